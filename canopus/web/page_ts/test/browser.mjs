// The page in a real browser: `node test/browser.mjs CHROMIUM FOLDER URL`. URL: what `tools/page --serve` prints, of a run of examples/stuck-slave/plant.toml, whose
// nodes are in trouble. Counts clicks and characters, works with the keyboard alone, takes pictures of each screen into FOLDER, light and dark, 1280 and 1920
// pixels wide, and has axe-core look at them. playwright-core and axe-core are those of tests/interop. Prints what failed, and ends with 1 then.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";

const [executablePath, folder, url] = process.argv.slice(2);
const require = createRequire(new URL("../../../../tests/interop/package.json", import.meta.url));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
let failures = 0;

async function open(hash = "", options = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", ...options });
  const page = await context.newPage();
  const counts = { clicks: 0, typed: 0 };
  page.problems = [];
  page.counts = counts;
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && page.problems.push(message.text()));
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => new URL(request.url()).host === new URL(url).host || /^(data|blob):/.test(request.url()) || page.problems.push(`request of ${request.url()}`));
  await page.exposeFunction("tell", (kind) => { ++counts[kind]; });
  await page.addInitScript(() => {
    // A button that Enter presses gets a click, too, but none of a mouse.
    for (const kind of ["click", "contextmenu"]) addEventListener(kind, (event) => { if (event.isTrusted && (event.detail > 0 || event.type === "contextmenu")) tell("clicks"); }, true);
    addEventListener("keydown", (event) => { if (event.isTrusted && event.key.length === 1) tell("typed"); }, true);
  });
  await page.goto(url);
  await page.waitForSelector(".node");
  if (hash) await page.evaluate((address) => { location.hash = address; }, hash);
  return page;
}

/** Tab until the element with the focus matches. */
async function tab_to(page, selector) {
  for (let i = 0; i < 60; ++i) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((one) => document.activeElement?.closest(one) !== null && document.activeElement !== document.body, selector)) return;
  }
  assert.fail(`the keyboard does not lead to ${selector}`);
}

const tests = {
  async "W5: a red node says its reason after one click"() {
    const page = await open();
    await page.click(".node[data-mood=error]");
    assert.match(await page.textContent(".drawer .lead"), /product code differs/);
    assert.deepEqual(page.counts, { clicks: 1, typed: 0 });
    return page;
  },
  async "W8: one click on a number plots it"() {
    const page = await open();
    await page.click(".bus .number");
    await page.evaluate(() => { location.hash = "#/plots"; });
    await page.waitForSelector("plot-chart canvas");
    assert.equal(page.counts.clicks, 1);
    return page;
  },
  async "W9: what if this frame is lost: right click, Lose it, Run"() {
    const page = await open("#/trace");
    await page.waitForSelector("#trace-grid .ag-row .ag-cell[col-id=text]");
    await page.waitForTimeout(500);
    await page.click("#trace-grid .ag-row .ag-cell[col-id=text]", { button: "right" });
    await page.click("#menu button");
    await page.click("#fault-run");
    await page.waitForSelector(".fault[data-mood=acting]");
    assert.deepEqual(page.counts, { clicks: 3, typed: 0 });
    // Remove means removed.
    await page.click(".fault ix-icon-button");
    await page.waitForSelector(".fault", { state: "detached" });
    return page;
  },
  async "a filter is completed with the name of a node"() {
    const page = await open("#/trace");
    await page.click("filter-input");
    await page.keyboard.type("no");
    await page.waitForTimeout(400);
    await page.keyboard.press("Tab");
    await page.keyboard.type("enc");
    await page.waitForTimeout(400);
    await page.keyboard.press("Tab");
    await page.waitForFunction(() => location.hash === "#/trace?filter=node%3D3");
    return page;
  },
  async "an abort code stands in the row of its transfer"() {
    const page = await open("#/trace?filter=service%3Dsdo%20errors");
    await page.waitForFunction(() => /^[0-9A-F]{8}H /.test(document.querySelector("#trace-grid .ag-row .ag-cell[col-id=text]")?.textContent ?? ""));
    return page;
  },
  async "by the keyboard alone: a node, then the trace, then a line of it"() {
    const page = await open();
    await tab_to(page, ".trouble, .node");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".drawer .lead");
    await page.keyboard.press("Control+k");
    await page.waitForSelector("#palette-words:focus");
    await page.keyboard.type("trace");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#trace-grid .ag-row");
    await page.waitForTimeout(600);
    await tab_to(page, ".ag-cell, .ag-header-cell");
    await page.keyboard.press("ArrowDown");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".drawer .facts");
    assert.equal(page.counts.clicks, 0);
    return page;
  },
  async "by the keyboard alone: an object is found and described"() {
    const page = await open("#/objects/line1/4");
    await page.waitForSelector("#objects-grid .ag-row");
    await page.keyboard.press("/");
    await page.keyboard.type("6041");
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-cell[col-id=object]")?.textContent === "6041:00");
    await tab_to(page, ".ag-cell, .ag-header-cell");
    await page.keyboard.press("ArrowDown");
    await page.keyboard.press("Enter");
    await page.waitForFunction(() => document.querySelector(".drawer h2")?.textContent === "Statusword");
    assert.equal(page.counts.clicks, 0);
    return page;
  },
  async "nothing found is said"() {
    const page = await open();
    await page.keyboard.press("Control+k");
    await page.waitForSelector("#palette-words:focus");
    await page.keyboard.type("zzzz");
    await page.waitForSelector("#palette p");
    assert.match(await page.textContent("#palette p"), /^Nothing found for “zzzz”/);
    return page;
  },
};

for (const [name, test] of Object.entries(tests)) {
  try {
    const page = await test();
    assert.deepEqual(page.problems, []);
    await page.context().close();
    console.log(`ok ${name}`);
  } catch (error) {
    ++failures;
    console.log(`not ok ${name}: ${String(error.message ?? error).slice(0, 500)}`);
  }
}

const screens = ["start", "overview", "overview?node=line1/3/encoder", "scan", "bus", "boot", "module", "module/0/errors", "settings", "objects/line1/4", "pdos", "trace", "plots?bus%20line1%20now=load", "faults", "project", "transfer", "events"];
for (const colorScheme of ["light", "dark"]) {
  for (const [width, height] of [[1280, 800], [1920, 1080]]) {
    const page = await open("", { colorScheme, viewport: { width, height } });
    const devtools = await page.context().newCDPSession(page);
    for (const screen of screens) {
      await page.evaluate((address) => { location.hash = `#/${address}`; }, screen);
      await page.waitForTimeout(900);
      const name = `${screen.replace(/[^\w-]+/g, "-")} ${colorScheme} ${width}`;
      await page.screenshot({ path: `${folder}/${name.replaceAll(" ", "-")}.png` });
      const problems = page.problems.splice(0);
      if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight)) problems.push("wider or higher than the window");
      await devtools.send("Page.setBypassCSP", { enabled: true });
      await page.evaluate(axe);
      const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
      await devtools.send("Page.setBypassCSP", { enabled: false });
      for (const one of found.violations.filter((violation) => ["serious", "critical"].includes(violation.impact))) problems.push(`${one.id}: ${one.nodes.slice(0, 2).map((node) => node.html.slice(0, 120)).join(" | ")}`);
      if (problems.length === 0) continue;
      ++failures;
      console.log(`not ok ${name}: ${problems.join("; ")}`);
    }
    await page.context().close();
  }
}
await browser.close();
console.log(failures ? `${failures} failed` : "all good");
process.exit(failures ? 1 : 0);
