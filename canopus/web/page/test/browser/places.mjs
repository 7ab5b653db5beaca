// Every screen with something on it: which run, which address, what is done there before one looks. Plant time stands still where it can.
import path from "node:path";
import { command, drop, example, folder_of_work, make_project, needs, open, run_example, say, scratch, shared_run, stand_at, start_run } from "./kit.mjs";

const stands = 14;  // s of plant time: all nodes that boot have booted

/** A run whose plant time stands at the same second for every picture. Ages of words are known from the first look at a module on. */
async function standing(name) {
  for (let attempt = 1; ; ++attempt) {
    const run = await run_example(name);
    const page = await open(run, "#/module/0");
    try {
      await stand_at(page, stands);
      return run;
    } catch (error) {
      if (attempt === 3) throw error;  // on a busy machine the page may open too late
      run.stop();
    } finally {
      await page.context().close();
    }
  }
}
const first = () => shared_run("standing first plant", () => standing("first-plant/plant.toml"));
const stuck = () => shared_run("standing stuck slaves", () => standing("stuck-slave/plant.toml"));
const program = () => shared_run("standing program", () => standing("structured-text/plant.toml"));
const running = () => shared_run("running first plant", () => run_example("first-plant/plant.toml"));
const project = () => shared_run("project of pictures", () => start_run(["web", path.basename(make_project(path.join(scratch, "press-line")))]));
const module_settings = () => shared_run("settings of pictures", async () => {
  const file = path.join(scratch, "cell-module.xml");
  command("configure", "new", file, "--module", "RJ71CN91");
  command("configure", "set", file, "tpdo/1", "COB-ID=0x181");
  return start_run(["run", example("rj71cn91/plant.toml"), "--web", "--free-ports", "--web-settings", file]);
});
const start = () => shared_run("start of pictures", () => start_run(["web"], { cwd: folder_of_work() }));

const bus_of = async (page) => (await say(page, { command: "hello" })).buses[0].bus;

const choose_row = async (page, grid, text) => {
  await page.waitForSelector(`${grid} .ag-row`);
  await page.click(`${grid} .ag-row:has-text('${text}') .ag-cell >> nth=0`);
  await page.waitForSelector(".drawer .facts");
};

/** `prepare`: what is done there; `needs`: what the program has to offer; `collects`: s of plant time until a picture has enough in it; `moves`: it is not the same twice, and is not compared. */
export const places = [
  { name: "start", run: start, hash: "#/start", prepare: (page) => page.waitForSelector(".plant-card, .entry") },
  { name: "new-plant", run: start, hash: "#/start", prepare: async (page) => {
    await page.waitForSelector("#new-project");
    await page.click((await page.locator("#new-plant").count()) ? "#new-plant" : "#new-project");
    await page.fill("#wizard-name", "press 3");
    await page.click("#wizard-next");
    await page.click("#wizard-next");
    await drop(page, ".drop-zone", example("devices/encoder.eds"));
    await drop(page, ".drop-zone", example("devices/drive.eds"));
    await page.waitForSelector("#wizard tbody tr:nth-child(2)");
  } },
  { name: "overview", run: stuck, hash: "#/overview", prepare: (page) => page.waitForSelector(".trouble") },
  { name: "overview-node", run: stuck, hash: "#/overview?node=line1%2F3%2Fencoder", prepare: (page) => page.waitForSelector(".drawer .lead") },
  { name: "scan", run: project, hash: "#/scan", moves: true, prepare: async (page) => {
    await page.click("ix-button:text-is('Scan')");
    await page.waitForFunction(() => document.querySelector(".said")?.textContent.includes("on the bus"), null, { timeout: 60_000 });
  } },
  { name: "bus", run: running, hash: "#/bus/line1?id=183", moves: true, collects: 16, prepare: (page) => page.waitForSelector(".bit-field") },
  { name: "boot", run: stuck, hash: "#/boot?node=line1%2F3", prepare: (page) => page.waitForSelector(".steps") },
  { name: "module", run: first, hash: "#/module/0", prepare: (page) => page.waitForSelector("#words-grid .ag-row") },
  { name: "module-word", run: first, hash: "#/module/0?find=G10000", prepare: (page) => choose_row(page, "#words-grid", "G10000") },
  { name: "module-errors", run: stuck, hash: "#/module/0/errors", prepare: (page) => page.waitForSelector("table.rows, ix-empty-state") },
  { name: "program", run: program, hash: "#/program/plc1?line=138", needs: "halt program", prepare: (page) => page.waitForSelector(".source li:has-text('output') .value-chip") },
  { name: "settings", run: module_settings, hash: "#/settings/0/master", moves: true, prepare: (page) => page.waitForSelector(".settings-form") },
  { name: "settings-pdo", run: module_settings, hash: "#/settings/0/tpdo", moves: true, prepare: async (page) => { await page.click(".mapping button"); await page.waitForSelector(".picks li button"); } },
  { name: "objects", run: first, hash: "#/objects/line1/4", prepare: (page) => page.waitForSelector("#objects-grid .ag-row") },
  { name: "objects-word", run: first, hash: "#/objects/line1/4?find=604", prepare: (page) => choose_row(page, "#objects-grid", "Statusword") },
  { name: "pdos", run: first, hash: "#/pdos", prepare: async (page) => { await page.waitForFunction(() => document.querySelector(".head .about")?.textContent.startsWith("as the nodes have them"), null, { timeout: 60_000 }); await choose_row(page, "#pdo-grid", "Position value"); } },
  { name: "pdo-editor", run: project, hash: "#/pdos", moves: true, prepare: async (page) => { await choose_row(page, "#pdo-grid", "TPDO1"); await page.click("ix-button:has-text('Change')"); await page.waitForSelector(".editor .picks li button"); } },
  { name: "link-signals", run: project, hash: "#/pdos", moves: true, prepare: async (page) => { await page.click(".parts a:has-text('Link signals')"); await page.waitForSelector("#link-to button"); } },
  { name: "trace", run: stuck, hash: "#/trace?filter=service%3Dsdo", prepare: async (page) => { await page.waitForSelector("#trace-grid .ag-row .ag-cell[col-id=text]"); await page.waitForTimeout(600); await page.click("#trace-grid .ag-row .ag-cell[col-id=text] >> nth=1"); await page.waitForSelector(".drawer table.rows"); } },
  { name: "trace-statistics", run: first, hash: "#/trace", prepare: async (page) => { await page.click("button:text-is('Statistics')"); await page.waitForSelector(".scrolls h2"); } },
  { name: "plots", run: running, hash: "#/plots?objects%203%20606C%3A00=drive%20606C%20Velocity%20actual%20value&words%200%2010008=Master%20G10008&bus%20line1%20now=load%20of%20line1%2C%20%25", moves: true, collects: 24, prepare: (page) => page.waitForSelector(".plot canvas") },
  { name: "faults", run: running, hash: "#/faults", moves: true, collects: 4, prepare: async (page) => {
    await page.waitForSelector("button[aria-label='Add a fault']");
    await say(page, { command: "run faults", bus: "line1", seed: 1, faults: [{ text: 'kind = "drop"\nidentifier = 0x183\nevery = 10', on: true }, { text: 'kind = "delay"\nidentifier = 0x182\ndelay = "5ms"', on: true }] });
    await page.waitForSelector(".fault[data-mood=acting]");
    await page.click(".fault-name >> nth=0");
  } },
  { name: "project", run: project, hash: "#/project/bus/3", moves: true, prepare: async (page) => { await page.waitForSelector(".project-node"); await page.click(".project-node:has-text('drive')"); await page.waitForSelector("#project-grid .ag-row"); } },
  { name: "transfer", run: project, hash: "#/project", moves: true, prepare: async (page) => {
    await page.waitForSelector(".project-node");
    for (const [node, items] of [["1", ["1017:00=500"]], ["2", ["1017:00=500", "1800:05=20"]], ["3", ["1017:00=500"]]]) await say(page, { command: "project set", bus: await bus_of(page), node, items });
    await page.click("ix-menu-item[data-screen=transfer]");
    await page.waitForSelector("#screen-transfer tbody tr:nth-child(3)", { timeout: 60_000 });
  } },
  { name: "events", run: stuck, hash: "#/events?find=line1", prepare: (page) => page.waitForSelector("#events-grid .ag-row") },
];

/** Plant time passes four times as fast; the page draws as often. */
async function pass(page, seconds) {
  await say(page, { command: "pace", speed: 4 });
  await page.waitForTimeout(250 * seconds);
  await say(page, { command: "pace", speed: 1 });
}

/** A page at a place, with everything on it that a picture shows if it `is_seen`. */
export async function open_place(place, { is_seen }) {
  const page = await open(await place.run(), place.hash);
  if (place.needs) await needs(page, place.needs);
  await place.prepare(page);
  if (is_seen && place.collects) await pass(page, place.collects);
  await page.mouse.move(740, 62);  // no tip of what was clicked last
  if (is_seen) await page.waitForTimeout(800);
  return page;
}
