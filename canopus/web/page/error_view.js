// What a module shows and keeps of errors, in the words of its manual, at its front: those that are there now, emergencies and events, the newest first.
import { make, set_text } from "./dom.js";

export class ErrorView {
  /// `list`: the fronts, in the order of the state. `say`: called when what it looks at has changed.
  constructor(list, commands, say) {
    this.list = list;
    this.commands = commands;
    this.say = say;
    this.may_operate = false;
    this.number = null;  // of the module whose errors are open
  }

  greeted(hello) {
    this.may_operate = hello.role !== "look" && hello.offers.includes("clear errors");
    for (const ways of this.list.querySelectorAll(".module-ways")) ways.hidden = !this.may_operate;
  }

  /// The inside of a front's part: what can be done about errors, what became of it, and the errors.
  static make_part() {
    return make("div", { class: "errors", role: "region", tabindex: "0", hidden: "" },
                make("div", { class: "ways module-ways" }, make("button", { type: "button", hidden: "" }, "Clear errors"), make("button", { type: "button", hidden: "" }, "Reset"), make("span", { role: "status" })),
                make("div"));
  }

  toggle(number) {
    this.number = this.number === number ? null : number;
    [...this.list.children].forEach((card, place) => this.show(card, place));
    this.say();
  }

  /// The part of a front is open or not.
  show(card, number) {
    const is_open = this.number === number;
    const button = card.querySelector(".open-errors");
    set_text(button, is_open ? "Hide errors" : "Errors");
    button.setAttribute("aria-label", `${button.textContent} of ${card.querySelector("h3").textContent}`);
    button.setAttribute("aria-expanded", is_open);
    card.querySelector(".errors").hidden = !is_open;
    const ways = card.querySelector(".module-ways");
    const [clear, reset] = ways.children;
    ways.hidden = !this.may_operate;
    clear.onclick = () => this.run(ways, number, "clear errors", "Clear errors");
    reset.onclick = () => this.ask_reset(card, number);
  }

  /// What the server is asked for, or null.
  get view() {
    return this.number === null ? null : { errors: this.number };
  }

  draw(event) {
    const part = event.number === this.number ? this.list.children[event.number]?.querySelector(".errors") : null;
    if (part) [event.clear, event.reset].forEach((way, place) => this.offer(part.querySelectorAll(".module-ways button")[place], way));
    const text = JSON.stringify(event.groups);
    if (!part || part.dataset.text === text) return;  // a selection in it stays
    part.dataset.text = text;
    part.lastElementChild.replaceChildren(...(event.groups.length === 0 ? [make("p", {}, "no errors, and none before")] : event.groups.flatMap((group) => [make("h4", {}, group.title), make("ul", { "aria-label": group.title },
      ...group.lines.map((line) => make("li", {}, ...[line.t === undefined ? "" : `${line.t.toFixed(3)} s`, line.where, line.code].filter(Boolean).map((one) => make("span", { class: "faint" }, `${one} `)), line.meaning)))])));
  }

  /// As the module's manual has it; a button that it has no counterpart for is not there.
  offer(button, way) {
    button.hidden = !way.offered;
    button.title = way.how;
  }

  ask_reset(card, number) {
    const name = card.querySelector("h3").textContent;
    const dialog = make("dialog", { "aria-label": `Reset ${name}` });
    const [yes, no] = [make("button", { type: "button" }, "Yes"), make("button", { type: "button" }, "No")];
    yes.addEventListener("click", () => {
      dialog.close();
      this.run(card.querySelector(".module-ways"), number, "reset module", "Reset");
    });
    no.addEventListener("click", () => dialog.close());
    dialog.addEventListener("close", () => dialog.remove());
    dialog.append(make("h2", {}, `Reset ${name}`), make("p", {}, "The module leaves the network and starts again; settings that it has not saved are lost."), make("p", { class: "ways" }, yes, no));
    document.body.append(dialog);  // a front may be drawn anew meanwhile
    dialog.showModal();
    no.focus();
  }

  async run(ways, number, command, text) {
    const said = ways.querySelector("[role=status]");
    const buttons = ways.querySelectorAll("button");
    const focused = document.activeElement;
    for (const button of buttons) button.disabled = true;
    said.dataset.mood = "";
    set_text(said, `${text} …`);
    const done = await this.commands.run({ command, number });
    for (const button of buttons) button.disabled = false;
    if (ways.contains(focused)) focused.focus();
    said.dataset.mood = done.code === 0 ? "" : "error";
    set_text(said, done.code === 0 ? done.rows[0].said : done.message || `${text}: failed with code ${done.code}`);
  }
}
