"""Checks of a module's settings on the page, in a real Chromium: the table of the RJ71CN91's configuration tool row by row, and the way to the module."""
import csv
import json
import os
import pathlib
import re

from configure_checks import state, tool
from configure_rj71cn91_checks import module_of, new, number, rack
from kit import HERE, ROOT, Skip, browser, check, command, program, require, running, running_page, scratch, tier
from web_checks import Watcher, page_of, page_with_key

TOOL = ROOT.parent / "shared/spec/rj71cn91/config-tool.csv"

# Where the items of a window of the table are: the page's window, and in which form or list of it.
WINDOWS = {
    "CANopen Configuration": ("basic", "form"), "CANopen node settings": ("basic", "details"),
    "PDO list (Transmit PDO / Receive PDO)": ("tpdo", "row"), "TPDO details": ("tpdo", "details"), "RPDO details": ("rpdo", "details"),
    "NMT settings": ("master", "form"), "NMT master / slave": ("master", "form"), "NMT slave assignment": ("slave", "row"), "NMT slave": ("slave", "details"),
    "Heartbeat": ("consumer", "row"), "Transfer Setup": ("setup", "form"), "Setup wizard: PC side": ("setup", "form"), "Setup wizard: PLC side": ("setup", "form"),
    "Setup wizard: communication path": ("setup", "form"), "Download Configuration": ("transfer", "form"), "Network scan": ("scan", "form"), "SDO send / receive": ("sdo", "form"),
    "Module status": ("status", "form"), "NMT master reset": ("reset", "form"), "Export / Import": ("export", "form"),
}

# Items without a name of their own, by what shows them; None: a name that is on the page for something else.
CALLED = {
    ("NMT slave assignment", "List"): "NMT slave assignment", ("Heartbeat", "List"): "Heartbeat, consumer", ("TPDO details", "Mapping: limit"): "Mapping", ("RPDO details", "Mapping: limit"): "Mapping",
    ("Menu: Project", "New"): "New settings", ("Menu: Project", "Open"): "Settings of modules", ("SDO send / receive", "Explanation"): "Description window", ("Module status", "Status view"): "Module status",
}


def table():
    if not TOOL.exists():
        raise Skip(f"{TOOL} is not there")
    return list(csv.DictReader(TOOL.open()))


def printed(item):
    """An item's name without the list or group that it is in, and without the brackets of a button."""
    return re.sub(r"^(Node list|COB-ID|Mapping): | \([TR]PDO\)$|^\[|\]$", "", item)


def field_tests(rows):
    """For each field with a range: values that do not fit, and those at its ends."""
    tests = []
    for row in rows:
        page, scope = WINDOWS.get(row["window"], ("", ""))
        name = printed(row["item"])
        if page not in ("basic", "tpdo", "rpdo", "master", "slave", "consumer") or row["kind"] not in ("field", "column", "check box"):
            continue
        if row["item"].startswith("Mapping") or name in ("PDO number",) or (name == "Node ID" and page != "basic") or row["item"] == "Node list: Node ID":
            continue  # the number of a row, and the mapping: by their own steps
        if page == "basic" and row["range"] == "":
            continue  # what a node says of itself
        if row["item"] == "Transmission type (RPDO)":
            page = "rpdo"
        if row["item"].startswith("Node list: "):
            scope = "row"
        if name == "Producer heartbeat time":
            scope = "form"
        test = {"page": page, "scope": scope, "name": name, "refused": [], "taken": []}
        bounds = re.fullmatch(r"(0x)?([0-9A-F]+)-(0x)?([0-9A-F]+)(?: ms)?", row["range"])
        if row["item"] in ("Node list: Node name", "Node name"):
            test |= {"taken": ["Pump 1", "x" * 256]}
        elif bounds:
            base = 16 if bounds[1] else 10
            lowest, highest = int(bounds[2], base), int(bounds[4], base)
            shown = (lambda n: f"0x{n:X}") if base == 16 else str
            test["refused"] = [shown(highest + 1), "x", *([shown(lowest - 1)] if lowest else [])]
            test["taken"] = [shown(highest), shown(lowest)]
            if name == "Guard time" or name == "Timeout":
                test["refused"].append("-1")
            if name == "Priority time slot":
                test["taken"].reverse()  # more than 127 times the time slot of a device, or nothing is written
            if name == "Module address":
                test["refused"].append("0x8")
                test["taken"] = ["0xFE0", "0x0"]
        elif name == "Baud-Rate":
            test["taken"] = [re.match(r"\d+", one)[0] for one in row["range"].split(";")]
        elif ";" in row["range"]:
            test["taken"] = [one.strip() for one in row["range"].split(";")]
        elif row["kind"] == "check box" or page == "slave" or name == "valid":
            test["taken"] = ["Selected", "Not selected"]
        else:
            raise AssertionError(row)
        tests.append(test)
    # What refers to others is left as the rest wants it.
    order = ["master", "basic", "tpdo", "rpdo", "slave", "consumer"]
    tests = [one for one in tests if not (one["page"] == "master" and one["name"] == "NMT master")] + [
        {"page": "master", "scope": "form", "name": "NMT master", "refused": [], "taken": ["Selected"]}]
    return sorted(tests, key=lambda one: order.index(one["page"]))


@check
@tier("browser")
def web_settings_in_chromium():
    """All fields of the RJ71CN91's tool on the page: values out of range are refused with the range, those at its ends are taken; mapping, transfer, SDO, scan, status, backups."""
    rows = table()
    chromium = browser()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "settings"
    pictures.mkdir(parents=True, exist_ok=True)
    path, backup = new("web-settings"), new("web-backup", ("basic", "Node ID=77"))
    tests = field_tests(rows)
    fields = scratch / "web-settings.json"
    fields.write_text(json.dumps(tests))
    with running(rack("web-settings"), words=["--web", "--web-settings", str(path)]) as plant:
        module = module_of(plant)
        seen = json.loads(command("node", HERE / "web_settings.mjs", chromium, page_with_key(plant), pictures, fields, backup, timeout=400).stdout)
        stored = [module.g(n) for n in (24, 27, 71)], number(module, 0x1F80, 0)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], (seen["problems"], seen["axe"], seen["overflow"]))

    # Each name that the table prints, in the window that it is for; which are not on the page, the manual's page says.
    # Of `canopus web` alone; web_start_in_chromium sees them there.
    seen["names"]["start"] = ["New settings", "Settings of modules", "Start", "Save as", "Recent Projects", "Exit", "Close"]
    shown_on = {}
    for row in rows:
        page, _ = WINDOWS.get(row["window"], ("", ""))
        names = set(seen["names"].get(page, [])) if page else {name for names in seen["names"].values() for name in names}
        if row["item"] == "Transmission type (RPDO)":
            names = set(seen["names"]["rpdo"])
        wanted = CALLED.get((row["window"], row["item"]), printed(row["item"]))
        shown_on[row["window"], row["item"]] = wanted is not None and any(name.lower() == wanted.lower() for name in names)
    told = {}
    window = ""
    for line in (ROOT / "docs/configure-rj71cn91.md").read_text().splitlines():
        if line.startswith("## "):
            window = line[3:]
        cells = [cell.strip() for cell in line.strip("|").split(" | ")]
        if window and len(cells) == 5 and cells[0] not in ("item", "---"):
            told[window, cells[0].replace("\\|", "|")] = cells[4] != ""
    print(f"    {sum(shown_on.values())} of the {len(rows)} items are on the page, the others in the command line")
    require(len(rows) == 188 and told.keys() == shown_on.keys(), sorted(set(told) ^ set(shown_on)))
    require(told == shown_on, [(key, "is" if shown else "is not", "on the page") for key, shown in shown_on.items() if told[key] != shown])

    # Fields: every test came to its end, and its sentences are those of the description.
    described = {}
    for line in command(program, "configure", "describe", "--model", "RJ71CN91", "--json").stdout.splitlines():
        row = json.loads(line)
        if "field" in row:
            described[row["window"], row["field"]] = row
    require([(one["page"], one["name"]) for one in seen["fields"]] == [(one["page"], one["name"]) for one in tests], "the fields that were tried")
    count = 0
    for one, test in zip(seen["fields"], tests):
        word = {"consumer": "producer"}.get(one["page"], one["page"]) if one["name"] == "Producer heartbeat time" else \
            "node" if one["name"] == "Download target" else one["page"]
        expected = described.get((word, one["name"]), {}).get("range", "")
        if one["name"] == "CAN-ID (11-bit)":
            expected = "0x000 to 0x57F"
        for refused in one["refused"]:
            count += 1
            steps = refused["value"] == "0x8"
            require(refused["mood"] == "error" and refused["invalid"] == "true" and refused["kept"] == refused["value"] and one["name"] in refused["said"], refused)
            require(("expected steps of 0x10" if steps else f"expected {expected}") in refused["said"], (one["name"], refused, expected))
        for taken in one["taken"]:
            count += 1
            same = taken["shown"] == taken["value"] or (re.match("0x|[0-9]", taken["value"]) and int(taken["shown"], 0) == int(taken["value"], 0))
            require(same and taken["invalid"] != "true", (one["name"], taken))
        if one["name"] != "Node name":
            require(one["name"] in one["description"] and expected in one["description"], (one["name"], one["description"]))
    print(f"    {len(tests)} fields, {count} values")

    numbers = {"basic": "127", "tpdo": "256", "rpdo": "256", "slave": "127", "consumer": "127"}
    for key, highest in numbers.items():
        require(f"/{highest}" in seen["new_rows"][key] and "expected" in seen["new_rows"][key], seen["new_rows"])
    require(len(seen["names_to_map"]) == 8 and len(seen["names_to_receive"]) == 14, (seen["names_to_map"], seen["names_to_receive"]))
    require(seen["first_mapped"] == ["Un\\G13000", "Unsigned16", "0xA100", "0x01"], seen["first_mapped"])
    require(seen["second_mapped"] == ["Buffer Memory Area Integer32", "Un\\G13002-Un\\G13003"] and seen["bits"] == "48 of 64 bits are mapped", seen["second_mapped"])
    require("80 bits: expected at most 64" in seen["too_many_bits"], seen["too_many_bits"])
    require(seen["mapping_refused"][0] == "Index = 10000: expected 0x0000 to 0xFFFF" and seen["mapping_refused"][1].startswith("Index = G: ")
            and "expected one from Un\\G13000-Un\\G13001 to Un\\G14022-Un\\G14023" in seen["mapping_refused"][2], seen["mapping_refused"])
    require(seen["not_mappable"].startswith("0xA1C0:0xFF is none of"), seen["not_mappable"])

    # The module has what the page says.
    require(seen["undone"][0][:2] == ["taken back: set basic Node ID=102", "101"] and seen["undone"][1][0] == "taken back: set basic Node ID=101" and seen["undo_restored"] and not seen["look_undo"], seen["undone"])
    require(seen["write"] == {"clicks": 1, "typed": 0} and any("SDO timeout" in line for line in seen["plan"]), seen["plan"])
    require("is in RUN" in seen["in_run"], seen["in_run"])
    require(seen["plan_of_all"] > len(seen["plan"]) and "Transmission type: the module has FEH" in seen["marked"], seen["marked"])
    require(seen["steps"] and all(one.endswith("done") for one in seen["steps"]) and "read back: the same" in seen["written"], (seen["written"], seen["steps"]))
    require(seen["compared"] == "the module has it all", seen["compared"])
    require(stored == ([250, 1, 50], 1), stored)
    require(seen["sdo_read"].startswith("SDO_READ_SUCCESS|hexadecimal0x00000401|decimal1025|"), seen["sdo_read"])
    require("06020000H" in seen["sdo_no_object"], seen["sdo_no_object"])
    for refused, what in zip(seen["sdo_refused"], ("Node ID = 128: expected 1 to 127", "Index = 0x10000: expected 0x0000 to 0xFFFF", "Sub-index = 0x100: expected 0x00 to 0xFF")):
        require(refused.startswith(what), refused)
    require(seen["sdo_write"] == "SDO_WRITE_SUCCESS" and "decimal1500" in seen["sdo_after"], (seen["sdo_write"], seen["sdo_after"]))
    require(len(seen["scanned"]) >= 1 and any(one.startswith("3Canopus") for one in seen["scanned"]), seen["scanned"])
    require(re.match(r"negotiation: 500 ms \+ 1 x 1500 ms \+ \d+ x 10 ms = [\d.]+ s after a reset, .*; it takes no part", seen["negotiation"]) and "1270 ms is not more than 127 x 10 ms = 1270 ms" in seen["overlap"], (seen["negotiation"], seen["overlap"]))
    require("Function mode405" in seen["status"] and any(one.startswith("Error status") for one in seen["status"]), seen["status"])
    require("has started again" in seen["reset"] and "ProtocolTCP" in seen["setup"] and "R04" in seen["test"], (seen["setup"], seen["test"]))
    require({"CPU typeR04", "CPU seriesR", "Connect CPU seriesR", "Multiple CPUNone"} <= set(seen["setup"]), seen["setup"])
    require(seen["node_file"][-2:] == ["EDS file version1", "EDS file revision1"], seen["node_file"])
    require("1025" in seen["identity"] and "983441" in seen["identity"], seen["identity"])
    require(any("Canopus I/O block" in row for row in seen["hardware"]) and seen["read"] == "the file has what the module has", (seen["hardware"], seen["read"]))
    require(seen["asked"] == ["The object dictionaries of all listed nodes are written into their memory.", "All listed nodes lose their settings; defaults count after a reset of the nodes."], seen["asked"])
    require(seen["import_refused"].startswith("wrong.xml:1: ") and seen["imported"] == "77", (seen["import_refused"], seen["imported"]))
    exported = pictures / "exported.xml"
    tool(None, "check", exported, expect=0)
    require(seen["description_hidden"], "the description window stays")
    require(len(seen["lists"]) == 15 and all(count >= 1 and problems == [] for count, problems in seen["lists"].values()), seen["lists"])
    require(not [one for one in seen["look_enabled"] if not re.match(r"\d+$|Close|Node ID|PDO|First|Last", one)], seen["look_enabled"])


@check
def web_settings_of_a_live_plc_are_armed():
    """`canopus web FILE.xml`: no plant and no bus; nothing is written before it is armed, and nobody without the key writes at all."""
    path = new("web-live")
    with running(rack("web-live")) as plant:
        module_of(plant)
        host, port = plant.mc.rsplit(":", 1)
        tool(None, "setup", "set", "live one", "--host", host, "--port", port, "--timeout", "2s")
        with running_page(path, "--setup", "live one", "--timeout", "4s") as page:
            key = page_with_key(page).partition("#key=")[2]
            _, web_port = page_of(page)
            owner, looker = Watcher(web_port, key=key), Watcher(web_port)
            number = iter(range(1, 1000))

            def done(watcher, **words):
                own = next(number)
                watcher.say({"do": words, "id": own})
                rows = []
                while True:
                    reply = watcher.event(lambda e: e["event"] == "reply" and e["id"] == own)
                    rows += reply.get("rows", [])
                    if not reply.get("more"):
                        return reply, rows

            hello = done(owner, command="hello")[0]
            require(hello["buses"] == [] and [one["file"] for one in hello["settings"]] == [str(path)] and hello["settings"][0]["live"], hello)
            require(hello["settings"][0]["setup"] == "live one" and hello["settings"][0]["plc"] == [f"--host={host}", "--timeout=4s", f"--port={port}"], hello)
            require(done(owner, command="configure sdo-read", node="3", object="1018:02")[0]["code"] == 0, "reading needs no arming")
            for words in ({"command": "configure sdo-write", "node": "3", "object": "1017", "data": "500"}, {"command": "configure write", "yes": True},
                          {"command": "configure reset"}, {"command": "configure nodes save"}, {"command": "configure nodes restore"}, {"command": "configure status clear"}):
                reply, _ = done(owner, **words)
                require(reply["code"] == 8 and "leads to a live module; arm writing first" in reply["message"], (words, reply))
                require(done(looker, **words)[0]["code"] == 7, words)
            require(done(owner, command="configure write")[0]["code"] == 0, "what would be written may be looked at")
            for name in ("configure set", "configure read", "configure import", "configure delete", "configure defaults", "configure identify"):
                reply, _ = done(looker, command=name, window="basic", row="tpdo/1", node="3", items=["Node ID=5"], file={"name": "a", "text": ""})
                require(reply["code"] in (2, 7), (name, reply))
            require(done(looker, command="configure set", window="basic", items=["Node ID=5"])[0]["code"] == 7, "who only looks")
            before = path.read_bytes()
            for words in ({"command": "configure set", "window": "--help"}, {"command": "configure set", "window": "basic", "items": ["--json"]},
                          {"command": "configure show", "window": "../x"}, {"command": "configure show", "settings": "/etc/passwd"}, {"command": "configure new"},
                          {"command": "configure import", "file": {"name": "../../x.xml", "text": "<x"}}, {"command": "plc write"}, {"command": "configure delete", "row": "basic"}):
                reply, _ = done(owner, **words)
                require(reply["code"] == 2, (words, reply))
            require(path.read_bytes() == before, "a refused command has changed the file")
            require(done(owner, command="arm", on=True)[0]["code"] == 0, "armed")
            require(done(owner, command="configure sdo-write", node="3", object="1017", data="500")[0]["code"] == 0, "written")
            require(done(owner, command="project show")[0]["code"] == 2, "there is no bus")
    wrong = scratch / "no-settings.xml"
    wrong.write_text("<plant/>\n")
    done = command(program, "web", wrong, "--for", "10ms", expect=3, env=state())
    require("no-settings.xml:1" in done.stderr and "canopus configure new" in done.stderr, done.stderr)
