// Plots of numbers that somebody clicked: any of the page that is a button with `data-plot`, its key:
//   "words 0 10000"     word of a module's buffer memory
//   "objects 3 6004:00" object of a node
//   "state line1 4 tec" a figure of a node; "bus line1 now" of a bus
import { make, set_text } from "./dom.js";

const most_points = 20000;  // over an hour
const most_plots = 6;
const most_drawn = 1000;

export class Plots {
  /// `say`: called when other values are to be asked for.
  constructor(section, list, say) {
    this.section = section;
    this.list = list;
    this.say = say;
    this.plots = new Map();  // by key: { name, points: [[t, value]], element ... }
    this.window = Infinity;
    this.is_held = false;
    document.addEventListener("click", (event) => {
      const button = event.target.closest?.("[data-plot]");
      if (button) this.toggle(button.dataset.plot, button.dataset.name ?? button.title.replace(/^Plot /, ""));
    });
    this.hold = make("button", { type: "button", "aria-pressed": "false" }, "Hold");
    this.hold.addEventListener("click", () => {
      this.is_held = !this.is_held;
      this.hold.setAttribute("aria-pressed", this.is_held);
    });
    const windows = make("select", { "aria-label": "Time that is shown" }, ...[["10 s", 10], ["1 min", 60], ["10 min", 600], ["all", Infinity]].map(([name, value]) => make("option", { value }, name)));
    windows.value = "Infinity";
    windows.addEventListener("change", () => {
      this.window = Number(windows.value);
      for (const plot of this.plots.values()) this.draw(plot);
    });
    const csv = make("button", { type: "button" }, "CSV");
    csv.addEventListener("click", () => this.save());
    list.before(make("p", { class: "ways" }, this.hold, make("label", {}, "Show the last ", windows), csv));
  }

  /// What the server is asked for, or null.
  get view() {
    const keys = [...this.plots.keys()].filter((key) => /^(words|objects) /.test(key));
    return keys.length ? { values: keys } : null;
  }

  add(key, value, t) {
    const plot = this.plots.get(key);
    if (!plot || this.is_held || !Number.isFinite(value) || plot.points.at(-1)?.[0] >= t) return;
    plot.points.push([t, value]);
    if (plot.points.length > most_points) plot.points.splice(0, most_points / 10);
    this.draw(plot);
  }

  values(event) {
    for (const { key, value } of event.values) this.add(key, value, event.t);
  }

  state(state) {
    if (this.plots.size === 0) return;
    for (const node of state.nodes) {
      for (const name of ["tec", "rec", "pdos", "emcy", "frames"]) this.add(`state ${node.bus} ${node.node} ${name}`, node[name], state.t);
    }
    for (const bus of state.buses) {
      for (const name of ["now", "frames", "error_frames"]) this.add(`bus ${bus.bus} ${name}`, name === "now" ? 100 * bus[name] : bus[name], state.t);
    }
  }

  toggle(key, name) {
    if (this.plots.has(key)) return this.close(key);
    if (this.plots.size === most_plots) this.close(this.plots.keys().next().value);
    const close = make("button", { type: "button", "aria-label": `Close the plot of ${name}` }, "Close");
    close.addEventListener("click", () => this.close(key));
    const line = make("svg:polyline", { fill: "none" });
    const cursor = make("svg:line", { class: "cursor", y1: 0, y2: 100, x1: -1, x2: -1 });
    const picture = make("svg:svg", { viewBox: "0 0 1000 100", preserveAspectRatio: "none", role: "img", "aria-label": `Plot of ${name}` }, line, cursor);
    const element = make("figure", { class: "plot" }, make("figcaption", {}, name, " ", make("b"), " ", close), make("div", { class: "axis" }, make("span"), make("span")), picture,
      make("p", { class: "faint" }, "waits for values"));
    const plot = { name, points: [], element, line, cursor };
    picture.addEventListener("pointermove", (event) => {
      const place = picture.getBoundingClientRect();
      plot.at = (event.clientX - place.left) / place.width;
      this.draw_cursor(plot);
    });
    picture.addEventListener("pointerleave", () => {
      plot.at = undefined;
      this.draw_cursor(plot);
    });
    this.plots.set(key, plot);
    this.list.append(element);
    this.section.hidden = false;
    this.changed();
  }

  /// Those of the address that the page was opened with.
  restore() {
    for (const text of new URLSearchParams(location.search).getAll("plot").slice(0, most_plots)) {
      const [key, name] = text.slice(0, 200).split("|");
      if (key && !this.plots.has(key)) this.toggle(key, name || key);
    }
  }

  /// An address that somebody copies shows the same plots.
  changed() {
    const search = new URLSearchParams([...this.plots].map(([key, plot]) => ["plot", `${key}|${plot.name}`])).toString();
    history.replaceState(null, "", `${location.pathname}${search ? `?${search}` : ""}${location.hash}`);
    this.say();
  }

  close(key) {
    this.plots.get(key)?.element.remove();
    this.plots.delete(key);
    this.section.hidden = this.plots.size === 0;
    this.changed();
  }

  /// Values hold until the next one. Of many points in one place the lowest and the highest are drawn.
  draw(plot) {
    const end = plot.points.at(-1)?.[0];
    if (end === undefined) return;
    let first = plot.points.length - 1;
    while (first > 0 && plot.points[first - 1][0] >= end - this.window) --first;
    const points = plot.points.slice(first);
    plot.shown = points;
    let low = Infinity;
    let high = -Infinity;
    for (const [, value] of points) {
      low = Math.min(low, value);
      high = Math.max(high, value);
    }
    const begin = points[0][0];
    const span = end - begin || 1;
    const range = high - low || 1;
    const x = (t) => (1000 * (t - begin) / span).toFixed(1);
    const y = (value) => (95 - 90 * (value - low) / range).toFixed(1);
    const places = [];
    const step = Math.max(1, Math.ceil(points.length / most_drawn));
    for (let i = 0; i < points.length; i += step) {
      const some = points.slice(i, i + step).map((point) => point[1]);
      const values = step === 1 ? some : [Math.min(...some), Math.max(...some), some.at(-1)];
      if (i > 0) places.push(`${x(points[i][0])},${y(points[i - 1][1])}`);
      for (const value of values) places.push(`${x(points[i][0])},${y(value)}`);
    }
    plot.line.setAttribute("points", places.join(" "));
    const [, axis, , note] = plot.element.children;
    set_text(axis.children[0], String(high));
    set_text(axis.children[1], String(low));
    set_text(note, `${begin.toFixed(1)} s to ${end.toFixed(1)} s`);
    this.draw_cursor(plot);
  }

  draw_cursor(plot) {
    const { shown, at, cursor, element } = plot;
    if (!shown) return;
    const value = element.querySelector("b");
    if (at === undefined) {
      cursor.setAttribute("x1", -1);
      cursor.setAttribute("x2", -1);
      return set_text(value, String(shown.at(-1)[1]));
    }
    const t = shown[0][0] + at * (shown.at(-1)[0] - shown[0][0]);
    const point = shown.findLast((one) => one[0] <= t) ?? shown[0];
    cursor.setAttribute("x1", 1000 * at);
    cursor.setAttribute("x2", 1000 * at);
    set_text(value, `${point[1]} at ${t.toFixed(3)} s`);
  }

  save() {
    const quoted = (text) => `"${text.replaceAll('"', '""')}"`;
    const lines = ["time (s),name,value"];
    for (const { name, points } of this.plots.values()) for (const [t, value] of points) lines.push(`${t},${quoted(name)},${value}`);
    const link = make("a", { href: URL.createObjectURL(new Blob([lines.join("\r\n"), "\r\n"], { type: "text/csv" })), download: "plots.csv" });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
  }
}
