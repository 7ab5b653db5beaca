// The settings of a module in the windows of its configuration tool: navigator, parameter window, description window. What a form has goes into
// the file of the settings; what goes to the module is shown before.
import { keep_children, make, set_text } from "./dom.js";
import { Settings } from "./settings.js";
import { AreaChoice, FieldForm, cob_id_parts, draw_description, tool_button } from "./settings_fields.js";
import { SettingsList } from "./settings_list.js";
import { ExportPart, ScanPart, SdoPart, SetupPart, StatusPart, TransferPart } from "./settings_online.js";

/// What the tool's buttons call the parts of the settings.
const part_names = { basic: "module basic settings", tpdo: "PDO List", rpdo: "PDO List", nmt: "NMT settings" };

export class SettingsView {
  constructor(section, commands) {
    this.section = section;
    this.commands = commands;
    this.role = "look";
    this.all = [];
    this.settings = null;
    this.pages = [];
    [this.title, this.said, this.navigator, this.page, this.description, this.findings, this.hide] =
      ["settings-title", "settings-said", "settings-navigator", "settings-page", "settings-description", "settings-findings", "settings-hide"].map((id) => section.querySelector(`#${id}`));
    this.navigator.addEventListener("click", (event) => {
      const button = event.target.closest("button");
      if (button) this.open_page(button.dataset.key);
    });
    // The description window follows the focus.
    this.page.addEventListener("focusin", (event) => {
      const field = this.field_of(event.target);
      if (field) draw_description(this.description, field);
    });
    section.querySelector("#settings-undo").addEventListener("click", () => this.undo());
    this.hide.addEventListener("click", () => {
      this.description.hidden = !this.description.hidden;
      this.hide.setAttribute("aria-pressed", !this.description.hidden);
    });
  }

  get may_configure() {
    return this.role === "configure";
  }

  /// For people: "192.168.3.39:5007".
  get place_of_plc() {
    const option = (name) => this.settings?.one.plc.find((one) => one.startsWith(`--${name}=`))?.slice(name.length + 3);
    return this.settings ? `${option("host")}:${option("port") ?? 5007}` : "";
  }

  field_of(input) {
    const name = input.dataset?.field;
    if (!name) return null;
    const word = input.closest("[data-window]")?.dataset.window;
    const window = this.settings.window(word);
    if (name === window?.key) return { field: name, range: `1 to ${window.most_key}`, description: `the number of a row; at most ${window.most_rows} rows` };
    return [...(window?.fields ?? []), ...cob_id_parts].find((one) => one.field === name) ?? this.pages.flatMap((page) => page.part?.fields ?? []).find((one) => one.field === name) ?? null;
  }

  /// What the server says there is; the first file is shown at once.
  greeted(hello) {
    this.role = hello.role;
    this.all = (hello.settings ?? []).map((one) => new Settings(one, this.commands, () => this.draw()));
    this.section.hidden = this.all.length === 0;
    if (this.all.length) this.open(0);
    return this.all.map((one) => one.one.file);
  }

  /// What anybody has done, as the audit log has it: others change the file, too.
  done_by_somebody(command) {
    if (this.settings?.busy === 0 && /^canopus configure (set|delete|defaults|undo|import|read|identify)\b/.test(command)) this.settings.load();
  }

  open(number, _name, page) {
    const settings = this.all[number];
    if (!settings) return;
    if (this.settings !== settings) {
      this.settings = settings;
      this.pages = [];
      this.navigator.replaceChildren();
      settings.load().then(() => {
        this.make_pages();
        this.open_page(page ?? this.pages[0].key);
      });
    } else if (page) {
      this.open_page(page);
    }
    if (location.hash.startsWith("#settings")) {
      this.section.scrollIntoView();
      this.title.focus({ preventScroll: true });
    }
  }

  open_page(key) {
    const page = this.pages.find((one) => one.key === key) ?? this.pages[0];
    if (!page || page === this.opened) return;
    this.opened = page;
    this.page.replaceChildren(page.element);
    this.description.dataset.text = "";
    this.description.replaceChildren(make("p", { class: "faint" }, "What the field with the focus means, its range and its default."));
    page.opened?.();
    this.draw();
  }

  /// [Read …], [Write …] and [Restore default values] of a window.
  ways_of(window, noun = part_names[window.part]) {
    const { settings } = this;
    const area = ["tpdo", "rpdo"].includes(window.part) ? new AreaChoice("PDO", window.most_key) : null;
    const pdos = () => (area ? { pdos: area.text } : {});
    const ways = make("div", { class: "ways" });
    if (area) ways.append(area.element);
    ways.append(tool_button(`Read ${noun}`, "configure", () => this.read({ part: window.part, ...pdos() })),
      tool_button(`Write ${noun}`, "configure", () => {
        this.transfer.choose(window.part, area?.text ?? "all");
        this.open_page("transfer");
        this.transfer.compare();
      }));
    if (!window.key) ways.append(tool_button("Restore default values", "configure", () => settings.change({ command: "configure defaults", window: window.word })));
    return ways;
  }

  /// What the module has goes into the file.
  async read(wish) {
    const done = await this.settings.change({ command: "configure read", ...wish });
    if (!done.failed) this.settings.said.text = "the file has what the module has";
    this.draw();
  }

  async set(place, name, text) {
    const done = await this.settings.set(place, name, text);
    if (!done.failed) this.settings.changes.push({ title: `set ${place} ${name}=${text}`, field: `${place} ${name}` });
    this.draw();
    return !done.failed;
  }

  /// The latest change of the file, whoever made it.
  async undo() {
    const { settings } = this;
    const done = await settings.change({ command: "configure undo" });
    const title = done.rows.find((row) => row.event === "undone")?.title;
    if (title !== undefined) {
      settings.said.text = `taken back: ${title}`;
      if (settings.changes.at(-1)?.title === title) settings.changes.pop();
    }
    this.draw();
  }

  make_pages() {
    const { settings } = this;
    const has_nodes = settings.window("node") !== undefined;
    const add = (key, title, element, draw, more = {}) => this.pages.push({ key, title, element: make("div", {}, make("h3", {}, title), element), draw, ...more });
    this.pages = [];
    for (const window of settings.windows) {
      if (window.word === "node" || window.word === "producer") continue;
      const element = make("div", { "data-window": window.word });
      if (window.key) {
        const list = new SettingsList(this, window);
        const producer = window.word === "consumer" ? settings.window("producer") : null;
        const form = producer && new FieldForm(producer.fields, this.may_configure, (name, text) => this.set("producer", name, text));
        element.append(this.ways_of(window), ...(form ? [make("div", { "data-window": "producer" }, form.element)] : []), list.element);
        add(window.word, producer ? "NMT settings: Heartbeat" : window.title, element, () => {
          list.draw();
          form?.set((field) => settings.row("producer").values[field.field]);
        });
        continue;
      }
      const form = new FieldForm(window.fields, this.may_configure, (name, text) => this.set(window.word, name, text));
      element.append(this.ways_of(window), form.element);
      const nodes = window.word === "basic" && has_nodes ? new SettingsList(this, settings.window("node")) : null;
      const [words, warning] = [make("p", { class: "words", role: "status" }), make("p", { class: "bad" })];
      element.append(words, warning);
      const page = make("div", {}, element, ...(nodes ? [make("div", { "data-window": "node" }, nodes.element)] : []));
      add(window.word, window.title, page, () => {
        const row = settings.row(window.word);
        form.set((field) => row.values[field.field]);
        set_text(words, row.words ?? "");
        set_text(warning, row.warning ?? "");
        nodes?.draw();
      });
    }
    this.transfer = new TransferPart(this);
    for (const [key, title, part] of [["transfer", "Download Configuration", this.transfer], ["setup", "Transfer Setup", new SetupPart(this)], ["scan", "Network scan", new ScanPart(this)],
      ["sdo", "SDO send / receive", new SdoPart(this)], ["status", "Module status", new StatusPart(this)], ["export", "Export / Import", new ExportPart(this)]]) {
      add(key, title, part.element, () => part.draw?.(), { part, opened: () => part.opened?.() });
    }
  }

  draw() {
    const { settings } = this;
    if (!settings) return;
    set_text(this.title, `Settings of ${settings.one.model}: ${settings.one.file}`);
    this.section.setAttribute("aria-busy", settings.busy > 0);
    this.said.dataset.mood = settings.said.mood;
    set_text(this.said.firstElementChild, settings.running ? `${settings.running} …` : settings.said.text);
    set_text(this.said.lastElementChild, settings.said.command);
    const findings = JSON.stringify(settings.findings);
    if (this.findings.dataset.text !== findings) {
      this.findings.dataset.text = findings;
      this.findings.replaceChildren(...settings.findings.slice(0, 100).map((one) => make("li", { class: one.severity }, make("b", {}, `${one.severity}: `), one.message)));
    }
    keep_children(this.navigator, this.pages, (page) => page.key, () => make("li", {}, make("button", { type: "button", class: "plain" })), (item, page) => {
      const button = item.firstElementChild;
      button.dataset.key = page.key;
      set_text(button, page.title);
      if (page === this.opened) button.setAttribute("aria-current", "page");
      else button.removeAttribute("aria-current");
    });
    this.opened?.draw();
    const roles = ["look", "operate", "configure"];
    for (const button of this.section.querySelectorAll("button[data-role]")) {
      button.disabled = roles.indexOf(this.role) < roles.indexOf(button.dataset.role) || settings.running !== null || button.dataset.off === "true";
    }
    this.draw_differences();
  }

  /// Changed and not yet written; differs from the module; the same.
  draw_differences() {
    for (const input of this.page.querySelectorAll("[data-field]")) {
      const place = input.closest("[data-place]")?.dataset.place ?? input.closest("[data-window]")?.dataset.window;
      const field = ["valid", "CAN-ID (11-bit)"].includes(input.dataset.field) ? "COB-ID" : input.dataset.field;
      const differs = this.settings.differs.get(`${place} ${field}`);
      const mood = this.settings.is_unwritten(`${place} ${input.dataset.field}`) ? "unwritten" : differs ? "differs" : "";
      if (input.dataset.mood !== mood) input.dataset.mood = mood;
      const title = mood === "unwritten" ? "changed and not yet written" : differs ? `the module has ${differs.device}` : "";
      if (input.title !== title) input.title = title;
    }
  }
}

