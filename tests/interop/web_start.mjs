// A real browser on the page of `canopus web` without a project. Says as JSON what it saw.
// `node web_start.mjs CHROMIUM URL FOLDER`; pictures go into FOLDER. Judged by web_project_checks.py.
import { counted, end, judge, open, picture, seen, url } from "./page_kit.mjs";

const page = await open();
await page.waitForSelector("#start-projects button");
seen.sections = await page.locator("main > section:not([hidden])").evaluateAll((all) => all.map((one) => one.id));
seen.plants = await page.locator("#start-plants li").allTextContents();
seen.projects = await page.locator("#start-projects li").allTextContents();
await picture(page, "start");

const try_a_plant = async () => {
  const begin = performance.now();
  await page.click("#start-try");
  await page.waitForFunction(() => / [1-9]\d* frames/.test(document.querySelector(".bus .faint")?.textContent ?? ""));
  return Math.round(performance.now() - begin);
};
seen.milliseconds = [];
seen.w1 = await counted(page, async () => seen.milliseconds.push(await try_a_plant()));
seen.nodes = await page.locator(".nodes li").count();
while (seen.milliseconds.length < 3 && Math.min(...seen.milliseconds) >= 1000) {
  await page.goto(url);
  await page.waitForSelector("#start-projects button");
  seen.milliseconds.push(await try_a_plant());
}

// It runs on; what runs can be ended.
await page.goto(url);
await page.waitForSelector("#start-running li");
seen.running = await page.locator("#start-running li").allTextContents();
await page.locator("#start-running button").first().click();
await page.waitForFunction(() => document.getElementById("start-said").textContent === "the built-in plant ends");
// One that is opened twice is one run.
const opened = async () => {
  await page.goto(url);
  await page.waitForSelector("#start-plants button");
  await page.locator("#start-plants button", { hasText: "plant.toml" }).click();
  await page.waitForURL((one) => one.host !== new URL(url).host);
  return page.evaluate(() => location.host);
};
seen.twice = [await opened(), await opened()];

// A new project; and who only looks.
await page.goto(url.split("#")[0]);
await page.waitForSelector("#start-projects button");
await page.fill("#start-name", "fresh");
await page.press("#start-name", "Enter");
await page.waitForFunction(() => document.getElementById("project-title")?.textContent.startsWith("Project "), null, { timeout: 20000 });
seen.fresh = await page.textContent("#project-title");
await page.goto(url);
await page.waitForSelector("#start-settings button");
seen.settings = await page.locator("#start-settings li").allTextContents();
await page.fill("#start-settings-name", "press");
await page.press("#start-settings-name", "Enter");
await page.waitForFunction(() => document.getElementById("settings-title")?.textContent.startsWith("Settings of "), null, { timeout: 20000 });
seen.fresh_settings = await page.textContent("#settings-title");
await page.click("#open-about");
seen.about = await page.locator("#about dl div").allTextContents();
await judge(page, "about");
await page.keyboard.press("Escape");
await page.waitForFunction(() => document.getElementById("where").textContent.startsWith("LIVE PLC"));
seen.where = await page.textContent("#where");
seen.sections_of_settings = await page.locator("main > section:not([hidden])").evaluateAll((all) => all.map((one) => one.id));
await picture(page, "settings-alone", null, ["light"]);
const looker = await open(url.split("#")[0]);
await looker.waitForSelector("#start-projects button");
seen.look_disabled = await looker.locator("#start-try").isDisabled();
seen.look_exit = await looker.locator("#start-exit").isDisabled();
seen.look_recent = await looker.isVisible("#start-recent-part");
// A copy of the settings; what was used last; Close; Exit, which is asked for.
await page.goto(url);
await page.waitForSelector("#start-recent button");
seen.recent = await page.locator("#start-recent li").allTextContents();
seen.headings = await page.locator("#start-section :is(h2, h3), #start-section button").allTextContents();
await page.selectOption("#start-copied", "press.xml");
await page.fill("#start-copy-name", "there/not");
await page.press("#start-copy-name", "Enter");
await page.waitForSelector("#start-said[data-mood=error]");
seen.save_as_refused = await page.textContent("#start-said");
await page.fill("#start-copy-name", "second");
await page.press("#start-copy-name", "Enter");
await page.waitForFunction(() => document.getElementById("settings-title")?.textContent.endsWith("/second.xml"), null, { timeout: 20000 });
await page.goto(url);
await page.waitForSelector("#start-recent button");
await page.locator("#start-recent button", { hasText: "press.xml" }).click();
await page.waitForFunction(() => document.getElementById("settings-title")?.textContent.endsWith("/press.xml"), null, { timeout: 20000 });
await page.goto(url);
await page.getByRole("button", { name: "Close second.xml", exact: true }).click();
await page.waitForFunction(() => document.getElementById("start-said").textContent === "second.xml ends");
await page.click("#start-exit");
await page.waitForSelector("dialog[open]");
await judge(page, "exit");
await page.getByRole("button", { name: "No", exact: true }).click();
seen.after_no = await page.textContent("#where");
await page.click("#start-exit");
await page.getByRole("button", { name: "Yes", exact: true }).click();
await page.waitForFunction(() => document.getElementById("where").textContent === "NOT CONNECTED");
await end();
