"""Plays of the FX2N-32CAN User's Manual (JY992D92801)."""
from rig import Rig, bit, equal, number_of, play

END = 0xFFFF  # end of a parameter table (7.3.5, 8.2.5)


def module(node, name, settings="", position=0):
    """A rack with one FX2N-32CAN; FROM and TO words are one memory, as in the ports."""
    return f'''
[[plc]]
name = "plc{node}"
family = "FX3"
listen = "127.0.0.1:0"
store = "state"
[[plc.module]]
name = "{name}"
model = "FX2N-32CAN"
position = {position}
bus = "line"
{settings}
'''


def plant(*parts, bit_rate=125_000):
    return f'''
[plant]
name = "FX2N-32CAN"
[[bus]]
name = "line"
bit_rate = {bit_rate}
serve = "socketcand:127.0.0.1:0"
''' + "".join(parts)


def rack(node=5, objects="", **options):
    """A module with this node address whose watchdog is off, ready and Pre-operational."""
    rig = Rig(plant(module(node, "module", f"node = {node}\nbuffer = {{ G26 = 0 }}\n{objects}")), **options)
    if rig.bus:
        rig.bus.expect(f"{0x700 + node:03X} 00", within=8)
    return rig, rig.plc.g[0]


def start(rig, node=5):
    """Operational, by an NMT master on the bus."""
    rig.bus.send(f"000 01 {node:02X}")
    rig.plc.wait("U0\\G25 >= 512", 1)
    rig.bus.discard()


def exchange(rig, memory, *values, first=0):
    """Data to transmit, then 1 to BFM20 (4.2.2)."""
    if values:
        memory[first:first + len(values)] = values
    memory[20] = 1
    rig.run(0.02)


def sdo(memory, rig, index, sub=0, node=0):
    """The number that an SDO read (6.1) brings."""
    result = rig.command(memory, 4, node, index, sub)
    equal(result[0], 5, f"result of the SDO read of {index:04X}H:{sub:02X}H (class {result[1]:04X}H)")
    return number_of(result[5:7], result[4])


# --- 4 Buffer memory structure, parameter set-up


@play("FX2N-32CAN", "4.1", "4.2.3", "4.2.5", "4.2.6")
def fx2n_reads_what_table_4_1_says_of_a_new_module():
    """4.1: Table 4.1 has the module code K7100 and the defaults."""
    rig = Rig(plant(module(127, "module"), bit_rate=10_000))
    memory = rig.plc.g[0]
    equal(memory[30], 7100, "module code")
    equal(memory[24], 10, "default 10kBd")
    equal(memory[26], 20, "default = 20 equals 200ms")
    equal(memory[27], 127, "default = 127")
    rig.bus.expect("77F 00", within=8)
    equal(memory[25] & 0x0301, 0x0101, "online, Pre-operational")
    memory[30] = 1
    equal(memory[30], 7100, "(Read only)")


@play("FX2N-32CAN", "4.2.2", "4.2.1")
def fx2n_data_exchange_moves_whole_pdos():
    """4.2.2: TO data go to the bus after a write access to BFM20 alone, FROM data stay as they are until the next one."""
    rig, memory = rack()
    equal(bit(memory[20], 0), 0, "not in data exchange mode")
    start(rig)
    equal(bit(memory[20], 0), 1, "in data exchange mode")
    memory[0:4] = [0x1111, 0x2222, 0x3333, 0x4444]          # TO, one after the other
    rig.bus.expect_none(0.2)                                  # not sent before BFM20 was written
    memory[20] = 1
    rig.bus.expect("185 11 11 22 22 33 33 44 44", others=False)
    rig.bus.send("205 01 02 03 04 05 06 07 08")
    rig.run(0.05)
    equal(memory[0:4], [0, 0, 0, 0], "FROM before the exchange")
    exchange(rig, memory)
    equal(memory[0:4], [0x0201, 0x0403, 0x0605, 0x0807], "FROM")
    rig.bus.send("205 FF FF FF FF FF FF FF FF")
    rig.run(0.05)
    equal(memory[0:4], [0x0201, 0x0403, 0x0605, 0x0807], "no new exchange command")
    exchange(rig, memory)
    equal(memory[0:4], [0xFFFF] * 4, "FROM")
    rig.bus.send("000 80 05")                             # enter Pre-operational
    rig.run(0.02)
    equal(bit(memory[20], 0), 0, "not in data exchange mode")
    exchange(rig, memory, 5)
    rig.bus.expect_none(0.2)


@play("FX2N-32CAN", "4.2.3", "4.2.4", "4.2.6", "4.2.8")
def fx2n_bit_rate_and_node_address_change():
    """4.2.3, 4.2.4, 4.2.6: set BFM24 and BFM27, then the restart command, or a power down; 4.2.8: both are kept."""
    rig = Rig(plant(module(127, "module"), bit_rate=125_000), peer=False)
    memory = rig.plc.g[0]
    rig.run(2)
    memory[24] = 125                                        # the rate of the network
    memory[27] = 5
    equal(memory[27], 127, "the actual address is displayed")
    memory[26] = 0
    memory[25] = 1                                          # restart command, as a pulse
    equal(bit(memory[25], 0), 0, "module offline")
    rig.plc.wait(lambda: bit(memory[25], 0), 8)
    equal(memory[24], 125)
    equal(memory[27], 5, "the new address")
    memory[27] = 9
    rig.power_cycle(peer=True)                                     # a power down of the host PLC
    rig.bus.expect("709 00", within=8)                    # at 125 kbit/s
    memory = rig.plc.g[0]
    equal([memory[24], memory[26], memory[27]], [125, 0, 9], "kept by EEPROM")
    rig.bus.send("609 40 00 10 00 00 00 00 00")
    rig.bus.expect("589 43 00 10 00 95 01 00 00")


@play("FX2N-32CAN", "4.2.3")
def fx2n_takes_every_bit_rate_of_table_4_2():
    """4.2.3: Table 4.2. Each is set, and the module restarted with it."""
    rig = Rig(plant(module(127, "module")), peer=False)
    memory = rig.plc.g[0]
    rig.run(2)
    memory[26] = 0
    for rate in (10, 20, 50, 125, 250, 500, 800, 1000):
        memory[24] = rate
        memory[25] = 1
        rig.plc.wait(lambda: bit(memory[25], 0), 8)
        equal(memory[24], rate)
        equal(bit(memory[29], 11), 0, "set baud rate valid")


@play("FX2N-32CAN", "4.2.4")
def fx2n_communication_status_follows_the_network_state():
    """4.2.4: Table 4.3, bits 9 and 8 in each state, bit 0 online."""
    rig, memory = rack()
    for command, state in (("01", 0b10), ("02", 0b00), ("80", 0b01), ("01", 0b10)):
        rig.bus.send(f"000 {command} 00")
        rig.run(0.02)
        equal(memory[25] & 0x0301, state << 8 | 1)


@play("FX2N-32CAN", "4.2.5", "4.2.7")
def fx2n_watchdog_of_from_and_to():
    """4.2.5: error after the time without FROM or TO, reset by writing BFM26, disabled by 0; 4.2.7: the emergency message."""
    rig, memory = rack()
    start(rig)
    memory[26] = 20
    for _ in range(10):                                     # normal operation: any BFM resets the timer
        rig.run(0.19)
        equal(memory[30], 7100)
    equal(bit(memory[29], 7), 0)
    rig.bus.expect_none(0.001)
    rig.run(0.21)                                         # no FROM or TO for 210 ms
    rig.bus.expect("085 00 62 01 33 30 30 58 46")         # an emergency message, if Operational
    equal(bit(memory[29], 7), 1, "FROM/TO watchdog timer")
    memory[29] = 0
    equal(bit(memory[29], 7), 1, "it must be reset by writing BFM26")
    memory[26] = 20
    equal(bit(memory[29], 7), 0)
    memory[26] = 0                                          # disabled
    rig.bus.discard()
    rig.bus.expect_none(5, "085")
    equal(bit(memory[29], 7), 0, "b7 will never become 1")
    rig.bus.send("000 80 05")
    rig.run(0.02)
    memory[26] = 20
    rig.bus.discard()
    rig.bus.expect_none(0.3)                                  # in Pre-operational: the bit, and no message
    equal(bit(memory[29], 7), 1)


@play("FX2N-32CAN", "4.2.7")
def fx2n_wrong_settings_are_errors_of_bfm_29():
    """4.2.7: bits 11 and 12, "no change"; they are reset as soon as a valid value is there."""
    rig, memory = rack()
    memory[24] = 100
    equal(memory[24], 125, "no change")
    equal(memory[29], 1 << 11)
    memory[24] = 250
    equal(memory[29], 0)
    memory[24] = 125
    for wrong in (0, 128):
        memory[27] = wrong
        equal(memory[27], 5)
        equal(memory[29], 1 << 12)
    memory[27] = 7
    equal(memory[29], 0, "solved")


@play("FX2N-32CAN", "4.2.7")
def fx2n_alone_on_the_bus_is_error_passive_and_latches_it():
    """4.2.7: bit 14 is latched, and reset by 0 when the cause is gone."""
    rig = Rig(plant(module(5, "module", "node = 5\nbuffer = { G26 = 0 }")), peer=False)
    memory = rig.plc.g[0]
    rig.run(3)                                            # its boot-up message is acknowledged by nobody
    equal(bit(memory[29], 14), 1, "CAN error passive")
    memory[29] = 0
    equal(bit(memory[29], 14), 1, "the cause is still there")
    equal(bit(memory[29], 0), 0, "b14 is no general error")


# --- 5 Object dictionary


@play("FX2N-32CAN", "5.1", "5.2")
def fx2n_words_are_objects_as_tables_5_1_and_5_2_say():
    """5.1, 5.2: each type of a word's object, by SDO read from the own node."""
    rig, memory = rack()
    start(rig)
    exchange(rig, memory, 0x1234, 0x5678)
    for index, sub, value in ((0xA100, 1, 0x1234), (0xA0C0, 1, 0x1234), (0xA040, 1, 0x34), (0xA040, 2, 0x12), (0xA000, 1, 0x34),
                              (0xA100, 2, 0x5678), (0xA200, 1, 0x56781234), (0xA1C0, 1, 0x56781234), (0xA240, 1, 0x56781234)):
        equal(sdo(memory, rig, index, sub), value, f"{index:04X}H:{sub:02X}H")
    for word, sub16, sub8, sub32 in ((19, 0x14, 0x27, 0x0A), (100, 0x15, 0x29, 0x0B), (199, 0x78, 0xEF, 0x3C)):
        memory[word] = 0xABCD
        exchange(rig, memory)
        equal(sdo(memory, rig, 0xA100, sub16), 0xABCD, f"BFM{word}")
        equal(sdo(memory, rig, 0xA040, sub8), 0xCD, f"BFM{word}, lower 8 bit")
        equal(sdo(memory, rig, 0xA040, sub8 + 1), 0xAB, f"BFM{word}, higher 8 bit")
        high = word % 2 * 16
        equal(sdo(memory, rig, 0xA200, sub32) >> high & 0xFFFF, 0xABCD, f"BFM{word} in 32 bits")
    rig.bus.send("205 01 02 03 04 05 06 07 08")
    rig.run(0.02)
    exchange(rig, memory)
    for index, sub, value in ((0xA580, 1, 0x0201), (0xA540, 2, 0x0403), (0xA4C0, 5, 0x05), (0xA480, 8, 0x08),
                              (0xA680, 1, 0x04030201), (0xA640, 2, 0x08070605), (0xA6C0, 2, 0x08070605)):
        equal(sdo(memory, rig, index, sub), value, f"{index:04X}H:{sub:02X}H")
    result = rig.command(memory, 4, 0, 0xA100, 0x79)
    equal(result[0:5], [0x000F, 3, 0, 0x0011, 0x0609], "behind the last sub-index")


@play("FX2N-32CAN", "5.3.2")
def fx2n_has_the_objects_of_table_5_4():
    """5.3.2: every index of Table 5.4 is answered."""
    rig, memory = rack()
    for index in (0x1000, 0x1001, 0x1004, 0x1005, 0x1006, 0x1007, 0x100B, 0x100C, 0x100D):
        sdo(memory, rig, index)
    equal(sdo(memory, rig, 0x100B), 5, "Node ID")
    for index in (0x1008, 0x1009, 0x100A):
        equal(rig.command(memory, 4, 0, index, 0)[0], 5, "a text")
    for index in (0x1010, 0x1011, 0x1400, 0x141D, 0x1600, 0x161D, 0x1800, 0x181D, 0x1A00, 0x1A1D):
        sdo(memory, rig, index, 1)


# --- 6 Command interface


@play("FX2N-32CAN", "6.1")
def fx2n_sdo_read_request():
    """6.1: node address, index, subindex, then command code 4. Table 6.1."""
    rig, memory = rack()
    rig.bus.discard()
    result = rig.command(memory, 4, 0, 0x1000, 0)         # "0" is the connected module
    equal(result[0:7], [5, 0, 0x1000, 0, 4, 0x0195, 0])
    result = rig.command(memory, 4, 5, 0x1000, 0)         # or its actual address
    equal(result[0:7], [5, 5, 0x1000, 0, 4, 0x0195, 0])
    rig.bus.expect_none(0.01)
    memory[1001:1004] = [9, 0x1000, 0]
    memory[1000] = 4
    equal(memory[1000], 0xFFFF, "CIF BUSY")
    rig.bus.expect("609 40 00 10 00 00 00 00 00")
    rig.bus.send("589 43 00 10 00 91 01 0F 00")
    rig.run(0.01)
    equal(memory[1000:1007], [5, 9, 0x1000, 0, 4, 0x0191, 0x000F])


@play("FX2N-32CAN", "6.1")
def fx2n_sdo_read_of_a_long_object():
    """6.1: up to 118 data bytes, the 1st in the low byte of BFM1005; more are the error of Table 6.5."""
    rig, memory = rack()
    text = bytes(range(1, 119))
    answers = {"609 40 00 20 00 00 00 00 00": f"589 41 00 20 00 {len(text):02X} 00 00 00"}
    for number in range(0, len(text), 7):
        part = text[number:number + 7]
        toggle = number // 7 % 2 << 4
        last = number + 7 >= len(text)
        answers.setdefault(f"609 {0x60 | toggle:02X} 00 00 00 00 00 00 00", []).append(
            f"589 {toggle | (7 - len(part)) << 1 | last:02X} {part.ljust(7, bytes(1)).hex(' ')}")
    rig.bus.answers = answers
    result = rig.command(memory, 4, 9, 0x2000, 0)
    equal(result[0:5], [5, 9, 0x2000, 0, 118])
    equal(result[5:64], [2 * i + 1 | (2 * i + 2) << 8 for i in range(59)])
    rig.bus.answers = {"609 40 00 20 00 00 00 00 00": "589 41 00 20 00 77 00 00 00"}  # 119 bytes
    result = rig.command(memory, 4, 9, 0x2000, 0)
    equal(result[0:5], [0x000F, 3, 9, 0x0000, 0x6060], "buffer too small")


@play("FX2N-32CAN", "6.2")
def fx2n_sdo_write_request():
    """6.2: data length and parameter data besides, command code 2."""
    rig, memory = rack()
    rig.bus.answers = {"609 2B 17 10 00 E8 03 00 00": "589 60 17 10 00 00 00 00 00"}
    result = rig.command(memory, 2, 9, 0x1017, 0, 2, 0x03E8)
    equal(result[0:4], [3, 9, 0x1017, 0])
    result = rig.command(memory, 2, 0, 0x100C, 0, 2, 100)
    equal(result[0:4], [3, 0, 0x100C, 0])
    equal(sdo(memory, rig, 0x100C), 100)


@play("FX2N-32CAN", "6.3")
def fx2n_layer_2_messages():
    """6.3: COB-ID, RTR, DLC and data bytes, command 000C hex."""
    rig, memory = rack()
    rig.bus.discard()
    result = rig.command(memory, 0x000C, 0x0333, 0, 0, 3, 0x2211, 0x0033)
    assert result[0] != 0x000F, "a queue was available"
    rig.bus.expect("333 11 22 33", others=False)
    rig.command(memory, 0x000C, 0x0185, 0, 1, 8)
    rig.command(memory, 0x000C, 0, 0, 0, 2, 0x0001)       # NMT: start all nodes
    rig.bus.expect("000 01 00")
    equal([str(frame) for frame in rig.remote_frames()], ["185 R8"])


@play("FX2N-32CAN", "6.3.1", "7.1")
def fx2n_pdo_remote_transmission_request():
    """6.3.1: an RPDO number, 8101 hex; 81FF hex for one that was not configured; 0 asks for all local Rx-PDOs."""
    rig, memory = rack(node=1)
    equal(rig.command(memory, 0x8900)[0], 0x8901)         # mode 0: RPDO 1 to 4
    equal(rig.command(memory, 0x8100, 1)[0], 0x8101)
    equal(rig.command(memory, 0x8100, 7)[0:2], [0x81FF, 7], "no COB-ID found")
    equal(rig.command(memory, 0x8100, 0)[0], 0x8101)
    rig.run(0.1)
    equal([frame.identifier for frame in rig.remote_frames()], ["201", "201", "301", "401", "501"])


@play("FX2N-32CAN", "6.3.1")
def fx2n_running_remote_transmission_is_aborted():
    """6.3.1: to abort, FFFF hex to the command BFM 1000."""
    rig, memory = rack(node=1)
    equal(rig.command(memory, 0x8200)[0], 0x8201)         # mode A: 30 Rx-PDOs
    memory[1001] = 0
    memory[1000] = 0x8100
    equal(memory[1000], 0xFFFF, "CIF busy")
    memory[1000] = 0xFFFF
    rig.until(lambda: memory[1000] != 0xFFFF, "CIF is ready", 0.1)
    equal(rig.command(memory, 4, 0, 0x1001, 0)[0], 5, "a new command")
    rig.run(0.2)
    assert len(rig.remote_frames()) < 30, "all PDOs were requested"


@play("FX2N-32CAN", "6.4.1", "6.4.2", "6.4.3")
def fx2n_sdo_errors():
    """6.4.1 to 6.4.3: class 3, device ID, error code low word first; what the partner aborts with, and local time out."""
    rig, memory = rack()
    rig.bus.answers = {"609 40 55 55 00 00 00 00 00": "589 80 55 55 00 00 00 02 06"}
    equal(rig.command(memory, 4, 9, 0x5555, 0)[0:5], [0x000F, 3, 9, 0x0000, 0x0602])
    equal(rig.command(memory, 4, 8, 0x1000, 0, within=5)[0:5], [0x000F, 3, 8, 0x0000, 0x5000], "time out")
    equal(rig.command(memory, 4, 0, 0x5555, 0)[0:5], [0x000F, 3, 0, 0x0000, 0x0602], "the local dictionary")


@play("FX2N-32CAN", "6.4.4", "6.4.6", "6.4.7")
def fx2n_busy_command_interface_is_reset():
    """6.4.4: unknown command; 6.4.6: TO while busy; 6.4.7: FFFF hex, then BFM1000 displays 0000 hex."""
    rig, memory = rack()
    equal(rig.command(memory, 0x1234)[0:2], [0x000F, 0x0064], "unknown command")
    memory[1001:1004] = [9, 0x1000, 0]
    memory[1000] = 4
    equal(memory[1000], 0xFFFF, "CIF busy")
    memory[1002] = 0x2000                                   # a parameter change
    equal(memory[1000:1002], [0x000F, 0xFFFF])
    rig.run(2)
    equal(memory[1000:1002], [0x000F, 0xFFFF], "until it is acknowledged")
    memory[1000] = 0xFFFF
    rig.until(lambda: memory[1000] == 0, "the CIF is available again", 0.1)
    rig.bus.answers = {"609 40 00 10 00 00 00 00 00": "589 43 00 10 00 91 01 0F 00"}
    equal(rig.command(memory, 4, 9, 0x1000, 0)[0:7], [5, 9, 0x1000, 0, 4, 0x0191, 0x000F])


@play("FX2N-32CAN", "6.4.5", "6.4.1", "6.3")
def fx2n_transmission_queue_is_full():
    """6.4.5: the access to the transmission queue was rejected: no node acknowledges, so that nothing leaves it."""
    rig = Rig(plant(module(5, "module", "node = 5\nbuffer = { G26 = 0 }")), peer=False)
    memory = rig.plc.g[0]
    rig.run(2)
    results = []
    for _ in range(200):
        results.append(rig.command(memory, 0x000C, 0x0333, 0, 0, 1, 0x11)[0:2])
        if results[-1][0] == 0x000F:
            break
    equal(results[-1], [0x000F, 0x8FFF])
    assert len(results) > 1, "the queue takes a frame"


@play("FX2N-32CAN", "4.2.7", "4.2.4")
def fx2n_bus_off_and_restart():
    """4.2.7: bit 3, and bit 0 with it; 4.2.4: a restart brings the module back, the bits are reset by themselves."""
    rig = Rig(plant('[[bus.fault]]\nkind = "stuck recessive"\nports = ["module"]\nfrom = "2s"\nuntil = "3s"\n',
                        module(5, "module", "node = 5\nbuffer = { G26 = 0 }")))
    memory = rig.plc.g[0]
    rig.run(2.1)
    equal(memory[29], 0)
    rig.command(memory, 0x000C, 0x0333, 0, 0, 1, 0x11)
    rig.until(lambda: bit(memory[29], 3), "bus off", 1)
    equal([bit(memory[29], 0), bit(memory[20], 0)], [1, 0])
    rig.run(1)
    rig.bus.discard()
    memory[25] = 1
    rig.run(0.1)
    rig.until(lambda: bit(memory[25], 0), "online", 8)
    equal([bit(memory[29], 3), bit(memory[29], 0)], [0, 0])
    rig.bus.expect("705 00", within=0.1)


@play("FX2N-32CAN", "6.4.7")
def fx2n_commands_wait_for_the_end_of_a_watchdog_error():
    """6.4.7: in From/To watchdog error the command execution is shifted."""
    rig, memory = rack()
    memory[26] = 10
    rig.run(0.15)
    equal(bit(memory[29], 7), 1)
    memory[1001:1004] = [0, 0x1000, 0]
    memory[1000] = 4
    rig.run(0.05)
    equal(memory[1000], 0xFFFF, "shifted")
    memory[26] = 0
    rig.run(0.01)
    equal(memory[1000:1007], [5, 0, 0x1000, 0, 4, 0x0195, 0])


# --- 7 Mapping modes


@play("FX2N-32CAN", "7.1", "7.4.1", "7.4.2")
def fx2n_factory_default_and_mode_0_mapping():
    """7.1, note of 7.4.2: two PDOs each way from the factory, four after the Mode 0 command."""
    rig, memory = rack(node=10)
    cob_ids = lambda first: [sdo(memory, rig, first + i, 1) & 0x800007FF for i in range(30)]
    off = 0x80000000
    valid = lambda words: [word & 0x7FF if not word & off else off for word in words]
    equal(valid(cob_ids(0x1800)), [0x18A, 0x28A] + [off] * 28, "factory, Tx")
    equal(valid(cob_ids(0x1400)), [0x20A, 0x30A] + [off] * 28, "factory, Rx")
    equal(rig.command(memory, 0x8900)[0], 0x8901)
    equal(valid(cob_ids(0x1800)), [0x18A, 0x28A, 0x38A, 0x48A] + [off] * 26, "mode 0, Tx")
    equal(valid(cob_ids(0x1400)), [0x20A, 0x30A, 0x40A, 0x50A] + [off] * 26, "mode 0, Rx")
    start(rig, 10)
    memory[0:16] = range(1, 17)
    memory[20] = 1
    for pdo in range(4):
        rig.bus.expect(f"{0x18A + 0x100 * pdo:03X} " + " ".join(f"{4 * pdo + i:02X} 00" for i in (1, 2, 3, 4)), others=False)
    rig.bus.send("50A 01 00 02 00 03 00 04 00")
    rig.run(0.02)
    exchange(rig, memory)
    equal(memory[12:16], [1, 2, 3, 4], "Rx-PDO 4: BFM#12 to #15")


@play("FX2N-32CAN", "7.2", "6.2")
def fx2n_three_stations_in_mode_a():
    """7.2: 8200 hex to all modules, one is the network manager by an SDO write; each station exchanges 16 words."""
    nodes = (1, 3, 8)
    rig = Rig(plant(*(module(node, f"node{node}", f"node = {node}\nbuffer = {{ G26 = 0 }}") for node in nodes)))
    memory = {node: rig.plant.plcs[f"plc{node}"].g[0] for node in nodes}
    rig.run(2)
    # 1: the network manager is defined by a CIF SDO write; it counts from a restart on, so it is stored first.
    equal(rig.command(memory[1], 2, 0, 0x1F80, 0, 4, 1, 0)[0], 3)
    # 2: the command to all modules
    for node in nodes:
        equal(rig.command(memory[node], 0x8200)[0], 0x8201)
        equal(rig.command(memory[node], 2, 0, 0x1010, 1, 4, 0x6173, 0x6576)[0], 3)   # "save"
    memory[1][25] = 1
    rig.run(1)
    rig.plant.plcs["plc1"].wait("U0\\G25 >= 512", 10)     # the manager is back, and Operational
    # 3: the manager starts the others, with a Layer 2 message (6.3)
    equal([bit(memory[node][25], 9) for node in nodes], [1, 0, 0])
    rig.command(memory[1], 0x000C, 0, 0, 0, 2, 0x0001)
    rig.run(0.1)
    equal([bit(memory[node][25], 9) for node in nodes], [1, 1, 1], "operational")
    rig.bus.discard()
    for node in nodes:
        memory[node][0:16] = [node << 8 | i for i in range(16)]
        memory[node][20] = 1
        rig.run(0.1)
    for node in nodes:
        for pdo in range(4):
            words = " ".join(f"{4 * pdo + i:02X} {node:02X}" for i in range(4))
            assert f"{0x180 + 0x100 * pdo + node:03X} {words}" in rig.bus.received(), f"Tx-PDO {pdo + 1} of node {node}"
    for reader in nodes:
        memory[reader][20] = 1
        rig.run(0.02)
        equal(memory[reader][112:128], [3 << 8 | i for i in range(16)] if reader != 3 else [0] * 16,
              f"station #3 is always BFM112-127, read by {reader}")
        if reader != 1:
            equal(memory[reader][0:16], [1 << 8 | i for i in range(16)], "station 1")
        if reader != 8:
            equal(memory[reader][192:200], [8 << 8 | i for i in range(8)], "station 8 can send just 8 words")
    for node, sub in ((1, 1), (3, 1)):
        equal(sdo(memory[node], rig, 0x1400, sub), 0x181, "Rx-PDO 1 is fixed")


@play("FX2N-32CAN", "7.2")
def fx2n_mode_a_refuses_a_node_above_8():
    """7.2: node number mismatch, 82FF hex."""
    rig, memory = rack(node=9)
    before = sdo(memory, rig, 0x1400, 1)
    equal(rig.command(memory, 0x8200)[0], 0x82FF)
    equal(sdo(memory, rig, 0x1400, 1), before)


@play("FX2N-32CAN", "7.3.1", "7.3.2", "7.3.3", "7.3.5", "7.4.4", "7.4.5")
def fx2n_mode_b_binds_two_nodes():
    """7.3: prepare the base (0000/0000), then the printed pair 1009/0203 hex; the warning of 7.4.5 for a disabled destination."""
    rig, memory = rack(node=1)
    result = rig.command(memory, 0x8300, 0, 0, END)       # 7.3.1
    equal(result[0], 0x8301)
    equal(result[1:67], [0] * 66, "0000 hex = no error")
    for pdo in range(30):
        equal(sdo(memory, rig, 0x1400 + pdo, 1) >> 31, 1, f"Rx-PDO {pdo + 1} disabled")
    equal([sdo(memory, rig, 0x1800 + i, 1) & 0x800007FF for i in range(5)], [0x181, 0x281, 0x381, 0x481, 0x80000000])
    # 7.3.2, 7.3.3: node 10H TPDO 9 to node 2 RPDO 3
    rig.bus.discard()
    rig.bus.answers = {"610 40 08 18 01 00 00 00 00": "590 43 08 18 01 90 01 00 00",
                         "602 40 02 14 01 00 00 00 00": "582 43 02 14 01 02 04 00 00",
                         "602 23 02 14 01 90 01 00 00": "582 60 02 14 01 00 00 00 00"}
    result = rig.command(memory, 0x8300, 0x1009, 0x0203, END)
    equal(result[0:3], [0x8301, 0, 0], "binding done without errors")
    rig.bus.expect("610 40 08 18 01 00 00 00 00", "602 40 02 14 01 00 00 00 00", "602 23 02 14 01 90 01 00 00")
    # 7.4.5: the destination was 80000000 hex: bound, and told
    rig.bus.answers["602 40 02 14 01 00 00 00 00"] = "582 43 02 14 01 00 00 00 80"
    equal(rig.command(memory, 0x8300, 0x1009, 0x0203, END)[0:3], [0x83FF, 0, 0x0003])
    # note of 7.4.5: not for the local node
    equal(rig.command(memory, 0x8300, 0x1009, 0x0003, END)[0:3], [0x8301, 0, 0])
    equal(sdo(memory, rig, 0x1402, 1), 0x190)


@play("FX2N-32CAN", "7.3.4")
def fx2n_mode_b_occupies_a_cob_id():
    """7.3.4: Source 7F01 hex, Destination 8005 hex: Tx-PDO 5 with COB-ID 1FF hex."""
    rig, memory = rack(node=1)
    rig.bus.discard()
    equal(rig.command(memory, 0x8300, 0x7F01, 0x8005, END)[0:3], [0x8301, 0, 0])
    rig.bus.expect_none(0.01)
    start(rig, 1)
    memory[16:20] = [1, 2, 3, 4]
    memory[20] = 1
    rig.bus.expect("1FF 01 00 02 00 03 00 04 00")
    result = rig.command(memory, 0x8300, 0x7F01, 0x8004, END)
    equal(result[0], 0x83FF, "the first four PDOs")
    assert result[1] or result[2], "the parameter that caused the error"


@play("FX2N-32CAN", "7.4.3", "7.4.4", "7.4.5", "7.4.6")
def fx2n_mode_b_errors_name_the_parameter():
    """7.4.3 to 7.4.6: Source5 (BFM1009) different from 0; the four states of a parameter; prepare in a later pair."""
    rig, memory = rack(node=1)
    equal(rig.command(memory, 0x8900)[0], 0x8901)         # the base: mode 0
    good = [0x0001, 0x0001, 0x0002, 0x0002, 0x0003, 0x0003, 0x0004, 0x0004]
    result = rig.command(memory, 0x8300, *good, 0x0100, 0x0005, END)   # PDO number 0
    equal(result[0], 0x83FF)
    equal(result[1:11], [0] * 8 + [0xFFFF, 0xFFFF], "Source5, Destination5 skipped")
    equal(rig.command(memory, 0x8300, 0x0901, 0x0001, END, within=8)[0:3], [0x83FF, 0x0900, 0xFFFF], "no response from node 9")
    rig.bus.answers = {"602 40 04 18 01 00 00 00 00": "582 43 04 18 01 00 00 00 80"}
    equal(rig.command(memory, 0x8300, 0x0205, 0x0001, END)[0:3], [0x83FF, 0x0005, 0xFFFF], "COB-ID is 80000000 hex")
    rig.bus.answers = {"602 40 08 18 01 00 00 00 00": "582 80 08 18 01 00 00 02 06"}
    equal(rig.command(memory, 0x8300, 0x0209, 0x0001, END)[0:3], [0x83FF, 0x0209, 0xFFFF], "PDO number not supported")
    equal(rig.command(memory, 0x8300, 0x8001, 0x0001, END)[0:3], [0x83FF, 0xFFFF, 0xFFFF], "node ID higher than 127")
    result = rig.command(memory, 0x8300, 0x0001, 0x0001, 0, 0, END)    # 7.4.6: prepare in the second pair
    equal([result[0], result[3]], [0x83FF, 0xFFFF])


# --- 8 Node guarding


def manager():
    """The network manager, node 1, by the object dictionary (7.2, 8.1); its own start-up is over."""
    rig, memory = rack(node=1, objects='objects = { "1F80:00" = 0x01 }')
    rig.plc.wait("U0\\G25 >= 512", 5)
    rig.bus.discard()
    return rig, memory


def answering(rig, *frames):
    """A guarded slave: one answer each 100 ms, behind each request; the first request came just now."""
    rig.run(0.02)
    for frame in frames:
        rig.bus.send(frame)
        rig.run(0.1)


@play("FX2N-32CAN", "8.1", "8.2.1", "8.2.2", "8.2.3", "8.2.4", "8.2.5", "8.2.7", "8.2.8")
def fx2n_guards_a_slave_and_reads_its_status():
    """8.1, 8.2: slave, services, guard time, retries, FFFF hex, command 8400 hex; status by 8500, latch reset by 8600 hex."""
    rig, memory = manager()
    bus = rig.bus
    bus.discard()
    bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 60 0C 10 00 00 00 00 00",
                   "605 2F 0D 10 00 03 00 00 00": "585 60 0D 10 00 00 00 00 00"}
    result = rig.command(memory, 0x8400, 5, 1, 100, 3, END)
    equal(result[0], 0x8401, "slaves have been assigned")
    equal(result[1:5], [0, 0, 0, 0], "no error")
    begin = bus.expect("605 2B 0C 10 00 64 00 00 00", "605 2F 0D 10 00 03 00 00 00").time
    answering(rig, "705 7F")
    bus.expect("000 01 05")                                 # bit 0: the node will be set to operational
    answering(rig, *["705 85", "705 05"] * 5)
    equal(sdo(memory, rig, 0x1F81, 5), 0x00640301, "index 1F81 hex")
    equal(rig.command(memory, 0x8500, 5)[0:3], [0x8501, 5, 0b1], "guarding is activated")   # 8.2.7: a single node
    rig.run(0.15)
    equal(rig.command(memory, 0x8500, 5)[2] & 0b1101, 0b0101, "one response is missed")
    equal(bit(memory[29], 10), 0)
    rig.run(0.5)
    equal(rig.command(memory, 0x8500, 0x1205)[0:3], [0x8501, 5, rig.command(memory, 0x8500, 5)[2]], "the high byte is ignored")
    equal(bit(rig.command(memory, 0x8500, 5)[2], 3), 1, "no response and lifetime elapsed")
    equal(bit(memory[29], 10), 1, "CANopen guarding error")
    equal(rig.command(memory, 0x8500, 128)[0:3], [0x8502, 5, rig.command(memory, 0x8500, 5)[2]], "next node with error")
    result = rig.command(memory, 0x8500, 0)
    equal(result[0], 0x8503)
    assert bit(result[3], 3) and result[3] >> 8 == 0, "node 5: low byte of BFM1003"
    equal(rig.command(memory, 0x8600, 5)[0], 0x8601, "status latch was reset")
    equal(rig.command(memory, 0x8500, 5)[2] & 0b1111000, 0, "flags are set to 0")
    times = [frame.time for frame in rig.remote_frames() if frame.identifier == "705"]
    gaps = [b - a for a, b in zip(times, times[1:])][:10]
    assert times[0] - begin < 0.15 and all(abs(gap - 0.1) < 0.002 for gap in gaps), f"every 100 x 1ms: {times}"


@play("FX2N-32CAN", "8.1", "7.2")
def fx2n_guards_a_slave_that_is_assigned_at_once():
    """8.1: slaves have been assigned (8401 hex) as soon as the manager takes commands; 8.2.3: it sends guard requests."""
    rig, memory = rack(node=1, objects='objects = { "1F80:00" = 0x01 }')
    assert not bit(memory[25], 9), "the manager's own start-up is not over yet"
    rig.bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 60 0C 10 00 00 00 00 00",
                         "605 2F 0D 10 00 03 00 00 00": "585 60 0D 10 00 00 00 00 00"}
    equal(rig.command(memory, 0x8400, 5, 1, 100, 3, END)[0], 0x8401)
    rig.run(2)
    equal(bit(rig.command(memory, 0x8500, 5)[2], 0), 1, "guarding is activated")


@play("FX2N-32CAN", "8.2.3", "8.2.4")
def fx2n_number_of_guarding_retries():
    """8.2.3, 8.2.4: the request is repeated until the number of retries has been submitted, then it is an error."""
    rig, memory = manager()
    rig.bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 60 0C 10 00 00 00 00 00",
                         "605 2F 0D 10 00 03 00 00 00": "585 60 0D 10 00 00 00 00 00"}
    equal(rig.command(memory, 0x8400, 5, 1, 100, 3, END)[0], 0x8401)
    answering(rig, "705 05", "705 85")
    rig.bus.discard()
    rig.until(lambda: bit(memory[29], 10), "a guarding error", 2)
    error = rig.time
    unanswered = [frame.time for frame in rig.remote_frames() if frame.identifier == "705"][2:]
    assert len([time for time in unanswered if time < error]) == 4, f"error at {error}: {unanswered}"


@play("FX2N-32CAN", "8.2.7")
def fx2n_guarding_flags_toggle_and_state():
    """8.2.7, *2: bit 4 toggle error, bit 5 state changed."""
    for answers, flag in ((["705 05", "705 05"], 4), (["705 05", "705 FF"], 5)):
        rig, memory = manager()
        rig.bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 60 0C 10 00 00 00 00 00",
                             "605 2F 0D 10 00 03 00 00 00": "585 60 0D 10 00 00 00 00 00"}
        equal(rig.command(memory, 0x8400, 5, 1, 100, 3, END)[0], 0x8401)
        answering(rig, *answers)
        equal(bit(rig.command(memory, 0x8500, 5)[2], flag), 1, f"bit {flag}")
        rig.close()


@play("FX2N-32CAN", "8.2.7", "8.2.8")
def fx2n_next_node_with_guarding_error():
    """8.2.7: each execution with 128 to 255 jumps to the next node; 8.2.8: 0 resets all."""
    rig, memory = manager()
    rig.bus.answers = {f"{0x600 + node:03X} {write}": f"{0x580 + node:03X} 60 {index} 10 00 00 00 00 00"
                         for node in (5, 9) for write, index in (("2B 0C 10 00 64 00 00 00", "0C"), ("2F 0D 10 00 03 00 00 00", "0D"))}
    equal(rig.command(memory, 0x8400, 5, 1, 100, 3, 9, 1, 100, 3, END)[0], 0x8401)
    rig.bus.answers = {}
    rig.run(1)
    equal(rig.command(memory, 0x8500, 128)[0:2], [0x8502, 5])
    equal(rig.command(memory, 0x8500, 255)[0:2], [0x8502, 9])
    equal(rig.command(memory, 0x8500, 200)[0:2], [0x8502, 5])
    # the slaves guard no more, so that no new error comes
    for node in (5, 9):
        equal(rig.command(memory, 2, 0, 0x1F81, node, 4, 0, 0)[0], 3)
    equal(rig.command(memory, 0x8600, 0)[0], 0x8601)
    equal(rig.command(memory, 0x8500, 128)[0:3], [0x8502, 0, 0], "no node is in guarding error state")


@play("FX2N-32CAN", "8.2.6")
def fx2n_guarding_parameter_errors():
    """8.2.6: the node number outside 1 to 127, a retry factor above 255, a slave without index 100C/100D."""
    rig, memory = manager()
    result = rig.command(memory, 0x8400, 200, 1, 100, 3, END)
    equal(result[0:2], [0x84FF, 200], "the value which caused the problem")
    result = rig.command(memory, 0x8400, 5, 1, 100, 300, END)
    equal(result[0], 0x84FF)
    assert result[4], "an error value in the retry factor's BFM"
    rig.bus.answers = {"605 2B 0C 10 00 64 00 00 00": "585 80 0C 10 00 00 00 02 06",
                         "605 2F 0D 10 00 03 00 00 00": "585 80 0D 10 00 00 00 02 06"}
    equal(rig.command(memory, 0x8400, 5, 1, 100, 3, END)[1:5], [5, 1, 100, 3], "just copied")


@play("FX2N-32CAN", "8.2.5")
def fx2n_sixteen_slaves_need_no_end_of_table():
    """8.2.5: with a setting in BFM1061 to 1064 FFFF hex is not required."""
    rig, memory = manager()
    parameters, answers = [], {}
    for node in range(10, 26):
        parameters += [node, 1, 100, 3]
        answers[f"{0x600 + node:03X} 2B 0C 10 00 64 00 00 00"] = f"{0x580 + node:03X} 60 0C 10 00 00 00 00 00"
        answers[f"{0x600 + node:03X} 2F 0D 10 00 03 00 00 00"] = f"{0x580 + node:03X} 60 0D 10 00 00 00 00 00"
    rig.bus.answers = answers
    result = rig.command(memory, 0x8400, *parameters, 0, 0, within=10)
    equal(result[0], 0x8401)
    equal(result[1:65], [0] * 64)
    equal([sdo(memory, rig, 0x1F81, node) for node in (10, 25)], [0x00640301] * 2)


@play("FX2N-32CAN", "8.2.7", "8.2.6")
def fx2n_local_guarding_fails():
    """8.2.7, *2 bit 6: no request from the network manager in the expected time."""
    rig, memory = rack()
    for index, length, value in ((0x100C, 2, 100), (0x100D, 1, 3)):
        equal(rig.command(memory, 2, 0, index, 0, length, value)[0], 3)
    rig.bus.discard()
    rig.bus.send_remote("705", 1)
    rig.bus.expect("705 7F")
    rig.bus.send_remote("705", 1)
    rig.bus.expect("705 FF")
    equal(bit(memory[29], 10), 0)
    rig.run(0.35)
    equal(bit(memory[29], 10), 1, "CANopen guarding error")
    equal(bit(rig.command(memory, 0x8500, 5)[2], 6), 1, "guarding failed for the local node")


# --- 9 Emergency messages


@play("FX2N-32CAN", "9.1")
def fx2n_emergency_buffers_are_read_and_cleared():
    """9.1: stack of the first 11, ring of the latest 11, next unread one, clear with 10 and 11 hex."""
    rig, memory = rack()
    for number in range(1, 26):
        rig.bus.send(f"083 {number:02X} 81 01 02 03 04 05 06")
        rig.run(0.005)
    equal(bit(memory[29], 13), 1, "CANopen emergency occurred")
    record = lambda number: [3, number, 0x8100 | number, 0x0201, 0x0403, 0x0605]
    result = rig.command(memory, 0x8700, 0)
    equal(result[0], 0x8701)
    equal(result[1:67], sum((record(number) for number in range(1, 12)), []), "stack buffer")
    result = rig.command(memory, 0x8700, 1)
    equal(result[0], 0x8702)
    equal(result[1:67], sum((record(number) for number in range(15, 26)), []), "ring buffer, the oldest first")
    result = rig.command(memory, 0x8700, 0x10)            # read the stack buffer and clear both
    equal(result[0:7], [0x8701, *record(1)])
    equal(rig.command(memory, 0x8700, 1)[0:7], [0x8702] + [0] * 6, "both are cleared")
    rig.bus.send("084 10 82 11 00 00 00 00 00")
    rig.run(0.005)
    equal(rig.command(memory, 0x8700, 0)[0:13], [0x8701, 4, 1, 0x8210, 0x0011, 0, 0] + [0] * 6, "first cell of the stack")
    equal(rig.command(memory, 0x8700, 0x11)[0], 0x8702)
    equal(rig.command(memory, 0x8700, 0)[0:7], [0x8701] + [0] * 6, "cleared by 11 hex, too")


@play("FX2N-32CAN", "9.1")
def fx2n_reads_the_next_unread_emergency():
    """9.1, *3: each execution shows the next unread message, then 0 until a new one is received."""
    rig, memory = rack()
    for number in (1, 2):
        rig.bus.send(f"083 {number:02X} 10 01 00 00 00 00 00")
        rig.run(0.005)
    equal(rig.command(memory, 0x8700, 2)[0:5], [0x8703, 3, 1, 0x1001, 1])
    equal(rig.command(memory, 0x8700, 2)[0:5], [0x8703, 3, 2, 0x1002, 1])
    equal(rig.command(memory, 0x8700, 2)[0:7], [0x8703] + [0] * 6)
    rig.bus.send("083 03 10 01 00 00 00 00 00")
    rig.run(0.005)
    equal(rig.command(memory, 0x8700, 2)[0:5], [0x8703, 3, 3, 0x1003, 1])


@play("FX2N-32CAN", "9.1")
def fx2n_emergency_counter_stays_at_255():
    """9.1, *7: the counter stays at 255 as long as the buffer is not cleared."""
    rig, memory = rack()
    for number in range(300):
        rig.bus.send("083 00 10 01 00 00 00 00 00")
        if number % 20 == 0:
            rig.run(0.05)
    rig.run(0.2)
    equal(rig.command(memory, 0x8700, 1)[62], 255, "message counter of the newest")


@play("FX2N-32CAN", "9.2")
def fx2n_sends_an_emergency_message():
    """9.2: data bytes from the low byte of BFM1001 on, command 000A hex."""
    rig, memory = rack()
    rig.bus.discard()
    result = rig.command(memory, 0x000A, 0x1000, 0x0201, 0x0403, 0x0605)
    assert result[0] != 0x000F, "a queue was available"
    rig.bus.expect("085 00 10 01 02 03 04 05 06", others=False)
