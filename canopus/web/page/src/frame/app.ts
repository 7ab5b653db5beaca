// What all screens share: the store, commands, the address, the description at the right edge.
import type { TemplateResult } from "lit";
import { Connection } from "../store/connection.js";
import type { Command, Done } from "../store/commands.js";
import { FaultList } from "../store/faults.js";
import { Plots } from "../store/plots.js";
import { Project } from "../store/project.js";
import type { RunEvent, ViewWish } from "../store/protocol.js";
import { Store } from "../store/store.js";
import { Menu } from "./menu.js";
import { link, parse_route, type Route } from "./route.js";

export interface Screen {
  readonly id: string;
  readonly title: string;
  readonly icon: string;
  /** It has tables, plots or a filter with completion, which are loaded behind the first screen. */
  readonly needs_parts?: boolean;
  /** What the server is asked for while the screen is open. */
  wishes?(): ViewWish[];
  /** The address has led here, or to another thing of the screen. */
  opened?(route: Route): void;
  closed?(): void;
  view(): TemplateResult;
  /** Commands of the palette while the screen is open, and things that it can find. */
  places?(): Place[];
}

/** Something that Ctrl+K finds. */
export interface Place {
  title: string;
  detail: string;
  href?: string;
  run?: () => void;
  /** It is not known whether there is something. */
  is_guess?: boolean;
}

/** What the drawer at the right edge shows of what has the focus. */
export interface Description {
  title: string;
  readonly rows: [string, string | number | undefined][];
  /** Troubles, above the facts. */
  readonly lead?: readonly string[];
  /** "1017:00": the server is asked what it is for. */
  object?: string;
  /** Below the facts. */
  more?: () => TemplateResult;
}

export interface Said {
  text: string;
  mood: "" | "error" | "running";
}

/** A frame of the trace is wanted by another screen. */
export interface Picking {
  words: string;
  /** A CAN-ID, hexadecimal. */
  take: (bus: string, id: string) => void;
}

export class App {
  readonly store = new Store();
  readonly connection = new Connection(this.store);
  readonly plots = new Plots();
  readonly faults = new FaultList();
  private known_projects: Project[] | null = null;
  readonly menu = new Menu(this);
  route: Route = parse_route(location.hash);
  screens: Screen[] = [];
  description: Description | null = null;
  is_hexadecimal = false;
  /** Tables, plots and the filter with completion are loaded. */
  has_parts = false;
  picking: Picking | null = null;
  /** What became of the last command, for the line below the bar. */
  said: Said = { text: "", mood: "" };
  private is_drawing = false;
  private was_opened_by_itself = false;
  private followed: Screen | null = null;

  constructor(private readonly draw: () => void) {
    this.store.listen((event) => {
      if (event === null) this.follow_first();
      if (event?.event === "state" && this.store.state) this.plots.take_state(this.store.state);
      const values = event?.event === "values" ? this.store.view("values") : null;
      if (values) this.plots.take_values(values);
      if (event?.event === "audit") for (const one of this.known_projects ?? []) one.done_by_somebody(String((event as RunEvent)["do"]));
      this.redraw();
    });
  }

  /** At the next frame, once. */
  redraw(): void {
    if (this.is_drawing) return;
    this.is_drawing = true;
    const later = document.hidden ? (run: () => void) => setTimeout(run, 250) : requestAnimationFrame;
    later(() => {
      this.is_drawing = false;
      this.draw();
      this.connection.look_at(this.wishes());
    });
  }

  private wishes(): ViewWish[] {
    const meaning = this.is_described && this.description?.object ? [{ meaning: this.description.object }] : [];
    const values = this.plots.asked_keys();
    return [...(this.screen.wishes?.() ?? []), ...(values.length ? [{ values }] : []), ...meaning];
  }

  /** Of the buses that have one; read when they are first asked for. */
  get projects(): Project[] {
    const { hello } = this.store;
    if (!hello) return [];
    if (this.known_projects) return this.known_projects;
    this.known_projects = hello.buses.filter((bus) => bus.project).map((bus) => new Project(bus, (command) => this.connection.commands.run(command), () => this.project_changed()));
    for (const one of this.known_projects) void one.load();
    return this.known_projects;
  }

  /** Nodes of a live bus have the names of its project. */
  private project_changed(): void {
    this.store.set_live_nodes((this.known_projects ?? []).filter((one) => one.bus.live).flatMap((one) => one.nodes.map(({ node, name, product }) => ({ bus: one.bus.bus, node, name: name || (product ?? "") }))));
    this.redraw();
  }

  /** The project that has this node; null: none has. */
  project_with(bus: string, node: number): Project | null {
    return this.projects.find((one) => one.bus.bus === bus && one.node(node)) ?? null;
  }

  project_of(bus: string | undefined): Project | null {
    return this.projects.find((one) => one.bus.bus === bus) ?? this.projects[0] ?? null;
  }

  /** What the faults of the simulated buses are and have hit. */
  async load_faults(): Promise<void> {
    if (!this.store.offers("faults")) return;
    const done = await this.connection.commands.run({ command: "faults" });
    if (done.code === 0) this.faults.take(done.rows[0] as never);
    this.redraw();
  }

  /** A command that changes the files of a project, and what they say then. */
  async change(project: Project, command: Command, done = ""): Promise<Done & { failed: boolean }> {
    const result = await this.run({ ...command, bus: project.bus.bus }, done ? { done } : {});
    if (!result.failed) {
      const items = command["items"];
      if (command.command === "project set" && command["node"] && Array.isArray(items)) project.set_here(Number(command["node"]), items as string[]);
      await project.load();
    }
    return result;
  }

  /** Those that there is something for: the start page has no run, settings of a module alone have none, either, and a PLC need not have a program. */
  get shown_screens(): Screen[] {
    const { store } = this;
    if (store.offers("plants")) return this.screens.filter((one) => ["start", "events"].includes(one.id));
    if (store.hello && store.hello.buses.length === 0 && store.hello.settings.length) return this.screens.filter((one) => ["settings", "events"].includes(one.id));
    return this.screens.filter((one) => one.id !== "program" || store.state?.programs?.length || one === this.screen);
  }

  get screen(): Screen {
    // Without a screen in the address: what there is to do here.
    const first = this.store.offers("plants") ? "start" : this.store.hello && this.store.hello.buses.length === 0 ? "settings" : "overview";
    return this.screens.find((one) => one.id === this.route.screen) ?? this.screens.find((one) => one.id === first)!;
  }

  /** The greeting of the server may lead to another first screen. */
  private follow_first(): void {
    if (this.store.hello?.buses.some((bus) => bus.live && bus.project)) void this.projects;
    if (this.screens.length === 0 || this.screen === this.followed) return;
    this.followed?.closed?.();
    this.followed = this.screen;
    this.screen.opened?.(this.route);
  }

  /** Another screen begins; the old one is told. */
  follow(hash: string): void {
    const before = this.followed;
    this.route = parse_route(hash);
    this.followed = this.screen;
    if (this.screen !== before) {
      before?.closed?.();
      this.description = null;
      this.said = { text: "", mood: "" };
      if (this.was_opened_by_itself) document.documentElement.dataset["drawer"] = "off";
      this.was_opened_by_itself = false;
    }
    this.screen.opened?.(this.route);
    this.redraw();
  }

  go(screen: string, path: readonly (string | number)[] = [], query: Record<string, string | number | undefined> = {}): void {
    location.hash = link(screen, path, query);
  }

  /** The address says what is shown, without a step of the history. */
  keep(screen: string, path: readonly (string | number)[], query: Record<string, string | number | undefined>): void {
    const address = link(screen, path, query);
    if (location.hash === address) return;
    history.replaceState(null, "", address);
    this.route = parse_route(address);
  }

  describe(description: Description | null, opens = false): void {
    this.description = description;
    if (description === null && this.was_opened_by_itself) {
      document.documentElement.dataset["drawer"] = "off";
      this.was_opened_by_itself = false;
    }
    if (opens && !this.is_described) {
      // It goes again with the screen; what was opened by hand stays.
      document.documentElement.dataset["drawer"] = "on";
      this.was_opened_by_itself = true;
    }
    this.redraw();
  }

  /** The next frame that is chosen in the trace goes to who asked for it; null: nobody asks any more. */
  pick(picking: Picking | null): void {
    this.picking = picking;
    this.redraw();
  }

  /** The description takes room that tables need: they leave out what it shows. */
  get is_narrow(): boolean {
    return this.is_described && innerWidth < 1500;
  }

  get is_described(): boolean {
    return document.documentElement.dataset["drawer"] === "on";
  }

  show_description(on: boolean): void {
    this.was_opened_by_itself = false;
    document.documentElement.dataset["drawer"] = on ? "on" : "off";
    try {
      localStorage.setItem("canopus drawer", on ? "on" : "off");
    } catch {
      // The browser keeps nothing.
    }
    this.redraw();
  }

  say(text: string, mood: Said["mood"] = ""): void {
    this.said = { text, mood };
    this.redraw();
  }

  /** Runs a command and says what became of it; `fine`: codes that are no failure, `done`: the sentence then. */
  async run(command: Command, options: { done?: string; fine?: number[]; progress?: (rows: Record<string, unknown>[]) => void } = {}): Promise<Done & { failed: boolean }> {
    this.say(`${command.command} …`, "running");
    const done = await this.connection.commands.run(command, options.progress ?? (() => undefined));
    const failed = !(options.fine ?? [0]).includes(done.code);
    if (failed) this.say(done.message || `failed with code ${done.code}`, "error");
    else this.say(options.done ?? done.message ?? "");
    return { ...done, failed };
  }
}
