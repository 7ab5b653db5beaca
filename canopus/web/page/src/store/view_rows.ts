// Rows of a view of the server (words, objects): those in sight are asked for, and come with each state.

const most = 256;
const beyond = 30;  // rows above and below what is seen

export class ViewRows<Row> {
  version = 0;
  count = 0;
  from = 0;
  asked = 100;
  find = "";
  private seen: [number, number] = [0, 30];
  private kept = new Map<number, Row>();

  row(index: number): Row | undefined {
    return this.kept.get(index);
  }

  see(first: number, last: number): void {
    this.seen = [first, last];
    this.from = Math.max(0, first - beyond);
    this.asked = Math.min(most, last - first + 1 + 2 * beyond);
  }

  /** Another thing, or another text: the rows are others. */
  restart(find: string): void {
    this.find = find.slice(0, 100);
    this.kept.clear();
    this.from = 0;
    this.count = 0;
    ++this.version;
  }

  take(event: { from: number; of: number; rows: readonly Row[] }): void {
    if (event.of < this.count) this.kept.clear();
    this.count = event.of;
    event.rows.forEach((row, i) => this.kept.set(event.from + i, row));
    ++this.version;
  }

  /** Rows in sight that are here. */
  in_sight(): Row[] {
    const [first, last] = this.seen;
    return [...this.kept.entries()].filter(([index]) => first <= index && index <= last).sort(([a], [b]) => a - b).map(([, row]) => row);
  }

  get rows(): Row[] {
    return [...this.kept.values()];
  }
}
