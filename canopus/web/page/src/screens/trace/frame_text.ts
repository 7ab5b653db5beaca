// Frames as text: "601#4018100100000000", "123#R", "18FF1234#00" (8 digits: 29 bits), one in each line. No browser is needed here.

export const frames_of = (text: string): string[] => text.split("\n").map((line) => line.trim().toUpperCase()).filter(Boolean);

function problem_of(frame: string): string {
  const found = /^([0-9A-F]+)#(R\d?|(?:[0-9A-F]{2})*)$/.exec(frame);
  if (!found) return frame.includes("#") ? "the data is an even number of hexadecimal digits, or R" : "expected CAN-ID#data, for example 181#0102";
  const [, id = "", data = ""] = found;
  if (id.length !== 3 && id.length !== 8) return "a CAN-ID has 3 digits (11 bits) or 8 (29 bits)";
  if (parseInt(id, 16) > (id.length === 3 ? 0x7ff : 0x1fffffff)) return `the largest CAN-ID of ${id.length} digits is ${id.length === 3 ? "7FF" : "1FFFFFFF"}`;
  return !data.startsWith("R") && data.length > 16 ? "a frame has at most 8 bytes" : "";
}

/** What is wrong with the first line that is no frame; an empty text: nothing. */
export function frame_problem(text: string): string {
  for (const [place, frame] of text.split("\n").map((line) => line.trim().toUpperCase()).entries()) {
    const problem = frame === "" ? "" : problem_of(frame);
    if (problem) return `Line ${place + 1}: ${problem}`;
  }
  return "";
}

/** A line of the trace as such a text. */
export const frame_of_row = (row: { id: string; data?: string; remote?: boolean; dlc?: number }): string => `${row.id}#${row.remote ? `R${row.dlc ?? 0}` : row.data ?? ""}`;
