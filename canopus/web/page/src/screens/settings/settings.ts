// The settings of a module in the windows of its configuration tool: a tree at the left, the window, and what differs from the module.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconCogwheel, iconTrashcan } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { save_file } from "../../parts/save_file.js";
import type { Done } from "../../store/commands.js";
import { count_text } from "../../store/nodes.js";
import { bits_of_all, found_objects, mappable_objects, mapping_text, object_text, parse_mapped, type MappableObject, type MappedObject } from "./mapping.js";
import { tree_of } from "./tree.js";
import { Settings, shown_value, type SettingsField, type SettingsRow, type SettingsWindow } from "../../store/settings.js";

const tools: [string, string][] = [["transfer", "Download Configuration"], ["scan", "Network scan"], ["sdo", "SDO send / receive"], ["status", "Module status"], ["file", "Export / Import"]];
const text = (value: unknown): string => (value === null || value === undefined ? "" : String(value));

export class SettingsScreen implements Screen {
  readonly id = "settings";
  readonly title = "Settings";
  readonly icon = iconCogwheel;
  private all: Settings[] | null = null;
  private number = 0;
  private page = "";
  private stop = false;
  private steps: Record<string, unknown>[] = [];
  private answer: Record<string, unknown>[] = [];
  private new_row = "";
  private sdo = { node: "127", object: "1000:00", data: "0", length: "BYTE_LENGTH_2" };
  private nodes = "all";
  private confirms = "";
  /** The PDO whose mapping is open, "tpdo/5". */
  private mapping = "";
  private find = "";
  private mappable = new Map<string, MappableObject[]>();

  constructor(private readonly app: App) {
    app.store.listen((event) => {
      if (event?.event === "audit" && /^canopus configure (set|delete|defaults|undo|import|read|identify)\b/.test(String((event as { do?: unknown }).do))) void this.settings?.load();
    });
  }

  opened(route: Route): void {
    this.number = Number(route.path[0] ?? 0) || 0;
    const page = route.path[1] ?? "";
    if (page !== this.page) {
      this.answer = [];
      this.confirms = "";
      this.mapping = "";
    }
    this.page = page;
  }

  private get settings(): Settings | undefined {
    const { hello } = this.app.store;
    if (!this.all && hello) {
      this.all = hello.settings.map((one) => new Settings(one, (command) => this.app.connection.commands.run(command), () => this.app.redraw()));
      for (const one of this.all) void one.load();
    }
    return this.all?.[this.number] ?? this.all?.[0];
  }

  private async run(settings: Settings, command: Record<string, unknown> & { command: string }, options: Parameters<App["run"]>[1] = {}): Promise<Done & { failed: boolean }> {
    return this.app.run({ ...command, settings: settings.one.file }, options);
  }

  private async change(settings: Settings, command: Record<string, unknown> & { command: string }, done = ""): Promise<boolean> {
    const result = await this.run(settings, command, { done });
    await settings.load();
    return !result.failed;
  }

  private async set(settings: Settings, place: string, field: string, value: string): Promise<void> {
    if (await this.change(settings, { command: "configure set", window: place, items: [`${field}=${value}`] })) settings.unwritten.add(`${place} ${field}`);
    this.app.redraw();
  }

  private describe(field: SettingsField, device: unknown): void {
    if (this.app.description?.title === field.field) return;
    this.app.describe({ title: field.field, rows: [["Meaning", field.description], ["Range", field.range], ["Default", field.default], ["Unit", field.unit], ["The module has", text(device)]] });
  }

  private input(settings: Settings, place: string, field: SettingsField, value: number | undefined, label: string | null): TemplateResult {
    const shown = shown_value(field, value);
    const mood = settings.mood(place, field.field);
    const off = field.read_only || !this.app.store.may_configure;
    const set = (event: Event): void => void this.set(settings, place, field.field, (event.target as HTMLInputElement).value);
    const focus = (): void => this.describe(field, settings.differs.get(`${place} ${field.field}`));
    const title = mood === "unwritten" ? "changed and not yet written" : mood === "differs" ? `the module has ${text(settings.differs.get(`${place} ${field.field}`))}` : nothing;
    if (field.words?.length === 2 && field.words[1] === "Selected") {
      return html`<input type="checkbox" data-mood=${mood} title=${title} aria-label=${label ?? nothing} .checked=${shown === "Selected"} ?disabled=${off} @focus=${focus} @change=${(event: Event) => void this.set(settings, place, field.field, (event.target as HTMLInputElement).checked ? "Selected" : "Not selected")}>`;
    }
    const options = field.words ?? field.choices?.map(String);
    if (options) return html`<select class="field" data-mood=${mood} title=${title} aria-label=${label ?? nothing} ?disabled=${off} @focus=${focus} @change=${set}>${options.map((one) => html`<option ?selected=${one === shown}>${one}</option>`)}</select>`;
    return html`<input class="field" data-mood=${mood} title=${title} aria-label=${label ?? nothing} maxlength="20" autocomplete="off" spellcheck="false" .value=${shown} ?disabled=${off} @focus=${focus} @change=${set}>`;
  }

  private form(settings: Settings, window: SettingsWindow): TemplateResult {
    const row = settings.row(window.word);
    return html`<div class="settings-form">${window.fields.map((field) => html`<label><span>${field.field}</span>${this.input(settings, window.word, field, row?.values[field.field], null)}<span class="faint">${field.unit.replace(/^us$/, "µs")}</span></label>`)}</div>
      ${row?.words ? html`<p>${row.words}</p>` : nothing}${row?.warning ? html`<p class="bad">${row.warning}</p>` : nothing}`;
  }

  private list(settings: Settings, window: SettingsWindow): TemplateResult {
    const rows = settings.rows.get(window.word) ?? [];
    const off = !this.app.store.may_configure;
    const add = async (): Promise<void> => {
      const number = this.new_row.trim();
      if (number && (await this.change(settings, { command: "configure set", window: `${window.word}/${number}` }))) this.new_row = "";
      this.app.redraw();
    };
    const row_view = (row: SettingsRow): TemplateResult => {
      const place = `${window.word}/${row.number}`;
      return html`<tr><th scope="row">${row.number}</th>${window.name_field ? html`<td><input class="field" maxlength="256" aria-label=${`${window.name_field} of ${row.number}`} .value=${row.name ?? ""} ?disabled=${off} @change=${(event: Event) => void this.set(settings, place, window.name_field ?? "", (event.target as HTMLInputElement).value)}></td>` : nothing}
        ${window.fields.map((field) => html`<td>${this.input(settings, place, field, row.values[field.field], `${field.field} of ${window.key} ${row.number}`)}</td>`)}
        ${window.maps_objects ? html`<td class="mapping"><button type="button" class="quiet" title="Change the mapping" aria-expanded=${this.mapping === place} @click=${() => void this.open_mapping(settings, window, place)}>${row.objects.length ? count_text(row.objects.length, "object") : "nothing"} …</button></td>` : nothing}
        <td><ix-icon-button size="16" variant="subtle-tertiary" icon=${iconTrashcan} aria-label=${`Delete ${window.key} ${row.number}`} title="Delete" ?disabled=${off} @click=${() => void this.change(settings, { command: "configure delete", row: place })}></ix-icon-button></td></tr>`;
    };
    return html`<div class="tools"><label class="inline">New row: ${window.key} <input class="field number-field" inputmode="numeric" placeholder=${`1 to ${window.most_key}`} ?disabled=${off} .value=${this.new_row} @input=${(event: Event) => { this.new_row = (event.target as HTMLInputElement).value; }} @keydown=${(event: KeyboardEvent) => { if (event.key === "Enter") void add(); }}></label>
        <button type="button" class="quiet bordered" ?disabled=${off} @click=${() => void add()}>Add</button><span class="faint">${rows.length} of ${count_text(window.most_rows ?? 0, "row")}</span></div>
      ${rows.length === 0 ? html`<p class="faint">No row yet</p>` : html`<div class="wide"><table class="rows"><thead><tr><th scope="col">${window.key}</th>${window.name_field ? html`<th scope="col">${window.name_field}</th>` : nothing}${window.fields.map((field) => html`<th scope="col">${field.field}</th>`)}${window.maps_objects ? html`<th scope="col">Mapping</th>` : nothing}<th scope="col"><span class="hidden">Delete</span></th></tr></thead><tbody>${rows.map(row_view)}</tbody></table></div>`}
      ${rows.filter((row) => this.mapping === `${window.word}/${row.number}`).map((row) => this.mapping_part(settings, window, row))}`;
  }

  private async open_mapping(settings: Settings, window: SettingsWindow, place: string): Promise<void> {
    this.mapping = this.mapping === place ? "" : place;
    this.find = "";
    this.app.redraw();
    if (this.mappable.has(window.word)) return;
    const done = await this.app.connection.commands.run({ command: "configure objects", settings: settings.one.file, window: window.word });
    this.mappable.set(window.word, mappable_objects(done.rows));
    this.app.redraw();
  }

  private mapping_part(settings: Settings, window: SettingsWindow, row: SettingsRow): TemplateResult {
    const place = `${window.word}/${row.number}`;
    const off = !this.app.store.may_configure;
    const all = this.mappable.get(window.word) ?? [];
    const mapped = row.objects.map(parse_mapped).filter((one) => one !== null);
    const found = found_objects(all, this.find);
    const put = (objects: readonly MappedObject[]): void => void this.set(settings, place, "map", mapping_text(objects));
    const name_of = (one: MappedObject): string => all.find((other) => other.index === one.index && other.sub === one.sub && other.bits === one.bits)?.name ?? "";
    const used = bits_of_all(mapped);
    return html`<section class="panel" aria-label=${`Mapping of PDO ${row.number}`}><div class="tools"><h2>Mapping of PDO ${row.number}</h2><span class=${used > 64 ? "bad" : "faint"}>${used} of 64 bits</span><span class="grows"></span><button type="button" class="quiet bordered" @click=${() => { this.mapping = ""; this.app.redraw(); }}>Close</button></div>
      <div class="halves"><div><h3>Mapped</h3><ol class="picks">${mapped.map((one, i) => html`<li><span><b>${object_text(one)}</b> ${name_of(one)} <span class="faint">${one.bits} bits</span></span><span>
          <button type="button" class="quiet" title=${`Move ${object_text(one)} up`} ?disabled=${off || i === 0} @click=${() => put([...mapped.slice(0, i - 1), one, mapped[i - 1]!, ...mapped.slice(i + 1)])}>↑</button>
          <button type="button" class="quiet" aria-label=${`Remove ${object_text(one)}`} ?disabled=${off} @click=${() => put(mapped.filter((_, k) => k !== i))}>Remove</button></span></li>`)}${mapped.length === 0 ? html`<li class="faint">Nothing is mapped</li>` : nothing}</ol></div>
        <div><h3>Can be mapped <span class="faint">${found.length}</span></h3><input class="field full" type="search" aria-label="Search objects that can be mapped" placeholder="Description, object name or index; as G13000" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; this.app.redraw(); }}>
          <ul class="picks">${found.slice(0, 100).map((one) => html`<li><span><b>${object_text(one)}</b> ${one.name} <span class="faint">${one.type}</span></span><button type="button" class="quiet" aria-label=${`Add ${object_text(one)}`} ?disabled=${off || used + one.bits > 64} @click=${() => put([...mapped, one])}>Add</button></li>`)}
            ${found.length > 100 ? html`<li class="faint">${found.length - 100} more: search for one of them</li>` : nothing}${found.length === 0 ? html`<li class="faint">${all.length ? "Nothing found" : "Reading …"}</li>` : nothing}</ul></div></div></section>`;
  }

  private async compare(settings: Settings): Promise<void> {
    this.steps = [];
    const done = await this.run(settings, { command: "configure diff", part: "all" }, { fine: [0, 4], done: "" });
    settings.compared(done.failed ? null : done.rows);
    this.app.redraw();
  }

  private async write(settings: Settings): Promise<void> {
    const steps = (rows: Record<string, unknown>[]): void => { this.steps = rows.filter((row) => row["step"] !== undefined); this.app.redraw(); };
    const done = await this.run(settings, { command: "configure write", part: "all", stop: this.stop, yes: true }, { progress: steps, done: "" });
    steps(done.rows);
    if (!done.failed) {
      settings.compared([]);
      this.app.say(this.steps.length ? "written and read back: the same. What the module takes over at its start counts after a reset." : "nothing was to be written");
    }
  }

  private transfer(settings: Settings): TemplateResult {
    const { plan } = settings;
    const may = this.app.store.may_configure && settings.one.plc.length > 0;
    const not_armed = settings.one.live && this.app.store.armed_until === 0;
    return html`<p class="faint">The settings go into the flash ROM of the module, through its PLC. The CPU module must be in STOP.</p>
      <div class="tools"><ix-button variant="secondary" ?disabled=${!this.app.store.may_operate || settings.one.plc.length === 0} @click=${() => void this.compare(settings)}>Compare</ix-button>
        <ix-button ?disabled=${!may || !plan?.length || not_armed} @click=${() => void this.write(settings)}>Write${plan?.length ? ` ${count_text(plan.length, "setting")}` : ""}</ix-button>
        <ix-button variant="secondary" ?disabled=${!may} @click=${() => void this.change(settings, { command: "configure read", part: "all" }, "the file has what the module has")}>Read all settings</ix-button>
        <label class="inline"><input type="checkbox" .checked=${this.stop} @change=${(event: Event) => { this.stop = (event.target as HTMLInputElement).checked; }}>Put the CPU module into STOP for it, and into RUN again</label>
        ${not_armed ? html`<span class="warn">Writes on a live PLC have to be armed first, in the bar</span>` : nothing}</div>
      ${settings.one.plc.length === 0 ? html`<p class="warn">There is no PLC with this module</p>` : nothing}
      ${plan === null ? html`<p class="faint">Not compared yet</p>` : plan.length === 0 ? html`<p>The module has all of it.</p>` : html`<table class="rows"><thead><tr><th scope="col">Setting</th><th scope="col">Project</th><th scope="col">Module</th></tr></thead><tbody>${plan.map((row) => html`<tr><th scope="row">${row.field}</th><td>${text(row.project)}</td><td>${text(row.device)}</td></tr>`)}</tbody></table>`}
      ${this.steps.length ? html`<h3>Steps</h3><table class="rows"><tbody>${this.steps.map((row) => html`<tr class=${row["good"] ? "" : "bad"}><td>${text(row["step"])}</td><td>${row["good"] ? "done" : "refused"}</td></tr>`)}</tbody></table>` : nothing}`;
  }

  private async ask(settings: Settings, command: Record<string, unknown> & { command: string }, done = ""): Promise<void> {
    this.confirms = "";
    this.answer = [];
    const result = await this.run(settings, command, { done, progress: (rows) => { this.answer = rows; this.app.redraw(); } });
    this.answer = result.rows;
    this.app.redraw();
  }

  private answer_table(): TemplateResult | typeof nothing {
    const rows = this.answer.filter((row) => row["current"] === undefined);
    if (rows.length === 0) return nothing;
    return html`<table class="rows"><tbody>${rows.map((row) => html`<tr><th scope="row">${text(row["name"] ?? row["node"] ?? row["result"])}</th><td>${text(row["value"] ?? (row["node"] === undefined ? "" : row["node"]))}</td></tr>`)}</tbody></table>`;
  }

  private tool(settings: Settings, page: string): TemplateResult {
    const { store } = this.app;
    const off = !store.may_operate || settings.one.plc.length === 0;
    const set = (field: keyof SettingsScreen["sdo"]) => (event: Event): void => { this.sdo[field] = (event.target as HTMLInputElement).value; };
    if (page === "transfer") return this.transfer(settings);
    if (page === "scan") return html`<div class="tools"><label class="inline">Node-IDs <input class="field number-field" .value=${this.nodes} @input=${(event: Event) => { this.nodes = (event.target as HTMLInputElement).value; }}></label><ix-button ?disabled=${off} @click=${() => void this.ask(settings, { command: "configure scan", nodes: this.nodes, progress: true })}>Scan</ix-button><span class="faint">${text(this.answer.findLast((row) => row["current"] !== undefined)?.["current"])}</span></div>${this.answer_table()}`;
    if (page === "sdo") return html`<div class="tools"><label class="inline">Node-ID <input class="field number-field" .value=${this.sdo.node} @input=${set("node")}></label><label class="inline">Object <input class="field" .value=${this.sdo.object} @input=${set("object")}></label><ix-button ?disabled=${off} @click=${() => void this.ask(settings, { command: "configure sdo-read", node: this.sdo.node, object: this.sdo.object })}>Read</ix-button>
        <label class="inline">Data <input class="field" .value=${this.sdo.data} @input=${set("data")}></label><label class="inline">Data length <select class="field" @change=${set("length")}>${["STRING", "BYTE_LENGTH_1", "BYTE_LENGTH_2", "BYTE_LENGTH_4", "BYTE_LENGTH_6", "BYTE_LENGTH_8"].map((one) => html`<option ?selected=${one === this.sdo.length}>${one}</option>`)}</select></label>
        <ix-button variant="secondary" ?disabled=${off || !store.may_configure} @click=${() => void this.ask(settings, { command: "configure sdo-write", ...this.sdo })}>Write</ix-button></div>${this.answer_table()}`;
    if (page === "status") return html`<div class="tools"><ix-button ?disabled=${off} @click=${() => void this.ask(settings, { command: "configure status" })}>Refresh</ix-button><ix-button variant="secondary" ?disabled=${off} @click=${() => void this.ask(settings, { command: "configure status clear" })}>Clear error</ix-button>
        ${this.confirms === "reset" ? html`<span class="warn">The NMT master is reset, and with it the network.</span><ix-button variant="danger-primary" @click=${() => void this.ask(settings, { command: "configure reset" }, "the NMT master was reset")}>Reset now</ix-button>` : html`<ix-button variant="secondary" ?disabled=${off} @click=${() => { this.confirms = "reset"; this.app.redraw(); }}>Reset …</ix-button>`}</div>${this.answer_table()}`;
    return html`<p class="faint">Each change is in the file at once. A backup is one XML file.</p><div class="tools"><ix-button @click=${async () => { const done = await this.run(settings, { command: "configure export" }); if (done.file !== undefined) save_file([done.file], `${settings.one.file.split("/").pop()?.replace(/\.xml$/, "") ?? "settings"}-backup.xml`); }}>Export</ix-button>
      <label class="quiet bordered file">Import …<input type="file" accept=".xml" ?disabled=${!store.may_configure} @change=${async (event: Event) => { const [file] = (event.target as HTMLInputElement).files ?? []; if (file) await this.change(settings, { command: "configure import", file: { name: file.name, text: await file.text() } }, `${file.name} imported`); }}></label></div>`;
  }

  view(): TemplateResult {
    const { app, settings } = this;
    if (!app.store.hello) return html`${head("Settings", "")}<p class="faint">Waiting for the run …</p>`;
    if (!settings) return html`${head("Settings", "")}<ix-empty-state header="No settings of a module" sub-header="This run was started without settings of a module. The start page of a folder opens them, and makes new ones."></ix-empty-state>`;
    const pages: [string, string][] = [...settings.windows.map((one): [string, string] => [one.word, one.title]), ...tools];
    const page = pages.some(([word]) => word === this.page) ? this.page : pages[0]?.[0] ?? "";
    const window = settings.window(page);
    const words_of = (keys: Iterable<string>): Set<string> => new Set([...keys].map((key) => key.split(/[ /]/)[0] ?? ""));
    const [changed, differing] = [words_of(settings.unwritten), words_of(settings.differs.keys())];
    return html`${head("Settings", `${settings.one.model}, ${settings.one.file.split("/").pop() ?? ""}`, html`<button type="button" class="quiet bordered" ?disabled=${!app.store.may_configure} @click=${() => void this.change(settings, { command: "configure undo" }, "the latest change was taken back")}>Undo</button>`)}
      ${(this.all?.length ?? 0) > 1 ? html`<div class="tools"><label class="inline">File <select class="field" @change=${(event: Event) => app.go("settings", [(event.target as HTMLSelectElement).value])}>${this.all?.map((one, i) => html`<option value=${i} ?selected=${one === settings}>${one.one.file}</option>`)}</select></label></div>` : nothing}
      ${settings.problem ? html`<p class="bad" role="alert">${settings.problem}</p>` : nothing}
      ${settings.findings.length ? html`<ul class="findings" tabindex="0" aria-label="What does not fit">${settings.findings.slice(0, 20).map((one) => html`<li class=${one.severity === "error" ? "bad" : "warn"}>${one.message}</li>`)}</ul>` : nothing}
      <div class="sides"><nav class="side tree" aria-label="Windows">${[...tree_of(settings.windows), { title: "Online", items: tools.map(([word, title]) => ({ word, title })) }].map((group) => html`${group.title ? html`<h3>${group.title}</h3>` : nothing}<ul class=${group.title ? "branch" : ""}>${group.items.map(({ word, title }) => html`<li><a class="project-node" href=${link("settings", [this.number, word])} aria-current=${word === page ? "page" : nothing}><span>${title}</span>${changed.has(word) ? html`<span class="warn">changed</span>` : differing.has(word) ? html`<span class="bad">differs</span>` : nothing}</a></li>`)}</ul>`)}</nav>
        <div class="main scrolls" tabindex="0" role="region" aria-label=${window?.title ?? "Tool"}><h2>${pages.find(([word]) => word === page)?.[1] ?? ""}</h2>${window ? (window.key ? this.list(settings, window) : this.form(settings, window)) : this.tool(settings, page)}</div></div>`;
  }
}
