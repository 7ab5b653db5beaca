// Frames that somebody writes, for a simulated bus or an armed one. What is not a frame is said beside its line.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { count_text, seconds_text } from "../../store/nodes.js";
import { frame_problem, frames_of } from "./frame_text.js";

export class SendFrames {
  is_open = false;
  private bus = "";
  private text = "";
  private interval = "10ms";
  private repeat = "1";
  private is_sending = false;

  constructor(private readonly app: App) {}

  /** Buses that frames can be sent on. */
  private get buses(): string[] {
    return (this.app.store.state?.buses ?? []).filter((bus) => !bus.gone).map((bus) => bus.bus);
  }

  get is_offered(): boolean {
    return this.app.store.offers("send frames") && this.app.store.may_configure && this.buses.length > 0;
  }

  /** A line of the trace to begin with. */
  open(bus = "", frame = ""): void {
    this.is_open = true;
    if (bus) this.bus = bus;
    if (frame) this.text = [this.text.trim(), frame].filter(Boolean).join("\n");
    this.app.redraw();
    requestAnimationFrame(() => requestAnimationFrame(() => document.querySelector<HTMLElement>("#send-frames")?.focus()));
  }

  private async send(): Promise<void> {
    const frames = frames_of(this.text);
    this.is_sending = true;
    const done = await this.app.run({ command: "send frames", bus: this.bus || this.buses[0], frames, repeat: Number(this.repeat) || 1, ...(this.interval.trim() ? { interval: this.interval.trim() } : {}) }, { done: "" });
    this.is_sending = false;
    if (done.failed) return;
    const row = done.rows[0] as { frames?: number; seconds?: number } | undefined;
    this.app.say(`${count_text(row?.frames ?? frames.length, "frame")} sent in ${seconds_text(row?.seconds ?? 0)}`);
  }

  view(): TemplateResult | typeof nothing {
    if (!this.is_open || !this.is_offered) return nothing;
    const problem = frame_problem(this.text);
    const frames = frames_of(this.text);
    const bus = this.bus || this.buses[0] || "";
    const is_live = this.app.store.is_live;
    return html`<section class="panel send" aria-label="Send frames"><div class="tools"><h2>Send frames</h2>
        <label class="inline">Bus <select class="field" @change=${(event: Event) => { this.bus = (event.target as HTMLSelectElement).value; this.app.redraw(); }}>${this.buses.map((one) => html`<option ?selected=${one === bus}>${one}</option>`)}</select></label>
        <label class="inline">Interval <input class="field number-field" autocomplete="off" placeholder="none" .value=${this.interval} @input=${(event: Event) => { this.interval = (event.target as HTMLInputElement).value; }}></label>
        <label class="inline">Repeat <input class="field number-field" type="number" min="1" max="10000" .value=${this.repeat} @input=${(event: Event) => { this.repeat = (event.target as HTMLInputElement).value; }}></label>
        <span class="grows"></span>
        <ix-button id="send-now" ?disabled=${frames.length === 0 || problem !== "" || (is_live && this.app.store.armed_until === 0)} @click=${() => void this.send()}>Send ${frames.length > 1 ? count_text(frames.length, "frame") : ""}</ix-button>
        ${this.is_sending ? html`<ix-button variant="secondary" @click=${() => void this.app.connection.commands.run({ command: "stop frames" })}>Stop</ix-button>` : nothing}
        <ix-button variant="secondary" @click=${() => { this.is_open = false; this.app.redraw(); }}>Close</ix-button></div>
      <textarea id="send-frames" class="field mono" rows="3" spellcheck="false" aria-label="Frames, one in each line" aria-invalid=${problem !== ""} placeholder="One frame in each line: 601#4018100100000000, 123#R, 18FF1234#00" .value=${this.text} @input=${(event: Event) => { this.text = (event.target as HTMLTextAreaElement).value; this.app.redraw(); }}></textarea>
      ${problem ? html`<p class="bad" role="status">${problem}</p>` : is_live ? html`<p class="warn">LIVE: writes have to be armed in the bar.</p>` : nothing}</section>`;
  }
}
