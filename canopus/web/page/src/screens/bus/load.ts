// The load of a bus over time by class of frame, from the sums that the server counts. No browser is needed here.
import type { TrafficView } from "../../store/protocol.js";

export interface Load {
  t: number;
  shares: number[];
}

const kept = 240;  // four a second

export class LoadHistory {
  loads: Load[] = [];
  private before: TrafficView | null = null;

  forget(): void {
    this.loads = [];
    this.before = null;
  }

  take(event: TrafficView): void {
    const { before } = this;
    if (before && event.t <= before.t) return;
    this.before = event;
    if (!before || before.number !== event.number) return;
    this.loads.push({ t: event.t, shares: event.classes.map((one, i) => Math.max(0, (one.busy - (before.classes[i]?.busy ?? 0)) / (event.t - before.t))) });
    if (this.loads.length > kept) this.loads.shift();
  }

  /** The upper end of the axis: the next round share. */
  get top(): number {
    const most = Math.max(0.001, ...this.loads.map((load) => load.shares.reduce((a, b) => a + b, 0)));
    return [0.01, 0.02, 0.05, 0.1, 0.2, 0.5, 1].find((one) => one >= most) ?? 1;
  }

  /** For each class the corners of its area in a picture of 1000 x 100. */
  areas(classes: number): string[] {
    const [first, last] = [this.loads[0], this.loads.at(-1)];
    if (!first || !last) return [];
    const [span, { top }] = [last.t - first.t || 1, this];
    const sum = (load: Load, upto: number): number => load.shares.slice(0, upto).reduce((a, b) => a + b, 0);
    const point = (load: Load, upto: number): string => `${((1000 * (load.t - first.t)) / span).toFixed(1)},${(100 - (100 * sum(load, upto)) / top).toFixed(2)}`;
    return Array.from({ length: classes }, (_, i) => [...this.loads.map((load) => point(load, i + 1)), ...[...this.loads].reverse().map((load) => point(load, i))].join(" "));
  }
}

export interface BitField {
  name: string;
  bits: { level: "d" | "r"; stuff: boolean; lost: string; wrong: boolean }[];
}

/** Bits by field; at each what lost the arbitration there. */
export function fields_of_frame(frame: NonNullable<TrafficView["frame"]>): BitField[] {
  const fields: BitField[] = [];
  frame.bits.forEach((bit, place) => {
    const lost = (frame.lost ?? []).filter((one) => one.bit === place).map((one) => `${one.name} (${one.can_id}H)`).join(", ");
    if (fields.at(-1)?.name !== bit.field) fields.push({ name: bit.field, bits: [] });
    fields.at(-1)!.bits.push({ level: bit.level, stuff: bit.stuff === true, lost, wrong: false });
  });
  return fields;
}

/** Bits of an error frame: of the frame up to the bit that was wrong, of the flags, of the delimiter. */
export function fields_of_error(bits: readonly { level: "d" | "r"; part: string }[]): BitField[] {
  const fields: BitField[] = [];
  for (const bit of bits) {
    if (fields.at(-1)?.name !== bit.part) fields.push({ name: bit.part, bits: [] });
    fields.at(-1)!.bits.push({ level: bit.level, stuff: false, lost: "", wrong: false });
  }
  const last = fields[0]?.name === "frame" ? fields[0].bits.at(-1) : undefined;
  if (last) last.wrong = true;
  return fields;
}
