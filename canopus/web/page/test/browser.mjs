// The page in a real browser: `node test/browser.mjs --program PROGRAM [--chromium CHROMIUM] [--folder BUILT_PAGE] [--pictures FOLDER] [--compare FOLDER] [--only PATTERN] [--limit SECONDS]`.
// Runs of the examples are started here. With --folder the files of the page come from there, else from the program. --pictures keeps a picture of each screen,
// --compare holds them against kept ones (docs/web). playwright-core and axe-core are those of tests/interop. Prints what failed, and ends with 1 then; the same
// when --limit is over, with the names of those that were not run.
import { end, options, run_tests } from "./browser/kit.mjs";
import { pictures } from "./browser/pictures.mjs";
import { points } from "./browser/points.mjs";
import { program } from "./browser/program.mjs";
import { screens } from "./browser/screens.mjs";
import { workflows } from "./browser/workflows.mjs";

try {
  await run_tests({ ...workflows, ...points, ...program, ...screens, ...(options.compare ? pictures : {}) });
} finally {
  await end();
}
