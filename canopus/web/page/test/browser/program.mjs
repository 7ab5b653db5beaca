// The screen of a PLC program: live values beside the text, forces, breaks and single scans, a run-time error at its line.
import assert from "node:assert/strict";
import { first_plant, needs, open, run_example } from "./kit.mjs";
import { FakeProgram } from "./fake_program.mjs";

async function open_program(program, hash = "#/program") {
  const page = await open(await first_plant(), hash, { joined: (context) => program.join(context) });
  await page.waitForSelector(".source li .value-chip, #variables-grid .ag-row, .screen table.rows");
  return page;
}
const line = (page, number) => page.locator(`.source li:has(.line-number:text-is("${number}"))`);

export const program = {
  async "PLC program: one that runs is halted, goes on for a scan, and a variable is forced and released"() {
    const run = await run_example("structured-text/plant.toml");
    const page = await open(run, "#/program/plc1?line=138");
    await needs(page, "halt program");
    await page.waitForSelector(".source li:has-text('output') .value-chip");
    await page.click("#program-halt");
    await page.waitForSelector(".cpu-state:text-is('halted')");
    await page.click(".parts a:text-is('Tasks')");
    const runs = () => page.textContent("table.rows tbody tr:first-child td:last-child");
    await page.waitForTimeout(600);  // more than from state to state
    const before = Number(await runs());
    await page.waitForTimeout(600);
    assert.equal(Number(await runs()), before, "a halted program does not run");
    await page.click("#program-scan");
    await page.waitForFunction((count) => document.querySelector("table.rows tbody tr:first-child td:last-child").textContent === String(count), before + 1);
    await page.click(".parts a:text-is('Variables')");
    await page.fill("[data-filter]", "echoes");
    await page.click("#variables-grid .ag-cell[col-id=name]:has-text('echoes')");
    await page.fill("#variable-value", "70000");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p.bad:has-text('expected')");
    await page.fill("#variable-value", "7");
    await page.click("#variable-force");
    await page.waitForSelector("#variables-grid .ag-cell[col-id=forced]:has-text('forced')");
    await page.waitForFunction(() => document.querySelector("#variables-grid .ag-cell[col-id=value]")?.textContent === "7");
    await page.click("#variable-release");
    await page.waitForSelector(".forced", { state: "detached" });
    await page.click("#program-continue");
    await page.waitForSelector(".cpu-state:text-is('RUN')");
    run.stop();
    return page;
  },
  async "PLC program: values stand beside the text, a variable is forced from its line and released"() {
    const fake = new FakeProgram();
    const page = await open_program(fake);
    assert.match(await line(page, 9).textContent(), /n := n \+ D100;.*n 5.*D100 17/s);
    assert.match(await line(page, 10).locator("[data-on]").first().textContent(), /motor ON/);
    await line(page, 9).locator(".value-chip:has-text('n 5')").click();
    await page.fill("#variable-value", "many");
    await page.keyboard.press("Enter");
    await page.waitForSelector(".write p.bad:has-text('expected INT')");
    await page.fill("#variable-value", "42");
    await page.click("#variable-force");
    await page.waitForSelector(".write p:has-text('n = 42 forced')");
    await line(page, 9).locator(".value-chip[data-forced]:has-text('n 42')").waitFor();
    await page.click(".forced button[aria-label='Release n']");
    await page.waitForSelector(".forced", { state: "detached" });
    await line(page, 9).locator(".value-chip:has-text('D100')").click();
    await page.waitForSelector(".drawer h2:text-is('D100')");
    assert.equal(await page.locator("#variable-value").count(), 0, "a device is not written here");
    assert.deepEqual(fake.commands.filter((one) => one.plc).map(({ command, plc, name, value }) => [command, plc, name, value]), [["write variable", "plc1", "n", "many"], ["force variable", "plc1", "n", "42"], ["release variable", "plc1", "n", undefined]]);
    return page;
  },
  async "PLC program: it is halted, goes on scan by scan, and halts at a break"() {
    const fake = new FakeProgram();
    const page = await open_program(fake);
    await page.click("#program-halt");
    await page.waitForSelector(".source li[data-mark=halted]:has-text('motor :=')");
    assert.match(await page.textContent(".cpu-state"), /halted/);
    await page.click("#program-scan");
    await page.waitForSelector(".inline-facts dd:text-is('501')");
    await page.click("#program-continue");
    await page.waitForSelector(".cpu-state:text-is('RUN')");
    assert.equal(await line(page, 3).locator("button.break").count(), 0, "no break where there is no code");
    await line(page, 11).locator("button.break").click();
    await page.waitForSelector("button.break[aria-pressed=true]");
    await line(page, 11).locator("button.break").click();
    await page.waitForSelector("button.break[aria-pressed=true]", { state: "detached" });
    return page;
  },
  async "PLC program: a run-time error stands at its line, and is led to"() {
    const fake = new FakeProgram();
    Object.assign(fake, { state: "error", error: { code: 3400, code_text: "3400H", text: "main.st:301:9: division by zero", file: 0, line: 301, column: 9, t: 0.004 } });
    const page = await open_program(fake);
    assert.match(await page.textContent("[role=alert].lead"), /3400H main\.st:301:9: division by zero, at 0\.004 s/);
    await page.click(".lead a:has-text('Go to the line')");
    await page.waitForSelector(".source li[data-mark=error]:has-text('3400H division by zero')");
    const [row, list] = [await page.locator(".source li[data-mark=error]").boundingBox(), await page.locator("#source").boundingBox()];
    assert.ok(row.y > list.y && row.y + row.height < list.y + list.height, "the line is in sight");
    return page;
  },
  async "PLC program: variables are found by name and written, tasks say when they run"() {
    const fake = new FakeProgram();
    const page = await open_program(fake, "#/program/plc1/variables");
    await page.fill("[data-filter]", "lim");
    await page.waitForFunction(() => document.querySelectorAll("#variables-grid .ag-center-cols-container .ag-row").length === 1);
    await page.click("#variables-grid .ag-cell[col-id=name]");
    await page.waitForSelector(".drawer h2:text-is('Main.limit')");
    await page.click(".parts a:text-is('Tasks')");
    await page.waitForSelector("table.rows td:text-is('every 10.0 ms')");
    return page;
  },
};
