// What the server sends and takes (docs/events.md, docs/web.md). test/recorded.ts has messages of real runs that are checked against this.

/** What a node is named by. `node` 255: it has no node-ID yet. */
export interface NodeLabel {
  bus: string;
  node: number;
  name: string;
}

export type Controller = "error active" | "error passive" | "bus-off" | "unknown";

export interface TimeFigures {
  count: number;
  least: number;
  mean: number;
  most: number;
}

/** Error control and SDO answers of a node, seconds. */
export interface NodeFigures {
  heartbeat?: { age: number; period: number };
  sdo?: TimeFigures;
}

export interface BusState {
  bus: string;
  link: string;
  bit_rate: number;
  now: number;
  peak: number;
  frames: number;
  error_frames: number;
  gone?: boolean;
  /** The two halves of a bus whose wire is cut, the near one first. */
  cut?: BusHalf[];
}

export interface BusHalf {
  nodes: string[];
  now: number;
  frames: number;
  error_frames: number;
}

/** A node that a bus has shown and that is neither of the plant nor booted by one of its modules. It has no name. */
export interface OutsideNode extends NodeLabel, NodeFigures {
  state: string;
  in_operation: boolean;
}

export interface NodeState extends NodeLabel, NodeFigures {
  module: boolean;
  state: string;
  in_operation: boolean;
  cut_off?: boolean;
  frames: number;
  waiting: number;
  pdos: number;
  emcy: number;
  last_emcy?: string;
  controller: Controller;
  tec: number;
  rec: number;
}

/** As far as they apply. */
export interface BootFields {
  step: string;
  since: number;
  object?: string;
  attempts?: number;
  error?: string;
  abort?: string;
  expected?: number | string;
  received?: number | string;
  reason?: string;
}

export interface SlaveState extends NodeLabel, NodeFigures, BootFields {
  master: number;
  state: string;
  in_operation: boolean;
  identity?: string;
}

export interface Led {
  name: string;
  pattern: string;
  opposite: boolean;
  error: boolean;
}

export interface ModuleState extends NodeLabel {
  plc: string;
  head: number;
  on: boolean;
  cpu: "RUN" | "STOP";
  leds: Led[];
  signals_on: string[];
  model?: string;
  /** It has X and Y. */
  signals?: boolean;
  words: { address: number; value: number; name?: string }[];
}

/** A PLC that has a program. */
export interface ProgramState {
  plc: string;
  state: CpuState;
  error?: string;
}

/** `halted`: in RUN, but no scan begins; `error`: stopped by a run-time error. */
export type CpuState = "run" | "stop" | "pause" | "off" | "halted" | "error";

export interface RunState {
  t: number;
  event: "state";
  plant: string;
  speed: number;
  live: boolean;
  buses: BusState[];
  nodes: NodeState[];
  slaves: SlaveState[];
  outside?: OutsideNode[];
  modules: ModuleState[];
  programs?: ProgramState[];
  troubles: (NodeLabel & { message: string })[];
  forced: (NodeLabel & { object: string; text: string })[];
}

export interface WordRow {
  address: number;
  name: string;
  access: string;
  value: number;
  initial: number;
  section: string;
  low?: number;
  high?: number;
  values?: number[];
  pdo?: string;
  can_id?: string;
  from?: string;
  age?: number;
}

export interface WordsView {
  t: number;
  event: "words";
  number: number;
  module: string;
  from: number;
  of: number;
  rows: WordRow[];
}

export interface ObjectRow {
  object: string;
  name: string;
  of: string;
  type: string;
  access: string;
  hex?: string;
  decimal?: string;
  default_hex?: string;
  default_decimal?: string;
  low?: string;
  high?: string;
  unit?: string;
  tpdo?: boolean;
  rpdo?: boolean;
  bytes?: number;
  text?: string;
  words?: string;
  warning?: string;
}

export interface ObjectsView extends NodeLabel {
  t: number;
  event: "objects";
  number: number;
  from: number;
  of: number;
  rows: ObjectRow[];
}

export interface BootStep extends BootFields {
  t: number;
}

export interface BootsView {
  t: number;
  event: "boots";
  masters: (NodeLabel & { start_up: string })[];
  slaves: (NodeLabel & { master: number; steps: BootStep[] })[];
}

export interface FrameBit {
  level: "d" | "r";
  field: string;
  stuff?: boolean;
  lost?: { name: string; can_id: string; bit: number }[];
}

export interface ErrorFrame {
  at: number;
  error: string;
  field: string;
  bit: number;
  name: string;
  transmitter: boolean;
  finders: number;
  bits?: { level: "d" | "r"; part: string }[];
}

export interface TrafficView {
  t: number;
  event: "traffic";
  number: number;
  bus: string;
  classes: { class: string; frames: number; busy: number }[];
  sync?: TimeFigures;
  errors: { error: string; field: string; count: number }[];
  error_frames: ErrorFrame[];
  can_ids: string[];
  frame?: { can_id: string; at: number; dlc: number; remote?: boolean; data: string; bits: FrameBit[]; lost?: { name: string; can_id: string; bit: number }[] };
}

export interface ErrorsView {
  t: number;
  event: "errors";
  number: number;
  module: string;
  groups: { title: string; lines: { where?: string; code?: string; meaning: string; t?: number }[] }[];
  clear: { offered: boolean; how: string };
  reset: { offered: boolean; how: string };
}

export interface MeaningView {
  t: number;
  event: "meaning";
  object: string;
  meaning: string;
  unit: string;
  source: string;
}

export interface DomainWords {
  heading: string;
  entries: { object: string; name: string; value: string }[];
  problem: string;
  dump: string[];
}

export interface DomainView {
  t: number;
  event: "domain";
  number: number;
  bus: string;
  node: number;
  object: string;
  size: number;
  words?: DomainWords;
  part?: number;
  hex?: string;
}

export interface ValuesView {
  t: number;
  event: "values";
  values: { key: string; value: number | null }[];
}

/** A value that stands in a line of a program, as the language writes it. A device (D100, X10) is no variable: it cannot be written or forced here. */
export interface ProgramValue {
  column: number;
  length: number;
  name: string;
  type: string;
  value: string;
  forced: boolean;
  writable: boolean;
  device?: boolean;
}

export interface ProgramLine {
  text: string;
  /** A break may be set here. */
  code: boolean;
  values: ProgramValue[];
}

/** `file`: place in the files of the program; lines and columns count from 1. */
export interface ProgramPlace {
  file: number;
  line: number;
}

export interface ProgramTask {
  name: string;
  kind: string;
  priority: number;
  programs: string[];
  runs: number;
  every?: number;
  on?: string;
}

export interface ProgramView {
  t: number;
  event: "program";
  plc: string;
  cpu: string;
  state: CpuState;
  halted_at?: ProgramPlace;
  error?: ProgramPlace & { code: number; code_text: string; text: string; column: number; t: number };
  /** Seconds: `period` of plant time from scan to scan; the others are how long the program takes, by estimate. */
  scan: { count: number; period: number; now: number; least: number; most: number };
  breaks: ProgramPlace[];
  forced: { name: string; type: string; value: string }[];
  tasks: ProgramTask[];
  files: string[];
  file: number;
  from: number;
  of: number;
  blocks: string[];
  block?: string;
  lines: ProgramLine[];
}

export interface VariableRow {
  name: string;
  type: string;
  value: string;
  forced: boolean;
  writable: boolean;
  retain: boolean;
  comment: string;
}

export interface VariablesView {
  t: number;
  event: "variables";
  plc: string;
  from: number;
  of: number;
  rows: VariableRow[];
}

export interface Reply {
  t: number;
  event: "reply";
  id: number;
  code?: number;
  message?: string;
  command?: string;
  file?: string;
  more?: boolean;
  rows?: Record<string, unknown>[];
}

export interface Hello extends Reply {
  user: string;
  role: Role;
  version: string;
  armed_for: number;
  offers: string[];
  buses: BusOfCommands[];
  settings: { file: string; model: string; setup: string; plc: string[]; live: boolean }[];
}

export type Role = "look" | "operate" | "configure";

export interface BusOfCommands {
  bus: string;
  project: string;
  joins: boolean;
  bit_rate: number;
  live: boolean;
  device_files: string[];
}

/** A line of the event list. Its fields are of its kind (docs/events.md). */
export interface RunEvent {
  t: number;
  event: string;
  bus?: string;
  node?: number;
  name?: string;
  [field: string]: unknown;
}

export type View = WordsView | ObjectsView | BootsView | TrafficView | ErrorsView | MeaningView | DomainView | ValuesView | ProgramView | VariablesView;
export type ViewKind = View["event"];
export const view_kinds: readonly ViewKind[] = ["words", "objects", "boots", "traffic", "errors", "meaning", "domain", "values", "program", "variables"];
export type ServerEvent = RunState | View | Reply | RunEvent;

/** What is looked at beside the state: {"views": [...]}, at most eight. */
export type ViewWish =
  | { words: number; find: string; from: number; count: number }
  | { objects: number; find: string; from: number; count: number }
  | { boots: true }
  | { traffic: number; can_id?: number; extended?: true }
  | { errors: number }
  | { meaning: string }
  | { domain: number; object: string; part?: number }
  | { values: string[] }
  | { program: string; file: number; from: number; count: number; block?: string }
  | { variables: string; find: string; from: number; count: number };

export interface TraceRow {
  n: number;
  record: number;
  t: number;
  bus: string;
  id: string;
  service: string;
  what: string;
  node?: number;
  name?: string;
  object?: string;
  text: string;
  trouble?: boolean;
  frames?: number;
  duration?: number;
  dlc?: number;
  remote?: boolean;
  data?: string;
}

export interface TraceAnswer {
  records: number;
  forgotten: number;
  lost?: number;
  progress?: number;
  first: number;
  end: number;
  from: number;
  rows: TraceRow[];
}
