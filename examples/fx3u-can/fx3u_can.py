"""The FX3U-CAN over MC protocol: what the function blocks of its manual's chapter 13 do, as Python functions.

    module = Fx3uCan(Plc("127.0.0.1", 5007), unit=0)
    module.sdo_read(3, 0x1000)                             # 4 bytes of node 3's device type
    module.sdo_write(3, 0x6423, 0, u8(1))
    module.nmt_request(ALL_NODES, START)

| function block          | here                                            |
|-------------------------|-------------------------------------------------|
| CANopenInit             | initialize()                                    |
| NMTMasterSettings       | set_master()                                    |
| NMTSlaveSettings        | assign_slaves()                                 |
| HeartbeatProducerSetup  | produce_heartbeats()                            |
| HeartbeatConsumerSetup  | consume_heartbeats()                            |
| PDOSetup                | set_up_rpdo(), set_up_tpdo()                    |
| PDORead, PDOWrite       | read_pdo(), write_pdo(), exchange()             |
| SDORead, SDOWrite       | sdo_read(), sdo_write()                         |
| NMTRequestWrite         | nmt_request()                                   |
| NMTStatus               | nmt_states()                                    |
| HeartbeatStatus         | error_control(), clear_errors()                 |

The module has no X and Y: a program asks by bits of its buffer memory, and the bits go back when it is done. Numbers in
parentheses are sections of the FX3U-CAN User's Manual. The package canopus_plc (docs/python.md) speaks the MC protocol.
"""
import pathlib
import struct
import sys

try:
    from canopus_plc import Plc
except ImportError:  # it is not installed: that of this source tree
    sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
    from canopus_plc import Plc

OWN_NODE = 0      # node number of the module's own object dictionary (10.2)
ALL_NODES = 0x80  # sub-index of 1F82H and 1F83H that means all nodes (5.8.9)
END = 0xFFFF      # of a list of parameters (10.3, 10.4)

# Requests to 1F82H (5.8.9)
STOP, START, RESET_NODE, RESET_COMMUNICATION, PRE_OPERATIONAL = 4, 5, 6, 7, 127
# States in #601 to #727 (6.22)
STATES = {0: "unknown", 1: "missing", 4: "stopped", 5: "operational", 7: "reset communication", 127: "pre-operational"}

# 1F81H, configuration of a slave (5.8.7)
ASSIGNED, BOOT_SLAVE, MANDATORY, KEEP_ALIVE = 1, 4, 8, 16

# Bits of #29 (14.2)
ERROR_BITS = {1: "hardware error", 3: "bus-off", 4: "flash error", 5: "write while online or initializing",
              6: "invalid value written", 7: "FROM/TO watchdog", 8: "queue overflow", 10: "error control of a node",
              11: "invalid baud rate", 12: "invalid node address", 13: "emergency message of a slave", 14: "error passive",
              15: "message slot error"}

EVENT_DRIVEN = 0xFE  # transmission type of a PDO (5.6.5)


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
    """The module reports an error in #29, or an answer does not come."""


class CommandError(Exception):
    """The command interface refused a command; `result` is #1000 to #1066 (10.9)."""

    def __init__(self, what, result):
        self.result = result
        self.abort_code = result[4] << 16 | result[3] if result[:2] == [0x000F, 0x0003] else None
        reasons = {0x0064: "unknown command", 0x0F0F: "not possible in the module's state", 0xB0FF: "bus-off",
                   0xFFFF: "written to while it was busy"}
        if self.abort_code is not None:
            reason = f"SDO abort {self.abort_code:08X}H"
        elif result[0] == 0x000F:
            reason = reasons.get(result[1], f"error class {result[1]:04X}H")
        else:
            reason = ", ".join(f"#{1000 + i} = {word:04X}H" for i, word in enumerate(result) if i and word)
        super().__init__(f"{what}: #1000 = {result[0]:04X}H: {reason}")


class Fx3uCan:
    def __init__(self, plc, unit=0):
        """`plc` is a Plc; `unit` the number of the special function block, 0 for the first one (6.2)."""
        self.plc, self.memory = plc, plc.g[unit]

    # --- words

    def g(self, address):
        return self.memory[address]

    def words(self, address, count):
        return self.memory[address:address + count]

    def set_g(self, address, *values):
        self.memory[address:address + len(values)] = values

    def wait(self, condition, what, timeout):
        try:
            self.plc.wait(condition, timeout)
        except TimeoutError:
            raise ModuleError(f"{what} did not come within {timeout} s; #25 = {self.g(25):04X}H, "
                              f"#29 = {self.g(29):04X}H") from None

    def request(self, address, bits, timeout):
        """Write bits as 1, and wait until they are 0 (6.4, 6.6)."""
        self.set_g(address, bits)
        self.wait(lambda: not self.g(address) & bits, f"#{address} = 0", timeout)

    def check(self):
        """Raises ModuleError with the meaning of #29, and the number in #39 or #40 (14.2)."""
        bits = self.g(29)
        if bits:
            names = [name for bit, name in ERROR_BITS.items() if bits >> bit & 1]
            where, refused = self.words(39, 2)
            place = f", #{where}" if where else f", #{refused}" if refused else ""
            raise ModuleError(f"#29 = {bits:04X}H: {', '.join(names)}{place}")

    # --- start-up (12.1)

    def wait_ready(self, timeout=20):
        """#25 bit 7 is 0: before that only #25 and #29 may be read, and nothing written (6.8)."""
        self.wait(lambda: not self.g(25) & 0x80, "the end of the initialization", timeout)

    def save(self):
        """Stores the words that are settings in the flash memory (6.6)."""
        self.request(22, 1, 10)
        self.check()

    def restart(self):
        """New mode, baud rate, node-ID and master role come into force (6.8)."""
        self.set_g(25, 1)
        self.wait_ready(30)

    def initialize(self, node, kbps, mode=405, watchdog=0):
        """`watchdog`: FROM/TO watchdog in 10 ms, 0 = off (6.9)."""
        self.wait_ready()
        self.set_g(21, mode)
        self.set_g(24, kbps)
        self.set_g(26, watchdog)
        if mode == 405:
            self.set_g(27, node)
        self.save()
        self.restart()
        self.check()

    def set_master(self, start_up=1):
        """1F80H of the module itself: bit 0 NMT master (5.8.5). In force after store_objects() and restart()."""
        self.sdo_write(OWN_NODE, 0x1F80, 0, u32(start_up))

    def assign_slaves(self, *slaves):
        """(node, configuration, guard time in ms, retry factor) of up to 16 slaves: 1F81H, and their 100CH and 100DH (10.4)."""
        self.set_up(0x8400, [word for slave in slaves for word in slave] + [END], "slave settings")

    def store_objects(self, *nodes):
        """1010:01 = "save" of these nodes, or of the module alone (10.6)."""
        self.set_up(0x6000, [*(nodes or [OWN_NODE]), END], "store")

    # --- command interface (10)

    def command(self, code, parameters, what, timeout=10):
        """Parameters to #1001 on, then the code to #1000, which executes it; the words of the result."""
        self.set_g(1001, *parameters)
        self.set_g(1000, code)
        self.wait(lambda: self.g(1000) != 0xFFFF, f"the end of {what}", timeout)
        return self.words(1000, 67)

    def sdo_read(self, node, index, sub=0):
        """The object's bytes, up to 124."""
        what = f"SDO read of node {node}, {index:04X}:{sub:02X}"
        result = self.command(0x0004, [node, index, sub], what)
        if result[0] != 0x0005:
            raise CommandError(what, result)
        return struct.pack("<62H", *result[5:67])[:result[4]]

    def sdo_write(self, node, index, sub, data):
        """`data`: 1 to 124 bytes; u8(), u16() and u32() make them of numbers."""
        padded = data + bytes(len(data) % 2)
        words = struct.unpack(f"<{len(padded) // 2}H", padded)
        what = f"SDO write to node {node}, {index:04X}:{sub:02X}"
        result = self.command(0x0002, [node, index, sub, len(data), *words], what)
        if result[0] != 0x0003:
            raise CommandError(what, result)

    def set_up(self, code, parameters, what):
        """A command for many nodes: its result is the code + 1, else its parameters' words say what went wrong (10.3 to 10.7)."""
        result = self.command(code, parameters, what, 60)
        if result[0] != code + 1:
            raise CommandError(what, result)

    def map_pdos(self, code):
        """8200H: mode A; 8900H: mode 0 (7.2.3, 7.2.4)."""
        result = self.command(code, [], "PDO mapping")
        if result[0] != code + 1:
            raise CommandError("PDO mapping", result)

    def bind_pdos(self, *pairs):
        """Mode B: pairs of source (node << 8 | TPDO) and destination (node << 8 | RPDO) (7.2.5)."""
        self.set_up(0x8300, [word for pair in pairs for word in pair] + [END], "PDO binding")

    # --- network management

    def nmt_request(self, node, request):
        """START, STOP, ... to a node or ALL_NODES, through 1F82H; the module must be the NMT master (5.8.9)."""
        self.sdo_write(OWN_NODE, 0x1F82, node, u8(request))

    def nmt_states(self, first=1, count=127):
        """{node: state} from #601 to #727 (6.22)."""
        return {first + i: word for i, word in enumerate(self.words(600 + first, count))}

    def produce_heartbeats(self, *nodes):
        """(node, ms): 1017H of up to 33 nodes; OWN_NODE is the module itself (10.3.2)."""
        self.set_up(0x7410, [word for node in nodes for word in node] + [END], "heartbeat producing")

    def consume_heartbeats(self, *nodes, consumer=OWN_NODE):
        """(node, ms): 1016:01 on of the consumer (10.3.1)."""
        self.set_up(0x7400, [consumer, *[word for node in nodes for word in node], END], "heartbeat consuming")

    def error_control(self):
        """{node: bits} from #900 to #963 (6.24): 0 guarding runs, 1 heartbeat heard, 2 to 7 failures."""
        words = self.words(900, 64)
        return {node: words[(node - 1) // 2] >> (8 if node % 2 == 0 else 0) & 0xFF for node in range(1, 128)}

    def clear_errors(self):
        """All latched bits of #29, and with bit 10 the failures of all nodes (14.2)."""
        self.set_g(29, 0)

    # --- PDOs (5.6.5)

    def set_up_rpdo(self, number, can_id, mapping, transmission_type=EVENT_DRIVEN):
        """PDO `number` (1 to 80) that the module receives. `mapping`: (index, sub-index, bits) of up to 8 objects."""
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
        """#20 bit 0: what was written goes out, what was received comes in (6.4)."""
        self.request(20, 1, 2)

    def read_pdo(self, number):
        """The four words of RPDO `number` with its default mapping: #10000 on, of the last exchange."""
        return self.words(10000 + 4 * (number - 1), 4)

    def write_pdo(self, number, *words):
        """Words of TPDO `number`; sent with the next exchange if they changed."""
        self.set_g(11000 + 4 * (number - 1), *words)


def receive_word(address, count=1):
    """Mapping entries for words #10000 to #10319: unsigned 16-bit objects A580H on (7.1.2)."""
    return [_variable(0xA580, address - 10000 + i) for i in range(count)]


def transmit_word(address, count=1):
    """The same for #11000 to #11319: A100H on (7.1.1)."""
    return [_variable(0xA100, address - 11000 + i) for i in range(count)]


def _variable(first_index, position):
    if not 0 <= position < 320:
        raise ValueError("expected words #10000 to #10319, or #11000 to #11319")
    return first_index + position // 120, position % 120 + 1, 16
