"""Runs checks side by side, each in a process of its own with a folder of its own.

A check is a function without arguments: it returns, raises Skip, or fails by any other exception. What it prints, and what its
programs print on their inherited outputs, is shown as one block when it has ended. A check that outlives its time limit, and every
program that a check leaves behind, is killed; the others go on. Nothing is left when the runner ends, however that happens.
"""
import ctypes
import dataclasses
import json
import os
import pathlib
import re
import shutil
import signal
import sys
import time
import traceback
import xml.etree.ElementTree as ET

MARK = "CANOPUS_INTEROP_CHECK"  # in the environment of every program of a check: its number
SHOWN = 100_000                 # characters of a check's output that are printed, its last ones
CHILD_SUBREAPER, PARENT_DEATH_SIGNAL = 36, 1  # PR_SET_... [prctl(2)]


class Skip(Exception):
    """What a check needs is absent; the message says what."""


@dataclasses.dataclass(frozen=True)
class Plan:
    """How a check may run. `seconds`: about how long it takes; the longest are started first."""
    seconds: float = 5
    waits: bool = False      # it hardly computes: it takes none of the places of those that do
    alone: bool = False      # it judges time: no other check runs meanwhile
    shares: str = ""         # of all checks with the same word one runs at a time


@dataclasses.dataclass
class Outcome:
    name: str
    verdict: str = "failed"  # "ok", "skipped", "failed"
    message: str = ""
    output: str = ""
    wall: float = 0          # s
    processor: float = 0     # s, of the check and of its programs that have ended


def printable(text):
    """Without control characters, which could clear a screen and are forbidden in XML; line feeds and tabs stay."""
    return re.sub("[\x00-\x08\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069\ud800-\udfff\ufffe\uffff]",
                  lambda found: f"\\u{ord(found[0]):04X}", text)


@dataclasses.dataclass
class _Process:
    """What /proc says of one."""
    number: int
    name: str
    state: str
    parent: int
    session: int


def _processes():
    found = {}
    for entry in os.listdir("/proc"):
        if not entry.isdigit():
            continue
        try:
            text = pathlib.Path("/proc", entry, "stat").read_text(errors="replace")
        except OSError:
            continue  # it has ended
        begin, end = text.index("("), text.rindex(")")
        fields = text[end + 2:].split()
        found[int(entry)] = _Process(int(entry), text[begin + 1:end], fields[0], int(fields[1]), int(fields[3]))
    return found


def _descendants(of):
    """Of this process, those that have ended and wait for their parent left out."""
    every = _processes()
    below, new = set(), {of}
    while new:
        new = {p.number for p in every.values() if p.parent in new and p.number not in below}
        below |= new
    return [every[number] for number in below if every[number].state not in "ZX"]


def _is_of(process, check):
    """Whether a check started it, though it has lost its parents since."""
    if process.session == check.pid:
        return True
    try:
        environment = pathlib.Path("/proc", str(process.number), "environ").read_bytes()
    except OSError:
        return False
    return f"{MARK}={os.getpid()}.{check.number}".encode() in environment.split(b"\0")


def _kill(number):
    try:
        os.kill(number, signal.SIGKILL)
    except ProcessLookupError:
        pass


class _Check:
    """A check that runs."""

    def __init__(self, function, number, base, prepare):
        self.name, self.number = function.__name__, number
        self.folder, self.said, self.judged = base / f"{number}", base / f"{number}.out", base / f"{number}.json"
        self.folder.mkdir()
        self.begun = time.monotonic()
        self.overdue = False
        sys.stdout.flush()
        sys.stderr.flush()
        self.pid = os.fork()
        if self.pid == 0:
            try:
                self._work(function, prepare)
            finally:
                os._exit(3)  # no threads are waited for, nothing of the runner is tidied up

    def _work(self, function, prepare):
        os.setsid()  # a Ctrl-C on the terminal is the runner's
        ctypes.CDLL(None).prctl(PARENT_DEATH_SIGNAL, signal.SIGKILL)
        signal.signal(signal.SIGTERM, signal.SIG_DFL)
        output = os.open(self.said, os.O_WRONLY | os.O_CREAT | os.O_APPEND, 0o600)
        nothing = os.open(os.devnull, os.O_RDONLY)
        for source, place in ((nothing, 0), (output, 1), (output, 2)):
            os.dup2(source, place)
        os.close(output)
        os.close(nothing)
        sys.stdout, sys.stderr = (open(place, "w", buffering=1, encoding="utf-8", errors="backslashreplace", closefd=False)
                                  for place in (1, 2))
        os.environ[MARK] = f"{os.getppid()}.{self.number}"
        os.environ["TMPDIR"] = str(self.folder)
        verdict, message = "ok", ""
        try:
            prepare(self.folder)
            function()
        except Skip as reason:
            verdict, message = "skipped", str(reason)
        except BaseException as error:  # noqa: B902  (a check's failure, whatever it was)
            verdict, message = "failed", str(error) or "".join(traceback.format_exception(error))
        sys.stdout.flush()
        sys.stderr.flush()
        text = json.dumps({"verdict": verdict, "message": message})
        new = self.judged.with_suffix(".new")
        new.write_text(text)
        new.rename(self.judged)
        os._exit(0)

    def outcome(self, status, usage):
        outcome = Outcome(self.name, wall=time.monotonic() - self.begun, processor=usage.ru_utime + usage.ru_stime)
        if self.said.exists():
            text = self.said.read_bytes().decode("utf-8", "replace")
            outcome.output = printable(text if len(text) <= SHOWN else "...\n" + text[-SHOWN:])
        if self.overdue:
            outcome.message = f"it had not ended after {outcome.wall:.0f} s"
        elif self.judged.exists():
            found = json.loads(self.judged.read_text())
            outcome.verdict, outcome.message = found["verdict"], printable(found["message"])
        else:
            outcome.message = f"its process ended with {os.waitstatus_to_exitcode(status)} before it had a verdict"
        return outcome


class Runner:
    """`places`: checks that compute at one time; `waiting`: checks that hardly do, besides; `limit`: seconds for one check."""

    def __init__(self, base, prepare, plans, *, places=2, waiting=12, limit=900, keep=False):
        self.base, self.prepare, self.plans, self.places, self.waiting, self.limit, self.keep = (
            pathlib.Path(base), prepare, plans, places, waiting, limit, keep)
        self.running = []

    def plan(self, function):
        return self.plans.get(function.__name__, Plan())

    def run(self, functions, show):
        """Runs them all; calls `show` with the Outcome of each as it ends. Returns the outcomes in the order of the functions."""
        if ctypes.CDLL(None).prctl(CHILD_SUBREAPER, 1) != 0:
            raise OSError("PR_SET_CHILD_SUBREAPER")
        left = sorted(enumerate(functions), key=lambda f: (self.plan(f[1]).alone, -self.plan(f[1]).seconds))
        outcomes = {}
        try:
            while left or self.running:
                for entry in [e for e in left if self._fits(e[1])]:
                    if self._fits(entry[1]):
                        left.remove(entry)
                        self.running.append(_Check(entry[1], entry[0], self.base, self.prepare))
                for outcome, number in self._ended():
                    outcomes[number] = outcome
                    show(outcome)
                self._end_overdue()
                time.sleep(0.05)
        finally:
            self._end_all()
        return [outcomes[number] for number in sorted(outcomes)]

    def _fits(self, function):
        plan = self.plan(function)
        plans = [self.plans.get(c.name, Plan()) for c in self.running]
        if plan.alone or any(p.alone for p in plans):
            return not plans
        if plan.shares and any(p.shares == plan.shares for p in plans):
            return False
        waits = plan.waits and self.waiting > 0
        return sum((p.waits and self.waiting > 0) == waits for p in plans) < (self.waiting if waits else self.places)

    def _ended(self):
        """Those that have ended since, with what each has left behind killed. Others' orphans are waited for on the way."""
        while True:
            try:
                pid, status, usage = os.wait4(-1, os.WNOHANG)
            except ChildProcessError:
                return
            if pid == 0:
                return
            check = next((c for c in self.running if c.pid == pid), None)
            if check is None:
                continue
            self.running.remove(check)
            outcome = check.outcome(status, usage)
            remains = [p for p in self._orphans() if _is_of(p, check)]
            for process in remains:
                _kill(process.number)
            if remains and not check.overdue:
                outcome.output += f"    left running: {', '.join(sorted(printable(p.name) for p in remains))}\n"
            if not self.keep:
                shutil.rmtree(check.folder, ignore_errors=True)
            yield outcome, check.number

    def _orphans(self):
        """The runner's descendants that are below no check that runs."""
        below = set()
        for check in self.running:
            below |= {check.pid} | {p.number for p in _descendants(check.pid)}
        return [p for p in _descendants(os.getpid()) if p.number not in below]

    def _end_overdue(self):
        for check in self.running:
            if time.monotonic() - check.begun > self.limit:
                check.overdue = True
                for process in _descendants(check.pid):
                    _kill(process.number)
                _kill(check.pid)

    def _end_all(self):
        while below := _descendants(os.getpid()):
            for process in below:
                _kill(process.number)
            try:
                while os.wait4(-1, os.WNOHANG)[0]:
                    pass
            except ChildProcessError:
                pass
            time.sleep(0.01)
        self.running = []


def line_of(outcome):
    """A check's block of the report: what it printed, then its verdict."""
    output = outcome.output if not outcome.output or outcome.output.endswith("\n") else outcome.output + "\n"
    verdict = {"ok": "ok", "skipped": f"skipped: {outcome.message}", "failed": f"FAILED\n{outcome.message}"}[outcome.verdict]
    return f"{output}  {outcome.name} ({outcome.wall:.1f} s, processor {outcome.processor:.1f} s): {verdict}\n"


def junit(outcomes, features, suite_name="interop"):
    """JUnit XML; `features`: name of a check to the features of the manuals that it covers."""
    suite = ET.Element("testsuite", name=suite_name)
    for outcome in outcomes:
        case = ET.SubElement(suite, "testcase", classname=suite_name, name=outcome.name, status="run", time=f"{outcome.wall:.3f}")
        properties = ET.SubElement(case, "properties")
        ET.SubElement(properties, "property", name="processor", value=f"{outcome.processor:.3f}")
        if outcome.name in features:
            ET.SubElement(properties, "property", name="spec", value=features[outcome.name])
        if outcome.verdict == "skipped":
            ET.SubElement(case, "skipped", message=outcome.message)
        elif outcome.verdict == "failed":
            ET.SubElement(case, "failure", message=outcome.message[:2000])
    return ET.ElementTree(suite)
