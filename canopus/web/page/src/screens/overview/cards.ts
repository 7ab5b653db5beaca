// What stands on the cards of nodes, and in which order. No browser is needed here.
import { not_seen, type ShownNode } from "../../store/nodes.js";
import type { BusState } from "../../store/protocol.js";

/** In trouble first, the worst in front; then by node-ID. */
export function sorted_troubles(nodes: readonly ShownNode[]): ShownNode[] {
  const rank = (node: ShownNode): number => (node.mood === "error" ? 0 : 1);
  return nodes.filter((node) => node.mood === "error" || (node.mood === "warning" && node.troubles.length > 0)).sort((a, b) => rank(a) - rank(b) || a.node - b.node);
}

/** What stands on a card below the name. */
export function card_line(node: ShownNode): string {
  if (node.outside) return node.state === not_seen ? "in the project, not seen yet" : node.state;
  if (!node.own) return `${node.state}, external node`;
  const rate = node.rates?.pdo_rate;
  const words = [node.state];
  if (node.own.last_emcy) words.push(`EMCY ${node.own.last_emcy}H`);
  else if (rate !== undefined && rate !== null) words.push(`${Math.round(rate)} PDO/s`);
  return words.join(" · ");
}

/** The part of a cut bus that a node is on, 0: the near one; -1: the wire is whole. */
export function half_of(bus: Pick<BusState, "cut">, node: Pick<ShownNode, "name">): number {
  if (!bus.cut) return -1;
  const place = bus.cut.findIndex((half) => half.nodes.includes(node.name));
  return Math.max(0, place);
}
