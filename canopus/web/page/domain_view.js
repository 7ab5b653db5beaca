// A value of many bytes in words: a concise DCF of 1F22H as the objects that it writes, any other DOMAIN as its bytes with the text in them. What it says comes from
// the server, or from `canopus sdo`, which say the same (docs/web.md).
import { make, set_text } from "./dom.js";

/// Bytes of pairs of hexadecimal digits.
export const bytes_of = (hex) => Uint8Array.from(hex.match(/../g) ?? [], (pair) => parseInt(pair, 16));

/// Lets the browser keep bytes as a file.
export function save_bytes(parts, name) {
  const link = make("a", { href: URL.createObjectURL(new Blob(parts, { type: "application/octet-stream" })), download: name });
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 60000);
}

export const file_name = (bus, node, object) => `${bus}-${node}-${object.replace(":", "-")}.bin`.replace(/[^\w.-]/g, "_");

/// Where a value is shown; `save`: what [Save to file] does. `label`: of what.
export class DomainWords {
  constructor(label, save) {
    this.heading = make("p", { class: "heading", role: "status" });
    this.problem = make("p", { class: "bad" });
    this.entries = make("tbody");
    this.table = make("div", { class: "scrolls", role: "region", "aria-label": `Entries of ${label}`, tabindex: "0" }, make("table", { class: "rows" }, make("thead", {}, make("tr", {}, ...["Object", "Name", "Value"].map((one) => make("th", { scope: "col" }, one)))), this.entries));
    this.dump = make("pre", { role: "region", "aria-label": `Bytes of ${label}`, tabindex: "0" });
    this.button = make("button", { type: "button" }, "Save to file");
    this.button.addEventListener("click", save);
    this.element = make("div", { class: "domain", hidden: "" }, make("div", { class: "ways" }, this.heading, this.button), this.problem, this.table, this.dump);
  }

  /// `words`: { heading, entries, problem, dump }, or nothing.
  show(words) {
    this.element.hidden = !words;
    const text = JSON.stringify(words ?? null);
    if (this.text === text) return;  // a selection in it stays
    this.text = text;
    if (!words) return;
    set_text(this.heading, words.heading);
    set_text(this.problem, words.problem);
    this.problem.hidden = !words.problem;
    this.table.hidden = words.entries.length === 0;
    this.entries.replaceChildren(...words.entries.map((one) => make("tr", {}, make("th", { scope: "row" }, one.object), make("td", {}, one.name), make("td", {}, one.value))));
    this.dump.hidden = words.dump.length === 0;
    set_text(this.dump, words.dump.join("\n"));
  }
}

/// The open value of a node's objects: of a simulated node, read where it is.
export class DomainView {
  /// `say`: called when what it looks at has changed.
  constructor(part, say) {
    this.part = part;
    this.say = say;
    this.open_one = null;  // { domain, object }
    this.saving = null;    // { size, parts }
    [this.title, this.close_button] = [part.querySelector("h3"), part.querySelector("button")];
    this.close_button.addEventListener("click", () => this.close());
    this.words = new DomainWords("the value", () => this.save());
    part.append(this.words.element);
  }

  open(number, object, name) {
    this.open_one = { domain: number, object };
    this.saving = null;
    this.event = null;
    this.words.show(null);
    set_text(this.title, `${object} ${name}`);
    this.part.hidden = false;
    this.title.focus();
    this.say();
  }

  close() {
    this.part.hidden = true;
    this.open_one = null;
    this.saving = null;
    this.say();
  }

  /// What the server is asked for, or null.
  get view() {
    if (!this.open_one) return null;
    return this.saving ? { ...this.open_one, part: this.saving.from } : this.open_one;
  }

  save() {
    this.saving = { from: 0, parts: [] };
    this.say();
  }

  draw(event) {
    if (!this.open_one || event.number !== this.open_one.domain || event.object !== this.open_one.object) return;
    if (event.words) {
      this.event = event;
      this.words.show(event.words);
    }
    if (!this.saving || event.part !== this.saving.from) return;
    const bytes = bytes_of(event.hex);
    this.saving.parts.push(bytes);
    this.saving.from += bytes.length;
    if (this.saving.from >= event.size || bytes.length === 0) {
      save_bytes(this.saving.parts, file_name(event.bus, event.node, event.object));
      this.saving = null;
    }
    this.say();
  }
}
