import assert from "node:assert/strict";
import { test } from "node:test";
import { fault_kinds, shown_value, values_of, with_value } from "../src/screens/faults/fault_text.js";
import { word_of_text } from "../src/screens/module/word_text.js";
import { LiveValues } from "../src/screens/objects/live_values.js";
import { difference_text, project_text, with_read_value } from "../src/screens/objects/object_text.js";
import { card_line, half_of } from "../src/screens/overview/cards.js";
import { mapping_refusal } from "../src/screens/pdos/pdo_editor.js";
import { entries_of, type Found } from "../src/screens/start/entries.js";
import { device_problem, free_node_id } from "../src/screens/start/wizard.js";
import { tree_of } from "../src/screens/settings/tree.js";
import { frame_of_row, frame_problem, frames_of } from "../src/screens/trace/frame_text.js";
import { without_options, type Command, type Done } from "../src/store/commands.js";
import { Cursors, cursor_text, value_at } from "../src/store/cursors.js";
import { DictionaryPdos, pdos_of_node } from "../src/store/dictionary_pdos.js";
import { Marks } from "../src/store/marks.js";
import { nodes_of } from "../src/store/nodes.js";
import { addresses_text, ProcessWords } from "../src/store/process_words.js";
import type { ProjectObject } from "../src/store/project.js";
import type { ObjectRow, RunState, WordRow } from "../src/store/protocol.js";
import { named_bits } from "../src/store/value_words.js";
import { recorded_views } from "./recorded.js";

const stuck = (): RunState => structuredClone(recorded_views.find((one) => one.event === "state" && one.plant === "stuck slaves")) as RunState;
const row = (object: string, decimal?: number, more: Partial<ObjectRow> = {}): ObjectRow => ({ object, name: object, of: object, type: "UNSIGNED32", access: "rw", ...(decimal === undefined ? {} : { decimal: String(decimal), hex: decimal.toString(16) }), ...more });

test("a cursor shows the value that a plot had at its time, and two cursors the difference", () => {
  const plot = { times: [1, 2, 4], values: [10, 20, 5] };
  assert.deepEqual([value_at(plot, 0.5), value_at(plot, 1), value_at(plot, 3.9), value_at(plot, 9)], [null, 10, 20, 5]);
  const cursors = new Cursors();
  cursors.a = 1.5;
  assert.equal(cursors.between, null);
  cursors.b = 4;
  assert.equal(cursors.between, 2.5);
  assert.equal(cursor_text(plot, cursors), "A 10, B 5, B−A -5");
});

test("marks stand in the order of time, a second one at the same line takes it away, and the time since the mark before is known", () => {
  const marks = new Marks();
  marks.toggle({ record: 9, t: 3, text: "b" });
  marks.toggle({ record: 4, t: 1, text: "a" });
  assert.deepEqual(marks.all.map((one) => one.text), ["a", "b"]);
  assert.deepEqual([marks.since(0.5), marks.since(2), marks.since(5)], [null, 1, 2]);
  marks.toggle({ record: 9, t: 3, text: "b" });
  assert.ok(!marks.has(9) && marks.has(4));
});

test("frames are text of one line each; what is no frame is said with its line", () => {
  assert.deepEqual(frames_of(" 181#01ff \n\n123#r\n"), ["181#01FF", "123#R"]);
  assert.equal(frame_problem("181#0102\n18FF1234#\n7FF#R8"), "");
  assert.match(frame_problem("181#0102\n18#00"), /^Line 2: a CAN-ID has 3 digits/);
  assert.match(frame_problem("800#00"), /^Line 1: the largest CAN-ID of 3 digits is 7FF/);
  assert.match(frame_problem("181#123"), /even number/);
  assert.match(frame_problem("181"), /expected CAN-ID#data/);
  assert.match(frame_problem("181#001122334455667788"), /at most 8 bytes/);
  assert.equal(frame_of_row({ id: "601", data: "40181001" }), "601#40181001");
  assert.equal(frame_of_row({ id: "701", remote: true, dlc: 1 }), "701#R1");
});

test("the CAN-ID of a fault has eight digits where it has 29 bits, and three take that away again", () => {
  const field = fault_kinds[0]!.fields[0]!;
  const long = with_value('kind = "drop"', field, "18FF1234");
  assert.equal(long, 'kind = "drop"\nextended = true\nidentifier = 0x18FF1234');
  assert.equal(shown_value(field, values_of(long)), "18FF1234");
  assert.equal(shown_value(field, values_of('identifier = 0x123\nextended = true')), "00000123");
  assert.equal(with_value(long, field, "181"), 'kind = "drop"\nidentifier = 0x181');
});

test("a word is written in decimal or hexadecimal, with or without a sign", () => {
  assert.deepEqual(["1234", "-1", "−1", "12ABH", "0x10", "FFH", "65536", "12AB", "", "1.5"].map(word_of_text), [1234, 65535, 65535, 0x12ab, 16, 255, null, null, null, null]);
});

test("an object says what the project has and whether that differs, in the notation of its value", () => {
  const beat = row("1017:00", 500, { type: "UNSIGNED16" });
  assert.deepEqual([project_text(beat, 250, false), project_text(beat, 250, true), difference_text(beat, 250)], ["250", "00FAH", "differs"]);
  assert.deepEqual([difference_text(beat, 500), difference_text(beat, undefined), difference_text(beat, null), difference_text(row("1017:00"), 250)], ["same", "", "", ""]);
  assert.deepEqual([project_text(row("1008:00", undefined, { text: "drive" }), "encoder", false), difference_text(row("1008:00", undefined, { text: "drive" }), "encoder")], ["encoder", "differs"]);
});

test("the bits of a word have their names", () => {
  assert.deepEqual(named_bits("6041:00", 0x0237).filter((one) => one.is_on).map((one) => `${one.bit} ${one.name}`),
    ["0 ready to switch on", "1 switched on", "2 operation enabled", "4 voltage enabled", "5 no quick stop", "9 remote"]);
  assert.deepEqual(named_bits("6064:00", 5), []);
});

test("values of a live node are read one after the other, with the type of the file, and a refusal stands in its row", async () => {
  const asked: Command[] = [];
  const answers: Partial<Done>[] = [{ code: 0, rows: [{ object: "6041:00", value: 55 }], t: 1 }, { code: 1, rows: [{ reason: "06010001H Read access to a write-only object" }], t: 2 }];
  const live = new LiveValues((command) => { asked.push(command); return Promise.resolve({ message: "", command: "", ...answers[asked.length - 1] } as Done); }, () => undefined);
  const took: unknown[] = [];
  const rows = [row("6041:00", undefined, { type: "UNSIGNED16" }), row("6040:00", undefined, { type: "UNSIGNED16" }), row("2000:00", undefined, { access: "wo" })];
  await live.read_rows("can0", 5, rows, (...words) => took.push(words));
  assert.deepEqual(asked, [{ command: "sdo read", bus: "can0", node: "5", object: "6041:00", type: "u16" }, { command: "sdo read", bus: "can0", node: "5", object: "6040:00", type: "u16" }]);
  assert.deepEqual(took, [["6041:00", 55, 1]]);
  assert.deepEqual([live.shown(rows[0]!).decimal, live.shown(rows[0]!).hex, live.problem_of("6040:00")], ["55", "0037", "06010001H Read access to a write-only object"]);
  assert.equal(with_read_value(row("6064:00", undefined, { type: "INTEGER16" }), -2).hex, "FFFE");
});

test("a node of a live bus has the name of its project; one of the project that was not seen says so", () => {
  const state = stuck();
  state.outside = [{ bus: "can0", node: 5, name: "", state: "operational", in_operation: true }];
  const [drive, io] = nodes_of(state, new Map(), [{ bus: "can0", node: 5, name: "drive" }, { bus: "can0", node: 6, name: "io" }]).slice(-2);
  assert.deepEqual([drive!.name, drive!.mood, card_line(drive!)], ["drive", "good", "operational"]);
  assert.deepEqual([io!.name, io!.mood, card_line(io!)], ["io", "warning", "in the project, not seen yet"]);
});

test("each half of a cut bus has its nodes", () => {
  const half = { now: 0, frames: 0, error_frames: 0 };
  const bus = { cut: [{ ...half, nodes: ["plc", "io"] }, { ...half, nodes: ["drive"] }] };
  assert.deepEqual([half_of(bus, { name: "io" }), half_of(bus, { name: "drive" }), half_of(bus, { name: "nobody" }), half_of({}, { name: "io" })], [0, 1, 0, -1]);
});

const dictionary: ObjectRow[] = [row("1800:01", 0x181), row("1800:02", 255), row("1800:05", 100), row("1A00:00", 2), row("1A00:01", 0x60000108), row("1A00:02", 0x00050008), row("6000:01", 0, { name: "Inputs 1 to 8" }), row("1801:01", 0x80000281), row("1A01:00", 0)];

test("PDOs are read out of a dictionary: CAN-ID, times, mapping with its places, and those that are disabled", () => {
  const [first, second] = pdos_of_node(1, dictionary);
  assert.deepEqual(first, { node: 1, pdo: "TPDO1", active: true, can_id: 0x181, transmission_type: 255, bytes: 2, event_ms: 100, mapping: [{ bit: 0, bits: 8, object: "6000:01", name: "Inputs 1 to 8" }, { bit: 8, bits: 8 }] });
  assert.deepEqual([second!.pdo, second!.active, second!.bytes], ["TPDO2", false, 0]);
});

test("dictionaries are asked for in parts, and a TPDO is linked to the RPDO of its CAN-ID", () => {
  const state = stuck();
  state.nodes = state.nodes.slice(0, 2).map((one, i) => ({ ...one, node: i + 1, name: ["plc", "io"][i]! }));
  const pdos = new DictionaryPdos("line1", state);
  const wished = (): unknown[] => pdos.wishes().map((one) => "objects" in one && [one.objects, one.from]);
  assert.deepEqual(wished(), [[0, 0], [1, 0]]);
  const event = (number: number, from: number, of: number, rows: ObjectRow[]): void => pdos.take({ t: 0, event: "objects", number, bus: "line1", node: number + 1, name: "", from, of, rows });
  const long = [...Array.from({ length: 300 }, (_, i) => row(`2${i.toString(16).padStart(3, "0")}:00`, 0)), ...dictionary];
  event(1, 0, long.length, long.slice(0, 256));
  assert.deepEqual(wished(), [[0, 0], [1, 256]]);
  event(1, 256, long.length, long.slice(256));
  event(0, 0, 4, [row("1400:01", 0x181), row("1600:00", 1), row("1600:01", 0x22000110), row("2200:01", 0, { name: "Word" })]);
  assert.ok(pdos.is_complete && pdos.wishes().length === 0);
  const sender = pdos.pdos.find((one) => one.node === 2 && one.pdo === "TPDO1")!;
  assert.deepEqual(sender.mapping[0]!.to, [{ node: 1, object: "2200:01" }]);
  assert.deepEqual(pdos.pdos.find((one) => one.pdo === "RPDO1")!.mapping[0]!.from, [{ node: 2, object: "6000:01" }]);
  assert.equal(pdos.label(2), "2 io");
});

test("of a large dictionary no more is asked for than up to its last PDO", () => {
  const state = stuck();
  state.nodes = state.nodes.slice(0, 1).map((one) => ({ ...one, node: 1, name: "module" }));
  const pdos = new DictionaryPdos("line1", state);
  const event = (from: number, rows: ObjectRow[]): void => pdos.take({ t: 0, event: "objects", number: 0, bus: "line1", node: 1, name: "module", from, of: 20_000, rows });
  event(0, Array.from({ length: 256 }, (_, i) => row(`1${i.toString(16).toUpperCase().padStart(3, "0")}:00`, 0)));
  assert.deepEqual(pdos.wishes().map((one) => "from" in one && one.from), [256, 512, 768, 1024, 1280, 1536]);
  event(256, [...dictionary, ...Array.from({ length: 247 }, () => row("2000:00", 0))]);
  assert.ok(pdos.is_complete);
  assert.equal(pdos.pdos[0]!.pdo, "TPDO1");
});

test("the words of a PDO are found by its CAN-ID, over as many parts as there are", () => {
  const state = stuck();
  const words = new ProcessWords("line1", state);
  const word = (address: number, can_id?: string): WordRow => ({ address, name: "", access: "read", value: 0, initial: 0, section: "", ...(can_id ? { pdo: "RPDO1", can_id } : {}) });
  assert.deepEqual(words.wishes(null), [{ words: 0, find: "PDO", from: 0, count: 256 }]);
  words.take({ t: 0, event: "words", number: 0, module: "", from: 0, of: 3, rows: [word(10001, "183"), word(29)] });
  assert.deepEqual(words.wishes(null), [{ words: 0, find: "PDO", from: 2, count: 256 }]);
  words.take({ t: 0, event: "words", number: 0, module: "", from: 2, of: 3, rows: [word(10000, "183")] });
  assert.ok(words.is_complete);
  assert.deepEqual(words.of("183").map((one) => addresses_text(one.words)), ["G10000 to G10001"]);
  assert.deepEqual(words.wishes("183"), [{ words: 0, find: "183", from: 0, count: 64 }]);
  assert.deepEqual(words.wishes("777"), []);
});

test("what does not fit into a frame is refused with the bits that are free", () => {
  const object = (type: string): ProjectObject => ({ node: 1, object: "6000:01", name: "", type, access: "ro", value: 0, configured: false });
  assert.equal(mapping_refusal(56, object("UNSIGNED8")), "");
  assert.equal(mapping_refusal(56, object("UNSIGNED16")), "16 bits do not fit: 8 of 64 bits are free");
  assert.match(mapping_refusal(0, object("DOMAIN")), /no fixed size/);
});

test("plants are found by module, device and name; those that are not named by their paths", () => {
  const found: Found = { folder: "/x", plants: [{ path: "a/plant.toml", name: "first plant", buses: [{ bus: "line1", bit_rate: 250_000, modules: ["ME3CAN1-Q"], devices: ["io", "encoder"] }] }, { path: "b.toml", problem: "b.toml:3: text must be in quotes" }, { path: "old/plant.toml" }],
    projects: ["p/nodelist.cpj"], settings: ["press.xml"], running: [] };
  const all = entries_of(found, "");
  assert.deepEqual(all.map((one) => one.name), ["first plant", "b", "old", "p", "press"]);
  assert.equal(all[0]!.shows, "ME3CAN1-Q, 2 devices, 250 kbit/s");
  assert.match(all[1]!.problem, /quotes/);
  assert.deepEqual(entries_of(found, "encoder").map((one) => one.path), ["a/plant.toml"]);
  assert.deepEqual(entries_of(found, "module settings").map((one) => one.path), ["press.xml"]);
  assert.deepEqual(entries_of(found, "nothing"), []);
});

test("a new device gets the lowest free node-ID; one that is there twice or is none is said", () => {
  assert.equal(free_node_id(["2", "3", "5"], 2), 4);
  const device = (node_id: string): { node_id: string; name: string } => ({ node_id, name: "" });
  assert.equal(device_problem([device("2"), device("3")]), "");
  assert.equal(device_problem([device("2"), device("2")]), "Node-ID 2 is there twice");
  assert.match(device_problem([device("128")]), /1 to 127/);
});

test("windows of the configuration tool are a tree by the words before the colon", () => {
  assert.deepEqual(tree_of([{ word: "basic", title: "CANopen Configuration" }, { word: "tpdo", title: "PDO list: Transmit PDO" }, { word: "rpdo", title: "PDO list: Receive PDO" }]),
    [{ title: "", items: [{ word: "basic", title: "CANopen Configuration" }] }, { title: "PDO list", items: [{ word: "tpdo", title: "Transmit PDO" }, { word: "rpdo", title: "Receive PDO" }] }]);
});

test("no sentence about options of the command line comes to the page", () => {
  assert.equal(without_options("type missing: use --type u16 (or another of bool, u8), or --raw for bytes in hexadecimal"), "Choose a type.");
  assert.equal(without_options("it is there already. Overwrite it with --force."), "it is there already.");
  assert.equal(without_options("type missing: use --type u16 (or i32, text, ...)"), "Choose a type.");
  assert.equal(without_options("node 5 does not answer. Check its node-ID."), "node 5 does not answer. Check its node-ID.");
  assert.equal(without_options(""), "");
});
