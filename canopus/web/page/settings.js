// The settings of a module as the program's own commands show and change them (docs/configure.md).

export class Settings {
  /// `one`: of the server's greeting. `changed`: called when something is to be drawn.
  constructor(one, commands, changed) {
    this.one = one;
    this.commands = commands;
    this.changed = changed;
    this.windows = [];           // as `configure describe` says
    this.rows = new Map();       // by window: Map of number to { values, name, objects }
    this.mappable = new Map();   // by window: what can be mapped into its PDOs
    this.hardware = new Map();   // by node-ID: what the nodes said of themselves
    this.findings = [];
    this.plan = null;            // what differs between module and file; null: not compared
    this.differs = new Map();    // "tpdo/5 Event timer": { device, project }
    this.changes = [];           // of fields, since the module was looked at: { title, field: "tpdo/5 Event timer" }
    this.steps = [];             // of the writing
    this.running = null;
    this.busy = 0;               // what has been begun and not ended
    this.said = { text: "", mood: "", command: "" };
  }

  window(word) {
    return this.windows.find((one) => one.word === word);
  }

  row(word, number = 0) {
    return this.rows.get(word)?.get(number);
  }

  get node_id() {
    return this.row("basic")?.values["Node ID"];
  }

  /// Does a command and says what became of it; `fine`: exit codes that are no failure.
  run(command, options = {}) {
    return this.during(() => this.do_run(command, options));
  }

  async do_run(command, { told = null, fine = [0] }) {
    this.running = command.command;
    this.changed();
    const done = await this.commands.run({ ...command, settings: this.one.file }, told);
    this.running = null;
    const failed = !fine.includes(done.code);
    this.said = { text: (done.message ?? "").replace(/^canopus[a-z ]*: /, ""), mood: failed ? "error" : "", command: done.command ?? "" };
    if (failed && !this.said.text) this.said.text = `exit code ${done.code}`;
    return { ...done, failed };
  }

  async look(command) {
    const done = await this.commands.run({ ...command, settings: this.one.file });
    if (![0, 4].includes(done.code)) this.said = { text: done.message ?? "", mood: "error", command: done.command ?? "" };
    return done.rows;
  }

  /// Reads the file anew.
  async load() {
    if (this.windows.length === 0) this.described(await this.look({ command: "configure describe" }));
    const [shown, findings] = await Promise.all([this.look({ command: "configure show" }), this.look({ command: "configure check" })]);
    this.findings = findings.filter((one) => one.severity !== "note");
    this.rows = new Map(this.windows.map((window) => [window.word, new Map()]));
    for (const row of shown) {
      const objects = (row.objects ?? []).map((text) => {
        const [, index, sub, bits] = text.match(/^([0-9A-F]{4}):([0-9A-F]{2}):(\d+) /);
        return { index: parseInt(index, 16), sub: parseInt(sub, 16), bits: Number(bits) };
      });
      this.rows.get(row.window)?.set(row.number ?? 0, { values: row.fields, name: row.name, objects, words: row.words, warning: row.warning });
    }
    this.changed();
  }

  described(rows) {
    for (const row of rows) {
      if (row.field === undefined) this.windows.push({ ...row, word: row.window, fields: [] });
      else this.window(row.window).fields.push(row);
    }
  }

  /// What can be mapped into the PDOs of a window: [{ name, bits, objects: [[index, sub, description]] }].
  async load_mappable(word) {
    if (this.mappable.has(word)) return;
    this.mappable.set(word, []);
    this.mappable.set(word, await this.look({ command: "configure objects", window: word }));
    this.changed();
  }

  /// Several steps that are one to people.
  async during(steps) {
    ++this.busy;
    try {
      return await steps();
    } finally {
      --this.busy;
      this.changed();
    }
  }

  /// A change of the file, and what it says then. What was compared with the module was compared before.
  change(command) {
    return this.during(() => this.do_change(command));
  }

  async do_change(command) {
    const done = await this.run(command);
    if (done.failed) return done;
    this.plan = null;
    this.steps = [];
    this.differs.clear();
    const said = this.said;
    await this.load();
    this.said = said;
    return done;
  }

  /// What the module has otherwise; null: it was not found out. `is_known`: all else is the same.
  compared(rows, is_known = true) {
    this.plan = rows;
    this.differs.clear();
    if (rows !== null && is_known) this.changes = [];
    for (const row of rows ?? []) {
      const [, word, number, names] = row.field.match(/^(\w+)(?: (\d+))?: (.*?)(?: \([^()]*\))?$/) ?? [];
      for (const name of names?.split(", ") ?? []) this.differs.set(`${number ? `${word}/${number}` : word} ${name}`, row);
    }
  }

  /// Whether it was changed and not yet written.
  is_unwritten(field) {
    return this.changes.some((one) => one.field === field);
  }

  set(place, name, value) {
    return this.change({ command: "configure set", window: place, items: [`${name}=${value}`] });
  }
}

/// A value as the window shows it.
export function shown_value(field, value) {
  if (field.words?.[value] !== undefined) return field.words[value];
  if (!field.hexadecimal) return String(value);
  const digits = value.toString(16).toUpperCase();
  return `0x${field.highest <= 0xFF ? digits.padStart(2, "0") : field.highest <= 0xFFFF ? digits : digits.padStart(8, "0")}`;
}
