// One menu for all: at the pointer or below a button. Keys move, Escape closes.
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "./app.js";

export interface MenuItem {
  title: string;
  detail?: string;
  run: () => void;
}

export class Menu {
  private items: MenuItem[] = [];
  private label = "";
  private back: HTMLElement | null = null;

  constructor(private readonly app: App) {
    addEventListener("pointerdown", (event) => {
      if (this.items.length && !event.composedPath().some((one) => one instanceof HTMLElement && one.id === "menu")) this.close(false);
    }, true);
  }

  open(items: MenuItem[], x: number, y: number, label: string): void {
    this.items = items;
    this.label = label;
    this.back = document.activeElement as HTMLElement | null;
    this.app.redraw();
    requestAnimationFrame(() => requestAnimationFrame(() => {
      const menu = document.getElementById("menu");
      if (!menu) return;
      menu.style.left = `${Math.max(4, Math.min(x, innerWidth - menu.offsetWidth - 8))}px`;
      menu.style.top = `${Math.max(4, Math.min(y, innerHeight - menu.offsetHeight - 8))}px`;
      menu.querySelector("button")?.focus();
    }));
  }

  open_below(button: HTMLElement, items: MenuItem[], label: string): void {
    const box = button.getBoundingClientRect();
    this.open(items, box.left, box.bottom + 2, label);
  }

  close(gives_back: boolean): void {
    this.items = [];
    if (gives_back) this.back?.focus();
    this.app.redraw();
  }

  private key(event: KeyboardEvent): void {
    const buttons = [...document.querySelectorAll<HTMLElement>("#menu button")];
    const at = buttons.indexOf(document.activeElement as HTMLElement);
    if (event.key === "Escape" || event.key === "Tab") this.close(true);
    else if (event.key === "ArrowDown") buttons[(at + 1) % buttons.length]?.focus();
    else if (event.key === "ArrowUp") buttons[(at + buttons.length - 1) % buttons.length]?.focus();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }

  view(): TemplateResult | typeof nothing {
    if (this.items.length === 0) return nothing;
    return html`<ul id="menu" role="menu" aria-label=${this.label} @keydown=${(event: KeyboardEvent) => this.key(event)}>${this.items.map((one) => html`<li role="none"><button type="button" role="menuitem" tabindex="-1" title=${one.detail ?? nothing}
      @click=${() => { this.close(true); one.run(); }}>${one.title}</button></li>`)}</ul>`;
  }
}

/** A button that opens a menu. */
export function menu_button(app: App, text: string, label: string, items: () => MenuItem[], disabled = false): TemplateResult {
  return html`<button type="button" class="quiet bordered" aria-haspopup="menu" aria-label=${label} ?disabled=${disabled} @click=${(event: Event) => app.menu.open_below(event.currentTarget as HTMLElement, items(), label)}>${text} ▾</button>`;
}
