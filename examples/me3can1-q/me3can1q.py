"""The ME3CAN1-Q over MC protocol: what the function blocks of its manual's chapter 7 do, as Python functions.

    module = Me3Can1Q(Plc("127.0.0.1", 5007), head=0x00)
    module.sdo_read(2, 0x1000)                             # 4 bytes of node 2's device type
    module.sdo_write(2, 0x1017, 0, u16(500))               # its heartbeat
    module.nmt_request(ALL_NODES, START)

| function block          | here                                            |
|-------------------------|-------------------------------------------------|
| CANopenInit             | initialize()                                    |
| NMTMasterSettings       | set_master()                                    |
| NMTSlaveSettings        | assign_slave()                                  |
| HeartbeatProducerSetup  | produce_heartbeat()                             |
| HeartbeatConsumerSetup  | consume_heartbeat()                             |
| PDOSetup                | set_up_rpdo(), set_up_tpdo()                    |
| PDORead, PDOWrite       | read_pdo(), write_pdo(), exchange()             |
| SDORead, SDOWrite       | sdo_read(), sdo_write()                         |
| NMTRequestWrite         | nmt_request()                                   |
| NMTStatus               | nmt_states()                                    |
| HeartbeatStatus         | error_control(), clear_error_control()          |

Numbers in parentheses are sections of the ME3CAN1-Q User's Manual. The package canopus_plc (docs/python.md) speaks the MC protocol.
"""
import pathlib
import struct
import sys

try:
    from canopus_plc import Plc
except ImportError:  # it is not installed: that of this source tree
    sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
    from canopus_plc import Plc

OWN_NODE = 0      # node number of the module's own object dictionary (5.1)
ALL_NODES = 0x80  # sub-index of 1F82H and 1F83H that means all nodes (4.8.8)

# Requests to 1F82H (4.8.8)
STOP, START, RESET_NODE, RESET_COMMUNICATION, PRE_OPERATIONAL = 4, 5, 6, 7, 127
# States in G601 to G727 (3.5.16)
STATES = {0: "unknown", 1: "missing", 4: "stopped", 5: "operational", 7: "reset communication", 127: "pre-operational"}

# 1F81H, configuration of a slave (4.8.6)
ASSIGNED, BOOT_SLAVE, MANDATORY, KEEP_ALIVE = 1, 4, 8, 16

# Bits of G29 (3.5.7)
ERROR_BITS = {1: "hardware error", 3: "bus-off", 4: "flash error", 5: "write while online or initializing",
              6: "invalid value written", 8: "queue overflow", 14: "error passive", 15: "message slot error"}

EVENT_DRIVEN = 0xFE  # transmission type of a PDO (4.6.5)


def u8(value):
    return struct.pack("<B", value)


def u16(value):
    return struct.pack("<H", value)


def u32(value):
    return struct.pack("<I", value)


def number(data):
    """The unsigned number that an object's bytes are."""
    return int.from_bytes(data, "little")


class ModuleError(Exception):
    """The module reports an error in G29, or a signal does not come."""


class CommandError(Exception):
    """The command interface refused a command; `result` is G1000 to G1004 (5.4)."""

    def __init__(self, what, result):
        self.result = result
        self.abort_code = result[4] << 16 | result[3] if result[1] == 0x0003 else None
        reasons = {0x0064: "unknown command", 0x0F0F: "not possible in the module's state", 0xB0FF: "bus-off",
                   0xFFFF: "written to while it was busy"}
        if self.abort_code is not None:
            reason = f"SDO abort {self.abort_code:08X}H"
        else:
            reason = reasons.get(result[1], f"error class {result[1]:04X}H")
        super().__init__(f"{what}: G1000 = {result[0]:04X}H: {reason}")


class Me3Can1Q:
    def __init__(self, plc, head=0x00):
        """`plc` is a Plc; `head` the module's head I/O number, a multiple of 10H."""
        self.plc, self.head, self.memory = plc, head, plc.g[head >> 4]

    # --- words and signals

    def g(self, address):
        return self.memory[address]

    def words(self, address, count):
        return self.memory[address:address + count]

    def set_g(self, address, *values):
        self.memory[address:address + len(values)] = values

    def x(self, signal):
        return self.plc.x[self.head + signal]

    def y(self, signal, on):
        self.plc.y[self.head + signal] = on

    def wait(self, condition, what, timeout):
        try:
            self.plc.wait(condition, timeout)
        except TimeoutError:
            raise ModuleError(f"{what} did not come within {timeout} s; G25 = {self.g(25):04X}H, "
                              f"G29 = {self.g(29):04X}H") from None

    def handshake(self, signal, timeout):
        """Request Y on, wait for X, request off (3.3.2)."""
        self.y(signal, True)
        try:
            self.wait(lambda: self.x(signal), f"X{signal:02X}", timeout)
        finally:
            self.y(signal, False)

    def check(self):
        """Raises ModuleError with the meaning of G29, and the address in G39 or G40 (8.1.2)."""
        bits = self.g(29)
        if bits:
            names = [name for bit, name in ERROR_BITS.items() if bits >> bit & 1]
            where, refused = self.words(39, 2)
            place = f", G{where}" if where else f", G{refused}" if refused else ""
            raise ModuleError(f"G29 = {bits:04X}H: {', '.join(names)}{place}")

    # --- start-up (6.5.1)

    def wait_ready(self, timeout=20):
        """X00 on and initialization over: before that nothing may be written."""
        self.wait(lambda: self.x(0x00) and not self.g(25) & 0x80, "X00", timeout)

    def save(self):
        """Stores the buffer memory settings in the flash memory: G22 = 1, Y1F (3.5.3)."""
        self.set_g(22, 1)
        self.handshake(0x1F, 10)
        self.check()

    def restart(self):
        """Y02; about 6 s (3.3.2). New mode, baud rate, node-ID and master role come into force."""
        self.handshake(0x02, 30)
        self.wait_ready()

    def initialize(self, node, kbps, mode=405):
        """Function mode, then baud rate and node-ID, each saved and restarted with: steps 1 to 7."""
        self.wait_ready()
        self.set_g(21, mode)
        self.save()
        self.restart()
        self.set_g(24, kbps)
        self.set_g(27, node)
        self.save()
        self.restart()
        self.check()

    def set_master(self, start_up=1):
        """1F80H of the module itself: bit 0 NMT master (4.8.5). In force after store_objects() and restart()."""
        self.sdo_write(OWN_NODE, 0x1F80, 0, u32(start_up))

    def assign_slave(self, node, device_type=0, mandatory=True, guard_time=0, retry_factor=0):
        """1F81H: the node is a slave that is booted; 1F84H: its expected device type, 0 = any (4.8.4, 4.8.6)."""
        configuration = ASSIGNED | BOOT_SLAVE | (MANDATORY if mandatory else 0)
        self.sdo_write(OWN_NODE, 0x1F81, node, u32(guard_time << 16 | retry_factor << 8 | configuration))
        self.sdo_write(OWN_NODE, 0x1F84, node, u32(device_type))

    def store_objects(self):
        """1010:01 = "save": the object dictionary goes to the flash memory (4.6.10)."""
        self.sdo_write(OWN_NODE, 0x1010, 1, b"save")

    # --- SDO, through the command interface (5.1)

    def command(self, words, what, timeout=10):
        """Writes G1000 on, executes by Y17; the words of the result. CommandError when it failed."""
        self.set_g(1000, *words)
        self.handshake(0x17, timeout)
        result = self.words(1000, 67)
        if result[0] in (0x000F, 0x000C):
            raise CommandError(what, result[:5])
        return result

    def sdo_read(self, node, index, sub=0):
        """The object's bytes, up to 124."""
        result = self.command([0x0004, node, index, sub], f"SDO read of node {node}, {index:04X}:{sub:02X}")
        return struct.pack("<62H", *result[5:67])[:result[4]]

    def sdo_write(self, node, index, sub, data):
        """`data`: 1 to 124 bytes; u8(), u16() and u32() make them of numbers."""
        padded = data + bytes(len(data) % 2)
        words = struct.unpack(f"<{len(padded) // 2}H", padded)
        self.command([0x0002, node, index, sub, len(data), *words],
                     f"SDO write to node {node}, {index:04X}:{sub:02X}")

    # --- network management

    def nmt_request(self, node, request):
        """START, STOP, ... to a node or ALL_NODES, through 1F82H; the module must be the NMT master (4.8.8)."""
        self.sdo_write(OWN_NODE, 0x1F82, node, u8(request))

    def nmt_states(self, first=1, count=127):
        """{node: state} from G601 to G727 (3.5.16)."""
        return {first + i: word for i, word in enumerate(self.words(600 + first, count))}

    def produce_heartbeat(self, node, milliseconds):
        """1017H of a node, or of the module itself (OWN_NODE). The node forgets it at a reset unless it stores it."""
        self.sdo_write(node, 0x1017, 0, u16(milliseconds))

    def consume_heartbeat(self, entry, node, milliseconds):
        """1016H:entry of the module: node's heartbeat must come within this time (4.6.8)."""
        self.sdo_write(OWN_NODE, 0x1016, entry, u32(node << 16 | milliseconds))

    def error_control(self, first=1, count=127):
        """{node: bits} from G401 to G527 (3.5.15): 0 guarding runs, 1 heartbeat heard, 2 to 7 failures."""
        return {first + i: word for i, word in enumerate(self.words(400 + first, count))}

    def clear_error_control(self, node=0):
        """Clears the failures of one node, or (0) of all: G400 and Y10 (3.5.14)."""
        self.set_g(400, node)
        self.y(0x10, True)
        self.y(0x10, False)

    # --- PDOs (4.6.5)

    def set_up_rpdo(self, number, can_id, mapping, transmission_type=EVENT_DRIVEN):
        """PDO `number` (1 to 256) that the module receives. `mapping`: (index, sub-index, bits) of up to 8 objects."""
        self._set_up_pdo(0x1400 + number - 1, 0x1600 + number - 1, 0x0000_0000, can_id, mapping, transmission_type)

    def set_up_tpdo(self, number, can_id, mapping, transmission_type=EVENT_DRIVEN):
        """PDO that the module sends. Bit 30 of a TPDO's COB-ID is always 1."""
        self._set_up_pdo(0x1800 + number - 1, 0x1A00 + number - 1, 0x4000_0000, can_id, mapping, transmission_type)

    def _set_up_pdo(self, communication, mapping_object, bits, can_id, mapping, transmission_type):
        self.sdo_write(OWN_NODE, communication, 1, u32(0x8000_0000 | bits | can_id))  # not valid while it changes
        self.sdo_write(OWN_NODE, communication, 2, u8(transmission_type))
        self.sdo_write(OWN_NODE, mapping_object, 0, u8(0))
        for entry, (index, sub, length) in enumerate(mapping, start=1):
            self.sdo_write(OWN_NODE, mapping_object, entry, u32(index << 16 | sub << 8 | length))
        self.sdo_write(OWN_NODE, mapping_object, 0, u8(len(mapping)))
        self.sdo_write(OWN_NODE, communication, 1, u32(bits | can_id))

    def exchange(self):
        """Y01: what was written goes out, what was received comes in (3.3.2)."""
        self.handshake(0x01, 2)

    def read_pdo(self, number):
        """The four words of RPDO `number` with its default mapping: G10000 on, of the last exchange."""
        return self.words(10000 + 4 * (number - 1), 4)

    def write_pdo(self, number, *words):
        """Words of TPDO `number`; sent with the next exchange if they changed."""
        self.set_g(13000 + 4 * (number - 1), *words)


def receive_word(address, count=1):
    """Mapping entries for words G10000 to G11023: unsigned 16-bit objects A580H on (3.5.19)."""
    return [_variable(0xA580, address - 10000 + i) for i in range(count)]


def transmit_word(address, count=1):
    """The same for G13000 to G14023: A100H on."""
    return [_variable(0xA100, address - 13000 + i) for i in range(count)]


def _variable(first_index, position):
    if not 0 <= position < 1024:
        raise ValueError("expected words G10000 to G11023, or G13000 to G14023")
    return first_index + position // 254, position % 254 + 1, 16
