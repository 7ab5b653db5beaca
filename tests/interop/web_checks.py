"""Checks of the page of a run: `canopus run --web`."""
import base64
import concurrent.futures
import hashlib
import json
import os
import re
import socket
import struct
import sys
import threading

from docs_checks import require_shown, transcripts
from kit import PATIENCE, ROOT, check, command, first_plant_file, page_files, program, require, running, scratch

sys.path.append(str(ROOT / "bench"))
import plant_126  # noqa: E402


class Watcher:
    """A WebSocket client of a few lines (RFC 6455)."""

    def __init__(self, port, timeout=PATIENCE, key=None, receive_buffer=None):
        self.socket = socket.socket()
        self.socket.settimeout(timeout)
        if receive_buffer:
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, receive_buffer)
        self.socket.connect(("127.0.0.1", port))
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
        return json.loads(self.text())

    def text(self):
        while True:
            first, second = self.file.read(2)
            size = second & 0x7F
            if size == 126:
                size, = struct.unpack("!H", self.file.read(2))
            elif size == 127:
                size, = struct.unpack("!Q", self.file.read(8))
            data = self.file.read(size)
            if first == 0x81:
                return data
            require(first == 0x89, f"frame {first:02x}")  # a ping
            self.socket.sendall(bytes([0x8A, 0x80 | size]) + bytes(4) + data)

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


class PageClient:
    """Does what a page does, as a program; with the key of the run unless `key` is False."""

    def __init__(self, page, key=True):
        own = page_with_key(page).partition("#key=")[2] if key else None
        self.watcher = Watcher(page_of(page)[1], key=own)
        self.number = 0

    def begin(self, **words):
        self.number += 1
        self.watcher.say({"do": words, "id": self.number})
        return self.number

    def end(self, number):
        """The last reply, and all rows."""
        rows = []
        while True:
            reply = self.watcher.event(lambda e: e["event"] == "reply" and e["id"] == number)
            rows += reply.get("rows", [])
            if not reply.get("more"):
                return reply, rows

    def do(self, **words):
        return self.end(self.begin(**words))

    def trace(self, **words):
        """The row of a trace query that has come to its end: one that goes on has what was found up to then, and its progress."""
        while True:
            _, (row,) = self.do(command="trace", **words)
            if "progress" not in row:
                return row

    def state(self, holds=lambda _: True):
        return self.watcher.event(lambda e: e["event"] == "state" and holds(e))

    def view(self, **wish):
        """The event of what is looked at."""
        self.watcher.say({"views": [wish]})
        return self.watcher.event(lambda e: e["event"] == next(iter(wish)))


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
    page_files()
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
def web_fifty_pages_of_a_full_bus():
    """126 nodes with 8,400 frames a second and 50 pages, of which two never read what they are sent, messages and views included: the others lose
    nothing, the two are closed, and the plant goes on. How late the plant is at most: `bench/watchers`."""
    page_files()
    plant_file = scratch / "plant-126.toml"
    plant_file.write_text(plant_126.plant_text())
    with running(plant_file, has_plc=False, is_served=False, operational=range(2, plant_126.NODES + 1), words=["--web"]) as plant:
        _, port = page_of(plant)
        silent = [Watcher(port, receive_buffer=4096) for _ in range(2)]
        for one in silent:
            one.say({"messages": True})
            one.say({"views": [{"traffic": 0}]})
        readers = [Watcher(port) for _ in range(48)]
        ended = threading.Event()

        def read(reader):
            """The last state, and whether one was missed, up to the first state after the end of the silent ones."""
            has_lost = False
            while True:
                is_last = ended.is_set()
                text = reader.text()
                has_lost = has_lost or b'"event":"lost"' in text
                states = [event for event in json.loads(text) if event["event"] == "state"] if is_last else []
                if states:
                    return states[0], has_lost

        with concurrent.futures.ThreadPoolExecutor(len(readers)) as pool:
            results = [pool.submit(read, one) for one in readers]
            closed = []
            for _ in silent:
                closed.append(plant.wait(lambda e: e["event"] == "error" and "does not take what it is sent" in e["message"] and e not in closed))
            ended.set()
            for state, has_lost in (one.result() for one in results):
                require(not has_lost, "events were lost on the way to a page that reads")
                require(all(node["state"] == "operational" for node in state["nodes"]), state["nodes"])
        code, errors = plant.stop()
        require(code == 0, errors)
        summary = plant.wait(lambda e: e["event"] == "summary")
        require(summary["buses"][0]["error_frames"] == 0 and not summary["troubles"], summary["buses"])
        print(f"    50 pages, 126 nodes: the plant was at most {1000 * summary['lag']:.1f} ms late")


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
    require("--web cannot be combined with --virtual" in done.stderr or "--virtual cannot be combined with --web" in done.stderr, done.stderr)
    done = command(program, "run", plant, "--web", "--for", "10ms", "--free-ports")
    require("web of" in done.stdout and "http://127.0.0.1:" in done.stdout, done.stdout)
