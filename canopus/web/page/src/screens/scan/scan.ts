// A scan of a bus: what answers, what it is, whether the project has it; devices without a node-ID by LSS.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconSearch } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { count_text } from "../../store/nodes.js";
import type { BusOfCommands } from "../../store/protocol.js";

type Row = Record<string, unknown>;
const hex = (value: unknown): string => (typeof value === "number" ? `${value.toString(16).toUpperCase().padStart(8, "0")}H` : "");
const text = (value: unknown): string => (value === null || value === undefined ? "" : String(value));

export class ScanScreen implements Screen {
  readonly id = "scan";
  readonly title = "Scan";
  readonly icon = iconSearch;
  private bus = "";
  private nodes = "1-127";
  private found: Row[] | null = null;
  private devices: Row[] | null = null;
  private is_busy = false;
  private first = "1";
  private stores = false;
  private search = { node: "1", vendor: "", product: "", revision: "", serial: "" };

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    const bus = route.path[0] ?? this.bus;
    if (bus !== this.bus) {
      this.found = null;
      this.devices = null;
    }
    this.bus = bus;
  }

  private get place(): BusOfCommands | undefined {
    const buses = this.app.store.hello?.buses ?? [];
    return buses.find((one) => one.bus === this.bus) ?? buses.find((one) => one.joins) ?? buses[0];
  }

  private async run(command: Record<string, unknown> & { command: string }, take: (rows: Row[]) => void, fine = [0]): Promise<Row[] | null> {
    this.is_busy = true;
    const done = await this.app.run({ ...command, bus: this.place?.bus }, { fine, done: "", progress: (rows) => { take(rows); this.app.redraw(); } });
    this.is_busy = false;
    take(done.rows);
    this.app.redraw();
    return done.failed ? null : done.rows;
  }

  private async scan(): Promise<void> {
    this.found = [];
    const rows = await this.run({ command: "scan", nodes: this.nodes.trim() }, (all) => { this.found = all.filter((row) => row["node"] !== undefined); });
    if (rows) this.app.say(`${count_text(this.found?.length ?? 0, "node")} on the bus`);
  }

  private async adopt(): Promise<void> {
    const rows = await this.run({ command: "project adopt" }, (all) => { const matched = all.filter((row) => row["match"] !== undefined); if (matched.length) this.found = matched; }, [0, 4]);
    const project = this.app.project_of(this.place?.bus);
    await project?.load();
    if (rows) this.app.say(`${count_text(rows.filter((row) => row["result"] === "added").length, "node")} taken over into the project`);
  }

  private async lss(command: Record<string, unknown> & { command: string }): Promise<void> {
    this.devices = [];
    const patience = this.place?.live ? {} : { timeout: "50ms" };
    const rows = await this.run({ ...patience, ...command }, (all) => { this.devices = all.filter((row) => row["vendor"] !== undefined || row["serial"] !== undefined); });
    if (!rows) return;
    const row = rows[0];
    if (command.command === "lss search" && row) this.app.say(`found at ${Number(row["found_at"]) / 1000} kbit/s: node ${text(row["node"])} at ${Number(row["bit_rate"]) / 1000} kbit/s now`);
    else this.app.say(rows.length ? count_text(rows.length, "device") : "no device without a node-ID answers");
  }

  private table(rows: Row[]): TemplateResult {
    const project = this.app.project_of(this.place?.bus);
    const has_project = Boolean(this.place?.project);
    return html`<table class="rows full"><thead><tr>${["Node", "Name", "State", "Device type", "Vendor-ID", "Product code", "Revision", "Serial number", ...(has_project ? ["Device file", "In the project"] : [])].map((one, i) => html`<th scope="col" class=${i >= 3 && i <= 7 ? "figure" : ""}>${one}</th>`)}</tr></thead>
      <tbody>${rows.map((row) => html`<tr><th scope="row"><a href=${link("objects", [this.place?.bus ?? "", text(row["node"])])}>${text(row["node"])}</a></th><td>${text(row["name"])}</td><td>${text(row["state"])}</td>${["device_type", "vendor", "product", "revision", "serial"].map((name) => html`<td class="figure">${hex(row[name])}</td>`)}
        ${has_project ? html`<td>${text(row["match"])}${row["file"] ? html` <span class="faint">${text(row["file"])}</span>` : nothing}</td><td>${row["result"] === undefined ? (project?.node(Number(row["node"])) ? "yes" : "no") : text(row["result"])}</td>` : nothing}</tr>`)}</tbody></table>`;
  }

  private lss_part(place: BusOfCommands): TemplateResult {
    const { store } = this.app;
    const off = !store.may_configure || this.is_busy;
    const input = (label: string, name: keyof ScanScreen["search"], hint: string): TemplateResult => html`<label class="inline">${label} <input class="field number-field" placeholder=${hint} .value=${this.search[name]} @input=${(event: Event) => { this.search[name] = (event.target as HTMLInputElement).value; }}></label>`;
    return html`<section class="panel"><h2>Devices without a node-ID (LSS)</h2>
      <div class="tools"><ix-button variant="secondary" ?disabled=${!store.may_operate || this.is_busy} @click=${() => void this.lss({ command: "lss scan" })}>Find devices</ix-button>
        <ix-button variant="secondary" ?disabled=${off} @click=${() => void this.lss({ command: "lss assign", assign: this.first, store: this.stores })}>Assign node-IDs</ix-button>
        <label class="inline">starting at <input class="field number-field" type="number" min="1" max="127" .value=${this.first} @input=${(event: Event) => { this.first = (event.target as HTMLInputElement).value; }}></label>
        <label class="inline"><input type="checkbox" .checked=${this.stores} @change=${(event: Event) => { this.stores = (event.target as HTMLInputElement).checked; }}>Store in device (LSS store)</label></div>
      <h3>Find a device at an unknown bit rate and assign a node-ID</h3>
      <div class="tools">${input("Node-ID", "node", "1")}${input("Vendor-ID", "vendor", "any")}${input("Product code", "product", "any")}${input("Revision", "revision", "any")}${input("Serial number", "serial", "any")}
        <ix-button variant="secondary" ?disabled=${off} @click=${() => { const { node, ...address } = this.search; void this.lss({ command: "lss search", node, ...(place.bit_rate ? { bit_rate: String(place.bit_rate) } : {}), ...Object.fromEntries(Object.entries(address).filter(([, value]) => value.trim())) }); }}>Search all bit rates</ix-button></div>
      <p class="faint">Searching changes bit rates: other nodes may go bus-off meanwhile.</p>
      ${this.devices?.length ? html`<table class="rows"><thead><tr>${["Vendor-ID", "Product code", "Revision", "Serial number", "Node-ID"].map((one, i) => html`<th scope="col" class=${i < 4 ? "figure" : ""}>${one}</th>`)}</tr></thead><tbody>${this.devices.map((row) => html`<tr>${["vendor", "product", "revision", "serial"].map((name) => html`<td class="figure">${hex(row[name])}</td>`)}<td>${text(row["node"] ?? "none")}</td></tr>`)}</tbody></table>` : nothing}</section>`;
  }

  view(): TemplateResult {
    const { app, place } = this;
    const { store } = app;
    if (!store.hello) return html`${head("Scan", "")}<p class="faint">Waiting for the run …</p>`;
    if (!place?.joins) return html`${head("Scan", "")}<ix-empty-state header="No bus to scan" sub-header="Commands cannot join a bus of this run"></ix-empty-state>`;
    const buses = store.hello.buses.filter((one) => one.joins);
    return html`${head("Scan", html`${place.live ? html`<b class="bad">LIVE</b> ` : ""}${place.bus}, ${place.bit_rate / 1000} kbit/s. A scan asks each node-ID for its identity by SDO.`)}
      <div class="tools">${buses.length > 1 ? html`<label class="inline">Bus <select class="field" @change=${(event: Event) => app.go("scan", [(event.target as HTMLSelectElement).value])}>${buses.map((one) => html`<option ?selected=${one === place}>${one.bus}</option>`)}</select></label>` : nothing}
        <label class="inline">Node-IDs <input class="field number-field" .value=${this.nodes} maxlength="20" @input=${(event: Event) => { this.nodes = (event.target as HTMLInputElement).value; }}></label>
        <ix-button ?disabled=${!store.may_operate || this.is_busy} @click=${() => void this.scan()}>Scan</ix-button>
        ${place.project ? html`<ix-button variant="secondary" ?disabled=${!store.may_configure || this.is_busy} @click=${() => void this.adopt()}>Adopt all</ix-button><a href=${link("project", [place.bus])}>Project</a>` : nothing}</div>
      <div class="scrolls panels" tabindex="0" role="region" aria-label="Found"><section class="panel"><h2>Nodes on the bus</h2>${this.found === null ? html`<p class="faint">Not scanned yet</p>` : this.found.length === 0 ? html`<p class="faint">${this.is_busy ? "Scanning …" : "No node answered"}</p>` : html`<div class="wide">${this.table(this.found)}</div>`}</section>${this.lss_part(place)}</div>`;
  }
}
