// The object dictionary of a node: type, access, value and default of each sub-index. Only the rows that can be seen are asked for.
import { make, set_text } from "./dom.js";
import { words_of } from "./value_words.js";

const row_height = 26;
const beyond = 12;  // rows above and below what is seen

export class ObjectView {
  /// `domain`: a DomainView for what does not go into a row. `say`: called when what it looks at has changed.
  constructor(section, domain, say) {
    this.section = section;
    this.domain = domain;
    this.say = say;
    [this.title, this.list, this.space, this.table, this.find, this.count, this.base] =
      ["objects-title", "objects", "objects-space", "objects-table", "objects-find", "objects-count", "objects-base"]
        .map((id) => section.querySelector(`#${id}`));
    this.number = null;
    this.is_hexadecimal = false;
    this.list.addEventListener("scroll", () => this.look());
    this.find.addEventListener("input", () => {
      this.list.scrollTop = 0;
      this.look();
    });
    this.base.addEventListener("click", () => {
      this.is_hexadecimal = !this.is_hexadecimal;
      this.base.setAttribute("aria-pressed", this.is_hexadecimal);
      if (this.event) this.draw(this.event);
    });
  }

  open(number, name) {
    if (this.number !== number) this.domain.close();
    this.number = number;
    this.event = null;
    this.table.tBodies[0].replaceChildren();
    set_text(this.title, `Objects of ${name}`);
    this.section.hidden = false;
    this.list.scrollTop = 0;
    this.look();
    this.title.focus();
  }

  close() {
    this.section.hidden = true;
    this.number = null;
    this.domain.close();
    this.say();
  }

  /// What the server is asked for, or null.
  get view() {
    if (this.number === null) return null;
    return { objects: this.number, find: this.find.value.slice(0, 100), from: this.from ?? 0, count: this.rows ?? 60 };
  }

  look() {
    this.from = Math.max(0, Math.floor(this.list.scrollTop / row_height) - beyond);
    this.rows = Math.min(256, Math.ceil((this.list.clientHeight || 500) / row_height) + 2 * beyond);
    this.say();
  }

  draw(event) {
    if (event.number !== this.number) return;
    this.event = event;
    set_text(this.count, event.of === 1 ? "1 sub-index" : `${event.of} sub-indexes`);
    this.space.style.height = `${event.of * row_height + row_height}px`;
    this.table.style.top = `${event.from * row_height}px`;
    const body = this.table.tBodies[0];
    while (body.rows.length > event.rows.length) body.lastElementChild.remove();
    while (body.rows.length < event.rows.length) {
      body.append(make("tr", {}, make("th", { scope: "row" }), make("td"), make("td"), make("td"),
                       make("td", {}, make("span"), make("button", { type: "button", class: "number", hidden: "" }), make("button", { type: "button", class: "plain", hidden: "" }, "Show")), make("td")));
    }
    event.rows.forEach((row, place) => this.fill(body.rows[place], row, event));
  }

  /// Of a row, for the description.
  described(line) {
    const row = line.described;
    if (!row) return null;
    const range = row.low !== undefined || row.high !== undefined ? `${row.low ?? ""} … ${row.high ?? ""}` : "";
    return { title: row.name === row.of ? row.name : `${row.of}: ${row.name}`, object: row.object,
      rows: [["Object", row.object], ["Type", row.type], ["Access", row.access], ["Range", range], ["Default", row.default_decimal === undefined ? "" : `${row.default_decimal} (${row.default_hex}H)`], ["In words", row.words ?? words_of(row.object, row.decimal)], ["Warning", row.warning]] };
  }

  fill(line, row, event) {
    line.described = row;
    const [object, name, type, access, value, usual] = line.children;
    set_text(object, row.object);
    set_text(name, row.name === row.of ? row.name : `${row.of}: ${row.name}`);
    name.title = name.textContent;
    set_text(type, row.type);
    set_text(access, row.access);
    const [text, button, show] = value.children;
    show.hidden = !row.bytes || (row.type !== "DOMAIN" && row.bytes <= 64);
    show.setAttribute("aria-label", `Show ${row.object} ${row.name}`);
    show.onclick = () => this.domain.open(event.number, row.object, name.title);
    value.title = row.words ? [row.words, row.warning].filter(Boolean).join("; ") : "";
    const is_number = row.decimal !== undefined;
    button.hidden = !is_number;
    if (!is_number) {
      const shown = row.text !== undefined && !this.is_hexadecimal ? `“${row.text}”` : row.hex + (row.bytes > 64 ? "…" : "");
      set_text(text, row.bytes === 0 ? "empty" : show.hidden ? shown : `${row.bytes} bytes `);
      set_text(usual, "");
      return;
    }
    set_text(text, "");
    const shown = this.is_hexadecimal ? `${row.hex}H` : row.decimal;
    const other = this.is_hexadecimal ? `${row.default_hex}H` : row.default_decimal;
    set_text(button, shown);
    button.title = `Plot ${event.bus} ${event.node} ${row.object} ${row.name}`;
    button.dataset.plot = `objects ${event.number} ${row.object}`;
    set_text(usual, shown === other ? "same" : other);
  }
}
