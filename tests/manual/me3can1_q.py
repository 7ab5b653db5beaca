"""Plays of the ME3CAN1-Q User's Manual (version A). The module has head address 40H, unless the play says so."""
from signals import NONE, OWN, Module, rack as rack_of, slave
from rig import DEVICES, Rig, bit, equal, play

ME3 = "ME3CAN1-Q"
SAVE, LOAD = 0x65766173, 0x64616F6C  # "save", "load"


def rack(settings="", **options):
    return rack_of(ME3, settings, **options)


def node(number, settings="", **options):
    """An NMT slave with this node-ID, Pre-operational."""
    module = rack(settings, node=number, **options).ready()
    if module.bus:
        module.bus.expect(f"{0x700 + number:03X} 00", within=8)
    return module


def operational(number=1, settings="", **options):
    module = node(number, settings, **options)
    module.bus.send(f"000 01 {number:02X}")
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 1)
    module.bus.discard()
    return module


def master(settings="", more_objects="", **options):
    """The NMT master, node 1; `more_objects` in TOML."""
    return rack(f'objects = {{ "1F80:00" = 0x01{more_objects} }}\n{settings}', node=1, **options).ready()


def layer2(mode=11, **words):
    """A module in a Layer 2 mode, offline; what was saved are these words."""
    saved = ", ".join(f"{name} = {value}" for name, value in {"G21": mode, **words}.items())
    return rack(f"buffer = {{ {saved} }}").ready()


def online(module):
    module.y(0x03, True)
    module.until_x(0x03)
    module.run(0.05)                                        # a slot may be sent at the transition to online
    module.bus.discard()


# --- 3.3 I/O signals, 3.4 Buffer memory


@play(ME3, "3.3.1", "3.4")
def me3_signals_and_words_of_a_head_address():
    """3.3.1: signals from the head address on, here 30H; 3.4: Un\\G with the head I/O number."""
    module = rack(head=0x30)
    module.until_x(0x00, within=20)
    assert module.plc.x[0x30], "module ready is X30"
    module.ready()
    equal(module.plc.g[3][21], 405, "U3\\G21")
    module.plc.g[3][70] = 600
    equal(module.plc.g[3][70], 600)


@play(ME3, "3.4.1", "3.4")
def me3_buffer_memory_from_the_box():
    """3.4.1: the default values; 4.8.1: boot-up message, Pre-operational."""
    module = rack().ready()
    g = module.g
    module.bus.expect("77F 00", within=8)
    equal(g[25], 0x0100, "Pre-operational")
    for address, value in ((20, 0), (21, 405), (22, 0), (24, 250), (27, 127), (29, 0), (35, 0), (36, 0), (37, 2500), (38, 875), (39, 0),
                           (40, 0), (50, 1), (51, 14), (52, 8), (53, 1), (58, 0), (70, 500), (71, 500), (400, 0), (727, 0x7F)):
        equal(g[address], value, f"G{address}")
    for first, count in ((401, 127), (601, 126), (750, 110), (1000, 67)):
        equal(g[first:first + count], [0] * count, f"G{first} on")


@play(ME3, "3.3.2")
def me3_module_restart():
    """3.3.2, Xn2/Yn2, Fig. 3-4: restart request, about 6 s of initialization, restart completed."""
    module = node(1)
    module.bus.discard()
    begin = module.rig.time
    module.y(0x02, True)
    module.run(0.1)
    equal(bit(module.g[25], 7), 1, "initializing")
    module.until_x(0x02)
    took = module.rig.time - begin
    assert 5 < took < 7, f"{took} s"
    equal(bit(module.g[25], 7), 0)
    module.bus.expect("701 00", within=0.1)
    module.y(0x02, False)
    module.until_x(0x02, False, 1)


@play(ME3, "3.3.2", "3.5.7", "3.5.10", "8.1.2")
def me3_error_and_its_clear_request():
    """3.3.2, XnF/YnF, Fig. 3-5: G29, G39, XnF; cleared by YnF; while YnF is ON no error stays."""
    module = rack().ready()
    module.g[21] = 100
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[39], module.g[21]], [1 << 6, 21, 405])
    module.g[27] = 200
    equal(module.g[39], 21, "the first address is displayed")
    module.y(0x0F, True)
    module.until_x(0x0F, False, 1)
    equal([module.g[29], module.g[39]], [0, 0])
    module.y(0x0F, False)
    module.run(0.05)
    module.g[27] = 200
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[39]], [1 << 6, 27])
    module.g[29] = 0                                        # 8.1.2: or "0" to the whole address
    module.until_x(0x0F, False, 1)
    equal([module.g[29], module.g[39]], [0, 0])


@play(ME3, "3.3.2", "3.5.14", "3.5.15")
def me3_nmt_error_is_cleared_for_one_node_or_all():
    """3.3.2, X(n+1)0/Y(n+1)0; 3.5.14: Un\\G400 = node, or 0 for all."""
    module = node(1, 'objects = { "1016:01" = 0x000205DC, "1016:02" = 0x000305DC }')
    for other in ("702 05", "703 05"):
        module.bus.send(other)
    module.run(0.01)
    equal([module.g[402], module.g[403]], [0b10, 0b10], "heartbeat is active")
    module.until_x(0x10, within=3)
    equal([bit(module.g[402], 7), bit(module.g[403], 7)], [1, 1])
    module.g[400] = 2
    module.y(0x10, True)
    module.run(0.05)
    equal([bit(module.g[402], 7), bit(module.g[403], 7), module.x(0x10)], [0, 1, True])
    module.y(0x10, False)
    module.run(0.05)
    module.g[400] = 0
    module.y(0x10, True)
    module.until_x(0x10, False, 1)
    equal(bit(module.g[403], 7), 0)
    module.y(0x10, False)


@play(ME3, "3.3.2", "3.5.17", "3.5.1")
def me3_emcy_message_and_its_clear_request():
    """3.3.2, X(n+1)1/Y(n+1)1, Fig. 3-6: the message is available, data exchange shows it, clear request empties the buffer."""
    module = node(1)
    module.bus.send("085 30 81 11 01 02 03 04 05")
    module.until_x(0x11, within=1)
    equal(module.g[750], 0, "not before the data exchange")
    module.exchange()
    equal(module.g[750:755], [5, 0x8130, 0x0111, 0x0302, 0x0504])
    module.y(0x11, True)
    module.until_x(0x11, False, 1)
    equal(module.g[750:860], [0] * 110)
    module.bus.send("085 30 81 11 01 02 03 04 05")
    module.run(0.05)
    equal(module.x(0x11), False, "not stored while the request is ON")
    module.y(0x11, False)
    module.run(0.05)
    module.bus.send("086 10 10 01 00 00 00 00 00")
    module.until_x(0x11, within=1)
    module.exchange()
    equal(module.g[750:753], [6, 0x1010, 0x0001])
    module.g[750] = 0                                       # 3.5.17: clears it, too
    module.run(0.02)
    equal(module.g[750:755], [0] * 5)


@play(ME3, "3.5.17")
def me3_emcy_stack_and_ring():
    """3.5.17: the first 11 messages in the stack, the latest 11 in the ring."""
    module = node(1)
    for code in range(0x1001, 0x1018):
        module.bus.send(f"085 {code & 0xFF:02X} 10 01 00 00 00 00 00")
        module.run(0.002)
    module.exchange()
    words = module.g[750:860]
    equal(words[0::5], [5] * 22)
    equal(words[1::5], [*range(0x1001, 0x100C), *range(0x100D, 0x1018)])


# --- 3.5 Buffer memory details: CANopen mode


@play(ME3, "3.5.1", "3.3.2", "3.5.19")
def me3_data_exchange():
    """3.3.2, Xn1/Yn1; 3.5.1: Un\\G20 selects process data or EMCY; 3.5.19: TPDO and RPDO words."""
    module = operational()
    module.g[13000:13004] = [0x1111, 0x2222, 0x3333, 0x4444]
    module.bus.expect_none(0.1)
    module.exchange()
    module.bus.expect("181 11 11 22 22 33 33 44 44")
    module.bus.send("201 01 02 03 04 05 06 07 08", "085 00 10 01 00 00 00 00 00")
    module.run(0.02)
    equal(module.g[10000:10004], [0] * 4)
    module.g[20] = 0x1000                                   # EMCY alone
    module.exchange()
    equal([module.g[10000], module.g[750]], [0, 5])
    module.g[20] = 0x0100                                   # PDOs alone
    module.bus.send("085 00 10 01 00 00 00 00 00")
    module.exchange()
    equal([module.g[10000:10004], module.g[755]], [[0x0201, 0x0403, 0x0605, 0x0807], 0])
    module.g[20] = 0
    module.exchange()
    equal(module.g[755], 5, "both")


@play(ME3, "3.5.2", "3.5.3", "3.3.2")
def me3_function_mode_is_saved_and_restarted_with():
    """3.5.2: mode 11, saved, restart; without a save the restart brings the former mode back."""
    module = rack().ready()
    module.g[21] = 11
    module.restart()
    equal(module.g[21], 405, "not saved")
    module.g[21] = 11
    module.save()
    equal(module.g[25] & 0x0300, 0x0100, "the mode changes with the restart")
    module.bus.discard()
    module.restart()
    equal(module.g[21], 11)
    module.bus.expect("0FF 00 62 01 4D 45 30 30 34", others=False)   # 4.6.12: the restart, in the former mode
    module.bus.expect_none(0.5)                                 # no CANopen in Layer 2 mode


@play(ME3, "3.5.3", "3.3.2")
def me3_save_and_restore_configuration():
    """3.5.3: Un\\G22 bit 0 saves, bit 1 restores the defaults, both save the defaults; executed by Y(n+1)F."""
    module = rack().ready()
    module.g[70] = 1000
    module.save()
    module.restart()
    equal(module.g[70], 1000)
    module.g[22] = 2
    module.handshake(0x1F)
    equal([module.g[22], module.g[70]], [0, 500])
    module.restart()
    equal(module.g[70], 1000, "the flash memory was not touched")
    module.g[22] = 3
    module.handshake(0x1F)
    equal(module.g[70], 500)
    module.rig.power_cycle()
    module.ready()
    equal([module.g[21], module.g[27], module.g[70]], [405, 127, 500])


@play(ME3, "3.5.4", "3.5.6")
def me3_bit_rate_and_node_address():
    """3.5.4, 3.5.6: set Un\\G24 and Un\\G27, save, restart; the rate in use stands in Un\\G37."""
    module = rack(bit_rate=500_000, peer=False, settings="buffer = { G24 = 250 }").ready()
    module.g[24] = 500
    module.g[27] = 9
    equal(module.g[37], 2500, "still the former one")
    module.save()
    equal(module.g[37], 2500)
    module.rig.power_cycle(peer=True)
    module.ready()
    module.bus.expect("709 00", within=8)
    equal([module.g[24], module.g[37], module.g[27], module.g[609]], [500, 5000, 9, 0x7F])


@play(ME3, "3.5.5", "4.8.3", "4.8.1", "3.5.16")
def me3_communication_status_of_an_nmt_slave():
    """3.5.5: Un\\G25; 4.8.1, Fig. 4-25: NMT states by node control commands; 3.5.16: Un\\G601."""
    module = node(1)
    module.bus.send("000 01 01")
    module.run(0.01)
    equal([module.g[25], module.g[601]], [0x0201, 5], "Operational")
    module.bus.send("000 80 00")
    module.run(0.01)
    equal([module.g[25], module.g[601]], [0x0100, 0x7F], "Pre-operational")
    module.bus.send("000 02 01")
    module.run(0.01)
    equal([module.g[25], module.g[601]], [0x0000, 4], "Stopped")
    module.bus.discard()
    module.bus.send("601 40 00 10 00 00 00 00 00")
    module.bus.expect_none(0.1)
    module.bus.send("000 82 01")
    module.run(0.01)
    equal(bit(module.g[25], 7), 1, "initializing")
    module.bus.expect("701 00", within=8)
    module.run(0.01)
    equal(bit(module.g[25], 6), 1, "NMT reset")
    module.g[25] = 0xFFBF
    equal(bit(module.g[25], 6), 0)


@play(ME3, "3.5.8", "8.1.1")
def me3_error_counters_and_error_passive():
    """3.5.8: Un\\G35; 3.5.7: bit 14 from 128 on, reset by itself; 8.1.1: a module that no node acknowledges."""
    module = rack(node=1, peer=False).ready()
    module.run(1)
    equal(module.g[35], 128, "no node acknowledges the boot-up message")
    equal(bit(module.g[29], 14), 1, "error passive state")


@play(ME3, "8.1.2", "3.5.7", "5.4.5")
def me3_bus_off_and_restart():
    """8.1.2, bit 3: check the network, then restart the module; 5.4.5: a command meanwhile is error class B0FFH."""
    module = node(1, more='[[bus.fault]]\nkind = "stuck recessive"\nports = ["module"]\nfrom = "9s"\nuntil = "12s"\n')
    module.run(9.2 - module.rig.time)
    module.g[1000:1004] = [4, 2, 0x1000, 0]
    module.y(0x17, True)
    module.rig.until(lambda: bit(module.g[29], 3), "bus OFF", 2)
    module.until_x(0x17)
    module.y(0x17, False)
    module.until_x(0x17, False, 1)
    equal(module.cif(4, 2, 0x1000, 0)[0:2], [0x000F, 0xB0FF])
    equal(module.g[35], 256)
    module.run(2)
    module.restart()
    equal([bit(module.g[29], 3), module.g[35] < 128], [0, True])


@play(ME3, "3.5.11", "3.3.2", "4.6.9")
def me3_time_stamp_producer():
    """3.5.11: the clock is set by Y(n+1)2, read by Y(n+1)3; Un\\G50 = 2 and Un\\G58 = 1: TIME each minute, from the active master."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    module.bus.discard()
    module.g[50:57] = [2, 14, 10, 15, 12, 30, 0]
    module.g[58] = 1
    module.handshake(0x12)
    first = module.bus.expect("100 40 A5 AE 02 ED 2B", within=1)
    second = module.bus.expect("100 A0 8F AF 02 ED 2B", within=61)
    assert abs(second.time - first.time - 60) < 0.01
    module.handshake(0x13)
    equal(module.g[51:58], [14, 10, 15, 12, 31, module.g[56], 3], "Wednesday, one minute later")


@play(ME3, "3.5.11")
def me3_wrong_date():
    """3.5.11: a date that does not exist is a buffer memory setting error."""
    module = node(1)
    module.g[50:57] = [2, 14, 2, 30, 12, 0, 0]
    module.y(0x12, True)
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[39]], [1 << 6, 53])
    module.y(0x12, False)


@play(ME3, "3.5.11", "4.6.9", "3.3.2")
def me3_time_stamp_consumer():
    """4.6.9: TIME sets the clock, Un\\G25 bit 12; before 2000 it is 2000-01-01."""
    module = node(1)
    module.bus.send("100 00 00 00 00 A2 2B")                # 2014-08-01
    module.run(5.1)
    equal(bit(module.g[25], 12), 1)
    module.handshake(0x13)
    equal(module.g[51:58], [14, 8, 1, 0, 0, 5, 5], "Friday")
    module.g[25] = 0xEFFF
    equal(bit(module.g[25], 12), 0)
    module.bus.send("100 00 00 00 00 01 00")                # 1984-01-02
    module.run(0.1)
    module.handshake(0x13)
    equal(module.g[51:54], [0, 1, 1])
    equal(module.g[57], 6, "Saturday")


# --- 3.6 Layer 2 message mode


@play(ME3, "3.6.2", "3.6.4", "3.6.6", "3.3.2")
def me3_layer2_transmit_and_trigger():
    """3.6.2: parameters of a slot; 3.6.6: CAN-ID, DLC, data; 3.6.4: trigger flags with Yn4."""
    module = layer2(G6000=0xFFFF, G6001=0x5FFF, G6002=4, G10000=0x0123, G10001=0)
    module.g[10002] = 2
    online(module)
    module.g[10003] = 0xBBAA
    module.exchange()
    module.bus.expect_none(0.1)                                 # type 4: not by the data exchange
    module.g[8400] = 1
    module.handshake(0x04)
    module.bus.expect("123 AA BB")
    equal(module.g[8400], 0)


@play(ME3, "3.6.2", "3.6.6")
def me3_layer2_transmission_types():
    """3.6.2, parameter C: 0 every data exchange, 1 if the data changed, 2 and 3 by the cycle time of D."""
    slots = {}
    for slot, kind in enumerate((0, 1, 2, 3)):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": 0x5FFF, f"G{6002 + 4 * slot}": kind,
                      f"G{6003 + 4 * slot}": 10, f"G{10000 + 7 * slot}": 0x101 + slot, f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(4):
        module.g[10002 + 7 * slot] = 1
    online(module)
    module.run(0.5)
    module.bus.discard()
    for slot in range(4):
        module.g[10003 + 7 * slot] = 0x11
    module.exchange()
    module.exchange()
    module.run(0.05)
    equal([module.bus.received("101").count("101 11"), module.bus.received("102").count("102 11")], [2, 1])
    module.run(1)
    cycles = [frame.time for frame in module.bus.frames if str(frame) == "103 11"]
    assert len(cycles) >= 9 and all(abs(b - a - cycles[1] + cycles[0]) < 0.001 for a, b in zip(cycles, cycles[1:])), cycles
    equal(module.bus.received("104").count("104 11"), 1, "type 3: once for a change")


@play(ME3, "3.6.3", "3.6.2", "3.6.6")
def me3_layer2_remote_frames():
    """3.6.2, parameter B: 7FFFH automatic answer, 6FFFH manual with the RTR flag of 3.6.3, 5FFFH none; strict DLC check."""
    slots = {}
    for slot, kind in enumerate((0x7FFF, 0x6FFF, 0x5FFF, 0x7FFF)):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": kind, f"G{6002 + 4 * slot}": 0,
                      f"G{10000 + 7 * slot}": 0x121 + slot, f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(4):
        module.g[10002 + 7 * slot] = 2 | (0x1000 if slot == 3 else 0)
        module.g[10003 + 7 * slot] = 0xB0A0 + slot
    online(module)
    module.run(0.05)
    module.bus.discard()
    module.bus.send_remote("121", 2)
    module.bus.expect("121 A0 B0")
    equal(module.g[8350], 0)
    module.bus.send_remote("122", 2)
    module.bus.expect_none(0.05)
    equal(module.g[8350], 0b10, "RTR flag of slot 2, without a data exchange")
    module.g[10010] = 0x2211
    module.exchange()
    module.bus.expect("122 11 22")
    equal(module.g[8350], 0)
    module.run(0.05)
    module.bus.discard()
    module.bus.send_remote("123", 2)
    module.bus.expect_none(0.05, "123")
    module.bus.send_remote("124", 1)
    module.bus.expect_none(0.05, "124")
    module.bus.send_remote("124", 2)
    module.bus.expect("124 A3 B0")


@play(ME3, "3.6.2")
def me3_layer2_takes_28_slots_with_remote_answers():
    """3.6.2: more than 28 slots with B = 7FFFH or 6FFFH get 5FFFH."""
    slots = {}
    for slot in range(30):
        slots.update({f"G{6000 + 4 * slot}": 0xFFFF, f"G{6001 + 4 * slot}": 0x7FFF, f"G{10000 + 7 * slot}": 0x101 + slot,
                      f"G{10001 + 7 * slot}": 0})
    module = layer2(**slots)
    for slot in range(30):
        module.g[10002 + 7 * slot] = 1
    module.y(0x03, True)
    module.run(0.5)
    equal([module.g[6001 + 4 * 27], module.g[6001 + 4 * 28], module.g[6001 + 4 * 29]], [0x7FFF, 0x5FFF, 0x5FFF])


@play(ME3, "3.6.2", "3.6.6")
def me3_layer2_receive_filter_example_1():
    """3.6.2, example 1 (Fig. 3-8): slot 1 receives 181H; new data, new frame and overflow bits at the points (1) to (4)."""
    module = layer2(G6000=0x0181, G6001=0, G6002=0, G6003=0)
    online(module)

    def point(*frames):
        """Clear the upper byte, let frames come, exchange; the words of the slot."""
        module.g[10002] = module.g[10002] & 0x00FF
        module.bus.send(*frames) if frames else None
        module.run(0.01)
        module.exchange()
        return module.g[10000:10004]

    point()
    equal(point()[2] >> 8, 0, "(2) nothing came")
    equal(point("181 A1"), [0x0181, 0, 0x0301, 0x00A1], "(3)")
    equal(point("181 B1", "181 C1", "181 D1"), [0x0181, 0, 0x0701, 0x00D1], "(4)")
    equal(point("182 11")[2] >> 8, 0, "182H is not stored")
    equal(point("181 D1")[2], 0x0201, "the same data again: new frame, no new data")


@play(ME3, "3.6.1", "8.1.2")
def me3_layer2_receive_overflow():
    """3.6.1: error code 2000H of a slot; 8.1.2, bit 15: check Un\\G5001."""
    module = rack("buffer = { G21 = 11, G24 = 1000, G6000 = 0x0181, G6001 = 0, G6002 = 0, G6003 = 0 }", bit_rate=1_000_000).ready()
    online(module)
    module.bus.send(*["181"] * 100)                         # as fast as the bus is
    module.until_x(0x0F, within=1)
    equal([module.g[5001], bit(module.g[29], 15)], [0x2000, 1])
    module.exchange()
    module.g[5001] = 0
    module.y(0x0F, True)
    module.until_x(0x0F, False, 1)
    equal([module.g[5001], module.g[29]], [0, 0])


@play(ME3, "3.6.2")
def me3_layer2_receive_filter_example_2():
    """3.6.2, example 2 (Fig. 3-9): slot 2 receives 180H, 182H, 184H and 186H."""
    module = layer2(G6004=0x0180, G6005=0, G6006=0x0006, G6007=0)
    online(module)
    for identifier, accepted in (("180", True), ("182", True), ("184", True), ("186", True), ("181", False), ("188", False)):
        module.g[10009] = 0
        module.bus.send(f"{identifier} {identifier[1:]}")
        module.run(0.01)
        module.exchange()
        equal(bool(module.g[10009] >> 8 & 2), accepted, identifier)
        if accepted:
            equal(module.g[10007], int(identifier, 16))
    module.g[10009] = 0
    module.bus.send("182 01", "186 02", "180 D1")
    module.run(0.01)
    module.exchange()
    equal(module.g[10007:10011], [0x0180, 0, 0x0701, 0x00D1])


@play(ME3, "3.6.5", "4.7")
def me3_layer2_run_stop_messages():
    """3.6.5: messages that are sent when the PLC goes from RUN to STOP, in the order 1 to 4."""
    module = layer2(G8450=0x0100, G8451=0, G8452=1, G8453=0x0055, G8457=0x0050, G8458=0, G8459=2, G8460=0x2211)
    online(module)
    module.plc.remote_stop()
    module.bus.expect("100 55", "050 11 22", others=False)


@play(ME3, "3.6.7", "5.4.1")
def me3_layer2_message_by_the_command_interface():
    """3.6.7: command 000CH; 000DH, F00CH; CANopen commands are unknown here."""
    module = layer2()
    online(module)
    equal(module.cif(0x000C, 0x0321, 0, 0, 3, 0x0201, 0x0003)[0:5], [0x000D, 0, 0, 0, 0])
    module.bus.expect("321 01 02 03")
    result = module.cif(0x000C, 0x0321, 0, 0, 9, 0x0201, 0x0003)
    equal(result[0], 0xF00C)
    assert result[4], "the wrong parameter is not 0"
    equal(module.cif(0x0004, 0, 0x1000, 0)[0:2], [0x000F, 0x0064])
    equal(module.cif(0x000C, 0x0322, 0, 1, 4)[0], 0x000D)
    module.run(0.01)
    equal([str(frame) for frame in module.rig.remote_frames()], ["322 R4"])


@play(ME3, "8.1.2", "3.6.2", "3.3.2")
def me3_layer2_configuration_while_online():
    """8.1.2, bit 5: no write into configuration words while ONLINE; Un\\G40; the remedy: offline first."""
    module = layer2()
    online(module)
    before = module.g[6000]
    module.g[6000] = 0x0200
    module.until_x(0x0F, within=1)
    equal([module.g[29], module.g[40], module.g[6000]], [1 << 5, 6000, before])
    module.y(0x0F, True)
    module.until_x(0x0F, False, 1)
    module.y(0x0F, False)
    equal([module.g[29], module.g[40]], [0, 0])
    module.y(0x03, False)
    module.until_x(0x03, False, 1)
    module.g[6000] = 0x0200
    equal([module.g[29], module.g[6000]], [0, 0x0200])


# --- 4.6 Communication profile area


@play(ME3, "4.6.3", "4.6.2", "5.2")
def me3_pre_defined_error_field():
    """4.6.3: the latest error at sub-index 1; 0 to sub-index 0 deletes the history."""
    module = node(1)
    for code in range(1, 17):
        equal(module.cif(0x000A, 0x1000 + code, 0x0081)[0], 0x000B)
    equal([module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1003, 1) & 0xFFFF], [15, 0x1010])
    result = module.cif(0x0002, OWN, 0x1003, 0, 1, 1)
    equal(result[0], 0x000F, "any other value")
    module.sdo_write(OWN, 0x1003, 0, 0, 1)
    equal([module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1001, 0)], [0, 0])


@play(ME3, "4.6.5")
def me3_pdo_mapping_procedure():
    """4.6.5: disable the PDO by bit 31, sub-index 0 of the mapping to 0, entries, number, enable; examples A5800110H and A1000110H."""
    module = node(1)
    for communication, mapping, entry, cob_id in ((0x1400, 0x1600, 0xA5800110, 0x00000201), (0x1800, 0x1A00, 0xA1000110, 0x40000181)):
        refused = module.cif(0x0002, OWN, mapping, 1, 4, entry & 0xFFFF, entry >> 16)
        equal(refused[0], 0x000F, "while the PDO exists")
        module.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        module.sdo_write(OWN, mapping, 0, 0, 1)
        module.sdo_write(OWN, mapping, 1, entry, 4)
        module.sdo_write(OWN, mapping, 0, 1, 1)
        module.sdo_write(OWN, communication, 1, cob_id, 4)
    module.bus.send("000 01 01")
    module.run(0.02)
    module.bus.discard()
    module.bus.send("201 34 12")
    module.run(0.01)
    module.g[13000] = 0x5678
    module.exchange()
    module.bus.expect("181 78 56")
    equal(module.g[10000], 0x1234)


@play(ME3, "4.6.5")
def me3_tpdo_inhibit_time_and_event_timer():
    """4.6.5, cases 1 to 5 (Fig. 4-9 to 4-13)."""
    def tpdo(inhibit, event):
        return operational(settings=f'objects = {{ "1800:03" = {inhibit}, "1800:05" = {event} }}')

    def change(module, value):
        module.g[13000] = value
        module.y(0x01, True)
        module.y(0x01, False)

    def frames(module):
        first = next(frame.time for frame in module.bus.frames if frame.identifier == "181")
        return [(round(frame.time - first, 2), frame.data[:2]) for frame in module.bus.frames if frame.identifier == "181"]

    module = tpdo(0, 0)                                     # case 1
    module.g[13000] = 0x11
    module.exchange()
    module.exchange()                                       # unchanged: none
    module.g[13000] = 0x22                                  # no exchange: none
    module.run(0.1)
    equal(len(module.bus.received("181")), 1)
    module.exchange()
    module.run(0.01)
    equal([data for _, data in frames(module)], ["11", "22"])
    module.rig.close()

    module = tpdo(1000, 0)                                  # case 2: inhibit time 100 ms
    change(module, 0x11)
    module.run(0.05)
    change(module, 0x22)                                    # dismissed
    module.run(0.07)
    change(module, 0x33)
    module.run(0.2)
    equal(frames(module), [(0.0, "11"), (0.12, "33")])
    module.rig.close()

    module = tpdo(0, 200)                                   # case 3: event timer 200 ms
    change(module, 0x11)
    module.run(0.45)
    change(module, 0x22)
    module.run(0.25)
    equal(frames(module), [(0.0, "11"), (0.2, "11"), (0.4, "11"), (0.45, "22"), (0.65, "22")])
    module.rig.close()

    module = tpdo(1000, 200)                                # case 4
    change(module, 0x11)
    module.run(0.05)
    change(module, 0x22)
    module.run(0.18)
    equal([time for time, _ in frames(module)], [0.0, 0.2])
    module.rig.close()

    module = tpdo(3000, 200)                                # case 5: no timer frame within the inhibit time
    change(module, 0x11)
    module.run(0.7)
    times = [time for time, _ in frames(module)]
    assert len(times) > 1 and all(b - a >= 0.3 for a, b in zip(times, times[1:])), times


@play(ME3, "4.6.5", "4.6.6")
def me3_synchronous_pdos():
    """4.6.5: transmission types 0, 3 and, for an RPDO, 01H."""
    module = operational(settings='objects = { "1800:02" = 3, "1801:02" = 0, "1400:02" = 1, "1801:01" = 0x40000281 }')
    module.g[13004] = 0x77
    module.exchange()
    module.bus.expect_none(0.05)
    for _ in range(3):
        module.bus.send("080")
        module.run(0.01)
    equal(module.bus.received("181", "281"), ["281 77 00 00 00 00 00 00 00", "181 00 00 00 00 00 00 00 00"])
    module.bus.send("201 34 12 00 00 00 00 00 00")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000], 0, "before the SYNC")
    module.bus.send("080")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000], 0x1234)


@play(ME3, "4.6.5", "4.5")
def me3_dummy_mapping():
    """4.5, 4.6.5: a dummy object 0005H as place holder in an RPDO."""
    module = operational(settings='objects = { "1600:00" = 2, "1600:01" = 0x00050008, "1600:02" = 0xA4C00108 }')
    module.bus.send("201 AA BB")
    module.run(0.01)
    module.exchange()
    equal(module.g[10000], 0x00BB)


@play(ME3, "4.6.6")
def me3_sync_producer():
    """4.6.6: 1006H in us, 1005H bit 30; only the active NMT master sends SYNC."""
    for make, produces in ((master, True), (lambda: node(1), False)):
        module = make()
        module.run(2)
        module.sdo_write(OWN, 0x1006, 0, 10000, 4)
        module.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
        module.bus.discard()
        module.run(0.5)
        times = [frame.time for frame in module.bus.frames if frame.identifier == "080"][-40:]
        if produces:
            assert len(times) == 40 and all(abs(b - a - 0.01) < 0.0002 for a, b in zip(times, times[1:])), times
        else:
            equal(times, [])
        module.rig.close()


@play(ME3, "4.6.7", "4.8.9", "3.5.15")
def me3_node_guarding_of_the_master():
    """4.6.7: 1F81H guard time and retry factor; Un\\G402: bits; 4.8.9: 1F83H stops and starts it."""
    module = master(more_objects=', "1F81:02" = 0x00640301')
    module.rig.until(lambda: bit(module.g[402], 0), "guarding is started", 5)
    for state in ("05", "85") * 3:
        module.bus.send(f"702 {state}")
        module.run(0.1)
    equal(module.g[402], 0b1)
    module.sdo_write(OWN, 0x1F83, 2, 0, 1)
    equal(module.sdo_read(OWN, 0x1F83, 2), 0)
    stopped = module.rig.time
    module.run(1)
    module.sdo_write(OWN, 0x1F83, 2, 1, 1)
    started = module.rig.time
    equal(module.sdo_read(OWN, 0x1F83, 2), 1)
    module.run(0.5)
    equal([bit(module.g[402], 2), bit(module.g[402], 3)], [1, 1], "no answer, for 3 retries")
    equal(module.x(0x10), True)
    times = [frame.time for frame in module.rig.remote_frames() if frame.identifier == "702"]
    assert not [time for time in times if stopped + 0.01 < time < started - 0.05], f"stopped {stopped}, started {started}: {times}"
    late = [time for time in times if time >= started - 0.05]
    assert len(late) >= 3 and all(abs(b - a - 0.1) < 0.002 for a, b in zip(late[:3], late[1:3])), late


@play(ME3, "4.6.7", "4.7")
def me3_node_guarding_of_a_slave():
    """4.6.7: 100CH and 100DH; the toggle bit; life guarding event after guard time x life time factor."""
    module = node(1)
    module.sdo_write(OWN, 0x100C, 0, 100, 2)
    module.sdo_write(OWN, 0x100D, 0, 3, 1)
    module.bus.send("000 01 01")
    module.run(0.01)
    module.bus.discard()
    module.bus.send_remote("701", 1)
    module.bus.expect("701 05")
    module.bus.send_remote("701", 1)
    module.bus.expect("701 85")
    module.bus.expect("081 01 8F 11 00 00 00 00 00", within=0.4)     # 8.2.1: caused by node-ID 1
    equal(bit(module.g[401], 6), 1)
    equal(module.g[25] & 0x0300, 0x0100, "1029H: Pre-operational")


@play(ME3, "4.6.8", "3.5.15")
def me3_heartbeat_producer_and_consumer():
    """4.6.8: 1017H produces; 1016H consumes from the first heartbeat on; Un\\G402 bits 1 and 7, X(n+1)0."""
    module = node(1)
    module.sdo_write(OWN, 0x1017, 0, 200, 2)
    module.sdo_write(OWN, 0x1016, 1, 0x000205DC, 4)
    module.bus.discard()
    times = [module.bus.expect("701 7F").time for _ in range(3)]
    assert all(abs(b - a - 0.2) < 0.001 for a, b in zip(times, times[1:])), times
    module.run(2)
    equal(module.g[402], 0, "no error before the first heartbeat")
    module.bus.send("702 05")
    module.run(0.01)
    equal([module.g[402], module.g[602]], [0b10, 5])
    module.run(1.45)
    equal(bit(module.g[402], 7), 0)
    module.run(0.1)
    equal([bit(module.g[402], 7), module.x(0x10)], [1, True])
    module.bus.send("702 00")
    module.run(0.01)
    equal(module.g[602], 0x7F)


@play(ME3, "4.6.10", "4.6.11", "3.3.2")
def me3_store_and_restore_of_objects():
    """4.6.10: "save" to 1010H; 4.6.11: "load" to 1011H, in force after a restart."""
    module = node(1)
    equal([module.sdo_read(OWN, 0x1010, 1), module.sdo_read(OWN, 0x1011, 1)], [1, 1])
    module.sdo_write(OWN, 0x1017, 0, 1000, 2)
    module.save()                                           # 3.5.3: the dictionary is not covered by Un\G22
    module.restart()
    equal(module.sdo_read(OWN, 0x1017), 0)
    module.sdo_write(OWN, 0x1017, 0, 1000, 2)
    module.sdo_write(OWN, 0x1010, 1, SAVE, 4)
    module.restart()
    equal(module.sdo_read(OWN, 0x1017), 1000)
    module.sdo_write(OWN, 0x1011, 1, LOAD, 4)
    equal(module.sdo_read(OWN, 0x1017), 1000, "until the restart")
    module.restart()
    equal(module.sdo_read(OWN, 0x1017), 0)


@play(ME3, "4.6.12", "4.7", "8.2.1")
def me3_emcy_of_cpu_stop_and_restart():
    """4.7: RUN to STOP; 4.6.12: EMCY; a module restart is announced."""
    module = operational()
    module.plc.remote_stop()
    module.bus.expect("081 00 FF 81 4D 45 30 30 32")
    equal(module.g[25] & 0x0300, 0x0100, "1029H = 0: Pre-operational")
    module.bus.send("000 01 01")
    module.run(0.05)
    equal(module.g[25] & 0x0300, 0x0100, "no start while the CPU is in STOP")
    module.plc.remote_run()
    module.run(0.05)
    equal(module.g[25] & 0x0300, 0x0100)
    module.bus.send("000 01 01")
    module.run(0.05)
    equal(module.g[25] & 0x0300, 0x0200)
    module.bus.discard()
    module.y(0x02, True)
    module.run(0.1)
    assert [frame for frame in module.bus.received("081") if frame.startswith("081 00 62") and frame.endswith("4D 45 30 30 34")]
    module.until_x(0x02)


@play(ME3, "4.7")
def me3_error_behavior():
    """4.7, 1029H: 0 Pre-operational, 1 no change of the state by a heartbeat event, 2 Stopped; a CPU STOP."""
    for behaviour, heartbeat, stop in ((0, 0x0100, 0x0100), (1, 0x0200, 0x0100), (2, 0x0000, 0x0000)):
        module = operational(settings=f'objects = {{ "1029:01" = {behaviour}, "1016:01" = 0x000200C8 }}')
        module.bus.send("702 05")
        module.run(0.3)
        equal(module.g[25] & 0x0300, heartbeat, f"1029H = {behaviour}, heartbeat lost")
        module.bus.send("000 01 01")
        module.run(0.02)
        module.plc.remote_stop()
        module.run(0.05)
        equal(module.g[25] & 0x0300, stop, f"1029H = {behaviour}, CPU STOP")
        module.rig.close()


# --- 4.8 Network management


@play(ME3, "4.8.5", "3.5.12")
def me3_simple_master_start_up():
    """4.8.5, Fig. 4-29: reset communication all, the delay of Un\\G70, start all remote nodes."""
    for delay in (500, 2000):
        module = rack(f'objects = {{ "1F80:00" = 0x03 }}\nbuffer = {{ G70 = {delay} }}', node=1)
        reset = module.bus.expect("000 82 00", within=8)
        start = module.bus.expect("000 01 00", within=4)
        assert start.time - reset.time > delay / 1000 - 0.001, f"{start.time - reset.time} s"
        assert start.time - reset.time < delay / 1000 + 0.5
        module.run(0.01)
        equal(module.g[25], 0x8201)
        module.rig.close()


@play(ME3, "4.8.5", "4.8.6", "4.8.4", "4.8.2")
def me3_master_boots_a_slave():
    """4.8.6: 1F81H, 1F84H to 1F88H: device type and identity are read, then the slave and the master are started."""
    module = master(more_objects=', "1F81:02" = 0x0D, "1F84:02" = 0x000F0191, "1F85:02" = 0x1234, "1F86:02" = 0x5678, '
                    '"1F87:02" = 0x00010001, "1F88:02" = 7, "1F89:00" = 10000')
    two = slave(module, 2)
    module.bus.expect("000 82 00", within=8)
    module.rig.until(lambda: bit(module.g[25], 14), "start-up of slaves", 2)
    two.power_on()
    module.bus.expect("602 40 00 10 00 00 00 00 00", "602 40 18 10 01 00 00 00 00", "602 40 18 10 02 00 00 00 00",
                      "602 40 18 10 03 00 00 00 00", "602 40 18 10 04 00 00 00 00", "000 01 02", within=3)
    module.rig.until(lambda: bit(module.g[25], 9), "the master is Operational", 2)
    equal([bit(module.g[25], 15), bit(module.g[25], 14), bit(module.g[25], 11)], [1, 0, 0])


@play(ME3, "4.8.6", "3.5.15")
def me3_device_type_is_asked_again_until_the_boot_time_is_over():
    """4.8.6: retry after 1 s until the slave responds or the boot time elapses; then the start-up is stopped."""
    module = master(more_objects=', "1F81:02" = 0x0D, "1F84:02" = 0x000F0191, "1F89:00" = 5000')
    module.bus.expect("000 82 00", within=8)
    first = module.bus.expect("602 40 00 10 00 00 00 00 00", within=2)
    second = module.bus.expect("602 40 00 10 00 00 00 00 00", within=2)
    assert second.time - first.time >= 1, f"{second.time - first.time} s"
    module.rig.until(lambda: bit(module.g[402], 4), "G402 bit 4", 6)
    equal([module.x(0x10), module.g[25] & 0x0300], [True, 0x0100], "the master stays Pre-operational")
    module.bus.discard()
    slave(module, 2).power_on()
    module.bus.expect_none(2, "000")                            # start-up master disabled


@play(ME3, "4.8.4", "4.8.6")
def me3_slave_with_another_identity():
    """4.8.4: if identification data are different, the start-up of this NMT slave is stopped."""
    module = master(more_objects=', "1F81:02" = 0x0D, "1F85:02" = 0x9999, "1F89:00" = 10000')
    module.bus.expect("000 82 00", within=8)
    slave(module, 2).power_on()
    module.rig.until(lambda: bit(module.g[402], 4), "G402 bit 4", 3)
    module.bus.expect_none(2, "000")
    equal(module.g[25] & 0x0300, 0x0100)


def booted(configuration=0x01, assignment=0x0D):
    """A master with this 1F80H that has started slave 2, whose heartbeat it watches."""
    module = rack(f'objects = {{ "1F80:00" = {configuration}, "1F81:02" = {assignment}, "1016:01" = 0x000205DC }}', node=1).ready()
    two = slave(module, 2)
    two.heartbeat = 0.2
    module.bus.expect("000 82 00", within=8)
    two.power_on()
    module.bus.expect("000 01 02", within=3)
    module.rig.until(lambda: bit(module.g[25], 9) and module.g[602] == 5, "Operational", 3)
    module.bus.discard()
    return module, two


@play(ME3, "4.8.7", "4.8.5")
def me3_error_control_event_of_a_slave():
    """4.8.7, Fig. 4-34; 4.8.5, 1F80H bits 4 and 6: reset of the slave, of all, or stop of all."""
    for configuration, assignment, frame in ((0x01, 0x05, "000 82 02"), (0x01, 0x0D, "000 82 02"), (0x11, 0x0D, "000 82 00"),
                                             (0x11, 0x05, "000 82 02"), (0x41, 0x0D, "000 02 00"), (0x51, 0x0D, "000 02 00")):
        module, two = booted(configuration, assignment)
        two.is_off = True
        module.bus.expect(frame, within=2)
        equal(bit(module.g[402], 7), 1, f"1F80H = {configuration:02X}H")
        module.rig.close()


@play(ME3, "4.8.7", "4.8.2")
def me3_boot_up_message_of_an_assigned_slave():
    """4.8.7: the slave is started up again; not while the master is Stopped."""
    module, two = booted()
    two.power_on()
    module.bus.expect("602 40 00 10 00 00 00 00 00", "000 01 02", within=2)
    module.sdo_write(OWN, 0x1F82, 1, 4, 1)
    module.rig.until(lambda: module.g[25] & 0x0300 == 0, "Stopped", 1)
    module.bus.discard()
    two.power_on()
    module.bus.expect_none(1, "602", "000")


@play(ME3, "4.8.8", "5.1.3", "3.5.16")
def me3_request_nmt():
    """4.8.8, Tab. 4-31: each value of 1F82H, for one node and for all; 5.1.3, Tab. 5-7: all nodes Operational."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    for value, command in ((0x04, "02"), (0x05, "01"), (0x7F, "80"), (0x06, "81"), (0x07, "82")):
        module.bus.discard()
        module.sdo_write(OWN, 0x1F82, 2, value, 1)
        module.bus.expect(f"000 {command} 02", others=False)
    for value, command in ((0x84, "02"), (0x85, "01"), (0x86, "81"), (0x87, "82"), (0x8F, "80")):
        module.bus.discard()
        module.sdo_write(OWN, 0x1F82, 0x80, value, 1)
        module.bus.expect(f"000 {command} 00", others=False)
        equal(module.g[25] & 0x0300, 0x0200, "the master stays in its state")
    module.sdo_write(OWN, 0x1F82, 0x80, 0x7F, 1)
    module.rig.until(lambda: module.g[25] & 0x0300 == 0x0100, "Pre-operational", 1)
    module.bus.discard()
    result = module.cif(0x0002, OWN, 0x1F82, 0x80, 1, 5)    # Tab. 5-7
    equal(result[0:4], [0x0003, OWN, 0x1F82, 0x80])
    module.bus.expect("000 01 00")
    module.rig.until(lambda: module.g[25] & 0x0301 == 0x0201, "Operational", 1)
    module.bus.send("000 02 00")
    module.run(0.05)
    equal(module.g[25] & 0x0300, 0x0200, 'the master ignores "all nodes" commands (4.8.5)')


@play(ME3, "4.8.10")
def me3_flying_masters():
    """4.8.10, Fig. 4-36: two flying masters, the lower node-ID wins; it fails, the other one takes over; heartbeats by themselves."""
    def plc(number):
        return f'''
[[plc]]
name = "plc{number}"
family = "Q"
listen = "127.0.0.1:0"
[[plc.module]]
model = "ME3CAN1-Q"
name = "module {number}"
head = 0x40
node = {number}
objects = {{ "1F80:00" = 0x21 }}
'''
    rig = Rig('''
[plant]
name = "flying masters"
[[bus]]
name = "line"
bit_rate = 250_000
serve = "socketcand:127.0.0.1:0"
[[bus.fault]]
kind = "cut"
ports = ["module 1"]
from = "30s"
''' + plc(1) + plc(2))
    one, two = Module(rig, plc="plc1").ready(), Module(rig, plc="plc2").ready()
    rig.until(lambda: bit(one.g[25], 15), "node 1 is the master", 15)
    rig.run(20 - rig.time)
    equal([bit(one.g[25], 15), bit(two.g[25], 15)], [1, 0])
    rig.bus.received()
    beats = [frame.time for frame in rig.bus.frames if frame.identifier == "701" and frame.data in ("05", "7F")][-5:]
    assert all(abs(b - a - 1) < 0.01 for a, b in zip(beats, beats[1:])), f"heartbeat every 1000 ms: {beats}"
    assert "000 82 00" in rig.bus.received("000"), "reset communication to all nodes"
    rig.run(30 - rig.time)                              # node 1 is cut off
    rig.bus.discard()
    rig.run(5)
    equal(bit(two.g[25], 15), 1, "node 2 is the master")
    assert "000 82 00" in rig.bus.received("000")


@play(ME3, "4.8.11")
def me3_lss_gives_a_slave_its_node_id():
    """4.8.11: 1F89H, 1F84H to 1F88H and 1F81H = 0DH of node 5; a slave without node-ID gets it; the network is reset then."""
    module = master(more_objects=', "1F81:05" = 0x0D, "1F84:05" = 0x000F0191, "1F85:05" = 0x1234, "1F86:05" = 0x0401, '
                    '"1F87:05" = 0x00010000, "1F88:05" = 7, "1F89:00" = 3000',
                    more=f'[[device]]\nname = "block"\nnode = "unconfigured"\neds = "{DEVICES}/io-block.eds"\n'
                         'objects = { "1018:01" = 0x1234, "1018:04" = 7 }\n')
    module.rig.until(lambda: bit(module.g[25], 10), "LSS services in progress", 12)
    module.bus.expect("7E5 40 34 12 00 00 00 00 00", "7E5 41 01 04 00 00 00 00 00", "7E5 42 00 00 01 00 00 00 00",
                      "7E5 43 07 00 00 00 00 00 00", "7E4 44 00 00 00 00 00 00 00", within=5)
    module.bus.expect("7E5 11 05 00 00 00 00 00 00", within=1)
    module.bus.expect("705 00", within=5)


@play(ME3, "4.8.12")
def me3_concise_dcf():
    """4.8.12: stored in 1F22H at once, a second one is refused, deleted by 0; the slave is configured at boot, or by "conf"."""
    module, two = booted()

    def download(data):
        """As a configuration tool does it, over the bus; the last answer."""
        begin = len(module.bus.received())
        module.bus.send(f"601 21 22 1F 02 {len(data):02X} 00 00 00")
        for place in range(0, len(data), 7):
            module.run(0.005)
            part = data[place:place + 7]
            toggle = place // 7 % 2 << 4
            module.bus.send(f"601 {toggle | 7 - len(part) << 1 | (place + 7 >= len(data)):02X} {part.ljust(7, bytes(1)).hex(' ')}")
        module.run(0.05)
        return module.bus.received("581")[-1] if len(module.bus.received()) > begin else None

    entry = bytes.fromhex("01000000 1710 00 02000000 F401")  # 1017H = 500
    equal(download(entry)[:6], "581 30", "accepted")
    module.run(1)
    assert download(entry)[4:6] == "80", "already used"
    module.sdo_write(OWN, 0x1F25, 2, 0x666E6F63, 4)         # "conf"
    module.bus.expect("602 2B 17 10 00 F4 01 00 00", within=2)
    result = module.cif(0x0002, OWN, 0x1F25, 3, 4, 0x6F63, 0x666E)
    equal(result[0:5], [0x000F, 3, 0, 0x0024, 0x0800], "no data are stored")
    module.sdo_write(OWN, 0x1F25, 1, 0x666E6F63, 4)         # the own node: no error
    module.bus.discard()
    two.power_on()                                          # at boot, too
    module.bus.expect("602 2B 17 10 00 F4 01 00 00", "000 01 02", within=3)


@play(ME3, "4.8.12")
def me3_expected_configuration_date():
    """4.8.12: 1020H of the slave is compared with 1F26H and 1F27H: no download if they are equal."""
    for date, downloads in ((11245, False), (11244, True)):
        module = master(more_objects=', "1F81:02" = 0x0D, "1F26:02" = 11245, "1F27:02" = 45000000, "1F89:00" = 0',
                        settings='')
        module.bus.send("601 21 22 1F 02 0D 00 00 00", "601 00 01 00 00 00 17 10 00", "601 13 02 00 00 00 F4 01 00")
        module.run(1)
        two = slave(module, 2)
        two.objects[0x1020, 1], two.objects[0x1020, 2] = date.to_bytes(4, "little"), (45000000).to_bytes(4, "little")
        two.power_on()
        module.bus.expect("000 01 02", within=4)
        equal((0x1017, 0, 500) in two.written, downloads, f"1020:01 = {date}")
        module.rig.close()


# --- 5 Command interface


@play(ME3, "5.1.1")
def me3_sdo_read_access():
    """5.1.1: command 0004H, local and remote; a text."""
    module = node(1)
    equal(module.cif(0x0004, OWN, 0x1000, 0)[0:7], [0x0005, OWN, 0x1000, 0, 4, 0x0195, 0])
    result = module.cif(0x0004, OWN, 0x1008, 0)
    equal(result[0:10], [0x0005, OWN, 0x1008, 0, 9, 0x454D, 0x4333, 0x4E41, 0x2D31, 0x0051], "ME3CAN1-Q")
    module.bus.answers = {"602 40 00 10 00 00 00 00 00": "582 43 00 10 00 91 01 0F 00"}
    equal(module.cif(0x0004, 2, 0x1000, 0)[0:7], [0x0005, 2, 0x1000, 0, 4, 0x0191, 0x000F])


@play(ME3, "5.1.2")
def me3_multi_sdo_read_access():
    """5.1.2: command 0008H, FFFFH behind the last record; 0009H, or 00F9H with 0F00H in the record that failed."""
    module = node(1)
    records = [OWN, 0x1000, 0, 0, 0, 0, 0, 0, OWN, 0x1018, 4, 0, 0, 0, 0, 0, NONE]
    result = module.cif(0x0008, *records)
    equal(result[0], 0x00F9)
    equal(result[1:7], [OWN, 0x1000, 0, 4, 0x0195, 0])
    equal(result[9:15], [0x0F00, 0x1018, 4, 0, 0x0011, 0x0609])
    records[8:11] = [OWN, 0x1018, 1]
    equal(module.cif(0x0008, *records)[0], 0x0009)


@play(ME3, "5.1.3", "5.4.4", "3.5.13")
def me3_sdo_write_access():
    """5.1.3: command 0002H; 5.4.4: abort code and time-out of a node."""
    module = node(1)
    module.bus.answers = {"602 2B 17 10 00 E8 03 00 00": "582 60 17 10 00 00 00 00 00"}
    equal(module.cif(0x0002, 2, 0x1017, 0, 2, 0x03E8)[0:4], [0x0003, 2, 0x1017, 0])
    module.bus.answers = {"602 2B 17 10 00 E8 03 00 00": "582 80 17 10 00 30 00 09 06"}
    equal(module.cif(0x0002, 2, 0x1017, 0, 2, 0x03E8)[0:5], [0x000F, 3, 2, 0x0030, 0x0609])
    module.g[71] = 300                                      # 3.5.13: SDO time out
    begin = module.rig.time
    equal(module.cif(0x0004, 9, 0x1000, 0)[0:5], [0x000F, 3, 9, 0x0000, 0x0504])
    assert 0.29 < module.rig.time - begin < 0.4


@play(ME3, "5.1.4")
def me3_multi_sdo_write_access():
    """5.1.4: command 0006H, 0007H, 00F7H."""
    module = node(1)
    records = [OWN, 0x1017, 0, 2, 0x03E8, 0, 0, 0, OWN, 0x1000, 0, 4, 1, 0, 0, 0, NONE]
    result = module.cif(0x0006, *records)
    equal([result[0], result[1], result[9], result[13], result[14]], [0x00F7, OWN, 0x0F00, 0x0002, 0x0601])
    equal(module.sdo_read(OWN, 0x1017), 1000)
    equal(module.cif(0x0006, *records[:8], NONE)[0], 0x0007)


@play(ME3, "5.2", "4.6.12", "4.6.2")
def me3_sends_an_emergency_message():
    """5.2: command 000AH; 000CH with 1 in the inhibit time, with 2 in Stopped."""
    module = node(1)
    module.bus.discard()
    result = module.cif(0x000A, 0x1000, 0xAA81, 0xCCBB, 0xEEDD)
    equal(result[0:2], [0x000B, 0])
    module.bus.expect("081 00 10 81 AA BB CC DD EE", others=False)
    equal([module.sdo_read(OWN, 0x1003, 0), module.sdo_read(OWN, 0x1001, 0)], [1, 0x81])
    module.sdo_write(OWN, 0x1015, 0, 10000, 2)
    module.cif(0x000A, 0x1000, 0xAA81, 0, 0)
    equal(module.cif(0x000A, 0x1000, 0xAA81, 0, 0)[0:2], [0x000C, 1])
    module.bus.send("000 02 01")
    module.run(2)
    equal(module.cif(0x000A, 0x1000, 0xAA81, 0, 0)[0:2], [0x000C, 2])


@play(ME3, "5.3")
def me3_display_current_parameter():
    """5.3: command 0000H shows the parameters of the last command."""
    module = node(1)
    module.cif(0x000A, 0x1000, 0xAA81, 0xCCBB, 0xEEDD)
    equal(module.cif(0x0000)[0:5], [0x0000, 0x1000, 0xAA81, 0xCCBB, 0xEEDD])


@play(ME3, "5.4.1", "5.4.2", "5.4.3", "3.5.18")
def me3_busy_command_interface_is_cleared():
    """5.4.1: unknown command; 5.4.2: a change while busy; 5.4.3: FFFFH to Un\\G1000 and Y(n+1)7."""
    module = node(1)
    equal(module.cif(0x1234)[0:2], [0x000F, 0x0064])
    module.g[1000:1004] = [4, 9, 0x1000, 0]
    module.y(0x17, True)
    module.rig.until(lambda: module.g[1000] == 0xFFFF, "busy", 1)
    module.g[1005] = 1
    module.until_x(0x17)
    equal(module.g[1000:1002], [0x000F, 0xFFFF])
    module.y(0x17, False)
    module.until_x(0x17, False, 1)
    equal(module.cif(0xFFFF)[0], 0)
    equal(module.cif(0x0004, OWN, 0x1000, 0)[0], 0x0005)


@play(ME3, "5.4.6")
def me3_device_in_wrong_state():
    """5.4.6: error class 0F0FH, for an SDO to another node while the module is Stopped."""
    module = node(1)
    module.bus.send("000 02 01")
    module.run(0.02)
    equal(module.cif(0x0004, 2, 0x1000, 0)[0:2], [0x000F, 0x0F0F])


# --- 6.5 Start-up procedure, 7 Programming, 8 Troubleshooting


@play(ME3, "6.5.1", "4.6.8", "4.6.5", "4.6.10")
def me3_start_up_procedure_of_the_405_mode():
    """6.5.1, Tab. 6-4: steps 1 to 13, then a restart in which all of it is in force."""
    module = rack().ready()
    module.g[21] = 405                                      # 1
    module.save()                                           # 2
    module.restart()                                        # 3
    module.g[24] = 250                                      # 4
    module.g[27] = 1                                        # 5
    module.save()                                           # 6
    module.bus.discard()
    module.restart()                                        # 7
    module.bus.expect("701 00", within=0.1)
    equal([module.g[601], module.g[727]], [0x7F, 0])
    module.sdo_write(OWN, 0x1F80, 0, 1, 4)                  # 8: NMT master
    module.store_objects()
    module.restart()
    equal(bit(module.g[25], 15), 1)
    module.sdo_write(OWN, 0x1017, 0, 1000, 2)               # 9: heartbeat
    module.sdo_write(OWN, 0x1016, 1, 0x000205DC, 4)
    for communication, mapping, entry, cob_id in ((0x1400, 0x1600, 0xA5800110, 0x00000182),          # 10: RPDO
                                                  (0x1800, 0x1A00, 0xA1000110, 0x40000202)):         # 11: TPDO
        module.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        module.sdo_write(OWN, communication, 2, 0xFE, 1)
        module.sdo_write(OWN, mapping, 0, 0, 1)
        module.sdo_write(OWN, mapping, 1, entry, 4)
        module.sdo_write(OWN, mapping, 0, 1, 1)
        module.sdo_write(OWN, communication, 1, cob_id, 4)
    module.sdo_write(OWN, 0x1F81, 2, 0x0D, 4)               # 12: slave assignment, identification, boot time
    module.sdo_write(OWN, 0x1F84, 2, 0x000F0191, 4)
    module.sdo_write(OWN, 0x1F89, 0, 10000, 4)
    module.store_objects()                                  # 13
    two = slave(module, 2)
    two.heartbeat = 0.2
    module.bus.discard()
    module.restart()
    two.power_on()
    module.bus.expect("602 40 00 10 00 00 00 00 00", "000 01 02", within=5)
    module.rig.until(lambda: module.g[602] == 5 and bit(module.g[25], 9), "Operational", 3)
    module.bus.expect("701 05", within=1.1)
    module.bus.send("182 34 12")
    module.run(0.01)
    module.g[13000] = 0x5678
    module.exchange()
    module.bus.expect("202 78 56")
    equal(module.g[10000], 0x1234)


@play(ME3, "6.5.2", "3.6.2", "3.6.5", "3.6.6")
def me3_start_up_procedure_of_the_layer_2_mode():
    """6.5.2, Tab. 6-5: steps 1 to 10, with 11 and with 29 bits."""
    for mode, low, high, frame in ((11, 0x0123, 0, "123 11 22"), (29, 0xF100, 0x18FE, "18FEF100 11 22")):
        module = rack(bit_rate=500_000, peer=False, settings="buffer = { G24 = 250 }").ready()
        module.g[21] = mode                                 # 1
        module.save()                                       # 2
        module.restart()                                    # 3
        equal(module.g[21], mode)
        module.g[24] = 500                                  # 4
        module.save()                                       # 5
        module.restart()                                    # 6
        module.g[6000:6004] = [0xFFFF, 0x5FFF, 0, 0]        # 7
        module.g[10000:10002] = [low, high]                 # 8
        module.g[8450:8454] = [low, high, 1, 0x00FF]        # 9
        module.save()                                       # 10
        module.rig.power_cycle(peer=True)
        module.ready()
        equal([module.g[21], module.g[24]], [mode, 500])
        equal(module.g[6000:6004], [0xFFFF, 0x5FFF, 0, 0])
        equal([*module.g[10000:10002], *module.g[8450:8452]], [low, high, low, high])
        module.g[10002] = 2
        online(module)
        equal(module.g[37], 5000)
        module.g[10003] = 0x2211
        module.exchange()
        module.bus.expect(frame)
        module.rig.close()


@play(ME3, "7.1", "7.2", "7.3")
def me3_program_example():
    """7.3: the ladder figures are lost; the order is that of the labels of 7.2 (see the module's page): initialize, master, slave,
    heartbeat, four PDOs, release of the analog inputs, NMT request, cyclic exchange with status."""
    module = rack().ready()
    module.g[27] = 1                                        # CANopenInit
    module.save()
    module.restart()
    module.sdo_write(OWN, 0x1F80, 0, 0x09, 4)               # NMTMasterSettings: the program starts the slaves (bit 3)
    module.sdo_write(OWN, 0x1F81, 2, 0x0D, 4)               # NMTSlaveSettings
    module.store_objects()
    station = slave(module, 2)
    module.restart()
    station.power_on()
    module.bus.expect("602 40 00 10 00 00 00 00 00", within=3)
    module.sdo_write(OWN, 0x1017, 0, 500, 2)                # HeartbeatProducerSetup
    module.sdo_write(2, 0x1017, 0, 200, 2)
    module.sdo_write(OWN, 0x1016, 1, 0x000203E8, 4)         # HeartbeatConsumerSetup
    module.rig.until(lambda: bit(module.g[402], 1), "STliteHeartbeatActive", 2)
    for communication, mapping, entry, cob_id in (  # First- to FourthPDOProcessing
            (0x1400, 0x1600, 0xA5800110, 0x00000182), (0x1401, 0x1601, 0xA5800510, 0x00000282),
            (0x1800, 0x1A00, 0xA1000110, 0x40000202), (0x1801, 0x1A01, 0xA1000510, 0x40000302)):
        module.sdo_write(OWN, communication, 1, cob_id | 0x80000000, 4)
        module.sdo_write(OWN, communication, 2, 0xFE, 1)
        module.sdo_write(OWN, mapping, 0, 0, 1)
        module.sdo_write(OWN, mapping, 1, entry, 4)
        module.sdo_write(OWN, mapping, 0, 1, 1)
        module.sdo_write(OWN, communication, 1, cob_id, 4)
    module.sdo_write(2, 0x6423, 0, 1, 1)                    # ReleaseAnalogInputdata
    equal(station.objects[0x6423, 0], b"\1")
    module.bus.discard()
    module.sdo_write(OWN, 0x1F82, 0x80, 5, 1)               # NMTRequestWrite, RequestData 5
    module.bus.expect("000 01 00", within=1)
    module.rig.until(lambda: [module.g[601], module.g[602]] == [5, 5], "STliteOperational", 2)
    for value in (1, 2, 3):                                 # PDORead, PDOWrite
        module.bus.send(f"182 {value:02X} 00", f"282 {value:02X} 10")
        module.run(0.01)
        module.g[13000] = 0x100 + value
        module.g[13004] = 0x200 + value
        module.exchange()
        module.bus.expect(f"202 {value:02X} 01")
        module.bus.expect(f"302 {value:02X} 02")
        equal([module.g[10000], module.g[10004]], [value, 0x1000 + value])
    station.is_off = True                                # HeartbeatStatus, ResetHeartbeatError
    module.until_x(0x10, within=2)
    equal(bit(module.g[402], 7), 1)
    station.is_off = False
    module.bus.answering(0.5)
    module.g[400] = 0
    module.y(0x10, True)
    module.until_x(0x10, False, 1)
    module.y(0x10, False)


@play(ME3, "8.1.1", "3.1.1")
def me3_leds_show_the_state():
    """8.1.1, 3.1.1: RUN, ERR., CAN RUN, CAN ERR; what the engineering tool sees of them."""
    module = node(1)
    leds = module.rig.leds
    equal([leds()["RUN"], leds()["CAN RUN"], leds()["CAN ERR"]], ["on", "blinking", "off"])
    module.bus.send("000 01 01")
    module.run(0.05)
    equal(leds()["CAN RUN"], "on")
    module.bus.send("000 02 01")
    module.run(0.05)
    equal(leds()["CAN RUN"], "single flash")
    module.g[21] = 100
    module.run(0.05)
    equal(leds()["CAN ERR"], "blinking", "general error")


@play(ME3, "8.1.2", "3.5.7")
def me3_internal_queue_overflow():
    """8.1.2, bit 8: too fast data exchange at a low baud rate; latched, cleared by YnF."""
    module = rack(node=1, bit_rate=10_000).ready()
    module.bus.send("000 01 01")
    module.run(0.1)
    for value in range(1, 300):
        module.g[13000] = value
        module.y(0x01, True)
        module.y(0x01, False)
        module.run(0.001)
        if bit(module.g[29], 8):
            break
    equal(bit(module.g[29], 8), 1)
    equal(module.x(0x0F), True)
    module.run(5)
    equal(bit(module.g[29], 8), 1, "latched")
    module.y(0x0F, True)
    module.run(0.05)
    equal(bit(module.g[29], 8), 0)


@play(ME3, "8.1.2")
def me3_hardware_error():
    """8.1.2, bit 1: not cleared by another error clear; after a power cycle it is judged anew."""
    module = rack(settings='fault = "hardware error"\nfault_at = "10s"').ready()
    module.run(11 - module.rig.time)
    equal(bit(module.g[29], 1), 1)
    module.y(0x0F, True)
    module.run(0.1)
    module.y(0x0F, False)
    module.run(0.1)
    equal(bit(module.g[29], 1), 1)
    module.rig.power_cycle()
    module.ready()
    equal(bit(module.g[29], 1), 0)


@play(ME3, "8.1.2", "3.5.3")
def me3_flash_memory_error():
    """8.1.2, bit 4: power loss during a write operation to the Flash ROM; gone when the configuration is saved again."""
    module = rack().ready()
    module.g[70] = 900
    module.g[22] = 1
    module.y(0x1F, True)
    module.run(0.003)
    equal([module.x(0x1F), module.g[22]], [False, 1], "the save is in progress")
    module.rig.power_cycle()
    module.ready()
    equal([module.g[29], module.g[70], module.x(0x0F)], [1 << 4, 500, True])
    module.save()
    module.restart()
    equal([module.g[29], module.x(0x0F)], [0, False])


@play(ME3, "8.1.1", "3.3.2")
def me3_watchdog_error():
    """8.1.1: RUN is OFF when the watchdog monitoring time has been exceeded; 3.3.2: Xn0 is OFF."""
    module = rack(settings='fault = "watchdog error"\nfault_at = "8s"').ready()
    module.run(9 - module.rig.time)
    leds = module.rig.leds()
    equal([leds["RUN"], module.x(0x00)], ["off", False])


# --- what notes of 3.3 to 3.6 say besides


@play(ME3, "3.3.2")
def me3_restart_request_that_stays_on():
    """3.3.2, Xn2/Yn2: "Not setting this signal back to OFF will cause that the module will be restarted again and again"."""
    module = node(1)
    module.bus.discard()
    module.y(0x02, True)
    module.run(20)
    boots = [frame.time for frame in module.bus.frames if str(frame) == "701 00"][1:]
    assert len(boots) >= 2 and all(5.5 < b - a < 7 for a, b in zip(boots, boots[1:])), boots
    module.y(0x02, False)
    module.ready()
    module.run(0.1)
    module.bus.discard()
    module.bus.expect_none(10, "701")


@play(ME3, "3.3.2", "3.5.15")
def me3_nmt_error_while_the_clear_request_is_on():
    """3.3.2, Y(n+1)0: a new error while it is ON is cleared automatically; after OFF the module checks again."""
    module = node(1, 'objects = { "1016:01" = 0x000200C8 }')
    module.y(0x10, True)
    module.bus.send("702 05")
    module.run(0.5)
    equal([bit(module.g[402], 7), module.x(0x10)], [0, False])
    module.y(0x10, False)
    module.bus.send("702 05")
    module.until_x(0x10, within=1)
    equal(bit(module.g[402], 7), 1)


@play(ME3, "3.4", "3.5.5", "3.5.10")
def me3_write_during_the_initialization():
    """3.4, note: while Un\\G25 bit 7 is ON a write generates a Un\\G29 bit 5 error; Un\\G40 has the address."""
    module = node(1)
    module.y(0x02, True)
    module.run(0.1)
    module.y(0x02, False)
    equal(bit(module.g[25], 7), 1)
    module.g[27] = 3
    module.rig.until(lambda: not bit(module.g[25], 7), "the end of the initialization", 8)
    equal([bit(module.g[29], 5), module.g[40], module.g[27]], [1, 27, 1])
    module.y(0x0F, True)
    module.run(0.05)
    equal([module.g[29], module.g[40]], [0, 0])


@play(ME3, "3.5.2", "4.6.10")
def me3_mode_change_deletes_the_object_dictionary():
    """3.5.2, note: all object dictionary settings are deleted when the CANopen mode is changed."""
    module = node(1)
    module.sdo_write(OWN, 0x1017, 0, 1000, 2)
    module.store_objects()
    for mode in (11, 405):
        module.g[21] = mode
        module.save()
        module.restart()
    equal(module.sdo_read(OWN, 0x1017), 0)


@play(ME3, "3.5.4")
def me3_takes_every_bit_rate():
    """3.5.4: Tab. 3-9; in force after save and restart, as Un\\G37 shows."""
    module = rack(peer=False).ready()
    for rate in (10, 20, 50, 100, 125, 250, 500, 800, 1000):
        module.g[24] = rate
        module.save()
        module.restart()
        equal([module.g[24], module.g[37], module.g[29] & ~(1 << 14)], [rate, 10 * rate, 0])


@play(ME3, "3.5.6", "3.5.7")
def me3_node_address_in_a_layer_2_mode():
    """3.5.6: a write access in Layer 2 function mode, and a value out of range, are failures of Un\\G29 bit 6."""
    module = layer2()
    module.g[27] = 5
    equal([bit(module.g[29], 6), module.g[39]], [1, 27])
    module.rig.close()
    module = node(1)
    for wrong in (0, 128):
        module.g[27] = wrong
        equal([bit(module.g[29], 6), module.g[39], module.g[27]], [1, 27, 1])
        module.g[29] = 0


@play(ME3, "3.5.8", "3.5.5")
def me3_warning_level():
    """3.5.8: 96 to 127 is the warning level, shown by Un\\G25 bit 1; from 128 on error passive."""
    module = rack("buffer = { G24 = 10 }", node=1, bit_rate=10_000, peer=False)
    levels = {}
    for _ in range(3000):
        module.run(0.001)
        counter, status, error = module.g[35], bit(module.g[25], 1), bit(module.g[29], 14)
        levels.setdefault("warning" if 96 <= counter < 128 else "passive" if counter >= 128 else "active", set()).add((status, error))
        if counter >= 128:
            break
    equal(levels, {"active": {(0, 0)}, "warning": {(1, 0)}, "passive": {(0, 1)}})


@play(ME3, "3.6.2", "3.5.10")
def me3_layer2_invalid_parameter():
    """3.6.2, note: an invalid value in Un\\G6000 to Un\\G6167: Un\\G29 bit 6, the address in Un\\G39."""
    module = layer2()
    module.g[10000:10003] = [0x0123, 0, 1]
    module.g[6000:6004] = [0xFFFF, 0x5FFF, 5, 0]            # no transmission type 5
    module.until_x(0x0F, within=1)
    equal([bit(module.g[29], 6), module.g[39]], [1, 6002])


@play(ME3, "4.6.9", "3.5.11")
def me3_clock_overflow():
    """4.6.9: later than 2079-12-31 23:59:59 is 2000-01-01 00:00:00."""
    module = master()
    module.g[50:57] = [2, 79, 12, 31, 23, 59, 58]
    module.handshake(0x12)
    module.run(3)
    module.handshake(0x13)
    equal(module.g[51:56], [0, 1, 1, 0, 0])


@play(ME3, "4.6.6")
def me3_sync_of_less_than_a_millisecond():
    """4.6.6, 1006H: values smaller than 1 ms are 1 ms; 0 disables SYNC."""
    module = master()
    module.rig.until(lambda: bit(module.g[25], 9), "Operational", 5)
    module.sdo_write(OWN, 0x1006, 0, 500, 4)
    module.sdo_write(OWN, 0x1005, 0, 0x40000080, 4)
    module.run(0.05)
    times = [frame.time for frame in module.bus.frames if frame.identifier == "080"][-20:]
    assert len(times) == 20 and all(abs(b - a - 0.001) < 0.0002 for a, b in zip(times, times[1:])), times
    module.sdo_write(OWN, 0x1006, 0, 0, 4)
    module.run(0.01)
    module.bus.discard()
    module.bus.expect_none(0.1, "080")


@play(ME3, "4.6.7", "4.6.8")
def me3_heartbeat_goes_before_guarding():
    """4.6.7: if heartbeat is activated, the node guarding settings are ignored."""
    module = master(more_objects=', "1F81:02" = 0x00640301, "1016:01" = 0x000205DC')
    for _ in range(10):
        module.bus.send("702 05")
        module.run(0.3)
    equal(module.g[402] & 0b11, 0b10)
    equal([frame for frame in module.rig.remote_frames() if frame.identifier == "702"], [])
