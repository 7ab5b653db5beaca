// The boot of each slave as a bar of its steps; the failed step with what was expected and found, what to do, Retry.
import { html, nothing, svg, type TemplateResult } from "lit";
import { repeat } from "lit/directives/repeat.js";
import type { App, Screen } from "../../frame/app.js";
import { head } from "../../frame/head.js";
import { iconGanttchart } from "../../frame/icons.js";
import { link, type Route } from "../../frame/route.js";
import { count_text } from "../../store/nodes.js";
import type { BootsView, ViewWish } from "../../store/protocol.js";
import { axis, duration_text, facts_of, newest_attempt, reason_and_remedy, sorted_slaves, spans_of, type Span } from "./waterfall.js";

type Slave = BootsView["slaves"][number];
const key_of = (slave: { bus: string; node: number }): string => `${slave.bus}/${slave.node}`;

export class BootScreen implements Screen {
  readonly id = "boot";
  readonly title = "Boot";
  readonly icon = iconGanttchart;
  private open = new Set<string>();

  constructor(private readonly app: App) {}

  opened(route: Route): void {
    if (route.query["node"]) this.open.add(route.query["node"]);
  }

  wishes(): ViewWish[] {
    return [{ boots: true }];
  }

  private retry(slave: Slave, halted: boolean): TemplateResult | typeof nothing {
    const { store } = this.app;
    if (!store.may_operate || !store.joins(slave.bus) || halted) return nothing;
    return html`<ix-button variant="secondary" title=${`Master ${slave.master} resets the communication of node ${slave.node} and boots it anew`} aria-label=${`Retry the boot of node ${slave.node}`}
      @click=${() => void this.app.run({ command: "boot retry", bus: slave.bus, node: String(slave.node), master: String(slave.master) }, { done: `node ${slave.node} is booted anew` })}>Retry</ix-button>`;
  }

  private step_row(slave: Slave, span: Span): TemplateResult {
    return html`<tr class=${span.kind === "failed" ? "bad" : ""}><td class="figure"><a href=${link("trace", [], { filter: `node=${slave.node}`, at: span.t.toFixed(6) })} title="Frames of this moment">${span.t.toFixed(3)} s</a></td>
      <td class="figure">${span.kind === "done" || span.kind === "failed" ? "" : duration_text(span.end - span.t)}</td><td>${span.step}</td><td>${facts_of(span).filter(([, value]) => value !== undefined).map(([name, value]) => `${name} ${value}`).join(", ")}</td></tr>`;
  }

  private slave(slave: Slave, spans: Span[], place: (time: number) => number, halted: boolean): TemplateResult {
    const key = key_of(slave);
    const last = spans.at(-1);
    if (!last) return html``;
    const newest = newest_attempt(spans);
    const is_open = this.open.has(key);
    const [reason, remedy] = reason_and_remedy(last.reason ?? "");
    const result = last.kind === "done" ? `booted in ${duration_text(last.t - (newest[0]?.t ?? last.t))}` : last.step;
    const bars = spans.map((span, i) => {
      const x = 1000 * place(span.t);
      return svg`<rect x=${x} y="0" height="16" width=${Math.max(1000 * place(span.end) - x, span.kind ? 5 : 2)} class=${`step step-${i % 2} ${span.kind}`}><title>${span.step}, ${duration_text(span.end - span.t)}</title></rect>`;
    });
    return html`<li class="boot" data-kind=${last.kind}>
      <div class="boot-line"><button type="button" class="fault-name" aria-expanded=${is_open} @click=${() => { if (is_open) this.open.delete(key); else this.open.add(key); this.app.redraw(); }}><b>${slave.node}</b> ${slave.name || `Node ${slave.node}`}${this.app.store.state && this.app.store.state.buses.length > 1 ? html` <span class="faint">${slave.bus}</span>` : nothing}</button>
        <svg class="waterfall" viewBox="0 0 1000 16" preserveAspectRatio="none" role="img" aria-label=${`Boot of node ${slave.node}: ${result}`}>${bars}</svg>
        <span class="result">${result}</span>${last.kind === "failed" || last.kind === "retry" ? this.retry(slave, halted) : html`<span></span>`}</div>
      ${last.kind !== "done" && reason ? html`<div class="why"><p>${reason}</p>
        <dl class="inline-facts">${facts_of(last).filter(([, value]) => value !== undefined).map(([name, value]) => html`<div><dt>${name}</dt><dd>${value}</dd></div>`)}</dl>
        ${remedy ? html`<p><b>What to do</b> ${remedy}</p>` : nothing}
        <p class="buttons"><a href=${link("trace", [], { filter: `node=${slave.node}`, at: last.t.toFixed(6) })}>Frames of this moment</a><a href=${link("overview", [], { node: this.app.store.nodes.find((one) => one.bus === slave.bus && one.node === slave.node)?.key })}>Node</a></p></div>` : nothing}
      ${is_open ? html`<table class="rows steps"><thead><tr><th scope="col">At</th><th scope="col">Took</th><th scope="col">Step</th><th scope="col">Details</th></tr></thead><tbody>${spans.map((span) => this.step_row(slave, span))}</tbody></table>` : nothing}</li>`;
  }

  private halt(master: BootsView["masters"][number]): TemplateResult {
    const { store } = this.app;
    return html`<div class="boot" data-kind="failed"><div class="why"><p>${master.bus}: master ${master.node} ${master.name} has halted its start-up, because a mandatory slave was not booted. It boots no slave until its next start-up.</p>
      ${store.may_operate && store.joins(master.bus) ? html`<ix-button @click=${() => void this.app.run({ command: "boot retry all", bus: master.bus, node: "all", master: String(master.node) }, { done: "start-up begins anew" })}>Retry start-up</ix-button>` : nothing}</div></div>`;
  }

  view(): TemplateResult {
    const view = this.app.store.view("boots");
    if (!view) return html`${head("Boot", "")}<p class="faint">Waiting for the run …</p>`;
    const all = sorted_slaves(view).map((slave) => ({ slave, spans: spans_of(slave.steps, view.t) }));
    const place = axis(all.flatMap((one) => one.spans));
    const halted = view.masters.filter((one) => one.start_up === "halted");
    const done = all.filter((one) => one.spans.at(-1)?.kind === "done").length;
    if (all.length === 0) return html`${head("Boot", "")}<ix-empty-state header="No slave is booted" sub-header="No module of this plant is the NMT master of a slave"></ix-empty-state>`;
    return html`${head("Boot", `${done} of ${count_text(all.length, "slave")} booted`)}
      <div class="scrolls"><div class="boots">${halted.map((one) => this.halt(one))}
      <ul class="boots">${repeat(all, (one) => key_of(one.slave), ({ slave, spans }) => this.slave(slave, spans, place, halted.some((one) => one.bus === slave.bus && one.node === slave.master)))}</ul></div></div>`;
  }
}
