// The source text of a PLC program with the values of its lines, of which those in sight are asked for; what its state and its tasks are in words.
import type { CpuState, ProgramLine, ProgramTask, ProgramView } from "./protocol.js";
import { seconds_text } from "./nodes.js";

const most = 400;    // lines that the server sends at a time
const [least_width, most_width] = [44, 88];
const beyond = 40;   // lines above and below what is seen

export class SourceLines {
  /** By their number, from 1. */
  private lines = new Map<number, ProgramLine>();
  count = 0;
  /** Characters of the longest line that has values, within bounds: the values of all lines stand below each other. */
  width = least_width;
  private seen: [number, number] = [1, 60];

  line(number: number): ProgramLine | undefined {
    return this.lines.get(number);
  }

  see(first: number, last: number): void {
    this.seen = [first, last];
  }

  /** What the server is asked for. */
  get asked(): { from: number; count: number } {
    const from = Math.max(1, this.seen[0] - beyond);
    return { from, count: Math.min(most, this.seen[1] - from + 1 + beyond) };
  }

  /** Another file, or another program. */
  restart(): void {
    this.lines.clear();
    this.count = 0;
    this.width = least_width;
    this.seen = [1, 60];
  }

  take(view: Pick<ProgramView, "from" | "of" | "lines">): void {
    if (view.of !== this.count) this.lines.clear();
    this.count = view.of;
    view.lines.forEach((line, i) => this.lines.set(view.from + i, line));
    for (const line of view.lines) if (line.values.length) this.width = Math.min(most_width, Math.max(this.width, line.text.length));
  }
}

export const state_words: Record<CpuState, string> = { run: "RUN", stop: "STOP", pause: "PAUSE", off: "no supply", halted: "halted", error: "stopped by an error" };

export const state_moods: Record<CpuState, "good" | "warning" | "error" | ""> = { run: "good", stop: "", pause: "warning", off: "", halted: "warning", error: "error" };

/** How many scans, how long from one to the next, and how long the program takes, by estimate. */
export function scan_facts(scan: ProgramView["scan"]): [string, string][] {
  const facts: [string, string][] = [["Scans", String(scan.count)], ["Scan time", seconds_text(scan.period)]];
  if (scan.count > 0 && scan.most > 0) facts.push(["Execution", seconds_text(scan.now)], ["Shortest", seconds_text(scan.least)], ["Longest", seconds_text(scan.most)]);
  return facts;
}

/** When a task runs. */
export function task_words(task: Pick<ProgramTask, "kind" | "every" | "on">): string {
  if (task.kind === "scan") return "each scan";
  if (task.kind === "initial") return "once, in the first scan";
  if (task.kind === "fixed scan") return `every ${seconds_text(task.every ?? 0)}`;
  if (task.kind === "event") return `when ${task.on ?? ""} goes ON`;
  return task.kind === "standby" ? "when it is called for" : task.kind;
}

/** A value beside its line: BOOL as contacts are read, ON and OFF. */
export const value_text = (one: { type: string; value: string }): string => (one.type !== "BOOL" ? one.value : one.value === "TRUE" ? "ON" : "OFF");

export const is_on = (one: { type: string; value: string }): boolean => one.type === "BOOL" && one.value === "TRUE";

/** "MAIN.csv" is an instruction list: its lines have cells. */
export const cells_of = (text: string): string[] => text.split("\t");
