"""Checks of a plant that is driven in step: `canopus run --virtual --step`."""
import contextlib
import json
import os
import pathlib
import re
import shutil
import signal
import socket
import subprocess
import threading

from docs_checks import blocks, differs
from kit import PATIENCE, PYTHON, ROOT, Skip, check, command, first_plant_file, host_port, program, require, scratch


class SteppedPlant:
    """The first plant in step, its control server, and a socket of its MC protocol server."""

    runs = 0

    def __init__(self, *words, plant=None, virtual=True):
        SteppedPlant.runs += 1
        self.trace = scratch / f"step-{SteppedPlant.runs}.log"
        mode = ["--virtual", "--step"] if virtual else []
        self.process = subprocess.Popen(
            [program, "run", str(plant or first_plant_file()), *mode, "--free-ports", "--json", "--trace", str(self.trace),
             *words], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        self.servers = {}
        while len(self.servers) < 3:
            event = json.loads(self.process.stdout.readline())
            if event["event"] == "listen":
                self.servers[event["protocol"]] = event["address"]
        self.events = []
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()
        self.lines = self.connect("control").makefile("rw")

    def _read(self):
        for line in self.process.stdout:
            self.events.append(json.loads(line))

    def connect(self, protocol):
        host, port = host_port(self.servers[protocol])
        return socket.create_connection((host, int(port)), PATIENCE)

    def send(self, **request):
        print(json.dumps(request), file=self.lines, flush=True)

    def answer(self):
        return json.loads(self.lines.readline())

    def ask(self, **request):
        self.send(**request)
        return self.answer()

    def run(self, **request):
        answer = self.ask(request="run", **request)
        require(answer["ok"], answer)
        return answer

    def stop(self, how=signal.SIGINT):
        self.process.send_signal(how)
        return self.end()

    def end(self):
        code = self.process.wait(timeout=PATIENCE)
        self.reader.join(timeout=PATIENCE)
        return code, self.process.stderr.read()


@contextlib.contextmanager
def stepped(*words, **options):
    plant = SteppedPlant(*words, **options)
    try:
        yield plant
    finally:
        if plant.process.poll() is None:
            plant.process.kill()
            plant.process.wait()


def scanned_plant():
    """The first plant with a scan of 5 ms."""
    path = scratch / "scanned-plant.toml"
    path.write_text(first_plant_file().read_text().replace("[[plc]]\n", '[[plc]]\nscan = "5ms"\n'))
    return path


def stepped_program(plant):
    """Writes, reads and waits by every server; returns all that it saw."""
    seen = []
    _, port = host_port(plant.servers["MC protocol"])
    plc = lambda *words: command(program, "plc", *words, "--plc", port).stdout
    seen.append(plant.run(until=r"U0\G601 == 5", **{"for": "60s"}))
    for turn in range(20):
        plc("write", r"U0\G13000", str(turn * 7 % 256), "--no-verify")
        plant.run(scans=turn + 1)
        seen.append(plc("read", r"U0\G10000", "--count", "4"))
        seen.append(plc("read", "X0", "--count", "32"))
        seen.append(plc("read", "SD420"))
    with plant.connect("socketcand") as bus:
        for said, expected in ((None, b"< hi >"), (b"< open line1 >", b"< ok >"), (b"< rawmode >", b"< ok >")):
            if said:
                bus.sendall(said)
            require(bus.recv(len(expected)) == expected, "socketcand does not greet")
        bus.sendall(b"< send 602 8 40 18 10 01 00 00 00 00 >")
        seen.append(plant.run(**{"for": "250ms"}))
        heard = b""
        while b"frame 582 " not in heard:
            more = bus.recv(65536)
            require(more, "the socketcand server closed the connection")
            heard += more
        seen.append(re.search(rb"frame 582 [^>]*>", heard)[0])
    seen.append(plant.ask(request="set", device="io-block", object="6000:01", value=3, **{"for": "20ms"}))
    seen.append(plant.run(**{"for": "100ms"}))
    return seen


@check
def the_same_stepped_program_gives_the_same_frames():
    for plant_file in (first_plant_file(), scanned_plant()):
        runs = []
        for _ in range(2):
            with stepped(plant=plant_file) as plant:
                seen = stepped_program(plant)
                code, errors = plant.stop()
                require((code, errors) == (0, ""), f"exit code {code}: {errors}")
                runs.append((seen, plant.trace.read_bytes(), [e for e in plant.events if e["event"] != "summary"]))
        require(runs[0][0] == runs[1][0], f"two runs saw different things:\n{runs[0][0]}\n{runs[1][0]}")
        require(runs[0][1] == runs[1][1], "two runs recorded different frames")
        require(runs[0][1].count(b"\n") > 200, "the trace is almost empty")
        require(runs[0][2] == runs[1][2], "two runs had different events")


@check
def plant_time_stands_still_until_somebody_wants_it():
    with stepped() as plant:
        require(plant.ask(request="list")["t"] == 0, "plant time has moved by itself")
        require(plant.run(scans=7)["t"] == 0.07, "7 scans of 10 ms are not 70 ms")
        require(plant.ask(request="list")["t"] == 0.07, "plant time has moved by itself")
        # Who leaves in the middle of an hour takes the rest of it along.
        with plant.connect("control") as other:
            other.sendall(b'{"request": "run", "for": "100000h"}\n{"request": "run", "for": "1h"}\n')
        before = plant.run(scans=1)["t"]
        require(plant.run(scans=1)["t"] < before + 1, "the plant still runs for a client that has left")
        for bad in ({}, {"scans": -1}, {"for": "yesterday"}, {"until": "Q7"}, {"scans": 1, "plc": "plc7"}):
            answer = plant.ask(request="run", **bad)
            require(not answer["ok"] and len(answer["error"]) > 20, answer)
        require(plant.stop() == (0, ""), "it does not end well")


@check
def a_stepped_plant_always_ends():
    for how in (signal.SIGINT, signal.SIGTERM):
        with stepped() as plant:  # nobody wants time
            require(plant.stop(how) == (0, ""), f"{how.name}: it does not end well")
        with stepped() as plant:  # in the middle of a run
            plant.send(request="run", **{"for": "100000h"})
            with plant.connect("control") as other:
                lines = other.makefile("rw")
                print('{"request": "list"}', file=lines, flush=True)
                require(json.loads(lines.readline())["ok"], "nobody else is answered meanwhile")
            plant.process.send_signal(how)
            answer = plant.answer()
            require(not answer["ok"] and "the run of the plant ended first" in answer["error"], answer)
            require(plant.end() == (0, ""), f"{how.name}: it does not end well")
    with stepped("--for", "2s") as plant:
        require(plant.run(scans=150)["t"] == 1.5, "150 scans are not 1.5 s")
        answer = plant.ask(request="run", scans=100)
        require(not answer["ok"] and "ended first, 50 scans later" in answer["error"] and answer["t"] == 2, answer)
        require(plant.end() == (0, ""), "--for does not end it well")
        require(plant.events[-1]["event"] == "summary" and plant.events[-1]["t"] == 2, plant.events[-1])


@check
def a_stepped_plant_whose_output_nobody_reads_ends_by_a_signal():
    plant = subprocess.Popen([program, "run", str(first_plant_file()), "--virtual", "--step", "--free-ports", "--json"],
                             stdout=subprocess.PIPE, stderr=subprocess.DEVNULL, text=True)
    try:
        address = None
        while address is None:
            event = json.loads(plant.stdout.readline())
            if event["event"] == "listen" and event["protocol"] == "control":
                address = event["address"]
        host, port = host_port(address)
        with socket.create_connection((host, int(port)), PATIENCE) as client:
            client.sendall(b'{"request": "run", "for": "100000h"}\n')  # fills the pipe, and what waits before it
            client.settimeout(2)
            with contextlib.suppress(TimeoutError):
                client.recv(1)
            plant.send_signal(signal.SIGTERM)
            require(plant.wait(timeout=PATIENCE) == 0, f"exit code {plant.returncode}")
    finally:
        plant.kill()
        plant.wait()


@check
def a_client_of_the_bus_loses_nothing_however_fast_the_plant_runs():
    with stepped() as plant, plant.connect("socketcand") as bus:
        for said, expected in ((None, b"< hi >"), (b"< open line1 >", b"< ok >"), (b"< rawmode >", b"< ok >")):
            if said:
                bus.sendall(said)
            require(bus.recv(len(expected)) == expected, "socketcand does not greet")
        plant.run(**{"for": "1s"})
        plant.send(request="run", **{"for": "120s"})
        heard, text = 0, b""
        bus.settimeout(PATIENCE)
        while b"frame 701 120." not in text:  # the module's heartbeat of second 120
            text = text[-40:] + (more := bus.recv(65536))
            require(more, "the socketcand server closed the connection")
            heard += more.count(b"frame ")
            require(b"error" not in more, more)
        require(plant.answer()["ok"], "no answer")
        bus.sendall(b"< echo >")  # its answer comes behind the last frame
        while b"< echo >" not in text:
            require(more := bus.recv(65536), "the socketcand server closed the connection")
            text += more
            heard += more.count(b"frame ")
        require(plant.stop() == (0, ""), "it does not end well")
        frames = sum(float(line[1:line.index(")")]) > 0.02 for line in plant.trace.read_text().splitlines())
        require(abs(frames - heard) <= 40 and frames > 10000, f"{heard} of {frames} frames were heard")


@check
def a_client_of_the_bus_that_does_not_read_does_not_stop_the_plant():
    with stepped() as plant, plant.connect("socketcand") as bus:
        bus.sendall(b"< open line1 >< rawmode >")
        plant.run(**{"for": "1s"})
        require(plant.run(**{"for": "300s"})["t"] == 301, "it stands still")
        require(plant.stop()[0] == 0, "it does not end well")


@check
def in_real_time_a_client_waits_for_scans_too():
    text = first_plant_file().read_text().replace("seed = 1\n", 'seed = 1\ncontrol = "127.0.0.1:0"\n')
    path = scratch / "controlled-plant.toml"
    path.write_text(text)
    with stepped(plant=path, virtual=False) as plant:
        before = plant.ask(request="list")["t"]
        answer = plant.run(scans=20)
        require(answer["scans"] == 20 and answer["t"] >= before + 0.18, f"{before} to {answer}")
        require(plant.run(until=r"U0\G601 == 5", **{"for": "60s"})["met"], "node 1 does not become Operational")
        with plant.connect("control") as other:
            other.sendall(b'{"request": "run", "for": "1h"}\n')
        require(plant.run(**{"for": "20ms"})["ok"], "a client that has left keeps others waiting")
        plant.send(request="run", **{"for": "1h"})
        plant.process.send_signal(signal.SIGINT)
        require("the run of the plant ended first" in plant.answer().get("error", ""), "no answer at the end")
        require(plant.end()[0] == 0, "it does not end well")


@check
def a_driven_plant_says_what_its_page_shows():
    with stepped() as plant:
        exchange = next(b for b in blocks("docs/control.md") if b[0].startswith("> ") and '"run"' in b[0])
        for line in exchange:
            if line.startswith("> "):
                print(line[2:], file=plant.lines, flush=True)
            else:
                said = plant.lines.readline().rstrip("\n")
                require(differs([line[2:]], [said], ()) is None, f"the page shows {line!r}, the plant says {said!r}")


def python(*words):
    """Debian's Python with the package of this source tree and the program under test; the examples lie where the page has them."""
    folder = scratch / "python-page"
    folder.mkdir(exist_ok=True)
    if not (folder / "examples").exists():
        (folder / "examples").symlink_to(ROOT / "examples")
    environment = os.environ | {"PYTHONPATH": str(ROOT / "python"), "CANOPUS_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}
    return command(PYTHON, *words, cwd=folder, env=environment).stdout


@check
def the_python_of_its_page_does_what_the_page_says():
    first, second, test = ("\n".join(block) for block in blocks("docs/python.md", "python"))
    said = python("-c", first).splitlines()
    require(said == ["operational after 1.51 s", "the echo is 5AH"], said)
    page = (ROOT / "docs/python.md").read_text()
    require(all(f"`{line}`" in page for line in said), "the page says something else")
    require(python("-c", second) == "True 2 0\n", python("-c", second))
    if subprocess.run([PYTHON, "-c", "import pytest"], capture_output=True).returncode != 0:
        print("    python3-pytest is absent: the test of the page is not run")
        return
    folder = scratch / "python-page"
    (folder / "conftest.py").write_text('pytest_plugins = ["canopus_plc.pytest_plugin"]\n')
    (folder / "test_page.py").write_text(test)
    require("1 passed" in python("-m", "pytest", "-q", "-p", "no:cacheprovider", "test_page.py"), "the test of the page")


@check
def the_python_package_is_installed_with_the_program():
    build = pathlib.Path(program).parent
    if not shutil.which("cmake") or not (build / "cmake_install.cmake").is_file():
        raise Skip("no cmake, or the program lies in no build folder")
    there = scratch / "installed"
    command("cmake", "--install", build, "--prefix", there)
    package = there / "share/canopus/python"
    require((there / "bin/canopus").is_file() and (package / "canopus_plc/py.typed").is_file(), "it is not complete")
    words = "import canopus_plc; print(canopus_plc.__file__)"
    environment = {"PYTHONPATH": str(package), "PYTHONDONTWRITEBYTECODE": "1"}
    require(str(package) in command(PYTHON, "-c", words, env=environment, cwd=scratch).stdout, "another one is imported")


@check
def step_needs_virtual_time():
    done = command(program, "run", ROOT / "examples/first-plant/plant.toml", "--step", expect=2)
    require("--virtual" in done.stderr, done.stderr)
