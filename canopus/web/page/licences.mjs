// The packages in the bundle with their versions and licences: as data for the parts list, and as one text for people.
import { readdir, readFile } from "node:fs/promises";
import path from "node:path";

/** `inputs`: files of the bundle, relative to `root`. What a bundled package depends on may be in its own files already (iX has its dependencies so). */
export async function packages_of(inputs, root) {
  const waiting = [];
  for (const input of inputs) {
    const found = /^node_modules\/((?:@[^/]+\/)?[^/]+)\//.exec(input);
    if (found) waiting.push(found[1]);
  }
  const packages = new Map();
  while (waiting.length) {
    const name = waiting.pop();
    if (packages.has(name)) continue;
    const folder = path.join(root, "node_modules", name);
    const { version, license, dependencies } = JSON.parse(await readFile(path.join(folder, "package.json"), "utf8"));
    const file = (await readdir(folder)).sort().find((one) => /^licen[cs]e(\.\w+)?$/i.test(one));
    packages.set(name, { name, version, licence: license, text: file ? (await readFile(path.join(folder, file), "utf8")).trim() : "" });
    waiting.push(...Object.keys(dependencies ?? {}).filter((one) => !one.startsWith("@types/")));
  }
  return [...packages.values()].sort((a, b) => (a.name < b.name ? -1 : 1));
}

export const licence_text = (packages) => packages.map((one) => `${one.name} ${one.version}: ${one.licence}\n\n${one.text}\n`).join(`\n${"-".repeat(78)}\n\n`);
/** [{ name, version, licence }] */
export const licence_list = (packages) => `${JSON.stringify(packages.map(({ name, version, licence }) => ({ name, version, licence })), null, 1)}\n`;
