// A real browser on a transfer that devices refuse in part, and on devices that somebody writes to meanwhile. Says as JSON what it saw.
// `node web_transfer.mjs CHROMIUM URL FOLDER PROGRAM BUS`; PROGRAM writes to the devices of BUS. Judged by web_transfer_checks.py.
import { execFileSync } from "node:child_process";
import { end, more, open, picture, seen } from "./page_kit.mjs";

const [program, bus] = more;
const page = await open();
await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 3);
const idle = () => page.waitForFunction(() => document.querySelector("#project-ways button:last-child").hidden);
const said = () => page.textContent("#project-said b");
const rows = () => page.locator("#transfer-rows tr").evaluateAll((all) => all.map((row) => [...row.children].map((one) => one.textContent)));
const value_of = (object) => execFileSync(program, ["sdo", "read", "5", object, "--type", object === "1017" ? "u16" : "u32", "--json", "--bus", bus], { encoding: "utf8" });

await page.click("#arm");
await page.waitForSelector("#arm[aria-pressed=true]");
await page.locator("#project-ways button", { hasText: "Transfer" }).click();
await page.waitForFunction(() => !document.getElementById("transfer-write").disabled);
seen.plan = await rows();
seen.plan_facts = await page.textContent("#transfer-facts");

// What was looked at is not what the devices have any more: nothing is written, and the list is the new one.
execFileSync(program, ["sdo", "write", "5", "6083", "777", "--type", "u32", "--bus", bus]);
await page.click("#transfer-write");
await page.waitForSelector("#project-said[data-mood=error]");
await idle();
seen.changed = await said();
seen.plan_anew = await rows();
seen.untouched = value_of("1017");

// Written as far as the devices take it.
await page.click("#transfer-write");
await page.waitForFunction(() => / written$/.test(document.getElementById("transfer-facts").textContent));
await idle();
seen.said = await said();
seen.mood = await page.getAttribute("#project-said", "data-mood");
seen.facts = await page.textContent("#transfer-facts");
seen.results = await rows();
seen.green = await page.locator("#transfer-rows tr.same td:nth-child(2)").allTextContents();
seen.values = Object.fromEntries(["1017", "1800:01", "1A00", "6081", "6083", "6084"].map((object) => [object, value_of(object === "1A00" ? "1A00:02" : object)]));
await picture(page, "refused", "#transfer");
await page.click("#transfer-close");

// The values of the node say the same: those that were written are not shown as they were before.
seen.devices = await page.locator("#project-nodes td:nth-child(7)").allTextContents();
await page.locator("#project-nodes button", { hasText: "drive" }).click();
await page.waitForSelector("#project-objects tr");
await page.waitForFunction(() => document.querySelectorAll("#project-objects tr.differs").length > 0);
seen.differs = await page.locator("#project-objects tr.differs th").allTextContents();
seen.same = await page.locator("#project-objects tr.same th").allTextContents();
await end();
