// A real browser on error frames, lost arbitration and waiting frames. Says as JSON what it saw. `node web_error_frames.mjs CHROMIUM URL FOLDER`; judged by web_bus_ways_checks.py.
import { end, open, picture, seen, url } from "./page_kit.mjs";

const page = await open(`${url}#bus/0/183`);
await page.waitForSelector("#error-frames .bit");
await page.waitForSelector("#strip .lost-here");
seen.latest = await page.locator("#error-frames li").allTextContents();
const found = await page.evaluate(() => [...document.querySelectorAll("#error-frames .field")].map((one) => [one.querySelector(".field-name").textContent, one.querySelectorAll(".bit").length]));
seen.parts = found.map(([name]) => name);
seen.bits = found.map(([, count]) => count);
seen.wrong = await page.locator("#error-frames .wrong").count();
seen.lost = await page.textContent("#strip .lost-here");
seen.waiting = await page.locator("#counters tbody td:nth-child(7)").allTextContents();
await picture(page, "error-frames", "#bus-section");
seen.cut_off = await page.evaluate(() => document.getElementById("counters").scrollWidth - document.getElementById("counters").clientWidth);
await end();
