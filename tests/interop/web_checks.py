"""Checks of the page of a run: `canopus run --web`."""
import base64
import concurrent.futures
import csv
import hashlib
import json
import os
import pathlib
import re
import socket
import struct

from docs_checks import require_shown, transcripts
from kit import BROWSER_PATIENCE, HERE, PATIENCE, browser, check, command, first_plant_file, program, require, running, scratch, tier


class Watcher:
    """A WebSocket client of a few lines (RFC 6455)."""

    def __init__(self, port, timeout=PATIENCE, key=None):
        self.socket = socket.create_connection(("127.0.0.1", port), timeout)
        target = f"/events?key={key}" if key else "/events"
        key = base64.b64encode(os.urandom(16)).decode()
        self.socket.sendall((f"GET {target} HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\nOrigin: http://127.0.0.1:{port}\r\n"
                             "Upgrade: websocket\r\nConnection: Upgrade\r\nSec-WebSocket-Version: 13\r\n"
                             f"Sec-WebSocket-Key: {key}\r\n\r\n").encode())
        self.file = self.socket.makefile("rb")
        require(self.file.readline().startswith(b"HTTP/1.1 101 "), "the server takes no WebSocket")
        wanted = base64.b64encode(hashlib.sha1((key + "258EAFA5-E914-47DA-95CA-C5AB0DC85B11").encode()).digest())
        fields = {}
        while line := self.file.readline().strip():
            name, value = line.split(b":", 1)
            fields[name.lower()] = value.strip()
        require(fields[b"sec-websocket-accept"] == wanted, fields)

    def message(self):
        """The events of the next message."""
        while True:
            first, second = self.file.read(2)
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack("!H", self.file.read(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.file.read(8))
            data = self.file.read(size)
            if first == 0x81:
                return json.loads(data)
            require(first == 0x89, f"frame {first:02x}")  # a ping

    def say(self, message):
        data = json.dumps(message).encode()
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xFE" + struct.pack("!H", len(data))
        self.socket.sendall(b"\x81" + size + bytes(4) + data)

    def event(self, wanted):
        while True:
            for event in self.message():
                if wanted(event):
                    return event


def page_of(plant):
    """Its address for who only looks, and its port."""
    address = page_with_key(plant).partition("#")[0]
    require(address.startswith("http://127.0.0.1:"), address)
    return address, int(address.split(":")[2].rstrip("/"))


def page_with_key(plant):
    """As it is printed: for who runs the program."""
    address = plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "web")["address"]
    require(re.fullmatch("http://127.0.0.1:[0-9]+/#key=[0-9a-f]{32}", address), address)
    return address


def ask(port, head):
    with socket.create_connection(("127.0.0.1", port), PATIENCE) as client:
        client.sendall(head.encode())
        return client.makefile("rb").read()


@check
def web_events_are_those_of_json():
    """What a watcher gets is what --json prints, event for event, and a state that says the same."""
    with running(first_plant_file(), operational=[1, 2], words=["--web"]) as plant:
        _, port = page_of(plant)
        watcher = Watcher(port)
        events = watcher.message()
        state = next((e for e in events if e["event"] == "state"), None) or watcher.event(lambda e: e["event"] == "state")
        seen = [e for e in events if e["event"] not in ("state", "listen", "load")]
        printed = [e for e in plant.events if e["event"] not in ("listen", "load")]
        require(seen[:len(printed)] == printed[:len(seen)] and len(seen) >= 5, f"{seen}\n{printed}")
        require(not state["live"] and [b["link"] for b in state["buses"]] == ["sim"], state)
        require({n["node"]: n["state"] for n in state["nodes"]}[2] == "operational", state["nodes"])
        later = watcher.event(lambda e: e["event"] == "state" and e["t"] > state["t"])
        require(later["buses"][0]["frames"] > 0, later)
        watcher.say({"messages": True})
        messages = watcher.event(lambda e: e["event"] == "messages")
        require(any(m["service"] == "pdo" and m["name"] == "encoder" for m in messages["messages"]), messages)
        code, _ = plant.stop()
        require(code == 0, code)


@check
def web_hostile_clients():
    """Half requests, huge heads, wrong hosts and origins, floods and 50 watchers, one of whom reads nothing: the plant keeps its
    time and goes on."""
    with running(first_plant_file(), operational=[1], words=["--web"]) as plant:
        _, port = page_of(plant)
        require(ask(port, f"GET / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n").startswith(b"HTTP/1.1 200 OK"), "no page")
        for head, status in ((f"GET / HTTP/1.1\r\nHost: evil.example:{port}\r\n\r\n", b"421"),
                             (f"POST / HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n", b"405"),
                             (f"GET /../plant.toml HTTP/1.1\r\nHost: 127.0.0.1:{port}\r\n\r\n", b"404"),
                             ("\0" * 9000, b"431"), ("\r\n\r\n", b"400")):
            require(ask(port, head).split()[1] == status, f"{head[:40]!r}: {status}")
        half = [socket.create_connection(("127.0.0.1", port)) for _ in range(10)]
        for one in half:
            one.sendall(b"GET / HTTP/1.1\r\nHost:")
        slow = Watcher(port)
        slow.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        watchers = [Watcher(port) for _ in range(49)]
        with concurrent.futures.ThreadPoolExecutor(49) as pool:
            states = list(pool.map(lambda w: w.event(lambda e: e["event"] == "state" and e["t"] > 2), watchers))
        require(len(states) == 49, "some watcher got nothing")
        for _ in range(3000):
            socket.create_connection(("127.0.0.1", port), PATIENCE).close()
        watchers[0].event(lambda e: e["event"] == "state" and e["t"] > states[0]["t"] + 1)
        code, errors = plant.stop()
        summary = plant.wait(lambda e: e["event"] == "summary") if code == 0 else None
        require(code == 0, errors)
        print(f"    50 watchers, 3000 connections: the plant was at most {1000 * summary['lag']:.1f} ms late")


@check
def web_documentation():
    """The command of docs/web.md, and what it prints."""
    (shown,), = transcripts("docs/web.md")
    words = [program if w == "canopus" else str(first_plant_file()) if w.startswith("examples/") else w for w in shown[0].split()]
    require_shown("docs/web.md", words, shown[1], [r"127\.0\.0\.1:\d+/#key=[0-9a-f]{32}"])


@check
def web_address():
    """Addresses that are not this machine's, and wrong words, are refused in a sentence."""
    plant = first_plant_file()
    done = command(program, "run", plant, "--web", "0.0.0.0:0", "--for", "1s", expect=1)
    require("the page is for this machine alone" in done.stderr, done.stderr)
    done = command(program, "run", plant, "--web", "nonsense:port", expect=2)
    require("nonsense" in done.stderr, done.stderr)
    done = command(program, "run", plant, "--web", "--virtual", expect=2)
    require("--web excludes --virtual" in done.stderr or "--virtual excludes --web" in done.stderr, done.stderr)
    done = command(program, "run", plant, "--web", "--for", "10ms", "--free-ports")
    require("web of" in done.stdout and "http://127.0.0.1:" in done.stdout, done.stdout)


def pictures_of(name):
    """The folder for what a browser saw."""
    folder = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / name
    folder.mkdir(parents=True, exist_ok=True)
    return folder


def browse(address, name):
    """What a real Chromium saw of the page."""
    chromium = browser()
    folder = pictures_of(name)
    done = command("node", HERE / "web_browser.mjs", chromium, address, folder)
    seen = json.loads(done.stdout)
    require(seen["problems"] == [], f"the browser complains: {seen['problems']}")
    require(seen["dialogs"] == 0 and seen["markup"] == 0, "a name became markup")
    require({u.split("/")[2] for u in seen["requests"]} == {address.split("/")[2]}, seen["requests"])
    require(seen["foreign"] == "refused" and seen["framed"] == "refused", "another site's page got through")
    require(not seen["overflow"] and seen["unnamed"] == 0, "wider than the window, or a control without a name")
    require(seen["focus_in"] == "node-title" and seen["focus_back"], "the keyboard loses its place")
    require(all(pathlib.Path(p).stat().st_size > 3000 for p in seen["pictures"]), seen["pictures"])
    require(seen["words_title"].startswith("Buffer memory of ") and seen["words_focus"] == "words-title" and seen["words_closed"], seen)
    require(seen["follow"] == ["Stop following", "Follow"], seen["follow"])
    require(10 < seen["words_rows"] <= 256 and seen["markup_later"] == 0, f"{seen['words_rows']} rows are on the page")
    require(re.fullmatch("[0-9A-F]{4}H", seen["word_hexadecimal"]), seen["word_hexadecimal"])
    return seen


@check
@tier("browser")
def web_page_in_chromium():
    """The page of the first plant in a real browser, by keyboard alone, light and dark, in two sizes."""
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        address, _ = page_of(plant)
        seen = browse(address, "first-plant")
        require(seen["where"] == "SIMULATED" and seen["plant"] in seen["title"], seen)
        require(seen["moods"] and set(seen["moods"]) == {"good"} and seen["reasons"][0] == "", seen)
        require(any(led.startswith("RUN ") for led in seen["leds"]), seen["leds"])
        require(any("operational" in row for row in seen["rows"]), seen["rows"])
        require(any("(encoder)" in line and "TPDO1  Position value" in line for line in seen["messages"]), seen["messages"])
        require(seen["first_time"] != seen["later_time"], "plant time stands still")
        require(seen["filtered"] and all("boot-up" in line for line in seen["filtered"]), seen["filtered"])
        require(re.fullmatch(r"\d{4,5} words", seen["words_count"]), seen["words_count"])
        require(re.search(r"^G10000.*RPDO1 18\dH, [0-9.]+ s ago.*from node \d \(\S+\) TPDO1.*read", seen["word"]), seen["word"])
        require(re.match(r"G\d+", seen["words_scrolled"]), seen["words_scrolled"])
        require(len(seen["boots"]) == 3 and all("booted in" in line for line in seen["boots"]), seen["boots"])
        require(len(seen["boot_steps"]) > 2 and "booted" in seen["boot_steps"][-1], seen["boot_steps"])


@check
@tier("browser")
def web_page_escapes_names():
    """Names that would be markup, script or control characters are text on the page; a slave that is missing is red, with the
    reason in sight."""
    text = first_plant_file().read_text()
    names = ['<img src=x onerror=alert(1)>', '\\u001B[2J</script><script>alert(2)</script>']
    for name, old in zip(names, ("io-block", "encoder")):
        text = text.replace(f'name = "{old}"', f'name = "{name}"', 1)
    require(text.count("alert(") == 2, text)
    plant_file = scratch / "hostile-names.toml"
    plant_file.write_text(text)
    with running(plant_file, operational=[1], words=["--web"]) as plant:
        seen = browse(page_of(plant)[0], "hostile-names")
        require(any("<img src=x onerror=alert(1)>" in name for name in seen["nodes"]), seen["nodes"])
        require(any("<script>alert(2)</script>" in name for name in seen["nodes"]), seen["nodes"])


def look_at_views(address, name, *words):
    """What a real Chromium saw of the views."""
    chromium = browser()
    folder = pictures_of(name)
    return json.loads(command("node", HERE / "web_views.mjs", chromium, address, folder, *words, timeout=BROWSER_PATIENCE).stdout)


@check
@tier("browser")
def web_views_in_chromium():
    """Bus, objects and plots of the first plant's page, by links and keys; axe-core finds nothing serious, light and dark."""
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        seen = look_at_views(page_of(plant)[0], "views")
        require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [] and seen["markup"] == 0, seen)
        require(seen["bus_link"] == "#bus/0" and seen["bus_focus"] == "bus-title" and seen["closed_link"] == "#overview", seen)
        require(seen["frame_link"] == "#bus/0/183" and seen["strip"].startswith("183H, DLC "), seen["strip"])
        require(seen["fields"][0] == "SOF" and seen["fields"][-3:] == ["ACK slot", "ACK delimiter", "EOF"], seen["fields"])
        require(int(re.search(r"(\d+) bits", seen["strip"])[1]) == seen["bits"] > 50, seen["strip"])
        require(any(line.startswith("PDO ") for line in seen["legend"]), seen["legend"])
        require(len(seen["counters"]) == 4 and seen["errors"], seen["counters"])
        require(seen["sync"] == "No SYNC is sent, or one at most.", seen["sync"])
        require(sum("jitter" in one for one in seen["sdo_times"]) == 3, seen["sdo_times"])
        rows = " | ".join(seen["node_rows"])
        for wanted in (r"Frames sent\d+ \|", r"Frames a second\d+, [\d.]+ % of those on the bus", r"Heartbeat[\d.]+ (ms|s) ago, every [\d.]+ (ms|s)", r"SDO answers\d+, after .* in the mean", r"Boot.*booted"):
            require(re.search(wanted, rows), (wanted, rows))
        require(seen["keys_open"] and seen["in_sight"] and seen["plots_closed"], seen)
        require("encoder" in seen["objects_title"] and seen["objects_rows"] <= 256, seen["objects_title"])
        require(re.match(r"6004:00.*UNSIGNED32", seen["position"]), seen["position"])
        require("6004:00" in seen["plot"] and seen["w8"] == 1, seen["plot"])
        require(re.fullmatch(r"\d+ at \d+\.\d{3} s", seen["cursor"]) and seen["held"] and seen["plots"] == 2, seen)
        require(seen["plot_link"].count("plot=") == 2 and len(seen["linked_plots"]) == 3 and seen["linked_markup"] == 0, seen)
        require("<img src=x>" in seen["linked_plots"][2] and "io-block" in seen["linked_objects"], seen["linked_plots"])
        require(seen["tree"] == ["line1", "1  ME3CAN1-Q U0", "2  io-block", "3  encoder", "4  drive", "ME3CAN1-Q U0 (plc1)", "Boot", "Faults", "Trace",
                                 "Messages", "Events"] and seen["lamps"] == 4, seen["tree"])
        require("encoder" in seen["tree_node"] and seen["tree_focus"] == ["messages-title", True], seen)
        require("line1" in seen["tree_bus"] and not seen["tree_narrow"], seen)
        require(min(seen["narrow"]) >= 160, f"{seen['narrow']} pixels for the names")
        rows = list(csv.DictReader((pictures_of("views") / "plots.csv").open(newline="")))
        require(len(rows) > 6 and "6004:00" in rows[0]["name"] and float(rows[-1]["time (s)"]) > float(rows[0]["time (s)"]), rows[:3])


@check
@tier("browser")
def web_reason_in_one_click():
    """A slave whose product code is not the expected one is red; one click shows the reason without scrolling (W5)."""
    text = first_plant_file().read_text().replace('"1016:01" =', '"1F86:04" = 0x1234, "1016:01" =', 1)
    require("1F86:04" in text, text)
    plant_file = scratch / "wrong-product.toml"
    plant_file.write_text(text)
    with running(plant_file, words=["--web"]) as plant:
        address, _ = page_of(plant)
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e.get("error") == "M")
        seen = look_at_views(address, "reason", "drive")
        require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [] and seen["reason"]["in_sight"], seen)
        require("1018H:02 reads 00000402H" in seen["reason"]["text"] and "expected 00001234H" in seen["reason"]["text"], seen["reason"])
