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
import subprocess
import sys
import tempfile
import threading
import time

from soak_clients import ANSWER_TIME, DEVICES, BusClient, NoAnswer, PlcClient, client_process, upload_request

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
CALM_AT_THE_END = 30.0   # seconds without faults before the end
MOST_GROWTH = 1024       # KiB of heap and stack from the second quarter of the run to the last one


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


Sample = collections.namedtuple("Sample", "at running waiting stolen")  # seconds; stolen: from the machine, by its host


def stolen_time():
    with open("/proc/stat") as file:
        return int(file.readline().split()[8]) / os.sysconf("SC_CLK_TCK")



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
        self.samples.append(Sample(time.monotonic(), running * 1e-9, waiting * 1e-9, stolen_time()))
        judged = [late for late in self.pending if late[0] < self.samples[-1].at - 0.3]
        for late in judged:
            self.pending.remove(late)
            self.too_slow.append((late[2], self.was_busy(late[0], late[1])))

    def was_busy(self, at, lag):
        """Whether for at least half of the time by which it says it was late the process ran, waited for a processor, or the
        machine had none because its host gave it to another one. Otherwise the figures are kept for the report."""
        before = [s for s in self.samples if s.at <= at - lag - 0.2]
        first = before[-1] if before else self.samples[0]
        last = self.samples[-1]
        busy = [last.running - first.running, last.waiting - first.waiting, last.stolen - first.stolen]
        if sum(busy) >= 0.5 * lag:
            return True
        print(f"    {(at - self.started) / 60:6.1f} min  {lag:.3f} s late, and in {last.at - first.at:.3f} s it ran {busy[0]:.3f}, "
              f"waited {busy[1]:.3f}, the machine lost {busy[2]:.3f}", flush=True)
        return False

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
