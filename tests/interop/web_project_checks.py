"""Checks of the page of a project: `canopus web`, and projects of a running plant's buses."""
import json
import os
import re
import shutil
import socket
import subprocess

from kit import PATIENCE, ROOT, Skip, check, command, program, require, running_page, scratch, until
from web_checks import PageClient, Watcher, page_of, page_with_key

DEVICES = ROOT / "examples/devices"


def new_project(name):
    folder = scratch / name
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder, "--name", "Found <b>here</b>")
    return folder


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
def web_start_offers_and_opens():
    """W1 and what else `canopus web` begins with: the built-in plant runs; plants, projects and settings of the folder, new ones, copies, what was used
    last; one that is opened twice is one run; End, and Exit; nobody without the key starts anything."""
    folder = scratch / "web start"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    command(program, "project", "new", folder / "line <1>")
    (folder / "plant.toml").write_text('[[bus]]\nname = "a"\nbit_rate = 500_000\n')
    (folder / "other.toml").write_text('name = "none of ours"\n')
    command(program, "configure", "new", folder / "module.xml")
    with running_page(cwd=folder) as page:
        client, looker = PageClient(page), PageClient(page, key=False)
        row = lambda **words: client.do(**words)[1][0]
        found = row(command="plants")
        require(len(found["plants"]) == 1 and found["projects"] == ["line <1>/nodelist.cpj"] and found["settings"] == ["module.xml"], found)
        require(re.match("http://127.0.0.1:", row(command="open")["url"]), "the built-in plant")
        (running_one,) = row(command="plants")["running"]
        require(row(command="end", number=running_one["number"]) == {"ended": ""}, "end")
        require(row(command="open", path="plant.toml") == row(command="open", path="plant.toml"), "two runs of one plant would be two masters on its real bus")
        require("url" in row(command="new project", name="fresh") and (folder / "fresh/nodelist.cpj").is_file(), "no project was made")
        require("url" in row(command="new settings", name="press", model="RJ71CN91") and 'model="RJ71CN91"' in (folder / "press.xml").read_text(), "no settings")
        require(any(one.endswith("/press.xml") for one in row(command="recent projects")["recent"]), "recent")
        require(client.do(command="save as", path="press.xml", name="there/not")[0]["message"].startswith("expected a name"), "save as")
        require("url" in row(command="save as", path="press.xml", name="second"), "save as")
        require((folder / "second.xml").read_text() == (folder / "press.xml").read_text(), "the copy")
        for words in ({"command": "open"}, {"command": "exit"}, {"command": "recent projects"}, {"command": "new project", "name": "x"}):
            require(looker.do(**words)[0]["code"] == 7, words)
        require(row(command="exit") == {"exit": True} and page.process.wait(timeout=PATIENCE) == 0, "exit")


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
