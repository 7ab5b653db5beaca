// Writes a variable once, or forces it: then it keeps its value whatever the program writes, until it is released.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { submit_button } from "../../parts/submit_button.js";

export interface FormVariable {
  name: string;
  value: string;
  forced: boolean;
  writable: boolean;
}

export class VariableForm {
  private value = "";
  private said = "";
  private mood = "";

  constructor(private readonly app: App) {}

  begin(): void {
    this.value = this.said = this.mood = "";
  }

  private async act(plc: string, name: string, command: "write variable" | "force variable" | "release variable", verb: string): Promise<void> {
    const value = this.value.trim();
    const with_value = command !== "release variable";
    const done = with_value && !value ? { code: 5, message: "expected a value", rows: [] } : await this.app.connection.commands.run({ command, plc, name, ...(with_value ? { value } : {}) });
    const now = (done.rows[0] as { value?: string } | undefined)?.value ?? value;
    if (done.code === 0) Object.assign(this, { said: with_value ? `${name} = ${now} ${verb}` : `${name} is ${verb}`, mood: "", value: "" });
    else Object.assign(this, { said: done.message || `failed with code ${done.code}`, mood: "bad" });
    this.app.redraw();
  }

  view(plc: string, one: FormVariable): TemplateResult | typeof nothing {
    const { store } = this.app;
    if (!one.writable || !store.may_operate || !store.offers("force variable")) return nothing;
    return html`<form class="write" @submit=${(event: Event) => { event.preventDefault(); void this.act(plc, one.name, "write variable", "written"); }}>
      <label class="stacked"><span>New value</span><input class="field" id="variable-value" autocomplete="off" spellcheck="false" maxlength="1024" placeholder=${one.value} .value=${this.value} @input=${(event: Event) => { this.value = (event.target as HTMLInputElement).value; }}></label>
      <p class="buttons">${submit_button("Write")}<ix-button variant="secondary" id="variable-force" title="It keeps this value, whatever the program writes" @click=${() => void this.act(plc, one.name, "force variable", "forced")}>Force</ix-button>
        ${one.forced ? html`<ix-button variant="secondary" id="variable-release" @click=${() => void this.act(plc, one.name, "release variable", "released")}>Release</ix-button>` : nothing}</p>
      ${this.said ? html`<p role="status" class=${this.mood}>${this.said}</p>` : nothing}</form>`;
  }
}
