"""Checks of what happens on a bus: the commands that join one (sdo, nmt, scan, lss, master) on the bus of another process."""
import contextlib
import json
import pathlib
import signal
import subprocess
import threading

from kit import (ANSWER, HERE, PATIENCE, PYTHON, ROOT, RawClient, Skip, check, command, first_plant, host_port, in_machine, program,
                 require, running, scratch, talking, tier)

DEVICE = HERE / "interop_device.eds"
PATTERN = bytes((i * 7 + (i >> 8)) & 0xFF for i in range(1000))  # as the JavaScript peers make it


def device_plant(*devices, bit_rate=1_000_000):
    """A plant of devices alone: (node, EDS, further TOML) each."""
    text = (f'[plant]\nname = "devices"\n[[bus]]\nname = "line1"\nbit_rate = {bit_rate}\n'
            'serve = "socketcand:127.0.0.1:0"\n')
    for node, eds, more in devices:
        text += f'[[device]]\nnode = {node}\neds = "{eds}"\n{more}\n'
    path = scratch / "devices.toml"
    path.write_text(text)
    return running(path, has_plc=False)


def on_bus(plant, *words, name=False, **options):
    """`canopus WORDS --bus` the plant's. Whoever must answer has time: only scans wait for silence."""
    address = f"socketcand:{plant.socketcand}" + ("/line1" if name else "")
    if "--timeout" not in words and words[0] in ("sdo", "nmt"):
        words += ("--timeout", f"{PATIENCE}s")
    return command(program, *words, "--bus", address, timeout=5 * PATIENCE, **options)


@contextlib.contextmanager
def peer(plant, name, *words):
    """A script that stays on the bus; once it said "ready" the check goes on. Then its standard input ends, and it must end
    well."""
    with talking("node", HERE / name, *host_port(plant.socketcand), "line1", *words) as script:
        script.wait_line(lambda line: line.startswith("ready"))
        yield script
        script.process.stdin.close()
        script.require_end()


# --- the commands on a plant's bus


@check
def sdo_command_reads_and_writes_a_device():
    with device_plant((5, DEVICE, "")) as plant:
        require(on_bus(plant, "sdo", "read", "5", "1018:02", "--type", "u32").stdout == "1018:02  1280  00000500H\n",
                on_bus(plant, "sdo", "read", "5", "1018:02", "--type", "u32").stdout)
        require('"Interop device"' in on_bus(plant, "sdo", "read", "5", "1008", name=True).stdout, "1008H is not shown")
        for flags in ([], ["--block"]):
            path, back = scratch / "domain", scratch / "back"
            path.write_bytes(PATTERN * 9)
            on_bus(plant, "sdo", "write", "5", "2001", "--file", path, *flags)
            on_bus(plant, "sdo", "read", "5", "2001", "--file", back, *flags)
            require(back.read_bytes() == path.read_bytes(), f"the domain comes back otherwise {flags}")
            path.write_bytes(b"")
            back.write_bytes(b"")
        for kind, value, shown in (("u16", "0x1F4", "500  01F4H"), ("u16", "1000", "1000  03E8H")):
            on_bus(plant, "sdo", "write", "5", "2003", value, "--type", kind)
            require(shown in on_bus(plant, "sdo", "read", "5", "2003", "--type", kind).stdout, f"2003H is not {shown}")
        on_bus(plant, "sdo", "write", "5", "2000", "longer than four bytes", "--type", "text")
        line = json.loads(on_bus(plant, "sdo", "read", "5", "2000", "--type", "text", "--json").stdout)
        require(line["value"] == "longer than four bytes" and line["node"] == 5, str(line))
        on_bus(plant, "sdo", "write", "5", "2004", "-1.5", "--type", "f32")
        require("-1.5" in on_bus(plant, "sdo", "read", "5", "2004", "--type", "f32").stdout, "2004H is not -1.5")


@check
def sdo_command_with_block_transfers_in_blocks_or_fails():
    """Node 40 is a script: it answers a block upload of 2000H expedited, and refuses all others."""
    with device_plant((5, DEVICE, "")) as plant:
        client, heard = RawClient(plant), []

        def answer():
            with contextlib.suppress(OSError, AssertionError):  # the plant ended
                while True:
                    identifier, data = client.frame()
                    heard.append((identifier, data))
                    if identifier != 0x628 or data[0] == 0x80:
                        continue
                    if data[0] >> 5 == 5 and data[1:3] == b"\x00\x20":
                        client.send(0x5A8, bytes.fromhex("4F 00 20 00 05 00 00 00"))
                    else:
                        client.send(0x5A8, bytes((0x80,)) + data[1:4] + bytes.fromhex("01 00 04 05"))
        threading.Thread(target=answer, daemon=True).start()
        for words, told in (
                (("read", "40", "2000"), "node 40, 2000:00: it answers the block upload with an ordinary one; "
                                         "without --block it can be read"),
                (("read", "40", "2001"), "abort 05040001H: command specifier invalid or unknown; "
                                         "without --block it may work"),
                (("write", "40", "2003", "500", "--type", "u16"), "without --block it may work")):
            done = on_bus(plant, "sdo", *words, "--block", expect=1)
            require(told in done.stderr, f"{words}: {done.stderr}")
        require((0x628, bytes.fromhex("80 00 20 00 01 00 04 05")) in heard, f"the client did not abort: {heard}")
        on_bus(plant, "sdo", "write", "5", "2003", "500", "--type", "u16", "--block")
        require("500  01F4H" in on_bus(plant, "sdo", "read", "5", "2003", "--type", "u16", "--block").stdout, "2003H")
        require("00000500H" in on_bus(plant, "sdo", "read", "5", "1018:02", "--type", "u32", "--block").stdout, "1018:02")
        started = {data[0] >> 5 for identifier, data in heard if identifier == 0x605 and data[0] != 0x80 and data[1:3] == b"\x03\x20"}
        require(started <= {5, 6}, f"2003H of node 5 went otherwise than in blocks: {heard}")


@check
def sdo_command_tells_aborts_in_hex_and_words():
    with device_plant((5, DEVICE, "")) as plant:
        for words, told in (
                (("read", "5", "2999"), "node 5, 2999:00: abort 06020000H: object does not exist"),
                (("read", "5", "1018:09"), "node 5, 1018:09: abort 06090011H: "),
                (("read", "5", "2002"), "node 5, 2002:00: abort 06010001H: "),
                (("write", "5", "1000", "1", "--type", "u32"), "node 5, 1000:00: abort 06010002H: "),
                (("write", "5", "2003", "1001", "--type", "u16"), "node 5, 2003:00: abort 06090031H: "),
                (("write", "5", "2003", "9", "--type", "u16"), "node 5, 2003:00: abort 06090032H: "),
                (("read", "6", "1000", "--timeout", "50ms"), "node 6, 1000:00: no answer within 50.0 ms")):
            done = on_bus(plant, "sdo", *words, expect=1)
            require(told in done.stderr, f"{words}: {done.stderr}")
        line = json.loads(on_bus(plant, "sdo", "read", "5", "2999", "--json", expect=1).stdout)
        require(line["abort"] == "06020000", str(line))
        for words in (("read", "128", "1000"), ("read", "5", "xyz"), ("read", "5", "1000", "--type", "u99"),
                      ("write", "5", "2003", "99999", "--type", "u16"), ("write", "5", "2003")):
            on_bus(plant, "sdo", *words, expect=2)


@check
def a_bus_that_cannot_be_joined_is_told_with_its_address():
    with device_plant((5, DEVICE, "")) as plant:
        for address, told in ((f"socketcand:{plant.socketcand}/line7", "does not open the bus \"line7\""),
                              ("socketcand:127.0.0.1:1", "Connection refused"),
                              ("socketcan:nosuchcan9", "socketcan:nosuchcan9: ")):
            done = command(program, "sdo", "read", "5", "1000", "--bus", address, expect=1)
            require(told in done.stderr, f"{address}: {done.stderr}")
        done = command(program, "sdo", "read", "5", "1000", "--bus", "line1", expect=2)
        require("socketcand:HOST:PORT/BUS" in done.stderr, done.stderr)


@check
def a_bus_without_another_node_is_told():
    """The only device of the plant listens and drives nothing: no node acknowledges what the commands send. Each has a plant of
    its own: a client that left with frames unsent is still on the bus for a second, and acknowledges."""
    for words in (("scan", "--nodes", "1-16", "--timeout", ANSWER), ("sdo", "read", "5", "1000", "--timeout", ANSWER),
                  ("nmt", "start", "5", "--wait", "--timeout", ANSWER), ("lss", "identify", "--timeout", ANSWER),
                  ("master", network_file("node = 5"), "--for", "8s", "--timeout", ANSWER)):
        with device_plant((5, DEVICE, "listen_only = true")) as plant:
            done = on_bus(plant, *words, expect=1)
            require(done.stderr.count("no acknowledgement: no other node on this bus") == 1, f"{words}: {done.stderr}")
            plant.wait(lambda e: e["event"] == "unacknowledged" and e["name"] == "socketcand")


@check
def nmt_command_moves_a_node_through_its_states():
    with device_plant((5, DEVICE, "")) as plant:
        for word, shown in (("start", "node 5 is operational"), ("stop", "node 5 is stopped"),
                            ("preop", "node 5 is pre-operational"), ("reset-comm", "node 5 has booted"),
                            ("start", "node 5 is operational"), ("reset", "node 5 has booted")):
            done = on_bus(plant, "nmt", word, "5", "--wait")
            require(done.stdout == shown + "\n", f"{word}: {done.stdout}")
        require(on_bus(plant, "nmt", "start", "all").stdout == "start sent to all nodes\n", "nmt start all")
        plant.wait_operational([5])
        done = on_bus(plant, "nmt", "start", "6", "--wait", "--timeout", "300ms", expect=1)
        require("node 6 does not show operational within 300.0 ms" in done.stderr, done.stderr)


@check
def nmt_command_by_the_master():
    """The master resets a slave, and boots it anew; who is no active master refuses."""
    with first_plant() as plant:
        plant.wait_operational([2, 3, 4])
        done = on_bus(plant, "nmt", "reset-comm", "3", "--master", "1", "--wait", "--json")
        require(json.loads(done.stdout) == {"command": "reset-comm", "node": 3, "master": 1, "state": "initialising"}, done.stdout)
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 3 and e["step"] == "booted" and e["t"] > 1.5)
        require(on_bus(plant, "nmt", "stop", "4", "--master", "1").stdout == "stop for node 4 requested of master 1\n", "stop")
        plant.wait(lambda e: e["event"] == "nmt" and e["node"] == 4 and e["state"] == "stopped")
        require(on_bus(plant, "nmt", "preop", "4", "--master", "1").stdout == "preop for node 4 requested of master 1\n", "preop")
        before = plant.wait(lambda e: e["event"] == "nmt" and e["node"] == 4 and e["state"] == "pre-operational" and e["t"] > 1.5)["t"]
        on_bus(plant, "sdo", "write", "4", "6067", "55", "--type", "u32")
        require(on_bus(plant, "nmt", "reset", "4", "--master", "1", "--wait").stdout == "node 4 has booted\n", "reset")
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e["step"] == "booted" and e["t"] > before)
        require(json.loads(on_bus(plant, "sdo", "read", "4", "6067", "--type", "u32", "--json").stdout)["value"] == 100, "not reset, its communication alone")
        done = on_bus(plant, "nmt", "stop", "4", "--json")
        require(json.loads(done.stdout) == {"command": "stop", "node": 4}, done.stdout)  # of no master
        refused = on_bus(plant, "nmt", "start", "4", "--master", "3", expect=1)
        require("master 3 did not take 05H for 1F82:04 (request NMT): abort 06020000H: object does not exist" in refused.stderr, refused.stderr)
        wrong = on_bus(plant, "nmt", "start", "4", "--master", "128", expect=2)
        require('--master: "128" is not a node; expected a node-ID 1 to 127' in wrong.stderr, wrong.stderr)
        require(on_bus(plant, "nmt", "stop", "all", "--master", "1").stdout == "stop for all nodes requested of master 1\n", "all")
        plant.wait(lambda e: e["event"] == "nmt" and e["node"] == 2 and e["state"] == "stopped")


@check
def scan_finds_the_nodes_of_the_first_plant():
    with first_plant() as plant:
        nodes = [json.loads(line) for line in on_bus(plant, "scan", "--json", "--timeout", ANSWER).stdout.splitlines()]
        require([n["node"] for n in nodes] == [1, 2, 3, 4], str(nodes))
        require(all(n["state"] == "operational" for n in nodes), str(nodes))
        require([n["device_type"] for n in nodes] == [0x195, 0x000F0191, 0x00010196, 0x00020192], str(nodes))
        require(nodes[2]["name"] == "Canopus encoder" and nodes[2]["product"] == 0x406, str(nodes[2]))
        require("4 nodes found" in on_bus(plant, "scan", "--timeout", ANSWER).stdout, "the table does not end with the count")


@check
def scan_learns_states_by_heartbeat_and_by_guarding():
    quiet = 'objects = { "1017:00" = 0 }'
    with device_plant((5, DEVICE, ""), (6, DEVICE, quiet), (7, DEVICE, "")) as plant:
        on_bus(plant, "nmt", "start", "6")
        on_bus(plant, "nmt", "stop", "7", "--wait")
        said = on_bus(plant, "scan", "--json", "--nodes", "1-16", "--timeout", ANSWER).stdout
        nodes = {n["node"]: n for n in map(json.loads, said.splitlines())}
        require({n: nodes[n]["state"] for n in nodes}
                == {5: "pre-operational", 6: "operational", 7: "stopped"}, str(nodes))
        require(not nodes[7]["answers_sdo"], "a stopped node answered SDO")
        on_bus(plant, "scan", "--nodes", "20-30", "--timeout", "50ms", expect=1)


def network_file(*slaves, master=""):
    path = scratch / "network.toml"
    path.write_text(f"[master]\n{master}\n" + "".join(f"[[slave]]\n{text}\n" for text in slaves))
    return path


@check
def master_boots_a_network_without_a_plc():
    devices = ROOT / "examples/devices"
    with device_plant((2, devices / "io-block.eds", ""), (3, devices / "encoder.eds", ""),
                      (5, DEVICE, "")) as plant:
        network = network_file(
            f'node = 2\nname = "io"\neds = "{devices}/io-block.eds"\nconsumer_heartbeat_time = "5s"\n'
            'objects = { "1017:00" = 200 }',
            f'node = 3\neds = "{devices}/encoder.eds"\nguard_time = "1s"\nobjects = {{ "1017:00" = 0 }}',
            f'node = 5\neds = "{DEVICE}"\nobjects = {{ "2000:00" = "written by the master", "2003:00" = 123 }}',
            'node = 9\nname = "spare"\nmandatory = false')
        slowly = ("--timeout", ANSWER)
        done = on_bus(plant, "master", network, *slowly)
        require("node 2 (io): booted" in done.stdout and "3 of 4 slaves booted" in done.stdout, done.stdout)
        require("node 9 (spare): absent (optional)" in done.stdout, done.stdout)
        for node in (2, 3, 5):
            plant.wait_operational([node])
        require('"written by the master"' in on_bus(plant, "sdo", "read", "5", "2000", "--type", "text").stdout,
                "the setting did not arrive")
        events = [json.loads(line) for line in on_bus(plant, "master", network, "--json", *slowly).stdout.splitlines()]
        require(events[-1] == {**events[-1], "event": "summary", "slaves": 4, "booted": 3, "good": True}, str(events[-1]))
        require({e["node"] for e in events if e["event"] == "booted"} == {2, 3, 5}, str(events))


@check
def master_tells_why_a_slave_does_not_boot():
    # A heartbeat that is far longer in coming than a busy machine lets the master wait.
    with device_plant((5, DEVICE, 'objects = { "1017:00" = 5000 }')) as plant:
        for text, told in (
                ("node = 5\nvendor = 0x195", "1018:01 reads 00000000H, expected 00000195H"),
                (f'node = 5\neds = "{DEVICE}"\ndevice_type = 0x191', "1000:00 reads 00000000H, expected 00000191H"),
                ("node = 8", "Check that the device is powered and connected"),
                (f'node = 5\neds = "{DEVICE}"\nobjects = {{ "2003:00" = 5000 }}', "2003:00: abort 06090031H"),
                ("node = 5\nvendor = 0\nconsumer_heartbeat_time = \"100ms\"", "its producer heartbeat time 1017H")):
            done = on_bus(plant, "master", network_file(text), "--for", "60s", "--timeout", ANSWER, expect=1)
            require(told in done.stdout, f"{text}:\n{done.stdout}{done.stderr}")
        path = network_file("node = 200")
        done = on_bus(plant, "master", path, expect=2)
        require(f"{path}:4:8: node = 200: a node-ID is 1 to 127" in done.stderr, done.stderr)


@check
def flying_masters_stand_by_and_take_over():
    """Two processes: the better one boots the slave; when it ends, the other one does."""
    timing = ('[master.times]\nflying_heartbeat = "100ms"\nflying_consumer_time = "4s"\n'
              '[master.flying]\npriority = {}\nnegotiation_delay = "100ms"\npriority_slot = "300ms"\ndevice_slot = "1ms"\n')
    paths = {}
    for node, priority in ((11, 0), (12, 1)):
        paths[node] = scratch / f"flying{node}.toml"
        paths[node].write_text(f"[master]\nnode = {node}\n{timing.format(priority)}[[slave]]\nnode = 5\n")
    active_now, booted = "this node is the active master", "node 5: booted"
    with device_plant((5, DEVICE, "")) as plant:
        master = lambda node: talking(program, "master", paths[node], "--bus", f"socketcand:{plant.socketcand}", "--stay")
        with master(12) as standby, master(11) as active:
            active.wait_line(lambda line: line.endswith(active_now))
            active.wait_line(lambda line: line.endswith(booted))
            standby.wait_line(lambda line: line.endswith("node 11 is the active master, this one stands by"))
            active.process.send_signal(signal.SIGINT)
            active.require_end()
            standby.wait_line(lambda line: line.endswith(active_now))
            standby.wait_line(lambda line: line.endswith(booted))
            standby.process.send_signal(signal.SIGINT)
            standby.require_end()
            for ended in (active, standby):
                require("node 5: booted, operational" in ended.said, "\n".join(ended.said))


@check
def a_cpp_program_on_the_rooms_boots_a_network():
    example = pathlib.Path(program).parent / "examples" / "example_cpp_master"
    with device_plant((2, ROOT / "examples/devices/io-block.eds", ""), (3, ROOT / "examples/devices/encoder.eds", "")) as plant:
        bus = f"socketcand:{plant.socketcand}"
        said = command(example, bus, 2, 3).stdout
        for wanted in ("node 2: asking for 1000H", "node 3: booted", 'node 2 is a "Canopus I/O block"', "Node 3: booted"):
            require(wanted in said, f"no {wanted!r} in {said}")
        missing = command(example, bus, 2, 9, expect=1).stdout
        require("Node 9: failed (B, no answer to 1000H)" in missing, f"why node 9 does not boot: {missing}")
    refused = command(example, "somewhere", 2, expect=2).stderr
    require("somewhere" in refused, f"a wrong address is told: {refused}")


@check
def a_cpp_slave_serves_foreign_programs():
    example = pathlib.Path(program).parent / "examples" / "example_cpp_slave"
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python3-can is not installed")
    with first_plant() as plant:
        bus = f"socketcand:{plant.socketcand}"
        with talking(example, bus, 9, ROOT / "examples/devices/io-block.eds") as slave:
            slave.wait_line(lambda line: line.endswith("Pre-operational"))
            command(PYTHON, HERE / "socketcand_python_can.py", *host_port(plant.socketcand), "line1", "9", "0x000F0191")
            slave.wait_line(lambda line: line.endswith("Operational") and "Pre" not in line)
            on_bus(plant, "sdo", "write", 9, "6200:1", "0x5A", "--type", "u8")
            slave.wait_line(lambda line: line.endswith("outputs 5A"))
            said = on_bus(plant, "sdo", "read", 9, "6000:1", "--type", "u8").stdout
            require("5A" in said or "90" in said, said)
            slave.process.send_signal(signal.SIGINT)
            slave.require_end()
    refused = command(example, "somewhere", 2, "nothing.eds", expect=2).stderr
    require("somewhere" in refused, f"a wrong address is told: {refused}")
    require("usage" in command(example, bus, 200, "nothing.eds", expect=2).stderr, "a node-ID beyond 127 is refused")


@check
@tier("machine")
def commands_join_socketcan():
    """In a virtual machine with a kernel that has SocketCAN: a virtual interface, and two controllers on one bus."""
    script = HERE / "socketcan_commands.sh"
    for theirs, ours in (("vcan0", "vcan0"), ("can0", "can1")):
        done = in_machine("bash", script, program, theirs, ours)
        require("socketcan ok" in done.stdout, f"{theirs} to {ours}:\n{done.stdout[-2000:]}\n{done.stderr[-2000:]}")
