// The strip at the bottom: the latest events in words, each a link to the frames of that moment.
import { keep_children, make, set_text } from "./dom.js";
import { event_mood } from "./words.js";

const most = 3;
const around = 0.01;  // seconds of the trace on either side

/// The frames of an event in the trace; of one that is not of a bus, the list of events.
export function link_of(event) {
  if (!event.bus) return "#events-section";
  const terms = [`bus=${/^[\w.-]+$/.test(event.bus) ? event.bus : `"${event.bus}"`}`, `from=${Math.max(0, event.t - around).toFixed(6)}s`, `to=${(event.t + around).toFixed(6)}s`];
  return `#trace/${encodeURIComponent(terms.join(" "))}/${event.t.toFixed(6)}`;
}

export class NewestEvents {
  constructor(strip) {
    this.strip = strip;
    this.list = strip.querySelector("ul");
    this.events = [];
    this.count = 0;
    const button = strip.querySelector("button");
    button.addEventListener("click", () => {
      const is_open = this.list.hidden;
      this.list.hidden = !is_open;
      button.setAttribute("aria-expanded", is_open);
    });
  }

  /// What one source says again and again takes one place.
  add(event, text) {
    if (event.source) this.events = this.events.filter((one) => one.event.event !== event.event || one.event.source !== event.source);
    this.events.push({ event, text, key: String(++this.count) });
    if (this.events.length > most) this.events.shift();
  }

  draw() {
    this.strip.hidden = this.events.length === 0;
    keep_children(this.list, [...this.events].reverse(), (one) => one.key, () => make("li", {}, make("a", {})), (item, { event, text }) => {
      const link = item.firstElementChild;
      const shown = `${event.t.toFixed(3)} s  ${text}`;
      if (link.textContent === shown) return;
      set_text(link, shown);
      link.title = shown;
      link.setAttribute("href", link_of(event));
      item.dataset.mood = event_mood(event);
    });
  }
}
