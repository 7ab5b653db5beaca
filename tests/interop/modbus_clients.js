// npm modbus-serial and jsmodbus against a rack: modbus_clients.js HOST PORT modbus-serial|modbus-serial-rtu|jsmodbus
// modbus-serial-rtu: RTU frames over TCP.
const assert = require("node:assert");
const net = require("node:net");

const [host, port, client] = process.argv.slice(2);
setTimeout(() => { console.error("no answer within 60 s"); process.exit(1); }, 60000);

async function withModbusSerial(isRtu) {
  const ModbusRTU = require("modbus-serial");
  const plc = new ModbusRTU();
  await (isRtu ? plc.connectTelnet(host, { port: Number(port) }) : plc.connectTCP(host, { port: Number(port) }));
  plc.setID(1);
  plc.setTimeout(30000);
  await plc.writeRegisters(710, [1, 2, 65535]);
  assert.deepEqual((await plc.readHoldingRegisters(710, 3)).data, [1, 2, 65535]);
  await plc.writeRegister(711, 77);
  assert.deepEqual((await plc.readHoldingRegisters(711, 1)).data, [77]);
  if (!isRtu) {  // its RTU knows no functions 22 and 43
    await plc.maskWriteRegister(711, 0x00f0, 0x0003);
    assert.deepEqual((await plc.readHoldingRegisters(711, 1)).data, [(77 & 0xf0) | 3]);
  }
  await plc.writeCoils(0x110, [true, false, true]);
  assert.deepEqual((await plc.readCoils(0x110, 3)).data.slice(0, 3), [true, false, true]);
  await plc.writeCoil(0x110, false);
  assert.equal((await plc.readCoils(0x110, 1)).data[0], false);
  assert.equal((await plc.readDiscreteInputs(0, 16)).data.length, 16);
  assert.deepEqual((await plc.readInputRegisters(203, 1)).data, [0]);
  if (!isRtu) {
    const identification = await plc.readDeviceIdentification(1, 0);
    assert.ok(JSON.stringify(identification).includes("Canopus"), JSON.stringify(identification));
  }
  await assert.rejects(plc.readHoldingRegisters(65000, 1), (error) => error.modbusCode === 2);
  plc.close(() => {});
}

function withJsmodbus() {
  const { client: { TCP } } = require("jsmodbus");
  const socket = new net.Socket();
  const plc = new TCP(socket, 1);
  return new Promise((resolve, reject) => {
    socket.on("error", reject);
    socket.on("connect", async () => {
      try {
        await plc.writeMultipleRegisters(720, [10, 20, 30]);
        const words = await plc.readHoldingRegisters(720, 3);
        assert.deepEqual(Array.from(words.response.body.valuesAsArray), [10, 20, 30]);
        await plc.writeSingleRegister(721, 99);
        await plc.writeMultipleCoils(0x120, [true, true, false, true]);
        const bits = await plc.readCoils(0x120, 4);
        assert.deepEqual(Array.from(bits.response.body.valuesAsArray).slice(0, 4), [1, 1, 0, 1]);
        await plc.writeSingleCoil(0x120, false);
        await plc.readDiscreteInputs(0, 8);
        const registers = await plc.readInputRegisters(203, 1);
        assert.deepEqual(Array.from(registers.response.body.valuesAsArray), [0]);
        // Requests behind each other on one connection.
        const many = await Promise.all(Array.from({ length: 20 }, () => plc.readHoldingRegisters(720, 2)));
        for (const one of many) assert.deepEqual(Array.from(one.response.body.valuesAsArray), [10, 99]);
        await assert.rejects(plc.readHoldingRegisters(65000, 1));
        socket.end();
        resolve();
      } catch (error) { reject(error); }
    });
    socket.connect({ host, port: Number(port) });
  });
}

(client === "jsmodbus" ? withJsmodbus() : withModbusSerial(client === "modbus-serial-rtu"))
  .then(() => { console.log("all held"); process.exit(0); })
  .catch((error) => { console.error(error); process.exit(1); });
