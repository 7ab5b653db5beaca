// Prints each check as it is made; the exit code says whether all held.
let failures = 0;

function show(value) {
  if (typeof value === 'number') return `${value} (${value.toString(16).toUpperCase()}H)`;
  if (!Buffer.isBuffer(value)) return JSON.stringify(value);
  const start = value.subarray(0, 16).toString('hex');
  return value.length > 16 ? `${value.length} bytes ${start}…` : start;
}

/** One check: prints it, and remembers a failure. */
export function check(what, actual, expected) {
  const same = Buffer.isBuffer(expected) ? Buffer.isBuffer(actual) && expected.equals(actual) : actual === expected;
  if (!same) ++failures;
  console.log(same ? `ok    ${what}: ${show(actual)}` : `FAIL  ${what}: ${show(actual)}, expected ${show(expected)}`);
  return same;
}

/** What is there at once on an idle machine is given so many milliseconds: they cost something only when a check fails. */
export const patience = 60_000;

/** Runs the script's body; ends the process with 0 when every check held. Nothing hangs longer than `seconds`. */
export function run(body, seconds = 600) {
  const done = (code) => process.exit(code || (failures > 0 ? 1 : 0));
  setTimeout(() => {
    console.log(`FAIL  not finished within ${seconds} s`);
    done(1);
  }, seconds * 1000);
  body().then(() => done(0), (error) => {
    console.log(`FAIL  ${error.stack ?? error}`);
    done(1);
  });
}

/** Whoever started the script says by the end of its standard input that it is no longer needed. */
export function standardInputEnded() {
  return new Promise((resolve) => { process.stdin.on('end', resolve).resume(); });
}

/** The command line's arguments, or the usage and exit code 2. */
export function argumentsOrUsage(least, usage) {
  const words = process.argv.slice(2);
  if (words.length >= least) return words;
  console.log(`usage: ${usage}`);
  process.exit(2);
}
