// Ctrl+K: finds screens, nodes, objects by index, words, commands. Nothing found is said.
import { html, nothing, type TemplateResult } from "lit";
import { id_of, label_of, type ShownNode } from "../store/nodes.js";
import type { RunState } from "../store/protocol.js";
import type { App, Place, Screen } from "./app.js";
import { link } from "./route.js";

/** Everything of a state that has a place. */
export function places_of(screens: readonly Screen[], state: RunState | null, nodes: readonly ShownNode[]): Place[] {
  const places: Place[] = screens.map((one) => ({ title: one.title, detail: "Screen", href: link(one.id) }));
  if (!state) return places;
  for (const bus of state.buses) places.push({ title: `Bus ${bus.bus}`, detail: "Load, errors, frames", href: link("bus", [bus.bus]) });
  for (const node of nodes) {
    const name = `${id_of(node)} ${label_of(node)}`;
    places.push({ title: name, detail: `Node of ${node.bus}`, href: link("overview", [], { node: node.key }) });
    if (node.place >= 0) places.push({ title: `${name}: objects`, detail: `Node of ${node.bus}`, href: link("objects", [node.bus, node.node]) });
    if (node.node >= 1) places.push({ title: `${name}: frames`, detail: `Trace of ${node.bus}`, href: link("trace", [], { filter: `node=${node.node}` }) });
  }
  state.modules.forEach((module, i) => places.push({ title: `${module.name}: buffer memory`, detail: `Module of ${module.plc}`, href: link("module", [i]) }));
  return places;
}

/** Those that have all the words; what begins with them stands first. An index ("6041", "1018:01") leads to the objects of each node. */
export function found_places(places: readonly Place[], words: string, state: RunState | null, most = 14): Place[] {
  const terms = words.toLowerCase().split(/\s+/).filter(Boolean);
  const has_all = (place: Place): boolean => terms.every((term) => `${place.title} ${place.detail}`.toLowerCase().includes(term));
  const found = places.filter(has_all);
  const first = terms[0] ?? "";
  found.sort((a, b) => Number(b.title.toLowerCase().startsWith(first)) - Number(a.title.toLowerCase().startsWith(first)));
  const index = /^([0-9a-f]{4}(:[0-9a-f]{2})?)h?$/i.exec(words.trim())?.[1];
  const word = /^g(\d{1,5})$/i.exec(words.trim())?.[1];
  const extra: Place[] = [];
  if (index && state) for (const node of state.nodes) extra.push({ title: `Object ${index.toUpperCase()} of ${node.node} ${node.name}`, detail: node.bus, href: link("objects", [node.bus, node.node], { find: index.toUpperCase() }) });
  if (word && state) state.modules.forEach((module, i) => extra.push({ title: `G${word} of ${module.name}`, detail: "Buffer memory", href: link("module", [i], { find: `G${word}` }) }));
  if (words.trim() && !index && !word && state && found.length < most) {
    for (const node of state.nodes) extra.push({ title: `Objects of ${node.node} ${node.name} named “${words.trim()}”`, detail: node.bus, href: link("objects", [node.bus, node.node], { find: words.trim() }) });
  }
  return [...(index || word ? extra : found), ...(index || word ? found : extra)].slice(0, most);
}

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
      { title: app.is_hexadecimal ? "Show numbers in decimal" : "Show numbers in hexadecimal", detail: "View, key h", run: () => { app.is_hexadecimal = !app.is_hexadecimal; } },
    ];
    if (app.store.offers("pace") && app.store.may_operate) {
      const stands = app.store.state?.speed === 0;
      own.push({ title: stands ? "Run plant time" : "Pause plant time", detail: "Command", run: () => void app.run({ command: "pace", speed: stands ? 1 : 0 }) });
    }
    return own;
  }

  private all(): Place[] {
    const { store, screens, screen } = this.app;
    return found_places([...places_of(screens, store.state, store.nodes), ...this.commands(), ...(screen.places?.() ?? [])], this.words, store.state);
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
    return html`<dialog id="palette" aria-label="Go to" @close=${() => this.close()} @click=${(event: MouseEvent) => { if ((event.target as HTMLElement).id === "palette") this.close(); }}>
      <input id="palette-words" class="field" role="combobox" aria-expanded="true" aria-controls="palette-list" aria-activedescendant=${all.length ? `palette-${this.chosen}` : nothing} autocomplete="off" spellcheck="false"
        placeholder="Screen, node, object (6041, 1018:01), word (G10000), command" aria-label="Go to" .value=${this.words}
        @input=${(event: InputEvent) => { this.words = (event.target as HTMLInputElement).value; this.chosen = 0; this.app.redraw(); }} @keydown=${(event: KeyboardEvent) => this.key(event, all)}>
      <ul id="palette-list" role="listbox" aria-label="Found">${all.map((place, i) => html`<li id=${`palette-${i}`} role="option" aria-selected=${i === this.chosen} @click=${() => this.take(place)}>
        <span>${place.title}</span><span class="faint">${place.detail}</span></li>`)}</ul>
      ${all.length === 0 ? html`<p role="status" class="faint">Nothing found for “${this.words}”</p>` : nothing}
    </dialog>`;
  }
}
