// A real browser that sends NMT commands to one node and to all. Says as JSON what it saw. `node web_nmt.mjs CHROMIUM URL FOLDER`.
// Judged by web_nmt_checks.py.
import { counted, end, judge, open, seen, url } from "./page_kit.mjs";

const page = await open();
const all = page.getByRole("group", { name: "NMT commands to all nodes of line1" });
const states = () => page.locator("#buses .nodes .state").allTextContents();
const in_state = (number, state) => page.waitForFunction(([wanted, text]) =>
  [...document.querySelectorAll("#buses .nodes .state")].filter((one) => one.textContent === text).length === wanted, [number, state], { timeout: 20000 });

await all.waitFor();
seen.buttons = await all.getByRole("button").allTextContents();
seen.stop = await counted(page, async () => {
  await all.getByRole("button", { name: "Stop all" }).click();
  await in_state(3, "stopped");
});
await page.waitForFunction(() => document.querySelector("#buses .nmt [role=status]").textContent.endsWith("sent"));
seen.said = await all.getByRole("status").textContent();
seen.command = await all.getByRole("status").getAttribute("title");
seen.stopped = await states();

// One alone: the others stay where they are.
await page.locator("#buses .nodes button", { hasText: "encoder" }).click();
const one = page.getByRole("group", { name: "NMT commands to line1 node 3" });
seen.start = await counted(page, async () => {
  await one.getByRole("button", { name: "Start", exact: true }).click();
  await in_state(1, "operational");
});
await page.waitForFunction(() => document.querySelector("#node-nmt [role=status]").textContent.endsWith("sent"));
seen.started = await states();
seen.said_of_one = await one.getByRole("status").textContent();
await judge(page, "node with its NMT commands");
await page.keyboard.press("Escape");

// By keyboard.
await all.getByRole("button", { name: "Pre-operational all" }).focus();
await page.keyboard.press("Enter");
await in_state(3, "pre-operational");
await page.waitForFunction(() => document.activeElement.textContent === "Pre-operational all");
await all.getByRole("button", { name: "Start all" }).click();
await in_state(3, "operational");
await judge(page, "overview");

const looker = await open(url.split("#")[0]);
await looker.waitForSelector("#buses .nodes button");
await looker.waitForTimeout(500);
seen.look = await looker.locator(".nmt:visible").count();
await end();
