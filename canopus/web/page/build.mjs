// Makes the files of the page: `node build.mjs FOLDER [--watch] [--serve ADDRESS --program URL]`. tools/page calls it.
import { cp, mkdir, readdir, readFile, rm, writeFile } from "node:fs/promises";
import path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";
import { licence_list, licence_text, packages_of } from "./licences.mjs";
import { serve } from "./serve.mjs";

const here = path.dirname(fileURLToPath(import.meta.url));
const [folder, ...words] = process.argv.slice(2);
const word_after = (name) => (words.includes(name) ? words[words.indexOf(name) + 1] : undefined);
const is_watching = words.includes("--watch");

/** What is bundled says which licences belong beside it. */
const beside = {
  name: "files beside the bundle",
  setup(build) {
    build.onEnd(async (result) => {
      if (result.errors.length) return;
      for (const name of ["index.html", "login.html", "login.css", "icon.svg"]) await cp(path.join(here, name), path.join(folder, name));
      const packages = await packages_of(Object.keys(result.metafile.inputs), here);
      await writeFile(path.join(folder, "licences.txt"), licence_text(packages));
      await writeFile(path.join(folder, "packages.json"), licence_list(packages));
      if (is_watching) console.log("built", new Date().toTimeString().slice(0, 8));
    });
  },
};

const options = {
  absWorkingDir: here,
  entryPoints: [{ in: "src/main.ts", out: "page" }],
  outdir: path.resolve(folder),
  splitting: true,
  chunkNames: "[name]-[hash]",
  bundle: true,
  format: "esm",
  target: "es2022",
  minify: !is_watching,
  sourcemap: is_watching ? "inline" : false,
  legalComments: "none",
  charset: "utf8",
  metafile: true,
  logLevel: "warning",
  loader: { ".svg": "dataurl" },
  plugins: [beside],
};

await mkdir(folder, { recursive: true });
for (const name of await readdir(folder)) if (/^(heavy|chunk)-\w+\.js$/.test(name)) await rm(path.join(folder, name));
if (is_watching) {
  const context = await esbuild.context(options);
  await context.watch();
} else {
  await esbuild.build(options);
  for (const name of (await readdir(folder)).filter((one) => /\.(js|css)$/.test(one))) console.log(`${name} ${(await readFile(path.join(folder, name))).length} bytes`);
}
const address = word_after("--serve");
if (address) await serve(path.resolve(folder), address, word_after("--program"));
