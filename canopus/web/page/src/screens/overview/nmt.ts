// NMT commands to one node, or to all of a bus [CiA 301 7.2.8.3.1].
import { html, nothing, type TemplateResult } from "lit";
import type { App } from "../../frame/app.js";
import { menu_button } from "../../frame/menu.js";

export const nmt_commands = [
  ["Start", "nmt start", "to Operational"],
  ["Stop", "nmt stop", "to Stopped: no PDO, no SDO"],
  ["Pre-operational", "nmt preop", "no PDO"],
  ["Reset node", "nmt reset", "all values as stored, else their defaults"],
  ["Reset communication", "nmt reset-comm", "1000H to 1FFFH as stored, else their defaults"],
] as const;

const may_command = (app: App, bus: string): boolean => app.store.may_operate && app.store.joins(bus);

/** `node`: a node-ID, or "all". */
export function nmt_menu(app: App, bus: string, node: string, label: string): TemplateResult | typeof nothing {
  if (!may_command(app, bus)) return nothing;
  return menu_button(app, "NMT", `NMT commands to ${label}`, () => nmt_commands.map(([name, command, meaning]) => ({
    title: node === "all" ? `${name}, all nodes` : name, detail: meaning, run: () => void app.run({ command, bus, node }, { done: `${name}: sent to ${label}` }) })));
}

export function nmt_buttons(app: App, bus: string, node: string, label: string): TemplateResult | typeof nothing {
  if (!may_command(app, bus)) return nothing;
  return html`<div class="buttons" role="group" aria-label=${`NMT commands to ${label}`}>${nmt_commands.map(([name, command, meaning]) =>
    html`<button type="button" class="quiet bordered" title=${meaning} @click=${() => void app.run({ command, bus, node }, { done: `${name}: sent to ${label}` })}>${name}</button>`)}</div>`;
}
