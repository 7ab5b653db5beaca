// A node in the description: the reason first if it is in trouble, then its figures, and what can be done.
import { html, nothing, type TemplateResult } from "lit";
import type { App, Description } from "../../frame/app.js";
import { link } from "../../frame/route.js";
import { plot_button } from "../../parts/plot_button.js";
import { has_id, id_of, is_late, label_of, not_seen, percent_text, seconds_text, type ShownNode } from "../../store/nodes.js";
import type { RunState } from "../../store/protocol.js";
import { nmt_buttons } from "./nmt.js";

export function node_facts(node: ShownNode, state: RunState): [string, string | number | undefined][] {
  const { own, slave, outside, heartbeat, sdo, rates } = node;
  const forced = state.forced.filter((one) => one.bus === node.bus && one.node === node.node && one.name === node.name).map((one) => one.text);
  return [
    ["NMT state", node.state],
    ["Kind", own ? (own.module ? "module" : "") : outside ? (node.state === not_seen ? "of the project, not seen on the bus yet" : "node of a live bus") : "external node (not in the plant file)"],
    ["Boot", slave ? `${slave.step}, by master ${slave.master}` : undefined],
    ["Identity", slave?.identity],
    ["Heartbeat", heartbeat ? `${seconds_text(heartbeat.age)} ago${heartbeat.period ? `, every ${seconds_text(heartbeat.period)}` : ""}${is_late(heartbeat) ? ": late" : ""}` : undefined],
    ["SDO answers", sdo ? `${sdo.count}, after ${seconds_text(sdo.least)} to ${seconds_text(sdo.most)}` : undefined],
    ["Frames", own ? `${own.frames}${rates?.frame_rate != null ? `, ${Math.round(rates.frame_rate)}/s, ${percent_text(rates.share ?? 0)} of the bus` : ""}` : undefined],
    ["Controller", own?.controller],
    ["Last emergency", own?.last_emcy ? `${own.last_emcy}H, ${own.emcy} in all` : undefined],
    ...forced.map((text): [string, string] => ["Forced", text]),
  ];
}

function more(app: App, node: ShownNode): TemplateResult {
  const { own } = node;
  const numbers: [string, keyof NonNullable<typeof own>][] = [["TEC", "tec"], ["REC", "rec"], ["PDOs sent", "pdos"], ["Emergencies", "emcy"]];
  return html`
    ${own && has_id(node) ? html`<h3>Counters</h3><p class="buttons">${numbers.map(([name, field]) => html`<span>${name} ${plot_button(app, `state ${node.bus} ${node.node} ${field}`, `${name} of ${label_of(node)}`, String(own[field]))}</span>`)}</p>` : nothing}
    <h3>Go to</h3><p class="buttons">
      ${own || node.outside ? html`<a href=${link("objects", [node.bus, node.node])}>Objects</a>` : nothing}
      ${has_id(node) ? html`<a href=${link("trace", [], { filter: `node=${node.node}` })}>Frames</a>` : nothing}
      ${node.slave ? html`<a href=${link("boot", [], { node: `${node.bus}/${node.node}` })}>Boot</a>` : nothing}
      ${own?.module ? html`<a href=${link("module", [app.store.state?.modules.findIndex((one) => one.bus === node.bus && one.name === node.name) ?? 0])}>Module</a>` : nothing}</p>
    ${has_id(node) && app.store.may_operate && app.store.joins(node.bus) ? html`<h3>NMT</h3>${nmt_buttons(app, node.bus, String(node.node), label_of(node))}` : nothing}`;
}

/** Its figures are those of the newest state whenever it is drawn. */
export function describe_node(app: App, key: string): Description {
  const find = (): ShownNode | undefined => app.store.nodes.find((one) => one.key === key);
  const first = find();
  return {
    title: first ? `${id_of(first)} ${label_of(first)}` : key,
    get rows() {
      const node = find();
      return node && app.store.state ? node_facts(node, app.store.state) : [["State", "not there any more"] as [string, string]];
    },
    get lead() {
      return find()?.troubles ?? [];
    },
    more: () => {
      const node = find();
      return node ? more(app, node) : html``;
    },
  };
}
