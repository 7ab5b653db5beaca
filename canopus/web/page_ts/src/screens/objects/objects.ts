// The object dictionary of a node: value, type, words of the value, default. What is chosen is described at the right edge, where it is written, too.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconList } from "../../frame/icons.js";
import type { Route } from "../../frame/route.js";
import type { Columns, DataGrid } from "../../parts/grid.js";
import { toggle_plot } from "../../parts/plot_button.js";
import { save_file } from "../../parts/save_file.js";
import { count_text, id_of, label_of, type ShownNode } from "../../store/nodes.js";
import type { DomainWords, ObjectRow, ViewWish } from "../../store/protocol.js";
import { is_hexadecimal, sdo_type, words_of } from "../../store/value_words.js";
import { ViewRows } from "../../store/view_rows.js";

export const full_name = (row: Pick<ObjectRow, "name" | "of">): string => (row.name === row.of ? row.name : `${row.of}: ${row.name}`);

export function value_text(row: ObjectRow, in_hex: boolean): string {
  if (row.decimal !== undefined) return in_hex || is_hexadecimal(row.object) ? `${row.hex}H` : row.decimal;
  if (row.text !== undefined && !in_hex) return `“${row.text}”`;
  if (!row.bytes) return "empty";
  return row.type === "DOMAIN" || row.bytes > 64 ? count_text(row.bytes, "byte") : row.hex ?? "";
}

export function default_text(row: ObjectRow, in_hex: boolean): string {
  if (row.decimal === undefined) return "";
  if (row.decimal === row.default_decimal) return "same";
  return in_hex || is_hexadecimal(row.object) ? `${row.default_hex}H` : row.default_decimal ?? "";
}

export const object_words = (row: ObjectRow): string => row.words ?? (row.decimal === undefined ? "" : words_of(row.object, Number(row.decimal)));

export class ObjectsScreen implements Screen {
  readonly id = "objects";
  readonly title = "Objects";
  readonly icon = iconList;
  private rows = new ViewRows<ObjectRow>();
  private node: ShownNode | null = null;
  private wanted: string[] = [];
  private chosen = "";
  private domain: { object: string; part: number | null; parts: Uint8Array<ArrayBuffer>[] } | null = null;
  private was_hex = false;
  /** Of a node that is not of the plant, or another object: read by SDO. */
  private sdo = { object: "", type: "", value: "", said: "", mood: "" };

  constructor(private readonly app: App) {
    app.store.listen((event) => {
      if (event?.event === "objects") {
        const view = app.store.view("objects");
        if (view && this.node && view.bus === this.node.bus && view.node === this.node.node && view.number === this.node.place) this.rows.take(view);
      }
      if (event?.event === "domain") this.take_domain();
    });
  }

  opened(route: Route): void {
    this.wanted = route.path;
    this.node = null;
    this.chosen = "";
    this.domain = null;
    this.rows.restart(route.query["find"] ?? "");
    this.app.store.forget_view("objects");
    this.find_node();
  }

  private find_node(): void {
    const { nodes } = this.app.store;
    const [bus, id] = this.wanted;
    this.node = nodes.find((one) => one.bus === bus && String(one.node) === id) ?? (bus === undefined ? nodes.find((one) => one.place >= 0 && !one.own?.module) ?? nodes.find((one) => one.place >= 0) : undefined) ?? null;
  }

  wishes(): ViewWish[] {
    if (!this.node || this.node.place < 0) return [];
    const list: ViewWish = { objects: this.node.place, find: this.rows.find, from: this.rows.from, count: this.rows.asked };
    if (!this.domain) return [list];
    return [list, { domain: this.node.place, object: this.domain.object, ...(this.domain.part === null ? {} : { part: this.domain.part }) }];
  }

  private set_find(text: string): void {
    this.rows.restart(text);
    if (this.node) this.app.keep("objects", [this.node.bus, this.node.node], { find: text });
    this.app.redraw();
  }

  private choose(row: ObjectRow): void {
    this.chosen = row.object;
    this.domain = row.type === "DOMAIN" || (row.bytes ?? 0) > 64 ? { object: row.object, part: null, parts: [] } : null;
    this.app.store.forget_view("domain");
    this.sdo = { object: row.object, type: sdo_type(row.type), value: "", said: "", mood: "" };
    const now = (): ObjectRow => this.rows.rows.find((one) => one.object === row.object) ?? row;
    const range = row.low !== undefined || row.high !== undefined ? `${row.low ?? ""} … ${row.high ?? ""}` : "";
    this.app.describe({
      title: full_name(row), object: row.object,
      get rows(): [string, string | undefined][] {
        const one = now();
        return [["Object", one.object], ["Value", one.decimal === undefined ? value_text(one, false) : `${one.decimal} (${one.hex}H)`], ["In words", object_words(one)], ["Warning", one.warning], ["Type", one.type], ["Access", one.access], ["Range", range],
          ["Default", one.default_decimal === undefined ? "" : `${one.default_decimal} (${one.default_hex}H)`]];
      },
      more: () => html`${this.write_form(now())}${this.domain_view()}`,
    }, true);
  }

  private may_write(row: ObjectRow): boolean {
    return row.access !== "ro" && row.access !== "const" && this.app.store.may_configure && this.node !== null && this.app.store.joins(this.node.bus);
  }

  private write_form(row: ObjectRow): TemplateResult {
    const key = `objects ${this.node?.place} ${row.object}`;
    const name = `${this.node ? label_of(this.node) : ""} ${row.object} ${row.name}`;
    const plot = row.decimal === undefined ? nothing : html`<button type="button" class="quiet bordered" aria-pressed=${this.app.plots.has(key)} @click=${() => toggle_plot(this.app, key, name)}>Plot</button>`;
    if (!this.may_write(row)) return html`<p class="buttons">${plot}</p>`;
    return html`<form class="write" @submit=${(event: Event) => { event.preventDefault(); void this.write(); }}>
      <label class="stacked"><span>New value (${row.type})</span><input class="field" id="object-value" autocomplete="off" spellcheck="false" placeholder=${row.decimal ?? "text or bytes"} .value=${this.sdo.value} @input=${(event: Event) => { this.sdo.value = (event.target as HTMLInputElement).value; }}></label>
      <p class="buttons"><ix-button type="submit" @click=${() => void this.write()}>Write by SDO</ix-button>${plot}</p>
      ${this.sdo.said ? html`<p role="status" class=${this.sdo.mood}>${this.sdo.said}</p>` : nothing}</form>`;
  }

  private async write(): Promise<void> {
    const { node, sdo } = this;
    if (!node || sdo.value.trim() === "") return;
    const done = await this.app.connection.commands.run({ command: "sdo write", bus: node.bus, node: String(node.node), object: sdo.object, value: sdo.value.trim(), ...(sdo.type ? { type: sdo.type } : {}) });
    const reason = (done.rows[0] as { reason?: string } | undefined)?.reason ?? done.message;
    Object.assign(sdo, done.code === 0 ? { said: `${sdo.object} = ${sdo.value.trim()} written`, mood: "", value: "" } : { said: reason.replace(/Give --type.*$/, "Choose a type.") || `failed with code ${done.code}`, mood: "bad" });
    this.app.redraw();
  }

  private take_domain(): void {
    const event = this.app.store.view("domain");
    const { domain } = this;
    if (!event || !domain || event.object !== domain.object || domain.part === null || event.part !== domain.part) return;
    const bytes = Uint8Array.from((event.hex ?? "").match(/../g) ?? [], (pair) => parseInt(pair, 16));
    domain.parts.push(bytes);
    domain.part += bytes.length;
    if (domain.part < event.size && bytes.length > 0) return;
    save_file(domain.parts, `${event.bus}-${event.node}-${event.object.replace(":", "-")}.bin`.replace(/[^\w.-]/g, "_"));
    this.domain = { object: domain.object, part: null, parts: [] };
  }

  private domain_view(): TemplateResult | typeof nothing {
    const event = this.app.store.view("domain");
    if (!this.domain || !event?.words || event.object !== this.domain.object) return nothing;
    const words: DomainWords = event.words;
    return html`<h3>${words.heading}</h3>${words.problem ? html`<p class="bad">${words.problem}</p>` : nothing}
      ${words.entries.length ? html`<table class="rows"><tbody>${words.entries.map((one) => html`<tr><th scope="row">${one.object}</th><td>${one.name}</td><td class="figure">${one.value}</td></tr>`)}</tbody></table>` : nothing}
      ${words.dump.length ? html`<pre class="dump" tabindex="0" aria-label="Bytes">${words.dump.join("\n")}</pre>` : nothing}
      <p><button type="button" class="quiet bordered" @click=${() => { this.domain = { object: event.object, part: 0, parts: [] }; this.app.redraw(); }}>Save to file</button></p>`;
  }

  private columns(): Columns<ObjectRow> {
    const in_hex = (): boolean => this.app.is_hexadecimal;
    return [
      { headerName: "Object", field: "object", width: 92, cellClass: "figure" },
      { headerName: "Name", colId: "name", flex: 3, minWidth: 180, valueGetter: (p) => (p.data ? full_name(p.data) : ""), tooltipValueGetter: (p) => (p.data ? full_name(p.data) : "") },
      { headerName: "Value", colId: "value", width: 150, cellClass: "figure", valueGetter: (p) => (p.data ? value_text(p.data, in_hex()) : "") },
      { headerName: "In words", colId: "words", flex: 3, minWidth: 160, valueGetter: (p) => (p.data ? object_words(p.data) : ""), tooltipValueGetter: (p) => (p.data ? object_words(p.data) : "") },
      { headerName: "Default", colId: "default", width: 110, cellClass: "figure", valueGetter: (p) => (p.data ? default_text(p.data, in_hex()) : "") },
      { headerName: "Type", field: "type", width: 132 },
      { headerName: "Access", field: "access", width: 76 },
    ];
  }

  private other(): TemplateResult {
    const { node, sdo } = this;
    if (!node) return html`<p class="faint">Choose a node.</p>`;
    if (!this.app.store.joins(node.bus)) return html`<p class="faint">Commands cannot join the bus ${node.bus}.</p>`;
    const set = (field: "object" | "type" | "value") => (event: Event): void => { sdo[field] = (event.target as HTMLInputElement).value; };
    const read = async (): Promise<void> => {
      const done = await this.app.connection.commands.run({ command: "sdo read", bus: node.bus, node: String(node.node), object: sdo.object.trim(), ...(sdo.type ? { type: sdo.type } : {}) });
      const row = done.rows[0] as { object?: string; value?: unknown; bytes?: string; reason?: string } | undefined;
      Object.assign(sdo, { mood: done.code === 0 ? "" : "bad", said: row?.reason ?? (done.code === 0 && row ? `${row.object} = ${row.value ?? row.bytes}` : done.message) });
      this.app.redraw();
    };
    return html`<p class="faint">${label_of(node)} is an external node (not in the plant file): its objects are read one by one, by SDO.</p>
      <form class="tools" @submit=${(event: Event) => { event.preventDefault(); void read(); }}>
        <label class="inline">Object <input class="field" placeholder="1018:02" autocomplete="off" .value=${sdo.object} @input=${set("object")}></label>
        <label class="inline">Type <select class="field" @change=${set("type")}>${["", "bool", "u8", "u16", "u32", "u64", "i8", "i16", "i32", "i64", "f32", "f64", "text", "domain"].map((one) => html`<option value=${one}>${one || "bytes"}</option>`)}</select></label>
        <ix-button type="submit" @click=${() => void read()}>Read by SDO</ix-button>
        ${this.app.store.may_configure ? html`<label class="inline">Value <input class="field" autocomplete="off" .value=${sdo.value} @input=${set("value")}></label><ix-button variant="secondary" @click=${() => void this.write()}>Write by SDO</ix-button>` : nothing}
      </form>${sdo.said ? html`<p role="status" class=${sdo.mood}>${sdo.said}</p>` : nothing}`;
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
      requestAnimationFrame(() => document.querySelector<DataGrid>("#objects-grid")?.grid?.refreshCells({ force: true }));
    }
    const buses = [...new Set(nodes.map((one) => one.bus))];
    return html`${head("Objects", node && node.place >= 0 ? count_text(rows.count, "sub-index", "sub-indexes") : "")}
      <div class="tools">
        <label class="inline">Node <select class="field" id="objects-node" @change=${(event: Event) => { const [bus = "", id = ""] = (event.target as HTMLSelectElement).value.split("/"); app.go("objects", [bus, id]); }}>
          ${buses.map((bus) => html`<optgroup label=${bus}>${nodes.filter((one) => one.bus === bus).map((one) => html`<option value=${`${one.bus}/${one.node}`} ?selected=${one.key === node?.key}>${id_of(one)} ${label_of(one)}</option>`)}</optgroup>`)}</select></label>
        <input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Name or index" autocomplete="off" spellcheck="false" maxlength="100" .value=${rows.find} @input=${(event: Event) => this.set_find((event.target as HTMLInputElement).value)}>
        <label class="inline"><input type="checkbox" .checked=${app.is_hexadecimal} @change=${(event: Event) => { app.is_hexadecimal = (event.target as HTMLInputElement).checked; app.redraw(); }}>Hexadecimal</label>
      </div>
      ${node && node.place >= 0 ? guard([node.key], () => html`<data-grid id="objects-grid" .label=${"Objects"} .empty=${"No object with this name or index"} .columns=${this.columns()} .source=${rows}
        .row_classes=${{ "row-chosen": (row: ObjectRow) => row.object === this.chosen }} .chosen=${(row: ObjectRow) => this.choose(row)} .opened=${() => document.querySelector<HTMLElement>("#object-value")?.focus()}></data-grid>`) : this.other()}`;
  }
}
