// The PDOs of a bus whose nodes are in the plant: read out of their dictionaries, for a bus that has no project. No browser is needed here.
import type { Mapped, Pdo } from "./project.js";
import type { ObjectRow, ObjectsView, RunState, ViewWish } from "./protocol.js";

const most_rows = 256;
const most_wishes = 6;
/** Of a larger dictionary (that of a module has 20,000 sub-indexes and more) the names behind the PDOs are left out. */
const large = 2048;
const behind_pdos = "1C00";

const number_of = (rows: ReadonlyMap<string, ObjectRow>, object: string): number | undefined => {
  const text = rows.get(object)?.decimal;
  return text === undefined ? undefined : Number(text);
};
const hex4 = (value: number): string => value.toString(16).toUpperCase().padStart(4, "0");
const sub = (value: number): string => value.toString(16).toUpperCase().padStart(2, "0");

/** The objects that a PDO maps, each with its place in the frame. Objects below 0020H are dummies: bits that nobody uses. */
function mapping_of(rows: ReadonlyMap<string, ObjectRow>, index: number): Mapped[] {
  const count = Math.min(64, number_of(rows, `${hex4(index)}:00`) ?? 0);
  const mapping: Mapped[] = [];
  let bit = 0;
  for (let i = 1; i <= count; ++i) {
    const value = number_of(rows, `${hex4(index)}:${sub(i)}`);
    if (value === undefined || value === 0) break;
    const [of, place, bits] = [Math.floor(value / 65536), Math.floor(value / 256) % 256, value % 256];
    const object = `${hex4(of)}:${sub(place)}`;
    const name = rows.get(object)?.name;
    mapping.push(of < 0x20 ? { bit, bits } : { bit, bits, object, ...(name === undefined ? {} : { name }) });
    bit += bits;
  }
  return mapping;
}

/** Those of one node. */
export function pdos_of_node(node: number, all: readonly ObjectRow[]): Pdo[] {
  const rows = new Map(all.map((row) => [row.object, row]));
  const pdos: Pdo[] = [];
  for (const [kind, first, maps] of [["TPDO", 0x1800, 0x1a00], ["RPDO", 0x1400, 0x1600]] as const) {
    for (let i = 0; i < 512; ++i) {
      const at = hex4(first + i);
      const id = number_of(rows, `${at}:01`);
      if (id === undefined) continue;
      const mapping = mapping_of(rows, maps + i);
      const is_extended = Math.floor(id / 2 ** 29) % 2 === 1;
      const [inhibit, event] = [number_of(rows, `${at}:03`), number_of(rows, `${at}:05`)];
      pdos.push({ node, pdo: `${kind}${i + 1}`, active: id < 2 ** 31, can_id: id % (is_extended ? 2 ** 29 : 2 ** 11), transmission_type: number_of(rows, `${at}:02`) ?? 255,
        bytes: Math.ceil(mapping.reduce((sum, one) => sum + one.bits, 0) / 8), mapping, ...(inhibit === undefined || kind === "RPDO" ? {} : { inhibit_us: 100 * inhibit }), ...(event === undefined ? {} : { event_ms: event }) });
    }
  }
  return pdos;
}

/** What goes where: a TPDO and the RPDOs of its CAN-ID have the same bits. */
export function with_links(pdos: readonly Pdo[]): Pdo[] {
  const linked = pdos.map((pdo) => ({ ...pdo, mapping: pdo.mapping.map((one) => ({ ...one })) }));
  for (const from of linked.filter((one) => one.active && one.pdo.startsWith("T"))) {
    for (const to of linked.filter((one) => one.active && one.pdo.startsWith("R") && one.can_id === from.can_id && one.node !== from.node)) {
      for (const a of from.mapping) {
        if (!a.object) continue;
        const b = to.mapping.find((one) => one.object && one.bit < a.bit + a.bits && a.bit < one.bit + one.bits);
        if (!b?.object) continue;
        (a.to ??= []).push({ node: to.node, object: b.object });
        (b.from ??= []).push({ node: from.node, object: a.object });
      }
    }
  }
  return linked;
}

/** The rows of a node by the place of their first one. */
interface Reading {
  place: number;
  node: number;
  of: number | null;
  parts: Map<number, readonly ObjectRow[]>;
}

/** Asks for the dictionaries of a bus, some at a time, until all are here. */
export class DictionaryPdos {
  pdos: readonly Pdo[] = [];
  private own: Pdo[] = [];
  private left: Reading[] = [];
  private names = new Map<number, string>();

  constructor(readonly bus: string, state: RunState) {
    state.nodes.forEach((one, place) => {
      if (one.bus !== bus || one.node < 1 || one.node > 127) return;
      this.left.push({ place, node: one.node, of: null, parts: new Map() });
      this.names.set(one.node, one.name);
    });
  }

  get bus_name(): string {
    return this.bus;
  }

  get is_complete(): boolean {
    return this.left.length === 0;
  }

  label(node: number): string {
    return [node, this.names.get(node)].filter(Boolean).join(" ");
  }

  wishes(): ViewWish[] {
    const wishes: ViewWish[] = [];
    for (const { place, of, parts } of this.left) {
      for (let from = 0; from < (of ?? 1) && wishes.length < most_wishes; from += most_rows) if (!parts.has(from)) wishes.push({ objects: place, find: "", from, count: most_rows });
    }
    return wishes;
  }

  take(event: ObjectsView): void {
    const at = this.left.find((one) => one.place === event.number);
    if (!at || event.bus !== this.bus || event.from % most_rows !== 0) return;
    at.of = event.of;
    at.parts.set(event.from, event.rows);
    const rows: ObjectRow[] = [];
    for (let part = at.parts.get(0); part && part.length > 0; part = at.parts.get(rows.length)) rows.push(...part);
    const has_all_pdos = event.of > large && (rows.at(-1)?.object ?? "") >= behind_pdos;
    if (rows.length < event.of && !has_all_pdos) return;
    this.left = this.left.filter((one) => one !== at);
    this.own.push(...pdos_of_node(at.node, rows));
    this.own.sort((a, b) => a.node - b.node);
    this.pdos = with_links(this.own);
  }
}
