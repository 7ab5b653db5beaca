// A number that is plotted by a click on it, wherever it stands.
import { html, type TemplateResult } from "lit";
import type { App } from "../frame/app.js";
import { most_plots } from "../store/plots.js";

export function toggle_plot(app: App, key: string, name: string): void {
  const was_there = app.plots.has(key);
  if (!app.plots.toggle(key, name)) app.say(`at most ${most_plots} plots: end another one first`, "error");
  else app.say(was_there ? `${name}: plot ended` : `${name} is plotted`);
}

export function plot_button(app: App, key: string, name: string, text: string): TemplateResult {
  return html`<button type="button" class="number" aria-pressed=${app.plots.has(key)} title=${`Plot ${name}`} @click=${(event: Event) => {
    event.stopPropagation();
    toggle_plot(app, key, name);
  }}>${text}</button>`;
}

/** A number in a cell of a grid: the same, as an element. */
export function number_cell(app: App, key: string, name: string, text: string): HTMLElement {
  const button = document.createElement("button");
  button.type = "button";
  button.className = "number";
  button.textContent = text;
  button.title = `Plot ${name}`;
  button.tabIndex = -1;
  button.setAttribute("aria-pressed", String(app.plots.has(key)));
  button.addEventListener("click", (event) => {
    event.stopPropagation();
    toggle_plot(app, key, name);
    button.setAttribute("aria-pressed", String(app.plots.has(key)));
  });
  return button;
}
