// The text of a program, line by line: breaks at the left, values at the right, the place of a run-time error and of a break.
import { html, nothing, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import { cells_of, is_on, value_text, type SourceLines } from "../../store/program.js";
import type { ProgramValue, ProgramView } from "../../store/protocol.js";

const height = 24;  // px of a line; .source li has it, too
const around = 12;  // lines that are drawn above and below what is seen

export interface SourceActions {
  may_break: boolean;
  toggle_break: (line: number) => void;
  choose: (value: ProgramValue) => void;
  chosen: string;
  redraw: () => void;
}

const place_of = (element: HTMLElement): [number, number] => [1 + Math.floor(element.scrollTop / height), 1 + Math.ceil((element.scrollTop + element.clientHeight) / height)];

/** The line comes into sight. */
export function show_line(line: number): void {
  const list = document.getElementById("source");
  if (list) list.scrollTop = Math.max(0, (line - 1) * height - list.clientHeight / 2);
}

function marked(text: string, values: readonly ProgramValue[]): (string | TemplateResult)[] {
  const parts: (string | TemplateResult)[] = [];
  let at = 0;
  for (const one of [...values].sort((a, b) => a.column - b.column)) {
    const begin = one.column - 1;
    if (begin < at || begin + one.length > text.length) continue;
    parts.push(text.slice(at, begin), html`<span class=${is_on(one) ? "operand on" : "operand"}>${text.slice(begin, begin + one.length)}</span>`);
    at = begin + one.length;
  }
  return [...parts, text.slice(at)];
}

/** Each value once in a line, in the order of its places. */
const of_line = (values: readonly ProgramValue[]): ProgramValue[] => [...values].sort((a, b) => a.column - b.column).filter((one, i, all) => all.findIndex((other) => other.name === one.name) === i);

function value_chip(one: ProgramValue, actions: SourceActions): TemplateResult {
  return html`<button type="button" class="value-chip" data-on=${is_on(one) ? "" : nothing} data-forced=${one.forced ? "" : nothing} aria-pressed=${actions.chosen === one.name} title=${`${one.name}: ${one.type}${one.forced ? ", forced" : ""}`} @click=${() => actions.choose(one)}><span class="faint">${one.name}</span> ${value_text(one)}${one.forced ? html` <b>forced</b>` : nothing}</button>`;
}

export function source_view(view: ProgramView, lines: SourceLines, actions: SourceActions): TemplateResult {
  const list = document.getElementById("source");
  const [seen_first, seen_last] = list ? place_of(list) : [1, 60];
  const first = Math.max(1, Math.min(seen_first - around, lines.count));
  const last = Math.min(lines.count, seen_last + around);
  const at = (place: { file: number; line: number } | undefined): number => (place && place.file === view.file ? place.line : 0);
  const [failed, halted] = [at(view.error), at(view.halted_at)];
  const breaks = new Set(view.breaks.filter((one) => one.file === view.file).map((one) => one.line));
  const row = (number: number): TemplateResult => {
    const line = lines.line(number);
    const has_break = breaks.has(number);
    const mark = number === failed ? "error" : number === halted ? "halted" : nothing;
    return html`<li data-mark=${mark}>
      ${line?.code && actions.may_break ? html`<button type="button" class="break" aria-pressed=${has_break} aria-label=${`Break at line ${number}`} title=${has_break ? "Take the break away" : "Stop before this line"} @click=${() => actions.toggle_break(number)}></button>` : html`<span class="break" data-on=${has_break ? "" : nothing}></span>`}
      <span class="line-number">${number}</span>
      <span class="text mono">${line ? cells_of(line.text).length > 1 ? cells_of(line.text).map((cell) => html`<span class="cell">${cell}</span>`) : marked(line.text, line.values) : ""}</span>
      <span class="values">${number === failed && view.error ? html`<b>${view.error.code_text} ${view.error.text.replace(/^[^ ]*:\d+:\d+: /, "")}</b>` : nothing}${number === halted ? html`<b>next</b>` : nothing}${line ? of_line(line.values).map((one) => value_chip(one, actions)) : nothing}</span></li>`;
  };
  const numbers = Array.from({ length: Math.max(0, last - first + 1) }, (_, i) => first + i);
  return html`<div class="scrolls source" id="source" tabindex="0" role="region" aria-label=${`Text of ${view.files[view.file] ?? ""}`} @scroll=${(event: Event) => { lines.see(...place_of(event.currentTarget as HTMLElement)); actions.redraw(); }}>
    <ol .style=${`--text-width: ${lines.width + 2}ch; height: ${lines.count * height}px; padding-top: ${(first - 1) * height}px`}>${repeat(numbers, (number) => number, row)}</ol></div>`;
}
