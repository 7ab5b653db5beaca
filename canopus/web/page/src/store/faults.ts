// Faults of simulated buses: those that somebody edits here, beside those that act now. Run has the edited ones begin anew.

export interface ActingFault {
  text: string;
  on: boolean;
  from_file: boolean;
  hits?: number;
  active?: boolean;
}

export interface EditedFault {
  text: string;
  on: boolean;
  from_file: boolean;
}

export interface BusFaults {
  bus: string;
  seed: number;
  ports: string[];
  edited: EditedFault[];
  acting: ActingFault[];
  is_changed: boolean;
  /** Why the last Run was refused. */
  problem: string;
}

export interface FaultStatus {
  words: string;
  mood: "" | "acting" | "waiting";
}

export class FaultList {
  buses: BusFaults[] = [];
  is_known = false;

  bus(name: string): BusFaults | undefined {
    return this.buses.find((one) => one.bus === name) ?? this.buses[0];
  }

  /** The answer of `faults` and of `run faults`. What somebody edits stays; so does the object of a bus, which open menus and forms have. */
  take(row: { buses: { bus: string; seed: number; ports: string[]; faults: ActingFault[] }[] }): void {
    this.is_known = true;
    this.buses = row.buses.map((one) => {
      const known = this.buses.find((bus) => bus.bus === one.bus) ?? { bus: one.bus, seed: 0, ports: [], edited: [], acting: [], is_changed: false, problem: "" };
      Object.assign(known, { ports: one.ports, acting: one.faults });
      if (!known.is_changed) Object.assign(known, { seed: one.seed, edited: one.faults.map(({ text, on, from_file }) => ({ text, on, from_file })) });
      return known;
    });
  }

  add(bus: string, text: string): void {
    const list = this.bus(bus);
    if (!list) return;
    list.edited = [...list.edited, { text, on: true, from_file: false }];
    list.is_changed = true;
  }

  /** Another text, on or off; null: removed. */
  change(bus: string, place: number, fault: EditedFault | null): void {
    const list = this.bus(bus);
    if (!list) return;
    list.edited = list.edited.flatMap((one, i) => (i !== place ? [one] : fault ? [fault] : []));
    list.is_changed = true;
  }

  ran(bus: string, problem: string): void {
    const list = this.bus(bus);
    if (!list) return;
    list.problem = problem;
    if (!problem) list.is_changed = false;
  }

  /** Some act, so that their hits are asked for. */
  get acts(): boolean {
    return this.buses.some((bus) => bus.acting.some((one) => one.on));
  }
}

const struck = (fault: ActingFault): string => (fault.active ? "acting now" : `${fault.hits ?? 0} ${fault.hits === 1 ? "frame" : "frames"} hit`);

/** What is to be said of each edited fault, and of those that act until Run though they were removed. */
export function fault_status(edited: readonly EditedFault[], acting: readonly ActingFault[]): { edited: FaultStatus[]; left: { text: string; words: string }[] } {
  const rest = acting.filter((fault) => fault.on);
  const statuses = edited.map(({ text, on }): FaultStatus => {
    const place = rest.findIndex((fault) => fault.text === text);
    const found = place < 0 ? undefined : rest.splice(place, 1)[0];
    if (!found) return on ? { words: "not yet run", mood: "waiting" } : { words: "off", mood: "" };
    return on ? { words: struck(found), mood: "acting" } : { words: `${struck(found)}; acts until Run`, mood: "waiting" };
  });
  return { edited: statuses, left: rest.map((fault) => ({ text: fault.text, words: `${struck(fault)}; removed here, acts until Run` })) };
}
