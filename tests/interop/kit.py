"""What the checks of interop.py share: running commands and plants, skipping, the scratch folder."""
import argparse
import contextlib
import json
import os
import pathlib
import queue
import shutil
import signal
import socket
import subprocess
import sys
import threading
import time

import node_packages
from runner import Skip

HERE = pathlib.Path(__file__).resolve().parent
ROOT = HERE.parent.parent
DEVICE_FILES = ROOT.parent / "shared" / "data" / "eds"
PYTHON = "/usr/bin/python3"  # Debian's, which sees Debian's python3-can

parser = argparse.ArgumentParser(description="Runs the program for real and lets programs we did not write judge it.")
parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/canopus")
parser.add_argument("--results", type=pathlib.Path)
parser.add_argument("--only", help="only checks whose name contains this")
parser.add_argument("--tier", action="append", choices=["check", "long", "browser", "machine"], help="only checks of this tier; again for another one")
parser.add_argument("--list", action="store_true", help="print the checks with tier and seconds, and run none")
parser.add_argument("--keep", action="store_true", help="keep the scratch folders")
parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="checks that compute at one time; those that wait run besides, "
                    "those that judge time alone; 1: one after the other")
args = parser.parse_args()
if args.jobs < 1:
    parser.error(f"--jobs {args.jobs}: expected 1 or more")
program = str(args.program.resolve())


class Scratch(os.PathLike):
    """The folder of the check that runs. Each has one of its own, so that none sees the files of another."""

    path = None

    def move_to(self, folder):
        self.path = folder

    def __fspath__(self):
        return str(self.path)

    __str__ = __fspath__

    def __truediv__(self, name):
        return self.path / name

    def __getattr__(self, name):
        return getattr(self.path, name)


scratch = Scratch()

# What is there at once on an idle machine is given so many seconds: they cost something only when a check fails.
PATIENCE = 120
BROWSER_PATIENCE = 800  # s, for a whole script of a browser: many pages, on a machine that builds meanwhile


def silence(milliseconds):
    """A time-out that is waited for in full when nobody answers (an LSS scan is mostly silence), as `--timeout` takes it: the
    time given, on a machine with more to do than cores up to four times that, and what the machine oversleeps at present; 250 ms
    at least (a virtual machine may get no processor for 200 ms, seldom enough not to be seen here). A late answer would pass for
    the next one's."""
    minute, _, _, running, _ = pathlib.Path("/proc/loadavg").read_text().split()
    wanted = max(float(minute), int(running.split("/")[0])) / os.cpu_count()
    late = 0.0
    end = time.monotonic() + 0.5
    while (start := time.monotonic()) < end:
        time.sleep(0.001)
        late = max(late, time.monotonic() - start)
    return f"{round(max(250, milliseconds * min(max(wanted, 1), 4) + 1000 * min(2 * late, 0.25)))}ms"


checks = []


def check(function):
    checks.append(function)
    return function


def covers(features):
    """Names the features of the manuals (spec/*/features.csv) whose behaviour the check looks at."""
    def mark(function):
        function.features = features
        return function
    return mark


def tier(name):
    """When the check runs, other than in `./check`: "long", "browser", "machine"; all of them in `./check --all`."""
    def mark(function):
        function.tier = name
        return function
    return mark


def require(condition, message):
    if not condition:
        raise AssertionError(message)


def command(*words, timeout=PATIENCE, expect=0, **options):
    """Runs a command to its end; its output is the message if it ends otherwise than expected."""
    done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace", timeout=timeout, **options)
    require(done.returncode == expect, f"{' '.join(map(str, words))}\nexit code {done.returncode}, expected {expect}\n"
            f"{done.stdout[-4000:]}\n{done.stderr[-4000:]}")
    return done


def until(condition, message, timeout=PATIENCE):
    """Asks again until it is so; a program that runs in real time is not there at once."""
    end = time.monotonic() + timeout
    while not condition():
        require(time.monotonic() < end, message)
        time.sleep(0.01)


class RunningPlant:
    """`canopus run --json` in real time, with its servers on ports of the system's choice."""

    runs = 0

    def __init__(self, plant, has_plc=True, words=(), is_served=True):
        RunningPlant.runs += 1
        self.trace = scratch / f"run-{RunningPlant.runs}.pcap"
        self._start("run", plant, "--trace", self.trace, *words)
        if has_plc:
            self.mc = self.wait(lambda e: e["event"] == "listen" and e["protocol"].startswith("MC protocol"))["address"]
        if not is_served:
            return
        self.socketcand = self.wait(lambda e: e["event"] == "listen" and e["protocol"] == "socketcand")["address"]

    def _start(self, *words, cwd=None):
        self.process = subprocess.Popen([program, *map(str, words), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                        text=True, cwd=cwd, env={**os.environ, "XDG_STATE_HOME": str(scratch / "configure-state")})
        self.events, self.lines = [], queue.Queue()
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.lines.put(line)
        self.lines.put(None)

    def wait(self, wanted, timeout=PATIENCE):
        """The first event, past or coming, that is wanted."""
        for event in self.events:
            if wanted(event):
                return event
        end = time.monotonic() + timeout
        while True:
            try:
                line = self.lines.get(timeout=max(0.01, end - time.monotonic()))
            except queue.Empty:
                raise AssertionError(f"an expected event did not come; last events: {self.events[-5:]}") from None
            if line is None:
                raise AssertionError(f"the plant ended: {self.process.stderr.read()[-2000:]}")
            self.events.append(json.loads(line))
            if wanted(self.events[-1]):
                return self.events[-1]

    def wait_operational(self, nodes):
        for node in nodes:
            self.wait(lambda e: e["event"] == "nmt" and e["node"] == node and e["state"] == "operational")

    def stop(self, how=signal.SIGINT):
        self.process.send_signal(how)
        code = self.process.wait(timeout=PATIENCE)
        self.reader.join(timeout=PATIENCE)
        return code, self.process.stderr.read()


class RunningPage(RunningPlant):
    """`canopus web --json`."""

    def __init__(self, *words, cwd=None):
        self._start("web", *words, cwd=cwd)


class Talker:
    """A program that runs while the check goes on, and whose lines the check waits for."""

    def __init__(self, *words):
        self.words = " ".join(map(str, words))
        self.process = subprocess.Popen([str(w) for w in words], stdin=subprocess.PIPE, stdout=subprocess.PIPE,
                                        stderr=subprocess.STDOUT, text=True)
        self.said, self.lines = [], queue.Queue()
        threading.Thread(target=self._read, daemon=True).start()

    def _read(self):
        for line in self.process.stdout:
            self.said.append(line.rstrip("\n"))
            self.lines.put(self.said[-1])
        self.lines.put(None)

    def wait_line(self, wanted):
        """The first line, of those that no wait has taken yet, that is wanted."""
        end = time.monotonic() + PATIENCE
        while True:
            try:
                line = self.lines.get(timeout=max(0.01, end - time.monotonic()))
            except queue.Empty:
                raise AssertionError(self.words + ": an expected line did not come:\n" + "\n".join(self.said)) from None
            require(line is not None, self.words + " ended too early:\n" + "\n".join(self.said))
            if wanted(line):
                return line

    def require_end(self, code=0):
        ended = self.process.wait(timeout=PATIENCE)
        require(ended == code, f"{self.words} ended with {ended}:\n" + "\n".join(self.said))


@contextlib.contextmanager
def talking(*words):
    talker = Talker(*words)
    try:
        yield talker
    finally:
        if talker.process.poll() is None:
            talker.process.kill()
            talker.process.wait()


class RawClient:
    """A socketcand client of a few lines, which hears all frames but its own."""

    def __init__(self, plant, bus="line1"):
        host, port = host_port(plant.socketcand)
        self.socket = socket.create_connection((host, int(port)), PATIENCE)
        self.text = ""
        self.expect("hi")
        for command in (f"open {bus}", "rawmode"):
            self.socket.sendall(f"< {command} >".encode())
            self.expect("ok")

    def element(self):
        """The words of the next element, without its brackets."""
        while ">" not in self.text:
            more = self.socket.recv(4096).decode()
            require(more, "the socketcand server closed the connection")
            self.text += more
        element, self.text = self.text.split(">", 1)
        return element.strip(" <").split()

    def expect(self, word):
        while (words := self.element()) != [word]:
            require(words[0] == "frame", f"expected {word}, the server says {words}")

    def frame(self):
        """(identifier, data) of the next frame."""
        while (words := self.element())[0] != "frame":
            pass
        return int(words[1], 16), bytes.fromhex("".join(words[3:]))

    def send(self, identifier, data):
        self.socket.sendall(f"< send {identifier:03x} {len(data)} {data.hex(' ')} >".encode())


def tshark_agrees(plant, kinds):
    """Ends the run; tshark must find these kinds of messages in its recording, and nothing malformed."""
    code, errors = plant.stop()
    require(code == 0, f"exit code {code}: {errors}")
    if not shutil.which("tshark"):
        print("    tshark is absent: the recording is not decoded")
        return
    command(sys.executable, HERE / "tshark_trace.py", plant.trace, "--need", kinds)


def in_machine(*words):
    """Runs a command where the kernel has SocketCAN: vcan0, vcan1, and can0 and can1 on one bus."""
    done = subprocess.run([str(ROOT / "tools/socketcan-machine"), "--timeout", "900", "--", *map(str, words)], capture_output=True,
                          text=True, errors="replace", timeout=1000)
    if done.returncode == 77:
        raise Skip(done.stderr.strip())
    return done


def host_port(address):
    host, port = address.rsplit(":", 1)
    return host, port


def first_plant_file():
    text = (ROOT / "examples/first-plant/plant.toml").read_text()
    text = text.replace("127.0.0.1:5007", "127.0.0.1:0").replace("127.0.0.1:29536", "127.0.0.1:0")
    text = text.replace('"../devices/', f'"{ROOT}/examples/devices/')
    path = scratch / "first-plant.toml"
    path.write_text(text)
    return path


@contextlib.contextmanager
def running(plant_file, has_plc=True, operational=(), words=(), is_served=True):
    plant = RunningPlant(plant_file, has_plc, words, is_served)
    try:
        plant.wait_operational(operational)
        yield plant
    finally:
        if plant.process.poll() is None:
            plant.process.kill()
            plant.process.wait()


@contextlib.contextmanager
def running_page(*words, cwd=None):
    page = RunningPage(*words, cwd=cwd)
    try:
        yield page
    finally:
        if page.process.poll() is None:
            page.process.kill()
            page.process.wait()


def first_plant():
    return running(first_plant_file(), operational=[1, 2, 3, 4])


def node_modules():
    for tool in ("node", "npm"):
        if not shutil.which(tool):
            raise Skip(f"{tool} is not installed")
    with node_packages.one_at_a_time(HERE):
        node_packages.install(HERE, scratch.path.parent, lambda words: command("npm", *words, cwd=HERE, timeout=600))
        build_crc()


def browser():
    """The Chromium of this machine; node has what drives it."""
    for name in ("chromium", "chromium-browser", "google-chrome"):
        if path := shutil.which(name):
            node_modules()
            return path
    raise Skip("no Chromium: tools/install-packages long")


def build_crc():
    """The native part of node-crc, which SDO block transfers of npm canopen need: one C file against the headers of node.
    Nothing is fetched for it. Where it cannot be built, block steps are skipped by the scripts, which say so."""
    package = HERE / "node_modules" / "node-crc"
    module = package / "build" / "Release" / "crc.node"
    node = pathlib.Path(shutil.which("node")).resolve()
    places = [node.parent.parent / "include/node", "/usr/include/node", "/usr/include/nodejs/src", "/usr/include/nodejs"]
    headers = [p for p in map(pathlib.Path, places) if (p / "node_api.h").is_file()]
    if module.is_file() or not headers or not shutil.which("gcc"):
        return
    module.parent.mkdir(parents=True, exist_ok=True)
    subprocess.run(["gcc", "-shared", "-fPIC", "-O2", "-DNODE_GYP_MODULE_NAME=crc", f"-I{headers[0]}",
                    str(package / "c" / "crc.c"), "-o", str(module)], capture_output=True)
