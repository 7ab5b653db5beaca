// A bus: load over time by class of frame, error counters, error frames, SYNC, and the last frame of a CAN-ID bit by bit.
import { html, nothing, svg, type TemplateResult } from "lit";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconNetworkWired } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { plot_button } from "../../parts/plot_button.js";
import { count_text, id_of, label_of, percent_text, type ShownNode } from "../../store/nodes.js";
import type { ErrorFrame, TimeFigures, TrafficView, ViewWish } from "../../store/protocol.js";
import { fields_of_error, fields_of_frame, LoadHistory, type BitField } from "./load.js";

/** "0.900 to 1.400 ms, mean 1.100 ms, jitter 0.500 ms" */
export function times_text({ least, mean, most }: TimeFigures): string {
  const [factor, unit] = most >= 1 ? ([1, "s"] as const) : most >= 0.001 ? ([1000, "ms"] as const) : ([1e6, "µs"] as const);
  const text = (seconds: number): string => (factor * seconds).toFixed(unit === "µs" ? 0 : 3);
  return `${text(least)} to ${text(most)} ${unit}, mean ${text(mean)} ${unit}, jitter ${text(most - least)} ${unit}`;
}

export function error_frame_text(one: ErrorFrame): string {
  return `${one.at.toFixed(6)} s: ${one.error} error in ${one.field}, bit ${one.bit}, found by ${one.name || "an external node"}${one.transmitter ? ", the sender" : ""}${one.finders > 1 ? ` and ${one.finders - 1} more` : ""}`;
}

export class BusScreen implements Screen {
  readonly id = "bus";
  readonly title = "Bus";
  readonly icon = iconNetworkWired;
  private name = "";
  private can_id = "";
  private history = new LoadHistory();
  private most_waiting = new Map<string, number>();

  constructor(private readonly app: App) {
    app.store.listen((event) => {
      const view = event?.event === "traffic" ? app.store.view("traffic") : null;
      if (view && view.number === this.number) this.history.take(view);
    });
  }

  opened(route: Route): void {
    const name = route.path[0] ?? this.name;
    if (name !== this.name) {
      this.history.forget();
      this.most_waiting.clear();
      this.app.store.forget_view("traffic");
    }
    this.name = name;
    this.can_id = /^([0-9A-F]{3}|[0-9A-F]{8})$/i.test(route.query["id"] ?? "") ? route.query["id"]!.toUpperCase() : "";
  }

  private get number(): number {
    const buses = this.app.store.state?.buses ?? [];
    const found = buses.findIndex((bus) => bus.bus === this.name);
    return found < 0 ? 0 : found;
  }

  wishes(): ViewWish[] {
    if (!this.app.store.state) return [];
    return [{ traffic: this.number, ...(this.can_id ? { can_id: parseInt(this.can_id, 16), ...(this.can_id.length === 8 ? { extended: true as const } : {}) } : {}) }];
  }

  private load(view: TrafficView): TemplateResult {
    const { history } = this;
    const last = history.loads.at(-1);
    const areas = history.areas(view.classes.length);
    return html`<section class="panel"><h2>Load by class of frame</h2>
      <div class="load-chart"><div class="axis"><span>${percent_text(history.top)}</span><span>0 %</span></div>
        <svg viewBox="0 0 1000 100" preserveAspectRatio="none" role="img" aria-label="Load over time">${areas.map((points, i) => svg`<polygon points=${points} class=${`class-${i}`}/>`)}</svg></div>
      <ul class="legend">${view.classes.map((one, i) => (one.frames ? html`<li><span class=${`swatch class-${i}`}></span>${one.class} ${percent_text(last?.shares[i] ?? 0)}, ${count_text(one.frames, "frame")}</li>` : nothing))}</ul>
      <p class="faint">${view.sync ? `SYNC: ${view.sync.count + 1} times, every ${times_text(view.sync)}` : "No SYNC is sent, or only one so far."}</p></section>`;
  }

  private counter(name: string, value: number): TemplateResult {
    return html`<svg class="counter" viewBox="0 0 260 10" preserveAspectRatio="none" role="img" aria-label=${`${name} ${value}`}>
      ${svg`<rect x="0" y="2" height="6" width=${Math.min(260, value)} class=${value > 127 ? "failed" : value >= 96 ? "warned" : ""}/>`}${[96, 128, 256].map((x) => svg`<line x1=${x} x2=${x} y1="0" y2="10"/>`)}</svg>`;
  }

  private node_row(node: ShownNode): TemplateResult {
    const { own } = node;
    if (!own) return html``;
    const most = Math.max(own.waiting, this.most_waiting.get(node.key) ?? 0);
    this.most_waiting.set(node.key, most);
    const number = (field: "tec" | "rec"): TemplateResult => plot_button(this.app, `state ${node.bus} ${node.node} ${field}`, `${field.toUpperCase()} of ${label_of(node)}`, String(own[field]));
    return html`<tr><th scope="row"><a href=${link("overview", [], { node: node.key })}>${id_of(node)} ${label_of(node)}</a></th><td class="figure">${number("tec")}</td><td>${this.counter("TEC", own.tec)}</td><td class="figure">${number("rec")}</td><td>${this.counter("REC", own.rec)}</td>
      <td class=${own.controller === "error active" ? "" : "bad"}>${own.controller}</td><td class="figure">${own.waiting}</td><td class="figure">${most}</td><td>${node.sdo ? times_text(node.sdo) : html`<span class="faint">none</span>`}</td></tr>`;
  }

  private bits(fields: readonly BitField[]): TemplateResult {
    return html`<div class="bit-fields">${fields.map((field) => html`<div class="bit-field"><span class="faint">${field.name}</span><span class="bits">${field.bits.map((bit) => html`<span class="bit ${bit.level} ${bit.stuff ? "stuff" : ""} ${bit.lost ? "lost" : ""} ${bit.wrong ? "wrong" : ""}" title=${bit.lost ? `arbitration lost here: ${bit.lost}` : bit.stuff ? "stuff bit" : nothing}>${bit.level === "d" ? 0 : 1}</span>`)}</span></div>`)}</div>`;
  }

  private errors(view: TrafficView): TemplateResult {
    const newest = view.error_frames[0];
    return html`<section class="panel"><h2>Error frames</h2>${view.errors.length === 0 ? html`<p class="faint">None since the start</p>` : html`<table class="rows"><thead><tr><th scope="col">Error</th><th scope="col">Found in</th><th scope="col">Count</th></tr></thead><tbody>${view.errors.map((one) => html`<tr><td>${one.error}</td><td>${one.field}</td><td class="figure">${one.count}</td></tr>`)}</tbody></table>
      <h3>The latest</h3><ul>${view.error_frames.map((one) => html`<li><a href=${link("trace", [], { at: one.at.toFixed(6) })}>${error_frame_text(one)}</a></li>`)}</ul>${newest?.bits ? this.bits(fields_of_error(newest.bits)) : nothing}`}</section>`;
  }

  private strip(view: TrafficView): TemplateResult {
    const frame = view.frame?.can_id === this.can_id ? view.frame : null;
    return html`<section class="panel"><h2>Bits of the last frame of a CAN-ID</h2>
      <p class="ids" role="group" aria-label="CAN-IDs that were on the bus">${view.can_ids.length === 0 ? html`<span class="faint">No frame was on this bus</span>` : view.can_ids.map((id) => html`<a href=${link("bus", [view.bus], { id })} aria-current=${id === this.can_id ? "true" : nothing}>${id}</a>`)}</p>
      ${frame ? html`<p>${frame.can_id}H, DLC ${frame.dlc}, ${frame.remote ? "remote" : frame.data || "no data"}, ${count_text(frame.bits.length, "bit")}, ${frame.bits.filter((bit) => bit.stuff).length} of them stuff bits, at ${frame.at.toFixed(6)} s</p>
        ${this.bits(fields_of_frame(frame))}
        <p class="faint">${frame.lost ? (frame.lost.length ? `Lost the arbitration to it: ${frame.lost.map((one) => `${one.name} (${one.can_id}H) at bit ${one.bit}`).join(", ")}. ` : "No other node began to send with it. ") : ""}0 dominant, 1 recessive; stuff bits have a frame.</p>` : this.can_id ? html`<p class="faint">Waiting for a frame of ${this.can_id}H …</p>` : nothing}</section>`;
  }

  view(): TemplateResult {
    const { app } = this;
    const { state, nodes } = app.store;
    const bus = state?.buses[this.number];
    const view = app.store.view("traffic");
    if (!state || !bus) return html`${head("Bus", "")}<p class="faint">Waiting for the run …</p>`;
    const shown = view?.number === this.number ? view : null;
    const own = nodes.filter((node) => node.bus === bus.bus && node.own).sort((a, b) => a.node - b.node);
    return html`${head("Bus", `${bus.bit_rate / 1000} kbit/s, ${count_text(bus.frames, "frame")}, ${count_text(bus.error_frames, "error frame")}, load ${percent_text(bus.now)}, peak ${percent_text(bus.peak)}`)}
      ${state.buses.length > 1 ? html`<div class="tools"><div class="parts" role="group" aria-label="Bus">${state.buses.map((one) => html`<a href=${link("bus", [one.bus])} aria-current=${one === bus ? "page" : nothing}>${one.bus}</a>`)}</div></div>` : nothing}
      <div class="scrolls panels" tabindex="0" role="region" aria-label=${`Bus ${bus.bus}`}>
        ${shown ? this.load(shown) : html`<p class="faint">Counting …</p>`}
        <section class="panel"><h2>Error counters</h2>${own.length === 0 ? html`<p class="faint">No node of the plant is on this bus</p>` : html`<div class="wide"><table class="rows"><thead><tr>${["Node", "TEC", "96 · 128 · 256", "REC", "96 · 128 · 256", "Controller", "Queued", "Most queued", "SDO answers after"].map((name) => html`<th scope="col">${name}</th>`)}</tr></thead><tbody>${own.map((node) => this.node_row(node))}</tbody></table></div>`}</section>
        ${shown ? html`${this.errors(shown)}${this.strip(shown)}` : nothing}</div>`;
  }
}
