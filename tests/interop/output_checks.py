"""Checks of what the real process prints: into pipes that nobody reads; and of what happens when the system has no more of something."""
import contextlib
import fcntl
import json
import os
import pathlib
import pty
import re
import resource
import select
import signal
import socket
import struct
import subprocess
import sys
import termios
import threading
import time

from kit import (PATIENCE, ROOT, check, first_plant_file, host_port, program, require, scratch, until)
from module_checks import recorded

sys.path.append(str(ROOT / "python"))
from canopus_plc import Plc  # noqa: E402


class LineReader:
    """Reads a pipe only when it is asked to, and only as far as it must."""

    def __init__(self, pipe):
        self.descriptor = pipe.fileno()
        self.rest = b""

    def line(self):
        """The next line, or nothing at the end."""
        while b"\n" not in self.rest:
            require(select.select([self.descriptor], [], [], PATIENCE)[0], "an expected line did not come")
            piece = os.read(self.descriptor, 4096)
            if not piece:
                return None
            self.rest += piece
        line, self.rest = self.rest.split(b"\n", 1)
        return line.decode()

    def all_lines(self):
        while (line := self.line()) is not None:
            yield line


@contextlib.contextmanager
def started(*words, **options):
    """The program and its standard output: a pipe that is not read by itself, or what the options say (and no reader)."""
    options = {"stdout": subprocess.PIPE, "stderr": subprocess.PIPE, "bufsize": 0, **options}
    process = subprocess.Popen([program, *map(str, words)], **options)
    try:
        yield process, LineReader(process.stdout) if process.stdout else None
    finally:
        if process.poll() is None:
            process.kill()
        process.wait()


def ends(process, how, within=30):
    """Sends the signal; the exit code. `within` fits a busy machine; what is meant is a second."""
    process.send_signal(how)
    try:
        return process.wait(timeout=within)
    except subprocess.TimeoutExpired:
        raise AssertionError(f"{signal.Signals(how).name} did not end the run") from None


def mc_address(lines):
    for line in lines.all_lines():
        event = json.loads(line)
        if event["event"] == "listen" and event["protocol"] == "MC protocol":
            return host_port(event["address"])
    raise AssertionError("the run ended before it opened its port")


def write_many(plc, first, requests):
    """Each request writes 480 other values: 480 events of about 100 octets. Each is answered."""
    for number in range(first, first + requests):
        plc.g[0][13000:13480] = [(number * 7 + i) & 0xFFFF for i in range(480)]
    plc.d[100] = first
    require(plc.d[100] == first, "the PLC does not answer any more")


# --- nobody reads


@check
def an_unread_output_does_not_stop_the_plant():
    """MC requests are answered, what is lost is counted in a JSON line, and a signal ends the run with its files complete."""
    trace = scratch / "unread.pcap"
    with started("run", first_plant_file(), "--json", "--trace", trace) as (process, lines):
        host, port = mc_address(lines)
        with Plc(host, int(port), timeout=PATIENCE) as plc:
            write_many(plc, 0, 100)
            events, lost = [], None
            for line in lines.all_lines():
                events.append(json.loads(line))
                if events[-1]["event"] == "lost":
                    lost = events[-1]["lines"]
                    break
            require(lost and lost > 1000, f"lost: {lost}; last events {events[-3:]}")
            shown = sum(event["event"] in ("buffer", "error") for event in events)  # an error: not to be written yet
            require(shown + lost >= 100 * 480, f"{shown} shown and {lost} lost of {100 * 480}")
            times = [event["t"] for event in events]
            require(times == sorted(times), "the number of lost lines is not at its place")
            require(json.loads(lines.line())["t"] >= events[-1]["t"], "the line after the lost ones is older")
            write_many(plc, 200, 100)
            until(lambda: plc.sd[420] > 300, "the CPU does not scan")  # 3 s: the nodes are up after one, then there are 150 frames a second
        begun = time.monotonic()
        require(ends(process, signal.SIGTERM) == 0, "exit code")
        print(f"    ended after {time.monotonic() - begun:.1f} s")
        errors = process.stderr.read().decode()
        require(re.fullmatch(r"canopus: \d+ lines lost: the output was not read\n", errors), errors)
        for line in list(lines.all_lines())[:-1]:
            json.loads(line)
    require(len(recorded(trace)) > 50, "the trace is not complete")


@check
def every_signal_ends_a_run_that_nobody_reads():
    for how in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        with started("run", first_plant_file(), "--json") as (process, lines):
            host, port = mc_address(lines)
            with Plc(host, int(port), timeout=PATIENCE) as plc:
                write_many(plc, 0, 60)
            require(ends(process, how) == 0, f"exit code after {how}")


@check
def an_unread_standard_error_does_not_stop_the_plant():
    """Invalid writes are errors, which people get on standard error."""
    reader, writer = os.pipe()
    try:
        with started("run", first_plant_file(), stderr=writer) as (process, lines):
            port = next(m[1] for m in (re.match(r"MC protocol.*:(\d+)$", line) for line in lines.all_lines()) if m)
            with Plc("127.0.0.1", int(port), timeout=PATIENCE) as plc:
                for _ in range(12000):
                    plc.g[0][24] = 300
                plc.d[100] = 4711
                require(plc.d[100] == 4711, "the PLC does not answer any more")
            require(ends(process, signal.SIGTERM) == 0, "exit code")
    finally:
        os.close(reader)
        os.close(writer)


@check
def in_virtual_time_the_plant_waits_for_the_reader():
    with started("run", first_plant_file(), "--virtual", "--for", "20min", "--json") as (process, lines):
        time.sleep(1)  # long enough to fill every queue; if not, the check proves less, but does not fail
        events = [json.loads(line)["event"] for line in lines.all_lines()]
        require(process.wait(timeout=PATIENCE) == 0, "exit code")
    require(events[-1] == "summary" and "lost" not in events, f"{events[-3:]}")
    require(events.count("load") == 1200, f"{events.count('load')} load events in 20 minutes")


@check
def a_signal_ends_a_run_in_virtual_time_that_waits_for_its_reader():
    with started("run", first_plant_file(), "--virtual", "--json") as (process, lines):
        lines.line()
        time.sleep(1)
        require(ends(process, signal.SIGTERM) == 0, "exit code")


@check
def a_trace_that_nobody_reads_does_not_stop_the_plant():
    """A FIFO, as for Wireshark."""
    fifo = scratch / "trace-fifo.pcap"
    os.mkfifo(fifo)
    with started("run", first_plant_file(), "--json", "--trace", fifo) as (process, lines):
        reader = os.open(fifo, os.O_RDONLY)
        try:
            host, port = mc_address(lines)
            with Plc(host, int(port), timeout=PATIENCE) as plc:
                plc.d[100] = 4711
                require(plc.d[100] == 4711, "the PLC does not answer")
            require(os.read(reader, 4) == (0xA1B23C4D).to_bytes(4, sys.byteorder), "no pcap header")
            ends(process, signal.SIGTERM)
        finally:
            os.close(reader)


@check
def a_signal_ends_a_run_whose_trace_has_no_reader():
    fifo = scratch / "trace-without-reader.pcap"
    os.mkfifo(fifo)
    with started("run", first_plant_file(), "--json", "--trace", fifo) as (process, _):
        time.sleep(0.5)  # until it waits for a reader; before that a signal ends it, too
        ends(process, signal.SIGTERM)


@check
def a_reader_that_begins_late_gets_what_was_kept_and_the_number_of_the_lost():
    """`canopus run --json | (sleep 60; cat)`, with a reader that wakes when enough has been lost."""
    with started("run", first_plant_file(), "--json") as (process, lines):
        host, port = mc_address(lines)
        pipe = process.stdout.fileno()
        reader = subprocess.Popen(["sh", "-c", f"read wake; exec cat <&{pipe}"], stdin=subprocess.PIPE,
                                  stdout=subprocess.PIPE, pass_fds=[pipe])
        try:
            process.stdout.close()  # the reader has it
            with Plc(host, int(port), timeout=PATIENCE) as plc:
                write_many(plc, 0, 100)
                reader.stdin.write(b"\n")
                reader.stdin.close()
                events = []
                for line in LineReader(reader.stdout).all_lines():
                    events.append(json.loads(line))
                    if events[-1]["event"] == "lost":
                        break
                require(events and events[-1]["event"] == "lost", f"the lost lines are not counted: {events[-3:]}")
                shown = sum(event["event"] in ("buffer", "error") for event in events)
                require(shown + events[-1]["lines"] >= 100 * 480, f"{shown} shown, {events[-1]} of {100 * 480}")
                plc.d[100] = 4711
                require(plc.d[100] == 4711, "the PLC does not answer any more")
            require(ends(process, signal.SIGTERM) == 0, "exit code")
        finally:
            reader.kill()
            reader.wait()


class Terminal:
    """A terminal of 100 columns and 30 lines, whose output can be stopped as by Ctrl-S."""

    def __init__(self):
        self.screen, self.program_side = pty.openpty()
        fcntl.ioctl(self.program_side, termios.TIOCSWINSZ, struct.pack("HHHH", 30, 100, 0, 0))
        self.shown = b""

    def stop(self):
        termios.tcflow(self.program_side, termios.TCOOFF)

    def go_on(self):
        termios.tcflow(self.program_side, termios.TCOON)

    def read(self, seconds):
        """What comes within the time; nothing if nothing comes."""
        if not select.select([self.screen], [], [], seconds)[0]:
            return b""
        piece = os.read(self.screen, 65536)
        self.shown += piece
        return piece

    def close(self):
        os.close(self.screen)
        os.close(self.program_side)


@check
def a_stopped_terminal_does_not_stop_the_plant():
    """Ctrl-S: clients are answered; Ctrl-Q: the table goes on; a signal ends the run while the terminal is stopped."""
    terminal = Terminal()
    try:
        with started("run", first_plant_file(), stdout=terminal.program_side, env={**os.environ, "TERM": "xterm"}) as (process, _):
            address = re.compile(rb"MC protocol\D*127\.0\.0\.1:(\d+)")
            until(lambda: terminal.read(1) is not None and address.search(terminal.shown), "the table does not name the port")
            port = int(address.search(terminal.shown)[1])
            terminal.stop()
            while terminal.read(1):
                pass  # what was under way
            with Plc("127.0.0.1", port, timeout=PATIENCE) as plc:
                write_many(plc, 0, 20)
                require(not terminal.read(1), "the terminal is not stopped")
                terminal.go_on()
                require(terminal.read(PATIENCE), "the table does not go on")
                terminal.stop()
                write_many(plc, 100, 20)
            require(ends(process, signal.SIGTERM) == 0, "exit code")
    finally:
        terminal.close()


# --- the system has no more of it


def processor_time(process):
    """Seconds that the process has used."""
    fields = pathlib.Path(f"/proc/{process.pid}/stat").read_text().rsplit(")", 1)[1].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK")


@check
def more_clients_than_file_descriptors_are_refused_in_words():
    """`ulimit -n 32`: eight clients of the bus join; whoever is too many is told so, and the run goes on without burning time."""
    limit = lambda: resource.setrlimit(resource.RLIMIT_NOFILE, (32, 32))
    with started("run", first_plant_file(), "--json", preexec_fn=limit) as (process, lines):
        ports, events = {}, []
        while len(ports) < 2:
            events.append(json.loads(lines.line()))
            if events[-1]["event"] == "listen":
                ports[events[-1]["protocol"]] = int(host_port(events[-1]["address"])[1])
        stop = threading.Event()

        def read():
            while not stop.is_set():
                if select.select([lines.descriptor], [], [], 0.1)[0]:
                    if (line := lines.line()) is None:
                        return
                    events.append(json.loads(line))

        reader = threading.Thread(target=read, daemon=True)
        reader.start()
        with contextlib.ExitStack() as stack:
            def connect(port):
                return stack.enter_context(socket.create_connection(("127.0.0.1", port), PATIENCE))

            for _ in range(8):
                client = connect(ports["socketcand"])
                require(client.recv(100) == b"< hi >", "a client is not greeted")
                client.sendall(b"< open line1 >")
                require(client.recv(100) == b"< ok >", "a client does not join")
            plc = stack.enter_context(Plc("127.0.0.1", ports["MC protocol"], timeout=PATIENCE))
            too_many = [connect(ports["socketcand"]) for _ in range(30)]
            answers = {client.recv(100) for client in too_many}
            require(b"< error too many open files >" in answers, f"answers: {answers}")
            refused = connect(ports["MC protocol"])
            require(refused.recv(100) == b"", "a PLC client that is too many is not turned away")
            before, begun = processor_time(process), time.monotonic()
            time.sleep(2)
            used, passed = processor_time(process) - before, time.monotonic() - begun
            require(used < passed / 2, f"it used {used} s of {passed} s")
            plc.d[100] = 4711
            require(plc.d[100] == 4711, "the PLC does not answer any more")
            until(lambda: any(e["event"] == "error" and "was refused: the process has no file descriptor left" in e["message"]
                              for e in list(events)), f"no error says so: {events[-5:]}")

        def greeted():
            with socket.create_connection(("127.0.0.1", ports["socketcand"]), PATIENCE) as client:
                return client.recv(100) == b"< hi >"

        until(greeted, "nobody can join after the others left")
        stop.set()
        reader.join()
        require(ends(process, signal.SIGTERM) == 0, "exit code")


@check
def a_store_folder_belongs_to_one_run_at_a_time():
    """The second run says who has it, and ends; after kill -9 of the first the next one starts."""
    plant = scratch / "one-store.toml"
    plant.write_text(first_plant_file().read_text().replace('listen = "127.0.0.1:0"', 'listen = "127.0.0.1:0"\nstore = "one-store"'))
    with started("run", plant, "--json") as (first, lines):
        mc_address(lines)
        second = subprocess.run([program, "run", str(plant), "--json"], capture_output=True, text=True, timeout=PATIENCE)
        require(second.returncode == 1, f"exit code {second.returncode}: {second.stderr}")
        require(re.search(rf"one-store\.toml:\d+:\d+: .*another process \({first.pid}\) uses it", second.stderr), second.stderr)
        require(second.stdout == "", f"it printed {second.stdout[:200]}")
        looked = subprocess.run([program, "check", str(plant)], capture_output=True, text=True, timeout=PATIENCE)
        require(looked.returncode == 0, f"a check needs the folder: {looked.stderr}")
        first.kill()
        first.wait()
    with started("run", plant, "--json") as (third, lines):
        mc_address(lines)
        require(ends(third, signal.SIGTERM) == 0, "exit code")
