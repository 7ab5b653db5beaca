// A real browser saves the DCF of a project's node and takes over another one. Says as JSON what it saw. `node web_dcf.mjs CHROMIUM URL FOLDER DCF OTHER`; judged by
// web_transfer_checks.py.
import { readFileSync } from "node:fs";
import { end, judge, more, open, picture, seen } from "./page_kit.mjs";

const [dcf, other] = more;
const page = await open();
await page.waitForFunction(() => document.querySelectorAll("#project-nodes tr").length === 1);
await page.locator("#project-nodes button", { hasText: "drive" }).click();
const said = () => page.textContent("#project-said b");
const choose = async (file) => {
  const [chooser] = await Promise.all([page.waitForEvent("filechooser"), page.getByRole("button", { name: "Compare with a DCF…" }).click()]);
  const before = await said();
  await chooser.setFiles(file);
  await page.waitForFunction((text) => ![text, ""].includes(document.querySelector("#project-said b").textContent) && !document.querySelector("#project-said b").textContent.endsWith("…"), before);
  return said();
};
const [download] = await Promise.all([page.waitForEvent("download"), page.getByRole("button", { name: "Save DCF" }).click()]);
seen.saved = [download.suggestedFilename(), readFileSync(await download.path(), "latin1")];
seen.refused = await choose(other);
seen.differs = await choose(dcf);
const part = page.getByRole("region", { name: "Values of a DCF" });
seen.rows = await part.locator("tbody tr").evaluateAll((all) => all.map((row) => [...row.children].map((one) => one.textContent)));
await judge(page, "values of a DCF");
await picture(page, "dcf", "#project-node");
await part.getByRole("button", { name: "Take over these values" }).click();
await part.waitFor({ state: "hidden" });
await page.waitForFunction(() => document.querySelector("#project-objects [data-object='1017:00']")?.value === "500");
seen.same = await choose(dcf);
await end();
