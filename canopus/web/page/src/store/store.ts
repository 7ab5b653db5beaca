// The state of a run as the page knows it: fed by the server's events alone, without a browser. Who shows it asks to be called when it has changed.
import { next_rates, nodes_of, type ProjectLabel, type Rates, type ShownNode } from "./nodes.js";
import type { Hello, RunEvent, RunState, ServerEvent, View, ViewKind } from "./protocol.js";
import { view_kinds } from "./protocol.js";
import { event_mood, sentence, type EventMood } from "./sentences.js";

export interface EventLine {
  n: number;
  t: number;
  kind: string;
  mood: EventMood;
  text: string;
  event: RunEvent;
}

/** A warning or an error, with how often it came. */
export interface Trouble {
  text: string;
  mood: EventMood;
  count: number;
  first: number;
  last: number;
  event: RunEvent;
}

export type Connection = "connecting" | "open" | "silent" | "lost";

/** The same trouble, whatever it measures: "12.5 ms late" and "80.1 ms late" are one. */
const kind_of = (text: string): string => text.replace(/\d+\.\d+/g, "#");

type ViewOf<K extends ViewKind> = Extract<View, { event: K }>;

const most_events = 20_000;
const most_troubles = 200;
const silent_after = 3000;  // ms without a message: the server sends a state four times a second

export class Store {
  connection: Connection = "connecting";
  state: RunState | null = null;
  /** When the state came, ms of `now`. */
  state_at = 0;
  hello: Hello | null = null;
  nodes: ShownNode[] = [];
  /** Nodes of projects on live buses. */
  private live_nodes: readonly ProjectLabel[] = [];
  events: EventLine[] = [];
  /** Grows with every event; the number of the next one. */
  event_count = 0;
  troubles: Trouble[] = [];
  /** ms of `now`; 0: writes are not armed. */
  armed_until = 0;
  private views = new Map<ViewKind, View>();
  private rates = new Map<string, Rates>();
  private received_at = 0;
  private listeners = new Set<(event: ServerEvent | null) => void>();

  /** `listener`: called with each event after the store has applied it, and with null when something else has changed. */
  listen(listener: (event: ServerEvent | null) => void): () => void {
    this.listeners.add(listener);
    return () => this.listeners.delete(listener);
  }

  view<K extends ViewKind>(kind: K): ViewOf<K> | null {
    return (this.views.get(kind) as ViewOf<K> | undefined) ?? null;
  }

  forget_view(kind: ViewKind): void {
    this.views.delete(kind);
  }

  receive(list: readonly ServerEvent[], now: number): void {
    this.received_at = now;
    if (this.connection === "silent") this.connection = "open";
    for (const event of list) {
      this.apply(event, now);
      for (const listener of this.listeners) listener(event);
    }
  }

  private apply(event: ServerEvent, now: number): void {
    if (event.event === "state") {
      this.state = event as RunState;
      this.state_at = now;
      this.rates = next_rates(this.rates, this.state);
      this.nodes = nodes_of(this.state, this.rates, this.live_nodes);
    } else if ((view_kinds as readonly string[]).includes(event.event)) {
      this.views.set(event.event as ViewKind, event as View);
    } else if (!["reply", "messages", "load"].includes(event.event)) {
      this.add_event(event as RunEvent);
    }
  }

  private add_event(event: RunEvent): void {
    const line: EventLine = { n: this.event_count++, t: event.t, kind: event.event, mood: event_mood(event), text: sentence(event), event };
    this.events.push(line);
    if (this.events.length > most_events + 1000) this.events.splice(0, this.events.length - most_events);
    if (line.mood !== "") this.add_trouble(line);
  }

  /** The newest first; what was there before is counted, and goes to the front. */
  private add_trouble(line: EventLine): void {
    const kind = kind_of(line.text);
    const place = this.troubles.findIndex((one) => kind_of(one.text) === kind);
    const before = place >= 0 ? this.troubles.splice(place, 1)[0] : undefined;
    this.troubles.unshift({ text: line.text, mood: line.mood, count: (before?.count ?? 0) + 1, first: before?.first ?? line.t, last: line.t, event: line.event });
    if (this.troubles.length > most_troubles) this.troubles.length = most_troubles;
  }

  /** The server sends its latest events again. */
  opened(now: number): void {
    this.connection = "open";
    this.received_at = now;
    this.events = [];
    this.troubles = [];
    this.rates = new Map();
    this.views.clear();
    this.notify();
  }

  closed(): void {
    this.connection = "lost";
    this.notify();
  }

  set_live_nodes(nodes: readonly ProjectLabel[]): void {
    this.live_nodes = nodes;
    if (this.state) this.nodes = nodes_of(this.state, this.rates, nodes);
  }

  greeted(hello: Hello, now: number): void {
    this.hello = hello;
    this.set_armed(hello.armed_for, now);
  }

  set_armed(seconds: number, now: number): void {
    this.armed_until = seconds > 0 ? now + 1000 * seconds : 0;
    this.notify();
  }

  /** Whether the run says something still; a page that is hidden gets its messages late. */
  look_at_clock(now: number): void {
    if (this.connection === "open" && this.received_at > 0 && now - this.received_at > silent_after) {
      this.connection = "silent";
      this.notify();
    }
    if (this.armed_until > 0 && now >= this.armed_until) this.set_armed(0, now);
  }

  get is_live(): boolean {
    return this.state?.live === true || (this.hello?.buses.length === 0 && this.hello.settings.some((one) => one.live));
  }

  get may_operate(): boolean {
    return this.hello !== null && this.hello.role !== "look";
  }

  get may_configure(): boolean {
    return this.hello?.role === "configure";
  }

  offers(command: string): boolean {
    return this.hello?.offers.includes(command) ?? false;
  }

  /** Commands of the program can join this bus. */
  joins(bus: string): boolean {
    return this.hello?.buses.some((one) => one.bus === bus && one.joins) ?? false;
  }

  /** Seconds of plant time, which goes on between two states. */
  plant_time(now: number): number {
    if (!this.state) return 0;
    return this.state.t + (this.connection === "open" ? (this.state.speed * (now - this.state_at)) / 1000 : 0);
  }

  private notify(): void {
    for (const listener of this.listeners) listener(null);
  }
}
