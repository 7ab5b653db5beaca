// Why something cannot be dropped here: at the pointer, where people look.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";

const stays = 2500;  // ms behind the last move, so that it can be read when the mouse button was released
const width = 260;

export class RefusalTip {
  private text = "";
  private at: [number, number] = [0, 0];
  private timer: ReturnType<typeof setTimeout> | null = null;

  constructor(private readonly app: App) {}

  /** An empty text: nothing is refused. */
  show(text: string, x: number, y: number): void {
    this.text = text;
    this.at = [x, y];
    if (this.timer) clearTimeout(this.timer);
    this.timer = setTimeout(() => this.hide(), stays);
    this.app.redraw();
  }

  hide(): void {
    this.text = "";
    this.app.redraw();
  }

  view(): TemplateResult | typeof nothing {
    if (!this.text) return nothing;
    return html`<div class="refused" role="alert" .style=${`left:${Math.min(this.at[0] + 12, innerWidth - width)}px;top:${this.at[1] + 16}px`}>${this.text}</div>`;
  }
}
