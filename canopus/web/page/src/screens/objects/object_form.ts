// An object in the description: its bits by their names, the form that writes it, and a DOMAIN in words.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { without_options } from "../../store/commands.js";
import { save_file } from "../../parts/save_file.js";
import { submit_button } from "../../parts/submit_button.js";
import type { ShownNode } from "../../store/nodes.js";
import type { DomainWords, ObjectRow, ViewWish } from "../../store/protocol.js";
import { named_bits, sdo_type } from "../../store/value_words.js";
import { is_writable } from "./object_text.js";

const types = ["bool", "u8", "u16", "u32", "u64", "i8", "i16", "i32", "i64", "f32", "f64", "text", "bytes", "domain"];

export function bits_view(row: ObjectRow): TemplateResult | typeof nothing {
  const bits = row.decimal === undefined ? [] : named_bits(row.object, Number(row.decimal));
  if (bits.length === 0) return nothing;
  return html`<h3>Bits</h3><ul class="named-bits">${bits.map((one) => html`<li data-on=${one.is_on ? "" : nothing}><span class="number-of-bit">${one.bit}</span><span class="state-of-bit">${one.is_on ? "1" : "0"}</span><span>${one.name}</span></li>`)}</ul>`;
}

/** Reads and writes one object of a node by SDO. */
export class ObjectForm {
  object = "";
  type = "";
  value = "";
  said = "";
  private mood = "";

  constructor(private readonly app: App) {}

  begin(row: ObjectRow): void {
    Object.assign(this, { object: row.object, type: sdo_type(row.type), value: "", said: "", mood: "" });
  }

  may_write(node: ShownNode, row: ObjectRow): boolean {
    return is_writable(row) && this.app.store.may_configure && this.app.store.joins(node.bus);
  }

  private async ask(node: ShownNode, command: "sdo read" | "sdo write"): Promise<void> {
    const value = this.value.trim();
    if (command === "sdo write" && value === "") return;
    const done = await this.app.connection.commands.run({ command, bus: node.bus, node: String(node.node), object: this.object.trim(), ...(command === "sdo write" ? { value } : {}), ...(this.type ? { type: this.type } : {}) });
    const row = done.rows[0] as { object?: string; value?: unknown; bytes?: string; reason?: string } | undefined;
    const is_good = done.code === 0;
    this.mood = is_good ? "" : "bad";
    this.said = is_good ? (command === "sdo read" ? `${row?.object ?? this.object} = ${String(row?.value ?? row?.bytes ?? "")}` : `${this.object} = ${value} written`) : without_options(row?.reason ?? done.message) || `failed with code ${done.code}`;
    if (is_good && command === "sdo write") this.value = "";
    this.app.redraw();
  }

  private types(): TemplateResult {
    return html`<select class="field" aria-label="Type" @change=${(event: Event) => { this.type = (event.target as HTMLSelectElement).value; this.app.redraw(); }}>${["", ...types].map((one) => html`<option value=${one} ?selected=${one === this.type}>${one || "type"}</option>`)}</select>`;
  }

  /** In the description, of the chosen row. */
  view(node: ShownNode, row: ObjectRow, others: unknown): TemplateResult {
    if (!this.may_write(node, row)) return html`<p class="buttons">${others}</p>`;
    const write = (): void => void this.ask(node, "sdo write");
    return html`<form class="write" @submit=${(event: Event) => { event.preventDefault(); write(); }}>
      <label class="stacked"><span>New value (${row.type})</span><input class="field" id="object-value" autocomplete="off" spellcheck="false" placeholder=${row.decimal ?? "text or bytes"} .value=${this.value} @input=${(event: Event) => { this.value = (event.target as HTMLInputElement).value; }}></label>
      <p class="buttons">${submit_button("Write by SDO")}${sdo_type(row.type) ? nothing : this.types()}${others}</p>
      ${this.said ? html`<p role="status" class=${this.mood}>${this.said}</p>` : nothing}</form>`;
  }

  /** Of a node whose dictionary is not known. */
  alone(node: ShownNode): TemplateResult {
    const set = (field: "object" | "value") => (event: Event): void => { this[field] = (event.target as HTMLInputElement).value; };
    return html`<form class="tools" @submit=${(event: Event) => { event.preventDefault(); void this.ask(node, "sdo read"); }}>
        <label class="inline">Object <input class="field" placeholder="1018:02" autocomplete="off" .value=${this.object} @input=${set("object")}></label>
        <label class="inline">Type ${this.types()}</label>
        ${submit_button("Read by SDO")}
        ${this.app.store.may_configure ? html`<label class="inline">Value <input class="field" autocomplete="off" .value=${this.value} @input=${set("value")}></label><ix-button variant="secondary" @click=${() => void this.ask(node, "sdo write")}>Write by SDO</ix-button>` : nothing}
      </form>${this.said ? html`<p role="status" class=${this.mood}>${this.said}</p>` : nothing}`;
  }
}

/** A DOMAIN or another long value in words, and as a file, part by part. */
export class DomainPart {
  private chosen: { object: string; part: number | null; parts: Uint8Array<ArrayBuffer>[] } | null = null;

  constructor(private readonly app: App) {
    app.store.listen((event) => { if (event?.event === "domain") this.take(); });
  }

  choose(row: ObjectRow | null): void {
    this.chosen = row && (row.type === "DOMAIN" || (row.bytes ?? 0) > 64) ? { object: row.object, part: null, parts: [] } : null;
    this.app.store.forget_view("domain");
  }

  wishes(node: number): ViewWish[] {
    if (!this.chosen) return [];
    return [{ domain: node, object: this.chosen.object, ...(this.chosen.part === null ? {} : { part: this.chosen.part }) }];
  }

  private take(): void {
    const event = this.app.store.view("domain");
    const { chosen } = this;
    if (!event || !chosen || event.object !== chosen.object || chosen.part === null || event.part !== chosen.part) return;
    const bytes = Uint8Array.from((event.hex ?? "").match(/../g) ?? [], (pair) => parseInt(pair, 16));
    chosen.parts.push(bytes);
    chosen.part += bytes.length;
    if (chosen.part < event.size && bytes.length > 0) return;
    save_file(chosen.parts, `${event.bus}-${event.node}-${event.object.replace(":", "-")}.bin`.replace(/[^\w.-]/g, "_"));
    this.chosen = { object: chosen.object, part: null, parts: [] };
  }

  view(): TemplateResult | typeof nothing {
    const event = this.app.store.view("domain");
    if (!this.chosen || !event?.words || event.object !== this.chosen.object) return nothing;
    const words: DomainWords = event.words;
    return html`<h3>${words.heading}</h3>${words.problem ? html`<p class="bad">${words.problem}</p>` : nothing}
      ${words.entries.length ? html`<table class="rows"><tbody>${words.entries.map((one) => html`<tr><th scope="row">${one.object}</th><td>${one.name}</td><td class="figure">${one.value}</td></tr>`)}</tbody></table>` : nothing}
      ${words.dump.length ? html`<pre class="dump" tabindex="0" aria-label="Bytes">${words.dump.join("\n")}</pre>` : nothing}
      <p><button type="button" class="quiet bordered" @click=${() => { this.chosen = { object: event.object, part: 0, parts: [] }; this.app.redraw(); }}>Save to file</button></p>`;
  }
}
