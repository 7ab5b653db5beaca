"""Checks of a transfer by the page of a project that does not go as it should (refused values, a device that keeps none, another device), and
of DCFs that the page saves and takes over."""
import json

from kit import ANSWER, check, command, program, require, running_page, scratch
from project_checks import DEVICES, lines, new_project, plant_of, project
from web_checks import PageClient


@check
def web_transfer_says_what_was_not_written():
    """Each step with its abort; what the device has now counts; nothing is written that was not in the list."""
    folder = new_project("web-transfer", (3, "encoder", DEVICES / "encoder.eds"), (5, "drive", DEVICES / "drive.eds"), (7, "other", DEVICES / "drive.eds"))
    project("set", folder, "encoder", "1017=300")
    project("set", folder, "drive", "1017=500", "6081=2000", "6083=3000", "6084=4000")
    project("pdo", "map", folder, "drive", "tpdo1", "Statusword", "6077", "--can-id", "0x1AB")
    project("set", folder, "other", "1017=500")
    # The drive takes at most 1500 for 6081H and has 6077H in no PDO; its 6084H is what it is, whatever it acknowledges. Node 7 is no drive.
    text = (DEVICES / "drive.eds").read_text()
    for old, new in (("ParameterName=Profile velocity\n", "ParameterName=Profile velocity\nHighLimit=1500\n"),
                     ("PDOMapping=1", "PDOMapping=0")):
        at = text.index("[6077]") if "PDO" in old else 0
        require(old in text[at:], old)
        text = text[:at] + text[at:].replace(old, new, 1)
    strict = scratch / "strict-drive.eds"
    strict.write_text(text)
    forced = '[[device.script]]\nat = "0s"\nset = { object = "6084", value = 7 }\n'
    with plant_of("web-transfer", [(3, DEVICES / "encoder.eds", ""), (5, strict, forced), (7, DEVICES / "encoder.eds", "")]) as plant:
        bus = f"socketcand:{plant.socketcand}"
        with running_page(folder, "--bus", bus) as page:
            client = PageClient(page)
            require(client.do(command="arm", on=True)[0]["code"] == 0, "arm")
            _, plan = client.do(command="project write")
            reply, results = client.do(command="project write", yes=True)
        values = {object: json.loads(command(program, "sdo", "read", "5", object, "--type", "u16" if object == "1017" else "u32", "--json", "--bus", bus, "--timeout", ANSWER).stdout)["value"]
                  for object in ("1017", "1800:01", "6081", "6083", "6084")}
        # The command line looks anew, says what it found, and writes that.
        command(program, "sdo", "write", "5", "6083", "555", "--type", "u32", "--bus", bus, "--timeout", ANSWER)
        said = lines("write", folder, "5", "--yes", bus=plant.socketcand, expect=6)
    found = next(i for i, row in enumerate(said) if row.get("object") == "6083:00")
    written = next(i for i, row in enumerate(said) if row.get("write") == "6083:00")
    require(found < written and said[found]["device"] == 555 and said[written]["state"] == "written", said)

    differs = [(row["node"], row["object"]) for row in plan if "object" in row and row.get("state") != "same"]
    require([object for node, object in differs if node == 5] == ["1017:00", "1800:01", "1A00:00", "1A00:02", "6081:00", "6083:00", "6084:00"], plan)
    require((3, "1017:00") in differs and all(row["state"] == "would be written" for row in plan if "write" in row), plan)
    require(reply["code"] == 6, reply)
    states = [(row["node"], row["write"], row["state"]) for row in results if "write" in row]
    require(states == [(3, "1017:00", "written"),
                       (5, "1017:00", "written"),
                       (5, "1800:01", "written"), (5, "1A00:00", "written"), (5, "1A00:02", "refused"),
                       (5, "1A00:00", "not tried"), (5, "1800:01", "not tried"),
                       (5, "6081:00", "refused"),
                       (5, "6083:00", "written"),
                       (5, "6084:00", "acknowledged, but not kept")], states)
    # Another program reads what the page was told.
    require((values["1017"], values["6081"], values["6083"], values["6084"]) == (500, 1000, 3000, 7), values)
    require(values["1800:01"] & 0x80000000, "the PDO is on with half of its mapping")


@check
def web_dcf_of_a_node_is_saved_and_taken_over():
    """Save DCF keeps the file byte for byte; another DCF is compared, its values are taken over, and no others; another device's is refused."""
    folder = new_project("web-dcf", (5, "drive", DEVICES / "drive.eds"))
    project("set", folder, "drive", "1017=500", "6081=2000")
    wanted = scratch / "wanted.dcf"
    project("dcf", "save", folder, "drive", wanted)
    require(wanted.read_bytes() == (folder / "drive.dcf").read_bytes(), "the DCF is not what the project has")
    project("set", folder, "drive", "1017=300", "6083=77")
    project("unset", folder, "drive", "6081")
    differences = [{"object": "1017:00", "name": "Producer heartbeat time", "state": "different", "project": "0x012C", "dcf": "0x01F4"},
                   {"object": "6081:00", "name": "Profile velocity", "state": "only in the DCF", "dcf": "0x000007D0"},
                   {"object": "6083:00", "name": "Profile acceleration", "state": "only in the project", "project": "0x0000004D"}]
    require(lines("dcf", "compare", folder, "drive", wanted, expect=4) == differences, "the command line compares otherwise")
    before = (folder / "drive.dcf").read_bytes()
    refused = project("dcf", "load", folder, "drive", DEVICES / "encoder.eds", expect=5).stderr
    require("is of another device: vendor-ID 00000000H, product code 00000406H; node 5 (drive) has 00000000H, 00000402H" in refused, refused)
    for broken, text in (("empty.dcf", ""), ("noise.dcf", "\x00\xff[["), ("folder.dcf", None)):
        path = scratch / broken
        if text is None:
            path.mkdir(exist_ok=True)
        else:
            path.write_text(text, encoding="latin-1")
        refused = project("dcf", "load", folder, "drive", path, expect=3).stderr
        require(refused.startswith("canopus project: "), refused)
    require((folder / "drive.dcf").read_bytes() == before, "a refused DCF has changed the project")
    with running_page(folder) as page:
        client = PageClient(page)
        file_of = lambda path: {"name": path.name, "text": path.read_text(encoding="latin-1")}
        require(client.do(command="project dcf save", node="5")[0]["file"].encode("latin-1") == before, "the DCF that is saved")
        reply, _ = client.do(command="project dcf load", node="5", file=file_of(DEVICES / "encoder.eds"))
        require(reply["code"] == 5 and "is of another device" in reply["message"], reply)
        reply, rows = client.do(command="project dcf compare", node="5", file=file_of(wanted))
        require(reply["code"] == 4 and rows == differences, (reply, rows))
        require(client.do(command="project dcf load", node="5", file=file_of(wanted))[0]["code"] == 0, "load")
    require(lines("dcf", "compare", folder, "drive", wanted) == [], "the values are not those of the DCF")
    project("undo", folder)
    require((folder / "drive.dcf").read_bytes() == before, "undo does not bring the values back")
