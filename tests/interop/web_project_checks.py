"""Checks of the page of a project: `canopus web`, and projects of a running plant's buses."""
import json
import os
import pathlib
import re
import shutil
import socket
import subprocess

from kit import (BROWSER_PATIENCE, HERE, PATIENCE, ROOT, Skip, browser, check, command, first_plant_file, program, require, running,
                 running_page, scratch, tier, until)
from web_checks import Watcher, page_of, page_with_key

DEVICES = ROOT / "examples/devices"


def new_project(name):
    folder = scratch / name
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder, "--name", "Found <b>here</b>")
    return folder


@check
@tier("browser")
def web_project_in_chromium():
    """W2, W3, W4, W7 and W10 with their clicks, three columns, refused values, arming, and who only looks, in a real browser on the
    bus of a running plant; axe-core finds nothing serious."""
    chromium = browser()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "project"
    pictures.mkdir(parents=True, exist_ok=True)
    folder = new_project("web-found")
    # The drive is another one than that of its file.
    text = first_plant_file().read_text()
    drive = text[text.index('name = "drive"'):]
    plant_file = scratch / "web-found.toml"
    plant_file.write_text(text.replace(drive, drive.replace('"1017:00" = 500', '"1017:00" = 500, "1018:04" = 4711', 1)))
    with running(plant_file, operational=[1, 2, 3]) as plant:
        words = [folder, "--bus", f"socketcand:{plant.socketcand}", "--eds", DEVICES]
        with running_page(*words) as page:
            done = command("node", HERE / "web_project.mjs", chromium, page_with_key(page), pictures,
                           DEVICES / "io-block.eds", timeout=BROWSER_PATIENCE)
    seen = json.loads(done.stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [] and seen["markup"] == 0, seen)
    require("#" not in seen["address"] and seen["role"] == "configure", "the key stays in the address")
    require(seen["w2"] == {"clicks": 2, "typed": 0} and seen["scanned"] == "4 nodes are on the bus", seen["w2"])
    require(seen["adopted"] == "3 nodes are taken over" and [n[0] for n in seen["nodes"]] == ["2", "3", "4"], seen["nodes"])
    require(seen["w3"]["clicks"] == 0 and seen["w3"]["typed"] == 0 and seen["added"].endswith("is node 1"), seen["added"])
    require(len(seen["nodes_later"]) == 4 and seen["nodes_later"][0].startswith("1"), seen["nodes_later"])
    require(seen["w4"]["clicks"] <= 1 and seen["w4"]["typed"] == 0, seen["w4"])
    require(any("TPDO1" in row and "183H" in row for row in seen["plan"]), seen["plan"])
    require(any("RPDO4" in row and "183H" in row and "Target position ←" in row for row in seen["plan"]), seen["plan"])
    require("Load" in seen["plan_load"] and seen["matrix"] == ["Position value TPDO1 183H"], seen["plan_load"])
    require(seen["command"].startswith("canopus project pdo link "), seen["command"])
    require("every 250 ms" in seen["changed_pdo"] and "250 kbit/s (sample point 87.5 % by CiA 301, at most 250 m of cable)" in seen["facts"], seen["facts"])
    require("does not fit UNSIGNED16; expected 0 to 65535" in seen["refused"], seen["refused"])
    require(len(seen["unwritten"]) == 1 and seen["unwritten"][0].startswith("1017:00"), seen["unwritten"])
    require(seen["compared"].startswith("1 Canopus I/O block is another device; ") and seen["compared"].endswith("values differ"), seen["compared"])
    require(seen["devices"] == ["another device", "as the project", "as the project", "4 differ"], seen["devices"])
    require(seen["cut_off"] == 0, f"the right-hand {seen['cut_off']} pixels of the PDOs are not in sight")
    require(any(re.match("1017:00.*500differs", row) for row in seen["differs"]), seen["differs"])
    require("is a live bus; arm writing first" in seen["not_armed"] and "armed, 10 min" in seen["armed"], seen["not_armed"])
    require(seen["w7"] == {"clicks": 2, "typed": 0}, "Transfer, look, Write")
    require(any("1017:00" in row and "250" in row and "500" in row for row in seen["will_write"]), seen["will_write"])
    # Node 1 is the module, not the device that was added: of it nothing is written, and that is said.
    left = [row for row in seen["written"] if row.startswith("1 ")]
    written = [row for row in seen["written"] if row not in left]
    require(written and all(row.endswith("written") for row in written), seen["written"])
    require(len(left) == 2 and all(row.endswith("it is another device, which is left alone") for row in left), left)
    require(any(row.startswith("1017:00") and row.endswith("same") for row in seen["same"]), seen["same"])
    require(seen["w6"] == {"clicks": 2, "typed": 0}, seen["w6"])
    require(len(seen["will_accept"]) == 1 and re.search("1018:04.*project 00000001H.*device 00001267H", seen["will_accept"][0]),
            seen["will_accept"])
    require(seen["w10"] == {"clicks": 1, "typed": 0}, seen["w10"])
    report = (pictures / "report.html").read_text()
    require("<script" not in report and "Found &lt;b&gt;here&lt;/b&gt;" in report, report[:500])
    require(seen["undone"].startswith("taken back: "), seen["undone"])
    require(seen["look_role"] == "look" and "Transfer…" in seen["look_disabled"] and seen["look_inputs"] == 0, seen)
    # The command line says the same as the page.
    shown = [json.loads(line) for line in command(program, "project", "show", folder, "--json").stdout.splitlines()]
    require([row["node"] for row in shown if "node" in row] == [1, 2, 3, 4], shown)


@check
def web_project_commands():
    """What a watcher without the key may not do, and what nobody may: other files, other buses, options as names."""
    folder = new_project("web-commands")
    for name in ("encoder", "drive"):
        command(program, "project", "add", folder, DEVICES / f"{name}.eds", "--bit-rate", "250k")
    with running_page(folder) as plant:
        key = page_with_key(plant).partition("#key=")[2]
        _, port = page_of(plant)
        owner, looker = Watcher(port, key=key), Watcher(port)
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

        require(done(looker, command="hello")[0]["role"] == "look", "without a key")
        require(done(owner, command="hello")[0]["role"] == "configure", "with the key")
        require(len(done(looker, command="project show")[1]) == 3, "looking is for everybody")
        for name in ("project set", "project undo", "project write", "project adopt", "nmt start", "sdo write", "scan"):
            reply, rows = done(looker, command=name, **({} if name.startswith(("project", "scan")) else
                                                       {"node": "1"} if name == "nmt start" else {"node": "1", "object": "1017", "value": "1"}))
            require(reply["code"] == 7 and rows == [], (name, reply))
        before = sorted((p.name, p.read_bytes()) for p in folder.iterdir() if p.is_file())
        for words in ({"command": "project set", "node": "--help"}, {"command": "project set", "node": "1", "items": ["--name=x"]},
                      {"command": "project remove", "node": "/etc/passwd"}, {"command": "project show", "node": "../../x"}):
            reply, _ = done(owner, **words)
            require(reply["code"] in (2, 5), (words, reply))
        for words in ({"command": "run"}, {"command": "plc write"}, {"command": "project show", "project": "/etc"},
                      {"command": "scan", "bus": "other"}, {"command": "project show", "--bus": "x"}, {"command": ["project", "show"]}, {}):
            reply, _ = done(owner, **words)
            require(reply["code"] == 2, (words, reply))
        require(before == sorted((p.name, p.read_bytes()) for p in folder.iterdir() if p.is_file()), "a file was changed")
        # The devices of the project are simulated: nothing is live, so nothing is to be armed.
        reply, rows = done(owner, command="project set", node="2", items=["1017=250"])
        require(reply["code"] == 0, reply)
        reply, rows = done(owner, command="project write", yes=True)
        require(reply["code"] == 0 and any(r.get("write") == "1017:00" and r["state"] == "written" for r in rows), rows)
        reply, rows = done(owner, command="sdo read", node="2", object="1017")
        require(rows[0]["bytes"] == "FA00", rows)
        # Several at once come one after the other, and each gets its own.
        for own in range(2000, 2008):
            owner.say({"do": {"command": "project show"}, "id": own})
        waiting = set(range(2000, 2008))
        while waiting:
            reply = owner.event(lambda e: e["event"] == "reply" and e["id"] in waiting and not e.get("more"))
            require(reply["code"] == 0, reply)
            waiting.discard(reply["id"])


@check
def web_bus_of_commands_is_for_own_user():
    """The door through which commands of the page join a simulated bus is shut for other users of this machine: roles are not gone round."""
    if os.geteuid() != 0:
        raise Skip("only root can act as another user")
    folder = new_project("web-door")
    command(program, "project", "add", folder, DEVICES / "encoder.eds", "--bit-rate", "250k")
    with running_page(folder) as page:
        key = page_with_key(page).partition("#key=")[2]
        owner = Watcher(page_of(page)[1], key=key)
        owner.say({"do": {"command": "project diff", "bus": "network"}, "id": 1})
        reply = owner.event(lambda e: e["event"] == "reply" and e["id"] == 1 and not e.get("more"))
        require(reply["code"] in (0, 1), reply)
        port = int(re.search(r"socketcand:127\.0\.0\.1:(\d+)", reply["command"])[1])
        script = f"import socket; s = socket.create_connection(('127.0.0.1', {port}), 10); print(s.recv(100).decode())"
        for user, said in ((0, "< hi >"), (65534, "< error not allowed >")):
            done = subprocess.run(["/usr/bin/python3", "-c", script], user=user, cwd="/", capture_output=True, text=True, timeout=PATIENCE)
            require(done.stdout.strip() == said, (user, done.stdout, done.stderr))
        refused = page.wait(lambda e: e["event"] == "client" or "is not allowed to connect" in str(e))
        require("is not allowed to connect" in str(refused), refused)


@check
def web_project_says_what_is_wrong():
    """What is wrong with a project or its bus is said about the file and the option, not about lines that nobody wrote."""
    folder = new_project("web-wrong")
    done = command(program, "web", folder, "--bus", "foo", expect=2)
    require(f'{folder}/nodelist.cpj: link = "foo" is not a bus; expected' in done.stderr, done.stderr)
    command(program, "project", "add", folder, DEVICES / "encoder.eds")
    next(folder.glob("*.dcf")).unlink()
    done = command(program, "web", folder, "--for", "10ms")
    require(re.search(r"nodelist.cpj: project = .*nodelist.cpj:\d+: node 1: cannot read .*dcf: No such file", done.stderr), done.stderr)
    require("the page shows what is wrong" in done.stderr, done.stderr)
    done = command(program, "web", folder, "--listen", "0.0.0.0:0", "--no-devices", expect=1)
    require("unless it has users (canopus web-users)" in done.stderr, done.stderr)


@check
@tier("browser")
def web_start_in_chromium():
    """W1: without a plant and a project, one click runs the built-in plant, and its frames are there within a second or so; plants and
    projects of the folder and a new project are offered; nobody without the key starts anything."""
    chromium = browser()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "start"
    pictures.mkdir(parents=True, exist_ok=True)
    folder = scratch / "web start"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    command(program, "project", "new", folder / "line <1>")
    (folder / "plant.toml").write_text('[[bus]]\nname = "a"\nbit_rate = 500_000\n')
    (folder / "other.toml").write_text('name = "none of ours"\n')
    command(program, "configure", "new", folder / "module.xml")
    with running_page(cwd=folder) as page:
        seen = json.loads(command("node", HERE / "web_start.mjs", chromium, page_with_key(page), pictures, timeout=BROWSER_PATIENCE).stdout)
        code = page.process.wait(timeout=20)
    require(code == 0 and seen["after_no"] != "NOT CONNECTED", (code, seen["after_no"]))  # Exit, and only when it is wanted
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["sections"] == ["start-section"], seen["sections"])
    require(seen["plants"] == ["plant.toml"] and seen["projects"] == ["line <1>/nodelist.cpj"], seen)
    require(seen["w1"] == {"clicks": 1, "typed": 0} and seen["nodes"] == 4, seen)
    print(f"    the first frame is shown {min(seen['milliseconds'])} ms after the click")
    require(len(seen["running"]) >= 1 and set(seen["running"]) == {"the built-in plant End"}, seen["running"])
    require(seen["twice"][0] == seen["twice"][1], "two runs of one plant would be two masters on its real bus")
    require(seen["look_disabled"] and seen["fresh"].endswith("/fresh"), seen)
    require((folder / "fresh/nodelist.cpj").is_file(), "no project was made")
    require(seen["settings"] == ["module.xml"] and seen["fresh_settings"].endswith("/press.xml") and "RJ71CN91" in seen["fresh_settings"], seen["settings"])
    require('model="RJ71CN91"' in (folder / "press.xml").read_text(), "no settings were made")
    version = command(program, "--version").stdout.split()[1]
    require(seen["about"] == [f"Version{version}", "LanguageEnglish"], seen["about"])
    require(seen["look_exit"] and not seen["look_recent"], "who only looks ends nothing, and is not told what was used last")
    require(any(one.endswith("/press.xml") for one in seen["recent"]), seen["recent"])
    require({"Start", "Settings of modules", "Recent Projects", "Save as", "Exit", "Close"} <= set(seen["headings"]), seen["headings"])
    require(seen["save_as_refused"].startswith("expected a name"), seen["save_as_refused"])
    require((folder / "second.xml").read_text() == (folder / "press.xml").read_text(), "the copy")
    require(seen["where"] == "LIVE PLC 127.0.0.1:5007" and seen["sections_of_settings"] == ["settings-section"], (seen["where"], seen["sections_of_settings"]))


@check
@tier("browser")
def web_faults_in_chromium():
    """W9: right click on a frame, Lose it, Run; the frame is lost, and what it hit is counted; the same by keys; a fault of the file is off by a click."""
    chromium = browser()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "faults"
    pictures.mkdir(parents=True, exist_ok=True)
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_faults.mjs", chromium, page_with_key(plant), pictures, timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["w9"] == {"clicks": 3, "typed": 0}, seen["w9"])
    require('kind = "drop"' in seen["text"] and "identifier = 0x183" in seen["text"] and "count = 1" in seen["text"], seen["text"])
    require(seen["hit"] == "1 frames hit" and seen["said"].startswith("1 at work since "), seen)
    require("expected one of drop, corrupt" in seen["wrong"], seen["wrong"])
    require(seen["stuck"] == "now" and "bus-off" in seen["controllers"], seen)
    require("identifier = 0x183" in seen["text_by_keys"] and "count = 1" in seen["text_by_keys"], seen["text_by_keys"])
    require(seen["look_disabled"] and not seen["look_menu"], "who only looks")


@check
def web_audit_log_is_not_filled_by_who_may_nothing():
    """Of what is refused to somebody who only looks five lines a second stand in the log, of the others how many they were; nothing is lost at the end."""
    folder, log = new_project("web-refused"), scratch / "web-refused.audit"
    log.unlink(missing_ok=True)
    tries = 30
    with running_page(folder, "--no-devices", "--audit", log) as page:
        looker = Watcher(page_of(page)[1])
        for own in range(1, tries + 1):
            looker.say({"do": {"command": "project undo"}, "id": own})
        for own in range(1, tries + 1):
            require(looker.event(lambda e, own=own: e["event"] == "reply" and e["id"] == own)["code"] == 7, own)
        page.process.terminate()
        page.process.wait(PATIENCE)
    lines = [json.loads(line) for line in log.read_text().splitlines()]
    refused = [line for line in lines if line["do"].startswith("canopus project undo")]
    left_out = sum(int(found[1]) for line in lines if (found := re.fullmatch(r"(\d+) more that were refused", line["do"])))
    require(5 <= len(refused) < tries and len(refused) + left_out == tries, [line["do"] for line in lines])
    require(all(line["code"] == 7 for line in lines), lines)


@check
def web_start_that_is_killed_leaves_no_plant_running():
    """Whatever ends `canopus web`, the plants that it started end with it: one of a real bus would go on unseen."""
    folder = scratch / "web killed"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    with running_page(cwd=folder) as page:
        owner = Watcher(page_of(page)[1], key=page_with_key(page).partition("#key=")[2])
        urls = []
        for own in (1, 2):
            owner.say({"do": {"command": "open"}, "id": own})
            reply = owner.event(lambda e, own=own: e["event"] == "reply" and e["id"] == own)
            require(reply["code"] == 0, reply)
            urls.append(int(re.search(r":(\d+)/", reply["rows"][0]["url"])[1]))
        for port in urls:
            socket.create_connection(("127.0.0.1", port), PATIENCE).close()
        page.process.kill()
        page.process.wait()
        for port in urls:
            until(lambda port=port: not answers(port), f"the plant of port {port} goes on")


def answers(port):
    try:
        socket.create_connection(("127.0.0.1", port), PATIENCE).close()
    except ConnectionRefusedError:
        return False
    return True
