// What there is to say of a list of faults that somebody edits, beside those that the bus has now.

const struck = (fault) => (fault.active ? "now" : `${fault.hits ?? 0} frames hit`);

/// `edited`: [{ text, on }]; `acting`: the bus's own, [{ text, on, hits, active }]. `says`: of each edited one; `left`: those that
/// go on until the list is run, though it has them no more.
export function fault_rows(edited, acting) {
  const rest = acting.filter((fault) => fault.on);
  const says = edited.map(({ text, on }) => {
    const place = rest.findIndex((fault) => fault.text === text);
    if (place < 0) return on ? "not yet run" : "off";
    const [found] = rest.splice(place, 1);
    return on ? struck(found) : `${struck(found)}, on until Run`;
  });
  return { says, left: rest.map((fault) => ({ text: fault.text, says: `${struck(fault)}, removed, but on until Run` })) };
}
