// The object dictionary of a node: value, unit, words of the value, project and difference. What is chosen is described at the right edge, where it is written, too.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconList } from "../../frame/icons.js";
import type { Route } from "../../frame/route.js";
import type { Columns, DataGrid } from "../../parts/grid.js";
import { number_cell, toggle_plot } from "../../parts/plot_button.js";
import { count_text, id_of, label_of, type ShownNode } from "../../store/nodes.js";
import type { Project } from "../../store/project.js";
import type { ObjectRow, ViewWish } from "../../store/protocol.js";
import { ViewRows } from "../../store/view_rows.js";
import { LiveValues } from "./live_values.js";
import { bits_view, DomainPart, ObjectForm } from "./object_form.js";
import { default_text, difference_text, found_rows, full_name, object_words, project_text, value_text } from "./object_text.js";

const poll_every = 1000;  // ms

export class ObjectsScreen implements Screen {
  readonly id = "objects";
  readonly title = "Objects";
  readonly icon = iconList;
  readonly needs_parts = true;
  private rows = new ViewRows<ObjectRow>();
  private node: ShownNode | null = null;
  private wanted: string[] = [];
  private chosen = "";
  private was_hex = false;
  /** Rows of a live node are those of its project: of which, and with which filter. */
  private shown_project: unknown[] = [];
  private polls = false;
  private timer: ReturnType<typeof setInterval> | null = null;
  private readonly form: ObjectForm;
  private readonly domain: DomainPart;
  private readonly live: LiveValues;

  constructor(private readonly app: App) {
    this.form = new ObjectForm(app);
    this.domain = new DomainPart(app);
    this.live = new LiveValues((command) => app.connection.commands.run(command), () => { ++this.rows.version; app.redraw(); });
    app.store.listen((event) => {
      const view = event?.event === "objects" ? app.store.view("objects") : null;
      if (view && this.node && view.bus === this.node.bus && view.node === this.node.node && view.number === this.node.place) this.rows.take(view);
    });
  }

  opened(route: Route): void {
    this.wanted = route.path;
    this.node = null;
    this.chosen = "";
    this.shown_project = [];
    this.live.forget();
    this.domain.choose(null);
    this.rows.restart(route.query["find"] ?? "");
    this.app.store.forget_view("objects");
    this.find_node();
    this.timer ??= setInterval(() => { if (this.polls && this.is_live && !document.hidden) void this.read_live(); }, poll_every);
  }

  closed(): void {
    if (this.timer) clearInterval(this.timer);
    this.timer = null;
    this.polls = false;
  }

  private find_node(): void {
    const { nodes } = this.app.store;
    const [bus, id] = this.wanted;
    this.node = nodes.find((one) => one.bus === bus && String(one.node) === id) ?? (bus === undefined ? nodes.find((one) => one.place >= 0 && !one.own?.module) ?? nodes[0] : undefined) ?? null;
  }

  /** Its values are on a live bus: each is an SDO, when it is asked for. */
  private get is_live(): boolean {
    return this.node !== null && this.node.place < 0;
  }

  wishes(): ViewWish[] {
    const place = this.node?.place ?? -1;
    return place < 0 ? [] : [{ objects: place, find: this.rows.find, from: this.rows.from, count: this.rows.asked }, ...this.domain.wishes(place)];
  }

  /** The project that has this node, its objects read. */
  private get project(): Project | null {
    const { node } = this;
    const project = node ? this.app.project_with(node.bus, node.node) : null;
    if (project && node) void project.load_objects(node.node);
    return project;
  }

  private project_value(row: ObjectRow): number | string | null | undefined {
    const { node } = this;
    const found = node ? this.project?.objects.get(node.node)?.find((one) => one.object === row.object) : undefined;
    return found?.value;
  }

  /** Of a live node: when the project or the filter has changed. */
  private take_project(): void {
    const objects = this.node ? this.project?.objects.get(this.node.node) : undefined;
    const shown = [objects, this.rows.find];
    if (!objects || shown.every((one, i) => one === this.shown_project[i])) return;
    this.shown_project = shown;
    const rows = found_rows(objects, this.rows.find);
    this.rows.take({ from: 0, of: rows.length, rows });
  }

  private get grid(): DataGrid<ObjectRow> | null {
    return document.querySelector<DataGrid<ObjectRow>>("#objects-grid");
  }

  private key_of(row: ObjectRow): string {
    return this.node?.place === -1 ? `sdo ${this.node.bus} ${this.node.node} ${row.object}` : `objects ${this.node?.place} ${row.object}`;
  }

  private plot_name(row: ObjectRow): string {
    return `${this.node ? label_of(this.node) : ""} ${row.object} ${row.name}`;
  }

  private async read_live(rows: readonly ObjectRow[] = this.rows.in_sight()): Promise<void> {
    const { node } = this;
    if (!node) return;
    await this.live.read_rows(node.bus, node.node, rows, (object, value, t) => this.app.plots.take_value(`sdo ${node.bus} ${node.node} ${object}`, t, value));
  }

  private set_find(text: string): void {
    this.rows.restart(text);
    if (this.node) this.app.keep("objects", [this.node.bus, this.node.node], { find: text });
    this.app.redraw();
  }

  private choose(row: ObjectRow): void {
    this.chosen = row.object;
    this.domain.choose(row);
    this.form.begin(row);
    const now = (): ObjectRow => this.live.shown(this.rows.rows.find((one) => one.object === row.object) ?? row);
    const in_project = (one: ObjectRow): string => project_text(one, this.project_value(one), false);
    const range = row.low !== undefined || row.high !== undefined ? `${row.low ?? ""} … ${row.high ?? ""}` : "";
    this.app.describe({
      title: full_name(row), object: row.object,
      get rows(): [string, string | undefined][] {
        const one = now();
        const in_both = (decimal: string | undefined, hex: string | undefined): string => (decimal === undefined ? "" : `${decimal} (${hex}H)`);
        return [["Object", one.object], ["Value", one.decimal === undefined ? value_text(one, false) : in_both(one.decimal, one.hex)], ["In words", object_words(one)], ["Warning", one.warning], ["Project", in_project(one)],
          ["Unit", one.unit], ["Type", one.type], ["Access", one.access], ["Range", range], ["Default", in_both(one.default_decimal, one.default_hex)], ["PDO", one.tpdo || one.rpdo ? `can be mapped (${[one.tpdo ? "TPDO" : "", one.rpdo ? "RPDO" : ""].filter(Boolean).join(", ")})` : ""]];
      },
      more: () => this.more(now()),
    }, true);
  }

  private more(row: ObjectRow): TemplateResult {
    const { node } = this;
    if (!node) return html``;
    const key = this.key_of(row);
    const plot = row.decimal === undefined ? nothing : html`<button type="button" class="quiet bordered" aria-pressed=${this.app.plots.has(key)} @click=${() => toggle_plot(this.app, key, this.plot_name(row))}>Plot</button>`;
    const read = this.is_live ? html`<button type="button" class="quiet bordered" @click=${() => void this.read_live([row])}>Read by SDO</button>` : nothing;
    return html`${bits_view(row)}${this.form.view(node, row, html`${read}${plot}`)}${this.domain.view()}`;
  }

  private value_cell(row: ObjectRow | undefined): HTMLElement | string {
    if (!row) return "";
    const shown = this.live.shown(row);
    const text = value_text(shown, this.app.is_hexadecimal);
    return shown.decimal === undefined ? text : number_cell(this.app, this.key_of(row), this.plot_name(row), text);
  }

  private columns(): Columns<ObjectRow> {
    const in_hex = (): boolean => this.app.is_hexadecimal;
    const live = (row: ObjectRow): ObjectRow => this.live.shown(row);
    const text = (of: (row: ObjectRow) => string) => (p: { data?: ObjectRow | undefined }): string => (p.data ? of(live(p.data)) : "");
    const { is_narrow } = this.app;
    const has_project = this.project !== null;
    const all: Columns<ObjectRow> = [
      { headerName: "Object", field: "object", width: 88, cellClass: "figure" },
      { headerName: "Name", colId: "name", flex: 3, minWidth: 180, valueGetter: text(full_name) },
      { headerName: "Value", colId: "value", flex: 1, minWidth: 120, cellClass: "figure", valueGetter: text((row) => value_text(row, in_hex())), cellRenderer: (p: { data?: ObjectRow }) => this.value_cell(p.data) },
      { headerName: "Unit", field: "unit", width: 68 },
      { headerName: "In words", colId: "words", flex: 3, minWidth: 150, valueGetter: text((row) => this.live.problem_of(row.object) || object_words(row)) },
      { headerName: "Project", colId: "project", width: 110, cellClass: "figure", hide: !has_project, valueGetter: text((row) => project_text(row, this.project_value(row), in_hex())) },
      { headerName: "Difference", colId: "difference", width: 96, hide: !has_project, valueGetter: text((row) => difference_text(row, this.project_value(row))), cellClassRules: { bad: (p) => p.value === "differs" } },
      { headerName: "Default", colId: "default", width: 104, cellClass: "figure", hide: is_narrow, valueGetter: text((row) => default_text(row, in_hex())) },
      { headerName: "Type", field: "type", width: 120, hide: is_narrow },
      { headerName: "Access", field: "access", width: 76, hide: is_narrow },
    ];
    return all;
  }

  /** A node whose dictionary the server does not have. */
  private other(node: ShownNode | null): TemplateResult {
    if (!node) return html`<p class="faint">Choose a node.</p>`;
    if (!this.app.store.joins(node.bus)) return html`<p class="faint">Commands cannot join the bus ${node.bus}.</p>`;
    return html`<p class="faint">${label_of(node)} is an external node (not in the plant file): its objects are read one by one, by SDO.</p>${this.form.alone(node)}`;
  }

  private table(node: ShownNode): TemplateResult {
    return html`${guard([node.key, this.project !== null, this.app.is_narrow], () => html`<data-grid id="objects-grid" .label=${"Objects"} .empty=${"No object with this name or index"} .columns=${this.columns()} .source=${this.rows}
      .row_classes=${{ "row-chosen": (row: ObjectRow) => row.object === this.chosen }} .chosen=${(row: ObjectRow) => this.choose(row)} .plotted=${(row: ObjectRow) => { if (this.live.shown(row).decimal !== undefined) toggle_plot(this.app, this.key_of(row), this.plot_name(row)); }}
      .opened=${() => document.querySelector<HTMLElement>("#object-value")?.focus()}></data-grid>`)}`;
  }

  view(): TemplateResult {
    const { app, rows } = this;
    const { nodes } = app.store;
    if (!this.node || !nodes.includes(this.node)) {
      const again = this.node ? nodes.find((one) => one.key === this.node?.key) : undefined;
      if (again) this.node = again;
      else this.find_node();
    }
    const { node } = this;
    if (this.was_hex !== app.is_hexadecimal) {
      this.was_hex = app.is_hexadecimal;
      ++rows.version;
      requestAnimationFrame(() => this.grid?.grid?.refreshCells({ force: true }));
    }
    const buses = [...new Set(nodes.map((one) => one.bus))];
    const has_table = node !== null && (node.place >= 0 || this.project !== null);
    if (this.is_live && has_table) this.take_project();
    const may_read = node !== null && this.is_live && app.store.may_operate && app.store.joins(node.bus);
    return html`${head("Objects", has_table ? `${node.place >= 0 ? "" : "live bus, "}${count_text(rows.count, "sub-index", "sub-indexes")}` : "")}
      <div class="tools">
        <label class="inline">Node <select class="field" id="objects-node" @change=${(event: Event) => { const [bus = "", id = ""] = (event.target as HTMLSelectElement).value.split("/"); app.go("objects", [bus, id]); }}>
          ${buses.map((bus) => html`<optgroup label=${bus}>${nodes.filter((one) => one.bus === bus).map((one) => html`<option value=${`${one.bus}/${one.node}`} ?selected=${one.key === node?.key}>${id_of(one)} ${label_of(one)}</option>`)}</optgroup>`)}</select></label>
        <input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Name or index" autocomplete="off" spellcheck="false" maxlength="100" .value=${rows.find} @input=${(event: Event) => this.set_find((event.target as HTMLInputElement).value)}>
        ${has_table && may_read ? html`<ix-button variant="secondary" ?disabled=${this.live.is_busy} title="Reads the objects in sight by SDO" @click=${() => void this.read_live()}>Read</ix-button>
          <label class="inline" title="Reads the objects in sight every second"><input type="checkbox" .checked=${this.polls} @change=${(event: Event) => { this.polls = (event.target as HTMLInputElement).checked; app.redraw(); }}>Poll</label>` : nothing}
        <label class="inline"><input type="checkbox" .checked=${app.is_hexadecimal} @change=${(event: Event) => { app.is_hexadecimal = (event.target as HTMLInputElement).checked; app.redraw(); }}>Hexadecimal</label>
      </div>
      ${has_table ? this.table(node) : this.other(node)}`;
  }
}
