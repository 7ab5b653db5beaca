// What there is, at the left edge: buses with their nodes, modules, and the parts of the page. Each entry leads there.
import { make, set_text } from "./dom.js";

const parts = [["Boot", "boot-section"], ["Plots", "plots"], ["Faults", "faults-section"], ["Trace", "trace-section", "#trace"], ["Messages", "messages-section"], ["Events", "events-section"]];
const most_open = 40;  // nodes of a bus that is unfolded from the beginning

const entry = (href) => make("li", {}, make("a", { href }));

export class Tree {
  /// `open_node(key)`: what a click on a node does.
  constructor(element, open_node) {
    this.element = element;
    this.buses = make("ul", { "aria-label": "Buses" });
    this.modules = make("ul", { "aria-label": "Modules" });
    this.projects = make("ul", { "aria-label": "Projects" });
    this.parts = make("ul", { "aria-label": "Parts of the page" });
    element.replaceChildren(this.buses, this.modules, this.projects, this.parts);
    element.addEventListener("click", (event) => {
      const node = event.target.closest("button[data-node]");
      if (node) open_node(node.dataset.node);
    });
  }

  make_bus(name) {
    const fold = make("button", { type: "button", class: "fold", "aria-label": `Nodes of ${name}` });
    fold.addEventListener("click", () => fold.setAttribute("aria-expanded", fold.getAttribute("aria-expanded") !== "true"));
    return make("li", {}, fold, make("a", { href: "" }, name), make("span", { class: "badge", title: "nodes that want attention" }), make("ul", { "aria-label": `Nodes of ${name}` }));
  }

  /// `look`: what the page knows of a state (page.js).
  draw(state, look) {
    const { keep_children, nodes_of, key_of, name_of, mood_of } = look;
    keep_children(this.buses, state.buses, (bus) => bus.bus, (name) => this.make_bus(name), (item, bus) => {
      const [fold, link, badge, list] = item.children;
      const nodes = nodes_of(bus.bus);
      if (!fold.hasAttribute("aria-expanded")) fold.setAttribute("aria-expanded", nodes.length <= most_open);
      link.setAttribute("href", `#bus/${state.buses.indexOf(bus)}`);
      const troubled = nodes.filter((node) => ["error", "warning"].includes(mood_of(node))).length;
      badge.hidden = troubled === 0;
      set_text(badge, String(troubled));
      const is_open = fold.getAttribute("aria-expanded") === "true";
      list.hidden = !is_open;
      keep_children(list, is_open ? nodes : [], key_of, (key) => make("li", {}, make("button", { type: "button", "data-node": key }, make("i", { "aria-hidden": "true" }), make("span"))), (child, node) => {
        const button = child.firstElementChild;
        const mood = mood_of(node);
        if (button.dataset.mood !== mood) button.dataset.mood = mood;
        if (button.title !== node.state) button.title = node.state;
        set_text(button.lastElementChild, name_of(node));
      });
    });
    keep_children(this.modules, state.modules.map((one, i) => [`${one.name} (${one.plc})`, `#words/${i}`]), ([, href]) => href, entry,
                  (item, [name]) => set_text(item.firstElementChild, name));
    this.draw_parts(keep_children);
  }

  /// Those that are shown.
  draw_parts(keep_children) {
    const shown = parts.filter(([, id]) => !document.getElementById(id).hidden);
    keep_children(this.parts, shown, ([, id, link]) => link ?? `#${id}`, entry, (item, [name]) => set_text(item.firstElementChild, name));
  }

  /// The buses that have a project, and the files of module settings.
  draw_projects(names, settings, keep_children) {
    keep_children(this.projects, [...names.map((name, i) => [`Project of ${name}`, `#project/${i}`]), ...settings.map((name, i) => [`Settings ${name.split("/").pop()}`, `#settings/${i}`])], ([, href]) => href, entry,
                  (item, [name]) => set_text(item.firstElementChild, name));
  }
}
