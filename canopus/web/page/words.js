// Events as sentences, how well a node is, and what it is known by.

const where = (event) => {
  const node = event.node >= 1 && event.node <= 127 ? ` node ${event.node}` : "";
  return `${event.bus ?? ""}${node}${event.name ? ` (${event.name})` : ""}`;
};

/// A word that somebody has said, whatever it is.
const said = (value) => (["string", "number"].includes(typeof value) ? String(value) : "?");

/// The program's own commands: no command line stands behind them. One that was refused for its role has no fields.
const own_commands = {
  pace: (c) => (c.run !== undefined ? `let plant time go on for ${said(c.run)}` : c.speed === undefined ? "change the pace of plant time" : c.speed === 0 ? "let plant time stand still" : `let plant time go at ×${said(c.speed)}`),
  faults: () => "look at the faults",
  "run faults": (c) => {
    if (!Array.isArray(c.faults)) return "run faults";
    const on = c.faults.filter((one) => one?.on !== false).length;
    return `run the faults of ${said(c.bus)} anew, ${on} of ${c.faults.length} on${c.seed === undefined ? "" : `, seed ${said(c.seed)}`}`;
  },
  "clear errors": (c) => (c.number === undefined ? "clear the errors of a module" : `clear the errors of module ${said(c.number)}`),
  "reset module": (c) => (c.number === undefined ? "reset a module" : `reset module ${said(c.number)}`),
  plants: () => "look for plants and projects",
  open: (c) => (c.path === undefined ? "open a plant" : `open ${said(c.path)}`),
  end: (c) => (c.number === undefined ? "end a run" : `end run ${said(c.number)}`),
  "new project": (c) => (c.name === undefined ? "make a project" : `make the project ${said(c.name)}`),
  "new settings": (c) => (c.name === undefined ? "make settings of a module" : `make the settings ${said(c.name)} of the module ${said(c.model)}`),
  arm: () => "arm writes",
  disarm: () => "disarm writes",
};

function own_command_of(text) {
  try {
    const command = JSON.parse(text);
    return typeof command === "object" && command !== null ? command : null;
  } catch {
    const name = text.match(/^\{.*?"command":"([a-z ]+)"/)?.[1]; // a long one is kept without its end
    return name ? { command: name } : null;
  }
}

/// What somebody did: the command line that was run, or a short sentence.
function deed(text) {
  const command = own_command_of(text);
  const name = command ? command.command : text;
  if (command?.command === "open" && command.path === undefined) return "open the built-in plant";
  if (Object.hasOwn(own_commands, name)) return own_commands[name](command ?? {});
  return command ? "a command that there is not" : text;
}

/// Exit codes, and those of the page (docs/events.md, `reply`), where no reason was said.
const endings = { 0: "done", 2: "not understood", 4: "done, something differs or does not fit", 7: "refused, the role is too low", 8: "refused, writes are not armed", 9: "refused, too many wait", 10: "stopped" };
const log_in_endings = { 0: "done", 1: "refused, wrong name or password", 9: "refused, too many attempts" };

function ending(event) {
  const reason = event.code === 0 ? "" : (event.message ?? "").replace(/^canopus[a-z ]*: /, "");
  return reason || (event.do === "log in" ? log_in_endings : endings)[event.code] || `failed with code ${event.code}`;
}

const lift_text = (e) => [e.bus, e.lift && `lift ${e.lift}`, e.floor && `floor ${e.floor}`].filter(Boolean).join(" ") +
  [`: ${e.what}`, e.call, e.passenger && `passenger ${e.passenger}${e.to ? ` to floor ${e.to}` : ""}`, e.door > 1 && `door ${e.door}`, e.fault].filter(Boolean).join(": ");

const sentences = {
  listen: (e) => `${e.protocol}${e.of ? ` of ${e.of}` : ""} on ${e.address}`,
  boot: (e) => `${where(e)}: boot-up`,
  nmt: (e) => `${where(e)}: ${e.state}`,
  "boot slave": (e) => `${where(e)}: ${e.reason || e.step}`,
  lss: (e) => `${where(e)}: LSS, ${e.bit_rate / 1000} kbit/s`,
  emcy: (e) => `${where(e)}: EMCY ${e.code}H, error register ${e.register}, data ${e.data}`,
  unacknowledged: (e) => `${where(e)}: nobody acknowledges`,
  "bus error": (e) => `${e.bus}: ${e.error} error in ${e.field}, bit ${e.bit}`,
  controller: (e) => `${where(e)}: ${e.state}, TEC ${e.tec}, REC ${e.rec}`,
  signal: (e) => `${e.plc}: ${e.signal} ${e.on ? "ON" : "OFF"}`,
  buffer: (e) => `${e.plc}: ${e.module}\\G${e.address} = ${e.value} (by the ${e.by})`,
  forced: (e) => `${where(e)}: ${e.object} (${e.parameter}) forced to ${e.value}`,
  released: (e) => `${where(e)}: ${e.object} (${e.parameter}) released, ${e.value}`,
  warning: (e) => `${e.source}: ${e.message}`,
  error: (e) => `${e.source}: ${e.message}`,
  "module error": (e) => `${e.module}: error ${e.code}H (${e.class}): ${e.overview}`,
  "module event": (e) => `${e.module}: event ${e.code}: ${e.overview}`,
  lost: (e) => `${e.lines} events were lost here`,
  audit: (e) => `${deed(e.do)}: ${ending(e)}; by ${e.user || e.address} (${e.role})`.replace(/\s+/g, " "),
  lift: lift_text,
  summary: () => "the run has ended",
};

export function sentence(event) {
  const words = sentences[event.event];
  if (words) return words(event);
  // Of a newer program: the fields that are words.
  const { t, event: kind, ...rest } = event;
  return [`${kind}: ${where(event)}`, ...Object.entries(rest).filter(([name, value]) => !["bus", "node", "name"].includes(name) && typeof value !== "object").map(([name, value]) => `${name} ${value}`)].join(", ");
}

/// How an event is to be seen: "error", "warning", or "".
export function event_mood(event) {
  if (event.event === "audit") return [0, 4].includes(event.code) ? "" : "error";
  if (["error", "module error", "emcy", "bus error", "error-frame"].includes(event.event)) return "error";
  return ["warning", "lost", "unacknowledged"].includes(event.event) ? "warning" : "";
}

/// "line1  183  pdo  3 (encoder)  TPDO  Position value = 7"
export function message_line(message) {
  const node = message.node ? `${message.node}${message.name ? ` (${message.name})` : ""}` : "";
  const pdo = message.pdo ? String(message.pdo) : "";
  return `${message.channel ?? ""}  ${message.id.padStart(3)}  ${message.service.padEnd(13)}  ${node.padEnd(18)}  ` +
         `${message.kind}${pdo}  ${message.text}`;
}

export function mood_of(node, troubles) {
  if (node.controller === "bus-off" || troubles.length > 0) return "error";
  if (node.state === "off") return "off";
  if (node.controller === "error passive") return "warning";
  if (!node.in_operation) return "warning";
  return "good";
}

/// What a node is known by. `twin`: how many of the same bus, node-ID and name stand before it; devices without a node-ID often have one name.
export const key_of = (node) => `${node.bus}\u0000${node.node}\u0000${node.name}\u0000${node.twin ?? 0}`;

export function tell_twins_apart(nodes) {
  const times = new Map();
  for (const node of nodes) {
    node.twin = 0;
    const key = key_of(node);
    node.twin = times.get(key) ?? 0;
    times.set(key, node.twin + 1);
  }
}
