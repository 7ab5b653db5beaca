// Ctrl+K: finds screens, nodes, objects by index, words, commands. Nothing found is said.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Place } from "./app.js";
import { show_about, show_keys } from "./keys.js";
import { found_places, places_of } from "./places.js";

export class Palette {
  is_open = false;
  private words = "";
  private chosen = 0;

  constructor(private readonly app: App) {}

  open(): void {
    this.is_open = true;
    this.words = "";
    this.chosen = 0;
    this.app.redraw();
    requestAnimationFrame(() => requestAnimationFrame(() => {
      const dialog = document.querySelector<HTMLDialogElement>("#palette");
      if (dialog && !dialog.open) dialog.showModal();
      document.querySelector<HTMLInputElement>("#palette-words")?.focus();
    }));
  }

  close(): void {
    this.is_open = false;
    document.querySelector<HTMLDialogElement>("#palette")?.close();
    this.app.redraw();
  }

  private commands(): Place[] {
    const { app } = this;
    const own: Place[] = [
      { title: app.is_described ? "Hide the description" : "Show the description", detail: "View", run: () => app.show_description(!app.is_described) },
      { title: "About", detail: "Version, language, licences", run: () => show_about(app) },
      { title: "Keys", detail: "Help, key ?", run: () => show_keys(app) },
      { title: app.is_hexadecimal ? "Show numbers in decimal" : "Show numbers in hexadecimal", detail: "View, key h", run: () => { app.is_hexadecimal = !app.is_hexadecimal; } },
    ];
    if (app.store.offers("pace") && app.store.may_operate) {
      const stands = app.store.state?.speed === 0;
      own.push({ title: stands ? "Run plant time" : "Pause plant time", detail: "Command", run: () => void app.run({ command: "pace", speed: stands ? 1 : 0 }) });
    }
    return own;
  }

  private all(): Place[] {
    const { store, shown_screens, screen } = this.app;
    return found_places([...places_of(shown_screens, store.state, store.nodes), ...this.commands(), ...(screen.places?.() ?? [])], this.words, store.state);
  }

  private take(place: Place | undefined): void {
    if (!place) return;
    this.close();
    if (place.href) location.hash = place.href;
    else place.run?.();
    this.app.redraw();
  }

  private key(event: KeyboardEvent, all: readonly Place[]): void {
    if (event.key === "Enter") this.take(all[this.chosen]);
    else if (event.key === "ArrowDown") this.chosen = Math.min(this.chosen + 1, all.length - 1);
    else if (event.key === "ArrowUp") this.chosen = Math.max(this.chosen - 1, 0);
    else return;
    event.preventDefault();
    this.app.redraw();
  }

  view(): TemplateResult | typeof nothing {
    if (!this.is_open) return nothing;
    const all = this.all();
    const is_nothing = this.words.trim() !== "" && all.every((place) => place.is_guess);
    return html`<dialog id="palette" aria-label="Go to" @close=${() => this.close()} @click=${(event: MouseEvent) => { if ((event.target as HTMLElement).id === "palette") this.close(); }}>
      <input id="palette-words" class="field" role="combobox" aria-expanded="true" aria-controls="palette-list" aria-activedescendant=${all.length ? `palette-${this.chosen}` : nothing} autocomplete="off" spellcheck="false"
        placeholder="Screen, node, object (6041, 1018:01), word (G10000), command" aria-label="Go to" .value=${this.words}
        @input=${(event: InputEvent) => { this.words = (event.target as HTMLInputElement).value; this.chosen = 0; this.app.redraw(); }} @keydown=${(event: KeyboardEvent) => this.key(event, all)}>
      <ul id="palette-list" role="listbox" aria-label="Found">${all.map((place, i) => html`<li id=${`palette-${i}`} role="option" aria-selected=${i === this.chosen} @click=${() => this.take(place)}>
        <span>${place.title}</span><span class="faint">${place.detail}</span></li>`)}</ul>
      ${is_nothing ? html`<p role="status">Nothing found for “${this.words.trim()}”${all.length ? "; it may be the name of an object:" : ""}</p>` : nothing}
    </dialog>`;
  }
}
