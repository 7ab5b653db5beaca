// Values of a node of a live bus: read by SDO, one after the other, when somebody asks for them. No browser is needed here.
import type { Command, Done } from "../../store/commands.js";
import type { ObjectRow } from "../../store/protocol.js";
import { sdo_type } from "../../store/value_words.js";
import { is_readable, with_read_value } from "./object_text.js";

interface Read {
  value?: unknown;
  problem?: string;
  t: number;
}

export class LiveValues {
  is_busy = false;
  private read = new Map<string, Read>();
  private generation = 0;

  /** `changed`: called after each value. */
  constructor(private readonly ask: (command: Command) => Promise<Done>, private readonly changed: () => void) {}

  forget(): void {
    ++this.generation;
    this.is_busy = false;
    this.read.clear();
  }

  /** The row with its value, or with the reason why there is none. */
  shown(row: ObjectRow): ObjectRow {
    const found = this.read.get(row.object);
    if (!found) return row;
    return found.problem === undefined ? with_read_value(row, found.value) : { ...row, warning: found.problem };
  }

  problem_of(object: string): string {
    return this.read.get(object)?.problem ?? "";
  }

  /** `rows`: those in sight; `took`: called with each number. */
  async read_rows(bus: string, node: number, rows: readonly ObjectRow[], took: (object: string, value: number, t: number) => void): Promise<void> {
    if (this.is_busy) return;
    this.is_busy = true;
    const { generation } = this;
    for (const row of rows.filter(is_readable)) {
      const type = sdo_type(row.type);
      const done = await this.ask({ command: "sdo read", bus, node: String(node), object: row.object, ...(type ? { type } : {}) });
      if (generation !== this.generation) return;
      const answer = done.rows[0] as { value?: unknown; bytes?: unknown; reason?: string } | undefined;
      const is_good = done.code === 0 && answer?.reason === undefined;
      this.read.set(row.object, is_good ? { value: answer?.value ?? answer?.bytes, t: done.t } : { problem: answer?.reason ?? (done.message || "no answer"), t: done.t });
      if (is_good && typeof answer?.value === "number") took(row.object, answer.value, done.t);
      this.changed();
      if (done.code === -1) break;
    }
    this.is_busy = false;
    this.changed();
  }
}
