// What a number in an object says, in words [CiA 301, CiA 302-2, CiA 402].

const hex = (number: number, digits: number): string => `${number.toString(16).toUpperCase().padStart(digits, "0")}H`;
const bit = (value: number, number: number): boolean => Math.floor(value / 2 ** number) % 2 === 1;
const milliseconds = (time: number): string => (time >= 1000 && time % 1000 === 0 ? `${time / 1000} s` : `${time} ms`);

/** "2nd", "11th". */
export function ordinal(number: number): string {
  const is_teen = Math.floor(number / 10) % 10 === 1;
  return `${number}${is_teen ? "th" : (["th", "st", "nd", "rd"][number % 10] ?? "th")}`;
}

/** Transmission type of a PDO [CiA 301 7.5.2.36, 7.5.2.38]. */
export function transmission_words(type: number): string {
  if (type === 0) return "synchronous, at events";
  if (type <= 240) return type === 1 ? "at every SYNC" : `at every ${ordinal(type)} SYNC`;
  if (type === 252) return "synchronous, on request";
  if (type === 253) return "on request";
  return type < 254 ? "reserved" : "event-driven";
}

const can_id = (value: number): string => (bit(value, 29) ? `CAN-ID ${hex(value % 2 ** 29, 8)} (29 bits)` : `CAN-ID ${hex(value % 2 ** 11, 3)}`);
const pdo_cob_id = (value: number): string => (bit(value, 31) ? "disabled" : can_id(value));

function mapped(value: number): string {
  if (value === 0) return "nothing";
  const bits = value % 256;
  return `${hex(Math.floor(value / 2 ** 16), 4).slice(0, 4)}:${hex(Math.floor(value / 256) % 256, 2).slice(0, 2)}, ${bits} ${bits === 1 ? "bit" : "bits"}`;
}

function start_up(value: number): string {
  if (!bit(value, 0)) return "not an NMT master";
  const words = [bit(value, 5) ? "flying NMT master" : "NMT master", bit(value, 3) ? "does not start the slaves" : bit(value, 1) ? "starts all nodes by one command" : "starts each slave by itself"];
  if (bit(value, 2)) words.push("is started by its application");
  if (bit(value, 6)) words.push("stops all nodes when a mandatory slave is lost");
  else if (bit(value, 4)) words.push("resets all nodes when a mandatory slave is lost");
  return words.join(", ");
}

function assignment(value: number): string {
  if (!bit(value, 0)) return "not a slave of this master";
  const words = [bit(value, 3) ? "mandatory slave" : "optional slave", bit(value, 2) ? "booted" : "not booted"];
  if (bit(value, 4)) words.push("not reset while operational");
  const [factor, time] = [Math.floor(value / 256) % 256, Math.floor(value / 2 ** 16)];
  if (factor && time) words.push(`guarded every ${milliseconds(time)}, lost after ${factor}`);
  return words.join(", ");
}

const names_of_bits = (value: number, names: readonly (string | null)[]): string => names.filter((name, i) => name !== null && bit(value, i)).join(", ");

/** What the bits of a word are called, from bit 0 on; null: it has no meaning, or another one in each mode. */
const bits_of_words: Record<string, readonly (string | null)[]> = {
  "1001:00": ["generic error", "current", "voltage", "temperature", "communication", "device profile", null, "manufacturer"],
  "6040:00": ["switch on", "enable voltage", "no quick stop", "enable operation", null, null, null, "fault reset", "halt"],
  "6041:00": ["ready to switch on", "switched on", "operation enabled", "fault", "voltage enabled", "no quick stop", "switch on disabled", "warning", null, "remote", "target reached", "internal limit active"],
};

export interface NamedBit {
  bit: number;
  name: string;
  is_on: boolean;
}

/** The bits of a word by their names; empty: it has none. */
export function named_bits(object: string, value: number): NamedBit[] {
  return (bits_of_words[object] ?? []).flatMap((name, i) => (name === null ? [] : [{ bit: i, name, is_on: bit(value, i) }]));
}

/** State of the drive [CiA 402-2], then the bits beside it. */
function statusword(value: number): string {
  const masked = value & 0x6f;
  const state = (value & 0x4f) === 0x00 ? "not ready to switch on" : (value & 0x4f) === 0x40 ? "switch on disabled" : masked === 0x21 ? "ready to switch on" : masked === 0x23 ? "switched on"
    : masked === 0x27 ? "operation enabled" : masked === 0x07 ? "quick stop active" : (value & 0x4f) === 0x0f ? "fault reaction active" : (value & 0x4f) === 0x08 ? "fault" : "unknown state";
  const more = names_of_bits(value, [null, null, null, null, "voltage enabled", null, null, "warning", null, "remote", "target reached", "internal limit active"]);
  return more ? `${state}; ${more}` : state;
}

function controlword(value: number): string {
  const command = bit(value, 7) ? "fault reset" : (value & 0x07) === 0x06 ? "shutdown" : (value & 0x0f) === 0x07 ? "switch on" : (value & 0x0f) === 0x0f ? "enable operation" : !bit(value, 1) ? "disable voltage" : !bit(value, 2) ? "quick stop" : "";
  return [command, bit(value, 8) ? "halt" : ""].filter(Boolean).join(", ");
}

const modes: Record<number, string> = { 0: "no mode", 1: "profile position", 2: "velocity", 3: "profile velocity", 4: "profile torque", 6: "homing", 7: "interpolated position", 8: "cyclic synchronous position", 9: "cyclic synchronous velocity", 10: "cyclic synchronous torque" };
const states: Record<number, string> = { 0: "initialising", 4: "stopped", 5: "operational", 127: "pre-operational" };

function consumer_time(value: number): string {
  const [node, time] = [Math.floor(value / 2 ** 16) % 128, value % 2 ** 16];
  return node === 0 || time === 0 ? "off" : `node ${node}, lost after ${milliseconds(time)}`;
}

type Row = readonly [first: number, last: number, sub: number | null, words: (value: number) => string];

/** Index range, sub-index (null: each but 00), words of the value. */
const rows: readonly Row[] = [
  [0x1000, 0x1000, 0, (value) => (value % 2 ** 16 === 0 ? "no device profile" : `CiA ${value % 2 ** 16}`)],
  [0x1001, 0x1001, 0, (value) => names_of_bits(value, bits_of_words["1001:00"]!) || "no error"],
  [0x1005, 0x1005, 0, (value) => `${can_id(value)}${bit(value, 30) ? ", produces SYNC" : ""}`],
  [0x1006, 0x1006, 0, (value) => (value === 0 ? "no SYNC is produced" : `every ${value / 1000} ms`)],
  [0x1014, 0x1014, 0, (value) => (bit(value, 31) ? "off" : can_id(value))],
  [0x1016, 0x1016, null, consumer_time],
  [0x1017, 0x1017, 0, (value) => (value === 0 ? "no heartbeat" : `every ${milliseconds(value)}`)],
  [0x1400, 0x15ff, 1, pdo_cob_id],
  [0x1400, 0x15ff, 2, (value) => (value <= 240 ? "taken at the next SYNC" : "taken at once")],
  [0x1600, 0x17ff, null, mapped],
  [0x1800, 0x19ff, 1, pdo_cob_id],
  [0x1800, 0x19ff, 2, transmission_words],
  [0x1800, 0x19ff, 3, (value) => (value === 0 ? "no pause" : `a pause of ${value / 10} ms at least`)],
  [0x1800, 0x19ff, 5, (value) => (value === 0 ? "only at events" : `after ${milliseconds(value)} at the latest`)],
  [0x1a00, 0x1bff, null, mapped],
  [0x1f80, 0x1f80, 0, start_up],
  [0x1f81, 0x1f81, null, assignment],
  [0x1f82, 0x1f82, null, (value) => states[value] ?? ""],
  [0x1f89, 0x1f89, 0, (value) => (value === 0 ? "no limit" : `at most ${milliseconds(value)}`)],
  [0x6040, 0x6040, 0, controlword],
  [0x6041, 0x6041, 0, statusword],
  [0x6060, 0x6061, 0, (value) => modes[value] ?? ""],
];

export const place_of = (object: string): [number, number] | null => {
  const found = /^([0-9A-F]{4}):([0-9A-F]{2})$/i.exec(object);
  return found ? [Number.parseInt(found[1]!, 16), Number.parseInt(found[2]!, 16)] : null;
};

/** Words for the value of an object ("1F80:00"); an empty text where there are none. */
export function words_of(object: string, value: number): string {
  const place = place_of(object);
  if (!place || !Number.isFinite(value)) return "";
  const [index, sub] = place;
  const row = rows.find(([first, last, of]) => first <= index && index <= last && (of === null ? sub !== 0 : of === sub));
  return row ? row[3](value) : "";
}

/** Whether people read an object's numbers in hexadecimal: identities, COB-IDs, mapped objects, words of bits. */
export function is_hexadecimal(object: string): boolean {
  const place = place_of(object);
  if (!place) return false;
  const [index, sub] = place;
  const within = (first: number, last: number): boolean => first <= index && index <= last;
  if ([0x1000, 0x1005, 0x1012, 0x1014, 0x6040, 0x6041].includes(index)) return true;
  if (index === 0x1018) return sub !== 0;
  if (within(0x1200, 0x12ff)) return sub === 1 || sub === 2;
  if (within(0x1400, 0x15ff) || within(0x1800, 0x19ff)) return sub === 1;
  return sub !== 0 && (within(0x1600, 0x17ff) || within(0x1a00, 0x1bff));
}

/** Types of `canopus sdo` for the names of CiA 301. */
export function sdo_type(type: string): string {
  const found = /^(UNSIGNED|INTEGER|REAL)(\d+)$/.exec(type);
  if (found) return `${{ UNSIGNED: "u", INTEGER: "i", REAL: "f" }[found[1]!]}${found[2]}`;
  return { BOOLEAN: "bool", VISIBLE_STRING: "text", UNICODE_STRING: "unicode", OCTET_STRING: "bytes", DOMAIN: "domain" }[type] ?? "";
}
