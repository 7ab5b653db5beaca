// What happened, the newest first; what people did is a line, too.
import { html, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconLog } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import type { Columns } from "../../parts/grid.js";
import { count_text } from "../../store/nodes.js";
import { kind_words } from "../../store/sentences.js";
import { collapsed, matching_events, type EventFilter, type EventRow } from "./filter.js";

/** Rows for the grid: the newest first, of those that match. */
class EventRows {
  version = 0;
  private lines: EventRow[] = [];

  get count(): number {
    return this.lines.length;
  }

  row(index: number): EventRow | undefined {
    return this.lines[this.lines.length - 1 - index];
  }

  see(): void {
    // All are here.
  }

  set(lines: EventRow[]): void {
    this.lines = lines;
    ++this.version;
  }
}

export class EventsScreen implements Screen {
  readonly id = "events";
  readonly title = "Events";
  readonly icon = iconLog;
  readonly needs_parts = true;
  private filter: EventFilter = { find: "", only: "" };
  private rows = new EventRows();
  private shown = "";
  private is_frozen = false;
  private collapses = true;

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    const only = route.query["only"];
    this.filter = { find: route.query["find"] ?? "", only: only === "trouble" || only === "people" ? only : "" };
    this.is_frozen = false;
  }

  private set(filter: Partial<EventFilter>): void {
    this.filter = { ...this.filter, ...filter };
    this.app.keep("events", [], { ...this.filter });
    this.app.redraw();
  }

  private choose(line: EventRow): void {
    const rest = Object.entries(line.event).filter(([name, value]) => !["t", "event", "message", "reason"].includes(name) && typeof value !== "object");
    this.app.describe({ title: kind_words(line.kind), lead: line.mood === "error" ? [line.text] : [], rows: [["Time", `${line.t.toFixed(6)} s`], ...(line.mood === "error" ? [] : [["Event", line.text] as [string, string]]), ...rest.map(([name, value]): [string, string] => [name, String(value)])],
      more: () => (line.event.bus ? html`<p class="buttons"><a href=${link("trace", [], { at: line.t.toFixed(6) })}>Frames of this moment</a></p>` : html``) });
  }

  private columns(): Columns<EventRow> {
    return [
      { headerName: "Time, s", colId: "time", width: 120, cellClass: "figure", valueGetter: (p) => p.data?.t.toFixed(6) ?? "" },
      { headerName: "Times", colId: "count", width: 72, cellClass: "figure", valueGetter: (p) => (p.data && p.data.count > 1 ? `×${p.data.count}` : "") },
      { headerName: "Kind", colId: "kind", width: 124, valueGetter: (p) => (p.data ? kind_words(p.data.kind) : "") },
      { headerName: "Event", field: "text", flex: 1, minWidth: 240 },
    ];
  }

  private readonly grid_columns = this.columns();

  view(): TemplateResult {
    const { store } = this.app;
    const key = `${store.event_count} ${this.filter.find} ${this.filter.only} ${this.collapses}`;
    if (key !== this.shown && !(this.is_frozen && this.shown)) {
      this.shown = key;
      this.rows.set(collapsed(matching_events(store.events, this.filter), this.collapses));
    }
    const about = this.rows.count === store.events.length ? count_text(store.events.length, "event") : `${count_text(this.rows.count, "line")} of ${count_text(store.events.length, "event")}`;
    return html`${head("Events", about)}
      <div class="tools">
        <input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Filter: words of an event" autocomplete="off" spellcheck="false" .value=${this.filter.find} @input=${(event: Event) => this.set({ find: (event.target as HTMLInputElement).value })}>
        <label class="inline">Show <select class="field" @change=${(event: Event) => this.set({ only: (event.target as HTMLSelectElement).value as EventFilter["only"] })}>${[["", "all"], ["trouble", "troubles"], ["people", "what people did"]].map(([value, text]) => html`<option value=${value!} ?selected=${value === this.filter.only}>${text}</option>`)}</select></label>
        <label class="inline"><input type="checkbox" .checked=${this.collapses} @change=${(event: Event) => { this.collapses = (event.target as HTMLInputElement).checked; this.app.redraw(); }}>Repeated ones once</label>
        <button type="button" class="quiet bordered" aria-pressed=${this.is_frozen} @click=${() => { this.is_frozen = !this.is_frozen; this.app.redraw(); }}>Freeze</button>
      </div>
      <data-grid id="events-grid" .label=${"Events"} .empty=${"No event matches"} .columns=${this.grid_columns} .source=${this.rows} .row_classes=${{ "row-trouble": (row: EventRow) => row.mood === "error", "row-warning": (row: EventRow) => row.mood === "warning" }} .chosen=${(row: EventRow) => this.choose(row)}></data-grid>`;
  }
}
