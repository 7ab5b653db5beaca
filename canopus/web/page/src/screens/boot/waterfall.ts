// Boots as bars: steps with their ends, and where they stand in the picture. No browser is needed here.
import type { BootsView, BootStep } from "../../store/protocol.js";

export type StepKind = "" | "done" | "failed" | "retry";

export interface Span extends BootStep {
  end: number;
  kind: StepKind;
}

export const kind_of = (step: BootStep): StepKind => (step.step === "booted" ? "done" : step.step.startsWith("failed") ? "failed" : step.error ? "retry" : "");

/** The last one goes on until now, unless it is an end. */
export function spans_of(steps: readonly BootStep[], now: number): Span[] {
  return steps.map((step, place) => {
    const kind = kind_of(step);
    const next = steps[place + 1];
    return { ...step, kind, end: kind === "done" || kind === "failed" ? step.t : next ? next.t : now };
  });
}

/** The steps of the newest attempt: one ends with booted or failed. */
export function newest_attempt(spans: readonly Span[]): Span[] {
  const ended = spans.findLastIndex((span, place) => place < spans.length - 1 && (span.kind === "done" || span.kind === "failed"));
  return spans.slice(ended + 1);
}

/** Times to places from 0 to 1. A pause in which nobody booted, longer than all the boots together, is a small gap. */
export function axis(spans: readonly Pick<Span, "t" | "end">[]): (time: number) => number {
  const busy: { t: number; end: number }[] = [];
  for (const span of [...spans].sort((a, b) => a.t - b.t)) {
    const last = busy.at(-1);
    if (last && span.t <= last.end) last.end = Math.max(last.end, span.end);
    else busy.push({ t: span.t, end: span.end });
  }
  const total = Math.max(0.001, busy.reduce((sum, one) => sum + one.end - one.t, 0));
  const pieces: { t: number; end: number; x: number }[] = [];
  for (const one of busy) {
    const last = pieces.at(-1);
    if (last && one.t - last.end <= total) last.end = one.end;
    else pieces.push({ ...one, x: 0 });
  }
  const gap = pieces.length > 1 ? Math.min(0.02, 0.25 / (pieces.length - 1)) : 0;
  const shown = Math.max(0.001, pieces.reduce((sum, one) => sum + one.end - one.t, 0));
  const scale = (1 - gap * (pieces.length - 1)) / shown;
  let x = 0;
  for (const piece of pieces) {
    piece.x = x;
    x += scale * (piece.end - piece.t) + gap;
  }
  return (time) => {
    const piece = pieces.findLast((one) => one.t <= time) ?? pieces[0];
    return piece ? piece.x + scale * Math.min(Math.max(0, time - piece.t), piece.end - piece.t) : 0;
  };
}

export function duration_text(seconds: number): string {
  return seconds < 0.1 ? `${(seconds * 1000).toFixed(1)} ms` : `${seconds.toFixed(2)} s`;
}

const shown_value = (value: number | string | undefined): string | undefined => (typeof value === "number" ? `${value.toString(16).toUpperCase().padStart(8, "0")}H (${value})` : value);

/** What is known of why a step does not go on. */
export function facts_of(step: BootStep): [string, string | undefined][] {
  const is_compared = step.object !== undefined;
  return [["Object", step.object], ["Expected", is_compared ? shown_value(step.expected) : undefined], ["Found", is_compared ? shown_value(step.received) : undefined], ["Error", step.error ? `${step.error} [CiA 302-2]` : undefined],
    ["SDO abort", step.abort ? `${step.abort}H` : undefined], ["Requests for 1000H", step.attempts === undefined ? undefined : String(step.attempts)]];
}

/** The sentence, and what to do: the last sentence of a reason is the remedy ("Check …"). */
export function reason_and_remedy(reason: string): [string, string] {
  const at = reason.search(/(?<=\. )Check /);
  return at < 0 ? [reason, ""] : [reason.slice(0, at).trim(), reason.slice(at)];
}

/** Slaves in trouble first. */
export function sorted_slaves(view: BootsView): BootsView["slaves"] {
  const rank = (slave: BootsView["slaves"][number]): number => ({ failed: 0, retry: 1, "": 2, done: 3 })[kind_of(slave.steps.at(-1) ?? { step: "", since: 0, t: 0 })];
  return [...view.slaves].sort((a, b) => rank(a) - rank(b) || a.node - b.node);
}
