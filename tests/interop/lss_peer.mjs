#!/usr/bin/env node
// Devices without a node-ID, made of a stack that is not ours, on one bus over socketcand: LSS slaves.
//
// Each IDENTITY is VENDOR:PRODUCT:REVISION:SERIAL. Prints "ready", then each node-ID as it is given, until its standard input
// ends; by then every device must have one. `late:N:MS` makes the Nth answer of each device MS ms late.
//
// Two things the stack leaves to the application are done here: fastscan is for devices in waiting state that have no node-ID
// yet, and a device selected by its address says so (44H).
import { argumentsOrUsage, check, run, standardInputEnded } from './interop_report.mjs';
import { canopen } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { Device, LssMode } = canopen;
const [host, port, busName, ...words] =
  argumentsOrUsage(4, 'lss_peer.mjs HOST PORT BUS [late:N:MS] VENDOR:PRODUCT:REVISION:SERIAL...');
const identities = words.filter((word) => !word.startsWith('late:'));
const [, lateAnswer, delay] = (words.find((word) => word.startsWith('late:')) ?? 'late:0:0').split(':').map(Number);
const fastscan = 0x51;
const lastOfAddress = 0x43;

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  let missing = identities.length;
  for (const text of identities) {
    const [vendorId, productCode, revisionNumber, serialNumber] = text.split(':').map(Number);
    const device = new Device({ enableLss: true });
    device.eds.setIdentity({ vendorId, productCode, revisionNumber, serialNumber });
    let nodeId;
    let answers = 0;
    device.on('message', (message) => {
      if (++answers === lateAnswer) return setTimeout(() => bus.send(message), delay);
      bus.send(message);
    });
    device.lss.on('changeDeviceId', (id) => {
      if (nodeId === undefined) --missing;
      nodeId = id;
      console.log(`      ${text} is node ${id}`);
    });
    bus.on('frame', (frame) => {
      if (frame.extended || frame.id !== 0x7E5) return;
      const waiting = device.lss.mode !== LssMode.CONFIGURATION;
      if (frame.data[0] === fastscan && !(waiting && nodeId === undefined)) return;
      device.lss.receive(frame);
      if (frame.data[0] === lastOfAddress && waiting && device.lss.mode === LssMode.CONFIGURATION) {
        bus.send({ id: 0x7E4, data: Buffer.from([0x44, 0, 0, 0, 0, 0, 0, 0]) });
      }
    });
  }
  console.log('ready');
  await standardInputEnded();
  check('devices with a node-ID', identities.length - missing, identities.length);
  await bus.close();
});
