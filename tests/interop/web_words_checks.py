"""Checks of the words that the page has for values of the communication profile and for events: its scripts alone, run by Node.js, without a browser."""
import json
import re
import shutil

from kit import ROOT, Skip, check, command, require

WORDS = {
    ("1000:00", "0x00020192"): "CiA 402",
    ("1005:00", "0x40000080"): "CAN-ID 080H, produces SYNC",
    ("1006:00", "2500"): "every 2.5 ms",
    ("1014:00", "0x80000084"): "off",
    ("1016:01", "0x000405DC"): "node 4, lost after 1500 ms",
    ("1016:02", "0"): "nobody",
    ("1017:00", "2000"): "every 2 s",
    ("1400:01", "0x20012345"): "CAN-ID 00012345H (29 bits)",
    ("1400:02", "1"): "taken at the next SYNC",
    ("1600:01", "0x62000108"): "6200:01, 8 bits",
    ("1800:01", "0x40000184"): "CAN-ID 184H, no remote request",
    ("1800:01", "0xC0000184"): "off",
    ("1800:02", "5"): "synchronous, every 5 SYNCs",
    ("1800:02", "250"): "reserved",
    ("1800:02", "255"): "event-driven",
    ("1800:03", "15"): "a pause of 1.5 ms at least",
    ("1800:05", "100"): "after 100 ms at the latest",
    ("1F80:00", "0x2D"): "flying NMT master, does not start the slaves, is started by its application",
    ("1F80:00", "0x13"): "NMT master, starts all nodes by one command, resets all nodes when a mandatory slave is lost",
    ("1F80:00", "0"): "not an NMT master",
    ("1F81:04", "0x01F4030D"): "a mandatory slave, is booted, is guarded every 500 ms, lost after 3",
    ("1F81:04", "0x11"): "an optional slave, is not booted, is not reset while it is operational",
    ("1F89:00", "0"): "as long as it takes",
    # A name of CiA 306, no number, the number of entries, an object of the device: no words.
    ("1800:01", "$NODEID+0x180"): "",
    ("1017:00", None): "",
    ("1016:00", "3"): "",
    ("6000:01", "1"): "",
}


@check
def values_of_the_communication_profile_in_words():
    if not shutil.which("node"):
        raise Skip("node is not installed")
    script = (f'import {{ words_of }} from {json.dumps(str(ROOT / "canopus/web/page/value_words.js"))};'
              f"console.log(JSON.stringify({json.dumps([list(key) for key in WORDS])}.map(([object, value]) => words_of(object, value))));")
    said = json.loads(command("node", "--input-type=module", "--eval", script).stdout)
    script = (f'import {{ value_text }} from {json.dumps(str(ROOT / "canopus/web/page/value_words.js"))};'
              'console.log([value_text("1400:01", 0x80000183), value_text("1A00:01", 7), value_text("1A00:00", 2), value_text("1017:00", 500),'
              ' value_text("1018:02", 0x402), value_text("1800:01", "$NODEID+0x180"), value_text("1017:00", null)].join("|"));')
    texts = command("node", "--input-type=module", "--eval", script).stdout.strip()
    require(texts == "0x80000183|0x00000007|2|500|0x00000402|$NODEID+0x180|", texts)
    for (place, words), shown in zip(WORDS.items(), said, strict=True):
        require(shown == words, f"{place}: {shown!r} instead of {words!r}")


@check
def faults_that_act_are_shown_whatever_somebody_edits():
    """A fault that is removed from the list, switched off or changed in it is on until the list is run, and says so."""
    if not shutil.which("node"):
        raise Skip("node is not installed")
    drop, jam = 'kind = "drop"', 'kind = "jam"'
    acting = [{"text": drop, "on": True, "hits": 3, "active": False}, {"text": jam, "on": True, "hits": 0, "active": True}, {"text": "x", "on": False}]
    cases = [
        ([{"text": drop, "on": True}, {"text": jam, "on": True}], acting, {"says": ["3 frames hit", "now"], "left": []}),
        ([], acting, {"says": [], "left": [{"text": drop, "says": "3 frames hit, removed, but on until Run"}, {"text": jam, "says": "now, removed, but on until Run"}]}),
        ([{"text": drop, "on": False}, {"text": jam + "\n", "on": True}], acting,
         {"says": ["3 frames hit, on until Run", "not yet run"], "left": [{"text": jam, "says": "now, removed, but on until Run"}]}),
        ([{"text": drop, "on": True}], acting[:1] * 2, {"says": ["3 frames hit"], "left": [{"text": drop, "says": "3 frames hit, removed, but on until Run"}]}),
        ([{"text": drop, "on": True}, {"text": jam, "on": False}], [], {"says": ["not yet run", "off"], "left": []}),
        ([], [], {"says": [], "left": []}),
    ]
    script = (f'import {{ fault_rows }} from {json.dumps(str(ROOT / "canopus/web/page/fault_rows.js"))};'
              f"console.log(JSON.stringify({json.dumps([case[:2] for case in cases])}.map(([edited, acting]) => fault_rows(edited, acting))));")
    said = json.loads(command("node", "--input-type=module", "--eval", script).stdout)
    for (edited, _, words), shown in zip(cases, said, strict=True):
        require(shown == words, f"{edited}: {shown} instead of {words}")


def audit(do, code=0, user="anna", **more):
    return {"t": 1.5, "event": "audit", "user": user, "role": "operate", "address": "192.168.1.7:50123", "do": do if isinstance(do, str) else json.dumps(do), "code": code, **more}


# What stands in the strip and in the list of events.
EVENTS = [
    (audit("canopus nmt stop --json --bus=socketcan:can0 -- all"), "canopus nmt stop --json --bus=socketcan:can0 -- all: done; by anna (operate)"),
    (audit("canopus sdo write -- 3 1017 x", 2, message="canopus sdo: x: expected a number"), "canopus sdo write -- 3 1017 x: x: expected a number; by anna (operate)"),
    (audit("canopus project diff -- line1", 4), "canopus project diff -- line1: done, something differs or does not fit; by anna (operate)"),
    (audit("canopus scan", 1, message="canopus scan: no bus,\nno answer"), "canopus scan: no bus, no answer; by anna (operate)"),
    (audit("canopus scan", 10), "canopus scan: stopped; by anna (operate)"),
    (audit("canopus scan", 139), "canopus scan: failed with code 139; by anna (operate)"),
    (audit("arm", user=""), "arm writes: done; by 192.168.1.7:50123 (operate)"),
    (audit("disarm"), "disarm writes: done; by anna (operate)"),
    (audit("log in"), "log in: done; by anna (operate)"),
    (audit("log in", 1), "log in: refused, wrong name or password; by anna (operate)"),
    (audit("log in", 9), "log in: refused, too many attempts; by anna (operate)"),
    (audit("12 more that were refused", 7, "?"), "12 more that were refused: refused, the role is too low; by ? (operate)"),
    (audit({"command": "pace", "speed": 0}), "let plant time stand still: done; by anna (operate)"),
    (audit({"command": "pace", "speed": 10}), "let plant time go at ×10: done; by anna (operate)"),
    (audit({"command": "pace", "run": "100ms"}), "let plant time go on for 100ms: done; by anna (operate)"),
    (audit({"command": "pace", "speed": {"a": [1]}}, 5, message="speed: expected 0 (stand still) or 0.01 to 100"),
     "let plant time go at ×?: speed: expected 0 (stand still) or 0.01 to 100; by anna (operate)"),
    (audit("pace", 7), "change the pace of plant time: refused, the role is too low; by anna (operate)"),
    (audit({"command": "run faults", "bus": "line1", "seed": 5, "faults": [{"text": 'kind = "drop"', "on": True}, {"text": 'kind = "bit"', "on": False}]}),
     "run the faults of line1 anew, 1 of 2 on, seed 5: done; by anna (operate)"),
    (audit({"command": "clear errors", "number": 1}), "clear the errors of module 1: done; by anna (operate)"),
    (audit({"command": "reset module", "number": 0}, 5, message="ME3CAN1-Q U0: the PLC has no supply"), "reset module 0: ME3CAN1-Q U0: the PLC has no supply; by anna (operate)"),
    (audit("reset module", 7), "reset a module: refused, the role is too low; by anna (operate)"),
    (audit("run faults", 7), "run faults: refused, the role is too low; by anna (operate)"),
    (audit({"command": "open"}), "open the built-in plant: done; by anna (operate)"),
    (audit({"command": "open", "path": "pumps/plant.toml"}, 5, message="no such file"), "open pumps/plant.toml: no such file; by anna (operate)"),
    (audit("open", 7), "open a plant: refused, the role is too low; by anna (operate)"),
    (audit({"command": "end", "number": 3}), "end run 3: done; by anna (operate)"),
    (audit({"command": "new project", "name": "line 2"}), "make the project line 2: done; by anna (operate)"),
    (audit({"command": "new settings", "name": "m", "model": "FX3U-CAN"}), "make the settings m of the module FX3U-CAN: done; by anna (operate)"),
    (audit({"command": "constructor"}, 2), "a command that there is not: not understood; by anna (operate)"),
    (audit("[1, {}]", 2), "a command that there is not: not understood; by anna (operate)"),
    ({"t": 1, "event": "lift", "bus": "hoist", "what": "passenger came", "lift": 1, "floor": 2, "to": 5, "passenger": 7}, "hoist lift 1 floor 2: passenger came: passenger 7 to floor 5"),
    ({"t": 1, "event": "lift", "bus": "hoist", "what": "fault began", "lift": 1, "fault": "door blocked"}, "hoist lift 1: fault began: door blocked"),
    ({"t": 1, "event": "summary", "virtual": False, "buses": [{"bus": "line1"}]}, "the run has ended"),
    ({"t": 1, "event": "something new", "bus": "line1", "node": 3, "name": "pump", "level": 2, "list": [1], "more": {"a": 1}}, "something new: line1 node 3 (pump), level 2"),
]


@check
def events_in_words():
    """Each kind of event is a sentence, and what people do on the page is what was run, by whom, and how it ended."""
    if not shutil.which("node"):
        raise Skip("node is not installed")
    kinds = set(re.findall(r"^\| `([a-z ]+)` \|", (ROOT / "docs/events.md").read_text().partition("The [page in the browser]")[0], re.MULTILINE))
    require({"boot", "lift", "summary"} <= kinds, kinds)
    # Those without a sentence of their own would begin with their kind and a colon.
    bare = [{"t": 1, "event": kind} for kind in sorted(kinds - {"load"})]
    script = (f'import {{ sentence, event_mood }} from {json.dumps(str(ROOT / "canopus/web/page/words.js"))};'
              f"console.log(JSON.stringify([{json.dumps([event for event, _ in EVENTS])}.map(sentence), {json.dumps(bare)}.map(sentence), {json.dumps([event for event, _ in EVENTS])}.map(event_mood)]));")
    said, of_kinds, moods = json.loads(command("node", "--input-type=module", "--eval", script).stdout)
    for (event, words), shown, mood in zip(EVENTS, said, moods, strict=True):
        require(shown == words, f"{event}: {shown!r} instead of {words!r}")
        require(event["event"] != "audit" or mood == ("" if event["code"] in (0, 4) else "error"), f"{event}: {mood!r}")
    for event, shown in zip(bare, of_kinds, strict=True):
        require(not shown.startswith(f"{event['event']}: "), f"{event['event']} has no sentence: {shown}")
