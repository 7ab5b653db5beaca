// What stands in a row of the object dictionary. No browser is needed here.
import { count_text } from "../../store/nodes.js";
import type { ProjectObject } from "../../store/project.js";
import type { ObjectRow } from "../../store/protocol.js";
import { is_hexadecimal, words_of } from "../../store/value_words.js";

export const full_name = (row: Pick<ObjectRow, "name" | "of">): string => (row.name === row.of ? row.name : `${row.name}, ${row.of}`);

export function value_text(row: ObjectRow, in_hex: boolean): string {
  if (row.decimal !== undefined) return in_hex || is_hexadecimal(row.object) ? `${row.hex}H` : row.decimal;
  if (row.text !== undefined && !in_hex) return `“${row.text}”`;
  if (row.bytes === undefined) return "";
  if (row.bytes === 0) return "empty";
  return row.type === "DOMAIN" || row.bytes > 64 ? count_text(row.bytes, "byte") : row.hex ?? "";
}

const number_text = (object: string, decimal: string | undefined, hex: string | undefined, in_hex: boolean): string => (decimal === undefined ? "" : in_hex || is_hexadecimal(object) ? `${hex}H` : decimal);

export function default_text(row: ObjectRow, in_hex: boolean): string {
  if (row.default_decimal !== undefined && row.decimal === row.default_decimal) return "same";
  return number_text(row.object, row.default_decimal, row.default_hex, in_hex);
}

type ProjectValue = number | string | null | undefined;

export function project_text(row: ObjectRow, value: ProjectValue, in_hex: boolean): string {
  return typeof value === "number" ? number_text(row.object, String(value), hex_of(value, row.type), in_hex) : value ?? "";
}

/** "same", "differs", or nothing where one of both is not known. */
export function difference_text(row: ObjectRow, value: ProjectValue): string {
  const device = row.decimal ?? row.text;
  if (value === undefined || value === null || device === undefined) return "";
  return String(value) === device ? "same" : "differs";
}

/** The row of a node of a live bus: all but its value. */
export function row_of_project(one: ProjectObject): ObjectRow {
  const limit = (value: number | undefined): string | undefined => (value === undefined ? undefined : String(value));
  const [low, high] = [limit(one.low), limit(one.high)];
  return { object: one.object, name: one.name, of: one.name, type: one.type, access: one.access, ...(one.unit ? { unit: one.unit } : {}), ...(one.tpdo ? { tpdo: true } : {}), ...(one.rpdo ? { rpdo: true } : {}),
    ...(low === undefined ? {} : { low }), ...(high === undefined ? {} : { high }) };
}

/** Those whose name or index holds the text. */
export function found_rows(all: readonly ProjectObject[], find: string): ObjectRow[] {
  const text = find.toLowerCase();
  return all.filter((one) => !one.object.startsWith("00") && `${one.object} ${one.name}`.toLowerCase().includes(text)).map(row_of_project);
}

export const object_words = (row: ObjectRow): string => row.words ?? (row.decimal === undefined ? "" : words_of(row.object, Number(row.decimal)));

export const is_readable = (row: Pick<ObjectRow, "access">): boolean => row.access !== "wo";
export const is_writable = (row: Pick<ObjectRow, "access">): boolean => row.access !== "ro" && row.access !== "const";

/** The row with a value that was read by SDO: a number, a text or bytes. */
export function with_read_value(row: ObjectRow, value: unknown): ObjectRow {
  if (typeof value === "number") return { ...row, decimal: String(value), hex: hex_of(value, row.type) };
  if (typeof value === "boolean") return { ...row, decimal: value ? "1" : "0", hex: value ? "01" : "00" };
  if (typeof value === "string") return /^-?\d+$/.test(value) && /^(UNSIGNED|INTEGER)/.test(row.type) ? { ...row, decimal: value, hex: hex_of(Number(value), row.type) } : { ...row, text: value, bytes: value.length };
  return row;
}

function hex_of(value: number, type: string): string {
  const bits = Number(/\d+$/.exec(type)?.[0] ?? 32);
  if (!Number.isInteger(value) || bits > 53) return value.toString(16).toUpperCase();
  return (value < 0 ? value + 2 ** bits : value).toString(16).toUpperCase().padStart(Math.ceil(bits / 4), "0");
}
