#!/usr/bin/env node
// A CANopen stack that is not ours configures an ME3CAN1-Q, RJ71CN91 or FX3U-CAN as its slave, over socketcand, as a
// configuration tool would: identity, heartbeat producer and consumer, two PDOs each way, store (1010H), reset; what was stored must be in force after
// the reset, what was not must be gone. The node is left Operational with a heartbeat every 200 ms; RPDO1 and TPDO1 carry
// the words G10000 and G13000 (FX3U-CAN: #10000 and #11000) on events, RPDO2 and TPDO2 the words four further with each SYNC.
// With an EDS file (of `canopus module eds`), the stack reads that, too, and the module must be what the file says.
import { argumentsOrUsage, check, patience, run } from './interop_report.mjs';
import { abortCodeOf, canopen, deviceOn, useServer } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { DataType, Eds, NmtState } = canopen;
const [host, port, busName, nodeText, edsFile, model] = argumentsOrUsage(6, 'module_slave_peer.mjs HOST PORT BUS NODE EDS MODEL');
const [vendor, product, revision, pdos] =
  { 'ME3CAN1-Q': [0x71, 0xED63, 0x10000, 256], RJ71CN91: [0x1D0, 0x100, 0x10000, 256], 'FX3U-CAN': [0x71, 7170, 0x1000C, 80] }[model];
const node = Number(nodeText);
const { UNSIGNED8: u8, UNSIGNED16: u16, UNSIGNED32: u32, VISIBLE_STRING: text } = DataType;

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, 126);
  useServer(device, node);
  device.start();
  const read = (index, subIndex, dataType) => device.sdo.upload({ deviceId: node, index, subIndex, dataType, timeout: patience });
  const write = (index, subIndex, data, dataType) =>
    device.sdo.download({ deviceId: node, index, subIndex, data, dataType, timeout: patience });
  const heartbeat = (state) => new Promise((resolve) => {
    const timer = setTimeout(() => done(`none within ${patience} ms`), patience);
    const listen = ({ id, data }) => { if (id === 0x700 + node && data[0] === state) done(data[0]); };
    const done = (result) => {
      clearTimeout(timer);
      bus.off('frame', listen);
      resolve(result);
    };
    bus.on('frame', listen);
  });

  check('1000H device type', await read(0x1000, 0, u32), 0x195);
  check('1008H device name', await read(0x1008, 0, text), model);
  check('1018:00 entries', await read(0x1018, 0, u8), 3);
  check('1018:01 vendor', await read(0x1018, 1, u32), vendor);
  check('1018:02 product code', await read(0x1018, 2, u32), product);
  check('1018:03 revision', await read(0x1018, 3, u32), revision);
  check('1018:04 serial number is refused', await abortCodeOf(read(0x1018, 4, u32)), 0x06090011);

  const eds = Eds.fromFile(edsFile);
  check('EDS: 1008H', eds.getEntry(0x1008).defaultValue, await read(0x1008, 0, text));
  for (const sub of [1, 2, 3]) {
    check(`EDS: 1018H:0${sub}`, eds.getSubEntry(0x1018, sub).value, await read(0x1018, sub, u32));
  }
  check('EDS: RPDOs', Array.from({ length: 256 }, (_, i) => eds.getEntry(0x1400 + i)).filter(Boolean).length, pdos);
  check('EDS: 1A05:03', eds.getSubEntry(0x1A05, 3).value, await read(0x1A05, 3, u32));

  await write(0x1017, 0, 200, u16);
  check('heartbeat in Pre-operational', await heartbeat(NmtState.PRE_OPERATIONAL), NmtState.PRE_OPERATIONAL);
  // TPDO1: one word, G13000, inhibit time 5 ms
  await write(0x1800, 1, 0xC0000180 + node, u32);
  await write(0x1A00, 0, 0, u8);
  await write(0x1A00, 1, 0xA1000110, u32);
  check('9 entries are refused', await abortCodeOf(write(0x1A00, 0, 9, u8)), 0x06040042);
  await write(0x1A00, 0, 1, u8);
  await write(0x1800, 3, 50, u16);
  await write(0x1800, 1, 0x40000180 + node, u32);
  // RPDO1 one word, G10000; RPDO2 and TPDO2 one word each, G10004 and G13004, synchronous
  const setUp = async (communication, cobId, type, entry) => {
    await write(communication, 1, (cobId | 0x80000000) >>> 0, u32);
    await write(communication, 2, type, u8);
    await write(communication + 0x200, 0, 0, u8);
    await write(communication + 0x200, 1, entry, u32);
    await write(communication + 0x200, 0, 1, u8);
    check(`${communication.toString(16)}H: the mapping cannot change while entries are in use`,
      await abortCodeOf(write(communication + 0x200, 1, entry, u32)), 0x06010000);
    await write(communication, 1, cobId, u32);
    check(`${communication.toString(16)}H: the mapping cannot change while the PDO is valid`,
      await abortCodeOf(write(communication + 0x200, 0, 0, u8)), 0x08000022);
  };
  await setUp(0x1400, 0x200 + node, 254, 0xA5800110);
  await setUp(0x1401, 0x300 + node, 1, 0xA5800510);
  await setUp(0x1801, 0x40000280 + node, 1, 0xA1000510);
  check('an input cannot be mapped into an RPDO', await abortCodeOf((async () => {
    await write(0x1604, 0, 0, u8);
    await write(0x1604, 1, 0xA1000110, u32);
  })()), 0x06040041);
  check('a reserved COB-ID is refused', await abortCodeOf(write(0x1404, 1, 0x601, u32)), 0x06090030);
  await write(0x1016, 1, 0x007E03E8, u32);  // this stack, node 126: 1000 ms
  check('another word than "save" is refused', await abortCodeOf(write(0x1010, 1, 0x65766172, u32)), 0x08000020);
  await write(0x1010, 1, 0x65766173, u32);
  await write(0x1015, 0, 77, u16);  // not stored
  device.nmt.resetNode(node);
  check('boot-up after the reset', await heartbeat(0), 0);
  check('heartbeat after the reset', await heartbeat(NmtState.PRE_OPERATIONAL), NmtState.PRE_OPERATIONAL);
  check('1800:03 was stored', await read(0x1800, 3, u16), 50);
  check('1A00:00 was stored', await read(0x1A00, 0, u8), 1);
  check('1A00:01 was stored', await read(0x1A00, 1, u32), 0xA1000110);
  check('1016:01 was stored', await read(0x1016, 1, u32), 0x007E03E8);
  check('1017H was stored', await read(0x1017, 0, u16), 200);
  for (const [communication, cobId, type, entry] of [[0x1400, 0x200 + node, 254, 0xA5800110],
    [0x1401, 0x300 + node, 1, 0xA5800510], [0x1801, 0x40000280 + node, 1, 0xA1000510]]) {
    const name = `${communication.toString(16)}H`;
    check(`${name}:01 was stored`, await read(communication, 1, u32), cobId);
    check(`${name}:02 was stored`, await read(communication, 2, u8), type);
    check(`${name}: its mapping was stored`, await read(communication + 0x200, 0, u8), 1);
    check(`${name}: its object was stored`, await read(communication + 0x200, 1, u32), entry);
  }
  check('1015H was not', await read(0x1015, 0, u16), 0);
  device.nmt.startNode(node);
  check('Operational', await heartbeat(NmtState.OPERATIONAL), NmtState.OPERATIONAL);
  await bus.close();
});
