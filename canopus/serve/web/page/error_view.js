// What a module shows and keeps of errors, in the words of its manual, at its front: those that are there now, emergencies and events, the newest first.
import { make, set_text } from "./dom.js";

export class ErrorView {
  /// `list`: the fronts, in the order of the state. `say`: called when what it looks at has changed.
  constructor(list, say) {
    this.list = list;
    this.say = say;
    this.number = null;  // of the module whose errors are open
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
  }

  /// What the server is asked for, or null.
  get view() {
    return this.number === null ? null : { errors: this.number };
  }

  draw(event) {
    const part = event.number === this.number ? this.list.children[event.number]?.querySelector(".errors") : null;
    const text = JSON.stringify(event.groups);
    if (!part || part.dataset.text === text) return;  // a selection in it stays
    part.dataset.text = text;
    part.replaceChildren(...(event.groups.length === 0 ? [make("p", {}, "no errors, and none before")] : event.groups.flatMap((group) => [make("h4", {}, group.title), make("ul", { "aria-label": group.title },
      ...group.lines.map((line) => make("li", {}, ...[line.t === undefined ? "" : `${line.t.toFixed(3)} s`, line.where, line.code].filter(Boolean).map((one) => make("span", { class: "faint" }, `${one} `)), line.meaning)))])));
  }
}
