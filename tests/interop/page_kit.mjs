// What the scripts of a real browser share: `node SCRIPT.mjs CHROMIUM URL FOLDER [more]`. A Chromium, what its pages complain of, clicks and typed
// characters, pictures, what axe-core finds. A script fills `seen` and ends with `end()`, which prints it as JSON for the check that judges.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

const [executablePath, address, pictures, ...words] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");

export const url = address;
export const folder = pictures;
export const more = words;
export const seen = { problems: [], pictures: [], axe: [], overflow: [] };
export const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });

/** A page at an address, in a session of its own: 1280 x 800, light, unless `options` of the context say otherwise. */
export async function open(at = url, options = {}) {
  // The page's own policy would not run axe-core.
  const page = await browser.newPage({ viewport: { width: 1280, height: 800 }, colorScheme: "light", bypassCSP: true, ...options });
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && seen.problems.push(message.text()));
  page.on("pageerror", (error) => seen.problems.push(String(error)));
  const counts = { clicks: 0, typed: 0 };
  await page.exposeFunction("tell", (kind) => { ++counts[kind]; });
  await page.addInitScript(() => {
    for (const kind of ["click", "contextmenu"]) addEventListener(kind, (event) => { if (event.isTrusted) tell("clicks"); }, true);
    addEventListener("keydown", (event) => { if (event.isTrusted && event.key.length === 1) tell("typed"); }, true);
  });
  page.counts = counts;
  await page.goto(at);
  return page;
}

/** What was clicked and typed for something that is done on the page. */
export async function counted(page, action) {
  const before = { ...page.counts };
  await action();
  await page.evaluate(() => 0);  // what was told before has come
  return { clicks: page.counts.clicks - before.clicks, typed: page.counts.typed - before.typed };
}

/** Whether the page is wider than its window, and what axe-core finds serious: into `seen`, with the name of the place. */
export async function judge(page, place) {
  if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)) seen.overflow.push(place);
  await page.evaluate(axe);
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  for (const one of found.violations.filter((violation) => ["serious", "critical"].includes(violation.impact))) {
    seen.axe.push(`${place}: ${one.id}: ${one.nodes.slice(0, 3).map((node) => node.html.slice(0, 150)).join(" | ")}`);
  }
}

/** Pictures of a section are not to be covered by the bar, nor by the strip at the bottom. */
export async function uncover(page) {
  await page.addStyleTag({ content: "#bar { position: static !important; } #newest { display: none !important; }" });
}

/** A section (else all that is in sight) light and dark, 1280 and 1920 pixels wide: as NAME-SCHEME-WIDTH.png, and judged. */
export async function picture(page, name, selector, schemes = ["light", "dark"]) {
  if (selector) await uncover(page);
  for (const colorScheme of schemes) {
    for (const [width, height] of [[1280, 800], [1920, 1080]]) {
      await page.emulateMedia({ colorScheme });
      await page.setViewportSize({ width, height });
      const path = `${folder}/${name}-${colorScheme}-${width}.png`;
      await (selector ? page.locator(selector) : page).screenshot({ path });
      seen.pictures.push(path);
      await judge(page, `${name} ${colorScheme} ${width}`);
    }
  }
  await page.emulateMedia({ colorScheme: "light" });
  await page.setViewportSize({ width: 1280, height: 800 });
}

/** Ends the browser and prints what was seen. */
export async function end() {
  await browser.close();
  console.log(JSON.stringify(seen));
}
