// The page of a run.
import "@siemens/ix/dist/siemens-ix/siemens-ix-core.css";
import "@siemens/ix/dist/siemens-ix/theme/classic-light.css";
import "@siemens/ix/dist/siemens-ix/theme/classic-dark.css";
import "uplot/dist/uPlot.min.css";
import "./style.css";
import { render } from "lit";
import { App } from "./frame/app.js";
import { define_components } from "./frame/components.js";
import { Frame } from "./frame/frame.js";
import { show_keys } from "./frame/keys.js";
import { Palette } from "./frame/palette.js";
import { follow_scheme } from "./frame/scheme.js";
import { TopBar } from "./frame/top_bar.js";
import type { DataGrid } from "./parts/grid.js";
import type { PlotChart } from "./parts/plot_chart.js";
import { make_screens } from "./screens/screens.js";

define_components();
follow_scheme();

let frame: Frame;
/** The menu's own button has aria-expanded on its host, which has no role; it belongs to the button within. The host is another one when the menu has folded or unfolded. */
function name_menu_button(within: ParentNode | null | undefined): void {
  for (const one of within?.querySelectorAll("*") ?? []) {
    const inner = one.matches("ix-icon-button[aria-expanded]") ? (one.shadowRoot ?? one).querySelector("button") : null;
    if (inner) {
      inner.setAttribute("aria-expanded", one.getAttribute("aria-expanded") ?? "false");
      one.removeAttribute("aria-expanded");
    }
    if (one.shadowRoot && one.matches(":not(ix-menu-item)")) name_menu_button(one.shadowRoot);
  }
}

const app = new App(() => {
  render(frame.view(), document.body);
  const menu = document.querySelector("ix-menu");
  name_menu_button(menu);
  name_menu_button(menu?.shadowRoot);
  for (const grid of document.querySelectorAll<DataGrid>("data-grid")) grid.update();
  requestAnimationFrame(() => { for (const chart of document.querySelectorAll<PlotChart>("plot-chart")) chart.update(); });
  const title = [app.screen.title, app.store.state?.plant, "Canopus"].filter(Boolean).join(" – ");
  if (document.title !== title) document.title = title;
});
app.screens = make_screens(app);
const palette = new Palette(app);
frame = new Frame(app, new TopBar(app, () => palette.open()), palette);

addEventListener("hashchange", () => app.follow(location.hash));
// The menu folds and unfolds by itself, a little later.
for (const kind of ["resize", "click"]) addEventListener(kind, () => { app.redraw(); setTimeout(() => app.redraw(), 300); });
addEventListener("keydown", (event) => {
  if (event.ctrlKey && event.key.toLowerCase() === "k") {
    event.preventDefault();
    if (!palette.is_open) palette.open();
  }
  const target = event.composedPath()[0] as HTMLElement;
  if (event.ctrlKey || event.altKey || event.metaKey || target.matches?.("input, select, textarea, [contenteditable=true]")) return;
  if (event.key === "h") app.is_hexadecimal = !app.is_hexadecimal;
  else if (event.key === "?") show_keys(app);
  else if (event.key === "i") app.show_description(!app.is_described);
  else if (event.key === "/") {
    const filter = document.querySelector<HTMLElement>("[data-filter]");
    if (!filter) return;
    event.preventDefault();
    filter.focus();
  } else return;
  app.redraw();
});

/** Plant time goes on between two states. */
function tick(): void {
  const place = document.getElementById("plant-time");
  if (place && app.store.state) {
    const text = `${app.store.plant_time(performance.now()).toFixed(1)} s`;
    if (place.textContent !== text) place.textContent = text;
  }
}

app.follow(location.hash);
setInterval(tick, 100);
void import("./parts/heavy.js").then(() => {
  app.has_parts = true;
  app.redraw();
});
