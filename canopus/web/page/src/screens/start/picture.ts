// A plant as a small picture: each bus a line, modules above it, devices below.
import { svg, type SVGTemplateResult, type TemplateResult, html } from "lit";
import type { PlantBus } from "./entries.js";

const [width, lane] = [200, 44];
const most_lanes = 2;
const most_devices = 12;

function bus_picture(bus: PlantBus, y: number): SVGTemplateResult {
  const modules = bus.modules.slice(0, 4);
  const devices = bus.devices.slice(0, most_devices);
  const step = (width - 20) / Math.max(1, devices.length);
  const size = Math.min(14, step - 3);
  return svg`<g transform=${`translate(0 ${y})`}><line class="wire-of" x1="6" x2=${width - 6} y1="22" y2="22"/>
    ${modules.map((_, i) => svg`<line class="stub" x1=${20 + 40 * i} x2=${20 + 40 * i} y1="14" y2="22"/><rect class="module-of" x=${8 + 40 * i} y="3" width="24" height="12" rx="2"/>`)}
    ${devices.map((_, i) => { const x = 10 + step * (i + 0.5); return svg`<line class="stub" x1=${x} x2=${x} y1="22" y2="29"/><rect class="device-of" x=${x - size / 2} y="29" width=${size} height="9" rx="1.5"/>`; })}</g>`;
}

/** Decoration: what it shows stands beside it in words. */
export function plant_picture(buses: readonly PlantBus[]): TemplateResult {
  const shown = buses.slice(0, most_lanes);
  return html`<svg class="plant-picture" viewBox=${`0 0 ${width} ${lane * Math.max(1, shown.length)}`} aria-hidden="true">${shown.map((bus, i) => bus_picture(bus, lane * i))}</svg>`;
}
