// Every screen light and dark, 1280 and 1920 pixels wide: nothing stands out of the window, the browser complains of nothing; axe-core finds nothing serious
// in the light and in the dark. A picture is kept on the way (--pictures).
import assert from "node:assert/strict";
import path from "node:path";
import { axe_problems, layout_problems, options } from "./kit.mjs";
import { open_place, places } from "./places.mjs";

const windows = [
  { colorScheme: "light", width: 1280, height: 800, with_axe: true },
  { colorScheme: "light", width: 1920, height: 1080 },
  { colorScheme: "dark", width: 1280, height: 800 },
  { colorScheme: "dark", width: 1920, height: 1080, with_axe: true },
];

async function look(place) {
  const page = await open_place(place, { is_seen: Boolean(options.pictures) });
  if (options.pictures) await page.screenshot({ path: path.join(options.pictures, `${place.name}.png`) });
  const problems = [];
  for (const { colorScheme, width, height, with_axe } of windows) {
    await page.emulateMedia({ colorScheme });
    await page.setViewportSize({ width, height });
    await page.waitForTimeout(350);  // the menu folds and unfolds 300 ms later
    for (const one of [...(await layout_problems(page)), ...(with_axe ? await axe_problems(page) : [])]) problems.push(`${colorScheme} ${width}: ${one}`);
  }
  assert.deepEqual(problems, []);
  return page;
}

export const screens = Object.fromEntries(places.map((place) => [`screen ${place.name}`, () => look(place)]));
