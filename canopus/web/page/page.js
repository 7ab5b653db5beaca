// The page of a run. It gets events over a WebSocket (docs/events.md) and shows them; what people do goes to the server as commands. Names come from strangers' files: they become text nodes and attributes, never markup.
import { EventList } from "./event_list.js";
import { key_of, mood_of, message_line, sentence, tell_twins_apart } from "./words.js";
import { Silence } from "./silence.js";
import { keep_children, make, set_text } from "./dom.js";
import { draw_leds, draw_modules } from "./modules.js";
import { WordView } from "./word_view.js";
import { BootView } from "./boot_view.js";
import { BusView } from "./bus_view.js";
import { BusControls } from "./bus_controls.js";
import { Description } from "./description.js";
import { DomainView } from "./domain_view.js";
import { ErrorView } from "./error_view.js";
import { Links } from "./links.js";
import { ObjectView } from "./object_view.js";
import { PaceControls } from "./pace_controls.js";
import { Plots } from "./plots.js";
import { Commands, take_key } from "./commands.js";
import { ProjectView } from "./project_view.js";
import { SettingsView } from "./settings_view.js";
import { StartView } from "./start_view.js";
import { FaultView } from "./fault_view.js";
import { NewestEvents } from "./newest_events.js";
import { NmtControls } from "./nmt_controls.js";
import { TraceView } from "./trace_view.js";
import { Tree } from "./tree.js";
import { has_users, key_of_session } from "./session.js";

const by_id = (id) => document.getElementById(id);
let state = null;
let state_at = 0;
let chosen = null;  // key of the node that is open
let rates = new Map();  // by node: { pdos, t, rate }
const events = new EventList(by_id("events"), by_id("filter"), by_id("event-count"));
const messages = new EventList(by_id("messages"), by_id("message-filter"), by_id("message-count"));
let socket = null;
const silence = new Silence();
let settings_alone = "";  // where the PLC of the settings is, where there is nothing else
let follows = false;
let key = take_key();
const commands = new Commands((message) => {
  if (socket?.readyState !== WebSocket.OPEN) return false;
  socket.send(JSON.stringify(message));
  return true;
});
const project_view = new ProjectView(by_id("project-section"), commands);
const settings_view = new SettingsView(by_id("settings-section"), commands);
const start_view = new StartView(by_id("start-section"), commands);
const fault_view = new FaultView(by_id("faults-section"), by_id("frame-menu"), commands);
const pace_controls = new PaceControls(by_id("pace"), commands);
const bus_controls = new BusControls(commands);
const nmt_controls = new NmtControls(commands);
// The constructors below must not call say_views(): what it uses is declared further down.
const words = new WordView(by_id("words-section"), () => say_views());
const boots = new BootView(by_id("boot-section"), bus_controls, () => say_views());
const plots = new Plots(by_id("plots"), by_id("plot-list"), () => say_views());
const domain = new DomainView(by_id("domain"), () => say_views());
const objects = new ObjectView(by_id("objects-section"), domain, () => say_views());
const errors = new ErrorView(by_id("modules"), commands, () => say_views());
const bus_view = new BusView(by_id("bus-section"), () => say_views());
const newest = new NewestEvents(by_id("newest"));
const description = new Description(() => say_views());
description.follow(by_id("objects-table"), (line) => objects.described(line));
description.follow(by_id("words-table"), (line) => words.described(line));
description.follow(by_id("project-objects"), (line) => project_view.described(line));
// "#objects/N": state.nodes and the view "objects" count the modules first, then the devices.
const trace_view = new TraceView(commands, (frame, x, y) => fault_view.open_menu(frame, x, y), (bus, node) => {
  const place = state?.nodes.findIndex((one) => one.bus === bus && one.node === node) ?? -1;
  return place < 0 ? null : `#objects/${place}`;
});
const places = new Links({ trace: trace_view, project: project_view, settings: settings_view, words, objects, bus: bus_view, boots: { open: () => boots.is_open || by_id("show-boots").click() } },
                        [by_id("words-base"), by_id("objects-base")]);

const tree = new Tree(by_id("tree"), (key) => open_node(key));

const label_of = (node) => node.name || (node.node >= 1 && node.node <= 127 ? `Node ${node.node}` : "Node");
const id_of = (node) => (node.node >= 1 && node.node <= 127 ? String(node.node) : "-");

function slave_of(node) {
  return state.slaves.find((slave) => slave.bus === node.bus && slave.node === node.node);
}

function troubles_of(node) {
  const lines = state.troubles.filter((one) => key_of(one) === key_of(node)).map((one) => one.message);
  const slave = slave_of(node);
  if (slave && slave.reason && slave.step !== "booted") lines.unshift(slave.reason);
  if (node.cut_off) lines.unshift("cut off from its bus");
  return lines;
}

/// Nodes of the plant, and slaves that a module boots but the plant does not have.
function nodes_of(bus) {
  const own = state.nodes.filter((node) => node.bus === bus);
  const known = new Set(own.map((node) => node.node));
  const foreign = state.slaves.filter((slave) => slave.bus === bus && !known.has(slave.node)).map((slave) => ({
    ...slave, foreign: true, pdos: 0, emcy: 0, tec: 0, rec: 0, controller: "error active",
  }));
  return [...own, ...foreign];
}

/// PDOs a second, frames a second, and their share of those on the bus, over a second or so; null: not known yet.
function rates_of(node) {
  const key = key_of(node);
  const before = rates.get(key);
  if (before && state.t - before.t < 1) return before;
  const on_bus = state.buses.find((bus) => bus.bus === node.bus)?.frames ?? 0;
  const span = before ? state.t - before.t : 0;
  const rate = (name) => (span > 0 ? (node[name] - before[name]) / span : null);
  const now = { pdos: node.pdos, frames: node.frames, on_bus, t: state.t, pdo_rate: rate("pdos"), frame_rate: rate("frames"),
    share: span > 0 && on_bus > before.on_bus ? (node.frames - before.frames) / (on_bus - before.on_bus) : null };
  rates.set(key, now);
  return now;
}

const percent_of = (share) => (share === null ? "-" : `${(100 * share).toFixed(1)} %`);
/// Seconds as people say them.
const time_text = (seconds) => (seconds >= 1 ? `${seconds.toFixed(1)} s` : seconds >= 0.001 ? `${(1000 * seconds).toFixed(1)} ms` : `${Math.round(1e6 * seconds)} µs`);
const is_late = (beat) => beat && beat.period > 0 && beat.age > 1.5 * beat.period;

function figures_of(node) {
  const { pdo_rate } = rates_of(node);
  const parts = [`${pdo_rate === null ? "-" : Math.round(pdo_rate)} PDO/s`, `TEC ${node.tec}`, `REC ${node.rec}`];
  if (slave_of(node)?.identity) parts.push("identity ✓");
  if (is_late(node.heartbeat)) parts.unshift(`no heartbeat for ${time_text(node.heartbeat.age)}`);
  if (node.controller !== "error active") parts.unshift(node.controller);
  if (node.last_emcy) parts.push(`EMCY ${node.last_emcy}H ×${node.emcy}`);
  return parts.join(" · ");
}

function make_node(key) {
  const button = make("button", { type: "button" }, make("b"), make("span", { class: "state" }),
                      make("span", { class: "figures" }), make("span", { class: "reason" }));
  button.addEventListener("click", () => open_node(key));
  return make("li", {}, button);
}

function make_bus(name) {
  const bar = make("svg:svg", { class: "load", viewBox: "0 0 100 8", preserveAspectRatio: "none", role: "img" },
                   make("svg:rect", { x: 0, y: 0, height: 8, width: 0 }), make("svg:line", { y1: 0, y2: 8, x1: 0, x2: 0 }));
  return make("div", { class: "bus" },
              make("header", {}, make("h3", {}, make("a", { href: `#bus/${state.buses.findIndex((one) => one.bus === name)}` }, name)), make("span", { class: "faint" }), bar, make("button", { type: "button", class: "share number", title: `Plot the load of ${name} in %`, "data-plot": `bus ${name} now`, "data-name": `load of ${name} in %` })),
              nmt_controls.make(name, "all", `all nodes of ${name}`), bus_controls.make(name),
              make("ul", { class: "nodes", "aria-label": `Nodes of ${name}` }));
}

function fill_bus(element, bus) {
  const [, facts, bar, share] = element.firstElementChild.children;
  facts.classList.toggle("bad", Boolean(bus.gone));
  set_text(facts, `${bus.gone ? "GONE: nothing is heard and sent · " : ""}${bus.bit_rate / 1000} kbit/s · ${bus.link === "sim" ? "simulated" : bus.link} · ${bus.frames} frames · ` +
                  `${bus.error_frames} error frames`);
  const percent = (value) => `${(100 * value).toFixed(1)} %`;
  bar.firstElementChild.setAttribute("width", 100 * bus.now);
  for (const side of ["x1", "x2"]) bar.lastElementChild.setAttribute(side, 100 * bus.peak);
  bar.setAttribute("aria-label", `Load of ${bus.bus}: ${percent(bus.now)}, peak ${percent(bus.peak)}`);
  set_text(share, `load ${percent(bus.now)}, peak ${percent(bus.peak)}`);
  keep_children(element.lastElementChild, nodes_of(bus.bus), key_of, make_node, fill_node);
}

function fill_node(item, node) {
  const button = item.firstElementChild;
  const [name, shown, figures, reason] = button.children;
  const trouble = troubles_of(node);
  button.dataset.mood = mood_of(node, trouble);
  set_text(name, `${id_of(node)}  ${label_of(node)}`);
  set_text(shown, node.state);
  set_text(figures, node.foreign ? "not of this plant" : figures_of(node));
  set_text(reason, trouble[0] ?? "");
}

function find_node(key) {
  for (const bus of state.buses) {
    const found = nodes_of(bus.bus).find((node) => key_of(node) === key);
    if (found) return found;
  }
  return null;
}

function open_node(key) {
  chosen = key;
  draw_node();
  by_id("node-title").focus();
}

/// NMT commands to the open node; made anew for another one alone, so that what was said of the last one stays.
function draw_node_ways(node) {
  const place = by_id("node-nmt");
  if (place.dataset.key === chosen) return;
  place.dataset.key = chosen;
  const has_id = node.node >= 1 && node.node <= 127;
  const words = [node.bus, String(node.node), `${node.bus} node ${node.node}`];
  place.replaceChildren(...(has_id ? [nmt_controls.make(...words), bus_controls.make_sdo(...words)] : []));
}

function draw_node() {
  const node = chosen === null ? null : find_node(chosen);
  by_id("node").hidden = node === null;
  if (!node) return;
  draw_node_ways(node);
  set_text(by_id("node-title"), `${node.bus} node ${id_of(node)}: ${label_of(node)}`);
  const slave = slave_of(node);
  const forced = state.forced.filter((one) => key_of(one) === key_of(node)).map((one) => one.text);
  const has_id = node.node >= 1 && node.node <= 127;  // figures are plotted by node-ID
  const number = (name, value) => has_id ? { key: `state ${node.bus} ${node.node} ${name}`, value } : String(value);
  const rows = [...troubles_of(node).map((line) => ["Why", line]), ["NMT state", node.state]];
  // Of a device that is not of this plant nobody sees the controller.
  if (!node.foreign) rows.push(["Controller", node.controller], ["TEC", number("tec", node.tec)], ["REC", number("rec", node.rec)], ["PDOs sent", number("pdos", node.pdos)], ["Emergencies", number("emcy", node.emcy)]);
  if (node.last_emcy) rows.push(["Last emergency", `${node.last_emcy}H`]);
  const rates_now = node.foreign ? null : rates_of(node);
  if (rates_now) rows.push(["Frames sent", number("frames", node.frames)], ["Frames a second", rates_now.frame_rate === null ? "-" : `${Math.round(rates_now.frame_rate)}, ${percent_of(rates_now.share)} of those on the bus`]);
  if (node.heartbeat) rows.push(["Heartbeat", `${time_text(node.heartbeat.age)} ago${node.heartbeat.period ? `, every ${time_text(node.heartbeat.period)}` : ""}`]);
  if (node.sdo) rows.push(["SDO answers", `${node.sdo.count}, after ${time_text(node.sdo.least)} to ${time_text(node.sdo.most)}, ${time_text(node.sdo.mean)} in the mean`]);
  if (slave?.identity) rows.push(["Identity", `✓ ${slave.identity}`]);
  if (slave) rows.push(["Boot", `${slave.step}, since ${slave.since} s, by node ${slave.master}`]);
  for (const line of forced) rows.push(["Forced", line]);
  const body = by_id("node-body");
  const text = JSON.stringify(rows);
  if (body.dataset.text === text) return;  // a selection in it stays
  body.dataset.text = text;
  const place = state.nodes.findIndex((one) => key_of(one) === chosen);
  const ways = [make("a", { href: "#boots" }, "Boots")];
  if (place >= 0) ways.unshift(make("a", { href: `#objects/${place}` }, "Objects"));
  body.replaceChildren(make("p", { class: "ways" }, ...ways), make("table", {}, make("tbody", {}, ...rows.map(([name, value]) =>
    make("tr", {}, make("th", { scope: "row" }, name), make("td", {}, value?.key === undefined ? value :
      make("button", { type: "button", class: "number", "data-plot": value.key, "data-name": `${name} of ${label_of(node)}`, title: `Plot ${name} of ${label_of(node)}` }, String(value.value))))))));
}

function draw() {
  document.title = `${state.plant} – Canopus`;
  set_text(by_id("plant"), state.plant);
  const links = state.buses.filter((bus) => bus.link !== "sim").map((bus) => bus.link);
  const gone = state.buses.filter((bus) => bus.gone).map((bus) => bus.bus);
  set_text(by_id("where"), gone.length ? `${state.live ? "LIVE" : "REPLAY"} ${links.join(", ")} GONE` : settings_alone ? `LIVE PLC ${settings_alone}` : state.live ? `LIVE ${links.join(", ")}` : links.length ? `REPLAY ${links.join(", ")}` : `SIMULATED${pace_controls.draw(state)}`);
  by_id("bar").className = state.live || settings_alone ? "live" : "simulated";
  const all = state.buses.flatMap((bus) => nodes_of(bus.bus));
  set_text(by_id("operation"), `${all.filter((node) => node.in_operation && mood_of(node, troubles_of(node)) !== "error").length} of ${all.length}`);
  const moods = ["error", "warning"];
  const worst = moods.map((mood) => all.find((node) => mood_of(node, troubles_of(node)) === mood)).find(Boolean);
  // A node that is off is meant to be, but it is not well.
  const off = all.filter((node) => node.state === "off").length;
  set_text(by_id("worst"), gone.length ? `bus ${gone[0]} is gone` : worst ? `${id_of(worst)} ${label_of(worst)}: ${troubles_of(worst)[0] ?? worst.state}` : all.length === 0 ? "no node is known" : off ? `${off} off` : "all well");
  for (const id of ["plant", "worst"]) if (by_id(id).title !== by_id(id).textContent) by_id(id).title = by_id(id).textContent;
  keep_children(by_id("buses"), state.buses, (bus) => bus.bus, make_bus, fill_bus);
  draw_modules(by_id("modules"), state.modules, keep_children, key_of, (number, name) => words.open(number, name), errors);
  draw_node();
  tree.draw(state, { keep_children, nodes_of, key_of, name_of: (node) => `${id_of(node)}  ${label_of(node)}`, mood_of: (node) => mood_of(node, troubles_of(node)) });
  bus_view.draw_counters(state);
  trace_view.set_buses(state.buses.length);
  plots.state(state);
  places.state(state);
}

const plant_now = () => state.t + state.speed * (performance.now() - state_at) / 1000;

function animate() {
  if (socket?.readyState === WebSocket.OPEN && silence.has_changed()) {
    set_text(by_id("connection"), silence.is_on ? "The run does not answer. What is shown here is old." : "");
    if (silence.is_on) by_id("bar").className = "waiting";
    if (silence.is_on) set_text(by_id("where"), "NO ANSWER");
  }
  if (state && !by_id("bar").classList.contains("waiting")) {
    set_text(by_id("time"), `${plant_now().toFixed(1)} s`);
    draw_leds(by_id("modules"), Math.floor(plant_now() * 1000));
  }
  requestAnimationFrame(animate);
}

function received(list) {
  silence.ends();
  for (const event of list) {
    if (event.event === "state") {
      state = event;
      tell_twins_apart(state.nodes);
      state_at = performance.now();
    } else if (event.event === "messages") {
      if (event.left_out) messages.add({ t: event.t, event: "lost" }, `${event.left_out} frames were left out: more than can be shown`);
      for (const message of event.messages) messages.add({ t: message.time, event: message.service }, message_line(message), { bus: message.channel, id: message.id });
      messages.draw();
    } else if (event.event === "words") {
      words.draw(event);
    } else if (event.event === "objects") {
      objects.draw(event);
    } else if (event.event === "domain") {
      domain.draw(event);
    } else if (event.event === "errors") {
      errors.draw(event);
    } else if (event.event === "values") {
      plots.values(event);
    } else if (event.event === "meaning") {
      description.draw(event);
    } else if (event.event === "traffic") {
      bus_view.draw(event);
    } else if (event.event === "reply") {
      commands.received(event);
    } else if (event.event === "boots") {
      boots.draw(event, keep_children);
    } else if (event.event !== "load") {
      if (event.event === "audit" && event.code < 7) for (const view of [project_view, settings_view]) view.done_by_somebody(event.do);
      const text = sentence(event);
      events.add(event, text);
      newest.add(event, text);
    }
  }
  if (state) draw();
  events.draw();
  newest.draw();
}

/// Who one is here, and what there is to work on.
function greeted(hello) {
  if (hello.code !== 0) return;
  by_id("arm").hidden = hello.role === "look" || ![...hello.buses, ...hello.settings].some((one) => one.live);
  draw_armed(hello.armed_for);
  set_text(by_id("role"), hello.user ? `${hello.user}, ${hello.role}` : hello.role);
  set_text(by_id("about-version"), hello.version);
  start_view.greeted(hello);
  fault_view.greeted(hello);
  nmt_controls.greeted(hello);
  bus_controls.greeted(hello);
  pace_controls.greeted(hello);
  errors.greeted(hello);
  const projects = project_view.greeted(hello);
  const settings = settings_view.greeted(hello);
  // A module's settings and its PLC: there is neither a plant nor a bus.
  settings_alone = hello.buses.length === 0 ? settings_view.place_of_plc : "";
  document.body.classList.toggle("settings-alone", settings_alone !== "");
  document.body.classList.toggle("no-plant", settings_alone !== "" || !by_id("start-section").hidden);
  if (settings_alone) for (const section of document.querySelectorAll("main > section")) section.hidden = section.id !== "settings-section";
  places.projects(projects, settings);
  tree.draw_projects(projects, settings, keep_children);
}

/// What writes on a live bus is done only as long as somebody has armed it.
let armed_until = 0;
function draw_armed(seconds) {
  armed_until = performance.now() + 1000 * seconds;
  const is_armed = seconds > 0;
  by_id("arm").setAttribute("aria-pressed", is_armed);
  set_text(by_id("arm"), is_armed ? `Writes are armed, ${Math.ceil(seconds / 60)} min` : "Arm writes");
}
setInterval(() => {
  if (armed_until > 0) draw_armed(Math.max(0, (armed_until - performance.now()) / 1000));
}, 1000);
by_id("arm").addEventListener("click", async () => {
  const done = await commands.run({ command: "arm", on: by_id("arm").getAttribute("aria-pressed") !== "true" });
  if (done.code === 0) draw_armed(done.armed_for);
});

async function connect() {
  if (has_users) key = await key_of_session();
  socket = new WebSocket(`${location.protocol.replace("http", "ws")}//${location.host}/events${key ? `?key=${key}` : ""}`);
  socket.addEventListener("open", () => {
    silence.ends();
    events.clear();  // the server sends the latest ones again
    rates = new Map();
    views_said = "[]";
    set_text(by_id("connection"), "");
    if (follows) say_wish();
    say_views();
    commands.run({ command: "hello" }).then(greeted);
  });
  socket.addEventListener("message", (message) => received(JSON.parse(message.data)));
  socket.addEventListener("close", () => {
    commands.lost();
    by_id("bar").className = "waiting";
    set_text(by_id("where"), "NOT CONNECTED");
    set_text(by_id("connection"), "The run has ended, or does not answer. What is shown here is old.");
    setTimeout(connect, 2000);
  });
}

/// The server decodes frames only for who wants to see them.
function say_wish() {
  if (socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ messages: follows }));
}

/// What is looked at beside the state, at most ten times a second.
let views_timer = null;
let views_said = "[]";
function say_views() {
  if (views_timer !== null) return;
  views_timer = setTimeout(() => {
    views_timer = null;
    const views = JSON.stringify([words.view, boots.view, objects.view, bus_view.view, plots.view, description.view, errors.view, domain.view].filter(Boolean));
    if (views === views_said || socket?.readyState !== WebSocket.OPEN) return;
    views_said = views;
    socket.send(`{"views":${views}}`);
  }, 100);
}

by_id("follow").addEventListener("click", () => {
  follows = !follows;
  set_text(by_id("follow"), follows ? "Stop following" : "Follow");
  say_wish();
});

function close_node() {
  const key = chosen;
  chosen = null;
  draw_node();
  [...document.querySelectorAll(".nodes li")].find((item) => item.dataset.key === key)?.firstElementChild.focus();
}

/// What if this frame were lost?
by_id("messages").addEventListener("contextmenu", (event) => {
  const line = event.target.closest(".event");
  if (line?.dataset.id && fault_view.open_menu({ bus: line.dataset.bus, id: line.dataset.id }, event.clientX, event.clientY)) event.preventDefault();
});

by_id("close-node").addEventListener("click", close_node);
document.addEventListener("keydown", (event) => {
  if (event.key === "Escape" && chosen !== null) close_node();
  else if (event.key === "Escape" && words.view) words.close();
  if (event.key === "/" && event.target === document.body) {
    event.preventDefault();
    by_id("filter").focus();
  }
});
plots.restore();
connect();
requestAnimationFrame(animate);
