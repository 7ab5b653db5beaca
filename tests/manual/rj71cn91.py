"""Plays of the MELSEC iQ-R CANopen Module User's Manual (Application), RJ71CN91. Start I/O number 0, as in the manual's examples."""
from signals import NONE, OWN, Module, rack as rack_of, slave
from rig import DEVICES, Rig, bit, equal, play

RJ = "RJ71CN91"


def rack(settings="", **options):
    return rack_of(RJ, settings, head=0, **options)


def node(number=3, settings="", **options):
    """An NMT slave with this node-ID, Pre-operational."""
    module = rack(settings, node=number, **options).ready()
    if module.bus:
        module.bus.expect(f"{0x700 + number:03X} 00", within=8)
    return module


def operational(number=3, settings="", **options):
    module = node(number, settings, **options)
    module.bus.send(f"000 01 {number:02X}")
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 1)
    module.bus.discard()
    return module


def master(configuration=0x01, more_objects="", settings="", **options):
    """The NMT master, node 127, with this 1F80H."""
    return rack(f'objects = {{ "1F80:00" = {configuration}{more_objects} }}\n{settings}', node=127, **options).ready()


def booted(configuration=0x01, assignment=0x0D, more_objects=""):
    """A master that has started slave 5, whose heartbeat it watches."""
    module = master(configuration, f', "1F81:05" = {assignment}, "1016:01" = 0x000505DC{more_objects}')
    five = slave(module, 5)
    five.heartbeat = 0.2
    module.bus.expect("000 82 00", within=8)
    five.power_on()
    module.bus.expect("000 01 05", within=3)
    module.rig.until(lambda: bit(module.g[25], 9) and module.g[605] == 5, "Operational", 3)
    module.bus.discard()
    return module, five


def layer2(mode=11, bit_rate=250_000, **words):
    saved = ", ".join(f"{name} = {value}" for name, value in {"G21": mode, **words}.items())
    return rack(f"buffer = {{ {saved} }}", bit_rate=bit_rate).ready()


def online(module):
    module.y(0x03, True)
    module.until_x(0x03)
    module.run(0.05)                                        # each slot is sent once at the transition to online (1.11)
    module.bus.discard()


# --- 1.2 NMT


@play(RJ, "1.2 NMT state")
def rj_nmt_states():
    """1.2 NMT state: boot-up, and the states that node control brings; Un\\G25, Un\\G601."""
    module = node()
    equal([module.g[25] & 0x0300, module.g[603]], [0x0100, 0x7F])
    for command, status, state in (("01", 0x0200, 5), ("02", 0x0000, 4), ("80", 0x0100, 0x7F)):
        module.bus.send(f"000 {command} 00")
        module.run(0.02)
        equal([module.g[25] & 0x0300, module.g[603]], [status, state])


@play(RJ, "1.2 Node control", "App. 3 Request NMT")
def rj_node_control_by_request_nmt():
    """1.2 Node control: 1F82H of the active NMT master by SDO, for one node and all, with and without the master."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    for value, command in ((0x05, "01"), (0x04, "02"), (0x7F, "80"), (0x06, "81"), (0x07, "82")):
        module.bus.discard()
        module.sdo_write(OWN, 0x1F82, 5, value, 1)
        module.bus.expect(f"000 {command} 05", within=1, others=False)
    for value, command in ((0x85, "01"), (0x84, "02"), (0x8F, "80"), (0x86, "81"), (0x87, "82")):
        module.bus.discard()
        module.sdo_write(OWN, 0x1F82, 0x80, value, 1)
        module.bus.expect(f"000 {command} 00", within=1, others=False)
        equal(module.g[25] & 0x0300, 0x0200, "excluding NMT master")
    module.sdo_write(OWN, 0x1F82, 0x80, 0x7F, 1)
    module.rig.until(lambda: module.g[25] & 0x0300 == 0x0100, "the master itself, too", 1)
    module.bus.send("000 01 00")
    module.run(0.05)
    equal(module.g[25] & 0x0300, 0x0100, "all-nodes commands of others are not the active master's")


@play(RJ, "1.2 NMT start-up")
def rj_nmt_start_up_step_by_step():
    """1.2 NMT start-up, steps 1 to 8: communication reset of all, boot of the slaves, remote node start, own state."""
    module = master(0x01, ', "1F81:05" = 0x0D, "1F84:05" = 0x000F0191')
    five = slave(module, 5)
    module.bus.expect("000 82 00", within=8)                # 4
    module.rig.until(lambda: bit(module.g[25], 14), "NMT start-up in progress", 2)
    five.power_on()                                         # 5
    module.bus.expect("605 40 00 10 00 00 00 00 00", "000 01 05", within=3)
    module.rig.until(lambda: bit(module.g[25], 9), "7: Operational automatically", 2)
    equal([bit(module.g[25], 14), bit(module.g[25], 11), bit(module.g[25], 15)], [0, 0, 1])


@play(RJ, "1.2 NMT start-up")
def rj_all_slaves_start_at_once():
    """1.2 NMT start-up, step 9: "Start all nodes"; a slave that failed: remote node start for each that succeeded."""
    module = master(0x03, ', "1F81:05" = 0x0D, "1F81:06" = 0x0D')
    nodes = [slave(module, number) for number in (5, 6)]
    module.bus.expect("000 82 00", within=8)
    for each in nodes:
        each.power_on()
    module.bus.expect("000 01 00", within=3)
    module.bus.answering(0.2)
    equal([frame for frame in module.bus.received("000") if frame.startswith("000 01")], ["000 01 00"])
    module.rig.close()
    module = master(0x03, ', "1F81:05" = 0x0D, "1F81:06" = 0x05, "1F85:06" = 0x9999')
    nodes = [slave(module, number) for number in (5, 6)]
    module.bus.expect("000 82 00", within=8)
    for each in nodes:
        each.power_on()
    module.bus.expect("000 01 05", within=3)
    module.bus.answering(0.5)
    starts = [frame for frame in module.bus.received("000") if frame.startswith("000 01")]
    assert "000 01 00" not in starts and "000 01 06" not in starts, starts


@play(RJ, "1.2 NMT start-up", "App. 3 NMT start-up")
def rj_master_that_starts_neither_itself_nor_the_slaves():
    """1.2 NMT start-up, step 7: "NMT master start" disabled: stopped until it is Operational; "Start node" disabled: the program starts."""
    module = master(0x05, ', "1F81:05" = 0x0D')
    five = slave(module, 5)
    module.bus.expect("000 82 00", within=8)
    five.power_on()
    module.bus.answering(2)
    equal(module.g[25] & 0x0300, 0x0100)
    module.sdo_write(OWN, 0x1F82, 127, 5, 1)
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 1)
    module.rig.close()
    module = master(0x09, ', "1F81:05" = 0x0D')
    five = slave(module, 5)
    module.bus.expect("000 82 00", within=8)
    five.power_on()
    module.bus.answering(2)
    assert not [frame for frame in module.bus.received("000") if frame.startswith("000 01")]
    module.bus.discard()
    module.sdo_write(OWN, 0x1F82, 5, 5, 1)
    module.bus.expect("000 01 05")


@play(RJ, "App. 2 G70", "1.2 NMT start-up")
def rj_interval_of_node_control_messages():
    """App. 2, Un\\G70: the minimum interval of node control messages, 500 ms: from the reset to the start of a slave."""
    module = master(0x01, ', "1F81:05" = 0x0D')
    five = slave(module, 5)
    reset = module.bus.expect("000 82 00", within=8)
    five.power_on()
    start = module.bus.expect("000 01 05", within=3)
    assert start.time - reset.time > 0.499, f"{start.time - reset.time} s"


@play(RJ, "1.2 NMT start-up", "App. 3 NMT slave assignment")
def rj_slave_that_is_kept_alive():
    """1.2 NMT start-up, step 4: a slave whose communication reset condition is disabled: reset of the other slaves, one by one."""
    module = master(0x01, ', "1F81:05" = 0x05, "1F81:06" = 0x15')
    six = slave(module, 6)
    six.power_on()
    six.state = 5
    six.heartbeat = 0.1
    module.bus.answering(2)
    resets = [frame for frame in module.bus.received("000") if frame.startswith("000 82")]
    assert "000 82 05" in resets and "000 82 00" not in resets and "000 82 06" not in resets, resets


@play(RJ, "1.2 NMT start-up")
def rj_slave_that_is_kept_alive_and_unassigned_nodes():
    """1.2 NMT start-up, step 4: "execute a communication reset for each NMT slave": not for nodes that are none."""
    module = master(0x01, ', "1F81:05" = 0x05, "1F81:06" = 0x15')
    module.run(3)
    equal([frame for frame in module.bus.received("000") if frame.startswith("000 82")], ["000 82 05"])


@play(RJ, "1.2 NMT start-up", "5.4 NMT state not Operational", "App. 3 Boot time")
def rj_boot_time_is_over():
    """1.2 NMT start-up, steps 5 and 6; 5.4: a mandatory slave that is absent fails the start-up after the boot time; the master must be reset."""
    module = master(0x01, ', "1F81:05" = 0x0D, "1F89:00" = 2000')
    reset = module.bus.expect("000 82 00", within=8)
    module.rig.until(lambda: bit(module.g[25], 11), "start-up failed", 5)
    assert 1.9 < module.rig.time - reset.time < 3.2, module.rig.time - reset.time
    assert not [frame for frame in module.bus.received("000") if frame.startswith("000 01")]
    five = slave(module, 5)
    module.bus.discard()
    module.restart()                                        # reset the NMT master
    five.power_on()
    module.bus.expect("000 01 05", within=4)


@play(RJ, "1.2 NMT slave identification", "App. 3 Device Type", "App. 3 Vendor identification", "App. 3 Revision number")
def rj_nmt_slave_identification():
    """1.2 NMT slave identification: 0 is not compared; major revision the same, minor revision the same or above."""
    for entry, revision, succeeds in (('"1F84:05" = 0x000F0191', "01000100", True), ('"1F84:05" = 0x12', "01000100", False),
                                      ('"1F85:05" = 0x1234', "01000100", True), ('"1F88:05" = 8', "01000100", False),
                                      ('"1F87:05" = 0x00010002', "01000100", False), ('"1F87:05" = 0x00010002', "02000100", True),
                                      ('"1F87:05" = 0x00010002', "07000100", True), ('"1F87:05" = 0x00010002', "00000200", False)):
        module = master(0x01, f', "1F81:05" = 0x0D, {entry}')
        five = slave(module, 5)
        five.objects[0x1018, 3] = bytes.fromhex(revision)
        module.bus.expect("000 82 00", within=8)
        five.power_on()
        module.bus.answering(0.6)
        equal("000 01 05" in module.bus.received("000"), succeeds, f"{entry}, revision {revision}")
        module.rig.close()


@play(RJ, "1.2 Error event control")
def rj_error_event_control():
    """1.2 Error event control: the table of conditions and actions."""
    for configuration, assignment, action in ((0x41, 0x0D, "000 02 00"), (0x11, 0x0D, "000 82 00"), (0x01, 0x0D, "000 82 05"),
                                              (0x51, 0x05, "000 82 05")):
        module, five = booted(configuration, assignment)
        five.is_off = True
        module.bus.expect(action, within=2)
        equal(bit(module.g[405], 7), 1)
        module.rig.close()


@play(RJ, "1.2 Boot-up control")
def rj_boot_up_control():
    """1.2 Boot-up control: a boot-up message starts the slave; not while the master is in Stop, not an unassigned one."""
    module, five = booted()
    five.power_on()
    module.bus.expect("000 01 05", within=2)
    module.bus.discard()
    module.bus.send("706 00")
    module.bus.expect_none(0.5, "000", "606")
    module.sdo_write(OWN, 0x1F82, 127, 4, 1)
    module.rig.until(lambda: module.g[25] & 0x0300 == 0, "Stop", 1)
    module.bus.discard()
    five.power_on()
    module.bus.expect_none(1, "000", "605")


@play(RJ, "1.2 Flying master", "App. 3 NMT flying master timing parameters", "App. 4")
def rj_flying_masters():
    """1.2 Flying master: the smaller node ID is the active master; its CPU stops (App. 4), the standby takes over; automatic heartbeats."""
    def plc(number):
        return f'''
[[plc]]
name = "plc{number}"
family = "iQ-R"
listen = "127.0.0.1:0"
[[plc.module]]
model = "RJ71CN91"
name = "module {number}"
head = 0
node = {number}
objects = {{ "1F80:00" = 0x21 }}
'''
    rig = Rig('[plant]\nname = "flying masters"\n[[bus]]\nname = "line"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                  + plc(2) + plc(3))
    two, three = Module(rig, 0, "plc2").ready(), Module(rig, 0, "plc3").ready()
    rig.run(20 - rig.time)
    equal([bit(two.g[25], 15), bit(three.g[25], 15)], [1, 0])
    beats = [frame.time for frame in rig.bus.frames if frame.identifier == "702" and frame.data in ("05", "7F")][-5:]
    assert all(abs(b - a - 1) < 0.01 for a, b in zip(beats, beats[1:])), f"every 1000 ms: {beats}"
    two.plc.remote_stop()
    rig.run(0.01)
    rig.bus.discard()
    stopped = rig.time
    rig.until(lambda: bit(three.g[25], 15), "node 3 is the active master", 8)
    assert rig.time - stopped > 0.4, "not before the heartbeat time of 1530 ms from the last heartbeat"
    assert "000 82 00" in rig.bus.received("000")


@play(RJ, "1.2 LSS")
def rj_lss_gives_a_slave_its_node_id():
    """1.2 LSS: a mandatory slave that does not boot in the boot time; identity objects set: LSS gives it node-ID and baud rate."""
    module = master(0x01, ', "1F81:09" = 0x0D, "1F84:09" = 0x000F0191, "1F85:09" = 0x1234, "1F86:09" = 0x0401, '
                    '"1F87:09" = 0x00010000, "1F88:09" = 7, "1F89:00" = 3000',
                    more=f'[[device]]\nname = "block"\nnode = "unconfigured"\neds = "{DEVICES}/io-block.eds"\n'
                         'objects = { "1018:01" = 0x1234, "1018:04" = 7 }\n')
    module.rig.until(lambda: bit(module.g[25], 10), "LSS in progress", 12)
    module.bus.expect("7E5 40 34 12 00 00 00 00 00", "7E5 41 01 04 00 00 00 00 00", "7E5 42 00 00 01 00 00 00 00",
                      "7E5 43 07 00 00 00 00 00 00", "7E4 44 00 00 00 00 00 00 00", "7E5 11 09 00 00 00 00 00 00", within=5)
    module.bus.expect("709 00", within=5)
    module.rig.until(lambda: bit(module.g[25], 11), "NMT start-up fails after the LSS execution", 5)
    module.restart()
    module.bus.expect("000 01 09", within=5)


@play(RJ, "1.2 Configuration manager", "App. 3 Concise DCF", "App. 3 Configuration request", "App. 3 Expected configuration date",
      "App. 3 Expected configuration time", "App. 3 Verify Configuration")
def rj_configuration_manager():
    """1.2 Configuration manager: the CDCF in 1F22H goes to the slave in NMT start-up, or by "conf" to 1F25H; 1F26H, 1F27H against 1020H."""
    module, five = booted()

    def download(*frames):
        for frame in frames:
            module.bus.send(f"67F {frame}")
            module.bus.answering(0.01)
        module.bus.answering(0.5)
        return module.bus.received("5FF")[-1]

    cdcf = ("21 22 1F 05 0D 00 00 00", "00 01 00 00 00 17 10 00", "13 02 00 00 00 F4 01 00")   # 1017H = 500
    equal(download(*cdcf)[:6], "5FF 30")
    assert download(*cdcf)[4:6] == "80", "it has to be deleted first"
    module.sdo_write(OWN, 0x1F25, 5, 0x666E6F63, 4)
    module.bus.expect("605 2B 17 10 00 F4 01 00 00", within=2)
    equal(module.cif(0x0002, OWN, 0x1F25, 6, 4, 0x6F63, 0x666E)[0:5], [0x000F, 3, 0, 0x0024, 0x0800])
    module.sdo_write(OWN, 0x1F25, 127, 0x666E6F63, 4)
    module.sdo_write(OWN, 0x1F26, 5, 11245, 4)
    module.sdo_write(OWN, 0x1F27, 5, 45000000, 4)
    for date, downloads in ((11245, False), (11244, True)):
        five.objects[0x1020, 1], five.objects[0x1020, 2] = date.to_bytes(4, "little"), (45000000).to_bytes(4, "little")
        five.written.clear()
        module.bus.discard()
        five.power_on()
        module.bus.expect("000 01 05", within=3)
        equal((0x1017, 0, 500) in five.written, downloads)
    module.bus.send("67F 2F 22 1F 05 00 00 00 00")          # delete with one byte 00H
    module.bus.answering(3)
    equal(download(*cdcf)[:6], "5FF 30")


@play(RJ, "1.2 Configuration manager", "1.2 NMT start-up")
def rj_refused_configuration_fails_the_boot():
    """1.2 NMT start-up, step 5: the configuration manager is one of the operations: "If any operation fails, it is regarded as a boot failure"."""
    module = master(0x01, ', "1F81:05" = 0x0D')
    for frame in ("21 22 1F 05 0D 00 00 00", "00 01 00 00 00 17 10 00", "13 02 00 00 00 F4 01 00"):
        module.bus.send(f"67F {frame}")
        module.run(0.01)
    module.run(0.5)
    five = slave(module, 5)
    five.refused[0x1017, 0] = 0x06010002
    five.power_on()
    module.bus.answering(2)
    assert "000 01 05" not in module.bus.received("000"), "boot failure"


# --- 1.3 SDO


@play(RJ, "1.3 SDO read", "App. 1 X17/Y17")
def rj_sdo_read():
    """1.3 SDO read: command 0004H, the own dictionary, a text, another node."""
    module = node()
    module.bus.discard()
    result = module.cif(0x0004, OWN, 0x1008, 0)
    equal(result[0:9], [0x0005, OWN, 0x1008, 0, 8, 0x4A52, 0x3137, 0x4E43, 0x3139], "RJ71CN91")
    module.bus.expect_none(0.01)
    module.bus.answers = {"605 40 00 10 00 00 00 00 00": "585 43 00 10 00 92 01 02 00"}
    equal(module.cif(0x0004, 5, 0x1000, 0)[0:7], [0x0005, 5, 0x1000, 0, 4, 0x0192, 0x0002])


@play(RJ, "1.3 SDO abort codes", "5.4 SDO communication is not available", "App. 2 G71")
def rj_sdo_abort_codes():
    """1.3 SDO abort codes: what the node answers; 05040000H after the SDO timeout Un\\G71."""
    module = node()
    module.bus.answers = {"605 40 00 10 00 00 00 00 00": "585 80 00 10 00 00 00 02 06"}
    equal(module.cif(0x0004, 5, 0x1000, 0)[0:5], [0x000F, 3, 5, 0x0000, 0x0602])
    module.g[71] = 300
    begin = module.rig.time
    equal(module.cif(0x0004, 9, 0x1000, 0)[0:5], [0x000F, 3, 9, 0x0000, 0x0504])
    assert 0.29 < module.rig.time - begin < 0.4


@play(RJ, "1.3 SDO multi read")
def rj_sdo_multi_read():
    """1.3 SDO multi read: eight records, FFFFH in those that are not used."""
    module = node()
    records = [OWN, 0x1000, 0, 0, 0, 0, 0, 0, OWN, 0x1018, 4, 0, 0, 0, 0, 0]
    records += sum(([NONE, 0, 0, 0, 0, 0, 0, 0] for _ in range(6)), [])
    result = module.cif(0x0008, *records)
    equal(result[0], 0x00F9)
    equal([result[1], *result[4:7]], [OWN, 4, 0x0195, 0])
    equal(result[9:15], [0x0F00, 0x1018, 4, 0, 0x0011, 0x0609])
    records[8] = NONE
    equal(module.cif(0x0008, *records)[0], 0x0009)


@play(RJ, "1.3 SDO write")
def rj_sdo_write():
    """1.3 SDO write: command 0002H."""
    module = node()
    module.bus.answers = {"605 2B 17 10 00 E8 03 00 00": "585 60 17 10 00 00 00 00 00"}
    equal(module.cif(0x0002, 5, 0x1017, 0, 2, 0x03E8)[0:4], [0x0003, 5, 0x1017, 0])
    equal(module.cif(0x0000)[0:6], [0x0000, 5, 0x1017, 0, 2, 0x03E8], "App. 2: display current parameter")


@play(RJ, "1.3 SDO multi write")
def rj_sdo_multi_write():
    """1.3 SDO multi write: 0007H, or 00F7H with abort code in the record."""
    module = node()
    records = [OWN, 0x1017, 0, 2, 0x03E8, 0, 0, 0, OWN, 0x1000, 0, 4, 1, 0, 0, 0] + [NONE, 0, 0, 0, 0, 0, 0, 0] * 6
    result = module.cif(0x0006, *records)
    equal([result[0], result[9], result[13], result[14]], [0x00F7, 0x0F00, 0x0002, 0x0601])
    equal(module.sdo_read(OWN, 0x1017), 1000)
    records[8] = NONE
    equal(module.cif(0x0006, *records)[0], 0x0007)


@play(RJ, "App. 2 CIF", "1.3 SDO read")
def rj_command_area_is_not_cleared():
    """App. 2, command interface: the area is not cleared after execution: what the command does not need stays."""
    module = node()
    module.g[1020] = 0x1234
    module.cif(0x0004, OWN, 0x1000, 0)
    equal(module.g[1020], 0x1234)


@play(RJ, "App. 2 CIF", "5.4 SDO communication is not available")
def rj_command_interface_errors():
    """App. 2, CIF receive message (error): unknown command, access while busy and its FFFFH, bus off."""
    module = node(3, more='[[bus.fault]]\nkind = "stuck recessive"\nports = ["module"]\nfrom = "12s"\nuntil = "13s"\n')
    equal(module.cif(0x0055)[0:2], [0x000F, 0x0064])
    module.g[1000:1004] = [4, 9, 0x1000, 0]
    module.y(0x17, True)
    module.rig.until(lambda: module.g[1000] == 0xFFFF, "busy", 1)
    module.g[1005] = 1
    module.until_x(0x17)
    equal(module.g[1000:1002], [0x000F, 0xFFFF])
    module.y(0x17, False)
    module.until_x(0x17, False, 1)
    equal(module.cif(0xFFFF)[0], 0)
    module.run(12.1 - module.rig.time)
    module.cif(0x0004, 9, 0x1000, 0)
    module.rig.until(lambda: bit(module.g[29], 3), "bus off", 1)
    equal(module.cif(0x0004, 9, 0x1000, 0)[0:2], [0x000F, 0xB0FF])


# --- 1.4 PDO to 1.6 TIME


@play(RJ, "1.4 TPDO", "App. 1 X1/Y1", "App. 2 G20")
def rj_tpdo_flow_of_data():
    """1.4 TPDO, flow of data transmission: data to Un\\G13000, Y1, X1; sent if they changed."""
    module = operational()
    module.g[13000:13004] = [0x1111, 0x2222, 0x3333, 0x4444]
    module.bus.expect_none(0.05)
    module.exchange()
    module.bus.expect("183 11 11 22 22 33 33 44 44")
    module.exchange()
    module.bus.expect_none(0.05)
    module.bus.send("000 80 03")                            # App. 1, *1: not while the own node is not Operational
    module.run(0.02)
    module.g[13000] = 5
    module.bus.send("203 01 00 00 00 00 00 00 00")
    module.exchange()
    module.bus.expect_none(0.05)
    equal(module.g[10000], 0)


@play(RJ, "1.4 TPDO")
def rj_tpdo_timing():
    """1.4 TPDO, data transmission timing: inhibit time and event timer in their five combinations."""
    def run(inhibit, event, *steps, end=0.2):
        """`steps`: ms and a value; times and values of the frames."""
        module = operational(settings=f'objects = {{ "1800:03" = {inhibit}, "1800:05" = {event} }}')
        begin = module.rig.time
        for at, value in steps:
            if at:
                module.run(begin + at / 1000 - module.rig.time)
            module.g[13000] = value
            module.y(0x01, True)
            module.y(0x01, False)
        module.run(begin + end - module.rig.time)
        frames = [frame for frame in module.bus.frames if frame.identifier == "183"]
        result = [(round((frame.time - frames[0].time) * 1000), int(frame.data[:2], 16)) for frame in frames]
        module.rig.close()
        return result
    equal(run(0, 0, (0, 1), (10, 2), (25, 3)), [(0, 1), (10, 2), (25, 3)])
    equal(run(100, 0, (0, 1), (5, 2), (12, 3)), [(0, 1), (12, 3)], "the change at 5 ms is not caught up")
    equal(run(0, 20, (0, 1), (50, 2), end=0.08), [(0, 1), (20, 1), (40, 1), (50, 2), (70, 2)])
    equal(run(100, 30, (0, 1), (5, 2), (20, 3), end=0.06), [(0, 1), (20, 3), (50, 3)])
    times = [time for time, _ in run(300, 20, (0, 1))]
    assert len(times) > 1 and all(b - a >= 30 for a, b in zip(times, times[1:])), times


@play(RJ, "1.4 TPDO", "1.4 RPDO", "1.5 SYNC")
def rj_synchronous_pdos():
    """1.4: transmission type 0, every n-th SYNC, and the RPDO that waits for SYNC."""
    module = operational(settings='objects = { "1800:02" = 2, "1801:02" = 0, "1801:01" = 0x40000283, "1400:02" = 0xF0 }')
    module.g[13004] = 0x77
    module.exchange()
    module.bus.expect_none(0.05)
    for _ in range(4):
        module.bus.send("080")
        module.run(0.01)
    equal(module.bus.received("183", "283").count("183 00 00 00 00 00 00 00 00"), 2, "SYNC 2 and 4")
    equal(module.bus.received("283"), ["283 77 00 00 00 00 00 00 00"])
    module.bus.send("203 34 12 00 00 00 00 00 00")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000], 0)
    module.bus.send("080")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000], 0x1234)


@play(RJ, "1.4 RPDO")
def rj_rpdo_flow_of_data():
    """1.4 RPDO, flow of receiving data: Y1, then Un\\G10000; a PDO of another length is refused (1.7: 8210H, 8220H)."""
    module = operational()
    module.bus.send("203 01 00 02 00 03 00 04 00")
    module.run(0.01)
    equal(module.g[10000], 0)
    module.exchange()
    equal(module.g[10000:10004], [1, 2, 3, 4])
    module.bus.send("203 AA AA AA AA AA AA")
    module.run(0.02)
    assert [frame for frame in module.bus.received("083") if frame.startswith("083 10 82")], module.bus.received("083")
    module.exchange()
    equal(module.g[10000], 1)


@play(RJ, "1.5 SYNC", "App. 3 Communication cycle period", "App. 3 COB-ID of SYNC message")
def rj_sync_producer():
    """1.5 SYNC: 1006H and bit 30 of 1005H; the active NMT master alone."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    module.sdo_write(OWN, 0x1006, 0, 10000, 4)
    module.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
    module.run(0.5)
    times = [frame.time for frame in module.bus.frames if frame.identifier == "080"][-40:]
    assert len(times) == 40 and all(abs(b - a - 0.01) < 0.0002 for a, b in zip(times, times[1:])), times
    module.rig.close()
    module = node()
    module.sdo_write(OWN, 0x1006, 0, 10000, 4)
    module.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
    module.run(0.5)
    equal(module.bus.received("080"), [])


@play(RJ, "1.6 TIME", "App. 1 X12/Y12", "App. 1 X13/Y13", "App. 2 G50")
def rj_time_producer():
    """1.6 TIME, App. 1: Un\\G50 = 2, the clock by Y12, one TIME each minute; Y13 reads it."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    module.g[50:57] = [2, 2024, 2, 29, 13, 5, 30]
    module.g[58] = 1
    module.bus.discard()
    module.handshake(0x12)
    equal(module.g[57], 4, "Thursday")
    module.rig.until(lambda: module.bus.received("100"), "TIME", 61)
    frame = next(frame for frame in module.bus.frames if frame.identifier == "100")
    equal(frame.data[-5:], "4D 39", "day 14669")
    module.handshake(0x13)
    equal(module.g[51:54], [2024, 2, 29])
    module.run(70)
    times = [frame.time for frame in module.bus.frames if frame.identifier == "100"]
    assert abs(times[1] - times[0] - 60) < 0.01, times
    module.g[51:54] = [2023, 2, 29]
    module.y(0x12, True)
    module.until_x(0x0F, within=1)
    equal([bit(module.g[29], 6), module.g[39]], [1, 53])
    module.y(0x12, False)


@play(RJ, "1.6 TIME", "App. 3 COB-ID Time stamp")
def rj_time_consumer():
    """1.6 TIME: a received TIME sets the clock, Un\\G25 bit 12."""
    module = node()
    module.bus.send("100 00 00 00 00 D4 16")                # 2000-01-01
    module.run(3.1)
    equal(bit(module.g[25], 12), 1)
    module.handshake(0x13)
    equal(module.g[51:57], [2000, 1, 1, 0, 0, 3])
    module.g[25] = 0xEFFF
    equal(bit(module.g[25], 12), 0)


# --- 1.7 EMCY to 1.10


@play(RJ, "1.7 EMCY sending", "App. 3 Inhibit time EMCY", "App. 3 Error register")
def rj_manual_emcy():
    """1.7 When sending a message manually: command 000AH; too early 000CH 1; in Stop 000CH 2."""
    module = node()
    module.bus.discard()
    equal(module.cif(0x000A, 0xFF00, 0x0181, 0x0302, 0x0504)[0:2], [0x000B, 0])
    module.bus.expect("083 00 FF 81 01 02 03 04 05", others=False)
    equal([module.sdo_read(OWN, 0x1001), module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1003, 1) & 0xFFFF], [0x81, 1, 0xFF00])
    module.sdo_write(OWN, 0x1015, 0, 10000, 2)
    module.cif(0x000A, 0xFF00, 0x0181, 0, 0)
    equal(module.cif(0x000A, 0xFF00, 0x0181, 0, 0)[0:2], [0x000C, 1])
    module.run(1.1)
    equal(module.cif(0x000A, 0xFF00, 0x0181, 0, 0)[0], 0x000B)
    module.bus.send("000 02 03")
    module.run(1.1)
    equal(module.cif(0x000A, 0xFF00, 0x0181, 0, 0)[0:2], [0x000C, 2])


@play(RJ, "1.7 EMCY reception", "App. 1 X11/Y11", "App. 2 G750")
def rj_emcy_reception():
    """1.7 When a message is received: X11, data exchange, Un\\G750; Y11 clears, and nothing is received meanwhile."""
    module = node()
    module.bus.send("085 10 81 11 01 02 03 04 05")
    module.until_x(0x11, within=1)
    equal(module.g[750:755], [0] * 5)
    module.exchange()
    equal(module.g[750:755], [5, 0x8110, 0x0111, 0x0302, 0x0504])
    module.y(0x11, True)
    module.until_x(0x11, False, 1)
    equal(module.g[750:860], [0] * 110)
    module.bus.send("085 10 81 11 01 02 03 04 05")
    module.run(0.05)
    module.y(0x11, False)
    module.run(0.05)
    equal(module.x(0x11), False)
    for number in range(1, 26):                             # App. 2: the first 11, the latest 11
        module.bus.send(f"085 {number:02X} 10 01 00 00 00 00 00")
        module.run(0.002)
    module.exchange()
    equal([word & 0xFF for word in module.g[751:860][0::5]], [*range(1, 12), *range(15, 26)])


@play(RJ, "1.7 EMCY sending", "App. 4", "App. 3 Pre-defined error field")
def rj_emcy_of_cpu_stop():
    """App. 4, NMT slave: RUN to STOP: the state of 1.10, EMCY 4D45303032H; STOP to RUN does not start it."""
    module = operational()
    module.plc.remote_stop()
    module.bus.expect("083 00 FF 81 4D 45 30 30 32")
    equal(module.g[25] & 0x0300, 0x0100)
    module.plc.remote_run()
    module.bus.expect("083 00 00 00 00 00 00 00 00")
    equal([module.g[25] & 0x0300, module.sdo_read(OWN, 0x1003, 0)], [0x0100, 0])


@play(RJ, "1.8 Node guarding", "App. 3 Request node guarding")
def rj_node_guarding_of_the_master():
    """1.8 Node Guarding, by the NMT master: guard time and retry factor of 1F81H; Un\\G405; 1F83H."""
    module = master(0x01, ', "1F81:05" = 0x00640301')
    module.rig.until(lambda: bit(module.g[405], 0), "guarding", 5)
    for state in ("05", "85") * 3:
        module.bus.send(f"705 {state}")
        module.run(0.1)
    equal(module.g[405] & 0xFC, 0)
    module.sdo_write(OWN, 0x1F83, 5, 0, 1)
    equal(module.sdo_read(OWN, 0x1F83, 5), 0)
    stopped = module.rig.time
    module.run(1)
    module.sdo_write(OWN, 0x1F83, 5, 1, 1)
    started = module.rig.time
    equal(module.sdo_read(OWN, 0x1F83, 5), 1)
    module.run(0.6)
    equal([bit(module.g[405], 3), module.x(0x10), bit(module.g[29], 10)], [1, True, 1])
    assert [frame for frame in module.bus.received("0FF") if frame.startswith("0FF 05 8F")], "EMCY 8F05H"
    times = [frame.time for frame in module.rig.remote_frames() if frame.identifier == "705"]
    assert not [time for time in times if stopped + 0.01 < time < started - 0.05], times


@play(RJ, "1.8 Node guarding", "App. 3 Guard time", "App. 3 Life time factor")
def rj_node_guarding_of_the_slave():
    """1.8 Node Guarding, by the NMT slave: 100CH x 100DH without a request."""
    module = node()
    module.sdo_write(OWN, 0x100C, 0, 100, 2)
    module.sdo_write(OWN, 0x100D, 0, 3, 1)
    module.bus.send("000 01 03")
    module.run(0.01)
    module.bus.discard()
    module.bus.send_remote("703", 1)
    module.bus.expect("703 05")
    module.bus.send_remote("703", 1)
    module.bus.expect("703 85")
    module.run(0.35)
    equal([bit(module.g[403], 6), module.g[25] & 0x0300], [1, 0x0100])


@play(RJ, "1.9 Heartbeat", "1.8 Node guarding", "App. 3 Consumer heartbeat time", "App. 3 Producer heartbeat time")
def rj_heartbeat():
    """1.9 Heartbeat: producer 1017H; consumer 1016H from the first message on; Un\\G405, X10, EMCY; it goes before guarding (1.8)."""
    module = master(0x01, ', "1F81:05" = 0x00640301, "1016:01" = 0x000505DC, "1017:00" = 200')
    module.run(3)
    equal(bit(module.g[405], 0), 0, "no guarding of a node with a heartbeat time")
    module.bus.send("705 05")
    module.run(0.01)
    equal([module.g[405] & 0b10, module.g[605]], [0b10, 5])
    module.run(1.48)
    equal(bit(module.g[405], 7), 0)
    module.run(0.05)
    equal([bit(module.g[405], 7), module.x(0x10)], [1, True])
    assert [frame for frame in module.bus.received("0FF") if frame.startswith("0FF 05 8F")], "EMCY 8F05H"
    times = [frame.time for frame in module.bus.frames if frame.identifier == "77F" and frame.data != "00"][-5:]
    assert all(abs(b - a - 0.2) < 0.001 for a, b in zip(times, times[1:])), times
    equal([frame for frame in module.rig.remote_frames() if frame.identifier == "705"], [])


@play(RJ, "1.10 Operation setting at error occurrence", "App. 3 Error behavior")
def rj_operation_at_error_occurrence():
    """1.10: 1029H and the NMT state after an error, and after CPU STOP."""
    for behaviour, after_error, after_stop, starts in ((0, 0x0100, 0x0100, False), (1, 0x0200, 0x0100, True), (2, 0, 0, False)):
        module = operational(settings=f'objects = {{ "1029:01" = {behaviour}, "1016:01" = 0x000500C8 }}')
        module.bus.send("705 05")
        module.run(0.3)
        equal(module.g[25] & 0x0300, after_error, f"1029H = {behaviour}")
        module.bus.send("000 01 03")
        module.run(0.02)
        module.plc.remote_stop()
        module.run(0.05)
        equal(module.g[25] & 0x0300, after_stop, "CPU STOP")
        module.bus.send("000 01 03")
        module.run(0.05)
        equal(bit(module.g[25], 9), int(starts), "remote node start in CPU STOP")
        module.rig.close()


# --- 1.11, 1.12, 4.1 Layer 2 messages


@play(RJ, "1.11 Data transmission", "App. 1 X3/Y3", "App. 2 G10000")
def rj_layer2_data_transmission():
    """1.11 Data transmission: set the slot, Y3, data, Y1."""
    module = layer2(G6000=0xFFFF, G6001=0x5FFF, G6002=0, G6003=0, G10000=0x0501, G10001=0)
    module.g[10002] = 8
    module.y(0x03, True)
    module.until_x(0x03)
    module.bus.expect("501 00 00 00 00 00 00 00 00")        # once at the transition to online
    module.g[10003:10007] = [0x0201, 0x0403, 0x0605, 0x0807]
    module.exchange()
    module.bus.expect("501 01 02 03 04 05 06 07 08")


@play(RJ, "1.11 Data transmission", "App. 2 G6000")
def rj_layer2_transmission_timing():
    """1.11, data transmission timing: Event, Event (COS), Cycle, Cycle (COS), trigger only."""
    slots = {}
    for slot, kind in enumerate((0, 1, 2, 3, 4)):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": 0x5FFF, f"G{6002 + 4 * slot}": kind,
                      f"G{6003 + 4 * slot}": 5, f"G{10000 + 7 * slot}": 0x101 + slot, f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(5):
        module.g[10002 + 7 * slot] = 1
    online(module)
    module.run(0.3)
    module.bus.discard()
    for slot in range(5):
        module.g[10003 + 7 * slot] = 0x11
    module.exchange()
    module.exchange()
    module.run(0.5)
    counts = [module.bus.received(f"10{i}").count(f"10{i} 11") for i in range(1, 6)]
    equal([counts[0], counts[1], counts[3], counts[4]], [2, 1, 1, 0])
    cycles = [frame.time for frame in module.bus.frames if str(frame) == "103 11"]
    assert len(cycles) >= 9 and all(abs(b - a - 0.05) < 0.001 for a, b in zip(cycles, cycles[1:])), f"5 x 10 ms: {cycles}"


@play(RJ, "App. 1 X4/Y4", "App. 2 G8400", "1.11 Data transmission")
def rj_layer2_message_transmit_trigger():
    """App. 1, X4/Y4: flags of Un\\G8400 on, X4 when all is in the send buffer."""
    module = layer2(G6000=0xFFFF, G6001=0x5FFF, G6002=4, G10000=0x0501, G10001=0, G6004=0x123, G6005=0)
    module.g[10002] = 1
    online(module)
    module.g[10003] = 0x55
    module.exchange()
    module.bus.expect_none(0.05)
    module.g[8400] = 0b11                                   # slot 2 receives: its flag has no effect
    module.handshake(0x04)
    module.bus.expect("501 55", others=False)
    equal(module.g[8400], 0)


@play(RJ, "1.11 RTR transmission")
def rj_layer2_rtr_transmission():
    """1.11 RTR transmission: bit 15 of RTR/new/DLC, sent by the trigger."""
    module = layer2(G6000=0xFFFF, G6001=0x5FFF, G6002=4, G10000=0x0501, G10001=0)
    module.g[10002] = 0x8008
    module.y(0x03, True)
    module.until_x(0x03)
    module.run(0.05)
    module.g[8400] = 1
    module.handshake(0x04)
    module.run(0.01)
    frames = [str(frame) for frame in module.rig.remote_frames()]
    assert frames and set(frames) == {"501 R8"}, frames


@play(RJ, "1.11 RTR response", "App. 2 G8350")
def rj_layer2_rtr_response():
    """1.11 RTR response: automatic; manual with the RTR flag of Un\\G8350; precise DLC check."""
    slots = {}
    for slot, kind in enumerate((0x7FFF, 0x6FFF, 0x7FFF)):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": kind, f"G{6002 + 4 * slot}": 0,
                      f"G{10000 + 7 * slot}": 0x601 + slot, f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(3):
        module.g[10002 + 7 * slot] = 0x1008 if slot == 2 else 8
    online(module)
    module.run(0.05)
    module.bus.discard()
    module.bus.send_remote("601", 8)
    module.bus.expect("601 00 00 00 00 00 00 00 00")
    equal(module.g[8350], 0)
    module.bus.send_remote("602", 8)
    module.bus.expect_none(0.05)
    equal(module.g[8350], 0b10)
    module.g[10010] = 0x2211
    module.exchange()
    module.bus.expect("602 11 22 00 00 00 00 00 00")
    equal(module.g[8350], 0)
    module.run(0.05)
    module.bus.discard()
    module.bus.send_remote("603", 4)
    module.bus.expect_none(0.05)
    module.bus.send_remote("603", 8)
    module.bus.expect("603 00 00 00 00 00 00 00 00")


@play(RJ, "1.11 Data reception", "App. 2 G10000")
def rj_layer2_data_reception_example_1():
    """App. 2, receive example 1: slot 1 receives 0181H; the upper byte of RTR/new/DLC at each exchange."""
    module = layer2(G6000=0x0181, G6001=0, G6002=0, G6003=0)
    online(module)

    def exchange(*frames):
        module.g[10002] = module.g[10002] & 0x00FF
        if frames:
            module.bus.send(*frames)
        module.run(0.01)
        module.exchange()
        return module.g[10000:10004]
    exchange()
    equal(exchange()[2] >> 8, 0)
    equal(exchange("181 0A"), [0x0181, 0, 0x0301, 0x000A])
    equal(exchange("181 0B", "181 0C", "181 0D"), [0x0181, 0, 0x0701, 0x000D])
    equal(exchange("181 0D")[2], 0x0201, "the same data again")
    equal(exchange("181 11 22")[2:4], [0x0302, 0x2211])


@play(RJ, "1.11 Data reception", "App. 2 G6000")
def rj_layer2_data_reception_example_2():
    """App. 2, receive example 2: 0180H with C = 0006H takes 0180H, 0182H, 0184H and 0186H."""
    module = layer2(G6004=0x0180, G6005=0, G6006=0x0006, G6007=0)
    online(module)
    module.bus.send("180 01", "182 02", "181 03", "184 04", "186 05", "188 06")
    module.run(0.01)
    module.exchange()
    equal(module.g[10007:10011], [0x0186, 0, 0x0701, 0x0005])


@play(RJ, "1.11 Data/RTR transmission via CIF")
def rj_layer2_transmission_via_cif():
    """1.11: command 000CH; 000DH; F00CH with the wrong value."""
    module = layer2()
    online(module)
    equal(module.cif(0x000C, 0x0501, 0, 0, 3, 0x2211, 0x0033)[0], 0x000D)
    module.bus.expect("501 11 22 33")
    result = module.cif(0x000C, 0x0501, 0, 0, 9)
    equal([result[0], result[4]], [0xF00C, 9])
    result = module.cif(0x000C, 0x0800, 0, 0, 3)
    equal([result[0], result[1]], [0xF00C, 0x0800])
    equal(module.cif(0x000C, 0x0502, 0, 1, 2)[0], 0x000D)
    module.run(0.01)
    equal([str(frame) for frame in module.rig.remote_frames()], ["502 R2"])


@play(RJ, "1.12 CPU STOP transition message", "App. 2 G8450", "App. 4")
def rj_layer2_cpu_stop_messages():
    """1.12: messages 1 to 4 at RUN to STOP, in this order; App. 4: offline when Y3 is cleared."""
    words = {}
    for number, identifier in enumerate((0x123, 0x050, 0x300, 0x010)):
        words.update({f"G{8450 + 7 * number}": identifier, f"G{8451 + 7 * number}": 0, f"G{8452 + 7 * number}": 2,
                      f"G{8453 + 7 * number}": 0x2211 + number})
    module = layer2(**words)
    online(module)
    module.plc.remote_stop()
    module.bus.expect("123 11 22", "050 12 22", "300 13 22", "010 14 22", others=False)
    module.run(0.1)
    equal(module.x(0x03), False)


@play(RJ, "2.1 Layer 2", "App. 1 X2/Y2", "App. 1 X1F/Y1F", "App. 2 G21", "App. 2 G22")
def rj_setting_parameters_in_the_layer_2_mode():
    """2.1, Layer 2 message mode, steps 3 to 7, with 11 and 29 bits."""
    for mode, low, high, frame in ((11, 0x0501, 0, "501 11 22"), (29, 0xF100, 0x18FE, "18FEF100 11 22")):
        module = rack(bit_rate=500_000, settings="buffer = { G24 = 500 }").ready()
        module.g[21] = mode                                 # 3
        module.save()                                       # 4
        module.restart()                                    # 5
        equal(module.g[21], mode)
        module.g[24] = 500                                  # 6
        module.g[6000:6004] = [0xFFFF, 0x5FFF, 0, 0]
        module.g[8450:8454] = [low, high, 1, 0x55]
        module.g[10000:10003] = [low, high, 2]
        module.save()
        module.bus.discard()
        module.y(0x03, True)                                # 7
        module.until_x(0x03)
        equal([module.g[37], module.g[29]], [5000, 0])
        module.g[10003] = 0x2211
        module.exchange()
        module.bus.expect(frame)
        module.g[22] = 1                                    # App. 1, X1F: not while online
        module.y(0x1F, True)
        module.run(0.5)
        equal(bit(module.g[29], 5), 1)
        module.rig.close()


@play(RJ, "App. 1 X3/Y3", "App. 2 G6000", "5.4 Cannot send/receive Layer 2 messages")
def rj_layer2_settings_are_checked():
    """App. 1, X3/Y3: settings that are abnormal: Un\\G29.6, X3 stays off; settings do not change while online."""
    module = layer2()
    for slot in (0, 1):                                     # App. 2: two slots with one CAN-ID
        module.g[6000 + 4 * slot:6004 + 4 * slot] = [0xFFFF, 0x5FFF, 0, 0]
        module.g[10000 + 7 * slot:10003 + 7 * slot] = [0x0501, 0, 1]
    module.y(0x03, True)
    module.rig.until(lambda: bit(module.g[29], 6), "a setting error", 1)
    equal(module.x(0x03), False)
    module.y(0x03, False)
    module.run(0.05)
    module.g[10007] = 0x0502
    module.y(0x0F, True)
    module.run(0.05)
    module.y(0x0F, False)
    online(module)
    module.g[6000] = 0x0200
    module.g[10000] = 0x0300
    equal([module.g[6000], module.g[10000]], [0xFFFF, 0x0501], "ignored")


@play(RJ, "4.1", "2.1 Layer 2", "1.11 RTR response", "1.11 RTR transmission")
def rj_communication_example_of_layer_2():
    """4.1: two nodes, 1000 kbps, 11 bits; the five programs with their label's devices (M0 ... M43, D20 ..., D40 ...). The ladder
    figures are lost: the steps are those of their captions."""
    def plc(number):
        return f'''
[[plc]]
name = "plc{number}"
family = "iQ-R"
listen = "127.0.0.1:0"
[[plc.module]]
model = "RJ71CN91"
name = "CAN node ({number})"
head = 0
'''
    rig = Rig('[plant]\nname = "4.1"\n[[bus]]\nname = "line"\nbit_rate = 1_000_000\nserve = "socketcand:127.0.0.1:0"\n'
                  + plc(1) + plc(2))
    one, two = Module(rig, 0, "plc1"), Module(rig, 0, "plc2")
    # Parameter setting program (0): function mode, baud rate, save, restart
    for module in (one, two):
        module.ready()
        equal(module.x(0x0F), False)
        module.plc.m[0] = True
        module.g[21] = 11
        module.g[24] = 1000
        module.save()
        module.restart()
    # (33): message settings
    for module, send, receive, answer, request in ((one, 0x501, 0x581, 0x601, 0x681), (two, 0x581, 0x501, 0x681, 0x601)):
        module.plc.m[1] = True
        for slot, setting, identifier, word in ((0, [0xFFFF, 0x5FFF, 4, 0], send, 8), (1, [receive, 0, 0, 0], receive, 0),
                                                (2, [0xFFFF, 0x6FFF, 4, 0], answer, 8), (3, [0xFFFF, 0x5FFF, 4, 0], request, 0x8008),
                                                (4, [request, 0, 0, 0], request, 0)):
            module.g[6000 + 4 * slot:6004 + 4 * slot] = setting
            if setting[0] == 0xFFFF:
                module.g[10000 + 7 * slot:10003 + 7 * slot] = [identifier, 0, word]
        module.save()
    # Message transmission program (0): online
    for module in (one, two):
        module.y(0x03, True)
        module.until_x(0x03)
        equal(module.g[29], 0)
    rig.run(0.1)
    for module in (one, two):                               # what came at the transition to online is retrieved
        module.exchange()
        for word in (10009, 10030):
            module.g[word] = module.g[word] & 0x00FF
    rig.bus.discard()
    # (19) data, (48) data exchange, (69) transmit trigger request
    one.g[10003:10007] = [0x0201, 0x0403, 0x0605, 0x0807]
    one.exchange()
    one.g[8400] = 1
    one.handshake(0x04)
    rig.bus.expect("501 01 02 03 04 05 06 07 08")
    # Message receive program of node (2): (19) data exchange, (40) retrieve
    two.exchange()
    equal(two.g[10007:10009], [0x501, 0])
    two.plc.d[20:22] = two.g[10007:10009]
    two.plc.d[22] = two.g[10009] & 0xFF
    two.plc.d[23:27] = two.g[10010:10014]
    equal([two.plc.d.double[20], two.plc.d[22], two.plc.d[23:27]], [0x501, 8, [0x0201, 0x0403, 0x0605, 0x0807]])
    flags = two.g[10009] >> 8 & 7
    two.plc.m[232:235] = [bool(flags & 2), bool(flags & 1), bool(flags & 4)]
    equal(flags, 0b011, "new frame, new data")
    two.g[10009] = two.g[10009] & 0x00FF
    # RTR request program of node (2): (19) trigger: the remote frame of slot 4
    two.g[8400] = 0b1000
    two.handshake(0x04)
    rig.run(0.01)
    # RTR response program of node (1): (20) RTR flag, (39) data, (69) exchange, (91) trigger
    equal(one.g[8350], 0b100)
    one.g[10017:10021] = [0xA1A0, 0xA3A2, 0xA5A4, 0xA7A6]
    one.exchange()
    one.g[8400] = 0b100
    one.handshake(0x04)
    rig.bus.expect("601 A0 A1 A2 A3 A4 A5 A6 A7")
    equal(one.g[8350], 0)
    # (54) data exchange, (84) retrieve the receive data of slot 5
    two.exchange()
    equal([two.g[10028], two.g[10030], two.g[10031:10035]], [0x601, 0x0308, [0xA1A0, 0xA3A2, 0xA5A4, 0xA7A6]])
    two.plc.d[40:42] = two.g[10028:10030]
    two.plc.d[43:47] = two.g[10031:10035]
    equal(two.plc.d[43], 0xA1A0)
    # and the other way round
    two.g[10003] = 0x7788
    two.exchange()
    two.g[8400] = 1
    two.handshake(0x04)
    rig.bus.expect("581 88 77 00 00 00 00 00 00")
    equal([str(frame) for frame in rig.remote_frames()][-1], "601 R8")


@play(RJ, "4.2", "1.6 TIME")
def rj_communication_example_of_the_405_mode():
    """4.2: after an NMT reset the program sets 2 (producer) to Un\\G50 again: X0 ON and Un\\G25.7 off, Y12, X12."""
    module = node()
    module.bus.discard()

    def program():
        """A scan of the program; M0: the time stamp has been set since the last NMT reset."""
        plc = module.plc
        if not module.x(0x00) or bit(module.g[25], 7):
            plc.m[0] = False
        elif not plc.m[0]:
            if module.x(0x12):
                module.y(0x12, False)
                plc.m[0] = True
            else:
                module.g[50] = 2
                module.y(0x12, True)
        module.run(0.01)

    for reset in ("000 82 03", "000 81 03"):
        for _ in range(20):
            program()
        equal(module.sdo_read(OWN, 0x1012), 0x40000100)
        module.bus.send(reset)
        program()
        equal(bit(module.g[25], 7), 1, "initialization")
        while bit(module.g[25], 7):
            program()
        equal(module.sdo_read(OWN, 0x1012) & 0x40000000, 0, "the default is back")
    for _ in range(20):
        program()
    equal(module.sdo_read(OWN, 0x1012), 0x40000100)


# --- 2, 3 Parameters by the tools


@play(RJ, "2.2", "2.3")
def rj_refresh_setting():
    """2.2, 2.3: data exchange "refresh": RPDO words come to a device, TPDO words from it, at END."""
    module = rack('objects = { "1017:00" = 0 }', node=3, plc='scan = "10ms"',
                  tail='[plc.module.parameters]\ndata_exchange = "refresh"\nrefresh = { G10000 = "D1000", G13000 = "D2000" }').ready()
    module.bus.send("000 01 03")
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 2)
    module.bus.discard()
    module.plc.d[2000:2004] = [1, 2, 3, 4]
    module.bus.expect("183 01 00 02 00 03 00 04 00")
    module.bus.send("203 11 00 22 00 33 00 44 00")
    module.run(0.05)
    equal(module.plc.d[1000:1004], [0x11, 0x22, 0x33, 0x44])
    module.g[13000] = 0x99                                  # 2.3, precautions: it is overwritten
    module.run(0.05)
    equal(module.g[13000], 1)


@play(RJ, "2.4", "3.2 Writing the settings", "2.1 405")
def rj_parameters_that_the_tool_wrote():
    """2.1 405 mode, 3.2: what the tool writes to the CPU is in the module after the reset; settings of slaves lie in 1F22H and go to
    them at boot. The windows are the plant file's `parameters`."""
    module = rack(node=1, tail=f'''
[plc.module.parameters]
buffer = {{ G70 = 600 }}
objects = {{ "1F80:00" = 0x01, "1F81:05" = 0x0D }}
[[plc.module.parameters.node]]
node = 5
eds = "{DEVICES}/io-block.eds"
objects = {{ "1017:00" = 100 }}
''').ready()
    equal(module.g[70], 600)
    five = slave(module, 5)
    five.power_on()
    module.bus.expect("605 2B 17 10 00 64 00 00 00", "000 01 05", within=5)
    assert module.cif(0x0004, OWN, 0x1F22, 5)[0] == 0x0005, "the CDCF"


@play(RJ, "App. 5", "App. 1 X1F/Y1F", "App. 3 Store parameters", "2.1 405")
def rj_setting_parameters_without_the_tool():
    """App. 5, steps 2 to 4: buffer memory and save, restart, objects by SDO and 1010H."""
    module = rack().ready()
    module.g[27] = 3                                        # 2
    module.g[70] = 700
    module.g[71] = 400
    module.save()
    module.bus.discard()
    module.restart()                                        # 3
    module.bus.expect("703 00", within=0.5)
    module.sdo_write(OWN, 0x1017, 0, 200, 2)                # 4
    module.sdo_write(OWN, 0x1029, 1, 2, 1)
    module.store_objects()
    module.rig.power_cycle()
    module.ready()
    equal([module.g[27], module.g[70], module.g[71]], [3, 700, 400])
    equal([module.sdo_read(OWN, 0x1017), module.sdo_read(OWN, 0x1029, 1)], [200, 2])


# --- 5 Troubleshooting, App. 1 to 4


@play(RJ, "5.1", "5.2", "App. 1 XF/YF")
def rj_leds_and_module_diagnostics():
    """5.1, 5.2: a moderate error: RUN on, ERR flashing, 3000H with its address; cleared by YF."""
    module = node()
    leds = module.rig.leds
    equal([leds()["RUN"], leds()["ERR"]], ["on", "off"])
    module.g[71] = 10
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[39]], [1 << 6, 71])
    error = module.rig.diagnostics()["errors"][0]
    equal([error["code"], error["class"]], ["3000", "moderate"])
    equal([leds()["RUN"], leds()["ERR"]], ["on", "blinking"])
    module.g[71] = 500
    module.y(0x0F, True)
    module.until_x(0x0F, False, 1)
    equal([module.g[29], leds()["ERR"], module.rig.diagnostics()["errors"]], [0, "off", []])
    module.y(0x0F, False)
    module.run(0.05)
    equal(module.x(0x0F), False)


@play(RJ, "5.6", "5.2")
def rj_event_history():
    """5.6: what the program did stands in the event history; 5.2: clearing an error leaves it."""
    module = node()
    module.save()
    module.g[22] = 2
    module.handshake(0x1F)
    module.bus.send("085 30 81 11 01 02 03 04 05")
    module.run(0.05)
    module.y(0x11, True)
    module.run(0.05)
    module.y(0x11, False)
    module.restart()
    module.y(0x0F, True)
    module.run(0.05)
    codes = [line["code"] for line in module.rig.diagnostics()["history"][0]["lines"]]
    wanted = ["00408", "00404", "0040A", "00410", "0040D", "0040C"]
    equal([code for code in codes if code in wanted], wanted, "the newest first")


@play(RJ, "5.2")
def rj_module_information_list():
    """5.2: function mode, baud rate and node ID; "-" in the Layer 2 offline mode."""
    module = node(3, bit_rate=500_000)
    found = module.rig.diagnostics()
    equal([found["function_mode"], found["bit_rate"], found["node"]], [405, 500000, 3])
    module.rig.close()
    module = layer2()
    equal([module.rig.diagnostics()["function_mode"], module.rig.diagnostics()["bit_rate"]], [11, None])


@play(RJ, "5.3", "App. 1 XF/YF", "App. 2 G35", "1.3 SDO abort codes")
def rj_bus_off_and_its_remedy():
    """5.3, b3; 5.1, 1804H: restart the module to restore communication."""
    module = node(3, more='[[bus.fault]]\nkind = "stuck recessive"\nports = ["module"]\nfrom = "9s"\nuntil = "11s"\n')
    module.run(9.1 - module.rig.time)
    module.cif(0x000A, 0xFF00, 0x0181, 0, 0)
    module.rig.until(lambda: bit(module.g[29], 3), "bus off", 1)
    equal([module.g[35], module.x(0x0F)], [256, True])
    module.run(2)
    module.restart()
    equal([module.g[29], module.x(0x0F)], [0, False])
    module.bus.answers = {"605 40 00 10 00 00 00 00 00": "585 43 00 10 00 92 01 02 00"}
    equal(module.cif(0x0004, 5, 0x1000, 0)[0], 0x0005)


@play(RJ, "5.3", "App. 1 XF/YF")
def rj_error_bits_go_with_their_cause():
    """App. 1, XF/YF: all the bits of Un\\G29 automatically turn off when the error cause is removed."""
    module = layer2()
    online(module)
    module.g[22] = 1
    module.y(0x1F, True)
    module.run(0.5)
    equal(bit(module.g[29], 5), 1)
    module.y(0x1F, False)
    module.y(0x03, False)
    module.run(0.5)
    equal(bit(module.g[29], 5), 0)


@play(RJ, "5.4 NMT state not Operational", "App. 1 X10/Y10", "App. 2 G400", "App. 2 G401")
def rj_nmt_failure_is_cleared():
    """App. 1, X10/Y10: for a node, for all; while Y10 is ON nothing is detected."""
    module = node(3, 'objects = { "1016:01" = 0x000401F4, "1016:02" = 0x000501F4 }')
    module.bus.send("704 05", "705 05")
    module.until_x(0x10, within=2)
    module.run(0.1)
    equal([bit(module.g[404], 7), bit(module.g[405], 7)], [1, 1])
    module.g[400] = 4
    module.y(0x10, True)
    module.run(0.05)
    equal([bit(module.g[404], 7), bit(module.g[405], 7), module.x(0x10)], [0, 1, True])
    module.y(0x10, False)
    module.run(0.05)
    module.g[400] = 0
    module.y(0x10, True)
    module.until_x(0x10, False, 1)
    module.bus.send("704 05")
    module.run(1)
    equal([bit(module.g[404], 7), module.x(0x10)], [0, False])
    module.y(0x10, False)


@play(RJ, "5.4 PDO communication is not available")
def rj_pdos_that_do_not_come():
    """5.4: the checks: Operational, data exchange, COB-ID; a TPDO whose COB-ID is invalid is enabled."""
    module = node(3, 'objects = { "1800:01" = 0xC0000183 }')
    module.g[13000] = 1
    module.exchange()
    module.bus.expect_none(0.05, "183")                         # the node is not Operational
    module.bus.send("000 01 03")
    module.run(0.02)
    module.g[13000] = 2
    module.exchange()
    module.bus.expect_none(0.05, "183")                         # the PDO is invalid
    module.sdo_write(OWN, 0x1800, 1, 0x40000183, 4)
    module.g[13000] = 3
    module.exchange()
    module.bus.expect("183 03 00 00 00 00 00 00 00")


@play(RJ, "App. 2 G21", "App. 2 G39", "App. 2 G24", "App. 2 G27", "App. 1 XF/YF")
def rj_wrong_settings():
    """App. 2: function mode, baud rate and node ID out of range: Un\\G29.6, Un\\G39; corrected, YF."""
    module = rack().ready()
    for address, wrong, right in ((21, 12, 405), (24, 99, 250), (27, 128, 127)):
        module.g[address] = wrong
        module.until_x(0x0F, within=1)
        equal([bit(module.g[29], 6), module.g[39]], [1, address])
        module.g[address] = right
        module.y(0x0F, True)
        module.until_x(0x0F, False, 1)
        module.y(0x0F, False)
        module.run(0.05)
        equal([module.g[29], module.g[39], module.x(0x0F)], [0, 0, False])


@play(RJ, "App. 2 G22", "App. 1 X1F/Y1F", "App. 3 Restore default parameters", "App. 3 Store parameters")
def rj_save_and_restore():
    """App. 2, Un\\G22; App. 3, 1011H: restore in the buffer memory alone, in the flash ROM, too; objects by "load" and a restart."""
    module = rack().ready()
    module.g[70] = 700
    module.save()
    module.g[70] = 800
    module.g[22] = 2
    module.handshake(0x1F)
    equal(module.g[70], 500)
    module.restart()
    equal(module.g[70], 700)
    module.g[22] = 3
    module.handshake(0x1F)
    module.rig.power_cycle()
    module.ready()
    equal(module.g[70], 500)
    module.sdo_write(OWN, 0x1017, 0, 300, 2)
    module.store_objects()
    module.sdo_write(OWN, 0x1011, 1, 0x64616F6C, 4)
    equal(module.sdo_read(OWN, 0x1017), 300)
    module.restart()
    equal(module.sdo_read(OWN, 0x1017), 0)


@play(RJ, "App. 1 X2/Y2", "App. 1 X0")
def rj_module_restart():
    """App. 1, X2/Y2: about 6 seconds; unsaved settings are lost, errors are cleared."""
    module = node()
    module.g[71] = 10
    module.until_x(0x0F, within=1)
    module.g[70] = 900
    begin = module.rig.time
    module.y(0x02, True)
    module.run(0.1)
    equal(bit(module.g[25], 7), 1)
    module.until_x(0x02)
    assert 5 < module.rig.time - begin < 7
    module.y(0x02, False)
    module.until_x(0x02, False, 1)
    module.ready()
    equal([module.g[70], module.g[71], module.g[29], module.x(0x0F)], [500, 500, 0, False])


@play(RJ, "App. 3 RPDO mapping parameter", "App. 3 TPDO mapping parameter", "App. 3 RPDO communication parameter",
      "App. 3 TPDO communication parameter", "5.4 PDO communication is not available")
def rj_pdo_mapping_procedure():
    """App. 3: COB-ID invalid, sub-index 00H = 0, the entries, sub-index 00H, COB-ID valid."""
    module = node()
    for communication, mapping, entries, cob_id in ((0x1400, 0x1600, (0xA5800110, 0xA5800210), 0x203),
                                                    (0x1800, 0x1A00, (0xA1000110, 0xA1000210), 0x40000183)):
        equal(module.cif(0x0002, OWN, mapping, 1, 4, entries[0] & 0xFFFF, entries[0] >> 16)[0], 0x000F, "while it is valid")
        module.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        module.sdo_write(OWN, mapping, 0, 0, 1)
        for sub, entry in enumerate(entries, start=1):
            module.sdo_write(OWN, mapping, sub, entry, 4)
        module.sdo_write(OWN, mapping, 0, 2, 1)
        module.sdo_write(OWN, communication, 1, cob_id, 4)
    module.bus.send("000 01 03")
    module.run(0.02)
    module.g[13000:13002] = [0x1111, 0x2222]
    module.bus.send("203 01 00 02 00")
    module.run(0.01)
    module.exchange()
    module.bus.expect("183 11 11 22 22")
    equal(module.g[10000:10002], [1, 2])


@play(RJ, "App. 4")
def rj_cpu_stop_and_run_of_the_nmt_master():
    """App. 4, NMT master: STOP ends heartbeat and master operations, RUN begins NMT start-up again."""
    module, five = booted(more_objects=', "1017:00" = 100')
    module.plc.remote_stop()
    module.bus.expect("0FF 00 FF 81 4D 45 30 30 32", within=0.2)
    module.bus.answering(0.05)
    module.bus.discard()
    module.bus.expect_none(1, "77F", "000")
    module.plc.remote_run()
    module.bus.expect("000 82 00", "000 01 05", within=4)
    module.bus.expect("77F 05", within=1)


@play(RJ, "1.12 CPU STOP transition message", "App. 4", "App. 1 X0")
def rj_cpu_in_stop_from_the_start():
    """App. 4: RUN to STOP "including the case in which the status is STOP immediately after startup"."""
    module = rack(node=3, plc='cpu = "stop"').ready()
    module.run(1)
    assert [frame for frame in module.bus.received("083") if frame.endswith("4D 45 30 30 32")], module.bus.received()
    module.bus.send("000 01 03")
    module.run(0.05)
    equal(bit(module.g[25], 9), 0)


@play(RJ, "1.7 EMCY sending", "App. 4")
def rj_emcy_comes_behind_the_boot_up_message():
    """1.2 NMT state: EMCY belongs to Pre-operational and Operational; the boot-up message comes first."""
    module = rack(node=3, plc='cpu = "stop"').ready()
    module.run(1)
    equal(module.bus.received("703", "083")[0], "703 00")


@play(RJ, "5.1", "App. 1 X0")
def rj_watchdog_error():
    """5.1: a major error: RUN off; App. 1: X0 turns off when a watchdog timer error occurs."""
    module = rack(settings='fault = "watchdog error"\nfault_at = "8s"').ready()
    module.run(9 - module.rig.time)
    leds = module.rig.leds()
    equal([leds["RUN"], module.x(0x00)], ["off", False])


@play(RJ, "5.3", "App. 2 G22")
def rj_flash_rom_error():
    """5.3, b4: invalid data in the flash ROM; it has gone when the settings were saved again."""
    module = rack().ready()
    module.g[70] = 900
    module.g[22] = 1
    module.y(0x1F, True)
    module.run(0.003)
    module.rig.power_cycle()
    module.ready()
    equal([module.g[29], module.g[70], module.x(0x0F)], [1 << 4, 500, True])
    module.save()
    module.restart()
    equal([module.g[29], module.x(0x0F)], [0, False])


# --- what App. 1 to 3 say besides


@play(RJ, "App. 2 G24", "App. 1 X3/Y3", "App. 2 G37")
def rj_bit_rates():
    """App. 2, Un\\G24: each rate, in force after save and restart (405 mode), at the transition to online (Layer 2 mode)."""
    module = rack(peer=False).ready()
    for rate in (10, 20, 50, 100, 125, 250, 500, 800, 1000):
        module.g[24] = rate
        module.save()
        module.restart()
        equal([module.g[24], module.g[37]], [rate, 10 * rate])
    module.rig.close()
    module = layer2()
    equal(module.g[37], 0, "offline")
    for rate in (500, 1000):
        module.g[24] = rate
        module.y(0x03, True)
        module.until_x(0x03)
        equal(module.g[37], 10 * rate)
        module.y(0x03, False)
        module.until_x(0x03, False, 1)


@play(RJ, "App. 1 XF/YF")
def rj_no_error_while_it_is_cleared():
    """App. 1, XF/YF: while YF is ON no error is detected; afterwards detection resumes."""
    module = rack().ready()
    module.y(0x0F, True)
    module.run(0.02)
    module.g[71] = 10
    module.run(0.05)
    equal([module.g[29], module.x(0x0F)], [0, False])
    module.y(0x0F, False)
    module.run(0.02)
    module.g[71] = 10
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[39]], [1 << 6, 71])


@play(RJ, "App. 2 G35", "5.3")
def rj_warning_level_and_error_passive():
    """App. 2, Un\\G35; 5.3, b14: alone on the bus."""
    module = rack("buffer = { G24 = 10 }", node=1, bit_rate=10_000, peer=False)
    levels = {}
    for _ in range(3000):
        module.run(0.001)
        counter, status, error = module.g[35], bit(module.g[25], 1), bit(module.g[29], 14)
        levels.setdefault("warning" if 96 <= counter < 128 else "passive" if counter >= 128 else "active", set()).add((status, error))
        if counter >= 128:
            break
    equal(levels, {"active": {(0, 0)}, "warning": {(1, 0)}, "passive": {(0, 1)}})


@play(RJ, "App. 3 Pre-defined error field", "App. 3 Error register", "1.7 EMCY sending")
def rj_error_history():
    """App. 3, 1003H: 15 errors, the latest first; 0 deletes them, any other value is refused."""
    module = node()
    for code in range(1, 17):
        module.cif(0x000A, 0x1000 + code, 0x0081, 0, 0)
    equal([module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1003, 1) & 0xFFFF, module.sdo_read(OWN, 0x1003, 15) & 0xFFFF],
          [15, 0x1010, 0x1002])
    equal(module.cif(0x0002, OWN, 0x1003, 0, 1, 1)[0], 0x000F)
    module.sdo_write(OWN, 0x1003, 0, 0, 1)
    equal([module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1001)], [0, 0])


@play(RJ, "App. 2 G10000, G13000", "1.4 TPDO", "1.4 RPDO")
def rj_words_are_objects():
    """App. 2, RPDO and TPDO: words and their objects, first and last; App. 3: default mappings."""
    module = operational()
    for index, sub, word in ((0xA580, 0x01, 10000), (0xA580, 0xFE, 10253), (0xA581, 0x01, 10254), (0xA584, 0x08, 11023)):
        module.sdo_write(OWN, index, sub, 0x1234, 2)
        module.exchange()
        equal(module.g[word], 0x1234, f"{index:04X}H:{sub:02X}H")
    for mapping, sub, entry in ((0x1600, 1, 0xA5800110), (0x1602, 3, 0xA5800B10), (0x16FF, 4, 0xA5840810), (0x1A00, 1, 0xA1000110),
                                (0x1AFF, 4, 0xA1040810)):
        equal(module.sdo_read(OWN, mapping, sub), entry, f"{mapping:04X}H:{sub:02X}H")
    module.g[13000] = 0x4321
    module.exchange()
    equal([module.sdo_read(OWN, 0xA100, 1), module.cif(0x0002, OWN, 0xA100, 1, 2, 5)[0:5]],
          [0x4321, [0x000F, 3, 0, 0x0002, 0x0601]], "network input variables are read only")


@play(RJ, "3.2 Parameter settings", "2.4", "App. 3 NMT slave assignment")
def rj_parameter_settings_as_the_windows_show_them():
    """3.2, steps 1 to 7, with the values of the windows: TPDO 1 and RPDO 1 with one signed 8-bit object each, NMT master, node 1 as NMT
    slave and boot slave, heartbeat. The windows are the plant file's `parameters`."""
    module = rack(node=127, tail='''
[plc.module.parameters.objects]
"1800:01" = 0x40000181
"1800:02" = 0xFE
"1A00:00" = 1
"1A00:01" = 0xA0000108
"1400:01" = 0x00000201
"1400:02" = 0xFE
"1600:00" = 1
"1600:01" = 0xA4800108
"1F80:00" = 0x01
"1F81:01" = 0x05
"1016:01" = 0x000105DC
''').ready()
    one = slave(module, 1)
    module.bus.expect("000 82 00", within=8)
    one.power_on()
    one.heartbeat = 0.5
    module.bus.expect("000 01 01", within=3)
    module.rig.until(lambda: bit(module.g[25], 9) and module.g[601] == 5, "Operational", 3)
    module.bus.discard()
    module.g[13000] = 0x3385                                # LByte: -123
    module.exchange()
    module.bus.expect("181 85")
    module.bus.send("201 7B")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000] & 0xFF, 0x7B)
    one.is_off = True
    module.until_x(0x10, within=3)
    equal(bit(module.g[401], 7), 1)


@play(RJ, "1.11 Data transmission", "App. 1 X3/Y3")
def rj_layer2_data_of_the_transition_to_online():
    """1.11, point: regardless of the transmission type, at the transition to online mode send data are updated and sent."""
    slots = {}
    for slot in range(5):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": 0x5FFF, f"G{6002 + 4 * slot}": slot,
                      f"G{6003 + 4 * slot}": 1000, f"G{10000 + 7 * slot}": 0x101 + slot, f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(5):
        module.g[10002 + 7 * slot:10004 + 7 * slot] = [1, 0x21 + slot]
    module.y(0x03, True)
    module.until_x(0x03)
    module.run(0.05)
    equal(sorted(module.bus.received()), [f"10{1 + slot} {21 + slot}" for slot in range(5)])
    module.g[10003] = 0x99                                  # afterwards Y1 is required
    module.g[8400] = 1
    module.handshake(0x04)
    module.bus.expect("101 21", "101 21")


@play(RJ, "1.11 RTR transmission", "App. 1 X3/Y3")
def rj_layer2_rtr_transmission_knows_no_cos():
    """1.11, RTR transmission: neither Event (COS) nor Cycle (COS) can be selected."""
    for kind in (1, 3):
        module = layer2(G6000=0xFFFF, G6001=0x5FFF, G6002=kind, G10000=0x0501, G10001=0)
        module.g[10002] = 0x8008
        module.y(0x03, True)
        module.rig.until(lambda: bit(module.g[29], 6), "a setting error", 1)
        equal(module.x(0x03), False)
        module.rig.close()


@play(RJ, "1.11 Data reception", "App. 2 G10000")
def rj_layer2_flow_of_receiving_data():
    """1.11, flow of receiving data: Y1, X1, then the words; frames of the offline mode are not retrieved."""
    acknowledges = f'[[device]]\nnode = 9\neds = "{DEVICES}/io-block.eds"\n'   # an offline module does not
    module = rack("buffer = { G21 = 11, G6000 = 0x0181, G6001 = 0, G6002 = 0, G6003 = 0 }", more=acknowledges).ready()
    module.bus.send("181 01")
    module.run(0.05)
    online(module)
    module.exchange()
    equal(module.g[10002] >> 8, 0, "App. 1, X3/Y3: received in the offline mode")
    module.bus.send("181 02 03")
    module.run(0.01)
    equal(module.g[10002] >> 8, 0, "before Y1")
    module.y(0x01, True)
    module.until_x(0x01)
    equal(module.g[10000:10004], [0x0181, 0, 0x0302, 0x0302])
    module.y(0x01, False)
    module.until_x(0x01, False, 1)


@play(RJ, "App. 2 G22", "App. 2 G21", "2.1 Layer 2")
def rj_what_is_saved_and_restored():
    """App. 2, Un\\G22: areas of the function mode used are saved, all areas are restored."""
    module = rack().ready()
    module.g[70] = 700
    module.save()
    module.g[21] = 11
    module.save()
    module.restart()
    module.g[6000:6004] = [0x0123, 0, 0, 0]
    module.save()
    module.g[21] = 405
    module.save()
    module.restart()
    equal(module.g[70], 700)
    module.g[21] = 11
    module.save()
    module.restart()
    equal(module.g[6000:6002], [0x0123, 0])
    module.g[22] = 3
    module.handshake(0x1F)
    equal(module.g[6000:6002], [0xFFFF, 0xFFFF])
    module.restart()
    equal([module.g[21], module.g[70]], [405, 500])


@play(RJ, "1.2 NMT start-up", "App. 2 G25")
def rj_optional_slave_that_fails():
    """1.2 NMT start-up, steps 5 and 6; App. 2, Un\\G25 bit 13: an optional slave failed; the network starts without it."""
    module = master(0x01, ', "1F81:05" = 0x05, "1F85:05" = 0x9999')
    five = slave(module, 5)
    module.bus.expect("000 82 00", within=8)
    five.power_on()
    module.rig.until(lambda: bit(module.g[25], 13), "optional NMT slave failed to start", 5)
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 2)
    equal([bit(module.g[25], 11), "000 01 05" in module.bus.received("000")], [0, False])
