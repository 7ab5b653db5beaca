// npm modbus-serial as somebody's hands: modbus_words.js HOST PORT, then a line of the standard input each:
// read ADDRESS COUNT -> the words; write ADDRESS WORD... -> ok. Addresses are decimal, words hexadecimal; a refusal is "exception N".
const readline = require("node:readline");
const ModbusRTU = require("modbus-serial");

async function main() {
  const plc = new ModbusRTU();
  await plc.connectTCP(process.argv[2], { port: Number(process.argv[3]) });
  plc.setID(1);
  plc.setTimeout(60000);
  for await (const line of readline.createInterface({ input: process.stdin })) {
    const [what, address, ...fields] = line.split(" ");
    try {
      if (what === "read") {
        const { data } = await plc.readHoldingRegisters(Number(address), Number(fields[0]));
        console.log(data.map((word) => word.toString(16).toUpperCase().padStart(4, "0")).join(" "));
      } else {
        const words = fields.map((word) => parseInt(word, 16));
        await (words.length === 1 ? plc.writeRegister(Number(address), words[0]) : plc.writeRegisters(Number(address), words));
        console.log("ok");
      }
    } catch (error) {
      if (error.modbusCode === undefined) throw error;
      console.log(`exception ${error.modbusCode}`);
    }
  }
}

main().then(() => process.exit(0), (error) => { console.error(error); process.exit(1); });
