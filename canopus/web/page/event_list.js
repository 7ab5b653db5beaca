// Thousands of events, newest first, of which only those in sight are elements.
import { make } from "./dom.js";
import { event_mood } from "./words.js";

const row_height = 22;
const most_kept = 20000;

export class EventList {
  constructor(box, filter, count) {
    this.box = box;
    this.filter = filter;
    this.count = count;
    this.events = [];
    this.shown = [];
    this.inside = make("div");
    box.append(this.inside);
    box.addEventListener("scroll", () => this.draw_rows());
    new ResizeObserver(() => this.draw_rows()).observe(box);
    filter.addEventListener("input", () => {
      this.choose();
      this.draw();
    });
  }

  clear() {
    this.events = [];
    this.choose();
  }

  /// `data`: what the line has with it for who acts on it.
  add(event, text, data = {}) {
    const row = { t: event.t, text, mood: event_mood(event), data };
    this.events.push(row);
    if (this.events.length > most_kept) {
      this.events.splice(0, most_kept / 10);
      this.choose();
      return;
    }
    if (!this.matches(row)) return;
    this.shown.push(row);
    // Who has scrolled down keeps reading the same lines.
    if (this.box.scrollTop > 0) this.box.scrollTop += row_height;
  }

  matches(row) {
    const wanted = this.filter.value.trim().toLowerCase();
    return wanted === "" || row.text.toLowerCase().includes(wanted);
  }

  choose() {
    this.shown = this.events.filter((row) => this.matches(row));
  }

  draw() {
    this.inside.style.height = `${this.shown.length * row_height}px`;
    this.count.textContent = `${this.shown.length} of ${this.events.length}`;
    this.draw_rows();
  }

  draw_rows() {
    const first = Math.floor(this.box.scrollTop / row_height);
    const last = Math.min(this.shown.length, first + Math.ceil(this.box.clientHeight / row_height) + 1);
    const rows = [];
    for (let i = first; i < last; ++i) {
      const row = this.shown[this.shown.length - 1 - i];
      const line = make("div", { class: `event ${row.mood}` }, `${row.t.toFixed(6).padStart(12)}  ${row.text}`);
      line.style.top = `${i * row_height}px`;
      line.title = row.text;
      Object.assign(line.dataset, row.data);
      rows.push(line);
    }
    this.inside.replaceChildren(...rows);
  }
}
