// The settings of a module as `canopus configure` shows and changes them (docs/configure.md).
import type { Command, Done } from "./commands.js";
import { Once } from "./once.js";

export interface SettingsField {
  field: string;
  range: string;
  default: string;
  description: string;
  unit: string;
  lowest: number;
  highest: number;
  hexadecimal: boolean;
  read_only: boolean;
  choices?: number[];
  words?: string[];
}

export interface SettingsWindow {
  word: string;
  title: string;
  part: string;
  key?: string;
  most_key?: number;
  most_rows?: number;
  name_field?: string;
  maps_objects: boolean;
  fields: SettingsField[];
}

export interface SettingsRow {
  number: number;
  name?: string;
  values: Record<string, number>;
  /** "6000:01:8 Digital inputs" as the program says them. */
  objects: string[];
  words?: string;
  warning?: string;
}

export interface Difference {
  field: string;
  project: unknown;
  device: unknown;
}

export interface SettingsOfModule {
  file: string;
  model: string;
  setup: string;
  plc: string[];
  live: boolean;
}

type Row = Record<string, unknown>;

/** A value as the window shows it. */
export function shown_value(field: SettingsField, value: number | undefined): string {
  if (value === undefined) return "";
  if (field.words?.[value] !== undefined) return field.words[value]!;
  if (!field.hexadecimal) return String(value);
  const digits = value.toString(16).toUpperCase();
  return `0x${field.highest <= 0xff ? digits.padStart(2, "0") : field.highest <= 0xffff ? digits : digits.padStart(8, "0")}`;
}

export class Settings {
  windows: SettingsWindow[] = [];
  rows = new Map<string, SettingsRow[]>();
  findings: { severity: string; message: string }[] = [];
  /** What differs between module and file; null: not compared. */
  plan: Difference[] | null = null;
  /** "tpdo/5 Event timer": what the module has. */
  differs = new Map<string, unknown>();
  unwritten = new Set<string>();
  problem = "";
  private reading = new Once(() => this.read());

  constructor(readonly one: SettingsOfModule, private readonly ask: (command: Command) => Promise<Done>, private readonly changed: () => void) {}

  window(word: string | undefined): SettingsWindow | undefined {
    return this.windows.find((one) => one.word === word);
  }

  row(word: string, number = 0): SettingsRow | undefined {
    return this.rows.get(word)?.find((one) => one.number === number);
  }

  private async read_rows(command: Command): Promise<Row[]> {
    const done = await this.ask({ ...command, settings: this.one.file });
    if (![0, 4].includes(done.code)) this.problem = done.message;
    return done.rows;
  }

  /** Reads the file anew. */
  load(): Promise<void> {
    return this.reading.run();
  }

  private async read(): Promise<void> {
    this.problem = "";
    if (this.windows.length === 0) this.described(await this.read_rows({ command: "configure describe" }));
    const [shown, findings] = await Promise.all([this.read_rows({ command: "configure show" }), this.read_rows({ command: "configure check" })]);
    this.shown(shown);
    this.findings = findings.filter((one) => one["severity"] !== "note") as never;
    this.changed();
  }

  described(rows: readonly Row[]): void {
    for (const row of rows) {
      if (row["field"] === undefined) this.windows.push({ ...row, word: String(row["window"]), fields: [] } as unknown as SettingsWindow);
      else this.window(String(row["window"]))?.fields.push(row as unknown as SettingsField);
    }
  }

  shown(rows: readonly Row[]): void {
    this.rows = new Map(this.windows.map((window) => [window.word, []]));
    for (const row of rows) {
      this.rows.get(String(row["window"]))?.push({ number: Number(row["number"] ?? 0), values: (row["fields"] ?? {}) as Record<string, number>, objects: (row["objects"] ?? []) as string[],
        ...(typeof row["name"] === "string" ? { name: row["name"] } : {}), ...(typeof row["words"] === "string" ? { words: row["words"] } : {}), ...(typeof row["warning"] === "string" ? { warning: row["warning"] } : {}) });
    }
  }

  /** What the module has otherwise; null: it was not found out. */
  compared(rows: readonly Row[] | null): void {
    this.plan = rows as unknown as Difference[] | null;
    this.differs.clear();
    if (rows) this.unwritten.clear();
    for (const row of this.plan ?? []) {
      const [, word, number, names] = /^(\w+)(?: (\d+))?: (.*?)(?: \([^()]*\))?$/.exec(row.field) ?? [];
      for (const name of names?.split(", ") ?? []) this.differs.set(`${number ? `${word}/${number}` : word} ${name}`, row.device);
    }
  }

  /** "tpdo/5" and "Event timer": changed and not yet written, or not what the module has. */
  mood(place: string, field: string): "unwritten" | "differs" | "" {
    const key = `${place} ${field}`;
    return this.unwritten.has(key) ? "unwritten" : this.differs.has(key) ? "differs" : "";
  }
}
