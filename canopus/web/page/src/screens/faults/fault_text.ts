// Faults as the plant file writes them (docs/plant-file.md, [[bus.fault]]), and as a form with words.
import { ordinal } from "../../store/value_words.js";

export interface FaultField {
  key: string;
  label: string;
  kind: "can-id" | "number" | "time" | "port" | "text" | "levels";
  hint: string;
}

export interface FaultKind {
  kind: string;
  title: string;
  meaning: string;
  fields: FaultField[];
  start: string;
}

const frames: FaultField[] = [
  { key: "identifier", label: "CAN-ID", kind: "can-id", hint: "as 181; empty: every frame" },
  { key: "sender", label: "Sent by", kind: "port", hint: "any node" },
];
const which: FaultField[] = [
  { key: "first", label: "From the frame", kind: "number", hint: "1" },
  { key: "every", label: "Every n-th", kind: "number", hint: "1" },
  { key: "count", label: "At most", kind: "number", hint: "all" },
  { key: "probability", label: "Probability", kind: "number", hint: "1" },
];
const when: FaultField[] = [
  { key: "from", label: "Starts at", kind: "time", hint: "at once; as 2s" },
  { key: "until", label: "Ends at", kind: "time", hint: "never" },
];
const receiver: FaultField = { key: "receiver", label: "Only for", kind: "port", hint: "all receivers" };
const port: FaultField = { key: "ports", label: "Nodes", kind: "port", hint: "a node" };

export const fault_kinds: readonly FaultKind[] = [
  { kind: "drop", title: "Lose frames", meaning: "acknowledged, then lost in the receivers", fields: [...frames, receiver, ...which, ...when], start: 'kind = "drop"\ncount = 1' },
  { kind: "delay", title: "Delay frames", meaning: "the sender waits before it sends", fields: [...frames, { key: "delay", label: "By", kind: "time", hint: "as 5ms" }, ...which, ...when], start: 'kind = "delay"\ndelay = "5ms"' },
  { kind: "corrupt", title: "Corrupt frames", meaning: "one bit on the wire is inverted", fields: [...frames, receiver, { key: "bit", label: "Bit", kind: "number", hint: "any; 0 = SOF, stuff bits counted" }, ...which, ...when], start: 'kind = "corrupt"\nevery = 10' },
  { kind: "duplicate", title: "Send frames twice", meaning: "received, but repeated by the sender", fields: [...frames, ...which, ...when], start: 'kind = "duplicate"\ncount = 1' },
  { kind: "jam", title: "Jam a receiver", meaning: "its receive queue is not emptied", fields: [port, { key: "capacity", label: "Queue length", kind: "number", hint: "frames, as 16" }, ...when], start: 'kind = "jam"\nports = ["PORT"]\ncapacity = 16' },
  { kind: "cut", title: "Cut the wire", meaning: "the nodes are on the far side of a cut wire", fields: [port, ...when], start: 'kind = "cut"\nports = ["PORT"]' },
  { kind: "stuck dominant", title: "Stick dominant", meaning: "the transceiver drives dominant all the time", fields: [port, ...when], start: 'kind = "stuck dominant"\nports = ["PORT"]' },
  { kind: "stuck recessive", title: "Stick recessive", meaning: "what the controller drives does not reach the wire", fields: [port, ...when], start: 'kind = "stuck recessive"\nports = ["PORT"]' },
  { kind: "early", title: "Send too early", meaning: "a controller begins before the bus is idle", fields: [port, { key: "early_bits", label: "Bits early", kind: "number", hint: "1 to 10" }, ...when], start: 'kind = "early"\nports = ["PORT"]\nearly_bits = 3' },
  { kind: "late", title: "Send late", meaning: "bits reach the wire later", fields: [port, { key: "delay", label: "By", kind: "time", hint: "less than a bit, as 300ns" }, ...when], start: 'kind = "late"\nports = ["PORT"]\ndelay = "300ns"' },
  { kind: "babble", title: "Babbling idiot", meaning: "a controller sends a frame again and again", fields: [port, { key: "interval", label: "Every", kind: "time", hint: "as fast as it can" }, { key: "frame", label: "Frame", kind: "text", hint: "{ identifier = 0x001, data = [0] }" }, ...when], start: 'kind = "babble"\nports = ["PORT"]\nframe = { identifier = 0x001, data = [0] }\ninterval = "1ms"' },
  { kind: "noise", title: "Noise", meaning: "bits are inverted at random", fields: [{ key: "bit_error_rate", label: "Bit error rate", kind: "number", hint: "above 0, as 1e-4" }, { ...port, hint: "on the wire" }, ...when], start: 'kind = "noise"\nbit_error_rate = 1e-4' },
  { kind: "overload", title: "Overload frames", meaning: "a controller asks for overload frames", fields: [port, { key: "overload_frames", label: "After each frame", kind: "number", hint: "1 or 2" }, ...when], start: 'kind = "overload"\nports = ["PORT"]\noverload_frames = 1' },
  { kind: "single-shot", title: "Single shot", meaning: "each frame is sent once, whatever becomes of it", fields: [port, ...when], start: 'kind = "single-shot"\nports = ["PORT"]' },
  { kind: "termination", title: "Wrong termination", meaning: "other than two resistors", fields: [{ key: "resistors", label: "Resistors of 120 Ω", kind: "number", hint: "0 to 20" }, { key: "length", label: "Length of the line, m", kind: "number", hint: "0 to 10000" }, ...when], start: 'kind = "termination"\nresistors = 1\nlength = 100' },
  { kind: "drive", title: "Drive bits", meaning: "raw levels on the wire", fields: [...frames, { key: "field", label: "In the field", kind: "text", hint: "ACK slot" }, { key: "bits", label: "Levels", kind: "levels", hint: "0 dominant, r recessive" }, ...which, ...when], start: 'kind = "drive"\nidentifier = 0x181\nfield = "ACK slot"\nbits = "r"' },
];

/** `of a frame`: lose or damage the next one, or all. */
export const faults_of_frame: readonly (readonly [string, (id: string) => string])[] = [
  ["Lose it", (id) => `kind = "drop"\n${identifier(id)}\ncount = 1`],
  ["Lose all with this CAN-ID", (id) => `kind = "drop"\n${identifier(id)}`],
  ["Delay it by 5 ms", (id) => `kind = "delay"\n${identifier(id)}\ndelay = "5ms"\ncount = 1`],
  ["Corrupt it", (id) => `kind = "corrupt"\n${identifier(id)}\ncount = 1`],
  ["Send it twice", (id) => `kind = "duplicate"\n${identifier(id)}\ncount = 1`],
];

const identifier = (id: string): string => `identifier = 0x${id}${id.length > 3 ? "\nextended = true" : ""}`;

/** Keys of a fault's text and what stands behind them, as written. */
export function values_of(text: string): Map<string, string> {
  const values = new Map<string, string>();
  for (const line of text.split("\n")) {
    const found = /^\s*([a-z_]+)\s*=\s*(.*?)\s*$/.exec(line);
    if (found?.[1] !== undefined && found[2] !== undefined) values.set(found[1], found[2]);
  }
  return values;
}

export const unquoted = (text: string): string => /^"(.*)"$/.exec(text)?.[1] ?? /^\["(.*)"\]$/.exec(text)?.[1]?.replace(/"\s*,\s*"/g, ", ") ?? text;

/** What a form shows of a field. */
export function shown_value(field: FaultField, values: ReadonlyMap<string, string>): string {
  const written = values.get(field.key) ?? "";
  if (field.kind === "can-id") {
    const digits = written.replace(/^0x|_/gi, "").toUpperCase();
    return values.get("extended") === "true" && digits ? digits.padStart(8, "0") : digits;
  }
  return unquoted(written);
}

/** The text with another value for a field; an empty one takes the key away. Lines that are not keys stay. */
export function with_value(text: string, field: FaultField, said: string): string {
  const value = said.trim();
  const written = field.kind === "number" || field.key === "frame" ? value
    : field.kind === "can-id" ? `0x${value.replace(/^0x|h$/gi, "")}`
      : field.key === "ports" ? `[${value.split(",").map((one) => JSON.stringify(one.trim())).join(", ")}]` : JSON.stringify(value);
  // More than three digits are 29 bits, as in the trace.
  const is_long = field.kind === "can-id" && value.replace(/^0x|h$/gi, "").length > 3;
  const lines = [...text.split("\n").filter((line) => field.kind !== "can-id" || !/^\s*extended\s*=/.test(line)), ...(is_long ? ["extended = true"] : [])];
  const place = lines.findIndex((line) => new RegExp(`^\\s*${field.key}\\s*=`).test(line));
  if (value === "") return lines.filter((_, i) => i !== place || place < 0).join("\n");
  const line = `${field.key} = ${written}`;
  if (place >= 0) lines[place] = line;
  else lines.push(line);
  return lines.filter((one) => one.trim() !== "").join("\n");
}

export const kind_of = (text: string): FaultKind | undefined => fault_kinds.find((one) => one.kind === unquoted(values_of(text).get("kind") ?? ""));

/** "Lose frames 181H, at most 1" */
export function fault_words(text: string): string {
  const kind = kind_of(text);
  if (!kind) return text.replace(/\n/g, ", ");
  const values = values_of(text);
  const parts: string[] = [];
  for (const field of kind.fields) {
    const value = shown_value(field, values);
    if (value === "") continue;
    parts.push(field.kind === "can-id" ? `${value}H` : field.key === "ports" ? value : field.key === "every" ? `every ${ordinal(Number(value))} frame` : field.kind === "levels" ? `levels ${value}` : `${field.label.charAt(0).toLowerCase()}${field.label.slice(1)} ${value}`);
  }
  return [kind.title, ...parts].join(", ");
}
