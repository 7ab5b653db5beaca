"""Checks of what the vendors' configuration tools do: `canopus configure` on an FX3U-CAN, and the commands for an AS-FCOPM. A Python
client of the MC protocol looks into the module; the tool's own reading is no witness of its writing."""
import json
import os
import re
import shlex
import subprocess
import sys

from as_fcopm_checks import card_plant, port_of
from docs_checks import transcripts
from kit import ANSWER, PATIENCE, ROOT, check, command, covers, host_port, program, require, running, scratch, until

sys.path.insert(0, str(ROOT / "python"))
from canopus_plc import Plc  # noqa: E402

DEVICE = ROOT / "examples/devices/io-block.eds"
def state():
    """The environment of a command whose connections are remembered in the check's folder."""
    return {**os.environ, "XDG_STATE_HOME": str(scratch / "configure-state")}


def fx3u_plant(name, device='node = 3', store=False):
    path = scratch / f"{name}.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                    f'[[device]]\n{device}\nname = "io-block"\neds = "{DEVICE}"\n'
                    '[[plc]]\nname = "plc1"\nfamily = "FX3"\nlisten = "127.0.0.1:0"\n'
                    + (f'store = "{scratch}/{name}-store"\n' if store else "")
                    + '[[plc.module]]\nmodel = "FX3U-CAN"\nposition = 0\nrestart_time = "100ms"\n')
    return path


def tool(plant, *words, expect=0):
    """A command of the tool on the running plant."""
    online = ("read", "diff", "write", "scan", "sdo-read", "sdo-write", "status", "reset", "nodes", "identify")
    port = ["--plc", host_port(plant.mc)[1], "--timeout", f"{PATIENCE}s"] if plant is not None and words[0] in online else []
    return command(program, "configure", *words, *port, expect=expect, env=state())


def project(name, *settings):
    """A new project with these settings: (window, field=value ...)."""
    path = scratch / f"{name}.xml"
    path.unlink(missing_ok=True)
    tool(None, "new", path)
    for window, *fields in settings:
        tool(None, "set", path, window, *fields)
    return path


class Module:
    """Looks at the module as a PLC's program does, without the tool."""

    def __init__(self, plant):
        host, port = host_port(plant.mc)
        self.plc = Plc(host, int(port))
        self.g = self.plc.g[0]
        self.plc.wait(lambda: not self.g[25] & 0x80, PATIENCE)

    def object(self, index, sub, node=0):
        """An SDO read by the command interface [FX3U-CAN 10.2.1]."""
        self.g[1001:1004] = [node, index, sub]
        self.g[1000] = 4
        self.plc.wait(lambda: self.g[1000] != 0xFFFF, PATIENCE)
        words = self.g[1000:1008]
        require(words[0] == 5, f"{index:04X}H:{sub:02X} cannot be read: {words}")
        return words[5] | words[6] << 16 if words[4] > 2 else words[5] & (0xFF if words[4] == 1 else 0xFFFF)


def stop_cpu(plant):
    command(program, "plc", "stop", "--plc", host_port(plant.mc)[1])


@check
@covers("FX3U-TOOL-001")
def basic_settings_are_edited_read_and_written():
    with running(fx3u_plant("configure-basic", store=True)) as plant:
        module = Module(plant)
        path = project("configure-basic")
        shown = tool(None, "show", path, "basic").stdout
        for line in ("Module number +0", "Function mode +405", "Node ID +127", "Baud-Rate +250 kbps", "FROM/TO Watchdog +200 ms",
                     "SDO timeout +500 ms"):
            require(re.search(rf"^  {line}$", shown, re.M), f"{line} is not in {shown}")
        for wrong, reason in (("Node ID=0", "expected 1 to 127"), ("Node ID=128", "expected 1 to 127"),
                              ("Baud-Rate=300", "expected 10, 20, 50, 100, 125, 250, 500, 800, 1000 kbps"),
                              ("FROM/TO Watchdog=15", "expected steps of 10 ms"), ("FROM/TO Watchdog=65540", "expected 0 to 65530 ms"),
                              ("SDO timeout=49", "expected 50 to 32767 ms"), ("SDO timeout=32768", "expected 50 to 32767 ms"),
                              ("Module number=17", "expected 0 to 16")):
            require(reason in tool(None, "set", path, "basic", wrong, expect=2).stderr, wrong)
        tool(None, "set", path, "basic", "Node ID=9", "Baud-Rate=500", "FROM/TO Watchdog=0", "SDO timeout=32767")
        tool(plant, "write", path, "--part", "basic", "--yes", "--stop")
        require([module.g[n] for n in (24, 26, 27, 71)] == [500, 0, 9, 32767], "the words of the module")
        tool(None, "defaults", path, "basic")
        require("Node ID                                127" in tool(None, "show", path, "basic").stdout, "defaults")
        tool(plant, "read", path, "--part", "basic")
        shown = tool(None, "show", path, "basic").stdout
        require("500 kbps" in shown and re.search("Node ID +9$", shown, re.M), shown)
        plant.process.kill()
        plant.process.wait()
    with running(fx3u_plant("configure-basic", store=True)) as plant:                # they are in the flash ROM
        module = Module(plant)
        require([module.g[n] for n in (24, 26, 27, 71)] == [500, 0, 9, 32767], "after the power was cut")
    # An FX5 counts its modules from 1.
    path.unlink()
    tool(None, "new", path, "--number", "16")
    require(re.search("Module number +16$", tool(None, "show", path, "basic").stdout, re.M), "--number")


@check
@covers("FX3U-TOOL-002 FX3U-TOOL-003")
def pdos_are_edited_read_and_written_by_area():
    with running(fx3u_plant("configure-pdo", store=True)) as plant:
        module = Module(plant)
        stop_cpu(plant)
        path = project("configure-pdo", ("tpdo/1", "Transmission type=0x01", "map=A100:01:16"),
                       ("tpdo/80", "valid=Selected", "CAN-ID (11-bit)=0x57F", "Inhibit time=65535", "Event timer=65535",
                        "map=A1C0:A0:32,A240:01:32"),
                       ("rpdo/2", "Transmission type=0xF0", "map=A4C0:01:8 0005:00:8 A580:02:16"), ("rpdo/3", "valid=Not selected"))
        for window, wrong, reason in (("tpdo/81", "Event timer=1", "expected tpdo/1 to tpdo/80"),
                                      ("tpdo/2", "CAN-ID (11-bit)=0x580", "expected 0x000 to 0x57F"),
                                      ("tpdo/2", "Inhibit time=65536", "expected 0 to 65535 100us"),
                                      ("tpdo/2", "Transmission type=0x100", "expected 0x00 to 0xFF"),
                                      ("tpdo/2", "map=A1C0:01:32 A1C0:02:32 A000:01:8", "at most 64")):
            require(reason in tool(None, "set", path, window, wrong, expect=2).stderr, (window, wrong))
        shown = tool(None, "show", path).stdout
        for name in ("BFM Area Integer32 (PLC write access), BFM#11319, #11318 (TO)", "BFM Area Float (PLC write access), BFM#11001, #11000 (TO)",
                     "BFM Area Unsigned8 (PLC read access), BFM#10000 LByte (FROM)", "Dummy Unsigned 8 bit"):
            require(name in shown, f"{name} is not in {shown}")
        tool(plant, "write", path, "--part", "tpdo", "--pdos", "2-", "--yes")            # starting from 2
        require(module.object(0x184F, 1) == 0x4000057F and module.object(0x1800, 2) == 0xFE, "starting from 2")
        tool(plant, "write", path, "--part", "tpdo", "--pdos", "1-1", "--yes")
        require(module.object(0x1800, 2) == 1 and module.object(0x1A00, 0) == 1, "range 1 to 1")
        tool(plant, "write", path, "--part", "rpdo", "--yes")                            # all
        got = [module.object(0x1A4F, sub) for sub in (0, 1, 2)] + [module.object(0x184F, sub) for sub in (2, 3, 5)]
        require(got == [2, 0xA1C0A020, 0xA2400120, 0xFE, 65535, 65535], f"TPDO80: {[hex(value) for value in got]}")
        got = [module.object(0x1601, sub) for sub in range(4)] + [module.object(0x1401, 2), module.object(0x1402, 1)]
        require(got == [3, 0xA4C00108, 0x00050008, 0xA5800210, 0xF0, 0x8000047F], f"RPDO2 and 3: {[hex(value) for value in got]}")
        other = project("configure-pdo-2")
        tool(plant, "read", other, "--part", "tpdo", "--pdos", "80-")
        shown = tool(None, "show", other, "--json").stdout
        require(shown.count('"window":"tpdo"') == 1 and '"Event timer":65535' in shown, shown)
        tool(plant, "read", other, "--part", "tpdo")
        require(tool(None, "show", other, "--json").stdout.count('"window":"tpdo"') == 5, "1 to 4, and 80")
        plant.process.kill()
        plant.process.wait()
    with running(fx3u_plant("configure-pdo", store=True)) as plant:
        require(Module(plant).object(0x184F, 1) == 0x4000057F, "TPDO80 after the power was cut: it was not in the flash ROM")


@check
@covers("FX3U-TOOL-004")
def nmt_settings_are_edited_read_and_written():
    with running(fx3u_plant("configure-nmt")) as plant:
        module = Module(plant)
        stop_cpu(plant)
        slaves = [(f"slave/{node}", "NMT slave=Selected") for node in range(4, 127)]
        path = project("configure-nmt",
                       ("master", "NMT master=Selected", "Reset all nodes=Selected", "Flying master=Selected", "Boot time=4000",
                        "SYNC - Communication cycle period=20000", "Start all nodes delay=700", "Timeout=200",
                        "NMT master negotiation time delay=600", "NMT master priority=Low", "Priority time slot=2600",
                        "CANopen device time slot=20", "Multiple NMT master detect cycle time=6000", "Guard time=300", "Life time factor=4"),
                       ("slave/3", "NMT slave=Selected", "NMT boot slave=Selected", "Mandatory=Selected", "Reset communication=Selected",
                        "Retry factor=3", "Guard time=150", "Device type=983441", "Vendor-ID=0x0", "Product code=1025",
                        "Revision number=0x10000", "Serial number=0x1"),
                       *slaves[:2], ("consumer/3", "Consumer heartbeat time=1500"), ("producer", "Producer heartbeat time=800"))
        tool(plant, "write", path, "--part", "nmt", "--yes")
        wanted = {(0x1F80, 0): 0x31, (0x1F89, 0): 4000, (0x1006, 0): 20000, (0x1F90, 1): 200, (0x1F90, 2): 600, (0x1F90, 3): 2,
                  (0x1F90, 4): 2600, (0x1F90, 5): 20, (0x1F90, 6): 6000, (0x100C, 0): 300, (0x100D, 0): 4, (0x1F81, 3): 0x0096031D,
                  (0x1F81, 4): 1, (0x1F81, 5): 1, (0x1F84, 3): 983441, (0x1F86, 3): 1025, (0x1F87, 3): 0x10000, (0x1F88, 3): 1,
                  (0x1016, 1): 0x000305DC, (0x1017, 0): 800}
        for (index, sub), value in wanted.items():
            require(module.object(index, sub) == value, f"{index:04X}H:{sub:02X} is {module.object(index, sub):X}H, expected {value:X}H")
        require(module.g[70] == 700, "#70")
        other = project("configure-nmt-2")
        tool(plant, "read", other, "--part", "nmt")
        require(tool(None, "show", other, "master").stdout == tool(None, "show", path, "master").stdout, "the master's settings")
        require(tool(None, "show", other, "slave").stdout == tool(None, "show", path, "slave").stdout, "the slaves")
        require("Consumer heartbeat time                1500 ms" in tool(None, "show", other, "consumer").stdout, "the consumer")
        # At most 126 of each.
        for window, *fields in slaves[2:]:
            tool(None, "set", path, window, *fields)
        tool(None, "set", path, "slave/1", "NMT slave=Selected")
        require("at most 126" not in tool(None, "set", path, "slave/2", expect=0).stderr, "126")
        require("slave: at most 126 rows" in tool(None, "set", path, "slave/127", expect=2).stderr, "127")
        # A slave that the list has no more is none of the module's any more.
        tool(None, "delete", other, "slave/4")
        tool(plant, "write", other, "--part", "nmt", "--yes")
        require(module.object(0x1F81, 4) == 0, "slave 4 is still assigned")


@check
@covers("FX3U-TOOL-005")
def a_project_is_downloaded_in_stop_alone():
    with running(fx3u_plant("configure-download")) as plant:
        module = Module(plant)
        path = project("configure-download", ("basic", "Node ID=2"), ("producer", "Producer heartbeat time=100"))
        said = tool(plant, "write", path).stdout
        require("Node ID (G27): device 127, project 2" in said and "nothing is written without --yes" in said, said)
        refused = tool(plant, "write", path, "--yes", expect=3)
        require("is in RUN" in refused.stderr and module.g[27] == 127, "it was written in RUN")
        stop_cpu(plant)
        said = tool(plant, "write", path, "--yes").stdout
        require("read back: the same" in said and module.g[27] == 2 and module.object(0x1017, 0) == 100, said)
        require("nothing to write" in tool(plant, "write", path, "--yes").stdout, "a second time")
        # What the module refuses is told, and nothing is said to be written that is not.
        tool(None, "set", path, "rpdo/1", "map=6000:01:8")
        said = tool(plant, "write", path, "--yes", expect=1)
        require("abort 0602" in said.stderr or "abort 0604" in said.stderr, said.stderr)
        require("1600:01" not in said.stdout.split("rpdo 1: 1400:01")[1] and "read back" not in said.stdout, said.stdout)
        # A project that is wrong in itself is not begun.
        tool(None, "set", path, "master", "Priority time slot=1")
        require("Priority time slot" in tool(plant, "write", path, "--yes", expect=4).stderr, "a wrong project")
    gone = command(program, "configure", "diff", path, "--plc", host_port(plant.mc)[1], "--timeout", "1s", expect=1, env=state())
    require("canopus" in gone.stderr and not gone.stdout, gone.stderr)


@check
@covers("FX3U-TOOL-006 FX3U-TOOL-007")
def the_tool_scans_and_sends_sdos():
    with running(fx3u_plant("configure-sdo")) as plant:
        for words, wanted in (([], 1), (["--nodes", "3-"], 1), (["--nodes", "4-9"], 0), (["--nodes", "1-3"], 1)):
            said = tool(plant, "scan", "--json", *words).stdout
            require(said.count('{"node":3,"name":"Canopus I/O block"}') == wanted, f"{words}: {said}")
        said = tool(plant, "sdo-read", "3", "0x1000:0x00").stdout
        require(said.splitlines() == ["SDO_READ_SUCCESS", "  hexadecimal    0x000F0191", "  decimal        983441",
                                      "  floating point 1.378094e-39", "  ASCII          ...."], said)
        said = tool(plant, "sdo-read", "3", "1008").stdout
        require("SDO_READ_SUCCESS" in said and "ASCII          Canopus I/O block" in said, said)
        require(tool(plant, "sdo-write", "3", "1017", "0x1F4").stdout == "SDO_WRITE_SUCCESS\n", "2 bytes")
        require("decimal        500" in tool(plant, "sdo-read", "3", "1017").stdout, "it was not written")
        require(tool(plant, "sdo-write", "3", "6200:01", "255", "--length", "BYTE_LENGTH_1").stdout == "SDO_WRITE_SUCCESS\n", "1 byte")
        require(tool(plant, "sdo-write", "3", "1014", "0x83", "--length", "BYTE_LENGTH_4").returncode == 0, "4 bytes")
        for words, reason in ((("1000", "1", "--length", "BYTE_LENGTH_4"), "abort 06010002H"), (("5000", "1"), "abort 06020000H"),
                              (("1017", "1", "--length", "BYTE_LENGTH_6"), "abort 0607"), (("1017", "1", "--length", "BYTE_LENGTH_8"), "abort 0607"),
                              (("1017", "text", "--length", "STRING"), "abort 0607")):
            failed = tool(plant, "sdo-write", "3", *words, expect=1)
            require(reason in failed.stderr and failed.stdout == "", f"{words}: {failed.stderr}")
        require("no number of 2 bytes" in tool(plant, "sdo-write", "3", "1017", "65536", expect=2).stderr, "a number that is too long")
        require("abort 0504" in tool(plant, "sdo-read", "100", "1000", expect=1).stderr, "a node that is not there")


@check
@covers("FX3U-TOOL-008 FX3U-TOOL-009")
def the_tool_shows_clears_and_resets():
    with running(fx3u_plant("configure-status")) as plant:
        module = Module(plant)
        module.g[24] = 251                                                           # a setting error
        said = tool(plant, "status").stdout
        require("baud rate change error" in said and "NMT state" in said, said)
        module.g[24] = 250
        said = tool(plant, "status", "--clear").stdout
        require("Error status                0000H" in said and "baud rate" not in said.lower().replace("baud-rate", ""), said)
        path = project("configure-status", ("master", "NMT master=Selected"), ("slave/3", "NMT slave=Selected", "NMT boot slave=Selected"))
        tool(plant, "write", path, "--part", "nmt", "--yes", "--stop")
        require("--yes" in tool(plant, "reset", expect=2).stderr, "it asks before")
        tool(plant, "reset", "--yes")
        plant.wait(lambda e: e["event"] == "nmt" and e["node"] == 3 and e["state"] == "operational")
        until(lambda: "Operational, active NMT master" in tool(plant, "status").stdout, "the NMT master does not start again")


@check
@covers("FX3U-TOOL-010")
def projects_are_exported_imported_and_remembered():
    state = {**os.environ, "XDG_STATE_HOME": str(scratch / "recent-state")}
    run = lambda *words, expect=0: command(program, "configure", *words, expect=expect, env=state)
    paths = [scratch / f"recent-{number}.xml" for number in range(12)]
    for path in paths:
        run("new", path)
    listed = run("recent").stdout.split()
    require(listed == [str(path) for path in reversed(paths[2:])], f"the last ten: {listed}")
    run("show", paths[5])
    require(run("recent").stdout.split()[0] == str(paths[5]), "an opened one comes first")
    run("set", paths[5], "basic", "Node ID=42")
    backup = scratch / "backup.xml"
    run("export", paths[5], backup)
    require(backup.read_text().startswith("<?xml") and "backup" not in run("recent").stdout, "an export")
    target = scratch / "imported.xml"
    run("new", target)
    before = run("recent").stdout
    other = scratch / "imported-2.xml"
    run("import", other, backup)
    require(run("recent").stdout == before, "opened by import: not remembered")
    require(other.read_text() == paths[5].read_text(), "the settings of the backup")
    require(".xml" in run("export", paths[5], scratch / "backup.txt", expect=2).stderr, "the extension")
    # A file of a newer version, and one that is none, change nothing.
    backup.write_text(backup.read_text().replace('format="1"', 'format="2"'))
    require("newer" in run("import", other, backup, expect=2).stderr, "a newer format")
    backup.write_text("\x00\x1b[31m<")
    failed = run("import", other, backup, expect=2)
    require("\x1b" not in failed.stderr and other.read_text() == paths[5].read_text(), "a file that is none")


@check
def the_page_of_configure_shows_what_it_prints():
    folder = scratch / "configure-page"
    folder.mkdir()
    for commands in transcripts("docs/configure.md"):
        for words, shown in commands:
            done = subprocess.run([program, *shlex.split(words)[1:]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                  cwd=folder, env=state(), timeout=PATIENCE)
            require(done.stdout.splitlines() == shown, f"{words} says:\n{done.stdout}")


@check
@covers("ASF-TOOL-001 ASF-TOOL-002 ASF-TOOL-003 ASF-TOOL-009 ASF-TOOL-010")
def the_vendors_operations_on_an_as_fcopm_are_commands():
    """Their windows are commands here: docs/modules/as-fcopm.md says which."""
    drive = ROOT / "examples/devices/drive.eds"
    download = '[[plc.module.download.slave]]\nnode = 3\ntx_pdo = [{ number = 1, type = 1, objects = ["6041:00"] }]\n'
    devices = f'[[device]]\nnode = 3\nname = "axis"\neds = "{drive}"\n'
    for node, rate in ((1, 1000), (7, 500)):                                         # two downloads of card settings
        path = card_plant(f"tool-{node}", download, devices, card=f"node = {node}")
        path.write_text(path.read_text().replace("bit_rate = 1_000_000", f"bit_rate = {rate}_000"))
        with running(path, has_plc=False) as plant:
            host, port = port_of(plant, "Modbus TCP")
            on_plc = lambda *words: command(program, "plc", *words, "--modbus", "--plc", f"{host}:{port}").stdout
            bus = ("--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER)
            said = lambda: command(program, "scan", "--nodes", "1-9", *bus).stdout
            until(lambda: "2 nodes found" in said() and " operational" in said(), "the scan does not find master and slave")
            require(re.search(rf"^ +{node}  .*AS300 Series PLC$", said(), re.M) and re.search("^ +3  .*Canopus drive$", said(), re.M), said())
            require(on_plc("read", "SR822").split()[1] == str(rate), "the card's bit rate")
            shown = command(program, "eds", "show", drive).stdout
            require(re.search("^60FF:00 +INTEGER32 +rw", shown, re.M), "index and sub-index of the slave's parameters")
            sdo = lambda *words: command(program, "sdo", *words, *bus).stdout
            sdo("write", "3", "6083:00", "4321", "--type", "u32")
            require("4321" in sdo("read", "3", "6083:00", "--type", "u32"), "a parameter that was edited")
    gone = command(program, "plc", "read", "SR822", "--modbus", "--plc", f"{host}:{port}", "--timeout", "1s", expect=1)
    require(port in gone.stderr, "a PLC that is not there")


@check
def changes_of_settings_are_taken_back_byte_for_byte():
    path = project("undo", ("basic", "Node ID=5"))
    other = project("undo-other")
    steps = [path.read_bytes()]
    for words in (("set", path, "basic", "Node ID=6"), ("set", path, "tpdo/3", "Event timer=100"), ("delete", path, "tpdo/3"),
                  ("defaults", path, "basic"), ("import", path, other)):
        tool(None, *words)
        if path.read_bytes() != steps[-1]:
            steps.append(path.read_bytes())
    require(len(steps) >= 4, "nothing changed")
    titles = []
    for before in reversed(steps[:-1]):
        titles.append(tool(None, "undo", path).stdout.strip())
        require(path.read_bytes() == before, titles)
    require(titles[-3:] == ["taken back: delete tpdo/3", "taken back: set tpdo/3 Event timer=100", "taken back: set basic Node ID=6"], titles)
    require(json.loads(tool(None, "undo", path, "--json").stdout) == {"event": "undone", "title": "set basic Node ID=5"}, "the first change")
    require("there is nothing to take back" in tool(None, "undo", path, expect=2).stderr, "more than there was")
    require("there is nothing to take back" in tool(None, "undo", other, expect=2).stderr, "a change of another file")
    # What somebody else has changed since stays; a refused change is none; a file that is not there leaves nothing behind.
    tool(None, "set", path, "basic", "Node ID=7")
    tool(None, "set", path, "basic", "Node ID=128", expect=2)
    path.write_bytes(path.read_bytes() + b"<!-- a note -->\n")
    require("has been changed since" in tool(None, "undo", path, expect=2).stderr, "it was overwritten")
    require(path.read_bytes().endswith(b"<!-- a note -->\n"), "the note is gone")
    tool(None, "set", scratch / "no-such.xml", "basic", "Node ID=7", expect=2)
    require(not (scratch / ".canopus/settings/no-such.xml").exists(), "a folder for nothing")
    # Two at a time do not lose each other's changes.
    import fcntl
    with open(scratch / ".canopus/settings/undo-other.xml/.lock", "a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        require("another process" in tool(None, "set", other, "basic", "Node ID=9", expect=2).stderr, "it was changed")
        require("Node ID" in tool(None, "show", other).stdout, "it cannot be read meanwhile")
