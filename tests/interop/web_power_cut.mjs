// A real browser on a transfer to a device that falls silent in the middle. Says as JSON what it saw. `node web_power_cut.mjs CHROMIUM URL FOLDER`; judged by
// web_transfer_checks.py.
import { end, judge, open, picture, seen } from "./page_kit.mjs";

const page = await open();
await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 2);
const idle = () => page.waitForFunction(() => document.querySelector("#project-ways button:last-child").hidden, null, { timeout: 120000 });
await page.click("#arm");
await page.waitForSelector("#arm[aria-pressed=true]");
await page.locator("#project-ways button", { hasText: "Transfer" }).click();
await page.waitForFunction(() => !document.getElementById("transfer-write").disabled);
await page.click("#transfer-write");
await page.waitForFunction(() => / written$/.test(document.getElementById("transfer-facts").textContent), null, { timeout: 120000 });
await idle();
seen.facts = await page.textContent("#transfer-facts");
seen.said = await page.textContent("#project-said b");
seen.results = await page.locator("#transfer-rows tr").evaluateAll((all) => all.map((row) => [...row.children].map((one) => one.textContent)));
seen.green = await page.locator("#transfer-rows tr.same td:nth-child(2)").allTextContents();
await judge(page, "transfer");
await picture(page, "cut", "#transfer");
await end();
