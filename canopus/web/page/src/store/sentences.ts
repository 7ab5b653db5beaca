// Events of a run as sentences, and how serious each is.
import { count_text } from "./nodes.js";
import type { RunEvent } from "./protocol.js";

export type EventMood = "" | "warning" | "error";

const text = (value: unknown): string => (["string", "number"].includes(typeof value) ? String(value) : "?");

/** "line1, node 3 (encoder)" */
function where(event: RunEvent): string {
  const node = typeof event.node === "number" && event.node >= 1 && event.node <= 127 ? `node ${event.node}` : "";
  return `${[event.bus, node].filter(Boolean).join(", ")}${event.name ? ` (${event.name})` : ""}`;
}

/** Commands of the run itself: no command line stands behind them. */
const own_commands: Record<string, (wish: Record<string, unknown>) => string> = {
  pace: (c) => c["run"] !== undefined ? `plant time goes on for ${text(c["run"])}` : c["speed"] === 0 ? "plant time paused" : `plant time at ×${text(c["speed"])}`,
  faults: () => "faults read",
  "run faults": (c) => `faults of ${text(c["bus"])} started anew${Array.isArray(c["faults"]) ? `, ${c["faults"].filter((one) => one?.on !== false).length} of ${c["faults"].length} on` : ""}`,
  "clear errors": (c) => `clear the errors of module ${text(c["number"])}`,
  "reset module": (c) => `reset module ${text(c["number"])}`,
  "open trace": (c) => (c["path"] === undefined ? "open the trace file from the browser's machine" : `open ${text(c["path"])}`),
  "upload trace": (c) => `trace file ${text(c["name"])} from the browser's machine`,
  plants: () => "list plants and projects",
  open: (c) => (c["path"] === undefined ? "open the built-in plant" : `open ${text(c["path"])}`),
  end: (c) => `end run ${text(c["number"])}`,
  "new project": (c) => `make the project ${text(c["name"])}`,
  "new settings": (c) => `make the settings ${text(c["name"])} of ${text(c["model"])}`,
  arm: () => "arm writes",
  disarm: () => "disarm writes",
};

function deed(said: string): string {
  let name = said;
  let wish: Record<string, unknown> = {};
  try {
    const parsed: unknown = JSON.parse(said);
    if (typeof parsed === "object" && parsed !== null) wish = parsed as Record<string, unknown>;
    name = typeof wish["command"] === "string" ? wish["command"] : said;
  } catch {
    name = /^\{.*?"command":"([a-z ]+)"/.exec(said)?.[1] ?? said;  // a long one is kept without its end
  }
  return Object.hasOwn(own_commands, name) ? own_commands[name]!(wish) : name;
}

/** Exit codes of commands, and those of the page (docs/events.md, `reply`), where no reason was said. */
export const endings: Record<number, string> = { 0: "done", 2: "not understood", 4: "done, something differs or does not fit", 7: "refused, the role is too low",
  8: "refused, writes are not armed", 9: "refused, too many commands wait", 10: "stopped" };

function ending(event: RunEvent): string {
  const code = Number(event["code"]);
  const reason = code === 0 ? "" : text(event["message"] ?? "").replace(/^canopus[a-z ]*: /, "");
  if (event["do"] === "log in" && code === 1) return "refused, wrong name or password";
  return reason || endings[code] || `failed with code ${code}`;
}

const sentences: Record<string, (e: RunEvent) => string> = {
  listen: (e) => `${text(e["protocol"])}${e["of"] ? ` of ${text(e["of"])}` : ""} on ${text(e["address"])}`,
  boot: (e) => `${where(e)}: boot-up`,
  nmt: (e) => `${where(e)}: ${text(e["state"])}`,
  "boot slave": (e) => `${where(e)}: ${text(e["reason"] || e["step"]).replace(/, (for 0\.0 s|0\.0 s ago)(?=\.|$)/, "")}`,  // the moment of the event
  lss: (e) => `${where(e)}: LSS, ${Number(e["bit_rate"]) / 1000} kbit/s`,
  emcy: (e) => `${where(e)}: EMCY ${text(e["code"])}H, error register ${text(e["register"])}, data ${text(e["data"])}`,
  unacknowledged: (e) => `${where(e)}: no other node acknowledges its frames`,
  "bus error": (e) => `${text(e.bus)}: ${text(e["error"])} error in ${text(e["field"])}, bit ${text(e["bit"])}`,
  controller: (e) => `${where(e)}: ${text(e["state"])}, TEC ${text(e["tec"])}, REC ${text(e["rec"])}`,
  signal: (e) => `${text(e["plc"])}: ${text(e["signal"])} ${e["on"] ? "ON" : "OFF"}`,
  buffer: (e) => `${text(e["plc"])}: ${text(e["module"])}\\G${text(e["address"])} = ${text(e["value"])} (by the ${text(e["by"])})`,
  forced: (e) => `${where(e)}: ${text(e["object"])} (${text(e["parameter"])}) forced to ${text(e["value"])}`,
  released: (e) => `${where(e)}: ${text(e["object"])} (${text(e["parameter"])}) released, ${text(e["value"])}`,
  warning: (e) => `${text(e["source"])}: ${text(e["message"])}`,
  error: (e) => `${text(e["source"])}: ${text(e["message"])}`,
  "module error": (e) => `${text(e["module"])}: error ${text(e["code"])}H (${text(e["class"])}): ${text(e["overview"])}`,
  "module event": (e) => `${text(e["module"])}: event ${text(e["code"])}H: ${text(e["overview"])}`,
  lost: (e) => `${count_text(Number(e["lines"] ?? e["events"] ?? 0), "event")} lost here`,
  audit: (e) => `${deed(text(e["do"]))}: ${ending(e)}; by ${text(e["user"] || e["address"])} (${text(e["role"])})`,
  lift: (e) => [[e.bus, e["lift"] && `lift ${text(e["lift"])}`, e["floor"] && `floor ${text(e["floor"])}`].filter(Boolean).join(" "), text(e["what"]), e["call"], e["fault"]].filter(Boolean).join(": "),
  summary: () => "the run has ended",
};

/** What a kind of event is called. */
const kinds: Record<string, string> = { listen: "Server", boot: "Boot-up", nmt: "NMT state", "boot slave": "Boot", lss: "LSS", emcy: "Emergency", unacknowledged: "No acknowledge", "bus error": "Bus error", controller: "Controller", signal: "Signal", buffer: "Buffer memory",
  forced: "Forced", released: "Released", warning: "Warning", error: "Error", "module error": "Module error", "module event": "Module event", lost: "Lost", audit: "Command", lift: "Lift", summary: "Summary" };

export const kind_words = (kind: string): string => kinds[kind] ?? kind;

export const event_kinds: readonly string[] = Object.keys(sentences);

export function sentence(event: RunEvent): string {
  const known = sentences[event.event];
  if (known) return known(event).replace(/\s+/g, " ");
  // Of a newer program: the fields that are words.
  const rest = Object.entries(event).filter(([name, value]) => !["t", "event", "bus", "node", "name"].includes(name) && typeof value !== "object");
  return [`${event.event}: ${where(event)}`, ...rest.map(([name, value]) => `${name} ${text(value)}`)].join(", ");
}

export function event_mood(event: RunEvent): EventMood {
  if (event.event === "audit") return [0, 4].includes(Number(event["code"])) ? "" : "error";
  if (["error", "module error", "emcy", "bus error"].includes(event.event)) return "error";
  if (event.event === "boot slave") return String(event["step"] ?? "").startsWith("failed") ? "error" : "";
  if (event.event === "controller") return event["state"] === "error active" ? "" : event["state"] === "bus-off" ? "error" : "warning";
  return ["warning", "lost", "unacknowledged"].includes(event.event) ? "warning" : "";
}
