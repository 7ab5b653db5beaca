// The program of a PLC: its text with live values, scan by scan; forced values; a run-time error at its line; its variables and tasks.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import type { App, Description, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconCodeFunction, iconPause, iconPlay, iconPlayStepwise } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import type { Columns } from "../../parts/grid.js";
import { count_text } from "../../store/nodes.js";
import { scan_facts, SourceLines, state_moods, state_words, task_words, value_text } from "../../store/program.js";
import type { ProgramState, ProgramView, VariableRow, ViewWish } from "../../store/protocol.js";
import { ViewRows } from "../../store/view_rows.js";
import { show_line, source_view } from "./source.js";
import { VariableForm, type FormVariable } from "./variable_form.js";

const parts = { source: "Source", variables: "Variables", tasks: "Tasks" } as const;
type Part = keyof typeof parts;

export class ProgramScreen implements Screen {
  readonly id = "program";
  readonly title = "PLC program";
  readonly icon = iconCodeFunction;
  readonly needs_parts = true;
  private plc = "";
  private part: Part = "source";
  private file = 0;
  private block = "";
  private wanted_line = 0;
  private chosen = "";
  private readonly lines = new SourceLines();
  private readonly variables = new ViewRows<VariableRow>();
  private readonly form: VariableForm;

  constructor(private readonly app: App) {
    this.form = new VariableForm(app);
    app.store.listen((event) => {
      const view = event?.event === "program" ? this.source : null;
      if (view && view.file === this.file) this.lines.take(view);
      const variables = event?.event === "variables" ? app.store.view("variables") : null;
      if (variables && variables.plc === this.program?.plc) this.variables.take(variables);
    });
  }

  opened(route: Route): void {
    const [plc = "", part = ""] = route.path;
    if (plc !== this.plc) this.restart();
    this.plc = plc;
    this.part = part in parts ? (part as Part) : "source";
    const file = Number(route.query["file"] ?? 0);
    if (file !== this.file) this.lines.restart();
    this.file = Number.isInteger(file) && file >= 0 ? file : 0;
    this.block = route.query["block"] ?? "";
    this.wanted_line = Number(route.query["line"] ?? 0);
    this.variables.restart(route.query["find"] ?? "");
  }

  private restart(): void {
    this.lines.restart();
    this.app.describe(null);
    this.app.store.forget_view("program");
    this.app.store.forget_view("variables");
    this.chosen = "";
  }

  private get program(): ProgramState | undefined {
    const programs = this.app.store.state?.programs ?? [];
    return this.plc ? programs.find((one) => one.plc === this.plc) : programs[0];
  }

  /** Of this PLC. */
  private get source(): ProgramView | null {
    const view = this.app.store.view("program");
    return view && view.plc === this.program?.plc ? view : null;
  }

  wishes(): ViewWish[] {
    const { program } = this;
    if (!program) return [];
    const { variables } = this;
    return [{ program: program.plc, file: this.file, ...this.lines.asked, ...(this.block ? { block: this.block } : {}) },
      ...(this.part === "variables" ? [{ variables: program.plc, find: variables.find, from: variables.from, count: variables.asked }] : [])];
  }

  private address(part: Part, query: Record<string, string | number | undefined> = {}): string {
    return link("program", [this.program?.plc ?? "", ...(part === "source" ? [] : [part])], query);
  }

  private go(query: Record<string, string | number | undefined>): void {
    location.hash = this.address("source", query);
  }

  private act(command: string, more: Record<string, unknown> = {}, done = ""): void {
    void this.app.run({ command, plc: this.program?.plc, ...more }, done ? { done } : {});
  }

  private describe(title: string, type: string, now: () => FormVariable & { type: string }, more: [string, string][] = []): void {
    this.chosen = title;
    this.form.begin();
    const plc = this.program?.plc ?? "";
    const description: Description = {
      title,
      get rows(): [string, string | undefined][] {
        const one = now();
        return [["Type", type], ["Value", one.value], ["Forced", one.forced ? "yes: the program does not change it" : ""], ...more];
      },
      more: () => html`${this.form.view(plc, now())}${now().writable ? nothing : html`<p class="faint">Written by the program, its module or a client of the PLC; not here.</p>`}`,
    };
    this.app.describe(description, true);
  }

  /** What a variable of this name is now, wherever it is in sight. */
  private now_of<Row extends FormVariable & { type: string }>(row: Row): FormVariable & { type: string } {
    for (let number = 1; number <= this.lines.count; ++number) {
      const found = this.lines.line(number)?.values.find((one) => one.name === row.name);
      if (found) return found;
    }
    return this.variables.rows.find((one) => one.name === row.name) ?? row;
  }

  private controls(program: ProgramState, view: ProgramView | null): TemplateResult | typeof nothing {
    const { store } = this.app;
    if (!store.offers("halt program")) return nothing;
    const off = !store.may_operate;
    const is_halted = program.state === "halted";
    return html`${is_halted ? html`<ix-button id="program-continue" icon=${iconPlay} ?disabled=${off} @click=${() => this.act("continue program", {}, "the program goes on")}>Continue</ix-button>`
      : html`<ix-button id="program-halt" icon=${iconPause} variant="secondary" ?disabled=${off || program.state !== "run"} @click=${() => this.act("halt program", {}, "no scan begins any more; plant time goes on")}>Halt</ix-button>`}
      <ix-button id="program-scan" icon=${iconPlayStepwise} variant="secondary" ?disabled=${off || !["run", "halted"].includes(program.state)} title="One more scan, then it halts" @click=${() => this.act("single scan", {}, "one scan")}>Single scan</ix-button>
      ${view?.breaks.length ? html`<button type="button" class="quiet" ?disabled=${off} @click=${() => this.act("clear breaks", {}, "no break is left")}>Clear ${count_text(view.breaks.length, "break")}</button>` : nothing}
      ${store.offers("change program") ? html`<button type="button" class="quiet bordered" ?disabled=${!store.may_configure} title="The files are compiled anew and go on with the values of now; with a mistake nothing is changed" @click=${() => this.act("change program", {}, "the program is changed; variables kept their values")}>Take over changed files</button>` : nothing}`;
  }

  private forced(view: ProgramView): TemplateResult | typeof nothing {
    if (view.forced.length === 0) return nothing;
    const off = !this.app.store.may_operate;
    return html`<div class="tools forced"><b class="warn">Forced</b>${view.forced.map((one) => html`<span class="value-chip" data-forced><span class="faint">${one.name}</span> ${value_text(one)} <button type="button" class="quiet" ?disabled=${off} aria-label=${`Release ${one.name}`} @click=${() => this.act("release variable", { name: one.name }, `${one.name} is released`)}>Release</button></span>`)}
      ${view.forced.length > 1 ? html`<button type="button" class="quiet" ?disabled=${off} @click=${() => this.act("release all", {}, "nothing is forced any more")}>Release all</button>` : nothing}</div>`;
  }

  private toggle_break(view: ProgramView, line: number): void {
    const is_set = view.breaks.some((one) => one.file === view.file && one.line === line);
    this.act(is_set ? "clear break" : "set break", { file: view.files[view.file], line }, is_set ? `line ${line}: no break` : `the program halts before line ${line}`);
  }

  private text(view: ProgramView): TemplateResult {
    if (this.wanted_line && this.lines.count) {
      const line = this.wanted_line;
      this.wanted_line = 0;
      requestAnimationFrame(() => show_line(line));
    }
    const blocks = view.blocks.length ? view.blocks : view.block ? [view.block] : [];
    return html`${view.files.length > 1 || blocks.length ? html`<div class="tools">
        ${view.files.length > 1 ? html`<div class="parts" role="group" aria-label="File">${view.files.map((name, i) => html`<a href=${this.address("source", { file: i })} aria-current=${i === view.file ? "page" : nothing}>${name}</a>`)}</div>` : html`<span>${view.files[0]}</span>`}
        ${blocks.length ? html`<label class="inline">Values of <select class="field" id="program-block" @change=${(event: Event) => this.go({ file: this.file, block: (event.target as HTMLSelectElement).value })}>${blocks.map((one) => html`<option ?selected=${one === view.block}>${one}</option>`)}</select></label>` : nothing}</div>` : nothing}
      ${source_view(view, this.lines, { may_break: this.app.store.may_operate && this.app.store.offers("set break"), toggle_break: (line) => this.toggle_break(view, line), chosen: this.chosen,
        choose: (one) => this.describe(one.name, one.type, () => this.now_of(one), one.device ? [["Kind", "device of the CPU"]] : []), redraw: () => this.app.redraw() })}`;
  }

  private readonly columns: Columns<VariableRow> = [
    { headerName: "Name", field: "name", flex: 2, minWidth: 200 },
    { headerName: "Type", field: "type", width: 120 },
    { headerName: "Value", colId: "value", flex: 1, minWidth: 120, valueGetter: (p) => (p.data ? value_text(p.data) : ""), cellClass: (p) => (p.data && p.data.type === "BOOL" && p.data.value === "TRUE" ? "configured" : "") },
    { headerName: "Forced", colId: "forced", width: 90, cellClass: "warn", valueGetter: (p) => (p.data?.forced ? "forced" : "") },
    { headerName: "Retain", colId: "retain", width: 90, valueGetter: (p) => (p.data?.retain ? "RETAIN" : "") },
    { headerName: "Comment", field: "comment", flex: 2, minWidth: 120 },
  ];

  private choose_variable(row: VariableRow): void {
    this.describe(row.name, row.type, () => this.variables.rows.find((one) => one.name === row.name) ?? row, [["Retain", row.retain ? "its value stays when the CPU stops" : ""], ["Comment", row.comment]]);
  }

  private watch(): TemplateResult {
    const { variables } = this;
    return html`<div class="tools"><input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Name, type or comment" autocomplete="off" spellcheck="false" maxlength="100" .value=${variables.find} @input=${(event: Event) => {
      variables.restart((event.target as HTMLInputElement).value);
      this.app.keep("program", [this.program?.plc ?? "", "variables"], { find: variables.find });
      this.app.redraw();
    }}><span class="faint">${count_text(variables.count, "variable")}</span></div>
      ${guard([this.program?.plc], () => html`<data-grid id="variables-grid" .label=${"Variables"} .empty=${"No variable with this name, type or comment"} .columns=${this.columns} .source=${variables}
        .row_classes=${{ "row-chosen": (row: VariableRow) => row.name === this.chosen }} .chosen=${(row: VariableRow) => this.choose_variable(row)} .opened=${() => document.querySelector<HTMLElement>("#variable-value")?.focus()}></data-grid>`)}`;
  }

  private tasks(view: ProgramView): TemplateResult {
    return html`<div class="scrolls" tabindex="0" role="region" aria-label="Tasks"><table class="rows full"><thead><tr><th scope="col">Task</th><th scope="col">Runs</th><th scope="col" class="figure">Priority</th><th scope="col">Programs</th><th scope="col" class="figure">Times</th></tr></thead>
      <tbody>${view.tasks.map((one) => html`<tr><td>${one.name}</td><td>${task_words(one)}</td><td class="figure">${one.priority}</td><td>${one.programs.join(", ")}</td><td class="figure">${one.runs}</td></tr>`)}</tbody></table></div>`;
  }

  view(): TemplateResult {
    const { app, program } = this;
    const programs = app.store.state?.programs ?? [];
    if (!program) return html`${head(this.title, "")}<ix-empty-state header=${app.store.state ? (programs.length ? `${this.plc} has no program` : "No program") : "Waiting for the run …"} sub-header=${app.store.state ? "A PLC executes what its line “program” in the plant file names" : ""}></ix-empty-state>`;
    const view = this.source;
    const error = view?.error;
    return html`${head(this.title, html`${program.plc}${view ? ` · ${view.cpu}` : ""} · <b class="cpu-state" data-mood=${state_moods[program.state]}>${state_words[program.state]}</b>`)}
      <div class="tools">
        ${programs.length > 1 ? html`<label class="inline">PLC <select class="field" @change=${(event: Event) => app.go("program", [(event.target as HTMLSelectElement).value])}>${programs.map((one) => html`<option ?selected=${one.plc === program.plc}>${one.plc}</option>`)}</select></label>` : nothing}
        <div class="parts" role="group" aria-label="What is shown">${(Object.keys(parts) as Part[]).map((part) => html`<a href=${this.address(part)} aria-current=${part === this.part ? "page" : nothing}>${parts[part]}</a>`)}</div>
        ${this.controls(program, view)}
      </div>
      ${view ? html`<dl class="inline-facts">${scan_facts(view.scan).map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}</dl>` : nothing}
      ${error ? html`<p class="lead" role="alert"><b>${error.code_text}</b> ${error.text}, at ${error.t.toFixed(3)} s <a href=${this.address("source", { file: error.file, line: error.line })}>Go to the line</a></p>` : nothing}
      ${view ? this.forced(view) : nothing}
      ${!view ? html`<p class="faint">Reading …</p>` : this.part === "variables" ? this.watch() : this.part === "tasks" ? this.tasks(view) : this.text(view)}`;
  }
}
