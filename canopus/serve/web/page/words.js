// Events as sentences, how well a node is, and what it is known by.

const where = (event) => {
  const node = event.node >= 1 && event.node <= 127 ? ` node ${event.node}` : "";
  return `${event.bus ?? ""}${node}${event.name ? ` (${event.name})` : ""}`;
};

const sentences = {
  listen: (e) => `${e.protocol}${e.of ? ` of ${e.of}` : ""} on ${e.address}`,
  boot: (e) => `${where(e)}: boot-up`,
  nmt: (e) => `${where(e)}: ${e.state}`,
  "boot slave": (e) => `${where(e)}: ${e.reason || e.step}`,
  lss: (e) => `${where(e)}: LSS, ${e.bit_rate / 1000} kbit/s`,
  emcy: (e) => `${where(e)}: EMCY ${e.code}H, error register ${e.register}, data ${e.data}`,
  unacknowledged: (e) => `${where(e)}: nobody acknowledges`,
  "bus error": (e) => `${e.bus}: ${e.error} error in ${e.field}, bit ${e.bit}`,
  controller: (e) => `${where(e)}: ${e.state}, TEC ${e.tec}, REC ${e.rec}`,
  signal: (e) => `${e.plc}: ${e.signal} ${e.on ? "ON" : "OFF"}`,
  buffer: (e) => `${e.plc}: ${e.module}\\G${e.address} = ${e.value} (by the ${e.by})`,
  forced: (e) => `${where(e)}: ${e.object} (${e.parameter}) forced to ${e.value}`,
  released: (e) => `${where(e)}: ${e.object} (${e.parameter}) released, ${e.value}`,
  warning: (e) => `${e.source}: ${e.message}`,
  error: (e) => `${e.source}: ${e.message}`,
  "module error": (e) => `${e.module}: error ${e.code}H (${e.class}): ${e.overview}`,
  "module event": (e) => `${e.module}: event ${e.code}: ${e.overview}`,
  lost: (e) => `${e.lines} events were lost here`,
  audit: (e) => `${e.user || e.address}, ${e.role}: ${e.do}: ${e.code === 0 ? "done" : `refused or failed (${e.code})`}`,
};

export function sentence(event) {
  const words = sentences[event.event];
  if (words) return words(event);
  const { t, event: kind, ...rest } = event;
  return `${kind}: ${JSON.stringify(rest)}`;
}

/// "line1  183  pdo  3 (encoder)  TPDO  Position value = 7"
export function message_line(message) {
  const node = message.node ? `${message.node}${message.name ? ` (${message.name})` : ""}` : "";
  const pdo = message.pdo ? String(message.pdo) : "";
  return `${message.channel ?? ""}  ${message.id.padStart(3)}  ${message.service.padEnd(13)}  ${node.padEnd(18)}  ` +
         `${message.kind}${pdo}  ${message.text}`;
}

export function mood_of(node, troubles) {
  if (node.controller === "bus-off" || troubles.length > 0) return "error";
  if (node.state === "off") return "off";
  if (node.controller === "error passive") return "warning";
  if (!node.in_operation) return "warning";
  return "good";
}

/// What a node is known by. `twin`: how many of the same bus, node-ID and name stand before it; devices without a node-ID often have one name.
export const key_of = (node) => `${node.bus}\u0000${node.node}\u0000${node.name}\u0000${node.twin ?? 0}`;

export function tell_twins_apart(nodes) {
  const times = new Map();
  for (const node of nodes) {
    node.twin = 0;
    const key = key_of(node);
    node.twin = times.get(key) ?? 0;
    times.set(key, node.twin + 1);
  }
}
