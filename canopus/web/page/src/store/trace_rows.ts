// The lines of the trace that are here, of all that the server has: those in sight and around them. It asks for what is missing, one question at a time.
import type { Command, Done } from "./commands.js";
import type { TraceAnswer, TraceRow } from "./protocol.js";

const most_asked = 256;
const most_kept = 4000;
const asked_ahead = 128;  // lines beyond those in sight, where the sight moves to

export interface TraceLine extends TraceRow {
  /** Seconds since the line before. */
  delta: number | null;
}

export class TraceRows {
  version = 0;
  filter = "";
  /** A trace file that is open; null: the run. */
  file: number | null = null;
  folded = true;
  newest_first = true;
  /** Lines are not moved by new ones. */
  is_frozen = false;
  first = 0;
  end = 0;
  records = 0;
  forgotten = 0;
  lost = 0;
  progress: number | null = null;
  problem = "";
  private kept = new Map<number, TraceLine>();
  private shown_end = 0;
  private sight: [number, number] = [0, 40];
  /** Where the sight moves to: what comes next is asked for, too. */
  private moves: "to older" | "to newer" | "" = "";
  private is_asking = false;
  private query = 0;

  /** `ask`: does a command; `changed`: called when lines have come. */
  constructor(private readonly ask: (command: Command) => Promise<Done>, private readonly changed: () => void) {}

  get count(): number {
    return Math.max(0, this.shown_end - this.first);
  }

  number_of(index: number): number {
    return this.newest_first ? this.shown_end - 1 - index : this.first + index;
  }

  index_of(number: number): number {
    return this.newest_first ? this.shown_end - 1 - number : number - this.first;
  }

  row(index: number): TraceLine | undefined {
    return this.kept.get(this.number_of(index));
  }

  see(first: number, last: number): void {
    const before = this.number_of(this.sight[0]);
    this.sight = [first, last];
    const now = this.number_of(first);
    if (now !== before) this.moves = now < before ? "to older" : "to newer";
    if (this.missing() !== null) void this.fetch();
  }

  /** With another filter or of another file, lines have other numbers. */
  restart(filter: string, folded: boolean, file = this.file): void {
    if (filter === this.filter && folded === this.folded && file === this.file && this.version > 0) return;
    this.filter = filter;
    this.folded = folded;
    this.file = file;
    this.forget();
    void this.fetch();
  }

  forget(): void {
    ++this.query;
    this.kept.clear();
    this.first = this.end = this.shown_end = 0;
    this.is_frozen = false;
    ++this.version;
  }

  set_order(newest_first: boolean): void {
    this.newest_first = newest_first;
    ++this.version;
  }

  freeze(on: boolean): void {
    this.is_frozen = on;
    if (!on) void this.fetch();
    ++this.version;
  }

  /** What each question about lines begins with. */
  get question(): Command {
    return { command: "trace", filter: this.filter, fold: this.folded, ...(this.file === null ? {} : { file: this.file }) };
  }

  /** Objects of the lines that are here. */
  objects(): string[] {
    return [...new Set([...this.kept.values()].map((row) => row.object ?? "").filter(Boolean))].sort();
  }

  /** The number with which the next question begins; null: everything in sight is here, and enough of what comes into sight next. */
  private missing(): number | null {
    const [a, b] = this.sight.map((index) => this.number_of(Math.max(0, Math.min(index, this.count - 1)))) as [number, number];
    const low = Math.max(this.first, Math.min(a, b) - (this.moves === "to older" ? asked_ahead : 0));
    const high = Math.min(this.shown_end - 1, Math.max(a, b) + (this.moves === "to newer" ? asked_ahead : 0));
    const numbers = Array.from({ length: Math.max(0, high - low + 1) }, (_, i) => low + i).filter((n) => !this.kept.has(n));
    const [lowest, highest] = [numbers[0], numbers.at(-1)];
    if (lowest === undefined || highest === undefined) return null;
    return Math.max(this.first, this.moves === "to older" ? highest + 1 - most_asked : this.moves === "to newer" ? lowest : lowest - 60);
  }

  /** Asks for what is new, or for what is in sight and not here. */
  async fetch(): Promise<void> {
    if (this.is_asking) return;
    const from = this.missing();
    if (from === null && this.is_frozen) return;
    this.is_asking = true;
    const query = this.query;
    const wish: Command = { ...this.question, count: most_asked };
    if (from !== null && (this.is_frozen || from < this.end - most_asked)) wish["from"] = from;
    const done = await this.ask(wish);
    this.is_asking = false;
    if (query !== this.query) return void this.fetch();
    this.apply(done);
    const next = this.is_frozen ? this.missing() : null;
    if (next !== null && next !== from) void this.fetch();
    else if (next !== null || this.progress !== null) setTimeout(() => void this.fetch(), 60);
  }

  private apply(done: Done): void {
    ++this.version;
    this.problem = done.code === 0 ? "" : done.message || "no answer";
    const answer = done.rows[0] as unknown as TraceAnswer | undefined;
    if (done.code === 0 && answer) {
      for (const row of answer.rows) this.keep(row);
      Object.assign(this, { first: answer.first, end: answer.end, records: answer.records, forgotten: answer.forgotten, lost: answer.lost ?? 0, progress: answer.progress ?? null });
      if (!this.is_frozen || this.shown_end === 0) this.shown_end = answer.end;
      this.keep_few();
    }
    this.changed();
  }

  /** A line that is known and has not changed stays the same object. */
  private keep(row: TraceRow): void {
    const [known, before, after] = [this.kept.get(row.n), this.kept.get(row.n - 1), this.kept.get(row.n + 1)];
    if (known && (known.delta !== null || !before) && (Object.keys(row) as (keyof TraceRow)[]).every((key) => known[key] === row[key])) return;
    this.kept.set(row.n, { ...row, delta: before ? row.t - before.t : null });
    if (after && after.delta === null) this.kept.set(after.n, { ...after, delta: after.t - row.t });
  }

  private keep_few(): void {
    if (this.kept.size <= most_kept) return;
    const middle = this.number_of(Math.round((this.sight[0] + this.sight[1]) / 2));
    for (const n of [...this.kept.keys()].sort((a, b) => Math.abs(b - middle) - Math.abs(a - middle)).slice(0, this.kept.size - most_kept / 2)) this.kept.delete(n);
  }
}

/** "1234AB" as "12 34 AB". */
export const spaced = (hex: string): string => hex.replace(/..(?=.)/g, "$& ");

/** "12 34 AB"; of an SDO transfer, how many frames it had. */
export function bytes_text(row: TraceRow): string {
  if (row.frames !== undefined) return `${row.frames} frames, ${(1000 * (row.duration ?? 0)).toFixed(1)} ms`;
  return row.remote ? `remote, DLC ${row.dlc}` : spaced(row.data ?? "");
}

export const node_text = (row: Pick<TraceRow, "node" | "name">): string => (row.node === undefined ? "" : `${row.node || "all"}${row.name ? ` ${row.name}` : ""}`);

/** What a line means; of an SDO transfer that was aborted the abort code first, where it is not cut off. */
export function meaning_text(row: Pick<TraceRow, "text" | "service">): string {
  const found = row.service === "sdo" ? /^(.*\babort.*?): ([0-9A-F]{8}H .*)$/.exec(row.text) : null;
  return found ? `${found[2]}; ${found[1]}` : row.text;
}
