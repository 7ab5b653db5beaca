// What a number in an object of the communication profile says, in words [CiA 301, CiA 302-2]: COB-IDs, transmission types, mapped objects, times, the
// bits of an NMT master. Nothing of the page is needed here.

const hex = (number, digits) => `${number.toString(16).toUpperCase().padStart(digits, "0")}H`;
const bit = (value, number) => Math.floor(value / 2 ** number) % 2 === 1;
const milliseconds = (time) => time >= 1000 && time % 1000 === 0 ? `${time / 1000} s` : `${time} ms`;

/// Transmission type of a PDO [CiA 301 7.5.2.36, 7.5.2.38].
export function transmission_words(type) {
  if (type === 0) return "synchronous, at events";
  if (type <= 240) return type === 1 ? "synchronous" : `synchronous, every ${type} SYNCs`;
  if (type === 252) return "synchronous, on request";
  if (type === 253) return "on request";
  return type < 254 ? "reserved" : "event-driven";
}

function can_id(value) {
  return bit(value, 29) ? `CAN-ID ${hex(value % 2 ** 29, 8)} (29 bits)` : `CAN-ID ${hex(value % 2 ** 11, 3)}`;
}

function pdo_cob_id(value, is_tpdo) {
  if (bit(value, 31)) return "off";
  return can_id(value) + (is_tpdo && bit(value, 30) ? ", no remote request" : "");
}

function mapped(value) {
  if (value === 0) return "nothing";
  const bits = value % 256;
  return `${hex(Math.floor(value / 2 ** 16), 4).slice(0, 4)}:${hex(Math.floor(value / 256) % 256, 2).slice(0, 2)}, ${bits} ${bits === 1 ? "bit" : "bits"}`;
}

/// 1F80H [CiA 302-2].
function start_up(value) {
  if (!bit(value, 0)) return "not an NMT master";
  const words = [bit(value, 5) ? "flying NMT master" : "NMT master", bit(value, 1) ? "starts all nodes by one command" : "starts each slave by itself"];
  if (bit(value, 3)) words[1] = "does not start the slaves";
  if (bit(value, 2)) words.push("is started by its application");
  if (bit(value, 6)) words.push("stops all nodes when a mandatory slave is lost");
  else if (bit(value, 4)) words.push("resets all nodes when a mandatory slave is lost");
  return words.join(", ");
}

/// 1F81H [CiA 302-2].
function assignment(value) {
  if (!bit(value, 0)) return "not a slave of this master";
  const words = [bit(value, 3) ? "a mandatory slave" : "an optional slave", bit(value, 2) ? "is booted" : "is not booted"];
  if (bit(value, 4)) words.push("is not reset while it is operational");
  if (bit(value, 5)) words.push("its software is checked");
  if (bit(value, 6)) words.push("its software may be updated");
  if (bit(value, 7)) words.push("gets its defaults back first");
  const [factor, time] = [Math.floor(value / 256) % 256, Math.floor(value / 2 ** 16)];
  if (factor && time) words.push(`is guarded every ${milliseconds(time)}, lost after ${factor}`);
  return words.join(", ");
}

function consumer_time(value) {
  const [node, time] = [Math.floor(value / 2 ** 16) % 128, value % 2 ** 16];
  return node === 0 || time === 0 ? "nobody" : `node ${node}, lost after ${milliseconds(time)}`;
}

/// Index range, sub-index (null: each but 00), words of the value.
const rows = [
  [0x1000, 0x1000, 0, (value) => value % 2 ** 16 === 0 ? "no device profile" : `CiA ${value % 2 ** 16}`],
  [0x1005, 0x1005, 0, (value) => `${can_id(value)}${bit(value, 30) ? ", produces SYNC" : ""}`],
  [0x1006, 0x1006, 0, (value) => value === 0 ? "no SYNC is produced" : `every ${value / 1000} ms`],
  [0x1014, 0x1014, 0, (value) => bit(value, 31) ? "off" : can_id(value)],
  [0x1016, 0x1016, null, consumer_time],
  [0x1017, 0x1017, 0, (value) => value === 0 ? "no heartbeat" : `every ${milliseconds(value)}`],
  [0x1400, 0x15FF, 1, (value) => pdo_cob_id(value, false)],
  [0x1400, 0x15FF, 2, (value) => value <= 240 ? "taken at the next SYNC" : "taken at once"],
  [0x1600, 0x17FF, null, mapped],
  [0x1800, 0x19FF, 1, (value) => pdo_cob_id(value, true)],
  [0x1800, 0x19FF, 2, transmission_words],
  [0x1800, 0x19FF, 3, (value) => value === 0 ? "no pause" : `a pause of ${value / 10} ms at least`],
  [0x1800, 0x19FF, 5, (value) => value === 0 ? "only at events" : `after ${milliseconds(value)} at the latest`],
  [0x1A00, 0x1BFF, null, mapped],
  [0x1F80, 0x1F80, 0, start_up],
  [0x1F81, 0x1F81, null, assignment],
  [0x1F89, 0x1F89, 0, (value) => value === 0 ? "as long as it takes" : `at most ${milliseconds(value)}`],
];

/// Whether people read an object's numbers in hexadecimal: identities, COB-IDs, mapped objects.
function is_hexadecimal(object) {
  const [index, sub] = object.split(":").map((part) => Number.parseInt(part, 16));
  const within = (first, last) => first <= index && index <= last;
  if ([0x1000, 0x1005, 0x1012, 0x1014].includes(index)) return true;
  if (index === 0x1018) return sub !== 0;
  if (within(0x1200, 0x12FF)) return sub === 1 || sub === 2;
  if (within(0x1400, 0x15FF) || within(0x1800, 0x19FF)) return sub === 1;
  return sub !== 0 && (within(0x1600, 0x17FF) || within(0x1A00, 0x1BFF));
}

/// A value of an object as a project takes it, too: 0x80000183 or 500, texts as they are.
export function value_text(object, value) {
  if (value === null || value === undefined) return "";
  return typeof value === "number" && is_hexadecimal(object) ? `0x${value.toString(16).toUpperCase().padStart(8, "0")}` : String(value);
}

/// Words for the value of an object ("1F80:00"); an empty text where there are none.
export function words_of(object, value) {
  const place = /^([0-9A-F]{4}):([0-9A-F]{2})$/i.exec(object ?? "");
  const text = String(value ?? "").trim();
  if (!place || !/^(\d+|0x[0-9a-f]+)$/i.test(text)) return "";
  const [index, sub] = [Number.parseInt(place[1], 16), Number.parseInt(place[2], 16)];
  const row = rows.find(([first, last, of]) => first <= index && index <= last && (of === null ? sub !== 0 : of === sub));
  return row ? row[3](Number(text)) : "";
}
