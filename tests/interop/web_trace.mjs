// A real browser on the trace of a run's page: filters, folding, holding, statistics, export, keys, links. Says as JSON what it saw.
// `node web_trace.mjs CHROMIUM URL FOLDER`; pictures and the exported files go into FOLDER. Judged by web_trace_checks.py.
import { counted, end, folder, judge, open, picture, seen, url } from "./page_kit.mjs";

const page = await open(`${url.split("#")[0]}#trace`);
const lines = () => page.locator("#trace tbody tr").allTextContents();
const said = () => page.textContent("#trace-said");
const filter = async (text) => {
  await page.fill("#trace-filter", text);
  await page.waitForFunction((wanted) => /^\d+ lines|expected|unknown/.test(document.getElementById("trace-said").textContent) && document.getElementById("trace-filter").value === wanted, text);
  await page.waitForTimeout(700);
};
await page.waitForFunction(() => document.querySelectorAll("#trace tbody tr").length > 10 && document.getElementById("trace").textContent.includes("TPDO1"));

// It follows; what is held stands still while frames come.
const first = (await lines())[0];
await page.waitForFunction((text) => document.querySelector("#trace tbody tr").textContent !== text, first);
await page.click("#trace-hold");
await page.waitForTimeout(500);
const held = await lines();
const count = await said();
await page.waitForTimeout(1200);
seen.held = JSON.stringify(held) === JSON.stringify(await lines());
// Keys: to the beginning, and down by lines.
await page.focus("#trace");
await page.keyboard.press("Home");
await page.waitForFunction(() => document.querySelector("#trace tbody tr").textContent.includes("boot-up"));
seen.oldest = (await lines())[0];
await page.keyboard.press("ArrowDown");
await page.keyboard.press("ArrowDown");
await page.waitForTimeout(300);
seen.third = (await lines())[0];
await page.mouse.move(...await page.locator("#trace").boundingBox().then((box) => [box.x + 100, box.y + 100]));
await page.mouse.wheel(0, -440);
await page.waitForTimeout(300);
seen.wheeled = (await lines())[0] === seen.oldest;

// A transfer is one line, opened to its frames; as frames, the two are marked together.
seen.transfer = await counted(page, () => page.locator("#trace tbody tr", { hasText: "Product code" }).first().click());
await page.waitForSelector("#trace-frames");
seen.frames = await page.locator("#trace-frames tbody tr").allTextContents();
seen.facts = await page.textContent("#trace-one");
await page.uncheck("#trace-fold");
await filter("service=sdo node=3");
await page.locator("#trace tbody tr", { hasText: "upload response" }).first().click();
await page.waitForFunction(() => document.querySelectorAll("#trace tr.pair").length === 2);
seen.pair = await page.locator("#trace tr.pair").allTextContents();
seen.filtered = await lines();

// A wrong filter is said where it is; a link has the filter.
await filter("service=sdp");
seen.wrong = await said();
seen.invalid = await page.getAttribute("#trace-filter", "aria-invalid");
await filter("id=183");
await page.press("#trace-filter", "Enter");
seen.link = await page.evaluate(() => location.hash);

// What is exported is what the filter lets through.
for (const format of ["candump", "pcapng"]) {
  await page.selectOption("#trace-format", format);
  const download = page.waitForEvent("download");
  await page.click("#trace-export");
  await (await download).saveAs(`${folder}/trace.${format}`);
  await page.waitForFunction(() => document.getElementById("trace-exported").textContent.includes("are exported"));
  seen[format] = await page.textContent("#trace-exported");
}
await page.check("#trace-fold");
await filter("");
await page.check("#trace-newest");
await page.check("#trace-delta");
await page.waitForTimeout(600);
seen.delta = (await lines())[3];
await page.uncheck("#trace-newest");
await page.uncheck("#trace-delta");
await page.click("#trace-hold");
await page.focus("#trace");
await page.keyboard.press("Home");
await page.waitForTimeout(500);
await page.locator("#trace tbody tr", { hasText: "Product code" }).first().click();
await page.click("#trace-statistics");
await page.waitForSelector("#trace-figures table");
seen.figures = await page.locator("#trace-figures tbody tr", { hasText: "TPDO1 of 3" }).first().textContent();
await picture(page, "trace", "#trace-section");

// In a narrow window the meaning stays.
await page.setViewportSize({ width: 700, height: 800 });
seen.narrow = await page.locator("#trace th", { hasText: "Meaning" }).evaluate((one) => one.offsetWidth);
await judge(page, "trace 700");
await page.setViewportSize({ width: 1280, height: 800 });

// Another page opens the link, and hostile ones do no harm.
const other = await open(`${url.split("#")[0]}#trace/${encodeURIComponent("node=3 service=error-control")}`);
await other.waitForFunction(() => document.querySelector("#trace tbody")?.textContent.includes("operational"));
seen.linked = await other.inputValue("#trace-filter");
for (const hash of ["#trace/%", "#trace/%22%3Cimg src=x onerror=alert(1)%3E", `#trace/${"x".repeat(2000)}`]) {
  await other.evaluate((text) => { location.hash = text; }, hash);
  await other.waitForTimeout(500);
}
seen.hostile = await other.locator("#trace-section img").count();
seen.last = await other.textContent("#trace-said");
await end();
