#!/usr/bin/env python3
"""A CiA 402 servo on an AS-FCOPM, by the registers of the AS300: homes, moves to positions, turns, stops.

usage: servo.py [HOST [PORT]]              against `canopus run examples/as-fcopm/servo.toml`

Needs pymodbus (Debian: python3-pymodbus). `Card` is how a program talks to the function card, `Axis` how it talks to the
drive through the words that the card exchanges; both are made to be copied. Numbers in brackets are sections of the AS series
manual.
"""
import logging
import struct
import sys
import time

from pymodbus.client import ModbusTcpClient

NODE = 3              # the drive
D, SR = 0, 0xC000     # Modbus addresses of D0 and SR0
PATIENCE = 60         # seconds for what is there in a few; this program may run on a busy machine

STATUS = {3: "no answer from the node", 4: "illegal command code", 5: "illegal length of the request",
          6: "the object has not 1, 2 or 4 bytes", 7: "the node is busy", 8: "illegal type", 9: "incorrect node address"}


class Fault(Exception):
    """What the card or the drive says is wrong."""


class Card:
    """The AS-FCOPM as master: requests D25000 on, answers D24000 on, states SR821 on."""

    def __init__(self, host, port):
        logging.getLogger("pymodbus").setLevel(logging.CRITICAL)  # what it would say is said here
        self.client = ModbusTcpClient(host, port=port, timeout=PATIENCE)
        if not self.client.connect():
            raise Fault(f"no answer from {host}:{port}")

    def close(self):
        self.client.close()

    def read(self, address, count=1):
        answer = self.client.read_holding_registers(address, count=count)
        if answer.isError():
            raise Fault(f"reading {count} registers from {address}: {answer}")
        return answer.registers

    def write(self, address, *words):
        answer = self.client.write_registers(address, list(words))
        if answer.isError():
            raise Fault(f"writing {len(words)} registers from {address}: {answer}")

    def own_code(self):
        """0, or what the card has to say of itself, F1H to FCH [10.5.1]."""
        return self.read(SR + 825)[0]

    def node_code(self, node):
        """0, or why the node is abnormal, E0H to E8H [10.5.1]."""
        return self.read(SR + 829 + node)[0]

    def request(self, kind, node, size, *data):
        """One request [10.4]: another ReqID than before asks; all words in one Modbus write count together. The answer's words."""
        request_id = ((self.read(D + 25000)[0] >> 8) + 1) & 0xFF
        words = [request_id << 8 | 0x01, size, kind << 8 | node, *data]
        self.write(D + 25000, *words, *[0] * (7 - len(words)))
        until("the card answers", lambda: self.read(D + 24000)[0] >> 8 == request_id and self.read(D + 24000)[0] & 0xFF != 2)
        answer = self.read(D + 24000, 24)
        status = answer[0] & 0xFF
        if status == 0x0A:
            raise Fault(f"node {node} has refused {data[0]:04X}:{data[1]:02X}, abort code {answer[6]:04X}{answer[5]:04X}H")
        if status != 1:
            raise Fault(f"request {kind} to node {node}: {STATUS.get(status, status)}")
        return answer

    def sdo_read(self, node, index, sub=0):
        """The value of an object of 1, 2 or 4 bytes, without a sign."""
        answer = self.request(0x01, node, 4, index, sub)
        return answer[6] << 16 | answer[5]

    def sdo_write(self, node, index, sub, value, size):
        low, high = struct.unpack("<2H", (value & 0xFFFFFFFF).to_bytes(4, "little"))
        self.request(0x02, node, 4 + size, index, sub, low, high)

    def emergencies(self, node):
        """How many came, and the latest five, the newest first, as (error code, error register)."""
        answer = self.request(0x04, node, 0)
        total, stored = answer[3] >> 8, answer[3] & 0xFF
        return total, [(answer[4 + 4 * i], answer[5 + 4 * i] & 0xFF) for i in range(stored)]


class Axis:
    """The drive by its process data: D25032 on is written, D24032 on is read, each once per call."""

    POSITION_MODE, VELOCITY_MODE, HOMING_MODE = 1, 3, 6

    def __init__(self, card):
        self.card = card
        # A drive that is Operational sends its statusword, which is never 0.
        until(f"the card (SR825) boots node {NODE} (SR{829 + NODE})", lambda: card.own_code() == 0 and self.look().status != 0)
        self.target, self.mode = self.position, self.mode_display
        self.command(0x0000)

    def look(self):
        words = self.card.read(D + 24032, 6)
        low_high = struct.pack("<6H", *words)
        self.position, self.status, self.mode_display, _, self.velocity = struct.unpack("<iHbBi", low_high)
        return self

    def command(self, controlword):
        words = struct.unpack("<4H", struct.pack("<iHbx", self.target, controlword, self.mode))
        self.card.write(D + 25032, *words)

    def wait(self, what, condition):
        """Looks until the condition holds; a fault of the drive or a lost node ends it."""
        def look():
            code = self.card.node_code(NODE)
            if self.look().status & 0x004F == 0x0008:
                total, latest = self.card.emergencies(NODE)
                last = f", the last {latest[0][0]:04X}H" if latest else ""
                raise Fault(f"{what}: the drive has a fault; emergency messages: {total}{last}")
            if code not in (0, 0xE0):
                raise Fault(f"{what}: node {NODE} is abnormal, {code:02X}H")
            return condition()
        until(what, look)

    def enable(self):
        """The state machine of CiA 402, from whatever it is in to Operation enabled."""
        if self.look().status & 0x004F == 0x0008:
            self.command(0x0080)                                                  # fault reset
            until("the fault is reset", lambda: self.look().status & 0x004F == 0x0040)
        for controlword, mask, state, name in ((0x0006, 0x6F, 0x21, "ready to switch on"), (0x0007, 0x6F, 0x23, "switched on"),
                                               (0x000F, 0x6F, 0x27, "operation enabled")):
            self.command(controlword)
            self.wait(name, lambda: self.status & mask == state)

    def disable(self):
        self.command(0x0000)
        self.wait("switch on disabled", lambda: self.status & 0x4F == 0x40)

    def take_mode(self, mode):
        self.mode = mode
        self.command(0x000F)
        self.wait(f"mode {mode}", lambda: self.mode_display == mode)

    def home(self):
        """With the method and the speeds that the drive has."""
        self.take_mode(self.HOMING_MODE)
        self.command(0x001F)
        self.begun = time.monotonic()
        # An axis that was homed before shows so until the new search begins.
        self.wait("the search begins", lambda: not self.status & 0x0400 or time.monotonic() - self.begun > 1)
        self.wait("homing", lambda: self.status & 0x2400)
        if self.status & 0x2000 or not self.status & 0x1000:
            raise Fault("homing error")
        self.command(0x000F)

    def move(self, target, shown=lambda position: None):
        """Profile position: a set-point, its handshake, the way."""
        if self.mode_display != self.POSITION_MODE:
            self.take_mode(self.POSITION_MODE)
        self.target = target
        self.command(0x003F)                                                      # new set-point, at once
        self.wait("the set-point is taken", lambda: self.status & 0x1000)
        self.command(0x000F)
        self.wait("the set-point is done with", lambda: not self.status & 0x1000)
        self.wait("the target", lambda: shown(self.position) or self.status & 0x0400)

    def turn(self, velocity):
        """Profile velocity."""
        if self.mode_display != self.VELOCITY_MODE:
            self.take_mode(self.VELOCITY_MODE)
        self.card.write(D + 25036, *struct.unpack("<2H", struct.pack("<i", velocity)))
        self.wait(f"{velocity}/s", lambda: self.velocity == velocity)


def until(what, condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        if time.monotonic() > end:
            raise Fault(f"after {PATIENCE} s still not: {what}")
        time.sleep(0.01)


def show_now_and_then():
    """Prints a position, at most once a second."""
    last = time.monotonic()

    def show(position):
        nonlocal last
        if time.monotonic() - last >= 1:
            last = time.monotonic()
            print(f"  on the way: {position}")
    return show


def main(host="127.0.0.1", port="5021"):
    card = Card(host, int(port))
    axis = Axis(card)
    rate, = card.read(SR + 822)
    print(f"the master runs at {rate} kbit/s, node {NODE} is Operational")
    print(f"node {NODE}: device type {card.sdo_read(NODE, 0x1000):08X}H, modes {card.sdo_read(NODE, 0x6502):08X}H")

    card.sdo_write(NODE, 0x6098, 0, 17, 1)           # homing method: the negative limit switch
    card.sdo_write(NODE, 0x6099, 1, 10_000, 4)       # speed to the switch
    card.sdo_write(NODE, 0x6099, 2, 1_000, 4)        # speed back off it
    card.sdo_write(NODE, 0x605A, 0, 2, 2)            # a quick stop brakes at 6085H
    card.sdo_write(NODE, 0x6081, 0, 40_000, 4)       # profile velocity
    print(f"settings: homing method {card.sdo_read(NODE, 0x6098)}, profile velocity {card.sdo_read(NODE, 0x6081)}")
    try:
        card.sdo_write(NODE, 0x6041, 0, 0, 2)        # the statusword cannot be written
    except Fault as fault:
        print(f"as expected: {fault}")

    axis.enable()
    print(f"operation enabled; the axis stands at {axis.position}, wherever that is")
    axis.home()
    print(f"homed: {axis.position} is the edge of the limit switch")
    for target in (50_000, 150_000, 20_000):
        print(f"to {target}")
        axis.move(target, show_now_and_then())
        print(f"  there: {axis.position}")
    axis.turn(-5_000)
    print(f"turns at {axis.velocity} increments/s")
    axis.turn(0)
    print("stopped")
    axis.disable()
    print("switched off: the brake holds the axis")
    card.close()


if __name__ == "__main__":
    try:
        main(*sys.argv[1:3])
    except Fault as fault:
        sys.exit(f"servo.py: {fault}")
