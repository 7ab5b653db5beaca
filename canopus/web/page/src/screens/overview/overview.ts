// The buses, each as a line with its nodes; what is in trouble stands first, with its reason.
import { html, nothing, svg, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconDashboard, iconError, iconPlc, iconSuccess, iconWarning, iconGenericDevice } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { plot_button } from "../../parts/plot_button.js";
import { count_text, has_id, id_of, label_of, percent_text, type ShownNode } from "../../store/nodes.js";
import type { BusHalf, BusState } from "../../store/protocol.js";
import { add_device_files } from "../../parts/device_files.js";
import { card_line, half_of, sorted_troubles } from "./cards.js";
import { describe_node } from "./node_details.js";
import { nmt_menu } from "./nmt.js";

const icons = { error: iconError, warning: iconWarning, off: iconGenericDevice, good: iconSuccess };
const mood_words = { error: "in trouble", warning: "attention", off: "switched off", good: "in operation" };

export class OverviewScreen implements Screen {
  readonly id = "overview";
  readonly title = "Overview";
  readonly icon = iconDashboard;
  private chosen = "";

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    const key = route.query["node"] ?? "";
    if (key === this.chosen) return;
    this.chosen = key;
    this.describe(key !== "");
  }

  closed(): void {
    this.chosen = "";
  }

  private describe(opens: boolean): void {
    const node = this.app.store.nodes.find((one) => one.key === this.chosen);
    if (node) this.app.describe(describe_node(this.app, node.key), opens);
    else if (!this.chosen) this.app.describe(null);
  }

  private choose(node: ShownNode): void {
    this.chosen = node.key;
    this.app.keep("overview", [], { node: node.key });
    this.app.describe(describe_node(this.app, node.key), true);
  }

  private key(event: KeyboardEvent): void {
    const cards = [...(event.currentTarget as HTMLElement).querySelectorAll<HTMLElement>(".node")];
    const at = cards.indexOf(document.activeElement as HTMLElement);
    if (at < 0) return;
    const columns = cards.filter((card) => card.offsetTop === cards[0]?.offsetTop).length;
    const step = { ArrowRight: 1, ArrowLeft: -1, ArrowDown: columns, ArrowUp: -columns }[event.key];
    if (!step) return;
    event.preventDefault();
    cards[Math.max(0, Math.min(at + step, cards.length - 1))]?.focus();
  }

  private card(node: ShownNode): TemplateResult {
    const kind = node.own?.module ? "module" : node.own ? "device" : "external";
    return html`<li><button type="button" class="node" data-mood=${node.mood} data-kind=${kind} aria-pressed=${node.key === this.chosen} title=${node.troubles[0] ?? `${label_of(node)}: ${mood_words[node.mood]}`} @click=${() => this.choose(node)}>
      <span class="id">${id_of(node)}</span><span class="name">${label_of(node)}</span>${node.own?.module ? html`<ix-icon aria-hidden="true" name=${iconPlc} size="16"></ix-icon>` : nothing}
      <ix-icon aria-hidden="true" class="mood" name=${icons[node.mood]} size="16"></ix-icon>
      <span class="line">${card_line(node)}</span></button></li>`;
  }

  private trouble(node: ShownNode): TemplateResult {
    return html`<li><button type="button" class="trouble" data-mood=${node.mood} aria-pressed=${node.key === this.chosen} @click=${() => this.choose(node)}>
      <ix-icon aria-hidden="true" name=${icons[node.mood]} size="16"></ix-icon><span class="id">${id_of(node)}</span><span class="name">${label_of(node)}</span><span class="reason">${node.troubles[0] ?? node.state}</span>
      ${node.troubles.length > 1 ? html`<span class="faint">+${node.troubles.length - 1}</span>` : nothing}</button></li>`;
  }

  /** `peak`: of a whole bus; half a bus has none. */
  private load(name: string, now: number, peak?: number): TemplateResult {
    const load = percent_text(now);
    return html`<span class="load-line"><svg class="load" viewBox="0 0 100 8" preserveAspectRatio="none" role="img" aria-label=${`Load ${load}`}><rect class="track" width="100" height="8"/><rect class="now" height="8" width=${100 * now}/>${peak === undefined ? nothing : svg`<line y1="0" y2="8" x1=${100 * peak} x2=${100 * peak}/>`}</svg>
      ${peak === undefined ? html`<span>load ${load}</span>` : html`${plot_button(this.app, `bus ${name} now`, `load of ${name}, %`, `load ${load}`)}<span class="faint">peak ${percent_text(peak)}</span>`}</span>`;
  }

  private cards(nodes: readonly ShownNode[], label: string): TemplateResult {
    return html`<div class="wire"></div><ul class="nodes ${nodes.length > 24 ? "dense" : ""}" aria-label=${label} @keydown=${(event: KeyboardEvent) => this.key(event)}>${repeat(nodes, (node) => node.key, (node) => this.card(node))}</ul>`;
  }

  /** The wire is cut: each half is a bus by itself. */
  private half(bus: BusState, half: BusHalf, place: number, nodes: readonly ShownNode[]): TemplateResult {
    const own = nodes.filter((node) => half_of(bus, node) === place);
    const name = place === 0 ? "Near half" : "Far half";
    return html`<section class="half-bus" aria-label=${`${name} of ${bus.bus}`}><p class="half-head"><b>${name}</b>${this.load(bus.bus, half.now)}<span class=${half.error_frames ? "bad" : "faint"}>${count_text(half.error_frames, "error frame")}</span></p>${this.cards(own, `${name} of ${bus.bus}`)}</section>`;
  }

  private async drop(bus: BusState, event: DragEvent): Promise<void> {
    event.preventDefault();
    const project = this.app.store.hello?.buses.some((one) => one.bus === bus.bus && one.project) ? this.app.project_of(bus.bus) : null;
    if (!project) return this.app.say(`${bus.bus} has no project to add devices to`, "error");
    await add_device_files(this.app, project, [...(event.dataTransfer?.files ?? [])]);
  }

  private bus(bus: BusState): TemplateResult {
    const { store } = this.app;
    const nodes = store.nodes.filter((node) => node.bus === bus.bus).sort((a, b) => a.node - b.node);
    const troubles = sorted_troubles(nodes);
    const in_operation = nodes.filter((node) => node.in_operation && node.mood !== "error").length;
    return html`<section class="bus" aria-label=${`Bus ${bus.bus}`} data-gone=${bus.gone ? "" : nothing} @dragover=${(event: DragEvent) => { if (event.dataTransfer?.types.includes("Files")) event.preventDefault(); }} @drop=${(event: DragEvent) => void this.drop(bus, event)}>
      <header><h2><a href=${link("bus", [bus.bus])}>${bus.bus}</a></h2>
        <span class="faint">${bus.bit_rate / 1000} kbit/s · ${bus.gone ? "GONE: nothing is received or sent" : bus.link === "sim" ? "simulated" : bus.link}</span>
        ${store.state && store.state.buses.length > 1 ? html`<span>${in_operation} of ${count_text(nodes.length, "node")} in operation</span>` : nothing}
        ${bus.cut ? html`<b class="bad">The wire is cut</b>` : this.load(bus.bus, bus.now, bus.peak)}
        <span class="faint frame-count">${count_text(bus.frames, "frame")}</span><span class=${bus.error_frames ? "bad" : "faint"}>${count_text(bus.error_frames, "error frame")}</span>
        <span class="grows"></span>${nmt_menu(this.app, bus.bus, "all", `all nodes of ${bus.bus}`)}</header>
      ${troubles.length ? html`<ul class="troubles">${repeat(troubles, (node) => node.key, (node) => this.trouble(node))}</ul>` : nothing}
      ${bus.cut ? html`<div class="cut-bus">${bus.cut.map((half, i) => this.half(bus, half, i, nodes))}</div>` : nodes.length ? this.cards(nodes, `Nodes of ${bus.bus}`) : nothing}
      ${nodes.length === 0 ? html`<p class="faint">No node on this bus. ${store.joins(bus.bus) ? html`<a href=${link("scan", [bus.bus])}>Scan</a> finds devices.` : nothing}</p>` : nothing}
    </section>`;
  }

  view(): TemplateResult {
    const { store } = this.app;
    if (!store.state) return html`${head("Overview", "")}<p class="faint">Waiting for the run …</p>`;
    if (this.chosen && !this.app.description) this.describe(true);
    const nodes = store.nodes;
    const well = nodes.filter((node) => node.in_operation && node.mood !== "error").length;
    const errors = nodes.filter((node) => node.mood === "error").length;
    const about = nodes.length ? `${well} of ${count_text(nodes.length, "node")} in operation${errors ? `, ${errors} in trouble` : ""}${nodes.some((one) => !has_id(one)) ? `, ${nodes.filter((one) => !has_id(one)).length} without a node-ID` : ""}` : "";
    return html`${head("Overview", about)}<div class="scrolls buses">${store.state.buses.map((bus) => this.bus(bus))}</div>`;
  }
}
