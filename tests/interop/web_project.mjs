// A real browser on the page of a project: what people do there, with their clicks and typed characters counted. Says as JSON what
// it saw. `node web_project.mjs CHROMIUM URL FOLDER EDS`; pictures go into FOLDER. Judged by web_project_checks.py.
import { readFileSync } from "node:fs";
import { counted, end, folder, judge, more, open, picture, seen, url } from "./page_kit.mjs";

const [eds] = more;
const page = await open();
await page.waitForFunction(() => document.getElementById("project-title").textContent.length > 8);
seen.address = await page.evaluate(() => location.href);
seen.role = await page.textContent("#role");
const texts = (selector) => page.locator(selector).allTextContents();
const said = () => page.textContent("#project-said b");
const idle = () => page.waitForFunction(() => document.querySelector("#project-ways button:last-child").hidden);
const way = (name) => page.locator("#project-ways button", { hasText: name });

// W2: what runs on the bus becomes the project.
seen.w2 = await counted(page, async () => {
  await way("Scan").click();
  await idle();
  seen.scanned = await said();
  await way("Adopt all").click();
  await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length >= 3);
  await idle();
});
seen.adopted = await said();
seen.nodes = await texts("#project-nodes tr");
seen.in_the_way = await texts("#project-findings li");

// W3: a device file is dropped on the project.
seen.w3 = await counted(page, async () => {
  const data = await page.evaluateHandle(([name, text]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([text], name));
    return transfer;
  }, [eds.split("/").pop(), readFileSync(eds, "latin1")]);
  await page.dispatchEvent("#project-drop", "drop", { dataTransfer: data });
  await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length >= 4);
  await idle();
});
seen.added = await said();
seen.nodes_later = await texts("#project-nodes tr");

// W4: one drag links two signals; both PDOs and the load are there before it is kept.
await page.selectOption("#link-from-node", { label: (await texts("#link-from-node option")).find((one) => one.includes("encoder")) });
await page.selectOption("#link-to-node", { label: (await texts("#link-to-node option")).find((one) => one.includes("drive")) });
const from = page.locator("#link-from button", { hasText: "Position value" });
const to = page.locator("#link-to button", { hasText: "Target position" });
await to.waitFor();
await page.waitForTimeout(300);
seen.w4 = await counted(page, async () => {
  await from.dragTo(to);
  await page.waitForSelector("#link-plan:not([hidden])");
});
seen.plan = await texts("#link-plan-rows tr");
seen.plan_load = await page.textContent("#link-plan-load");
await picture(page, "link", "#pdo-part");
await page.click("#link-keep");
await page.waitForSelector("#pdo-matrix .crossing:has-text('Position value')");
await idle();
seen.matrix = await texts("#pdo-matrix .crossing");
seen.command = await page.textContent("#project-said code");

// A PDO's type and times.
await page.locator("#pdo-list tr", { hasText: "181H" }).locator("button", { hasText: "Change" }).click();
await page.locator("#pdo-edit input[aria-label='Event timer']").fill("250ms");
await page.keyboard.press("Enter");
await page.waitForSelector("#pdo-list tr:has-text('every 250 ms')");
seen.changed_pdo = await page.locator("#pdo-list tr", { hasText: "181H" }).textContent();
await page.selectOption("#project-bit-rate", "250k");
await page.waitForFunction(() => document.getElementById("project-facts").textContent.includes("250 kbit/s"));
seen.facts = await page.textContent("#project-facts");

// A value of a node: out of range first, with the sentence, then one that fits.
await page.locator("#project-nodes button", { hasText: "drive" }).click();
const beat = page.locator("#project-objects input[data-object='1017:00']");
await beat.waitFor();
await beat.fill("70000");
await beat.press("Enter");
await page.waitForSelector("#project-said[data-mood=error]");
seen.refused = await said();
await beat.fill("250");
await beat.press("Enter");
await page.waitForSelector("#project-objects tr.unwritten");
seen.unwritten = await texts("#project-objects tr.unwritten");

// Three columns: project, device, difference.
await way("Compare with devices").click();
await page.waitForSelector("#project-objects tr.differs");
await idle();
seen.compared = await said();
seen.differs = await texts("#project-objects tr.differs");
seen.devices = await texts("#project-nodes td:nth-child(7)");
await picture(page, "project", "#project-section");
seen.cut_off = await page.locator("#pdo-part [aria-label=PDOs]").evaluate((one) => one.scrollWidth - one.clientWidth);

// Nothing is written on a live bus before it is armed.
await way("Transfer").click();
await page.waitForFunction(() => !document.getElementById("transfer-write").disabled);
await page.click("#transfer-write");
await page.waitForSelector("#project-said[data-mood=error]");
seen.not_armed = await said();
await page.click("#transfer-close");
await page.click("#arm");
await page.waitForSelector("#arm[aria-pressed=true]");
seen.armed = await page.textContent("#arm");

// W7: into the machine.
seen.w7 = await counted(page, async () => {
  await way("Transfer").click();
  await page.waitForSelector("#transfer-rows tr");
  await page.waitForFunction(() => !document.getElementById("transfer-write").disabled);
  seen.will_write = await texts("#transfer-rows tr");
  await page.click("#transfer-write");
  await page.waitForSelector("#transfer-rows tr.same");
  await idle();
});
seen.written = await texts("#transfer-rows tr");
seen.transfer_facts = await page.textContent("#transfer-facts");
await picture(page, "transfer", "#transfer");
await page.click("#transfer-close");
seen.same = await texts("#project-objects tr.same");

// W6: a device that was replaced.
seen.w6 = await counted(page, async () => {
  await page.locator("#project-node-form button", { hasText: "Accept this device" }).click();
  await page.waitForSelector("#project-accepted:not([hidden]) tr");
  seen.will_accept = await texts("#project-accepted tr");
  await judge(page, "accept this device");
  await page.click("#project-accept");
  await page.waitForFunction(() => document.querySelector("#project-said b").textContent === "this device is the project's now");
});
await idle();

// W10: the report.
const download = page.waitForEvent("download");
seen.w10 = await counted(page, async () => {
  await way("Report").click();
  await download;
});
await (await download).saveAs(`${folder}/report.html`);

await way("Undo").click();
await page.waitForFunction(() => document.querySelector("#project-said b").textContent.startsWith("taken back"));
seen.undone = await said();
seen.markup = await page.evaluate(() => document.querySelectorAll("#project-section img, #project-section script").length);

// Who does not know the key looks.
const looker = await open(url.split("#")[0]);
await looker.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length >= 3);
seen.look_role = await looker.textContent("#role");
seen.look_disabled = await looker.locator("#project-ways button:disabled").allTextContents();
await looker.locator("#project-nodes button").first().click();
await looker.waitForSelector("#project-objects tr");
seen.look_inputs = await looker.locator("#project-objects input").count();
await end();
