// The 64 bits of a frame: one block for each mapped object.
import { html, svg, type TemplateResult } from "lit";
import type { Mapped } from "../../store/project.js";
import { short } from "./pdo_words.js";

export function frame_strip(mapping: readonly Mapped[]): TemplateResult {
  return html`<div class="frame-bits"><svg class="frame-strip" viewBox="0 0 64 6" preserveAspectRatio="none" role="img" aria-label=${mapping.map((one) => `${short(one)} ${one.bits} bits`).join(", ") || "nothing is mapped"}>
      ${svg`<rect width="64" height="6" class="track"/>`}${mapping.map((one, i) => svg`<rect x=${one.bit} y="0" width=${one.bits} height="6" class=${one.object ? `signal-${i % 6}` : "unused"}><title>${short(one)}: bits ${one.bit} to ${one.bit + one.bits - 1}</title></rect>`)}${[8, 16, 24, 32, 40, 48, 56].map((x) => svg`<line x1=${x} x2=${x} y1="0" y2="6"/>`)}</svg>
    <div class="byte-numbers" aria-hidden="true">${[0, 1, 2, 3, 4, 5, 6, 7].map((byte) => html`<span>${byte}</span>`)}</div></div>`;
}
