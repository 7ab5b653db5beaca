// A number that is plotted by a click on it, wherever it stands.
import { html, type TemplateResult } from "lit";
import type { App } from "../frame/app.js";
import { most_plots } from "../store/plots.js";

export function toggle_plot(app: App, key: string, name: string): void {
  const was_there = app.plots.has(key);
  if (!app.plots.toggle(key, name)) app.say(`at most ${most_plots} plots: end another one first`, "error");
  else app.say(was_there ? `${name}: plot ended` : `${name}: plotted, see Plots`);
}

export function plot_button(app: App, key: string, name: string, text: string): TemplateResult {
  return html`<button type="button" class="number" aria-pressed=${app.plots.has(key)} title=${`Plot ${name}`} @click=${(event: Event) => {
    event.stopPropagation();
    toggle_plot(app, key, name);
  }}>${text}</button>`;
}
