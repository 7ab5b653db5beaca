"""Plays of the AS Series manual, chapter 10 (AS-FCOPM). The PLC is read and written over Modbus TCP, by Debian's python3-pymodbus."""
import rig as rigs
from rig import Skip, Slave, Rig, equal, play

SR = 0xC000  # Modbus address of SR0; that of D0 is 0
M = 0x0000   # coil of M0


def pdo(index, kind, objects, type=255):
    """Communication and mapping record of an EDS file. objects: index:sub-index:bits."""
    def entry(record, number, name, data_type, access, value):
        return (f"[{record:X}sub{number}]\nParameterName={name}\nDataType={data_type}\nAccessType={access}\n"
                f"DefaultValue={value}\n")
    last = 5 if kind == "Tx" else 2
    text = f"[{index:X}]\nParameterName={kind}PDO {index & 0xF}\nObjectType=9\nSubNumber={last if last == 5 else 3}\n"
    text += entry(index, 0, "Entries", 5, "const", last)
    text += entry(index, 1, "COB-ID", 7, "rw", f"$NODEID+0x{(0x200 if kind == 'Rx' else 0x180) + 0x100 * (index & 0xF):X}")
    text += entry(index, 2, "Type", 5, "rw", type)
    if last == 5:
        text += entry(index, 3, "Inhibit time", 6, "rw", 0) + entry(index, 5, "Event timer", 6, "rw", 0)
    mapping = index + 0x200
    text += f"[{mapping:X}]\nParameterName=Mapping\nObjectType=9\nSubNumber={len(objects) + 1}\n"
    text += entry(mapping, 0, "Objects", 5, "rw", len(objects))
    for number, mapped in enumerate(objects, start=1):
        text += entry(mapping, number, f"Object {number}", 7, "rw", f"0x{mapped:08X}")
    return text


#: The parameters of the ASDA-A2 servo that chapter 10 uses, group and number, as its objects.
SERVO = {0x2009: (4, 0x100), 0x2109: (4, 0), 0x2306: (3, 0), 0x2407: (3, 0), 0x212D: (4, 0), 0x2017: (2, 0)}


def servo_eds():
    listed = lambda title, objects: (f"[{title}]\nSupportedObjects={len(objects)}\n"
                                     + "".join(f"{i + 1}=0x{index:X}\n" for i, index in enumerate(objects)))
    text = ("[FileInfo]\nFileName=servo.eds\n[DeviceInfo]\nVendorName=Delta\nProductName=ASDA-A2\nBaudRate_1000=1\nNrOfRXPDO=2\nNrOfTXPDO=1\n"
            + listed("MandatoryObjects", [0x1000, 0x1001, 0x1018])
            + "[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0x00020192\n"
            "[1001]\nParameterName=Error register\nDataType=5\nAccessType=ro\nDefaultValue=0\n"
            "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=3\n"
            "[1018sub0]\nParameterName=Entries\nDataType=5\nAccessType=const\nDefaultValue=2\n"
            "[1018sub1]\nParameterName=Vendor-ID\nDataType=7\nAccessType=ro\nDefaultValue=0x1DD\n"
            "[1018sub2]\nParameterName=Product code\nDataType=7\nAccessType=ro\nDefaultValue=0x6000\n"
            + listed("OptionalObjects", [0x1014, 0x1017, 0x1400, 0x1401, 0x1600, 0x1601, 0x1800, 0x1A00])
            + "[1014]\nParameterName=COB-ID EMCY\nDataType=7\nAccessType=ro\nDefaultValue=$NODEID+0x80\n"
            "[1017]\nParameterName=Producer heartbeat time\nDataType=6\nAccessType=rw\nDefaultValue=0\n"
            + pdo(0x1400, "Rx", [0x21090020]) + pdo(0x1401, "Rx", [0x23060010, 0x24070010]) + pdo(0x1800, "Tx", [0x20090020], 1)
            + listed("ManufacturerObjects", list(SERVO)))
    for index, (data_type, value) in SERVO.items():
        text += (f"[{index:X}]\nParameterName=P{index >> 8 & 0xF}-{index & 0xFF:02d}\nDataType={data_type}\nAccessType=rw\n"
                 f"PDOMapping=1\nDefaultValue={value}\n")
    return text


#: The same servo as a slave of the play's own.
OBJECTS = {(0x1000, 0): bytes.fromhex("92010200"), (0x1018, 1): bytes.fromhex("DD010000"), (0x1018, 2): bytes.fromhex("00600000"),
           (0x1017, 0): bytes(2), (0x2009, 0): bytes.fromhex("00010000"), (0x212D, 0): bytes(4), (0x2017, 0): bytes(1),
           **{(record, sub): bytes(size) for record in (0x1400, 0x1401, 0x1800) for sub, size in ((1, 4), (2, 1), (3, 2), (5, 2))},
           **{(record, sub): bytes(4 if sub else 1) for record in (0x1600, 0x1601, 0x1A00) for sub in range(5)},
           (0x2306, 0): bytes(2), (0x2407, 0): bytes(2), (0x2109, 0): bytes(4)}

#: The node list of 10.6, step 5.
SERVO_PDOS = '''
rx_pdo = [{ number = 1, type = 255, objects = ["2109:00"] }, { number = 2, type = 255, objects = ["2306:00", "2407:00"] }]
tx_pdo = [{ number = 1, type = 1, objects = ["2009:00"] }]
'''


class As300:
    """The rack, its bus and its Modbus client."""

    def __init__(self, download, device="", *, node=1, bit_rate=1_000_000, plc="", settings="", objects=""):
        (rigs.scratch / "servo.eds").write_text(servo_eds())
        self.rig = Rig(f'''
[plant]
name = "AS300"
[[bus]]
name = "line"
bit_rate = {bit_rate}
serve = "socketcand:127.0.0.1:0"
{device}
[[plc]]
name = "as300"
family = "AS300"
listen = "off"
store = "state"
{plc}
[[plc.modbus]]
listen = "127.0.0.1:0"
[[plc.module]]
model = "AS-FCOPM"
name = "card"
card = 2
bus = "line"
node = {node}
{settings}
{objects}
[plc.module.download]
{download}''')
        self._connect()

    def _connect(self):
        try:
            from pymodbus.client import ModbusTcpClient
        except ImportError:
            raise Skip("python3-pymodbus is not installed") from None
        host, port = self.rig.server("Modbus")
        self._client = ModbusTcpClient(host, port=port, timeout=60)
        assert self._client.connect()
        self.bus = self.rig.bus
        self.run = self.rig.run

    def power_cycle(self):
        self._client.close()
        self.rig.power_cycle()
        self._connect()

    def read(self, first, count=1):
        """Words of D or SR."""
        answer = self._client.read_holding_registers(first, count, slave=1)
        assert not answer.isError(), answer
        return answer.registers if count > 1 else answer.registers[0]

    def write(self, first, *words):
        assert not self._client.write_registers(first, list(words), slave=1).isError()

    def coil(self, number, on=None):
        """M: reads, or writes."""
        if on is None:
            return self._client.read_coils(M + number, 1, slave=1).bits[0]
        assert not self._client.write_coil(M + number, on, slave=1).isError()

    def sr(self, number, count=1):
        return self.read(SR + number, count)

    def booted(self, slave):
        """The slave gets its supply, and is started."""
        slave.power_on()
        self.bus.expect(f"000 01 {slave.node:02X}", within=5)

    def become(self, number, code, within=5.0):
        self.rig.until(lambda: self.sr(number) == code, f"SR{number} = {code:X}H", within)

    def ask(self, *words, within=2.0):
        """A request in D25000 on, D25000 last (10.4); the response."""
        self.write(25001, *words[1:])
        self.write(25000, words[0])
        self.rig.until(lambda: self.read(24000) >> 8 == words[0] >> 8 and self.read(24000) & 0xFF != 2, "a response", within)
        return self.read(24000, 24)


def with_servo(node=3, more="", heartbeat='heartbeat = "200ms"', **options):
    """A master whose node list has a simulated servo, Operational."""
    device = f'''
[[device]]
node = {node}
name = "servo"
eds = "servo.eds"
[[device.behaviour]]
object = "2009:00"
kind = "echo"
source = "2109:00"
'''
    rack = As300(f'[[plc.module.download.slave]]\nnode = {node}\n{heartbeat}\n{SERVO_PDOS}{more}', device, **options)
    rack.rig.until(lambda: rack.rig.plant.states()["servo"] == "operational", "the servo is Operational", 5)
    rack.run(0.05)
    return rack


def with_slave(node=3, more="", pdos=SERVO_PDOS, heartbeat='heartbeat = "200ms"', **options):
    """A master whose node list has a slave of the play's own, not there yet."""
    rack = As300(f'[[plc.module.download.slave]]\nnode = {node}\neds = "servo.eds"\n{heartbeat}\n{pdos}{more}', **options)
    return rack, Slave(rack.bus, node, OBJECTS)


# --- 10.1 to 10.3


@play("AS-FCOPM", "10.2.3")
def as_work_mode_node_and_bit_rate():
    """10.2.3 step 3, 10.6 step 3: working mode, node ID and bit rate are downloaded; the PLC runs with them after a reboot."""
    rack = As300('work_mode = "master"', node=1, bit_rate=125_000)
    rack.bus.expect("701 00", within=3)
    equal(rack.sr(822), 125, "SR822: CANopen baud rate (unit: 1kpps)")
    equal(rack.sr(821), 402, "SR821: version of CANopen DS301")


@play("AS-FCOPM", "10.1.2", "10.3.2")
def as_slave_maps_its_registers():
    """10.1.2: a slave's output area D25032-25063 goes to TxPDOs, RxPDOs come to D24032-24063; 10.3.2: NMT states, SR825."""
    rack = As300('work_mode = "slave"', node=5)
    bus = rack.bus
    bus.expect("705 00", within=3)
    equal(rack.sr(825), 0xA1, "pre-operational")
    bus.send("000 01 05")
    rack.run(0.01)
    equal(rack.sr(825), 0)
    bus.discard()
    rack.write(25032, 0x1234, 0x5678, 0x9ABC, 0xDEF0)
    bus.expect("185 34 12 78 56 BC 9A F0 DE", within=0.3)
    bus.send("205 AA BB 01 00 02 00 03 00")
    rack.run(0.01)
    equal(rack.read(24032, 4), [0xBBAA, 1, 2, 3])
    bus.send("000 80 05")
    rack.run(0.01)
    equal(rack.sr(825), 0xA1)
    bus.send("000 02 05")
    rack.run(0.01)
    bus.discard()
    bus.send("605 40 00 10 00 00 00 00 00")                 # table of 10.3.2: no SDO in Stopped
    bus.expect_none(0.1)
    bus.send("000 82 05")
    bus.expect("705 00", within=3)


@play("AS-FCOPM", "10.3.2", "10.6")
def as_master_sends_sync_and_heartbeat():
    """10.6 step 3 D: cycle period 50 ms, master heartbeat time 200 ms; 10.3.2: SYNC is COB-ID 80."""
    rack = As300("")
    rack.bus.expect("701 00", within=3)
    rack.run(3)
    rack.bus.received()
    last = rack.rig.time - 2
    for identifier, period in (("080", 0.05), ("701", 0.2)):
        times = [frame.time for frame in rack.bus.frames if frame.identifier == identifier and frame.time > last]
        assert len(times) >= 9 and all(abs(b - a - period) < 0.002 for a, b in zip(times, times[1:])), f"{identifier}: {times}"


@play("AS-FCOPM", "10.3.2")
def as_slave_is_watched_by_heartbeat_and_not_by_guarding():
    """10.3.2: only Heartbeat; 1017H makes the slave a producer."""
    rack = As300('work_mode = "slave"', node=5)
    rack.bus.expect("705 00", within=3)
    rack.bus.send("605 2B 17 10 00 64 00 00 00")
    rack.bus.expect("585 60 17 10 00 00 00 00 00")
    times = [rack.bus.expect("705 7F").time for _ in range(4)]
    assert all(abs(b - a - 0.1) < 0.002 for a, b in zip(times, times[1:])), times
    rack.bus.send("605 2B 17 10 00 00 00 00 00")
    rack.bus.expect("585 60 17 10 00 00 00 00 00")
    rack.bus.send_remote("705", 1)
    rack.bus.expect_none(0.3)


# --- 10.4 Sending SDO, NMT and reading emergency messages


@play("AS-FCOPM", "10.4", "10.4.1")
def as_sdo_write_of_example_1():
    """10.4.1 example 1: write 010203E8 (hex) to 212D_0 in slave of No. 3."""
    rack = with_servo()
    rack.bus.discard()
    rack.write(25000, *[0] * 32)                            # clear the request message mapping area
    response = rack.ask(0x0101, 0x0008, 0x0203, 0x212D, 0x0000, 0x03E8, 0x0102)
    equal(response[0:7], [0x0101, 0x0004, 0x6003, 0x212D, 0x0000, 0x0000, 0x0000])
    rack.bus.expect("603 23 2D 21 00 E8 03 02 01", "583 60 2D 21 00 00 00 00 00")
    equal(rack.rig.plant.value("servo", "212D:00"), 0x010203E8)


@play("AS-FCOPM", "10.4", "10.4.1")
def as_request_area_is_cleared():
    """10.4: clear the request message mapping area to zero; status 0: no data transmission request."""
    rack = with_servo()
    rack.ask(0x0101, 0x0008, 0x0203, 0x212D, 0x0000, 0x03E8, 0x0102)
    rack.write(25000, *[0] * 32)
    rack.run(0.05)
    equal(rack.read(24000) & 0xFF, 0)


@play("AS-FCOPM", "10.4.1")
def as_sdo_read_of_example_2():
    """10.4.1 example 2: read 212D_0 in slave of No. 3; another ReqID than before."""
    rack = with_servo()
    rack.ask(0x0101, 0x0008, 0x0203, 0x212D, 0x0000, 0x03E8, 0x0102)
    rack.bus.discard()
    response = rack.ask(0x0201, 0x0004, 0x0103, 0x212D, 0, 0, 0)
    equal(response[0:7], [0x0201, 0x0008, 0x4303, 0x212D, 0x0000, 0x03E8, 0x0102])
    rack.bus.expect("603 40 2D 21 00 00 00 00 00", "583 43 2D 21 00 E8 03 02 01")
    rack.bus.discard()
    rack.write(25003, 0x2009)                               # the ReqID stays: no request
    rack.bus.expect_none(0.3, "603")
    rack.write(25000, 0x0301)
    rack.bus.expect("603 40 09 20 00 00 00 00 00")


@play("AS-FCOPM", "10.4.1")
def as_sdo_sizes_of_word_and_byte():
    """10.4.1, Size: six for a word, five for a byte; Type of the response: 4B and 4F (Hex)."""
    rack = with_servo()
    equal(rack.ask(0x0101, 6, 0x0203, 0x2306, 0, 0x1234, 0)[0:3], [0x0101, 4, 0x6003])
    rack.bus.expect("603 2B 06 23 00 34 12 00 00")
    equal(rack.ask(0x0201, 5, 0x0203, 0x2017, 0, 0x0007, 0)[0:3], [0x0201, 4, 0x6003])
    rack.bus.expect("603 2F 17 20 00 07 00 00 00")
    equal(rack.ask(0x0301, 4, 0x0103, 0x2306, 0, 0, 0)[0:6], [0x0301, 6, 0x4B03, 0x2306, 0, 0x1234])
    equal(rack.ask(0x0401, 4, 0x0103, 0x2017, 0, 0, 0)[0:6], [0x0401, 5, 0x4F03, 0x2017, 0, 0x0007])


@play("AS-FCOPM", "10.4.1")
def as_status_codes_of_a_response():
    """10.4.1: status codes 0 to 0A."""
    rack = As300('[[plc.module.download.slave]]\nnode = 3\neds = "servo.eds"')
    slave = Slave(rack.bus, 3, OBJECTS)
    rack.run(1)
    equal(rack.read(24000), 0, "no data transmission request")
    rack.booted(slave)
    rack.write(25001, 4, 0x0103, 0x2009, 0)
    slave.is_off = True
    rack.write(25000, 0x0101)
    rack.run(0.01)
    equal(rack.read(24000), 0x0102, "SDO message is being transmitted")
    rack.write(25000, 0x0201)                               # a second one to the same device
    rack.run(0.01)
    equal(rack.read(24000), 0x0207, "equipment to be sent messages is busy")
    rack.run(1.5)
    rack.write(25000, 0x0301)
    rack.run(1)
    equal(rack.read(24000), 0x0303, "SDO transmission time-out")
    slave.is_off = False
    equal(rack.ask(0x0402, 4, 0x0103, 0x2009, 0)[0], 0x0404, "illegal command code")
    equal(rack.ask(0x0501, 9, 0x0203, 0x2009, 0, 1, 0)[0], 0x0505, "the length of the transmitted data is illegal")
    equal(rack.ask(0x0601, 4, 0x0503, 0x2009, 0)[0], 0x0608, "illegal type")
    equal(rack.ask(0x0701, 4, 0x0180, 0x2009, 0)[0], 0x0709, "incorrect node address")
    response = rack.ask(0x0801, 4, 0x0103, 0x5555, 0)
    equal(response[0], 0x080A, "error message")
    equal(response[2:7], [0x8003, 0x5555, 0, 0x0000, 0x0602], "80 (Hex) refers to stopping SDO command")
    equal(rack.ask(0x0901, 4, 0x0103, 0x2009, 0)[0], 0x0901, "SDO message transmission succeeds")


@play("AS-FCOPM", "10.4.2")
def as_nmt_of_example_1():
    """10.4.2 example 1: stop slave of No. 3; then each NMT service code, and the broadcast."""
    rack = with_servo()
    rack.bus.discard()
    equal(rack.ask(0x0101, 0x0004, 0x0303, 0x0002, 0x0003)[0:3], [0x0101, 0x0000, 0x0003])
    rack.bus.expect("000 02 03")
    equal(rack.rig.plant.states()["servo"], "stopped")
    for request, service in enumerate((0x01, 0x80, 0x81, 0x82), start=2):
        equal(rack.ask(request << 8 | 1, 4, 0x0303, service, 3)[0:3], [request << 8 | 1, 0, 3])
        rack.bus.expect(f"000 {service:02X} 03")
        rack.run(1)
    equal(rack.ask(0x0801, 4, 0x0300, 0x01, 0)[0:3], [0x0801, 0, 0], "0: Broadcast")
    rack.bus.expect("000 01 00")
    assert rack.ask(0x0901, 4, 0x0303, 0x03, 3)[0] != 0x0901, "no such service"


@play("AS-FCOPM", "10.4.3")
def as_emergency_of_example_1():
    """10.4.3 example 1: the two frames of slave No. 2; the page of the module has the reading of the printed response."""
    rack = As300('[[plc.module.download.slave]]\nnode = 2\neds = "servo.eds"')
    rack.booted(Slave(rack.bus, 2, OBJECTS))
    equal(rack.ask(0x0101, 0x0000, 0x0402)[0:4], [0x0101, 0x002A, 0x0402, 0x0000], "no message")
    rack.bus.send("082 43 54 20 14 00 00 00 00", "082 42 54 20 15 00 00 00 00")
    rack.run(0.02)
    equal(rack.sr(831), 0xE0, "emergency message from the slave (10.5.1)")
    response = rack.ask(0x0201, 0x0000, 0x0402)
    equal(response[0:3], [0x0201, 0x002A, 0x0402])
    equal(response[3], 0x0202, "total number and number stored")
    equal(response[4:8], [0x5442, 0x1520, 0, 0], "the latest: 42 54 20 15")
    equal(response[8:12], [0x5443, 0x1420, 0, 0])
    for number in range(7):                                 # five messages at most
        rack.bus.send(f"082 {number:02X} 10 01 00 00 00 00 00")
        rack.run(0.01)
    response = rack.ask(0x0301, 0x0000, 0x0402)
    equal(response[3], 0x0905)
    equal(response[4::4][:5], [0x1006, 0x1005, 0x1004, 0x1003, 0x1002])


@play("AS-FCOPM", "10.4.4")
def as_program_reads_p0_09_of_the_servo():
    """10.4.4: the ladder program. When M2 = ON, it reads 2009_0 of node 3; D24005 = 100 (hex)."""
    rack = with_servo(more="")
    rack.rig.plant.force("servo", "2009:00", 0x100)
    rack.bus.discard()

    def program():
        """A scan of the ladder diagram."""
        if rack.coil(2):
            rack.write(25001, 0x0004, 0x0103, 0x2009, 0x0000)
            rack.write(25000, 0x0101)
        rack.run(0.001)

    program()
    rack.bus.expect_none(0.05, "603")
    rack.coil(2, True)
    for _ in range(50):
        program()
    equal(rack.read(24000, 6), [0x0101, 0x0008, 0x4303, 0x2009, 0x0000, 0x0100])
    rack.bus.expect("603 40 09 20 00 00 00 00 00")
    rack.bus.expect_none(0.2, "603")                            # the ReqID stays


# --- 10.5 Troubleshooting


@play("AS-FCOPM", "10.5.1")
def as_codes_of_a_slave_that_is_not_there():
    """10.5.1: E6, its flag in SR826; "ensure that the slave is correctly connected": it goes when the slave is there."""
    rack, slave = with_slave()
    rack.become(832, 0xE6)
    equal(rack.sr(826, 4), [1 << 2, 0, 0, 0], "SR826 b2: node 3")
    rack.booted(slave)
    rack.become(832, 0, within=0.05)
    equal(rack.sr(826, 4), [0, 0, 0, 0], "when the node is normal, the bit is OFF")
    slave.is_off = True                                  # E7: error control is timed-out
    rack.become(832, 0xE7)
    equal(rack.sr(826), 1 << 2)


@play("AS-FCOPM", "10.5.1")
def as_flags_of_the_nodes():
    """10.5.1: SR826 to SR829, and SR830 to SR893, of nodes 1 to 64."""
    for node, register, flag in ((2, 826, 1), (16, 826, 15), (17, 827, 0), (64, 829, 15)):
        rack, _ = with_slave(node)
        rack.become(829 + node, 0xE6)
        equal(rack.sr(826, 4), [1 << flag if r == register else 0 for r in range(826, 830)])
        rack.rig.close()


@play("AS-FCOPM", "10.5.1")
def as_emergency_code_and_its_remedy():
    """10.5.1, E0: read the relevant message with the PLC program."""
    rack, slave = with_slave()
    rack.booted(slave)
    rack.become(832, 0, within=0.05)
    rack.bus.send("083 00 10 01 00 00 00 00 00")
    rack.become(832, 0xE0)
    equal(rack.ask(0x0101, 0, 0x0403)[3:5], [0x0101, 0x1000])
    rack.bus.send("083 00 00 00 00 00 00 00 00")            # the error is eliminated (10.3.2)
    rack.become(832, 0)


@play("AS-FCOPM", "10.5.1")
def as_codes_of_pdo_length_and_missing_pdo():
    """10.5.1: E1 for a PDO of another length; E2 for one that is not received."""
    rack, slave = with_slave()
    slave.power_on()
    rack.become(832, 0xE2)                                  # type 1: it is due with each SYNC
    rack.bus.send("183 01 02")
    rack.become(832, 0xE1)
    rack.bus.send("183 01 02 03 04")
    rack.run(0.01)
    equal(rack.sr(832), 0)
    equal(rack.read(24032, 2), [0x0201, 0x0403])


@play("AS-FCOPM", "10.5.1")
def as_codes_of_refused_writes():
    """10.5.1: E3, downloading auto SDO fails; E4, configuration of PDO parameter fails."""
    rack, slave = with_slave(more='auto_sdo = [{ object = "2017:00", value = 7 }]')
    slave.refused[0x2017, 0] = 0x06090030
    slave.power_on()
    rack.become(832, 0xE3)
    rack.rig.close()
    rack, slave = with_slave()
    slave.refused[0x1400, 2] = 0x06090030
    slave.power_on()
    rack.become(832, 0xE4)


@play("AS-FCOPM", "10.5.1")
def as_code_of_another_device():
    """10.5.1, E5: the connected slave device is consistent with the configured slave."""
    rack, slave = with_slave()
    slave.objects[0x1018, 2] = bytes.fromhex("01600000")
    slave.power_on()
    rack.become(832, 0xE5)
    slave.objects[0x1018, 2] = bytes.fromhex("00600000")
    slave.power_on()
    rack.become(832, 0)


@play("AS-FCOPM", "10.5.1")
def as_code_of_a_node_id_twice():
    """10.5.1, E8: the node IDs of master and slave repeat."""
    rack = As300('[[plc.module.download.slave]]\nnode = 1\neds = "servo.eds"')
    rack.become(830, 0xE8)
    equal(rack.sr(826), 1)


@play("AS-FCOPM", "10.5.1")
def as_codes_of_the_master():
    """10.5.1, SR825: F1 without a node list; F5 for an address outside 1-127 is the tool's; F4 bus-off, and the reboot."""
    rack = As300("")
    rack.become(825, 0xF1)                                  # add slave into the node list
    rack.rig.close()
    rack, slave = with_slave()
    rack.booted(slave)
    equal(rack.sr(825), 0)


@play("AS-FCOPM", "10.5.1")
def as_bus_off_and_reboot():
    """10.5.1, F4: check the cables and the baud rate before you reboot."""
    rack = As300('', device='[[bus.fault]]\nkind = "stuck recessive"\nports = ["card"]\nfrom = "2s"\nuntil = "3s"\n')
    rack.run(1.9)
    assert rack.sr(825) != 0xF4
    rack.run(2)
    equal(rack.sr(825), 0xF4, "bus-off is detected")
    rack.power_cycle()
    rack.run(1)
    assert rack.sr(825) != 0xF4, "after the reboot"


@play("AS-FCOPM", "10.5.1")
def as_internal_error_and_error_of_the_plc():
    """10.5.1: F8, internal memory; F3, the PLC is in error status."""
    rack = As300("", settings='fault = "hardware error"\nfault_at = "1s"')
    rack.become(825, 0xF8)
    rack.rig.close()
    rack = As300("", plc='cpu_error = "2s"')
    rack.become(825, 0xF3)


@play("AS-FCOPM", "10.5.1")
def as_codes_of_the_slave():
    """10.5.1: A1 pre-operational, B1 PDO length, B0 heartbeat of the master."""
    rack = As300('work_mode = "slave"', node=5)
    bus = rack.bus
    bus.expect("705 00", within=3)
    equal(rack.sr(825), 0xA1)
    bus.send("605 23 16 10 01 C8 00 01 00")                 # 1016H: node 1, 200 ms
    bus.expect("585 60 16 10 01 00 00 00 00")
    bus.send("000 01 05", "701 05")
    rack.run(0.01)
    equal(rack.sr(825), 0)
    bus.send("205 01 02 03 04")
    rack.run(0.01)
    equal(rack.sr(825), 0xB1)
    bus.send("205 01 02 03 04 05 06 07 08")
    rack.run(0.01)
    equal(rack.sr(825), 0)
    rack.run(0.3)
    equal(rack.sr(825), 0xB0, "heartbeat message time-out")
    bus.expect("085 30 81 01 01 00 00 00 00", within=0.1)    # the node that is missing


# --- 10.6 Application example


@play("AS-FCOPM", "10.6")
def as_application_example_turns_the_servo():
    """10.6: steps 2 to 7. Servo node 3, 1 Mbit/s; RxPDO1 P1-09, RxPDO2 P3-06 and P4-07, TxPDO1 P0-09; the program of M0 and M1."""
    rack = As300('[[plc.module.download.slave]]\nnode = 3\neds = "servo.eds"\nheartbeat = "200ms"\n' + SERVO_PDOS
                 + 'auto_sdo = [{ object = "2017:00", value = 7 }]')   # step 2: P0-17 = 07
    bus = rack.bus
    servo = Slave(bus, 3, OBJECTS)
    servo.power_on()
    # steps 3 and 5: what was downloaded goes to the servo when it starts
    bus.expect("603 40 00 10 00 00 00 00 00", "603 40 18 10 01 00 00 00 00", "603 40 18 10 02 00 00 00 00", within=3)
    bus.expect("603 2F 00 14 02 FF 00 00 00", "603 23 00 14 01 03 02 00 00", within=2)
    bus.expect("603 2F 01 14 02 FF 00 00 00", "603 23 01 14 01 03 03 00 00")
    bus.expect("603 2F 00 18 02 01 00 00 00", "603 23 00 18 01 83 01 00 00")
    bus.expect("603 2B 17 10 00 C8 00 00 00", "603 2F 17 20 00 07 00 00 00", "000 01 03")
    equal(servo.objects[0x1600, 1], bytes.fromhex("20000921"), "RxPDO1: P1-09")
    equal([servo.objects[0x1601, 1], servo.objects[0x1601, 2]], [bytes.fromhex("10000623"), bytes.fromhex("10000724")], "RxPDO2")
    equal(servo.objects[0x1A00, 1], bytes.fromhex("20000920"), "TxPDO1: P0-09")
    # step 7: for the first time P3-06 is set to F
    rack.write(25034, 0x000F)
    bus.expect("303 0F 00 00 00")
    # M0 OFF -> ON: 256 to D25032, the speed command
    rack.write(25032, 256)
    bus.expect("203 00 01 00 00")
    # M1 OFF -> ON: P4-07 = 5
    rack.write(25035, 5)
    bus.expect("303 0F 00 05 00")
    # TxPDO1, type 1: after each SYNC the actual speed
    bus.expect("080")
    bus.send("183 FE 00 00 00")
    rack.run(0.01)
    equal(rack.read(24032, 2), [0x00FE, 0])
    # M1 ON -> OFF: the speed command becomes 0
    rack.write(25032, 0)
    bus.expect("203 00 00 00 00")


@play("AS-FCOPM", "10.6")
def as_transmission_types_of_rx_pdos():
    """10.6, PDO transmission type: 0 at once when the data change, N each N SYNC whether they change or not, 254 and 255 on change."""
    for type, periods in ((0, None), (1, 1), (3, 3), (254, None), (255, None)):
        rack, slave = with_slave(pdos=f'rx_pdo = [{{ number = 1, type = {type}, objects = ["2109:00"] }}]')
        rack.booted(slave)
        rack.bus.answering(0.3)                             # its heartbeat says that it is Operational
        rack.bus.discard()
        rack.write(25032, 5)
        if periods is None:
            rack.bus.expect("203 05 00 00 00", within=0.01)
            rack.bus.expect_none(0.3, "203")
        else:
            rack.bus.expect("203 05 00 00 00", within=0.3)
            rack.bus.answering(0.7)
            times = [frame.time for frame in rack.bus.frames if frame.identifier == "203"][1:]
            assert all(abs(b - a - 0.05 * periods) < 0.002 for a, b in zip(times, times[1:])), f"type {type}: {times}"
        rack.rig.close()


@play("AS-FCOPM", "10.6", "10.3.2")
def as_transmission_types_of_tx_pdos():
    """10.6, the card as slave: 0 on SYNC after a change, N each N SYNC, 255 by event timer or on change."""
    def slave(type, inhibit=0, event=0):
        rack = As300('work_mode = "slave"', node=5)
        rack.bus.expect("705 00", within=3)
        for data in ("23 00 18 01 85 01 00 80", f"2F 00 18 02 {type:02X} 00 00 00", f"2B 00 18 03 {inhibit:02X} 00 00 00",
                     f"2B 00 18 05 {event:02X} 00 00 00", "23 00 18 01 85 01 00 00"):
            rack.bus.send(f"605 {data}")
            rack.bus.expect(f"585 60 {' '.join(data.split()[1:4])} 00 00 00 00")
        rack.bus.send("000 01 05")
        rack.run(0.2)
        rack.bus.send("080")
        rack.run(0.01)
        rack.bus.discard()
        return rack

    rack = slave(0)
    rack.write(25032, 7)
    rack.bus.expect_none(0.1)
    rack.bus.send("080")
    rack.bus.expect("185 07 00 00 00 00 00 00 00", within=0.01)
    rack.bus.send("080")
    rack.bus.expect_none(0.05)
    rack.rig.close()
    rack = slave(3)
    for _ in range(6):
        rack.bus.send("080")
        rack.run(0.01)
    equal(len(rack.bus.received("185")), 2, "each 3 SYNC")
    rack.rig.close()
    rack = slave(255)
    rack.write(25032, 7)
    rack.bus.expect("185 07 00 00 00 00 00 00 00", within=0.01)
    rack.bus.expect_none(0.3)
    rack.rig.close()
    rack = slave(255, event=100)
    times = [rack.bus.expect("185 00 00 00 00 00 00 00 00", within=0.2).time for _ in range(3)]
    assert all(abs(b - a - 0.1) < 0.002 for a, b in zip(times, times[1:])), times


@play("AS-FCOPM", "10.6")
def as_twenty_auto_sdos():
    """10.6 step 5: up to 20 SDOs, written when the slave goes from pre-operational to operational."""
    entries = ", ".join(f'{{ object = "212D:00", value = {number} }}' for number in range(1, 21))
    rack, slave = with_slave(more=f"auto_sdo = [{entries}]")
    slave.power_on()
    rack.bus.expect("000 01 03", within=3)
    equal([value for index, _, value in slave.written if index == 0x212D], list(range(1, 21)))


# --- 10.7 Object dictionary


@play("AS-FCOPM", "10.7")
def as_slave_has_the_printed_object_dictionary():
    """10.7: index, default value and attribute, read and written by SDO."""
    rack = As300('work_mode = "slave"', node=5)
    bus = rack.bus
    bus.expect("705 00", within=3)

    def read(index, sub):
        bus.send(f"605 40 {index & 0xFF:02X} {index >> 8:02X} {sub:02X} 00 00 00 00")
        start = len(bus.frames)
        rack.rig.until(lambda: any(f.identifier == "585" for f in bus.frames[start:]), f"{index:X}H:{sub:02X}", 0.5)
        data = bytes.fromhex(next(f for f in bus.frames[start:] if f.identifier == "585").data)
        return None if data[0] == 0x80 else int.from_bytes(data[4:8 - (data[0] >> 2 & 3)], "little")

    expected = {(0x1000, 0): 0, (0x1001, 0): 0, (0x1005, 0): 0x80, (0x1014, 0): 0x85, (0x1016, 0): 1, (0x1016, 1): 0, (0x1017, 0): 0,
                (0x1018, 0): 3, (0x1018, 1): 0x1DD, (0x1018, 2): 0x55, (0x1018, 3): 0x10002}
    for pdo in range(8):
        expected.update({(0x1400 + pdo, 0): 3, (0x1400 + pdo, 1): 0x205 if pdo == 0 else 0x80000000, (0x1400 + pdo, 2): 0xFF,
                         (0x1400 + pdo, 3): 0, (0x1600 + pdo, 0): 4 if pdo == 0 else 0,
                         (0x1800 + pdo, 0): 5, (0x1800 + pdo, 1): 0x185 if pdo == 0 else 0x80000000, (0x1800 + pdo, 2): 0xFF,
                         (0x1800 + pdo, 3): 50, (0x1800 + pdo, 5): 100, (0x1A00 + pdo, 0): 4 if pdo == 0 else 0})
        for sub in range(1, 5):
            expected[0x1600 + pdo, sub] = 0x20000010 | sub << 8 if pdo == 0 else 0
            expected[0x1A00 + pdo, sub] = 0x20010010 | sub << 8 if pdo == 0 else 0
    wrong = {f"{index:X}:{sub:02X}": (read(index, sub), value) for (index, sub), value in expected.items() if read(index, sub) != value}
    assert not wrong, f"found and printed: {wrong}"
    for data, answer in (("23 14 10 00 86 00 00 00", "80 14 10 00 02 00 01 06"), ("2B 17 10 00 64 00 00 00", "60 17 10 00 00 00 00 00"),
                         ("23 05 10 00 81 00 00 00", "60 05 10 00 00 00 00 00")):
        bus.send(f"605 {data}")
        bus.expect(f"585 {answer}")
    bus.send("605 40 08 10 00 00 00 00 00")                 # "AS300 Series PLC"
    bus.expect("585 41 08 10 00 10 00 00 00")
    bus.send("605 60 00 00 00 00 00 00 00")
    bus.expect("585 00 41 53 33 30 30 20 53")
