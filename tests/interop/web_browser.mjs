// A real browser on the page of a run: says as JSON what it saw. `node web_browser.mjs CHROMIUM URL FOLDER`; pictures go into
// FOLDER. Judged by web_checks.py.
import { chromium } from "playwright-core";

const [executablePath, url, folder] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const seen = { problems: [], dialogs: 0, requests: [], pictures: [] };

async function open(colorScheme, width, height) {
  const page = await browser.newPage({ colorScheme, viewport: { width, height } });
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && seen.problems.push(message.text()));
  page.on("pageerror", (error) => seen.problems.push(String(error)));
  page.on("dialog", (dialog) => {
    ++seen.dialogs;
    dialog.dismiss();
  });
  page.on("request", (request) => seen.requests.push(request.url()));
  await page.goto(url);
  await page.waitForFunction(() => /^[1-9]/.test(document.getElementById("operation").textContent));
  await page.waitForSelector(".nodes li");
  return page;
}

for (const scheme of ["light", "dark"]) {
  for (const [width, height] of [[1280, 800], [1920, 1080]]) {
    const page = await open(scheme, width, height);
    await page.waitForTimeout(1500);
    const path = `${folder}/overview-${scheme}-${width}.png`;
    // The strip stands at the end of the page, not where the window ends.
    await page.evaluate(() => { document.getElementById("newest").style.position = "static"; });
    await page.screenshot({ path, fullPage: true });
    seen.pictures.push(path);
    await page.close();
  }
}

const page = await open("light", 1280, 800);
const texts = (selector) => page.locator(selector).allTextContents();
seen.where = await page.textContent("#where");
seen.plant = await page.textContent("#plant");
seen.title = await page.title();
seen.operation = await page.textContent("#operation");
seen.nodes = await texts(".nodes b");
seen.moods = await page.locator(".nodes button").evaluateAll((all) => all.map((one) => one.dataset.mood));
seen.reasons = await texts(".nodes .reason");
seen.leds = await texts(".led span");
seen.events = await texts("#events .event");
seen.markup = await page.locator("img, iframe, script:not([src='page.js'])").count();
seen.overflow = await page.evaluate(() => document.documentElement.scrollWidth > innerWidth);
// By the keyboard alone: to the first node, open it, and back.
for (let i = 0; i < 30; ++i) {
  await page.keyboard.press("Tab");
  if (await page.evaluate(() => document.activeElement.matches(".nodes button"))) break;
}
await page.keyboard.press("Enter");
seen.opened = await page.textContent("#node-title");
seen.focus_in = await page.evaluate(() => document.activeElement.id);
seen.rows = await texts("#node-body tr");
await page.keyboard.press("Escape");
seen.focus_back = await page.evaluate(() => document.activeElement.matches(".nodes button"));
// Every control has a name for a screen reader.
seen.unnamed = (await page.locator("button, input").evaluateAll((all) => all.filter((one) =>
  !(one.getAttribute("aria-label") || one.textContent.trim() || one.labels?.length)).length));
await page.click("#follow");
seen.follow = [await page.textContent("#follow")];
await page.waitForSelector("#messages .event");
await page.fill("#message-filter", "pdo");
await page.waitForFunction(() => document.querySelectorAll("#messages .event").length > 5);
seen.messages = await texts("#messages .event");
const picture = `${folder}/messages-light-1280.png`;
await page.screenshot({ path: picture, fullPage: true });
seen.pictures.push(picture);
await page.click("#follow");
seen.follow.push(await page.textContent("#follow"));
seen.first_time = await page.textContent("#time");
await page.waitForTimeout(700);
seen.later_time = await page.textContent("#time");
await page.fill("#filter", "boot-up");
seen.filtered = await texts("#events .event");
// The buffer memory of the first module: names, values, the PDO behind a word; only the rows in sight are there.
await page.click(".open-words");
await page.waitForFunction(() => document.querySelectorAll("#words-table tbody tr").length > 10);
seen.words_title = await page.textContent("#words-title");
seen.words_focus = await page.evaluate(() => document.activeElement.id);
seen.words_count = await page.textContent("#words-count");
seen.words_rows = await page.locator("#words-table tbody tr").count();
const first_row = () => page.textContent("#words-table tbody tr");
await page.fill("#words-find", "G10000");
await page.waitForFunction(() => document.querySelector("#words-table tbody tr")?.textContent.startsWith("G10000"));
await page.waitForFunction(() => document.querySelector("#words-table tbody tr")?.textContent.includes(" s ago"), null, { timeout: 10000 }).catch(() => {});
seen.word = await first_row();
await page.click("#words-base");
seen.word_hexadecimal = await page.textContent("#words-table tbody tr td:nth-child(3)");
await page.fill("#words-find", "");
await page.waitForFunction(() => document.querySelectorAll("#words-table tbody tr").length > 10);
await page.locator("#words").evaluate((list) => { list.scrollTop = list.scrollHeight / 2; });
await page.waitForFunction(() => parseInt(document.getElementById("words-table").style.top) > 26 * 100);
seen.words_scrolled = await first_row();
await page.fill("#words-find", "G100");
await page.waitForTimeout(600);
// The boots of the slaves, step by step.
await page.click("#show-boots");
await page.waitForSelector("#boots li");
seen.boots = await texts("#boots summary");
await page.locator("#boots summary").first().click();
seen.boot_steps = await page.locator("#boots li").first().locator("tr").allTextContents();
for (const scheme of ["light", "dark"]) {
  await page.emulateMedia({ colorScheme: scheme });
  for (const [id, name] of [["#words-section", "words"], ["#boot-section", "boot"]]) {
    const path = `${folder}/${name}-${scheme}-1280.png`;
    await page.locator(id).screenshot({ path });
    seen.pictures.push(path);
  }
}
await page.emulateMedia({ colorScheme: "light" });
await page.keyboard.press("Escape");
seen.words_closed = await page.locator("#words-section").isHidden();
seen.markup_later = await page.locator("img, iframe, script:not([src='page.js'])").count();
// A page of another site gets nothing.
const other = await browser.newPage();
await other.goto("data:text/html,<title>other</title>");
seen.foreign = await other.evaluate((address) => new Promise((done) => {
  const socket = new WebSocket(address);
  socket.onopen = () => done("open");
  socket.onerror = () => done("refused");
}), `${url.replace("http", "ws")}events`);
seen.framed = await other.evaluate((address) => fetch(address).then(() => "read", () => "refused"), url);
await browser.close();
console.log(JSON.stringify(seen));
