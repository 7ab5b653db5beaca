// Links of the views (#words/0, #objects/3, #bus/0/183, #boots), "Go to", and keys.
import { make } from "./dom.js";

const by_id = (id) => document.getElementById(id);

/// What there is to go to: name, link.
function value_mask_of(state) {
  return [
    ["Overview", "#overview"], ["Boots", "#boots"], ["Trace", "#trace"],
    ...state.modules.map((one, i) => [`Buffer memory of ${one.name} (${one.plc})`, `#words/${i}`]),
    ...state.buses.map((one, i) => [`Bus ${one.bus}`, `#bus/${i}`]),
    ...state.nodes.map((one, i) => [`Objects of ${one.bus} ${one.node} ${one.name}`, `#objects/${i}`]),
  ];
}

/// What a link says that nobody of the page has made may be anything.
function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

export class Links {
  /// `views`: by the first word of a link open(number, name, rest) and close(); `bases`: buttons that the key h presses.
  constructor(views, bases) {
    this.views = views;
    this.bases = bases;
    this.places = [["Overview", "#overview"]];
    this.is_followed = false;
    addEventListener("hashchange", () => this.follow());
    by_id("open-go-to").addEventListener("click", () => this.open_go_to());
    by_id("open-keys").addEventListener("click", () => by_id("keys").showModal());
    by_id("open-about").addEventListener("click", () => by_id("about").showModal());
    by_id("go-to-words").addEventListener("input", () => this.draw_places());
    by_id("go-to-words").addEventListener("keydown", (event) => {
      if (event.key === "Enter") by_id("go-to-list").querySelector("a")?.click();
    });
    by_id("go-to-list").addEventListener("click", (event) => {
      if (event.target.closest("a")) by_id("go-to").close();
    });
    document.addEventListener("keydown", (event) => this.key(event));
  }

  /// The link that the page was opened with needs the names of the first state.
  state(state) {
    this.last_state = state;
    this.places = value_mask_of(state);
    if (this.is_followed) return;
    this.is_followed = true;
    if (location.hash) this.follow();
  }

  /// The buses that have a project, and the files of module settings.
  projects(names, settings) {
    this.project_places = [...names.map((name, i) => [`Project of ${name}`, `#project/${i}`]), ...settings.map((name, i) => [`Settings ${name.split("/").pop()}`, `#settings/${i}`])];
    if (/^#(project|settings)/.test(location.hash)) this.follow();
  }

  follow() {
    const [view, digits, rest] = location.hash.slice(1).split("/");
    for (const [name, one] of Object.entries(this.views)) {
      if (name !== view) one.close?.();
    }
    if (view === "boots") return this.views.boots.open();
    if (view === "trace") return this.views.trace.open(digits === undefined ? "" : decode(digits), rest);
    if (["boot-section", "plots", "faults-section", "messages-section", "events-section"].includes(view)) {
      by_id(view).scrollIntoView();
      return by_id(view).querySelector("h2").focus({ preventScroll: true });
    }
    const number = /^\d{1,5}$/.test(digits ?? "") ? Number(digits) : -1;
    if (view === "project" || view === "settings") return this.views[view].open(number, "", rest && decode(rest));
    const place = this.places.find((one) => one[1] === `#${view}/${number}`);
    if (!place || !this.last_state) return;
    const of = { words: "modules", bus: "buses", objects: "nodes" }[view];
    const one = this.last_state[of][number];
    this.views[view].open(number, view === "objects" ? `${one.bus} ${one.node} ${one.name}` : view === "bus" ? one.bus : one.name, rest);
  }

  open_go_to() {
    by_id("go-to-words").value = "";
    this.draw_places();
    by_id("go-to").showModal();
    by_id("go-to-words").focus();
  }

  draw_places() {
    const words = by_id("go-to-words").value.trim().toLowerCase();
    const found = [...this.places, ...(this.project_places ?? [])].filter(([name]) => name.toLowerCase().includes(words)).slice(0, 12);
    by_id("go-to-list").replaceChildren(...found.map(([name, link]) => make("li", {}, make("a", { href: link }, name))));
  }

  key(event) {
    const is_open = document.querySelector("dialog[open]") !== null;
    if (event.ctrlKey && event.key.toLowerCase() === "k") {
      event.preventDefault();
      if (!is_open) this.open_go_to();
    }
    if (is_open || event.ctrlKey || event.altKey || event.metaKey || event.target.matches("input, select, textarea")) return;
    if (event.key === "?") by_id("keys").showModal();
    if (event.key === "h") for (const button of this.bases) button.click();
    if (event.key === "Escape" && location.hash.length > 1) location.hash = "#overview";
  }
}
