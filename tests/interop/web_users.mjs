// A real browser logs in to the page of a run, and pages of other servers try what they must not. Says as JSON what it saw.
// `node web_users.mjs CHROMIUM URL OTHER-SITE OTHER-PORT FOLDER PASSWORD`; the others are host:port. Judged by web_log_in_checks.py.
import { readFileSync } from "node:fs";
import { createRequire } from "node:module";
import { chromium } from "playwright-core";

const [executablePath, url, other_site, other_port, folder, password] = process.argv.slice(2);
const axe = readFileSync(createRequire(import.meta.url).resolve("axe-core/axe.min.js"), "utf8");
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox"] });
const seen = { problems: [], axe: [] };
const context = await browser.newContext({ viewport: { width: 1280, height: 800 } });
const page = await context.newPage();
let expects_refusal = false;
page.on("console", (message) => {
  if (["error", "warning"].includes(message.type()) && !expects_refusal) seen.problems.push(message.text());
});
page.on("pageerror", (error) => seen.problems.push(String(error)));

async function log_in(words) {
  await page.fill("#name", "anna");
  await page.fill("#password", words);
  await page.keyboard.press("Enter");
}

await page.goto(url);
seen.first = page.url();
for (const scheme of ["light", "dark"]) {
  await page.emulateMedia({ colorScheme: scheme });
  await page.screenshot({ path: `${folder}/log-in-${scheme}-1280.png` });
}
const bare = await browser.newContext({ bypassCSP: true });
const judged = await bare.newPage();
await judged.goto(`${url}login`);
await judged.addScriptTag({ content: axe });
const found = await judged.evaluate(() => globalThis.axe.run());
seen.axe = found.violations.filter((one) => ["serious", "critical"].includes(one.impact)).map((one) => one.id);
await bare.close();
expects_refusal = true;  // 401 is a line of the console
await log_in("wrong password");
await page.waitForFunction(() => (document.getElementById("said")?.textContent ?? "") !== "");
expects_refusal = false;
seen.said = await page.textContent("#said");
await log_in(password);
await page.waitForFunction(() => document.querySelector(".role")?.textContent.includes(","));
seen.role = await page.textContent(".role");
await page.waitForSelector(".bar .plant");
seen.plant = await page.textContent(".bar .plant");
seen.log_out = await page.isVisible("[aria-label='Log out']");
seen.cookies = await context.cookies();
seen.document_cookie = await page.evaluate(() => document.cookie);
await page.screenshot({ path: `${folder}/logged-in-light-1280.png` });

/// What a page of another server gets, in the browser that has the session.
async function tries(place) {
  const other = await context.newPage();
  await other.goto(`http://${place}/`);
  const result = {};
  result.fetch = await other.evaluate((address) => fetch(`${address}session`, { credentials: "include" }).then(
    (answer) => answer.text(), () => "refused"), url);
  result.socket = await other.evaluate((address) => new Promise((done) => {
    const socket = new WebSocket(`${address.replace("http", "ws")}events`);
    socket.onopen = () => done("open");
    socket.onerror = () => done("refused");
  }), url);
  result.frame = await other.evaluate((address) => new Promise((done) => {
    const frame = document.createElement("iframe");
    frame.src = address;
    frame.onload = () => {
      try {
        done(frame.contentDocument === null ? "refused" : "shown");  // the page of an error is of no origin
      } catch {
        done("refused");
      }
    };
    document.body.append(frame);
  }), url);
  const [answer] = await Promise.all([
    other.waitForResponse((one) => one.url().endsWith("/login") && one.request().method() === "POST"),
    other.evaluate((address) => {
      const form = document.createElement("form");
      form.method = "post";
      form.action = `${address}login`;
      form.innerHTML = '<input name="name" value="anna"><input name="password" value="x">';
      document.body.append(form);
      form.submit();
    }, url),
  ]);
  result.form = answer.status();
  await other.close();
  return result;
}
seen.other_site = await tries(other_site);
seen.other_port = await tries(other_port);
// A link of another site opens the page without the cookie.
const linked = await context.newPage();
await linked.goto(`http://${other_site}/`);
await Promise.all([linked.waitForNavigation(), linked.evaluate((address) => { location.href = address; }, url)]);
seen.from_other_site = linked.url();
await linked.close();

await page.click("[aria-label='Log out']");
await page.waitForURL("**/login");
seen.after_log_out = page.url();
seen.cookies_after = await context.cookies();
await browser.close();
console.log(JSON.stringify(seen));
