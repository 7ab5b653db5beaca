// The project of a bus: its nodes, what does not fit, and of a node its values as the project, as the device, and the difference.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconProject } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { choose_bus } from "../../parts/choose_bus.js";
import { add_device_files, device_file_types } from "../../parts/device_files.js";
import type { Columns } from "../../parts/grid.js";
import { no_project } from "../../parts/no_project.js";
import { save_file } from "../../parts/save_file.js";
import { bit_rates, count_text, percent_text } from "../../store/nodes.js";
import { is_identity, type Project, type ProjectNode, type ProjectObject } from "../../store/project.js";
import { is_hexadecimal, words_of } from "../../store/value_words.js";
import { DcfValues } from "./dcf_values.js";

export interface ValueRow extends ProjectObject {
  device: string;
  difference: string;
}

export const project_value = (object: string, value: unknown): string =>
  value === null || value === undefined ? "" : typeof value === "number" && is_hexadecimal(object) ? `0x${value.toString(16).toUpperCase().padStart(8, "0")}` : String(value);

/** Values of a node beside those of its device; those that differ first. */
export function value_rows(project: Project, node: number, find: string, only: "all" | "configured" | "different"): ValueRow[] {
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  const rows = (project.objects.get(node) ?? []).filter((row) => !row.object.startsWith("00")).map((row): ValueRow => {
    const found = project.device.get(`${node} ${row.object}`);
    const state = project.states.get(node);
    const difference = project.unwritten.has(`${node} ${row.object}`) ? "not yet written" : found ? found.state : state && state.state !== "no answer" && row.configured ? "same" : "";
    return { ...row, device: found ? project_value(row.object, found.device) : difference === "same" ? project_value(row.object, row.value) : "", difference };
  });
  return rows.filter((row) => (only === "all" || (only === "configured" ? row.configured : row.difference !== "" && row.difference !== "same")) && terms.every((term) => `${row.object} ${row.name}`.toLowerCase().includes(term)));
}

const hex8 = (value: number | undefined): string => (value === undefined ? "–" : `${value.toString(16).toUpperCase().padStart(8, "0")}H`);

/** "product code 00000402H, revision 00010000H, serial number 00000001H" */
export const identity_text = (node: ProjectNode): string => `product code ${hex8(node.product_code)}, revision ${hex8(node.revision)}, serial number ${hex8(node.serial)}`;

export class ProjectScreen implements Screen {
  readonly id = "project";
  readonly title = "Project";
  readonly icon = iconProject;
  readonly needs_parts = true;
  private bus: string | undefined;
  private node: number | null = null;
  private find = "";
  private only: "all" | "configured" | "different" = "all";
  private rows: readonly ValueRow[] = [];
  private made_of = "";
  private accepting: { object: string; name?: string; project?: unknown; device?: unknown }[] | null = null;

  private readonly dcf: DcfValues;

  constructor(private readonly app: App) {
    this.dcf = new DcfValues(app);
  }

  opened(route: Route): void {
    this.bus = route.path[0] ?? this.bus;
    const node = Number(route.path[1]);
    this.node = route.path[1] && Number.isInteger(node) ? node : null;
    this.accepting = null;
    this.dcf.close();
    this.find = route.query["find"] ?? "";
  }

  private async compare(project: Project): Promise<void> {
    project.forget(null);
    const done = await this.app.run({ command: "project diff", bus: project.bus.bus }, { fine: [0, 4], progress: (rows) => project.found(rows) });
    project.found(done.rows);
    if (done.failed) return;
    const differ = done.rows.reduce((sum, row) => sum + Number(row["differ"] ?? 0), 0);
    const others = [...new Set(done.rows.filter(is_identity).map((row) => Number(row["node"])))].map((id) => `${project.label(id)} is another device`);
    const silent = [...project.states].filter(([, one]) => one.state === "no answer").map(([id]) => `${project.label(id)} does not answer`);
    this.app.say([...others, ...silent, ...(differ ? [count_text(differ, "value differs", "values differ")] : [])].join("; ") || "the devices have what the project has", others.length + silent.length ? "error" : "");
  }

  private async save(project: Project, command: "project report" | "project dcf save", name: string, node?: number): Promise<void> {
    const done = await this.app.run({ command, bus: project.bus.bus, ...(node === undefined ? {} : { node: String(node) }) });
    if (done.file === undefined) return;
    save_file([done.file], name);
    this.app.say(`${name} saved`);
  }

  private describe(project: Project, row: ValueRow): void {
    const node = row.node;
    const number = typeof row.value === "number" ? words_of(row.object, row.value) : "";
    this.app.describe({ title: row.name, object: row.object, rows: [["Object", row.object], ["Project", project_value(row.object, row.value)], ["Device", row.device], ["Difference", row.difference], ["In words", number], ["Type", row.type], ["Access", row.access],
      ["Range", row.low === undefined && row.high === undefined ? "" : `${row.low ?? ""} … ${row.high ?? ""}`], ["In the DCF", row.configured ? "yes" : "no: the default of the device file"]],
      more: () => (row.configured && this.app.store.may_configure ? html`<p><button type="button" class="quiet bordered" @click=${() => void this.app.change(project, { command: "project unset", node: String(node), items: [row.object] }, `${row.object} is the default again`)}>Back to the default</button></p>` : html``) });
  }

  private columns(project: Project): Columns<ValueRow> {
    return [
      { headerName: "Object", field: "object", width: 92, cellClass: "figure" },
      { headerName: "Name", field: "name", flex: 2, minWidth: 180 },
      { headerName: "Project", colId: "project", width: 150, cellClass: "figure", editable: (p) => this.app.store.may_configure && p.data !== undefined && p.data.access !== "const" && p.data.access !== "ro", valueGetter: (p) => (p.data ? project_value(p.data.object, p.data.value) : ""),
        valueSetter: (p) => { void this.app.change(project, { command: "project set", node: String(p.data.node), items: [`${p.data.object}=${String(p.newValue)}`] }); return false; },
        cellClassRules: { unwritten: (p) => p.data?.difference === "not yet written", configured: (p) => p.data?.configured === true } },
      { headerName: "Device", field: "device", width: 140, cellClass: "figure" },
      { headerName: "Difference", field: "difference", width: 130, cellClassRules: { bad: (p) => p.value === "different" || p.value === "refused", warn: (p) => p.value === "not yet written" } },
      { headerName: "In words", colId: "words", flex: 1, minWidth: 120, valueGetter: (p) => (p.data && typeof p.data.value === "number" ? words_of(p.data.object, p.data.value) : "") },
      { headerName: "Type", field: "type", width: 130 },
    ];
  }

  private async accept(project: Project, node: number, yes: boolean): Promise<void> {
    const done = await this.app.run({ command: "project accept", bus: project.bus.bus, node: String(node), ...(yes ? { yes: true } : {}) }, { fine: [0, 4] });
    if (done.failed) return;
    const rows = done.rows.filter((row) => row["object"] !== undefined);
    if (yes) {
      this.accepting = null;
      await project.load();
      return this.app.say("this device is the project's now");
    }
    this.accepting = rows.length ? (rows as never) : null;
    if (rows.length === 0) this.app.say("it is the device that the project has");
    this.app.redraw();
  }

  private node_part(project: Project, node: ProjectNode): TemplateResult {
    const { app } = this;
    void project.load_objects(node.node);
    const key = JSON.stringify([node.node, this.find, this.only, project.objects.get(node.node)?.length, [...project.device.values()].length, [...project.unwritten], [...project.states], project.objects.get(node.node)?.map((row) => row.value)]);
    if (key !== this.made_of) {
      this.made_of = key;
      this.rows = value_rows(project, node.node, this.find, this.only);
    }
    const off = !app.store.may_configure;
    const set = (fields: Record<string, unknown>) => void app.change(project, { command: "project set", node: String(node.node), ...fields });
    return html`<div class="tools">
        <label class="inline">Name <input class="field name-field" .value=${node.name} ?disabled=${off} @change=${(event: Event) => set({ name: (event.target as HTMLInputElement).value })}></label>
        <label class="inline">Node-ID <input class="field number-field" type="number" min="1" max="127" .value=${String(node.node)} ?disabled=${off} @change=${(event: Event) => { const id = (event.target as HTMLInputElement).value; void app.change(project, { command: "project set", node: String(node.node), node_id: id }).then((done) => { if (!done.failed) app.go("project", [project.bus.bus, id]); }); }}></label>
        <ix-button variant="secondary" ?disabled=${off || !project.bus.joins} @click=${() => void this.accept(project, node.node, false)}>Accept this device …</ix-button>
        <button type="button" class="quiet bordered" @click=${() => void this.save(project, "project dcf save", (node.file ?? "node.dcf").split("/").pop() ?? "node.dcf", node.node)}>Save DCF</button>
        ${this.dcf.button(project, node.node, off)}
        <button type="button" class="quiet bordered" ?disabled=${off} @click=${() => void app.change(project, { command: "project remove", node: String(node.node) }, `node ${node.node} removed; Undo takes that back`).then((done) => { if (!done.failed) app.go("project", [project.bus.bus]); })}>Remove</button></div>
      <div class="tools"><label class="inline"><input type="checkbox" .checked=${node.present} ?disabled=${off} @change=${(event: Event) => set((event.target as HTMLInputElement).checked ? { present: true } : { absent: true })}>Present</label>
        <label class="inline grows">Note <input class="field grows" id="project-note" maxlength="900" autocomplete="off" placeholder="for the report" .value=${node.note ?? ""} ?disabled=${off} @change=${(event: Event) => void app.change(project, { command: "project note", node: String(node.node), text: (event.target as HTMLInputElement).value }, "noted")}></label>
        <span class="faint">${identity_text(node)}</span><a href=${link("pdos", [project.bus.bus], { node: node.node })}>PDOs</a></div>
      ${this.dcf.view(project, node.node)}
      ${this.accepting ? html`<div class="panel"><h2>Accept this device</h2><p>It says of itself otherwise than the project; only this changes:</p><table class="rows"><thead><tr><th scope="col">Object</th><th scope="col">Name</th><th scope="col">Project</th><th scope="col">Device</th></tr></thead><tbody>${this.accepting.map((row) => html`<tr><th scope="row">${row.object}</th><td>${row.name ?? ""}</td><td>${String(row.project ?? "")}</td><td>${String(row.device ?? "")}</td></tr>`)}</tbody></table>
        <p class="buttons"><ix-button @click=${() => void this.accept(project, node.node, true)}>Accept</ix-button><ix-button variant="secondary" @click=${() => { this.accepting = null; app.redraw(); }}>Cancel</ix-button></p></div>` : nothing}
      <div class="tools"><input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Name or index" autocomplete="off" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; app.keep("project", [project.bus.bus, node.node], { find: this.find }); app.redraw(); }}>
        <label class="inline">Show <select class="field" @change=${(event: Event) => { this.only = (event.target as HTMLSelectElement).value as ProjectScreen["only"]; app.redraw(); }}><option value="all">all objects</option><option value="configured">configured ones</option><option value="different">differences</option></select></label><span class="faint">${count_text(this.rows.length, "object")}</span></div>
      ${guard([project.bus.bus, node.node, project.objects.has(node.node)], () => html`<data-grid id="project-grid" .is_edited=${true} .label=${`Objects of ${project.label(node.node)}`} .empty=${project.objects.has(node.node) ? "No object matches" : "Reading …"} .columns=${this.columns(project)} .rows=${this.rows} .row_id=${(row: ValueRow) => row.object} .chosen=${(row: ValueRow) => this.describe(project, row)} .options=${{ singleClickEdit: false, stopEditingWhenCellsLoseFocus: true }}></data-grid>`)}`;
  }

  private node_row(project: Project, node: ProjectNode): TemplateResult {
    const state = project.states.get(node.node);
    const words = !state ? "" : state.state === "same" ? "same" : state.state === "no answer" ? "no answer" : state.reason ?? `${state.differ ?? ""} ${state.state}`.trim();
    const bad = project.findings.filter((one) => one.node === node.node && one.severity !== "note").length;
    return html`<li><a class="project-node" href=${link("project", [project.bus.bus, node.node])} aria-current=${node.node === this.node ? "page" : nothing}><span class="id">${node.node}</span><span>${node.name || node.product || ""}${node.present ? "" : html` <span class="faint">not present</span>`}</span>
      <span class=${words === "same" ? "good-text" : words ? "bad" : "faint"}>${words || (bad ? count_text(bad, "finding") : "")}</span></a></li>`;
  }

  view(): TemplateResult {
    const { app } = this;
    const project = app.project_of(this.bus);
    if (!project) return html`${head("Project", "")}${no_project(app)}`;
    const node = this.node === null ? undefined : project.node(this.node);
    const network = project.network;
    const off = !app.store.may_configure;
    const live = project.bus.joins;
    const worst = project.findings.filter((one) => one.severity !== "note");
    requestAnimationFrame(() => { const grid = document.querySelector<HTMLElement & { rows: readonly ValueRow[] }>("#project-grid"); if (grid) grid.rows = this.rows; });
    return html`${head("Project", network ? `${network.bit_rate ? `${network.bit_rate / 1000} kbit/s, ` : ""}${count_text(project.nodes.length, "node")}, load ${percent_text(network.load)} by timers and SYNC, ${percent_text(network.load_at_most)} at most` : "")}
      <div class="tools">${choose_bus(app, "project", project)}
        <label class="quiet bordered file">Add a device …<input type="file" multiple accept=${device_file_types} ?disabled=${off} @change=${(event: Event) => { const input = event.target as HTMLInputElement; void add_device_files(app, project, [...(input.files ?? [])]).then(() => { input.value = ""; }); }}></label>
        <label class="inline">Bit rate <select class="field" ?disabled=${off} @change=${(event: Event) => { const rate = (event.target as HTMLSelectElement).value; if (rate) void app.change(project, { command: "project set", bit_rate: rate }); }}><option value="">not the same</option>${bit_rates.map((rate) => html`<option value=${`${rate}k`} ?selected=${network?.bit_rate === rate * 1000}>${rate} kbit/s</option>`)}</select></label>
        <ix-button variant="secondary" ?disabled=${!app.store.may_operate || !live} @click=${() => void this.compare(project)}>Compare with devices</ix-button>
        <ix-button variant="secondary" ?disabled=${off || !live} @click=${() => void app.run({ command: "project read", bus: project.bus.bus }, { fine: [0, 4] }).then(async (done) => { await project.load(); project.forget(null); if (!done.failed) app.say(`${count_text(done.rows.filter((row) => row["state"] === "taken").length, "value")} taken over`); })}>Read from devices</ix-button>
        <a href=${link("transfer", [project.bus.bus])}>Transfer</a>
        <button type="button" class="quiet bordered" ?disabled=${off} @click=${() => void app.change(project, { command: "project undo" }).then((done) => { const undone = done.rows.find((row) => row["event"] === "undone"); if (undone) app.say(`taken back: ${String(undone["title"])}`); })}>Undo</button>
        <button type="button" class="quiet bordered" @click=${() => void this.save(project, "project report", "report.html")}>Report</button></div>
      ${project.problem ? html`<p class="bad" role="alert">${project.problem}</p>` : nothing}
      <div class="sides" @dragover=${(event: DragEvent) => { if (event.dataTransfer?.types.includes("Files")) event.preventDefault(); }} @drop=${(event: DragEvent) => { if (event.dataTransfer?.files.length) { event.preventDefault(); void add_device_files(app, project, [...event.dataTransfer.files]); } }}>
        <nav class="side" aria-label="Nodes of the project"><ul>${project.nodes.map((one) => this.node_row(project, one))}</ul>${project.is_loaded && project.nodes.length === 0 ? html`<p class="faint">No node yet: drop an EDS file here.</p>` : nothing}</nav>
        <div class="main">${node ? this.node_part(project, node) : html`<div class="scrolls">
          <p class="faint">Drop EDS, DCF or XDD files here to add devices; choose a node to see its values.</p>
          <h3>What does not fit</h3>${worst.length === 0 ? html`<p class="faint">Nothing</p>` : nothing}<ul class="findings">${project.findings.map((one) => html`<li class=${one.severity === "error" ? "bad" : one.severity === "warning" ? "warn" : "faint"}>${one.node === undefined ? one.message : html`<a href=${link("project", [project.bus.bus, one.node])}>${one.message}</a>`}</li>`)}</ul></div>`}</div></div>`;
  }
}
