"""What the plays share: a plant in step, its bus as a foreign node sees it, and the marks of a play.

A play is a function that follows steps of a manual through the PLC's ports alone. Plant time moves in run(), wait() and the methods of
Bus that say so; nothing waits for a clock.
"""
import dataclasses
import pathlib
import socket
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
sys.path[:0] = [str(ROOT / "python"), str(ROOT / "tests/interop")]

from canopus_plc import Plant  # noqa: E402
from runner import Skip  # noqa: E402, F401

DEVICES = ROOT / "examples/devices"
plays = []      # functions, in the order of their files
scratch = None  # the folder of the play that runs
program = None  # the program canopus
_rigs = []      # plants of the play that runs


def play(module, *sections, fails=None):
    """Marks a play of a module's manual, with the sections whose steps it follows. `fails`: what is wrong in the program; the play
    fails at its last line then, and must not pass in silence once that is mended."""
    def mark(function):
        def run():
            try:
                function()
            except (AssertionError, TimeoutError) as error:
                if not fails or _line_in(function, error) != max(line for *_, line in function.__code__.co_lines() if line):
                    raise
                print(f"    fails as expected ({fails}): {error}")
            else:
                assert not fails, f"it passes now: take the mark away ({fails})"
            finally:
                while _rigs:
                    _rigs.pop().close()
        run.__name__, run.__doc__ = function.__name__, function.__doc__
        run.module, run.sections, run.fails = module, sections, fails
        plays.append(run)
        return run
    return mark


def _line_in(function, error):
    trace = error.__traceback__
    while trace.tb_frame.f_code is not function.__code__:
        trace = trace.tb_next
    return trace.tb_lineno


def prepare(folder):
    global scratch
    scratch = pathlib.Path(folder)


def equal(found, expected, what=""):
    """Numbers are shown in hexadecimal, as manuals print them."""
    def shown(value):
        if isinstance(value, (list, tuple)):
            return "[" + ", ".join(map(shown, value)) + "]"
        return f"{value:04X}H" if type(value) is int else repr(value)
    if isinstance(found, tuple):
        found = list(found)
    assert found == expected, f"{what + ': ' if what else ''}{shown(found)}, expected {shown(expected)}"


def number_of(words, size):
    """The number in the first bytes of words, low byte first."""
    return int.from_bytes(b"".join(word.to_bytes(2, "little") for word in words)[:size], "little")


def bit(word, number):
    return word >> number & 1


@dataclasses.dataclass(frozen=True)
class Frame:
    time: float      # plant time in s
    identifier: str  # "181", "18FEF100"
    data: str        # "11 22", "" without data

    def __str__(self):
        return f"{self.identifier} {self.data}".rstrip()


class Slave:
    """A CANopen slave of the play's own, byte by byte: boot-up message, NMT states, expedited SDOs, heartbeat. It lives in the plant
    time that Bus and Rig let pass a millisecond at a time."""

    def __init__(self, bus, node, objects, heartbeat=None):
        """`objects`: (index, sub-index) to bytes; a write to another object, or to one in `refused`, is answered with that abort code.
        `heartbeat` in s; without it 1017H says."""
        self.bus, self.node, self.objects, self.state = bus, node, dict(objects), 0x7F
        self.refused = {}   # (index, sub-index) -> abort code of a write
        self.is_off = True  # no supply yet
        self.written = []   # (index, sub-index, number), in order
        self.heartbeat, self._next = heartbeat, None
        bus.slaves.append(self)

    def power_on(self):
        self.state, self.is_off = 0x7F, False
        self._next = None
        self.bus.send(f"{0x700 + self.node:03X} 00")

    def answers(self, frame, now):
        if self.is_off:
            return []
        data = bytes.fromhex(frame.data)
        if frame.identifier == "000" and data[1] in (0, self.node):
            if data[0] in (0x81, 0x82):
                self.state = 0x7F
                return [f"{0x700 + self.node:03X} 00"]
            self.state = {0x01: 0x05, 0x02: 0x04, 0x80: 0x7F}[data[0]]
        if frame.identifier != f"{0x600 + self.node:03X}" or self.state == 4:
            return []
        place = (data[1] | data[2] << 8, data[3])
        answer = lambda command, value=bytes(4): [f"{0x580 + self.node:03X} {command:02X} {data[1:4].hex(' ')} {value.ljust(4, bytes(1)).hex(' ')}"]
        if data[0] == 0x40:
            value = self.objects.get(place)
            return answer(0x80, b"\0\0\2\6") if value is None else answer(0x43 | 4 - len(value) << 2, value)
        if data[0] & 0xF3 == 0x23:
            if place in self.refused or place not in self.objects:
                return answer(0x80, self.refused.get(place, 0x06020000).to_bytes(4, "little"))
            self.objects[place] = data[4:8 - (data[0] >> 2 & 3)]
            self.written.append((*place, int.from_bytes(self.objects[place], "little")))
            return answer(0x60)
        return []

    def due(self, now):
        period = self.heartbeat or int.from_bytes(self.objects.get((0x1017, 0), b""), "little") / 1000
        if not period or self.is_off:
            self._next = None
            return []
        if self._next is None:
            self._next = now
        if now < self._next - 1e-9:
            return []
        self._next += period
        return [f"{0x700 + self.node:03X} {self.state:02X}"]


class Bus:
    """A node of its own on a bus, by socketcand: it acknowledges, receives what others send, and sends what the play wants.

    A frame is text: "181 11 22". expect() and expect_none() let plant time pass. `answers` are frames that the node sends when it receives
    another: {"603 40 00 10 00 00 00 00 00": "583 43 00 10 00 91 01 0F 00"}; an answer may be a list, one for each time.
    """

    def __init__(self, rig, name):
        self._rig = rig
        self._socket = socket.create_connection(rig.plant.socketcand(name), 300)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._input = ""
        self._frames = []
        self._expected = 0
        self.answers = {}
        self.slaves = []
        self._ask("", "< hi >")
        self._ask(f"< open {name} >", "< ok >")
        self._ask("< rawmode >", "< ok >")
        self._from = rig.time + 0.021  # a new client gets nothing before 20 ms of plant time have passed

    def close(self):
        self._socket.close()

    def send(self, *frames):
        """Data frames, one behind the other. They are on the bus when plant time has moved."""
        self._settle()
        for frame in frames:
            self._put(frame)
        self._sync()

    def send_remote(self, identifier, length=0):
        self._settle()
        self._ask(f"< sendrtr {identifier} {length} >")
        self._sync()

    @property
    def frames(self):
        """Every frame so far, in order."""
        self._sync()
        return self._frames

    def received(self, *identifiers):
        """The frames with these identifiers so far, as text; all without any."""
        return [str(frame) for frame in self.frames if not identifiers or frame.identifier in identifiers]

    def discard(self):
        """What was received so far is not expected any more."""
        self._sync()
        self._expected = len(self._frames)

    def expect(self, *frames, within=0.5, others=True):
        """Waits for these frames, in this order, from behind the last one that was expected. Returns the last. `others`: other frames
        may come between them."""
        for wanted in frames:
            end = self._rig.time + within
            while True:
                self._sync()
                new = self._frames[self._expected:]
                place = next((i for i, frame in enumerate(new) if str(frame) == wanted), None)
                if place is not None:
                    assert others or place == 0, f"before {wanted} came {[str(frame) for frame in new[:place]]}"
                    self._expected += place + 1
                    break
                now = self._rig.time
                assert now < end, f"{wanted} did not come within {within} s, but {[str(frame) for frame in new]}"
                self._rig.run(self._rig.step(now - end + within))
        return self._frames[self._expected - 1]

    def expect_none(self, seconds=0.05, *identifiers):
        """So long no frame comes (with these identifiers, or none at all), from behind the last one that was expected."""
        if self._rig.step(1) == 0.001:
            self.answering(seconds)
        else:
            self._rig.run(seconds)
        self._sync()
        new = [str(frame) for frame in self._frames[self._expected:] if not identifiers or frame.identifier in identifiers]
        assert not new, f"expected no frame, there are {new}"

    def answering(self, seconds):
        """Plant time passes, and this node gives its answers."""
        end = self._rig.time + seconds
        while self._rig.time < end - 1e-9:
            self._rig.run(min(0.001, end - self._rig.time))
            self._sync()

    def _sync(self):
        """All frames that the plant has sent so far are here; answers to them are on their way."""
        if self._from:
            if self._rig.time < self._from:
                return
            self._from = 0
        while True:
            before = len(self._frames)
            self._ask("< echo >", "< echo >")
            now = self._rig.time if self.slaves else 0
            answers = [frame for slave in self.slaves for frame in slave.due(now)]
            for frame in self._frames[before:]:
                answer = self.answers.get(str(frame))
                if isinstance(answer, list):
                    answer = answer.pop(0) if answer else None
                answers += [answer] if answer else []
                for slave in self.slaves:
                    answers += slave.answers(frame, now)
            for answer in answers:
                self._put(answer)
            if len(self._frames) == before and not answers:
                return

    def _settle(self):
        if self._from and self._rig.time < self._from:
            self._rig.run(self._from - self._rig.time)

    def _put(self, frame):
        identifier, *data = frame.split()
        self._ask(f"< send {identifier} {len(data)} {' '.join(data)} >")

    def _ask(self, element, answer=None):
        if element:
            self._socket.sendall(element.encode())
        while answer:
            begin = self._input.find("<")
            end = self._input.find(">", begin)
            if begin < 0 or end < 0:
                more = self._socket.recv(65536).decode()
                assert more, "the bus closed the connection"
                self._input += more
                continue
            found, self._input = self._input[begin:end + 1], self._input[end + 1:]
            words = found.split()
            if found == answer:
                return
            if words[1] == "frame":
                data = words[4] if len(words) > 5 else ""
                self._frames.append(Frame(float(words[3]), words[2], " ".join(data[i:i + 2] for i in range(0, len(data), 2))))
            else:
                assert words[1] == "error" and len(words[2]) == 3, f"the bus says {found}"  # a CAN error class, no message


class Rig:
    """A plant in step, made of TOML text; paths in it are relative to the play's folder. `bus` is the bus "line" from a node of the
    play's own; without `peer` there is none, and a module that is alone is acknowledged by nobody. `store = "state"` is a new folder."""

    number = 0  # of plants in this play

    def __init__(self, text, *, peer=True, name="plant"):
        self._peer = peer
        Rig.number += 1
        self._file = scratch / f"{name}-{Rig.number}.toml"
        self._file.write_text(text.replace('store = "state"', f'store = "state-{Rig.number}"'))
        self._runs = 0
        self.plant = self.bus = None
        _rigs.append(self)
        self._start()

    def _start(self):
        self._runs += 1
        self._trace = self._file.with_suffix(f".{self._runs}.log")
        self.plant = Plant(self._file, program=program, trace=self._trace)
        if self.plant.plcs:
            self.plc = next(iter(self.plant.plcs.values()))
        if self._peer:
            self.bus = Bus(self, "line")

    def close(self):
        if self.bus:
            self.bus.close()
            self.bus = None
        if self.plant:
            plant, self.plant = self.plant, None
            plant.stop()

    def power_cycle(self, peer=None):
        """The supply goes off and comes back; what was saved in the `store` of the plant file is there. Time begins at 0 again. `peer`:
        from now on with the play's own node on the bus, or without."""
        self._peer = self._peer if peer is None else peer
        self.close()
        self._start()

    def remote_frames(self):
        """The remote frames that were on the bus, "R8" with their DLC for data; socketcand passes none on. It ends the run."""
        self.close()
        lines = [line.split() for line in self._trace.read_text().splitlines()]
        return [Frame(float(line[0].strip("()")), *line[2].split("#")) for line in lines if "#R" in line[2]]

    @property
    def time(self):
        """Plant time in s; nothing but this play moves it."""
        return self.plant._controlled().time

    def run(self, seconds):
        self.plant.run(seconds)

    def diagnostics(self):
        """What the engineering tool's module diagnostics show of the first module (docs/control.md)."""
        return self.plant._controlled().ask("modules")["modules"][0]

    def leds(self):
        """The patterns of the first module's LEDs, by their names."""
        return {led["name"]: led["pattern"] for led in self.diagnostics()["leds"]}

    def server(self, protocol):
        """Host and port of a server of the plant, by the beginning of its protocol's name."""
        event = self.plant._wait_event(lambda e: e["event"] == "listen" and e["protocol"].startswith(protocol))
        host, port = event["address"].rsplit(":", 1)
        return host, int(port)

    def command(self, memory, code, *parameters, within=3.0):
        """A command of an FX module's command interface: parameters from 1001 on, the code to 1000; the 67 words of its result."""
        if parameters:
            memory[1001:1001 + len(parameters)] = parameters
        memory[1000] = code
        self.until(lambda: memory[1000] != 0xFFFF, f"the end of command {code:04X}H", within)
        return memory[1000:1067]

    def until(self, condition, what, within=10.0):
        """Plant time passes until it is so; what it gave."""
        begin = self.time
        while not (value := condition()):
            now = self.time
            assert now < begin + within, f"{what}: not within {within} s"
            self.run(self.step(now - begin))
            if self.bus:
                self.bus._sync()
        return value

    def step(self, waited):
        """How far to run before it is looked again: a millisecond where answers are due, and in the first 50 ms; then seldomer."""
        if self.bus and (self.bus.answers or any(not slave.is_off for slave in self.bus.slaves)):
            return 0.001
        return 0.001 if waited < 0.05 else 0.01 if waited < 1 else 0.05
