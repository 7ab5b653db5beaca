// A bus: load over time by class of frame, error counters, error frames, and the bits of the last frame of an identifier.
import { make, set_text } from "./dom.js";

const by_id = (id) => document.getElementById(id);
const kept = 240;  // of the load, four a second

/// "0.9 … 1.4 ms, mean 1.1 ms, jitter 0.5 ms"
function times_text({ least, mean, most }) {
  const [factor, unit] = most >= 1 ? [1, "s"] : most >= 0.001 ? [1000, "ms"] : [1e6, "µs"];
  const text = (seconds) => (factor * seconds).toFixed(unit === "µs" ? 0 : 3);
  return `${text(least)} … ${text(most)} ${unit}, mean ${text(mean)} ${unit}, jitter ${text(most - least)} ${unit}`;
}

export class BusView {
  /// `say`: called when what it looks at has changed.
  constructor(section, say) {
    this.section = section;
    this.say = say;
    this.number = null;
  }

  /// `id`: three hexadecimal digits, of the frame whose bits are shown; or nothing.
  open(number, name, id) {
    if (number !== this.number) {
      this.loads = [];
      this.before = null;
      this.most_waiting = new Map();  // since the bus is looked at, by node
      for (const box of ["bus-load", "errors", "error-frames", "can-ids", "counters"]) this.empty(by_id(box));
    }
    this.empty(by_id("strip"));
    this.number = number;
    this.id = /^([0-9A-F]{3}|[0-9A-F]{8})$/i.test(id ?? "") ? id.toUpperCase() : null;
    const was_hidden = this.section.hidden;
    set_text(by_id("bus-title"), `Bus ${name}`);
    this.section.hidden = false;
    if (was_hidden) by_id("bus-title").focus();
    this.say();
  }

  empty(box) {
    box.replaceChildren();
    delete box.dataset.text;
  }

  close() {
    this.section.hidden = true;
    this.number = null;
    this.say();
  }

  /// What the server is asked for, or null.
  get view() {
    if (this.number === null) return null;
    return this.id ? { traffic: this.number, can_id: parseInt(this.id, 16), ...(this.id.length === 8 ? { extended: true } : {}) } : { traffic: this.number };
  }

  draw(event) {
    if (event.number !== this.number) return;
    this.add_load(event);
    this.draw_errors(event);
    this.draw_error_frames(event);
    set_text(by_id("bus-sync"), event.sync ? `SYNC: ${event.sync.count + 1} times, every ${times_text(event.sync)}` : "No SYNC is sent, or one at most.");
    this.draw_ids(event);
    if (event.frame) this.draw_strip(event.frame);
  }

  add_load(event) {
    const before = this.before;
    this.before = event;
    if (!before || event.t <= before.t) return;
    const shares = event.classes.map((one, i) => Math.max(0, (one.busy - before.classes[i].busy) / (event.t - before.t)));
    this.loads.push({ t: event.t, shares });
    if (this.loads.length > kept) this.loads.shift();
    const most = Math.max(0.01, ...this.loads.map((load) => load.shares.reduce((a, b) => a + b, 0)));
    const top = [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1].find((one) => one >= most) ?? 1;
    const begin = this.loads[0].t;
    const span = event.t - begin || 1;
    const areas = event.classes.map((one, i) => {
      const sum = (load, upto) => load.shares.slice(0, upto).reduce((a, b) => a + b, 0);
      const point = (load, upto) => `${(1000 * (load.t - begin) / span).toFixed(1)},${(100 - 100 * sum(load, upto) / top).toFixed(2)}`;
      const points = [...this.loads.map((load) => point(load, i + 1)), ...[...this.loads].reverse().map((load) => point(load, i))];
      return make("svg:polygon", { points: points.join(" "), class: `class-${i}` });
    });
    const percent = (value) => `${(100 * value).toFixed(2)} %`;
    by_id("bus-load").replaceChildren(
      make("div", { class: "axis" }, make("span", {}, percent(top)), make("span", {}, "0 %")),
      make("svg:svg", { viewBox: "0 0 1000 100", preserveAspectRatio: "none", role: "img",
                        "aria-label": `Load of ${event.bus} over ${span.toFixed(0)} s` }, ...areas),
      make("ul", { class: "legend" }, ...event.classes.map((one, i) => [one, i]).filter(([one]) => one.frames).map(([one, i]) =>
        make("li", {}, make("svg:svg", { viewBox: "0 0 8 8", "aria-hidden": "true" }, make("svg:rect", { width: 8, height: 8, class: `class-${i}` })),
             `${one.class} ${percent(shares[i])}, ${one.frames} frames`))));
  }

  /// TEC and REC come with the state.
  draw_counters(state) {
    if (this.number === null) return;
    const bus = state.buses[this.number]?.bus;
    const nodes = state.nodes.filter((node) => node.bus === bus);
    const text = JSON.stringify(nodes.map((node) => [node.node, node.tec, node.rec, node.controller, node.sdo, node.waiting]));
    const box = by_id("counters");
    if (box.dataset.text === text) return;
    box.dataset.text = text;
    const bar = (name, value) => make("svg:svg", { class: "counter", viewBox: "0 0 260 10", preserveAspectRatio: "none", role: "img", "aria-label": `${name} ${value}` },
      make("svg:rect", { x: 0, y: 2, height: 6, width: Math.min(260, value), class: value > 127 ? "failed" : value >= 96 ? "warned" : "" }),
      ...[96, 128, 256].map((line) => make("svg:line", { x1: line, x2: line, y1: 0, y2: 10 })));
    box.replaceChildren(make("table", {},
      make("thead", {}, make("tr", {}, ...["Node", "TEC", "96 · 128 · 256", "REC", "96 · 128 · 256", "State", "Waiting frames", "SDO answers after"].map((name) => make("th", { scope: "col" }, name)))),
      make("tbody", {}, ...nodes.map((node) => make("tr", {}, make("th", { scope: "row" }, `${node.node} ${node.name}`),
        make("td", {}, this.plot_button(node, "tec")), make("td", {}, bar("TEC", node.tec)),
        make("td", {}, this.plot_button(node, "rec")), make("td", {}, bar("REC", node.rec)), make("td", {}, node.controller), make("td", {}, this.waiting_text(node)),
        make("td", {}, node.sdo ? times_text(node.sdo) : "-"))))));
  }

  /// Now, and at most since the bus is looked at.
  waiting_text(node) {
    const key = `${node.node} ${node.name}`;
    this.most_waiting.set(key, Math.max(node.waiting, this.most_waiting.get(key) ?? 0));
    return `${node.waiting}, at most ${this.most_waiting.get(key)}`;
  }

  plot_button(node, name) {
    const key = `state ${node.bus} ${node.node} ${name}`;
    const title = `${name.toUpperCase()} of ${node.bus} ${node.node} ${node.name}`;
    return make("button", { type: "button", class: "number", title: `Plot ${title}`, "data-plot": key }, String(node[name]));
  }

  draw_errors(event) {
    const box = by_id("errors");
    const text = JSON.stringify(event.errors);
    if (box.dataset.text === text) return;
    box.dataset.text = text;
    box.replaceChildren(event.errors.length === 0 ? make("p", {}, "None since the start.") : make("table", {},
      make("thead", {}, make("tr", {}, ...["Error", "Found in", "Error frames"].map((name) => make("th", { scope: "col" }, name)))),
      make("tbody", {}, ...event.errors.map((one) => make("tr", {}, make("td", {}, one.error), make("td", {}, one.field), make("td", {}, String(one.count)))))));
  }

  /// The latest error frames: who found what where; of the newest one its bits.
  draw_error_frames(event) {
    const box = by_id("error-frames");
    const text = JSON.stringify(event.error_frames);
    if (box.dataset.text === text) return;
    box.dataset.text = text;
    const sentence = (one) => `${one.at.toFixed(6)} s: ${one.error} error in ${one.field}, bit ${one.bit}, found by ${one.name ?? "a node outside"}${one.transmitter ? ", which sends it" : ""}${one.finders > 1 ? ` and ${one.finders - 1} more` : ""}`;
    const [newest] = event.error_frames;
    const parts = [];
    for (const bit of newest?.bits ?? []) {
      if (parts.at(-1)?.name !== bit.part) parts.push({ name: bit.part, bits: [] });
      parts.at(-1).bits.push(bit);
    }
    box.replaceChildren(make("ul", { "aria-label": "The latest error frames" }, ...event.error_frames.map((one) => make("li", {}, sentence(one)))),
      ...(parts.length ? [make("div", { class: "fields" }, ...parts.map((part) => make("div", { class: "field" }, make("span", { class: "field-name" }, part.name),
        make("span", { class: "bits" }, ...part.bits.map((bit, i) => make("span", { class: `bit ${bit.level} ${part.name === "frame" && i === part.bits.length - 1 ? "wrong" : ""}` }, bit.level === "d" ? "0" : "1"))))))] : []));
  }

  draw_ids(event) {
    const box = by_id("can-ids");
    const text = JSON.stringify([event.can_ids, this.id]);
    if (box.dataset.text === text) return;
    box.dataset.text = text;
    box.replaceChildren(...event.can_ids.map((id) => make("a", { href: `#bus/${event.number}/${id}`, class: "can-id",
      ...(id === this.id ? { "aria-current": "true" } : {}) }, id)));
  }

  draw_strip(event) {
    if (event.can_id !== this.id) return;
    const box = by_id("strip");
    const fields = [];
    event.bits.forEach((bit, place) => {
      bit.lost = event.lost?.filter((one) => one.bit === place).map((one) => `${one.name} (${one.can_id}H)`).join(", ");
    });
    for (const bit of event.bits) {
      if (fields.at(-1)?.name !== bit.field) fields.push({ name: bit.field, bits: [] });
      fields.at(-1).bits.push(bit);
    }
    const lost = event.lost ?? [];
    const text = JSON.stringify([event.bits, lost]);
    set_text(this.caption ??= make("p"), `${event.can_id}H, DLC ${event.dlc}, ${event.remote ? "remote" : event.data || "no data"}, ${event.bits.length} bits, ` +
      `${event.bits.filter((bit) => bit.stuff).length} of them stuff bits, at ${event.at.toFixed(6)} s`);
    if (box.dataset.text === text) return;
    box.dataset.text = text;
    box.replaceChildren(this.caption, make("div", { class: "fields" }, ...fields.map((field) => make("div", { class: "field" },
      make("span", { class: "field-name" }, field.name),
      make("span", { class: "bits" }, ...field.bits.map((bit) => make("span", { class: `bit ${bit.level} ${bit.stuff ? "stuff" : ""} ${bit.lost ? "lost" : ""}`, ...(bit.lost ? { title: `arbitration lost here: ${bit.lost}` } : {}) },
        bit.level === "d" ? "0" : "1")))))),
      ...(event.lost ? [make("p", { class: "lost-here" }, lost.length ? `Lost the arbitration to it: ${lost.map((one) => `${one.name} (${one.can_id}H) at bit ${one.bit}`).join(", ")}.` : "Nobody else began to send with it.")] : []),
      make("p", { class: "faint" }, "0 dominant, 1 recessive; stuff bits are framed. The ACK slot is as the bus had it: somebody acknowledged."));
  }
}
