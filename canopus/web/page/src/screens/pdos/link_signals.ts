// Links a signal of one node to one of another, by dragging or by choosing both: what will change is shown before it is kept.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { percent_text } from "../../store/nodes.js";
import type { Pdo, Project, ProjectObject } from "../../store/project.js";
import { can_id_text, mappable, mapped_text, refusal, sent_text, short } from "./pdo_words.js";
import { RefusalTip } from "./refusal_tip.js";

const in_sight = 300;
const sides = [{ label: "Producer", kind: "tpdo" }, { label: "Consumer", kind: "rpdo" }] as const;

export class LinkSignals {
  private nodes: [number | null, number | null] = [null, null];
  private finds: [string, string] = ["", ""];
  private taken: ProjectObject | null = null;
  private preview: Record<string, unknown>[] | null = null;
  private linking: { command: string; from: string; to: string } | null = null;
  private readonly tip: RefusalTip;

  constructor(private readonly app: App) {
    this.tip = new RefusalTip(app);
  }

  private async try_link(project: Project, to: ProjectObject, at: [number, number]): Promise<void> {
    const from = this.taken;
    if (!from) return this.tip.show("choose a signal of the producer first", ...at);
    const why = refusal(from, to);
    if (why) return this.tip.show(why, ...at);
    this.linking = { command: "project pdo link", from: `${from.node}.${from.object}`, to: `${to.node}.${to.object}` };
    const done = await this.app.run({ ...this.linking, bus: project.bus.bus, dry_run: true }, { done: "" });
    if (done.failed) this.tip.show(done.message, ...at);
    else if (done.rows.every((row) => row["pdo"] === undefined)) this.tip.show("it is linked already", ...at);
    else this.preview = done.rows;
    this.app.redraw();
    if (this.preview) requestAnimationFrame(() => document.querySelector<HTMLElement>("#link-apply")?.focus());
  }

  private signal(project: Project, side: 0 | 1, row: ProjectObject): TemplateResult {
    const off = !this.app.store.may_configure;
    const why = side === 1 && this.taken ? refusal(this.taken, row) : "";
    return html`<li><button type="button" class="signal-button" draggable=${side === 0 && !off} ?disabled=${off} aria-pressed=${side === 0 ? this.taken?.object === row.object : nothing} title=${why || row.name} data-refused=${why ? "" : nothing}
      @dragstart=${(event: DragEvent) => { if (side === 1) return; this.taken = row; event.dataTransfer?.setData("text/plain", row.object); this.app.redraw(); }}
      @dragover=${(event: DragEvent) => { if (side === 0 || !this.taken) return; event.preventDefault(); if (event.dataTransfer) event.dataTransfer.dropEffect = why ? "none" : "link"; this.tip.show(why, event.clientX, event.clientY); }}
      @drop=${(event: DragEvent) => { event.preventDefault(); if (side === 1) void this.try_link(project, row, [event.clientX, event.clientY]); }}
      @click=${(event: MouseEvent) => {
        if (side === 1) return void this.try_link(project, row, [event.clientX, event.clientY]);
        this.taken = row;
        this.tip.hide();
      }}><b>${row.object}</b> <span>${short(row)}</span> <span class="faint">${row.type}</span></button></li>`;
  }

  private half(project: Project, side: 0 | 1): TemplateResult {
    const id = this.nodes[side];
    const { label, kind } = sides[side];
    const objects = id === null ? undefined : project.objects.get(id);
    const found = mappable(objects, kind, this.finds[side]);
    return html`<div class="half"><div class="tools"><label class="inline">${label} <select class="field" @change=${(event: Event) => { this.nodes[side] = Number((event.target as HTMLSelectElement).value); if (side === 0) this.taken = null; this.app.redraw(); }}>${project.nodes.map((one) => html`<option value=${one.node} ?selected=${one.node === id}>${project.label(one.node)}</option>`)}</select></label>
        <input class="field grows" type="search" aria-label=${`Search signals of the ${label.toLowerCase()}`} placeholder="Search" .value=${this.finds[side]} @input=${(event: Event) => { this.finds[side] = (event.target as HTMLInputElement).value; this.app.redraw(); }}><span class="faint">${found.length}</span></div>
      <ul class="picks scrolls" id=${side === 0 ? "link-from" : "link-to"}>${found.slice(0, in_sight).map((row) => this.signal(project, side, row))}${found.length > in_sight ? html`<li class="faint">${found.length - in_sight} more: search for one of them</li>` : nothing}
        ${found.length === 0 ? html`<li class="faint">${objects ? "No object can be mapped" : id === null ? "No node" : "Reading …"}</li>` : nothing}</ul></div>`;
  }

  private plan(project: Project, preview: Record<string, unknown>[]): TemplateResult {
    const dry = preview.find((row) => row["event"] === "dry run");
    const changed = preview.filter((row) => row["pdo"] !== undefined) as unknown as Pdo[];
    // The sender's PDO may stay as it is; it is shown all the same.
    const sender = project.pdos.find((pdo) => pdo.node === this.taken?.node && pdo.pdo.startsWith("T") && pdo.active && changed.some((one) => one.can_id === pdo.can_id && one.pdo !== pdo.pdo));
    if (sender && !changed.some((one) => one.node === sender.node && one.pdo === sender.pdo)) changed.unshift(sender);
    const forget = (): void => { this.preview = null; this.taken = null; this.app.redraw(); };
    return html`<section class="panel" id="link-plan" aria-label="This will change"><h2>This will change</h2><table class="rows"><tbody>${changed.map((pdo) => html`<tr><th scope="row">${project.label(pdo.node)}</th><td>${pdo.pdo}</td><td>${can_id_text(pdo.can_id)}</td><td>${sent_text(pdo)}</td><td>${mapped_text(pdo)}</td></tr>`)}</tbody></table>
      ${dry ? html`<p>Load ${percent_text(Number(dry["load"]))} by timers and SYNC (now ${percent_text(Number(dry["load_before"]))}), ${percent_text(Number(dry["load_at_most"]))} at most (now ${percent_text(Number(dry["load_at_most_before"]))})</p>` : nothing}
      <p class="buttons"><ix-button id="link-apply" @click=${async () => { const wish = this.linking; forget(); if (wish) await this.app.change(project, wish, "linked"); }}>Apply</ix-button><ix-button variant="secondary" @click=${forget}>Discard</ix-button></p></section>`;
  }

  view(project: Project): TemplateResult {
    const able = project.nodes.filter((node) => node.tpdos !== undefined);
    const [from, to] = this.nodes;
    if (from === null || !project.node(from)) this.nodes[0] = able.find((node) => node.tpdos)?.node ?? able[0]?.node ?? null;
    if (to === null || !project.node(to)) this.nodes[1] = able.find((node) => node.node !== this.nodes[0] && node.rpdos)?.node ?? able.find((node) => node.node !== this.nodes[0])?.node ?? null;
    for (const id of this.nodes) if (id !== null) void project.load_objects(id);
    return html`<p class="faint">${this.taken ? html`<b>${short(this.taken)}</b> of ${project.label(this.taken.node)}: drop it on a signal of the consumer, or choose one there.` : "Drag a signal of the producer onto one of the consumer, or choose both. CAN-ID and both mappings are computed."}</p>
      ${this.preview ? this.plan(project, this.preview) : nothing}
      <div class="halves grows">${this.half(project, 0)}${this.half(project, 1)}</div>${this.tip.view()}`;
  }
}
