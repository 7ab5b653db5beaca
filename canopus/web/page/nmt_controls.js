// NMT commands to one node, or to all of a bus [CiA 301 7.2.8.3.1]: `canopus nmt` by the run's program, beside the plant.
import { make, set_text } from "./dom.js";

const ways = [
  ["Start", "start", "to Operational"],
  ["Stop", "stop", "to Stopped: no PDO, no SDO"],
  ["Pre-operational", "preop", "to Pre-operational: no PDO"],
  ["Reset", "reset", "reset node: all values as stored, else their defaults"],
  ["Reset communication", "reset-comm", "reset communication: 1000H to 1FFFH as stored, else their defaults"],
];

export class NmtControls {
  constructor(commands) {
    this.commands = commands;
    this.may_operate = false;
    this.joined = new Set();  // buses that commands can join
    this.groups = [];
  }

  greeted(hello) {
    this.may_operate = hello.role !== "look";
    this.joined = new Set(hello.buses.filter((bus) => bus.joins).map((bus) => bus.bus));
    this.groups = this.groups.filter((group) => group.element.isConnected);
    for (const group of this.groups) this.show(group);
  }

  /// Buttons for a node-ID, or for "all"; hidden where the role or the bus does not allow it.
  make(bus, node, label) {
    const said = make("span", { role: "status", class: "faint" });
    const element = make("div", { class: "ways nmt", role: "group", "aria-label": `NMT commands to ${label}` });
    for (const [name, command, meaning] of ways) {
      const text = node === "all" ? `${name} all` : name;
      const button = make("button", { type: "button", title: `${label} ${meaning}` }, text);
      button.addEventListener("click", () => this.run(element, said, { command: `nmt ${command}`, bus, node }, text));
      element.append(button);
    }
    element.append(said);
    const group = { element, bus };
    this.groups.push(group);
    this.show(group);
    return element;
  }

  show(group) {
    group.element.hidden = !this.may_operate || !this.joined.has(group.bus);
  }

  async run(element, said, command, text) {
    const buttons = element.querySelectorAll("button");
    const focused = document.activeElement;
    for (const button of buttons) button.disabled = true;
    set_text(said, `${text} …`);
    const done = await this.commands.run(command);
    for (const button of buttons) button.disabled = false;
    if (element.contains(focused)) focused.focus();
    said.dataset.mood = done.code === 0 ? "" : "error";
    set_text(said, done.code === 0 ? `${text}: sent` : done.message || `${text}: failed with code ${done.code}`);
    said.title = done.command ?? "";
  }
}
