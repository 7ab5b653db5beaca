// A real browser on what the page says in words: domains, the time of a flying master, a module's errors. Says as JSON what it saw. `node web_in_words.mjs CHROMIUM URL FOLDER
// CONCISE`; CONCISE is a concise DCF in hexadecimal digits. Judged by web_in_words_checks.py.
import { readFileSync } from "node:fs";
import { end, judge, more, open, picture, seen, url } from "./page_kit.mjs";

const page = await open(url, { acceptDownloads: true });
await page.waitForSelector(".nodes li");
const go = (hash) => page.evaluate((to) => { location.hash = to; }, hash);
const words_in = async (part) => ({
  heading: await part.locator(".heading").textContent(),
  rows: await part.locator(".domain tbody tr").allTextContents(),
  dump: await part.locator("pre").textContent(),
});
const saved = async (button) => {
  const [file] = await Promise.all([page.waitForEvent("download"), button.click()]);
  return { name: file.suggestedFilename(), bytes: readFileSync(await file.path()).toString("hex") };
};

// One object by SDO.
const sdo = page.getByRole("group", { name: /^SDO to / });
const node = page.locator("#node");
const choose = async (id) => {
  await page.locator(".nodes button", { hasText: new RegExp(`^${id}  `) }).first().click();
  await page.waitForFunction((one) => document.querySelector("#node-title").textContent.includes(`node ${one}:`), id);
};
const press = async (name) => {
  const button = sdo.getByRole("button", { name, exact: true });
  await button.click();
  await page.waitForFunction((one) => !one.disabled, await button.elementHandle(), { timeout: 60000 });
  return sdo.getByRole("status").textContent();
};
const set = async (object, type, value) => {
  await sdo.getByLabel("Object").fill(object);
  await sdo.getByLabel("Data type").selectOption(type);
  if (value !== undefined) await sdo.getByLabel("Value").fill(value);
};
await choose(1);
await set("1F22:03", "domain", more[0]);
seen.written = await press("Write object");
seen.written_speed = await node.locator(".speed").textContent();
await set("1F22:03", "");
await press("Read object");
await node.getByText("Operating parameters").waitFor();
seen.read = await words_in(node);
await picture(page, "sdo-concise", "#node");
await set("1017", "u16");
await press("Read object");
seen.expedited = await node.locator(".speed").textContent();
await choose(5);
await set("2001", "domain", Buffer.from("hello domain of a no").toString("hex"));
await press("Write object");
await press("Read object");
seen.text = await words_in(node);
seen.saved = await saved(node.getByRole("button", { name: "Save to file" }));
await judge(page, "a domain by SDO");
await page.click("#close-node");

// In the objects of the module: the concise DCF has the names of the slave's own file.
await go("#objects/0");
await page.fill("#objects-find", "1f22");
const row = page.locator("#objects-table tbody tr", { hasText: "1F22:03" });
await row.waitFor();
seen.object = { value: await row.locator("td").nth(3).textContent() };
await row.getByRole("button", { name: /^Show / }).click();
const part = page.locator("#domain");
await part.locator("tbody tr").first().waitFor();
seen.object.rows = (await words_in(part)).rows;
seen.kept = await saved(part.getByRole("button", { name: "Save to file" }));
await picture(page, "domain", "#objects-section");
await part.getByRole("button", { name: "Close the value" }).click();
seen.closed = !await part.isVisible();

// The time of a flying master.
await page.fill("#objects-find", "1f90");
await page.waitForFunction(() => document.querySelector("#objects-table tbody tr")?.textContent.startsWith("1F90:00"));
await page.click("#show-description");
await page.locator("#objects-table tbody tr", { hasText: "1F90:04" }).locator(".number").focus();
await page.waitForFunction(() => document.querySelector("#description-rows").textContent.includes("negotiation:"));
seen.flying = await page.locator("#description-rows div").evaluateAll((all) => Object.fromEntries(all.map((one) => [one.children[0].textContent, one.children[1].textContent])));
await page.waitForFunction(() => document.querySelector("#description-source").textContent !== "");
await picture(page, "negotiation", null);
await page.click("#show-description");
await go("#overview");

// A module's errors at its front.
const front = page.locator(".front").first();
await front.getByRole("button", { name: /^Errors of / }).click();
await front.locator(".errors li").first().waitFor();
seen.errors = await front.locator(".errors").evaluate((all) => Object.fromEntries([...all.querySelectorAll("h4")].map((one) => [one.textContent, [...one.nextElementSibling.children].map((line) => line.textContent)])));
await picture(page, "module-errors", "#modules");

// They are cleared there, and the module is reset, which is asked once.
const said = front.locator(".module-ways [role=status]");
const ended = (word) => page.waitForFunction((one) => document.querySelector(".front .module-ways [role=status]").textContent.startsWith(one), word);
await front.getByRole("button", { name: "Clear errors" }).click();
await ended("errors cleared");
seen.cleared = { said: await said.textContent() };
await page.waitForFunction(() => !document.querySelector(".front .errors").textContent.includes("G29 bit 6"));
const reset = front.getByRole("button", { name: "Reset", exact: true });
seen.reset = { how: await reset.getAttribute("title") };
await reset.click();
const dialog = page.getByRole("dialog", { name: /^Reset / });
await judge(page, "a module's reset is asked");
await dialog.getByRole("button", { name: "No" }).click();
seen.reset.asked = await said.textContent();
await reset.click();
await dialog.getByRole("button", { name: "Yes" }).click();
await ended("restarted in");
seen.reset.said = await said.textContent();
await judge(page, "a module's errors");
await picture(page, "module-reset", "#modules");
await front.getByRole("button", { name: /^Hide errors of / }).click();
seen.errors_closed = !await front.locator(".errors").isVisible();
await end();
