#!/usr/bin/env node
// A CANopen stack that is not ours identifies devices and commands the last of them by NMT, over socketcand.
//
// For each device it reads 1000H (must be TYPE), 1008H (must be NAME) and 1018:01, 02 (must be VENDOR, PRODUCT); what is not
// given is read without being compared. Then it makes the last device send heartbeats, sends it to Pre-operational and starts
// it, and expects both states in its heartbeats.
import { argumentsOrUsage, check, patience, run } from './interop_report.mjs';
import { canopen, deviceOn, useServer } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { DataType, NmtState } = canopen;
const [host, port, busName, ...devices] = argumentsOrUsage(4,
  'canopen_peer.mjs HOST PORT BUS NODE:TYPE[:NAME[:VENDOR[:PRODUCT]]]...');
const own = 127;

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, own);
  const expected = devices.map((text) => {
    const [node, type, name, vendor, product] = text.split(':');
    return { node: Number(node), type, name, vendor, product };
  });
  for (const { node } of expected) useServer(device, node);
  device.start();

  const read = (deviceId, index, subIndex, dataType) =>
    device.sdo.upload({ deviceId, index, subIndex, dataType, timeout: patience });
  const compare = (what, actual, text, parse) => {
    if (text) check(what, actual, parse(text));
    else check(`${what} (${JSON.stringify(actual)}) is there`, actual !== undefined, true);
  };
  for (const { node, type, name, vendor, product } of expected) {
    compare(`node ${node} 1000H device type`, await read(node, 0x1000, 0, DataType.UNSIGNED32), type, Number);
    compare(`node ${node} 1008H name`, await read(node, 0x1008, 0, DataType.VISIBLE_STRING), name, String);
    const entries = await read(node, 0x1018, 0, DataType.UNSIGNED8);
    check(`node ${node} 1018:00 names 1 to 4 entries (${entries})`, entries >= 1 && entries <= 4, true);
    compare(`node ${node} 1018:01 vendor`, await read(node, 0x1018, 1, DataType.UNSIGNED32), vendor, Number);
    if (entries >= 2) compare(`node ${node} 1018:02 product`, await read(node, 0x1018, 2, DataType.UNSIGNED32), product, Number);
  }

  const { node } = expected.at(-1);
  const period = await read(node, 0x1017, 0, DataType.UNSIGNED16);
  const setPeriod = (data) =>
    device.sdo.download({ deviceId: node, index: 0x1017, subIndex: 0, data, dataType: DataType.UNSIGNED16, timeout: patience });
  if (period === 0 || period > 500) await setPeriod(100);
  // The state of the next heartbeat, or of the first one that shows `state`.
  const heartbeat = (state) => new Promise((resolve) => {
    const timer = setTimeout(() => done(`none within ${patience} ms`), patience);
    const listen = ({ id, data }) => { if (id === 0x700 + node && (state === undefined || data[0] === state)) done(data[0]); };
    const done = (result) => {
      clearTimeout(timer);
      bus.off('frame', listen);
      resolve(result);
    };
    bus.on('frame', listen);
  });
  device.nmt.enterPreOperational(node);
  check(`node ${node} goes to Pre-operational`, await heartbeat(NmtState.PRE_OPERATIONAL), NmtState.PRE_OPERATIONAL);
  device.nmt.startNode(node);
  check(`node ${node} starts`, await heartbeat(NmtState.OPERATIONAL), NmtState.OPERATIONAL);
  if (period === 0 || period > 500) await setPeriod(period);
  await bus.close();
});
