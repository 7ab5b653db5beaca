import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import path from "node:path";
import { test } from "node:test";
import { where_of } from "../src/frame/where.js";
import { nodes_of, worst_of } from "../src/store/nodes.js";
import type { RunEvent, RunState, ServerEvent } from "../src/store/protocol.js";
import { event_kinds, event_mood, sentence } from "../src/store/sentences.js";
import { Store } from "../src/store/store.js";
import { recorded_events, recorded_views } from "./recorded.js";

const recorded_state = (plant: string): RunState => structuredClone(recorded_views.find((one) => one.event === "state" && one.plant === plant)) as RunState;
const stuck = (): RunState => recorded_state("stuck slaves");

test("each event that docs/events.md lists for a run has a sentence", () => {
  const docs = readFileSync(path.join(process.env["PAGE_SOURCE"] ?? "", "../../../docs/events.md"), "utf8");
  const listed = [...(docs.split("The [page in the browser]")[0] ?? "").matchAll(/^\| `([a-z ]+)` \|/gm)].map((found) => found[1]!);
  assert.ok(listed.length > 15);
  for (const kind of listed.filter((one) => one !== "load")) assert.ok(event_kinds.includes(kind), `no sentence for ${kind}`);
});

test("the store shows what a recorded run sent", () => {
  const store = new Store();
  store.opened(0);
  store.receive([...recorded_views, ...recorded_events] as ServerEvent[], 10);
  assert.equal(store.connection, "open");
  assert.ok(store.state);
  assert.ok(store.view("words")!.rows.length > 0);
  assert.ok(store.view("boots")!.slaves.length > 0);
  assert.equal(store.view("meaning")!.object, "1017:00");
  assert.ok(store.events.length > 0);
  assert.ok(store.events.every((line) => line.text.length > 0 && !line.text.includes("undefined")));
});

test("a node whose boot failed is in trouble with its reason, and an external node is known", () => {
  const nodes = nodes_of(stuck());
  const encoder = nodes.find((node) => node.node === 3)!;
  assert.equal(encoder.mood, "error");
  assert.match(encoder.troubles[0]!, /product code differs/);
  const missing = nodes.find((node) => node.node === 9)!;
  assert.equal(missing.own, null);
  assert.equal(missing.place, -1);
});

test("the worst trouble is said in words, not as an NMT state", () => {
  const state = stuck();
  assert.match(worst_of(state, nodes_of(state))!.text, /^3 encoder: failed \(M, product code differs/);
});

test("an error passive node is a warning that names its counters", () => {
  const state = recorded_state("five modules");
  Object.assign(state.nodes[0]!, { controller: "error passive", tec: 130, rec: 2 });
  const [node] = nodes_of(state);
  assert.equal(node!.mood, "warning");
  assert.equal(node!.troubles[0], "error passive, TEC 130, REC 2");
});

test("a bus that is gone is the worst trouble", () => {
  const state = stuck();
  state.buses[0]!.gone = true;
  assert.equal(worst_of(state, nodes_of(state))!.text, "bus line1 is gone");
});

test("twins of one bus, node-ID and name have keys of their own", () => {
  const state = stuck();
  state.nodes = [state.nodes[1]!, structuredClone(state.nodes[1]!)];
  state.slaves = [];
  const [first, second] = nodes_of(state);
  assert.notEqual(first!.key, second!.key);
});

test("a trouble that comes again is counted, whatever it measures, and stands first", () => {
  const store = new Store();
  const late = (t: number, by: string): RunEvent => ({ t, event: "error", source: "real time", message: `the plant is ${by} ms late` });
  store.receive([late(1, "10.5"), { t: 2, event: "warning", source: "plant.toml:1:1", message: "something" }, late(3, "99.1")], 0);
  assert.equal(store.troubles.length, 2);
  assert.deepEqual([store.troubles[0]!.count, store.troubles[0]!.first, store.troubles[0]!.last], [2, 1, 3]);
  assert.match(store.troubles[0]!.text, /99.1/);
});

test("events are kept up to a number, and the newest stay", () => {
  const store = new Store();
  for (let i = 0; i < 22_000; i += 1000) store.receive(Array.from({ length: 1000 }, (_, k): RunEvent => ({ t: i + k, event: "boot", bus: "b", node: 1 })), 0);
  assert.ok(store.events.length <= 21_000);
  assert.equal(store.events.at(-1)!.t, 21_999);
});

test("a run that says nothing for three seconds is silent until it says something", () => {
  const store = new Store();
  store.opened(0);
  store.receive([stuck()], 100);
  store.look_at_clock(3000);
  assert.equal(store.connection, "open");
  store.look_at_clock(3200);
  assert.equal(store.connection, "silent");
  assert.equal(where_of(store).text, "NO ANSWER");
  store.receive([stuck()], 3300);
  assert.equal(store.connection, "open");
});

test("plant time goes on with its speed, and stands when the run is silent", () => {
  const store = new Store();
  store.opened(0);
  store.receive([{ ...stuck(), t: 10, speed: 2 }], 1000);
  assert.equal(store.plant_time(2000), 12);
  store.closed();
  assert.equal(store.plant_time(5000), 10);
});

test("the bar says SIMULATED with the speed, PAUSED, LIVE with the bus, REPLAY", () => {
  const store = new Store();
  store.opened(0);
  const with_state = (change: (state: RunState) => void): string => {
    const state = stuck();
    change(state);
    store.receive([state], 0);
    return where_of(store).text;
  };
  assert.equal(with_state((state) => { state.speed = 1; }), "SIMULATED ×1");
  assert.equal(with_state((state) => { state.speed = 37; }), "SIMULATED ×37");
  assert.equal(with_state((state) => { state.speed = 0; }), "SIMULATED PAUSED");
  assert.equal(with_state((state) => { state.live = true; state.buses[0]!.link = "socketcan:can0"; }), "LIVE can0");
  assert.equal(with_state((state) => { state.live = true; state.buses[0]!.link = "socketcan:can0"; state.buses[0]!.gone = true; }), "LIVE can0 GONE");
  assert.equal(with_state((state) => { state.buses[0]!.link = "trace.log"; }), "REPLAY");
});

test("writes are disarmed when their time is over", () => {
  const store = new Store();
  store.set_armed(600, 0);
  store.look_at_clock(599_000);
  assert.ok(store.armed_until > 0);
  store.look_at_clock(600_000);
  assert.equal(store.armed_until, 0);
});

test("rates of a node are over a second, and none without two states", () => {
  const store = new Store();
  const [first, second] = [stuck(), stuck()];
  Object.assign(first, { t: 1 });
  Object.assign(second, { t: 2 });
  second.nodes[0]!.frames = first.nodes[0]!.frames + 50;
  second.nodes[0]!.pdos = first.nodes[0]!.pdos + 20;
  second.buses[0]!.frames = first.buses[0]!.frames + 200;
  store.receive([first], 0);
  assert.equal(store.nodes[0]!.rates!.frame_rate, null);
  store.receive([second], 1000);
  assert.deepEqual([store.nodes[0]!.rates!.frame_rate, store.nodes[0]!.rates!.pdo_rate, store.nodes[0]!.rates!.share], [50, 20, 0.25]);
});

test("what people did is a sentence with how it ended and by whom", () => {
  const audit = (fields: Record<string, unknown>): RunEvent => ({ t: 0, event: "audit", user: "", role: "configure", address: "127.0.0.1:5", ...fields });
  assert.equal(sentence(audit({ do: '{"command":"pace","speed":0}', code: 0 })), "plant time paused: done; by 127.0.0.1:5 (configure)");
  assert.equal(sentence(audit({ do: "canopus nmt start 3", code: 8, user: "anna" })), "canopus nmt start 3: refused, writes are not armed; by anna (configure)");
  assert.equal(event_mood(audit({ do: "arm", code: 0 })), "");
  assert.equal(event_mood(audit({ do: "arm", code: 7 })), "error");
});

test("an event of a newer program is shown by its fields", () => {
  assert.equal(sentence({ t: 1, event: "new thing", bus: "line1", node: 3, name: "drive", speed: 7 }), "new thing: line1, node 3 (drive), speed 7");
});
