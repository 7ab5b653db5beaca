// Plots of numbers that somebody clicked, drawn on as long as their rows are in sight.
import { make, set_text } from "./dom.js";

const most_points = 2400;
const most_plots = 6;

export class Plots {
  constructor(section, list) {
    this.section = section;
    this.list = list;
    this.plots = new Map();  // by key: { name, points: [[t, value]], element }
  }

  /// A value of a number, plotted or not.
  add(key, value, t) {
    const plot = this.plots.get(key);
    if (!plot || t === undefined || plot.points.at(-1)?.[0] >= t) return;
    plot.points.push([t, value]);
    if (plot.points.length > most_points) plot.points.shift();
    this.draw(plot);
  }

  state(state) {
    for (const node of state.nodes) {
      for (const name of ["tec", "rec"]) this.add(`state ${node.bus} ${node.node} ${name}`, node[name], state.t);
    }
  }

  toggle(key, name) {
    if (this.plots.has(key)) return this.close(key);
    if (this.plots.size === most_plots) this.close(this.plots.keys().next().value);
    const close = make("button", { type: "button", "aria-label": `Close the plot of ${name}` }, "Close");
    close.addEventListener("click", () => this.close(key));
    const line = make("svg:polyline", { fill: "none" });
    const element = make("figure", { class: "plot" }, make("figcaption", {}, name, " ", make("b"), " ", close),
      make("div", { class: "axis" }, make("span"), make("span")),
      make("svg:svg", { viewBox: "0 0 1000 100", preserveAspectRatio: "none", role: "img", "aria-label": `Plot of ${name}` }, line),
      make("p", { class: "faint" }, "waits for values"));
    this.plots.set(key, { name, points: [], element, line });
    this.list.append(element);
    this.section.hidden = false;
  }

  close(key) {
    this.plots.get(key)?.element.remove();
    this.plots.delete(key);
    this.section.hidden = this.plots.size === 0;
  }

  draw(plot) {
    const { points, element, line } = plot;
    const values = points.map((point) => point[1]);
    const low = Math.min(...values);
    const high = Math.max(...values);
    const begin = points[0][0];
    const span = points.at(-1)[0] - begin || 1;
    const range = high - low || 1;
    // Values hold until the next one.
    const places = [];
    points.forEach(([t, value], i) => {
      const x = (1000 * (t - begin) / span).toFixed(1);
      if (i > 0) places.push(`${x},${(95 - 90 * (points[i - 1][1] - low) / range).toFixed(1)}`);
      places.push(`${x},${(95 - 90 * (value - low) / range).toFixed(1)}`);
    });
    line.setAttribute("points", places.join(" "));
    const [caption, axis, , note] = element.children;
    set_text(caption.querySelector("b"), String(values.at(-1)));
    set_text(axis.children[0], String(high));
    set_text(axis.children[1], String(low));
    set_text(note, `${begin.toFixed(1)} s to ${points.at(-1)[0].toFixed(1)} s`);
  }
}
