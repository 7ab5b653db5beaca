// A list window of a module's settings: a row for each PDO, node or slave, a new one by its number, and the details of the open one.
import { keep_children, make, set_text } from "./dom.js";
import { shown_value } from "./settings.js";
import { FieldForm, FieldInput, cob_id_parts, tool_button } from "./settings_fields.js";
import { MappingTable, mapping_text } from "./settings_mapping.js";

/// What the windows of one row are called [RJ71CN91 3.1].
const details_titles = { node: "CANopen node settings", tpdo: "TPDO details", rpdo: "RPDO details", slave: "NMT slave" };
const hardware_names = ["Device name", "Vendor-ID", "Product code", "Revision number", "Serial number", "Hardware version", "Software version"];
/// Of the node's device file, where one is known [RJ71CN91 3.1 CANopen node settings window].
const file_names = ["EDS file version", "EDS file revision"];
const shown_file = (value) => (value === undefined ? "" : value === null ? "–" : String(value));
const shown_hardware = (value) => (value === undefined ? "" : value === null ? "–" : typeof value === "number" ? `0x${value.toString(16).toUpperCase().padStart(8, "0")}` : value);
const name_field = (window) => ({ field: window.name_field, is_text: true, longest: 256, range: "1 to 256 characters", default: "CANopen node", unit: "", description: "of the node, for people" });

/// As wide as its longest value, so that all columns fit side by side.
function narrow(input, field) {
  if (input.type === "text" && !field.is_text) input.style.width = `calc(${shown_value(field, field.highest).length}ch + .6rem)`;
}

export class SettingsList {
  /// `view`: the SettingsView; `window`: as `configure describe` says.
  constructor(view, window) {
    this.view = view;
    this.window = window;
    this.number = null;  // of the open row
    const is_nodes = window.word === "node";
    this.columns = [...(window.name_field ? [name_field(window)] : []), ...window.fields];
    const hardware = is_nodes ? hardware_names : [];
    const heads = [window.key, ...this.columns.map((one) => one.field), ...hardware, ...(window.maps_objects ? ["Mapping"] : []), "Delete"];
    this.body = make("tbody");
    const add = make("input", { type: "text", inputmode: "numeric", size: "5", maxlength: "5", autocomplete: "off", "aria-label": `New row: ${window.key}`, placeholder: `1-${window.most_key}`, "data-field": window.key });
    add.disabled = !view.may_configure;
    add.addEventListener("change", () => this.add(add));
    const all = tool_button("Delete all", "configure", () => view.settings.change({ command: "configure defaults", window: window.word }));
    this.count = make("span", { class: "faint" });
    this.details = make("div", { class: "details", hidden: "" });
    const table = make("table", { class: "rows" }, make("caption", {}, window.title.replace(/^NMT settings: |^PDO list: /, "")), make("thead", {}, make("tr", {}, ...heads.map((one) => make("th", { scope: "col" }, one)))), this.body);
    this.element = make("div", {}, ...(is_nodes ? [this.node_ways()] : []), make("div", { class: "scrolls", role: "region", "aria-label": window.title, tabindex: "0" }, table),
      make("p", { class: "ways" }, make("label", {}, `New row: ${window.key} `, add), all, this.count), this.details);
  }

  place(number) {
    return `${this.window.word}/${number}`;
  }

  node_ways() {
    const { settings } = this.view;
    return make("div", { class: "ways" },
      tool_button("Read all CANopen nodes", "operate", () => this.read_hardware({})),
      tool_button("Save Object Dictionary on all nodes", "configure", () => this.ask("The object dictionaries of all listed nodes are written into their memory.", () => settings.run({ command: "configure nodes save" }))),
      tool_button("Restore Object Dictionary to default on all nodes", "configure", () => this.ask("All listed nodes lose their settings; defaults count after a reset of the nodes.", () => settings.run({ command: "configure nodes restore" }))));
  }

  /// What cannot be taken back is asked for.
  ask(sentence, action) {
    const dialog = make("dialog", { "aria-label": sentence });
    const [yes, no] = [make("button", { type: "button" }, "Yes"), make("button", { type: "button" }, "No")];
    yes.addEventListener("click", () => {
      dialog.close();
      action();
    });
    no.addEventListener("click", () => dialog.close());
    dialog.addEventListener("close", () => dialog.remove());
    dialog.append(make("p", {}, sentence), make("p", { class: "ways" }, yes, no));
    this.element.append(dialog);
    dialog.showModal();
    no.focus();
  }

  async read_hardware(node) {
    const { settings } = this.view;
    const done = await settings.run({ command: "configure nodes", ...node });
    for (const row of done.rows) settings.hardware.set(row.node, row);
    this.view.draw();
  }

  async add(input) {
    const number = input.value.trim();
    if (!number) return;
    const done = await this.view.settings.change({ command: "configure set", window: this.place(number) });
    input.setAttribute("aria-invalid", done.failed);
    if (done.failed) return;
    input.value = "";
    this.open(Number(number));
  }

  open(number) {
    this.number = number;
    this.made = null;
    if (this.window.maps_objects) this.view.settings.load_mappable(this.window.word);
    this.view.draw();
  }

  draw() {
    const { settings, may_configure } = this.view;
    const rows = [...(settings.rows.get(this.window.word) ?? [])];
    set_text(this.count, `${rows.length} of ${this.window.most_rows} rows`);
    keep_children(this.body, rows, ([number]) => String(number), (key) => this.make_row(Number(key), may_configure), (item, [number, row]) => this.fill_row(item, number, row));
    if (this.number !== null && !settings.row(this.window.word, this.number)) this.number = null;
    this.details.hidden = this.number === null;
    if (this.number !== null) this.draw_details();
  }

  make_row(number, may_configure) {
    const open = make("button", { type: "button", class: "plain", "aria-label": `Details of ${this.window.key} ${number}` }, String(number));
    open.addEventListener("click", () => this.open(number));
    const remove = tool_button("Delete", "configure", () => this.view.settings.change({ command: "configure delete", row: this.place(number) }));
    remove.classList.add("plain");
    remove.setAttribute("aria-label", `Delete ${this.window.key} ${number}`);
    const inputs = this.columns.map((field) => new FieldInput({ ...field, read_only: field.read_only || field.field === "COB-ID" }, may_configure,
      (text) => this.view.set(this.place(number), field.field, text), `${field.field} of ${this.window.key} ${number}`));
    for (const one of inputs) narrow(one.input, one.field);
    const hardware = this.window.word === "node" ? hardware_names.map((name) => make("td", /name|version/.test(name) ? { class: "hardware" } : {})) : [];
    const mapping = this.window.maps_objects ? [make("td", { class: "mapping" })] : [];
    const item = make("tr", { "data-place": this.place(number) }, make("th", { scope: "row" }, open), ...inputs.map((one) => make("td", {}, one.input)), ...hardware, ...mapping, make("td", {}, remove));
    item.fields = { inputs, hardware, mapping };
    return item;
  }

  fill_row(item, number, row) {
    const { inputs, hardware, mapping } = item.fields;
    for (const one of inputs) one.set(one.field.is_text ? row.name : row.values[one.field.field]);
    const said = this.view.settings.hardware.get(number);
    hardware.forEach((cell, i) => set_text(cell, shown_hardware(said?.[hardware_names[i]])));
    for (const cell of mapping) set_text(cell, row.objects.map((one) => `${one.index.toString(16).toUpperCase().padStart(4, "0")}:${one.sub.toString(16).toUpperCase().padStart(2, "0")}`).join(" "));
    if (number === this.number) item.setAttribute("aria-current", "true");
    else item.removeAttribute("aria-current");
  }

  // The open row.

  make_details() {
    const { window, view, number } = this;
    const place = this.place(number);
    const fields = [...(window.name_field ? [name_field(window)] : []), ...window.fields.filter((one) => one.field !== "COB-ID")];
    this.form = new FieldForm(fields, view.may_configure, (name, text) => view.set(place, name, text));
    this.cob_id = window.maps_objects ? new FieldForm(cob_id_parts, view.may_configure, (name, text) => view.set(place, name, text)) : null;
    this.mapping = window.maps_objects
      ? new MappingTable(async (objects) => !(await view.settings.set(place, "map", mapping_text(objects))).failed, (sentence) => {
        view.settings.said = { text: sentence, mood: "error", command: "" };
        view.draw();
      }) : null;
    this.hardware = window.word === "node" ? make("table", { class: "hardware" }) : null;
    const key = new FieldInput({ field: window.key, is_text: true, unit: "", longest: 5 }, true, async (text) => this.go_to(text));
    key.set(String(number));
    const close = make("button", { type: "button", class: "close" }, "Close");
    close.addEventListener("click", () => {
      this.number = null;
      view.draw();
    });
    const title = make("h4", { tabindex: "-1" }, details_titles[window.word] ?? window.title);
    this.details.dataset.place = place;
    this.details.replaceChildren(close, title, make("div", { class: "fields-of" }, make("label", {}, make("span", {}, window.key), key.input)), this.form.element,
      ...(this.cob_id ? [make("fieldset", {}, make("legend", {}, "COB-ID"), this.cob_id.element)] : []), ...(this.mapping ? [this.mapping.element] : []),
      ...(this.hardware ? [this.hardware] : []), this.ways());
    this.made = number;
  }

  /// To the row of another number, which is there.
  async go_to(text) {
    const number = Number(text);
    if (this.view.settings.row(this.window.word, number)) {
      this.open(number);
      return true;
    }
    this.view.settings.said = { text: `${this.window.key} = ${text}: expected a row of the list`, mood: "error", command: "" };
    this.view.draw();
    return false;
  }

  ways() {
    const { window, number, view } = this;
    const { settings } = view;
    const node = String(number);
    const ways = make("div", { class: "ways" });
    if (window.word === "slave") {
      for (const from of ["master", "slave"]) ways.append(tool_button(`Read from ${from}`, "configure", () => settings.change({ command: "configure identify", node, from })));
      ways.append(tool_button("Restore default values", "configure", async () => {
        const done = await settings.change({ command: "configure delete", row: this.place(number) });
        if (!done.failed) await settings.change({ command: "configure set", window: this.place(number) });
        this.open(number);
      }));
    }
    if (window.word === "node") {
      const is_own = number === settings.node_id;
      ways.append(tool_button("Read from module", "operate", () => this.read_hardware({ node })),
        tool_button("Save Object Dictionary", "configure", () => this.ask(`The object dictionary of node ${node} is written into its memory.`, () => settings.run({ command: "configure nodes save", node }))),
        tool_button("Restore Object Dictionary to default", "configure", () => this.ask(`Node ${node} loses its settings; defaults count after its reset.`, () => settings.run({ command: "configure nodes restore", node }))));
      const transfer = [tool_button("Read CANopen node", "configure", () => view.read({ part: "all" })),
        tool_button("Write CANopen node", "configure", () => {
          view.transfer.choose("all", "all");
          view.open_page("transfer");
          view.transfer.compare();
        })];
      for (const button of transfer) {
        button.dataset.off = !is_own;
        if (!is_own) button.title = "PDOs and NMT settings of another node are a project of their own: canopus configure read or write PROJECT --node";
      }
      ways.append(...transfer);
    }
    return ways;
  }

  draw_details() {
    const { settings, may_configure } = this.view;
    if (this.made !== this.number) this.make_details();
    const row = settings.row(this.window.word, this.number);
    this.form.set((field) => (field.is_text ? row.name : row.values[field.field]));
    this.cob_id?.set((field) => field.of(row.values["COB-ID"]));
    this.mapping?.draw(settings.mappable.get(this.window.word) ?? [], row.objects, may_configure);
    if (!this.hardware) return;
    const said = settings.hardware.get(this.number);
    const text = JSON.stringify(said ?? null);
    if (this.hardware.dataset.text === text) return;
    this.hardware.dataset.text = text;
    this.hardware.replaceChildren(make("tbody", {}, ...hardware_names.map((name) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, shown_hardware(said?.[name])))),
      ...file_names.map((name) => make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, shown_file(said?.[name]))))));
  }
}

