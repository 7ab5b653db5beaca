// Faults of simulated buses: the list, on and off, new ones from a frame or a kind, and what they hit. Run has them begin anew.
import { make, set_text } from "./dom.js";
import { fault_rows } from "./fault_rows.js";

const kinds = {
  drop: 'kind = "drop"\nidentifier = 0x181\ncount = 1',
  corrupt: 'kind = "corrupt"\nidentifier = 0x181\nevery = 10',
  duplicate: 'kind = "duplicate"\nidentifier = 0x181\ncount = 1',
  delay: 'kind = "delay"\nidentifier = 0x181\ndelay = "5ms"',
  babble: 'kind = "babble"\nports = ["PORT"]\nframe = { identifier = 0x001, data = [0] }\ninterval = "1ms"',
  "stuck dominant": 'kind = "stuck dominant"\nports = ["PORT"]',
  "stuck recessive": 'kind = "stuck recessive"\nports = ["PORT"]',
  late: 'kind = "late"\nports = ["PORT"]\ndelay = "300ns"',
  jam: 'kind = "jam"\nports = ["PORT"]\ncapacity = 16',
  cut: 'kind = "cut"\nports = ["PORT"]',
  noise: 'kind = "noise"\nbit_error_rate = 1e-4',
  overload: 'kind = "overload"\nports = ["PORT"]\noverload_frames = 1',
  "single-shot": 'kind = "single-shot"\nports = ["PORT"]',
  early: 'kind = "early"\nports = ["PORT"]\nearly_bits = 3',
  drive: 'kind = "drive"\nidentifier = 0x181\nfield = "ACK slot"\nbits = "r"',
  termination: 'kind = "termination"\nresistors = 1\nlength = 100',
};

/// Of a frame: lose or damage the next one, or all.
const of_frame = [
  ["Lose it", (id) => `kind = "drop"\n${id}\ncount = 1`],
  ["Lose all with this CAN-ID", (id) => `kind = "drop"\n${id}`],
  ["Damage it", (id) => `kind = "corrupt"\n${id}\ncount = 1`],
  ["Send it twice", (id) => `kind = "duplicate"\n${id}\ncount = 1`],
];

export class FaultView {
  constructor(section, menu, commands) {
    this.section = section;
    this.menu = menu;
    this.commands = commands;
    this.buses = [];
    [this.list, this.said, this.kind, this.bus, this.run_button, this.seed] =
      ["fault-list", "fault-said", "fault-kind", "fault-bus", "fault-run", "fault-seed"].map((id) => section.querySelector(`#${id}`));
    this.kind.replaceChildren(...Object.keys(kinds).map((kind) => make("option", {}, kind)));
    section.querySelector("#fault-add").addEventListener("click", () => {
      const bus = this.buses.find((one) => one.bus === this.bus.value);
      this.add(bus, kinds[this.kind.value].replace("PORT", bus.ports.find((name) => name) ?? ""));
    });
    this.bus.addEventListener("change", () => this.draw());
    this.seed.addEventListener("input", () => {
      if (!this.chosen) return;
      this.chosen.seed = Number(this.seed.value) || 0;
      this.changed(this.chosen);
    });
    this.run_button.addEventListener("click", () => this.run());
    document.addEventListener("click", (event) => !this.menu.contains(event.target) && this.close_menu());
    document.addEventListener("keydown", (event) => event.key === "Escape" && this.close_menu());
    setInterval(() => !document.hidden && this.is_watched && this.look(), 1000);
  }

  greeted(hello) {
    this.may_run = hello.role !== "look";
    if (hello.offers.includes("faults")) this.look();
  }

  /// How often they have struck is asked for while some are on.
  async look() {
    const done = await this.commands.run({ command: "faults" });
    if (done.code === 0) this.take(done.rows[0]);
  }

  take(row) {
    // Rows of the page belong to the lists that are there: these stay, and what somebody is about to change keeps its words.
    const is_same = (one, other) => one.faults.length === other.faults.length &&
      one.faults.every((fault, place) => fault.text === other.faults[place].text && fault.on === other.faults[place].on);
    this.buses = row.buses.map((bus) => {
      const acting = bus.faults.map((fault) => ({ ...fault }));
      const known = this.buses.find((one) => one.bus === bus.bus);
      return Object.assign(known && (known.is_changed || is_same(known, bus)) ? known : bus, { acting });
    });
    this.is_watched = this.buses.some((bus) => bus.acting.some((fault) => fault.on));
    if (this.bus.options.length !== this.buses.length) this.bus.replaceChildren(...this.buses.map((bus) => make("option", { value: bus.bus }, bus.bus)));
    this.section.hidden = this.buses.length === 0 || document.getElementById("start-section").hidden === false || document.body.classList.contains("settings-alone");
    this.draw();
  }

  get chosen() {
    return this.buses.find((bus) => bus.bus === this.bus.value);
  }

  add(bus, text) {
    if (!bus) return;
    this.bus.value = bus.bus;
    bus.faults.push({ text, on: true });
    this.changed(bus);
    this.section.scrollIntoView({ block: "nearest" });
    this.run_button.scrollIntoView({ block: "nearest" });
    this.run_button.focus({ preventScroll: true });
  }

  changed(bus) {
    bus.is_changed = true;
    set_text(this.said, "not yet run");
    this.said.dataset.mood = "";
    this.drawn = "";
    this.draw();
  }

  /// The list as it stands, from the beginning.
  async run() {
    const bus = this.chosen;
    const done = await this.commands.run({ command: "run faults", bus: bus.bus, seed: Number(this.seed.value) || 0, faults: bus.faults.map(({ text, on }) => ({ text, on })) });
    this.said.dataset.mood = done.code === 0 ? "" : "error";
    if (done.code !== 0) return set_text(this.said, `${done.message}; the bus goes on as before`);
    bus.is_changed = false;
    bus.seed = done.rows[0].buses.find((one) => one.bus === bus.bus).seed;
    const on = bus.faults.filter((fault) => fault.on).length;
    set_text(this.said, on ? `${on} at work since ${done.t.toFixed(3)} s` : "none at work");
    this.drawn = "";
    this.take(done.rows[0]);
  }

  /// At a frame of the messages: { bus, id }.
  open_menu(frame, x, y) {
    const bus = this.buses.find((one) => one.bus === frame.bus);
    if (!bus || !this.may_run) return false;
    const id = `identifier = 0x${frame.id}${frame.id.length > 3 ? "\nextended = true" : ""}`;
    this.menu.replaceChildren(...of_frame.map(([name, text]) => {
      const button = make("button", { type: "button", role: "menuitem" }, name);
      button.addEventListener("click", () => {
        this.close_menu();
        this.add(bus, text(id));
      });
      return make("li", { role: "none" }, button);
    }));
    this.menu.hidden = false;
    this.menu.style.left = `${Math.min(x, innerWidth - this.menu.offsetWidth - 8)}px`;
    this.menu.style.top = `${Math.min(y, innerHeight - this.menu.offsetHeight - 8)}px`;
    this.menu.querySelector("button").focus();
    return true;
  }

  close_menu() {
    this.menu.hidden = true;
  }

  draw() {
    const bus = this.chosen;
    if (!bus) return;
    if (document.activeElement !== this.seed) this.seed.value = bus.seed;
    for (const one of this.section.querySelectorAll("button, textarea, #fault-seed")) one.disabled = !this.may_run;
    const { says, left } = fault_rows(bus.faults, bus.acting);
    const text = JSON.stringify([bus.bus, bus.faults.map(({ text, on }) => [text, on]), left.map((fault) => fault.text), this.may_run]);
    if (this.drawn !== text) {
      this.drawn = text;
      this.list.replaceChildren(...bus.faults.map((fault, place) => this.row(bus, fault, place)),
        ...left.map((fault) => make("li", { class: "fault" }, make("pre", {}, fault.text), make("span", { class: "hits" }))));
      if (says.length + left.length === 0) this.list.replaceChildren(make("li", { class: "faint" }, "the bus has no faults"));
    }
    [...says, ...left.map((fault) => fault.says)].forEach((words, place) => set_text(this.list.children[place].querySelector(".hits"), words));
  }

  row(bus, fault, place) {
    const words = make("textarea", { rows: String(fault.text.split("\n").length), spellcheck: "false", "aria-label": `Fault ${place + 1}`, maxlength: "4000" });
    words.value = fault.text;
    words.disabled = !this.may_run;
    words.addEventListener("change", () => {
      fault.text = words.value;
      this.changed(bus);
    });
    const on = make("input", { type: "checkbox" });
    on.checked = fault.on;
    on.disabled = !this.may_run;
    on.addEventListener("change", () => {
      fault.on = on.checked;
      this.changed(bus);
    });
    const remove = make("button", { type: "button", "aria-label": `Remove fault ${place + 1}` }, "Remove");
    remove.disabled = !this.may_run;
    remove.addEventListener("click", () => {
      bus.faults.splice(place, 1);
      this.changed(bus);
    });
    return make("li", { class: "fault" }, words, make("label", {}, on, " on"), remove, make("span", { class: "hits" }), make("span", { class: "faint" }, fault.from_file ? "of the plant file" : ""));
  }
}
