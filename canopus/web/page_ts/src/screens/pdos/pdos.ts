// PDOs of a project: producers and consumers, the list with its frames, an editor with the bit strip, and signals that are linked by dragging.
import { html, nothing, svg, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconTable } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { choose_bus } from "../../parts/choose_bus.js";
import type { Columns } from "../../parts/grid.js";
import { no_project } from "../../parts/no_project.js";
import { count_text, percent_text } from "../../store/nodes.js";
import type { Pdo, Project, ProjectObject } from "../../store/project.js";
import { transmission_words } from "../../store/value_words.js";
import { bits_of, can_id_text, crossings_of, linked_text, mappable, mapped_text, refusal, sent_text, short } from "./pdo_words.js";

type Part = "list" | "matrix" | "link";
const parts: [Part, string][] = [["list", "List"], ["matrix", "Producers and consumers"], ["link", "Link signals"]];

interface Edited {
  pdo: Pdo;
  can_id: string;
  type: string;
  inhibit: string;
  event: string;
  items: string[];
  find: string;
}

export class PdosScreen implements Screen {
  readonly id = "pdos";
  readonly title = "PDOs";
  readonly icon = iconTable;
  private bus: string | undefined;
  private part: Part = "list";
  private node: number | null = null;
  private find = "";
  private with_disabled = false;
  private edited: Edited | null = null;
  private from: number | null = null;
  private to: number | null = null;
  private finds = ["", ""];
  private taken: ProjectObject | null = null;
  private refused = "";
  private refused_at: [number, number] = [0, 0];
  private preview: Record<string, unknown>[] | null = null;
  private linking: { command: string; from: string; to: string } | null = null;
  private rows: readonly Pdo[] = [];
  private made_of: unknown[] = [];

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    this.bus = route.path[0] ?? this.bus;
    this.part = parts.find(([part]) => part === route.path[1])?.[0] ?? "list";
    this.node = route.query["node"] ? Number(route.query["node"]) : null;
    this.find = route.query["find"] ?? "";
  }

  private edit(pdo: Pdo): void {
    this.edited = { pdo, can_id: pdo.active ? `0x${pdo.can_id.toString(16).toUpperCase()}` : "free", type: String(pdo.transmission_type), inhibit: pdo.inhibit_us === undefined ? "" : `${pdo.inhibit_us / 1000}ms`, event: pdo.event_ms === undefined ? "" : `${pdo.event_ms}ms`,
      items: pdo.mapping.flatMap((one) => (one.object ? [one.object] : [])), find: "" };
    this.app.redraw();
  }

  private async apply(project: Project, edited: Edited): Promise<void> {
    const { pdo } = edited;
    const items = edited.items.join() === pdo.mapping.flatMap((one) => (one.object ? [one.object] : [])).join() ? {} : { items: edited.items };
    const done = await this.app.change(project, { command: "project pdo map", node: String(pdo.node), pdo: pdo.pdo, can_id: edited.can_id.trim(), type: edited.type.trim(), ...(pdo.inhibit_us === undefined ? {} : { inhibit: edited.inhibit.trim() }), ...(pdo.event_ms === undefined ? {} : { event: edited.event.trim() }), ...items }, `${pdo.pdo} of ${project.label(pdo.node)} changed`);
    if (!done.failed) this.edited = null;
    this.app.redraw();
  }

  /** The 64 bits of a frame: one block for each mapped object. */
  private strip(mapping: readonly { bit: number; bits: number; name?: string; object?: string }[]): TemplateResult {
    return html`<svg class="frame-strip" viewBox="0 0 64 6" preserveAspectRatio="none" role="img" aria-label=${mapping.map((one) => `${short(one)} ${one.bits} bits`).join(", ") || "nothing is mapped"}>
      ${svg`<rect width="64" height="6" class="track"/>`}${mapping.map((one, i) => svg`<rect x=${one.bit} y="0" width=${one.bits} height="6" class=${one.object ? `signal-${i % 6}` : "unused"}><title>${short(one)}: bits ${one.bit} to ${one.bit + one.bits - 1}</title></rect>`)}${[8, 16, 24, 32, 40, 48, 56].map((x) => svg`<line x1=${x} x2=${x} y1="0" y2="6"/>`)}</svg>`;
  }

  private editor(project: Project, edited: Edited): TemplateResult {
    const { pdo } = edited;
    void project.load_objects(pdo.node);
    const kind = pdo.pdo.startsWith("T") ? "tpdo" : "rpdo";
    const objects = project.objects.get(pdo.node);
    let bit = 0;
    const mapping = edited.items.map((object) => {
      const known = objects?.find((row) => row.object === object);
      const size = known ? bits_of(known.type) ?? 8 : pdo.mapping.find((one) => one.object === object)?.bits ?? 8;
      const name = known?.name ?? pdo.mapping.find((one) => one.object === object)?.name;
      const one = { bit, bits: size, object, ...(name === undefined ? {} : { name }) };
      bit += size;
      return one;
    });
    const found = mappable(objects, kind, edited.find);
    const set = (field: "can_id" | "type" | "inhibit" | "event" | "find") => (event: Event): void => { edited[field] = (event.target as HTMLInputElement).value; this.app.redraw(); };
    const field = (label: string, name: "can_id" | "type" | "inhibit" | "event", hint: string, off = false): TemplateResult => html`<label class="stacked"><span>${label}</span><input class="field" autocomplete="off" placeholder=${hint} .value=${edited[name]} ?disabled=${off} @input=${set(name)}></label>`;
    return html`<section class="panel editor" aria-label=${`${pdo.pdo} of ${project.label(pdo.node)}`}><div class="tools"><h2>${project.label(pdo.node)}, ${pdo.pdo}</h2><span class=${bit > 64 ? "bad" : "faint"}>${bit} of 64 bits</span><span class="grows"></span>
        <ix-button ?disabled=${bit > 64} @click=${() => void this.apply(project, edited)}>Apply</ix-button><ix-button variant="secondary" @click=${() => { this.edited = null; this.app.redraw(); }}>Cancel</ix-button></div>
      <div class="form-grid">${field("CAN-ID", "can_id", "0x181, or free")}${field(`Transmission type: ${transmission_words(Number(edited.type))}`, "type", "0 to 240, 252 to 255")}${field("Inhibit time", "inhibit", "10ms", pdo.inhibit_us === undefined)}${field("Event timer", "event", "100ms", pdo.event_ms === undefined)}</div>
      ${this.strip(mapping)}
      <div class="halves"><div><h3>Mapped</h3><ol class="picks">${mapping.map((one, i) => html`<li><span><b>${one.object}</b> ${short(one)} <span class="faint">${one.bits} bits</span></span>
          <span><button type="button" class="quiet" title=${`Move ${short(one)} up`} ?disabled=${i === 0} @click=${() => { edited.items.splice(i - 1, 0, ...edited.items.splice(i, 1)); this.app.redraw(); }}>↑</button><button type="button" class="quiet" aria-label=${`Remove ${short(one)}`} @click=${() => { edited.items.splice(i, 1); this.app.redraw(); }}>Remove</button></span></li>`)}${mapping.length === 0 ? html`<li class="faint">Nothing is mapped</li>` : nothing}</ol></div>
        <div><h3>Can be mapped <span class="faint">${found.length}</span></h3><input class="field full" type="search" aria-label="Search objects that can be mapped" placeholder="Name, index or type" .value=${edited.find} @input=${set("find")}><ul class="picks">${found.map((row) => html`<li><span><b>${row.object}</b> ${short(row)} <span class="faint">${row.type}</span></span><button type="button" class="quiet" aria-label=${`Add ${row.object} ${short(row)}`} @click=${() => { edited.items.push(row.object); this.app.redraw(); }}>Add</button></li>`)}${found.length === 0 ? html`<li class="faint">${objects ? "Nothing found" : "Reading …"}</li>` : nothing}</ul></div></div></section>`;
  }

  private columns(project: Project): Columns<Pdo> {
    return [
      { headerName: "Node", colId: "node", width: 170, valueGetter: (p) => (p.data ? project.label(p.data.node) : ""), comparator: (_a, _b, a, b) => (a.data?.node ?? 0) - (b.data?.node ?? 0) },
      { headerName: "PDO", field: "pdo", width: 84 },
      { headerName: "CAN-ID", colId: "id", width: 88, cellClass: "figure", valueGetter: (p) => (p.data ? (p.data.active ? can_id_text(p.data.can_id) : "disabled") : "") },
      { headerName: "Bytes", field: "bytes", width: 70, cellClass: "figure" },
      { headerName: "Transmission", colId: "sent", width: 190, valueGetter: (p) => (p.data ? sent_text(p.data) : ""), tooltipValueGetter: (p) => (p.data ? sent_text(p.data) : "") },
      { headerName: "Mapped", colId: "mapped", flex: 1, minWidth: 160, valueGetter: (p) => (p.data ? mapped_text(p.data) : ""), tooltipValueGetter: (p) => (p.data ? mapped_text(p.data) : "") },
      { headerName: "Linked to", colId: "linked", flex: 1, minWidth: 140, valueGetter: (p) => (p.data ? linked_text(p.data, project) : ""), tooltipValueGetter: (p) => (p.data ? linked_text(p.data, project) : "") },
    ];
  }

  private describe(project: Project, pdo: Pdo): void {
    const off = !this.app.store.may_configure;
    this.app.describe({ title: `${pdo.pdo} of ${project.label(pdo.node)}`, rows: [["CAN-ID", pdo.active ? can_id_text(pdo.can_id) : "disabled"], ["Transmission", sent_text(pdo)], ["Length", count_text(pdo.bytes, "byte")], ["Linked to", linked_text(pdo, project)]],
      more: () => html`${this.strip(pdo.mapping)}<table class="rows"><tbody>${pdo.mapping.map((one) => html`<tr><td class="figure">${one.bit}–${one.bit + one.bits - 1}</td><td>${one.object ?? ""}</td><td>${short(one)}</td></tr>`)}</tbody></table>
        <p class="buttons"><ix-button ?disabled=${off} @click=${() => this.edit(pdo)}>Change …</ix-button>${pdo.active ? html`<ix-button variant="secondary" ?disabled=${off} @click=${() => void this.app.change(project, { command: "project pdo off", node: String(pdo.node), pdo: pdo.pdo }, `${pdo.pdo} of ${project.label(pdo.node)} disabled`)}>Disable</ix-button>` : nothing}
        <a href=${link("trace", [], { filter: `id=${can_id_text(pdo.can_id).slice(0, -1)}` })}>Frames</a></p>` }, true);
  }

  private list(project: Project): TemplateResult {
    const made_of = [project.pdos, this.with_disabled, this.find, this.node];
    if (made_of.some((one, i) => one !== this.made_of[i])) {
      this.made_of = made_of;
      const terms = this.find.toLowerCase().split(/\s+/).filter(Boolean);
      this.rows = project.pdos.filter((pdo) => (pdo.active || this.with_disabled) && (this.node === null || pdo.node === this.node) && terms.every((term) => `${project.label(pdo.node)} ${pdo.pdo} ${can_id_text(pdo.can_id)} ${mapped_text(pdo)} ${linked_text(pdo, project)}`.toLowerCase().includes(term)));
    }
    requestAnimationFrame(() => { const grid = document.querySelector<HTMLElement & { rows: readonly Pdo[] }>("#pdo-grid"); if (grid) grid.rows = this.rows; });
    return html`<div class="tools"><input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Node, PDO, CAN-ID or signal" autocomplete="off" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; this.app.keep("pdos", [project.bus.bus], { find: this.find, ...(this.node === null ? {} : { node: this.node }) }); this.app.redraw(); }}>
        <label class="inline"><input type="checkbox" .checked=${this.with_disabled} @change=${(event: Event) => { this.with_disabled = (event.target as HTMLInputElement).checked; this.app.redraw(); }}>Show disabled PDOs</label><span class="faint">${count_text(this.rows.length, "PDO")}</span></div>
      ${guard([project.bus.bus], () => html`<data-grid id="pdo-grid" .label=${"PDOs"} .empty=${"No PDO matches"} .columns=${this.columns(project)} .rows=${this.rows} .row_id=${(pdo: Pdo) => `${pdo.node} ${pdo.pdo}`} .row_classes=${{ "row-faint": (pdo: Pdo) => !pdo.active }} .chosen=${(pdo: Pdo) => this.describe(project, pdo)} .opened=${(pdo: Pdo) => this.edit(pdo)}></data-grid>`)}`;
  }

  private matrix(project: Project): TemplateResult {
    const all = crossings_of(project.pdos);
    if (all.length === 0) return html`<ix-empty-state header="No signal goes from one node to another" sub-header="Link signals shows what each node can send and take"></ix-empty-state>`;
    const [from, to] = [[...new Set(all.map((one) => one.from))].sort((a, b) => a - b), [...new Set(all.map((one) => one.to))].sort((a, b) => a - b)];
    return html`<div class="scrolls" tabindex="0" role="region" aria-label="Producers and consumers"><table class="rows matrix"><thead><tr><th scope="col">Producer</th>${to.map((id) => html`<th scope="col">${project.label(id)}</th>`)}</tr></thead>
      <tbody>${from.map((id) => html`<tr><th scope="row">${project.label(id)}</th>${to.map((end) => html`<td>${all.filter((one) => one.from === id && one.to === end).map((one) => html`<div title=${sent_text(one.pdo)}>${one.name} <span class="faint">${one.pdo.pdo} ${can_id_text(one.pdo.can_id)}</span></div>`)}</td>`)}</tr>`)}</tbody></table></div>`;
  }

  private async try_link(project: Project, to: ProjectObject, at: [number, number]): Promise<void> {
    const from = this.taken;
    if (!from) return;
    this.refused_at = at;
    this.refused = refusal(from, to);
    if (this.refused) return this.app.redraw();
    this.linking = { command: "project pdo link", from: `${from.node}.${from.object}`, to: `${to.node}.${to.object}` };
    const done = await this.app.run({ ...this.linking, bus: project.bus.bus, dry_run: true }, { done: "" });
    if (done.failed) this.refused = done.message;
    else if (done.rows.every((row) => row["pdo"] === undefined)) this.refused = "it is linked already";
    else this.preview = done.rows;
    this.app.redraw();
    if (this.preview) requestAnimationFrame(() => document.querySelector<HTMLElement>("#link-apply")?.focus());
  }

  /** It stays for a moment, so that it can be read when the mouse button was released. */
  private forget_refusal(): void {
    const text = this.refused;
    setTimeout(() => {
      if (this.refused !== text) return;
      this.refused = "";
      this.app.redraw();
    }, 2500);
  }

  private signals(project: Project, side: 0 | 1): TemplateResult {
    const id = side === 0 ? this.from : this.to;
    const found = id === null ? [] : mappable(project.objects.get(id), side === 0 ? "tpdo" : "rpdo", this.finds[side] ?? "");
    const off = !this.app.store.may_configure;
    const label = side === 0 ? "Producer" : "Consumer";
    return html`<div class="half"><div class="tools"><label class="inline">${label} <select class="field" @change=${(event: Event) => { const value = Number((event.target as HTMLSelectElement).value); if (side === 0) this.from = value; else this.to = value; if (side === 0) this.taken = null; this.app.redraw(); }}>${project.nodes.map((one) => html`<option value=${one.node} ?selected=${one.node === id}>${project.label(one.node)}</option>`)}</select></label>
        <input class="field grows" type="search" aria-label=${`Search signals of the ${label.toLowerCase()}`} placeholder="Search" .value=${this.finds[side] ?? ""} @input=${(event: Event) => { this.finds[side] = (event.target as HTMLInputElement).value; this.app.redraw(); }}><span class="faint">${found.length}</span></div>
      <ul class="picks scrolls">${found.map((row) => {
        const why = side === 1 && this.taken ? refusal(this.taken, row) : "";
        return html`<li><button type="button" class="signal-button" draggable=${side === 0 && !off} ?disabled=${off} aria-pressed=${side === 0 ? this.taken?.object === row.object : nothing} title=${why || row.name} data-refused=${why ? "" : nothing}
          @dragstart=${(event: DragEvent) => { if (side === 0) { this.taken = row; event.dataTransfer?.setData("text/plain", row.object); this.app.redraw(); } }}
          @dragover=${(event: DragEvent) => { if (side === 1 && this.taken) { event.preventDefault(); if (event.dataTransfer) event.dataTransfer.dropEffect = why ? "none" : "link"; this.refused = why; this.refused_at = [event.clientX, event.clientY]; this.app.redraw(); } }}
          @dragleave=${() => this.forget_refusal()}
          @drop=${(event: DragEvent) => { event.preventDefault(); void this.try_link(project, row, [event.clientX, event.clientY]); }}
          @click=${(event: MouseEvent) => { if (side === 0) { this.taken = row; this.refused = ""; this.app.redraw(); } else void this.try_link(project, row, [event.clientX, event.clientY]); }}><b>${row.object}</b> <span>${short(row)}</span> <span class="faint">${row.type}</span></button></li>`;
      })}${found.length === 0 ? html`<li class="faint">${id !== null && project.objects.has(id) ? "Nothing that can be mapped" : "Reading …"}</li>` : nothing}</ul></div>`;
  }

  private link_part(project: Project): TemplateResult {
    const able = project.nodes.filter((node) => node.tpdos !== undefined);
    if (this.from === null || !project.node(this.from)) this.from = able.find((node) => node.tpdos)?.node ?? able[0]?.node ?? null;
    if (this.to === null || !project.node(this.to)) this.to = able.find((node) => node.node !== this.from && node.rpdos)?.node ?? able.find((node) => node.node !== this.from)?.node ?? null;
    for (const id of [this.from, this.to]) if (id !== null) void project.load_objects(id);
    const dry = this.preview?.find((row) => row["event"] === "dry run");
    const changed = (this.preview ?? []).filter((row) => row["pdo"] !== undefined) as unknown as Pdo[];
    // The sender's PDO may stay as it is; it is shown all the same.
    const sender = project.pdos.find((pdo) => pdo.node === this.taken?.node && pdo.pdo.startsWith("T") && pdo.active && changed.some((one) => one.can_id === pdo.can_id && one.pdo !== pdo.pdo));
    if (sender && !changed.some((one) => one.node === sender.node && one.pdo === sender.pdo)) changed.unshift(sender);
    return html`<p class="faint">${this.taken ? html`<b>${short(this.taken)}</b> of ${project.label(this.taken.node)}: drop it on a signal of the consumer, or choose one there.` : "Drag a signal of the producer onto one of the consumer, or choose both. CAN-ID and both mappings are computed."}</p>
      ${this.preview ? html`<section class="panel" aria-label="This will change"><h2>This will change</h2><table class="rows"><tbody>${changed.map((pdo) => html`<tr><th scope="row">${project.label(pdo.node)}</th><td>${pdo.pdo}</td><td>${can_id_text(pdo.can_id)}</td><td>${sent_text(pdo)}</td><td>${mapped_text(pdo)}</td></tr>`)}</tbody></table>
        ${dry ? html`<p>Load ${percent_text(Number(dry["load"]))} by timers and SYNC (now ${percent_text(Number(dry["load_before"]))}), ${percent_text(Number(dry["load_at_most"]))} at most (now ${percent_text(Number(dry["load_at_most_before"]))})</p>` : nothing}
        <p class="buttons"><ix-button id="link-apply" @click=${async () => { const wish = this.linking; this.preview = null; this.taken = null; if (wish) await this.app.change(project, wish, "linked"); }}>Apply</ix-button><ix-button variant="secondary" @click=${() => { this.preview = null; this.app.redraw(); }}>Discard</ix-button></p></section>` : nothing}
      <div class="halves grows">${this.signals(project, 0)}${this.signals(project, 1)}</div>
      ${this.refused ? html`<div class="refused" role="alert" .style=${`left:${Math.min(this.refused_at[0] + 12, innerWidth - 260)}px;top:${this.refused_at[1] + 16}px`}>${this.refused}</div>` : nothing}`;
  }

  view(): TemplateResult {
    const { app } = this;
    const project = app.project_of(this.bus);
    if (!project) return html`${head("PDOs", "")}${no_project(app)}`;
    const { network } = project;
    return html`${head("PDOs", network ? `load ${percent_text(network.load)} by timers and SYNC, ${percent_text(network.load_at_most)} at most` : "")}
      <div class="tools">${choose_bus(app, "pdos", project)}<div class="parts" role="group" aria-label="What is shown">${parts.map(([part, title]) => html`<a href=${link("pdos", part === "list" ? [project.bus.bus] : [project.bus.bus, part])} aria-current=${part === this.part ? "page" : nothing}>${title}</a>`)}</div>
        ${this.node === null ? nothing : html`<a href=${link("pdos", [project.bus.bus])}>Only ${project.label(this.node)} ×</a>`}</div>
      ${this.edited ? this.editor(project, this.edited) : nothing}
      ${this.part === "list" ? this.list(project) : this.part === "matrix" ? this.matrix(project) : this.link_part(project)}`;
  }
}
