// The boots of all slaves as a waterfall: a bar for each, with every step of CiA 302-2 and its time; why one does not go on.
import { make, set_text } from "./dom.js";

const width = 600;

const kind_of = (step) => step.step === "booted" ? "done" : step.step.startsWith("failed") ? "failed" : step.error ? "retry" : "";
const milliseconds = (seconds) => seconds < 0.1 ? `${(seconds * 1000).toFixed(1)} ms` : `${seconds.toFixed(2)} s`;

/// Steps with their ends; the last one goes on until now, unless it is an end.
function spans(slave, now) {
  return slave.steps.map((step, place) => {
    const next = slave.steps[place + 1];
    const is_end = ["done", "failed"].includes(kind_of(step));
    return { ...step, end: next ? next.t : is_end ? step.t : now, kind: kind_of(step) };
  });
}

/// Expected and received as hexadecimal, the abort and the sentence, as far as they are there.
function why(step) {
  const parts = [];
  if (step.reason) parts.push(step.reason);
  if (step.expected !== undefined) {
    const shown = (value) => typeof value === "number" ? `${value.toString(16).toUpperCase().padStart(8, "0")}H` : value;
    parts.push(`expected ${shown(step.expected)}, received ${shown(step.received)}`);
  }
  if (step.abort) parts.push(`abort ${step.abort}H`);
  return parts.join("; ");
}

export class BootView {
  constructor(section, say) {
    this.section = section;
    this.list = section.querySelector("#boots");
    this.button = section.querySelector("#show-boots");
    this.is_open = false;
    this.button.addEventListener("click", () => {
      this.is_open = !this.is_open;
      this.button.setAttribute("aria-pressed", this.is_open);
      this.list.hidden = !this.is_open;
      say();
    });
  }

  get view() {
    return this.is_open ? { boots: true } : null;
  }

  draw(event, keep_children) {
    const begin = Math.min(...event.slaves.map((slave) => slave.steps[0]?.t ?? event.t));
    const all = event.slaves.map((slave) => ({ slave, spans: spans(slave, event.t) }));
    const end = Math.max(begin + 0.001, ...all.flatMap((one) => one.spans.map((span) => span.end)));
    keep_children(this.list, all, (one) => `${one.slave.bus}\u0000${one.slave.node}`, () => this.make_slave(),
                  (item, one) => this.fill_slave(item, one, begin, end));
    if (event.slaves.length === 0) this.list.replaceChildren(make("li", { class: "faint" }, "No master of this plant boots a slave."));
  }

  make_slave() {
    return make("li", {}, make("details", {}, make("summary", {}, make("b"), make("svg:svg", {
      class: "waterfall", viewBox: `0 0 ${width} 16`, preserveAspectRatio: "none", "aria-hidden": "true",
    }), make("span", { class: "result" })), make("table", {}, make("tbody"))));
  }

  fill_slave(item, { slave, spans: steps }, begin, end) {
    const key = JSON.stringify([steps, begin, end]);
    if (item.dataset.drawn === key) return;
    item.dataset.drawn = key;
    const [summary, table] = item.firstElementChild.children;
    const [name, picture, result] = summary.children;
    set_text(name, `${slave.bus} ${slave.node}${slave.name ? ` ${slave.name}` : ""}`);
    const x = (time) => width * (time - begin) / (end - begin);
    picture.replaceChildren(...steps.map((step, place) => {
      const bar = make("svg:rect", { x: x(step.t), y: 0, height: 16, width: Math.max(x(step.end) - x(step.t), step.kind ? 3 : 1),
                                     class: `step step-${place % 2} ${step.kind}` });
      bar.append(make("svg:title", {}, `${step.step}, ${milliseconds(step.end - step.t)}`));
      return bar;
    }));
    const last = steps.at(-1);
    item.dataset.kind = last.kind;
    set_text(result, last.kind === "done" ? `booted in ${milliseconds(last.t - steps[0].t)}` : why(last) || last.step);
    table.tBodies[0].replaceChildren(...steps.map((step) => make("tr", { class: step.kind },
      make("th", { scope: "row" }, `${step.t.toFixed(3)} s`), make("td", {}, ["done", "failed"].includes(step.kind) ? "" : milliseconds(step.end - step.t)),
      make("td", {}, step.step), make("td", {}, why(step)))));
  }
}
