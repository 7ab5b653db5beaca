// Statistics of the trace, as `canopus trace stats --json` has them.
import { html, nothing, type TemplateResult } from "lit";
import { count_text, percent_text } from "../../store/nodes.js";

interface Times {
  count: number;
  min_ms?: number;
  mean_ms?: number;
  max_ms?: number;
  jitter_ms?: number;
}

export interface Statistics {
  duration?: number;
  progress?: number;
  services?: Record<string, number>;
  channels?: {
    name: string; frames: number; error_frames: number; load?: number; busiest_second_load?: number;
    identifiers: { id: string; who: string; frames: number; cycle: Times }[];
    nodes: { node: number; name?: string; boot_ups: number; heartbeats: number; lost_heartbeats: number; emergencies: number; sdo: Times & { reads: number; writes: number; aborts: number; unanswered: number } }[];
  }[];
}

const ms = (times: Times, name: "min_ms" | "mean_ms" | "max_ms" | "jitter_ms"): string => (times.count ? (times[name] ?? 0).toFixed(3) : "");

function table(caption: string, heads: readonly string[], rows: readonly (readonly (string | number)[])[]): TemplateResult {
  const is_figure = (i: number): boolean => i > 0 && rows.some((cells) => cells[i] !== "") && rows.every((cells) => /^[\d.]*$/.test(String(cells[i])));
  return html`<h3>${caption}</h3><table class="rows"><thead><tr>${heads.map((one, i) => html`<th scope="col" class=${is_figure(i) ? "figure" : ""}>${one}</th>`)}</tr></thead>
    <tbody>${rows.map((cells) => html`<tr>${cells.map((one, i) => (i === 0 ? html`<th scope="row">${one}</th>` : html`<td class=${typeof one === "number" || /^[\d.]+$/.test(one) ? "figure" : ""}>${one}</td>`))}</tr>`)}</tbody></table>`;
}

export function statistics_view(figures: Statistics): TemplateResult {
  if (!figures.channels) return html`<p class="faint">Counting …</p>`;
  const services = Object.entries(figures.services ?? {}).filter(([, count]) => count > 0).map(([name, count]) => `${name} ${count}`);
  return html`<div class="scrolls" tabindex="0" role="region" aria-label="Statistics">
    <p>${(figures.duration ?? 0).toFixed(3)} s: ${services.join(", ") || "nothing yet"}${figures.progress === undefined ? nothing : `; ${Math.floor(100 * figures.progress)} % read`}</p>
    ${figures.channels.map((bus) => html`<h2>${bus.name}: ${count_text(bus.frames, "frame")}, ${count_text(bus.error_frames, "error frame")}${bus.load === undefined ? nothing : `, load ${percent_text(bus.load)}, busiest second ${percent_text(bus.busiest_second_load ?? 0)}`}</h2>
      ${table("CAN-IDs", ["CAN-ID", "Message", "Frames", "Cycle min, ms", "Mean", "Max", "Jitter"], bus.identifiers.map((one) => [`${one.id}H`, one.who, one.frames, ms(one.cycle, "min_ms"), ms(one.cycle, "mean_ms"), ms(one.cycle, "max_ms"), ms(one.cycle, "jitter_ms")]))}
      ${table("Nodes", ["Node", "Boot-ups", "Heartbeats", "Lost", "EMCY", "SDO reads", "Writes", "Aborts", "Unanswered", "SDO min, ms", "Mean", "Max"], bus.nodes.map((one) => [`${one.node} ${one.name ?? ""}`, one.boot_ups, one.heartbeats, one.lost_heartbeats, one.emergencies, one.sdo.reads, one.sdo.writes, one.sdo.aborts, one.sdo.unanswered, ms(one.sdo, "min_ms"), ms(one.sdo, "mean_ms"), ms(one.sdo, "max_ms")]))}`)}</div>`;
}
