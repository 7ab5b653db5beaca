"""Checks of the services that `canopus gateway` has beside SDO and NMT: LSS and PDOs, with tshark or python-can as the judge."""
import shutil
import subprocess

from foreign_stack_checks import lss_example
from gateway_checks import DEVICE, Client, gateway, gateway_on, patient
from kit import HERE, PYTHON, Skip, attempts, check, command, program, require, running, scratch, silence

TIME_OUT = "ERROR:103 #time-out"


def lss_frames(trace):
    """What tshark reads of the requests of the LSS master and the answers of the devices."""
    words = ["tshark", "-r", trace, "-d", "can.subdissector,canopen", "-Y", "can.id == 0x7e5 || can.id == 0x7e4", "-T", "fields"]
    fields = ["cs", "addr.vendor", "addr.product", "addr.revision", "addr.serial", "switch.mode", "nid", "conf_id.err_code",
              "bt.tbl_selector", "bt.tbl_index", "abt_delay"]
    for field in fields:
        words += ["-e", f"canopen.lss.{field}"]
    lines = command(*words, "-e", "_ws.malformed").stdout.splitlines()
    number = lambda text: int(text, 0) if text else None
    return [dict(zip(fields + ["malformed"], map(number, line.split("\t")))) for line in lines]


@check
@attempts(3)
def gateway_configures_devices_by_lss():
    path = lss_example("plant.toml", "gateway-lss")
    valves = "0 0x401 0x10000 0x0A02"
    with running(path, has_plc=False) as plant, gateway_on(plant) as (port, _server):
        client = patient(port)
        client.ask("[1] lss_ident_nonconf", "[1] OK")
        client.ask("[2] lss_switch_glob 0", "[2] OK")
        client.ask(f"[3] lss_switch_sel {valves}", "[3] OK")
        client.ask("[4] lss_inquire_addr", "[4] 0x00000000 0x00000401 0x00010000 0x00000A02")
        client.ask("[5] lss_inquire_addr 3", "[5] 0x00000A02")
        client.ask("[6] lss_get_node", "[6] 255")
        client.ask("[7] lss_set_node 30", "[7] OK")
        client.ask("[8] lss_get_node", "[8] 255")  # it has its node-ID from the next switch to waiting on
        client.ask("[9] lss_conf_bitrate 0 5", "[9] ERROR:503 #LSS bit rate not supported")
        client.ask("[10] lss_store", "[10] OK")
        client.say("[11] lss_switch_glob 0")
        lines = {client.line(), client.line()}
        require(lines == {"[11] OK", "1 30 BOOT_UP"}, str(lines))
        client.ask("[12] 30 r 0x1018 4 x32", "[12] 0x00000A02")
        client.ask("[13] lss_inquire_addr", f"[13] {TIME_OUT}")
        client.ask("[14] lss_switch_sel 0 0x401 0x10000 99", f"[14] {TIME_OUT}")
        client.ask("[15] lss_identity 0 0x401 0 0xFFFFFFFF 0 0xFFFFFFFF", "[15] OK")
        client.ask("[16] _lss_slowscan 0 0x401 0x10000 0x10000 0xA00 0xA03", "[16] 0x00000000 0x00000401 0x00010000 0x00000A01")
        client.ask("[17] lss_switch_glob 0", "[17] OK")
        client.say(f"[18] lss_allnodes {silence(50).removesuffix('ms')} 10 1")
        while (line := client.line()).startswith("1 "):
            pass
        require(line == "[18] OK, found 2 nodes starting at node ID 10.", line)
        client.ask("[19] lss_ident_nonconf", f"[19] {TIME_OUT}")
        client.ask("[20] 2 lss_store", "[20] ERROR:106 #unsupported network")
        code, errors = plant.stop()
        require(code == 0 and errors == "", f"exit code {code}: {errors}")
        if not shutil.which("tshark"):
            raise Skip("tshark is not installed: the frames were not judged")
        frames = lss_frames(plant.trace)
    require(not any(f["malformed"] for f in frames), "tshark finds a malformed frame")
    # The whole conversation up to the node-ID, but for the answers of those that have none (50H): all of them may come.
    wanted = [0x4C, 0x04, 0x40, 0x41, 0x42, 0x43, 0x44, 0x5A, 0x5A, 0x5B, 0x5B, 0x5C, 0x5C, 0x5D, 0x5D, 0x5D, 0x5D, 0x5E, 0x5E,
              0x11, 0x11, 0x5E, 0x5E, 0x13, 0x13, 0x17, 0x17, 0x04]
    found = [f["cs"] for f in frames if f["cs"] != 0x50][:len(wanted)]
    require(found == wanted, f"LSS commands: {[hex(c) for c in found]}")
    asked = {(f["cs"], f[name]) for f in frames for name in f if f[name] is not None}
    for each in ((0x41, 0x401), (0x42, 0x10000), (0x43, 0x0A02), (0x11, 30), (0x11, 10), (0x11, 11), (0x13, 5)):
        require(each in asked, f"no frame with command {each[0]:#x} and {each[1]:#x}")


@check
@attempts(3)
def gateway_changes_the_bit_rate_of_devices():
    path = lss_example("plant.toml", "gateway-rate")
    with running(path, has_plc=False) as plant, gateway_on(plant) as (port, _server):
        client = Client(port)
        other = Client(port)
        client.ask("[1] lss_switch_sel 0 0x406 0x10000 1", "[1] OK")
        client.ask("[2] lss_conf_bitrate 0 2", "[2] OK")
        # The gateway follows: the bus is a simulated one, where each client is a controller of its own.
        client.say("[3] lss_activate_bitrate 1500")
        plant.wait(lambda e: e["event"] == "lss" and e["bit_rate"] == 500000)
        other.ask("[4] 0 start", "[4] ERROR:303 #CAN buffer overflow")
        answer = client.line()
        require(answer == "[3] OK", answer)
        other.ask("[5] 0 start", "[5] OK")
        client.ask("[6] init 3", "[6] OK")
        plant.stop()
        if not shutil.which("tshark"):
            raise Skip("tshark is not installed: the frames were not judged")
        rates = [f for f in lss_frames(plant.trace) if f["cs"] in (0x13, 0x15)]
    require((rates[0]["bt.tbl_selector"], rates[0]["bt.tbl_index"]) == (0, 2), str(rates))
    require(rates[-1]["abt_delay"] == 1500, str(rates))


@check
def gateway_has_the_size_of_a_command():
    with gateway() as (port, _server):
        client = patient(port)
        client.ask("[1] set command_size 32", "[1] OK")
        client.ask("[2] 5 r 0x1018 2 u32 " + " " * 11, "[2] 1280")
        client.ask("[3] 5 r 0x1018 2 u32 " + " " * 12, "ERROR:101 #syntax error")
        client.ask("[4] set command_size 65537", "[4] ERROR:600 #running out of memory")
        client.ask("[5] set command_size 31", "[5] ERROR:101 #syntax error")
        client.ask("[4] set command_size 65536", "[4] OK")
        client.ask("[4294967295] 5 r 0x1018 2 u32", "[4294967295] 1280")
        client.ask("[4294967296] 5 start", "ERROR:101 #syntax error")
        client.ask("[6] 5 w 0x2000 0 vs " + "x" * 60000, "[6] OK")
        client.ask("[7] 5 r 0x2000 0 vs", '[7] "' + "x" * 60000 + '"')
        client.ask("[8] set sdo_timeout 65536", "[8] ERROR:101 #syntax error")
        client.ask("[9] init 5", "[9] ERROR:100 #request not supported")


@check
def python_can_hears_and_asks_the_pdos_of_the_gateway():
    for module in ("can", "msgpack"):
        if subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True).returncode != 0:
            raise Skip(f"python3-{module} is not installed")
    if not shutil.which("unshare") or subprocess.run(["unshare", "-n", "true"], capture_output=True).returncode != 0:
        raise Skip("no network namespaces: unshare -n is not permitted")
    path = scratch / "gateway-multicast.toml"
    path.write_text('[plant]\nname = "gateway"\n[[bus]]\nname = "line1"\nbit_rate = 1000000\nlink = "udp-multicast:239.74.163.7:43200"\n'
                    f'[[device]]\nnode = 5\neds = "{DEVICE}"\n')
    done = subprocess.run(["unshare", "-n", PYTHON, HERE / "gateway_multicast.py", program, path], capture_output=True, text=True,
                          errors="replace", timeout=600)
    require(done.stdout.endswith("multicast ok\n"), f"{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
