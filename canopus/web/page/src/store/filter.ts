// Filters of the trace as people write them: what the server understands of them, and what they may be completed to.
import type { RunState } from "./protocol.js";

export interface Completion {
  text: string;
  detail: string;
}

const keys: readonly Completion[] = [
  { text: "node=", detail: "node-ID or name" },
  { text: "service=", detail: "kind of message" },
  { text: "object=", detail: "index, 6064 or 6064:00" },
  { text: "id=", detail: "CAN-ID, hexadecimal" },
  { text: "bus=", detail: "name of the bus" },
  { text: "abort=", detail: "SDO abort code" },
  { text: "errors", detail: "error frames, emergencies, failed SDO transfers" },
  { text: "from=", detail: "from this time on, s" },
  { text: "to=", detail: "up to this time, s" },
];

const services: readonly Completion[] = [
  { text: "nmt", detail: "NMT commands" }, { text: "sync", detail: "SYNC" }, { text: "emcy", detail: "emergencies" }, { text: "time", detail: "TIME" }, { text: "pdo", detail: "process data" },
  { text: "sdo", detail: "SDO transfers" }, { text: "heartbeat", detail: "error control" }, { text: "lss", detail: "LSS" },
];

const aborts: readonly Completion[] = [
  { text: "05040000", detail: "no answer" }, { text: "06010001", detail: "write only" }, { text: "06010002", detail: "read only" }, { text: "06020000", detail: "no such object" }, { text: "06040041", detail: "cannot be mapped" },
  { text: "06070010", detail: "length does not match" }, { text: "06090011", detail: "no such sub-index" }, { text: "06090030", detail: "value out of range" }, { text: "08000020", detail: "cannot be stored" }, { text: "08000022", detail: "not in this state" },
];

const begins_with = (words: string, ...texts: string[]): boolean => texts.some((text) => text.toLowerCase().startsWith(words.toLowerCase()));

/** For a term that is being written; `objects`: indexes that have been seen. */
export function completions(term: string, state: RunState | null, objects: readonly string[] = []): Completion[] {
  const at = term.indexOf("=");
  if (at < 0) return keys.filter((one) => begins_with(term, one.text));
  const [key, rest] = [term.slice(0, at), term.slice(at + 1)];
  const last = rest.slice(rest.lastIndexOf(",") + 1);
  const before = `${key}=${rest.slice(0, rest.length - last.length)}`;
  const of = (values: readonly Completion[]): Completion[] => values.filter((one) => begins_with(last, one.text, one.detail)).map((one) => ({ text: before + one.text, detail: one.detail }));
  if (key === "service") return of(services);
  if (key === "abort") return of(aborts);
  if (key === "bus") return of((state?.buses ?? []).map((bus) => ({ text: bus.bus, detail: `${bus.bit_rate / 1000} kbit/s` })));
  if (key === "node") return of((state?.nodes ?? []).filter((node) => node.node >= 1 && node.node <= 127).map((node) => ({ text: String(node.node), detail: node.name })));
  if (key === "object") return of(objects.slice(0, 40).map((text) => ({ text, detail: "" })));
  return [];
}

/** Without the terms that are still being written: "node=", "service=sdo,". */
export const complete_terms = (text: string): string => text.split(/(\s+|"[^"]*")/).filter((term) => !/^!?\w+=(.*,)?$/.test(term)).join("").trim();
