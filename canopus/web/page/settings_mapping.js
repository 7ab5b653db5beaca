// The mapping of a PDO of a module: a table of object name, object description, index and sub-index, of which each fills the others, and the
// 64 bits of the frame.
import { make } from "./dom.js";

const hexadecimal = (value, digits) => `0x${value.toString(16).toUpperCase().padStart(digits, "0")}`;
const data_type = (name) => (name.startsWith("Dummy") ? name.replace("Dummy ", "").replace(/ bit$/, " bit dummy") : name.split(" ").find((word) => /^(Integer|Unsigned|Real|Float)\d*$/.test(word)) ?? "");

export class MappingTable {
  /// `change(objects)`: the new mapping, [{ index, sub, bits }]; resolves to whether it was taken. `refuse(sentence)`: what cannot be.
  constructor(change, refuse) {
    this.change = change;
    this.refuse = refuse;
    this.body = make("tbody");
    this.strip = make("svg:svg", { class: "frame-strip", viewBox: "0 0 64 6", preserveAspectRatio: "none", role: "img" });
    this.facts = make("span", { class: "faint" });
    this.lists = make("div", { hidden: "" });
    const columns = ["Object name", "Object description", "Data type", "Index", "Sub-index", "Remove"];
    this.element = make("div", {}, make("p", {}, this.strip, " ", this.facts), make("div", { class: "scrolls", role: "region", "aria-label": "Mapped objects", tabindex: "0" },
      make("table", { class: "rows" }, make("caption", {}, "Mapping"), make("thead", {}, make("tr", {}, ...columns.map((one) => make("th", { scope: "col" }, one)))), this.body)), this.lists);
  }

  /// `mappable`: what there is; `objects`: what is mapped; `may_change`: and can be changed.
  draw(mappable, objects, may_change) {
    const text = JSON.stringify([mappable.length, objects, may_change]);
    if (text === this.text) return;
    this.text = text;
    if (this.mappable !== mappable) {
      this.mappable = mappable;
      this.lists.replaceChildren(...mappable.map((one, i) => make("datalist", { id: `mappable-${i}` }, ...one.objects.filter(([, , name]) => name).map(([, , name]) => make("option", { value: name })))));
    }
    this.objects = objects;
    const rows = objects.map((object, place) => this.row(object, place, may_change));
    if (may_change) rows.push(this.row(null, objects.length, true));
    this.body.replaceChildren(...rows);
    const used = objects.reduce((sum, one) => sum + one.bits, 0);
    let from = 0;
    this.strip.replaceChildren(make("svg:rect", { x: 0, y: 0, width: 64, height: 6, class: "unused" }), ...objects.map((one, i) => {
      const bar = make("svg:rect", { x: from, y: 0, width: one.bits, height: 6, class: `signal-${i % 6}` });
      from += one.bits;
      return bar;
    }));
    this.strip.setAttribute("aria-label", `${used} of 64 bits are mapped`);
    this.facts.textContent = `${used} of 64 bits`;
  }

  /// Where an object is among those that can be mapped: [number of the name, number of the object].
  place_of(object) {
    for (const [i, named] of this.mappable.entries()) {
      if (object.bits !== undefined && named.bits !== object.bits) continue;
      const j = named.objects.findIndex(([index, sub]) => index === object.index && sub === object.sub);
      if (j >= 0) return [i, j];
    }
    return [-1, -1];
  }

  row(object, place, may_change) {
    const [i, j] = object ? this.place_of(object) : [-1, -1];
    const named = this.mappable[i];
    const label = (name) => `${name} of mapped object ${place + 1}`;
    const name = make("select", { "aria-label": label("Object name") }, make("option", { value: "" }, ""), ...this.mappable.map((one, k) => make("option", { value: String(k) }, one.name)));
    name.value = i < 0 ? "" : String(i);
    const text = (what, value, list = "") => make("input", { type: "text", value, autocomplete: "off", maxlength: "60", "aria-label": label(what), ...(list ? { list } : {}) });
    const description = text("Object description", named?.objects[j][2] ?? "", i < 0 ? "" : `mappable-${i}`);
    const index = text("Index", object ? hexadecimal(object.index, 4) : "");
    const sub = text("Sub-index", object ? hexadecimal(object.sub, 2) : "");
    const remove = make("button", { type: "button", class: "plain", "aria-label": `Remove mapped object ${place + 1}` }, "Remove");
    for (const one of [name, description, index, sub, remove]) one.disabled = !may_change;
    name.addEventListener("change", () => (name.value === "" ? this.put(place, null) : this.put(place, this.first_of(Number(name.value)))));
    description.addEventListener("change", () => this.by_description(place, Number(name.value), description));
    const by_numbers = () => this.by_numbers(place, index, sub);
    index.addEventListener("change", by_numbers);
    sub.addEventListener("change", by_numbers);
    remove.addEventListener("click", () => this.put(place, null));
    return make("tr", {}, make("td", {}, name), make("td", {}, description), make("td", {}, named ? data_type(named.name) : object ? `${object.bits} bits` : ""), make("td", {}, index), make("td", {}, sub), make("td", {}, object ? remove : ""));
  }

  /// The first one that is not mapped here yet.
  first_of(i) {
    const named = this.mappable[i];
    const free = named.objects.find(([index, sub]) => !this.objects.some((one) => one.index === index && one.sub === sub && one.bits === named.bits)) ?? named.objects[0];
    return { index: free[0], sub: free[1], bits: named.bits };
  }

  by_description(place, i, input) {
    const named = this.mappable[i];
    const found = named?.objects.find(([, , name]) => name === input.value.trim());
    if (found) return this.put(place, { index: found[0], sub: found[1], bits: named.bits });
    input.setAttribute("aria-invalid", true);
    this.refuse(`Object description = ${input.value}: expected ${named ? `one from ${named.objects[0][2]} to ${named.objects.at(-1)[2]}` : "an object name first"}`);
  }

  by_numbers(place, index, sub) {
    const number = (input, name, highest) => {
      const value = /^(0x)?[0-9a-f]+$/i.test(input.value.trim()) ? parseInt(input.value, 16) : NaN;
      const fits = value <= highest;
      input.setAttribute("aria-invalid", !fits);
      if (!fits) this.refuse(`${name} = ${input.value}: expected ${hexadecimal(0, highest > 0xFF ? 4 : 2)} to ${hexadecimal(highest, 2)}`);
      return fits ? value : null;
    };
    const object = { index: number(index, "Index", 0xFFFF) };
    if (object.index === null) return;
    if (sub.value.trim() === "") return sub.focus();
    object.sub = number(sub, "Sub-index", 0xFF);
    if (object.sub === null) return;
    const [i] = this.place_of(object);
    if (i >= 0) return this.put(place, { ...object, bits: this.mappable[i].bits });
    for (const one of [index, sub]) one.setAttribute("aria-invalid", true);
    this.refuse(`${hexadecimal(object.index, 4)}:${hexadecimal(object.sub, 2)} is none of the objects that can be mapped here`);
  }

  /// An object in this place, or none.
  async put(place, object) {
    const objects = this.objects.slice();
    objects.splice(place, 1, ...(object ? [object] : []));
    if (!await this.change(objects)) this.text = "";  // what was refused is not to be taken for what is mapped
  }
}

export const mapping_text = (objects) => objects.map((one) => `${one.index.toString(16).padStart(4, "0")}:${one.sub.toString(16).padStart(2, "0")}:${one.bits}`).join(" ");
