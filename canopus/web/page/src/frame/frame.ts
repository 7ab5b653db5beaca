// The frame of all screens: bar, navigation, description, newest troubles.
import { html, nothing, type TemplateResult } from "lit";
import { seconds_text } from "../store/nodes.js";
import type { Trouble } from "../store/store.js";
import type { App } from "./app.js";
import { head } from "./head.js";
import { iconChevronDown, iconChevronUp, iconClose } from "./icons.js";
import type { Palette } from "./palette.js";
import { PlotDock } from "./plot_dock.js";
import { link } from "./route.js";
import type { TopBar } from "./top_bar.js";

/** Where a trouble leads: to the frames of that moment, or to the list of events. */
export function link_of_trouble(trouble: Pick<Trouble, "last" | "event">): string {
  return trouble.event.bus ? link("trace", [], { at: trouble.last.toFixed(6) }) : link("events", [], { find: String(trouble.event["source"] ?? "") });
}

export const times_text = (count: number): string => (count > 1 ? `×${count}` : "");

export class Frame {
  private is_strip_open = true;
  private readonly dock: PlotDock;

  constructor(private readonly app: App, private readonly bar: TopBar, private readonly palette: Palette) {
    this.dock = new PlotDock(app);
  }

  private strip(): TemplateResult {
    const { troubles } = this.app.store;
    const shown = this.is_strip_open ? troubles.slice(0, 3) : troubles.slice(0, 1);
    return html`<section class="strip" aria-label="Newest troubles">
      <ol>${shown.length === 0 ? html`<li class="faint">No trouble since the start</li>` : shown.map((one) => html`<li data-mood=${one.mood}><a href=${link_of_trouble(one)} title=${one.text}>
        <span class="time">${one.last.toFixed(3)} s</span><span class="count">${times_text(one.count)}</span><span class="text">${one.text}</span></a></li>`)}</ol>
      <ix-icon-button size="16" variant="subtle-tertiary" icon=${this.is_strip_open ? iconChevronDown : iconChevronUp} aria-label=${this.is_strip_open ? "Show one trouble" : "Show three troubles"}
        @click=${() => { this.is_strip_open = !this.is_strip_open; this.app.redraw(); }}></ix-icon-button>
    </section>`;
  }

  private drawer(): TemplateResult | typeof nothing {
    const { app } = this;
    if (!app.is_described) return nothing;
    const { description } = app;
    const meaning = app.store.view("meaning");
    const shown = description?.object && meaning?.object === description.object && meaning.meaning ? meaning : null;
    return html`<aside class="drawer" aria-label="Description">
      <header><h2>${description?.title ?? "Description"}</h2><ix-icon-button size="16" variant="subtle-tertiary" icon=${iconClose} aria-label="Close the description" @click=${() => app.show_description(false)}></ix-icon-button></header>
      <div class="drawer-body">
      ${description === null ? html`<p class="faint">Choose a node, an object, a word or a frame: its meaning, range, default and source stand here.</p>` : html`
        ${(description.lead ?? []).map((line) => html`<p class="lead">${line}</p>`)}
        ${shown ? html`<p>${shown.meaning}</p>` : nothing}
        <table class="facts"><tbody>${description.rows.filter(([, value]) => value !== undefined && value !== "").map(([name, value]) => html`<tr><th scope="row">${name}</th><td>${value}</td></tr>`)}
          ${shown?.unit ? html`<tr><th scope="row">Unit</th><td>${shown.unit}</td></tr>` : nothing}
          ${shown?.source ? html`<tr><th scope="row">Source</th><td>${shown.source}</td></tr>` : nothing}</tbody></table>
        ${description.more?.() ?? nothing}`}
      </div></aside>`;
  }

  private old(): TemplateResult | typeof nothing {
    const { store } = this.app;
    if (store.connection === "lost" && store.state) return html`<p class="old" role="alert">The run has ended, or does not answer. What is shown is ${seconds_text((performance.now() - store.state_at) / 1000)} old.</p>`;
    if (store.connection === "silent") return html`<p class="old" role="alert">The run does not answer. What is shown is old.</p>`;
    return nothing;
  }

  view(): TemplateResult {
    const { app } = this;
    const { screen } = app;
    const counts: Record<string, number> = { overview: app.store.nodes.filter((node) => node.mood === "error").length };
    return html`<ix-application>
      ${this.bar.view()}
      <ix-menu ?start-expanded=${innerWidth >= 1600} ?pinned=${innerWidth >= 1600} aria-label="Screens">
        ${app.shown_screens.map((one) => html`<ix-menu-item label=${one.title} icon=${one.icon} ?active=${one === screen} notifications=${counts[one.id] || nothing} tooltip-text=${one.title} data-screen=${one.id}
          @click=${() => { if (one !== screen) location.hash = link(one.id); }}></ix-menu-item>`)}
      </ix-menu>
      <div class="page">
        <div class="screen-area">
          ${this.old()}
          ${app.picking ? html`<p class="said" role="status"><span>${app.picking.words}</span><button type="button" class="quiet" @click=${() => app.pick(null)}>Cancel</button></p>` : nothing}
          ${app.said.text ? html`<p class="said" role="status" data-mood=${app.said.mood}><span>${app.said.text}</span>
            ${app.said.mood === "running" ? html`<button type="button" class="quiet" @click=${() => app.connection.commands.stop()}>Stop</button>` : html`<ix-icon-button size="16" variant="subtle-tertiary" icon=${iconClose} aria-label="Close the message" @click=${() => app.say("")}></ix-icon-button>`}</p>` : nothing}
          <section class="screen" id=${`screen-${screen.id}`} aria-labelledby="screen-title">${screen.needs_parts && !app.has_parts ? head(screen.title, "") : screen.view()}</section>
          ${this.dock.view()}
        </div>
        ${this.drawer()}
        ${this.strip()}
      </div>
    </ix-application>${this.palette.view()}${app.menu.view()}`;
  }
}
