// A module: its front with LEDs and signals, its buffer memory as a map with names, sources and age, what it shows of errors.
import { html, nothing, type TemplateResult } from "lit";
import { guard } from "lit/directives/guard.js";
import { repeat } from "lit/directives/repeat.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconPlc } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import type { Columns, DataGrid } from "../../parts/grid.js";
import { number_cell, plot_button, toggle_plot } from "../../parts/plot_button.js";
import { count_text, seconds_text } from "../../store/nodes.js";
import type { ErrorsView, ModuleState, ViewWish, WordRow } from "../../store/protocol.js";
import { ViewRows } from "../../store/view_rows.js";
import { WordForm } from "./word_form.js";
import { range_text, signal_groups, source_text, word_text } from "./word_text.js";

export class ModuleScreen implements Screen {
  readonly id = "module";
  readonly title = "Module";
  readonly icon = iconPlc;
  readonly needs_parts = true;
  private number = 0;
  private part: "memory" | "errors" = "memory";
  private rows = new ViewRows<WordRow>();
  private chosen = -1;
  private readonly form: WordForm;
  private was_hex = false;
  private confirms = false;

  constructor(private readonly app: App) {
    this.form = new WordForm(app);
    app.store.listen((event) => {
      const view = event?.event === "words" ? app.store.view("words") : null;
      if (view && view.number === this.number) this.rows.take(view);
    });
  }

  opened(route: Route): void {
    const number = Number(route.path[0] ?? 0);
    if (number !== this.number) this.app.describe(null);
    this.number = Number.isInteger(number) && number >= 0 ? number : 0;
    this.part = route.path[1] === "errors" ? "errors" : "memory";
    this.chosen = -1;
    this.confirms = false;
    this.rows.restart(route.query["find"] ?? "");
    this.app.store.forget_view("words");
    this.app.store.forget_view("errors");
  }

  wishes(): ViewWish[] {
    const { modules } = this.app.store.state ?? { modules: [] };
    if (this.number >= modules.length) return [];
    return [this.part === "memory" ? { words: this.number, find: this.rows.find, from: this.rows.from, count: this.rows.asked } : { errors: this.number }];
  }

  private get module(): ModuleState | undefined {
    return this.app.store.state?.modules[this.number];
  }

  private set_find(text: string): void {
    this.rows.restart(text);
    this.app.keep("module", [this.number], { find: text });
    this.app.redraw();
  }

  private choose(row: WordRow, module: ModuleState): void {
    this.chosen = row.address;
    this.form.begin();
    const now = (): WordRow => this.rows.rows.find((one) => one.address === row.address) ?? row;
    const key = `words ${this.number} ${row.address}`;
    const name = `${module.name} G${row.address} ${row.name}`;
    this.app.describe({
      title: row.name,
      get rows(): [string, string | undefined][] {
        const one = now();
        return [["Address", `G${one.address}`], ["Value", `${one.value} (${word_text(one.value, true)})`], ["Program", one.access], ["Range", range_text(one)], ["Initial", `${one.initial} (${word_text(one.initial, true)})`],
          ["PDO", one.pdo ? `${one.pdo}, CAN-ID ${one.can_id}H` : ""], ["From", one.from], ["Age", one.age === undefined ? "" : seconds_text(one.age)], ["Manual", one.section]];
      },
      more: () => html`<p class="buttons"><button type="button" class="quiet bordered" aria-pressed=${this.app.plots.has(key)} @click=${() => toggle_plot(this.app, key, name)}>Plot</button></p>
        ${row.can_id ? html`<h3>Go to</h3><p class="buttons"><a href=${link("trace", [], { filter: `id=${row.can_id}` })}>Frames of ${row.can_id}H</a></p>` : nothing}
        ${this.form.view(this.number, now())}`,
    }, true);
  }

  private front(module: ModuleState): TemplateResult {
    const words = module.words;
    return html`<div class="front">
      <ul class="leds" aria-label=${`LEDs of ${module.name}`}>${repeat(module.leds, (led) => led.name, (led) => html`<li class="led ${led.error ? "shows-error" : ""}" data-pattern=${module.on ? led.pattern : "off"} data-opposite=${led.opposite ? "" : nothing} title=${`${led.name}: ${led.pattern}${led.error ? ", shows an error" : ""}`}>
        <span class="lamp" aria-hidden="true"></span><span>${led.name}</span><span class="faint">${led.pattern}</span></li>`)}</ul>
      ${module.signals ? html`<div class="signals">${signal_groups(module.signals_on).map(([letter, names]) => html`<p><b>${letter} on</b> ${names.length ? names.map((name) => html`<span class="signal">${name}</span>`) : html`<span class="faint">none</span>`}</p>`)}</div>` : nothing}
      ${words.length ? html`<div class="watched">${words.map((word) => html`<span title=${word.name ?? nothing}><span class="faint">G${word.address}${word.name ? ` ${word.name}` : ""}</span> ${plot_button(this.app, `words ${this.number} ${word.address}`, `${module.name} G${word.address}`, word_text(word.value, this.app.is_hexadecimal))}</span>`)}</div>` : nothing}
    </div>`;
  }

  private columns(): Columns<WordRow> {
    const in_hex = (): boolean => this.app.is_hexadecimal;
    const { is_narrow } = this.app;
    return [
      { headerName: "Address", colId: "address", width: 88, cellClass: "figure", valueGetter: (p) => (p.data ? `G${p.data.address}` : "") },
      { headerName: "Name", field: "name", flex: 3, minWidth: 200 },
      { headerName: "Value", colId: "value", width: 96, cellClass: "figure", valueGetter: (p) => (p.data ? word_text(p.data.value, in_hex()) : ""), cellRenderer: (p: { data?: WordRow }) => (p.data ? number_cell(this.app, `words ${this.number} ${p.data.address}`, `${this.module?.name ?? ""} G${p.data.address} ${p.data.name}`, word_text(p.data.value, in_hex())) : "") },
      { headerName: "PDO and source", colId: "source", flex: 2, minWidth: 150, valueGetter: (p) => (p.data ? source_text(p.data) : "") },
      { headerName: "Age", colId: "age", width: 88, cellClass: "figure", valueGetter: (p) => (p.data?.age === undefined ? "" : seconds_text(p.data.age)) },
      { headerName: "Program", field: "access", width: 104, hide: is_narrow },
      { headerName: "Manual", field: "section", width: 128, hide: is_narrow },
    ];
  }

  private async act(command: string): Promise<void> {
    this.confirms = false;
    const done = await this.app.run({ command, number: this.number }, { done: "" });
    if (!done.failed) this.app.say(String((done.rows[0] as { said?: string } | undefined)?.said ?? "done"));
  }

  private errors(view: ErrorsView | null): TemplateResult {
    if (!view || view.number !== this.number) return html`<p class="faint">Reading …</p>`;
    const may = this.app.store.may_operate && this.app.store.offers("clear errors");
    return html`<div class="tools">
      ${may && view.clear.offered ? html`<ix-button variant="secondary" title=${view.clear.how} @click=${() => void this.act("clear errors")}>Clear errors</ix-button>` : nothing}
      ${may && view.reset.offered ? (this.confirms ? html`<span class="warn">The module leaves the network and starts again; settings that are not saved are lost.</span><ix-button variant="danger-primary" @click=${() => void this.act("reset module")}>Reset now</ix-button><ix-button variant="secondary" @click=${() => { this.confirms = false; this.app.redraw(); }}>Cancel</ix-button>`
        : html`<ix-button variant="secondary" title=${view.reset.how} @click=${() => { this.confirms = true; this.app.redraw(); }}>Reset …</ix-button>`) : nothing}
      ${view.clear.offered || view.reset.offered ? nothing : html`<span class="faint">${view.clear.how}</span>`}</div>
      <div class="scrolls" tabindex="0" role="region" aria-label="Errors of the module">${view.groups.length === 0 ? html`<ix-empty-state header="No errors" sub-header="Neither now, nor before"></ix-empty-state>` : view.groups.map((group) => html`<h3>${group.title.charAt(0).toUpperCase()}${group.title.slice(1)}</h3>
        ${group.lines.length === 0 ? html`<p class="faint">none</p>` : html`<table class="rows"><tbody>${group.lines.map((line) => html`<tr><td class="figure faint">${line.t === undefined ? "" : `${line.t.toFixed(3)} s`}</td><td class="faint">${line.where ?? ""}</td><td>${line.code ?? ""}</td><td>${line.meaning}</td></tr>`)}</tbody></table>`}`)}</div>`;
  }

  view(): TemplateResult {
    const { app, rows } = this;
    const modules = app.store.state?.modules ?? [];
    const { module } = this;
    if (!module) return html`${head("Module", "")}<ix-empty-state header=${app.store.state ? "No module" : "Waiting for the run …"} sub-header=${app.store.state ? "The plant file has no PLC with a module" : ""}></ix-empty-state>`;
    if (this.was_hex !== app.is_hexadecimal) {
      this.was_hex = app.is_hexadecimal;
      requestAnimationFrame(() => document.querySelector<DataGrid>("#words-grid")?.grid?.refreshCells({ force: true }));
    }
    const about = `${module.model ? `${module.model} · ` : ""}${module.plc} · ${module.bus}${module.node ? `, node ${module.node}` : ""} · ${module.on ? `CPU ${module.cpu}` : "no supply"}`;
    return html`${head("Module", about)}
      <div class="tools">
        <label class="inline">Module <select class="field" @change=${(event: Event) => app.go("module", [(event.target as HTMLSelectElement).value])}>${modules.map((one, i) => html`<option value=${i} ?selected=${i === this.number}>${one.name} (${one.plc})</option>`)}</select></label>
        <div class="parts" role="group" aria-label="What is shown">${(["memory", "errors"] as const).map((part) => html`<a href=${link("module", part === "memory" ? [this.number] : [this.number, part])} aria-current=${part === this.part ? "page" : nothing}>${part === "memory" ? "Buffer memory" : "Errors"}</a>`)}</div>
      </div>
      ${this.front(module)}
      ${this.part === "errors" ? this.errors(app.store.view("errors")) : html`<div class="tools">
        <input class="field grows" data-filter type="search" aria-label="Filter" placeholder="Name, address (G10000), PDO, CAN-ID or sender" autocomplete="off" spellcheck="false" maxlength="100" .value=${rows.find} @input=${(event: Event) => this.set_find((event.target as HTMLInputElement).value)}>
        <span class="faint">${count_text(rows.count, "word")}</span>
        <label class="inline"><input type="checkbox" .checked=${app.is_hexadecimal} @change=${(event: Event) => { app.is_hexadecimal = (event.target as HTMLInputElement).checked; app.redraw(); }}>Hexadecimal</label></div>
        ${guard([this.number, module.name, app.is_narrow], () => html`<data-grid id="words-grid" .label=${"Buffer memory"} .empty=${"No word with this name or address"} .columns=${this.columns()} .source=${rows}
          .row_classes=${{ "row-chosen": (row: WordRow) => row.address === this.chosen }} .chosen=${(row: WordRow) => this.choose(row, module)} .plotted=${(row: WordRow) => toggle_plot(app, `words ${this.number} ${row.address}`, `${module.name} G${row.address} ${row.name}`)} .opened=${() => document.querySelector<HTMLElement>("#word-value")?.focus()}></data-grid>`)}`}`;
  }
}
