// A real browser looks for a device at all bit rates. Says as JSON what it saw. `node web_rates.mjs CHROMIUM URL FOLDER`; judged by web_bus_ways_checks.py.
import { end, judge, open, picture, seen } from "./page_kit.mjs";

const page = await open();
await page.waitForSelector(".bus-ways summary");
await page.focus(".bus-ways summary");
await page.keyboard.press("Enter");
const search = page.getByRole("group", { name: /^Search over the bit rates/ });
const press = async () => {
  const button = search.getByRole("button", { name: "Search all bit rates", exact: true });
  await button.click();
  await page.waitForFunction((one) => !one.disabled, await button.elementHandle(), { timeout: 100000 });
  return search.getByRole("status").textContent();
};
await search.getByLabel("vendor").fill("0x71");
seen.half = await press();
await search.getByLabel("vendor").fill("");
await search.getByLabel("node-ID for it").fill("9");
seen.found = await press();
seen.rows = await page.getByRole("region", { name: /^Devices found by LSS/ }).locator("tbody tr").allTextContents();
await page.waitForSelector(".nodes button:has-text('9')");
await picture(page, "rates", "#buses");
await judge(page, "search over bit rates");
await end();
