// What goes into the devices: where to, what differs, Write, and each result, read back.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconSwapLeftRight } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { choose_bus } from "../../parts/choose_bus.js";
import { no_project } from "../../parts/no_project.js";
import { count_text } from "../../store/nodes.js";
import { plan_of, results_of, type PlanRow, type Project, type ResultRow } from "../../store/project.js";

const text = (value: unknown): string => (value === null || value === undefined ? "" : String(value));

export class TransferScreen implements Screen {
  readonly id = "transfer";
  readonly title = "Transfer";
  readonly icon = iconSwapLeftRight;
  private bus: string | undefined;
  private plan: PlanRow[] | null = null;
  private results: ResultRow[] = [];
  private is_busy = false;
  private wants_to_compare = false;

  constructor(private readonly app: App) {}

  /** What would be written is looked at as the screen opens, where no live bus is asked by that. */
  opened(route: Route): void {
    this.bus = route.path[0] ?? this.bus;
    this.plan = null;
    this.results = [];
    this.wants_to_compare = true;
  }

  private async compare(project: Project): Promise<boolean> {
    project.forget(null);
    this.is_busy = true;
    const done = await this.app.run({ command: "project write", bus: project.bus.bus }, { fine: [0, 1, 4], done: "" });
    this.is_busy = false;
    project.found(done.rows);
    // 1: a node does not answer; the others may be written.
    const is_known = !done.failed && (done.code !== 1 || done.rows.length > 0);
    if (!is_known && !done.failed) this.app.say(done.message || "no answer", "error");
    this.plan = is_known ? plan_of(done.rows) : null;
    const silent = [...project.states].filter(([, one]) => one.state === "no answer").map(([id]) => project.label(id));
    if (silent.length) this.app.say(`no answer from ${silent.slice(0, 3).join(", ")}${silent.length > 3 ? ` and ${silent.length - 3} more` : ""}`, "error");
    this.app.redraw();
    return is_known;
  }

  /** Nothing is written that was not in the list. */
  private async write(project: Project): Promise<void> {
    const shown = JSON.stringify(this.plan);
    this.results = [];
    if (!(await this.compare(project))) return;
    if (JSON.stringify(this.plan) !== shown) return this.app.say("the devices have changed since this list was made: look at it again", "error");
    this.is_busy = true;
    const done = await this.app.run({ command: "project write", bus: project.bus.bus, yes: true }, { fine: [0, 1, 4, 6], done: "", progress: (rows) => { this.results = results_of(rows); this.app.redraw(); } });
    this.is_busy = false;
    this.results = results_of(done.rows);
    project.found(done.rows);
    const bad = this.results.filter((row) => row.state !== "written").length;
    if (!done.failed) this.app.say(bad ? `${bad} of ${count_text(this.results.length, "value")} not written; the list says why` : `${count_text(this.results.length, "value")} written and read back`, bad ? "error" : "");
    if (!done.failed || this.results.length) this.plan = [];
    this.app.redraw();
  }

  private table(project: Project, heads: string[], rows: { node: number; object: string; cells: string[]; mood: string }[]): TemplateResult {
    return html`<div class="scrolls" tabindex="0" role="region" aria-label=${heads.join(", ")}><table class="rows full"><thead><tr>${heads.map((one) => html`<th scope="col">${one}</th>`)}</tr></thead>
      <tbody>${rows.map((row) => html`<tr class=${row.mood}><th scope="row"><a href=${link("project", [project.bus.bus, row.node], { find: row.object })}>${project.label(row.node)}</a></th><td>${row.object}</td>${row.cells.map((cell) => html`<td>${cell}</td>`)}</tr>`)}</tbody></table></div>`;
  }

  view(): TemplateResult {
    const { app, plan, results } = this;
    const project = app.project_of(this.bus);
    if (!project) return html`${head("Transfer", "")}${no_project(app)}`;
    if (this.wants_to_compare && project.is_loaded) {
      this.wants_to_compare = false;
      if (project.bus.joins && !project.bus.live && app.store.may_configure) void this.compare(project);
    }
    const to_write = plan?.filter((row) => row.is_to_be_written).length ?? 0;
    const where = project.bus.live ? html`<b class="bad">LIVE ${project.bus.bus}</b>` : `simulated bus ${project.bus.bus}`;
    const not_armed = project.bus.live && app.store.armed_until === 0;
    return html`${head("Transfer", html`to ${where}`)}
      <div class="tools">${choose_bus(app, "transfer", project)}
        <ix-button variant="secondary" ?disabled=${!app.store.may_configure || !project.bus.joins || this.is_busy} @click=${() => void this.compare(project)}>Compare</ix-button>
        <ix-button id="transfer-write" ?disabled=${to_write === 0 || this.is_busy || not_armed} @click=${() => void this.write(project)}>Write${to_write ? ` ${count_text(to_write, "value")}` : ""}</ix-button>
        ${not_armed ? html`<span class="warn">Writes on this live bus have to be armed first, in the bar</span>` : nothing}
        ${project.bus.joins ? nothing : html`<span class="warn">Commands cannot join this bus</span>`}</div>
      ${this.is_busy && !results.length ? html`<p class="faint" role="status">Asking the devices …</p>` : nothing}
      ${results.length ? this.table(project, ["Node", "Object", "Name", "Written", "Device has", "Result"], results.map((row) => ({ node: row.node, object: row.write, mood: row.state === "written" ? "good-text" : "bad", cells: [row.name ?? "", text(row.value), text(row.device), row.reason ?? row.state] })))
      : plan === null ? (this.is_busy ? nothing : html`<ix-empty-state header="Not compared yet" sub-header="Compare asks the devices and lists what would be written. Nothing is written by that."></ix-empty-state>`)
      : plan.length === 0 ? html`<ix-empty-state header="Nothing to write" sub-header="The devices that answer have what the project has"></ix-empty-state>`
      : this.table(project, ["Node", "Object", "Name", "Project", "Device", ""], plan.map((row) => ({ node: row.node, object: row.object, mood: row.is_to_be_written ? "" : "faint", cells: [row.name ?? "", text(row.project), text(row.device), row.is_to_be_written ? "will be written" : row.reason ?? ""] })))}`;
  }
}
