// Faults of simulated buses as a form: what, which frames, when; what each has hit; Run has them begin anew.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconBugRuntime, iconPlay, iconTrashcan } from "../../frame/icons.js";
import { menu_button } from "../../frame/menu.js";
import type { Route } from "../../frame/route.js";
import { count_text } from "../../store/nodes.js";
import { fault_status, type BusFaults, type EditedFault, type FaultStatus } from "../../store/faults.js";
import { fault_kinds, fault_words, kind_of, shown_value, values_of, with_value, type FaultField } from "./fault_text.js";

export class FaultsScreen implements Screen {
  readonly id = "faults";
  readonly title = "Faults";
  readonly icon = iconBugRuntime;
  private bus = "";
  private edited = -1;  // place of the one whose form is open
  private as_text = false;
  private timer: ReturnType<typeof setInterval> | null = null;

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    this.bus = route.path[0] ?? this.bus;
    void this.app.load_faults();
    this.timer ??= setInterval(() => { if (!document.hidden) void this.app.load_faults(); }, 1000);
    const list = this.app.faults.bus(this.bus);
    if (list?.is_changed) {
      const place = Number(route.query["fault"] ?? list.edited.length - 1);
      this.edited = place < list.edited.length ? place : list.edited.length - 1;
      requestAnimationFrame(() => requestAnimationFrame(() => document.querySelector<HTMLElement>("#fault-run")?.focus()));
    }
  }

  closed(): void {
    if (this.timer) clearInterval(this.timer);
    this.timer = null;
  }

  private add(list: BusFaults, text: string): void {
    this.app.faults.add(list.bus, text.replace("PORT", list.ports.find((name) => name) ?? ""));
    this.edited = list.edited.length - 1;
    this.app.redraw();
  }

  private change(list: BusFaults, place: number, fault: EditedFault | null): void {
    this.app.faults.change(list.bus, place, fault);
    if (!fault) this.edited = -1;
    this.app.redraw();
  }

  private async run(list: BusFaults): Promise<void> {
    const done = await this.app.connection.commands.run({ command: "run faults", bus: list.bus, seed: list.seed, faults: list.edited.map(({ text, on }) => ({ text, on })) });
    this.app.faults.ran(list.bus, done.code === 0 ? "" : done.message || "refused");
    if (done.code === 0) this.app.faults.take(done.rows[0] as never);
    const on = list.edited.filter((one) => one.on).length;
    this.app.say(done.code === 0 ? (on ? `${count_text(on, "fault")} of ${list.bus} started` : `no fault acts on ${list.bus}`) : `${done.message}; the faults that acted before go on`, done.code === 0 ? "" : "error");
  }

  /** One that acts ends now; the others go on. */
  private async end(list: BusFaults, number: number, was_changed: boolean): Promise<void> {
    const done = await this.app.connection.commands.run({ command: "end fault", bus: list.bus, number });
    if (done.code !== 0) return this.app.say(done.message, "error");
    list.is_changed = was_changed;
    this.app.faults.take(done.rows[0] as never);
    this.app.say("the fault has ended");
  }

  /** The next frame that is chosen in the trace is the one that this fault is for. */
  private pick(list: BusFaults, place: number, fault: EditedFault, field: FaultField): void {
    this.app.pick({ words: `Choose the frame for “${kind_of(fault.text)?.title ?? "the fault"}”.`, take: (bus, id) => {
      if (bus !== list.bus) this.app.say(`${id}H is on ${bus}; the fault is for ${list.bus}`, "error");
      else this.change(list, place, { ...fault, text: with_value(fault.text, field, id) });
      this.app.go("faults", [list.bus], { fault: place });
    } });
    this.app.go("trace");
  }

  /** Remove means removed: what acts is ended, too. */
  private async remove(list: BusFaults, place: number): Promise<void> {
    const acting = list.acting.findIndex((one) => one.on && one.text === list.edited[place]?.text);
    const was_changed = list.is_changed;
    this.change(list, place, null);
    if (acting >= 0) await this.end(list, acting, was_changed);
  }

  private field(list: BusFaults, place: number, fault: EditedFault, field: FaultField): TemplateResult {
    const value = shown_value(field, values_of(fault.text));
    const set = (event: Event): void => this.change(list, place, { ...fault, text: with_value(fault.text, field, (event.target as HTMLInputElement | HTMLSelectElement).value) });
    const many = value.includes(", ");
    return html`<label class="stacked"><span>${field.label}</span>${field.kind === "port" && !many
      ? html`<select class="field" @change=${set}><option value="" ?selected=${value === ""}>${field.hint}</option>${list.ports.filter(Boolean).map((one) => html`<option ?selected=${one === value}>${one}</option>`)}</select>`
      : html`<input class="field" .value=${value} placeholder=${field.hint} spellcheck="false" autocomplete="off" @change=${set}>`}</label>`;
  }

  private form(list: BusFaults, place: number, fault: EditedFault): TemplateResult {
    const kind = kind_of(fault.text);
    return html`<div class="fault-form">
      ${kind && !this.as_text ? html`<p class="faint">${kind.title}: ${kind.meaning}.</p><div class="form-grid">${kind.fields.map((field) => this.field(list, place, fault, field))}</div>
        ${kind.fields.filter((one) => one.kind === "can-id").map((field) => html`<p class="buttons"><button type="button" class="quiet bordered" @click=${() => this.pick(list, place, fault, field)}>Pick a frame in the trace</button></p>`)}`
      : html`<label class="stacked"><span>As the plant file has it</span><textarea class="field mono" rows=${fault.text.split("\n").length + 1} spellcheck="false" .value=${fault.text} @change=${(event: Event) => this.change(list, place, { ...fault, text: (event.target as HTMLTextAreaElement).value })}></textarea></label>`}
      <label class="inline"><input type="checkbox" .checked=${this.as_text} @change=${(event: Event) => { this.as_text = (event.target as HTMLInputElement).checked; this.app.redraw(); }}>As text</label></div>`;
  }

  private row(list: BusFaults, fault: EditedFault, place: number, status: FaultStatus): TemplateResult {
    const is_open = place === this.edited;
    return html`<li class="fault" data-mood=${status.mood}><div class="fault-line">
      <input type="checkbox" aria-label=${`${fault_words(fault.text)}: on`} .checked=${fault.on} ?disabled=${!this.app.store.may_operate} @change=${(event: Event) => this.change(list, place, { ...fault, on: (event.target as HTMLInputElement).checked })}>
      <button type="button" class="fault-name" aria-expanded=${is_open} @click=${() => { this.edited = is_open ? -1 : place; this.app.redraw(); }}>${fault_words(fault.text)}</button>
      <span class="faint">${fault.from_file ? "of the plant file" : ""}</span><span class="status">${status.words}</span>
      <ix-icon-button size="16" variant="subtle-tertiary" icon=${iconTrashcan} aria-label=${`Remove ${fault_words(fault.text)}`} title="Remove" ?disabled=${!this.app.store.may_operate} @click=${() => void this.remove(list, place)}></ix-icon-button>
      </div>${is_open ? this.form(list, place, fault) : nothing}</li>`;
  }

  view(): TemplateResult {
    const { app } = this;
    const list = app.faults.bus(this.bus);
    if (!list) return html`${head("Faults", "")}<p class="faint">${app.faults.is_known ? "Faults are for simulated buses; this run has none." : "Waiting for the run …"}</p>`;
    const { edited, left } = fault_status(list.edited, list.acting);
    const off = !app.store.may_operate;
    const acting = list.acting.filter((one) => one.on).length;
    return html`${head("Faults", acting ? `${count_text(acting, "fault")} on ${list.bus}` : `none on ${list.bus}`)}
      <div class="tools">
        ${app.faults.buses.length > 1 ? html`<label class="inline">Bus <select class="field" @change=${(event: Event) => { this.edited = -1; app.go("faults", [(event.target as HTMLSelectElement).value]); }}>${app.faults.buses.map((one) => html`<option ?selected=${one.bus === list.bus}>${one.bus}</option>`)}</select></label>` : nothing}
        ${menu_button(app, "Add a fault", "Add a fault", () => fault_kinds.map((kind) => ({ title: kind.title, detail: kind.meaning, run: () => this.add(list, kind.start) })), off)}
        <label class="inline">Seed <input class="field number-field" type="number" min="0" .value=${String(list.seed)} ?disabled=${off} @change=${(event: Event) => { list.seed = Number((event.target as HTMLInputElement).value) || 0; list.is_changed = true; app.redraw(); }}></label>
        <ix-button id="fault-run" icon=${iconPlay} variant=${list.is_changed ? "primary" : "secondary"} ?disabled=${off || list.edited.length + list.acting.length === 0} @click=${() => void this.run(list)}>Run</ix-button>
        ${list.is_changed ? html`<span class="warn" role="status">Changed: Run has all faults of ${list.bus} begin anew</span>` : nothing}
      </div>
      ${list.problem ? html`<p class="bad" role="alert">${list.problem}. What acted before goes on.</p>` : nothing}
      <ul class="scrolls faults">${list.edited.map((fault, i) => this.row(list, fault, i, edited[i]!))}
        ${left.map((one) => html`<li class="fault" data-mood="waiting"><div class="fault-line"><span></span><span class="fault-name">${fault_words(one.text)}</span><span></span><span class="status">${one.words}</span><span></span></div></li>`)}
        ${list.edited.length + left.length === 0 ? html`<li><ix-empty-state header="No fault" sub-header=${`Add a fault here, or choose a frame in the trace and “Lose it”.`}></ix-empty-state></li>` : nothing}</ul>`;
  }
}
