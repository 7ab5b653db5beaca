// The boots of all slaves as a waterfall: a bar for each, with every step of CiA 302-2 and its time; why one does not go on.
import { make, set_text } from "./dom.js";
import { link_of } from "./newest_events.js";

const width = 600;

const kind_of = (step) => step.step === "booted" ? "done" : step.step.startsWith("failed") ? "failed" : step.error ? "retry" : "";
const milliseconds = (seconds) => seconds < 0.1 ? `${(seconds * 1000).toFixed(1)} ms` : `${seconds.toFixed(2)} s`;

/// Steps with their ends; the last one goes on until now, unless it is an end.
function spans(slave, now) {
  return slave.steps.map((step, place) => {
    const next = slave.steps[place + 1];
    const is_end = ["done", "failed"].includes(kind_of(step));
    return { ...step, end: is_end ? step.t : next ? next.t : now, kind: kind_of(step) };
  });
}

/// The steps of the newest attempt, and where it begins: an attempt ends with booted or failed.
function newest_attempt(steps) {
  const ended = steps.findLastIndex((step, place) => place < steps.length - 1 && ["done", "failed"].includes(step.kind));
  return steps.slice(ended + 1);
}

/// Time to places of the picture. A pause in which nobody booted, longer than all the boots together, is a small gap.
function axis(spans) {
  const busy = [];
  for (const span of [...spans].sort((a, b) => a.t - b.t)) {
    const last = busy.at(-1);
    if (last && span.t <= last.end) last.end = Math.max(last.end, span.end);
    else busy.push({ t: span.t, end: span.end });
  }
  const total = Math.max(0.001, busy.reduce((sum, one) => sum + one.end - one.t, 0));
  const pieces = [];
  for (const one of busy) {
    const last = pieces.at(-1);
    if (last && one.t - last.end <= total) last.end = one.end;
    else pieces.push({ ...one });
  }
  const gap = pieces.length > 1 ? Math.min(12, width / 4 / (pieces.length - 1)) : 0;
  const shown = Math.max(0.001, pieces.reduce((sum, one) => sum + one.end - one.t, 0));
  const scale = (width - gap * (pieces.length - 1)) / shown;
  let x = 0;
  for (const piece of pieces) {
    piece.x = x;
    x += scale * (piece.end - piece.t) + gap;
  }
  const place = (time) => {
    const piece = pieces.findLast((one) => one.t <= time) ?? pieces[0];
    return piece.x + scale * Math.min(time - piece.t, piece.end - piece.t);
  };
  return { place, gaps: pieces.slice(1).map((piece) => piece.x - gap / 2) };
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
  /// `bus_controls`: the BusControls, by which boots are tried again.
  constructor(section, bus_controls, say) {
    this.bus_controls = bus_controls;
    this.halts = section.querySelector("#boot-halts");
    this.section = section;
    this.list = section.querySelector("#boots");
    this.button = section.querySelector("#show-boots");
    this.is_open = false;
    this.button.addEventListener("click", () => {
      this.is_open = !this.is_open;
      this.button.setAttribute("aria-expanded", this.is_open);
      set_text(this.button, this.is_open ? "Hide" : "Show");
      this.list.hidden = this.halts.hidden = !this.is_open;
      say();
    });
  }

  get view() {
    return this.is_open ? { boots: true } : null;
  }

  draw(event, keep_children) {
    const all = event.slaves.map((slave) => ({ slave, spans: spans(slave, event.t) }));
    const time = axis(all.flatMap((one) => one.spans));
    const halted = event.masters.filter((master) => master.start_up === "halted");
    keep_children(this.halts, halted, (one) => `${one.bus}\u0000${one.node}`, (_, one) => this.make_halt(one), (item, one) => this.show_way(item, one.bus, true));
    keep_children(this.list, all, (one) => `${one.slave.bus}\u0000${one.slave.node}`, (_, one) => this.make_slave(one.slave), (item, one) => {
      this.fill_slave(item, one, time);
      const is_halted = halted.some((master) => master.bus === one.slave.bus && master.node === one.slave.master);
      this.show_way(item, one.slave.bus, !is_halted && ["failed", "retry"].includes(item.dataset.kind));
    });
    if (event.slaves.length === 0) this.list.replaceChildren(make("li", { class: "faint" }, "No master of this plant boots a slave."));
  }

  /// A button that has the master boot slaves anew, and what became of that.
  make_way(text, meaning, command) {
    const said = make("span", { role: "status" });
    const button = make("button", { type: "button", title: meaning }, text);
    button.addEventListener("click", () => this.bus_controls.run(button, said, command));
    return make("div", { class: "ways" }, button, said);
  }

  /// Hidden where the role or the bus does not allow it; what was said stays as long as it is wanted.
  show_way(item, bus, is_wanted) {
    item.lastElementChild.hidden = !is_wanted || !this.bus_controls.may_be_used_on(bus);
  }

  make_halt({ bus, node, name }) {
    const master = `master ${node}${name ? ` ${name}` : ""}`;
    return make("li", {}, make("span", {}, `${bus}: ${master} has halted its start-up: a mandatory slave was not booted. It boots no slave until its next start-up.`),
                this.make_way("Retry start-up", `resets the communication of ${master} and of all its nodes; its start-up begins anew`,
                              { command: "boot retry all", bus, node: "all", master: String(node) }));
  }

  make_slave({ bus, node, name, master }) {
    const way = this.make_way("Retry", `master ${master} resets the communication of node ${node}${name ? ` ${name}` : ""}, and boots it anew`,
                              { command: "boot retry", bus, node: String(node), master: String(master) });
    way.firstElementChild.setAttribute("aria-label", `Retry the boot of node ${node}${name ? ` ${name}` : ""}`);
    return make("li", {}, make("details", {}, make("summary", {}, make("b"), make("svg:svg", {
      class: "waterfall", viewBox: `0 0 ${width} 16`, preserveAspectRatio: "none", "aria-hidden": "true",
    }), make("span", { class: "result" })), make("table", {}, make("tbody"))), way);
  }

  fill_slave(item, { slave, spans: steps }, time) {
    const newest = newest_attempt(steps);
    const places = steps.map((step) => [time.place(step.t), time.place(step.end)]);
    const key = JSON.stringify([steps, places, time.gaps]);
    if (item.dataset.drawn === key) return;
    item.dataset.drawn = key;
    const [summary, table] = item.firstElementChild.children;
    const [name, picture, result] = summary.children;
    set_text(name, `${slave.bus} ${slave.node}${slave.name ? ` ${slave.name}` : ""}`);
    picture.replaceChildren(...time.gaps.map((x) => make("svg:line", { x1: x, x2: x, y1: 0, y2: 16, class: "pause" })), ...steps.map((step, place) => {
      const [x, end] = places[place];
      const bar = make("svg:rect", { x, y: 0, height: 16, width: Math.max(end - x, step.kind ? 3 : 1),
                                     class: `step step-${place % 2} ${step.kind}` });
      bar.append(make("svg:title", {}, `${step.step}, ${milliseconds(step.end - step.t)}`));
      return bar;
    }));
    const last = steps.at(-1);
    item.dataset.kind = last.kind;
    set_text(result, last.kind === "done" ? `booted in ${milliseconds(last.t - newest[0].t)}` : why(last) || last.step);
    table.tBodies[0].replaceChildren(...steps.map((step) => make("tr", { class: step.kind },
      make("th", { scope: "row" }, make("a", { href: link_of({ bus: slave.bus, t: step.t }), title: "The frames of this moment in the trace" }, `${step.t.toFixed(3)} s`)), make("td", {}, ["done", "failed"].includes(step.kind) ? "" : milliseconds(step.end - step.t)),
      make("td", {}, step.step), make("td", {}, why(step)))));
  }
}
