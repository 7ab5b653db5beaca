// Marks of the trace: lines that somebody wants to find again, and the time between them. No browser is needed here.

export interface Mark {
  record: number;
  t: number;
  text: string;
}

export class Marks {
  all: readonly Mark[] = [];

  has(record: number): boolean {
    return this.all.some((one) => one.record === record);
  }

  /** Sets a mark, or takes it away. In the order of time. */
  toggle(mark: Mark): void {
    this.all = this.has(mark.record) ? this.all.filter((one) => one.record !== mark.record) : [...this.all, mark].sort((a, b) => a.t - b.t || a.record - b.record);
  }

  clear(): void {
    this.all = [];
  }

  /** Seconds since the mark before a time; null: there is none. */
  since(t: number): number | null {
    const before = this.all.findLast((one) => one.t < t);
    return before ? t - before.t : null;
  }
}
