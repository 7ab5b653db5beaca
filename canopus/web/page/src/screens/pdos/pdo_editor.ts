// Changes one PDO of a project: CAN-ID, transmission, times, and what is mapped, by a picker with search or by dragging.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { count_text } from "../../store/nodes.js";
import type { Mapped, Pdo, Project, ProjectObject } from "../../store/project.js";
import { transmission_words } from "../../store/value_words.js";
import { frame_strip } from "./frame_strip.js";
import { bits_of, mappable, short } from "./pdo_words.js";
import { RefusalTip } from "./refusal_tip.js";

const most_bits = 64;
const in_sight = 300;

interface Edited {
  pdo: Pdo;
  can_id: string;
  type: string;
  inhibit: string;
  event: string;
  items: string[];
  find: string;
}

/** Why an object cannot be mapped behind `bits` bits; an empty text: it can. */
export function mapping_refusal(bits: number, row: ProjectObject): string {
  const size = bits_of(row.type);
  if (size === null) return `${row.type} has no fixed size and cannot be mapped`;
  return bits + size > most_bits ? `${count_text(size, "bit does", "bits do")} not fit: ${most_bits - bits} of ${most_bits} bits are free` : "";
}

export class PdoEditor {
  private edited: Edited | null = null;
  private dragged: ProjectObject | null = null;
  private readonly tip: RefusalTip;

  constructor(private readonly app: App) {
    this.tip = new RefusalTip(app);
  }

  open(pdo: Pdo): void {
    this.edited = { pdo, can_id: pdo.active ? `0x${pdo.can_id.toString(16).toUpperCase()}` : "free", type: String(pdo.transmission_type), inhibit: pdo.inhibit_us === undefined ? "" : `${pdo.inhibit_us / 1000}ms`, event: pdo.event_ms === undefined ? "" : `${pdo.event_ms}ms`,
      items: pdo.mapping.flatMap((one) => (one.object ? [one.object] : [])), find: "" };
    this.app.describe(null);
  }

  get is_open(): boolean {
    return this.edited !== null;
  }

  close(): void {
    this.edited = null;
    this.app.redraw();
  }

  private async apply(project: Project, edited: Edited): Promise<void> {
    const { pdo } = edited;
    const items = edited.items.join() === pdo.mapping.flatMap((one) => (one.object ? [one.object] : [])).join() ? {} : { items: edited.items };
    const done = await this.app.change(project, { command: "project pdo map", node: String(pdo.node), pdo: pdo.pdo, can_id: edited.can_id.trim(), type: edited.type.trim(), ...(pdo.inhibit_us === undefined ? {} : { inhibit: edited.inhibit.trim() }), ...(pdo.event_ms === undefined ? {} : { event: edited.event.trim() }), ...items }, `${pdo.pdo} of ${project.label(pdo.node)} changed`);
    if (!done.failed) this.edited = null;
    this.app.redraw();
  }

  private mapping(edited: Edited, objects: readonly ProjectObject[] | undefined): { mapping: Mapped[]; bits: number } {
    let bit = 0;
    const mapping = edited.items.map((object): Mapped => {
      const known = objects?.find((row) => row.object === object);
      const before = edited.pdo.mapping.find((one) => one.object === object);
      const name = known?.name ?? before?.name;
      const one = { bit, bits: (known && bits_of(known.type)) ?? before?.bits ?? 8, object, ...(name === undefined ? {} : { name }) };
      bit += one.bits;
      return one;
    });
    return { mapping, bits: bit };
  }

  private add(edited: Edited, row: ProjectObject, bits: number, at: [number, number] | null): void {
    const why = mapping_refusal(bits, row);
    if (why && at) return this.tip.show(why, ...at);
    if (why) return this.app.say(why, "error");
    edited.items.push(row.object);
    this.app.redraw();
  }

  private move(edited: Edited, from: number, to: number): void {
    edited.items.splice(to, 0, ...edited.items.splice(from, 1));
    this.app.redraw();
  }

  private mapped_part(edited: Edited, mapping: readonly Mapped[], bits: number): TemplateResult {
    return html`<div @dragover=${(event: DragEvent) => { if (!this.dragged) return; event.preventDefault(); const why = mapping_refusal(bits, this.dragged); if (event.dataTransfer) event.dataTransfer.dropEffect = why ? "none" : "copy"; if (why) this.tip.show(why, event.clientX, event.clientY); }}
        @drop=${(event: DragEvent) => { event.preventDefault(); if (this.dragged) this.add(edited, this.dragged, bits, [event.clientX, event.clientY]); this.dragged = null; }}>
      <h3>Mapped</h3><ol class="picks">${mapping.map((one, i) => html`<li><span><span class=${`swatch signal-${i % 6}`}></span><b>${one.object}</b> ${short(one)} <span class="faint">${one.bits} bits</span></span>
        <span class="keep"><button type="button" class="quiet" aria-label=${`Move ${short(one)} up`} title="Move up" ?disabled=${i === 0} @click=${() => this.move(edited, i, i - 1)}>↑</button><button type="button" class="quiet" aria-label=${`Remove ${short(one)}`} @click=${() => { edited.items.splice(i, 1); this.app.redraw(); }}>Remove</button></span></li>`)}
        ${mapping.length === 0 ? html`<li class="faint">Nothing is mapped: add an object, or drag it here.</li>` : nothing}</ol></div>`;
  }

  private picker(edited: Edited, objects: readonly ProjectObject[] | undefined, bits: number): TemplateResult {
    const found = mappable(objects, edited.pdo.pdo.startsWith("T") ? "tpdo" : "rpdo", edited.find);
    return html`<div><h3>Can be mapped <span class="faint">${found.length}</span></h3>
      <input class="field full" type="search" id="pdo-find" aria-label="Search objects that can be mapped" placeholder="Name, index or type" .value=${edited.find} @input=${(event: Event) => { edited.find = (event.target as HTMLInputElement).value; this.app.redraw(); }}>
      <ul class="picks">${found.slice(0, in_sight).map((row) => html`<li draggable="true" class="grabbed" @dragstart=${(event: DragEvent) => { this.dragged = row; event.dataTransfer?.setData("text/plain", row.object); }} @dragend=${() => { this.dragged = null; }}><span><b>${row.object}</b> ${short(row)} <span class="faint">${row.type}</span></span>
          <button type="button" class="quiet" title=${mapping_refusal(bits, row) || nothing} aria-label=${`Add ${row.object} ${short(row)}`} @click=${() => this.add(edited, row, bits, null)}>Add</button></li>`)}
        ${found.length > in_sight ? html`<li class="faint">${found.length - in_sight} more: search for one of them</li>` : nothing}${found.length === 0 ? html`<li class="faint">${objects ? "Nothing found" : "Reading …"}</li>` : nothing}</ul></div>`;
  }

  view(project: Project): TemplateResult | typeof nothing {
    const { edited } = this;
    if (!edited) return nothing;
    const { pdo } = edited;
    void project.load_objects(pdo.node);
    const objects = project.objects.get(pdo.node);
    const { mapping, bits } = this.mapping(edited, objects);
    const field = (label: string, name: "can_id" | "type" | "inhibit" | "event", hint: string, off = false): TemplateResult => html`<label class="stacked"><span>${label}</span><input class="field" autocomplete="off" placeholder=${hint} .value=${edited[name]} ?disabled=${off} @input=${(event: Event) => { edited[name] = (event.target as HTMLInputElement).value; this.app.redraw(); }}></label>`;
    return html`<section class="panel editor" aria-label=${`${pdo.pdo} of ${project.label(pdo.node)}`}><div class="tools"><h2>${project.label(pdo.node)}, ${pdo.pdo}</h2><span class=${bits > most_bits ? "bad" : "faint"}>${bits} of ${most_bits} bits</span><span class="grows"></span>
        <ix-button id="pdo-apply" ?disabled=${bits > most_bits} @click=${() => void this.apply(project, edited)}>Apply</ix-button><ix-button variant="secondary" @click=${() => this.close()}>Cancel</ix-button></div>
      <div class="form-grid">${field("CAN-ID", "can_id", "0x181, or free")}${field(`Transmission type: ${transmission_words(Number(edited.type))}`, "type", "0 to 240, 252 to 255")}${field("Inhibit time", "inhibit", "10ms", pdo.inhibit_us === undefined)}${field("Event timer", "event", "100ms", pdo.event_ms === undefined)}</div>
      ${frame_strip(mapping)}
      <div class="halves">${this.mapped_part(edited, mapping, bits)}${this.picker(edited, objects, bits)}</div></section>${this.tip.view()}`;
  }
}
