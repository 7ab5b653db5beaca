// The PDOs of a project: who sends what to whom, each frame's bits, and signals that are linked by dragging one onto the other.
import { make, set_text } from "./dom.js";
import { transmission_words } from "./value_words.js";

const most_signals = 200;
const percent = (share) => `${(100 * share).toFixed(1)} %`;
const hex = (id) => `${id.toString(16).toUpperCase().padStart(3, "0")}H`;

/// The 64 bits of a frame: one block for each mapped object.
function strip(pdo) {
  const blocks = pdo.mapping.flatMap((one, i) => {
    const title = make("svg:title", {}, `${one.name ?? "not used"}: bits ${one.bit} to ${one.bit + one.bits - 1}`);
    const block = make("svg:rect", { x: one.bit, y: 0, width: one.bits, height: 6, class: one.object ? `signal-${i % 6}` : "unused" });
    block.append(title);
    return [block];
  });
  return make("svg:svg", { class: "frame-strip", viewBox: "0 0 64 6", preserveAspectRatio: "none", role: "img",
    "aria-label": pdo.mapping.map((one) => `${one.name ?? "not used"} ${one.bits} bits`).join(", ") || "nothing is mapped" }, ...blocks);
}

export class PdoView {
  /// `view`: of the project, which has the role and where the commands go.
  constructor(section, view) {
    this.section = section;
    this.view = view;
    this.from = null;   // node-IDs of the two lists
    this.to = null;
    this.taken = null;  // a signal that is to be linked: { node, object, name }
    this.preview = null;
    const part = (name) => section.querySelector(`#${name}`);
    [this.matrix, this.list, this.from_node, this.to_node, this.from_list, this.to_list, this.plan, this.plan_rows, this.plan_load, this.all, this.hint] =
      ["pdo-matrix", "pdo-list", "link-from-node", "link-to-node", "link-from", "link-to", "link-plan", "link-plan-rows", "link-plan-load", "pdo-all", "link-hint"].map(part);
    this.from_node.addEventListener("change", () => this.choose(Number(this.from_node.value), this.to));
    this.to_node.addEventListener("change", () => this.choose(this.from, Number(this.to_node.value)));
    this.all.addEventListener("change", () => this.view.draw());
    part("link-keep").addEventListener("click", () => this.keep());
    part("link-discard").addEventListener("click", () => this.discard());
    this.from_list.addEventListener("dragstart", (event) => {
      const button = event.target.closest("button");
      if (!button) return;
      this.take(button);
      event.dataTransfer.setData("text/plain", button.dataset.object);
      event.dataTransfer.effectAllowed = "link";
    });
    this.from_list.addEventListener("click", (event) => this.take(event.target.closest("button")));
    this.to_list.addEventListener("dragover", (event) => {
      if (!this.taken || !event.target.closest("button")) return;
      event.preventDefault();
      event.dataTransfer.dropEffect = "link";
    });
    this.to_list.addEventListener("drop", (event) => {
      event.preventDefault();
      this.link(event.target.closest("button"));
    });
    this.to_list.addEventListener("click", (event) => this.link(event.target.closest("button")));
  }

  choose(from, to) {
    this.from = from;
    this.to = to;
    this.taken = null;
    this.drawn_signals = "";
    this.view.draw();
  }

  /// The first half of a link: what is sent.
  take(button) {
    if (!button || !this.view.may_configure) return;
    this.taken = { node: this.from, object: button.dataset.object, name: button.dataset.name };
    for (const one of this.from_list.querySelectorAll("button")) one.setAttribute("aria-pressed", one === button);
    set_text(this.hint, `${this.taken.name} goes to …: drop it on a signal of the right list, or choose one there`);
  }

  /// The second half: what takes it. Both PDOs and the load are shown before it is kept.
  async link(button) {
    if (!button || !this.taken) return;
    const project = this.view.project;
    this.command = { command: "project pdo link", from: `${this.taken.node}.${this.taken.object}`, to: `${this.to}.${button.dataset.object}` };
    const done = await project.run({ ...this.command, dry_run: true });
    if (done.failed) return;
    this.preview = done.rows;
    set_text(this.hint, "");
    this.draw(project);
    if (done.rows.every((row) => row.pdo === undefined)) set_text(this.hint, "it is linked already");
    else this.section.querySelector("#link-keep").focus();
  }

  async keep() {
    this.preview = null;
    this.taken = null;
    this.drawn_signals = "";
    const project = this.view.project;
    await project.change(this.command);
  }

  discard() {
    this.preview = null;
    this.taken = null;
    this.drawn_signals = "";
    this.view.draw();
  }

  draw(project) {
    const nodes = project.nodes.filter((node) => node.tpdos !== undefined);
    this.section.hidden = nodes.length === 0;
    if (nodes.length === 0) return;
    if (!project.node(this.from)) this.from = nodes[0].node;
    if (!project.node(this.to)) this.to = (nodes.find((node) => node.node !== this.from) ?? nodes[0]).node;
    for (const id of [this.from, this.to]) project.load_objects(id);
    this.draw_matrix(project);
    this.draw_list(project);
    this.draw_signals(project, nodes);
    this.draw_preview(project);
  }

  /// Producers down, consumers across, the signals where they meet.
  draw_matrix(project) {
    const cells = new Map();
    for (const pdo of project.pdos) {
      for (const one of pdo.mapping) {
        for (const to of one.to ?? []) {
          const key = `${pdo.node} ${to.node}`;
          cells.set(key, [...(cells.get(key) ?? []), { pdo, name: one.name, to }]);
        }
      }
    }
    const text = JSON.stringify([...cells.keys(), project.pdos]);
    if (this.drawn_matrix === text) return;
    this.drawn_matrix = text;
    const rows = [...new Set([...cells.keys()].map((key) => Number(key.split(" ")[0])))].sort((a, b) => a - b);
    const columns = [...new Set([...cells.keys()].map((key) => Number(key.split(" ")[1])))].sort((a, b) => a - b);
    if (rows.length === 0) return this.matrix.replaceChildren(make("p", { class: "faint" }, "no signal goes from one node to another yet"));
    const head = make("tr", {}, make("th", { scope: "col" }, "from \\ to"), ...columns.map((id) => make("th", { scope: "col" }, project.label(id))));
    const body = rows.map((from) => make("tr", {}, make("th", { scope: "row" }, project.label(from)), ...columns.map((to) =>
      make("td", {}, ...(cells.get(`${from} ${to}`) ?? []).map(({ pdo, name }) =>
        make("div", { class: "crossing", title: `${pdo.pdo}, ${hex(pdo.can_id)}, ${transmission_words(pdo.transmission_type)}` }, `${name} `, make("span", { class: "faint" }, `${pdo.pdo} ${hex(pdo.can_id)}`)))))));
    this.matrix.replaceChildren(make("table", {}, make("thead", {}, head), make("tbody", {}, ...body)));
  }

  pdo_row(project, pdo) {
    const times = [pdo.inhibit_us ? `inhibit ${pdo.inhibit_us / 1000} ms` : "", pdo.event_ms ? `every ${pdo.event_ms} ms` : ""].filter(Boolean).join(", ");
    const ends = pdo.mapping.flatMap((one) => [...(one.to ?? []).map((end) => `${one.name} → ${project.label(end.node)}`), ...(one.from ?? []).map((end) => `${one.name} ← ${project.label(end.node)}`)]);
    return make("tr", { class: pdo.active ? "" : "faint" }, make("th", { scope: "row" }, project.label(pdo.node)), make("th", { scope: "row" }, pdo.pdo), make("td", {}, pdo.active ? hex(pdo.can_id) : "off"),
      make("td", {}, strip(pdo)), make("td", {}, `${pdo.bytes} bytes`), make("td", {}, [transmission_words(pdo.transmission_type), times].filter(Boolean).join(", ")),
      make("td", {}, pdo.mapping.map((one) => one.name ?? "not used").join(", ")), make("td", {}, ends.join(", ")));
  }

  draw_list(project) {
    const pdos = project.pdos.filter((pdo) => pdo.active || this.all.checked).slice(0, 600);
    const text = JSON.stringify([pdos, this.view.may_configure]);
    if (this.drawn_list === text) return;
    this.drawn_list = text;
    this.list.replaceChildren(...pdos.map((pdo) => {
      const row = this.pdo_row(project, pdo);
      const off = make("button", { type: "button", class: "plain", "aria-label": `Switch ${pdo.pdo} of node ${pdo.node} off` }, "Off");
      off.disabled = !this.view.may_configure;
      off.addEventListener("click", () => project.change({ command: "project pdo off", node: String(pdo.node), pdo: pdo.pdo }));
      const edit = make("button", { type: "button", class: "plain", "aria-label": `Change ${pdo.pdo} of node ${pdo.node}` }, "Change");
      edit.disabled = !this.view.may_configure;
      edit.addEventListener("click", () => this.edit(pdo));
      row.append(make("td", {}, edit, " ", pdo.active ? off : ""));
      return row;
    }));
  }

  /// CAN-ID, type, times and mapping of a PDO, to be changed.
  edit(pdo) {
    const project = this.view.project;
    const field = (name, value, hint) => make("input", { value, "aria-label": name, placeholder: hint, autocomplete: "off" });
    const can_id = field("CAN-ID", pdo.active ? `0x${pdo.can_id.toString(16).toUpperCase()}` : "free", "0x181, or free");
    const type = field("Transmission type", pdo.transmission_type, "0 to 240, 252 to 255");
    const inhibit = field("Inhibit time", pdo.inhibit_us === undefined ? "" : `${pdo.inhibit_us / 1000}ms`, "10ms");
    const event = field("Event timer", pdo.event_ms === undefined ? "" : `${pdo.event_ms}ms`, "100ms");
    const mapping = field("Mapped objects", pdo.mapping.filter((one) => one.object).map((one) => one.object).join(" "), "6000:01 6000:02");
    inhibit.disabled = pdo.inhibit_us === undefined;
    event.disabled = pdo.event_ms === undefined;
    const apply = make("button", { type: "submit" }, "Apply");
    const cancel = make("button", { type: "button" }, "Cancel");
    const form = make("form", { class: "ways" }, make("b", {}, `${project.label(pdo.node)} ${pdo.pdo}`), ...[["CAN-ID", can_id], ["Type", type], ["Inhibit time", inhibit], ["Event timer", event], ["Mapped", mapping]]
      .map(([name, input]) => make("label", {}, `${name} `, input)), apply, cancel);
    cancel.addEventListener("click", () => form.remove());
    form.addEventListener("submit", async (submit) => {
      submit.preventDefault();
      const command = { command: "project pdo map", node: String(pdo.node), pdo: pdo.pdo, can_id: can_id.value.trim(), type: type.value.trim() };
      if (!inhibit.disabled) command.inhibit = inhibit.value.trim();
      if (!event.disabled) command.event = event.value.trim();
      const objects = mapping.value.split(/[\s,]+/).filter(Boolean);
      if (objects.join() !== pdo.mapping.filter((one) => one.object).map((one) => one.object).join()) command.items = objects;
      const done = await project.change(command);
      if (!done.failed) form.remove();
    });
    this.section.querySelector("#pdo-edit").replaceChildren(form);
    can_id.focus();
  }

  draw_signals(project, nodes) {
    const lists = [[this.from_node, this.from_list, this.from, "tpdo"], [this.to_node, this.to_list, this.to, "rpdo"]];
    const text = JSON.stringify([nodes.map((node) => [node.node, node.name]), this.from, this.to, lists.map(([, , id]) => project.objects.get(id)?.length ?? 0), project.pdos, this.view.may_configure]);
    if (this.drawn_signals === text) return;
    this.drawn_signals = text;
    for (const [select, list, id, kind] of lists) {
      select.replaceChildren(...nodes.map((node) => {
        const option = make("option", { value: node.node }, project.label(node.node));
        option.selected = node.node === id;
        return option;
      }));
      const signals = (project.objects.get(id) ?? []).filter((row) => row[kind] && !row.object.startsWith("00")).slice(0, most_signals);
      list.replaceChildren(...signals.map((row) => {
        const button = make("button", { type: "button", "data-object": row.object, "data-name": row.name, title: `${row.object} ${row.type}` }, row.name, " ", make("span", { class: "faint" }, `${row.object} ${row.type}`));
        if (kind === "tpdo") button.draggable = this.view.may_configure;
        button.disabled = !this.view.may_configure;
        return make("li", {}, button);
      }));
      if (signals.length === 0) list.replaceChildren(make("li", { class: "faint" }, project.objects.has(id) ? "nothing that can be mapped" : "…"));
    }
  }

  draw_preview(project) {
    const rows = (this.preview ?? []).filter((row) => row.pdo !== undefined);
    this.plan.hidden = rows.length === 0;
    if (rows.length === 0) return;
    // The sender's PDO may stay as it is; it is shown all the same.
    const sender = project.pdos.find((pdo) => pdo.node === this.taken?.node && pdo.pdo.startsWith("T") && pdo.active &&
      rows.some((row) => row.can_id === pdo.can_id && row.pdo !== pdo.pdo));
    if (sender && !rows.some((row) => row.node === sender.node && row.pdo === sender.pdo)) rows.unshift(sender);
    const dry = this.preview.find((row) => row.event === "dry run");
    set_text(this.plan_load, dry ? `Load ${percent(dry.load)} by timers and SYNC (now ${percent(dry.load_before)}), ${percent(dry.load_at_most)} at most (now ${percent(dry.load_at_most_before)})` : "");
    this.plan_rows.replaceChildren(...rows.map((row) => this.pdo_row(project, row)));
  }
}
