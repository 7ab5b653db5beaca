// A real browser on the description of what has the focus and on the strip with the newest events. Says as JSON what it saw.
// `node web_description.mjs CHROMIUM URL FOLDER`; judged by web_description_checks.py.
import { end, judge, open as open_page, picture, seen, url } from "./page_kit.mjs";

const open = async (hash, options) => {
  const page = await open_page(url + hash, options);
  await page.waitForSelector("#newest-list li");
  return page;
};
const facts = (page) => page.locator("#description-rows div").evaluateAll((all) => Object.fromEntries(all.map((one) => [one.children[0].textContent, one.children[1].textContent])));

// On a wide window the pane is there from the beginning; a button is reached by the keyboard, and so is what it says.
const wide = await open("#objects/2", { viewport: { width: 1920, height: 1080 } });
seen.wide = await wide.isVisible("#description");
await wide.fill("#objects-find", "1017");
await wide.waitForFunction(() => document.querySelector("#objects-table tbody tr")?.textContent.startsWith("1017:00"));
await wide.locator("#objects-table .number").focus();
await wide.waitForFunction(() => document.querySelector("#description-source").textContent !== "");
seen.heartbeat = { title: await wide.textContent("#description-title"), facts: await facts(wide), meaning: await wide.textContent("#description-meaning"), source: await wide.textContent("#description-source") };
// One of the device's own.
await wide.fill("#objects-find", "6004");
await wide.waitForFunction(() => document.querySelector("#objects-table tbody tr")?.textContent.startsWith("6004:00"));
await wide.locator("#objects-table tbody td").first().click();
await wide.waitForFunction(() => document.querySelector("#description-meaning").textContent.startsWith("An object of the device"));
seen.own = await facts(wide);
await judge(wide, "description 1920");
await picture(wide, "description", null);
await wide.setViewportSize({ width: 1920, height: 1080 });
// Words of the buffer memory.
await wide.evaluate(() => { location.hash = "#words/0"; });
await wide.fill("#words-find", "g24");
await wide.waitForFunction(() => document.querySelector("#words-table tbody tr")?.textContent.startsWith("G24"));
await wide.locator("#words-table .number").first().focus();
await wide.waitForFunction(() => document.querySelector("#description-rows").textContent.includes("Manual"));
seen.word = { title: await wide.textContent("#description-title"), facts: await facts(wide), meaning: await wide.textContent("#description-meaning") };
// Hidden, and so it stays.
await wide.locator("#words-title").focus();
await wide.keyboard.press("i");
seen.hidden = !await wide.isVisible("#description");
await wide.reload();
await wide.waitForSelector("#newest-list li");
seen.stays_hidden = !await wide.isVisible("#description");
await wide.close();

// On a small window it comes when it is asked for, and covers no more than half.
const small = await open("#objects/2");
seen.small = await small.isVisible("#description");
await small.click("#show-description");
seen.small_asked = await small.isVisible("#description");
seen.pressed = await small.getAttribute("#show-description", "aria-pressed");
await judge(small, "description 1280");
await small.click("#show-description");

// The strip: the newest events in words, each a link to its frames.
seen.newest = await small.locator("#newest-list a").allTextContents();
seen.in_sight = await small.evaluate(() => document.getElementById("newest").getBoundingClientRect().bottom <= innerHeight + 1);
const link = small.locator("#newest-list a[href^='#trace/']").last();
seen.event = { text: await link.textContent(), link: decodeURIComponent(await link.getAttribute("href")) };
await link.click();
await small.waitForSelector("#trace tr[aria-selected]");
seen.filter = await small.inputValue("#trace-filter");
seen.frame = await small.locator("#trace tr[aria-selected] td").allTextContents();
await judge(small, "newest events");
await small.click("#newest button");
seen.folded = !await small.isVisible("#newest-list");
await small.close();
await end();
