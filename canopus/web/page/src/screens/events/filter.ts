// Which events are shown, and those that repeat as one. No browser is needed here.
import { kind_words } from "../../store/sentences.js";
import type { EventLine } from "../../store/store.js";

export interface EventFilter {
  find: string;
  only: "" | "trouble" | "people";
}

export function matching_events(events: readonly EventLine[], { find, only }: EventFilter): EventLine[] {
  const terms = find.toLowerCase().split(/\s+/).filter(Boolean);
  return events.filter((one) => (only === "" || (only === "trouble" ? one.mood !== "" : one.kind === "audit")) && terms.every((term) => `${kind_words(one.kind)} ${one.text}`.toLowerCase().includes(term)));
}

export interface EventRow extends EventLine {
  /** How many of its kind there are, of which this is the newest. */
  count: number;
}

/** Of those that say the same but for their numbers (a missing node is asked again and again), the newest alone, with how many there are. In the order of the newest. */
export function collapsed(events: readonly EventLine[], is_on: boolean): EventRow[] {
  if (!is_on) return events.map((one) => ({ ...one, count: 1 }));
  const newest = new Map<string, EventRow>();
  for (const one of events) {
    const key = [one.kind, one.event.bus, one.event.node, one.event["step"] ?? one.text.replace(/\d+(\.\d+)?/g, "#")].join("/");
    const count = (newest.get(key)?.count ?? 0) + 1;
    newest.delete(key);
    newest.set(key, { ...one, count });
  }
  return [...newest.values()];
}
