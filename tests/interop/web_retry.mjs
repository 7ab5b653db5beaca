// A real browser that has a failed boot tried again. Says as JSON what it saw. `node web_retry.mjs CHROMIUM URL FOLDER NAME`: of the slave.
// Judged by web_retry_checks.py.
import { counted, end, judge, more, open, seen, url } from "./page_kit.mjs";

const [name] = more;
const page = await open();
const show = () => page.locator("#show-boots").evaluate((one) => [one.textContent, one.getAttribute("aria-expanded"), !document.getElementById(one.getAttribute("aria-controls")).hidden]);
seen.show = [await show()];
for (let i = 0; i < 3; ++i) {
  await page.click("#show-boots");
  seen.show.push(await show());
}
const slave = page.locator("#boots li", { hasText: name });
await slave.waitFor();
const buttons = page.locator("#boot-section .ways button:visible");
await buttons.first().waitFor();
seen.buttons = await buttons.allTextContents();
seen.halts = await page.locator("#boot-halts li").allTextContents();
await judge(page, "boots with a failed one");
await slave.locator("summary").click();
const ends = () => slave.locator("tr.failed, tr.done").count();
const before = await ends();
seen.clicks = await counted(page, () => buttons.first().click());
await page.waitForFunction(([text, count]) => {
  const item = [...document.querySelectorAll("#boots li")].find((one) => one.textContent.includes(text));
  return item.querySelectorAll("tr.failed, tr.done").length > count;
}, [name, before], { timeout: 20000 });
seen.attempts = await ends();
seen.still = (await slave.locator(".result").textContent()).includes("product code");
seen.result = await slave.locator(".result").textContent();
await page.waitForFunction(() => document.querySelector("#boot-section .ways button").disabled === false);
seen.command = await slave.locator("[role=status]").getAttribute("title");
seen.halts_left = await page.locator("#boot-halts li").count();
seen.buttons_left = await buttons.count();
seen.pauses = await page.locator("#boots .pause").count();
await judge(page, "boots after a retry");

const looker = await open(url.split("#")[0]);
await looker.click("#show-boots");
await looker.waitForSelector("#boots li");
await looker.waitForTimeout(500);
seen.look = await looker.locator("#boot-section .ways:visible").count();
await end();
