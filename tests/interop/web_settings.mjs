// A real browser on the settings of a module: the windows of its configuration tool, each field with values in and out of its range, and what goes to the module. Says as JSON
// what it saw. `node web_settings.mjs CHROMIUM URL FOLDER FIELDS BACKUP`; FIELDS is a JSON file of { page, scope, name, refused, taken }. Judged by web_settings_checks.py.
import { readFileSync } from "node:fs";
import { counted, end, folder, judge, more, open, picture, seen, url } from "./page_kit.mjs";

const [fields_file, backup] = more;
const fields = JSON.parse(readFileSync(fields_file, "utf8"));
const page = await open(`${url.replace(/#.*/, "")}${url.match(/#.*/)[0]}`);
await page.waitForSelector("#settings-navigator button");
const said = () => page.textContent("#settings-said b");
const idle = () => page.waitForSelector("#settings-section[aria-busy=false]");
const go = async (key) => {
  await page.evaluate((to) => { location.hash = `#settings/0/${to}`; }, key);
  await page.waitForSelector(`#settings-navigator button[data-key=${key}][aria-current]`);
  await idle();
};
const button = (name) => page.locator("#settings-page").getByRole("button", { name, exact: true });
const press = async (name) => {
  await button(name).first().click();
  await page.waitForTimeout(20);
  await idle();
};

// What is printed on each window: labels, columns, captions, legends, buttons, headings, names for screen readers.
const names_here = () => page.evaluate(() => [...document.querySelectorAll("#settings-section label > span, #settings-section th, #settings-section caption, #settings-section legend, #settings-section button, #settings-section h3, #settings-section h4, #settings-section span, #settings-section select, #settings-section [aria-label], dialog[open]")]
  .filter((one) => one.offsetParent !== null || one.tagName === "DIALOG").flatMap((one) => [one.getAttribute("aria-label"), one.textContent.trim()]).filter((one) => one && one.length < 90));
seen.names = {};
const keep_names = async (key) => { seen.names[key] = [...new Set([...(seen.names[key] ?? []), ...await names_here()])]; };

// Rows: a new one by its number.
const new_row = async (number) => {
  const input = page.getByLabel(/^New row: /).first();
  await input.fill(String(number));
  await input.press("Enter");
  await idle();
};
const rows = { basic: 3, tpdo: 5, rpdo: 5, slave: 3, consumer: 3 };
seen.new_rows = {};
for (const key of ["basic", "tpdo", "rpdo", "master", "slave", "consumer"]) {
  await go(key);
  if (key === "master") await page.getByLabel("NMT master", { exact: true }).check();
  await idle();
  if (key in rows) {
    await new_row(key === "basic" ? 128 : key.endsWith("pdo") ? 257 : 128);
    seen.new_rows[key] = await said();
    await new_row(rows[key]);
    await page.waitForSelector(`#settings-page [data-place$="/${rows[key]}"]`);
    await new_row(rows[key]);
  }
  await keep_names(key);
  if (key !== "master") continue;
  // After what time it answers a negotiation, with a warning where the slots overlap.
  const words = page.locator("#settings-page [data-window=master] .words");
  seen.negotiation = await words.textContent();
  const slot = page.locator("#settings-page [data-window=master] [data-field='Priority time slot']");
  await slot.fill("1270");
  await slot.press("Enter");
  await idle();
  await page.waitForFunction(() => document.querySelector("#settings-page [data-window=master] .words").textContent.includes("1 x 1270 ms"));
  seen.overlap = await page.textContent("#settings-page [data-window=master] .bad");
  await picture(page, "master", "#settings-section");
  await slot.fill("1500");
  await slot.press("Enter");
  await idle();
}
for (const key of ["transfer", "setup", "scan", "sdo", "status", "export"]) {
  await go(key);
  await keep_names(key);
}

await page.click("#open-about");
seen.names.about = await page.locator("#about :is(h2, dt)").allTextContents();
await page.keyboard.press("Escape");

// Each field: what is out of its range is refused with the range and stays marked, what is in it is taken.
const input_of = (one) => {
  const at = page.locator("#settings-page");
  if (one.scope === "row") return at.getByLabel(`${one.name} of `, { exact: false }).first();
  const form = one.scope === "details" ? at.locator(".details .fields-of") : at.locator("[data-window] > .fields-of, [data-window=producer] .fields-of");
  return form.locator("label").filter({ has: page.locator(`span:first-child:text-is(${JSON.stringify(one.name)})`) }).locator("input, select").first();
};
seen.fields = [];
let at = "";
for (const one of fields) {
  if (at !== one.page) {
    at = one.page;
    await go(at);
    const details = page.locator("#settings-page tbody th button").first();
    if (await details.count() && !await page.locator("#settings-page .details:not([hidden])").count()) await details.click();
    await idle();
  }
  const input = input_of(one);
  const result = { page: one.page, scope: one.scope, name: one.name, refused: [], taken: [] };
  const before = await input.inputValue().catch(() => "");
  for (const value of one.refused) {
    await input.fill(value);
    await input.press("Tab");
    await page.waitForFunction((text) => [`= ${text}: `, `= "${text}": `].some((one) => document.querySelector("#settings-said b").textContent.includes(one)), value);
    result.refused.push({ value, said: await said(), invalid: await input.getAttribute("aria-invalid"), mood: await page.getAttribute("#settings-said", "data-mood"), kept: await input.inputValue() });
  }
  for (const value of one.taken) {
    const is_box = await input.getAttribute("type") === "checkbox";
    if (is_box) await input.setChecked(value === "Selected");
    else if (await input.evaluate((element) => element.tagName) === "SELECT") await input.selectOption(value);
    else {
      await input.fill(value);
      await input.press("Tab");
    }
    await page.waitForTimeout(20);
    await idle();
    result.taken.push({ value, invalid: await input.getAttribute("aria-invalid"), said: await said(), shown: is_box ? (await input.isChecked() ? "Selected" : "Not selected") : await input.inputValue() });
  }
  await input.focus();
  result.description = await page.textContent("#settings-description");
  result.before = before;
  seen.fields.push(result);
}

// The mapping: a name, then a description; index and sub-index; more than 64 bits.
await go("tpdo");
if (!await page.locator(".details:not([hidden])").count()) await page.locator("#settings-page tbody th button").first().click();
const mapped = (name, number) => page.getByLabel(`${name} of mapped object ${number}`, { exact: true });
await mapped("Object name", 1).selectOption({ label: "Buffer Memory Area Unsigned16" });
await page.waitForFunction(() => document.querySelectorAll(".details tbody tr").length === 2);
await idle();
seen.names_to_map = await mapped("Object name", 1).locator("option").allTextContents();
seen.first_mapped = await page.locator(".details tbody tr").first().evaluate((row) => [...row.querySelectorAll("input, td:nth-child(3)")].map((one) => one.value ?? one.textContent));
await mapped("Object description", 1).fill("Un\\G13007");
await mapped("Object description", 1).press("Tab");
await page.waitForFunction(() => document.querySelector("[aria-label='Sub-index of mapped object 1']").value === "0x08");
await mapped("Index", 2).fill("A1C0");
await mapped("Index", 2).press("Tab");
await mapped("Sub-index", 2).fill("2");
await mapped("Sub-index", 2).press("Tab");
await page.waitForFunction(() => document.querySelectorAll(".details tbody tr").length === 3);
await idle();
seen.second_mapped = [await mapped("Object name", 2).evaluate((one) => one.selectedOptions[0].textContent), await mapped("Object description", 2).inputValue()];
seen.bits = await page.locator(".details .frame-strip").getAttribute("aria-label");
await mapped("Object name", 3).selectOption({ label: "Buffer Memory Area Real32" });
await page.waitForSelector("#settings-said[data-mood=error]");
seen.too_many_bits = await said();
for (const [name, wrong] of [["Index", "10000"], ["Index", "G"], ["Object description", "Un\\G1"]]) {
  await mapped(name, 2).fill(wrong);
  await mapped(name, 2).press("Tab");
  await page.waitForFunction((what) => document.querySelector("#settings-said b").textContent.startsWith(what), `${name} = `);
  (seen.mapping_refused ??= []).push(await said());
  await go("rpdo");
  await go("tpdo");
}
await mapped("Index", 2).fill("A1C0");
await mapped("Index", 2).press("Tab");
await page.waitForFunction(() => document.querySelector("#settings-said").dataset.mood === "");
await idle();
await mapped("Sub-index", 2).fill("FF");
await mapped("Sub-index", 2).press("Tab");
await page.waitForFunction(() => document.querySelector("#settings-said b").textContent.includes("none of the objects"));
seen.not_mappable = await said();
await picture(page, "tpdo", "#settings-section");
await go("rpdo");
if (!await page.locator(".details:not([hidden])").count()) await page.locator("#settings-page tbody th button").first().click();
await page.waitForFunction(() => document.querySelectorAll(".details select option").length > 7);
seen.names_to_receive = await mapped("Object name", 1).locator("option").allTextContents();

// To the module: what differs first; refused in RUN; written in STOP; the same then.
await go("basic");
await page.locator("[data-window=basic] select[data-field='Baud-Rate']").selectOption("250");
await idle();
await picture(page, "basic", "#settings-section");
// What was changed last is taken back.
await go("basic");
const node_id = page.locator("[data-window=basic] input[data-field='Node ID']");
const node_id_before = await node_id.inputValue();
for (const value of ["101", "102"]) {
  await node_id.fill(value);
  await node_id.press("Tab");
  await page.waitForTimeout(20);
  await idle();
}
seen.undone = [];
for (let i = 0; i < 2; ++i) {
  await page.click("#settings-undo");
  await page.waitForTimeout(20);
  await idle();
  seen.undone.push([await said(), await node_id.inputValue(), await node_id.getAttribute("data-mood")]);
}
seen.undo_restored = await node_id.inputValue() === node_id_before;
seen.write = await counted(page, async () => {
  await button("Write module basic settings").click();
  await page.waitForSelector("#settings-page tr.differs");
});
await idle();
seen.plan = await page.locator("#settings-page tr.differs").allTextContents();
await press("OK");
await page.waitForSelector("#settings-said[data-mood=error]");
seen.in_run = await said();
await page.getByLabel("put the CPU module into STOP", { exact: false }).check();
await page.getByLabel("What", { exact: true }).selectOption("all");
await press("Compare");
seen.plan_of_all = await page.locator("#settings-page tr.differs").count();
await go("tpdo");
seen.marked = await page.locator("#settings-page [data-mood=differs]").evaluateAll((all) => all.map((one) => `${one.dataset.field}: ${one.title}`));
await go("transfer");
await button("OK").click();
await page.waitForFunction(() => /read back/.test(document.querySelector("#settings-said b").textContent) || document.querySelector("#settings-said").dataset.mood === "error", null, { timeout: 60000 });
seen.steps = await page.locator("#settings-page table").last().locator("tbody tr").allTextContents();
seen.written = await said();
await picture(page, "transfer", "#settings-section");
await press("Compare");
seen.compared = await page.textContent("#settings-page p[role=status]");

// SDO send / receive.
await go("sdo");
const sdo = async (values) => {
  for (const [name, value] of Object.entries(values)) {
    const input = page.locator(`#settings-page [data-field="${name}"]`);
    if (await input.evaluate((element) => element.tagName) === "SELECT") await input.selectOption(value);
    else await input.fill(value);
  }
  await press("Execute");
  return page.locator("#settings-page .result dl").evaluate((list) => [...list.children].map((row) => row.textContent).join("|"));
};
seen.sdo_read = await sdo({ "Node ID": "3", Index: "0x1018", "Sub-index": "0x02" });
seen.sdo_no_object = await sdo({ Index: "0x6FFF" });
seen.sdo_refused = [await sdo({ "Node ID": "128" }), await sdo({ "Node ID": "3", Index: "0x10000" }), await sdo({ Index: "0x1017", "Sub-index": "0x100" })];
seen.sdo_write = await sdo({ "Sub-index": "0x00", "Data direction": "Write data", "Data length": "BYTE_LENGTH_2", "Data": "1500" });
seen.sdo_after = await sdo({ "Data direction": "Read data" });
await picture(page, "sdo", "#settings-section");

// Network scan, module status, the reset of the NMT master, identities, hardware data.
await go("scan");
await page.getByLabel("Node ID area selection").selectOption("Range");
await page.getByLabel("First Node ID").fill("1");
await page.getByLabel("Last Node ID").fill("5");
await press("Scan");
seen.scanned = await page.locator("#settings-page tbody tr").allTextContents();
await go("status");
await press("Refresh");
seen.status = await page.locator("#settings-page tbody tr").allTextContents();
await press("Clear error");
await button("Reset").click();
await page.waitForSelector("dialog[open]");
await keep_names("reset");
await judge(page, "reset");
await page.getByRole("button", { name: "Yes", exact: true }).click();
await page.waitForFunction(() => /has started again/.test(document.querySelector("#settings-said b").textContent), null, { timeout: 30000 });
seen.reset = await said();
await go("setup");
await press("Comm. Test");
seen.setup = await page.locator("#settings-page tbody tr").allTextContents();
seen.test = await page.textContent("#settings-page p[role=status]");
await go("slave");
if (!await page.locator(".details:not([hidden])").count()) await page.locator("#settings-page tbody th button").first().click();
await press("Read from slave");
seen.identity = await page.locator(".details input").evaluateAll((all) => all.map((one) => one.value));
await go("basic");
await press("Read all CANopen nodes");
seen.hardware = await page.locator("#settings-page tbody tr").allTextContents();
await page.getByRole("button", { name: "Details of Node ID 3", exact: true }).click();
seen.node_file = await page.locator(".details .hardware tr").allTextContents();
await picture(page, "nodes", "#settings-section");
await go("slave");
await picture(page, "slaves", "#settings-section");

// All columns of each list are in sight, and the descriptions stand beside or below the rows.
const covered = () => page.evaluate(() => {
  const problems = [];
  const box = (one) => one.getBoundingClientRect();
  const descriptions = ["settings-description", "description"].map((id) => document.getElementById(id)).filter((one) => one.offsetParent !== null);
  const lists = [...document.querySelectorAll("#settings-page .scrolls")].filter((one) => one.offsetParent !== null);
  for (const list of lists) {
    const name = list.getAttribute("aria-label");
    if (list.scrollWidth > list.clientWidth) problems.push(`${name}: ${list.scrollWidth} in ${list.clientWidth} pixels`);
    for (const row of [list, ...list.querySelectorAll("tr")].map(box)) {
      for (const one of descriptions) {
        const over = box(one);
        if (row.left < over.right && over.left < row.right && row.top < over.bottom && over.top < row.bottom) problems.push(`${name}: below ${one.id}`);
      }
    }
  }
  return [lists.length, problems];
});
seen.lists = {};
for (const key of ["basic", "tpdo", "rpdo", "slave", "consumer"]) {
  await go(key);
  if (!await page.locator(".details:not([hidden])").count()) await page.locator("#settings-page tbody th button").first().click();
  await page.locator("#settings-page .details input").first().focus();
  // In a window of 1280 pixels the bars of page and list take 30.
  for (const [width, with_description] of [[1250, false], [1920, false], [1920, true]]) {
    await page.setViewportSize({ width, height: 900 });
    if (with_description) await page.click("#show-description");
    seen.lists[`${key} ${width}${with_description ? " with the description" : ""}`] = await covered();
    if (with_description) await page.click("#show-description");
  }
}
await page.setViewportSize({ width: 1280, height: 800 });
await go("basic");
seen.asked = [];
for (const name of ["Save Object Dictionary on all nodes", "Restore Object Dictionary to default on all nodes"]) {
  await button(name).click();
  await page.waitForSelector("dialog[open]");
  seen.asked.push(await page.textContent("dialog[open] p"));
  await judge(page, name);
  await page.getByRole("button", { name: "No", exact: true }).click();
}
await press("Read module basic settings");
await page.waitForFunction(() => document.querySelector("#settings-said b").textContent.startsWith("the file has"));
seen.read = await said();

// Backups; the description window; who only looks.
await go("export");
const download = page.waitForEvent("download");
await button("Export").click();
const exported = `${folder}/exported.xml`;
await (await download).saveAs(exported);
await page.setInputFiles("#settings-page input[type=file]", { name: "wrong.xml", mimeType: "text/xml", buffer: Buffer.from("<canopus") });
await page.waitForSelector("#settings-said[data-mood=error]");
seen.import_refused = await said();
await page.setInputFiles("#settings-page input[type=file]", backup);
await page.waitForFunction(() => document.querySelector("#settings-said").dataset.mood !== "error");
await idle();
await go("basic");
seen.imported = await page.locator("[data-window=basic] input[data-field='Node ID']").inputValue();
await page.click("#settings-hide");
seen.description_hidden = !await page.isVisible("#settings-description");
const looker = await open(`${url.replace(/#.*/, "")}#settings/0/basic`);
await looker.waitForSelector("#settings-page input");
seen.look_undo = await looker.isEnabled("#settings-undo");
seen.look_enabled = await looker.locator("#settings-page :is(input, select, button):enabled").evaluateAll((all) => all.map((one) => one.textContent.trim() || one.getAttribute("aria-label") || one.dataset.field));
await end();
