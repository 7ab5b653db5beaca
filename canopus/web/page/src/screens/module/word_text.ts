// Words of the buffer memory as people read and write them. No browser is needed here.
import type { WordRow } from "../../store/protocol.js";

export const word_text = (value: number, in_hex: boolean): string => (in_hex ? `${value.toString(16).toUpperCase().padStart(4, "0")}H` : String(value));

/** "1234", "-1", "12ABH", "0x12AB"; null: it is no word of 16 bits. */
export function word_of_text(text: string): number | null {
  const typed = text.trim().replace(/^−/, "-");
  const value = /^(0x[0-9a-f]+|[0-9][0-9a-f]*h|[a-f][0-9a-f]*h)$/i.test(typed) ? parseInt(typed.replace(/^0x|h$/gi, ""), 16) : /^-?\d+$/.test(typed) ? Number(typed) : NaN;
  return Number.isInteger(value) && value >= -32768 && value <= 0xffff ? value & 0xffff : null;
}

export function range_text(row: WordRow): string {
  return row.values?.join(", ") ?? (row.low === undefined ? "" : `${row.low} to ${row.high}`);
}

/** "RPDO1 183H from encoder" */
export function source_text(row: WordRow): string {
  if (!row.pdo) return "";
  return `${row.pdo} ${row.can_id}H${row.from ? ` from ${row.from}` : ""}`;
}

/** Signals by letter: X of the module, Y of the program. */
export function signal_groups(names: readonly string[]): [string, string[]][] {
  return (["X", "Y"] as const).map((letter): [string, string[]] => [letter, names.filter((name) => name.startsWith(letter))]);
}
