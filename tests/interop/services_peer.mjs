#!/usr/bin/env node
// The other services of a stack that is not ours, over socketcand: heartbeat, EMCY, SYNC, TIME and PDO, as consumer and as
// producer. Steps are done one after the other; a wait is given 60 s:
//   nmt,COMMAND,NODE               start stop preop reset reset-communication; NODE 0 = all
//   wait-state,NODE,STATE          the stack's heartbeat consumer sees STATE (hexadecimal: 4 5 7F)
//   wait-loss,NODE,MILLISECONDS    its heartbeat consumer, set to this time, loses NODE
//   wait-emcy,NODE[,CODE[,REGISTER]]   an emergency of NODE at 080H + NODE (hexadecimal)
//   emcy,CODE[,HEX]                sends one as node 126, with up to 5 bytes of its own
//   wait-sync,COUNT[,MILLISECONDS[,TOLERANCE]]   so many SYNCs, at this mean period
//   sync,COUNT,MILLISECONDS        produces them (1005H = 40000080H, 1006H)
//   sync-on,MILLISECONDS           produces them from now on, until sync-off
//   wait-pdo,COBID,TYPES[,VALUES]  a PDO whose objects (u8+u16+…) have values (v+v+…); _ = any
//   pdo,COBID,TYPES,VALUES         sends one
//   ready                          says so: what the next step waits for may happen from now on
//   stay                           until the standard input ends
//   pause,MILLISECONDS
import { argumentsOrUsage, check, patience, run, standardInputEnded } from './interop_report.mjs';
import { canopen, deviceOn, types, valueOf } from './npm_canopen.mjs';
import { SocketcandBus } from './socketcand_bus.mjs';

const [host, port, busName, ...steps] = argumentsOrUsage(4, 'services_peer.mjs HOST PORT BUS STEP...');
const own = 126;
const hex = (number, digits) => number.toString(16).toUpperCase().padStart(digits, '0');
const pause = (milliseconds) => new Promise((resolve) => { setTimeout(resolve, milliseconds); });

/** The first result other than undefined that `listen` gives for an event, or undefined when patience is over. */
function waitFor(emitter, event, listen) {
  return new Promise((resolve) => {
    const done = (result) => {
      clearTimeout(timer);
      emitter.off(event, handler);
      resolve(result);
    };
    const handler = (...words) => {
      const result = listen(...words);
      if (result !== undefined) done(result);
    };
    const timer = setTimeout(() => done(undefined), patience);
    emitter.on(event, handler);
  });
}

run(async () => {
  const bus = await SocketcandBus.connect(host, port, busName);
  const device = deviceOn(bus, own);
  const { eds } = device;
  eds.setEmcyCobId(0x80 + own);
  eds.setSyncCobId(0x80);
  device.start();
  device.nmt.setState(canopen.NmtState.OPERATIONAL);  // PDOs flow only there

  const consumers = new Map();
  const consume = (node, milliseconds) => {
    if (consumers.get(node) === milliseconds) return;
    if (consumers.has(node)) eds.removeHeartbeatConsumer(node);
    eds.addHeartbeatConsumer(node, milliseconds);
    consumers.set(node, milliseconds);
  };
  let nextIndex = 0x3000;
  // The objects mapped to each PDO; a PDO stays for good, because the stack fails when one is removed.
  const mapped = new Map();
  const objectsFor = (id, list, addPdo) => {
    if (mapped.has(id)) return mapped.get(id);
    const dataObjects = list.split('+').map((type) => {
      if (!(type in types)) throw new Error(`${type}: a type is one of ${Object.keys(types).join(' ')}`);
      return eds.addEntry(nextIndex, { parameterName: `Mapped ${nextIndex++}`, dataType: types[type] });
    });
    addPdo({ cobId: id, transmissionType: 254, dataObjects });
    mapped.set(id, dataObjects);
    return dataObjects;
  };
  const valuesOf = (list, values) => values.split('+').map((text, i) => (text === '_' ? undefined : valueOf(list.split('+')[i], text)));

  const actions = {
    async nmt(command, node) {
      const services = { start: 'startNode', stop: 'stopNode', preop: 'enterPreOperational', reset: 'resetNode',
        'reset-communication': 'resetCommunication' };
      device.nmt[services[command]](Number(node));
    },
    async 'wait-state'(node, state) {
      consume(Number(node), consumers.get(Number(node)) ?? 5000);
      const wanted = parseInt(state, 16);
      const seen = device.nmt.consumers[node]?.state === wanted ? wanted
        : await waitFor(device.nmt, 'heartbeat', (event) =>
          (event.deviceId === Number(node) && event.state === wanted ? event.state : undefined));
      check(`heartbeat of node ${node}`, seen === undefined ? 'none' : hex(seen, 2), hex(wanted, 2));
    },
    async 'wait-loss'(node, milliseconds) {
      consume(Number(node), Number(milliseconds));
      const lost = await waitFor(device.nmt, 'timeout', (id) => (id === Number(node) ? id : undefined));
      check('heartbeat consumer loses node', lost, Number(node));
    },
    async 'wait-emcy'(node, code, register) {
      const cobId = 0x80 + Number(node);
      if (!eds.getEmcyConsumers().some((consumer) => (consumer.cobId ?? consumer) === cobId)) eds.addEmcyConsumer(cobId);
      const em = await waitFor(device.emcy, 'emergency', (event) => (event.cobId === cobId ? event.em : undefined));
      check(`emergency of node ${node}`, em !== undefined, true);
      if (em && code) check('its error code', hex(em.code, 4), code.toUpperCase().padStart(4, '0'));
      if (em && register) check('its error register', hex(em.register, 2), register.toUpperCase().padStart(2, '0'));
    },
    async emcy(code, info) {
      device.emcy.write(parseInt(code, 16), Buffer.from(info ?? '', 'hex'));
      check('emergency sent', code, code);
    },
    async 'wait-sync'(count, milliseconds, tolerance = 10) {
      const times = [];
      const last = await waitFor(bus, 'frame', ({ id, time }) => {
        if (id === 0x80) times.push(time);
        return times.length > Number(count) ? time : undefined;
      });
      check(`${count} periods of SYNC`, last !== undefined, true);
      if (last === undefined || !milliseconds) return;
      const mean = ((times.at(-1) - times[0]) * 1000) / (times.length - 1);
      check(`their mean period ${mean.toFixed(3)} ms is within ${tolerance} % of ${milliseconds} ms`,
        Math.abs(mean - milliseconds) <= (milliseconds * tolerance) / 100, true);
    },
    async sync(count, milliseconds) {
      eds.setSyncCyclePeriod(Number(milliseconds) * 1000);
      eds.setSyncGenerationEnable(true);
      await pause(count * milliseconds + milliseconds / 2);
      eds.setSyncGenerationEnable(false);
      check('SYNC produced', Number(count), Number(count));
    },
    async 'sync-on'(milliseconds) {
      eds.setSyncCyclePeriod(Number(milliseconds) * 1000);
      eds.setSyncGenerationEnable(true);
    },
    async 'sync-off'() { eds.setSyncGenerationEnable(false); },
    async 'wait-pdo'(cobId, list, values) {
      const id = parseInt(cobId, 16);
      const dataObjects = objectsFor(id, list, (pdo) => eds.addReceivePdo(pdo));
      const expected = values === undefined ? [] : valuesOf(list, values);
      const holds = () => expected.every((value, i) => value === undefined || dataObjects[i].value === value);
      const seen = await waitFor(device.pdo, 'pdo', (pdo) => (pdo.cobId === id && holds() ? true : undefined));
      check(`PDO ${cobId}H (${dataObjects.map((object) => object.value).join(' ')}) has ${values ?? 'changed'}`, seen, true);
    },
    async pdo(cobId, list, values) {
      const id = parseInt(cobId, 16);
      const dataObjects = objectsFor(id, list, (pdo) => eds.addTransmitPdo(pdo));
      valuesOf(list, values).forEach((value, i) => { dataObjects[i].value = value; });
      device.pdo.write(id);
      check(`PDO ${cobId}H sent with`, values, values);
    },
    async ready() { console.log('ready'); },
    stay: standardInputEnded,
    pause: (milliseconds) => pause(Number(milliseconds)),
  };
  for (const step of steps) {
    const [action, ...fields] = step.split(',');
    if (!(action in actions)) throw new Error(`${step}: a step is one of ${Object.keys(actions).join(' ')}`);
    await actions[action](...fields);
  }
  device.stop();
  await bus.close();
});
