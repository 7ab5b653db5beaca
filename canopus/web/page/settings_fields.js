// Fields of a module's settings: inputs with the names, ranges and descriptions that the program has of them.
import { make } from "./dom.js";
import { shown_value } from "./settings.js";

const is_check_box = (field) => field.words?.length === 2 && field.words[1] === "Selected";

/// What stands for the two parts of a COB-ID [RJ71CN91 3.1 TPDO details].
export const cob_id_parts = [
  { field: "valid", words: ["Not selected", "Selected"], range: "Not selected, Selected", default: "PDO 1 to 4: Selected", unit: "", highest: 1,
    description: "the PDO is there (bit 31 of its COB-ID)", of: (cob_id) => (cob_id >= 0x80000000 ? 0 : 1) },
  { field: "CAN-ID (11-bit)", hexadecimal: true, range: "0x000 to 0x57F", default: "PDO 1 to 4: those of CiA 301, others 0x000", unit: "", highest: 0x57F,
    description: "of its frames", of: (cob_id) => cob_id % 0x800 },
];

export class FieldInput {
  /// `change(text)`: what is typed or chosen goes there, and resolves to whether it was taken. `label`: its name for screen readers, where it has none on the page.
  constructor(field, may_change, change, label = null) {
    this.field = field;
    if (is_check_box(field)) this.input = make("input", { type: "checkbox" });
    else if (field.words || field.choices) {
      this.input = make("select", {}, ...(field.words ?? field.choices).map((one, i) => make("option", { value: field.words ? one : String(one) }, field.choices ? `${one} ${field.unit}` : one)));
    } else {
      this.input = make("input", { type: "text", autocomplete: "off", spellcheck: "false", maxlength: field.longest ?? 20 });
    }
    if (label) this.input.setAttribute("aria-label", label);
    this.input.dataset.field = field.field;
    this.input.disabled = field.read_only || !may_change;
    this.input.addEventListener("change", async () => {
      this.is_asking = true;
      const taken = await change(this.text);
      this.is_asking = false;
      // As the program writes it. What was typed and refused stays; a box shows what holds.
      if (taken || this.input.type !== "text") this.show(this.latest);
      this.input.setAttribute("aria-invalid", !taken);
    });
  }

  get text() {
    return this.input.type === "checkbox" ? (this.input.checked ? "Selected" : "Not selected") : this.input.value;
  }

  /// What somebody types, and what was refused, stays.
  set(value) {
    const before = this.latest;
    this.latest = this.field.is_text ? value : shown_value(this.field, value);
    if (this.is_asking || this.latest === before) return;
    const is_typing = document.activeElement === this.input && this.input.type === "text" && this.text !== before;
    if (!is_typing) this.show(this.latest);
  }

  show(text) {
    this.input.setAttribute("aria-invalid", false);
    if (this.input.type === "checkbox") this.input.checked = text === "Selected";
    else this.input.value = text;
  }
}

/// What the description window says of a field.
export function draw_description(element, field) {
  const rows = [["Range", field.range], ["Default", field.default]];
  const text = JSON.stringify([field.field, rows]);
  if (element.dataset.text === text) return;
  element.dataset.text = text;
  element.replaceChildren(make("h4", {}, field.field), make("p", {}, field.description ?? ""),
    make("dl", {}, ...rows.filter(([, value]) => value).map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value)))));
}

/// A form of fields: label, input, unit. `open(field, text)`: sets it; `of(field)`: its value.
export class FieldForm {
  constructor(fields, may_change, change) {
    this.inputs = fields.map((field) => new FieldInput(field, may_change, (text) => change(field.field, text)));
    this.element = make("div", { class: "fields-of" }, ...this.inputs.map((one) =>
      make("label", {}, make("span", {}, one.field.field), one.input, make("span", { class: "faint" }, one.field.choices ? "" : one.field.unit ?? ""))));
  }

  set(of) {
    for (const one of this.inputs) one.set(of(one.field));
  }
}

/// A button by the name that the tool prints, for who has the role.
export function tool_button(name, role, action) {
  const button = make("button", { type: "button", "data-role": role }, name);
  button.addEventListener("click", action);
  return button;
}

/// All, Starting from, Range: "all", "5-", "3-8".
export class AreaChoice {
  constructor(name, highest) {
    this.kind = make("select", { "aria-label": `${name} area selection` }, ...["All", "Starting from", "Range"].map((one) => make("option", {}, one)));
    const number = (what, value) => make("input", { type: "number", min: "1", max: String(highest), value: String(value), "aria-label": `${what} ${name}`, hidden: "" });
    this.first = number("First", 1);
    this.last = number("Last", highest);
    this.kind.addEventListener("change", () => {
      this.first.hidden = this.kind.value === "All";
      this.last.hidden = this.kind.value !== "Range";
    });
    this.element = make("span", { class: "area" }, make("span", {}, `${name} area selection `), this.kind, this.first, this.last);
  }

  get text() {
    if (this.kind.value === "All") return "all";
    return `${this.first.value}-${this.kind.value === "Range" ? this.last.value : ""}`;
  }
}
