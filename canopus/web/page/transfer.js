// What a transfer is about to write, and what became of it: from the rows of `canopus project write`.

/// What differs, each with whether it will be written. A device that is not the project's has nothing written, whatever differs.
export function plan_of(rows) {
  const written = new Set(rows.filter((row) => row.write !== undefined).map((row) => row.node));
  const compared = new Set(rows.filter((row) => row.values !== undefined).map((row) => row.node));
  return rows.filter((row) => row.object !== undefined).map((row) => (written.has(row.node) ? { ...row, is_to_be_written: true }
    : { ...row, reason: row.reason ?? (compared.has(row.node) ? "it is not written" : "it is another device, which is left alone") }));
}

/// Each write with its result and what the device has now, and what is left alone.
export function results_of(rows) {
  const names = new Map();  // by "NODE OBJECT"
  const now = new Map();    // what still differs behind the writes
  const last = new Map();   // its last write
  const results = [];
  for (const row of rows) {
    const key = `${row.node} ${row.write ?? row.object}`;
    if (row.write !== undefined) {
      results.push({ ...row, name: names.get(key) });
      last.set(key, results.at(-1));
    } else if (row.object !== undefined) {
      names.set(key, row.name);
      if (last.has(key)) now.set(key, row);
    }
  }
  for (const [key, result] of last) {
    const found = now.get(key);
    if (found) result.device = found.device;
    else if (result.state === "written") result.device = result.value;
  }
  return [...results, ...plan_of(rows).filter((row) => !row.is_to_be_written)];
}
