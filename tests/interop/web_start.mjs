// A real browser on the page of `canopus web` without a project. Says as JSON what it saw.
// `node web_start.mjs CHROMIUM URL FOLDER`; pictures go into FOLDER. Judged by web_project_checks.py.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

const [executablePath, url, folder] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const seen = { problems: [], pictures: [], axe: [], overflow: [] };
const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", bypassCSP: true });
const page = await context.newPage();
page.on("console", (message) => ["error", "warning"].includes(message.type()) && seen.problems.push(message.text()));
page.on("pageerror", (error) => seen.problems.push(String(error)));
const counts = { clicks: 0, typed: 0 };
await context.exposeFunction("tell", (kind) => { ++counts[kind]; });
await context.addInitScript(() => {
  addEventListener("click", (event) => { if (event.isTrusted) tell("clicks"); }, true);
  addEventListener("keydown", (event) => { if (event.isTrusted && event.key.length === 1) tell("typed"); }, true);
});
await page.goto(url);
await page.waitForSelector("#start-projects button");
seen.sections = await page.locator("main > section:not([hidden])").evaluateAll((all) => all.map((one) => one.id));
seen.plants = await page.locator("#start-plants li").allTextContents();
seen.projects = await page.locator("#start-projects li").allTextContents();
for (const colorScheme of ["light", "dark"]) {
  for (const [width, height] of [[1280, 800], [1920, 1080]]) {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize({ width, height });
    const path = `${folder}/start-${colorScheme}-${width}.png`;
    await page.screenshot({ path });
    seen.pictures.push(path);
    if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth)) seen.overflow.push(`start ${width}`);
    if (width !== 1280) continue;
    await page.evaluate(axe);
    const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
    for (const one of found.violations.filter((violation) => ["serious", "critical"].includes(violation.impact))) seen.axe.push(`${colorScheme}: ${one.id}`);
  }
}

// W1.
Object.assign(counts, { clicks: 0, typed: 0 });
const begin = performance.now();
await page.click("#start-try");
await page.waitForFunction(() => / [1-9]\d* frames/.test(document.querySelector(".bus .faint")?.textContent ?? ""));
seen.milliseconds = Math.round(performance.now() - begin);
seen.w1 = { ...counts };
seen.nodes = await page.locator(".nodes li").count();

// A new project; and who only looks.
await page.goto(url.split("#")[0]);
await page.waitForSelector("#start-projects button");
await page.fill("#start-name", "fresh");
await page.press("#start-name", "Enter");
await page.waitForFunction(() => document.getElementById("project-title")?.textContent.startsWith("Project "), null, { timeout: 20000 });
seen.fresh = await page.textContent("#project-title");
const looker = await browser.newPage();
await looker.goto(url.split("#")[0]);
await looker.waitForSelector("#start-projects button");
seen.look_disabled = await looker.locator("#start-try").isDisabled();
await browser.close();
console.log(JSON.stringify(seen));
