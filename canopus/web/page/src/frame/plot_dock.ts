// The plots below every screen, where they were asked for: they keep running whichever screen is open.
import { html, nothing, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import { rounded } from "../store/cursors.js";
import { count_text } from "../store/nodes.js";
import type { Plot } from "../store/plots.js";
import type { App } from "./app.js";
import { iconChevronDown, iconChevronUp, iconClose } from "./icons.js";
import { link } from "./route.js";

export class PlotDock {
  private is_open = true;
  private known = 0;

  constructor(private readonly app: App) {}

  private plot(one: Plot): TemplateResult {
    const last = one.values.at(-1);
    return html`<section class="dock-plot" aria-label=${one.name}><header><span class="name" title=${one.name}>${one.name}</span><span class="figure">${last === undefined ? "–" : rounded(last)}</span>
      <ix-icon-button size="16" variant="subtle-tertiary" icon=${iconClose} aria-label=${`End the plot of ${one.name}`} title="End this plot" @click=${() => { this.app.plots.toggle(one.key, one.name); this.app.redraw(); }}></ix-icon-button></header>
      ${this.is_open ? html`<plot-chart .plot=${one} .seconds=${60} .height=${112} .is_small=${true}></plot-chart>` : nothing}</section>`;
  }

  view(): TemplateResult | typeof nothing {
    const { all } = this.app.plots;
    // A plot that begins is shown.
    if (all.length > this.known) this.is_open = true;
    this.known = all.length;
    if (all.length === 0 || this.app.screen.id === "plots" || !this.app.has_parts) return nothing;
    return html`<section class="dock" aria-label="Plots" data-open=${this.is_open ? "" : nothing}>
      <header><a href=${link("plots")}>${count_text(all.length, "plot")}</a><span class="faint">last minute</span><span class="grows"></span>
        <ix-icon-button size="16" variant="subtle-tertiary" icon=${this.is_open ? iconChevronDown : iconChevronUp} aria-label=${this.is_open ? "Fold the plots" : "Unfold the plots"} @click=${() => { this.is_open = !this.is_open; this.app.redraw(); }}></ix-icon-button></header>
      <div class="dock-plots" tabindex="0" role="region" aria-label="Charts">${repeat(all, (one) => one.key, (one) => this.plot(one))}</div></section>`;
  }
}
