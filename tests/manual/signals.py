"""A module with X/Y signals (ME3CAN1-Q, RJ71CN91) as its PLC program has it."""
from rig import Slave, Rig, equal, number_of

OWN = 0          # node number of the own object dictionary
NONE = 0xFFFF    # node number of an unused record of a multi SDO command


def rack(model, settings="", *, node=None, head=0x40, bit_rate=250_000, more="", plc="", tail="", **options):
    """The module in its rack, on the bus "line", as from the box but for these settings of the plant file. `more`: other parts of the
    plant, `plc`: keys of the rack, `tail`: tables of the module."""
    family = "iQ-R" if model == "RJ71CN91" else "Q"
    text = f'''
[plant]
name = "{model}"
[[bus]]
name = "line"
bit_rate = {bit_rate}
serve = "socketcand:127.0.0.1:0"
[[plc]]
name = "plc1"
family = "{family}"
listen = "127.0.0.1:0"
store = "state"
{plc}
[[plc.module]]
model = "{model}"
name = "module"
head = {head}
{f"node = {node}" if node else ""}
{settings}
{tail}
{more}
'''
    return Module(Rig(text, **options), head)


class Module:
    def __init__(self, rig, head=0x40, plc=None):
        self.rig, self.head, self._plc = rig, head, plc

    @property
    def plc(self):
        return self.rig.plant.plcs[self._plc] if self._plc else self.rig.plc

    @property
    def bus(self):
        return self.rig.bus

    @property
    def g(self):
        """Buffer memory Un\\G."""
        return self.plc.g[self.head >> 4]

    def x(self, signal):
        return self.plc.x[self.head + signal]

    def y(self, signal, on):
        self.plc.y[self.head + signal] = on

    def run(self, seconds):
        self.rig.run(seconds)

    def until_x(self, signal, on=True, within=10.0):
        self.rig.until(lambda: self.x(signal) == on, f"X{signal:02X} {'ON' if on else 'OFF'}", within)

    def handshake(self, signal, within=10.0):
        """Y ON, X comes; Y OFF, X goes."""
        self.y(signal, True)
        self.until_x(signal, True, within)
        self.y(signal, False)
        self.until_x(signal, False, 1)

    def ready(self):
        """X00, and the end of the initialization."""
        self.until_x(0x00, within=20)
        self.rig.until(lambda: not self.g[25] & 0x80, "the end of the initialization", 20)
        return self

    def save(self):
        self.g[22] = 1
        self.handshake(0x1F)
        equal(self.g[22], 0, "G22 after the save")

    def restart(self):
        self.handshake(0x02, 20)
        self.ready()

    def exchange(self):
        self.handshake(0x01)

    def cif(self, command, *parameters, within=10.0):
        """Un\\G1000 on, Y17, X17; the 67 words of the result."""
        words = [command, *parameters]
        self.g[1000:1000 + len(words)] = words
        self.handshake(0x17, within)
        return self.g[1000:1067]

    def sdo_write(self, node, index, sub, value, size):
        words = [value & 0xFFFF, value >> 16] if size == 4 else [value]
        result = self.cif(0x0002, node, index, sub, size, *words)
        equal(result[0:4], [0x0003, node, index, sub], f"SDO write to {index:04X}H:{sub:02X}H (abort {result[4]:04X}{result[3]:04X}H)")

    def sdo_read(self, node, index, sub=0):
        """The number."""
        result = self.cif(0x0004, node, index, sub)
        equal(result[0:4], [0x0005, node, index, sub], f"SDO read of {index:04X}H:{sub:02X}H (abort {result[4]:04X}{result[3]:04X}H)")
        return number_of(result[5:67], result[4])

    def store_objects(self):
        """1010:01 = "save"."""
        self.sdo_write(OWN, 0x1010, 1, 0x65766173, 4)


#: Identity of the slave of the plays, and what a master may configure in it.
IDENTITY = {(0x1000, 0): bytes.fromhex("91010F00"), (0x1018, 1): bytes.fromhex("34120000"), (0x1018, 2): bytes.fromhex("78560000"),
            (0x1018, 3): bytes.fromhex("01000100"), (0x1018, 4): bytes.fromhex("07000000"), (0x1017, 0): bytes(2),
            (0x1020, 1): bytes(4), (0x1020, 2): bytes(4), (0x6423, 0): bytes(1)}


def slave(module, node, **changed):
    return Slave(module.bus, node, {**IDENTITY, **changed})
