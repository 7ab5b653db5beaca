// The project of a bus: its nodes, what does not fit, a node's values beside those of its device, and what goes to the devices.
import { make, set_text } from "./dom.js";
import { Project, is_identity } from "./project.js";
import { PdoView } from "./pdo_view.js";
import { value_text, words_of } from "./value_words.js";
import { plan_of, results_of } from "./transfer.js";

const most_rows = 300;
const percent = (share) => `${(100 * share).toFixed(1)} %`;
/// The longest cable by CiA 301, in metres, by kbit/s.
const cables = new Map([[1000, 25], [800, 50], [500, 100], [250, 250], [125, 500], [50, 1000], [20, 2500], [10, 5000]]);

function rate_words(bit_rate) {
  if (!bit_rate) return "bit rate not known";
  const cable = cables.get(bit_rate / 1000);
  return `${bit_rate / 1000} kbit/s (sample point 87.5 % by CiA 301${cable ? `, at most ${cable} m of cable` : ""})`;
}

const shown = (value) => (value === null || value === undefined ? "" : String(value));

export class ProjectView {
  /// `section`: of the page; `is_hexadecimal`: how numbers are shown.
  constructor(section, commands) {
    this.section = section;
    this.commands = commands;
    this.role = "look";
    this.projects = [];
    this.project = null;
    this.opened = null;  // node-ID
    this.is_transfer = false;
    this.plan = [];
    this.results = [];
    const part = (id) => section.querySelector(`#${id}`);
    [this.title, this.ways, this.said, this.facts, this.nodes, this.findings, this.drop, this.node_part, this.node_title, this.node_form,
      this.find, this.only_configured, this.object_count, this.object_rows, this.transfer_part, this.transfer_facts, this.transfer_rows] =
      ["project-title", "project-ways", "project-said", "project-facts", "project-nodes", "project-findings", "project-drop", "project-node",
        "project-node-title", "project-node-form", "project-find", "project-configured", "project-object-count", "project-objects",
        "transfer", "transfer-facts", "transfer-rows"].map(part);
    this.pdos = new PdoView(part("pdo-part"), this);
    this.make_ways();
    this.find.addEventListener("input", () => this.draw_objects());
    this.only_configured.addEventListener("change", () => this.draw_objects());
    part("project-close-node").addEventListener("click", () => this.open_node(null));
    part("transfer-close").addEventListener("click", () => this.close_transfer());
    this.write_button = part("transfer-write");
    this.write_button.addEventListener("click", () => this.write());
    this.file = part("project-file");
    this.file.addEventListener("change", () => this.add_files([...this.file.files]));
    this.accepted = part("project-accepted");
    this.bit_rate = part("project-bit-rate");
    this.bit_rate.replaceChildren(...[0, 10, 20, 50, 100, 125, 250, 500, 800, 1000].map((rate) =>
      make("option", { value: rate === 0 ? "" : `${rate}k` }, rate === 0 ? "not the same everywhere" : `${rate} kbit/s`)));
    this.bit_rate.addEventListener("change", () => this.bit_rate.value && this.project.change({ command: "project set", bit_rate: this.bit_rate.value }));
    for (const name of ["dragenter", "dragover"]) {
      section.addEventListener(name, (event) => {
        if (!event.dataTransfer?.types.includes("Files")) return;
        event.preventDefault();
        this.drop.classList.add("over");
      });
    }
    section.addEventListener("dragleave", (event) => event.target === section && this.drop.classList.remove("over"));
    section.addEventListener("drop", (event) => {
      if (!event.dataTransfer?.files.length) return;
      event.preventDefault();
      this.drop.classList.remove("over");
      this.add_files([...event.dataTransfer.files]);
    });
    this.object_rows.addEventListener("change", (event) => this.set_value(event.target));
    this.object_rows.addEventListener("click", (event) => {
      const object = event.target.closest("[data-unset]")?.dataset.unset;
      if (object) this.project.change({ command: "project unset", node: String(this.opened), items: [object] }).then(() => this.project.load_objects(this.opened));
    });
  }

  /// What the server says there is; the first project is shown at once.
  greeted(hello) {
    this.role = hello.role;
    this.projects = hello.buses.filter((bus) => bus.project).map((bus) => new Project(bus, this.commands, () => this.draw()));
    this.section.hidden = this.projects.length === 0;
    if (this.projects.length) this.open(0);
    return this.projects.map((project) => project.bus.bus);
  }

  open(number, _name, rest) {
    const project = this.projects[number];
    if (!project) return;
    if (this.project !== project) {
      this.project = project;
      this.opened = null;
      project.load();
    }
    this.number = number;
    if (rest !== undefined && /^\d{1,3}$/.test(rest)) this.open_node(Number(rest));
    if (rest !== undefined || location.hash === `#project/${number}`) this.title.focus();
    this.draw();
  }

  /// What anybody has done, as the audit log has it: others change the project, too.
  done_by_somebody(command) {
    this.project?.done_by_somebody(command);
  }

  get may_configure() {
    return this.role === "configure";
  }

  make_ways() {
    const ways = [
      ["Scan", "operate", () => this.scan()],
      ["Adopt all", "configure", () => this.adopt()],
      ["Add a device…", "configure", () => this.file.click()],
      ["Compare with devices", "operate", () => this.compare()],
      ["Transfer…", "configure", () => this.open_transfer()],
      ["Read from devices", "configure", () => this.read()],
      ["Undo", "configure", () => this.undo()],
      ["Report", "look", () => this.report()],
    ];
    for (const [name, role, action] of ways) {
      const button = make("button", { type: "button", "data-role": role }, name);
      button.addEventListener("click", action);
      this.ways.append(button);
    }
    this.stop_button = make("button", { type: "button", hidden: "" }, "Stop");
    this.stop_button.addEventListener("click", () => this.commands.stop());
    this.ways.append(this.stop_button);
  }

  // What people do.

  async add_files(files) {
    this.file.value = "";
    for (const file of files) {
      if (file.size > 1500000) {
        this.project.said = { text: `${file.name} is larger than 1.5 MB: add it with canopus project add`, mood: "error", command: "" };
        this.draw();
        continue;
      }
      const done = await this.project.change({ command: "project add", file: { name: file.name, text: await file.text() } });
      const added = done.rows.find((row) => row.event === "added");
      if (added) this.project.said.text = `${added.name || file.name} is node ${added.node}`;
      this.draw();
    }
  }

  async scan() {
    const done = await this.project.run({ command: "scan" }, { told: (rows) => this.draw_found(rows) });
    this.draw_found(done.rows);
    if (!done.failed) this.project.said.text = `${done.rows.length} nodes are on the bus`;
    this.draw();
  }

  async adopt() {
    const done = await this.project.run({ command: "project adopt" }, { fine: [0, 4], told: (rows) => this.draw_found(rows) });
    await this.project.load();
    this.draw_found(done.rows.filter((row) => row.match !== undefined));
    if (!done.failed) this.project.said.text = `${done.rows.filter((row) => row.result === "added").length} nodes are taken over`;
    this.draw();
  }

  async compare() {
    this.project.forget(null);  // what was seen before may be otherwise now
    const done = await this.project.run({ command: "project diff" }, { fine: [0, 4], told: (rows) => this.project.found(rows) });
    this.project.found(done.rows);
    const differ = done.rows.reduce((sum, row) => sum + (row.differ ?? 0), 0);
    const others = [...new Set(done.rows.filter(is_identity).map((row) => row.node))];
    const said = [...others.map((id) => `${this.project.label(id)} is another device`), ...(differ ? [`${differ} values differ`] : [])];
    if (!done.failed) this.project.said.text = said.join("; ") || "the devices are as the project has them";
    this.project.tell_silence(done.rows);
    this.draw();
  }

  async read() {
    const done = await this.project.run({ command: "project read" }, { fine: [0, 4] });
    await this.project.load();
    this.project.forget(null);
    if (!done.failed) this.project.said.text = `${done.rows.filter((row) => row.state === "taken").length} values are taken over`;
    this.draw();
  }

  async undo() {
    const done = await this.project.change({ command: "project undo" });
    const undone = done.rows.find((row) => row.event === "undone");
    if (undone) this.project.said.text = `taken back: ${undone.title}`;
    this.draw();
  }

  async report() {
    const done = await this.project.run({ command: "project report" });
    if (done.file !== undefined) this.save(done.file, "text/html", "report.html");
  }

  /// The browser keeps a file.
  save(text, type, name) {
    const link = make("a", { href: URL.createObjectURL(new Blob([text], { type })), download: name });
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 60000);
    this.project.said.text = name;
    this.draw();
  }

  async save_dcf(node) {
    const done = await this.project.run({ command: "project dcf save", node: String(node.node) });
    if (done.file !== undefined) this.save(done.file, "text/plain", (node.file ?? "node.dcf").split("/").pop());
  }

  /// Which values a DCF has otherwise; then they may be taken over.
  async compare_dcf(node, chosen) {
    if (chosen.size > 1500000) {
      this.project.said = { text: `${chosen.name} is larger than 1.5 MB: take it over with canopus project dcf load`, mood: "error", command: "" };
      return this.draw();
    }
    const file = { name: chosen.name, text: await chosen.text() };
    const wish = { node: String(node.node), file };
    const done = await this.project.run({ command: "project dcf compare", ...wish });
    if (![0, 4].includes(done.code)) return;
    this.project.said = { text: done.code === 0 ? `${file.name}: the same values` : `${file.name}: ${done.rows.length} values differ`, mood: "", command: done.command ?? "" };
    const take = make("button", { type: "button" }, "Take over these values");
    const cancel = make("button", { type: "button" }, "Leave them");
    const close = () => { this.dcf_part.hidden = true; };
    take.disabled = !this.may_configure;
    take.addEventListener("click", () => this.project.change({ command: "project dcf load", ...wish }).then(close));
    cancel.addEventListener("click", close);
    this.dcf_part.hidden = done.code === 0;
    this.dcf_part.replaceChildren(make("table", { class: "rows" }, make("caption", {}, `${file.name} and ${this.project.label(node.node)}`),
      make("thead", {}, make("tr", {}, ...["Object", "Name", "Project", "DCF", "Difference"].map((one) => make("th", { scope: "col" }, one)))),
      make("tbody", {}, ...done.rows.map((row) => make("tr", { class: "differs" }, make("th", { scope: "row" }, row.object), ...[row.name, row.project, row.dcf, row.state].map((one) => make("td", {}, one ?? "")))))), take, " ", cancel);
    this.draw();
    if (done.code === 4) take.focus();
  }

  // Transfer: look at what differs, then write, then what became of each step.

  async open_transfer() {
    this.is_transfer = true;
    this.is_planned = false;
    this.plan = [];
    this.results = [];
    await this.look_at_plan();
    this.draw();
    this.write_button.focus();
  }

  async look_at_plan() {
    this.project.forget(null);
    this.draw();
    const done = await this.project.run({ command: "project write" }, { fine: [0, 4] });
    this.plan = plan_of(done.rows);
    this.project.found(done.rows);
    this.project.tell_silence(done.rows);
    this.is_planned = !done.failed;
  }

  async write() {
    // Somebody may have written to the devices since the list was shown: nothing is written that was not in it.
    const shown_plan = JSON.stringify(this.plan);
    await this.look_at_plan();
    if (JSON.stringify(this.plan) !== shown_plan) {
      if (this.is_planned) Object.assign(this.project.said, { text: "the devices have changed since this list was made: look at it again", mood: "error" });
      return this.draw();
    }
    const tell = (rows) => {
      this.results = results_of(rows);
      this.draw_transfer();
    };
    const done = await this.project.run({ command: "project write", yes: true }, { told: tell });
    tell(done.rows);
    this.project.found(done.rows);
    const bad = this.results.filter((row) => row.state !== "written").length;
    if (bad && !done.message) Object.assign(this.project.said, { text: `${bad} of ${this.results.length} values are not written; the list says why`, mood: "error" });
    if (!done.failed && !bad && this.results.length) this.project.said.text = `${this.results.length} values are written and read back`;
    this.project.tell_silence(done.rows);
    // What was refused before it began is still to be written.
    if (!done.failed || this.results.length) this.plan = [];
    this.draw();
  }

  close_transfer() {
    this.is_transfer = false;
    this.draw();
    this.title.focus();
  }

  // A node.

  open_node(id) {
    this.opened = id;
    this.accepted.hidden = true;
    this.draw();
    if (id === null) return this.title.focus();
    this.project.load_objects(id).then(() => this.node_title.focus());
  }

  async set_value(input) {
    const object = input.dataset.object;
    if (!object || input.value === input.dataset.value) return;
    const done = await this.project.change({ command: "project set", node: String(this.opened), items: [`${object}=${input.value}`] });
    if (done.failed) {
      input.setAttribute("aria-invalid", "true");
      return input.focus();
    }
    input.dataset.value = input.value;
    await this.project.load_objects(this.opened);
  }

  async change_node(fields) {
    const done = await this.project.change({ command: "project set", node: String(this.opened), ...fields });
    if (!done.failed && fields.node_id) this.opened = Number(fields.node_id);
    await this.project.load_objects(this.opened);
  }

  /// A device that was replaced: what it says of itself otherwise than the project, to be confirmed.
  async look_at_device() {
    const node = String(this.opened);
    const done = await this.project.run({ command: "project accept", node }, { fine: [0, 4] });
    const rows = done.rows.filter((row) => row.object !== undefined);
    if (done.failed) return;
    this.accepted.hidden = rows.length === 0;
    if (rows.length === 0) this.project.said.text = "it is the device that the project has";
    this.draw();
    const hex = (value) => `${Number(value).toString(16).toUpperCase().padStart(8, "0")}H`;
    const confirm = make("button", { type: "button", id: "project-accept" }, "Accept");
    const cancel = make("button", { type: "button" }, "Cancel");
    cancel.addEventListener("click", () => { this.accepted.hidden = true; });
    confirm.addEventListener("click", async () => {
      this.accepted.hidden = true;
      const taken = await this.project.change({ command: "project accept", node, yes: true });
      if (!taken.failed) this.project.said.text = "this device is the project's now";
      await this.project.load_objects(this.opened);
      this.draw();
    });
    this.accepted.replaceChildren(make("h4", {}, "This becomes the project's"), make("table", { class: "rows" }, make("tbody", {}, ...rows.map((row) =>
      make("tr", {}, make("th", { scope: "row" }, this.project.label(row.node)), make("td", {}, row.object), make("td", {}, row.name), make("td", {}, `project ${hex(row.project)}`), make("td", {}, `device ${hex(row.device)}`))))),
      confirm, " ", cancel);
    confirm.focus();
  }

  // What is seen.

  draw() {
    const project = this.project;
    if (!project) return;
    const name = project.network?.network || project.bus.project;
    set_text(this.title, `Project ${name}`);
    set_text(this.said.querySelector("b"), project.running ? `${project.running} …` : project.said.text);
    set_text(this.said.querySelector("code"), project.running ? "" : project.said.command);
    this.said.dataset.mood = project.said.mood;
    const roles = ["look", "operate", "configure"];
    for (const button of this.ways.querySelectorAll("[data-role]")) {
      const is_low = roles.indexOf(this.role) < roles.indexOf(button.dataset.role);
      button.disabled = is_low || project.running !== null;
      button.title = is_low ? `the role ${button.dataset.role} is needed` : "";
    }
    this.stop_button.hidden = project.running === null;
    this.draw_network();
    this.draw_node();
    this.draw_transfer();
    this.pdos.draw(project);
  }

  draw_network() {
    const { network, nodes, findings } = this.project;
    set_text(this.facts, !network ? "" : `${nodes.length} nodes · ${rate_words(network.bit_rate)} · ` +
      `load ${percent(network.load)} by timers and SYNC, ${percent(network.load_at_most)} at most` +
      (network.unlimited ? `, ${network.unlimited} TPDOs without a limit` : ""));
    this.bit_rate.disabled = !this.may_configure;
    if (document.activeElement !== this.bit_rate) this.bit_rate.value = network?.bit_rate ? `${network.bit_rate / 1000}k` : "";
    const text = JSON.stringify([nodes, findings, [...this.project.states], this.opened]);
    if (this.drawn_network === text) return;
    this.drawn_network = text;
    this.nodes.replaceChildren(...nodes.map((node) => {
      const open = make("button", { type: "button", class: "plain", "aria-pressed": this.opened === node.node }, node.name || `Node ${node.node}`);
      open.addEventListener("click", () => this.open_node(node.node));
      const mistakes = findings.filter((one) => one.node === node.node && one.severity !== "note");
      const state = this.project.states.get(node.node);
      const device = !state ? "" : state.state === "same" ? "as the project" : state.differ ? `${state.differ} differ` : state.reason ?? state.state;
      const row = make("tr", {}, make("th", { scope: "row" }, String(node.node)), make("td", {}, open), make("td", {}, node.product ?? node.error ?? ""),
        make("td", {}, node.present ? "yes" : "no"), make("td", {}, `${node.tpdos ?? 0} / ${node.rpdos ?? 0}`),
        make("td", { class: mistakes.length ? "bad" : "" }, mistakes.length ? `${mistakes.length}` : ""),
        make("td", { class: state ? (state.state === "same" ? "same" : "differs") : "" }, device), make("td", {}, node.file ?? ""));
      return row;
    }));
    this.findings.replaceChildren(...findings.slice(0, 100).map((one) => make("li", { class: one.severity }, make("b", {}, `${one.severity}: `), one.message)));
  }

  /// What a scan or adoption found, in place of the findings.
  draw_found(rows) {
    this.drawn_network = "";
    this.draw_network();
    this.drawn_network = "";
    this.findings.prepend(...rows.map((row) => {
      const node = this.project.node(row.node);
      const known = node ? (node.product_code === row.product && node.vendor_id === row.vendor ? "as in the project" : "another device than in the project") : "not in the project";
      return make("li", {}, make("b", {}, `node ${row.node}: `), `${row.name ?? ""} ${row.state ?? ""}, vendor-ID ${shown(row.vendor)}, product code ${shown(row.product)}, ` +
        `revision ${shown(row.revision)}, serial number ${shown(row.serial)}: ${row.result ?? known}`);
    }));
  }

  draw_node() {
    const node = this.opened === null ? null : this.project.node(this.opened);
    this.node_part.hidden = !node;
    if (!node) return;
    set_text(this.node_title, `Node ${node.node}: ${node.name || node.product || ""}`);
    const text = JSON.stringify([node, this.may_configure]);
    // Somebody else may change it while a name is typed here.
    const active = document.activeElement;
    const is_typing = this.node_form.contains(active) && active.defaultValue !== active.value && this.node_form.dataset.node === String(node.node);
    if (this.node_form.dataset.text !== text && !is_typing) {
      this.node_form.dataset.text = text;
      this.node_form.dataset.node = node.node;
      const field = (name, input) => make("label", {}, `${name} `, input);
      const name = make("input", { value: node.name ?? "", maxlength: "200", autocomplete: "off" });
      const id = make("input", { value: node.node, type: "number", min: "1", max: "127" });
      const present = make("input", { type: "checkbox" });
      present.checked = node.present;
      for (const one of [name, id]) one.addEventListener("change", () => { one.defaultValue = one.value; });
      name.addEventListener("change", () => this.change_node({ name: name.value }));
      id.addEventListener("change", () => this.change_node({ node_id: id.value }));
      present.addEventListener("change", () => this.change_node(present.checked ? { present: true } : { absent: true }));
      const remove = make("button", { type: "button" }, "Remove");
      remove.addEventListener("click", () => this.project.change({ command: "project remove", node: String(node.node) }).then(() => this.open_node(null)));
      const note = make("input", { value: node.note ?? "", maxlength: "900", autocomplete: "off" });
      note.addEventListener("change", () => this.project.change({ command: "project note", node: String(node.node), text: note.value }));
      const accept = make("button", { type: "button" }, "Accept this device…");
      accept.addEventListener("click", () => this.look_at_device());
      const save = make("button", { type: "button" }, "Save DCF");
      save.addEventListener("click", () => this.save_dcf(node));
      const dcf = make("input", { type: "file", accept: ".dcf,.xdc,.eds,.xdd", hidden: "" });
      dcf.addEventListener("change", () => {
        if (dcf.files.length) this.compare_dcf(node, dcf.files[0]);
        dcf.value = "";
      });
      const load = make("button", { type: "button" }, "Compare with a DCF…");
      load.addEventListener("click", () => dcf.click());
      this.dcf_part = make("div", { class: "scrolls", role: "region", "aria-label": "Values of a DCF", tabindex: "0", hidden: "" });
      load.disabled = this.role === "look";
      for (const one of [name, id, present, remove, note, accept]) one.disabled = !this.may_configure;
      const number = (value) => (value === undefined ? "–" : `${value.toString(16).toUpperCase().padStart(8, "0")}H`);
      this.node_form.replaceChildren(field("Name", name), field("Node-ID", id), field("Present", present), field("Note", note), remove, accept, save, load, dcf,
        make("p", { class: "faint" }, `${node.vendor ?? ""} ${node.product ?? ""} · device type ${number(node.device_type)} · vendor-ID ${number(node.vendor_id)} · ` +
          `product code ${number(node.product_code)} · revision ${number(node.revision)} · serial number ${number(node.serial)} · ${node.file ?? ""}`), this.dcf_part);
    }
    this.draw_objects();
  }

  draw_objects() {
    const rows = this.project.objects.get(this.opened);
    if (!rows) return;
    const words = this.find.value.trim().toLowerCase();
    const fitting = rows.filter((row) => (!this.only_configured.checked || row.configured || this.project.device.has(`${this.opened} ${row.object}`)) &&
      `${row.object} ${row.name}`.toLowerCase().includes(words));
    set_text(this.object_count, fitting.length > most_rows ? `the first ${most_rows} of ${fitting.length}` : `${fitting.length} of ${rows.length}`);
    const state = this.project.states.get(this.opened);
    const text = JSON.stringify([this.opened, words, this.only_configured.checked, fitting.slice(0, most_rows), state ?? null, [...this.project.device], [...this.project.unwritten]]);
    const active = document.activeElement;
    const is_typing = this.object_rows.contains(active) && active.dataset.value !== undefined && active.value !== active.dataset.value;
    if (this.drawn_objects === text || is_typing) return;
    this.drawn_objects = text;
    this.object_rows.replaceChildren(...fitting.slice(0, most_rows).map((row) => this.object_row(row, state)));
  }

  object_row(row, state) {
    const device = this.project.device.get(`${this.opened} ${row.object}`);
    const may_set = this.may_configure && row.access !== "ro" && row.access !== "const" && row.value !== null;
    const range = row.low !== undefined || row.high !== undefined ? `${shown(row.low)} … ${shown(row.high)}` : "";
    const value = may_set
      ? make("input", { value: value_text(row.object, row.value), "data-object": row.object, "data-value": value_text(row.object, row.value), autocomplete: "off", "aria-label": `${row.object} ${row.name}`, title: range })
      : value_text(row.object, row.value);
    const project = make("td", { class: row.configured ? "configured" : "" }, value);
    if (row.configured && may_set) {
      project.append(" ", make("button", { type: "button", class: "plain", "data-unset": row.object, "aria-label": `Default of ${row.object}`, title: `default ${row.default ?? ""}` }, "default"));
    }
    const is_known = state && row.configured && state.values !== undefined;
    const compared = this.project.unwritten.has(`${this.opened} ${row.object}`) ? "not yet written"
      : device ? (device.state === "different" ? "differs" : device.state) : is_known ? "same" : "";
    const line = make("tr", { class: { differs: "differs", same: "same", "not yet written": "unwritten" }[compared] ?? "" }, make("th", { scope: "row" }, row.object), make("td", { title: row.name }, row.name),
      make("td", {}, row.type), make("td", {}, row.access), project, make("td", {}, device ? value_text(row.object, device.device) : compared === "same" ? value_text(row.object, row.value) : ""),
      make("td", {}, device?.reason ?? compared), make("td", { class: "faint" }, range));
    line.described = { title: row.name, object: row.object,
      rows: [["Object", row.object], ["Type", row.type], ["Access", row.access], ["Range", range], ["Default", value_text(row.object, row.default)], ["Project", value_text(row.object, row.value)], ["In words", words_of(row.object, row.value)], ["Device", device ? value_text(row.object, device.device) : ""], ["Difference", device?.reason ?? compared]] };
    return line;
  }

  /// Of a row, for the description.
  described(line) {
    return line.described ?? null;
  }

  draw_transfer() {
    this.transfer_part.hidden = !this.is_transfer;
    if (!this.is_transfer) return;
    const running = this.project.running !== null;
    const count = this.plan.filter((row) => row.is_to_be_written).length;
    this.write_button.disabled = running || count === 0;
    const bad = this.results.filter((row) => row.state !== "written").length;
    set_text(this.transfer_facts, running && !this.results.length ? "asks the devices …" : this.results.length
      ? `${this.results.length - bad} of ${this.results.length} written` : count ? `${count} values differ; this is what will be written`
        : this.is_planned ? "nothing is to be written" : "what is to be written is not known");
    const rows = this.results.length
      ? this.results.map((row) => [row.node, row.write ?? row.object, row.name ?? "", value_text(row.write ?? row.object, row.value ?? row.project), value_text(row.write ?? row.object, row.device), row.state, row.reason ?? ""])
      : this.plan.map((row) => [row.node, row.object, row.name ?? "", value_text(row.object, row.project), value_text(row.object, row.device), row.state, row.reason ?? ""]);
    const text = JSON.stringify(rows);
    if (this.transfer_rows.dataset.text === text) return;
    this.transfer_rows.dataset.text = text;
    this.transfer_rows.replaceChildren(...rows.map(([node, object, name, project, device, state, reason]) =>
      make("tr", { class: state === "written" ? "same" : "differs" }, make("th", { scope: "row" }, this.project.label(node)), make("td", {}, object), make("td", {}, name), make("td", {}, project),
        make("td", {}, device), make("td", {}, state), make("td", {}, reason))));
  }
}
