// The mapping of a PDO of a module: objects by name and description. No browser is needed here.

export interface MappedObject {
  index: number;
  sub: number;
  bits: number;
}

export interface MappableObject extends MappedObject {
  /** "Buffer Memory Area Unsigned8" */
  type: string;
  /** "Un\G13000 LByte" */
  name: string;
}

const hex = (value: number, digits: number): string => value.toString(16).toUpperCase().padStart(digits, "0");

/** "6000:01:8 Digital inputs", as `configure show` says it. */
export function parse_mapped(text: string): MappedObject | null {
  const found = /^([0-9A-F]{4}):([0-9A-F]{2}):(\d+)/i.exec(text);
  return found ? { index: parseInt(found[1]!, 16), sub: parseInt(found[2]!, 16), bits: Number(found[3]) } : null;
}

/** As `configure set … map=` takes it. */
export const mapping_text = (objects: readonly MappedObject[]): string => objects.map((one) => `${hex(one.index, 4)}:${hex(one.sub, 2)}:${one.bits}`).join(" ");

export const object_text = (one: MappedObject): string => `${hex(one.index, 4)}:${hex(one.sub, 2)}`;

/** Rows of `configure objects`, one for each object. */
export function mappable_objects(rows: readonly Record<string, unknown>[]): MappableObject[] {
  return rows.flatMap((row) => ((row["objects"] ?? []) as [number, number, string][]).map(([index, sub, name]) => ({ index, sub, bits: Number(row["bits"]), type: String(row["name"]), name: name || String(row["name"]) })));
}

export function found_objects(all: readonly MappableObject[], find: string): MappableObject[] {
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  return all.filter((one) => terms.every((term) => `${one.name} ${one.type} ${object_text(one)}`.toLowerCase().includes(term)));
}

export const bits_of_all = (objects: readonly MappedObject[]): number => objects.reduce((sum, one) => sum + one.bits, 0);
