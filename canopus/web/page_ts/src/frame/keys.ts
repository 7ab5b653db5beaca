// The keys of the page, in the description.
import type { App } from "./app.js";

const keys: [string, string][] = [
  ["Ctrl+K", "go to a screen, node, object, word, or command"],
  ["/", "to the filter of the screen"],
  ["h", "numbers decimal or hexadecimal"],
  ["i", "description on or off"],
  ["Tab, Shift+Tab", "next, previous control"],
  ["Arrow keys", "in tables, in menus, among the nodes of a bus"],
  ["Enter", "chooses the row or node with the focus"],
  ["Escape", "closes a menu or a dialog"],
  ["?", "these keys"],
];

export function show_keys(app: App): void {
  app.describe({ title: "Keys", rows: keys }, true);
}
