"""What the checks of interop.py share: running commands and plants, skipping, the scratch folder."""
import argparse
import contextlib
import functools
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
PATIENCE = 300
PAGE_PATIENCE = 600  # s, to build the page: packages, types, tests
# The time-out of a command whose nodes answer at once on an idle machine, but for those that are not there: these it waits for in full.
ANSWER = "5s"


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


class Pauses:
    """Measures how long this process got no processor although it wanted one."""

    longest = 0.0  # s
    _step = 0.01

    def __enter__(self):
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._measure, daemon=True)
        self._thread.start()
        return self

    def __exit__(self, *_):
        self._ended.set()
        self._thread.join()

    def _measure(self):
        last = time.monotonic()
        while not self._ended.wait(self._step):
            now = time.monotonic()
            self.longest = max(self.longest, now - last - self._step)
            last = now


def attempts(most, pause=0.1):
    """Of a check whose commands take silence for an answer, or that has to see a state which passes: where the machine gave it no processor
    for `pause` s, its failure says nothing, and it is done anew in an empty folder, `most` times in all; that is printed."""
    def mark(function):
        @functools.wraps(function)
        def tried():
            for left in reversed(range(most)):
                with Pauses() as pauses:
                    try:
                        return function()
                    except AssertionError as error:
                        if not left or pauses.longest < pause:
                            raise
                        print(f"    again from the start, after a pause of the machine of {pauses.longest:.1f} s and: {error}")
                for path in scratch.iterdir():
                    shutil.rmtree(path) if path.is_dir() and not path.is_symlink() else path.unlink()
        return tried
    return mark


def require(condition, message):
    if not condition:
        raise AssertionError(message)


def command(*words, timeout=PATIENCE, expect=0, **options):
    """Runs a command to its end; its output is the message if it ends otherwise than expected, or not in time."""
    def shown(outcome, *outputs):
        texts = (text.decode(errors="replace") if isinstance(text, bytes) else text or "" for text in outputs)
        return "\n".join([" ".join(map(str, words)), outcome, *(text[-4000:] for text in texts)])

    try:
        done = subprocess.run([str(w) for w in words], capture_output=True, text=True, errors="replace", timeout=timeout, **options)
    except subprocess.TimeoutExpired as late:
        raise AssertionError(shown(f"not done after {timeout} s; its output up to then:", late.stdout, late.stderr)) from None
    require(done.returncode == expect, shown(f"exit code {done.returncode}, expected {expect}", done.stdout, done.stderr))
    return done


def until(condition, message, timeout=PATIENCE, pause=0.01):
    """Asks again until it is so; a program that runs in real time is not there at once."""
    end = time.monotonic() + timeout
    while not condition():
        require(time.monotonic() < end, message)
        time.sleep(pause)


class RunningPlant:
    """`canopus run --json` in real time, with its servers on ports of the system's choice."""

    runs = 0

    def __init__(self, plant, has_plc=True, words=(), is_served=True, copy=None):
        RunningPlant.runs += 1
        self.trace = scratch / f"run-{RunningPlant.runs}.pcap"
        self._start("run", plant, "--trace", self.trace, *words, copy=copy)
        if has_plc:
            self.mc = self.wait(lambda e: e["event"] == "listen" and e["protocol"].startswith("MC protocol"))["address"]
        if not is_served:
            return
        self.socketcand = self.wait(lambda e: e["event"] == "listen" and e["protocol"] == "socketcand")["address"]

    def _start(self, *words, cwd=None, copy=None):
        self.process = subprocess.Popen([copy or program, *map(str, words), "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE,
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
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            self.said.append(line.rstrip("\n"))
            self.lines.put(self.said[-1])
        self.lines.put(None)

    def wait_line(self, wanted, timeout=PATIENCE):
        """The first line, of those that no wait has taken yet, that is wanted."""
        end = time.monotonic() + timeout
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
        self.reader.join(PATIENCE)  # its last lines
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
def running(plant_file, has_plc=True, operational=(), words=(), is_served=True, copy=None):
    """`copy`: a copy of the program that runs in its place."""
    plant = RunningPlant(plant_file, has_plc, words, is_served, copy)
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
        try:
            node_packages.install(HERE, scratch.path.parent, lambda words: command("npm", *words, cwd=HERE, timeout=800))
        except node_packages.NoRegistry as error:
            raise Skip(f"the packages of npm are not there, and its registry cannot be reached: {str(error)[-300:]}") from None
        build_crc()


def page_tool(*words, is_needed=lambda: True):
    """tools/page, if it is still needed when it is this check's turn: checks run side by side, and its npm packages are those of all."""
    for tool in ("node", "npm"):
        if not shutil.which(tool):
            raise Skip(f"{tool} is not installed")
    unreachable = scratch.path.parent / "page-unreachable"  # said by another check of this run
    with node_packages.one_at_a_time(ROOT / "canopus/web/page"):
        if not is_needed():
            return None
        if not unreachable.exists():
            try:
                return command(ROOT / "tools/page", *words, timeout=PAGE_PATIENCE)
            except AssertionError as error:
                if "npm ci in" not in str(error) or not node_packages.is_of_the_network(str(error)):
                    raise
                unreachable.write_text(str(error)[-300:])
    raise Skip(f"the page is not built, and npm's registry cannot be reached: {unreachable.read_text()}")


def page_files():
    """The files of the page beside the program; they are built now if they are missing or older than their sources."""
    folder = pathlib.Path(program).resolve().parent / "page"
    made = folder / "packages.json"  # written last
    sources = ROOT / "canopus/web/page"

    def is_old():
        return not made.is_file() or node_packages.is_newer(sources, made, but=("node_modules", "test"))

    if is_old():
        page_tool(folder, is_needed=is_old)
    return folder


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
