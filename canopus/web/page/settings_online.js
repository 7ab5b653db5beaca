// What the configuration tool does with the module itself: transfer, network scan, SDO send / receive, module status; and backups.
import { make, set_text } from "./dom.js";
import { AreaChoice, tool_button } from "./settings_fields.js";

const select = (name, texts) => make("select", { "aria-label": name }, ...texts.map(([value, text]) => make("option", { value }, text ?? value)));
const labelled = (name, input) => make("label", {}, make("span", {}, name), input);
const table_of = (caption, heads, body) => make("div", { class: "scrolls", role: "region", "aria-label": caption, tabindex: "0" },
  make("table", { class: "rows wraps" }, make("caption", {}, caption), make("thead", {}, make("tr", {}, ...heads.map((one) => make("th", { scope: "col" }, one)))), body));
const row_of = (texts, mood = "") => make("tr", { class: mood }, ...texts.map((one, i) => make(i ? "td" : "th", i ? {} : { scope: "row" }, String(one ?? ""))));

/// What differs is shown, then written; what was written is read back.
export class TransferPart {
  constructor(view) {
    this.view = view;
    this.part = select("What", [["all", "all settings"], ["basic", "module basic settings"], ["tpdo", "Transmit PDOs"], ["rpdo", "Receive PDOs"], ["nmt", "NMT settings"]]);
    this.pdos = new AreaChoice("PDO", 256);
    this.stop = make("input", { type: "checkbox" });
    this.facts = make("p", { role: "status" });
    this.rows = make("tbody");
    this.steps = make("tbody");
    this.step_table = table_of("Steps", ["Step", "Result"], this.steps);
    this.write = tool_button("OK", "configure", () => this.do_write());
    const compare = tool_button("Compare", "operate", () => this.compare());
    this.element = make("div", {}, make("p", { class: "faint" }, "The settings go into the flash ROM of the module, through its PLC. The CPU module must be in STOP."),
      make("div", { class: "ways" }, labelled("Part ", this.part), this.pdos.element, make("label", {}, this.stop, " put the CPU module into STOP for it, and into RUN again"), compare, this.write),
      this.facts, table_of("What will be written", ["Setting", "Project", "Module"], this.rows), this.step_table);
  }

  choose(part, pdos) {
    this.part.value = part;
    const [first, last] = pdos.split("-");
    this.pdos.kind.value = pdos === "all" ? "All" : last ? "Range" : "Starting from";
    this.pdos.first.value = first === "all" ? 1 : first;
    if (last) this.pdos.last.value = last;
    this.pdos.kind.dispatchEvent(new Event("change"));
  }

  get wish() {
    return { part: this.part.value, pdos: this.pdos.text };
  }

  async compare() {
    const { settings } = this.view;
    const done = await settings.run({ command: "configure diff", ...this.wish }, { fine: [0, 4] });
    settings.steps = [];
    settings.compared(done.failed ? null : done.rows);
    this.view.draw();
  }

  async do_write() {
    const { settings } = this.view;
    const steps = (rows) => {
      settings.steps = rows.filter((row) => row.step !== undefined);
      this.view.draw();
    };
    const done = await settings.run({ command: "configure write", ...this.wish, stop: this.stop.checked, yes: true }, { told: steps });
    steps(done.rows);
    // Rows behind the steps are what the module has otherwise all the same.
    const last = done.rows.findLastIndex((row) => row.step !== undefined);
    if (done.failed) settings.compared(last < 0 ? settings.plan : done.rows.slice(last + 1).filter((row) => row.field !== undefined), false);
    else {
      settings.compared([]);
      settings.said.text = settings.steps.length ? "written and read back: the same. What the module takes over at its start counts after a reset" : "nothing was to be written";
    }
    this.view.draw();
  }

  draw() {
    const { settings } = this.view;
    const { plan, steps } = settings;
    this.write.dataset.off = plan === null || plan.length === 0;
    set_text(this.facts, settings.running?.startsWith("configure diff") ? "asks the module …" : plan === null ? "not compared yet" : plan.length ? `${plan.length} settings differ; this is what will be written` : "the module has it all");
    this.rows.replaceChildren(...(plan ?? []).map((row) => row_of([row.field, row.project, row.device], "differs")));
    this.step_table.hidden = steps.length === 0;
    this.steps.replaceChildren(...steps.map((row) => row_of([row.step, row.good ? "done" : "refused"], row.good ? "same" : "differs")));
  }
}

/// "R Safety" of "R08SFCPU".
const series_of = (name) => (name.startsWith("R") ? (/SF/.test(name) ? "R Safety" : "R") : "–");

/// The way to the PLC: the program was started with it.
export class SetupPart {
  constructor(view) {
    this.view = view;
    const plc = view.settings.one.plc;
    const option = (name, otherwise) => plc.find((one) => one.startsWith(`--${name}=`))?.split("=")[1] ?? otherwise;
    const asked = "asked of the CPU module";
    const cpu = option("cpu", "none");
    const rows = [["Select transfer setup", view.settings.one.setup || "none"], ["PC side I/F", "Ethernet board"], ["Connect module", "CPU module"], ["Protocol", plc.includes("--udp") ? "UDP" : "TCP"], ["Time out", option("timeout", "3s")],
      ["PLC side I/F", "CPU module"], ["CPU series", asked], ["CPU type", asked], ["Host(IP Address)", option("host", "none: no PLC of the plant has this module")], ["Port", option("port", "5007")],
      ["Frame", `${plc.includes("--1e") ? "1E" : plc.includes("--4e") ? "4E" : "3E"} ${plc.includes("--ascii") ? "ASCII" : "binary"}`], ["Station type", "Host station"], ["Connect CPU series", asked], ["Multiple CPU", cpu === "none" ? "None" : `No.${cpu}`]];
    this.rows = new Map(rows.map((row) => [row[0], row_of(row)]));
    this.result = make("p", { role: "status" });
    this.element = make("div", {}, make("table", { class: "hardware" }, make("tbody", {}, ...this.rows.values())),
      make("p", { class: "faint" }, "The program was started with this setup: ", make("code", {}, "canopus web FILE.xml --host … --port …"), ", or the PLC of the plant has the module. ",
        "Transfer setups are kept by ", make("code", {}, "canopus configure setup"), " (set, test, rename, remove) and used by ", make("code", {}, "canopus web FILE.xml --setup NAME"), "."),
      make("div", { class: "ways" }, tool_button("Comm. Test", "operate", () => this.test())), this.result);
  }

  async test() {
    const done = await this.view.settings.run({ command: "plc type" });
    const name = done.rows[0]?.name ?? "";
    if (!done.failed && name) {
      for (const key of ["CPU series", "Connect CPU series"]) set_text(this.rows.get(key).lastElementChild, series_of(name));
      set_text(this.rows.get("CPU type").lastElementChild, name.replace(/CPU$/, ""));
    }
    set_text(this.result, done.failed ? "no connection" : `connected: ${done.rows[0] ? `${done.rows[0].name ?? ""}` : "the PLC answers"}`);
  }
}

export class ScanPart {
  constructor(view) {
    this.view = view;
    this.area = new AreaChoice("Node ID", 127);
    this.rows = make("tbody");
    this.current = make("output", { "aria-label": "Current Node ID" });
    this.element = make("div", {}, make("div", { class: "ways" }, this.area.element, tool_button("Scan", "operate", () => this.scan())),
      make("p", {}, "Current Node ID ", this.current), table_of("Found CANopen nodes", ["Node ID", "Product name"], this.rows));
  }

  async scan() {
    const { settings } = this.view;
    const show = (rows) => {
      set_text(this.current, String(rows.findLast((row) => row.current !== undefined)?.current ?? ""));
      this.rows.replaceChildren(...rows.filter((row) => row.node !== undefined).map((row) => row_of([row.node, row.name])));
    };
    const done = await settings.run({ command: "configure scan", nodes: this.area.text, progress: true }, { told: show });
    show(done.rows);
    set_text(this.current, "");
    if (!done.failed) settings.said.text = `${done.rows.filter((row) => row.node !== undefined).length} CANopen nodes found`;
    this.view.draw();
  }
}

const lengths = ["STRING", "BYTE_LENGTH_1", "BYTE_LENGTH_2", "BYTE_LENGTH_4", "BYTE_LENGTH_6", "BYTE_LENGTH_8"];

export class SdoPart {
  constructor(view) {
    this.view = view;
    this.fields = [
      { field: "Data direction", range: "Read data, Write data", default: "Read data", description: "what is done with the object" },
      { field: "Node ID", range: "1 to 127; 0: the module itself", default: "127", description: "of the node that has the object" },
      { field: "Index", range: "0x0000 to 0xFFFF", default: "0x0000", description: "of the object, hexadecimal" },
      { field: "Sub-index", range: "0x00 to 0xFF", default: "0x00", description: "of the object, hexadecimal" },
      { field: "Data length", range: lengths.join(", "), default: "BYTE_LENGTH_2", description: "of the data that are written" },
      { field: "Data", range: "decimal, hexadecimal with 0x, or text", default: "0", description: "what is written" },
    ];
    const text = (value) => make("input", { type: "text", value, autocomplete: "off", maxlength: "200" });
    this.inputs = [select("Data direction", [["Read data"], ["Write data"]]), text("127"), text("0x0000"), text("0x00"), select("Data length", lengths.map((one) => [one])), text("0")];
    this.inputs[4].value = "BYTE_LENGTH_2";
    this.inputs.forEach((input, i) => {
      input.dataset.field = this.fields[i].field;
    });
    this.execute = tool_button("Execute", "operate", () => this.run());
    this.inputs[0].addEventListener("change", () => this.draw());
    this.list = make("dl");
    this.result = make("div", { role: "status", class: "result" }, this.list);
    this.element = make("div", {}, make("div", { class: "fields-of" }, ...this.inputs.map((input, i) => labelled(this.fields[i].field, input))), make("div", { class: "ways" }, this.execute),
      make("h4", {}, "Result"), this.result);
    this.draw();
  }

  draw() {
    const writes = this.inputs[0].value === "Write data";
    this.execute.dataset.role = writes ? "configure" : "operate";
    for (const input of this.inputs.slice(4)) input.disabled = !writes;
    this.view.section && this.execute.isConnected && (this.execute.disabled = this.view.settings.running !== null || (this.view.role === "look") || (writes && !this.view.may_configure));
  }

  /// Index or sub-index without 0x and H, or null.
  number(place, digits) {
    const input = this.inputs[place];
    const found = input.value.trim().match(/^(?:0x)?([0-9a-f]+)h?$/i);
    const fits = found !== null && parseInt(found[1], 16) < 16 ** digits;
    input.setAttribute("aria-invalid", !fits);
    return fits ? found[1].padStart(digits, "0").slice(-digits) : null;
  }

  refuse(place) {
    const { field, range } = this.fields[place];
    this.show([["", `${field} = ${this.inputs[place].value}: expected ${range}`]], "error");
  }

  show(rows, mood = "") {
    this.result.dataset.mood = mood;
    this.list.replaceChildren(...rows.map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, value))));
  }

  async run() {
    const [direction, node, , , length, data] = this.inputs.map((input) => input.value.trim());
    const is_node = /^\d{1,3}$/.test(node) && Number(node) <= 127;
    this.inputs[1].setAttribute("aria-invalid", !is_node);
    const [index, sub] = [this.number(2, 4), this.number(3, 2)];
    if (!is_node) return this.refuse(1);
    if (index === null) return this.refuse(2);
    if (sub === null) return this.refuse(3);
    const object = `${index}:${sub}`;
    const writes = direction === "Write data";
    const done = await this.view.settings.run(writes ? { command: "configure sdo-write", node, object, data, length } : { command: "configure sdo-read", node, object });
    if (done.failed) return this.show([["", this.view.settings.said.text]], "error");
    this.show([["", done.rows[0]?.result ?? ""], ...done.rows.slice(1).map((row) => [row.name, row.value])]);
  }
}

export class StatusPart {
  constructor(view) {
    this.view = view;
    this.rows = make("tbody");
    this.element = make("div", {}, make("div", { class: "ways" }, tool_button("Refresh", "operate", () => this.look("configure status")), tool_button("Clear error", "operate", () => this.look("configure status clear")),
      tool_button("Reset", "operate", () => this.ask())), table_of("Module status", ["What", "State"], this.rows));
  }

  async look(command) {
    const done = await this.view.settings.run({ command });
    if (!done.failed) this.rows.replaceChildren(...done.rows.map((row) => row_of([row.name, row.value])));
  }

  ask() {
    const dialog = make("dialog", { "aria-label": "NMT master reset" });
    const [yes, no] = [make("button", { type: "button" }, "Yes"), make("button", { type: "button" }, "No")];
    yes.addEventListener("click", async () => {
      dialog.close();
      const done = await this.view.settings.run({ command: "configure reset" });
      if (!done.failed) this.view.settings.said.text = "the NMT master was reset and has started again";
      this.view.draw();
    });
    no.addEventListener("click", () => dialog.close());
    dialog.addEventListener("close", () => dialog.remove());
    dialog.append(make("h2", {}, "NMT master reset"), make("p", {}, "The NMT master is reset and started again, and with it the network."), make("p", { class: "ways" }, yes, no));
    this.element.append(dialog);
    dialog.showModal();
    no.focus();
  }
}

export class ExportPart {
  constructor(view) {
    this.view = view;
    const file = make("input", { type: "file", accept: ".xml", "aria-label": "File" });
    this.file = file;
    file.disabled = !view.may_configure;
    file.addEventListener("change", () => this.take(file));
    this.element = make("div", {}, make("p", {}, "A backup of the settings is one XML file; the settings of a newer version are refused."),
      make("table", { class: "hardware" }, make("tbody", {}, row_of(["Save", "each change is in the file at once"]), row_of(["Save as", "where canopus web begins, or canopus configure export"]))),
      make("div", { class: "ways" }, tool_button("Export", "look", () => this.export())),
      make("p", {}, make("label", {}, make("span", {}, "Import"), " ", file)));
  }

  async export() {
    const { settings } = this.view;
    const done = await settings.run({ command: "configure export" });
    if (done.file === undefined) return;
    const link = make("a", { href: URL.createObjectURL(new Blob([done.file], { type: "application/xml" })), download: `${settings.one.file.split("/").pop().replace(/\.xml$/, "")}-backup.xml` });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  }

  async take(input) {
    const [file] = input.files;
    if (!file) return;
    const { settings } = this.view;
    if (file.size > 1500000) settings.said = { text: `${file.name} is larger than 1.5 MB`, mood: "error", command: "" };
    else await settings.change({ command: "configure import", file: { name: file.name, text: await file.text() } });
    input.value = "";
    this.view.draw();
  }
}
