#!/usr/bin/env node
// An NMT slave made of a stack that is not ours, as NODE on the bus, over socketcand, for an NMT master of ours: identity, heartbeat
// every 200 ms, SDO server, one PDO each way. TPDO1 (180H + NODE) has the four words of RPDO1 (200H + NODE) inverted, and is sent
// when RPDO1 came, in Operational; 3584 in the first one sends an emergency, too. 2003H (u16) is there to be configured.
// Prints "ready" once it is on the bus, then "state STATE", "written 2003 VALUE" and "received WORDS" as they come, until its
// standard input ends.
import { argumentsOrUsage, run, standardInputEnded } from './interop_report.mjs';
import { canopen, deviceOn } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { DataType, NmtState } = canopen;
const [host, port, busName, nodeText] = argumentsOrUsage(4, 'nmt_slave_peer.mjs HOST PORT BUS NODE');
const node = Number(nodeText);
const names = Object.fromEntries(Object.entries(NmtState).map(([name, value]) => [value, name]));

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, node);
  const { eds } = device;
  const words = (first) => Array.from({ length: 4 }, (_, i) =>
    eds.addEntry(first + i, { parameterName: `Word ${first + i}`, dataType: DataType.UNSIGNED16 }));
  const setUp = () => {
    eds.setIdentity({ vendorId: 0x319, productCode: 0x1234, revisionNumber: 0x10002, serialNumber: 42 });
    eds.setDeviceName('npm canopen');
    if (!eds.getEntry(0x1017)) {  // UNSIGNED16, which the stack would make an UNSIGNED32: it fails when a master writes two bytes
      eds.addEntry(0x1017, { parameterName: 'Producer heartbeat time', dataType: DataType.UNSIGNED16 });
    }
    eds.setHeartbeatProducerTime(200);
    eds.setEmcyCobId(0x80 + node);
  };
  setUp();
  eds.addSdoServerParameter(0, 0x580 + node, 0x600 + node);
  const limited = eds.addEntry(0x2003, { parameterName: 'Configured', dataType: DataType.UNSIGNED16, defaultValue: 0 });
  const received = words(0x2100);
  const sent = words(0x2200);
  eds.addReceivePdo({ cobId: 0x200 + node, transmissionType: 254, dataObjects: received });
  eds.addTransmitPdo({ cobId: 0x180 + node, transmissionType: 254, dataObjects: sent });
  limited.on('update', () => console.log(`written 2003 ${limited.value}`));

  const bootUp = () => bus.send({ id: 0x700 + node, data: Buffer.from([0]) });  // which the stack leaves to the application
  device.nmt.on('changeState', (state) => console.log(`state ${names[state]}`));
  device.pdo.on('pdo', (pdo) => {
    if (pdo.cobId !== 0x200 + node || device.nmt.state !== NmtState.OPERATIONAL) return;
    const values = received.map((object) => object.value);
    console.log(`received ${values.join(' ')}`);
    sent.forEach((object, i) => { object.value = values[i] ^ 0xFFFF; });
    device.pdo.write(0x180 + node);
    if (values[0] === 3584) device.emcy.write(0x5000, Buffer.from('0102030405', 'hex'));
  });
  bootUp();
  device.start();
  device.nmt.on('reset', () => {
    setUp();  // the stack has brought back the defaults of its objects
    setImmediate(bootUp);  // it starts again meanwhile
  });
  console.log(`ready as node ${node}`);
  await standardInputEnded();
  device.stop();
  await bus.close();
});
