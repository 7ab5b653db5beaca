// A project of a bus as the program's own commands show and change it (docs/project.md), and what its devices were found to have.
import type { Command, Done } from "./commands.js";
import { Once } from "./once.js";
import type { BusOfCommands } from "./protocol.js";

export interface ProjectNode {
  node: number;
  name: string;
  present: boolean;
  file?: string;
  product?: string;
  vendor?: string;
  vendor_id?: number;
  product_code?: number;
  revision?: number;
  serial?: number;
  note?: string;
  tpdos?: number;
  rpdos?: number;
}

export interface ProjectNetwork {
  network: string;
  file: string;
  bit_rate: number;
  load: number;
  load_at_most: number;
}

export interface Mapped {
  bit: number;
  bits: number;
  object?: string;
  name?: string;
  to?: { node: number; object: string }[];
  from?: { node: number; object: string }[];
}

export interface Pdo {
  node: number;
  pdo: string;
  active: boolean;
  can_id: number;
  transmission_type: number;
  bytes: number;
  inhibit_us?: number;
  event_ms?: number;
  mapping: Mapped[];
}

export interface ProjectObject {
  node: number;
  object: string;
  name: string;
  type: string;
  access: string;
  value: number | string | null;
  configured: boolean;
  low?: number;
  high?: number;
  unit?: string;
  default?: number | string | null;
  tpdo?: boolean;
  rpdo?: boolean;
}

/** A value of diff, write and read. */
export interface FoundValue {
  node: number;
  object: string;
  name?: string;
  project?: unknown;
  device?: unknown;
  state: string;
  reason?: string;
}

export interface NodeFound {
  state: string;
  values?: number;
  differ?: number;
  reason?: string;
}

export interface Finding {
  severity: "error" | "warning" | "note";
  node?: number;
  message: string;
}

type Row = Record<string, unknown>;

/** Of diff and write: what a device says of itself otherwise than the project. */
export const is_identity = (row: Row): boolean => row["state"] === "different" && /^10(00|18):/.test(String(row["object"] ?? ""));

export class Project {
  network: ProjectNetwork | null = null;
  nodes: ProjectNode[] = [];
  pdos: Pdo[] = [];
  findings: Finding[] = [];
  objects = new Map<number, ProjectObject[]>();
  /** By "NODE OBJECT". */
  device = new Map<string, FoundValue>();
  states = new Map<number, NodeFound>();
  /** "NODE OBJECT": changed here since the devices were looked at. */
  unwritten = new Set<string>();
  is_loaded = false;
  problem = "";
  private loading = new Set<number>();
  private reading = new Once(() => this.read());

  constructor(readonly bus: BusOfCommands, private readonly ask: (command: Command) => Promise<Done>, private readonly changed: () => void) {}

  get bus_name(): string {
    return this.bus.bus;
  }

  node(id: number): ProjectNode | undefined {
    return this.nodes.find((one) => one.node === id);
  }

  label(id: number): string {
    const name = this.node(id)?.name;
    return name ? `${id} ${name}` : `Node ${id}`;
  }

  private async read_rows(command: Command): Promise<Row[]> {
    const done = await this.ask({ ...command, bus: this.bus.bus });
    if (![0, 4].includes(done.code)) this.problem = done.message;
    return done.rows;
  }

  /** Reads the files anew. */
  load(): Promise<void> {
    return this.reading.run();
  }

  private async read(): Promise<void> {
    this.problem = "";
    const [shown, pdos, findings] = await Promise.all([this.read_rows({ command: "project show" }), this.read_rows({ command: "project pdo list", all: true }), this.read_rows({ command: "project check" })]);
    this.network = (shown.find((row) => row["network"] !== undefined) as unknown as ProjectNetwork | undefined) ?? null;
    this.nodes = shown.filter((row) => row["node"] !== undefined) as unknown as ProjectNode[];
    this.pdos = pdos as unknown as Pdo[];
    this.findings = findings as unknown as Finding[];
    this.objects.clear();
    this.is_loaded = true;
    this.changed();
  }

  async load_objects(id: number): Promise<void> {
    if (this.objects.has(id) || this.loading.has(id)) return;
    this.loading.add(id);
    const rows = await this.read_rows({ command: "project show", node: String(id), all: true });
    this.loading.delete(id);
    this.objects.set(id, rows.filter((row) => row["object"] !== undefined) as unknown as ProjectObject[]);
    this.changed();
  }

  /** What somebody's command has changed is read anew. */
  done_by_somebody(command: string): void {
    if (this.is_loaded && /^canopus project (add|remove|set|unset|note|undo|pdo (map|off|link)|read|accept|adopt|dcf load)\b/.test(command)) void this.load();
  }

  /** A value was changed here. */
  set_here(node: number, items: readonly string[]): void {
    for (const item of items) this.unwritten.add(`${node} ${item.split("=")[0]}`);
    this.forget(node);
  }

  /** What a node was found to have; null: every node. */
  forget(node: number | null): void {
    for (const key of [...this.device.keys()]) if (node === null || key.startsWith(`${node} `)) this.device.delete(key);
    if (node === null) this.states.clear();
    else this.states.delete(node);
  }

  /** Rows of diff, write and read. */
  found(rows: readonly Row[]): void {
    for (const row of rows) {
      const node = Number(row["node"]);
      if (row["write"] !== undefined && row["state"] !== "would be written") this.forget(node);
      if (is_identity(row)) this.states.set(node, { state: "different", reason: "another device" });
      if (row["object"] !== undefined && row["state"] !== undefined && row["write"] === undefined) this.device.set(`${node} ${String(row["object"])}`, row as unknown as FoundValue);
      else if (row["node"] !== undefined && row["write"] === undefined && row["state"] !== undefined) {
        this.states.set(node, row as unknown as NodeFound);
        for (const key of [...this.unwritten]) if (key.startsWith(`${node} `)) this.unwritten.delete(key);
        if (row["state"] === "same") for (const key of [...this.device.keys()]) if (key.startsWith(`${node} `)) this.device.delete(key);
      }
    }
    this.changed();
  }

  /** Changed and not yet written; what differs from the device; nothing. */
  mood(node: number, object: string): "unwritten" | "differs" | "" {
    const key = `${node} ${object}`;
    if (this.unwritten.has(key)) return "unwritten";
    return this.device.get(key)?.state === "different" ? "differs" : "";
  }
}

export interface PlanRow extends FoundValue {
  is_to_be_written: boolean;
}

/** What differs, each with whether it will be written. A device that is not the project's has nothing written. */
export function plan_of(rows: readonly Row[]): PlanRow[] {
  const written = new Set(rows.filter((row) => row["write"] !== undefined).map((row) => row["node"]));
  const compared = new Set(rows.filter((row) => row["values"] !== undefined).map((row) => row["node"]));
  return rows.filter((row) => row["object"] !== undefined && row["write"] === undefined).map((row) => {
    const is_to_be_written = written.has(row["node"]);
    const reason = is_to_be_written ? row["reason"] : row["reason"] ?? (compared.has(row["node"]) ? "not written" : "another device, left alone");
    return { ...row, ...(reason === undefined ? {} : { reason }), is_to_be_written } as unknown as PlanRow;
  });
}

export interface ResultRow {
  node: number;
  write: string;
  name?: string;
  value?: unknown;
  device?: unknown;
  state: string;
  reason?: string;
}

/** Each write with its result and what the device has now. */
export function results_of(rows: readonly Row[]): ResultRow[] {
  const names = new Map<string, unknown>();
  const now = new Map<string, Row>();
  const last = new Map<string, ResultRow>();
  const results: ResultRow[] = [];
  for (const row of rows) {
    const key = `${String(row["node"])} ${String(row["write"] ?? row["object"])}`;
    if (row["write"] !== undefined) {
      const name = names.get(key);
      const result = { ...row, ...(name === undefined ? {} : { name }) } as unknown as ResultRow;
      results.push(result);
      last.set(key, result);
    } else if (row["object"] !== undefined) {
      names.set(key, row["name"]);
      if (last.has(key)) now.set(key, row);
    }
  }
  for (const [key, result] of last) {
    const found = now.get(key);
    if (found) result.device = found["device"];
    else if (result.state === "written") result.device = result.value;
  }
  return results;
}
