// The trace: the latest million frames of all buses, decoded; the meaning has the width. What a chosen line has besides stands beside the list.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconClose, iconSnowflake, iconTraceEye } from "../../frame/icons.js";
import { menu_button } from "../../frame/menu.js";
import { link, type Route } from "../../frame/route.js";
import type { Columns, DataGrid } from "../../parts/grid.js";
import { save_file } from "../../parts/save_file.js";
import { complete_terms, completions } from "../../store/filter.js";
import { Marks } from "../../store/marks.js";
import { count_text, seconds_text } from "../../store/nodes.js";
import { bytes_text, meaning_text, node_text, spaced, TraceRows, type TraceLine } from "../../store/trace_rows.js";
import { faults_of_frame } from "../faults/fault_text.js";
import { frame_of_row } from "./frame_text.js";
import { SendFrames } from "./send_frames.js";
import { statistics_view, type Statistics } from "./statistics.js";
import { TraceFiles } from "./trace_files.js";

const formats = ["candump", "pcapng", "pcap", "asc", "trc", "csv"];
const every = 400;  // ms between two looks at what is new

export class TraceScreen implements Screen {
  readonly id = "trace";
  readonly title = "Trace";
  readonly icon = iconTraceEye;
  readonly needs_parts = true;
  private rows: TraceRows;
  private filter = "";
  private with_delta = false;
  private hidden: string[] = [];
  private chosen: TraceLine | null = null;
  private pair: { record: number; t: number; id: string; data: string; text: string }[] = [];
  private readonly marks = new Marks();
  private readonly sending: SendFrames;
  private readonly files: TraceFiles;
  private wanted: number | null = null;  // a time whose line is to be chosen
  private timer: ReturnType<typeof setInterval> | null = null;
  private statistics: Statistics | null = null;

  constructor(private readonly app: App) {
    this.sending = new SendFrames(app);
    this.files = new TraceFiles(app, () => this.other_file());
    this.rows = new TraceRows((command) => app.connection.commands.run(command), () => {
      this.choose_wanted();
      app.redraw();
    });
  }

  opened(route: Route): void {
    this.filter = (route.query["filter"] ?? "").slice(0, 1000);
    const at = Number(route.query["at"]);
    this.wanted = route.query["at"] && Number.isFinite(at) ? at : null;
    if (this.wanted !== null) this.rows.forget();
    this.rows.restart(complete_terms(this.filter), this.rows.folded);
    void this.rows.fetch();
    if (!this.app.faults.is_known) void this.app.load_faults();
    this.timer ??= setInterval(() => {
      if (document.hidden) return;
      if (this.statistics) void this.count();
      else if (!this.rows.is_frozen) void this.rows.fetch();
    }, every);
  }

  closed(): void {
    if (this.timer) clearInterval(this.timer);
    this.timer = null;
  }

  private other_file(): void {
    this.chosen = null;
    this.marks.clear();
    this.app.describe(null);
    this.rows.restart(this.rows.filter, this.rows.folded, this.files.open?.file ?? null);
    this.rows.set_order(this.files.open === null);
    this.app.redraw();
  }

  private get grid(): DataGrid<TraceLine> | null {
    return document.querySelector<DataGrid<TraceLine>>("#trace-grid");
  }

  private set_filter(text: string): void {
    this.filter = text;
    this.app.keep("trace", [], { filter: text });
    this.rows.restart(complete_terms(this.filter), this.rows.folded);
    this.app.redraw();
  }

  private set_folded(on: boolean): void {
    this.rows.restart(this.rows.filter, on);
    this.app.redraw();
  }

  private set_order(newest_first: boolean): void {
    this.rows.set_order(newest_first);
    this.app.redraw();
    requestAnimationFrame(() => this.grid?.show_index(newest_first ? 0 : this.rows.count - 1));
  }

  private freeze(on: boolean): void {
    this.rows.freeze(on);
    if (!on) this.grid?.show_index(this.rows.newest_first ? 0 : this.rows.count - 1);
    this.app.redraw();
  }

  /** The line that is nearest to the time of the address. */
  private choose_wanted(): void {
    if (this.wanted === null || this.rows.count === 0 || this.rows.progress !== null) return;
    const wanted = this.wanted;
    this.wanted = null;
    void this.find_time(wanted);
  }

  private async find_time(wanted: number): Promise<void> {
    this.rows.freeze(true);
    const done = await this.app.connection.commands.run({ ...this.rows.question, at: wanted, count: 250 });
    const found = (done.rows[0] as { rows?: TraceLine[] } | undefined)?.rows ?? [];
    const nearest = found.reduce<TraceLine | null>((best, row) => (best === null || Math.abs(row.t - wanted) < Math.abs(best.t - wanted) ? row : best), null);
    if (!nearest) return;
    this.grid?.show_index(this.rows.index_of(nearest.n), "middle");
    this.choose(nearest);
  }

  private choose(row: TraceLine): void {
    const { picking } = this.app;
    if (picking) {
      this.app.pick(null);
      return picking.take(row.bus, row.id);
    }
    if (this.chosen?.n === row.n) return;
    this.chosen = row;
    this.pair = [];
    const since = (): string | undefined => { const t = this.marks.since(row.t); return t === null ? undefined : seconds_text(t); };
    this.app.describe({
      title: row.what,
      lead: row.trouble ? [row.text] : [],
      get rows(): [string, string | number | undefined][] { return [["Time", `${row.t.toFixed(6)} s`], ["Since the mark", since()], ["Bus", row.bus], ["CAN-ID", `${row.id}H`], ["Node", node_text(row)], ["Service", row.service],
        ["Object", row.object], ["Meaning", row.text], ["Data", row.frames === undefined ? bytes_text(row) : undefined], ["DLC", row.dlc], ["Duration", row.duration === undefined ? undefined : seconds_text(row.duration)]]; },
      ...(row.object ? { object: row.object.includes(":") ? row.object : `${row.object}:00` } : {}),
      more: () => this.more(row),
    }, true);
    if (row.service === "sdo") void this.load_pair(row);
  }

  private async load_pair(row: TraceLine): Promise<void> {
    const done = await this.app.connection.commands.run({ command: "trace", frames: row.record, ...(this.rows.file === null ? {} : { file: this.rows.file }) });
    if (this.chosen?.n !== row.n || done.code !== 0) return;
    this.pair = (done.rows[0] as { rows: TraceScreen["pair"] } | undefined)?.rows ?? [];
    this.grid?.redraw();
    this.app.redraw();
  }

  private more(row: TraceLine): TemplateResult {
    return html`${this.pair.length ? html`<h3>Frames of this transfer</h3><table class="rows"><tbody>${this.pair.map((one) => html`<tr><td>${one.t.toFixed(6)}</td><td>${one.id}H</td><td class="mono">${spaced(one.data)}</td></tr><tr><td colspan="3" class="faint">${one.text}</td></tr>`)}</tbody></table>` : nothing}
      <h3>Go to</h3><p class="buttons">
        <a href=${link("trace", [], { filter: `id=${row.id}` })}>Only ${row.id}H</a>
        ${row.node ? html`<a href=${link("trace", [], { filter: `node=${row.node}` })}>Only node ${row.node}</a><a href=${link("objects", [row.bus, row.node], row.object ? { find: row.object } : {})}>Objects</a>` : nothing}
        <a href=${link("bus", [row.bus], { id: row.id })}>Bits of ${row.id}H</a>
        <button type="button" class="quiet" @click=${() => this.mark(row)}>${this.marks.has(row.record) ? "Take the mark away" : "Set mark"}</button>
        ${this.sending.is_offered && this.rows.file === null && row.frames === undefined ? html`<button type="button" class="quiet" @click=${() => this.sending.open(row.bus, frame_of_row(row))}>Send again …</button>` : nothing}</p>
      ${this.can_fault(row) ? html`<h3>What if</h3><p class="buttons">${faults_of_frame.map(([name, text]) => html`<button type="button" class="quiet" @click=${() => this.fault(row, text)}>${name}</button>`)}</p>` : nothing}`;
  }

  private mark(row: TraceLine): void {
    this.marks.toggle({ record: row.record, t: row.t, text: row.what });
    this.grid?.redraw();
    this.app.redraw();
  }

  private mark_strip(): TemplateResult | typeof nothing {
    const { all } = this.marks;
    if (all.length === 0) return nothing;
    return html`<div class="marks" role="group" aria-label="Marks">${all.map((one, i) => html`${i > 0 ? html`<span class="faint">${seconds_text(one.t - all[i - 1]!.t)}</span>` : nothing}
      <button type="button" class="quiet mark" title="Show this line" @click=${() => void this.find_time(one.t)}>${one.t.toFixed(6)} s ${one.text}</button>`)}
      <ix-icon-button size="16" variant="subtle-tertiary" icon=${iconClose} aria-label="Take all marks away" title="Take all marks away" @click=${() => { this.marks.clear(); this.grid?.redraw(); this.app.redraw(); }}></ix-icon-button></div>`;
  }

  private can_fault(row: TraceLine): boolean {
    if (!this.app.faults.is_known) void this.app.load_faults();
    return this.rows.file === null && this.app.store.may_operate && this.app.faults.buses.some((bus) => bus.bus === row.bus);
  }

  private fault(row: TraceLine, text: (id: string) => string): void {
    this.app.faults.add(row.bus, text(row.id));
    this.app.go("faults", [row.bus]);
  }

  private open_menu(row: TraceLine, x: number, y: number): void {
    const faults = this.can_fault(row) ? faults_of_frame.map(([title, text]) => ({ title, run: () => this.fault(row, text) })) : [];
    const mark = { title: this.marks.has(row.record) ? "Take the mark away" : "Set mark", run: () => this.mark(row) };
    this.app.menu.open([...faults, mark], x, y, `Line of ${row.id}H`);
  }

  private columns(): Columns<TraceLine> {
    const many = (this.app.store.state?.buses.length ?? 0) > 1;
    const all: Columns<TraceLine> = [
      { headerName: "Time, s", colId: "time", width: 116, cellClass: "figure", valueGetter: (p) => p.data?.t.toFixed(6) ?? "" },
      { headerName: "Delta, ms", colId: "delta", width: 84, cellClass: "figure", hide: !this.with_delta, valueGetter: (p) => (p.data?.delta == null ? "" : (1000 * p.data.delta).toFixed(3)) },
      { headerName: "Bus", field: "bus", width: 80, hide: !many },
      { headerName: "CAN-ID", field: "id", width: 76, cellClass: "figure" },
      { headerName: "Node", colId: "node", width: 120, valueGetter: (p) => (p.data ? node_text(p.data) : "") },
      { headerName: "Message", field: "what", width: 112 },
      { headerName: "Meaning", colId: "text", flex: 1, minWidth: 240, valueGetter: (p) => (p.data ? meaning_text(p.data) : "") },
      { headerName: "Data", colId: "data", width: 186, hide: this.app.is_narrow, cellClass: "mono", valueGetter: (p) => (p.data ? bytes_text(p.data) : "") },
    ];
    return all.map((one) => ({ ...one, sortable: false, hide: (one.hide ?? false) || this.hidden.includes(one.headerName ?? "") }));
  }

  private choose_columns(): void {
    const names = ["Bus", "CAN-ID", "Node", "Message", "Data"];
    const button = document.querySelector<HTMLElement>("[data-columns]");
    if (!button) return;
    this.app.menu.open_below(button, names.map((name) => ({ title: `${this.hidden.includes(name) ? "Show" : "Hide"} ${name}`, run: () => {
      this.hidden = this.hidden.includes(name) ? this.hidden.filter((one) => one !== name) : [...this.hidden, name];
      this.app.redraw();
    } })), "Columns");
  }

  private get column_key(): string {
    const { app } = this;
    return [this.with_delta, this.hidden, (app.store.state?.buses.length ?? 0) > 1, app.is_narrow].join();
  }

  private async count(): Promise<void> {
    const done = await this.app.connection.commands.run({ command: "trace", statistics: true, ...(this.rows.file === null ? {} : { file: this.rows.file }) });
    if (this.statistics && done.code === 0) this.statistics = done.rows[0] as unknown as Statistics;
    this.app.redraw();
  }

  private async export(format: string): Promise<void> {
    const parts: Uint8Array<ArrayBuffer>[] = [];
    let frames = 0;
    for (let part = 0; ; ++part) {
      const done = await this.app.connection.commands.run({ command: "export trace", filter: this.rows.filter, format, part, ...(this.rows.file === null ? {} : { file: this.rows.file }) });
      if (done.code !== 0) return this.app.say(done.message, "error");
      const row = done.rows[0] as unknown as { data: string; frames: number; at: number; done: boolean };
      parts.push(Uint8Array.from(atob(row.data), (c) => c.charCodeAt(0)));
      frames += row.frames;
      this.app.say(`export: ${count_text(frames, "frame")}, ${Math.floor(100 * row.at)} % of the trace`);
      if (row.done) break;
      await new Promise((done_waiting) => setTimeout(done_waiting, 60));
    }
    save_file(parts, `trace.${format === "candump" ? "log" : format}`);
    this.app.say(`${count_text(frames, "frame")} exported`);
  }

  private about(): string {
    const { rows } = this;
    if (rows.problem) return "";
    const parts = [`${count_text(rows.count, "line")} of ${count_text(rows.records, "frame")}`];
    if (rows.progress !== null) parts.push(`${Math.floor(100 * rows.progress)} % read`);
    if (rows.forgotten) parts.push(`${rows.forgotten} older ones forgotten`);
    if (rows.lost) parts.push(`${rows.lost} lost`);
    return parts.join(", ");
  }

  view(): TemplateResult {
    const { rows, app } = this;
    const { open } = this.files;
    return html`<div class="takes-files" @dragover=${(event: DragEvent) => { if (this.files.are_taken) event.preventDefault(); }} @drop=${(event: DragEvent) => { event.preventDefault(); const file = event.dataTransfer?.files[0]; if (file && this.files.are_taken) void this.files.take(file); }}>
      ${head("Trace", html`${open ? html`<b class="replay" title=${open.path}>REPLAY ${open.path}</b> ` : nothing}${this.about()}`,
      this.files.are_offered ? html`<button type="button" class="quiet bordered" id="trace-open" aria-haspopup="menu" @click=${async (event: Event) => { const button = event.currentTarget as HTMLElement; const items = await this.files.items(); if (items.length) app.menu.open_below(button, items, "Trace files"); }}>Open a file ▾</button>` : nothing,
      open ? html`<button type="button" class="quiet bordered" @click=${() => void this.files.close()}>Back to this run</button>` : nothing,
      this.sending.is_offered && !open ? html`<button type="button" class="quiet bordered" id="trace-send" aria-expanded=${this.sending.is_open} @click=${() => { if (this.sending.is_open) { this.sending.is_open = false; app.redraw(); } else this.sending.open(); }}>Send frames …</button>` : nothing,
      html`<button type="button" class="quiet bordered" aria-pressed=${this.statistics !== null} @click=${() => { this.statistics = this.statistics ? null : ({} as Statistics); if (this.statistics) void this.count(); app.redraw(); }}>Statistics</button>`,
      menu_button(app, "Export", "Export", () => formats.map((format) => ({ title: format, run: () => void this.export(format) }))))}
      <div class="tools">
        <filter-input class="grows" data-filter .label=${"Filter"} .hint=${"Filter, for example node=3 service=sdo abort=06010002"} .value=${this.filter} .suggest=${(term: string) => completions(term, app.store.state, rows.objects())} .changed=${(text: string) => this.set_filter(text)}></filter-input>
        <button type="button" class="quiet bordered" id="trace-freeze" aria-pressed=${rows.is_frozen} title="New lines are counted, and the list stays" @click=${() => this.freeze(!rows.is_frozen)}><ix-icon aria-hidden="true" name=${iconSnowflake} size="16"></ix-icon>Freeze</button>
        <label class="inline"><input type="checkbox" .checked=${rows.newest_first} @change=${(e: Event) => this.set_order((e.target as HTMLInputElement).checked)}>Newest first</label>
        <label class="inline"><input type="checkbox" .checked=${rows.folded} @change=${(e: Event) => this.set_folded((e.target as HTMLInputElement).checked)}>Group SDO transfers</label>
        <label class="inline"><input type="checkbox" .checked=${this.with_delta} @change=${(e: Event) => { this.with_delta = (e.target as HTMLInputElement).checked; this.app.redraw(); }}>Delta time</label>
        <button type="button" class="quiet bordered" data-columns aria-haspopup="menu" @click=${() => this.choose_columns()}>Columns ▾</button>
      </div>
      ${rows.problem ? html`<p class="bad" role="alert">${rows.problem}</p>` : nothing}
      ${this.sending.view()}${this.mark_strip()}
      ${this.statistics ? statistics_view(this.statistics) : guard([this.column_key], () => html`<data-grid id="trace-grid" .label=${"Trace"} .empty=${"No frame that the filter lets through"} .columns=${this.columns()} .source=${rows}
        .row_classes=${{ "row-trouble": (row: TraceLine) => row.trouble === true, "row-chosen": (row: TraceLine) => row.n === this.chosen?.n, "row-mark": (row: TraceLine) => this.marks.has(row.record), "row-pair": (row: TraceLine) => this.pair.some((one) => one.record === row.record) }}
        .chosen=${(row: TraceLine) => this.choose(row)} .marked=${(row: TraceLine) => this.mark(row)} .moved=${() => { if (!rows.is_frozen) this.freeze(true); }} .menu=${(row: TraceLine, x: number, y: number) => this.open_menu(row, x, y)}
        @wheel=${(e: WheelEvent) => { if (!rows.is_frozen && (rows.newest_first ? e.deltaY > 0 : e.deltaY < 0)) this.freeze(true); }}></data-grid>`)}</div>`;
  }
}
