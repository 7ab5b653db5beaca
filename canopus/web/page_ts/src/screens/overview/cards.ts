// What stands on the cards of nodes, and in which order. No browser is needed here.
import type { ShownNode } from "../../store/nodes.js";

/** In trouble first, the worst in front; then by node-ID. */
export function sorted_troubles(nodes: readonly ShownNode[]): ShownNode[] {
  const rank = (node: ShownNode): number => (node.mood === "error" ? 0 : 1);
  return nodes.filter((node) => node.mood === "error" || (node.mood === "warning" && node.troubles.length > 0)).sort((a, b) => rank(a) - rank(b) || a.node - b.node);
}

/** What stands on a card below the name. */
export function card_line(node: ShownNode): string {
  if (!node.own) return `${node.state}, external node`;
  const rate = node.rates?.pdo_rate;
  const words = [node.state];
  if (node.own.last_emcy) words.push(`EMCY ${node.own.last_emcy}H`);
  else if (rate !== undefined && rate !== null) words.push(`${Math.round(rate)} PDO/s`);
  return words.join(" · ");
}
