// The buffer memory of a module: what each word is called, what it holds, and the PDO that it goes with. Only the rows that can be
// seen are asked for.
import { make, set_text } from "./dom.js";

const row_height = 26;
const beyond = 12;  // rows above and below what is seen

export class WordView {
  /// `say`: called when what it looks at has changed.
  constructor(section, say) {
    this.section = section;
    this.say = say;
    [this.title, this.list, this.space, this.table, this.find, this.count, this.base] =
      ["words-title", "words", "words-space", "words-table", "words-find", "words-count", "words-base"]
        .map((id) => section.querySelector(`#${id}`));
    this.number = null;
    this.is_hexadecimal = false;
    this.before = new Map();  // values by address
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
    section.querySelector("#close-words").addEventListener("click", () => this.close());
  }

  open(number, name) {
    if (this.number !== number) this.before.clear();
    this.number = number;
    set_text(this.title, `Buffer memory of ${name}`);
    this.section.hidden = false;
    this.list.scrollTop = 0;
    this.from = undefined;
    this.look();
    this.title.focus();
  }

  close() {
    this.section.hidden = true;
    this.number = null;
    this.say();
  }

  /// What the server is asked for, or null.
  get view() {
    if (this.number === null) return null;
    return { words: this.number, find: this.find.value.slice(0, 100), from: this.from ?? 0, count: this.rows ?? 60 };
  }

  look() {
    const first = Math.max(0, Math.floor(this.list.scrollTop / row_height) - beyond);
    const rows = Math.min(256, Math.ceil((this.list.clientHeight || 500) / row_height) + 2 * beyond);
    const key = `${this.number} ${first} ${rows} ${this.find.value}`;
    if (key === this.key) return;
    this.key = key;
    this.from = first;
    this.rows = rows;
    this.say();
  }

  /// Of a row, for the description.
  described(line) {
    const row = line.described;
    if (!row) return null;
    const range = row.values?.join(", ") ?? (row.low === undefined ? "" : `${row.low} to ${row.high}`);
    return { title: row.name, rows: [["Address", `G${row.address}`], ["Program", row.access], ["Range", range], ["Initial", `${row.initial} (${row.initial.toString(16).toUpperCase().padStart(4, "0")}H)`],
      ["PDO", row.pdo ? `${row.pdo}, CAN-ID ${row.can_id}H` : ""], ["From", row.from], ["Manual", row.section]] };
  }

  value(word) {
    return this.is_hexadecimal ? `${word.toString(16).toUpperCase().padStart(4, "0")}H` : String(word);
  }

  draw(event) {
    if (event.number !== this.number) return;
    this.event = event;
    set_text(this.count, `${event.of} words`);
    this.space.style.height = `${event.of * row_height + row_height}px`;
    this.table.style.top = `${event.from * row_height}px`;
    const body = this.table.tBodies[0];
    while (body.rows.length > event.rows.length) body.lastElementChild.remove();
    while (body.rows.length < event.rows.length) {
      body.append(make("tr", {}, make("th", { scope: "row" }), ...Array.from({ length: 5 }, () => make("td"))));
      body.lastElementChild.children[2].append(make("button", { type: "button", class: "number" }));
    }
    event.rows.forEach((row, place) => {
      const line = body.rows[place];
      line.described = row;
      const [address, name, value, pdo, from, access] = line.children;
      set_text(address, `G${row.address}`);
      set_text(name, row.name);
      name.title = row.section ? `${row.name}, manual ${row.section}` : row.name;
      const [button] = value.children;
      set_text(button, this.value(row.value));
      button.dataset.plot = `words ${event.number} ${row.address}`;
      button.dataset.name = `${event.module} G${row.address} ${row.name}`;
      button.title = `Plot ${button.dataset.name}`;
      const before = this.before.get(row.address);
      line.classList.toggle("changed", before !== undefined && before !== row.value);
      this.before.set(row.address, row.value);
      const age = row.age === undefined ? "" : `, ${row.age < 10 ? row.age.toFixed(2) : Math.round(row.age)} s ago`;
      set_text(pdo, row.pdo ? `${row.pdo} ${row.can_id}H${age}` : "");
      set_text(from, row.from ? `from ${row.from}` : "");
      set_text(access, row.access);
    });
  }
}
