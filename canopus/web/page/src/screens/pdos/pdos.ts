// PDOs of a bus: the list with the buffer memory beside the objects, producers and consumers; of a project the editor, and signals that are linked by dragging.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconTable } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import type { Columns } from "../../parts/grid.js";
import { plot_button } from "../../parts/plot_button.js";
import { DictionaryPdos } from "../../store/dictionary_pdos.js";
import { count_text, percent_text, seconds_text } from "../../store/nodes.js";
import { addresses_text, ProcessWords } from "../../store/process_words.js";
import type { Pdo, Project } from "../../store/project.js";
import type { ViewWish } from "../../store/protocol.js";
import { frame_strip } from "./frame_strip.js";
import { LinkSignals } from "./link_signals.js";
import { PdoEditor } from "./pdo_editor.js";
import { can_id_text, crossings_of, linked_text, mapped_text, sent_text, short, type PdoNetwork } from "./pdo_words.js";

type Part = "list" | "matrix" | "link";
const parts: [Part, string][] = [["list", "List"], ["matrix", "Producers and consumers"], ["link", "Link signals"]];
const id_of_words = (pdo: Pdo): string => can_id_text(pdo.can_id).slice(0, -1);

export class PdosScreen implements Screen {
  readonly id = "pdos";
  readonly title = "PDOs";
  readonly icon = iconTable;
  readonly needs_parts = true;
  private bus: string | undefined;
  private part: Part = "list";
  private node: number | null = null;
  private find = "";
  private with_disabled = false;
  private chosen: Pdo | null = null;
  private read: DictionaryPdos | null = null;
  private words: ProcessWords | null = null;
  private rows: readonly Pdo[] = [];
  private made_of: unknown[] = [];
  private readonly editor: PdoEditor;
  private readonly linking: LinkSignals;

  constructor(private readonly app: App) {
    this.editor = new PdoEditor(app);
    this.linking = new LinkSignals(app);
    app.store.listen((event) => {
      const objects = event?.event === "objects" ? app.store.view("objects") : null;
      if (objects) this.read?.take(objects);
      const words = event?.event === "words" ? app.store.view("words") : null;
      if (words) this.words?.take(words);
    });
  }

  opened(route: Route): void {
    this.bus = route.path[0] ?? this.bus;
    this.part = parts.find(([part]) => part === route.path[1])?.[0] ?? "list";
    this.node = route.query["node"] ? Number(route.query["node"]) : null;
    this.find = route.query["find"] ?? "";
    this.chosen = null;
  }

  /** Dictionaries may have changed until the screen is opened again. */
  closed(): void {
    this.read = null;
    this.words = null;
    this.editor.close();
  }

  wishes(): ViewWish[] {
    const network = this.network();
    const chosen = this.chosen?.active ? id_of_words(this.chosen) : null;
    return [...(network && network === this.read ? this.read.wishes() : []), ...(this.words?.wishes(chosen) ?? [])];
  }

  /** The project of the bus; without one what the dictionaries of its nodes say. */
  private network(): PdoNetwork | null {
    const { state, hello } = this.app.store;
    if (!state || !hello) return null;
    const bus = state.buses.find((one) => one.bus === this.bus)?.bus ?? hello.buses.find((one) => one.bus === this.bus)?.bus ?? hello.buses.find((one) => one.project)?.bus ?? state.buses[0]?.bus;
    if (bus === undefined) return null;
    if (this.words?.bus !== bus) this.words = new ProcessWords(bus, state);
    const project = hello.buses.some((one) => one.bus === bus && one.project) ? this.app.project_of(bus) : null;
    if (project) return project;
    if (this.read?.bus !== bus) this.read = new DictionaryPdos(bus, state);
    return this.read;
  }

  private project_of(network: PdoNetwork): Project | null {
    return network === this.read ? null : (network as Project);
  }

  private columns(network: PdoNetwork): Columns<Pdo> {
    const { is_narrow } = this.app;
    const text = (of: (pdo: Pdo) => string) => (p: { data?: Pdo | undefined }): string => (p.data ? of(p.data) : "");
    const linked = (pdo: Pdo): string => linked_text(pdo, network);
    const words = (pdo: Pdo): string => (pdo.active ? this.words?.of(id_of_words(pdo)).map((one) => addresses_text(one.words)).join("; ") ?? "" : "");
    return [
      { headerName: "Node", colId: "node", width: 140, valueGetter: text((pdo) => network.label(pdo.node)), comparator: (_a, _b, a, b) => (a.data?.node ?? 0) - (b.data?.node ?? 0) },
      { headerName: "PDO", field: "pdo", width: 76 },
      { headerName: "CAN-ID", colId: "id", width: 80, cellClass: "figure", valueGetter: text((pdo) => (pdo.active ? can_id_text(pdo.can_id) : "disabled")) },
      { headerName: "Bytes", field: "bytes", width: 64, cellClass: "figure", hide: is_narrow },
      { headerName: "Transmission", colId: "sent", width: 150, hide: is_narrow, valueGetter: text(sent_text) },
      { headerName: "Mapped", colId: "mapped", flex: 2, minWidth: 150, valueGetter: text(mapped_text) },
      { headerName: "Buffer memory", colId: "words", width: 152, valueGetter: text(words) },
      { headerName: "Linked to", colId: "linked", flex: 2, minWidth: 140, valueGetter: text(linked) },
    ];
  }

  private words_view(pdo: Pdo): unknown {
    const found = pdo.active ? this.words?.of(id_of_words(pdo)) ?? [] : [];
    return found.map((one) => html`<h3>Buffer memory of ${one.module}</h3><table class="rows"><tbody>${one.words.map((word) => html`<tr><th scope="row"><a href=${link("module", [one.number], { find: `G${word.address}` })}>G${word.address}</a></th>
      <td class="figure">${plot_button(this.app, `words ${one.number} ${word.address}`, `${one.module} G${word.address}`, String(word.value))}</td><td class="faint">${word.age === undefined ? "" : `${seconds_text(word.age)} ago`}</td></tr>`)}</tbody></table>`);
  }

  private describe(network: PdoNetwork, pdo: Pdo): void {
    this.chosen = pdo;
    const off = !this.app.store.may_configure;
    const project = this.project_of(network);
    this.app.describe({ title: `${pdo.pdo} of ${network.label(pdo.node)}`, rows: [["CAN-ID", pdo.active ? can_id_text(pdo.can_id) : "disabled"], ["Transmission", sent_text(pdo)], ["Length", count_text(pdo.bytes, "byte")], ["Linked to", linked_text(pdo, network)]],
      more: () => html`${frame_strip(pdo.mapping)}<table class="rows"><tbody>${pdo.mapping.map((one, i) => html`<tr><td class="figure">${one.bit}–${one.bit + one.bits - 1}</td><td><span class=${one.object ? `swatch signal-${i % 6}` : "swatch"}></span>${one.object ?? ""}</td><td>${short(one)}</td></tr>`)}</tbody></table>
        ${this.words_view(pdo)}
        <p class="buttons">${project ? html`<ix-button ?disabled=${off} @click=${() => this.editor.open(pdo)}>Change …</ix-button>${pdo.active ? html`<ix-button variant="secondary" ?disabled=${off} @click=${() => void this.app.change(project, { command: "project pdo off", node: String(pdo.node), pdo: pdo.pdo }, `${pdo.pdo} of ${project.label(pdo.node)} disabled`)}>Disable</ix-button>` : nothing}` : nothing}
        ${pdo.active ? html`<a href=${link("trace", [], { filter: `id=${id_of_words(pdo)}` })}>Frames</a>` : nothing}</p>` }, true);
  }

  private list(network: PdoNetwork, bus: string): TemplateResult {
    const made_of = [network.pdos, this.with_disabled, this.find, this.node];
    if (made_of.some((one, i) => one !== this.made_of[i])) {
      this.made_of = made_of;
      const terms = this.find.toLowerCase().split(/\s+/).filter(Boolean);
      this.rows = network.pdos.filter((pdo) => (pdo.active || this.with_disabled) && (this.node === null || pdo.node === this.node) && terms.every((term) => `${network.label(pdo.node)} ${pdo.pdo} ${can_id_text(pdo.can_id)} ${mapped_text(pdo)} ${linked_text(pdo, network)}`.toLowerCase().includes(term)));
    }
    requestAnimationFrame(() => { const grid = document.querySelector<HTMLElement & { rows: readonly Pdo[] }>("#pdo-grid"); if (grid) grid.rows = this.rows; });
    const project = this.project_of(network);
    const has_words = this.words?.is_complete ?? true;
    return html`<div class="tools"><input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Node, PDO, CAN-ID or signal" autocomplete="off" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; this.app.keep("pdos", [bus], { find: this.find, ...(this.node === null ? {} : { node: this.node }) }); this.app.redraw(); }}>
        <label class="inline"><input type="checkbox" .checked=${this.with_disabled} @change=${(event: Event) => { this.with_disabled = (event.target as HTMLInputElement).checked; this.app.redraw(); }}>Show disabled PDOs</label><span class="faint">${count_text(this.rows.length, "PDO")}</span></div>
      ${guard([bus, has_words, this.app.is_narrow], () => html`<data-grid id="pdo-grid" .label=${"PDOs"} .empty=${"No PDO matches"} .columns=${this.columns(network)} .rows=${this.rows} .row_id=${(pdo: Pdo) => `${pdo.node} ${pdo.pdo}`} .row_classes=${{ "row-faint": (pdo: Pdo) => !pdo.active, "row-chosen": (pdo: Pdo) => pdo.node === this.chosen?.node && pdo.pdo === this.chosen.pdo }} .chosen=${(pdo: Pdo) => this.describe(network, pdo)} .opened=${(pdo: Pdo) => { if (project) this.editor.open(pdo); }}></data-grid>`)}`;
  }

  private matrix(network: PdoNetwork): TemplateResult {
    const all = crossings_of(network.pdos);
    if (all.length === 0) return html`<ix-empty-state header="No signal goes from one node to another" sub-header="Link signals shows what each node can send and take"></ix-empty-state>`;
    const [from, to] = [[...new Set(all.map((one) => one.from))].sort((a, b) => a - b), [...new Set(all.map((one) => one.to))].sort((a, b) => a - b)];
    return html`<div class="scrolls" tabindex="0" role="region" aria-label="Producers and consumers"><table class="rows matrix"><thead><tr><th scope="col">Producer</th>${to.map((id) => html`<th scope="col">${network.label(id)}</th>`)}</tr></thead>
      <tbody>${from.map((id) => html`<tr><th scope="row">${network.label(id)}</th>${to.map((end) => html`<td>${all.filter((one) => one.from === id && one.to === end).map((one) => html`<div title=${sent_text(one.pdo)}>${one.name} <span class="faint">${one.pdo.pdo} ${can_id_text(one.pdo.can_id)}</span></div>`)}</td>`)}</tr>`)}</tbody></table></div>`;
  }

  private about(network: PdoNetwork): string {
    const project = this.project_of(network);
    if (project) return project.network ? `load ${percent_text(project.network.load)} by timers and SYNC, ${percent_text(project.network.load_at_most)} at most` : "";
    return this.read?.is_complete ? "as the nodes have them; a project of this bus can change them" : "reading the dictionaries …";
  }

  view(): TemplateResult {
    const { app } = this;
    const network = this.network();
    if (!network) return html`${head("PDOs", "")}<p class="faint">${app.store.state ? "This run has no bus." : "Waiting for the run …"}</p>`;
    const bus = network.bus_name;
    const project = this.project_of(network);
    const buses = [...new Set([...(app.store.state?.buses ?? []).map((one) => one.bus), ...(app.store.hello?.buses ?? []).map((one) => one.bus)])];
    const shown = parts.filter(([part]) => project || part !== "link");
    return html`${head("PDOs", this.about(network))}
      <div class="tools">${buses.length > 1 ? html`<label class="inline">Bus <select class="field" @change=${(event: Event) => app.go("pdos", [(event.target as HTMLSelectElement).value])}>${buses.map((one) => html`<option ?selected=${one === bus}>${one}</option>`)}</select></label>` : nothing}
        <div class="parts" role="group" aria-label="What is shown">${shown.map(([part, title]) => html`<a href=${link("pdos", part === "list" ? [bus] : [bus, part])} aria-current=${part === this.part ? "page" : nothing}>${title}</a>`)}</div>
        ${this.node === null ? nothing : html`<a href=${link("pdos", [bus])}>Only ${network.label(this.node)} ×</a>`}</div>
      ${project && this.editor.is_open ? this.editor.view(project) : this.part === "matrix" ? this.matrix(network) : this.part === "link" && project ? this.linking.view(project) : this.list(network, bus)}`;
  }
}
