// The nodes of a bus, how well each is, and what is wrong with it.
import type { NodeFigures, NodeLabel, NodeState, OutsideNode, RunState, SlaveState } from "./protocol.js";

/** In kbit/s: those of CiA 301, and 100. */
export const bit_rates = [10, 20, 50, 100, 125, 250, 500, 800, 1000];

/** A node of the plant, a slave that a module boots but that the plant file does not have, or a node of a live bus. */
export interface ShownNode extends NodeFigures {
  bus: string;
  node: number;
  name: string;
  key: string;
  state: string;
  in_operation: boolean;
  own: NodeState | null;
  slave: SlaveState | null;
  /** What a live bus has shown of it. */
  outside: OutsideNode | null;
  /** Place in `state.nodes`, which the view `objects` counts by; -1: none. */
  place: number;
  troubles: string[];
  mood: Mood;
  rates: Rates | null;
}

/** The state of a node of the project that the bus has not shown. */
export const not_seen = "not seen";

export type Mood = "good" | "warning" | "error" | "off";
export const moods: readonly Mood[] = ["error", "warning", "off", "good"];

export const has_id = (node: { node: number }): boolean => node.node >= 1 && node.node <= 127;
export const label_of = (node: { node: number; name: string }): string => node.name || (has_id(node) ? `Node ${node.node}` : "no node-ID");
export const id_of = (node: { node: number }): string => (has_id(node) ? String(node.node) : "–");

/** A node of a project on a live bus, whether it was seen or not. */
export type ProjectLabel = NodeLabel;

/** `twin`: how many of the same bus, node-ID and name stand before it; devices without a node-ID often share a name. */
const key_of = (node: { bus: string; node: number; name: string }, twin = 0): string => [node.bus, node.node, node.name, ...(twin ? [twin] : [])].join("/");

function troubles_of(state: RunState, own: NodeState | null, slave: SlaveState | null): string[] {
  const lines: string[] = [];
  if (own?.cut_off) lines.push("cut off from its bus");
  if (own?.controller === "bus-off") lines.push("bus-off: it sends and receives nothing");
  if (slave?.reason && (slave.step !== "booted" || (own !== null && !slave.error && own.state !== "operational"))) lines.push(slave.reason);
  if (own) lines.push(...state.troubles.filter((one) => one.bus === own.bus && one.node === own.node && one.name === own.name).map((one) => one.message));
  return lines;
}

export const is_late = (beat: { age: number; period: number } | undefined): boolean => beat !== undefined && beat.period > 0 && beat.age > 1.5 * beat.period;

function warnings_of(own: NodeState | null, slave: NodeFigures | null): string[] {
  const lines: string[] = [];
  if (own?.controller === "error passive") lines.push(`error passive, TEC ${own.tec}, REC ${own.rec}`);
  const beat = own?.heartbeat ?? slave?.heartbeat;
  if (beat && is_late(beat)) lines.push(`no heartbeat for ${seconds_text(beat.age)}`);
  return lines;
}

function mood_of(own: NodeState | null, slave: { in_operation: boolean } | null, errors: number, warnings: number): Mood {
  if (errors > 0) return "error";
  if (own?.state === "off") return "off";
  if (warnings > 0 || !(own ?? slave)?.in_operation) return "warning";
  return "good";
}

/** Of all buses, in the order of the state; behind the plant's nodes the slaves that are not of the plant, and the nodes of live buses with the names of their projects. */
export function nodes_of(state: RunState, rates: ReadonlyMap<string, Rates> = new Map(), projects: readonly ProjectLabel[] = []): ShownNode[] {
  const twins = new Map<string, number>();
  const shown: ShownNode[] = [];
  const add = (own: NodeState | null, slave: SlaveState | null, place: number, outside: OutsideNode | null = null): void => {
    const label = own ?? slave ?? outside;
    if (!label) return;
    const plain = key_of(label);
    const twin = twins.get(plain) ?? 0;
    twins.set(plain, twin + 1);
    const key = key_of(label, twin);
    const errors = troubles_of(state, own, slave);
    const warnings = warnings_of(own, slave ?? outside);
    const heartbeat = label.heartbeat;
    const sdo = label.sdo;
    shown.push({ bus: label.bus, node: label.node, name: label.name, key, state: label.state, in_operation: label.in_operation, own, slave, outside, place,
      troubles: [...errors, ...warnings], mood: mood_of(own, slave ?? outside, errors.length, warnings.length), rates: rates.get(key) ?? null,
      ...(heartbeat ? { heartbeat } : {}), ...(sdo ? { sdo } : {}) });
  };
  const slave_of = (bus: string, node: number): SlaveState | null => state.slaves.find((one) => one.bus === bus && one.node === node) ?? null;
  state.nodes.forEach((node, place) => add(node, slave_of(node.bus, node.node), place));
  const known = new Set(state.nodes.map((node) => `${node.bus}/${node.node}`));
  for (const slave of state.slaves) if (!known.has(`${slave.bus}/${slave.node}`)) add(null, slave, -1);
  const of_project = (node: NodeLabel): ProjectLabel | undefined => projects.find((one) => one.bus === node.bus && one.node === node.node);
  for (const node of state.outside ?? []) {
    add(null, null, -1, { ...node, name: node.name || (of_project(node)?.name ?? "") });
    known.add(`${node.bus}/${node.node}`);
  }
  for (const node of projects) if (!known.has(`${node.bus}/${node.node}`) && !state.slaves.some((one) => one.bus === node.bus && one.node === node.node)) add(null, null, -1, { ...node, state: not_seen, in_operation: false });
  return shown;
}

/** The trouble that is to be read first: the state of a bus, then errors, then warnings; null: none. */
export function worst_of(state: RunState, nodes: readonly ShownNode[]): { text: string; node: ShownNode | null } | null {
  const gone = state.buses.find((bus) => bus.gone);
  if (gone) return { text: `bus ${gone.bus} is gone`, node: null };
  for (const mood of ["error", "warning"] as const) {
    const node = nodes.find((one) => one.mood === mood);
    if (node) return { text: `${id_of(node)} ${label_of(node)}: ${node.troubles[0] ?? `${node.state}, not started`}`, node };
  }
  return null;
}

export interface Rates {
  t: number;
  frames: number;
  pdos: number;
  on_bus: number;
  frame_rate: number | null;
  pdo_rate: number | null;
  share: number | null;
}

/** Frames and PDOs a second, over a second or so. */
export function next_rates(before: ReadonlyMap<string, Rates>, state: RunState): Map<string, Rates> {
  const rates = new Map<string, Rates>();
  for (const { key, own } of nodes_of(state)) {
    if (!own) continue;
    const last = before.get(key);
    if (last && state.t - last.t < 1 && state.t >= last.t) {
      rates.set(key, last);
      continue;
    }
    const on_bus = state.buses.find((bus) => bus.bus === own.bus)?.frames ?? 0;
    const span = last ? state.t - last.t : 0;
    rates.set(key, { t: state.t, frames: own.frames, pdos: own.pdos, on_bus,
      frame_rate: last && span > 0 ? (own.frames - last.frames) / span : null,
      pdo_rate: last && span > 0 ? (own.pdos - last.pdos) / span : null,
      share: last && on_bus > last.on_bus ? (own.frames - last.frames) / (on_bus - last.on_bus) : null });
  }
  return rates;
}

/** "1.5 s", "12.3 ms", "85 µs". */
export function seconds_text(seconds: number): string {
  if (seconds >= 1) return `${seconds.toFixed(1)} s`;
  if (seconds >= 0.001) return `${(1000 * seconds).toFixed(1)} ms`;
  return `${Math.round(1e6 * seconds)} µs`;
}

export const percent_text = (share: number): string => `${(100 * share).toFixed(1)} %`;
/** "1 frame", "2 frames". */
export const count_text = (count: number, one: string, many = `${one}s`): string => `${count} ${count === 1 ? one : many}`;
