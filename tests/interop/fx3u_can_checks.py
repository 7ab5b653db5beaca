"""Checks of the FX3U-CAN: a stack that is not ours as its master, tshark, 1E frames, and the example a user copies from."""
import json
import socket
import struct
import sys
import time

from bus_checks import on_bus
from kit import (ANSWER, HERE, PATIENCE, ROOT, check, command, covers, host_port, node_modules, program, require, running, scratch,
                 talking, tshark_agrees, until)
from module_checks import Plc, example_plant, in_order, recorded

EXAMPLES = ROOT / "examples/fx3u-can"
sys.path.append(str(EXAMPLES))
import fx3u_can  # noqa: E402


def fx3_plant(name, module="", port='listen = "127.0.0.1:0"', family="FX3", place="position = 0"):
    """A rack of an FX with an FX3U-CAN of factory settings, as node 127."""
    path = scratch / f"{name}.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                    f'[[plc]]\nfamily = "{family}"\n{port}\n'
                    f'[[plc.module]]\nmodel = "FX3U-CAN"\n{place}\nrestart_time = "100ms"\n{module}')
    return path


def wait_started(plant, node=127):
    plant.wait(lambda e: e["event"] == "nmt" and e["node"] == node and e["state"] == "pre-operational")


def exchange_with_npm_canopen(plant, module):
    """The peer sends PDOs, SYNC and emergencies; a PLC program answers: #11000 = #10000 + 1, #11004 = inverted #10004,
    an emergency while #10000 is 3584."""
    steps = ["wait-state,127,5",
             "pdo,27F,u16,4660", "wait-pdo,1FF,u16,4661",     # event-driven, both ways
             "pdo,27F,u16,65535", "wait-pdo,1FF,u16,0",
             "pdo,37F,u16,255", "pause,300", "sync-on,50",    # with SYNC, both ways
             "wait-pdo,2FF,u16,65280", "pdo,37F,u16,43690", "wait-pdo,2FF,u16,21845", "sync-off",
             "pdo,27F,u16,3584", "wait-emcy,127,5000",        # an emergency of the module
             "pdo,27F,u16,1", "wait-pdo,1FF,u16,2",
             "emcy,8130,0102030405", "stay"]                  # one of the peer
    end = time.monotonic() + 2 * PATIENCE
    with talking("node", HERE / "services_peer.mjs", *host_port(plant.socketcand), "line1", *steps) as peer:
        module.set_g(750, 0)
        while module.g(750) != 126:
            require(peer.process.poll() is None, "\n".join(peer.said))
            require(time.monotonic() < end, "#750 is not 126: the peer's emergency did not come\n" + "\n".join(peer.said))
            module.exchange()
            received, synchronous = module.g(10000), module.g(10004)
            module.set_g(11000, (received + 1) & 0xFFFF)
            module.set_g(11004, synchronous ^ 0xFFFF)
            if received == 3584:
                module.command(0x000A, [0x5000, 0x1182, 0x3322, 0x5544], "emergency")
        peer.process.stdin.close()
        peer.require_end()
    record = module.words(750, 5)
    require(record == [126, 0x8130, 0x0100 | record[2] & 0xFF, 0x0302, 0x0504], f"#750 has {record}")


@check
@covers("FX3U-SDO-001 FX3U-PDO-001 FX3U-STO-001 FX3U-SPEC-001 FX3U-EMCY-009 FX3U-PDO-007")
def npm_canopen_configures_an_fx3u_can_as_its_slave():
    """And takes its EDS file."""
    node_modules()
    eds = scratch / "fx3u-can.eds"
    command(program, "module", "eds", "fx3u-can", "-o", eds)
    checked = command(program, "eds", "check", eds).stdout
    require("accepted, 0 warnings:" in checked and checked.count("\n") == 1, checked)
    with running(fx3_plant("fx3u-can-slave")) as plant:
        wait_started(plant)
        command("node", HERE / "module_slave_peer.mjs", *host_port(plant.socketcand), "line1", "127", eds, "FX3U-CAN")
        host, port = host_port(plant.mc)
        with Plc(host, int(port)) as plc:
            module = fx3u_can.Fx3uCan(plc)
            module.set_g(26, 0)  # this program may be slower than the FROM/TO watchdog
            require(module.g(25) & 0x0301 == 0x0201, f"#25 = {module.g(25):04X}H after the peer started the node")
            module.set_g(11000, 0xBEEF)
            module.exchange()
            module.set_g(11000, 0)
            exchange_with_npm_canopen(plant, module)
        code, errors = plant.stop()
        require(code == 0, errors)
        frames = recorded(plant.trace)
        require((0x1FF, bytes.fromhex("EF BE")) in frames, "TPDO1 with the one word was not sent")
        syncs = sum(identifier == 0x080 for identifier, _ in frames)
        tpdo2 = [data for identifier, data in frames if identifier == 0x2FF]
        require(syncs >= 3 and abs(len(tpdo2) - syncs) <= 1, f"{syncs} SYNCs, {len(tpdo2)} times TPDO2")


@check
@covers("FX3U-BOOT-002 FX3U-BOOT-008 FX3U-HB-002 FX3U-NMT-013")
def npm_canopen_is_a_slave_of_the_fx3u_can():
    """Identity, start, PDOs each way, an emergency; killed, it is lost, and booted again when it comes back."""
    node_modules()
    path = fx3_plant("fx3u-can-master", 'node = 1\nobjects = { "1F80:00" = 1, "1F81:05" = 0x0D, "1F85:05" = 0x319, '
                     '"1F86:05" = 0x1234, "1F87:05" = 0x10002, "1F88:05" = 42, "1016:01" = 0x0005_1388, '
                     '"1400:01" = 0x185, "1800:01" = 0x4000_0205 }\nbuffer = { G26 = 0 }\n')
    with running(path) as plant:
        wait_started(plant, 1)
        host, port = host_port(plant.mc)
        slave = lambda: talking("node", HERE / "nmt_slave_peer.mjs", *host_port(plant.socketcand), "line1", "5")
        with Plc(host, int(port)) as plc:
            module = fx3u_can.Fx3uCan(plc)

            def booted(peer):
                peer.wait_line(lambda line: line == "state OPERATIONAL")
                until(lambda: module.g(605) == 5 and module.g(25) & 0xC301 == 0x8201, "the network is not Operational")

            def exchanged(peer, words):
                module.set_g(11000, *words)
                module.exchange()
                peer.wait_line(lambda line: line == "received " + " ".join(map(str, words)))
                inverted = [word ^ 0xFFFF for word in words]

                def arrived():
                    module.exchange()
                    return module.words(10000, 4) == inverted
                until(arrived, f"#10000 to #10003 are not {inverted}")

            with slave() as peer:
                booted(peer)
                exchanged(peer, [1, 2, 3, 4])
                exchanged(peer, [0xFFFF, 0x1234, 0, 0x8000])
                exchanged(peer, [3584, 0, 0, 0])
                until(lambda: module.g(29) & 0x2000, "#29 bit 13 is OFF: the peer's emergency did not come")
                module.exchange()
                require(module.words(750, 2) == [5, 0x5000], f"#750 has {module.words(750, 5)}")
                require(module.g(902) == 2, f"#902 = {module.g(902):04X}H")
                peer.process.kill()
                until(lambda: module.g(902) & 0x80 != 0, "#902 bit 7 is 0 after the peer was killed")
                require(module.g(29) & 0x0401 == 0x0401, f"#29 = {module.g(29):04X}H after the peer was killed")
            with slave() as peer:
                booted(peer)
                exchanged(peer, [5, 6, 7, 8])
                module.clear_errors()
                require(module.g(29) == 0, f"#29 = {module.g(29):04X}H")
        code, errors = plant.stop()
        require(code == 0, errors)
        frames = recorded(plant.trace)
        require(any(identifier == 0x081 and data[:2] == b"\x05\x8F" for identifier, data in frames), "no EMCY 8F05H")


@check
@covers("FX3U-BOOT-002 FX3U-BOOT-010")
def tshark_decodes_the_boot_of_three_devices_by_an_fx3u_can():
    path = scratch / "fx3u-can-boot.toml"
    devices = "".join(f'[[device]]\nnode = {node}\nname = "{name}"\neds = "{ROOT}/examples/devices/{name}.eds"\n'
                      for node, name in ((2, "io-block"), (3, "encoder"), (4, "drive")))
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n' + devices
                    + '[[plc]]\nfamily = "FX3"\nlisten = "127.0.0.1:0"\n[[plc.module]]\nmodel = "FX3U-CAN"\nposition = 0\nnode = 1\n'
                    'master = true\nslaves = "all"\nexchange = "20ms"\n'
                    'objects = { "1005:00" = 0x4000_0080, "1006:00" = 50_000, "1017:00" = 20 }\nwrite = { G11000 = 0x5A }\n')
    with running(path) as plant:
        plant.wait_operational([1, 2, 3, 4])
        host, port = host_port(plant.mc)
        with Plc(host, int(port)) as plc:
            module = fx3u_can.Fx3uCan(plc)
            require(module.g(25) & 0xC301 == 0x8201, f"#25 = {module.g(25):04X}H")
            require(list(module.nmt_states(1, 4).values()) == [5] * 4, f"#601 to #604 are {module.words(601, 4)}")
            module.command(0x000A, [0x5000, 0x0001, 0, 0], "emergency")
            module.set_g(26, 0)  # this program may be slower than the FROM/TO watchdog
            for value in range(20):
                module.set_g(11000, value)
                module.exchange()
                time.sleep(0.02)
        tshark_agrees(plant, "boot-up,NMT,SDO,PDO,SYNC,heartbeat,EMCY")


@check
@covers("FX3U-EX-001 FX3U-HB-006 FX3U-HB-007 FX3U-CIF-007 FX3U-CIF-011")
def example_program_of_the_fx3u_can_does_what_the_function_blocks_do():
    """Chapter 13, behind an FX3 over 3E frames and behind an FX5 over 1E frames."""
    example_program("program", "3E", 0)
    example_program("program-fx5", "1E", 1)


def example_program(name, frame, unit):
    with running(example_plant(name, folder=EXAMPLES, changes=[])) as plant:
        done = command(sys.executable, EXAMPLES / "program.py", *host_port(plant.mc), frame, unit)
        code, errors = plant.stop()
        require(code == 0, f"exit code {code}: {errors}")
    printed, frames = done.stdout, recorded(plant.trace)
    for line in ("40 cycles: 40 outputs came back", "analogue output 390", "SDO abort 05040000H",
                 "heartbeat lost: #901 = 0082H, #29 = 0401H", "cleared: #901 = 0002H, #29 = 0000H"):
        require(line in printed, f"{frame}: {line!r} is missing in:\n{printed}")
    in_order(frames, [
        (0x77F, "00"), (0x0FF, "00 62 01 34 30 30 58 46"), (0x701, "00"),       # CANopenInit
        (0x603, "2B 0C 10 00 00 00 00 00"), (0x603, "2F 0D 10 00 00 00 00 00"),  # NMTSlaveSettings
        (0x081, "00 62 01 34 30 30 58 46"), (0x000, "82 00"), (0x701, "00"),
        (0x603, "40 00 10 00 00 00 00 00"), (0x583, "43 00 10 00 91 01 0F 00"),
        (0x603, "2B 17 10 00 C8 00 00 00"), (0x583, "60 17 10 00 00 00 00 00"), (0x703, "7F"),  # heartbeats
        (0x603, "2B 11 64 01 01 00 00 00"), (0x583, "60 11 64 01 00 00 00 00"),  # SDOWrite
        (0x000, "01 00"), (0x203, "80 00"), (0x203, "81 00"), (0x203, "A7 00"),  # NMTRequestWrite, PDOWrite
        (0x000, "80 03"), (0x703, "7F"), (0x000, "02 03"), (0x703, "04"), (0x000, "01 03"),
        (0x603, "2B 17 10 00 00 00 00 00"), (0x081, "03 8F 11 00 00 00 00 00")])  # heartbeat lost
    outputs = [data[0] for identifier, data in frames if identifier == 0x203]
    require(outputs == list(range(0x80, 0xA8)), f"TPDO1 carried {outputs}")


@check
@covers("FX3U-TOOL-006")
def scan_finds_an_fx3u_can_as_the_configuration_tool_does():
    """15.3.1: all node-IDs, from one on, or a range; node-ID and product name."""
    with running(fx3_plant("fx3u-can-scan", 'node = 5')) as plant:
        wait_started(plant, 5)
        for words, wanted in (([], [5]), (["--nodes", "5-127"], [5]), (["--nodes", "6-127"], []), (["--nodes", "4-6"], [5]), (["--nodes", "1-4"], [])):
            done = on_bus(plant, "scan", "--json", "--timeout", ANSWER, *words, expect=0 if wanted else 1)
            found = [json.loads(line) for line in done.stdout.splitlines()]
            require([(node["node"], node["name"]) for node in found] == [(node, "FX3U-CAN") for node in wanted], f"{words}: {found}")
        require(plant.stop()[0] == 0, "exit code")


@check
@covers("FX3U-SPEC-010 FX3U-SPEC-011 FX3U-SPEC-012")
def words_of_an_fx3u_can_by_1e_frames_byte_by_byte():
    """0E and 0F of an FX5's port. An FX3U-ENET has no such commands: 50H."""
    port = 'listen = "127.0.0.1:0"\n[[plc.port]]\nlisten = "127.0.0.1:0"\nframe = "1E"'

    def talk(plant, unit):
        address = plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "MC protocol 1E")["address"]
        host, number = host_port(address)
        connection = socket.create_connection((host, int(number)), PATIENCE)

        def ask(command_code, bfm, count, data=b""):
            connection.sendall(struct.pack("<BBH", command_code, 0xFF, 10) + struct.pack("<I", 2 * bfm)[:3]
                               + struct.pack("<BH", 2 * count, unit) + data)
            return connection.recv(4096)
        return connection, ask

    with running(fx3_plant("fx3u-can-1e-fx3", port=port)) as plant:
        wait_started(plant)
        connection, ask = talk(plant, 0)
        with connection:
            require(ask(0x0E, 30, 1) == b"\x8e\x50", "0E of an FX3U-ENET")
        require(plant.stop()[0] == 0, "exit code")
    with running(fx3_plant("fx3u-can-1e-fx5", port=port, family="FX5", place="unit = 2")) as plant:
        wait_started(plant)
        connection, ask = talk(plant, 2)
        host, number = host_port(plant.mc)
        with connection, Plc(host, int(number)) as plc:
            module = fx3u_can.Fx3uCan(plc, unit=2)
            require(ask(0x0E, 30, 1) == b"\x8e\x00\x02\x1c", "#30 is not 7170")
            require(ask(0x0F, 70, 2, struct.pack("<2H", 700, 600)) == b"\x8f\x00", "0F")
            require(ask(0x0E, 70, 2) == b"\x8e\x00" + struct.pack("<2H", 700, 600), "#70 and #71")
            require(module.words(70, 2) == [700, 600], "U2\\G70 is another word")
            require(ask(0x0F, 21, 1, b"\x01\x00") == b"\x8f\x00", "0F of a bad value")
            # Alone on its bus it is error passive sooner or later, bit 14.
            shown = (module.words(21, 1), module.g(29) & ~0x4000, module.g(39))
            require(shown == ([405], 0x0041, 21), f"#21 = 1: #21, #29, #39 are {shown}")
            # A command: an SDO read of the own 1018:02.
            ask(0x0F, 1001, 3, struct.pack("<3H", 0, 0x1018, 2))
            ask(0x0F, 1000, 1, struct.pack("<H", 4))
            until(lambda: ask(0x0E, 1000, 1)[2:] == b"\x05\x00", "#1000 is not 0005H")
            require(ask(0x0E, 1004, 3)[2:] == struct.pack("<3H", 4, 7170, 0), "#1004 to #1006")
        require(plant.stop()[0] == 0, "exit code")
