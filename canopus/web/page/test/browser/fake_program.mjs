// A PLC program that no server runs: what docs/web.md has of views and commands, put into the messages of a run, for tests of the screen.
const text = ["(* Counts pieces and starts the motor. *)", "PROGRAM Main", "VAR", "  n : INT;", "  limit : INT := 100;", "  motor : BOOL;", "  pause : TON;", "END_VAR", "n := n + D100;", "motor := n < limit AND NOT pause.Q;", "pause(IN := NOT motor, PT := T#2s);", "IF n > limit THEN", "  n := n MOD limit;", "END_IF;", "END_PROGRAM", ...Array.from({ length: 600 }, (_, i) => `(* ${i} *)`)];

export class FakeProgram {
  state = "run";
  values = { n: "5", limit: "100", motor: "TRUE", "pause.Q": "FALSE", "pause.ET": "T#10ms" };
  types = { n: "INT", limit: "INT", motor: "BOOL", "pause.Q": "BOOL", "pause.ET": "TIME" };
  forced = new Set();
  breaks = [];
  scans = 500;
  error = undefined;
  commands = [];

  value(name) {
    return { name, type: this.types[name], value: this.values[name], forced: this.forced.has(name), writable: true };
  }

  line(number) {
    const line = text[number - 1];
    const values = [];
    for (const match of number > 8 && number < 16 ? line.matchAll(/\b(n|limit|motor|pause\.Q|D100)\b/g) : []) values.push({ column: match.index + 1, length: match[0].length, ...(match[0] === "D100" ? { name: "D100", type: "WORD", value: "17", forced: false, writable: false, device: true } : this.value(match[0])) });
    return { text: line, code: number > 8 && number < 15, values };
  }

  event(t, wish) {
    return { t, event: "program", plc: "plc1", cpu: "R04CPU", state: this.state, ...(this.state === "halted" ? { halted_at: { file: 0, line: 10 } } : {}), ...(this.error ? { error: this.error } : {}),
      scan: { count: this.scans, period: 0.002, now: 0.00041, least: 0.0004, most: 0.0006 }, breaks: this.breaks, forced: [...this.forced].map((name) => this.value(name)),
      tasks: [{ name: "scan", kind: "scan", priority: 0, programs: ["Main"], runs: this.scans }, { name: "fast", kind: "fixed scan", every: 0.01, priority: 1, programs: ["Fast"], runs: 12 }],
      files: ["main.st", "blocks.st"], file: wish.file, from: wish.from, of: text.length, blocks: [], lines: Array.from({ length: Math.min(wish.count, text.length - wish.from + 1) }, (_, i) => this.line(wish.from + i)) };
  }

  variables(t, wish) {
    const names = Object.keys(this.values).filter((name) => name.includes(wish.find));
    return { t, event: "variables", plc: "plc1", from: 0, of: names.length, rows: names.map((name) => ({ ...this.value(name), name: `Main.${name}`, retain: name === "n", comment: name === "n" ? "pieces" : "" })) };
  }

  /** The reply to a command; undefined: it is none of the program. */
  run(wish) {
    this.commands.push(wish);
    if (wish.command === "halt program" || wish.command === "single scan") {
      if (wish.command === "single scan") ++this.scans;
      this.state = "halted";
      return { state: "halted" };
    }
    if (wish.command === "continue program") return { state: (this.state = "run") };
    if (wish.command === "set break") return this.breaks.push({ file: 0, line: wish.line }), { file: wish.file, line: wish.line };
    if (wish.command === "clear break") return (this.breaks = this.breaks.filter((one) => one.line !== wish.line)), { breaks: this.breaks.length };
    if (["write variable", "force variable"].includes(wish.command)) {
      if (!/^(-?\d+|TRUE|FALSE)$/.test(wish.value)) return "value: expected INT: -32768 to 32767";
      this.values[wish.name] = wish.value;
      if (wish.command === "force variable") this.forced.add(wish.name);
      return this.value(wish.name);
    }
    if (wish.command === "release variable") return this.forced.delete(wish.name), this.value(wish.name);
    return undefined;
  }

  /** The messages of a page have the program in them. */
  async join(context) {
    await context.routeWebSocket(/\/events/, (page) => {
      const server = page.connectToServer();
      let wishes = [];
      let t = 0;
      page.onMessage((message) => {
        const wish = JSON.parse(message);
        if (wish.views) {
          wishes = wish.views;
          return server.send(JSON.stringify({ views: wishes.filter((one) => !one.program && !one.variables) }));
        }
        const row = wish.do ? this.run(wish.do) : undefined;
        if (row === undefined) return server.send(message);
        page.send(JSON.stringify([{ t, event: "reply", id: wish.id, ...(typeof row === "string" ? { code: 5, message: row } : { code: 0, rows: [row] }) }]));
      });
      server.onMessage((message) => {
        const events = JSON.parse(message);
        for (const event of [...events]) {
          if (event.offers) event.offers.push("halt program", "single scan", "continue program", "set break", "clear break", "clear breaks", "write variable", "force variable", "release variable", "release all", "change program");
          if (event.event !== "state") continue;
          t = event.t;
          event.programs = [{ plc: "plc1", state: this.state, ...(this.error ? { error: this.error.text } : {}) }];
          for (const wish of wishes) if (wish.program) events.push(this.event(t, wish)); else if (wish.variables) events.push(this.variables(t, wish));
        }
        page.send(JSON.stringify(events));
      });
    });
  }
}
