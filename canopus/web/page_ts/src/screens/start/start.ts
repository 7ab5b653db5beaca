// What there is to begin with: a built-in plant, the plants and projects of the folder, settings of modules, what runs already.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconHome, iconRocket } from "../../frame/icons.js";
import { link } from "../../frame/route.js";
import { count_text } from "../../store/nodes.js";

interface Found {
  folder: string;
  plants: string[];
  projects: string[];
  settings: string[];
  running: { number: number; path: string }[];
}

type Kind = "plant" | "project" | "settings";
const kind_words: Record<Kind, string> = { plant: "Plant", project: "Project", settings: "Module settings" };
export const models = ["RJ71CN91", "FX3U-CAN"];

/** All of a folder that match, plants first. */
export function entries_of(found: Found, find: string): { kind: Kind; path: string }[] {
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  const all = [...found.plants.map((path) => ({ kind: "plant" as const, path })), ...found.projects.map((path) => ({ kind: "project" as const, path })), ...found.settings.map((path) => ({ kind: "settings" as const, path }))];
  return all.filter((one) => terms.every((term) => `${one.path} ${kind_words[one.kind]}`.toLowerCase().includes(term)));
}

export class StartScreen implements Screen {
  readonly id = "start";
  readonly title = "Start";
  readonly icon = iconHome;
  private found: Found | null = null;
  private recent: string[] = [];
  private find = "";
  private name = "";
  private settings_name = "";
  private model = models[0] ?? "";
  private is_opening = false;
  private confirms_exit = false;

  constructor(private readonly app: App) {}

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
    return html`${head("Start", "")}<ix-empty-state header=${state ? state.plant || "This run" : "Waiting for the run …"} sub-header="This page shows one run. “canopus web” in a folder opens the choice of plants and projects."></ix-empty-state><p class="buttons centered"><a href=${link("overview")}>Overview</a></p>`;
  }

  view(): TemplateResult {
    const { app, found } = this;
    if (!app.store.offers("plants")) return this.no_choice();
    if (!found) {
      return html`${head("Start", "")}<p class="faint">Looking for plants and projects …</p>`;
    }
    const off = !app.store.may_configure || this.is_opening;
    const entries = entries_of(found, this.find);
    return html`${head("Start", found.folder, html`<ix-button icon=${iconRocket} ?disabled=${off} @click=${() => void this.open({ command: "open" })}>Try a plant</ix-button>`)}
      <div class="scrolls start"><section class="panel"><div class="tools"><h2>In this folder</h2><input class="field grows" data-filter type="search" aria-label="Search" placeholder="Search plants, projects and settings" .value=${this.find} @input=${(event: Event) => { this.find = (event.target as HTMLInputElement).value; app.redraw(); }}><span class="faint">${count_text(entries.length, "file")}</span></div>
          ${entries.length === 0 ? html`<p class="faint">${this.find ? `Nothing found for “${this.find}”` : "No plant, project or module settings in this folder"}</p>` : html`<ul class="entries">${entries.map((one) => html`<li><button type="button" class="entry" ?disabled=${off} @click=${() => void this.open({ command: "open", path: one.path })}><b>${one.path}</b><span class="faint">${kind_words[one.kind]}</span></button></li>`)}</ul>`}</section>
        <div class="column">${found.running.length ? html`<section class="panel"><h2>Running</h2><ul class="entries">${found.running.map((one) => html`<li class="running"><button type="button" class="entry" ?disabled=${off} @click=${() => void this.open({ command: "open", ...(one.path ? { path: one.path } : {}) })}><b>${one.path || "the built-in plant"}</b></button><button type="button" class="quiet" ?disabled=${off} @click=${async () => { await app.run({ command: "end", number: one.number }, { done: `${one.path || "the built-in plant"} ends` }); await this.load(); }}>${one.path.endsWith(".xml") ? "Close" : "End"}</button></li>`)}</ul></section>` : nothing}
        ${this.recent.length ? html`<section class="panel"><h2>Recent projects</h2><ul class="entries">${this.recent.map((path) => html`<li><button type="button" class="entry" ?disabled=${off} @click=${() => void this.open({ command: "open", path })}><b>${path}</b></button></li>`)}</ul></section>` : nothing}
        <section class="panel"><h2>New project</h2><form class="tools" @submit=${(event: Event) => { event.preventDefault(); void this.open({ command: "new project", name: this.name.trim() }); }}><label class="stacked"><span>Name</span><input class="field" ?disabled=${off} .value=${this.name} @input=${(event: Event) => { this.name = (event.target as HTMLInputElement).value; app.redraw(); }}></label><ix-button type="submit" ?disabled=${off || !this.name.trim()} @click=${() => void this.open({ command: "new project", name: this.name.trim() })}>Create</ix-button></form></section>
        <section class="panel"><h2>New settings of a module</h2><form class="tools" @submit=${(event: Event) => event.preventDefault()}><label class="stacked"><span>Name</span><input class="field" ?disabled=${off} .value=${this.settings_name} @input=${(event: Event) => { this.settings_name = (event.target as HTMLInputElement).value; app.redraw(); }}></label><label class="stacked"><span>Module</span><select class="field" ?disabled=${off} @change=${(event: Event) => { this.model = (event.target as HTMLSelectElement).value; }}>${models.map((one) => html`<option>${one}</option>`)}</select></label>
          <ix-button ?disabled=${off || !this.settings_name.trim()} @click=${() => void this.open({ command: "new settings", name: this.settings_name.trim(), model: this.model })}>Create</ix-button></form></section>
        <section class="panel"><h2>This program</h2><p class="faint">Version ${String(app.store.hello?.version ?? "")}</p>${this.confirms_exit ? html`<p class="warn">The program ends, and with it whatever it runs.</p><p class="buttons"><ix-button variant="danger-primary" @click=${() => void app.run({ command: "exit" }, { done: "the program ends" })}>Exit now</ix-button><ix-button variant="secondary" @click=${() => { this.confirms_exit = false; app.redraw(); }}>Cancel</ix-button></p>` : html`<ix-button variant="secondary" ?disabled=${off} @click=${() => { this.confirms_exit = true; app.redraw(); }}>Exit …</ix-button>`}</section></div></div>`;
  }
}
