// A real browser on the faults of a run's page. Says as JSON what it saw. `node web_faults.mjs CHROMIUM URL FOLDER`; pictures go
// into FOLDER. Judged by web_project_checks.py.
import { counted, end, judge, open, picture, seen, url } from "./page_kit.mjs";

const page = await open();
await page.waitForSelector("#faults-section:not([hidden])");
await page.click("#follow");
const frame = page.locator("#messages .event[data-id='183']").first();
await frame.waitFor();
// The list stays where it is read while frames come.
await page.click("#follow");
await page.waitForTimeout(300);

// W9.
seen.w9 = await counted(page, async () => {
  await frame.click({ button: "right" });
  await page.locator("#frame-menu button", { hasText: "Lose it" }).click();
  await page.click("#fault-run");
  await page.waitForFunction(() => document.querySelector(".hits")?.textContent === "1 frames hit", null, { timeout: 20000 });
});
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
await picture(page, "faults", "#faults-section");

// The same by keys alone: a line of the trace, its menu, and Run.
await page.locator(".fault button", { hasText: "Remove" }).click();
await page.click("#fault-run");
await page.evaluate(() => { location.hash = "#trace"; });
await page.fill("#trace-filter", "id=183");
await page.waitForFunction(() => document.querySelector("#trace tr[data-id='183']"));
await page.focus("#trace");
await page.keyboard.press("Enter");
await page.waitForSelector("#trace tr[aria-selected]");
const first = await page.getAttribute("#trace tr[aria-selected]", "data-n");
await page.keyboard.press("Enter");
await page.waitForFunction((n) => Number(document.querySelector("#trace tr[aria-selected]")?.dataset.n) === Number(n) + 1, first);
await page.keyboard.press("f");
await page.waitForSelector("#frame-menu:not([hidden])");
await judge(page, "what if");
seen.by_keys = await counted(page, async () => {
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.activeElement.id === "fault-run");
  await page.keyboard.press("Enter");
  await page.waitForFunction(() => document.querySelector(".hits")?.textContent === "1 frames hit");
});
seen.text_by_keys = await page.locator(".fault textarea").inputValue();

const looker = await open(url.split("#")[0]);
await looker.waitForSelector("#faults-section:not([hidden])");
seen.look_disabled = await looker.locator("#fault-run").isDisabled();
await looker.click("#follow");
const other = looker.locator("#messages .event[data-id]").first();
await other.waitFor();
await other.click({ button: "right" });
seen.look_menu = await looker.locator("#frame-menu").isVisible();
await end();
