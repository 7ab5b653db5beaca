// What Ctrl+K finds. No browser is needed here.
import { id_of, label_of, type ShownNode } from "../store/nodes.js";
import type { RunState } from "../store/protocol.js";
import type { Place, Screen } from "./app.js";
import { link } from "./route.js";

/** Everything of a state that has a place. */
export function places_of(screens: readonly Screen[], state: RunState | null, nodes: readonly ShownNode[]): Place[] {
  const places: Place[] = screens.map((one) => ({ title: one.title, detail: "Screen", href: link(one.id) }));
  if (!state) return places;
  for (const bus of state.buses) places.push({ title: `Bus ${bus.bus}`, detail: "Load, errors, frames", href: link("bus", [bus.bus]) });
  for (const node of nodes) {
    const name = `${id_of(node)} ${label_of(node)}`;
    places.push({ title: name, detail: `Node of ${node.bus}`, href: link("overview", [], { node: node.key }) });
    if (node.own || node.outside) places.push({ title: `${name}: objects`, detail: `Node of ${node.bus}`, href: link("objects", [node.bus, node.node]) });
    if (node.node >= 1) places.push({ title: `${name}: frames`, detail: `Trace of ${node.bus}`, href: link("trace", [], { filter: `node=${node.node}` }) });
  }
  state.modules.forEach((module, i) => places.push({ title: `${module.name}: buffer memory`, detail: `Module of ${module.plc}`, href: link("module", [i]) }));
  return places;
}

/** Those that have all the words; what begins with them stands first. An index ("6041", "1018:01") leads to the objects of each node. */
export function found_places(places: readonly Place[], words: string, state: RunState | null, most = 14): Place[] {
  const terms = words.toLowerCase().split(/\s+/).filter(Boolean);
  const has_all = (place: Place): boolean => terms.every((term) => `${place.title} ${place.detail}`.toLowerCase().includes(term));
  const found = places.filter(has_all);
  const first = terms[0] ?? "";
  found.sort((a, b) => Number(b.title.toLowerCase().startsWith(first)) - Number(a.title.toLowerCase().startsWith(first)));
  const index = /^([0-9a-f]{4}(:[0-9a-f]{2})?)h?$/i.exec(words.trim())?.[1];
  const word = /^g(\d{1,5})$/i.exec(words.trim())?.[1];
  const extra: Place[] = [];
  if (index && state) for (const node of state.nodes) extra.push({ title: `Object ${index.toUpperCase()} of ${node.node} ${node.name}`, detail: node.bus, href: link("objects", [node.bus, node.node], { find: index.toUpperCase() }) });
  if (word && state) state.modules.forEach((module, i) => extra.push({ title: `G${word} of ${module.name}`, detail: "Buffer memory", href: link("module", [i], { find: `G${word}` }) }));
  if (words.trim() && !index && !word && state && found.length < most) {
    for (const node of state.nodes) extra.push({ title: `Objects of ${node.node} ${node.name} named “${words.trim()}”`, detail: node.bus, is_guess: true, href: link("objects", [node.bus, node.node], { find: words.trim() }) });
  }
  return [...(index || word ? extra : found), ...(index || word ? found : extra)].slice(0, most);
}
