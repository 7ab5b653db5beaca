"""Checks of `canopus project` and its files: XDCs, judged by readers of XML and INI that are not ours; files of other tools;
outputs that nobody reads; folders and disks that take nothing."""
import os
import shutil
import subprocess
import tomllib
import xml.etree.ElementTree as ET

from kit import ANSWER, PATIENCE, ROOT, Skip, check, command, program, require, running, scratch
from project_checks import lines, new_project, project

DEVICES = ROOT / "examples/devices"


def as_xdd(name):
    """A device file of the examples as XDD."""
    path = scratch / f"{name}.xdd"
    command(program, "eds", "convert", DEVICES / f"{name}.eds", path)
    return path


def local(name):
    return name.rsplit("}", 1)[-1]


def values_of_xdc(path):
    """(index, sub) -> actualValue."""
    values = {}
    for element in ET.parse(path).getroot().iter():
        if local(element.tag) == "CANopenObject":
            index = element.get("index")
            values[index, None] = element.get("actualValue")
        elif local(element.tag) == "CANopenSubObject":
            values[index, element.get("subIndex")] = element.get("actualValue")
    return {key: value for key, value in values.items() if value is not None}


def changed_lines(before, after):
    a, b = before.split(b"\n"), after.split(b"\n")
    require(len(a) == len(b), "lines were added or taken out")
    return [new for old, new in zip(a, b) if old != new]


def unread(*words, cwd=None, out=True, error=True):
    """The program with pipes that nobody reads."""
    reader, writer = os.pipe()
    os.close(reader)
    with open(os.devnull, "wb") as nothing:
        done = subprocess.run([program, *map(str, words)], stdout=writer if out else nothing, stderr=writer if error else nothing,
                              cwd=cwd, timeout=PATIENCE)
    os.close(writer)
    return done.returncode


@check
def xdd_files_are_nodes_of_projects():
    folder = new_project("project-xdd", (3, "Encoder", as_xdd("encoder")), (4, "Drive", as_xdd("drive")))
    twin = new_project("project-xdd-twin", (3, "Encoder", DEVICES / "encoder.eds"), (4, "Drive", DEVICES / "drive.eds"))
    before = (folder / "drive.xdc").read_bytes()
    project("set", folder, "Drive", "1017=500")
    after = (folder / "drive.xdc").read_bytes()
    require(len(changed_lines(before, after)) == 1, "more than a line")
    require(values_of_xdc(folder / "drive.xdc") == {("1017", None): "500"}, values_of_xdc(folder / "drive.xdc"))
    for commissioning in (one for one in ET.parse(folder / "drive.xdc").getroot().iter() if local(one.tag) == "deviceCommissioning"):
        require((commissioning.get("nodeID"), commissioning.get("nodeName"), commissioning.get("actualBaudRate"))
                == ("4", "Drive", "250 Kbps"), commissioning.attrib)
    project("undo", folder)
    require((folder / "drive.xdc").read_bytes() == before, "undo")
    # The same words to a project of DCFs lead to the same concise DCFs, loads and links.
    for one in (folder, twin):
        project("set", one, "Drive", "1017=500", "6081=2000")
        project("unset", one, "Drive", "1017")
        project("pdo", "link", one, "Encoder.6004", "Drive.607A")
        project("pdo", "map", one, "Drive", "tpdo4", "Statusword", "--event", "100ms", "--can-id", "free")
        project("concise", one, "Drive", scratch / f"{one.name}.bin")
    require((scratch / "project-xdd.bin").read_bytes() == (scratch / "project-xdd-twin.bin").read_bytes(), "concise DCFs differ")

    def said(one):
        text = project("pdo", "list", one, "--all").stdout + project("show", one, "Drive").stdout
        return text.replace("encoder.xdc", "encoder.dcf").replace("drive.xdc", "drive.dcf")
    require(said(folder) == said(twin), said(folder) + said(twin))
    project("report", folder, scratch / "project-xdd.html")
    require("drive.xdc" in (scratch / "project-xdd.html").read_text(), "report")
    plant = scratch / "project-xdd.toml"
    plant.write_text(f'[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\nproject = "{folder}/nodelist.cpj"\n')
    with running(plant, has_plc=False) as plant:
        found = lines("diff", folder, bus=plant.socketcand)
        require([one["state"] for one in found if "values" in one] == ["same", "same"], found)
        project("set", folder, "Drive", "6081=2001")
        project("write", folder, "--yes", bus=plant.socketcand)
        command(program, "sdo", "write", "4", "6081", "1234", "--type", "u32", "--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER)
        project("read", folder, "Drive", bus=plant.socketcand)
    require(values_of_xdc(folder / "drive.xdc")["6081", None] == "1234", values_of_xdc(folder / "drive.xdc"))


@check
def a_network_is_adopted_from_xdd_files():
    devices = scratch / "adopt-xdd"
    shutil.rmtree(devices, ignore_errors=True)
    devices.mkdir()
    for name in ("encoder", "drive"):
        shutil.copy(as_xdd(name), devices)
    plant = scratch / "adopt-xdd.toml"
    plant.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n' + "".join(
        f'[[device]]\nnode = {node}\neds = "{devices}/{name}.xdd"\n' for node, name in ((3, "encoder"), (4, "drive"))))
    folder = new_project("project-adopt-xdd")
    with running(plant, has_plc=False) as running_plant:
        # Nobody reads what it says; the network is taken over nevertheless.
        code = unread("project", "adopt", folder, "--eds", devices, "--bit-rate", "250k", "--bus",
                      f"socketcand:{running_plant.socketcand}", "--timeout", ANSWER)
        require(code == 0, code)
        project("check", folder)
        project("diff", folder, bus=running_plant.socketcand)
    require(sorted(path.suffix for path in folder.iterdir() if path.is_file()) == [".cpj", ".xdc", ".xdc"], list(folder.iterdir()))


@check
def what_nobody_reads_is_done_nevertheless():
    """`canopus eds convert ... 2>&1 | head -1` and the like: the file is the same as with a reader."""
    folder = new_project("project-unread", (4, "Drive", DEVICES / "drive.eds"))
    trace = scratch / "unread.log"
    trace.write_text("".join(f"(1.{i:06}) can0 184#{i % 256:02X}\n" for i in range(500)) + "nonsense\n")
    noisy = scratch / "unread.eds"
    noisy.write_text((DEVICES / "drive.eds").read_text().replace("DefaultValue=", "DefaultValue=zz", 20))

    def written(path, *words):
        path.unlink(missing_ok=True)
        subprocess.run([program, *map(str, words)], capture_output=True, timeout=PATIENCE)
        whole = path.read_bytes()
        for out, error in ((True, True), (True, False), (False, True)):
            path.unlink()
            unread(*words, out=out, error=error)
            require(path.read_bytes() == whole, f"{words}: {path} is another file")
    written(scratch / "unread.xdd", "eds", "convert", noisy, scratch / "unread.xdd")
    written(scratch / "unread.asc", "trace", "convert", trace, scratch / "unread.asc")
    written(scratch / "unread-me.eds", "module", "eds", "me3can1-q", "-o", scratch / "unread-me.eds")
    written(scratch / "unread.html", "project", "report", folder, scratch / "unread.html")
    written(scratch / "unread.bin", "project", "concise", folder, "Drive", scratch / "unread.bin")
    for word, value in (("set", "1017=500"), ("unset", "1017")):
        require(unread("project", word, folder, "Drive", value) == 0, word)
    require(unread("project", "pdo", "map", folder, "Drive", "tpdo4", "Statusword") == 0, "pdo map")
    require("tpdo4" in project("undo", folder).stdout and "unset" in project("undo", folder).stdout, "undo")
    # Who only lists something ends with his reader, as ever.
    require(unread("project", "show", folder) == -13, "show")
    # A full disk under the output is said, after the work.
    with open("/dev/full", "wb") as full:
        done = subprocess.run([program, "project", "pdo", "map", folder, "Drive", "tpdo4", "Statusword"], stdout=full,
                              stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    require(done.returncode == 1 and "No space left on device" in done.stderr, done)
    require("tpdo4" in project("undo", folder).stdout, "the change was lost")


@check
def a_replaced_device_is_accepted():
    text = (DEVICES / "drive.eds").read_text()
    place = text.index("[1018sub4]")
    end = text.index("\n", text.index("DefaultValue=", place))
    (scratch / "other-drive.eds").write_text(text[:text.index("DefaultValue=", place)] + "DefaultValue=0x4711" + text[end:])
    folder = new_project("project-accept", (4, "Drive", DEVICES / "drive.eds"))
    other = new_project("project-accept-xdc", (4, "Drive", as_xdd("drive")))
    plant = scratch / "project-accept.toml"
    plant.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                     f'[[device]]\nnode = 4\neds = "{scratch}/other-drive.eds"\n')
    with running(plant, has_plc=False) as plant:
        for one, name in ((folder, "drive.dcf"), (other, "drive.xdc")):
            before = {path: path.read_bytes() for path in one.iterdir() if path.is_file()}
            found = lines("accept", one, "Drive", bus=plant.socketcand, expect=4)
            require([(row.get("object"), row.get("device"), row["state"]) for row in found]
                    == [("1018:04", 0x4711, "different"), (None, None, "different")], found)
            require(before == {path: path.read_bytes() for path in one.iterdir() if path.is_file()}, "written without --yes")
            code = unread("project", "accept", one, "4", "--yes", "--bus", f"socketcand:{plant.socketcand}", "--timeout", ANSWER)
            require(code == 0, f"exit code {code}")
            after = {path: path.read_bytes() for path in one.iterdir() if path.is_file()}
            require([path.name for path in after if after[path] != before[path]] == [name], "other files")
            require("is the device that the project has" in project("accept", one, "4", bus=plant.socketcand).stdout, "again")
            require("taken back: accept 4" in project("undo", one).stdout, "undo")
            require(before == {path: path.read_bytes() for path in one.iterdir() if path.is_file()}, "undo")
        project("set", folder, "4", "--node-id", "5")
        project("accept", folder, "5", "--timeout", "200ms", bus=plant.socketcand, expect=1)


@check
def notes_are_shown_and_taken_back():
    folder = new_project("project-notes", (3, "Encoder", as_xdd("encoder")), (4, "Drive", DEVICES / "drive.eds"))
    hostile = "<b>seal</b> \x1b[2J\"worn\"\nForged: line \\ \U0001F527"
    project("note", folder, "Drive", hostile)
    with (folder / "nodelist.notes.toml").open("rb") as file:
        require(tomllib.load(file) == {"notes": {"4": hostile}}, "Python reads another note")
    shown = lines("show", folder)
    require([row.get("note") for row in shown if "node" in row] == [None, hostile], shown)
    text = project("show", folder).stdout + project("show", folder, "Drive").stdout
    require("\x1b" not in text and "\nForged" not in text and text.count("worn") == 2, text)
    project("report", folder, scratch / "notes.html")
    page = (scratch / "notes.html").read_text()
    require("<b>" not in page and "&lt;b&gt;seal" in page, "report")
    project("set", folder, "Drive", "--node-id", "9")
    require(lines("show", folder, "9")[0]["note"] == hostile, "the note stayed behind")
    project("remove", folder, "9")
    require(not (folder / "nodelist.notes.toml").exists(), "a note of nobody")
    for number in range(3):
        require((folder / "nodelist.notes.toml").exists() == (number > 0), "undo")
        project("undo", folder)
    require(not (folder / "nodelist.notes.toml").exists(), "undo")
    project("note", folder, "7", "x", expect=5)
    project("note", folder, "4", "x" * 4001, expect=5)


@check
def projects_of_other_tools_are_taken_as_they_are():
    """Keys in lower case, Windows paths, Latin-1, a byte order mark, UTF-16, a path that leads elsewhere."""
    folder = scratch / "project-foreign"
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "dcfs").mkdir(parents=True)
    text = (DEVICES / "drive.eds").read_text()
    xdc = as_xdd("drive").read_text()

    def dcf(node, name):
        return f"{text}\n[DeviceComissioning]\nNodeID={node}\nNodeName={name}\nBaudrate=250\n"
    files = {"dcfs/pumpe \xfc.dcf": dcf(3, "Pumpe \xfc").encode("latin-1"), "dcfs/two.dcf": b"\xef\xbb\xbf" + dcf(4, "Zwei").encode(),
             "dcfs/three.dcf": dcf(5, "Drei").encode("utf-16"), "dcfs/four.XDC": b"\xef\xbb\xbf" + xdc.replace("\n", "\r\n").encode(),
             "dcfs/latin.xdc": xdc.replace("UTF-8", "ISO-8859-1").replace("Statusword", "Zustandsw\xf6rt").encode("latin-1")}
    for name, content in files.items():
        (folder / name).write_bytes(content)
    names = {3: "dcfs\\pumpe \xfc.dcf", 4: ".\\dcfs\\two.dcf", 5: "dcfs\\three.dcf", 6: "C:\\x\\y.dcf", 7: "dcfs\\four.XDC",
             8: "dcfs/latin.xdc", 9: "..\\..\\etc\\passwd"}
    (folder / "nodelist.cpj").write_bytes(("[topology]\nnetname=Halle \xfc\nnodes=0x7\n" + "".join(
        f"node{node}present=1\nnode{node}dcfname={name}\n" for node, name in names.items())).encode("latin-1"))
    rows = {row["node"]: row for row in lines("show", folder) if "node" in row}
    require({node for node, row in rows.items() if "error" in row} == {6, 9}, rows)
    for node, name in ((3, "dcfs/pumpe \xfc.dcf"), (4, "dcfs/two.dcf"), (7, "dcfs/four.XDC"), (8, "dcfs/latin.xdc")):
        project("set", folder, str(node), "1017=100")
        path = folder / name
        before, after = files[name].split(b"\n"), path.read_bytes().split(b"\n")
        kept = [line for line in after if line in before]
        require(len(after) - len(kept) == 1 and len(after) - len(before) in (0, 1), f"{name}: more than a line")
        project("undo", folder)
        require(path.read_bytes() == files[name], f"{name}: undo")
    project("set", folder, "5", "1017=100")  # UTF-16 stays UTF-16
    before, after = (content.decode("utf-16").split("\n") for content in (files["dcfs/three.dcf"], (folder / "dcfs/three.dcf").read_bytes()))
    require(len(after) - len(before) in (0, 1) and len([line for line in after if line not in before]) == 1, "UTF-16: more than a line")
    project("undo", folder)
    require((folder / "dcfs/three.dcf").read_bytes() == files["dcfs/three.dcf"], "UTF-16: undo")


@check
def a_full_or_read_only_disk_changes_nothing():
    disk = scratch / "small-disk"
    disk.mkdir(exist_ok=True)
    script = f"""mount -t tmpfs -o size=120k none '{disk}' || exit 77
cd '{disk}' && '{program}' project new p >&2 && '{program}' project add p '{DEVICES}/drive.eds' --name d1 >&2 || exit 1
find . -type f ! -name .lock | sort | xargs sha256sum > '{scratch}/small-disk.sums'
head -c 200000 /dev/zero > fill 2> /dev/null
for words in "set p 1 1017=5" "note p 1 x" "add p {DEVICES}/drive.eds" "remove p 1"
do '{program}' project $words > /dev/null; echo $?; done
rm fill && mount -o remount,ro '{disk}' || exit 1
for words in "set p 1 1017=5" "note p 1 x" "undo p" "new q"; do '{program}' project $words > /dev/null; echo $?; done
'{program}' project show p > /dev/null; echo $?
find . -type f ! -name .lock | sort | xargs sha256sum | diff - '{scratch}/small-disk.sums' && echo same"""
    done = subprocess.run(["unshare", "-rm", "sh", "-c", script], capture_output=True, text=True, timeout=PATIENCE)
    if done.returncode == 77 or "unshare" in done.stderr:
        raise Skip("no file system can be mounted here")
    require(done.stdout.split() == ["3"] * 8 + ["0", "same"], done.stdout + done.stderr)
    require(done.stderr.count("No space left on device") == 4 and done.stderr.count("Read-only file system") == 4, done.stderr)
