// The keys of the page, and what the program is, in the description.
import { html } from "lit";
import type { App } from "./app.js";

const keys: [string, string][] = [
  ["Ctrl+K", "go to a screen, node, object, word, or command"],
  ["/", "to the filter of the screen"],
  ["h", "numbers decimal or hexadecimal"],
  ["i", "description on or off"],
  ["Tab, Shift+Tab", "next, previous control"],
  ["Arrow keys", "in tables, in menus, among the nodes of a bus"],
  ["Enter", "chooses the row or node with the focus"],
  ["p", "plots the value of the row with the focus"],
  ["m", "in the trace: sets a mark at the chosen line, or takes it away"],
  ["Escape", "closes a menu or a dialog"],
  ["?", "these keys"],
];

/** Which program this is; the licences of what the page is made of stand beside its files. */
export function show_about(app: App): void {
  app.describe({ title: "About", rows: [["Program", "Canopus"], ["Version", app.store.hello?.version ?? "not known yet"], ["Language", "English"]], more: () => html`<p><a href="licences.txt" target="_blank" rel="noopener">Licences of the page's packages</a></p>` }, true);
}

export function show_keys(app: App): void {
  app.describe({ title: "Keys", rows: keys }, true);
}
