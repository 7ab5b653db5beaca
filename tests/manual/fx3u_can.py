"""Plays of the FX3U-CAN User's Manual (revision E). Section 5.10 and chapters 8 and 9 (417 mode, Layer 2 modes) are in
fx3u_can_modes.py."""
from signals import IDENTITY
from rig import DEVICES, Slave, Rig, bit, equal, number_of, play

FX3U = "FX3U-CAN"
OWN = 0          # node number of the own object dictionary (10.2)
END = 0xFFFF     # end of a parameter table (10.3, 10.4, 10.6)


def rack_text(settings="", *, node=None, name="plc", plc="", more=""):
    return f'''
[[plc]]
name = "{name}"
family = "FX3"
listen = "127.0.0.1:0"
store = "state"
{plc}
[[plc.module]]
model = "FX3U-CAN"
name = "module of {name}"
position = 0
bus = "line"
{f"node = {node}" if node else ""}
{settings}
{more}
'''


def bus_text(bit_rate=250_000):
    return f'[plant]\nname = "FX3U-CAN"\n[[bus]]\nname = "line"\nbit_rate = {bit_rate}\nserve = "socketcand:127.0.0.1:0"\n'


class Block:
    """The special function block as its PLC program has it: BFM numbers are those of FROM and TO."""

    def __init__(self, rig, plc=None):
        self.rig, self._plc = rig, plc

    @property
    def plc(self):
        return self.rig.plant.plcs[self._plc] if self._plc else self.rig.plc

    @property
    def b(self):
        return self.plc.g[0]

    @property
    def bus(self):
        return self.rig.bus

    def run(self, seconds):
        self.rig.run(seconds)

    def ready(self):
        """6.8: bit 7 of BFM #25 is 0."""
        self.rig.until(lambda: not bit(self.b[25], 7), "the end of the initialisation", 20)
        return self

    def request(self, number, bits, within=10):
        self.b[number] = bits
        self.rig.until(lambda: not self.b[number] & bits, f"#{number} is 0", within)

    def save(self):
        self.request(22, 1)

    def restart(self):
        self.b[25] = 1
        equal(bit(self.b[25], 7), 1, "initialisation mode")
        self.ready()

    def exchange(self):
        self.request(20, 1, 2)

    def command(self, code, *parameters, within=10):
        return self.rig.command(self.b, code, *parameters, within=within)

    def sdo_read(self, node, index, sub=0):
        result = self.command(4, node, index, sub)
        equal(result[0:4], [5, node, index, sub], f"SDO read of {index:04X}H:{sub:02X}H (abort {result[4]:04X}{result[3]:04X}H)")
        return number_of(result[5:67], result[4])

    def sdo_write(self, node, index, sub, value, size):
        words = [value & 0xFFFF, value >> 16] if size == 4 else [value]
        result = self.command(2, node, index, sub, size, *words)
        equal(result[0:4], [3, node, index, sub], f"SDO write to {index:04X}H:{sub:02X}H (abort {result[4]:04X}{result[3]:04X}H)")

    def store_objects(self):
        """10.6."""
        equal(self.command(0x6000, OWN, END)[0], 0x6001)


def rack(settings="", *, bit_rate=250_000, buffer="G26 = 0", bus="", **options):
    """A block from the box, but for these settings of the plant file, without the FROM/TO watchdog."""
    keys = {key: options.pop(key) for key in ("node", "plc", "more") if key in options}
    saved = f"buffer = {{ {buffer} }}\n" if buffer else ""
    return Block(Rig(bus_text(bit_rate) + bus + rack_text(saved + settings, **keys), **options))


def node(number=5, settings="", **options):
    """An NMT slave with this node-ID, Pre-operational."""
    block = rack(settings, node=number, **options).ready()
    if block.bus:
        block.bus.expect(f"{0x700 + number:03X} 00", within=8)
    return block


def operational(number=5, settings="", **options):
    block = node(number, settings, **options)
    block.bus.send(f"000 01 {number:02X}")
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 1)
    block.bus.discard()
    return block


def master(configuration=0x01, more_objects="", **options):
    """The NMT master, node 1."""
    return rack(f'objects = {{ "1F80:00" = {configuration}{more_objects} }}', node=1, **options).ready()


def slave(block, number):
    return Slave(block.bus, number, {**IDENTITY, (0x100C, 0): bytes(2), (0x100D, 0): bytes(1), (0x1016, 1): bytes(4),
                                     (0x1010, 1): bytes(4), (0x1011, 1): bytes(4)})


def booted(configuration=0x01, assignment=0x0D, **options):
    """A master that has started slave 3, whose heartbeat it watches."""
    block = master(configuration, f', "1F81:03" = {assignment}, "1016:01" = 0x000305DC', **options)
    three = slave(block, 3)
    three.heartbeat = 0.2
    block.bus.expect("000 82 00", within=8)
    three.power_on()
    block.bus.expect("000 01 03", within=3)
    block.rig.until(lambda: bit(block.b[25], 9) and block.b[603] == 5, "Operational", 3)
    block.bus.discard()
    return block, three


def exchange_emcy(block):
    """Bit 12 of #20; FROM does not show it (6.4)."""
    block.b[20] = 0x1000
    block.run(0.01)


def status_of(block, number):
    """The byte of a node in #900 on (6.24)."""
    word = block.b[900 + (number - 1) // 2]
    return word & 0xFF if number % 2 else word >> 8


# --- 6 Allocation of buffer memories


@play(FX3U, "6.1", "6.12", "6.22")
def fx3u_buffer_memories_from_the_box():
    """6.1: default values; 5.8.2: boot-up message; 6.12: module ID code K7170."""
    block = rack(buffer="").ready()
    block.bus.expect("77F 00", within=8)
    b = block.b
    equal(b[25], 0x0100)
    for number, value in ((21, 405), (22, 0), (24, 250), (26, 20), (27, 127), (29, 0), (30, 7170), (35, 0), (36, 0), (37, 2500),
                          (38, 875), (39, 0), (40, 0), (50, 1), (58, 0), (59, 0), (70, 500), (71, 500), (727, 0x7F)):
        equal(b[number], value, f"#{number}")
    equal(b[51:58], [12, 3, 1, 0, 0, 0, 4])
    equal(b[601:727], [0] * 126)


@play(FX3U, "6.3", "6.4", "7.1")
def fx3u_data_exchange_control():
    """6.4: write data, H0001 to #20, it is 0 when done; 6.3, 7.1: #0 on and #11000 on are the same words."""
    block = operational()
    b = block.b
    b[11000:11004] = [0x1111, 0x2222, 0x3333, 0x4444]
    block.bus.expect_none(0.05)
    block.exchange()
    block.bus.expect("185 11 11 22 22 33 33 44 44")
    block.exchange()
    block.bus.expect_none(0.05)
    b[0] = 0x5555
    block.exchange()
    block.bus.expect("185 55 55 22 22 33 33 44 44")
    equal(b[11000], 0x5555)
    block.bus.send("205 01 02 03 04 05 06 07 08")
    block.run(0.02)
    equal(b[10000], 0)
    block.exchange()
    equal([b[10000:10004], b[0:4]], [[0x0201, 0x0403, 0x0605, 0x0807]] * 2)


@play(FX3U, "6.4")
def fx3u_data_exchange_waits_for_operational():
    """6.4: the exchange is carried out in Operational."""
    block = node()
    block.b[11000] = 1
    block.b[20] = 1
    block.bus.expect_none(0.2)
    equal(bit(block.b[20], 0), 1)
    block.bus.send("000 01 05")
    block.bus.expect("185 01 00 00 00 00 00 00 00")
    block.rig.until(lambda: block.b[20] == 0, "done", 0.1)


@play(FX3U, "6.4", "6.23")
def fx3u_emcy_is_exchanged_apart():
    """6.4, bits 8 and 12: process data or emergency messages alone."""
    block = operational()
    block.bus.send("205 01 02 03 04 05 06 07 08", "083 00 10 01 00 00 00 00 00")
    block.run(0.02)
    block.request(20, 0x0100)
    equal([block.b[10000], block.b[750]], [0x0201, 0])
    exchange_emcy(block)
    equal(block.b[750:752], [3, 0x1000])


@play(FX3U, "6.5", "6.17", "6.6", "6.8")
def fx3u_function_mode():
    """6.5: #21, save, restart; stored objects are deleted by the change; 6.17: a wrong mode stands in #39."""
    block = node(5)
    block.sdo_write(OWN, 0x1017, 0, 500, 2)
    block.store_objects()
    block.b[21] = 1
    equal([block.b[29], block.b[39], block.b[21]], [0b1000001, 21, 405])
    block.b[71] = 49
    equal(block.b[39], 21, "the first one")
    block.b[29] = 0
    equal([block.b[29], block.b[39]], [0, 0])
    block.b[21] = 417
    block.restart()
    equal(block.b[21], 405, "it was not saved")
    block.b[21] = 417
    block.save()
    block.restart()
    equal(block.b[21], 417)
    equal([block.sdo_read(OWN, 0x1000), block.sdo_read(OWN, 0x1017)], [0x1A1, 1000], "the dictionary of CiA 417, default heartbeat")


@play(FX3U, "6.6")
def fx3u_save_and_restore_configuration():
    """6.6: #22 bit 0 saves, bit 1 restores, both into the Flash ROM, too."""
    block = rack().ready()
    block.b[70] = 900
    block.save()
    block.request(22, 2)
    equal(block.b[70], 500)
    block.restart()
    equal(block.b[70], 900)
    block.request(22, 3)
    block.rig.power_cycle()
    block.ready()
    equal([block.b[70], block.b[27], block.b[26]], [500, 127, 20])


@play(FX3U, "6.7", "6.10", "6.8", "6.15")
def fx3u_bit_rate_and_node_address():
    """6.7, 6.10: #24 and #27, save, restart (6.8); 6.15: #37 has the rate in use."""
    block = rack(peer=False, bit_rate=500_000, buffer="G26 = 0, G24 = 250").ready()
    block.b[27] = 9
    block.b[24] = 500
    equal(block.b[37], 2500)
    block.save()
    block.rig.power_cycle(peer=True)
    block.ready()
    block.bus.expect("709 00", within=8)
    equal([block.b[24], block.b[27], block.b[37], block.b[609]], [500, 9, 5000, 0x7F])
    block.b[27] = 10
    block.restart()
    equal(block.b[27], 9, "not saved")


@play(FX3U, "6.7", "6.10", "14.2")
def fx3u_wrong_bit_rate_and_node_address():
    """14.2, bits 11 and 12: the BFM keeps its former value."""
    block = node()
    block.b[24] = 300
    equal([block.b[24], bit(block.b[29], 11), bit(block.b[29], 0)], [250, 1, 1])
    block.b[24] = 250
    equal(bit(block.b[29], 11), 0)
    block.b[27] = 128
    equal([block.b[27], bit(block.b[29], 12)], [5, 1])
    block.b[27] = 5
    equal(bit(block.b[29], 12), 0)


@play(FX3U, "6.8", "6.23")
def fx3u_module_restart():
    """6.8: bit 0 of #25; bit 7 while it initialises; the restart is announced by EMCY (6.23, FX004)."""
    block = node()
    block.sdo_write(OWN, 0x1017, 0, 200, 2)
    block.bus.discard()
    block.b[25] = 1
    equal(bit(block.b[25], 7), 1)
    block.ready()
    frames = block.bus.received("085", "705")
    assert [frame for frame in frames if frame.startswith("085 00 62") and frame.endswith("34 30 30 58 46")], frames
    block.bus.expect("705 00", within=0.1)
    equal(block.sdo_read(OWN, 0x1017), 0)


@play(FX3U, "6.8", "6.18", "14.2")
def fx3u_write_during_initialisation():
    """6.18: a write during the initialisation: #29 bit 5, #40; cleared by 0."""
    block = node()
    block.b[25] = 1
    block.run(0.01)
    block.b[27] = 3
    block.b[24] = 500
    block.ready()
    equal([bit(block.b[29], 5), block.b[40], block.b[27]], [1, 27, 5])
    block.b[29] = 0
    equal([block.b[29], block.b[40]], [0, 0])


@play(FX3U, "6.8", "5.8.1", "5.8.3", "6.22")
def fx3u_nmt_states():
    """5.8.1, 5.8.3: node control commands; 6.8: bits 0, 6, 8, 9 of #25; 6.22."""
    block = node()
    for command, status, state in (("01", 0x0201, 5), ("02", 0x0000, 4), ("80", 0x0100, 0x7F)):
        block.bus.send(f"000 {command} 00")
        block.run(0.02)
        equal([block.b[25] & 0x0301, block.b[605]], [status, state])
    for command in ("82", "81"):
        block.bus.discard()
        block.bus.send(f"000 {command} 05")
        block.bus.expect("705 00", within=8)
        block.ready()
        equal(bit(block.b[25], 6), 1, "NMT reset")
        block.b[25] = 0
        equal(bit(block.b[25], 6), 0)


@play(FX3U, "6.9", "14.2", "6.23")
def fx3u_from_to_watchdog():
    """6.9: from the first access to process data in online mode on; EMCY; reset by #26; 0 disables it."""
    block = operational(buffer="")
    block.run(1)
    equal(bit(block.b[29], 7), 0, "not before the first access to process data")
    block.b[11000] = 1
    for _ in range(5):
        block.run(0.19)
        block.b[11000] = 2
    equal(bit(block.b[29], 7), 0)
    block.bus.discard()
    block.run(0.21)
    equal([bit(block.b[29], 7), bit(block.b[29], 0)], [1, 1])
    frames = block.bus.received("085")
    assert frames[-1].startswith("085 00 62") and frames[-1].endswith("33 30 30 58 46"), frames
    equal(bit(block.b[25], 9), 0, "1029H: Pre-operational")
    block.bus.send("000 01 05")
    block.run(0.02)
    equal(bit(block.b[25], 9), 0, "refused while b7 = 1")
    block.b[26] = 20
    equal(bit(block.b[29], 7), 0)
    block.b[26] = 0
    block.bus.send("000 01 05")
    block.run(0.02)
    equal(bit(block.b[25], 9), 1)
    block.b[11000] = 3
    block.run(2)
    equal(bit(block.b[29], 7), 0)


@play(FX3U, "6.13", "6.14", "14.2", "14.1")
def fx3u_error_passive_when_it_is_alone():
    """6.13, 14.2 bit 14; 14.1: the ERROR LED flashes once."""
    block = rack(node=5, peer=False).ready()
    block.run(1)
    equal([block.b[35] >= 128, bit(block.b[29], 14)], [True, 1])
    leds = block.rig.leds()
    equal(leds["ERROR"], "single flash")


@play(FX3U, "14.2", "14.1", "10.9.1 6", "6.8")
def fx3u_bus_off_and_restart():
    """14.2, bit 3: check the network, then restart the block; 10.9.1: class B0FF."""
    block = node(5, bus='[[bus.fault]]\nkind = "stuck recessive"\nports = ["module of plc"]\nfrom = "4s"\nuntil = "6s"\n')
    block.run(4.1 - block.rig.time)
    block.command(4, 9, 0x1000, 0)
    block.rig.until(lambda: bit(block.b[29], 3), "bus off", 1)
    equal(block.command(4, 9, 0x1000, 0)[0:2], [0x000F, 0xB0FF])
    leds = block.rig.leds()
    equal(leds["ERROR"], "on")
    block.run(2)
    block.bus.discard()
    block.restart()
    equal(bit(block.b[29], 3), 0)
    block.bus.expect("705 00", within=0.2)


@play(FX3U, "6.19 set", "5.6.10")
def fx3u_time_stamp_setting_procedure():
    """6.19, time stamp setting procedure: producer, date and time, #56 last, then #58; 5.6.10: from the active NMT master."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    block.bus.discard()
    block.b[50] = 2
    equal(block.sdo_read(OWN, 0x1012), 0x40000100)
    for number, value in ((51, 12), (52, 3), (53, 1), (54, 0), (55, 0), (56, 0)):
        block.b[number] = value
    block.bus.expect_none(0.1, "100")
    block.b[58] = 1
    first = block.bus.expect(next_time(block), within=0.5)
    equal(first.data[-5:], "2F 28", "day 10287 is 2012-03-01")
    equal(block.b[57], 4, "Thursday")
    block.run(61)
    times = [frame.time for frame in block.bus.frames if frame.identifier == "100"]
    assert abs(times[1] - times[0] - 60) < 0.01, times


def next_time(block):
    """The first TIME frame from now on."""
    block.rig.until(lambda: block.bus.received("100"), "TIME", 2)
    return block.bus.received("100")[-1]


@play(FX3U, "6.19 read", "5.6.10", "6.8")
def fx3u_time_stamp_read_procedure():
    """6.19, time stamp read procedure: #51 is read first, it takes the clock; a TIME consumer, #25 bit 12."""
    block = node()
    block.bus.send("100 00 00 00 00 2F 28")
    block.run(5.1)
    equal(bit(block.b[25], 12), 1)
    equal([block.b[51], block.b[52], block.b[53], block.b[56], block.b[57]], [12, 3, 1, 5, 4])
    block.b[51] = 20
    equal(block.b[51], 12, "a consumer's write is ignored")
    block.b[25] = 0
    equal(bit(block.b[25], 12), 0)
    block.bus.send("100 00 00 00 00 D3 16")                 # 1999-12-31
    block.run(0.1)
    equal([block.b[51], block.b[52], block.b[53]], [0, 1, 1])


@play(FX3U, "6.19 set")
def fx3u_wrong_date():
    """6.19: a date that does not exist: #29 bit 6."""
    block = node()
    block.b[50] = 2
    for number, value in ((51, 12), (52, 4), (53, 31), (54, 0), (55, 0), (56, 0)):
        block.b[number] = value
    equal(bit(block.b[29], 6), 1)


@play(FX3U, "6.20", "5.8.5")
def fx3u_simple_master_start_up():
    """5.8.5: reset communication all, the delay of #70 (6.20), start all."""
    for delay in (500, 2000):
        block = rack('objects = { "1F80:00" = 0x03 }', node=1, buffer=f"G26 = 0, G70 = {delay}")
        reset = block.bus.expect("000 82 00", within=8)
        start = block.bus.expect("000 01 00", within=4)
        assert -0.001 < start.time - reset.time - delay / 1000 < 0.5, f"{start.time - reset.time} s"
        block.run(0.01)
        equal(block.b[25] & 0x8301, 0x8201)
        block.rig.close()


@play(FX3U, "6.21", "10.9.1 5")
def fx3u_sdo_time_out():
    """6.21: #71 in ms; 10.9.1: SDO error with node and abort code."""
    block = node()
    block.b[71] = 300
    begin = block.rig.time
    equal(block.command(4, 9, 0x1000, 0)[0:5], [0x000F, 3, 9, 0x0000, 0x0504])
    assert 0.29 < block.rig.time - begin < 0.4


@play(FX3U, "6.23", "5.6.13")
def fx3u_emergency_message_buffer():
    """6.23: the first 11 in the stack, the latest 11 in the ring; 0 to #750 clears."""
    block = node()
    block.bus.send("083 00 10 01 A1 A2 A3 A4 A5")
    block.run(0.01)
    exchange_emcy(block)
    equal(block.b[750:755], [3, 0x1000, 0xA101, 0xA3A2, 0xA5A4])
    block.b[750] = 0
    equal(block.b[750:755], [0] * 5)
    for number in range(1, 24):
        block.bus.send(f"083 {number:02X} 10 01 00 00 00 00 00")
        block.run(0.002)
    exchange_emcy(block)
    equal([word & 0xFF for word in block.b[751:860][0::5]], [*range(1, 12), *range(13, 24)])


@play(FX3U, "6.24", "5.6.9", "14.2")
def fx3u_heartbeat():
    """5.6.9: producer 1017H, consumer 1016H; 6.24: status flags, cleared by 0 or by #29 bit 10."""
    block = node(5, 'objects = { "1017:00" = 200, "1016:01" = 0x00030258 }')
    times = [block.bus.expect("705 7F").time for _ in range(4)]
    assert all(abs(b - a - 0.2) < 0.001 for a, b in zip(times, times[1:])), times
    block.run(1)
    equal(status_of(block, 3), 0)
    block.bus.send("703 05")
    block.run(0.01)
    equal([status_of(block, 3), block.b[603]], [0b10, 5])
    block.run(0.57)
    equal(bit(status_of(block, 3), 7), 0)
    block.run(0.05)
    equal([bit(status_of(block, 3), 7), bit(block.b[29], 10), bit(block.b[29], 0)], [1, 1, 1])
    block.b[901] = 0
    equal(bit(status_of(block, 3), 7), 0)
    block.b[29] = 0
    equal(block.b[29], 0)


# --- 5.6 to 5.8


@play(FX3U, "5.6.3", "5.6.2", "10.5")
def fx3u_pre_defined_error_field():
    """5.6.3: the latest error first; K0 to sub-index 0 clears the history."""
    block = node()
    for code in (0x1001, 0x1002):
        equal(block.command(0x000A, code, 0x0001, 0, 0)[0], 0x000B)
    equal([block.sdo_read(OWN, 0x1003, 0), block.sdo_read(OWN, 0x1003, 1) & 0xFFFF, block.sdo_read(OWN, 0x1003, 2) & 0xFFFF],
          [2, 0x1002, 0x1001])
    equal(block.command(2, OWN, 0x1003, 0, 1, 1)[0], 0x000F)
    block.sdo_write(OWN, 0x1003, 0, 0, 1)
    equal([block.sdo_read(OWN, 0x1003, 0), block.sdo_read(OWN, 0x1001)], [0, 0])


@play(FX3U, "5.6.5 mapping")
def fx3u_pdo_mapping_procedure():
    """5.6.5: disable the PDO, number of entries 0, entries, number, enable."""
    block = node()
    for communication, mapping, entry, cob_id in ((0x1800, 0x1A00, 0xA2000120, 0x40000185), (0x1400, 0x1600, 0xA6800120, 0x205)):
        block.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        block.sdo_write(OWN, mapping, 0, 0, 1)
        block.sdo_write(OWN, mapping, 1, entry, 4)
        block.sdo_write(OWN, mapping, 0, 1, 1)
        block.sdo_write(OWN, communication, 1, cob_id, 4)
    block.bus.send("000 01 05", "205 01 00 02 00")
    block.run(0.02)
    block.bus.discard()
    block.b[11000:11002] = [0x5678, 0x1234]
    block.bus.send("205 01 00 02 00")
    block.run(0.01)
    block.exchange()
    block.bus.expect("185 78 56 34 12")
    equal(block.b[10000:10002], [1, 2])


@play(FX3U, "5.6.5 timing")
def fx3u_tpdo_timing_charts():
    """5.6.5, timing chart, examples 1 to 5."""
    def run(inhibit, event, *steps, end=0.3):
        """`steps`: ms and a value, None: a trigger without a change; ms and values of the frames."""
        block = operational(settings=f'objects = {{ "1800:03" = {inhibit}, "1800:05" = {event} }}')
        begin = block.rig.time
        for at, value in steps:
            if at:
                block.run(begin + at / 1000 - block.rig.time)
            if value is not None:
                block.b[11000] = value
            block.b[20] = 1
        block.run(begin + end - block.rig.time)
        frames = [frame for frame in block.bus.frames if frame.identifier == "185"]
        result = [(round((frame.time - frames[0].time) * 1000), int(frame.data[:2], 16)) for frame in frames]
        block.rig.close()
        return result
    equal(run(0, 0, (0, 1), (20, None), (40, 2)), [(0, 1), (40, 2)], "example 1")
    equal(run(500, 0, (0, 1), (10, 2), (20, 3), (60, None), (150, None)), [(0, 1), (60, 3)], "example 2")
    equal(run(0, 100, (0, 1), (130, 2), end=0.25), [(0, 1), (100, 1), (130, 2), (230, 2)], "example 3")
    equal(run(500, 100, (0, 1), (20, 2), end=0.15), [(0, 1), (100, 2)], "example 4")
    equal(run(2000, 100, (0, 1), (50, 2), end=0.25), [(0, 1), (200, 2)], "example 5")


@play(FX3U, "5.6.5 transmission type", "5.6.7")
def fx3u_synchronous_pdos():
    """5.6.5: transmission types 0, 1 to 240 by SYNC; an RPDO of type 00H to F0H."""
    block = operational(5, 'objects = { "1800:02" = 3, "1801:02" = 0, "1400:02" = 0 }')
    block.b[11004] = 0x77
    block.exchange()
    block.bus.expect_none(0.05)
    for _ in range(3):
        block.bus.send("080")
        block.run(0.01)
    equal(block.bus.received("185", "285"), ["285 77 00 00 00 00 00 00 00", "185 00 00 00 00 00 00 00 00"])
    block.bus.send("205 AA 00 00 00 00 00 00 00")
    block.run(0.01)
    block.exchange()
    equal(block.b[10000], 0)
    block.bus.send("080")
    block.run(0.01)
    block.exchange()
    equal(block.b[10000], 0x00AA)


@play(FX3U, "5.6.5 event timer", "6.23")
def fx3u_rpdo_event_timer():
    """5.6.5: an RPDO that does not come within its event timer: EMCY 8250H with its number."""
    block = operational(5, 'objects = { "1400:05" = 100 }')
    block.bus.send("205 01 00 00 00 00 00 00 00")
    block.bus.expect("085 50 82 11 01 00 4F 44 50", within=0.2)


@play(FX3U, "5.6.7")
def fx3u_sync_producer():
    """5.6.7: 1006H, then bit 30 of 1005H; the active NMT master alone."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    block.sdo_write(OWN, 0x1006, 0, 10000, 4)
    block.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
    block.run(0.5)
    times = [frame.time for frame in block.bus.frames if frame.identifier == "080"][-40:]
    assert len(times) == 40 and all(abs(b - a - 0.01) < 0.0002 for a, b in zip(times, times[1:])), times
    block.rig.close()
    block = node()
    block.sdo_write(OWN, 0x1006, 0, 10000, 4)
    block.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
    block.run(0.5)
    equal(block.bus.received("080"), [])


@play(FX3U, "5.6.8 slave", "5.7")
def fx3u_node_guarding_slave_setting():
    """5.6.8, slave setting: 100CH, 100DH; toggle bit; life time."""
    block = node()
    block.sdo_write(OWN, 0x100C, 0, 100, 2)
    block.sdo_write(OWN, 0x100D, 0, 3, 1)
    block.bus.send("000 01 05")
    block.run(0.02)
    block.bus.discard()
    block.bus.send_remote("705", 1)
    block.bus.expect("705 05")
    block.bus.send_remote("705", 1)
    block.bus.expect("705 85")
    block.run(0.35)
    equal([bit(status_of(block, 5), 6), bit(block.b[25], 9)], [1, 0])


@play(FX3U, "5.6.8 master", "5.8.7", "5.8.10", "6.24")
def fx3u_node_guarding_master_setting():
    """5.6.8, master setting: 1F81H; 5.8.10: 1F83H stops and starts it."""
    block = master(0x01, ', "1F81:03" = 0x00640301')
    block.rig.until(lambda: bit(status_of(block, 3), 0), "guarding", 5)
    for state in ("05", "85") * 3:
        block.bus.send(f"703 {state}")
        block.run(0.1)
    equal(status_of(block, 3), 0b1)
    block.sdo_write(OWN, 0x1F83, 3, 0, 1)
    equal(block.sdo_read(OWN, 0x1F83, 3), 0)
    stopped = block.rig.time
    block.run(1)
    block.sdo_write(OWN, 0x1F83, 3, 1, 1)
    started = block.rig.time
    equal(block.sdo_read(OWN, 0x1F83, 3), 1)
    block.run(0.6)
    equal([bit(status_of(block, 3), 2), bit(status_of(block, 3), 3), bit(block.b[29], 10)], [1, 1, 1])
    times = [frame.time for frame in block.rig.remote_frames() if frame.identifier == "703"]
    assert not [time for time in times if stopped + 0.01 < time < started - 0.05], times


@play(FX3U, "5.6.11", "5.6.12", "10.6", "10.7")
def fx3u_store_and_restore_objects():
    """10.6: command 6000; 10.7: command 6010, in force after a restart; of a remote node, too."""
    block = node()
    block.sdo_write(OWN, 0x1017, 0, 200, 2)
    equal(block.command(0x6000, OWN, END)[0], 0x6001)
    block.restart()
    equal(block.sdo_read(OWN, 0x1017), 200)
    equal(block.command(0x6010, OWN, END)[0], 0x6011)
    equal(block.sdo_read(OWN, 0x1017), 200)
    block.restart()
    equal(block.sdo_read(OWN, 0x1017), 0)
    three = slave(block, 3)
    three.power_on()
    equal(block.command(0x6000, 3, END)[0], 0x6001)
    equal(block.command(0x6010, 3, END)[0], 0x6011)
    equal([value for *_, value in three.written], [0x65766173, 0x64616F6C])


@play(FX3U, "5.7")
def fx3u_error_behaviour():
    """5.7: 1029H after a heartbeat error of a slave."""
    for behaviour, state in ((0, 0x0100), (1, 0x0200), (2, 0x0000)):
        block = operational(5, f'objects = {{ "1029:01" = {behaviour}, "1016:01" = 0x000300C8 }}')
        block.bus.send("703 05")
        block.run(0.3)
        equal(block.b[25] & 0x0300, state, f"1029H = {behaviour}")
        block.rig.close()


@play(FX3U, "5.8.5", "5.8.6", "5.8.4")
def fx3u_individual_slave_start_up():
    """5.8.6: 1F81H, identification, boot time; the slave is asked for 1000H and 1018H and started; then the master."""
    block = master(0x01, ', "1F81:03" = 0x0D, "1F84:03" = 0x000F0191, "1F85:03" = 0x1234, "1F86:03" = 0x5678, '
                   '"1F87:03" = 0x00010001, "1F88:03" = 7, "1F89:00" = 10000')
    three = slave(block, 3)
    block.bus.expect("000 82 00", within=8)
    block.rig.until(lambda: bit(block.b[25], 14), "start-up", 2)
    three.power_on()
    block.bus.expect("603 40 00 10 00 00 00 00 00", "603 40 18 10 01 00 00 00 00", "603 40 18 10 02 00 00 00 00",
                     "603 40 18 10 03 00 00 00 00", "603 40 18 10 04 00 00 00 00", "000 01 03", within=3)
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 2)
    equal([bit(block.b[25], 15), bit(block.b[25], 14), bit(block.b[25], 11)], [1, 0, 0])


@play(FX3U, "5.8.6", "5.8.4")
def fx3u_slave_that_is_missing_or_another_one():
    """5.8.6: the request is repeated until the boot time is over; a wrong identity: #25 bit 11."""
    block = master(0x01, ', "1F81:03" = 0x0D, "1F89:00" = 4000')
    reset = block.bus.expect("000 82 00", within=8)
    block.rig.until(lambda: bit(block.b[25], 11), "start-up failed", 8)
    assert 3.9 < block.rig.time - reset.time < 5.2
    assert len(block.bus.received("603")) >= 2
    assert not [frame for frame in block.bus.received("000") if frame.startswith("000 01")]
    block.rig.close()
    block = master(0x01, ', "1F81:03" = 0x0D, "1F84:03" = 0x12345678')
    three = slave(block, 3)
    block.bus.expect("000 82 00", within=8)
    three.power_on()
    block.rig.until(lambda: bit(block.b[25], 11), "start-up failed", 3)
    assert "000 01 03" not in block.bus.received("000")


@play(FX3U, "5.8.6")
def fx3u_slave_is_asked_each_second():
    """5.8.6: the NMT master retries the request every 1 s."""
    block = master(0x01, ', "1F81:03" = 0x0D, "1F89:00" = 0')
    block.run(8)
    times = [frame.time for frame in block.bus.frames if str(frame).startswith("603 40 00 10 00")]
    assert all(abs(b - a - 1) < 0.05 for a, b in zip(times, times[1:])), times


@play(FX3U, "5.8.5")
def fx3u_master_start_and_node_start_bits():
    """5.8.5, 1F80H bit 2: Operational by 1F82H; bit 3: the program starts the slaves."""
    block = master(0x05, ', "1F81:03" = 0x0D')
    three = slave(block, 3)
    block.bus.expect("000 82 00", within=8)
    three.power_on()
    block.bus.answering(1.5)
    equal(block.b[25] & 0x0300, 0x0100)
    block.sdo_write(OWN, 0x1F82, 1, 5, 1)
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 1)
    block.rig.close()
    block = master(0x09, ', "1F81:03" = 0x0D')
    three = slave(block, 3)
    block.bus.expect("000 82 00", within=8)
    three.power_on()
    block.bus.answering(1.5)
    assert not [frame for frame in block.bus.received("000") if frame.startswith("000 01")]
    block.sdo_write(OWN, 0x1F82, 3, 5, 1)
    block.bus.expect("000 01 03")


@play(FX3U, "5.8.8")
def fx3u_error_event_handling():
    """5.8.8: what a lost slave causes, by its assignment and 1F80H bits 4 and 6; a boot-up message starts it again."""
    for configuration, assignment, frame in ((0x01, 0x05, "000 82 03"), (0x01, 0x0D, "000 82 03"), (0x11, 0x0D, "000 82 00"),
                                             (0x41, 0x0D, "000 02 00"), (0x51, 0x0D, "000 02 00")):
        block, three = booted(configuration, assignment)
        three.is_off = True
        block.bus.expect(frame, within=2)
        block.rig.close()
    block, three = booted()
    three.power_on()
    block.bus.expect("603 40 00 10 00 00 00 00 00", "000 01 03", within=2)


@play(FX3U, "5.8.9", "10.2.3")
def fx3u_request_nmt():
    """5.8.9: values of 1F82H; 10.2.3, example: the whole network Operational."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    for value, command in ((4, "02"), (5, "01"), (0x7F, "80"), (6, "81"), (7, "82")):
        block.bus.discard()
        block.sdo_write(OWN, 0x1F82, 3, value, 1)
        block.bus.expect(f"000 {command} 03", within=1, others=False)
    for value, command in ((0x84, "02"), (0x85, "01"), (0x86, "81"), (0x87, "82"), (0x8F, "80")):
        block.bus.discard()
        block.sdo_write(OWN, 0x1F82, 0x80, value, 1)
        block.bus.expect(f"000 {command} 00", within=1, others=False)
        equal(bit(block.b[25], 9), 1, "the master stays")
    block.bus.discard()
    result = block.command(2, OWN, 0x1F82, 0x80, 1, 5)
    equal(result[0:4], [3, OWN, 0x1F82, 0x80])
    block.bus.expect("000 01 00")


@play(FX3U, "5.8.11", "11 flying master")
def fx3u_flying_masters():
    """5.8.11: the lower node-ID of equal priorities wins; 11: RUN to STOP of the active master starts a negotiation."""
    objects = 'buffer = { G26 = 0 }\nobjects = { "1F80:00" = 0x21 }'
    rig = Rig(bus_text() + rack_text(objects, node=5, name="plc5") + rack_text(objects, node=6, name="plc6"))
    five, six = Block(rig, "plc5").ready(), Block(rig, "plc6").ready()
    rig.run(15 - rig.time)
    equal([bit(five.b[25], 15), bit(six.b[25], 15)], [1, 0])
    assert "000 82 00" in rig.bus.received("000")
    beats = [frame.time for frame in rig.bus.frames if frame.identifier == "705" and frame.data in ("05", "7F")][-5:]
    assert all(abs(b - a - 1) < 0.01 for a, b in zip(beats, beats[1:])), beats
    five.plc.remote_stop()
    rig.run(0.01)
    rig.bus.discard()
    rig.until(lambda: bit(six.b[25], 15), "node 6 is the master", 8)
    five.plc.remote_run()
    rig.run(10)
    equal(bit(five.b[25], 15) + bit(six.b[25], 15), 1, "one active master")


@play(FX3U, "5.8.12")
def fx3u_lss():
    """5.8.12: identification, 1F81H = 0DH, boot time: an LSS slave without node-ID gets it; #25 bit 10 meanwhile."""
    block = master(0x01, ', "1F81:0A" = 0x0D, "1F84:0A" = 0x000F0191, "1F85:0A" = 0x1234, "1F86:0A" = 0x0401, '
                   '"1F87:0A" = 0x00010000, "1F88:0A" = 7, "1F89:00" = 3000',
                   bus=f'[[device]]\nname = "block"\nnode = "unconfigured"\neds = "{DEVICES}/io-block.eds"\n'
                       'objects = { "1018:01" = 0x1234, "1018:04" = 7 }\n')
    block.rig.until(lambda: bit(block.b[25], 10), "LSS", 12)
    leds = block.rig.leds()
    equal([leds["RUN"], leds["ERROR"]], ["flickering", "flickering"], "14.1")
    block.bus.expect("7E5 40 34 12 00 00 00 00 00", "7E5 41 01 04 00 00 00 00 00", "7E5 42 00 00 01 00 00 00 00",
                     "7E5 43 07 00 00 00 00 00 00", "7E4 44 00 00 00 00 00 00 00", "7E5 11 0A 00 00 00 00 00 00", within=5)
    block.bus.expect("70A 00", within=5)


@play(FX3U, "5.8.13")
def fx3u_configuration_manager():
    """5.8.13: CDCF to 1F22H; at boot it goes to the slave; 1F25H "conf"; 1F26H and 1F27H against 1020H; deletion by 0."""
    block, three = booted()

    def download(*frames):
        for frame in frames:
            block.bus.send(f"601 {frame}")
            block.bus.answering(0.01)
        block.bus.answering(0.5)
        return block.bus.received("581")[-1]
    cdcf = ("21 22 1F 03 0D 00 00 00", "00 01 00 00 00 17 10 00", "13 02 00 00 00 F4 01 00")
    equal(download(*cdcf)[:6], "581 30")
    assert download(*cdcf)[4:6] == "80", "it has to be deleted first"
    block.sdo_write(OWN, 0x1F25, 3, 0x666E6F63, 4)
    block.bus.expect("603 2B 17 10 00 F4 01 00 00", within=2)
    result = block.command(2, OWN, 0x1F25, 4, 4, 0x6F63, 0x666E)
    equal([*result[0:2], *result[3:5]], [0x000F, 3, 0x0024, 0x0800], "no data are stored")
    block.sdo_write(OWN, 0x1F26, 3, 11245, 4)
    block.sdo_write(OWN, 0x1F27, 3, 45000000, 4)
    for date, downloads in ((11245, False), (11244, True)):
        three.objects[0x1020, 1], three.objects[0x1020, 2] = date.to_bytes(4, "little"), (45000000).to_bytes(4, "little")
        three.written.clear()
        block.bus.discard()
        three.power_on()
        block.bus.expect("000 01 03", within=3)
        equal((0x1017, 0, 500) in three.written, downloads)
    block.bus.send("601 2F 22 1F 03 00 00 00 00")
    block.bus.answering(0.1)
    assert download(*cdcf).endswith("00 00 06 06"), "busy while it erases"
    block.bus.answering(2)
    equal(download(*cdcf)[:6], "581 30")


# --- 7 CANopen 405 mode


@play(FX3U, "7.1.1", "7.1.2")
def fx3u_words_are_objects():
    """7.1.1, 7.1.2: the tables of words and objects; unmapped objects are not written."""
    block = operational()
    block.b[11000] = 0x1234
    block.exchange()
    equal([block.sdo_read(OWN, 0xA100, 1), block.sdo_read(OWN, 0xA040, 1), block.sdo_read(OWN, 0xA200, 1)], [0x1234, 0, 0],
          "data are copied into mapped objects alone")
    for index, sub, value, word, expected in ((0xA580, 1, 0x1234, 10000, 0x1234), (0xA580, 0x14, 0x2345, 10019, 0x2345),
                                              (0xA580, 0x15, 0x3456, 10020, 0x3456), (0xA580, 0x78, 0x4567, 10119, 0x4567),
                                              (0xA581, 1, 0x5678, 10120, 0x5678), (0xA582, 0x50, 0x6789, 10319, 0x6789)):
        block.sdo_write(OWN, index, sub, value, 2)
        block.exchange()
        equal(block.b[word], expected, f"{index:04X}H:{sub:02X}H is #{word}")
    equal([block.b[19], block.b[100], block.b[199], block.b[200], block.b[399]], [0x2345, 0x3456, 0x4567, 0x5678, 0x6789],
          "the same words at #19, #100, #199, #200 and #399")


@play(FX3U, "7.2.3", "7.2.1", "7.2.2")
def fx3u_mode_0_mapping():
    """7.2.3: 8900; tables 7.2.1 and 7.2.2."""
    block = node(5)
    block.sdo_write(OWN, 0x1800, 1, 0xC0000185, 4)
    block.b[11000] = 7
    equal(block.command(0x8900)[0], 0x8901)
    equal([block.sdo_read(OWN, 0x1800 + i, 1) & 0x800007FF for i in range(4)], [0x185, 0x285, 0x385, 0x485])
    equal([block.sdo_read(OWN, 0x1400 + i, 1) & 0x800007FF for i in range(4)], [0x205, 0x305, 0x405, 0x505])
    equal([block.sdo_read(OWN, first + i, 1) >> 31 for first in (0x1404, 0x1804) for i in (0, 75)], [1] * 4)
    equal([block.sdo_read(OWN, 0x1A00, sub) for sub in (1, 4)], [0xA1000110, 0xA1000410])


@play(FX3U, "7.2.4")
def fx3u_eight_stations_in_mode_a():
    """7.2.4: 8200 to each block; RPDO COB-IDs are fixed; 16 words of each station; a node above 8: 82FF."""
    nodes = (1, 2, 8)
    rig = Rig(bus_text() + "".join(rack_text("buffer = { G26 = 0 }", node=number, name=f"plc{number}") for number in nodes))
    blocks = {number: Block(rig, f"plc{number}").ready() for number in nodes}
    for block in blocks.values():
        equal(block.command(0x8200)[0], 0x8201)
    two = blocks[2]
    equal([two.sdo_read(OWN, index, 1) & 0x800007FF for index in (0x1400, 0x1403, 0x1404, 0x141F)], [0x181, 0x481, 0x182, 0x488])
    equal(two.sdo_read(OWN, 0x1420, 1) >> 31, 1)
    rig.bus.send("000 01 00")
    rig.run(0.05)
    for number, block in blocks.items():
        block.b[11000:11016] = [number << 8 | i for i in range(16)]
        block.exchange()
    rig.run(0.1)
    for reader, block in blocks.items():
        block.exchange()
        for number in nodes:
            if number != reader:
                first = 10000 + 16 * (number - 1)
                equal(block.b[first:first + 16], [number << 8 | i for i in range(16)], f"station {number}, read by {reader}")
    rig.close()
    equal(node(127).command(0x8200)[0], 0x82FF)


@play(FX3U, "7.2.5 prepare", "7.2.5 source and destination")
def fx3u_mode_b_binding():
    """7.2.5: reset by 0000/0000, then the example 1009 to 0203 hex."""
    block = node(1)
    result = block.command(0x8300, 0, 0, END)
    equal(result[0:3], [0x8301, 0, 0])
    equal([block.sdo_read(OWN, index, 1) >> 31 for index in (0x1400, 0x144F, 0x1804, 0x184F)], [1] * 4)
    block.bus.discard()
    block.bus.answers = {"610 40 08 18 01 00 00 00 00": "590 43 08 18 01 90 01 00 00",
                         "602 40 02 14 01 00 00 00 00": "582 43 02 14 01 02 04 00 00",
                         "602 23 02 14 01 90 01 00 80": "582 60 02 14 01 00 00 00 00",
                         "602 23 02 14 01 90 01 00 00": "582 60 02 14 01 00 00 00 00"}
    equal(block.command(0x8300, 0x1009, 0x0203, END)[0:3], [0x8301, 0, 0])
    block.bus.expect("610 40 08 18 01 00 00 00 00", "602 40 02 14 01 00 00 00 00", "602 23 02 14 01 90 01 00 00")


@play(FX3U, "7.2.5 additional COB-IDs")
def fx3u_mode_b_occupies_a_cob_id():
    """7.2.5: 7F01 / 8005 hex: TPDO 5 with 1FF hex."""
    block = node(1)
    equal(block.command(0x8300, 0x7F01, 0x8005, END)[0:3], [0x8301, 0, 0])
    block.bus.send("000 01 01")
    block.run(0.02)
    block.bus.discard()
    block.b[11016:11020] = [1, 2, 3, 4]
    block.exchange()
    block.bus.expect("1FF 01 00 02 00 03 00 04 00")


@play(FX3U, "7.2.6")
def fx3u_mode_b_errors():
    """7.2.6: which parameter caused the error; source and destination errors."""
    block = node(1)
    result = block.command(0x8300, 0x0001, 0x0001, 0x0002, 0x0002, 0x0003, 0x0003, 0x0004, 0x0004, 0x0100, 0x0005, END)
    equal([result[0], *result[1:9]], [0x83FF] + [0] * 8)
    assert result[9], "the fifth source"
    equal(block.command(0x8300, 0x0301, 0x0001, END)[0:3], [0x83FF, 0x0300, 0xFFFF])
    equal(block.command(0x8300, 0x8001, 0x0001, END)[0:2], [0x83FF, 0xFFFF])
    block.bus.answers = {"602 40 04 18 01 00 00 00 00": "582 43 04 18 01 00 00 00 80"}
    equal(block.command(0x8300, 0x0205, 0x0001, END)[0:2], [0x83FF, 0x0005])
    for source, destination in ((0x7F05, 0x8005), (0x7F01, 0x8004)):     # 7.2.6, 3
        result = block.command(0x8300, source, destination, END)
        equal(result[0], 0x83FF)
        assert result[1] or result[2], "the parameter that is not set properly"


# --- 10 Command interface


@play(FX3U, "10.2.1")
def fx3u_sdo_read_access():
    """10.2.1: command 0004."""
    block = node()
    equal(block.command(4, OWN, 0x1018, 2)[0:7], [5, OWN, 0x1018, 2, 4, 7170, 0])
    equal(block.command(4, OWN, 0x1008, 0)[0:9], [5, OWN, 0x1008, 0, 8, 0x5846, 0x5533, 0x432D, 0x4E41], "FX3U-CAN")
    equal(block.command(4, 5, 0x1000, 0)[0:2], [5, 5], "its actual node number")
    block.bus.answers = {"609 40 00 10 00 00 00 00 00": "589 43 00 10 00 91 01 0F 00"}
    equal(block.command(4, 9, 0x1000, 0)[0:7], [5, 9, 0x1000, 0, 4, 0x0191, 0x000F])


@play(FX3U, "10.2.2")
def fx3u_multi_sdo_read_access():
    """10.2.2: command 0008; 0009, or 00F9 with 0F00 in the message that failed."""
    block = node()
    parameters = [OWN, 0x1000, 0, 0, 0, 0, 0, 0, OWN, 0x2000, 0, 0, 0, 0, 0, 0, END]
    result = block.command(8, *parameters)
    equal([result[0], result[1], *result[4:7]], [0x00F9, OWN, 4, 0x0195, 0])
    equal([result[9], result[12], result[13], result[14]], [0x0F00, 0, 0x0000, 0x0602])
    parameters[9:11] = [0x1018, 1]
    equal(block.command(8, *parameters)[0], 0x0009)


@play(FX3U, "10.2.4")
def fx3u_multi_sdo_write_access():
    """10.2.4: command 0006; 0007, or 00F7."""
    block = node()
    parameters = [OWN, 0x1017, 0, 2, 100, 0, 0, 0, OWN, 0x1008, 0, 2, 0x4141, 0, 0, 0, END]
    result = block.command(6, *parameters)
    equal([result[0], result[9], result[13], result[14]], [0x00F7, 0x0F00, 0x0002, 0x0601])
    equal(block.sdo_read(OWN, 0x1017), 100)
    parameters[8] = END
    equal(block.command(6, *parameters)[0], 0x0007)


@play(FX3U, "10.3 producing", "10.3 consuming")
def fx3u_set_heartbeat():
    """10.3: 7410 for producers, 7400 for consumers."""
    block = node()
    three = slave(block, 3)
    three.power_on()
    equal(block.command(0x7410, 3, 1000, OWN, 200, END)[0], 0x7411)
    block.bus.expect("603 2B 17 10 00 E8 03 00 00")
    equal(block.sdo_read(OWN, 0x1017), 200)
    equal(block.command(0x7400, 3, 5, 1500, END)[0], 0x7401)
    block.bus.expect("603 23 16 10 01 DC 05 05 00")
    equal(block.command(0x7400, OWN, 3, 1500, END)[0], 0x7401)
    equal(block.sdo_read(OWN, 0x1016, 1), 0x000305DC)
    result = block.command(0x7410, 9, 1000, END)
    equal(result[0], 0x741F, "node 9 does not answer")
    assert result[1]


@play(FX3U, "10.4")
def fx3u_set_node_guarding():
    """10.4: 8400; 1F81H of the master, 100CH and 100DH of the slave; a slave number above 127."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    three = slave(block, 3)
    three.power_on()
    equal(block.command(0x8400, 3, 1, 200, 3, END)[0:5], [0x8401, 0, 0, 0, 0])
    block.bus.expect("603 2B 0C 10 00 C8 00 00 00", "603 2F 0D 10 00 03 00 00 00")
    equal(block.sdo_read(OWN, 0x1F81, 3), 0x00C80301)
    result = block.command(0x8400, 200, 1, 200, 3, END)
    equal(result[0], 0x84FF)
    assert result[1] in (200, 0xFFFF)


@play(FX3U, "10.5", "5.6.13")
def fx3u_sends_an_emergency_message():
    """10.5: 000A; 000C with 1 in the inhibit time, with 2 in Stopped."""
    block = node()
    block.bus.discard()
    equal(block.command(0x000A, 0x1000, 0xA101, 0xA3A2, 0xA5A4)[0:2], [0x000B, 0])
    block.bus.expect("085 00 10 01 A1 A2 A3 A4 A5", others=False)
    equal([block.sdo_read(OWN, 0x1003, 1) & 0xFFFF, block.sdo_read(OWN, 0x1001)], [0x1000, 1])
    block.sdo_write(OWN, 0x1015, 0, 10000, 2)
    block.command(0x000A, 0x1000, 1, 0, 0)
    equal(block.command(0x000A, 0x1000, 1, 0, 0)[0:2], [0x000C, 1])
    block.bus.send("000 02 05")
    block.run(2)
    equal(block.command(0x000A, 0x1000, 1, 0, 0)[0:2], [0x000C, 2])


@play(FX3U, "10.8")
def fx3u_display_current_parameter():
    """10.8: command 0000."""
    block = node()
    block.command(4, 9, 0x1000, 2)
    equal(block.command(0)[0:4], [0, 9, 0x1000, 2])


@play(FX3U, "10.9.1 1", "10.9.1 3", "10.9.1 4", "10.9.2")
def fx3u_busy_command_interface():
    """10.9.1: unknown command; a change while busy, and its FFFF; 10.9.2: a running command is discontinued by FFFF."""
    block = node()
    equal(block.command(0x1234)[0:2], [0x000F, 0x0064])
    block.b[1001:1004] = [9, 0x1000, 0]
    block.b[1000] = 4
    equal(block.b[1000], 0xFFFF)
    block.b[1001] = 1
    equal(block.b[1000:1002], [0x000F, 0xFFFF])
    block.b[1000] = 0xFFFF
    block.rig.until(lambda: block.b[1000] == 0, "cleared", 0.1)
    block.b[1001:1004] = [9, 0x1000, 0]
    block.b[1000] = 4
    equal(block.b[1000], 0xFFFF)
    block.b[1000] = 0xFFFF
    block.rig.until(lambda: block.b[1000] == 0, "discontinued", 0.1)
    equal(block.command(4, OWN, 0x1000, 0)[0], 5)


@play(FX3U, "10.9.1 2", "9.7")
def fx3u_transmission_queue_is_full():
    """10.9.1, 2: the access to the transmission queue was rejected: no node acknowledges, so that nothing leaves it."""
    block = rack(buffer="G21 = 11, G26 = 0", peer=False).ready()
    block.b[25] = 0x0010
    block.rig.until(lambda: bit(block.b[25], 0), "online", 2)
    results = []
    for _ in range(300):
        results.append(block.command(0x000C, 0x0333, 0, 0, 1, 0x11)[0:2])
        if results[-1][0] == 0x000F:
            break
    equal(results[-1], [0x000F, 0x8FFF])


@play(FX3U, "14.2", "6.6")
def fx3u_flash_memory_error():
    """14.2, bit 4: power loss during a write operation to the Flash ROM."""
    block = rack(buffer="").ready()
    block.b[70] = 900
    block.b[22] = 1
    block.run(0.003)
    equal(block.b[22], 1, "the save is in progress")
    block.rig.power_cycle()
    block.ready()
    equal([bit(block.b[29], 4), bit(block.b[29], 0), block.b[70]], [1, 1, 500])
    block.save()
    block.restart()
    equal(block.b[29], 0)


@play(FX3U, "10.9.1 7")
def fx3u_device_in_wrong_state():
    """10.9.1, 7: class 0F0F."""
    block = node()
    equal(block.command(0x8400, 3, 1, 200, 3, END)[0:2], [0x000F, 0x0F0F], "no NMT master")


# --- 11, 12.1, 13, 14


@play(FX3U, "11 slave", "6.23")
def fx3u_run_stop_of_an_nmt_slave():
    """11, 1: RUN to STOP: the state of 1029H, EMCY (FX002); STOP to RUN: it stays."""
    block = operational()
    block.plc.remote_stop()
    block.run(0.02)
    frames = block.bus.received("085")
    assert frames[-1].startswith("085 00 FF") and frames[-1].endswith("32 30 30 58 46"), frames
    equal(block.b[25] & 0x0300, 0x0100)
    block.plc.remote_run()
    block.run(0.1)
    equal(block.b[25] & 0x0300, 0x0100)


@play(FX3U, "11 slave", "5.8.2")
def fx3u_power_up_in_stop():
    """11, 5.8.1: EMCY belongs to Pre-operational and Operational; the boot-up message comes first."""
    block = rack(node=5, plc='cpu = "stop"').ready()
    block.run(1)
    frames = block.bus.received("705", "085")
    assert len(frames) > 1, frames
    equal(frames[0], "705 00")


@play(FX3U, "11 master")
def fx3u_run_stop_of_an_nmt_master():
    """11, 2: NMT master, heartbeat and guarding stop; STOP to RUN: NMT master start-up."""
    block, _ = booted()
    block.sdo_write(OWN, 0x1017, 0, 100, 2)
    block.plc.remote_stop()
    block.bus.answering(0.1)
    block.bus.discard()
    block.bus.expect_none(1, "701", "000")
    block.plc.remote_run()
    block.bus.expect("000 82 00", "000 01 03", within=5)


@play(FX3U, "12.1", "1.4")
def fx3u_communication_settings_procedure_405():
    """12.1, flow chart (its figure is lost): mode, rate, node-ID, save, restart; mapping; NMT and heartbeat; store; restart; exchange."""
    block = rack(buffer="").ready()
    block.b[21] = 405
    block.b[24] = 250
    block.b[26] = 0
    block.b[27] = 1
    block.save()
    block.bus.discard()
    block.restart()
    block.bus.expect("701 00", within=0.2)
    equal(block.command(0x8900)[0], 0x8901)                 # PDO mapping
    for communication, mapping, entry, cob_id in ((0x1400, 0x1600, 0xA5800110, 0x183), (0x1800, 0x1A00, 0xA1000110, 0x40000203)):
        block.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        block.sdo_write(OWN, mapping, 0, 0, 1)
        block.sdo_write(OWN, mapping, 1, entry, 4)
        block.sdo_write(OWN, mapping, 0, 1, 1)
        block.sdo_write(OWN, communication, 1, cob_id, 4)
    block.sdo_write(OWN, 0x1F80, 0, 1, 4)                   # NMT master, slave, heartbeat
    block.sdo_write(OWN, 0x1F81, 3, 0x0D, 4)
    block.sdo_write(OWN, 0x1F84, 3, 0x000F0191, 4)
    block.sdo_write(OWN, 0x1016, 1, 0x000305DC, 4)
    block.store_objects()
    three = slave(block, 3)
    three.heartbeat = 0.2
    block.restart()
    three.power_on()
    block.bus.expect("000 01 03", within=4)
    block.rig.until(lambda: bit(block.b[25], 9) and block.b[603] == 5, "Operational", 3)
    block.bus.send("183 34 12")
    block.run(0.01)
    block.b[11000] = 0x5678
    block.exchange()
    block.bus.expect("203 78 56")
    equal(block.b[10000], 0x1234)


@play(FX3U, "13.1", "13.2", "13.3")
def fx3u_program_example():
    """13: the ladder figures are lost; the order is that of the labels of 13.2 and of the captions 28 to 39 (the module's page has
    it): initialise, master, slave, heartbeats, 6423 of node 3, four PDOs, NMT request, cyclic exchange."""
    block = rack(buffer="").ready()
    block.b[24] = 250                                       # CANopenInit
    block.b[26] = 0
    block.b[27] = 1
    block.save()
    block.restart()
    station = slave(block, 3)
    block.sdo_write(OWN, 0x1F80, 0, 0x09, 4)                # NMTMasterSettings
    block.store_objects()
    block.restart()
    station.power_on()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    equal(block.command(0x8400, 3, 0x0D, 0, 0, END)[0], 0x8401)    # NMTSlaveSettings
    equal(block.command(0x7410, OWN, 500, 3, 200, END)[0], 0x7411)  # HeartbeatProducerSetup
    equal(block.command(0x7400, OWN, 3, 1000, END)[0], 0x7401)     # HeartbeatConsumerSetup
    block.rig.until(lambda: bit(status_of(block, 3), 1), "STliteHeartbeatActive", 2)
    block.sdo_write(3, 0x6423, 0, 1, 1)                     # 28 to 32
    equal(station.objects[0x6423, 0], b"\1")
    for communication, mapping, entry, cob_id in ((0x1400, 0x1600, 0xA5800110, 0x183), (0x1401, 0x1601, 0xA5800510, 0x283),
                                                  (0x1800, 0x1A00, 0xA1000110, 0x40000203), (0x1801, 0x1A01, 0xA1000510, 0x40000303)):
        block.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)   # 37 to 39: PDOSetup
        block.sdo_write(OWN, communication, 2, 0xFE, 1)
        block.sdo_write(OWN, mapping, 0, 0, 1)
        block.sdo_write(OWN, mapping, 1, entry, 4)
        block.sdo_write(OWN, mapping, 0, 1, 1)
        block.sdo_write(OWN, communication, 1, cob_id, 4)
    block.bus.discard()
    block.sdo_write(OWN, 0x1F82, 0x80, 5, 1)                # NMTRequestWrite
    block.bus.expect("000 01 00", within=1)
    block.rig.until(lambda: [block.b[601], block.b[603]] == [5, 5], "STliteOperational", 2)
    for value in (1, 2, 3):                                 # PDORead, PDOWrite
        block.bus.send(f"183 {value:02X} 00", f"283 {value:02X} 10")
        block.run(0.01)
        block.b[11000] = 0x100 + value
        block.b[11004] = 0x200 + value
        block.exchange()
        block.bus.expect(f"203 {value:02X} 01")
        block.bus.expect(f"303 {value:02X} 02")
        equal([block.b[10000], block.b[10004]], [value, 0x1000 + value])
    station.is_off = True                                # HeartbeatStatus, ErrorReset
    block.rig.until(lambda: bit(block.b[29], 10), "heartbeat lost", 2)
    equal(bit(status_of(block, 3), 7), 1)
    station.is_off = False
    block.bus.answering(0.3)
    block.b[29] = 0
    equal(bit(status_of(block, 3), 7), 0)


@play(FX3U, "14.1")
def fx3u_leds():
    """14.1: RUN and ERROR LED in each state."""
    block = node()
    leds = block.rig.leds
    equal([leds()["RUN"], leds()["ERROR"]], ["blinking", "off"])
    for command, pattern in (("01", "on"), ("02", "single flash")):
        block.bus.send(f"000 {command} 05")
        block.run(0.05)
        equal(leds()["RUN"], pattern)
    block.sdo_write(OWN, 0x1016, 1, 0x000300C8, 4)
    block.bus.send("703 05")
    block.run(0.3)
    equal(leds()["ERROR"], "double flash", "a heartbeat failure")


@play(FX3U, "14.2", "6.4")
def fx3u_internal_queue_overflow():
    """14.2, bit 8: data exchange that is too fast at a low rate; latched."""
    block = rack(node=5, bit_rate=10_000).ready()
    block.bus.send("000 01 05")
    block.run(0.1)
    for value in range(1, 400):
        block.b[11000] = value
        block.b[20] = 1
        block.run(0.001)
        if bit(block.b[29], 8):
            break
    equal([bit(block.b[29], 8), bit(block.b[29], 0)], [1, 1])
    block.run(5)
    equal(bit(block.b[29], 8), 1)
    block.b[29] = 0
    equal(bit(block.b[29], 8), 0)


@play(FX3U, "14.2", "10.7")
def fx3u_hardware_error():
    """14.2, bit 1: not cleared by a restart, judged anew at a power cycle."""
    block = rack('fault = "hardware error"\nfault_at = "3s"', node=5).ready()
    block.run(3.1 - block.rig.time)
    equal([bit(block.b[29], 1), bit(block.b[29], 0)], [1, 1])
    block.b[29] = 0
    equal(bit(block.b[29], 1), 1)


@play(FX3U, "14.2", "6.23")
def fx3u_emergency_of_an_assigned_slave():
    """14.2, bit 13: of an assigned slave; not of another node."""
    block, _ = booted()
    block.bus.send("084 00 10 01 00 00 00 00 00")
    block.run(0.01)
    equal(bit(block.b[29], 13), 0)
    block.bus.send("083 00 10 01 00 00 00 00 00")
    block.run(0.01)
    equal(bit(block.b[29], 13), 1)
    block.b[29] = 0
    equal(bit(block.b[29], 13), 0)


@play(FX3U, "14.2 module failures", "10.7", "5.6.12")
def fx3u_module_that_stays_in_initial_status():
    """14.2, module failures: reset the object dictionary by the command interface (10.7), then restart (6.8)."""
    block = node(5)
    block.sdo_write(OWN, 0x1800, 1, 0xC0000185, 4)
    block.sdo_write(OWN, 0x1A00, 0, 0, 1)
    block.store_objects()
    equal(block.command(0x6010, OWN, END)[0], 0x6011)
    block.restart()
    equal([block.sdo_read(OWN, 0x1A00, 0), block.sdo_read(OWN, 0x1800, 1)], [4, 0x40000185])


# --- what notes of 6 and 10 say besides


@play(FX3U, "6.19 set", "6.19 read")
def fx3u_year_and_moment_of_the_clock():
    """6.19: K1984 is the year 2084; a date that is not valid does not set the clock; #51 to #57 are of the moment when #51 is read."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    block.b[50] = 2
    for number, value in ((51, 1984), (52, 12), (53, 31), (54, 23), (55, 59), (56, 50)):
        block.b[number] = value
    block.run(5.05)
    equal([block.b[51], block.b[56]], [84, 55])
    block.run(2)
    equal(block.b[56], 55, "not before #51 is read again")
    block.run(4)
    equal([block.b[51], block.b[52], block.b[53], block.b[54]], [85, 1, 1, 0])
    for number, value in ((51, 12), (52, 2), (53, 30), (54, 1), (55, 1), (56, 1)):
        block.b[number] = value
    equal(bit(block.b[29], 6), 1)
    block.run(0.1)
    equal(block.b[51], 85, "the clock will not be set")


@play(FX3U, "6.8", "5.8.6")
def fx3u_optional_slave_that_is_missing():
    """6.8, bits 13 and 14: an optional slave that cannot be started; the network starts without it."""
    block = master(0x01, ', "1F81:03" = 0x05, "1F85:03" = 0x9999')
    three = slave(block, 3)
    block.bus.expect("000 82 00", within=8)
    three.power_on()
    block.rig.until(lambda: bit(block.b[25], 13), "optional slave start-up failure", 5)
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 2)
    equal([bit(block.b[25], 11), bit(block.b[25], 15)], [0, 1])
    assert "000 01 03" not in block.bus.received("000")


@play(FX3U, "6.9")
def fx3u_words_that_restart_the_watchdog():
    """6.9: FROM and TO of #0 to #19 and #100 to #399 count, those of other BFM do not."""
    block = operational(buffer="")
    for number in (0, 19, 100, 399):
        block.b[0] = 1
        for _ in range(3):
            block.run(0.15)
            block.b[number]                                 # FROM
        equal(bit(block.b[29], 7), 0, f"#{number}")
    block.run(0.15)
    equal([block.b[30], block.b[27]], [7170, 5])
    block.run(0.1)
    equal(bit(block.b[29], 7), 1, "#30 and #27 are no data")


@play(FX3U, "10.3 producing")
def fx3u_heartbeat_of_33_nodes():
    """10.3, 1: 33 target nodes fill #1001 to #1066: no HFFFF behind them."""
    block = node(1)
    block.bus.answers = {f"{0x600 + each:03X} 2B 17 10 00 {each:02X} 01 00 00": f"{0x580 + each:03X} 60 17 10 00 00 00 00 00"
                         for each in range(10, 43)}
    result = block.command(0x7410, *sum(([each, 0x100 + each] for each in range(10, 43)), []), within=20)
    equal(result, [0x7411] + [0] * 66)
    equal(len(block.bus.received(*(f"{0x600 + each:03X}" for each in range(10, 43)))), 33)


@play(FX3U, "10.4")
def fx3u_node_guarding_notes():
    """10.4, note: a node number above K127 is displayed; a retry factor above 255; parameters that are just copied."""
    block = master()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    equal(block.command(0x8400, 200, 1, 100, 3, END)[0:2], [0x84FF, 200], "the value which caused the problem")
    result = block.command(0x8400, 5, 1, 100, 300, END)
    equal(result[0], 0x84FF)
    assert result[4], "retry factor"
    block.bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 80 0C 10 00 00 00 02 06", "605 2F 0D 10 00 03 00 00 00": "585 80 0D 10 00 00 00 02 06"}
    equal(block.command(0x8400, 5, 1, 100, 3, END)[1:5], [5, 1, 100, 3], "no 100C and 100D in the remote node")


@play(FX3U, "10.4")
def fx3u_guards_a_slave_that_is_assigned_at_once():
    """10.4: slaves have been assigned (8401) as soon as the master takes commands; 5.8.7: it sends guarding requests."""
    block = master()
    three = slave(block, 3)
    three.is_off = False
    block.bus.expect("000 82 00", within=8)
    block.bus.answering(0.1)                                # the slave is there again, with its boot-up message
    assert not bit(block.b[25], 9), "the master's own start-up is not over yet"
    equal(block.command(0x8400, 3, 1, 100, 3, END)[0], 0x8401)
    block.bus.answering(2)
    assert [frame for frame in block.rig.remote_frames() if frame.identifier == "703"]


@play(FX3U, "10.7", "10.6")
def fx3u_store_between_restore_and_reset():
    """10.7: "Do not use the Store Object Dictionary Settings command between": the old values stay."""
    block = node()
    block.sdo_write(OWN, 0x1017, 0, 200, 2)
    equal(block.command(0x6000, OWN, END)[0], 0x6001)
    equal(block.command(0x6010, OWN, END)[0], 0x6011)
    equal(block.command(0x6000, OWN, END)[0], 0x6001)
    block.restart()
    equal(block.sdo_read(OWN, 0x1017), 200)


@play(FX3U, "10.8")
def fx3u_new_parameter_beside_the_displayed_ones():
    """10.8, *1: when a new parameter is written, those of the last command are displayed except for the one that was written."""
    block = node()
    block.command(4, 9, 0x1000, 2)
    block.command(0)
    block.b[1002] = 0x1018
    equal(block.b[1001:1004], [9, 0x1018, 2])
