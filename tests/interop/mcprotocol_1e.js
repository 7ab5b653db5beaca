// npm mcprotocol against a port for 1E frames: mcprotocol_1e.js HOST PORT binary|ascii
const MC = require("mcprotocol");

const [host, port, code] = process.argv.slice(2);
const variables = { WORDS: "D700,5", BITS: "M800,28", REAL: "DFLOAT720", INPUT: "X20", TIMER: "TN3,2" };
const written = { WORDS: [1, -2, 300, 4, 5], BITS: Array.from({ length: 28 }, (_, i) => i % 3 === 0), REAL: 1.5 };

const fail = (why) => { console.error(why); process.exit(1); };
setTimeout(() => fail("no answer within 60 s"), 60000);
const plc = new MC();
plc.initiateConnection({ host, port: Number(port), ascii: code === "ascii" }, (error) => {
  if (error !== undefined) fail(error);
  plc.setTranslationCB((name) => variables[name]);
  plc.addItems(Object.keys(variables));
  plc.writeItems(Object.keys(written), Object.values(written), (bad) => {
    if (bad) fail("writing went wrong");
    plc.readAllItems((wrong, values) => {
      if (wrong) fail(`reading went wrong: ${JSON.stringify(values)}`);
      for (const [name, value] of Object.entries(written)) {
        if (JSON.stringify(values[name]) !== JSON.stringify(value)) fail(`${name}: ${JSON.stringify(values[name])}`);
      }
      if (values.INPUT !== false) fail(`INPUT: ${values.INPUT}`);
      console.log("all held");
      process.exit(0);
    });
  });
});
