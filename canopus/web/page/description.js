// The pane at the right edge: what the object or the word with the focus is, its range and default, what it is for. It can be hidden.
import { make, set_text } from "./dom.js";

const by_id = (id) => document.getElementById(id);
const kept = "canopus description";  // of this browser: "on" or "off"

/// Whether one has said before that it is wanted; null: nothing was said, or the browser keeps nothing.
function wish() {
  try {
    return localStorage.getItem(kept);
  } catch {
    return null;
  }
}

export class Description {
  /// `say`: called when what the server is asked for has changed.
  constructor(say) {
    this.say = say;
    this.object = null;
    this.button = by_id("show-description");
    this.button.addEventListener("click", () => this.show(document.body.dataset.description !== "on", true));
    document.addEventListener("keydown", (event) => {
      const is_free = !event.ctrlKey && !event.altKey && !event.metaKey && !event.target.matches("input, select, textarea");
      if (event.key === "i" && is_free && !document.querySelector("dialog[open]")) this.button.click();
    });
    const said = wish();
    this.show(said === null ? matchMedia("(min-width: 100rem)").matches : said === "on", false);
  }

  show(is_open, is_said) {
    document.body.dataset.description = is_open ? "on" : "off";
    this.button.setAttribute("aria-pressed", is_open);
    by_id("description").hidden = !is_open;
    if (!is_said) return;
    try {
      localStorage.setItem(kept, is_open ? "on" : "off");
    } catch {
      // Then it is so until the page is loaded again.
    }
    this.say();
  }

  /// The rows of a table are described; `facts(row)`: { title, object (or none), rows: [[name, text]] }, or nothing.
  follow(table, facts) {
    for (const kind of ["focusin", "click"]) {
      table.addEventListener(kind, (event) => {
        const line = event.target.closest("tbody tr");
        const found = line && facts(line);
        if (found) this.describe(found);
      });
    }
  }

  describe({ title, object, rows }) {
    const text = JSON.stringify([title, rows]);
    if (this.text === text) return;
    this.text = text;
    this.object = object ?? null;
    set_text(by_id("description-title"), title);
    by_id("description-rows").replaceChildren(...rows.filter(([, value]) => value !== undefined && value !== "").map(([name, value]) => make("div", {}, make("dt", {}, name), make("dd", {}, String(value)))));
    set_text(by_id("description-meaning"), "");
    set_text(by_id("description-source"), "");
    this.say();
  }

  /// What the server is asked for, or null.
  get view() {
    return this.object === null || document.body.dataset.description !== "on" ? null : { meaning: this.object };
  }

  draw(event) {
    if (event.object !== this.object) return;
    set_text(by_id("description-meaning"), event.meaning ? `${event.meaning}${event.unit ? ` Unit: ${event.unit}.` : ""}` : "An object of the device: what it is for stands in its manual.");
    set_text(by_id("description-source"), event.source ?? "");
  }
}
