// The trace: the latest million frames of all buses, decoded by the server, of which only lines about those in sight come here (docs/web.md).
import { make, set_text } from "./dom.js";
import { draw_figures } from "./trace_figures.js";

const by_id = (id) => document.getElementById(id);
const row_height = 22;
const ahead = 80;  // lines beside those in sight, so that turning the wheel waits for nobody
const every = 400;  // ms between two looks at what is new
const pause = 60;  // ms between two questions: the server takes 40 a second of everybody
const later = (milliseconds) => new Promise((done) => setTimeout(done, milliseconds));

/// "1.502860", or the time since another line.
const time_of = (row, before) => (before ? `+${(row.t - before.t).toFixed(6)}` : row.t.toFixed(6));
/// "12 34 AB".
const bytes_of = (row) => (row.remote ? `remote, ${row.dlc} bytes` : (row.data ?? "").replace(/..(?=.)/g, "$& "));

export class TraceView {
  /// `open_menu(frame, x, y)`: what if this frame were lost; `link_of_node(bus, node)`: of its objects, or nothing.
  constructor(commands, open_menu, link_of_node) {
    this.commands = commands;
    this.open_menu = open_menu;
    this.link_of_node = link_of_node;
    this.is_open = false;
    this.from = null;  // null: the newest
    this.rows = [];
    this.first = 0;
    this.end = 0;
    this.chosen = null;  // a row
    this.pair = new Set();  // records of the chosen one's transfer
    this.wanted = null;  // the time of a link whose line is to be chosen
    this.is_asking = false;
    this.is_asked_again = false;
    this.box = by_id("trace");
    this.place = by_id("trace-place");
    this.filter = by_id("trace-filter");
    by_id("trace-show").addEventListener("click", () => this.show(!this.is_open));
    this.filter.addEventListener("input", () => this.restart());
    this.filter.addEventListener("change", () => { if (this.is_open) history.replaceState(null, "", this.link()); });
    by_id("trace-fold").addEventListener("change", () => this.restart());
    for (const id of ["trace-newest", "trace-delta"]) by_id(id).addEventListener("change", () => this.draw());
    by_id("trace-hold").addEventListener("click", () => (this.from === null ? this.go(this.newest()) : this.follow()));
    by_id("trace-export").addEventListener("click", () => this.export());
    by_id("trace-statistics").addEventListener("click", () => this.show_figures());
    this.place.addEventListener("input", () => this.go(this.is_newest_first() ? this.first + this.newest() - Number(this.place.value) : Number(this.place.value)));
    this.box.addEventListener("wheel", (event) => {
      event.preventDefault();
      this.move(Math.sign(event.deltaY) * Math.max(1, Math.round(Math.abs(event.deltaY) / row_height)));
    }, { passive: false });
    this.box.addEventListener("keydown", (event) => this.key(event));
    this.box.addEventListener("click", (event) => this.choose(event.target.closest("tr[data-n]")));
    this.box.addEventListener("contextmenu", (event) => {
      const line = event.target.closest("tr[data-n]");
      if (line ? this.open_menu({ bus: line.dataset.bus, id: line.dataset.id }, event.clientX, event.clientY) : this.open_menu_of_chosen()) event.preventDefault();
    });
    new ResizeObserver(() => this.is_open && this.look()).observe(this.box);
    setInterval(() => {
      if (this.is_open && !document.hidden && this.from === null) this.look();
    }, every);
  }

  /// Whether the column of the buses says something.
  set_buses(count) {
    this.box.classList.toggle("one-bus", count < 2);
  }

  /// Of a link: #trace/FILTER, #trace/FILTER/TIME; the line of that time is chosen then.
  open(filter, time) {
    this.wanted = /^\d+\.\d+$/.test(time ?? "") ? Number(time) : null;
    if (filter !== undefined) this.filter.value = filter.slice(0, this.filter.maxLength);
    this.show(true);
    by_id("trace-section").scrollIntoView();
    by_id("trace-title").focus({ preventScroll: true });
  }

  link() {
    return this.filter.value ? `#trace/${encodeURIComponent(this.filter.value)}` : "#trace";
  }

  show(is_open) {
    this.is_open = is_open;
    by_id("trace-part").hidden = !is_open;
    by_id("trace-show").setAttribute("aria-expanded", is_open);
    set_text(by_id("trace-show"), is_open ? "Hide" : "Show");
    if (is_open) this.restart();
  }

  /// With another filter, lines have other numbers.
  restart() {
    this.rows = [];
    this.choose(null);
    this.follow();
  }

  follow() {
    this.from = null;
    by_id("trace-hold").setAttribute("aria-pressed", false);
    this.look();
  }

  is_newest_first() {
    return by_id("trace-newest").checked;
  }

  in_sight() {
    return Math.max(5, Math.floor((this.box.clientHeight - row_height) / row_height));
  }

  /// The line with which the newest ones begin.
  newest() {
    return Math.max(this.first, this.end - this.in_sight());
  }

  go(from) {
    this.from = Math.max(this.first, Math.min(from, this.newest()));
    by_id("trace-hold").setAttribute("aria-pressed", true);
    this.draw();
    this.look();
  }

  move(lines) {
    const down = this.is_newest_first() ? -lines : lines;
    this.go((this.from ?? this.newest()) + down);
  }

  key(event) {
    const page = this.in_sight() - 1;
    const ways = { ArrowDown: () => this.move(1), ArrowUp: () => this.move(-1), PageDown: () => this.move(page), PageUp: () => this.move(-page),
                   Home: () => (this.is_newest_first() ? this.follow() : this.go(0)), End: () => (this.is_newest_first() ? this.go(0) : this.follow()),
                   Enter: () => this.choose_beside(event.shiftKey ? -1 : 1), f: () => this.open_menu_of_chosen() };
    if (!ways[event.key] || event.ctrlKey || event.altKey) return;
    event.preventDefault();
    ways[event.key]();
  }

  /// By keys: the first line in sight, then the next ones. Lines that follow would be others before they are read.
  choose_beside(step) {
    if (this.from === null) this.go(this.newest());
    const lines = [...this.box.querySelectorAll("tr[data-n]")];
    const place = lines.findIndex((line) => line.hasAttribute("aria-selected"));
    if (lines.length) this.choose(lines[place < 0 ? 0 : Math.max(0, Math.min(place + step, lines.length - 1))]);
  }

  open_menu_of_chosen() {
    const line = this.box.querySelector("tr[aria-selected]");
    const place = line?.getBoundingClientRect();
    return Boolean(line) && this.open_menu({ bus: line.dataset.bus, id: line.dataset.id }, place.left + 100, place.bottom);
  }

  async look() {
    if (!this.is_open) return;
    this.is_asked_again = this.is_asking;
    if (this.is_asking) return;
    this.is_asking = true;
    const wish = { command: "trace", filter: this.filter.value, fold: by_id("trace-fold").checked, count: Math.min(256, this.in_sight() + 2 * ahead) };
    if (this.from !== null) wish.from = Math.max(0, this.from - ahead);
    const [done] = await Promise.all([this.commands.run(wish), later(pause)]);
    this.is_asking = false;
    if (wish.filter === this.filter.value && wish.fold === by_id("trace-fold").checked) this.received(done);
    if (this.is_asked_again) this.look();
  }

  received(done) {
    this.filter.setAttribute("aria-invalid", done.code !== 0);
    if (done.code !== 0) return this.say(done.message ?? "no answer", "error");
    const answer = done.rows[0];
    this.rows = answer.rows;
    this.first = answer.first;
    this.end = answer.end;
    if (this.from !== null && this.from < this.first) this.from = this.first;
    const count = `${this.end - this.first} lines of ${answer.records} frames`;
    const parts = [answer.progress === undefined ? count : `${count}, ${Math.floor(100 * answer.progress)} % read`];
    if (answer.forgotten) parts.push(`${answer.forgotten} older ones are forgotten`);
    if (answer.lost) parts.push(`${answer.lost} were lost`);
    this.say(parts.join(", "));
    this.draw();
    if (answer.progress !== undefined) this.is_asked_again = true;
    else if (this.wanted !== null && this.rows.length) this.choose_time();
  }

  say(text, mood = "") {
    by_id("trace-said").dataset.mood = mood;
    set_text(by_id("trace-said"), text);
  }

  draw() {
    const count = this.in_sight();
    const from = this.from ?? this.newest();
    const by_number = new Map(this.rows.map((row) => [row.n, row]));
    const shown = [];
    for (let n = from; n < Math.min(from + count, this.end); ++n) shown.push([n, by_number.get(n), by_number.get(n - 1)]);
    if (this.is_newest_first()) shown.reverse();
    const with_delta = by_id("trace-delta").checked;
    const lines = shown.map(([n, row, before]) => {
      if (!row) return make("tr", {}, make("td", { colspan: 7 }, "…"));
      const cells = [time_of(row, with_delta ? before : null), row.bus, row.id, row.node === undefined ? "" : `${row.node || "all"}${row.name ? ` ${row.name}` : ""}`, row.what, row.text,
                     row.frames ? `${row.frames} frames, ${(1000 * row.duration).toFixed(1)} ms` : bytes_of(row)];
      const line = make("tr", { "data-n": n, "data-bus": row.bus, "data-id": row.id, class: row.trouble ? "trouble" : "" }, ...cells.map((text) => make("td", { title: text }, text)));
      if (this.pair.has(row.record)) line.classList.add("pair");
      if (this.chosen?.n === n) line.setAttribute("aria-selected", true);
      return line;
    });
    this.box.querySelector("tbody").replaceChildren(...lines);
    Object.assign(this.place, { min: this.first, max: Math.max(this.first, this.newest()) });
    this.place.value = this.is_newest_first() ? this.first + this.newest() - from : from;
    this.place.setAttribute("aria-valuetext", `line ${from} of ${this.end}`);
  }

  /// The line that is nearest to the time of the link.
  choose_time() {
    const away = (row) => Math.abs(row.t - this.wanted);
    const nearest = this.rows.reduce((best, row) => (away(row) < away(best) ? row : best));
    this.wanted = null;
    this.choose(this.box.querySelector(`tr[data-n="${nearest.n}"]`));
  }

  /// What a line has besides; of an SDO transfer its frames, in the list marked, too.
  async choose(line) {
    this.chosen = line ? this.rows.find((row) => row.n === Number(line.dataset.n)) ?? null : null;
    this.pair = new Set();
    const row = this.chosen;
    by_id("trace-one").hidden = row === null;
    this.draw();
    if (!row) return;
    const facts = [["Time", `${row.t.toFixed(6)} s`], ["Bus", row.bus], ["CAN-ID", `${row.id}H`], ["Node", row.node === undefined ? "" : `${row.node || "all"} ${row.name ?? ""}`],
                   ["Service", `${row.what} (${row.service})`], ["Object", row.object ?? ""], ["Meaning", row.text], ["Data", row.frames ? "" : `${bytes_of(row)} (DLC ${row.dlc})`]];
    const link = row.node ? this.link_of_node(row.bus, row.node) : null;
    const body = make("tbody", {}, ...facts.filter(([, text]) => text).map(([name, text]) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, text))));
    const ways = [make("a", { href: `#trace/${encodeURIComponent(`id=${row.id}`)}` }, `only ${row.id}H`)];
    if (row.node) ways.push(make("a", { href: `#trace/${encodeURIComponent(`node=${row.node}`)}` }, `only node ${row.node}`));
    if (link) ways.push(make("a", { href: link }, "objects"));
    by_id("trace-one").replaceChildren(make("p", { class: "ways" }, ...ways), make("table", {}, body));
    if (row.service !== "sdo") return;
    const done = await this.commands.run({ command: "trace", frames: row.record });
    if (done.code !== 0 || this.chosen !== row) return;
    const frames = done.rows[0].rows;
    this.pair = new Set(frames.map((one) => one.record));
    by_id("trace-one").append(make("table", { class: "rows", id: "trace-frames" }, make("caption", {}, "Frames of this transfer"), make("tbody", {}, ...frames.map((one) =>
      make("tr", {}, make("td", {}, one.t.toFixed(6)), make("td", {}, `${one.id}H`), make("td", {}, bytes_of(one)), make("td", {}, one.text))))));
    this.draw();
  }

  async show_figures() {
    const box = by_id("trace-figures");
    box.hidden = !box.hidden;
    by_id("trace-statistics").setAttribute("aria-pressed", !box.hidden);
    while (!box.hidden && this.is_open) {
      const done = await this.commands.run({ command: "trace", statistics: true });
      if (done.code !== 0) return this.say(done.message ?? "no answer", "error");
      draw_figures(box, done.rows[0]);
      await later(done.rows[0].progress === undefined ? 2000 : pause);
    }
  }

  /// The frames of the lines that the filter lets through, part by part.
  async export() {
    const format = by_id("trace-format").value;
    const button = by_id("trace-export");
    const said = by_id("trace-exported");
    const parts = [];
    let frames = 0;
    button.disabled = true;
    for (let part = 0; ; ++part) {
      const [done] = await Promise.all([this.commands.run({ command: "export trace", filter: this.filter.value, format, part }), later(pause)]);
      if (done.code !== 0) {
        button.disabled = false;
        return set_text(said, done.message ?? "no answer");
      }
      const row = done.rows[0];
      parts.push(Uint8Array.from(atob(row.data), (c) => c.charCodeAt(0)));
      frames += row.frames;
      set_text(said, `${frames} frames, ${Math.floor(100 * row.at)} % of the trace`);
      if (row.done) break;
    }
    button.disabled = false;
    const link = make("a", { href: URL.createObjectURL(new Blob(parts, { type: "application/octet-stream" })), download: `trace.${{ candump: "log" }[format] ?? format}` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    set_text(said, `${frames} frames are exported`);
  }
}
