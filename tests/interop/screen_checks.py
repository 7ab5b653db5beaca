"""Checks of the live table on a terminal: a pseudo-terminal, a session with job control, and a few lines of a terminal's own."""
import contextlib
import fcntl
import os
import re
import select
import signal
import struct
import subprocess
import sys
import termios
import time

from docs_checks import blocks
from kit import PATIENCE, ROOT, check, first_plant_file, program, require

sys.path.append(str(ROOT / "python"))
from canopus_plc import Plc  # noqa: E402

ENTER, LEAVE = b"\x1b[?1049h", b"\x1b[?1049l"

# What a shell does with one job: it gives it the terminal, and takes it when the job is stopped or has ended.
SHELL = r"""
import fcntl, os, signal, sys, termios
control, report = int(sys.argv[1]), int(sys.argv[2])
fcntl.ioctl(0, termios.TIOCSCTTY, 0)
signal.signal(signal.SIGTTOU, signal.SIG_IGN)
job = os.fork()
if job == 0:
    os.setpgid(0, 0)
    os.tcsetpgrp(0, os.getpgrp())
    signal.signal(signal.SIGTTOU, signal.SIG_DFL)
    os.close(control)
    os.close(report)
    os.execv(sys.argv[3], sys.argv[3:])
os.write(report, b"started %d\n" % job)
while True:
    status = os.waitpid(job, os.WUNTRACED)[1]
    os.tcsetpgrp(0, os.getpgrp())
    if not os.WIFSTOPPED(status):
        os.write(report, b"ended %d\n" % os.waitstatus_to_exitcode(status))
        break
    os.write(report, b"stopped\n")
    if os.read(control, 3) == b"fg\n":
        os.tcsetpgrp(0, job)
    os.killpg(job, signal.SIGCONT)
"""


class Screen:
    """What a terminal shows of what it is sent: as much of one as the table needs. Anything else is a mistake."""

    def __init__(self, rows, columns):
        self.resize(rows, columns)
        self.rest = ""

    def resize(self, rows, columns):
        self.rows, self.columns = rows, columns
        self.lines = [[" "] * columns for _ in range(rows)]
        self.row = self.column = 0

    def feed(self, text):
        self.rest += text
        while self.rest:
            if self.rest[0] != "\x1b":
                self.put(self.rest[0])
                self.rest = self.rest[1:]
                continue
            found = re.match(r"\x1b\[([?\d;]*)([A-Za-z])", self.rest)
            if not found:
                require(len(self.rest) < 20, f"a sequence that is none: {self.rest[:20]!r}")
                return
            self.rest = self.rest[found.end():]
            self.obey(*found.groups())

    def put(self, character):
        if character in "\r\n":
            self.row, self.column = self.row + (character == "\n"), 0
            return
        require(character >= " ", f"the table sends {character!r}")
        require(self.column < self.columns, f"a line is longer than {self.columns}: {self.text()[self.row]}")
        require(self.row < self.rows, f"a line below the last one of {self.rows}")
        self.lines[self.row][self.column] = character
        self.column += 1

    def obey(self, words, final):
        if final == "H":
            self.row, self.column = [int(n) - 1 for n in words.split(";")] if words else (0, 0)
        elif final == "K":
            self.lines[self.row][self.column:] = [" "] * (self.columns - self.column)
        elif final == "J":
            first = 0 if words == "2" else self.row
            self.lines[first:] = [[" "] * self.columns for _ in range(self.rows - first)]
        else:
            require(final in "mhl", f"the table sends ESC [ {words} {final}")

    def text(self):
        return ["".join(line).rstrip() for line in self.lines]


class Session:
    """The program on a terminal of its own, as the job of a shell."""

    def __init__(self, words, rows, columns, **environment):
        self.master, slave = os.openpty()
        self.settings = termios.tcgetattr(self.master)
        self.screen = Screen(rows, columns)
        self.output, self.seen, self.table_on = b"", 0, False
        self._set_size(rows, columns)
        control_read, self.control = os.pipe()
        self.report, report_write = os.pipe()
        self.shell = subprocess.Popen([sys.executable, "-c", SHELL, str(control_read), str(report_write), program, *map(str, words)],
                                      stdin=slave, stdout=slave, stderr=slave, start_new_session=True,
                                      pass_fds=(control_read, report_write), env={**os.environ, "TERM": "xterm", **environment})
        for descriptor in (slave, control_read, report_write):
            os.close(descriptor)
        self.reports = b""
        self.wait_report("started")
        self.job = int(re.search(rb"started (\d+)", self.reports)[1])

    def _set_size(self, rows, columns):
        fcntl.ioctl(self.master, termios.TIOCSWINSZ, struct.pack("HHHH", rows, columns, 0, 0))

    def resize(self, rows, columns):
        """Lines of the old size may still be on their way: only what comes after the next picture has begun counts."""
        self.screen.resize(max(rows, self.screen.rows), max(columns, self.screen.columns))
        self._set_size(rows, columns)
        self.pump(0.3)
        self.wait(lambda: self.output.count(b"\x1b[1;1H", self.mark) >= 2, "no picture after a resize", mark=True)
        self.screen.resize(rows, columns)
        self.screen.rest = ""
        start = self.output.rindex(b"\x1b[1;1H")
        self.screen.feed(self.output[start:self.seen].decode(errors="ignore"))

    def pump(self, seconds):
        """Reads what comes within this time, and what the terminal holds at its end, for the screen as far as it belongs to the table."""
        end = time.monotonic() + seconds
        held = 20  # reads: more than a terminal holds, and no more, as a busy machine writes faster than it reads
        while held and select.select([self.master], [], [], left := max(0, end - time.monotonic()))[0]:
            held -= left == 0
            try:
                self.output += os.read(self.master, 65536)
            except OSError:  # nobody has the terminal open any more
                return
            self.draw()

    def draw(self):
        """Between ENTER and LEAVE everything is the table's."""
        while True:
            wanted = LEAVE if self.table_on else ENTER
            at = self.output.find(wanted, self.seen)
            end = at if at >= 0 else max(self.seen, len(self.output) - len(wanted))
            if self.table_on:
                piece = self.output[self.seen:end]
                piece = piece[:piece.rfind(b"\x1b[999")] if b"\x1b[999" in piece else piece  # the way out
                while piece and (piece[-1] & 0xC0) in (0x80, 0xC0) and at < 0:  # half a character
                    piece, end = piece[:-1], end - 1
                self.screen.feed(piece.decode())
            self.seen = end
            if at < 0:
                return
            self.seen = at + len(wanted)
            self.table_on = not self.table_on

    def wait(self, condition, message, mark=False):
        if mark:
            self.mark = len(self.output)
        end = time.monotonic() + PATIENCE
        while not condition():
            require(time.monotonic() < end, f"{message}; the screen:\n" + "\n".join(self.screen.text()) + f"\n{self.output[-500:]}")
            self.pump(0.05)

    def wait_shown(self, words):
        self.wait(lambda: self.table_on and words in "\n".join(self.screen.text()), f"{words!r} is not shown")

    def wait_report(self, word):
        def came():
            if select.select([self.report], [], [], 0)[0]:
                self.reports += os.read(self.report, 1000)
            return word.encode() in self.reports
        self.wait(came, f"the program has not {word}")

    def wait_end(self):
        """The exit code, and what came after the table."""
        self.wait_report("ended")
        self.pump(0.5)
        require(not self.table_on, "the program has left the terminal with the table on it")
        last = self.output.rfind(LEAVE)
        return int(re.search(rb"ended (-?\d+)", self.reports)[1]), self.output[last + len(LEAVE):].decode().replace("\r\n", "\n")

    def type(self, keys):
        os.write(self.master, keys)

    def require_given_back(self):
        """The program has stopped or ended; what it wrote last may still be on its way through the terminal."""
        def left():
            if termios.tcgetattr(self.master) != self.settings:
                return "the terminal's settings are not as before"
            if self.table_on:
                return "the table is still on the terminal"
            if self.output.rfind(b"\x1b[?25h") <= self.output.rfind(b"\x1b[?25l"):
                return "the cursor stays hidden"
            return "" if self.output.rfind(b"\x1b[?7h") > self.output.rfind(b"\x1b[?7l") else "lines do not wrap any more"

        end = time.monotonic() + PATIENCE
        while left() and time.monotonic() < end:
            self.pump(0.05)
        require(not left(), left())

    def plc(self):
        self.wait_shown("MC protocol")
        port = re.search(r"MC protocol 127\.0\.0\.1:(\d+)", "\n".join(self.screen.text()))[1]
        return Plc("127.0.0.1", int(port), timeout=PATIENCE)


@contextlib.contextmanager
def on_terminal(*words, rows=24, columns=80, **environment):
    session = Session(words, rows, columns, **environment)
    try:
        yield session
    finally:
        with contextlib.suppress(ProcessLookupError):
            if b"ended" not in session.reports:
                os.kill(session.job, signal.SIGKILL)
        session.shell.kill()
        session.shell.wait()
        for descriptor in (session.master, session.control, session.report):
            os.close(descriptor)


def wrong_write(session):
    """An error that a person should know."""
    with session.plc() as plc:
        plc.g[0][24] = 301
        plc.d[100] = 4711
        require(plc.d[100] == 4711, "the PLC does not answer")


@check
def the_table_fits_every_terminal():
    """40x10: no line wraps, the header stays; keys scroll; a resize redraws."""
    with on_terminal("run", first_plant_file(), rows=10, columns=40) as session:
        session.wait_shown("4/4 operational")
        lines = session.screen.text()
        require(lines[0].startswith("first") and "250 kbit/s" in lines[1] and lines[3].startswith("Node"), lines)
        session.resize(8, 40)
        session.wait_shown("more node")
        session.type(b"\x1b[F")
        session.wait_shown("   4  drive")
        require(session.screen.text()[0].startswith("first"), session.screen.text())
        session.type(b"?")
        session.wait_shown("PageUp")
        session.resize(24, 80)
        session.wait_shown("4 of 4 operational")
        session.type(b"q")
        code, rest = session.wait_end()
        require(code == 0 and rest.endswith("all 4 nodes operational\n"), rest)
        session.require_given_back()


@check
def the_readme_shows_the_live_table():
    (block,) = blocks("README.md", "text")
    with on_terminal("run", first_plant_file()) as session:
        session.wait_shown("4 of 4 operational")

        def shown():  # numbers differ
            def words(line):
                return re.sub(r"\d+(\.\d+)? *(us|ms|s)?|-", "#", line).split()
            screen = [words(line) for line in session.screen.text()]
            return all(words(line) in screen for line in block)
        session.wait(shown, "the table is not that of README.md")


@check
def ctrl_z_gives_the_terminal_back():
    with on_terminal("run", first_plant_file()) as session:
        session.wait_shown("4 of 4 operational")
        require(termios.tcgetattr(session.master) != session.settings, "the keys are not read one by one")
        for _ in range(2):
            before = session.output.count(ENTER)
            session.reports = b""
            session.type(b"\x1a")
            session.wait_report("stopped")
            session.pump(0.3)
            session.require_given_back()
            os.write(session.control, b"fg\n")
            session.wait(lambda: session.output.count(ENTER) == before + 1 and session.table_on, "the table has not come back")
            session.wait_shown("4 of 4 operational")
        # In the background nothing is shown, and what is typed is for the shell.
        session.reports = b""
        session.type(b"\x1a")
        session.wait_report("stopped")
        session.pump(0.3)
        size = len(session.output)
        os.write(session.control, b"bg\n")
        session.pump(1.5)
        require(len(session.output) == size, f"it writes in the background: {session.output[size:]}")
        os.kill(session.job, signal.SIGTERM)
        session.wait_report("ended 0")
        session.pump(0.5)
        require("the process was suspended for" in session.output[size:].decode(), session.output[size:])
        session.require_given_back()


@check
def errors_remain_when_the_table_has_gone():
    for how in ("q", signal.SIGTERM, signal.SIGHUP, signal.SIGINT):
        with on_terminal("run", first_plant_file()) as session:
            session.wait_shown("4 of 4 operational")
            wrong_write(session)
            session.wait_shown("G24 = 301")
            if how == "q":
                session.type(b"q")
            else:
                os.kill(session.job, how)
            code, rest = session.wait_end()
            require(code == 0 and rest.count("G24 = 301") == 1, f"{how}: {code}: {rest}")
            require(rest.endswith("all 4 nodes operational\n") and "\x1b" not in rest, rest)
            session.require_given_back()


@check
def a_stopped_terminal_does_not_stop_the_plant():
    """Ctrl-S: the plant goes on, and a signal ends the run and gives the terminal back."""
    with on_terminal("run", first_plant_file()) as session:
        session.wait_shown("4 of 4 operational")
        plc = session.plc()
        session.type(b"\x13")
        session.pump(1)
        size = len(session.output)
        with plc:
            for number in range(100):
                plc.d[100] = number
                require(plc.d[100] == number, "the PLC does not answer")
        session.pump(1)
        require(len(session.output) == size, "Ctrl-S does not stop the output")
        session.type(b"\x11")
        session.wait(lambda: len(session.output) > size, "Ctrl-Q does not let it go on")
        session.type(b"\x13")
        session.pump(1)
        os.kill(session.job, signal.SIGTERM)
        code, rest = session.wait_end()
        require(code == 0 and rest.endswith("all 4 nodes operational\n"), rest)
        session.require_given_back()


@check
def a_crash_gives_the_terminal_back():
    with on_terminal("run", first_plant_file()) as session:
        session.wait_shown("4 of 4 operational")
        os.kill(session.job, signal.SIGQUIT)
        code, _ = session.wait_end()
        require(code == -signal.SIGQUIT, f"exit code {code}")
        session.require_given_back()


@check
def terminals_that_are_none_and_colour_that_is_not_wanted():
    with on_terminal("run", first_plant_file(), "--for", "2s", TERM="dumb") as session:
        session.wait_report("ended 0")
        session.pump(0.5)
        require(b"\x1b" not in session.output and b"boot-up" in session.output, session.output[-500:])
    for refused, wanted in (("", True), ("1", False)):
        with on_terminal("run", first_plant_file(), NO_COLOR=refused) as session:
            session.wait_shown("4 of 4 operational")
            session.type(b"q")
            session.wait_end()
            require((re.search(rb"\x1b\[\d+m(?!\x1b)", session.output.replace(b"\x1b[0m", b"")) is not None) == wanted,
                    f"colour with NO_COLOR={refused!r}")
