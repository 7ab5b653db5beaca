// Pictures of each screen, held against kept ones (--compare) with the same plant time, seed and font. Those that differ are kept (--pictures).
import assert from "node:assert/strict";
import { existsSync, readFileSync } from "node:fs";
import path from "node:path";
import { options } from "./kit.mjs";
import { open_place, places } from "./places.mjs";

const most_different = 0.02;  // share of the pixels
const nearly_the_same = 48;   // of 255, of each colour

/** The share of pixels that differ; in the browser, which can read pictures. What tells time is left out. */
function difference(page, kept, taken, left_out) {
  return page.evaluate(async ([a, b, boxes, near]) => {
    const pixels = async (data) => {
      const image = await createImageBitmap(new Blob([Uint8Array.from(atob(data), (c) => c.charCodeAt(0))], { type: "image/png" }));
      const canvas = new OffscreenCanvas(image.width, image.height);
      const context = canvas.getContext("2d");
      context.drawImage(image, 0, 0);
      return context.getImageData(0, 0, image.width, image.height);
    };
    const [before, now] = [await pixels(a), await pixels(b)];
    if (before.width !== now.width || before.height !== now.height) return 1;
    let different = 0;
    for (let y = 0; y < now.height; ++y) {
      for (let x = 0; x < now.width; ++x) {
        if (boxes.some((box) => x >= box.x && x < box.x + box.width && y >= box.y && y < box.y + box.height)) continue;
        const at = 4 * (y * now.width + x);
        if ([0, 1, 2].some((i) => Math.abs(before.data[at + i] - now.data[at + i]) > near)) ++different;
      }
    }
    return different / (now.width * now.height);
  }, [kept.toString("base64"), taken.toString("base64"), left_out, nearly_the_same]);
}

async function compare(place) {
  const page = await open_place(place, { is_seen: true });
  const picture = await page.screenshot(options.pictures ? { path: path.join(options.pictures, `${place.name}.png`) } : {});
  const file = path.join(options.compare, `${place.name}.png`);
  assert.ok(existsSync(file), `${file} is not there`);
  const boxes = [];
  for (const selector of [".strip", ".worst", "#plant-time"]) for (const one of await page.locator(selector).all()) boxes.push(await one.boundingBox());
  const share = await difference(page, readFileSync(file), picture, boxes.filter(Boolean));
  assert.ok(share <= most_different, `${(100 * share).toFixed(1)} % of the picture is not as in ${file}`);
  return page;
}

export const pictures = Object.fromEntries(places.filter((place) => !place.moves).map((place) => [`picture ${place.name}`, () => compare(place)]));
