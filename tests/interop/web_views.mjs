// A real browser on the views of a run's page: bus, objects, plots, links and keys, and what axe-core finds. Says as JSON what it
// saw. `node web_views.mjs CHROMIUM URL FOLDER [RED NODE]`; pictures go into FOLDER. Judged by web_checks.py.
import { counted, end, folder, judge, more, open as open_page, picture, seen, uncover, url } from "./page_kit.mjs";

const [red] = more;

async function open(hash, options) {
  const page = await open_page(url + hash, options);
  await page.waitForSelector(".nodes li");
  return page;
}

// With a fourth word: a red node of that number, one click, and what is in sight of the reason, nothing scrolled.
if (red) {
  const page = await open("");
  const button = page.locator(".nodes button[data-mood=error]", { hasText: red });
  await button.click();
  await page.waitForSelector("#node-body tr");
  seen.reason = await page.evaluate(() => {
    const row = [...document.querySelectorAll("#node-body tr")].find((one) => one.textContent.startsWith("Why"));
    const place = row?.getBoundingClientRect();
    return { text: row?.textContent, in_sight: scrollY === 0 && place?.top >= 0 && place?.bottom <= innerHeight };
  });
  await picture(page, "reason", null);
  await end();
  process.exit(0);
}

// A link opens its view; light and dark, in two sizes; nothing serious for axe-core.
for (const [hash, section, ready] of [["#bus/0/183", "bus-section", "#strip .bit"], ["#objects/1", "objects-section", "#objects-table .number"],
                                      ["#words/0", "words-section", "#words-table tbody tr"], ["#boots", "boot-section", "#boots li"]]) {
  for (const colorScheme of ["light", "dark"]) {
    for (const [width, height] of [[1280, 800], [1920, 1080]]) {
      const page = await open(hash, { colorScheme, viewport: { width, height } });
      await page.waitForSelector(ready);
      await page.waitForTimeout(hash.startsWith("#bus") ? 2500 : 300);
      await judge(page, `${hash} ${colorScheme} ${width}`);
      if (section === "words-section") await page.fill("#words-find", "RPDO data");
      if (section === "boot-section") await page.locator("#boots summary").first().click();
      await page.waitForTimeout(600);
      await uncover(page);
      const path = `${folder}/${section.split("-")[0]}-${colorScheme}-${width}.png`;
      await page.locator(`#${section}`).screenshot({ path });
      seen.pictures.push(path);
      await page.close();
    }
  }
}

const page = await open("");
const texts = (selector) => page.locator(selector).allTextContents();
// By keys alone: to the bus, to a frame's bits.
await page.keyboard.press("Control+K");
await page.waitForSelector("#go-to[open]");
await judge(page, "go to");
await page.keyboard.type("bus line1");
await page.keyboard.press("Enter");
await page.waitForSelector("#can-ids a");
seen.bus_link = await page.evaluate(() => location.hash);
seen.bus_focus = await page.evaluate(() => document.activeElement.id);
await page.locator("#can-ids a", { hasText: "183" }).focus();
await page.keyboard.press("Enter");
await page.waitForSelector("#strip .bit");
seen.frame_link = await page.evaluate(() => location.hash);
// At once: the next frame may be there already.
Object.assign(seen, await page.evaluate(() => ({
  strip: document.querySelector("#strip p").textContent, fields: [...document.querySelectorAll("#strip .field-name")].map((one) => one.textContent), bits: document.querySelectorAll("#strip .bit").length })));
await page.waitForSelector("#bus-load .legend li");
seen.legend = await texts("#bus-load .legend li");
seen.counters = await texts("#counters tbody th");
seen.errors = await page.textContent("#errors");
seen.sync = await page.textContent("#bus-sync");
seen.sdo_times = await page.locator("#counters tbody td:last-child").allTextContents();
await page.keyboard.press("?");
seen.keys_open = await page.evaluate(() => document.getElementById("keys").open);
await judge(page, "keys");
await page.keyboard.press("Escape");
await page.keyboard.press("Escape");
await page.waitForFunction(() => document.getElementById("bus-section").hidden);
seen.closed_link = await page.evaluate(() => location.hash);
// Objects of the encoder, alive; one click plots a number.
await page.keyboard.press("Control+K");
await page.keyboard.type("encoder");
await page.keyboard.press("Enter");
await page.waitForSelector("#objects-table .number:visible");
seen.objects_title = await page.textContent("#objects-title");
seen.objects_count = await page.textContent("#objects-count");
seen.objects_rows = await page.locator("#objects-table tbody tr").count();
await page.fill("#objects-find", "6004");
await page.waitForFunction(() => document.querySelector("#objects-table tbody tr")?.textContent.startsWith("6004:00"));
seen.position = await page.textContent("#objects-table tbody tr");
seen.w8 = (await counted(page, async () => {
  await page.click("#objects-table .number");
  await page.waitForFunction(() => document.querySelector("#plots polyline")?.getAttribute("points")?.split(" ").length > 6);
})).clicks;
seen.plot = await page.textContent("#plots figcaption");
await page.waitForTimeout(2500);
await picture(page, "plots", "#plots");
await page.locator("#objects-title").focus();
await page.keyboard.press("h");
await page.waitForFunction(() => /^[0-9A-F]+H$/.test(document.querySelector("#objects-table .number")?.textContent));
await page.fill("#objects-find", "1008");
await page.waitForFunction(() => document.querySelector("#objects-table tbody tr")?.textContent.startsWith("1008:00"));
seen.markup = await page.locator("img, iframe, script:not([src='page.js'])").count();
// It goes on where its row is not in sight; a cursor shows a value; what is held stands still; CSV has the points.
const drawn = () => page.evaluate(() => document.querySelector("#plots .plot p").textContent);
const earlier = await drawn();
await page.waitForFunction((text) => document.querySelector("#plots .plot p").textContent !== text, earlier);
await page.locator("#plots .plot > svg").hover();
await page.waitForFunction(() => / at \d+\.\d{3} s$/.test(document.querySelector("#plots figcaption b").textContent));
seen.cursor = await page.textContent("#plots figcaption b");
await page.locator("#plots button", { hasText: "Hold" }).click();
const held = await drawn();
await page.waitForTimeout(800);
seen.held = held === await drawn();
const download = page.waitForEvent("download");
await page.locator("#plots button", { hasText: "CSV" }).click();
await (await download).saveAs(`${folder}/plots.csv`);
await page.locator(".bus .number").first().click();
seen.plots = await page.locator("#plots figcaption").count();
// An address with plots shows them; one that is nonsense shows what it has of them, as text.
seen.plot_link = await page.evaluate(() => location.search);
const linked = await open(`?${seen.plot_link.slice(1)}&plot=${encodeURIComponent("words 99 <b>|<img src=x>")}&plot=&plot=%7C#objects/1`);
await linked.waitForFunction(() => document.querySelector("#plots polyline")?.getAttribute("points")?.split(" ").length > 2);
seen.linked_plots = await linked.locator("#plots figcaption").allTextContents();
seen.linked_markup = await linked.locator("#plots img, #plots figcaption b b").count();
seen.linked_objects = await linked.textContent("#objects-title");
await linked.close();
await page.locator("#plots figcaption button").last().click();
await page.click("#plots figcaption button");
seen.plots_closed = await page.locator("#plots").isHidden();
// A link that leads nowhere is no error.
for (const hash of ["#bus/99", "#objects/x", "#words/0/<img>", "#nothing", "#bus/0/ZZZ"]) {
  await page.evaluate((link) => { location.hash = link; }, hash);
  await page.waitForTimeout(100);
}
// A node, clicked: what there is to say of it is in sight without scrolling.
const small = await open("", { viewport: { width: 1280, height: 800 } });
await small.locator(".nodes button").last().click();
seen.in_sight = await small.evaluate(() => {
  const place = document.querySelector("#node-body tr").getBoundingClientRect();
  return scrollY === 0 && place.top >= 0 && place.bottom <= innerHeight;
});
await picture(small, "node", null);

// The tree at the left edge: what it has, where it leads, folded; a window that is too narrow for it has none.
const wide = await open("");
await wide.locator("#tree a", { hasText: "Faults" }).waitFor();
seen.tree = await wide.locator("#tree li > a, #tree li > button:not(.fold)").allTextContents();
seen.lamps = await wide.locator("#tree [data-mood=good]").count();
await wide.locator("#tree button", { hasText: "encoder" }).click();
seen.tree_node = await wide.textContent("#node-title");
await wide.locator("#tree a", { hasText: "Messages" }).click();
await wide.waitForFunction(() => document.activeElement.id === "messages-title");
seen.tree_focus = await wide.evaluate(() => [document.activeElement.id, document.activeElement.getBoundingClientRect().top < innerHeight]);
await wide.locator("#tree .fold").click();
await wide.waitForFunction(() => !document.querySelector("#tree [data-node]"));
await wide.locator("#tree a", { hasText: "line1" }).click();
await wide.waitForFunction(() => document.getElementById("bus-title").textContent !== "");
seen.tree_bus = await wide.textContent("#bus-title");
await wide.setViewportSize({ width: 800, height: 800 });
seen.tree_narrow = await wide.locator("#tree").isVisible();
// Nor has it columns that leave no place for names.
await wide.setViewportSize({ width: 700, height: 800 });
seen.narrow = [];
for (const [hash, table] of [["#objects/1", "#objects-table"], ["#words/0", "#words-table"]]) {
  await wide.evaluate((link) => { location.hash = link; }, hash);
  await wide.waitForSelector(`${table} tbody tr`);
  seen.narrow.push(await wide.locator(`${table} th`, { hasText: "Name" }).evaluate((one) => one.offsetWidth));
  await judge(wide, `${hash} 700`);
}

// What is known of a node: figures over a second, heartbeat, SDO answers, boot.
const figures = await open("");
await figures.locator(".nodes button", { hasText: "encoder" }).click();
await figures.waitForFunction(() => [...document.querySelectorAll("#node-body tr")].some((row) => /^Frames a second\d/.test(row.textContent)));
seen.node_rows = await figures.locator("#node-body tr").allTextContents();
await end();
