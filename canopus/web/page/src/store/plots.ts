// What is plotted: points of each value over plant time, taken whichever screen is open. No browser is needed here.
import type { RunState, ValuesView } from "./protocol.js";

export interface Plot {
  key: string;
  name: string;
  times: number[];
  values: number[];
}

export const most_plots = 8;
const most_points = 20_000;

/** Keys: "bus line1 now" (%), "state line1 3 tec" of a node, "words 0 10000", "objects 3 6004:00" as the server names them, "sdo can0 5 6041:00": read by the page. */
export class Plots {
  all: Plot[] = [];

  has(key: string): boolean {
    return this.all.some((one) => one.key === key);
  }

  /** Begins a plot, or ends the one that there is. False: there are as many as can be. */
  toggle(key: string, name: string): boolean {
    const place = this.all.findIndex((one) => one.key === key);
    if (place >= 0) {
      this.all.splice(place, 1);
      return true;
    }
    if (this.all.length >= most_plots) return false;
    this.all.push({ key, name, times: [], values: [] });
    return true;
  }

  /** Those that the server has to be asked for. */
  asked_keys(): string[] {
    return this.all.map((one) => one.key).filter((key) => key.startsWith("words ") || key.startsWith("objects "));
  }

  take_values(event: ValuesView): void {
    for (const { key, value } of event.values) if (value !== null) this.add(key, event.t, value);
  }

  take_state(state: RunState): void {
    for (const { key } of this.all) {
      const value = value_of_state(state, key);
      if (value !== null) this.add(key, state.t, value);
    }
  }

  /** A value that the page has read itself. */
  take_value(key: string, t: number, value: number): void {
    this.add(key, t, value);
  }

  private add(key: string, t: number, value: number): void {
    const plot = this.all.find((one) => one.key === key);
    if (!plot || (plot.times.at(-1) ?? -1) >= t) return;
    plot.times.push(t);
    plot.values.push(value);
    if (plot.times.length > most_points) {
      plot.times.splice(0, 1000);
      plot.values.splice(0, 1000);
    }
  }

  csv(): string {
    const quoted = (text: string): string => `"${text.replaceAll('"', '""')}"`;
    const lines = this.all.flatMap((one) => one.times.map((t, i) => `${t},${quoted(one.name)},${one.values[i]}`));
    return ["time (s),name,value", ...lines, ""].join("\r\n");
  }
}

export function value_of_state(state: RunState, key: string): number | null {
  const [kind, bus, ...rest] = key.split(" ");
  if (kind === "bus") {
    const found = state.buses.find((one) => one.bus === bus);
    return found ? 100 * found.now : null;
  }
  if (kind !== "state") return null;
  const node = state.nodes.find((one) => one.bus === bus && one.node === Number(rest[0]));
  const value = node ? (node as unknown as Record<string, unknown>)[rest[1] ?? ""] : undefined;
  return typeof value === "number" ? value : null;
}
