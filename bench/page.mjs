// What the page costs a headless Chromium: drawn frames a second, the renderer's heap, memory of all its processes.
// `node page.mjs CHROMIUM URL SECONDS`, or "first frame" for SECONDS: how long that takes after a click. Run by bench/page.
import { readFileSync, readdirSync } from "node:fs";
import { createRequire } from "node:module";

const require = createRequire(new URL("../tests/interop/", import.meta.url));
const { chromium } = require("playwright-core");
const [executablePath, url, seconds] = process.argv.slice(2);
const browser = await chromium.launch({ executablePath, args: ["--no-sandbox", "--enable-precise-memory-info"] });
const page = await browser.newPage({ viewport: { width: 1920, height: 1080 } });
const client = await page.context().newCDPSession(page);
await client.send("Performance.enable");

/// Resident memory of what this process has started, in bytes: all, and the largest renderer.
function resident() {
  const processes = new Map();
  for (const id of readdirSync("/proc").filter((name) => /^\d+$/.test(name))) {
    try {
      const status = readFileSync(`/proc/${id}/status`, "utf8");
      const field = (name) => Number(new RegExp(`^${name}:\\s+(\\d+)`, "m").exec(status)?.[1] ?? 0);
      processes.set(Number(id), { parent: field("PPid"), memory: 1024 * field("VmRSS"), anonymous: 1024 * field("RssAnon"), words: readFileSync(`/proc/${id}/cmdline`, "utf8") });
    } catch {
      // It has ended.
    }
  }
  const is_ours = (id) => id === process.pid || (processes.has(id) && is_ours(processes.get(id).parent));
  const ours = [...processes].filter(([id]) => id !== process.pid && is_ours(id)).map(([, one]) => one);
  const renderers = ours.filter((one) => one.words.includes("--type=renderer")).sort((a, b) => b.memory - a.memory);
  return { all: ours.reduce((sum, one) => sum + one.memory, 0), renderer: renderers[0]?.memory ?? 0, anonymous: renderers[0]?.anonymous ?? 0 };
}

/// Frames that the page says the bus has had.
const frames = () => page.evaluate(() => Number(/(\d+) frames/.exec(document.querySelector(".frame-count, .head .about")?.textContent ?? "")?.[1] ?? 0));

async function measure(view) {
  await page.waitForTimeout(2000);
  const frames_before = await frames();
  const begin = performance.now();
  const before = (await client.send("Performance.getMetrics")).metrics;
  const drawn = await page.evaluate((time) => new Promise((done) => {
    let frames = 0;
    let longest = 0;
    let last = performance.now();
    const begin = last;
    const count = (now) => {
      ++frames;
      longest = Math.max(longest, now - last);
      last = now;
      if (now - begin < time) requestAnimationFrame(count);
      else done({ rate: 1000 * frames / (now - begin), longest });
    };
    requestAnimationFrame(count);
  }), 1000 * Number(seconds));
  const after = (await client.send("Performance.getMetrics")).metrics;
  const grown = (name) => after.find((one) => one.name === name).value - before.find((one) => one.name === name).value;
  const frame_rate = 1000 * (await frames() - frames_before) / (performance.now() - begin);
  const memory = resident();
  console.log(JSON.stringify({ view, ...drawn, share: grown("TaskDuration") / Number(seconds), layouts: grown("LayoutCount") / Number(seconds),
                               heap: after.find((one) => one.name === "JSHeapUsedSize").value, ...memory, frame_rate,
                               elements: await page.evaluate(() => document.querySelectorAll("*").length) }));
}

/// From the click that begins a plant to the first frame that the page shows, each time with a plant of its own; the first one
/// finds nothing in the browser's memory.
async function first_frames() {
  const times = [];
  for (let i = 0; i < 3; ++i) {
    await page.goto(url);
    await page.waitForSelector("#start-try:not([disabled])");
    const begin = performance.now();
    await page.click("#start-try");
    await page.waitForFunction(() => /[1-9]\d* frames/.test(document.querySelector(".frame-count")?.textContent ?? ""));
    times.push(performance.now() - begin);
  }
  return times;
}

if (seconds === "first frame") {
  console.log(JSON.stringify(await first_frames()));
  await browser.close();
  process.exit();
}
await measure("an empty page");
const million = 1_000_000;
const go = (hash) => page.evaluate((address) => { location.hash = address; }, hash);
await page.goto(url);
await page.waitForSelector(".node");
await measure("overview");
await go("#/bus");
await page.waitForSelector(".ids a");
await measure("bus");
await go("#/objects/line1/2?find=6004");
await page.waitForSelector("#objects-grid .number");
for (const node of [2, 3, 4, 5, 6, 7]) {
  await go(`#/objects/line1/${node}?find=6004`);
  await page.waitForTimeout(800);
  await page.click("#objects-grid .number");
}
await measure("objects, six plots");
await go("#/trace");
await page.waitForSelector("#trace-grid .ag-row");
await measure("trace, six plots");
// Lines of a million frames; the oldest ones are forgotten then.
const records = () => page.evaluate(() => Number(/of (\d+) frames/.exec(document.querySelector(".head .about")?.textContent ?? "")?.[1] ?? 0));
for (let i = 0; i < 600 && await records() < million; ++i) await page.waitForTimeout(1000);
await measure(`trace of ${await records()} frames, six plots`);
await page.mouse.move(900, 400);
const scrolling = setInterval(() => page.mouse.wheel(0, 2000).catch(() => {}), 100);  // the last one may come when the page is closed
await measure("the same, scrolled");
clearInterval(scrolling);
await browser.close();
