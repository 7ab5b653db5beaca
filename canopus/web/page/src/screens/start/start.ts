// What there is to begin with: a built-in plant, the plants and projects of the folder, settings of modules, what runs already; and what is new.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconAdd, iconHome, iconRocket } from "../../frame/icons.js";
import { link } from "../../frame/route.js";
import { submit_button } from "../../parts/submit_button.js";
import { count_text } from "../../store/nodes.js";
import { entries_of, type Entry, type Found } from "./entries.js";
import { plant_picture } from "./picture.js";
import { Wizard } from "./wizard.js";

const settings_models = ["RJ71CN91", "FX3U-CAN"];

export class StartScreen implements Screen {
  readonly id = "start";
  readonly title = "Start";
  readonly icon = iconHome;
  private found: Found | null = null;
  private recent: string[] = [];
  private find = "";
  private settings_name = "";
  private model = settings_models[0] ?? "";
  private copy_of = "";
  private is_opening = false;
  private confirms_exit = false;
  private readonly wizard: Wizard;

  constructor(private readonly app: App) {
    this.wizard = new Wizard(app, () => this.found?.models ?? [], (command) => this.open(command));
  }

  opened(): void {
    void this.load();
  }

  private async load(): Promise<void> {
    if (!this.app.store.offers("plants")) return;
    const done = await this.app.connection.commands.run({ command: "plants" });
    if (done.code === 0) this.found = done.rows[0] as unknown as Found;
    if (this.app.store.may_configure) {
      const recent = await this.app.connection.commands.run({ command: "recent projects" });
      if (recent.code === 0) this.recent = (recent.rows[0] as { recent?: string[] } | undefined)?.recent ?? [];
    }
    this.app.redraw();
  }

  /** It is a page of its own. */
  private async open(command: Record<string, unknown> & { command: string }): Promise<void> {
    if (this.is_opening) return;  // Enter was pressed twice
    this.is_opening = true;
    this.app.say("starting …", "running");
    const done = await this.app.connection.commands.run(command);
    this.is_opening = false;
    const url = String((done.rows[0] as { url?: string } | undefined)?.url ?? "");
    if (done.code === 0 && /^http:\/\/(127\.0\.0\.1|\[::1\]):\d+\//.test(url)) return location.assign(url);
    this.app.say(done.message || "it did not start", "error");
  }

  private no_choice(): TemplateResult {
    const { state } = this.app.store;
    return html`${head("Start", "")}<ix-empty-state header=${state ? state.plant || "This run" : "Waiting for the run …"} sub-header="This page shows one run. Plants and projects are chosen on the start page of a folder."></ix-empty-state><p class="buttons centered"><a href=${link("overview")}>Overview</a></p>`;
  }

  private card(one: Entry, off: boolean): TemplateResult {
    return html`<li><button type="button" class="plant-card" data-kind=${one.kind} ?disabled=${off} @click=${() => void this.open({ command: "open", path: one.path })}>
      ${one.kind === "plant" ? (one.buses.length ? plant_picture(one.buses) : nothing) : html`<span class="kind-mark" aria-hidden="true">${one.kind === "project" ? "CiA 306" : "XML"}</span>`}
      <b>${one.name}</b><span class=${one.problem ? "bad" : ""}>${one.problem || one.shows}</span><span class="faint path">${one.path}</span></button></li>`;
  }

  private in_folder(found: Found, off: boolean): TemplateResult {
    const entries = entries_of(found, this.find);
    return html`<section class="panel"><div class="tools"><h2>In this folder</h2><input class="field grows" data-filter type="search" aria-label="Search" placeholder="Name, module, device or file" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; this.app.redraw(); }}><span class="faint">${count_text(entries.length, "file")}</span></div>
      ${entries.length === 0 ? html`<p class="faint">${this.find ? `Nothing found for “${this.find}”` : "No plant, project or module settings in this folder"}</p>` : html`<ul class="plant-cards">${entries.map((one) => this.card(one, off))}</ul>`}</section>`;
  }

  private running(found: Found, off: boolean): TemplateResult | typeof nothing {
    if (found.running.length === 0) return nothing;
    const { app } = this;
    return html`<section class="panel"><h2>Running</h2><ul class="entries">${found.running.map((one) => html`<li class="running"><button type="button" class="entry" ?disabled=${off} @click=${() => void this.open({ command: "open", ...(one.path ? { path: one.path } : {}) })}><b>${one.path || "the built-in plant"}</b></button>
      <button type="button" class="quiet" ?disabled=${off} @click=${async () => { await app.run({ command: "end", number: one.number }, { done: `${one.path || "the built-in plant"} ends` }); await this.load(); }}>${one.path.endsWith(".xml") ? "Close" : "End"}</button></li>`)}</ul></section>`;
  }

  private new_settings(off: boolean): TemplateResult {
    const name = this.settings_name.trim();
    const create = (): void => { if (name) void this.open(this.copy_of ? { command: "save as", path: this.copy_of, name } : { command: "new settings", name, model: this.model }); };
    const files = this.found?.settings ?? [];
    return html`<section class="panel"><h2>New settings of a module</h2><form class="tools" @submit=${(event: Event) => { event.preventDefault(); create(); }}><label class="stacked"><span>Name</span><input class="field" id="settings-name" ?disabled=${off} .value=${this.settings_name} @input=${(event: Event) => { this.settings_name = (event.target as HTMLInputElement).value; this.app.redraw(); }}></label>
      ${files.length ? html`<label class="stacked"><span>Copy of</span><select class="field" ?disabled=${off} @change=${(event: Event) => { this.copy_of = (event.target as HTMLSelectElement).value; this.app.redraw(); }}><option value="">new</option>${files.map((one) => html`<option ?selected=${one === this.copy_of}>${one}</option>`)}</select></label>` : nothing}
      ${this.copy_of ? nothing : html`<label class="stacked"><span>Module</span><select class="field" ?disabled=${off} @change=${(event: Event) => { this.model = (event.target as HTMLSelectElement).value; }}>${settings_models.map((one) => html`<option>${one}</option>`)}</select></label>`}
      ${submit_button("Create", { id: "settings-create", disabled: off || name === "" })}</form></section>`;
  }

  private program(off: boolean): TemplateResult {
    const { app } = this;
    return html`<section class="panel"><h2>This program</h2><p class="faint">Version ${String(app.store.hello?.version ?? "")}</p>${this.confirms_exit
      ? html`<p class="warn">The program ends, and with it whatever it runs.</p><p class="buttons"><ix-button variant="danger-primary" @click=${() => void app.run({ command: "exit" }, { done: "the program ends" })}>Exit now</ix-button><ix-button variant="secondary" @click=${() => { this.confirms_exit = false; app.redraw(); }}>Cancel</ix-button></p>`
      : html`<ix-button variant="secondary" ?disabled=${off} @click=${() => { this.confirms_exit = true; app.redraw(); }}>Exit …</ix-button>`}</section>`;
  }

  view(): TemplateResult {
    const { app, found } = this;
    if (!app.store.offers("plants")) return this.no_choice();
    if (!found) return html`${head("Start", "")}<p class="faint">Reading the folder …</p>`;
    const off = !app.store.may_configure || this.is_opening;
    return html`${head("Start", found.folder,
      html`<ix-button id="start-try" icon=${iconRocket} ?disabled=${off} @click=${() => void this.open({ command: "open" })}>Try a plant</ix-button>`,
      app.store.offers("new plant") ? html`<ix-button variant="secondary" id="new-plant" icon=${iconAdd} ?disabled=${off} @click=${() => this.wizard.begin("plant")}>New plant</ix-button>` : nothing,
      html`<ix-button variant="secondary" id="new-project" icon=${iconAdd} ?disabled=${off} @click=${() => this.wizard.begin("project")}>New project</ix-button>`)}
      <div class="scrolls start"><div class="column">${this.wizard.view()}${this.in_folder(found, off)}</div>
        <div class="column">${this.running(found, off)}
        ${this.recent.length ? html`<section class="panel"><h2>Recent projects</h2><ul class="entries">${this.recent.map((path) => html`<li><button type="button" class="entry" ?disabled=${off} @click=${() => void this.open({ command: "open", path })}><b>${path}</b></button></li>`)}</ul></section>` : nothing}
        ${this.new_settings(off)}${this.program(off)}</div></div>`;
  }
}
