// The words of the buffer memory that take and give process data, by the CAN-ID of their PDO. No browser is needed here.
import type { RunState, ViewWish, WordRow, WordsView } from "./protocol.js";

const most_rows = 256;

interface OfModule {
  number: number;
  name: string;
  seen: number;
  is_complete: boolean;
  words: WordRow[];
}

export class ProcessWords {
  private modules: OfModule[];

  constructor(readonly bus: string, state: RunState) {
    this.modules = state.modules.flatMap((one, number) => (one.bus === bus ? [{ number, name: one.name, seen: 0, is_complete: false, words: [] }] : []));
  }

  get is_complete(): boolean {
    return this.modules.every((one) => one.is_complete);
  }

  /** Those that are not here yet; and of a chosen PDO their values now. */
  wishes(chosen: string | null): ViewWish[] {
    const next = this.modules.find((one) => !one.is_complete);
    if (next) return [{ words: next.number, find: "PDO", from: next.seen, count: most_rows }];
    const of_chosen = chosen === null ? undefined : this.modules.find((one) => one.words.some((word) => word.can_id === chosen));
    return of_chosen && chosen !== null ? [{ words: of_chosen.number, find: chosen, from: 0, count: 64 }] : [];
  }

  take(event: WordsView): void {
    const module = this.modules.find((one) => one.number === event.number);
    if (!module) return;
    for (const row of event.rows.filter((one) => one.pdo !== undefined)) {
      const place = module.words.findIndex((one) => one.address === row.address);
      if (place >= 0) module.words[place] = row;
      else module.words.push(row);
    }
    if (module.is_complete || event.from !== module.seen) return;
    module.seen += event.rows.length;
    module.is_complete = event.rows.length === 0 || module.seen >= event.of;
  }

  /** Of a CAN-ID ("183"), in the order of their addresses. */
  of(can_id: string): { module: string; number: number; words: WordRow[] }[] {
    return this.modules.map((one) => ({ module: one.name, number: one.number, words: one.words.filter((word) => word.can_id === can_id).sort((a, b) => a.address - b.address) })).filter((one) => one.words.length > 0);
  }
}

/** "G10000 to G10003" */
export function addresses_text(words: readonly Pick<WordRow, "address">[]): string {
  const parts: [number, number][] = [];
  for (const { address } of words) {
    const last = parts.at(-1);
    if (last && address === last[1] + 1) last[1] = address;
    else parts.push([address, address]);
  }
  return parts.map(([first, last]) => (first === last ? `G${first}` : `G${first} to G${last}`)).join(", ");
}
