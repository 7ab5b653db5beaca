// What could not be done on the page of before, point by point.
import assert from "node:assert/strict";
import { copyFileSync, mkdirSync, readFileSync, writeFileSync } from "node:fs";
import path from "node:path";
import { command, drop, example, first_plant, folder_of_work, go, make_project, needs, open, say, scratch, shared_run, start_run, stuck_slaves } from "./kit.mjs";

const cell = (page, grid, row, column) => page.locator(`${grid} .ag-row[row-index="${row}"] .ag-cell[col-id=${column}]`);
const text_of = (page, grid, row, column) => cell(page, grid, row, column).textContent();
const is_said = (page, words) => page.waitForFunction((text) => document.querySelector(".said")?.textContent.includes(text), words, { timeout: 60_000 });

/** A first plant of its own folder, for what writes files or changes the run for good. */
function own_plant(name, change = (text) => text) {
  const folder = path.join(scratch, name);
  mkdirSync(path.join(folder, "devices"), { recursive: true });
  for (const file of ["io-block", "encoder", "drive"]) copyFileSync(example(`devices/${file}.eds`), path.join(folder, "devices", `${file}.eds`));
  const text = readFileSync(example("first-plant/plant.toml"), "utf8").replaceAll("../devices", "devices");
  writeFileSync(path.join(folder, "plant.toml"), change(text));
  return path.join(folder, "plant.toml");
}

export const points = {
  async "1 trace: the abort code stands in the row, and a filter is completed with keys, names of nodes, abort codes and objects"() {
    const page = await open(await stuck_slaves(), "#/trace?filter=service%3Dsdo%20errors");
    await page.waitForFunction(() => /^[0-9A-F]{8}H /.test(document.querySelector("#trace-grid .ag-row .ag-cell[col-id=text]")?.textContent ?? ""));
    const shown = await cell(page, "#trace-grid", 0, "text").evaluate((one) => one.scrollWidth <= one.clientWidth || one.clientWidth > 400);
    assert.ok(shown, "the meaning has the width");
    await go(page, "#/trace");
    const typed = async (...words) => {
      await page.click("filter-input");
      await page.keyboard.press("Control+a");
      await page.keyboard.press("Delete");
      for (const word of words) {
        await page.keyboard.type(word);
        await page.waitForSelector("filter-input .cm-tooltip-autocomplete li[aria-selected]");
        await page.waitForTimeout(150);
        await page.keyboard.press("Tab");
      }
      await page.waitForTimeout(200);
      return decodeURIComponent(await page.evaluate(() => location.hash));
    };
    assert.equal(await typed("no", "enc"), "#/trace?filter=node=3");
    assert.equal(await typed("ab", "05040"), "#/trace?filter=abort=05040000");
    await typed("ob");
    return page;
  },
  async "1 trace: delta times, columns, freeze, marks, and a transfer with its request and answer"() {
    const page = await open(await first_plant(), "#/trace");
    await page.waitForSelector("#trace-grid .ag-row");
    await page.click("label:has-text('Delta time')");
    await page.waitForSelector("#trace-grid .ag-header-cell:has-text('Delta, ms')");
    await page.click("[data-columns]");
    await page.click("#menu button:text-is('Hide Data')");
    await page.waitForSelector("#trace-grid .ag-header-cell:has-text('Data')", { state: "detached" });
    await page.click("#trace-freeze");
    await page.waitForTimeout(600);
    const first = await text_of(page, "#trace-grid", 0, "time");
    await page.waitForTimeout(900);
    assert.equal(await text_of(page, "#trace-grid", 0, "time"), first, "a frozen trace stays");
    for (const row of [4, 1]) {
      await cell(page, "#trace-grid", row, "text").click();
      await page.keyboard.press("m");
    }
    await page.waitForFunction(() => document.querySelectorAll(".mark").length === 2 && /\d (ms|µs|s)/.test(document.querySelector(".marks .faint")?.textContent ?? ""));
    assert.equal(await page.locator("#trace-grid .row-mark").count(), 2);
    // Request and answer.
    await go(page, "#/trace?filter=service%3Dsdo");
    await page.waitForTimeout(800);
    await cell(page, "#trace-grid", 0, "text").click();
    await page.waitForFunction(() => document.querySelectorAll(".drawer table.rows tr").length >= 4);
    await page.click("label:has-text('Group SDO transfers')");
    await page.waitForTimeout(800);
    const details = await page.locator(".drawer").boundingBox();
    const list = await page.locator("#trace-grid").boundingBox();
    assert.ok(details.x >= list.x + list.width - 1, "details stand beside the list and cover nothing");
    return page;
  },
  async "1 trace: a trace file of the folder is opened, filtered, and left again"() {
    const plant = own_plant("trace-file");
    const run = await start_run(["run", plant, "--web", "--free-ports"]);
    const page = await open(run, "#/trace");
    await needs(page, "open trace");
    writeFileSync(path.join(path.dirname(plant), "recorded.log"), "(1.000000) can0 701#00\n(1.100000) can0 181#0102\n(1.200000) can0 601#4018100100000000\n(1.201000) can0 581#8018100111000906\n");
    await page.click("#trace-open");
    await page.click("#menu button:has-text('recorded.log')");
    await is_said(page, "recorded.log: 4 frames");
    await page.waitForFunction(() => document.querySelector(".head .about")?.textContent.includes("of 4 frames"));
    await go(page, "#/trace?filter=errors");
    await page.waitForFunction(() => /^06090011H /.test(document.querySelector("#trace-grid .ag-row .ag-cell[col-id=text]")?.textContent ?? ""));
    await page.click("button:text-is('Back to this run')");
    await page.waitForFunction(() => !document.querySelector(".head .about b"));
    run.stop();
    return page;
  },
  async "1 trace: a trace file of the browser's machine is opened by its button and by dropping it, and a wrong one says its line"() {
    const page = await open(await first_plant(), "#/trace");
    await needs(page, "upload trace");
    await page.waitForSelector("#trace-grid .ag-row");
    const log = path.join(scratch, "brought.log");
    writeFileSync(log, "(1.000000) can0 701#00\n(1.200000) can0 601#4018100100000000\n(1.201000) can0 581#8018100111000906\n");
    const chooser = page.waitForEvent("filechooser");
    await page.click("#trace-open");
    await page.click("#menu button:has-text('From this computer')");
    await (await chooser).setFiles(log);
    await is_said(page, "brought.log: 3 frames");
    await page.waitForFunction(() => document.querySelector(".head .replay")?.textContent === "REPLAY brought.log" && document.querySelector(".head .about")?.textContent.includes("of 3 frames"));
    await page.waitForFunction(() => /06090011H /.test(document.querySelector("#trace-grid")?.textContent ?? ""));
    await page.click("button:text-is('Back to this run')");
    await page.waitForFunction(() => !document.querySelector(".head .replay"));
    const half = path.join(scratch, "half.asc");
    writeFileSync(half, "date Mon Jan 5 10:00:00 2026\nbase hex  timestamps absolute\n0.100000 1  701  Rx   d 1 05\n0.200000 1  7GG  Rx   d 1 00\n");
    await drop(page, "#trace-grid", half);
    await is_said(page, "half.asc:4:");
    await page.waitForFunction(() => document.querySelector(".head .about")?.textContent.includes("of 1 frame"));
    const other = path.join(scratch, "project.zip");
    writeFileSync(other, "PK\u0003\u0004 and so on");
    await drop(page, "#trace-grid", other);
    await is_said(page, "project.zip: expected a trace, found a ZIP archive");
    return page;
  },
  async "1 trace: frames are sent on a simulated bus, and what is no frame is said with its line"() {
    const page = await open(await first_plant(), "#/trace?filter=id%3D6AA");
    await needs(page, "send frames");
    await page.click("#trace-send");
    await page.fill("#send-frames", "6AA#010203\n6AA#12345");
    await page.waitForSelector(".send .bad:has-text('Line 2')");
    await page.fill("#send-frames", "6AA#010203\n6AA#");
    await page.click("#send-now");
    await is_said(page, "2 frames sent");
    await page.waitForFunction(() => document.querySelectorAll("#trace-grid .ag-center-cols-container .ag-row .ag-cell[col-id=text]").length === 2);
    return page;
  },
  async "2 PDOs: the list has the buffer memory beside the objects of the slaves"() {
    const page = await open(await first_plant(), "#/pdos");
    await page.waitForFunction(() => document.querySelectorAll("#pdo-grid .ag-row").length > 6);
    await page.waitForFunction(() => document.querySelector(".head .about")?.textContent.startsWith("as the nodes have them"), null, { timeout: 60_000 });
    const rows = await page.locator("#pdo-grid .ag-center-cols-container .ag-row").allTextContents();
    const encoder = rows.find((row) => row.includes("3 encoder") && row.includes("TPDO1"));
    assert.match(encoder, /183H.*Position value.*1 /);
    await page.click("#pdo-grid .ag-row:has-text('3 encoder'):has-text('TPDO1') .ag-cell >> nth=0");
    await page.waitForSelector(".drawer .frame-strip");
    assert.match(await page.textContent(".drawer"), /Position value/);
    await page.waitForSelector(".drawer h3:has-text('Buffer memory of')", { timeout: 90_000 });
    assert.match(await page.textContent(".drawer"), /G100\d\d/);
    return page;
  },
  async "2 PDOs: an object is found by search and mapped by dragging; what does not fit is refused at the pointer"() {
    const folder = make_project(path.join(scratch, "map"));
    const run = await start_run(["web", folder]);
    const page = await open(run, "#/pdos");
    await page.waitForSelector("#pdo-grid .ag-row:has-text('TPDO1')");
    await page.click("#pdo-grid .ag-row:has-text('Canopus drive'):has-text('TPDO1') .ag-cell >> nth=0");
    await page.click("ix-button:has-text('Change')");
    await page.waitForSelector(".editor .picks li[draggable=true]");
    const all = Number(await page.textContent(".editor h3:has-text('Can be mapped') .faint"));
    assert.equal(await page.locator(".editor .picks li[draggable=true]").count(), all, "all objects that can be mapped are there");
    await page.fill("#pdo-find", "velocity actual");
    await page.waitForFunction(() => document.querySelectorAll(".editor .picks li[draggable=true]").length < 4);
    const before = await page.locator(".editor ol.picks li").count();
    const wanted = page.locator(".editor .picks li[draggable=true]").first();
    const mapped = page.locator(".editor ol.picks");
    await wanted.dragTo(mapped);
    await page.waitForFunction((count) => document.querySelectorAll(".editor ol.picks li").length === count + 1, before);
    await wanted.dragTo(mapped);
    await wanted.dragTo(mapped);
    await page.waitForSelector(".refused:has-text('bits do not fit')");
    const pointer = await page.locator(".refused").boundingBox();
    const list = await mapped.boundingBox();
    assert.ok(Math.abs(pointer.y - (list.y + list.height / 2)) < 120, "the reason stands at the pointer");
    run.stop();
    return page;
  },
  async "2 PDOs: a project on a live bus shows its nodes, and their objects are read and written"() {
    const plant = await shared_run("bus of a plant", () => start_run(["run", example("first-plant/plant.toml"), "--web", "--free-ports"]));
    const folder = path.join(scratch, "live-objects");
    make_project(folder, ["io-block", "encoder", "drive"]);
    // The plant's nodes are 2, 3 and 4.
    for (const [from, to] of [["3", "4"], ["2", "3"], ["1", "2"]]) command("project", "set", folder, from, "--node-id", to);
    const run = await start_run(["web", folder, "--bus", `socketcand:${plant.listens["socketcand"]}`]);
    const page = await open(run, "#/overview");
    const has_nodes = await page.waitForSelector(".node", { timeout: 60_000 }).then(() => true, () => false);
    if (!has_nodes) await needs(page, "nodes of a live bus");
    assert.match(await page.textContent(".where"), /^LIVE/);
    await page.waitForSelector(".node:has-text('operational')");
    const bus = await page.evaluate(() => document.querySelector(".bus h2").textContent);
    await go(page, `#/objects/${encodeURIComponent(bus)}/4?find=6041`);
    await page.waitForSelector("#objects-grid .ag-cell[col-id=object]:has-text('6041:00')");
    assert.equal(await text_of(page, "#objects-grid", 0, "value"), "", "looking asks nothing");
    await page.click("ix-button:text-is('Read')");
    await page.waitForFunction(() => /H$/.test(document.querySelector("#objects-grid .ag-row .ag-cell[col-id=value]")?.textContent ?? ""));
    // Written: refused until writes are armed.
    await go(page, `#/objects/${encodeURIComponent(bus)}/4?find=1017`);
    await page.waitForSelector("#objects-grid .ag-cell[col-id=object]:has-text('1017:00')");
    await cell(page, "#objects-grid", 0, "object").click();
    await page.fill("#object-value", "650");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p.bad");
    assert.match(await page.textContent(".write p.bad"), /arm/i);
    await page.click("button.arm");
    await page.waitForSelector("button.arm[aria-pressed=true]:has-text('Armed')");
    await page.fill("#object-value", "650");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p:has-text('1017:00 = 650 written')");
    const read = await say(page, { command: "sdo read", bus, node: "4", object: "1017:00", type: "u16" });
    assert.equal(read.rows[0].value, 650);
    run.stop();
    return page;
  },
  async "3 objects: value, unit, words of a Statusword, bits, decimal and hexadecimal, written with the type of the file"() {
    const page = await open(await first_plant(), "#/objects/line1/4?find=6041");
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-cell[col-id=object]")?.textContent === "6041:00");
    assert.match(await text_of(page, "#objects-grid", 0, "words"), /switch on|operation|ready/);
    await cell(page, "#objects-grid", 0, "object").click();
    await page.waitForSelector(".named-bits li");
    assert.ok((await page.locator(".named-bits li").count()) >= 10);
    await go(page, "#/objects/line1/4?find=1017");
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-cell[col-id=object]")?.textContent === "1017:00");
    assert.equal(await text_of(page, "#objects-grid", 0, "value"), "500");
    await page.click("label:has-text('Hexadecimal')");
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-row .ag-cell[col-id=value]")?.textContent === "01F4H");
    await page.click("label:has-text('Hexadecimal')");
    await cell(page, "#objects-grid", 0, "object").click();
    await page.fill("#object-value", "700");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p:has-text('1017:00 = 700 written')");
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-row .ag-cell[col-id=value]")?.textContent === "700");
    await page.fill("#object-value", "70000");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p.bad");
    assert.doesNotMatch(await page.textContent(".write p.bad"), /--/);
    await say(page, { command: "sdo write", bus: "line1", node: "4", object: "1017:00", value: "500", type: "u16" });
    return page;
  },
  async "3 objects: project, device and difference stand beside each other"() {
    const folder = make_project(path.join(scratch, "differences"));
    const run = await start_run(["web", folder]);
    const page = await open(run, "#/objects");
    await page.waitForSelector("#objects-grid .ag-row");
    const has_project = await page.waitForSelector("#objects-grid .ag-header-cell[col-id=difference]", { timeout: 60_000 }).then(() => true, () => false);
    if (!has_project) await needs(page, "values of the project beside objects");
    const bus = await page.evaluate(() => document.querySelector("#objects-node optgroup").label);
    await say(page, { command: "sdo write", bus, node: "3", object: "1017:00", value: "321", type: "u16" });
    await go(page, `#/objects/${encodeURIComponent(bus)}/3?find=1017`);
    await page.waitForFunction(() => document.querySelector("#objects-grid .ag-row .ag-cell[col-id=difference]")?.textContent === "differs");
    run.stop();
    return page;
  },
  async "4 overview: 127 nodes fit into the window, trouble stands first, external nodes are named"() {
    const devices = Array.from({ length: 126 }, (_, i) => `[[device]]\nnode = ${i + 2}\nname = "encoder ${i + 2}"\neds = "${example("devices/encoder.eds")}"\n`).join("\n");
    const file = path.join(scratch, "many.toml");
    writeFileSync(file, `[plant]\nname = "127 nodes"\n\n[[bus]]\nname = "line1"\nbit_rate = 1_000_000\n\n${devices}\n[[plc]]\n\n[[plc.module]]\nmodel = "ME3CAN1-Q"\nhead = 0\nnode = 1\nmaster = true\n`);
    const run = await start_run(["run", file, "--web", "--free-ports"]);
    const page = await open(run, "#/overview");
    await page.waitForFunction(() => document.querySelectorAll(".node").length === 127);
    const last = await page.locator(".node").last().boundingBox();
    assert.ok(last.y + last.height <= 800, `the last card ends at ${last.y + last.height}`);
    run.stop();
    const stuck = await open(await stuck_slaves(), "#/overview");
    await stuck.waitForSelector(".trouble");
    const above = (await stuck.locator(".trouble").first().boundingBox()).y < (await stuck.locator(".node").first().boundingBox()).y;
    assert.ok(above, "trouble first");
    assert.match(await stuck.locator(".node:has-text('9')").last().textContent(), /external node/);
    return [page, stuck];
  },
  async "4 overview: each half of a cut bus has its own load"() {
    const run = await start_run(["run", own_plant("cut"), "--web", "--free-ports"]);
    const page = await open(run, "#/overview");
    await page.waitForSelector(".node");
    await say(page, { command: "run faults", bus: "line1", seed: 1, faults: [{ text: 'kind = "cut"\nports = ["drive"]', on: true }] });
    const is_split = await page.waitForSelector(".half-bus", { timeout: 60_000 }).then(() => true, () => false);
    if (!is_split) await needs(page, "halves of a cut bus");
    assert.equal(await page.locator(".half-bus").count(), 2);
    assert.match(await page.locator(".half-bus").last().textContent(), /Far half.*load \d.*drive/s);
    run.stop();
    return page;
  },
  async "5 plots: they keep running under other screens, have two cursors, zoom, and are exported"() {
    const page = await open(await first_plant(), "#/overview");
    await page.click(".bus .number");
    await page.waitForSelector(".dock plot-chart canvas");
    await page.click("ix-menu-item[data-screen=events]");
    await page.waitForSelector(".dock plot-chart canvas");
    await page.waitForTimeout(2500);
    await page.click(".dock > header a");
    await page.waitForSelector(".plot canvas");
    await page.waitForTimeout(600);
    const chart = await page.locator(".plot .u-over").boundingBox();
    await page.mouse.click(chart.x + chart.width * 0.97, chart.y + 20);
    await page.keyboard.down("Shift");
    await page.mouse.click(chart.x + chart.width * 0.99, chart.y + 20);
    await page.keyboard.up("Shift");
    await page.waitForSelector("#cursor-time");
    assert.match(await page.textContent("#cursor-time"), /^B−A \d/);
    assert.match(await page.textContent(".plot header"), /A [\d.]+, B [\d.]+, B−A/);
    const download = page.waitForEvent("download");
    await page.click("button:text-is('Export CSV')");
    const csv = readFileSync(await (await download).path(), "utf8");
    assert.match(csv, /^time \(s\),name,value\r\n\d/);
    return page;
  },
  async "6 faults: a form with words, the frame is picked in the trace, hits are counted, a refusal keeps what acted, remove ends it"() {
    const run = await start_run(["run", own_plant("faults"), "--web", "--free-ports"]);
    const page = await open(run, "#/faults");
    await page.click("button[aria-label='Add a fault']");
    await page.click("#menu button:text-is('Lose frames')");
    await page.click("button:has-text('Pick a frame in the trace')");
    await page.waitForSelector(".said:has-text('Choose the frame for “Lose frames”')");
    await page.waitForSelector("#trace-grid .ag-row");
    await page.waitForTimeout(500);
    await page.click("#trace-freeze");
    await page.click("#trace-grid .ag-row:has-text('183') .ag-cell[col-id=text] >> nth=0");
    await page.waitForSelector(".fault-name:has-text('183H')");
    await page.fill("label:has-text('At most') input", "");
    await page.keyboard.press("Tab");
    await page.click("#fault-run");
    await page.waitForFunction(() => /[1-9]\d* frames? hit/.test(document.querySelector(".fault .status")?.textContent ?? ""), null, { timeout: 90_000 });
    // Refused: what acted goes on.
    await page.fill("label:has-text('Probability') input", "7");
    await page.keyboard.press("Tab");
    await page.click("#fault-run");
    await page.waitForSelector("[role=alert]:has-text('What acted before goes on')");
    const faults = (await say(page, { command: "faults" })).rows[0].buses[0].faults;
    assert.equal(faults.filter((one) => one.on).length, 1);
    await page.fill("label:has-text('Probability') input", "");
    await page.keyboard.press("Tab");
    await page.click("#fault-run");
    await page.waitForSelector(".fault[data-mood=acting]");
    await page.click(".fault ix-icon-button");
    await page.waitForSelector(".fault", { state: "detached" });
    assert.equal((await say(page, { command: "faults" })).rows[0].buses[0].faults.filter((one) => one.on).length, 0);
    run.stop();
    return page;
  },
  async "7 boot: the failed step with expected and found, what to do, Retry; a missing node is one line of the events"() {
    const page = await open(await stuck_slaves(), "#/boot");
    await page.waitForSelector(".boot[data-kind=failed]");
    const failed = await page.locator(".boot[data-kind=failed]").first().textContent();
    assert.match(failed, /product code differs.*Expected00000301H.*Found00000\w+H.*What to do Check/s);
    await page.click(".boot:has-text('3 encoder') ix-button");
    await page.waitForSelector(".said:has-text('node 3 is booted anew'), .said[data-mood=error]", { timeout: 90_000 });
    await go(page, "#/events");
    // It is asked again each 1.5 s of plant time: repeated from the second time on.
    await page.waitForSelector("#events-grid .ag-row:has-text('node 9'):has-text('×')", { timeout: 60_000 });
    const lines = (await page.locator("#events-grid .ag-center-cols-container .ag-row").allTextContents()).filter((line) => /node 9/.test(line));
    assert.ok(lines.length <= 3 && lines.some((line) => /×\d+/.test(line)), lines.join("\n"));
    return page;
  },
  async "8 module: LEDs, X and Y only where there are some, words with source and age, a word is written, error history"() {
    const page = await open(await first_plant(), "#/module/0?find=G10000");
    await page.waitForSelector("#words-grid .ag-row");
    assert.ok((await page.locator(".led").count()) >= 4);
    await page.waitForSelector(".signals");
    await page.waitForFunction(() => /RPDO\d 18\dH from \w+/.test(document.querySelector("#words-grid .ag-cell[col-id=source]")?.textContent ?? "") && /ms|s/.test(document.querySelector("#words-grid .ag-cell[col-id=age]")?.textContent ?? ""));
    await go(page, "#/module/0/errors");
    await page.waitForSelector("table.rows, ix-empty-state");
    const fx = await shared_run("an FX module", () => start_run(["run", example("fx3u-can/master.toml"), "--web", "--free-ports"]));
    const other = await open(fx, "#/module/0");
    await other.waitForSelector(".led");
    assert.equal(await other.locator(".signals").count(), 0, "an FX module has no X and Y");
    await needs(page, "write word");
    await go(page, "#/module/0?find=G13000");
    await page.waitForFunction(() => document.querySelector("#words-grid .ag-cell[col-id=address]")?.textContent === "G13000");
    await page.click("#words-grid .ag-cell[col-id=address]");
    await page.fill("#word-value", "12ABH");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p:has-text('G13000 = 12ABH written')");
    await page.waitForFunction((value) => document.querySelector("#words-grid .ag-cell[col-id=value]")?.textContent === value, String(0x12ab));
    await page.fill("#word-value", "99999");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p.bad:has-text('expected')");
    return [page, other];
  },
  async "9 start: plants are found by what they show"() {
    const run = await shared_run("start", () => start_run(["web"], { cwd: folder_of_work() }));
    const page = await open(run, "#/start");
    await page.waitForSelector(".plant-card");
    await page.fill("[data-filter]", "zzzz");
    await page.waitForSelector("p:has-text('Nothing found for “zzzz”')");
    await needs(page, "new plant");
    await page.fill("[data-filter]", "fx3u");
    await page.waitForFunction(() => [...document.querySelectorAll(".plant-card")].some((one) => /FX3U-CAN/.test(one.textContent) && one.querySelector(".plant-picture .device-of, .plant-picture .module-of")));
    return page;
  },
  async "9 start: a new plant in three steps, its devices from dropped files"() {
    const run = await shared_run("start", () => start_run(["web"], { cwd: folder_of_work() }));
    const page = await open(run, "#/start");
    await page.waitForSelector(".plant-card");
    await needs(page, "new plant");
    await page.click("#new-plant");
    await page.fill("#wizard-name", "made here");
    await page.click(".choice:has-text('ME3CAN1-Q')");
    await page.click("#wizard-next");
    await page.selectOption("#wizard-rate", "500");
    await page.click("#wizard-next");
    await drop(page, ".drop-zone", example("devices/encoder.eds"));
    await drop(page, ".drop-zone", example("devices/drive.eds"));
    await page.waitForSelector("#wizard tbody tr:nth-child(2)");
    await page.click("#wizard-next");
    await page.waitForFunction(() => document.querySelectorAll(".node").length === 3, null, { timeout: 90_000 });
    assert.match(await page.textContent(".bus"), /500 kbit\/s/);
    return page;
  },
  async "9 start: a new project in three steps, its devices from dropped files"() {
    const run = await shared_run("start", () => start_run(["web"], { cwd: folder_of_work() }));
    const page = await open(run, "#/start");
    await page.waitForSelector("#new-project");
    await needs(page, "new project");
    await page.click("#new-project");
    await page.fill("#wizard-name", "made press");
    await page.keyboard.press("Enter");  // right behind the last character, before a button is drawn anew
    await page.selectOption("#wizard-rate", "125");
    await page.click("#wizard-next");
    await drop(page, ".drop-zone", example("devices/encoder.eds"));
    await drop(page, ".drop-zone", example("devices/drive.eds"));
    await page.waitForSelector("#wizard tbody tr:nth-child(2)");
    await page.fill("#wizard tbody tr:nth-child(2) input[type=number]", "1");
    await page.waitForSelector("#wizard .bad:has-text('Node-ID 1 is there twice')");
    await page.fill("#wizard tbody tr:nth-child(2) input[type=number]", "9");
    await page.click("#wizard-next");
    await page.waitForFunction(() => document.querySelector(".plant")?.textContent !== "Canopus" || document.querySelectorAll(".node, .project-node").length === 2, null, { timeout: 90_000 });
    const shown = command("project", "show", path.join(folder_of_work(), "made press"), "--json").split("\n").filter(Boolean).map((line) => JSON.parse(line));
    assert.deepEqual(shown.filter((row) => row.node !== undefined).map((row) => row.node), [1, 9]);
    return page;
  },
  async "10 settings: a live PLC is compared, and written when writes are armed"() {
    const plc = await shared_run("settings of a PLC", () => start_run(["run", example("rj71cn91/plant.toml"), "--web", "--free-ports"]));
    const address = Object.entries(plc.listens).find(([protocol]) => protocol.startsWith("MC protocol"))?.[1];
    const [host, port] = address.split(":");
    const file = path.join(scratch, "live-module.xml");
    command("configure", "new", file, "--model", "RJ71CN91");
    command("configure", "read", file, "--part", "all", "--host", host, "--port", port);
    command("configure", "set", file, "tpdo/1", "COB-ID=0x191");
    const run = await start_run(["web", file, "--host", host, "--port", port]);
    const page = await open(run, "#/settings/0/transfer");
    assert.match(await page.textContent(".where"), /^LIVE/);
    assert.equal(await page.locator("#plant-time, .pace").count(), 0, "nothing of a simulated run");
    await page.click("ix-button:text-is('Compare')");
    await page.waitForSelector(".main tbody tr");
    const write = page.locator(".main ix-button:has-text('Write')");
    assert.match(await page.textContent(".main .warn"), /armed first/);
    await page.click("button.arm");
    await page.waitForSelector("button.arm[aria-pressed=true]");
    await page.click("label:has-text('Put the CPU module into STOP')");
    await write.click();
    await is_said(page, "written and read back: the same");
    await page.click("ix-button:text-is('Compare')");
    await page.waitForSelector(".main p:text-is('The module has all of it.')");
    run.stop();
    return page;
  },
  async "10 settings: windows as a tree, a changed field is marked, and nothing of a run is shown where there is none"() {
    const file = path.join(scratch, "alone.xml");
    command("configure", "new", file, "--module", "RJ71CN91");
    const run = await start_run(["web", file]);
    const page = await open(run, "#/settings");
    await page.waitForSelector(".tree h3:has-text('PDO list')");
    assert.deepEqual(await page.locator("ix-menu-item").evaluateAll((all) => all.map((one) => one.dataset.screen)), ["settings", "events"]);
    await page.click(".tree a:has-text('NMT master / slave')");
    const field = page.locator(".settings-form input.field").first();
    await field.fill("1234");
    await field.press("Tab");
    await page.waitForSelector(".tree a:has-text('NMT master / slave') .warn, .said[data-mood=error]");
    assert.equal(await page.locator(".settings-form [data-mood=unwritten]").count(), 1);
    run.stop();
    return page;
  },
  async "project: a value is changed and marked, a note is kept, a DCF is compared and taken over, and Undo takes it back"() {
    const folder = make_project(path.join(scratch, "dcf"), ["drive"]);
    const file = path.join(scratch, "drive-of-before.dcf");
    command("project", "dcf", "save", folder, "1", file);
    const run = await start_run(["web", folder]);
    const page = await open(run, "#/project");
    await page.waitForSelector(".project-node");
    await page.click(".project-node");
    await page.fill("[data-filter]", "1017");
    await page.waitForFunction(() => document.querySelector("#project-grid .ag-cell[col-id=object]")?.textContent === "1017:00");
    await page.dblclick("#project-grid .ag-cell[col-id=project]");
    await page.keyboard.press("Control+a");
    await page.keyboard.type("250");
    await page.keyboard.press("Enter");
    await page.waitForSelector("#project-grid .ag-cell:has-text('not yet written')");
    await page.fill("#project-note", "spare part 4711");
    await page.keyboard.press("Tab");
    await is_said(page, "noted");
    await page.setInputFiles(".file:has-text('Compare DCF') input", file);
    await page.waitForSelector(".panel:has-text('1 difference')");
    await page.click("ix-button:has-text('Take over these values')");
    await is_said(page, "the node has the values of");
    await page.click("button:text-is('Undo')");
    await is_said(page, "taken back");
    const shown = command("project", "show", folder, "1", "--all", "--json");
    assert.match(shown, /"object":"1017:00"[^\n]*"value":250/);
    assert.match(command("project", "show", folder, "--json"), /spare part 4711/);
    run.stop();
    return page;
  },
  async "bottom strip: a trouble that comes again is one line with its count, and the description covers nothing"() {
    const page = await open(await stuck_slaves(), "#/overview");
    await page.waitForSelector(".strip li");
    assert.ok((await page.locator(".strip li").count()) <= 3);
    await page.click(".node");
    const screen = await page.locator(".screen").boundingBox();
    const drawer = await page.locator(".drawer").boundingBox();
    assert.ok(screen.x + screen.width <= drawer.x + 1);
    return page;
  },
};
