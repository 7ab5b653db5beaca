#!/usr/bin/env node
// A device made of a stack that is not ours, as NODE on the bus, over socketcand: SDO server, NMT slave, heartbeat producer.
//
// It has 1000H, 1001H, 1017H, 1018H and
//   1008H text "npm canopen"    2000H text    2001H domain of 1000 bytes    2002H u32 12345678H, read only    2003H u16 0..1000
// prints "ready" once it is on the bus, then each object as it is written, until its standard input ends; by then every EXPECT
// (OBJECT,TYPE,VALUE, as in sdo_client_peer.mjs, in any order) must have been written.
import { argumentsOrUsage, check, run, standardInputEnded } from './interop_report.mjs';
import { canopen, canTransferBlocks, deviceOn, objectOf, types, valueOf } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const { AccessType, DataType } = canopen;
const [host, port, busName, nodeText, ...expects] = argumentsOrUsage(4, 'sdo_server_peer.mjs HOST PORT BUS NODE [EXPECT...]');
const node = Number(nodeText);

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, node);
  const { eds } = device;
  eds.setIdentity({ vendorId: 0x319, productCode: 0x1234, revisionNumber: 0x10002, serialNumber: 42 });
  eds.setDeviceName('npm canopen');
  eds.setHeartbeatProducerTime(200);
  eds.addSdoServerParameter(0, 0x580 + node, 0x600 + node);
  const objects = [
    eds.addEntry(0x2000, { parameterName: 'Text', dataType: DataType.VISIBLE_STRING, defaultValue: 'hello' }),
    eds.addEntry(0x2001, { parameterName: 'Domain', dataType: DataType.DOMAIN }),
    eds.addEntry(0x2002, { parameterName: 'Constant', dataType: DataType.UNSIGNED32, defaultValue: 0x12345678,
      accessType: AccessType.READ_ONLY }),
    eds.addEntry(0x2003, { parameterName: 'Limited', dataType: DataType.UNSIGNED16, lowLimit: 0, highLimit: 1000 }),
  ];
  objects[1].raw = Buffer.from(Array.from({ length: 1000 }, (_, i) => (i * 7 + (i >> 8)) & 0xFF));

  const missing = new Map(expects.map((text) => {
    const [object, type, value] = text.split(',');
    return [objectOf(object).index, { type, value }];
  }));
  for (const object of objects) {
    object.on('update', () => {
      const index = parseInt(object.key, 16);
      console.log(`      written ${object.key.toUpperCase()}H: ${object.raw.length} bytes ${object.raw.subarray(0, 32).toString('hex')}`);
      const expected = missing.get(index);
      if (!expected) return;
      const same = object.raw.equals(canopen.typeToRaw(valueOf(expected.type, expected.value), types[expected.type])
        ?? valueOf(expected.type, expected.value));
      if (!same) return;
      check(`${object.key.toUpperCase()}H was written with ${expected.value}`, same, true);
      missing.delete(index);
    });
  }
  bus.send({ id: 0x700 + node, data: Buffer.from([0]) });  // boot-up, which the stack leaves to the application
  device.start();
  console.log(`ready as node ${node}${canTransferBlocks ? '' : ', without block transfers (npm rebuild node-crc)'}`);
  await standardInputEnded();
  for (const [index, { value }] of missing) check(`${index.toString(16).toUpperCase()}H was written with ${value}`, false, true);
  device.stop();
  await bus.close();
});
