#!/usr/bin/env node
// The SDO client of a stack that is not ours, against the SDO server of NODE, over socketcand.
//
// Each further argument is one step, its fields separated by commas; OBJECT is INDEX:SUBINDEX in hexadecimal, TYPE one of
// bool i8 i16 i32 u8 u16 u32 f32 text bytes domain, bytes and domain in hexadecimal digits, CODE an SDO abort code:
//   upload,OBJECT,TYPE[,VALUE]           reads (expedited or segmented, as the server decides), compares with VALUE
//   download,OBJECT,TYPE,VALUE           writes and reads back (expedited up to 4 bytes, else segmented)
//   download-size,OBJECT,SIZE            writes SIZE bytes and reads them back
//   block-upload,OBJECT,TYPE[,VALUE]     the same by block transfer; skipped when the stack's CRC is not built
//   block-download,OBJECT,TYPE,VALUE
//   block-download-size,OBJECT,SIZE      written by blocks, read back by segments and by blocks
//   abort-upload,OBJECT,CODE             the server must abort with CODE
//   abort-download,OBJECT,TYPE,VALUE,CODE
//   abort-block-upload,OBJECT,CODE
//   abort-block-download,OBJECT,TYPE,VALUE,CODE
//   eds,FILE,OBJECT                      the stack reads an EDS file: its default value of OBJECT is what the server has
import { argumentsOrUsage, check, patience, run } from './interop_report.mjs';
import { abortCodeOf, canopen, canTransferBlocks, deviceOn, objectOf, types, useServer, valueOf } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const [host, port, busName, nodeText, ...steps] = argumentsOrUsage(5, 'sdo_client_peer.mjs HOST PORT BUS NODE STEP...');
const node = Number(nodeText);
const own = 126;

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, own);
  useServer(device, node);
  device.start();
  const transfer = { deviceId: node, timeout: patience };

  const upload = (object, type, blockTransfer) =>
    device.sdo.upload({ ...transfer, ...objectOf(object), dataType: types[type], blockTransfer });
  const download = (object, type, value, blockTransfer) =>
    device.sdo.download({ ...transfer, ...objectOf(object), data: valueOf(type, value), dataType: types[type], blockTransfer });
  const hexCode = (code) => (code === null ? 'no abort' : code.toString(16).toUpperCase().padStart(8, '0'));
  const expectAbort = async (what, started, code) => check(what, hexCode(await abortCodeOf(started)), code.toUpperCase().padStart(8, '0'));
  // Bytes that are neither text nor the same in any two segments.
  const pattern = (size) => Buffer.from(Array.from({ length: Number(size) }, (_, i) => (i * 7 + (i >> 8)) & 0xFF)).toString('hex');

  const actions = {
    async upload(object, type, value) {
      const read = await upload(object, type);
      if (value === undefined) check(`upload ${object} (${JSON.stringify(read)}) is answered`, read !== undefined, true);
      else check(`upload ${object}`, read, valueOf(type, value));
    },
    async download(object, type, value) {
      await download(object, type, value);
      check(`download ${object} read back`, await upload(object, type), valueOf(type, value));
    },
    'download-size': (object, size) => actions.download(object, 'domain', pattern(size)),
    async 'block-upload'(object, type, value) {
      const read = await upload(object, type, true);
      if (value === undefined) check(`block upload ${object} is like the segmented one`, read, await upload(object, type));
      else check(`block upload ${object}`, read, valueOf(type, value));
    },
    async 'block-download'(object, type, value) {
      await download(object, type, value, true);
      check(`block download ${object} read back by segments`, await upload(object, type), valueOf(type, value));
      check(`block download ${object} read back by blocks`, await upload(object, type, true), valueOf(type, value));
    },
    'block-download-size': (object, size) => actions['block-download'](object, 'domain', pattern(size)),
    async eds(file, object) {
      const { index, subIndex } = objectOf(object);
      const eds = canopen.Eds.fromFile(file);
      const entry = eds.getEntry(index).subNumber > 0 ? eds.getSubEntry(index, subIndex) : eds.getEntry(index);
      const read = await device.sdo.upload({ ...transfer, index, subIndex, dataType: entry.dataType });
      check(`EDS file: ${object}`, typeof read === 'number' ? Number(entry.defaultValue) : entry.defaultValue, read);
    },
    'abort-upload': (object, code) => expectAbort(`upload ${object} is aborted`, upload(object, 'domain'), code),
    'abort-download': (object, type, value, code) =>
      expectAbort(`download ${object} is aborted`, download(object, type, value), code),
    'abort-block-upload': (object, code) => expectAbort(`block upload ${object} is aborted`, upload(object, 'domain', true), code),
    'abort-block-download': (object, type, value, code) =>
      expectAbort(`block download ${object} is aborted`, download(object, type, value, true), code),
  };
  for (const step of steps) {
    const [action, ...fields] = step.split(',');
    if (!(action in actions)) throw new Error(`${step}: a step is one of ${Object.keys(actions).join(' ')}`);
    if (action.includes('block') && !canTransferBlocks) {
      console.log(`skip  ${step}: node-crc is not built (npm rebuild node-crc)`);
      continue;
    }
    await actions[action](...fields);
  }
  await bus.close();
});
