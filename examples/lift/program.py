#!/usr/bin/env python3
"""Two lifts of eight floors, controlled through the words of an FX3U-CAN in 417 mode.

usage: program.py [--plant FILE] [--seed N] [--until S] [--scan S] [--svg FILE]
           starts the plant, drives it in step, ends when nobody calls any more, and says how long people waited
       program.py --connect HOST:PORT
           controls the lifts of a plant that runs in real time

Full collective control: hall calls are given to the lift that will be there first, and each lift serves its calls in one direction
before it turns round. README.md says which word does what.
"""
from __future__ import annotations

import argparse
import collections
import contextlib
import pathlib
import sys
import time

try:
    from canopus_plc import Plant, Plc
except ImportError:  # it is not installed: that of this source tree
    sys.path.append(str(pathlib.Path(__file__).resolve().parents[2] / "python"))
    from canopus_plc import Plant, Plc

FLOORS = 8
FLOOR_HEIGHT = 3200  # mm
LIFTS = (1, 2)
SPEED, ACCELERATION, JERK = 1600, 800, 1000  # of the drives: mm/s, mm/s², mm/s³
IDLE = 20.0    # s without a call: nobody is left
LIMIT = 7200.0  # s

UP, DOWN = 1, -1
DWELL = 3.0         # s, a door stays open
DOORWAY_FREE = 1.0  # s, before a door that has reopened closes again
OUT_OF_SERVICE = 20.0  # s, a lift that cannot leave so long gets no hall calls

# Words that are received, and what the program sends.
FIRST_RECEIVED, LAST_RECEIVED = 12001, 12540
OUTPUT, DOOR_CONTROL, CONTROL_WORD, MODE, TARGET, VELOCITY = 13001, 13050, 13428, 13436, 13460, 13476

UNSAFE = ("door_open_between_floors", "door_open_while_moving", "overload_travels", "overspeeds")

# Basic functions of virtual inputs and outputs
HALL_CALL, CAR_CALL, POSITION_INDICATION, HALL_LANTERN = 0x02, 0x05, 0x40, 0x41
OPEN, CLOSE, RESET = 0x4FFF, 0x1FFF, 0xFFFF  # of a door


class Module:
    """The FX3U-CAN: what was received, and what is to be sent with the next data exchange."""

    def __init__(self, plc: Plc, scan: float) -> None:
        self.g = plc.g[0]
        self.scan = scan  # s, from one look at it to the next
        self.received: list[int] = []
        self.sent: dict[int, int] = {}
        self.to_send: dict[int, int] = {}
        self.outputs: collections.deque[tuple[int, int, int]] = collections.deque()

    def read(self) -> bool:
        """The words of the last exchange; False while it lasts."""
        if self.g[20] & 1:
            return False
        self.received = self.g[FIRST_RECEIVED:LAST_RECEIVED + 1]
        return True

    def word(self, address: int) -> int:
        return self.received[address - FIRST_RECEIVED]

    def signed_double(self, address: int) -> int:
        value = self.word(address) | self.word(address + 1) << 16
        return value - (1 << 32 if value >> 31 else 0)

    def set(self, address: int, value: int) -> None:
        if self.sent.get(address) != value:
            self.to_send[address] = value

    def exchange(self) -> None:
        """Sends what has changed and the next virtual output, and takes what was received."""
        if self.outputs:
            for i, word in enumerate(self.outputs.popleft()):
                self.to_send[OUTPUT + i] = word
        addresses = sorted(self.to_send)
        while addresses:
            run = [addresses.pop(0)]
            while addresses and addresses[0] == run[-1] + 1:
                run.append(addresses.pop(0))
            self.g[run[0]:run[-1] + 1] = [self.to_send[address] for address in run]
        self.sent.update(self.to_send)
        self.to_send.clear()
        self.g[20] = 1


class Lift:
    """One lift: its drive, its door, its calls."""

    def __init__(self, module: Module, number: int) -> None:
        self.module, self.number, self.bit = module, number, 1 << (number - 1)
        self.calls: set[int] = set()                   # of the car
        self.hall_calls: set[tuple[int, int]] = set()  # given to it: floor and direction
        self.direction = 0
        self.target: int | None = None                 # floor it travels to
        self.step = "stand"                            # of a travel: target, start, acknowledge, travel
        self.door = "closed"                           # what it is to be: closed, open
        self.open_since = self.free_since = self.stuck_since = 0.0
        self.reopened = self.commanded = False
        self.lantern: tuple[int, int] | None = None
        self.shown = 0
        module.set(MODE + number - 1, 1)  # profile position

    # --- what the words say

    def take(self, now: float) -> None:
        at = self.number - 1
        word = self.module.word
        self.status = word(12428 + at)
        self.door_state = word(12050 + 4 * at) >> 12
        self.doorway_is_free = word(12114 + 4 * at) == 0x003F
        self.position = self.module.signed_double(12300 + 8 * at)  # -1: lost
        self.velocity = self.module.signed_double(12492 + 2 * at)
        self.is_overloaded = bool(word(12524 + 2 * at) & 0x0008)
        self.is_enabled = self.status & 0x6F == 0x27
        self.is_closed = self.door_state in (0, 1)
        if self.door == "closed" and self.is_closed and self.is_enabled and self.position >= 0:
            self.stuck_since = now
        if not self.doorway_is_free:
            self.free_since = now

    @property
    def place(self) -> float:
        """In floors, from 1."""
        return self.position / FLOOR_HEIGHT + 1

    @property
    def floor(self) -> int | None:
        """Where it stands."""
        floor = round(self.place)
        level = abs(self.position - (floor - 1) * FLOOR_HEIGHT) <= 10
        return floor if self.step == "stand" and self.position >= 0 and level else None

    def is_in_service(self, now: float) -> bool:
        return now - self.stuck_since < OUT_OF_SERVICE + (DWELL if self.door == "open" else 0)

    def can_stop_at(self, floor: int) -> bool:
        """On its way, without braking harder than it would."""
        speed = abs(self.velocity)
        way = speed * (speed / ACCELERATION + ACCELERATION / JERK) / 2 + speed * 4 * self.module.scan + 50
        ahead = ((floor - 1) * FLOOR_HEIGHT - self.position) * (1 if self.velocity >= 0 else -1)
        return speed < 20 or ahead >= way

    # --- calls

    def has_calls(self) -> bool:
        return bool(self.calls or self.hall_calls)

    def calls_beyond(self, place: float, direction: int) -> bool:
        floors = self.calls | {floor for floor, _ in self.hall_calls}
        return any((floor - place) * direction > 0.01 for floor in floors)

    def is_wanted_at(self, floor: int) -> bool:
        return floor in self.calls or any(f == floor for f, _ in self.hall_calls)

    def serves(self, floor: int) -> bool:
        """A call here is one for the direction in which it goes on."""
        directions = {d for f, d in self.hall_calls if f == floor}
        turns = not self.calls_beyond(floor, self.direction)
        return floor in self.calls or bool(directions) and (not self.direction or self.direction in directions or turns)

    def next_stop(self, place: float, direction: int) -> int | None:
        """The next call in this direction; without one the farthest that wants to go the other way."""
        ahead = [f for f in self.calls | {f for f, d in self.hall_calls if d == direction} if (f - place) * direction > 0.01]
        if ahead:
            return min(ahead, key=lambda floor: abs(floor - place))
        turning = [f for f, _ in self.hall_calls if (f - place) * direction > 0.01]
        return max(turning, key=lambda floor: abs(floor - place), default=None)

    def cost(self, floor: int, direction: int) -> float:
        """Floors to go, and stops on the way as three of them, until it is there in this direction."""
        stops = sorted(self.calls | {f for f, _ in self.hall_calls})
        going = self.direction
        if not going or not stops:
            return abs(floor - self.place) + 3 * (self.door == "open" and floor != self.floor)
        last = max(stops + [floor]) if going == UP else min(stops + [floor])
        if going == direction and (floor - self.place) * going >= 0:
            way = abs(floor - self.place)
        elif going != direction:
            way = abs(last - self.place) + abs(last - floor)
        else:
            other = min(stops + [floor]) if going == UP else max(stops + [floor])
            way = abs(last - self.place) + abs(last - other) + abs(floor - other)
        return way + 3 * len(stops)

    # --- what is to be done

    def control(self, group: Group, now: float) -> None:
        self.show_floor(group)
        if not self.enable():
            return
        floor = self.floor
        if self.step != "stand":
            self.travel(group)
        elif self.door == "open":
            self.hold_open(group, floor, now)
        elif not self.is_closed:
            self.close(group, floor, now)
        elif floor is not None and self.serves(floor):
            self.arrive(group, floor, now)
        elif self.position >= 0:
            self.leave(group)

    def enable(self) -> bool:
        """Takes the drive to operation enabled, and out of a fault."""
        if self.is_enabled:
            return True
        if self.step != "stand":
            self.step, self.target = "stand", None
        last = self.module.sent.get(CONTROL_WORD + self.number - 1, 0)
        if self.status & 0x4F == 0x08:
            word = 0x80 if last == 0 else 0
        else:
            word = {0x40: 0x06, 0x21: 0x07, 0x23: 0x0F}.get(self.status & (0x4F if self.status & 0x40 else 0x6F), 0x06)
        self.module.set(CONTROL_WORD + self.number - 1, word)
        return False

    def leave(self, group: Group) -> None:
        if not self.has_calls():
            self.direction = 0
            return
        for direction in (self.direction or UP, -(self.direction or UP)):
            floor = self.next_stop(self.place, direction)
            if floor is not None:
                self.direction = direction
                return self.go_to(floor)

    def go_to(self, floor: int) -> None:
        self.target, self.step = floor, "target"
        at, position = 2 * (self.number - 1), (floor - 1) * FLOOR_HEIGHT
        for offset in (0, 1):
            self.module.set(TARGET + at + offset, position >> 16 * offset & 0xFFFF)
            self.module.set(VELOCITY + at + offset, SPEED >> 16 * offset & 0xFFFF)
        self.module.set(CONTROL_WORD + self.number - 1, 0x0F)

    def travel(self, group: Group) -> None:
        control_word = CONTROL_WORD + self.number - 1
        acknowledged = bool(self.status & 0x1000)
        if self.step == "target":
            if not acknowledged:  # of the one before
                self.module.set(control_word, 0x3F)  # at once, also on the way
                self.step = "start"
        elif self.step == "start":
            if acknowledged:
                self.module.set(control_word, 0x0F)
                self.step = "travel"
        elif not acknowledged:
            if self.status & 0x0400 and abs(self.velocity) == 0:
                self.step = "stand"
                return
            better = self.next_stop(self.place, self.direction)
            nearer = better is not None and abs(better - self.place) < abs(self.target - self.place)
            if (nearer or not self.is_wanted_at(self.target)) and better not in (None, self.target) and self.can_stop_at(better):
                self.go_to(better)

    def arrive(self, group: Group, floor: int, now: float) -> None:
        """Opens the door, and serves the calls of this floor in the direction in which it will go on."""
        direction = self.direction
        if not direction or not (self.calls_beyond(floor, direction) or (floor, direction) in self.hall_calls):
            waiting = [d for f, d in self.hall_calls if f == floor]
            behind = self.calls_beyond(floor, -direction) if direction else False
            direction = waiting[0] if waiting else -direction if behind else 0
            if not direction:
                direction = next((d for d in (UP, DOWN) if self.calls_beyond(floor, d)), 0)
        self.direction = direction
        self.door, self.open_since, self.reopened = "open", now, False
        self.module.set(DOOR_CONTROL + 4 * (self.number - 1), OPEN)
        self.answer(group, floor)

    def answer(self, group: Group, floor: int) -> None:
        if floor in self.calls:
            self.calls.discard(floor)
            group.light(self.bit, 0, CAR_CALL, floor, False)
        for direction in ([self.direction] if self.direction else [UP, DOWN]):
            if group.is_called(floor, direction):
                group.end_call(floor, direction)
        if self.lantern is None and self.direction:
            self.lantern = (floor, self.direction)
            group.show_lantern(self, True)

    def hold_open(self, group: Group, floor: int | None, now: float) -> None:
        if floor is not None:
            self.answer(group, floor)
            if not self.direction and self.has_calls():
                self.direction = next((d for d in (UP, DOWN) if self.calls_beyond(floor, d)), 0)
        open_now = self.door_state in (3, 4)
        if not open_now or self.is_overloaded or not self.doorway_is_free:
            self.open_since = max(self.open_since, now - DWELL + DOORWAY_FREE)
            if not open_now:
                self.open_since = now
        if now - self.open_since >= DWELL:
            self.door = "closed"
            self.module.set(DOOR_CONTROL + 4 * (self.number - 1), CLOSE)
            if self.lantern:
                group.show_lantern(self, False)
                self.lantern = None

    def close(self, group: Group, floor: int | None, now: float) -> None:
        """It closes; after a reopening again, when the doorway has been free for a while."""
        door = DOOR_CONTROL + 4 * (self.number - 1)
        here = floor is not None and (floor in self.calls or (floor, self.direction) in self.hall_calls)
        if self.is_overloaded or here:
            self.door, self.open_since = "open", now
            self.module.set(door, OPEN)
        elif self.door_state in (3, 4, 6, 7, 8):
            if self.module.sent.get(door) == RESET:
                self.module.set(door, CLOSE)
            elif self.door_state != 6 and now - self.free_since >= DOORWAY_FREE:
                self.module.set(door, RESET)

    def show_floor(self, group: Group) -> None:
        floor = round(self.place)
        if self.position >= 0 and floor != self.shown:
            self.shown = floor
            for place in (0xFF00, 0x0000):
                self.module.outputs.append((floor << 8 | POSITION_INDICATION, place | self.bit, 0x0001))


class Group:
    """All lifts, and the hall calls."""

    def __init__(self, module: Module) -> None:
        self.module = module
        self.lifts = [Lift(module, number) for number in LIFTS]
        self.every_bit = sum(lift.bit for lift in self.lifts)
        self.calls_to_give: list[tuple[int, int]] = []
        self.is_idle_since = 0.0

    def scan(self, now: float) -> None:
        for lift in self.lifts:
            lift.take(now)
        self.take_input()
        self.give_calls(now)
        for lift in self.lifts:
            lift.control(self, now)
        if any(lift.has_calls() or lift.door == "open" or lift.step != "stand" for lift in self.lifts):
            self.is_idle_since = now

    def take_input(self) -> None:
        code, where, data = (self.module.word(address) for address in (12001, 12002, 12003))
        if not data & 0x0300:
            return  # nothing, or a button that was let go
        basic, sub, lifts, floor = code & 0xFF, code >> 8, where & 0xFF, where >> 8
        if basic == HALL_CALL and 1 <= floor <= FLOORS and sub in (1, 2):
            direction = UP if sub == 1 else DOWN
            if not self.is_called(floor, direction):
                self.calls_to_give.append((floor, direction))
                self.light(self.every_bit, floor, HALL_CALL, sub, True)
        elif basic == CAR_CALL and 1 <= sub <= FLOORS:
            for lift in self.lifts:
                if lifts & lift.bit and sub not in lift.calls:
                    lift.calls.add(sub)
                    self.light(lift.bit, 0, CAR_CALL, sub, True)

    def is_called(self, floor: int, direction: int) -> bool:
        return (floor, direction) in self.calls_to_give or any((floor, direction) in lift.hall_calls for lift in self.lifts)

    def give_calls(self, now: float) -> None:
        """New calls, and those of a lift that cannot leave, to the one that costs least."""
        serving = [lift for lift in self.lifts if lift.is_in_service(now)]
        for lift in self.lifts:
            if serving and lift not in serving:
                self.calls_to_give += lift.hall_calls
                lift.hall_calls.clear()
        for floor, direction in self.calls_to_give if serving else []:
            min(serving, key=lambda lift: lift.cost(floor, direction)).hall_calls.add((floor, direction))
        if serving:
            self.calls_to_give.clear()

    def end_call(self, floor: int, direction: int) -> None:
        for lift in self.lifts:
            lift.hall_calls.discard((floor, direction))
        if (floor, direction) in self.calls_to_give:
            self.calls_to_give.remove((floor, direction))
        self.light(self.every_bit, floor, HALL_CALL, 1 if direction == UP else 2, False)

    # --- what people see

    def light(self, lifts: int, floor: int, basic: int, sub: int, on: bool) -> None:
        self.module.outputs.append((sub << 8 | basic, floor << 8 | lifts, 0x8101 if on else 0x0001))

    def show_lantern(self, lift: Lift, on: bool) -> None:
        floor, direction = lift.lantern
        self.module.outputs.append(((1 if direction == UP else 2) << 8 | HALL_LANTERN, floor << 8 | lift.bit,
                                    0x0101 if on else 0x0001))


def start(plc: Plc, module: Module, wait) -> None:
    """The module is in 417 mode and Operational, and hears a drive of each lift."""
    while plc.g[0][25] & 0x80 or not plc.g[0][25] & 1:
        wait()
    module.g[20] = 1
    while True:
        wait()
        if module.read():
            if all(module.word(12428 + number - 1) and module.word(12114 + 4 * (number - 1)) != 0x00FF for number in LIFTS):
                return
            module.exchange()


def drive_plant(arguments: argparse.Namespace) -> int:
    options = ["--svg", arguments.svg] if arguments.svg else []
    with Plant(arguments.plant, seed=arguments.seed, arguments=options) as plant:
        plc = plant.plc
        module = Module(plc, arguments.scan)
        now = 0.0

        def wait() -> None:
            nonlocal now
            plc.run(seconds=arguments.scan)
            now += arguments.scan

        start(plc, module, wait)
        group = Group(module)
        while now < LIMIT and (now < arguments.until or now - group.is_idle_since < IDLE):
            if module.read():
                group.scan(now)
                module.exchange()
            wait()
    return show(plant.events, now)


def show(events: list[dict], now: float) -> int:
    """What the plant says at its end; exit code 1 when somebody has not arrived, or something was unsafe."""
    summary = next(event for event in reversed(events) if event["event"] == "summary")
    good = True
    for lifts in summary["lifts"]:
        print(f"{lifts['arrived']} of {lifts['passengers']} passengers arrived after {now:.0f} s; "
              f"waiting {lifts['mean_waiting']:.1f} s (at most {lifts['longest_waiting']:.1f} s), "
              f"travel {lifts['mean_travel']:.1f} s (at most {lifts['longest_travel']:.1f} s)")
        good = good and lifts["arrived"] == lifts["passengers"]
        for car in lifts["cars"]:
            unsafe = {name: car[name] for name in UNSAFE if car[name]}
            print(f"lift {car['lift']}: {car['travelled']:.0f} m, {car['starts']} starts, {car['door_cycles']} door cycles, "
                  f"{car['door_reversals']} reversals, {car['overloads']} overloads"
                  + "".join(f", UNSAFE: {count} {name}" for name, count in unsafe.items()))
            good = good and not unsafe
    return 0 if good else 1


def control(address: str, scan: float) -> None:
    host, _, port = address.rpartition(":")
    with Plc(host or "127.0.0.1", int(port)) as plc:
        module = Module(plc, scan)
        start(plc, module, lambda: time.sleep(scan))
        group = Group(module)
        while True:
            if module.read():
                group.scan(time.monotonic())
                module.exchange()
            time.sleep(scan)


def main() -> int:
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--plant", default=str(pathlib.Path(__file__).with_name("plant.toml")), help="default: plant.toml beside it")
    parser.add_argument("--seed", type=int, help="of the passengers, instead of the plant file's")
    parser.add_argument("--until", type=float, default=480, help="s; passengers come until then (default 480)")
    parser.add_argument("--scan", type=float, default=0.05, help="s, from one look at the words to the next (default 0.05)")
    parser.add_argument("--svg", metavar="FILE", help="a picture of position, doors and calls")
    parser.add_argument("--connect", metavar="HOST:PORT", help="control a plant that runs already, in real time")
    arguments = parser.parse_args()
    if arguments.connect:
        with contextlib.suppress(KeyboardInterrupt):
            control(arguments.connect, arguments.scan)
        return 0
    return drive_plant(arguments)


if __name__ == "__main__":
    sys.exit(main())
