// A real browser on scan, LSS and single objects. Says as JSON what it saw. `node web_bus_ways.mjs CHROMIUM URL FOLDER`; judged by web_bus_ways_checks.py.
import { end, judge, open, picture, seen, url } from "./page_kit.mjs";

const page = await open();
await page.waitForSelector(".bus-ways summary");
await page.focus(".bus-ways summary");
await page.keyboard.press("Enter");
const [scan, lss] = [page.getByRole("group", { name: /^Scan of / }), page.getByRole("group", { name: /^LSS of / })];
const press = async (group, name) => {
  const button = group.getByRole("button", { name, exact: true });
  await button.click();
  await page.waitForFunction((one) => !one.disabled, await button.elementHandle(), { timeout: 100000 });
  return group.getByRole("status").textContent();
};
const rows = (name) => page.getByRole("region", { name }).locator("tbody tr").allTextContents();
await scan.getByLabel("nodes").fill("1-5");
seen.nobody = await press(scan, "Scan");
seen.found = await press(lss, "Find devices without a node-ID");
seen.devices = await rows(/^Devices found by LSS/);
await lss.getByLabel("from").fill("10");
seen.assigned = await press(lss, "Give them node-IDs");
seen.named = await rows(/^Devices found by LSS/);
await picture(page, "lss", "#buses");
seen.none_left = await press(lss, "Find devices without a node-ID");
await scan.getByLabel("nodes").fill("11-20");
seen.scanned = await press(scan, "Scan");
seen.nodes = await rows(/^Nodes found/);
await picture(page, "scan", "#buses");
await scan.getByLabel("nodes").fill("12-11");
seen.refused = await press(scan, "Scan");
await judge(page, "scan and LSS");
// Objects of a node.
await page.locator(".nodes button", { hasText: "10" }).first().click();
const sdo = page.getByRole("group", { name: /^SDO to / });
const set = async (object, type, value) => {
  await sdo.getByLabel("Object").fill(object);
  await sdo.getByLabel("Data type").selectOption(type);
  if (value !== undefined) await sdo.getByLabel("Value").fill(value);
};
await set("1018:02", "u32");
seen.read = await press(sdo, "Read object");
await set("1018:02", "");
seen.bytes = await press(sdo, "Read object");
await set("5000:02", "u8");
seen.abort = await press(sdo, "Read object");
await set("1017", "u16", "250");
seen.written = await press(sdo, "Write object");
seen.after = await press(sdo, "Read object");
await set("1017", "", "100");
seen.no_type = await press(sdo, "Write object");
await judge(page, "objects by SDO");
const looker = await open(url.split("#")[0]);
await looker.waitForSelector(".nodes li");
seen.look = await looker.locator(".bus-ways:visible, .sdo:visible").count();
await end();
