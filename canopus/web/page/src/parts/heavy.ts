// Tables, plots and the filter with completion: most of the code of the page. It comes behind the first screen, which is drawn without it.
import "./filter_input.js";
import "./grid.js";
import "./plot_chart.js";
