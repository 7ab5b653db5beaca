"""Checks of a module's settings by the page's commands: the table of the RJ71CN91's configuration tool row by row, and the way to the module."""
import csv
import json
import re

from configure_checks import state, tool
from configure_rj71cn91_checks import module_of, new, rack
from kit import ROOT, Skip, check, command, program, require, running, running_page, scratch
from web_checks import PageClient, Watcher, page_of, page_with_key

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
def web_settings_take_what_the_table_allows():
    """All fields of the RJ71CN91's tool by the page's commands: values out of range are refused with the range, those at its ends are taken."""
    tests = field_tests(table())
    path = new("web-settings")
    described = {}
    for line in command(program, "configure", "describe", "--module", "RJ71CN91", "--json").stdout.splitlines():
        row = json.loads(line)
        if "field" in row:
            described[row["window"], row["field"]] = row
    count = 0
    with running(rack("web-settings"), words=["--web", "--web-settings", str(path)]) as plant:
        module_of(plant)
        client = PageClient(plant)
        for test in tests:
            kind, name = test["page"], test["name"]
            word = "producer" if name == "Producer heartbeat time" else "node" if name in ("Download target", "Node name") or (kind, test["scope"]) == ("basic", "row") else kind
            window = {"node": "node/7", "tpdo": "tpdo/5", "rpdo": "rpdo/5", "slave": "slave/7", "consumer": "consumer/7"}.get(word, word)
            expected = "0x000 to 0x57F" if name == "CAN-ID (11-bit)" else described.get((word, name), {}).get("range", "")
            for value in test["refused"]:
                reply, _ = client.do(command="configure set", window=window, items=[f"{name}={value}"])
                wanted = "steps of 0x10" if value == "0x8" else expected
                require(reply["code"] == 2 and name in reply["message"] and f"expected {wanted}" in reply["message"], (test, value, reply))
            for value in test["taken"]:
                reply, _ = client.do(command="configure set", window=window, items=[f"{name}={value}"])
                require(reply["code"] == 0, (test, value, reply))
            count += len(test["refused"]) + len(test["taken"])
        before = path.read_bytes()
        require(client.do(command="configure set", window="basic", items=["Node ID=5"])[0]["code"] == 0 and path.read_bytes() != before, "Node ID")
        require(client.do(command="configure undo")[0]["code"] == 0 and path.read_bytes() == before, "undo")
        require(PageClient(plant, key=False).do(command="configure undo")[0]["code"] == 7, "who only looks")
    print(f"    {len(tests)} fields, {count} values")


@check
def web_settings_of_a_live_plc_are_armed():
    """`canopus web FILE.xml`: no plant and no bus; nothing is written before it is armed, and nobody without the key writes at all."""
    path = new("web-live")
    with running(rack("web-live")) as plant:
        module_of(plant)
        host, port = plant.mc.rsplit(":", 1)
        tool(None, "setup", "set", "live one", "--plc", f"{host}:{port}", "--timeout", "2s")
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
            require(hello["settings"][0]["setup"] == "live one" and hello["settings"][0]["plc"] == [f"--plc={host}:{port}", "--timeout=4s"], hello)
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
