"""Checks of `canopus project`: what it writes is read by programs we did not write, and what it says of devices is so."""
import configparser
import json
import re
import shlex
import shutil
import subprocess

from docs_checks import differs, transcripts
from kit import ANSWER, PATIENCE, ROOT, check, command, host_port, program, require, running, scratch, silence

DEVICES = ROOT / "examples/devices"


def project(*words, expect=0, bus=None, cwd=scratch):
    online = ["--bus", f"socketcand:{bus}", *(() if "--timeout" in words else ("--timeout", ANSWER))] if bus else []
    return command(program, "project", *words, *online, expect=expect, cwd=cwd)


def lines(*words, **options):
    """What a command with --json says."""
    return [json.loads(line) for line in project(*words, "--json", **options).stdout.splitlines()]


def new_project(name, *nodes):
    """A project with these nodes: (node-ID, name, device file)."""
    shutil.rmtree(scratch / name, ignore_errors=True)
    project("new", name)
    for node, called, device in nodes:
        project("add", name, device, "--node-id", str(node), "--name", called, "--bit-rate", "250k")
    return scratch / name


def plant_of(name, devices, extra=""):
    """A plant of devices without a PLC: (node-ID, device file, more keys)."""
    path = scratch / f"{name}.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n' + extra +
                    "".join(f'[[device]]\nnode = {node}\neds = "{eds}"\n{more}\n' for node, eds, more in devices))
    return running(path, has_plc=False)


def ini(path):
    """A CiA 306 file, read by Python's parser of INI files."""
    parser = configparser.ConfigParser(strict=False, interpolation=None, comment_prefixes=(";",))
    parser.optionxform = str
    parser.read(path, encoding="latin-1")
    return parser


@check
def the_page_of_projects_shows_what_the_commands_print():
    page = "docs/project.md"
    folder = scratch / "project-page"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "examples").symlink_to(ROOT / "examples")
    text = (ROOT / "examples/network-without-plc/devices.toml").read_text()
    (scratch / "project-page.toml").write_text(text.replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{DEVICES}/'))
    with running(scratch / "project-page.toml", has_plc=False) as plant:
        for commands in transcripts(page):
            for line, shown in commands:
                words = shlex.split(line)
                online = ["--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER] if words[2] in ("diff", "write", "adopt", "report", "accept") else []
                done = subprocess.run([program, *words[1:], *online], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                      timeout=PATIENCE, cwd=folder)
                different = differs(shown, done.stdout.splitlines(), ())
                require(different is None, f"{page} shows {different!r}, {line} says:\n{done.stdout}")


@check
def a_project_is_what_cia_306_has():
    folder = new_project("project-306", (3, "Encoder", DEVICES / "encoder.eds"), (5, "Drive", DEVICES / "drive.eds"))
    project("set", folder, "Drive", "1017=500", "--reference", "-M1")
    project("pdo", "link", folder, "Encoder.6004", "Drive.60FF")
    topology = ini(folder / "nodelist.cpj")["Topology"]
    require((topology["Nodes"], topology["Node5Present"], topology["Node5Name"], topology["Node5Refd"], topology["Node5DCFName"]) ==
            ("0x02", "0x01", "Drive", "-M1", "drive.dcf"), dict(topology))
    dcf = ini(folder / "drive.dcf")
    require((dcf["DeviceComissioning"]["NodeID"], dcf["DeviceComissioning"]["Baudrate"]) == ("5", "250"), "commissioning")
    require(dcf["1017"]["ParameterValue"] == "500", "1017")
    require(int(dcf["1403sub1"]["ParameterValue"], 0) == 0x183, "the RPDO has not the CAN-ID of the encoder")
    require(int(dcf["1603sub1"]["ParameterValue"], 0) == 0x60FF0020 and dcf["1603sub0"]["ParameterValue"] == "1", "mapping")
    # The rest of the DCF is the EDS, line for line.
    before = (DEVICES / "drive.eds").read_text().splitlines()
    after = (folder / "drive.dcf").read_text().splitlines()
    added = [line for line in after if line not in before]
    require(len(added) <= 14 and not [line for line in before if line not in after and not line.startswith(("FileName", "LastEDS"))],
            added)


@check
def changes_are_taken_back_byte_for_byte():
    folder = new_project("project-undo", (3, "Encoder", DEVICES / "encoder.eds"))
    def files():
        return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}
    before = files()
    project("add", folder, DEVICES / "drive.eds", "--name", "Drive")
    project("set", folder, "Encoder", "1017=100")
    project("remove", folder, "Encoder")
    require(set(files()) == {"nodelist.cpj", "drive.dcf"}, files().keys())
    for title in ("remove Encoder", "set Encoder 1017=100", "add drive.eds"):
        require(title in project("undo", folder).stdout, title)
    require(files() == before, "undo left something")
    # What somebody else has changed since is not overwritten.
    project("set", folder, "Encoder", "1017=100")
    (folder / "encoder.dcf").write_bytes((folder / "encoder.dcf").read_bytes() + b"; a note\r\n")
    require("has been changed since" in project("undo", folder, expect=3).stderr, "undo overwrote a change")


@check
def each_kind_of_failure_has_its_exit_code():
    folder = new_project("project-codes", (5, "Drive", DEVICES / "drive.eds"))
    for words, code, said in (
            (("show", scratch / "nowhere"), 3, "no such file"),
            (("new", folder), 3, "there already"),
            (("set", folder, "9", "1017=1"), 5, "no node 9"),
            (("set", folder, "5", "1017=70000"), 5, "expected 0 to 65535"),
            (("set", folder, "5", "nonsense"), 2, "expected OBJECT=VALUE"),
            (("set", folder, "5"), 2, "nothing to set"),
            (("add", folder, scratch / "none.eds"), 3, "No such file"),
            (("add", folder, folder / "nodelist.cpj"), 5, "nodelist.cpj: line"),
            (("add", folder, DEVICES / "drive.eds", "--node-id", "5"), 5, "1 is free"),
            (("add", folder, DEVICES / "drive.eds", "--bit-rate", "fast"), 2, "expected 10k, 20k, 50k"),
            (("pdo", "link", folder, "5.6041", "6.6040"), 5, "no node 6"),
            (("pdo", "map", folder, "5", "tpdo9"), 5, "it has RPDO1"),
            (("concise", folder, "5", scratch / "no/where"), 3, "cannot"),
            (("diff", folder, "--bus", "socketcand:127.0.0.1:1"), 1, "127.0.0.1:1"),
            (("undo", folder, "--network", "x"), 2, "--network")):
        done = subprocess.run([program, "project", *map(str, words)], capture_output=True, text=True, timeout=PATIENCE)
        require(done.returncode == code and said in done.stderr, f"{words}: {done.returncode}, {done.stderr}")
    require(lines("show", folder, "5")[0]["product"] == "Canopus drive", "the project was changed by a failure")


@check
def a_project_that_is_in_use_is_not_changed():
    import fcntl
    folder = new_project("project-lock", (5, "Drive", DEVICES / "drive.eds"))
    with open(folder / ".canopus/.lock", "a") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        require("another process" in project("set", folder, "5", "1017=1", expect=3).stderr, "it was changed")
    project("set", folder, "5", "1017=1")


@check
def devices_are_held_against_their_project_and_written():
    folder = new_project("project-write", (3, "Encoder", DEVICES / "encoder.eds"), (5, "Drive", DEVICES / "drive.eds"))
    project("set", folder, "Drive", "1017=500", "6081=2000")
    project("pdo", "map", folder, "Drive", "tpdo1", "Statusword", "6061", "--can-id", "0x1AB")
    # This drive takes at most 1500, which the project's file does not know; the encoder is not there.
    strict = scratch / "strict-drive.eds"
    strict.write_text((DEVICES / "drive.eds").read_text().replace("ParameterName=Profile velocity\n", "ParameterName=Profile velocity\nHighLimit=1500\n"))
    with plant_of("project-write", [(5, strict, "")]) as plant:
        bus = plant.socketcand
        said = lines("diff", folder, bus=bus, expect=1)
        require([one["object"] for one in said if one.get("state") == "different" and "object" in one] ==
                ["1017:00", "1800:01", "1A00:00", "1A00:02", "6081:00"], said)
        require({"node": 3, "state": "no answer"}.items() <= [one for one in said if one.get("node") == 3][0].items(), said)
        require(said[-1] == {"event": "summary", "same": 0, "different": 1, "no_answer": 1, "refused": 0}, said[-1])

        project("write", folder, "Drive", bus=bus, expect=4)  # nothing yet
        require([one for one in lines("diff", folder, "Drive", bus=bus, expect=4) if one.get("object") == "1017:00"], "it was written")

        said = lines("write", folder, "Drive", "--yes", bus=bus, expect=6)
        steps = [(one["write"], one["state"]) for one in said if "write" in one]
        require(steps == [("1017:00", "written"), ("1800:01", "written"), ("1A00:00", "written"), ("1A00:02", "written"),
                          ("1A00:00", "written"), ("1800:01", "written"), ("6081:00", "refused")], steps)
        left = [one["object"] for one in said[said.index([one for one in said if "write" in one][-1]):] if "object" in one]
        require(left == ["6081:00"], f"read back: {left}")
        # Another program reads what was written.
        for node, index, value in ((5, "1017", "500"), (5, "1800:01", "427"), (5, "1A00", "2")):
            read = command(program, "sdo", "read", str(node), index, "--bus", f"socketcand:{bus}", "--timeout", ANSWER).stdout
            require(value in read, f"{index}: {read}")
        project("set", folder, "Drive", "6081=1200")
        project("write", folder, "Drive", "--yes", bus=bus)
        project("diff", folder, "Drive", bus=bus)


@check
def a_device_that_goes_in_the_middle_of_a_write_has_nothing_written():
    """Its answers are lost from the N-th on: what it acknowledged before is not said to be written, as it was not read back."""
    folder = new_project("project-cut", (5, "Drive", DEVICES / "drive.eds"))
    project("set", folder, "Drive", "1017=500", "6081=2000", "6083=3000")
    seen = set()
    for first in range(4, 30):
        with plant_of("project-cut", [(5, DEVICES / "drive.eds", "")], f'[[bus.fault]]\nkind = "drop"\nidentifier = 0x585\nfirst = {first}\n') as plant:
            done = subprocess.run([program, "project", "write", folder, "--yes", "--json", "--timeout", silence(100), "--bus", f"socketcand:{plant.socketcand}"],
                                  capture_output=True, text=True, timeout=PATIENCE)
        said = [json.loads(line) for line in done.stdout.splitlines()]
        steps = [one["state"] for one in said if "write" in one]
        if done.returncode == 0:
            require(steps and set(steps) == {"written"}, said)
            break
        require(done.returncode == 1 and "written" not in steps, (first, done.returncode, said))
        require([one["state"] for one in said if one.get("node") == 5 and "object" not in one and "write" not in one] == ["no answer"], said)
        seen |= {"none" if not steps else "some" if "no answer" in steps else "all"}
        if steps:
            require(set(steps) <= {"acknowledged, not read back", "no answer", "not tried"} and steps[0] in ("acknowledged, not read back", "no answer"), steps)
    else:
        raise AssertionError("no write came to its end")
    require(seen == {"none", "some", "all"}, f"cut only where {seen} of the values were acknowledged")


@check
def another_device_is_left_alone():
    folder = new_project("project-other", (5, "Drive", DEVICES / "drive.eds"))
    project("set", folder, "Drive", "1017=500")
    with plant_of("project-other", [(5, DEVICES / "encoder.eds", "")]) as plant:
        said = project("write", folder, "--yes", bus=plant.socketcand, expect=4).stdout
        require("it is another device, which is left alone" in said and "1018:02" in said, said)
        require("0" in command(program, "sdo", "read", "5", "1017", "--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER).stdout.split(), "written")


@check
def a_running_network_is_adopted_and_runs_again_from_its_project():
    """Adopt, boot the adopted project on a plant made of it, and find the values that the devices had."""
    folder = new_project("project-adopt")
    devices = [(2, DEVICES / "io-block.eds", 'name = "<b>Valves</b>"'),
               (9, DEVICES / "drive.eds", 'objects = { "1017" = 250, "1800:01" = 0x1AB }'),
               (20, DEVICES / "encoder.eds", "")]
    with plant_of("project-adopt", devices) as plant:
        said = lines("adopt", folder, "--eds", DEVICES / "io-block.eds", "--eds", DEVICES / "drive.eds", "--bit-rate", "250k",
                     bus=plant.socketcand, expect=4)
        results = {one["node"]: one["result"] for one in said if "result" in one}
        require(results == {2: "added", 9: "added", 20: "no device file matches it"}, results)
        project("adopt", folder, "--eds", DEVICES, bus=plant.socketcand)
        project("diff", folder, bus=plant.socketcand)
        page = scratch / "adopted.html"
        project("report", folder, page, "--devices", bus=plant.socketcand)
        require("Canopus drive" in page.read_text() and "<script" not in page.read_text(), "the report")
    require([one["node"] for one in lines("show", folder)[1:]] == [2, 9, 20], "nodes")
    dcf = ini(folder / "canopus-drive.dcf")
    require((dcf["1017"]["ParameterValue"], int(dcf["1800sub1"]["ParameterValue"], 0)) == ("250", 0x1AB), "values")

    path = scratch / "adopted.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\nproject = "project-adopt/nodelist.cpj"\n')
    with running(path, has_plc=False) as plant:
        booted = command(program, "master", "--quiet", folder / "nodelist.cpj", "--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER).stdout
        require("3 of 3 slaves booted" in booted, booted)
        plant.wait_operational([2, 9, 20])
        project("diff", folder, bus=plant.socketcand)


@check
def names_of_strangers_do_no_harm():
    """A device file whose names are escape sequences, markup and paths."""
    hostile = scratch / "hostile.eds"
    text = (DEVICES / "drive.eds").read_text()
    hostile.write_text(text.replace("ProductName=Canopus drive", 'ProductName=\x1b[2J<script>alert(1)</script>../../x')
                       .replace("ParameterName=Statusword", 'ParameterName=\x1b]0;owned\x07"><img src=x>'))
    folder = new_project("project-hostile")
    project("add", folder, hostile, "--bit-rate", "250k")
    require(sorted(path.name for path in folder.iterdir()) == [".canopus", "nodelist.cpj", "2j-script-alert-1-script-x.dcf"]
            or len([path for path in folder.iterdir() if path.suffix == ".dcf"]) == 1, list(folder.iterdir()))
    require(not (scratch.parent / "x.dcf").exists(), "a file outside of the project")
    for words in (("show", folder), ("pdo", "list", folder), ("check", folder), ("show", folder, "1")):
        out = subprocess.run([program, "project", *map(str, words)], capture_output=True).stdout
        require(b"\x1b" not in out and b"\x07" not in out, words)
    page = scratch / "hostile.html"
    project("report", folder, page)
    require(not re.search(r"<(script|img)", page.read_text()), "markup of the device file is in the report")


@check
def reading_takes_over_what_was_changed_at_the_device():
    folder = new_project("project-read", (5, "Drive", DEVICES / "drive.eds"))
    with plant_of("project-read", [(5, DEVICES / "drive.eds", "")]) as plant:
        bus = f"socketcand:{plant.socketcand}"
        command(program, "sdo", "write", "5", "6081", "1234", "--type", "u32", "--bus", bus, "--timeout", ANSWER)
        command(program, "sdo", "write", "5", "6040", "15", "--type", "u16", "--bus", bus, "--timeout", ANSWER)  # process data
        said = lines("read", folder, bus=plant.socketcand)
        require([(one["object"], one["value"]) for one in said if "object" in one] == [("6081:00", 1234)], said)
        require(host_port(plant.socketcand), "")
    require(ini(folder / "drive.dcf")["6081"]["ParameterValue"] == "1234", "value")
    require("taken back: read all nodes" in project("undo", folder).stdout, "undo")
