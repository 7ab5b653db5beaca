// Two cursors over all plots: times that somebody has set, and what each plot has there. No browser is needed here.
import type { Plot } from "./plots.js";

export class Cursors {
  a: number | null = null;
  b: number | null = null;

  clear(): void {
    this.a = this.b = null;
  }

  /** The time between them, s; null: one is not set. */
  get between(): number | null {
    return this.a === null || this.b === null ? null : this.b - this.a;
  }
}

/** The value that a plot has at a time: the last one up to it; null: it began later. */
export function value_at(plot: Pick<Plot, "times" | "values">, t: number | null): number | null {
  if (t === null) return null;
  let [low, high] = [0, plot.times.length];
  while (low < high) {
    const middle = (low + high) >> 1;
    if (plot.times[middle]! <= t) low = middle + 1;
    else high = middle;
  }
  return low === 0 ? null : plot.values[low - 1]!;
}

export const rounded = (value: number): string => String(Math.round(value * 1e4) / 1e4);

/** "A 12, B 15, B−A 3" */
export function cursor_text(plot: Pick<Plot, "times" | "values">, cursors: Pick<Cursors, "a" | "b">): string {
  const [a, b] = [value_at(plot, cursors.a), value_at(plot, cursors.b)];
  const parts = [a === null ? "" : `A ${rounded(a)}`, b === null ? "" : `B ${rounded(b)}`, a === null || b === null ? "" : `B−A ${rounded(b - a)}`];
  return parts.filter(Boolean).join(", ");
}
