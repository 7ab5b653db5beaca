// A real browser on the strip at the bottom, while somebody does something. Says as JSON what it saw. `node web_strip.mjs CHROMIUM URL FOLDER`.
// Judged by web_strip_checks.py.
import { end, judge, open, picture, seen, url } from "./page_kit.mjs";

const page = await open();
await page.waitForSelector("#pace button");
const newest = page.locator("#newest-list li");
/** The strip once it says something: its text, its tip, how it is shown. */
const strip = async (text) => {
  const item = newest.filter({ hasText: text }).first();
  await item.waitFor();
  return item.evaluate((one) => [one.textContent.replace(/^[\d.]+ s {2}/, ""), one.firstElementChild.title, one.dataset.mood]);
};
seen.done = [];
const done = async (action, text) => {
  await action();
  seen.done.push(await strip(text));
};
await done(() => page.locator("#pace").getByRole("button", { name: "Pause", exact: true }).click(), "stand still");
await page.waitForFunction(() => document.getElementById("where").textContent === "SIMULATED PAUSED");
await page.selectOption("#pace [aria-label='Speed of plant time']", "10");
await done(() => page.locator("#pace").getByRole("button", { name: "Run", exact: true }).click(), "×10");
// The page must know that it runs, or a speed is chosen for later.
await page.waitForFunction(() => document.getElementById("where").textContent === "SIMULATED ×10");
await done(() => page.selectOption("#pace [aria-label='Speed of plant time']", "1"), /×1:/);
const all = page.getByRole("group", { name: "NMT commands to all nodes of line1" });
await done(() => all.getByRole("button", { name: "Pre-operational all" }).click(), "canopus nmt preop");
await page.locator("#fault-add").click();
await done(() => page.click("#fault-run"), "run the faults of line1");
await page.locator(".fault textarea").first().fill('kind = "x"');
await done(() => page.click("#fault-run"), "fault 1");
await picture(page, "strip", null, ["light"]);

// Who may not: what the server refuses is said with its reason.
await page.evaluate((address) => new Promise((end) => {
  const socket = new WebSocket(`${address.replace("http", "ws")}events`);
  socket.onopen = () => socket.send('{"do": {"command": "pace", "speed": 0}, "id": 1}');
  socket.onmessage = (message) => message.data.includes('"reply"') && end(socket.close());
}), url.split("#")[0]);
seen.refused = await strip("(look)");
await judge(page, "the strip");
await page.fill("#filter", "(");
seen.listed = await page.locator("#events .event").allTextContents();
await page.fill("#filter", "");
seen.all = [...await page.locator("#events .event").allTextContents(), ...await newest.allTextContents()];
await end();
