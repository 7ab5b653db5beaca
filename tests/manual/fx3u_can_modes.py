"""Plays of the FX3U-CAN User's Manual (revision E): the 417 mode (5.10, 8) and the Layer 2 modes (9)."""
from fx3u_can import END, FX3U, OWN, Block, bus_text, rack, rack_text
from rig import Rig, bit, equal, play


def lift(objects="", **options):
    """A block in 417 mode, node 1, Operational; `objects` in TOML."""
    block = rack(f"objects = {{ {objects} }}", node=1, buffer="G21 = 417, G26 = 0", **options).ready()
    block.bus.expect("701 00", within=8)
    block.bus.send("000 01 01")
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 1)
    block.bus.discard()
    return block


def layer2(mode=11, **words):
    """A block in a Layer 2 mode, offline; what was saved are these words."""
    saved = ", ".join(f"{name} = {value}" for name, value in {"G21": mode, "G26": 0, **words}.items())
    return rack(buffer=saved).ready()


def online(block):
    block.b[25] = 0x0010
    block.rig.until(lambda: bit(block.b[25], 0), "online", 2)
    block.bus.discard()


# --- 12.2, 8, 5.10


@play(FX3U, "12.2", "6.5", "8.2")
def fx3u_communication_settings_procedure_417():
    """12.2, flow chart (its figure is lost): #21 = 417, save, restart; lift number; TPDOs; store; restart; data exchange."""
    block = rack(buffer="").ready()
    block.b[21] = 417
    block.b[24] = 250
    block.b[26] = 0
    block.b[27] = 1
    equal(block.b[29], 0)
    block.save()
    block.bus.discard()
    block.restart()
    block.bus.expect("701 00", within=0.2)
    times = [block.bus.expect("701 7F", within=1.5).time for _ in range(3)]
    assert all(abs(b - a - 1) < 0.001 for a, b in zip(times, times[1:])), "default heartbeat of 1000 ms"
    equal([block.b[21], block.sdo_read(OWN, 0x1000)], [417, 0x1A1])
    block.b[13000] = 1                                      # lift number
    for index, value in ((0x1908, 0x40000200), (0x1902, 0x40000182), (0x1904, 0x40000180)):
        block.sdo_write(OWN, index, 1, value, 4)
    block.sdo_write(OWN, 0x1F80, 0, 3, 4)
    block.store_objects()
    block.restart()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    block.bus.discard()
    block.b[13050] = 0x1FFF                                 # cyclic: data, exchange, data
    block.exchange()
    block.bus.expect("200 FF 1F FF FF FF FF FF FF")


@play(FX3U, "8.2", "5.10.1", "10.6")
def fx3u_lift_number():
    """8.2: #13000 and #3000, 6001H; data save to Flash ROM: 1010H."""
    block = lift()
    equal([block.b[3000], block.b[13000], block.sdo_read(OWN, 0x6001)], [1, 1, 1])
    block.b[13000] = 3
    equal([block.b[3000], block.b[13000], block.sdo_read(OWN, 0x6001)], [3, 3, 3])
    block.restart()
    equal(block.b[13000], 1, "not stored")
    block.b[13000] = 3
    equal(block.command(0x6000, OWN, END)[0], 0x6001)
    block.restart()
    equal(block.b[13000], 3)


@play(FX3U, "8.3.1", "5.10.2", "6.4")
def fx3u_virtual_input_mapping():
    """8.3.1: messages of panels; bit 9 of #20 shows the next one; #12004 counts."""
    block = lift()
    block.bus.send("485 02 01 01 03 01 01", "486 05 07 01 00 01 01", "485 02 01 01 03 01 00")
    block.run(0.01)
    equal(block.b[12001:12004], [0, 0, 0])
    equal(block.b[12004], 3)
    for words, waiting in (([0x0102, 0x0301, 0x0101], 2), ([0x0705, 0x0001, 0x0101], 1), ([0x0102, 0x0301, 0x0001], 0), ([0, 0, 0], 0)):
        block.b[20] = 0x0200
        block.run(0.01)
        equal([block.b[12001:12004], block.b[12004]], [words, waiting])
        equal(block.b[3001:3004], words, "the same at #3001")
    block.bus.send("485 02 01 02 03 01 01")                 # lift 2 is not assigned
    block.run(0.01)
    equal(block.b[12004], 0)


@play(FX3U, "8.3.2", "5.10.3")
def fx3u_virtual_output_mapping():
    """8.3.2: #13001 to #13003; sent when they have changed; values of 5.10.3."""
    block = lift()
    for words, data in (((0x0102, 0x0301, 0x8101), "02 01 01 03 01 81"), ((0x0540, 0xFF01, 0x010F), "40 05 01 FF 0F 01"),
                        ((0x0141, 0x0301, 0x0101), "41 01 01 03 01 01"), ((0x2242, 0x0001, 0x0101), "42 22 01 00 01 01"),
                        ((0x0343, 0x0001, 0x5701), "43 03 01 00 01 57"), ((0x024A, 0xFF01, 0x010F), "4A 02 01 FF 0F 01")):
        block.b[13001:13004] = list(words)
        block.exchange()
        block.bus.expect(f"400 {data}", others=False)
        block.exchange()
        block.bus.expect_none(0.02)
    block.b[3001:3004] = [0x0100, 0xFF01, 0x010F]           # the older numbers
    block.exchange()
    block.bus.expect("400 00 01 01 FF 0F 01")


@play(FX3U, "8.4.1", "5.10.4")
def fx3u_door_control_word():
    """8.4.1: #13050: command open, then with limited force; door 4 of lift 2."""
    block = lift('"1908:01" = 0x40000200, "1918:01" = 0x40000210, "6001:00" = 3')
    block.b[13050] = 0x1FFF
    block.exchange()
    block.bus.expect("200 FF 1F FF FF FF FF FF FF")
    block.b[13057] = 0x4FFF
    block.exchange()
    block.bus.expect("210 FF FF FF FF FF FF FF 4F")
    equal([block.b[13050], block.b[3050]], [0x1FFF, 0xFFFF], "FROM #3050 is the status")


@play(FX3U, "8.4.2", "8.5", "8.6", "5.10.5", "5.10.6")
def fx3u_door_status_position_and_light_barrier():
    """8.4.2, 8.5, 8.6: status word, position, light barrier of the doors."""
    block = lift()
    equal([block.b[12050], block.b[12082], block.b[12114]], [0xFFFF, 0xFFFF, 0x00FF])
    for door in range(3):
        block.bus.send(f"20{1 + door} 55 45 20 0{3 + door}", f"20{5 + door} 7{door}")
        block.run(0.01)
        block.exchange()
        equal([block.b[12050 + door], block.b[12082 + door], block.b[12114 + door]], [0x4555, 0x0320 + 0x100 * door, 0x70 + door])
    block.bus.send("211 FF 1F 00 00")                       # lift 2
    block.run(0.01)
    block.exchange()
    equal(block.b[12054], 0xFFFF)


@play(FX3U, "8.7", "8.12")
def fx3u_position_value_and_control_effort():
    """8.7: four position units; 8.12."""
    block = lift()
    for unit in range(4):
        block.bus.send(f"{0x18C + unit:03X} {unit + 1:02X} 27 00 00")
    block.bus.send("181 9C FF FF FF")
    block.run(0.02)
    block.exchange()
    equal(block.b[12300:12308], [0x2701, 0, 0x2702, 0, 0x2703, 0, 0x2704, 0])
    equal(block.b[12444:12446], [0xFF9C, 0xFFFF])


@play(FX3U, "8.8", "8.9", "8.13.1", "5.6.6")
def fx3u_values_without_a_pdo_come_by_mpdo():
    """8.8, 8.9, 8.13.1; 5.6.6: a destination MPDO to this node, to all, to another one."""
    block = lift()
    block.bus.send("507 81 90 63 01 64 00 00 00")
    block.run(0.01)
    block.exchange()
    equal(block.b[12364], 0x0064, "speed value car")
    block.bus.send("507 80 91 63 01 07 00 00 00")
    block.run(0.01)
    block.exchange()
    equal(block.b[12396], 7, "acceleration value car, group address")
    block.bus.send("507 82 90 63 01 22 00 00 00")
    block.run(0.01)
    block.exchange()
    equal(block.b[12364], 0x0064, "another node's")
    block.bus.discard()
    block.bus.send("507 81 34 12 00 00 00 00 00")
    block.run(0.02)
    assert [frame for frame in block.bus.received("081") if frame.startswith("081 30 82")], block.bus.received()


@play(FX3U, "8.10.1", "8.10.2", "8.11.1", "8.11.2", "8.15.1", "8.15.2", "5.10.7", "5.10.8", "5.10.9", "5.10.10")
def fx3u_drive_in_velocity_mode():
    """8.10, 8.11, 8.15: control word, mode, target velocity; status word, mode display, velocity actual value."""
    block = lift('"1902:01" = 0x40000182')
    block.b[13436] = 3
    block.b[13492:13494] = [0x03E8, 0]
    for word in (0x0006, 0x0007, 0x000F):                   # shutdown, switch on, enable operation
        block.b[13428] = word
        block.exchange()
        block.bus.expect(f"182 {word:02X} 00 03 00 E8 03 00 00")
    block.bus.send("183 37 06 03 00 0C FE FF FF")
    block.run(0.01)
    block.exchange()
    equal([block.b[12428], block.b[12436], block.b[12492:12494]], [0x0637, 3, [0xFE0C, 0xFFFF]])
    equal(block.b[12428] & 0x006F, 0x0027, "operation enabled")
    block.b[13436] = 0x0103
    equal(block.b[13436], 3, "the high byte is not used")


@play(FX3U, "8.13.2", "8.14", "5.10.11")
def fx3u_target_position_and_profile_velocity():
    """8.13.2, 8.14: 32 bits each, in one PDO."""
    block = lift('"1904:01" = 0x40000180')
    block.b[13460:13462] = [0x2345, 0x0001]
    block.b[13476:13478] = [0x05DC, 0]
    block.exchange()
    block.bus.expect("180 45 23 01 00 DC 05 00 00")


@play(FX3U, "8.16", "8.17", "5.10.12", "5.10.13")
def fx3u_load_value_and_signalling():
    """8.16: absolute load and its unit; 8.17: full load."""
    block = lift()
    block.bus.send("188 04 2C 01")
    block.run(0.01)
    block.exchange()
    equal([block.b[12524], block.b[12508], block.b[12509], block.b[12525]], [4, 0x012C, 2, 0])


@play(FX3U, "8", "10.9.1 1", "6.3")
def fx3u_process_data_and_commands_of_the_417_mode():
    """6.3: #0 to #3 and #10000 to #10003 alone; 10.9.1: mapping commands are unknown."""
    block = lift('"1800:01" = 0x400004D0')
    block.b[11000:11004] = [1, 2, 3, 4]
    block.exchange()
    block.bus.expect("4D0 01 00 02 00 03 00 04 00")
    for command in (0x8900, 0x8200, 0x8300, 0x000C):
        equal(block.command(command)[0:2], [0x000F, 0x0064], f"{command:04X}H")
    equal(block.command(0x000A, 0xFF01, 0x0081, 0, 0)[0], 0x000B)
    block.bus.expect("081 01 FF 81 00 00 00 00 00")


@play(FX3U, "8.3.1", "8.3.2", "8.4", "8.10", "5.10")
def fx3u_a_hall_call_is_served():
    """8.3 to 8.10 together, with simulated devices of a lift on the bus: a program that reads calls, moves the drive and opens a door.
    What the program does of its own is not the manual's; each word it uses is."""
    settings = '''buffer = { G21 = 417, G26 = 0 }
[plc.module.objects]
"1F80:00" = 0x03
"1902:01" = 0x40000182
"1908:01" = 0x40000200
'''
    lifts = '''
[[lift]]
bus = "line"
number = 1
floors = 3
first_node = 2
'''
    block = Block(Rig(bus_text() + rack_text(settings, node=1, more=lifts))).ready()
    block.rig.until(lambda: bit(block.b[25], 9), "Operational", 5)
    block.run(1)
    block.exchange()
    position = lambda: block.b.signed_double[12300]
    begin = position()
    block.b[13436] = 3                                      # velocity mode
    for word in (0x0006, 0x0007, 0x000F):
        block.b[13428] = word
        block.exchange()
        block.run(0.1)
    block.exchange()
    equal(block.b[12428] & 0x006F, 0x0027, "operation enabled")
    block.b[13492:13494] = [300, 0]                         # upwards, 300 mm/s
    block.exchange()
    block.run(2)
    block.exchange()
    assert position() > begin + 100, f"the car has moved from {begin} to {position()}"
    assert block.b.signed_double[12492] > 100, "velocity actual value"
    block.b[13492:13494] = [0, 0]
    block.exchange()
    block.run(2)
    block.exchange()
    stopped = position()
    block.run(1)
    block.exchange()
    equal(position(), stopped)


# --- 9, 12.3 Layer 2 modes


@play(FX3U, "12.3", "9.1", "9.3.1", "6.6")
def fx3u_communication_settings_procedure_layer_2():
    """12.3, flow chart (its figure is lost): #21, save, restart; messages, save; online by #25 bit 4; exchange. 11 and 29 bits."""
    for mode, low, high, frame in ((11, 0x0123, 0, "123 11 22 33"), (29, 0xF100, 0x18FE, "18FEF100 11 22 33")):
        block = rack(buffer="").ready()
        block.b[21] = mode
        block.b[24] = 250
        block.b[26] = 0
        block.save()
        block.bus.discard()
        block.restart()
        equal([block.b[21], bit(block.b[25], 0)], [mode, 0])
        block.bus.expect_none(0.5, "77F")
        block.b[100:103] = [low, high, 3]
        block.b[1100:1104] = [0xFFFF, 0x5FFF, 0, 0]
        block.b[1900:1904] = [low, high, 1, 0x00FF]
        block.save()
        block.rig.power_cycle()
        block.ready()
        equal([block.b[100:103], block.b[1100:1104], block.b[1900:1904]], [[low, high, 3], [0xFFFF, 0x5FFF, 0, 0], [low, high, 1, 0x00FF]])
        online(block)
        block.b[103:105] = [0x2211, 0x0033]
        block.exchange()
        block.bus.expect(frame)
        block.rig.close()


@play(FX3U, "9.3.1", "9.1", "9.5")
def fx3u_layer2_transmission_types():
    """9.3.1, parameter C: each exchange, on change, cyclic, cyclic on change, by trigger (9.5)."""
    words = {}
    for slot, kind in enumerate((0, 1, 2, 3, 4)):
        words.update({f"G{1100 + 4 * slot}": 0xFFFF, f"G{1101 + 4 * slot}": 0x5FFF, f"G{1102 + 4 * slot}": kind, f"G{1103 + 4 * slot}": 10,
                      f"G{100 + 7 * slot}": 0x101 + slot, f"G{101 + 7 * slot}": 0, f"G{102 + 7 * slot}": 1})
    block = layer2(**words)
    online(block)
    block.run(0.3)
    block.bus.discard()
    for slot in range(5):
        block.b[103 + 7 * slot] = 0x11
    block.exchange()
    block.exchange()
    block.run(0.5)
    counts = [block.bus.received(f"10{i}").count(f"10{i} 11") for i in range(1, 6)]
    equal([counts[0], counts[1], counts[3], counts[4]], [2, 1, 1, 0])
    cycles = [frame.time for frame in block.bus.frames if str(frame) == "103 11"]
    gaps = [b - a for a, b in zip(cycles[2:], cycles[3:])]  # behind those of the two exchanges
    assert len(gaps) >= 3 and all(abs(gap - 0.1) < 0.0002 for gap in gaps), gaps
    block.bus.discard()
    block.b[1280] = 0b10000
    block.bus.expect("105 11", within=0.1)
    block.rig.until(lambda: block.b[1280] == 0, "the flag is OFF", 0.1)


@play(FX3U, "9.5")
def fx3u_layer2_trigger_flags():
    """9.5: flags of messages 1, 17 and 42."""
    words = {}
    for slot in (0, 16, 41):
        words.update({f"G{1100 + 4 * slot}": 0xFFFF, f"G{1101 + 4 * slot}": 0x5FFF, f"G{1102 + 4 * slot}": 4,
                      f"G{100 + 7 * slot}": 0x101 + slot, f"G{101 + 7 * slot}": 0, f"G{102 + 7 * slot}": 1})
    block = layer2(**words)
    online(block)
    block.b[1280] = 1
    block.bus.expect("101 00")
    block.b[1281] = 1
    block.bus.expect("111 00")
    block.b[1282] = 0x0200
    block.bus.expect("12A 00")
    block.run(0.01)
    equal(block.b[1280:1283], [0, 0, 0])


@play(FX3U, "9.4", "9.3.1")
def fx3u_layer2_rtr_flags():
    """9.3.1, parameter B: automatic, manual and no answer; 9.4: RTR flags; strict DLC (9.1)."""
    words = {}
    for slot, kind in enumerate((0x7FFF, 0x6FFF, 0x5FFF, 0x7FFF)):
        words.update({f"G{1100 + 4 * slot}": 0xFFFF, f"G{1101 + 4 * slot}": kind, f"G{1102 + 4 * slot}": 0,
                      f"G{100 + 7 * slot}": 0x121 + slot, f"G{101 + 7 * slot}": 0, f"G{102 + 7 * slot}": 0x1002 if slot == 3 else 2})
    block = layer2(**words)
    online(block)
    for slot in range(4):
        block.b[103 + 7 * slot] = 0x2211 + slot
    block.exchange()
    block.run(0.05)
    block.bus.discard()
    block.bus.send_remote("121", 2)
    block.bus.expect("121 11 22")
    equal(block.b[1270], 0)
    block.bus.send_remote("122", 2)
    block.bus.expect_none(0.05)
    equal(block.b[1270], 0b10)
    block.b[110] = 0x4433
    block.exchange()
    block.bus.expect("122 33 44")
    equal(block.b[1270], 0)
    block.run(0.05)
    block.bus.discard()
    block.bus.send_remote("123", 2)
    block.bus.expect_none(0.05)
    block.bus.send_remote("124", 3)
    block.bus.expect_none(0.05)
    block.bus.send_remote("124", 2)
    block.bus.expect("124 14 22")


@play(FX3U, "9.3.1")
def fx3u_layer2_takes_28_messages_with_remote_answers():
    """9.3.1, note: more than 28 get 5FFF hex."""
    words = {}
    for slot in range(30):
        words.update({f"G{1100 + 4 * slot}": 0xFFFF, f"G{1101 + 4 * slot}": 0x7FFF, f"G{100 + 7 * slot}": 0x101 + slot,
                      f"G{101 + 7 * slot}": 0, f"G{102 + 7 * slot}": 1})
    block = layer2(**words)
    online(block)
    equal([block.b[1101 + 4 * slot] for slot in (27, 28, 29)], [0x7FFF, 0x5FFF, 0x5FFF])


@play(FX3U, "9.1", "9.7")
def fx3u_layer2_remote_frame():
    """9.1, RTR/new/DLC bit 15: the message is a remote frame; 9.7: by command 000C, too."""
    block = layer2(G1100=0xFFFF, G1101=0x5FFF, G1102=0, G1103=0, G100=0x0123, G101=0, G102=0x8003)
    online(block)
    block.exchange()
    block.run(0.05)
    equal(block.command(0x000C, 0x0321, 0, 1, 0)[0], 0x000D)
    block.run(0.01)
    frames = [str(frame) for frame in block.rig.remote_frames()]
    assert "123 R3" in frames and frames[-1] in ("321 R", "321 R0"), frames


@play(FX3U, "9.3.2 example 1", "9.1")
def fx3u_layer2_receive_example_1():
    """9.3.2, example 1: message 1 receives 181 hex; the high byte of #102 at the points 1 to 4."""
    block = layer2(G1100=0x0181, G1101=0, G1102=0, G1103=0)
    online(block)

    def point(*frames):
        block.b[102] = block.b[102] & 0x00FF
        if frames:
            block.bus.send(*frames)
        block.run(0.01)
        block.exchange()
        return block.b[100:104]
    point()
    equal(point()[2] >> 8, 0, "2")
    equal(point("181 0A"), [0x0181, 0, 0x0301, 0x000A], "3")
    equal(point("181 0B", "181 0C", "181 0D"), [0x0181, 0, 0x0701, 0x000D], "4")
    equal(point("181 0D")[2], 0x0201, "the same data")
    equal(point("181 AA BB CC")[2:4] + [block.b[104]], [0x0303, 0xBBAA, 0x00CC])


@play(FX3U, "9.2", "14.2")
def fx3u_layer2_receive_buffer_overflow():
    """9.2: error code H2000 of a message; 14.2, bit 15: latched."""
    block = rack(buffer="G21 = 11, G26 = 0, G24 = 1000, G1100 = 0x0181, G1101 = 0, G1102 = 0, G1103 = 0", bit_rate=1_000_000).ready()
    online(block)
    block.bus.send(*["181"] * 100)                          # as fast as the bus is
    block.run(0.1)
    equal([block.b[401], bit(block.b[29], 15), bit(block.b[29], 0)], [0x2000, 1, 1])
    block.exchange()
    block.b[401] = 0
    block.b[29] = 0
    equal([block.b[401], bit(block.b[29], 15)], [0, 0])


@play(FX3U, "9.3.2 example 2")
def fx3u_layer2_receive_example_2():
    """9.3.2, example 2: message 2 receives 180, 182, 184 and 186 hex."""
    block = layer2(G1104=0x0180, G1105=0, G1106=0x0006, G1107=0)
    online(block)
    block.bus.send("181 01", "188 02")
    block.run(0.01)
    block.exchange()
    equal(block.b[109] >> 8, 0)
    block.bus.send("182 02", "186 06", "180 0D")
    block.run(0.01)
    block.exchange()
    equal(block.b[107:111], [0x0180, 0, 0x0701, 0x000D])


@play(FX3U, "9.6", "11 Layer 2")
def fx3u_layer2_run_stop_messages():
    """9.6: PLC RUN>STOP messages, in order; 11, 4: then offline, and it stays so."""
    block = layer2(G1900=0x0700, G1901=0, G1902=2, G1903=0x0201, G1907=0x0100, G1908=0, G1909=1, G1910=0x00FF)
    online(block)
    block.plc.remote_stop()
    block.bus.expect("700 01 02", "100 FF", others=False)
    block.rig.until(lambda: not bit(block.b[25], 0), "offline", 1)
    block.plc.remote_run()
    block.run(0.2)
    equal(bit(block.b[25], 0), 0)
    online(block)


@play(FX3U, "9.6", "6.9", "14.2")
def fx3u_layer2_watchdog():
    """14.2, note: the FROM/TO watchdog sends the RUN>STOP messages in a Layer 2 mode."""
    block = rack(buffer="G21 = 11, G26 = 20, G1900 = 0x0700, G1901 = 0, G1902 = 1, G1903 = 0x0055").ready()
    online(block)
    block.b[103] = 1
    block.run(0.25)
    equal(bit(block.b[29], 7), 1)
    block.bus.expect("700 55")
    block.b[26] = 20
    equal(bit(block.b[29], 7), 0)


@play(FX3U, "9.7", "10.9.1 1")
def fx3u_layer2_message_by_the_command_interface():
    """9.7: command 000C; 000D, F00C; CANopen commands are unknown."""
    block = layer2()
    online(block)
    equal(block.command(0x000C, 0x0321, 0, 0, 4, 0x0201, 0x0403)[0], 0x000D)
    block.bus.expect("321 01 02 03 04")
    result = block.command(0x000C, 0x0321, 0, 0, 9)
    equal(result[0], 0xF00C)
    assert result[4]
    equal(block.command(4, OWN, 0x1000, 0)[0:2], [0x000F, 0x0064])


@play(FX3U, "14.2", "6.8", "6.18", "9.3")
def fx3u_layer2_configuration_while_online():
    """14.2, bit 5: write to configuration BFM offline alone; #40; bit 6 cannot be reset online."""
    block = layer2()
    online(block)
    before = block.b[1100]
    block.b[1100] = 0x0181
    equal([block.b[1100], bit(block.b[29], 5), block.b[40]], [before, 1, 1100])
    block.b[29] = 0
    equal([bit(block.b[29], 5), block.b[40]], [0, 0])
    block.b[25] = 0
    block.rig.until(lambda: not bit(block.b[25], 0), "offline", 1)
    block.b[1100] = 0x0181
    equal([block.b[1100], bit(block.b[29], 5)], [0x0181, 0])


@play(FX3U, "9.1")
def fx3u_layer2_dlc_changes_offline_alone():
    """9.1, note: DLC and RTR are written in the configuration mode."""
    block = layer2(G1100=0xFFFF, G1101=0x5FFF, G1102=0, G1103=0, G100=0x0123, G101=0, G102=2)
    online(block)
    block.b[102] = 3
    block.b[103] = 0x2211
    block.exchange()
    block.run(0.05)
    equal(block.bus.received("123")[-1], "123 11 22")


@play(FX3U, "9.1", "14.2", "9.3")
def fx3u_layer2_bits_that_do_not_fit():
    """9.1, *3: bits 12 and 15 cannot be ON at the same time; bit 15 needs B = H5FFF, bit 12 H6FFF or H7FFF."""
    for parameter, word in ((0x7FFF, 0x9002), (0x7FFF, 0x8002), (0x5FFF, 0x1002)):
        block = layer2(G1100=0xFFFF, G1101=parameter, G1102=0, G100=0x0123, G101=0)
        block.b[102] = word
        block.b[25] = 0x0010
        block.run(0.5)
        equal(bit(block.b[29], 6), 1, f"B = {parameter:04X}H, {word:04X}H")
        assert block.b[39] in (102, 1101), block.b[39]
        block.rig.close()


@play(FX3U, "9.1")
def fx3u_layer2_message_42():
    """9.1: the last message is #387 to #393, its parameters #1264 to #1267."""
    block = layer2(G1264=0xFFFF, G1265=0x5FFF, G1266=0, G1267=0, G387=0x0777, G388=0, G389=8)
    online(block)
    block.b[390:394] = [0x0201, 0x0403, 0x0605, 0x0807]
    block.exchange()
    block.bus.expect("777 01 02 03 04 05 06 07 08")


@play(FX3U, "9.3.1")
def fx3u_layer2_cycle_time_of_0():
    """9.3.1, parameter D: "If cycle time is set to K0, cycle time operates as 1 ms"."""
    block = layer2(G1100=0xFFFF, G1101=0x5FFF, G1102=2, G1103=0, G100=0x0123, G101=0, G102=1)
    online(block)
    block.exchange()
    block.run(0.1)
    times = [frame.time for frame in block.bus.frames if frame.identifier == "123"]
    cyclic = [time for time in times if abs((time - times[0]) * 1000 % 1 - 0.5) > 0.4]
    assert len(cyclic) >= 100 and all(abs(b - a - 0.001) < 0.0002 for a, b in zip(cyclic, cyclic[1:])), times
    assert len(times) - len(cyclic) <= 1, times             # 9.3.1: the data exchange sends, too


@play(FX3U, "9", "6.10", "6.17")
def fx3u_node_address_in_a_layer_2_mode():
    """6.10: a write access to #27 in a Layer 2 mode generates #29 bit 6."""
    block = layer2()
    block.b[27] = 5
    equal([bit(block.b[29], 6), block.b[39]], [1, 27])
