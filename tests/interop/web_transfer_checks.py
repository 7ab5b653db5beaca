"""Checks of a transfer on the page of a project that does not go as it should: refused values, a device that keeps none, another device, and
somebody who writes to the devices meanwhile."""
import json

from kit import BROWSER_PATIENCE, HERE, browser, check, command, program, require, running_page, scratch, tier
from project_checks import DEVICES, lines, new_project, plant_of, project
from web_checks import page_with_key, pictures_of


@check
@tier("browser")
def web_transfer_says_what_was_not_written():
    """Each step with its abort; what the device has now counts; nothing is written that was not in the list."""
    chromium = browser()
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
            seen = json.loads(command("node", HERE / "web_transfer.mjs", chromium, page_with_key(page), pictures_of("transfer"), program, bus, timeout=BROWSER_PATIENCE).stdout)
        # The command line looks anew, says what it found, and writes that.
        command(program, "sdo", "write", "5", "6083", "555", "--type", "u32", "--bus", bus)
        said = lines("write", folder, "5", "--yes", bus=plant.socketcand, expect=6)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    found = next(i for i, row in enumerate(said) if row.get("object") == "6083:00")
    written = next(i for i, row in enumerate(said) if row.get("write") == "6083:00")
    require(found < written and said[found]["device"] == 555 and said[written]["state"] == "written", said)

    plan = {(row[0], row[1]): row for row in seen["plan"]}
    wanted = ["1017:00", "1800:01", "1A00:00", "1A00:02", "6081:00", "6083:00", "6084:00"]
    require([row[1] for row in seen["plan"] if row[0] == "5 drive"] == wanted and ("3 encoder", "1017:00") in plan, seen["plan"])
    others = [row for row in seen["plan"] if row[0] == "7 other"]
    require([row[1] for row in others] == ["1000:00", "1018:02"] and all(row[6] == "it is another device, which is left alone" for row in others), others)
    require(seen["plan_facts"] == "8 values differ; this is what will be written", seen["plan_facts"])

    require("have changed since this list was made" in seen["changed"], seen["changed"])
    anew = {(row[0], row[1]): row for row in seen["plan_anew"]}
    require(plan["5 drive", "6083:00"][4] == "10000" and anew["5 drive", "6083:00"][4] == "777", seen["plan_anew"])
    require(json.loads(seen["untouched"])["value"] == 0, "it was written before somebody had looked at the new list")

    results = [(row[0], row[1], row[5]) for row in seen["results"]]
    require(results == [("3 encoder", "1017:00", "written"),
                        ("5 drive", "1017:00", "written"),
                        ("5 drive", "1800:01", "written"), ("5 drive", "1A00:00", "written"), ("5 drive", "1A00:02", "refused"),
                        ("5 drive", "1A00:00", "not tried"), ("5 drive", "1800:01", "not tried"),
                        ("5 drive", "6081:00", "refused"),
                        ("5 drive", "6083:00", "written"),
                        ("5 drive", "6084:00", "acknowledged, but not kept"),
                        ("7 other", "1000:00", "different"), ("7 other", "1018:02", "different")], results)
    reasons = [row[6] for row in seen["results"]]
    require(reasons[4].startswith("abort 06040041H: ") and reasons[7] == "abort 06090031H: value too high", reasons)
    require(reasons[5] == reasons[6] == "not tried: the PDO stays off, as another part of it was refused", reasons)
    require(reasons[9:] == ["the device has 7 now"] + ["it is another device, which is left alone"] * 2, reasons)
    read_back = {row[1]: row[4] for row in seen["results"][1:10]}
    require(read_back == {"1017:00": "500", "1800:01": "0x800001AB", "1A00:00": "0", "1A00:02": "0x00000000", "6081:00": "1000", "6083:00": "3000", "6084:00": "7"}, read_back)
    require([row[2] for row in seen["results"]][7:9] == ["Profile velocity", "Profile acceleration"], seen["results"])
    require(seen["green"] == [object for _, object, state in results if state == "written"], seen["green"])
    require(seen["facts"] == "5 of 12 written" and seen["mood"] == "error", seen["facts"])
    require(seen["said"] == "7 of 12 values are not written; the list says why", seen["said"])
    # Another program reads what the page says.
    values = {name: json.loads(text)["value"] for name, text in seen["values"].items()}
    require((values["1017"], values["6081"], values["6083"], values["6084"]) == (500, 1000, 3000, 7), values)
    require(values["1800:01"] & 0x80000000, "the PDO is on with half of its mapping")

    require(seen["devices"][0] == "as the project" and seen["devices"][1].endswith(" differ"), seen["devices"])
    require(sorted(seen["differs"]) == ["1800:01", "1A00:00", "1A00:02", "6081:00", "6084:00"], seen["differs"])
    require(sorted(seen["same"]) == ["1017:00", "6083:00"], seen["same"])


def cut_off(name, extra=""):
    """A transfer to an encoder and to a drive, on a bus with this fault; what the page shows, and the drive's answers in their order."""
    with plant_of(name, [(3, DEVICES / "encoder.eds", ""), (5, DEVICES / "drive.eds", "")], extra) as plant:
        with running_page(scratch / "web-power-cut", "--bus", f"socketcand:{plant.socketcand}") as page:
            seen = json.loads(command("node", HERE / "web_power_cut.mjs", browser(), page_with_key(page), pictures_of("transfer"), timeout=BROWSER_PATIENCE).stdout)
        plant.stop()
    command(program, "trace", "convert", plant.trace, scratch / f"{name}.log")
    answers = [line.split("#")[1][:2] for line in (scratch / f"{name}.log").read_text().splitlines() if " 585#" in line]
    return seen, answers


@check
@tier("browser")
def web_transfer_to_a_device_whose_power_is_cut():
    """A device that falls silent in the middle of a write: nothing is shown as written that has not been read back; another device is written whole."""
    folder = new_project("web-power-cut", (3, "encoder", DEVICES / "encoder.eds"), (5, "drive", DEVICES / "drive.eds"))
    project("set", folder, "encoder", "1017=300")
    project("set", folder, "drive", "1017=500", "6081=2000", "6083=3000", "6084=4000")
    project("pdo", "map", folder, "drive", "tpdo1", "Statusword", "6077", "--can-id", "0x1AB")
    whole, answers = cut_off("web-whole")
    require(all(row[5] == "written" for row in whole["results"]) and len(whole["green"]) == len(whole["results"]) > 8, whole)
    written = [number for number, command_byte in enumerate(answers, 1) if command_byte == "60"]  # answers to downloads
    require(len(written) >= 8, answers)
    # The supply fails with the first, a middle and the last write of the drive, and before the last value is read back.
    for lost in (written[0], written[len(written) // 2], written[-1], len(answers) - 1):
        seen, _ = cut_off("web-cut", f'[[bus.fault]]\nkind = "drop"\nidentifier = 0x585\nfirst = {lost}\n')
        results = [(row[0], row[1], row[5], row[6]) for row in seen["results"]]
        require(("3 encoder", "1017:00", "written", "") in results, results)
        drive = [row for row in results if row[0] == "5 drive"]
        require(drive and all(row[2] != "written" or lost > written[-1] for row in drive), (lost, results))
        require([row for row in drive if row[2] != "written"], (lost, results))
        require(seen["green"] == [row[1] for row in results if row[2] == "written"], (lost, seen["green"]))
        require("written" in seen["facts"] and not seen["facts"].startswith(f"{len(results)} of") and seen["said"].startswith("5 drive: "), (lost, seen))
        require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)


@check
@tier("browser")
def web_dcf_of_a_node_is_saved_and_taken_over():
    """Save DCF keeps the file byte for byte; another DCF is compared, its values are taken over, and no others; another device's is refused."""
    chromium = browser()
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
        seen = json.loads(command("node", HERE / "web_dcf.mjs", chromium, page_with_key(page), pictures_of("project"), wanted, DEVICES / "encoder.eds", timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["saved"][0] == "drive.dcf" and seen["saved"][1].encode("latin-1") == before, seen["saved"][0])
    require("is of another device" in seen["refused"], seen["refused"])
    require(seen["differs"] == "wanted.dcf: 3 values differ", seen["differs"])
    require([row[0] for row in seen["rows"]] == [one["object"] for one in differences] and [row[4] for row in seen["rows"]] == [one["state"] for one in differences], seen["rows"])
    require(seen["same"] == "wanted.dcf: the same values", seen["same"])
    require(lines("dcf", "compare", folder, "drive", wanted) == [], "the values are not those of the DCF")
    project("undo", folder)
    require((folder / "drive.dcf").read_bytes() == before, "undo does not bring the values back")
