// Reads a DBC file and decodes frames by it with npm candied. usage: dbc_reader.mjs FILE.dbc < frames
// A line of the input is an identifier and the bytes, both in hexadecimal digits; one of the output is JSON: the message's
// name and its signals as [first bit, value, name] in order; null when no message has the identifier.
import fs from "node:fs";
import candied from "candied";

const { Can, Dbc } = candied;
const can = new Can();
can.database = new Dbc().load(fs.readFileSync(process.argv[2], "utf8"), true);
for (const line of fs.readFileSync(0, "utf8").split("\n").filter(Boolean)) {
  const [id, digits] = line.split(" ");
  const bytes = (digits.match(/../g) ?? []).map((byte) => parseInt(byte, 16));
  const message = can.decode(can.createFrame(parseInt(id, 16), bytes, id.length === 8));
  const signals = message && [...message.boundSignals].map(([name, one]) => [one.boundData.signal.startBit, one.value, name]);
  console.log(JSON.stringify(message ? { name: message.name, signals: signals.sort((a, b) => a[0] - b[0]) } : null));
}
