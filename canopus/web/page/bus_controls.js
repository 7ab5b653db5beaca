// Who is on a bus: a scan of its nodes, devices without a node-ID by LSS [CiA 305], and single objects of a node by SDO. Each is a command of the run's program, beside the plant.
import { make, set_text } from "./dom.js";
import { DomainWords, bytes_of, file_name, save_bytes } from "./domain_view.js";

const hexadecimal = (number) => (number === undefined ? "-" : `${number.toString(16).toUpperCase().padStart(8, "0")}H`);
const types = ["", "u8", "u16", "u32", "u64", "i8", "i16", "i32", "i64", "f32", "f64", "bool", "text", "bytes", "domain"];

function table_of(caption, heads) {
  const rows = make("tbody");
  const table = make("div", { class: "scrolls", role: "region", "aria-label": caption, tabindex: "0", hidden: "" },
    make("table", { class: "rows" }, make("caption", {}, caption), make("thead", {}, make("tr", {}, ...heads.map((one) => make("th", { scope: "col" }, one)))), rows));
  return { table, fill: (lines) => {
    table.hidden = lines.length === 0;
    rows.replaceChildren(...lines.map((line) => make("tr", {}, ...line.map((text, i) => make(i ? "td" : "th", i ? {} : { scope: "row" }, String(text ?? ""))))));
  } };
}

export class BusControls {
  constructor(commands) {
    this.commands = commands;
    this.role = "look";
    this.buses = new Map();  // of the server's greeting, by name: those that commands can join
    this.groups = [];
  }

  greeted(hello) {
    this.role = hello.role;
    this.buses = new Map(hello.buses.filter((bus) => bus.joins).map((bus) => [bus.bus, bus]));
    this.groups = this.groups.filter((group) => group.element.isConnected);
    for (const group of this.groups) this.show(group);
  }

  may_be_used_on(bus) {
    return this.role !== "look" && this.buses.has(bus);
  }

  /// Hidden where the role or the bus does not allow any of it, buttons where the role is too low for them.
  show({ element, bus }) {
    element.hidden = !this.may_be_used_on(bus);
    for (const button of element.querySelectorAll("[data-role=configure]")) button.disabled = this.role !== "configure";
  }

  keep(element, bus) {
    const group = { element, bus };
    this.groups.push(group);
    this.show(group);
    return element;
  }

  /// `told`: called with the rows that are there, while it runs. What was said stands in `said`.
  async run(button, said, command, told = () => {}) {
    button.disabled = true;
    said.dataset.mood = "";
    set_text(said, `${button.textContent} …`);
    const done = await this.commands.run(command, told);
    button.disabled = false;
    said.dataset.mood = done.code === 0 ? "" : "error";
    said.title = done.command ?? "";
    set_text(said, done.code === 0 ? "" : (done.message || `failed with code ${done.code}`).replace(/^canopus[a-z ]*: /, ""));
    told(done.rows);
    return done.code === 0;
  }

  /// [Scan] and LSS of a bus.
  make(bus) {
    const status = () => make("span", { role: "status" });
    const button = (name, role) => make("button", { type: "button", "data-role": role }, name);
    const input = (label, attributes) => make("label", {}, `${label} `, make("input", { autocomplete: "off", ...attributes }));
    const [scanned, found] = [status(), status()];
    const [scan, find, assign] = [button("Scan", "operate"), button("Find devices without a node-ID", "operate"), button("Give them node-IDs", "configure")];
    const nodes = input("nodes", { value: "1-127", size: 7, maxlength: 20 });
    const first = input("from", { type: "number", min: 1, max: 127, value: 1 });
    const store = make("input", { type: "checkbox" });
    const seen = table_of(`Nodes found on ${bus}`, ["Node", "Name", "State", "Device type", "Vendor-ID", "Product code", "Revision", "Serial number"]);
    const unnamed = table_of(`Devices found by LSS on ${bus}`, ["Vendor-ID", "Product code", "Revision", "Serial number", "Node"]);
    const tell_nodes = (rows) => seen.fill(rows.filter((row) => row.node !== undefined).map((row) => [row.node, row.name, row.state,
      ...[row.device_type, row.vendor, row.product, row.revision, row.serial].map(hexadecimal)]));
    const tell_devices = (rows) => unnamed.fill(rows.filter((row) => row.vendor !== undefined).map((row) => [...[row.vendor, row.product, row.revision, row.serial].map(hexadecimal), row.node ?? "none"]));
    scan.addEventListener("click", async () => {
      let count = 0;
      const fine = await this.run(scan, scanned, { command: "scan", bus, nodes: nodes.lastElementChild.value.trim() }, (rows) => tell_nodes(rows, count = rows.length));
      if (fine) set_text(scanned, `${count} nodes are on the bus`);
    });
    // A simulated device answers at once.
    const patience = () => (this.buses.get(bus)?.live ? {} : { timeout: "50ms" });
    const look = async (from, command) => {
      let count = 0;
      const fine = await this.run(from, found, { bus, ...patience(), ...command }, (rows) => tell_devices(rows, count = rows.length));
      if (fine) set_text(found, count ? `${count} devices` : "no device without a node-ID answers");
    };
    // One device at whatever bit rate: by its LSS address, or the first without a node-ID.
    const [searched, search] = [status(), button("Search all bit rates", "configure")];
    const number = input("node-ID for it", { type: "number", min: 1, max: 127, value: 1 });
    const parts = ["vendor", "product", "revision", "serial"];
    const address = parts.map((part) => input(part, { size: 9, maxlength: 12, placeholder: "any" }));
    search.addEventListener("click", async () => {
      const wish = { command: "lss search", bus, node: number.lastElementChild.value };
      const rate = this.buses.get(bus)?.bit_rate;
      if (rate) wish.bit_rate = String(rate);
      for (const [i, part] of parts.entries()) if (address[i].lastElementChild.value.trim()) wish[part] = address[i].lastElementChild.value.trim();
      let row;
      const fine = await this.run(search, searched, wish, (rows) => { [row] = rows; });
      if (!fine || !row) return;
      tell_devices([row]);
      set_text(searched, `found at ${row.found_at / 1000} kbit/s: is node ${row.node} at ${row.bit_rate / 1000} kbit/s now`);
    });
    find.addEventListener("click", () => look(find, { command: "lss scan" }));
    assign.addEventListener("click", () => look(assign, { command: "lss assign", assign: first.lastElementChild.value, store: store.checked }));
    return this.keep(make("details", { class: "bus-ways" }, make("summary", {}, "Scan and LSS"),
      make("div", { class: "ways", role: "group", "aria-label": `Scan of ${bus}` }, scan, nodes, scanned), seen.table,
      make("div", { class: "ways", role: "group", "aria-label": `LSS of ${bus}` }, find, assign, first, make("label", {}, store, " they keep them"), found),
      make("div", { class: "ways", role: "group", "aria-label": `Search over the bit rates of LSS on ${bus}` }, search, number, ...address, searched), unnamed.table), bus);
  }

  /// One object of a node, read and written.
  make_sdo(bus, node, label) {
    const said = make("span", { role: "status" });
    const object = make("input", { "aria-label": "Object, index and sub-index", placeholder: "1018:02", size: 8, maxlength: 12, autocomplete: "off" });
    const type = make("select", { "aria-label": "Data type" }, ...types.map((one) => make("option", { value: one }, one || "type")));
    const value = make("input", { "aria-label": "Value", placeholder: "value", size: 12, maxlength: 4000, autocomplete: "off" });
    const read = make("button", { type: "button" }, "Read object");
    const write = make("button", { type: "button", "data-role": "configure" }, "Write object");
    const wish = () => ({ bus, node, object: object.value.trim(), ...(type.value ? { type: type.value } : {}) });
    const speed = make("p", { class: "faint speed", role: "status" });
    let last = null;  // the value that is shown
    const domain = new DomainWords(`what ${label} says`, () => save_bytes([bytes_of(last.bytes)], file_name(bus, node, last.object)));
    const run = async (button, command, verb) => {
      let row;
      domain.show(null);
      set_text(speed, "");
      const fine = await this.run(button, said, command, (rows) => { [row] = rows; });
      const bytes = row?.bytes?.replace(/..(?=.)/g, "$& ");
      if (row?.reason) set_text(said, `${row.object}: ${row.reason}`);
      else if (fine && row?.domain) {
        last = row;
        set_text(said, `${row.object} ${verb}`);
        domain.show(row.domain);
        // The plant knows the device file of the slave that a concise DCF is for.
        const named = row.object.startsWith("1F22") ? await this.commands.run({ command: "domain words", bus, object: row.object, bytes: row.bytes }) : null;
        if (named?.code === 0 && last === row) domain.show(named.rows[0]);
      } else if (fine && row) set_text(said, `${row.object} ${verb}: ${row.value === undefined ? bytes : `${row.value} (${bytes})`}`);
      if (fine && row?.transfer && row.transfer.form !== "expedited") set_text(speed, row.transfer.text);
    };
    read.addEventListener("click", () => run(read, { command: "sdo read", ...wish() }, "reads"));
    write.addEventListener("click", () => run(write, { command: "sdo write", ...wish(), value: value.value }, "is written"));
    return this.keep(make("div", {}, make("div", { class: "ways sdo", role: "group", "aria-label": `SDO to ${label}` }, object, type, read, value, write, said), speed, domain.element), bus);
  }
}
