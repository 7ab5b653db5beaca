// A real browser on the faults of a run's page. Says as JSON what it saw. `node web_faults.mjs CHROMIUM URL FOLDER`; pictures go
// into FOLDER. Judged by web_project_checks.py.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

const [executablePath, url, folder] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const seen = { problems: [], pictures: [], axe: [], overflow: [] };
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", bypassCSP: true });
const page = await context.newPage();
page.on("console", (message) => ["error", "warning"].includes(message.type()) && seen.problems.push(message.text()));
page.on("pageerror", (error) => seen.problems.push(String(error)));
const counts = { clicks: 0, typed: 0 };
await context.exposeFunction("tell", (kind) => { ++counts[kind]; });
await context.addInitScript(() => {
  for (const kind of ["click", "contextmenu"]) addEventListener(kind, (event) => { if (event.isTrusted) tell("clicks"); }, true);
  addEventListener("keydown", (event) => { if (event.isTrusted && event.key.length === 1) tell("typed"); }, true);
});
await page.goto(url);
await page.waitForSelector("#faults-section:not([hidden])");
await page.click("#follow");
const frame = page.locator("#messages .event[data-id='183']").first();
await frame.waitFor();
// The list stays where it is read while frames come.
await page.click("#follow");
await page.waitForTimeout(300);

// W9.
Object.assign(counts, { clicks: 0, typed: 0 });
await frame.click({ button: "right" });
await page.locator("#frame-menu button", { hasText: "Lose it" }).click();
await page.click("#fault-run");
await page.waitForFunction(() => document.querySelector(".hits")?.textContent === "1 frames hit", null, { timeout: 20000 });
seen.w9 = { ...counts };
seen.text = await page.locator(".fault textarea").inputValue();
seen.hit = await page.textContent(".hits");
seen.said = await page.textContent("#fault-said");

// What is wrong is said, and changes nothing.
await page.locator(".fault textarea").fill('kind = "x"');
await page.click("#fault-run");
await page.waitForSelector("#fault-said[data-mood=error]");
seen.wrong = await page.textContent("#fault-said");
await page.locator(".fault button", { hasText: "Remove" }).click();

// A controller of which the output is stuck.
await page.selectOption("#fault-kind", "stuck recessive");
await page.click("#fault-add");
await page.locator(".fault textarea").fill('kind = "stuck recessive"\nports = ["encoder"]');
await page.click("#fault-run");
await page.waitForFunction(() => document.querySelector(".hits")?.textContent === "now", null, { timeout: 20000 });
seen.stuck = await page.textContent(".hits");
await page.waitForFunction(() => document.getElementById("buses").textContent.includes("bus-off"), null, { timeout: 20000 });
seen.controllers = await page.textContent("#buses");
await page.addStyleTag({ content: "#bar { position: static !important; }" });
for (const colorScheme of ["light", "dark"]) {
  await page.emulateMedia({ colorScheme });
  const path = `${folder}/faults-${colorScheme}-1280.png`;
  await page.locator("#faults-section").screenshot({ path });
  seen.pictures.push(path);
  if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)) seen.overflow.push(colorScheme);
  await page.evaluate(axe);
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  for (const one of found.violations.filter((violation) => ["serious", "critical"].includes(violation.impact))) seen.axe.push(`${colorScheme}: ${one.id}: ${one.nodes[0].html.slice(0, 120)}`);
}

const looker = await browser.newPage();
await looker.goto(url.split("#")[0]);
await looker.waitForSelector("#faults-section:not([hidden])");
seen.look_disabled = await looker.locator("#fault-run").isDisabled();
await looker.click("#follow");
const other = looker.locator("#messages .event[data-id]").first();
await other.waitFor();
await other.click({ button: "right" });
seen.look_menu = await looker.locator("#frame-menu").isVisible();
await browser.close();
console.log(JSON.stringify(seen));
