"""Traces of real runs, judged by tshark and python-can; a replay, heard by a client of its own."""
import contextlib
import csv
import json
import os
import pathlib
import shutil
import signal
import socket
import struct
import subprocess
import threading
import time

from kit import PATIENCE, PYTHON, ROOT, RawClient, Skip, check, command, first_plant, first_plant_file, program, require, running, scratch, until


def recorded_as(extension):
    path = scratch / f"formats.{extension}"
    command(program, "run", first_plant_file(), "--virtual", "--for", "5s", "--seed", "7", "--quiet", "--trace", path)
    return path


def python_can_frames(path, kind):
    """Identifier and data of each frame, and its time in us since the first one."""
    code = ("import sys, can\n"
            f"messages = list({kind}(sys.argv[1]))\n"
            "for m in messages: print(m.arbitration_id, bytes(m.data).hex() or '-', round((m.timestamp - messages[0].timestamp) * 1e6))\n")
    return command(PYTHON, "-c", code, path).stdout.splitlines()


@check
def a_run_is_recorded_alike_in_every_format():
    done = subprocess.run([PYTHON, "-c", "import can"], capture_output=True)
    if done.returncode != 0:
        raise Skip("python3-can is not installed")
    log = python_can_frames(recorded_as("log"), "can.CanutilsLogReader")
    require(len(log) > 500, f"only {len(log)} frames in the log")
    for extension, kind in (("asc", "can.ASCReader"), ("trc", "can.TRCReader")):
        frames = python_can_frames(recorded_as(extension), kind)
        require(frames == log, f"{extension}: python-can reads {len(frames)} frames, {len(log)} of the log")
    with open(recorded_as("csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    first = float(rows[0]["time"])
    frames = [f"{int(row['id'], 16)} {bytes.fromhex(row['data']).hex() or '-'} {round((float(row['time']) - first) * 1e6)}"
              for row in rows]
    require(frames == log, "csv: other frames than in the log")


@check
def tshark_reads_the_captures_of_a_run_alike():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    fields = ["-T", "fields", "-e", "frame.time_epoch", "-e", "can.id", "-e", "can.len", "-d", "can.subdissector,canopen",
              "-e", "_ws.col.Info"]
    pcap, pcapng = (command("tshark", "-r", recorded_as(extension), *fields).stdout for extension in ("pcap", "pcapng"))
    require(pcap.count("\n") > 500, "the pcap is almost empty")
    require(pcap == pcapng, "the pcap and the pcapng differ")
    names = command("tshark", "-r", recorded_as("pcapng"), "-T", "fields", "-e", "frame.interface_name").stdout
    require(set(names.split()) == {"line1"}, "the interface is not named as the bus")


@check
def traces_of_other_programs_are_counted_as_tshark_counts_them():
    folder = ROOT.parent / "shared" / "data" / "traces"
    if not shutil.which("tshark") or not folder.is_dir():
        raise Skip("tshark or ../shared/data/traces is not there")
    for path in sorted(folder.glob("*.pcapng")):
        counted = command("tshark", "-r", path, "-Y", "can", "-T", "fields", "-e", "frame.number").stdout.count("\n")
        info = json.loads(command(program, "trace", "info", path, "--json").stdout)
        require(info["frames"] + info["error_frames"] == counted, f"{path.name}: {info['frames']} frames, tshark has {counted}")


@check
def diff_ends_as_diff_does():
    log = recorded_as("log")
    asc = recorded_as("asc")
    command(program, "trace", "diff", log, asc, "--ignore-channels", "--tolerance", "0ms", "-q")
    lines = log.read_text().splitlines()
    changed = scratch / "changed.log"
    changed.write_text("\n".join(lines[:100] + lines[101:]) + "\n")
    done = command(program, "trace", "diff", log, changed, expect=1)
    require("1 only in" in done.stdout and done.stdout.startswith("- "), done.stdout[:500])
    command(program, "trace", "diff", log, scratch / "nothing.log", expect=2)


@check
def an_output_nobody_reads_ends_a_conversion_quietly():
    big = scratch / "big.log"
    big.write_text("(1.000000) can0 123#0102030405060708\n" * 200000)
    done = subprocess.run(f"{program} trace convert {big} - --out-format csv | head -1", shell=True, capture_output=True, text=True)
    require(done.stdout.startswith("time,"), done.stdout[:200])
    require("terminate" not in done.stderr, done.stderr[:500])


@check
def a_replay_keeps_the_times_of_the_trace():
    path = scratch / "replay.log"
    path.write_text("(10.000000) a 123#01\n(10.300000) a 124#02\n(10.400000) a 1ABCDEF0#03\n")
    with first_plant() as plant:
        client = RawClient(plant)
        apart = []

        def replayed_in_time():
            """Whether the second frame came when it must; a machine that stands still meanwhile delays one of them."""
            start = time.monotonic()
            done = command(program, "replay", path, "--bus", f"socketcand:{plant.socketcand}")
            require(time.monotonic() - start >= 0.4, "the replay was faster than the trace")
            require("3 frames sent" in done.stdout, done.stdout)
            heard = []
            while len(heard) < 3:
                words = client.element()
                if words[0] == "frame" and words[1].upper() in ("123", "124", "1ABCDEF0"):
                    heard.append((words[1].upper(), float(words[2])))
            require([name for name, _ in heard] == ["123", "124", "1ABCDEF0"], str(heard))
            apart.append(heard[1][1] - heard[0][1])
            return 0.25 < apart[-1] < 0.5
        until(replayed_in_time, f"the second frame came after {apart} s instead of 0.3 s")
        done = command(program, "replay", path, "--bus", f"socketcand:{plant.socketcand}", "--speed", "max", "--loop", "5", "--can-id", "123-124")
        require("10 frames sent" in done.stdout, done.stdout)


class SlowBus(threading.Thread):
    """A server of one client that stands still for `pauses[n]` s (None: for ever) before it takes frame n, and keeps the numbers that the
    frames carry. Subclasses say what it speaks."""

    def __init__(self, pauses):
        super().__init__(daemon=True)
        self.pauses, self.numbers, self.over = pauses, [], threading.Event()
        self.server = socket.socket()
        self.server.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        self.server.bind(("127.0.0.1", 0))
        self.server.listen()
        self.port = self.server.getsockname()[1]
        self.start()

    def run(self):
        self.socket = self.server.accept()[0]
        self.greet()
        rest = b""
        with contextlib.suppress(OSError):
            while data := self.socket.recv(65536):
                rest = self.take(rest + data)

    def greet(self):
        pass

    def frame(self, number):
        if len(self.numbers) in self.pauses:
            self.over.wait(self.pauses[len(self.numbers)])
        self.numbers.append(number)


class SlowAdapter(SlowBus):
    """A Lawicel adapter, which says when a frame is on the bus."""

    def take(self, data):
        *lines, rest = data.split(b"\r")
        for line in lines:
            if line[:1] == b"t":
                self.frame(int(line[5:], 16))
            self.socket.sendall({b"V": b"V1013\r", b"F": b"F00\r", b"t": b"z\r"}.get(line[:1], b"\r"))
        return rest


class SlowCannelloni(SlowBus):
    def greet(self):
        self.socket.sendall(b"CANNELLONIv1")
        require(self.socket.recv(12, socket.MSG_WAITALL) == b"CANNELLONIv1", "the greeting")

    def take(self, data):
        end = len(data) - len(data) % 13
        for at in range(0, end, 13):
            identifier, length, number = struct.unpack(">IBQ", data[at:at + 13])
            require((identifier, length) == (0x321, 8), f"frame {len(self.numbers)}: {data[at:at + 13].hex()}")
            self.frame(number)
        return data[end:]


def numbered_log(count):
    """Frames whose data are their numbers."""
    path = scratch / f"numbered-{count}.log"
    path.write_text("".join(f"({1 + i / 1e6:.6f}) can0 321#{i:016X}\n" for i in range(count)))
    return path


@check
def a_replay_waits_for_a_bus_that_takes_no_frames_for_a_time():
    # An adapter may take 0.5 s for an answer. The pauses of cannelloni are longer than the replay's patience was.
    for kind, address, count, pauses, least in (
            (SlowAdapter, "slcan:tcp:127.0.0.1:{}@250000", 10000, {3000: 0.3, 6000: 0.2, 9999: 0.3}, 0.8),
            (SlowCannelloni, "cannelloni:tcp:127.0.0.1:{}", 600000, {5: 3, 599990: 1}, 3)):
        bus = kind(pauses)
        done = command(program, "replay", numbered_log(count), "--bus", address.format(bus.port), "--speed", "max")
        require(done.stdout.startswith(f"{count} frames sent in "), done.stdout)
        require(float(done.stdout.split()[4]) > least, f"{kind.__name__}: it did not wait: {done.stdout}")
        bus.join(PATIENCE)
        require(bus.numbers == list(range(count)), f"{kind.__name__}: {len(bus.numbers)} frames, or another order")
        require(done.stderr == "", done.stderr)


@check
def a_replay_says_when_a_bus_takes_no_more_frames():
    bus = SlowCannelloni({500: None})
    start = time.monotonic()
    done = command(program, "replay", numbered_log(600000), "--bus", f"cannelloni:tcp:127.0.0.1:{bus.port}", "--speed", "max", expect=1)
    require(time.monotonic() - start > 10, f"it ended after {time.monotonic() - start:.1f} s")
    bus.over.set()
    require("the bus has taken nothing for 10 s; not sent: " in done.stderr and " and the rest of the trace" in done.stderr, done.stderr)
    bus = SlowAdapter({500: None})  # this transport knows by itself
    done = command(program, "replay", numbered_log(1000), "--bus", f"slcan:tcp:127.0.0.1:{bus.port}@250000", "--speed", "max", expect=1)
    bus.over.set()
    require("the adapter answers no more" in done.stderr and "frames may be missing" in done.stderr, done.stderr)


def numbers_on_the_bus(trace):
    """Of the frames 321H of a recording, as tshark reads them."""
    lines = command("tshark", "-r", trace, "-Y", "can.id == 0x321", "-T", "fields", "-e", "data.data").stdout.split()
    return [int(line.replace(":", ""), 16) for line in lines]


@check
def a_replay_loses_nothing_to_a_plant_that_stands_still():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    count = 30000
    with first_plant() as plant:
        replay = subprocess.Popen([program, "replay", numbered_log(count), "--bus", f"socketcand:{plant.socketcand}", "--speed", "max"],
                                  stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        for pause in (0.5, 4):
            time.sleep(0.5)
            plant.process.send_signal(signal.SIGSTOP)
            time.sleep(pause)
            plant.process.send_signal(signal.SIGCONT)
        said, errors = replay.communicate(timeout=300)
        require(replay.returncode == 0 and errors == "", f"exit code {replay.returncode}: {errors}")
        require(said.startswith(f"{count} frames sent in "), said)
        plant.stop()
        numbers = numbers_on_the_bus(plant.trace)
    require(numbers == list(range(count)), f"{len(numbers)} frames on the bus, or another order")


@check
def a_replay_on_a_bus_without_another_node_ends_with_an_error():
    path = scratch / "alone.toml"
    path.write_text('[plant]\nname = "alone"\n[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n')
    with running(path, has_plc=False) as plant:  # no node acknowledges
        done = command(program, "replay", numbered_log(20000), "--bus", f"socketcand:{plant.socketcand}", "--speed", "max", expect=1)
        require("canopus: " in done.stderr and "frames" in done.stderr, done.stderr)


@check
def a_named_pipe_that_nobody_writes_to_is_waited_for_in_words():
    """A trace that comes through a named pipe: commands say that they wait for it, end by a signal, and read it when it comes."""
    silent = scratch / "silent.log"
    os.mkfifo(silent)
    waits = f"canopus: {silent}: waiting until a program writes to this named pipe\n"
    plant = scratch / "plant.toml"
    plant.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\n')
    commands = [("trace", "info", silent), ("trace", "show", silent), ("replay", silent, "--bus", "socketcand:127.0.0.1:1"),
                ("run", plant, "--bus", f"replay:{silent}", "--quiet")]
    for words in commands:
        for how in (signal.SIGINT, signal.SIGTERM):
            with subprocess.Popen([program, *map(str, words)], stderr=subprocess.PIPE, text=True) as process:
                said = process.stderr.readline()
                process.send_signal(how)
                process.wait(timeout=PATIENCE)
            require(said == waits, f"{words}: {said}")
    with subprocess.Popen([program, "run", plant, "--bus", f"replay:{silent}", "--quiet"], stderr=subprocess.PIPE, text=True) as run:
        require(run.stderr.readline() == waits, "the run does not say that it waits")
        with open(silent, "w") as writer:
            writer.write("(1.000000) can0 123#01\n")
            writer.flush()
            until(lambda: handles(run.pid, signal.SIGTERM), "the plant runs, and waits for the next frame")
            run.send_signal(signal.SIGTERM)
            require(run.wait(timeout=PATIENCE) == 0, "SIGTERM does not end it as any run")


def handles(process, number):
    status = pathlib.Path(f"/proc/{process}/status").read_text()
    caught = next(line.split()[1] for line in status.splitlines() if line.startswith("SigCgt:"))
    return int(caught, 16) >> (number - 1) & 1
