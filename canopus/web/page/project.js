// A project of a bus as the program's own commands show and change it (docs/project.md), and what its devices were found to have.

/// Of diff and write: what a device says of itself otherwise than the project.
export const is_identity = (row) => row.state === "different" && /^10(00|18):/.test(row.object ?? "");

export class Project {
  /// `bus`: of the server's greeting. `changed`: called when something is to be drawn.
  constructor(bus, commands, changed) {
    this.bus = bus;
    this.commands = commands;
    this.changed = changed;
    this.network = null;
    this.nodes = [];
    this.pdos = [];
    this.findings = [];
    this.objects = new Map();  // by node-ID: rows of `project show NODE --all`
    this.loading = new Set();  // of those that are asked for
    this.device = new Map();   // by "NODE OBJECT": { project, device, state, reason }
    this.states = new Map();   // by node-ID: { state, values, differ, reason }
    this.unwritten = new Set();  // "NODE OBJECT": changed here since the devices were looked at
    this.running = null;
    this.said = { text: "", mood: "", command: "" };
    this.changes = [];         // command lines that have changed it while one of ours ran
  }

  node(id) {
    return this.nodes.find((one) => one.node === id);
  }

  label(id) {
    const name = this.node(id)?.name;
    return name ? `${id} ${name}` : `node ${id}`;
  }

  /// Does a command and says what became of it; `fine`: exit codes that are no failure.
  async run(command, { told = null, fine = [0] } = {}) {
    this.running = command.command;
    this.changed();
    const done = await this.commands.run({ ...command, bus: this.bus.bus }, told);
    this.running = null;
    const own = this.changes.indexOf(done.command);
    if (own >= 0) this.changes.splice(own, 1);
    if (this.changes.splice(0).length) this.load();
    const failed = !fine.includes(done.code);
    this.said = { text: (done.message ?? "").replace(/^canopus[a-z ]*: /, ""), mood: failed ? "error" : "", command: done.command ?? "" };
    if (failed && !this.said.text) this.said.text = `exit code ${done.code}`;
    this.changed();
    return { ...done, failed };
  }

  /// Somebody's command that has changed the project is a reason to read it anew. One's own does that itself.
  done_by_somebody(command) {
    if (!/^canopus project (add|remove|set|unset|note|undo|pdo (map|off|link)|read|accept|adopt)\b/.test(command)) return;
    if (this.running !== null) this.changes.push(command);
    else this.load();
  }

  /// Nodes that do not answer are said, whatever else there is to say.
  tell_silence(rows) {
    const silent = [...new Map(rows.filter((row) => row.object === undefined && row.state === "no answer").map((row) => [row.node, row])).values()];  // each once
    if (silent.length === 0) return;
    const names = silent.slice(0, 3).map((row) => this.label(row.node)).join(", ");
    this.said.text = `${names}${silent.length > 3 ? ` and ${silent.length - 3} others` : ""}: ${silent.length > 1 ? "no answer" : silent[0].reason ?? "no answer"}`;
    this.said.mood = "error";
  }

  /// Looks without a word, unless that fails.
  async look(command) {
    const done = await this.commands.run({ ...command, bus: this.bus.bus });
    if (![0, 4].includes(done.code)) this.said = { text: done.message ?? "", mood: "error", command: done.command ?? "" };
    return done.rows;
  }

  /// Reads it anew.
  async load() {
    const [shown, pdos, findings] = await Promise.all([
      this.look({ command: "project show" }), this.look({ command: "project pdo list", all: true }), this.look({ command: "project check" })]);
    this.network = shown.find((row) => row.network !== undefined) ?? null;
    this.nodes = shown.filter((row) => row.node !== undefined);
    this.pdos = pdos;
    this.findings = findings;
    this.objects.clear();
    this.changed();
  }

  async load_objects(id) {
    if (this.objects.has(id) || this.loading.has(id)) return;
    this.loading.add(id);
    const rows = await this.look({ command: "project show", node: String(id), all: true });
    this.loading.delete(id);
    this.objects.set(id, rows.filter((row) => row.object !== undefined));
    this.changed();
  }

  /// A change of the files, and what they say then. What is known of the devices was known of the old ones.
  async change(command) {
    const done = await this.run(command);
    if (done.failed) return done;
    const node = Number(command.node);
    for (const item of command.items ?? []) this.unwritten.add(`${node} ${item.split("=")[0]}`);
    this.forget(command.command === "project set" && command.node ? node : null);
    await this.load();
    return done;
  }

  /// What a node was found to have, or null: every node.
  forget(node) {
    for (const key of [...this.device.keys()]) if (node === null || key.startsWith(`${node} `)) this.device.delete(key);
    if (node === null) this.states.clear();
    else this.states.delete(node);
  }

  /// Rows of diff, write and read: what the devices have.
  found(rows) {
    for (const row of rows) {
      // What it had before it was written is not what it has now.
      if (row.write !== undefined && row.state !== "would be written") this.forget(row.node);
      // Nothing else is said of it: it was left alone.
      if (is_identity(row)) this.states.set(row.node, { state: "different", reason: "another device" });
      if (row.object !== undefined && row.state !== undefined && row.write === undefined) this.device.set(`${row.node} ${row.object}`, row);
      else if (row.node !== undefined && row.write === undefined && row.state !== undefined) {
        this.states.set(row.node, row);
        for (const key of [...this.unwritten]) if (key.startsWith(`${row.node} `)) this.unwritten.delete(key);
        // What differed before and is not told any more is the same now.
        if (row.state === "same") for (const key of [...this.device.keys()]) if (key.startsWith(`${row.node} `)) this.device.delete(key);
      }
    }
    this.changed();
  }
}
