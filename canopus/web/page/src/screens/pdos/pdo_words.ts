// PDOs of a project: who sends what to whom, and why a link cannot be. No browser is needed here.
import type { Mapped, Pdo, ProjectObject } from "../../store/project.js";
import { transmission_words } from "../../store/value_words.js";

/** The PDOs of a bus, wherever they are known from. */
export interface PdoNetwork {
  readonly bus_name: string;
  readonly pdos: readonly Pdo[];
  label(node: number): string;
}

export const can_id_text = (id: number): string => `${id.toString(16).toUpperCase().padStart(3, "0")}H`;

export function sent_text(pdo: Pdo): string {
  return [transmission_words(pdo.transmission_type), pdo.inhibit_us ? `inhibit ${pdo.inhibit_us / 1000} ms` : "", pdo.event_ms ? `every ${pdo.event_ms} ms` : ""].filter(Boolean).join(", ");
}

export function linked_text(pdo: Pdo, network: PdoNetwork): string {
  return pdo.mapping.flatMap((one) => [...(one.to ?? []).map((end) => `${short(one)} → ${network.label(end.node)}`), ...(one.from ?? []).map((end) => `${short(one)} ← ${network.label(end.node)}`)]).join(", ");
}

/** "Digital inputs 1 to 8" of "Read input 8-bit: Digital inputs 1 to 8". */
export const short = (one: Pick<Mapped, "name" | "object">): string => one.name?.split(": ").at(-1) ?? one.object ?? "not used";

export const mapped_text = (pdo: Pdo): string => pdo.mapping.map(short).join(", ");

/** All that can be mapped, with search; nothing is left out in silence. */
export function mappable(objects: readonly ProjectObject[] | undefined, kind: "tpdo" | "rpdo", find: string): ProjectObject[] {
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  return (objects ?? []).filter((row) => row[kind] === true && !row.object.startsWith("00") && terms.every((term) => `${row.object} ${row.name} ${row.type}`.toLowerCase().includes(term)));
}

const bits: Record<string, number> = { BOOLEAN: 1, REAL32: 32, REAL64: 64 };
export const bits_of = (type: string): number | null => bits[type] ?? (/^(?:UNSIGNED|INTEGER)(\d+)$/.exec(type) ? Number(/\d+$/.exec(type)?.[0]) : null);

/** Why the one cannot be linked to the other; an empty text: it can be tried. */
export function refusal(from: ProjectObject, to: ProjectObject): string {
  if (from.node === to.node) return "both are of one node";
  const [a, b] = [bits_of(from.type), bits_of(to.type)];
  return a !== null && b !== null && a !== b ? `${a} bits do not fit ${b} bits` : "";
}

export interface Crossing {
  from: number;
  to: number;
  name: string;
  pdo: Pdo;
}

export function crossings_of(pdos: readonly Pdo[]): Crossing[] {
  return pdos.filter((pdo) => pdo.active).flatMap((pdo) => pdo.mapping.flatMap((one) => (one.to ?? []).map((to) => ({ from: pdo.node, to: to.node, name: short(one), pdo }))));
}
