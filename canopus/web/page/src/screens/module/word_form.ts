// Writes a word of the buffer memory, as a PLC program would.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { submit_button } from "../../parts/submit_button.js";
import type { WordRow } from "../../store/protocol.js";
import { word_of_text } from "./word_text.js";

export class WordForm {
  private value = "";
  private said = "";
  private mood = "";

  constructor(private readonly app: App) {}

  begin(): void {
    this.value = this.said = this.mood = "";
  }

  private async write(number: number, row: WordRow): Promise<void> {
    const value = word_of_text(this.value);
    if (value === null) {
      Object.assign(this, { said: "expected −32768 to 65535, or hexadecimal as 12ABH", mood: "bad" });
      return this.app.redraw();
    }
    const done = await this.app.connection.commands.run({ command: "write word", number, address: row.address, value });
    if (done.code === 0) Object.assign(this, { said: `G${row.address} = ${this.value.trim()} written`, mood: "", value: "" });
    else Object.assign(this, { said: done.message || `failed with code ${done.code}`, mood: "bad" });
    this.app.redraw();
  }

  /** Where the program offers it, for words that a PLC program may write. */
  view(number: number, row: WordRow): TemplateResult | typeof nothing {
    if (!row.access.includes("write") || !this.app.store.offers("write word") || !this.app.store.may_operate) return nothing;
    const write = (): void => void this.write(number, row);
    return html`<form class="write" @submit=${(event: Event) => { event.preventDefault(); write(); }}><label class="stacked"><span>New value</span><input class="field" id="word-value" autocomplete="off" placeholder="decimal, or 12ABH" .value=${this.value} @input=${(event: Event) => { this.value = (event.target as HTMLInputElement).value; }}></label>
      <p class="buttons">${submit_button("Write")}</p>${this.said ? html`<p role="status" class=${this.mood}>${this.said}</p>` : nothing}</form>`;
  }
}
