// A new plant or project in three steps: name and module, bus, devices from their files.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { iconTrashcan } from "../../frame/icons.js";
import { device_file_types, largest_device_file } from "../../parts/device_files.js";
import { submit_button } from "../../parts/submit_button.js";
import { bit_rates, count_text } from "../../store/nodes.js";

const usual_rate = 250;

interface Device {
  file: { name: string; text: string };
  node_id: string;
  name: string;
}

/** The lowest node-ID that none has. */
export function free_node_id(taken: readonly (string | number)[], first: number): number {
  const used = new Set(taken.map(Number));
  for (let id = first; id <= 127; ++id) if (!used.has(id)) return id;
  return 127;
}

/** Why the form cannot be sent; an empty text: it can. */
export function device_problem(devices: readonly Pick<Device, "node_id" | "name">[]): string {
  const ids = devices.map((one) => Number(one.node_id));
  if (ids.some((id) => !Number.isInteger(id) || id < 1 || id > 127)) return "A node-ID is a number from 1 to 127";
  const twice = ids.find((id, i) => ids.indexOf(id) !== i);
  return twice === undefined ? "" : `Node-ID ${twice} is there twice`;
}

export class Wizard {
  kind: "plant" | "project" | null = null;
  private step = 0;
  private name = "";
  private model = "";
  private rate = usual_rate;
  private devices: Device[] = [];

  constructor(private readonly app: App, private readonly models: () => readonly string[], private readonly open: (command: Record<string, unknown> & { command: string }) => Promise<void>) {}

  begin(kind: "plant" | "project"): void {
    Object.assign(this, { kind, step: 0, name: "", model: this.models()[0] ?? "", rate: usual_rate, devices: [] });
    this.show();
  }

  private show(): void {
    this.app.redraw();
    requestAnimationFrame(() => requestAnimationFrame(() => document.querySelector<HTMLElement>("#wizard .field, #wizard input[type=file]")?.focus()));
  }

  private go(step: number): void {
    this.step = step;
    this.show();
  }

  private async take(files: readonly File[]): Promise<void> {
    for (const file of files) {
      if (file.size > largest_device_file) {
        this.app.say(`${file.name} is larger than 1.5 MB, which is too large for the page`, "error");
        continue;
      }
      const id = free_node_id(this.devices.map((one) => one.node_id), this.kind === "plant" ? 2 : 1);
      this.devices = [...this.devices, { file: { name: file.name, text: await file.text() }, node_id: String(id), name: file.name.replace(/\.\w+$/, "") }];
    }
    this.app.redraw();
  }

  private get has_name(): boolean {
    return this.name.trim() !== "";
  }

  private get problem(): string {
    return this.step === 2 ? device_problem(this.devices) : "";
  }

  private next(): void {
    if (!this.has_name || this.problem) return;
    if (this.step < 2) this.go(this.step + 1);
    else this.create();
  }

  private create(): void {
    const devices = this.devices.map((one) => ({ file: one.file, node_id: Number(one.node_id), name: one.name.trim() }));
    const name = this.name.trim();
    void this.open(this.kind === "plant" ? { command: "new plant", name, model: this.model, bit_rate: `${this.rate}k`, devices } : { command: "new project", name, bit_rate: `${this.rate}k`, devices });
  }

  private first(): TemplateResult {
    return html`<label class="stacked"><span>Name, also of the folder</span><input class="field" id="wizard-name" maxlength="64" autocomplete="off" .value=${this.name} @input=${(event: Event) => { this.name = (event.target as HTMLInputElement).value; this.app.redraw(); }}></label>
      ${this.kind === "plant" ? html`<fieldset class="choices"><legend>Module of the PLC</legend>${this.models().map((one) => html`<label class="choice"><input type="radio" name="wizard-model" .checked=${one === this.model} @change=${() => { this.model = one; this.app.redraw(); }}><span>${one}</span></label>`)}</fieldset>` : nothing}`;
  }

  private second(): TemplateResult {
    return html`<label class="stacked"><span>Bit rate</span><select class="field" id="wizard-rate" @change=${(event: Event) => { this.rate = Number((event.target as HTMLSelectElement).value); this.app.redraw(); }}>${bit_rates.map((one) => html`<option value=${one} ?selected=${one === this.rate}>${one} kbit/s</option>`)}</select></label>
      <p class="faint">${this.kind === "plant" ? "The module is node 1 and master of this bus." : "The bit rate of all nodes of the project."}</p>`;
  }

  private third(): TemplateResult {
    const set = (i: number, change: Partial<Device>): void => { this.devices = this.devices.map((one, k) => (k === i ? { ...one, ...change } : one)); this.app.redraw(); };
    return html`<label class="drop-zone" @dragover=${(event: DragEvent) => event.preventDefault()} @drop=${(event: DragEvent) => { event.preventDefault(); void this.take([...(event.dataTransfer?.files ?? [])]); }}>
        <span>Drop device files here (EDS, DCF or XDD), or choose them</span><input type="file" multiple accept=${device_file_types} @change=${(event: Event) => { const input = event.target as HTMLInputElement; void this.take([...(input.files ?? [])]).then(() => { input.value = ""; }); }}></label>
      ${this.devices.length ? html`<table class="rows full"><thead><tr><th scope="col">Node-ID</th><th scope="col">Name</th><th scope="col">File</th><th scope="col"><span class="hidden">Remove</span></th></tr></thead><tbody>${this.devices.map((one, i) => html`<tr>
        <td><input class="field number-field" type="number" min="1" max="127" aria-label=${`Node-ID of ${one.name}`} .value=${one.node_id} @input=${(event: Event) => set(i, { node_id: (event.target as HTMLInputElement).value })}></td>
        <td><input class="field" maxlength="64" aria-label=${`Name of node ${one.node_id}`} .value=${one.name} @input=${(event: Event) => set(i, { name: (event.target as HTMLInputElement).value })}></td><td class="faint">${one.file.name}</td>
        <td><ix-icon-button size="16" variant="subtle-tertiary" icon=${iconTrashcan} aria-label=${`Remove ${one.name}`} title="Remove" @click=${() => { this.devices = this.devices.filter((_, k) => k !== i); this.app.redraw(); }}></ix-icon-button></td></tr>`)}</tbody></table>` : html`<p class="faint">Devices can be added later, too.</p>`}`;
  }

  view(): TemplateResult | typeof nothing {
    if (!this.kind) return nothing;
    const titles = [this.kind === "plant" ? "Name and module" : "Name", "Bus", "Devices"];
    const { problem, has_name } = this;
    const last = this.step < 2 ? "Next" : this.devices.length ? `Create with ${count_text(this.devices.length, "device")}` : "Create";
    const steps = [(): TemplateResult => this.first(), (): TemplateResult => this.second(), (): TemplateResult => this.third()];
    return html`<section class="panel" id="wizard" aria-label=${`New ${this.kind}`}><h2>New ${this.kind}</h2>
      <ol class="wizard-steps">${titles.map((title, i) => html`<li aria-current=${i === this.step ? "step" : nothing} data-done=${i < this.step ? "" : nothing}><span class="step-number">${i + 1}</span>${title}</li>`)}</ol>
      <form class="wizard-form" @submit=${(event: Event) => { event.preventDefault(); this.next(); }}>${steps[this.step]!()}
        ${problem ? html`<p class="bad" role="alert">${problem}</p>` : nothing}
        <p class="buttons">${this.step > 0 ? html`<ix-button variant="secondary" @click=${() => this.go(this.step - 1)}>Back</ix-button>` : nothing}
          ${submit_button(last, { id: "wizard-next", disabled: !has_name || problem !== "" })}
          <span class="grows"></span><ix-button variant="secondary" @click=${() => { this.kind = null; this.app.redraw(); }}>Cancel</ix-button></p></form></section>`;
  }
}
