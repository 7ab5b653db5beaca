// The npm package `canopen`, a CANopen stack in JavaScript, put on a bus.
import { createRequire } from 'node:module';

const require = createRequire(import.meta.url);

/** False: the native part of node-crc, which SDO block transfers need, is not built (npm rebuild node-crc). */
export let canTransferBlocks = true;
try {
  require('node-crc');
} catch {
  canTransferBlocks = false;
  const filename = require.resolve('node-crc');
  const crc = () => { throw new Error('node-crc is not built'); };
  require.cache[filename] = { id: filename, filename, loaded: true, exports: { crc } };
}

export const canopen = require('canopen');
const { DataType, Device, SdoError } = canopen;

/** A device of the stack as node `id`, connected with the bus. */
export function deviceOn(bus, id) {
  const device = new Device({ id });
  device.on('message', (message) => bus.send(message));
  bus.on('frame', (frame) => { if (!frame.extended) device.receive(frame); });
  return device;
}

/** Makes the SDO server of `node`, at its default COB-IDs, known to the device's SDO client. */
export function useServer(device, node) {
  device.eds.addSdoClientParameter(node, 0x600 + node, 0x580 + node);
}

export const types = {
  bool: DataType.BOOLEAN,
  i8: DataType.INTEGER8, i16: DataType.INTEGER16, i32: DataType.INTEGER32,
  u8: DataType.UNSIGNED8, u16: DataType.UNSIGNED16, u32: DataType.UNSIGNED32,
  f32: DataType.REAL32, text: DataType.VISIBLE_STRING, bytes: DataType.OCTET_STRING, domain: DataType.DOMAIN,
};

/** The value written in text, of the type named: numbers as JavaScript reads them, bytes in hexadecimal digits. */
export function valueOf(type, text) {
  if (!(type in types)) throw new Error(`${type}: a type is one of ${Object.keys(types).join(' ')}`);
  if (type === 'text') return text;
  if (type === 'bytes' || type === 'domain') return Buffer.from(text, 'hex');
  if (type === 'bool') return text === '1' || text === 'true';
  const number = Number(text);
  if (text === '' || Number.isNaN(number)) throw new Error(`${text}: expected a number`);
  return number;
}

/** `1018:1` → { index, subIndex }, both hexadecimal. */
export function objectOf(text) {
  const match = /^([0-9A-Fa-f]{4})(?::([0-9A-Fa-f]{1,2}))?$/.exec(text);
  if (!match) throw new Error(`${text}: expected an object as INDEX:SUBINDEX in hexadecimal digits`);
  return { index: parseInt(match[1], 16), subIndex: parseInt(match[2] ?? '0', 16) };
}

/** Awaits an SDO transfer that must be aborted; its abort code, or null when it went through. */
export async function abortCodeOf(transfer) {
  try {
    await transfer;
    return null;
  } catch (error) {
    if (error instanceof SdoError) return error.code;
    throw error;
  }
}
