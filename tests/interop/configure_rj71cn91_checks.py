"""Checks of `canopus configure` on an RJ71CN91: its requests go by Y17, Y1F and Y02. A Python client of the MC protocol looks into
the module; the tool's own reading is no witness of its writing."""
import json
import re

from configure_checks import DEVICE, state, stop_cpu, tool
from kit import ROOT, check, command, covers, host_port, program, require, running, scratch
from module_checks import me3can1q  # its words, signals and commands are the same
from canopus_plc import Plc  # noqa: E402


def rack(name, position=0):
    """The module with factory settings, and one device on its bus."""
    path = scratch / f"{name}.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                    f'[[device]]\nnode = 3\nname = "io-block"\neds = "{DEVICE}"\n'
                    f'[[plc]]\nname = "plc1"\nfamily = "iQ-R"\nlisten = "127.0.0.1:0"\nstore = "{scratch}/{name}-store"\n'
                    f'[[plc.module]]\nmodel = "RJ71CN91"\nhead = {position * 16}\nrestart_time = "100ms"\n')
    return path


def new(name, *settings, number=0):
    path = scratch / f"{name}.xml"
    path.unlink(missing_ok=True)
    tool(None, "new", path, "--module", "RJ71CN91", "--number", str(number))
    for window, *fields in settings:
        tool(None, "set", path, window, *fields)
    return path


def module_of(plant, position=0):
    host, port = host_port(plant.mc)
    module = me3can1q.Me3Can1Q(Plc(host, int(port)), position * 16)
    module.wait_ready()
    return module


def number(module, index, sub, node=0):
    return int.from_bytes(module.sdo_read(node, index, sub), "little")


def cut_power(plant):
    plant.process.kill()
    plant.process.wait()


@check
@covers("RJ71-TOOL-002 RJ71-TOOL-003 RJ71-TOOL-010")
def configure_writes_an_rj71cn91_in_stop_and_it_stays():
    path = new("rj71-write", ("basic", "Node ID=5", "Baud-Rate=500", "SDO timeout=1500"), ("tpdo/256", "valid=Selected",
               "CAN-ID (11-bit)=0x57F", "Inhibit time=65535", "map=A104:08:16 A1C0:01:32"), ("rpdo/1", "map=A580:01:16 0005:00:8"),
               ("master", "NMT master=Selected", "NMT master priority=High", "Start all nodes delay=700", "Boot time=4000"),
               ("slave/3", "NMT slave=Selected", "NMT boot slave=Selected", "Retry factor=3", "Guard time=150"),
               ("consumer/3", "Consumer heartbeat time=1500"), ("producer", "Producer heartbeat time=800"), number=2)
    with running(rack("rj71-write", 2)) as plant:
        module = module_of(plant, 2)
        said = tool(plant, "write", path).stdout
        require("Node ID (G27): device 127, project 5" in said and "nothing is written without --yes" in said, said)
        require("is in RUN" in tool(plant, "write", path, "--yes", expect=3).stderr and module.g(27) == 127, "written in RUN")
        stop_cpu(plant)
        # A program that was broken off has left its request: the tool takes it away first.
        module.y(0x17, True)
        said = tool(plant, "write", path, "--yes").stdout
        require("read back: the same" in said, said)
        require([module.g(n) for n in (24, 27, 70, 71)] == [500, 5, 700, 1500], "the words")
        wanted = {(0x18FF, 1): 0x4000057F, (0x18FF, 3): 65535, (0x1AFF, 0): 2, (0x1AFF, 1): 0xA1040810, (0x1AFF, 2): 0xA1C00120,
                  (0x1600, 0): 2, (0x1600, 2): 0x00050008, (0x1F80, 0): 1, (0x1F90, 3): 0, (0x1F89, 0): 4000,
                  (0x1F81, 3): 0x00960305, (0x1016, 1): 0x000305DC, (0x1017, 0): 800}
        for (index, sub), value in wanted.items():
            require(number(module, index, sub) == value, f"{index:04X}H:{sub:02X} is {number(module, index, sub):X}H")
        require(not any(module.x(signal) for signal in (0x02, 0x17, 0x1F)), "requests are left")
        require("nothing to write" in tool(plant, "write", path, "--yes").stdout, "a second time")
        cut_power(plant)
    with running(rack("rj71-write", 2)) as plant:                                    # the flash ROM has it
        module = module_of(plant, 2)
        require([module.g(n) for n in (24, 27, 70, 71)] == [500, 5, 700, 1500], "the words after the power was cut")
        require(number(module, 0x18FF, 1) == 0x4000057F, "TPDO256 after the power was cut")
        other = new("rj71-read", number=2)
        tool(plant, "read", other)
        for window in ("basic", "master", "slave", "consumer", "producer"):
            require(tool(None, "show", other, window).stdout == tool(None, "show", path, window).stdout, window)
        shown = tool(None, "show", other, "tpdo").stdout
        require("PDO number 256 (tpdo/256)" in shown and "Buffer Memory Area Unsigned16, Un\\G14023" in shown, shown)
        # What the module refuses ends it, and is not told as written.
        stop_cpu(plant)
        tool(None, "set", path, "rpdo/2", "map=6000:01:8")
        failed = tool(plant, "write", path, "--part", "rpdo", "--yes", expect=1)
        require("1601:01" in failed.stderr and "abort" in failed.stderr and "read back" not in failed.stdout, failed.stderr)
        require("of 1 to 256" in tool(plant, "write", path, "--pdos", "257", expect=2).stderr, "--pdos 257")


@check
@covers("RJ71-TOOL-006 RJ71-TOOL-007 RJ71-TOOL-008 RJ71-TOOL-011")
def configure_reaches_an_rj71cn91s_network():
    path = new("rj71-online", ("basic", "Node ID=127"), ("node/3", "Node name=Block \x22A\x22"), ("node/127", "Node name=Master"),
               ("master", "NMT master=Selected"))
    with running(rack("rj71-online")) as plant:
        module = module_of(plant)
        for words, wanted in (([], 2), (["--nodes", "3-"], 2), (["--nodes", "4-9"], 0), (["--nodes", "3-3"], 1)):
            said = tool(plant, "scan", "--json", *words).stdout
            require(said.count('"node":') == wanted, f"{words}: {said}")
        require("SDO_READ_SUCCESS\n  hexadecimal    0x00000401\n  decimal        1025\n" in tool(plant, "sdo-read", "3", "1018:02").stdout,
                "sdo-read")
        require("SDO_WRITE_SUCCESS" in tool(plant, "sdo-write", "3", "1017", "500").stdout, "sdo-write")
        require(number(module, 0x1017, 0, 3) == 500, "the device's heartbeat")
        require("abort 06010002H" in tool(plant, "sdo-write", "3", "1000", "1", "--length", "BYTE_LENGTH_4", expect=1).stderr, "a refused one")
        # Hardware data of the listed nodes; the module has no serial number.
        nodes = [json.loads(line) for line in tool(plant, "nodes", path, "--json").stdout.splitlines()]
        require([(n["node"], n["name"], n["Device name"], n["Product code"], n["Serial number"]) for n in nodes] ==
                [(3, 'Block "A"', "Canopus I/O block", 1025, 1), (127, "Master", "RJ71CN91", 256, None)], str(nodes))
        require(all(n["EDS file version"] is None for n in nodes), "no file was named")
        shown = tool(plant, "nodes", path, "--eds", DEVICE, "--eds", ROOT / "examples/devices").stdout
        require(re.search("EDS file version +1\n +EDS file revision +1\nNode ID 127.*EDS file version +-\n +EDS file revision +-\n$", shown, re.S), shown)
        require("nothing.eds" in tool(plant, "nodes", path, "--eds", "nothing.eds", expect=2).stderr, "a file that is not there")
        # Identity of a slave, from itself and from the master's list.
        tool(plant, "identify", path, "3")
        shown = tool(None, "show", path, "slave").stdout
        for line in ("Device type +983441", "Vendor-ID +0x00000000", "Product code +1025", "Revision number +0x00010000", "Serial number +0x00000001"):
            require(re.search(f"^  {line}$", shown, re.M), f"{line} is not in {shown}")
        module.sdo_write(0, 0x1F86, 3, (77).to_bytes(4, "little"))
        tool(plant, "identify", path, "3", "--source", "master")
        shown = tool(None, "show", path, "slave").stdout
        require(re.search("^  Product code +77$", shown, re.M) and re.search("^  Device type +0$", shown, re.M), shown)
        require("node 9: abort" in tool(plant, "identify", path, "9", expect=1).stderr, "a node that is not there")
        require("9" not in re.findall("slave/([0-9]+)", tool(None, "show", path, "slave").stdout), "a failed one changes nothing")
        # Defaults of the module: not without --yes; they count after the reset.
        module.sdo_write(0, 0x1017, 0, (900).to_bytes(2, "little"))
        tool(plant, "nodes", path, "--node", "127", "--save", "--yes")
        require("--yes" in tool(plant, "nodes", path, "--node", "127", "--restore", expect=2).stderr, "without --yes")
        said = tool(plant, "nodes", path, "--node", "127", "--restore", "--yes").stdout
        require("defaults restored" in said and number(module, 0x1017, 0) == 900, said)
        tool(plant, "reset", "--yes")
        require(number(module, 0x1017, 0) == 0 and not module.x(0x02), "after the reset")
        # A heartbeat that is lost is an error; --clear asks the module to forget it (YF).
        require("Error status                0000H" in tool(plant, "status").stdout, "status")
        module.set_g(21, 99)                                                         # a setting that is refused: G29 bit 6, G39
        module.y(0x1F, False)
        said = tool(plant, "status").stdout
        require("bit 6  buffer memory setting error" in said and "First refused setting       G21" in said, said)
        module.set_g(21, 405)
        require("bit 6" not in tool(plant, "status", "--clear").stdout and not module.x(0x0F), "--clear")
        plant.wait(lambda e: e["event"] == "signal" and e["signal"] == "Y0F" and e["on"])
        plant.wait(lambda e: e["event"] == "signal" and e["signal"] == "Y0F" and not e["on"])
        require("--module" in command(program, "configure", "scan", "--module", "ME3", "--plc", "1", expect=2, env=state()).stderr, "--module")


@check
def the_page_of_the_rj71cn91s_tool_names_commands_that_are_there():
    """Each command in the page's last column is one, with these options."""
    page = (ROOT / "docs/configure-rj71cn91.md").read_text()
    for words in sorted({found.split()[0] for found in re.findall(r"`configure ([a-z][^`]*)`", page)}):
        command(program, "configure", words, "--help")
    for words in sorted(set(re.findall(r"`configure ([a-z-]+ [^`]*)`", page))):
        inner = words.split()[:2] if words.startswith("setup ") else words.split()[:1]
        shown = command(program, "configure", *inner, "--help").stdout
        for option in re.findall(r"--[a-z]+", words):
            require(option in shown, f"configure {words}: {option} is none of its options")
