// Values over plant time: taken whichever screen is open, from when they were asked for.
import { html, nothing, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconLinechart, iconTrashcan } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import "../../parts/plot_chart.js";
import type { PlotChart } from "../../parts/plot_chart.js";
import { save_file } from "../../parts/save_file.js";
import { count_text } from "../../store/nodes.js";

const spans: [number, string][] = [[10, "last 10 s"], [60, "last minute"], [600, "last 10 minutes"], [0, "all"]];

export class PlotsScreen implements Screen {
  readonly id = "plots";
  readonly title = "Plots";
  readonly icon = iconLinechart;
  private seconds = 60;
  private is_frozen = false;

  constructor(private readonly app: App) {}

  /** An address names plots, so that whoever opens it sees the same. */
  opened(route: Route): void {
    for (const [key, name] of Object.entries(route.query)) if (!this.app.plots.has(key)) this.app.plots.toggle(key, name || key);
    this.keep();
  }

  private keep(): void {
    this.app.keep("plots", [], Object.fromEntries(this.app.plots.all.map((one) => [encodeURIComponent(one.key), one.name])));
  }

  private set_seconds(seconds: number): void {
    this.seconds = seconds;
    for (const chart of document.querySelectorAll<PlotChart>("plot-chart")) chart.show_all();
    this.app.redraw();
  }

  view(): TemplateResult {
    const { app } = this;
    const { all } = app.plots;
    if (all.length === 0) return html`${head("Plots", "")}<ix-empty-state header="Nothing is plotted" sub-header="An underlined number on any screen is plotted by a click; so is an object or a word, by “Plot” in its description."></ix-empty-state>
      <p class="buttons centered"><a href=${link("objects")}>Objects</a><a href=${link("module")}>Module</a><a href=${link("overview")}>Overview</a></p>`;
    requestAnimationFrame(() => { for (const chart of document.querySelectorAll<PlotChart>("plot-chart")) chart.update(); });
    const height = all.length > 3 ? 120 : all.length > 1 ? 180 : 320;
    return html`${head("Plots", count_text(all.length, "value"))}
      <div class="tools">
        <label class="inline">Show <select class="field" @change=${(event: Event) => this.set_seconds(Number((event.target as HTMLSelectElement).value))}>${spans.map(([value, text]) => html`<option value=${value} ?selected=${value === this.seconds}>${text}</option>`)}</select></label>
        <button type="button" class="quiet bordered" aria-pressed=${this.is_frozen} @click=${() => { this.is_frozen = !this.is_frozen; app.redraw(); }}>Freeze</button>
        <button type="button" class="quiet bordered" @click=${() => this.set_seconds(this.seconds)}>Zoom out</button>
        <button type="button" class="quiet bordered" @click=${() => save_file([app.plots.csv()], "plots.csv")}>Export CSV</button>
        <span class="faint">Drag over a plot to zoom in</span>
      </div>
      <div class="scrolls plots" tabindex="0" role="region" aria-label="Plots">${repeat(all, (one) => one.key, (one) => html`<section class="plot" aria-label=${one.name}><header><h2>${one.name}</h2><span class="figure">${one.values.at(-1) === undefined ? html`<span class="faint">no value yet</span>` : String(Math.round((one.values.at(-1) ?? 0) * 1e4) / 1e4)}</span><span class="grows"></span>
        <ix-icon-button size="16" variant="subtle-tertiary" icon=${iconTrashcan} aria-label=${`End the plot of ${one.name}`} title="End this plot" @click=${() => { app.plots.toggle(one.key, one.name); this.keep(); app.redraw(); }}></ix-icon-button></header>
        <plot-chart .plot=${one} .seconds=${this.seconds} .frozen=${this.is_frozen} .height=${height}></plot-chart></section>`)}</div>${nothing}`;
  }
}
