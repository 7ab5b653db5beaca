// What the tests in a browser share: runs of the program, pages that count clicks and characters, dropped files, the keyboard alone.
import assert from "node:assert/strict";
import { spawn, spawnSync } from "node:child_process";
import { cpSync, existsSync, mkdirSync, mkdtempSync, readFileSync, rmSync } from "node:fs";
import { createRequire } from "node:module";
import os from "node:os";
import path from "node:path";
import readline from "node:readline";
import { fileURLToPath } from "node:url";
import { policy } from "../../serve.mjs";

export const root = fileURLToPath(new URL("../../../../../", import.meta.url));
const require = createRequire(path.join(root, "tests/interop/package.json"));
const { chromium } = require("playwright-core");
const axe = readFileSync(require.resolve("axe-core/axe.min.js"), "utf8");

const word_after = (name) => (process.argv.includes(name) ? process.argv[process.argv.indexOf(name) + 1] : undefined);
export const options = { program: path.resolve(word_after("--program") ?? path.join(root, "build/canopus")), chromium: word_after("--chromium") ?? "chromium", folder: word_after("--folder"),
  pictures: word_after("--pictures"), compare: word_after("--compare"), only: new RegExp(word_after("--only") ?? ""), limit: Number(word_after("--limit") ?? 1e6) };
const most_of_a_test = 240;  // s, on a machine that does much else
const patience = 90_000;     // ms, for what is there at once on an idle machine

export const scratch = mkdtempSync(path.join(os.tmpdir(), "page-"));
const started = [];
/** Runs that a test is done with: they end when its pages are closed. */
const ended = [];
const browser = await chromium.launch({ executablePath: options.chromium === "chromium" ? "/usr/bin/chromium" : options.chromium, args: ["--no-sandbox", "--font-render-hinting=none",
  "--disable-features=LocalNetworkAccessChecks,LocalNetworkAccessChecksWebSockets,LocalNetworkAccessForWebSockets,PrivateNetworkAccessSendPreflights,BlockInsecurePrivateNetworkRequests"] });

/** A command to its end; its lines as JSON with --json. */
export function command(...words) {
  const done = spawnSync(options.program, words, { encoding: "utf8", cwd: scratch });
  assert.equal(done.status, 0, `canopus ${words.join(" ")}: ${done.stderr}`);
  return done.stdout;
}

/** A run with a page: its address with the key, and what it listens on (of several PLCs the first one). `until`: false while an event is waited for. */
export async function start_run(words, { cwd = scratch, until = () => true } = {}) {
  const child = spawn(options.program, [...words, "--json"], { cwd, stdio: ["ignore", "pipe", "pipe"], env: { ...process.env, HOME: scratch, XDG_STATE_HOME: path.join(scratch, "state") } });
  started.push(child);
  const run = { child, url: "", listens: {}, stop: () => { ended.push(child); } };
  let errors = "";
  child.stderr.on("data", (text) => { errors = (errors + text).slice(-2000); });
  const lines = readline.createInterface({ input: child.stdout });
  await new Promise((done, failed) => {
    const patience = setTimeout(() => failed(new Error(`canopus ${words.join(" ")} has no page after 60 s: ${errors}`)), 60_000);
    child.on("exit", (code) => failed(new Error(`canopus ${words.join(" ")} ended with ${code}: ${errors}`)));
    let is_ready = false;
    lines.on("line", (line) => {
      if (is_ready) return;
      const event = JSON.parse(line);
      if (event.event === "listen") run.listens[event.protocol] ??= event.address;
      is_ready = Boolean(run.listens["web"]) && until(event, run);
      if (!is_ready) return;
      clearTimeout(patience);
      done();
    });
  });
  run.url = run.listens["web"];
  return run;
}

export const example = (name) => path.join(root, "examples", name);
/** Its messages name files as a reader of the documentation has them. */
export const run_example = (name, ...words) => start_run(["run", name, "--web", "--free-ports", ...words], { cwd: example("") });

/** Runs that several tests share. */
const shared = new Map();
export function shared_run(name, make) {
  if (!shared.has(name)) shared.set(name, make());
  return shared.get(name);
}
export const first_plant = () => shared_run("first plant", () => run_example("first-plant/plant.toml"));
export const stuck_slaves = () => shared_run("stuck slaves", () => run_example("stuck-slave/plant.toml"));

/** A folder with plants, a project and settings of a module, as people have one. */
export function folder_of_work() {
  const folder = path.join(scratch, "machines");
  if (existsSync(folder)) return folder;
  mkdirSync(folder, { recursive: true });
  for (const name of ["first-plant", "stuck-slave", "five-modules", "two-racks", "rj71cn91", "devices"]) cpSync(example(name), path.join(folder, name), { recursive: true });
  make_project(path.join(folder, "press"));
  command("configure", "new", path.join(folder, "press-module.xml"), "--module", "RJ71CN91");
  return folder;
}

/** A project with three devices. */
export function make_project(folder, devices = ["io-block", "encoder", "drive"]) {
  command("project", "new", folder, "--name", "Press line");
  for (const name of devices) command("project", "add", folder, example(`devices/${name}.eds`), "--bit-rate", "250k");
  return folder;
}

const types = { ".html": "text/html; charset=utf-8", ".js": "text/javascript; charset=utf-8", ".css": "text/css; charset=utf-8", ".svg": "image/svg+xml" };

/** Files of the page come from the folder, whichever run the page is of; everything else from the program. */
async function route_files(context) {
  if (!options.folder) return;
  await context.route((url) => url.hostname === "127.0.0.1" && (url.pathname === "/" || /^\/[\w.-]+\.(js|css|svg)$/.test(url.pathname)), (route) => {
    const name = new URL(route.request().url()).pathname.slice(1) || "index.html";
    void route.fulfill({ body: readFileSync(path.join(options.folder, name)), headers: { "Content-Type": types[path.extname(name)], "Content-Security-Policy": policy, "Cache-Control": "no-store" } });
  });
}

/** A page in a session of its own, 1280 x 800 and light unless `more` says otherwise; `joined` gets the session before it has a page. `page.counts`: clicks and characters of a person; `page.problems`: what the browser complained of. */
export async function open(run, hash = "", { joined, ...more } = {}) {
  const context = await browser.newContext({ viewport: { width: 1280, height: 800 }, colorScheme: "light", reducedMotion: "reduce", acceptDownloads: true, ...more });
  context.setDefaultTimeout(patience);
  context.setDefaultNavigationTimeout(patience);
  await route_files(context);
  await joined?.(context);
  const page = await context.newPage();
  // iX draws a button's `disabled` a frame late. Until then it swallows a click, which Playwright does not notice.
  const click = page.click.bind(page);
  page.click = async (selector, more) => {
    await page.locator(selector).first().evaluate(async (one) => {
      while (one.matches("ix-button") && !one.disabled && one.shadowRoot?.querySelector("button")?.disabled) await new Promise(requestAnimationFrame);
    }).catch(() => undefined);
    await click(selector, more);
  };
  const counts = { clicks: 0, typed: 0 };
  Object.assign(page, { problems: [], counts });
  page.on("console", (message) => ["error", "warning"].includes(message.type()) && page.problems.push(message.text()));
  page.on("pageerror", (error) => page.problems.push(String(error)));
  page.on("request", (request) => /^(http:\/\/127\.0\.0\.1|data:|blob:)/.test(request.url()) || page.problems.push(`request of ${request.url()}`));
  await page.exposeFunction("tell", (kind) => { ++counts[kind]; });
  await page.addInitScript(() => {
    // A button that Enter presses gets a click, too, but none of a mouse.
    for (const kind of ["click", "contextmenu"]) addEventListener(kind, (event) => { if (event.isTrusted && (event.detail > 0 || event.type === "contextmenu")) tell("clicks"); }, true);
    addEventListener("keydown", (event) => { if (event.isTrusted && event.key.length === 1) tell("typed"); }, true);
  });
  const answer = await page.goto(run.url);
  if (answer?.status() === 503) throw new NoPage(`the program has no page: ${await answer.text()}`);
  await page.waitForFunction(() => !/CONNECTING|NOT CONNECTED/.test(document.querySelector(".where")?.textContent ?? "") && document.querySelector(".screen h1") !== null);
  if (hash) await go(page, hash);
  return page;
}

export const go = (page, hash) => page.evaluate((address) => { location.hash = address; }, hash);

/** What was clicked and typed for something. */
export async function counted(page, action) {
  const before = { ...page.counts };
  await action();
  await page.evaluate(() => 0);  // what was said before has come
  return { clicks: page.counts.clicks - before.clicks, typed: page.counts.typed - before.typed };
}

/** A command as the page sends it, without the page: {"command": "pace", ...}. */
export function say(page, wish) {
  return page.evaluate((words) => new Promise((done, failed) => {
    const key = sessionStorage.getItem("canopus key");
    const socket = new WebSocket(`${location.origin.replace("http", "ws")}/events${key ? `?key=${key}` : ""}`);
    socket.onopen = () => socket.send(JSON.stringify({ do: words, id: 1 }));
    socket.onerror = () => failed(new Error("no WebSocket"));
    const rows = [];
    socket.onmessage = (message) => {
      for (const event of JSON.parse(message.data)) {
        if (event.event !== "reply" || event.id !== 1) continue;
        rows.push(...(event.rows ?? []));
        if (event.more) continue;
        socket.close();
        done({ ...event, rows });
      }
    };
  }), wish);
}

/** Plant time stands still at this second. Most of the way it runs four times as fast; the rest exactly. */
export async function stand_at(page, seconds) {
  const left = async () => seconds - (await say(page, { command: "pace", speed: 0 })).t;
  let remaining = await left();
  for (; remaining > 12; remaining = await left()) {  // a machine that stands still for two seconds does not miss it
    await say(page, { command: "pace", speed: 4 });
    await page.waitForTimeout(50 * remaining);
  }
  assert.ok(remaining > 0, `${seconds} s of plant time is past`);
  await say(page, { command: "pace", run: `${remaining.toFixed(6)}s` });
  await page.waitForFunction((time) => document.querySelector(".where")?.textContent === "SIMULATED PAUSED" && document.getElementById("plant-time")?.textContent === `${time.toFixed(1)} s`, seconds, { timeout: 120_000 });
}

/** Tab until the element with the focus matches. */
export async function tab_to(page, selector, most = 80) {
  for (let i = 0; i < most; ++i) {
    await page.keyboard.press("Tab");
    if (await page.evaluate((one) => document.activeElement !== document.body && (document.activeElement?.closest(one) ?? null) !== null, selector)) return;
  }
  assert.fail(`the keyboard does not lead to ${selector}`);
}

/** Drops a file, as from the desktop. */
export async function drop(page, selector, file) {
  const data = await page.evaluateHandle(([name, text]) => {
    const transfer = new DataTransfer();
    transfer.items.add(new File([text], name));
    return transfer;
  }, [path.basename(file), readFileSync(file, "latin1")]);
  await page.dispatchEvent(selector, "drop", { dataTransfer: data });
}

/** What the browser complained of, and whether anything stands out of the window. */
export async function layout_problems(page) {
  const problems = page.problems.splice(0);
  if (await page.evaluate(() => document.documentElement.scrollWidth > innerWidth || document.documentElement.scrollHeight > innerHeight)) problems.push("wider or higher than the window");
  return problems;
}

/** What axe-core finds serious or critical. */
export async function axe_problems(page) {
  const devtools = await page.context().newCDPSession(page);
  await devtools.send("Page.setBypassCSP", { enabled: true });
  await page.evaluate(axe);
  const found = await page.evaluate(() => globalThis.axe.run(document, { resultTypes: ["violations"] }));
  await devtools.send("Page.setBypassCSP", { enabled: false });
  return found.violations.filter((violation) => ["serious", "critical"].includes(violation.impact)).map((one) => `${one.id}: ${one.nodes.slice(0, 2).map((node) => node.html.slice(0, 120)).join(" | ")}`);
}

class Skip extends Error {}
/** Nothing can be tested. */
class NoPage extends Error {}

/** The rest of a test is for a program that has this. */
export async function needs(page, feature) {
  const hello = await say(page, { command: "hello" });
  if (!hello.offers.includes(feature)) throw new Skip(`this program has no ${feature}`);
}

const results = { failed: 0, done: 0, skipped: 0 };
const begin = performance.now();
const seconds_since = (time) => (performance.now() - time) / 1000;

/** What the test gives back, or an error that names what it waited for too long. */
async function in_time(test) {
  const running = test();
  running.catch(() => undefined);  // that it fails later, when its pages are closed, is no news
  const left = Math.min(most_of_a_test, options.limit - seconds_since(begin));
  let timer;
  const late = new Promise((_, failed) => { timer = setTimeout(() => failed(new Error(`not done after ${left.toFixed(0)} s`)), 1000 * left); });
  try {
    return await Promise.race([running, late]);
  } finally {
    clearTimeout(timer);
  }
}

async function keep_pictures_of(name) {
  for (const context of browser.contexts()) for (const page of context.pages()) await page.screenshot({ path: path.join(options.pictures, `failed-${name.replace(/\W+/g, "-").slice(0, 60)}.png`), timeout: 5000 }).catch(() => undefined);
}

/** Runs a test; it gives back the pages that it used, and what the browser complained of fails it. */
async function run_test(name, test) {
  const start = performance.now();
  try {
    for (const page of [await in_time(test)].flat().filter(Boolean)) assert.deepEqual(page.problems, []);
    ++results.done;
    console.log(`ok ${name} (${seconds_since(start).toFixed(1)} s)`);
  } catch (error) {
    if (error instanceof Skip) {
      ++results.skipped;
      console.log(`skipped ${name}: ${error.message}`);
    } else {
      ++results.failed;
      console.log(`not ok ${name} (${seconds_since(start).toFixed(1)} s): ${String(error.message ?? error).slice(0, 600)}`);
      if (error instanceof NoPage) throw error;
      if (options.pictures) await keep_pictures_of(name);
    }
  } finally {
    for (const context of browser.contexts()) await context.close();
    for (const child of ended.splice(0)) child.kill();
  }
}

/** Runs those whose name matches --only, as long as --limit allows. */
export async function run_tests(tests) {
  const wanted = Object.entries(tests).filter(([name]) => options.only.test(name));
  while (wanted.length && seconds_since(begin) < options.limit) {
    try {
      await run_test(...wanted.shift());
    } catch (error) {
      if (!(error instanceof NoPage)) throw error;
      break;
    }
  }
  if (!wanted.length) return;
  ++results.failed;
  console.log(`not run${seconds_since(begin) < options.limit ? "" : `, because ${options.limit} s are over`}: ${wanted.map(([name]) => name).join("; ")}`);
}

export async function end() {
  await browser.close();
  for (const child of started) {
    if (child.exitCode === null) await new Promise((done) => { child.on("exit", done); child.kill(); setTimeout(() => { child.kill("SIGKILL"); done(); }, 5000).unref(); });
  }
  rmSync(scratch, { recursive: true, force: true });
  console.log(results.failed ? `${results.failed} of ${results.failed + results.done} failed` : `all ${results.done} good${results.skipped ? `, ${results.skipped} skipped` : ""}`);
  process.exit(results.failed ? 1 : 0);
}
