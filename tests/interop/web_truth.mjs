// A real browser on what a page says when things are not as they were. `node web_truth.mjs CHROMIUM URL FOLDER run PID`: of a run that hangs, and of
// nodes with one name; `... project PID`: of a project whose bus (the process PID) falls silent and goes; `... views`: all views. Judged by web_truth_checks.py.
import { end, judge, more, open, seen, url } from "./page_kit.mjs";

const [what, process_of] = more;
const page = await open();
const signal = (name) => process.kill(Number(process_of), name);
const text = (selector) => page.textContent(selector);
const texts = (selector) => page.locator(selector).allTextContents();

async function run() {
  await page.waitForSelector(".nodes li");
  await page.waitForTimeout(2000);
  seen.nodes = await texts(".nodes li b");
  seen.tree = await texts("#tree button[data-node]");
  seen.worst = await text("#worst");
  seen.bar_height = await page.evaluate(() => document.getElementById("bar").offsetHeight);
  for (const width of [320, 400, 640]) {
    await page.setViewportSize({ width, height: 700 });
    await page.waitForTimeout(200);
    await judge(page, `${width} pixels`);
  }
  await page.setViewportSize({ width: 1280, height: 800 });
  // Of two that are called the same each is one of its own; a figure that is plotted by node-ID is none of theirs.
  await page.locator(".nodes button").last().click();
  await page.waitForSelector("#node-body tr");
  seen.plotted_of_twin = await page.locator("#node-body [data-plot]").count();
  await page.click("#close-node");
  await page.locator(".nodes button", { hasText: "WWW" }).click();
  await page.locator("#node-body tr", { hasText: "Frames sent" }).locator("button").click();
  await page.waitForFunction(() => document.querySelector("#plots polyline")?.getAttribute("points")?.split(" ").length > 2);
  seen.title_fits = await page.evaluate(() => document.getElementById("node-title").scrollWidth <= document.getElementById("node-title").clientWidth);
  // A seed stays while faults are written.
  await page.selectOption("#fault-kind", "drop");
  await page.click("#fault-add");
  await page.fill("#fault-seed", "4711");
  await page.locator(".fault textarea").last().fill('kind = "drop"\nidentifier = 0x185\ncount = 2');
  await page.locator(".fault textarea").last().blur();
  await page.waitForTimeout(1500);
  seen.seed = await page.inputValue("#fault-seed");
  // The run hangs: time stands still on the page, and it says so; then it goes on.
  signal("SIGSTOP");
  await page.waitForFunction(() => document.getElementById("where").textContent === "NO ANSWER");
  seen.silent = await text("#connection");
  seen.bar = await page.getAttribute("#bar", "class");
  const time = await text("#time");
  await page.waitForTimeout(700);
  seen.stood_still = time === await text("#time");
  signal("SIGCONT");
  await page.waitForFunction(() => document.getElementById("where").textContent === "SIMULATED" && document.getElementById("connection").textContent === "");
  seen.again = await text("#connection");
}

async function project() {
  const idle = () => page.waitForFunction(() => document.querySelector("#project-ways button:last-child").hidden);
  const said = () => text("#project-said b");
  const way = (name) => page.locator("#project-ways button", { hasText: name });
  const devices = () => texts("#project-nodes td:nth-child(7)");
  await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 2);
  seen.worst = await text("#worst");
  await way("Compare").click();
  await page.waitForFunction(() => document.querySelectorAll("#project-nodes td.same").length === 2);
  await idle();
  seen.devices = await devices();
  // Somebody else changes the project: it is seen here, too, and what is being typed stays.
  await page.locator("#project-nodes button", { hasText: "drive" }).click();
  await page.waitForSelector("#project-objects tr");
  await page.locator("#project-node-form input").first().pressSequentially("!");
  const other = await open(url);
  await other.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 2);
  await other.locator("#project-nodes button", { hasText: "encoder" }).click();
  await other.locator("#project-node-form input").first().fill("by somebody else");
  await other.keyboard.press("Enter");
  await page.waitForSelector("#project-nodes tr:has-text('by somebody else')");
  seen.typed = await page.locator("#project-node-form input").first().inputValue();
  seen.seen_by_others = await texts("#project-nodes button");
  await other.close();
  await page.keyboard.press("Control+A");
  await page.keyboard.type("drive");
  await page.keyboard.press("Tab");
  await idle();
  // A value that is to be written; the bus is live and not armed.
  await page.locator("#project-objects input[data-object='1017:00']").fill("444");
  await page.keyboard.press("Enter");
  await page.waitForSelector("#project-objects tr.unwritten");
  await way("Transfer").click();
  await page.waitForFunction(() => !document.getElementById("transfer-write").disabled);
  seen.plan = await text("#transfer-facts");
  await page.click("#transfer-write");
  await page.waitForSelector("#project-said[data-mood=error]");
  seen.not_armed = [await said(), await text("#transfer-facts"), await page.locator("#transfer-write").isDisabled()];
  await page.click("#transfer-close");
  await page.click("#arm");
  await page.waitForSelector("#arm[aria-pressed=true]");
  // The bus falls silent: nothing that was found before is shown as if it were so now.
  signal("SIGSTOP");
  await way("Compare").click();
  await page.waitForFunction(() => document.querySelector("#project-said b").textContent.includes("no answer"));
  seen.silent = [await said(), await devices(), await page.locator("#project-objects tr.same, #project-objects tr.differs").count()];
  await way("Transfer").click();
  await page.waitForFunction(() => !document.getElementById("transfer-facts").textContent.startsWith("asks"));
  seen.not_planned = [await text("#transfer-facts"), await page.locator("#transfer-write").isDisabled()];
  signal("SIGCONT");
  await page.click("#transfer-close");
  await way("Compare").click();
  await page.waitForSelector("#project-nodes td.same");
  await idle();
  // It is gone: LIVE is said of no bus that is not there.
  signal("SIGKILL");
  await page.waitForFunction(() => document.getElementById("where").textContent.endsWith(" GONE"));
  seen.gone = [await text("#where"), await text("#worst"), await text(".bus header .bad")];
  await judge(page, "a bus that is gone");
}

/// Each view, opened by who may do everything.
async function views() {
  await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 2);
  await page.click("#follow");
  await page.keyboard.press("i");
  for (const hash of ["#bus/0", "#bus/0/701", "#objects/0", "#objects/1", "#words/0", "#boots", "#trace", "#trace/service%3Dsdo", "#project/0/1", "#faults-section", "#events-section", "#overview"]) {
    await page.evaluate((link) => { location.hash = link; }, hash);
    await page.waitForTimeout(400);
  }
  for (const button of await page.locator(".nodes button").all()) await button.click();
  await page.click("#close-node");
  await page.click(".bus-ways summary");
  await page.locator("#buses .number").first().click();
  await page.waitForTimeout(1000);
}

await { run, project, views }[what]();
await end();
