// The fronts of the modules with their LEDs, signals and watched words.
import { make, set_text } from "./dom.js";
import { ErrorView } from "./error_view.js";

// Patterns of CiA 303-3: when an LED is lit, by the milliseconds of its period.
const patterns = {
  off: () => false,
  on: () => true,
  flickering: (ms) => ms % 100 < 50,
  blinking: (ms) => ms % 400 < 200,
  "single flash": (ms) => ms % 1200 < 200,
  "double flash": (ms) => ms % 1600 < 200 || (ms % 1600 >= 400 && ms % 1600 < 600),
};

function make_module() {
  return make("article", { class: "front" }, make("h3"), make("p", { class: "faint" }),
              make("ul", { class: "leds" }), make("p", { class: "figures" }), make("table"),
              make("button", { type: "button", class: "open-words" }, "Buffer memory"),
              make("button", { type: "button", class: "open-errors" }, "Errors"), ErrorView.make_part());
}

function fill_module(card, module, number, keep_children, open_words, errors) {
  const [title, facts, leds, signals, table, words_button, errors_button, errors_part] = card.children;
  words_button.onclick = () => open_words(number, module.name);
  words_button.setAttribute("aria-label", `Buffer memory of ${module.name}`);
  errors_button.onclick = () => errors.toggle(number);
  errors_part.setAttribute("aria-label", `Errors of ${module.name}`);
  set_text(title, module.name);
  errors.show(card, number);
  set_text(facts, `${module.plc} · ${module.bus}${module.node ? ` node ${module.node}` : ""} · ` +
                  `${module.on ? `CPU ${module.cpu}` : "no supply"}`);
  leds.setAttribute("aria-label", `LEDs of ${module.name}`);
  keep_children(leds, module.leds, (led) => led.name,
                () => make("li", { class: "led" },
                           make("svg:svg", { viewBox: "0 0 10 10", "aria-hidden": "true" }, make("svg:circle", { cx: 5, cy: 5, r: 4 })),
                           make("span")),
                (item, led) => {
                  Object.assign(item.dataset, { pattern: led.pattern, opposite: led.opposite });
                  item.classList.toggle("fault", led.error);
                  set_text(item.lastElementChild, `${led.name} ${led.pattern}`);
                });
  set_text(signals, module.signals_on.length ? `ON: ${module.signals_on.join(" ")}` : "no signal is ON");
  const words = JSON.stringify(module.words);
  if (table.dataset.words === words) return;
  table.dataset.words = words;
  table.replaceChildren(...module.words.map((word) => make("tr", {}, make("th", { scope: "row" }, `G${word.address}`),
    make("td", {}, make("button", { type: "button", class: "number", title: `Plot ${module.name} G${word.address}`, "data-plot": `words ${number} ${word.address}` }, `${word.value}`)), make("td", { class: "faint" }, `${word.value.toString(16).toUpperCase().padStart(4, "0")}H`))));
}

/// `open_words`: shows the buffer memory of the module of this number and name; `errors`: an ErrorView.
export function draw_modules(list, modules, keep_children, key_of, open_words, errors) {
  keep_children(list, modules, (module) => `${module.plc}\u0000${module.head}\u0000${key_of(module)}`, make_module,
                (card, module) => fill_module(card, module, modules.indexOf(module), keep_children, open_words, errors));
}

/// Lights the LEDs as they are at this millisecond of plant time. Who wants no motion sees them lit, with the pattern's name.
export function draw_leds(list, milliseconds) {
  const still = matchMedia("(prefers-reduced-motion: reduce)").matches;
  for (const led of list.querySelectorAll(".led")) {
    const is_lit = still ? led.dataset.pattern !== "off"
                         : (patterns[led.dataset.pattern]?.(milliseconds) ?? false) !== (led.dataset.opposite === "true");
    led.classList.toggle("lit", is_lit);
  }
}
