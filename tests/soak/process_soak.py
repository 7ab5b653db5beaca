#!/usr/bin/env python3
"""A long run of the real process: clients that join, send, read or do not read, and leave in every way there is, while the
bus has faults by seed and a PLC client asks all the time. It ends with an error when

  - an answer of the MC protocol or of socketcand does not come, or is not the right one,
  - the program says that the machine is too slow although the machine had time for it, or does not say that it was
    suspended (now and then it is stopped for some seconds),
  - the program's memory grows after its warm-up (runs of 10 minutes and more),
  - a node does not answer once the faults are over, or the program does not end cleanly by SIGTERM.

usage: process_soak.py --program build/canopus [--minutes 120] [--seed 1] [--clients 8]

Everything is on 127.0.0.1, on ports of the system's choice; it needs nothing but Python and Linux (/proc).
"""
import argparse
import collections
import contextlib
import json
import os
import pathlib
import random
import re
import shutil
import signal
import socket
import struct
import subprocess
import sys
import tempfile
import threading
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DEVICES = {"io-block": 2, "encoder": 3, "drive": 4}
ANSWER_TIME = 60.0       # an answer later than this never comes; a machine at load 8 has been seen to need 5 s
CALM_AT_THE_END = 30.0   # seconds without faults before the end
MOST_GROWTH = 1024       # KiB of heap and stack from the second quarter of the run to the last one


# --- a socketcand client, a process of its own ------------------------------------------------------------------------

class NoAnswer(Exception):
    pass


class BusClient:
    def __init__(self, port):
        self.text = b""
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=ANSWER_TIME)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def answer(self, wanted, timeout=ANSWER_TIME):
        """Reads on until this element comes; frames before it are passed over. How long it took."""
        start = time.monotonic()
        while True:
            element, bracket, rest = self.text.partition(b">")
            if bracket:
                self.text = rest
                if element.strip().startswith(wanted):
                    return time.monotonic() - start
                if element.strip().startswith(b"< error") and b"lost" not in element:
                    raise NoAnswer(f"expected {wanted.decode()}, received {element.decode(errors='replace')}")
                continue
            left = start + timeout - time.monotonic()
            if left <= 0:
                raise NoAnswer(f"no {wanted.decode()} within {timeout:.0f} s")
            self.socket.settimeout(left)
            try:
                received = self.socket.recv(65536)
            except TimeoutError:
                raise NoAnswer(f"no {wanted.decode()} within {timeout:.0f} s") from None
            if not received:
                raise NoAnswer(f"the connection was closed in place of {wanted.decode()}")
            self.text += received

    def read_for(self, seconds):
        end = time.monotonic() + seconds
        size = 0
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            with contextlib.suppress(TimeoutError):
                received = self.socket.recv(65536)
                if not received:
                    raise NoAnswer("the connection was closed")
                size += len(received)
        return size

    def send(self, *elements):
        self.socket.settimeout(ANSWER_TIME)
        self.socket.sendall("".join(elements).encode())

    def join(self, raw=True):
        self.answer(b"< hi")
        self.send("< open line1 >")
        self.answer(b"< ok")
        if raw:
            self.send("< rawmode >")
            self.answer(b"< ok")

    def echo(self):
        self.send("< echo >")
        return self.answer(b"< echo")

    def flood(self, seconds, frames):
        """Sends as fast as the connection takes it; does not care whether the bus keeps up."""
        data = "".join(frames).encode()
        end = time.monotonic() + seconds
        sent = 0
        self.socket.setblocking(False)
        while time.monotonic() < end:
            try:
                sent += self.socket.send(data[sent % len(data):])
            except BlockingIOError:
                time.sleep(0.01)
            except (ConnectionResetError, BrokenPipeError):
                break
        return sent

    def leave(self, how):
        if how == "half":  # says that nothing more comes, and waits for the server's end
            self.socket.shutdown(socket.SHUT_WR)
            self.socket.settimeout(ANSWER_TIME)
            try:
                while self.socket.recv(65536):
                    pass
            except ConnectionResetError:
                pass
            except TimeoutError:
                raise NoAnswer("the server did not end a connection that its client had closed") from None
        if how == "reset":
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if how == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        self.socket.close()


def some_frames(dice, count):
    """Frames that disturb no node: of low priority, a few of them extended, remote, or before everybody else's."""
    frames = []
    for _ in range(count):
        data = " ".join(f"{dice.randrange(256):x}" for _ in range(8))
        kind = dice.random()
        if kind < 0.8:
            frames.append(f"< send {dice.randrange(0x780, 0x7C0):x} 8 {data} >")
        elif kind < 0.9:
            frames.append(f"< send {dice.randrange(0x1FFFFFFF):08x} 8 {data} >")
        elif kind < 0.95:
            frames.append(f"< sendrtr {dice.randrange(0x780, 0x7C0):x} 2 >")
        else:
            frames.append(f"< send {dice.randrange(0x10, 0x80):x} 8 {data} >")
    return frames


def upload_request(node):
    return f"< send {0x600 + node:x} 8 40 00 10 00 0 0 0 0 >"


def conversation(dice, port, count):
    client = BusClient(port)
    count["joins"] += 1
    try:
        what = dice.choices(["greeting", "open", "read", "ask", "flood", "deaf", "short"], [5, 5, 20, 30, 15, 10, 15])[0]
        if what == "greeting":
            client.answer(b"< hi")
        elif what == "open":
            client.join(raw=False)
            count["longest echo"] = max(count["longest echo"], client.echo())
            count["echoes"] += 1
        elif what == "read":
            client.join()
            count["bytes read"] += client.read_for(dice.uniform(0.05, 5))
        elif what == "ask":
            client.join()
            for _ in range(dice.randrange(1, 20)):
                count["longest echo"] = max(count["longest echo"], client.echo())
                count["echoes"] += 1
                client.send(upload_request(dice.choice(list(DEVICES.values()))), *some_frames(dice, dice.randrange(5)))
                count["bytes read"] += client.read_for(dice.uniform(0, 0.2))
        elif what == "flood":
            client.join(raw=dice.random() < 0.5)
            count["floods"] += 1
            count["bytes flooded"] += client.flood(dice.uniform(0.05, 1), some_frames(dice, 500))
        elif what == "deaf":
            client.join()
            count["deaf"] += 1
            client.send(*some_frames(dice, dice.randrange(100)))
            time.sleep(dice.uniform(0.5, 15))
        elif what == "short":
            client.join(raw=False)
            client.send(*some_frames(dice, 3))
        client.leave(dice.choices(["close", "half", "reset", "kill"], [50, 20, 25, 5])[0])
    except (ConnectionResetError, BrokenPipeError):
        if what != "deaf":  # the server ends clients that do not read
            raise
    finally:
        client.socket.close()


def client_process(port, seed, end):
    dice = random.Random(seed)
    count = collections.Counter()
    while time.monotonic() < end:
        problem = None
        try:
            conversation(dice, port, count)
        except (NoAnswer, OSError) as error:
            problem = f"{type(error).__name__}: {error}"
        print(json.dumps({"count": count, "problem": problem}), flush=True)
        count = collections.Counter()
        if problem:
            return 1
        time.sleep(dice.expovariate(2))
    return 0


# --- the PLC client ---------------------------------------------------------------------------------------------------

class PlcClient(threading.Thread):
    """Asks without a pause worth the name; every answer is compared with what it must be."""

    def __init__(self, port, seed):
        super().__init__(daemon=True)
        self.port, self.dice = port, random.Random(seed)
        self.stop, self.problem = threading.Event(), None
        self.answers, self.longest = 0, 0.0

    def ask(self, connection, command, data):
        body = struct.pack("<HHH", 16, command[0], command[1]) + data
        start = time.monotonic()
        connection.sendall(bytes.fromhex("5000 00 ff ff03 00") + struct.pack("<H", len(body)) + body)
        head = self.read(connection, 11)
        length, end_code = struct.unpack("<HH", head[7:11])
        answer = self.read(connection, length - 2)
        self.longest = max(self.longest, time.monotonic() - start)
        if head[:7] != bytes.fromhex("d000 00 ff ff03 00") or end_code != 0:
            raise NoAnswer(f"{command[0]:04X} was answered with {head.hex()}")
        self.answers += 1
        return answer

    @staticmethod
    def read(connection, size):
        data = b""
        while len(data) < size:
            received = connection.recv(size - len(data))
            if not received:
                raise NoAnswer("the MC protocol's connection was closed")
            data += received
        return data

    def converse(self, connection):
        words = [self.dice.randrange(0x10000) for _ in range(self.dice.randrange(1, 64))]
        packed = struct.pack(f"<{len(words)}H", *words)
        first = self.dice.randrange(10000)
        where = struct.pack("<I", first)[:3] + b"\xa8" + struct.pack("<H", len(words))
        self.ask(connection, (0x1401, 0), where + packed)
        if self.ask(connection, (0x0401, 0), where) != packed:
            raise NoAnswer(f"D{first} and its neighbours are not what was written")
        buffer = bytes.fromhex("0000") + struct.pack("<I", 10000)[:3] + bytes.fromhex("ab 0000 0000 f8") + struct.pack("<H", 16)
        if len(self.ask(connection, (0x0401, 0x0080), buffer)) != 32:
            raise NoAnswer("U0\\G10000: not 16 words")
        self.ask(connection, (0x0401, 0), bytes.fromhex("000000 9c 0200"))  # X0, 32 points

    def run(self):
        try:
            while not self.stop.is_set():
                with socket.create_connection(("127.0.0.1", self.port), timeout=ANSWER_TIME) as connection:
                    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    for _ in range(self.dice.randrange(1, 2000)):
                        self.converse(connection)
                        if self.stop.wait(0.02):
                            break
        except (NoAnswer, OSError) as error:
            self.problem = f"MC protocol: {type(error).__name__}: {error}"


# --- the program ------------------------------------------------------------------------------------------------------

def plant_text(dice, seconds):
    text = (ROOT / "examples/first-plant/plant.toml").read_text()
    text = text.replace("127.0.0.1:5007", "127.0.0.1:0").replace("127.0.0.1:29536", "127.0.0.1:0")
    text = text.replace('"../devices/', f'"{ROOT}/examples/devices/')
    faults = []
    start = 10.0
    while start < seconds - CALM_AT_THE_END - 10:
        length = dice.uniform(0.5, 20)
        kind = dice.choice(["drop", "corrupt", "duplicate", "delay", "babble", "stuck dominant", "jam", "cut"])
        lines = [f'kind = "{kind}"']
        if kind in ("drop", "corrupt", "duplicate", "delay"):
            lines.append(f"probability = {dice.choice([0.001, 0.01, 0.1, 0.5])}")
            if dice.random() < 0.3:
                lines.append(f'sender = "{dice.choice(list(DEVICES))}"')
        else:
            lines.append(f'ports = ["{dice.choice(list(DEVICES))}"]')
        if kind == "delay":
            lines.append(f'delay = "{dice.randrange(1, 50)}ms"')
        if kind == "babble":
            lines.append(f"frame = {{ identifier = {dice.choice([0x7F0, 0x7F1, 0x40])}, data = [1, 2, 3] }}")
            lines.append(f'interval = "{dice.choice([1, 2, 10])}ms"')
        if kind == "stuck dominant":
            length = dice.uniform(0.001, 1)
        lines.append(f'from = "{int(start * 1000)}ms"')
        lines.append(f'until = "{int((start + length) * 1000)}ms"')
        faults.append("[[bus.fault]]\n" + "\n".join(lines) + "\n")
        start += length + dice.expovariate(1 / 20)
    head, device, rest = text.partition("[[device]]")
    return head + "\n".join(faults) + "\n" + device + rest, len(faults)


Sample = collections.namedtuple("Sample", "at running waiting")


class Program:
    def __init__(self, program, plant, scratch):
        self.errors_file = (scratch / "stderr").open("w+")
        self.process = subprocess.Popen([program, "run", str(plant), "--json"], stdout=subprocess.PIPE,
                                        stderr=self.errors_file, text=True)
        self.ports, self.ready = {}, threading.Event()
        self.events = collections.Counter()
        self.summary, self.too_slow, self.suspensions, self.others = None, [], [], collections.Counter()
        self.pending = []
        self.samples = collections.deque(maxlen=3000)  # of the last 5 minutes
        self.memory = []                               # (seconds, KiB)
        self.started = time.monotonic()
        self.reader = threading.Thread(target=self._read, daemon=True)
        self.reader.start()

    def _read(self):
        for line in self.process.stdout:
            event = json.loads(line)
            self.events[event["event"]] += 1
            if event["event"] == "listen":
                self.ports[event["protocol"]] = int(event["address"].rsplit(":", 1)[1])
                if len(self.ports) == 2:
                    self.ready.set()
            elif event["event"] == "summary":
                self.summary = event
            elif event["event"] == "error":
                late = re.search(r"is ([\d.]+) (us|ms|s) late", event["message"])
                if late:
                    lag = float(late[1]) * {"us": 1e-6, "ms": 1e-3, "s": 1.0}[late[2]]
                    self.pending.append((time.monotonic(), lag, event["message"]))
                elif suspended := re.search(r"suspended for ([\d.]+) (ms|s)", event["message"]):
                    self.suspensions.append(float(suspended[1]) * {"ms": 1e-3, "s": 1.0}[suspended[2]])
                else:
                    self.others[f"{event['source']}: {re.sub(chr(92) + 'd+', 'N', event['message'])}"] += 1
        self.ready.set()

    def sample(self):
        """How much processor time the main thread had, and how long it waited for a processor."""
        with open(f"/proc/{self.process.pid}/schedstat") as file:
            running, waiting, _ = map(int, file.read().split())
        self.samples.append(Sample(time.monotonic(), running * 1e-9, waiting * 1e-9))
        judged = [late for late in self.pending if late[0] < self.samples[-1].at - 0.3]
        for late in judged:
            self.pending.remove(late)
            self.too_slow.append((late[2], self.was_busy(late[0], late[1])))

    def was_busy(self, at, lag):
        """Whether the process ran or waited for a processor for at least half of the time by which it says it was late."""
        before = [s for s in self.samples if s.at <= at - lag - 0.2]
        first = before[-1] if before else self.samples[0]
        last = self.samples[-1]
        return (last.running - first.running) + (last.waiting - first.waiting) >= 0.5 * lag

    def suspend(self, seconds):
        """As Ctrl-Z and fg; how much of it the program reports within some seconds."""
        known = len(self.suspensions)
        self.process.send_signal(signal.SIGSTOP)
        time.sleep(seconds)
        self.process.send_signal(signal.SIGCONT)
        end = time.monotonic() + 10
        while time.monotonic() < end and len(self.suspensions) == known:
            self.sample()
            time.sleep(0.1)
        return sum(self.suspensions[known:])

    def sample_memory(self):
        with open(f"/proc/{self.process.pid}/status") as file:
            anonymous = re.search(r"RssAnon:\s+(\d+) kB", file.read())
        self.memory.append((time.monotonic() - self.started, int(anonymous[1])))

    def growth(self, seconds):
        """KiB from the second quarter to the last one; and the last one's."""
        def median_between(low, high):
            values = sorted(kib for at, kib in self.memory if low * seconds <= at <= high * seconds)
            return values[len(values) // 2] if values else 0
        return median_between(0.75, 1) - median_between(0.25, 0.5), median_between(0.75, 1)


class BusClients:
    def __init__(self, port, seed, count, end):
        self.port, self.end = port, end
        self.seeds = iter(range(seed * 1_000_000, (seed + 1) * 1_000_000))
        self.count, self.killed, self.problems = collections.Counter(), 0, []
        self.longest_echo = 0.0
        self.processes = {}
        for _ in range(count):
            self.start()

    def start(self):
        process = subprocess.Popen([sys.executable, __file__, "--client", str(self.port), str(next(self.seeds)), str(self.end)],
                                   stdout=subprocess.PIPE, text=True)
        reader = threading.Thread(target=self._read, args=[process], daemon=True)
        reader.start()
        self.processes[process] = reader

    def _read(self, process):
        for line in process.stdout:
            with contextlib.suppress(json.JSONDecodeError):  # cut by a kill
                said = json.loads(line)
                self.longest_echo = max(self.longest_echo, said["count"].pop("longest echo", 0.0))
                self.count.update(said["count"])
                if said["problem"]:
                    self.problems.append("socketcand: " + said["problem"])

    def look(self):
        """Starts anew who was killed."""
        for process, reader in list(self.processes.items()):
            if process.poll() is None:
                continue
            reader.join()
            process.stdout.close()
            del self.processes[process]
            if process.returncode == -signal.SIGKILL:
                self.killed += 1
            elif process.returncode != 0 and not self.problems:
                self.problems.append(f"a client ended with {process.returncode}")
            if time.monotonic() < self.end:
                self.start()

    def stop(self):
        for process, reader in self.processes.items():
            try:
                process.wait(timeout=2 * ANSWER_TIME)
            except subprocess.TimeoutExpired:
                self.problems.append("a client did not come to its end")
                process.kill()
                process.wait()
            reader.join()
        self.look()


def ask_every_node(port):
    """Every device answers an SDO upload of 1000H once the faults are over."""
    client = BusClient(port)
    try:
        client.join()
        silent = []
        for name, node in DEVICES.items():
            for attempt in range(5):
                client.send(upload_request(node))
                try:
                    client.answer(f"< frame {0x580 + node:X}".encode(), timeout=5 if attempt < 4 else 20)
                    break
                except NoAnswer:
                    pass
            else:
                silent.append(name)
        return silent
    finally:
        client.socket.close()


def soak(args, scratch):
    seconds = args.minutes * 60
    dice = random.Random(args.seed)
    text, faults = plant_text(dice, seconds)
    plant = scratch / "plant.toml"
    plant.write_text(text)
    program = Program(str(args.program), plant, scratch)
    problems = []
    clients = plc = None
    try:
        if not program.ready.wait(timeout=60) or len(program.ports) != 2:
            return [f"the program did not start: {(scratch / 'stderr').read_text()[-2000:]}"]
        end = program.started + seconds
        print(f"process soak: {args.minutes:g} min, seed {args.seed}, {args.clients} clients, {faults} bus faults; "
              f"pid {program.process.pid}", flush=True)
        plc = PlcClient(program.ports["MC protocol"], args.seed)
        plc.start()
        clients = BusClients(program.ports["socketcand"], args.seed, args.clients, end - CALM_AT_THE_END / 2)
        next_memory = next_line = 0.0
        next_stop = min(seconds / 2, dice.uniform(60, 600))
        stops = 0
        while time.monotonic() < end:
            if program.process.poll() is not None:
                return [f"the program ended with {program.process.returncode}: {(scratch / 'stderr').read_text()[-2000:]}"]
            program.sample()
            now = time.monotonic() - program.started
            if now >= next_memory:
                program.sample_memory()
                clients.look()
                next_memory = now + min(5.0, seconds / 100)
            if now >= next_line:
                print(f"  {now / 60:6.1f} min  {program.memory[-1][1]} KiB, {clients.count['joins']} joins, {plc.answers} answers, "
                      f"{len(program.too_slow)} too slow", flush=True)
                next_line = now + max(60.0, seconds / 24)
            if now >= next_stop and not clients.problems:
                stopped = dice.uniform(2, 8)
                reported = program.suspend(stopped)
                stops += 1
                if not stopped - 1.2 < reported < stopped + 1.2:
                    problems.append(f"stopped for {stopped:.1f} s, reported: {reported:.1f} s")
                next_stop = now + stopped + dice.uniform(300, 900)
            if clients.problems or plc.problem:
                break
            time.sleep(0.1)
        clients.end = 0
        if not (clients.problems or plc.problem):
            clients.stop()
            silent = ask_every_node(program.ports["socketcand"])
            if silent:
                problems.append(f"no answer after the faults: {', '.join(silent)}")
        plc.stop.set()
        plc.join(timeout=2 * ANSWER_TIME)
        if plc.is_alive():
            problems.append("MC protocol: the last answer did not come")
        problems += clients.problems + ([plc.problem] if plc.problem else [])
        time.sleep(0.5)
        program.sample()
        program.process.send_signal(signal.SIGTERM)
        try:
            code = program.process.wait(timeout=ANSWER_TIME)
        except subprocess.TimeoutExpired:
            code = None
            problems.append("SIGTERM did not end the program")
        program.reader.join(timeout=ANSWER_TIME)
        if code not in (0, None):
            problems.append(f"the program ended with {code}: {(scratch / 'stderr').read_text()[-2000:]}")
        if program.summary is None:
            problems.append("there was no summary")
        false_lag = [message for message, busy in program.too_slow if not busy]
        problems += [f"false: {message}" for message in false_lag]
        growth, size = program.growth(seconds)
        if growth > MOST_GROWTH and args.minutes >= 10:
            problems.append(f"memory grew by {growth} KiB")
        report(program, clients, plc, stops, false_lag, growth, size)
        return problems
    finally:
        if program.process.poll() is None:
            program.process.kill()
            program.process.wait()
        for process in clients.processes if clients else []:
            if process.poll() is None:
                process.kill()
                process.wait()


def report(program, clients, plc, stops, false_lag, growth, size):
    count = clients.count
    print(f"socketcand: {count['joins']} joins, {clients.killed} clients killed, {count['floods']} floods "
          f"({count['bytes flooded'] / 1e6:.1f} MB), {count['deaf']} did not read; {count['bytes read'] / 1e6:.1f} MB read; "
          f"{count['echoes']} echoes, longest {clients.longest_echo:.3f} s")
    print(f"MC protocol: {plc.answers} answers, longest {plc.longest:.3f} s (stops included)")
    print(f"too slow: {len(program.too_slow)}, of them false: {len(false_lag)}; stopped {stops} times, {len(program.suspensions)} suspensions reported")
    print(f"memory: {size} KiB, grown by {growth} KiB")
    if program.summary:
        bus = program.summary["buses"][0]
        states = ", ".join(f"{n['name']} {n['state']}" for n in program.summary["nodes"])
        print(f"summary: {bus['frames']} frames, {bus['error_frames']} error frames, largest lag {program.summary.get('lag')} s; {states}")
    events = ", ".join(f"{name} {number}" for name, number in sorted(program.events.items()))
    print(f"events: {events}; processor {program.samples[-1].running:.0f} s")
    for text, number in program.others.most_common(8):
        print(f"  {number} x {text}")


def main():
    if sys.argv[1:2] == ["--client"]:
        return client_process(int(sys.argv[2]), int(sys.argv[3]), float(sys.argv[4]))
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n", maxsplit=1)[0])
    parser.add_argument("--program", type=pathlib.Path, default=ROOT / "build/canopus")
    parser.add_argument("--minutes", type=float, default=120)
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--clients", type=int, default=8, help="socketcand clients at a time (at most 30)")
    args = parser.parse_args()
    args.program = args.program.resolve()
    scratch = pathlib.Path(tempfile.mkdtemp(prefix="canopus-soak-"))
    try:
        problems = soak(args, scratch)
    finally:
        shutil.rmtree(scratch)
    for problem in problems[:20]:
        print(f"FAILED: {problem}")
    print("process soak:", "failed" if problems else "good")
    return 1 if problems else 0


if __name__ == "__main__":
    sys.exit(main())
