// Statistics of the trace, as `canopus trace stats --json` has them.
import { make } from "./dom.js";

const ms = (figures, name) => (figures?.count ? figures[name].toFixed(3) : "");
const percent = (share) => `${(100 * share).toFixed(1)} %`;

function table(caption, heads, rows) {
  return make("div", { class: "scrolls", role: "region", "aria-label": caption, tabindex: "0" },
              make("table", { class: "rows" }, make("caption", {}, caption),
                   make("thead", {}, make("tr", {}, ...heads.map((head) => make("th", { scope: "col" }, head)))),
                   make("tbody", {}, ...rows.map((cells) => make("tr", {}, ...cells.map((text) => make("td", {}, String(text))))))));
}

export function draw_figures(box, figures) {
  const services = Object.entries(figures.services).filter(([, count]) => count > 0).map(([name, count]) => `${name} ${count}`);
  const parts = [make("p", {}, `${figures.duration.toFixed(3)} s; ${services.join(", ") || "nothing yet"}${figures.progress === undefined ? "" : `; ${Math.floor(100 * figures.progress)} % read`}`)];
  for (const bus of figures.channels) {
    parts.push(make("h4", {}, `${bus.name}: ${bus.frames} frames, ${bus.error_frames} error frames, load ${percent(bus.load)}, busiest second ${percent(bus.busiest_second_load)}`));
    parts.push(table(`CAN-IDs of ${bus.name}`, ["CAN-ID", "What", "Frames", "Cycle min ms", "Mean ms", "Max ms", "Jitter ms"],
                     bus.identifiers.map((one) => [`${one.id}H`, one.who, one.frames, ms(one.cycle, "min_ms"), ms(one.cycle, "mean_ms"), ms(one.cycle, "max_ms"), ms(one.cycle, "jitter_ms")])));
    parts.push(table(`Nodes of ${bus.name}`, ["Node", "Boot-ups", "Heartbeats", "Lost", "EMCY", "SDO reads", "Writes", "Aborts", "Unanswered", "SDO min ms", "Mean ms", "Max ms"],
                     bus.nodes.map((one) => [`${one.node} ${one.name ?? ""}`, one.boot_ups, one.heartbeats, one.lost_heartbeats, one.emergencies, one.sdo.reads, one.sdo.writes, one.sdo.aborts,
                                             one.sdo.unanswered, ms(one.sdo, "min_ms"), ms(one.sdo, "mean_ms"), ms(one.sdo, "max_ms")])));
  }
  // Where somebody has scrolled to in a table stays.
  const places = [...box.querySelectorAll(".scrolls")].map((one) => one.scrollTop);
  box.replaceChildren(...parts);
  box.querySelectorAll(".scrolls").forEach((one, i) => { one.scrollTop = places[i] ?? 0; });
}
