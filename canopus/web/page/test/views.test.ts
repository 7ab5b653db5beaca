import assert from "node:assert/strict";
import { test } from "node:test";
import { found_places, places_of } from "../src/frame/places.js";
import { link, parse_route } from "../src/frame/route.js";
import { axis, facts_of, newest_attempt, reason_and_remedy, spans_of } from "../src/screens/boot/waterfall.js";
import { fields_of_error, LoadHistory } from "../src/screens/bus/load.js";
import { collapsed, matching_events } from "../src/screens/events/filter.js";
import { fault_kinds, fault_words, kind_of, shown_value, values_of, with_value } from "../src/screens/faults/fault_text.js";
import { card_line, sorted_troubles } from "../src/screens/overview/cards.js";
import { bits_of_all, found_objects, mappable_objects, mapping_text, parse_mapped } from "../src/screens/settings/mapping.js";
import { bits_of, refusal } from "../src/screens/pdos/pdo_words.js";
import { fault_status, FaultList } from "../src/store/faults.js";
import { complete_terms, completions } from "../src/store/filter.js";
import { nodes_of } from "../src/store/nodes.js";
import { Plots, most_plots } from "../src/store/plots.js";
import { plan_of, Project, results_of, type ProjectObject } from "../src/store/project.js";
import { scan_facts, SourceLines, task_words, value_text } from "../src/store/program.js";
import type { ProgramLine, RunEvent, RunState, TrafficView, TraceRow } from "../src/store/protocol.js";
import { sentence } from "../src/store/sentences.js";
import { Store } from "../src/store/store.js";
import { too_long, upload } from "../src/screens/trace/upload.js";
import type { Command, Done } from "../src/store/commands.js";
import { meaning_text, TraceRows } from "../src/store/trace_rows.js";
import { sdo_type, transmission_words, words_of } from "../src/store/value_words.js";
import { ViewRows } from "../src/store/view_rows.js";
import { recorded_views } from "./recorded.js";

const stuck = structuredClone(recorded_views.find((one) => one.event === "state" && one.plant === "stuck slaves")) as RunState;

test("an address names a screen, its thing and its query, whatever letters they have", () => {
  const address = link("objects", ["line 1/a", 3], { find: "a=b&c?", empty: "" });
  assert.deepEqual(parse_route(address), { screen: "objects", path: ["line 1/a", "3"], query: { find: "a=b&c?" } });
  assert.deepEqual(parse_route("#/trace?filter=%E0%A4%A"), { screen: "trace", path: [], query: { filter: "%E0%A4%A" } });
  assert.deepEqual(parse_route(""), { screen: "", path: [], query: {} });
});

test("the palette finds nodes by name, objects by index, words by address, and nothing for nonsense", () => {
  const places = places_of([], stuck, nodes_of(stuck));
  assert.match(found_places(places, "encoder", stuck)[0]!.title, /^3 encoder/);
  assert.ok(found_places(places, "6041", stuck).some((one) => one.href === "#/objects/line1/4?find=6041"));
  assert.equal(found_places(places, "g10000", stuck)[0]!.href, "#/module/0?find=G10000");
  assert.ok(found_places(places, "zzzz", stuck).every((one) => one.is_guess));
});

test("nodes in trouble stand first, errors before warnings, and cards say external nodes", () => {
  const nodes = nodes_of(stuck);
  assert.deepEqual(sorted_troubles(nodes).map((node) => node.node), [3, 5, 9]);
  assert.match(card_line(nodes.find((node) => node.node === 9)!), /external node/);
});

test("a file of the browser's machine is sent in parts, each after the reply to the one before, up to the first that is refused", async () => {
  const file = Object.assign(new Blob([new Uint8Array(300_000).map((_, i) => i % 251)]), { name: "run.pcapng" });
  const sent: Command[] = [];
  const answer = (code: number, row: Record<string, unknown>): Done => ({ code, rows: [row], message: code ? "the disk is full" : "", command: "", t: 0 });
  const run = (most: number) => (command: Command): Promise<Done> => {
    sent.push(command);
    return Promise.resolve(sent.length > most ? answer(5, {}) : answer(0, { upload: 7 }));
  };
  const progress: number[] = [];
  assert.deepEqual(await upload(file, run(10), (bytes) => progress.push(bytes)), { upload: 7 });
  assert.deepEqual(sent[0], { command: "upload trace", name: "run.pcapng", size: 300_000 });
  const bytes = Buffer.concat(sent.slice(1).map((one) => Buffer.from(String(one["data"]), "base64")));
  assert.deepEqual(bytes, Buffer.from(await file.arrayBuffer()));
  assert.deepEqual(progress, [131_072, 262_144, 300_000]);
  sent.length = 0;
  assert.equal(((await upload(file, run(2), () => undefined)) as Done).message, "the disk is full");
  assert.equal(sent.length, 3);
  assert.match(too_long("run.asc", 129 * 1024 ** 2), /129 MiB.* at most 128 MiB/);
  assert.equal(too_long("run.asc", 128 * 1024 ** 2), "");
});

test("an event says what happened, at its own moment", () => {
  const event = { t: 1, event: "boot slave", bus: "line1", node: 3, name: "encoder", reason: "failed (M, product code differs from 1F86H), 0.0 s ago. Check the device." } as unknown as RunEvent;
  assert.equal(sentence(event), "line1, node 3 (encoder): failed (M, product code differs from 1F86H). Check the device.");
  assert.equal(sentence({ ...event, reason: "asking for 1000H, for 0.0 s. Asked 8 times without an answer." } as RunEvent), "line1, node 3 (encoder): asking for 1000H. Asked 8 times without an answer.");
  const audit = (wish: object): string => sentence({ t: 1, event: "audit", do: JSON.stringify(wish), code: 0, user: "anna", role: "operate", address: "::1" } as unknown as RunEvent);
  assert.match(audit({ command: "upload trace", name: "../run.asc", size: 5 }), /^trace file \.\.\/run\.asc from the browser's machine/);
  assert.match(audit({ command: "open trace", upload: 1 }), /^open the trace file from the browser's machine/);
  assert.match(audit({ command: "open trace", path: "old/run.log" }), /^open old\/run\.log/);
});

test("terms that are still being written filter nothing", () => {
  assert.equal(complete_terms("service=sdo node="), "service=sdo");
  assert.equal(complete_terms('node=3, "a b=" !abort='), '"a b="');
  assert.equal(complete_terms("node=3"), "node=3");
});

test("a term is completed by keys, then by their values, behind a comma too", () => {
  assert.deepEqual(completions("no", stuck).map((one) => one.text), ["node="]);
  assert.deepEqual(completions("node=enc", stuck).map((one) => one.text), ["node=3"]);
  assert.deepEqual(completions("service=sdo,p", stuck).map((one) => one.text), ["service=sdo,pdo"]);
  assert.ok(completions("abort=0601", stuck).some((one) => one.text === "abort=06010002"));
});

/** A server with lines 0 to `end`, of which it gives at most 256 at once. */
function server(lines: { end: number }): { asked: Record<string, unknown>[]; ask: (command: Record<string, unknown>) => Promise<Done> } {
  const asked: Record<string, unknown>[] = [];
  return { asked, ask: (command) => {
    asked.push(command);
    const count = Number(command["count"]);
    const from = Math.min(Number(command["from"] ?? lines.end - count), lines.end - count);
    const rows = Array.from({ length: Math.min(count, lines.end) }, (_, i) => ({ n: Math.max(0, from) + i, record: i, t: (Math.max(0, from) + i) / 10, bus: "b", id: "181", service: "pdo", what: "TPDO1", text: "x" }));
    return Promise.resolve({ code: 0, rows: [{ records: lines.end, forgotten: 0, first: 0, end: lines.end, from, rows }], message: "", command: "", t: 0 });
  } };
}
const settled = (): Promise<void> => new Promise((done) => setImmediate(done));

test("the trace shows the newest line first, with the time since the line before", async () => {
  const lines = { end: 1000 };
  const rows = new TraceRows(server(lines).ask, () => undefined);
  rows.restart("", true);
  await settled();
  assert.equal(rows.count, 1000);
  assert.equal(rows.row(0)!.n, 999);
  assert.ok(Math.abs(rows.row(0)!.delta! - 0.1) < 1e-9);
  rows.set_order(false);
  assert.equal(rows.row(999)!.n, 999);
});

test("lines that come into sight next are asked for before they are in sight", async () => {
  const { ask, asked } = server({ end: 100_000 });
  const rows = new TraceRows(ask, () => undefined);
  rows.restart("", true);
  await settled();
  rows.freeze(true);
  for (let first = 0; first < 3000; first += 60) {
    rows.see(first, first + 40);
    for (let index = first; index <= first + 40; ++index) assert.ok(rows.row(index), `line ${index}`);
    await settled();
  }
  assert.ok(asked.length < 30, `${asked.length} questions for 3,000 lines`);
});

test("a frozen trace stays while lines come, and asks for those in sight alone", async () => {
  const lines = { end: 1000 };
  const { ask, asked } = server(lines);
  const rows = new TraceRows(ask, () => undefined);
  rows.restart("", true);
  await settled();
  rows.freeze(true);
  lines.end = 1500;
  await rows.fetch();
  assert.equal(rows.row(0)!.n, 999);
  asked.length = 0;
  rows.see(600, 640);
  await settled();
  assert.equal(asked.length, 1);
  assert.ok(rows.row(620));
  assert.equal(rows.row(620)!.n, 379);
  rows.freeze(false);
  await settled();
  assert.equal(rows.row(0)!.n, 1499);
});

test("a line stays the same object while it does not change, and scrolling asks for what comes next", async () => {
  const { ask, asked } = server({ end: 5000 });
  const rows = new TraceRows(ask, () => undefined);
  rows.restart("", true);
  await settled();
  const line = rows.row(3);
  await rows.fetch();
  assert.ok(rows.row(3) === line);
  rows.freeze(true);
  asked.length = 0;
  rows.see(1000, 1040);
  await settled();
  assert.equal(rows.row(1210)!.n, 3789, "older lines came with those in sight");
  rows.see(1100, 1140);
  rows.see(1200, 1210);
  await settled();
  assert.equal(asked.length, 2, "the next ones, before they are in sight; all of those are new");
  assert.equal(rows.row(1500)!.n, 3499);
});

test("an answer to an old filter is not shown", async () => {
  let answer: ((done: Done) => void) | null = null;
  const rows = new TraceRows(() => new Promise((done) => { answer = done; }), () => undefined);
  rows.restart("node=1", true);
  const first = answer as unknown as (done: Done) => void;
  rows.restart("node=2", true);
  first({ code: 0, rows: [{ records: 1, forgotten: 0, first: 0, end: 1, from: 0, rows: [{ n: 0 }] }], message: "", command: "", t: 0 });
  await settled();
  assert.equal(rows.count, 0);
});

test("the abort code of an SDO transfer stands first", () => {
  const row = (text: string, service = "sdo"): Pick<TraceRow, "text" | "service"> => ({ text, service });
  assert.equal(meaning_text(row("1000:00 'Device type' read: aborted by the server: 06010002H read only")), "06010002H read only; 1000:00 'Device type' read: aborted by the server");
  assert.equal(meaning_text(row("Position value = 7", "pdo")), "Position value = 7");
});

test("rows of a view are kept by their place, and forgotten with another text", () => {
  const rows = new ViewRows<{ a: number }>();
  rows.take({ from: 10, of: 100, rows: [{ a: 1 }, { a: 2 }] });
  assert.deepEqual([rows.count, rows.row(11)], [100, { a: 2 }]);
  rows.see(50, 80);
  assert.deepEqual([rows.from, rows.asked], [20, 91]);
  rows.restart("x");
  assert.deepEqual([rows.count, rows.row(11)], [0, undefined]);
});

test("events that say the same but for numbers are one line with their count", () => {
  const store = new Store();
  store.receive([1, 2, 3].map((n) => ({ t: n, event: "boot slave", bus: "line1", node: 9, step: "asking", reason: `Asked ${n} times` })), 0);
  store.receive([{ t: 4, event: "boot", bus: "line1", node: 2 }], 0);
  const rows = collapsed(store.events, true);
  assert.deepEqual(rows.map((one) => one.count), [3, 1]);
  assert.match(rows[0]!.text, /Asked 3 times/);
  assert.equal(collapsed(store.events, false).length, 4);
  assert.equal(matching_events(store.events, { find: "boot-up", only: "" }).length, 1);
});

test("each kind of fault has words, and its form keeps what it does not know", () => {
  for (const kind of fault_kinds) assert.ok(kind_of(kind.start), kind.kind);
  assert.equal(fault_words('kind = "drop"\nidentifier = 0x181\ncount = 1'), "Lose frames, 181H, at most 1");
  const drop = fault_kinds.find((one) => one.kind === "drop")!;
  const [id, count] = [drop.fields.find((one) => one.key === "identifier")!, drop.fields.find((one) => one.key === "count")!];
  const text = with_value('kind = "drop"\n# why\nidentifier = 0x181', id, "1a2");
  assert.equal(text, 'kind = "drop"\n# why\nidentifier = 0x1a2');
  assert.equal(shown_value(id, values_of(text)), "1A2");
  assert.equal(with_value(with_value(text, count, "3"), count, ""), text);
  const cut = fault_kinds.find((one) => one.kind === "cut")!;
  assert.equal(with_value('kind = "cut"\nports = ["a"]', cut.fields[0]!, 'b "x"'), 'kind = "cut"\nports = ["b \\"x\\""]');
});

test("a fault that was removed here acts until Run, and is said", () => {
  const drop = 'kind = "drop"';
  const { edited, left } = fault_status([{ text: "new", on: true, from_file: false }], [{ text: drop, on: true, from_file: true, hits: 1 }]);
  assert.equal(edited[0]!.words, "not yet run");
  assert.deepEqual(left, [{ text: drop, words: "1 frame hit; removed here, acts until Run" }]);
});

test("what somebody edits stays when the run is asked for its faults, and after a refusal", () => {
  const list = new FaultList();
  const row = { buses: [{ bus: "line1", seed: 1, ports: [], faults: [{ text: "a", on: true, from_file: true, hits: 2 }] }] };
  list.take(row);
  list.add("line1", "b");
  list.ran("line1", "fault 2: expected a kind");
  list.take(row);
  assert.deepEqual(list.bus("line1")!.edited.map((one) => one.text), ["a", "b"]);
  assert.equal(list.bus("line1")!.problem, "fault 2: expected a kind");
  list.ran("line1", "");
  list.take(row);
  assert.deepEqual(list.bus("line1")!.edited.map((one) => one.text), ["a"]);
});

test("of a program the lines in sight are asked for, and kept until the file has another length", () => {
  const lines = new SourceLines();
  const one = (text: string): ProgramLine => ({ text, code: true, values: [] });
  assert.deepEqual(lines.asked, { from: 1, count: 100 });
  lines.take({ from: 1, of: 900, lines: [one("a"), one("b")] });
  lines.see(500, 530);
  assert.deepEqual(lines.asked, { from: 460, count: 111 });
  lines.take({ from: 460, of: 900, lines: [one("c")] });
  assert.deepEqual([lines.line(2)?.text, lines.line(460)?.text, lines.line(461)], ["b", "c", undefined]);
  lines.see(1, 2000);
  assert.equal(lines.asked.count, 400, "as many as the server sends");
  lines.take({ from: 1, of: 899, lines: [one("new")] });
  assert.deepEqual([lines.line(1)?.text, lines.line(2), lines.line(460)], ["new", undefined, undefined]);
});

test("a program's tasks and times are said in words, and BOOL as ON and OFF", () => {
  assert.equal(task_words({ kind: "fixed scan", every: 0.01 }), "every 10.0 ms");
  assert.equal(task_words({ kind: "event", on: "X10" }), "when X10 goes ON");
  assert.deepEqual(scan_facts({ count: 500, period: 0.002, now: 0.00041, least: 0.0004, most: 0.0006 }), [["Scans", "500"], ["Scan time", "2.0 ms"], ["Execution", "410 µs"], ["Shortest", "400 µs"], ["Longest", "600 µs"]]);
  assert.deepEqual(scan_facts({ count: 0, period: 0.002, now: 0, least: 0, most: 0 }), [["Scans", "0"], ["Scan time", "2.0 ms"]], "before the first scan nothing is known");
  assert.deepEqual([value_text({ type: "BOOL", value: "TRUE" }), value_text({ type: "BOOL", value: "FALSE" }), value_text({ type: "TIME", value: "T#1s" })], ["ON", "OFF", "T#1s"]);
});

test("faults: a menu that was opened before an answer came adds to the list of now", () => {
  const list = new FaultList();
  const row = { buses: [{ bus: "line1", seed: 1, ports: [], faults: [] }] };
  list.take(row);
  const of_menu = list.bus("line1")!;
  list.take(structuredClone(row));
  list.add("line1", "b");
  assert.deepEqual(of_menu.edited.map((one) => one.text), ["b"]);
});

test("a boot's bars end with the next step, and a long pause is a small gap", () => {
  const spans = spans_of([{ t: 0, since: 0, step: "reset" }, { t: 1, since: 1, step: "failed", error: "M" }, { t: 1000, since: 1000, step: "asking", error: "B" }, { t: 1001, since: 1001, step: "booted" }], 2000);
  assert.deepEqual(spans.map((one) => [one.end, one.kind]), [[1, ""], [1, "failed"], [1001, "retry"], [1001, "done"]]);
  assert.equal(newest_attempt(spans)[0]!.t, 1000);
  const place = axis(spans);
  assert.equal(place(0), 0);
  assert.ok(place(1) > 0.45 && place(1000) < 0.55);
  assert.ok(Math.abs(place(1001) - 1) < 1e-9);
  assert.equal(place(500), place(1), "a time within the pause stands at its beginning");
});

test("a failed boot step says what was expected and found, and what to do", () => {
  const facts = new Map(facts_of({ t: 1, since: 1, step: "failed", error: "M", object: "1018:02", expected: 0x301, received: 0x406 }));
  assert.equal(facts.get("Expected"), "00000301H (769)");
  assert.equal(facts.get("Found"), "00000406H (1030)");
  assert.deepEqual(reason_and_remedy("failed, 0.0 s ago. It reads 5. Check the device, or its entry."), ["failed, 0.0 s ago. It reads 5.", "Check the device, or its entry."]);
});

test("the load of a bus by class is what was busy since the last look", () => {
  const history = new LoadHistory();
  const traffic = (t: number, busy: number): TrafficView => ({ t, event: "traffic", number: 0, bus: "b", classes: [{ class: "PDO", frames: 1, busy }], errors: [], error_frames: [], can_ids: [] });
  history.take(traffic(1, 0.1));
  history.take(traffic(2, 0.35));
  assert.ok(Math.abs(history.loads[0]!.shares[0]! - 0.25) < 1e-9);
  assert.equal(history.top, 0.5);
  assert.equal(history.areas(1).length, 1);
});

test("the last bit of the frame is the one that was wrong in an error frame", () => {
  const fields = fields_of_error([{ level: "d", part: "frame" }, { level: "r", part: "frame" }, { level: "d", part: "error flag" }]);
  assert.deepEqual(fields.map((one) => [one.name, one.bits.map((bit) => bit.wrong)]), [["frame", [false, true]], ["error flag", [false]]]);
});

test("a number is plotted from the state, at most so many, and exported", () => {
  const plots = new Plots();
  assert.ok(plots.toggle("state line1 3 tec", "TEC"));
  plots.take_state({ ...stuck, t: 5 });
  plots.take_state({ ...stuck, t: 5 });
  assert.deepEqual(plots.all[0]!.times, [5]);
  assert.match(plots.csv(), /^time \(s\),name,value\r\n5,"TEC",0\r\n$/);
  for (let i = 1; i < most_plots; ++i) assert.ok(plots.toggle(`words 0 ${i}`, ""));
  assert.equal(plots.toggle("words 0 99", ""), false);
  assert.equal(plots.asked_keys().length, most_plots - 1);
});

test("values of objects are said in words", () => {
  assert.equal(words_of("6041:00", 0x0237), "operation enabled; voltage enabled, remote");
  assert.equal(words_of("6041:00", 0x0008), "fault");
  assert.equal(words_of("1017:00", 500), "every 500 ms");
  assert.equal(words_of("1016:01", 0x00050000), "off");
  assert.equal(words_of("1400:01", 0x80000181), "disabled");
  assert.equal(words_of("2000:00", 1), "");
  assert.equal(transmission_words(3), "at every 3rd SYNC");
  assert.deepEqual(["UNSIGNED16", "INTEGER8", "REAL32", "BOOLEAN", "VISIBLE_STRING"].map(sdo_type), ["u16", "i8", "f32", "bool", "text"]);
});

test("signals of other lengths, or of one node, are refused with the reason", () => {
  const object = (node: number, type: string): ProjectObject => ({ node, object: "6000:01", name: "x", type, access: "rw", value: 0, configured: false });
  assert.equal(refusal(object(1, "UNSIGNED8"), object(2, "INTEGER16")), "8 bits do not fit 16 bits");
  assert.equal(refusal(object(1, "UNSIGNED8"), object(1, "UNSIGNED8")), "both are of one node");
  assert.equal(refusal(object(1, "UNSIGNED8"), object(2, "INTEGER8")), "");
  assert.equal(bits_of("BOOLEAN"), 1);
});

test("a transfer lists what will be written and leaves another device alone", () => {
  const rows = [{ node: 2, object: "1017:00", project: 500, device: 0, state: "different" }, { node: 2, write: "1017:00", state: "would be written" }, { node: 3, object: "1018:02", state: "different" }];
  const plan = plan_of(rows);
  assert.deepEqual(plan.map((row) => [row.node, row.is_to_be_written, row.reason]), [[2, true, undefined], [3, false, "another device, left alone"]]);
});

test("a result says what the device has after the write", () => {
  const results = results_of([{ node: 2, object: "1017:00", name: "Heartbeat" }, { node: 2, write: "1017:00", value: 500, state: "written" }, { node: 2, write: "1800:02", value: 1, state: "refused", reason: "06090030" }]);
  assert.deepEqual(results.map((row) => [row.name, row.device, row.state]), [["Heartbeat", 500, "written"], [undefined, undefined, "refused"]]);
});

test("the mapping of a module's PDO is read and written as the program says it", () => {
  const all = mappable_objects([{ name: "Buffer Memory Area Unsigned8", bits: 8, objects: [[0xa040, 1, "Un\\G13000 LByte"], [0xa040, 2, "Un\\G13000 HByte"]] }]);
  assert.deepEqual(found_objects(all, "g13000 hb").map((one) => one.sub), [2]);
  const mapped = ["A040:01:8 Un\\G13000 LByte", "A040:02:8"].map((one) => parse_mapped(one)!);
  assert.equal(mapping_text(mapped), "A040:01:8 A040:02:8");
  assert.equal(bits_of_all(mapped), 16);
});

test("a project that many events say has changed is read twice at most", async () => {
  let asked = 0;
  const bus = { bus: "line1", project: "net", joins: true, bit_rate: 0, live: false, device_files: [] };
  const project = new Project(bus, async () => { ++asked; await settled(); return { code: 0, rows: [], message: "", command: "", t: 0 }; }, () => undefined);
  await project.load();
  assert.equal(asked, 3);
  for (let i = 0; i < 50; ++i) project.done_by_somebody("canopus project set -- net 3 1017=5");
  await project.load();
  assert.equal(asked, 9);
});
