#!/usr/bin/env node
// LSS master of a stack that is not ours, over devices of the plant that have no node-ID: fastscan, identity inquiry,
// selective switching, node-ID, bit timing, store. Devices get node-IDs from FIRST on, in the order fastscan finds them.
//
// Each IDENTITY is VENDOR:PRODUCT:REVISION:SERIAL; exactly these must be found. A fastscan takes silence for a 1: SILENCE is
// how many milliseconds an answer to it may take, all other answers have time.
import { argumentsOrUsage, check, patience, run } from './interop_report.mjs';
import { canopen } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { Device, LssMode } = canopen;
const [host, port, busName, silence, first, ...identities] =
  argumentsOrUsage(6, 'lss_master_peer.mjs HOST PORT BUS SILENCE FIRST VENDOR:PRODUCT:REVISION:SERIAL...');
const timeout = patience;
const text = (address) =>
  [address.vendorId, address.productCode, address.revisionNumber, address.serialNumber].join(':');

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const booted = new Set();
  bus.on('frame', (frame) => {
    if (!frame.extended && frame.id > 0x700 && frame.id < 0x780 && frame.data.length === 1 && frame.data[0] === 0) {
      booted.add(frame.id - 0x700);
      bus.emit('booted');
    }
  });
  const bootUp = (id) => new Promise((resolve) => {
    const end = setTimeout(() => resolve(false), patience);
    const look = () => {
      if (!booted.has(id)) return;
      clearTimeout(end);
      bus.off('booted', look);
      resolve(true);
    };
    bus.on('booted', look);
    look();
  });
  const device = new Device({ id: 126 });
  const { lss } = device;
  device.on('message', (message) => bus.send(message));
  lss.start?.();
  bus.on('frame', (frame) => { if (!frame.extended && frame.id === 0x7E4) lss.receive(frame); });

  const expected = new Set(identities.map((words) => words.split(':').map(Number).join(':')));
  let node = Number(first);
  lss.switchModeGlobal(LssMode.OPERATION);
  for (;;) {
    const found = await lss.fastscan({ timeout: Number(silence) });
    if (found === null) break;
    check('fastscan finds one of them', expected.delete(text(found)), true);
    const asked = {
      vendorId: await lss.inquireVendorId(timeout),
      productCode: await lss.inquireProductCode(timeout),
      revisionNumber: await lss.inquireRevisionNumber(timeout),
      serialNumber: await lss.inquireSerialNumber(timeout),
    };
    check('the identity inquired is the one found', text(asked), text(found));
    lss.switchModeGlobal(LssMode.OPERATION);
    await lss.switchModeSelective({ ...found, timeout });
    await lss.configureNodeId(node, timeout);
    await lss.configureBitTiming(0, 3, timeout);  // 250 kbit/s
    await lss.storeConfiguration(timeout);
    let refusal = null;
    await lss.configureNodeId(200, timeout).catch((error) => { refusal = error.code; });
    check('node-ID 200 is refused with error', refusal, 1);
    await lss.configureBitTiming(0, 9, timeout).catch((error) => { refusal = [refusal, error.code].join(); });
    check('bit timing index 9 as well', refusal, '1,1');
    lss.switchModeGlobal(LssMode.OPERATION);
    check(`node ${node} boots up`, await bootUp(node), true);
    ++node;
  }
  check('devices not found', expected.size, 0);
  await bus.close();
});
