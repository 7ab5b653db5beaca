// Bundles test/*.test.ts and runs them by node's own test runner: no browser.
import { spawnSync } from "node:child_process";
import { mkdtemp, readdir, rm } from "node:fs/promises";
import os from "node:os";
import path from "node:path";
import { fileURLToPath } from "node:url";
import * as esbuild from "esbuild";

const here = path.dirname(fileURLToPath(import.meta.url));
const folder = await mkdtemp(path.join(os.tmpdir(), "page-tests-"));
const tests = (await readdir(path.join(here, "test"))).filter((name) => name.endsWith(".test.ts"));
await esbuild.build({ absWorkingDir: here, entryPoints: tests.map((name) => `test/${name}`), outdir: folder, outExtension: { ".js": ".mjs" },
  bundle: true, format: "esm", platform: "node", target: "node18", define: { "process.env.PAGE_SOURCE": JSON.stringify(here) }, logLevel: "warning" });
const done = spawnSync(process.execPath, ["--test", ...tests.map((name) => path.join(folder, name.replace(/\.ts$/, ".mjs")))], { stdio: "inherit" });
await rm(folder, { recursive: true });
process.exit(done.status ?? 1);
