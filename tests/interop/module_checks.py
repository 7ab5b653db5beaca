"""Checks of the ME3CAN1-Q over its PLC's Ethernet port: the examples a user copies from, judged by the bus's recording."""
import struct
import sys

from kit import ROOT, check, command, covers, host_port, require, running, scratch

EXAMPLES = ROOT / "examples/me3can1-q"


def example_plant(name, changes=()):
    """An example's plant file with doors on free ports."""
    text = (EXAMPLES / f"{name}.toml").read_text()
    for old, new in [("127.0.0.1:5007", "127.0.0.1:0"), ("127.0.0.1:29536", "127.0.0.1:0"),
                     ('"../devices/', f'"{ROOT}/examples/devices/'), *changes]:
        require(old in text, f"{name}.toml has no {old}")
        text = text.replace(old, new)
    path = scratch / f"example-{name}.toml"
    path.write_text(text)
    return path


def recorded(path):
    """(identifier, bytes) of each data frame in a pcap file of SocketCAN frames, in order."""
    data = path.read_bytes()
    magic, = struct.unpack("<I", data[:4])
    require(magic in (0xA1B2C3D4, 0xA1B23C4D), f"{path}: no pcap file")
    frames, place = [], 24
    while place + 16 <= len(data):
        length, = struct.unpack("<I", data[place + 8:place + 12])
        packet = data[place + 16:place + 16 + length]
        identifier, = struct.unpack(">I", packet[:4])
        if not identifier & 0x6000_0000:  # neither RTR nor error frame
            frames.append((identifier & 0x1FFF_FFFF, packet[8:8 + packet[4]]))
        place += 16 + length
    return frames


def in_order(frames, expected):
    """All expected frames are there in this order, others between them."""
    left = iter(frames)
    for identifier, data in expected:
        wanted = (identifier, bytes.fromhex(data))
        require(wanted in left, f"{identifier:03X} [{data}] did not come, or not in the expected order")


def run_example(name):
    """(what the script printed, the frames of the bus)"""
    with running(example_plant(name)) as plant:
        done = command(sys.executable, EXAMPLES / f"{name}.py", *host_port(plant.mc))
        code, errors = plant.stop()
        require(code == 0, f"exit code {code}: {errors}")
        return done.stdout, recorded(plant.trace)


@check
@covers("ME3-PRG-002")
def example_starts_an_me3can1_q_up():
    printed, frames = run_example("startup")
    require("the network is Operational: nodes 1, 2 and 3" in printed, printed)
    require("its inputs 5A00H" in printed, printed)
    in_order(frames, [
        (0x77F, "00"), (0x0FF, "00 62 01 4D 45 30 30 34"), (0x77F, "00"),  # steps 1 to 3: still node 127
        (0x0FF, "00 62 01 4D 45 30 30 34"), (0x701, "00"),                 # 4 to 7: node 1, no master
        (0x081, "00 62 01 4D 45 30 30 34"), (0x000, "82 00"), (0x701, "00"),  # 8: master
        (0x081, "00 62 01 4D 45 30 30 34"), (0x000, "82 00"), (0x701, "00"),  # 13
        (0x602, "40 00 10 00 00 00 00 00"), (0x582, "43 00 10 00 91 01 0F 00"),  # 12: identification
        (0x000, "01 02"), (0x701, "05"), (0x202, "5A 00")])                # 9: heartbeat, 11: TPDO1
    require((0x000, bytes.fromhex("01 03")) in frames, "node 3 was not started")


@check
@covers("ME3-PRG-001")
def example_program_does_what_the_function_blocks_do():
    printed, frames = run_example("program")
    for line in ("40 cycles: 40 outputs came back", "analogue output 390", "SDO abort 05040000H", "G402 = 0082H, X10 ON"):
        require(line in printed, f"{line!r} is missing in:\n{printed}")
    in_order(frames, [
        (0x000, "82 00"), (0x701, "00"),                            # CANopenInit, NMTMasterSettings
        (0x602, "2B 17 10 00 C8 00 00 00"),                         # HeartbeatProducerSetup of the station
        (0x582, "60 17 10 00 00 00 00 00"), (0x702, "7F"),          # HeartbeatConsumerSetup: it is heard
        (0x602, "2B 11 64 01 01 00 00 00"), (0x582, "60 11 64 01 00 00 00 00"),  # SDOWrite
        (0x602, "40 00 10 00 00 00 00 00"), (0x582, "43 00 10 00 91 01 0F 00"),  # SDORead
        (0x000, "01 00"),                                          # NMTRequestWrite
        (0x202, "80 00"), (0x202, "81 00"), (0x202, "A7 00"),       # PDOWrite
        (0x000, "80 02"), (0x702, "7F"), (0x000, "02 02"), (0x702, "04"), (0x000, "01 02"),
        (0x602, "2B 17 10 00 00 00 00 00"), (0x081, "02 8F 11 00 00 00 00 00")])  # heartbeat lost
    outputs = [data[0] for identifier, data in frames if identifier == 0x202]
    require(outputs == list(range(0x80, 0xA8)), f"TPDO1 carried {outputs}")
    analogue = [int.from_bytes(data[:2], "little") for identifier, data in frames if identifier == 0x302]
    require(analogue == [10 * cycle for cycle in range(1, 40)], f"TPDO2 carried {analogue}")
