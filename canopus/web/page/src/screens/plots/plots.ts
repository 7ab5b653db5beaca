// Values over plant time: taken whichever screen is open, from when they were asked for.
import { html, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconLinechart, iconTrashcan } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import type { PlotChart } from "../../parts/plot_chart.js";
import { save_file } from "../../parts/save_file.js";
import { Cursors, cursor_text, rounded } from "../../store/cursors.js";
import { count_text, seconds_text } from "../../store/nodes.js";
import type { Plot } from "../../store/plots.js";

const spans: [number, string][] = [[10, "last 10 s"], [60, "last minute"], [600, "last 10 minutes"], [0, "all"]];

export class PlotsScreen implements Screen {
  readonly id = "plots";
  readonly title = "Plots";
  readonly icon = iconLinechart;
  readonly needs_parts = true;
  private seconds = 60;
  private is_frozen = false;
  private readonly cursors = new Cursors();

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

  private place(t: number, second: boolean): void {
    this.cursors[second ? "b" : "a"] = Math.round(t * 1000) / 1000;
    this.app.redraw();
  }

  private cursor_field(name: "a" | "b", hint: string): TemplateResult {
    const value = this.cursors[name];
    return html`<label class="inline" title=${hint}>Cursor ${name.toUpperCase()} <input class="field number-field" type="number" step="0.001" placeholder="s" .value=${value === null ? "" : String(value)}
      @change=${(event: Event) => { const text = (event.target as HTMLInputElement).value; this.cursors[name] = text === "" ? null : Number(text); this.app.redraw(); }}></label>`;
  }

  private plot(one: Plot, height: number): TemplateResult {
    const last = one.values.at(-1);
    return html`<section class="plot" aria-label=${one.name}><header><h2>${one.name}</h2><span class="figure">${last === undefined ? html`<span class="faint">no value yet</span>` : rounded(last)}</span><span class="faint">${cursor_text(one, this.cursors)}</span><span class="grows"></span>
      <ix-icon-button size="16" variant="subtle-tertiary" icon=${iconTrashcan} aria-label=${`End the plot of ${one.name}`} title="End this plot" @click=${() => { this.app.plots.toggle(one.key, one.name); this.keep(); this.app.redraw(); }}></ix-icon-button></header>
      <plot-chart .plot=${one} .seconds=${this.seconds} .frozen=${this.is_frozen} .height=${height} .cursors=${this.cursors} .placed=${(t: number, second: boolean) => this.place(t, second)}></plot-chart></section>`;
  }

  view(): TemplateResult {
    const { app, cursors } = this;
    const { all } = app.plots;
    if (all.length === 0) return html`${head("Plots", "")}<ix-empty-state header="Nothing is plotted" sub-header="A click on an underlined number plots it, on any screen."></ix-empty-state>
      <p class="buttons centered"><a href=${link("objects")}>Objects</a><a href=${link("module")}>Module</a><a href=${link("overview")}>Overview</a></p>`;
    const height = all.length > 3 ? 120 : all.length > 1 ? 200 : 400;
    return html`${head("Plots", count_text(all.length, "value"))}
      <div class="tools">
        <label class="inline">Show <select class="field" @change=${(event: Event) => this.set_seconds(Number((event.target as HTMLSelectElement).value))}>${spans.map(([value, text]) => html`<option value=${value} ?selected=${value === this.seconds}>${text}</option>`)}</select></label>
        <button type="button" class="quiet bordered" aria-pressed=${this.is_frozen} @click=${() => { this.is_frozen = !this.is_frozen; app.redraw(); }}>Freeze</button>
        <button type="button" class="quiet bordered" @click=${() => this.set_seconds(this.seconds)}>Zoom out</button>
        ${this.cursor_field("a", "Or click in a plot")}${this.cursor_field("b", "Or Shift and click in a plot")}
        ${cursors.between === null ? "" : html`<span id="cursor-time">B−A ${cursors.between < 0 ? "−" : ""}${seconds_text(Math.abs(cursors.between))}</span>`}
        <button type="button" class="quiet bordered" @click=${() => save_file([app.plots.csv()], "plots.csv")}>Export CSV</button>
      </div>
      <p class="faint">Drag over a plot to zoom in. Click sets cursor A, Shift and click cursor B.</p>
      <div class="scrolls plots" tabindex="0" role="region" aria-label="Plots">${repeat(all, (one) => one.key, (one) => this.plot(one, height))}</div>`;
  }
}
