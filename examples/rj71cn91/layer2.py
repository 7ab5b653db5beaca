#!/usr/bin/env python3
"""The Layer 2 sample system of the manual's chapter 4.1: two RJ71CN91 send each other messages and ask for them.

usage: layer2.py [HOST [PORT]]               against `canopus run examples/rj71cn91/layer2.toml`, or a real PLC

| CAN-ID | frame        | from | to |
|--------|--------------|------|----|
| 501H   | data         | 1    | 2  |
| 581H   | data         | 2    | 1  |
| 601H   | remote frame | 2    | 1  |
| 601H   | data         | 1    | 2  |
| 681H   | remote frame | 1    | 2  |
| 681H   | data         | 2    | 1  |

Both modules are in one rack here (start I/O numbers 0 and 20H); in the manual each has a CPU of its own. 11-bit CAN-IDs,
1000 kbit/s. Each has five slots: 1 sends, 2 receives, 3 answers remote frames, 4 sends one, 5 receives the answer.
"""
import sys

from rj71cn91 import Plc, Rj71Cn91

MANUAL_RTR, NO_RTR = 0x6FFF, 0x5FFF  # parameter B of a slot that sends (App. 2 G6000)
TRIGGER = 4                          # parameter C: by Y4 alone
REMOTE = 0x8000                      # bit 15 of RTR/new/DLC


def main(host="127.0.0.1", port="5007"):
    with Plc(host, int(port)) as plc:
        one, two = Rj71Cn91(plc, head=0x00), Rj71Cn91(plc, head=0x20)
        set_up(one, sends=0x501, receives=0x581, answers=0x601, asks=0x681)
        set_up(two, sends=0x581, receives=0x501, answers=0x681, asks=0x601)
        for module in (one, two):
            module.go_online()
        print("both modules are online")

        for sender, receiver, text in ((one, two, "1 to 2"), (two, one, "2 to 1")):
            data = [0x2211, 0x4433, 0x6655, 0x8877]
            sender.set_g(block(1) + 3, *data)
            send(sender, 1)
            identifier, words = take(receiver, 2)
            require(words == data)
            print(f"{text}: {identifier:03X} {hexadecimal(words)}")

            # The other one asks: its program is told by the RTR flag, and sends.
            receiver.set_g(8400, 1 << 4 - 1)
            receiver.handshake(0x04, 2)
            sender.wait(lambda: sender.g(8350) == 1 << 3 - 1, "the remote frame in slot 3", 5)
            answer = [word ^ 0xFFFF for word in data]
            sender.set_g(block(3) + 3, *answer)
            send(sender, 3)
            require(sender.g(8350) == 0)
            identifier, words = take(receiver, 5)
            require(words == answer)
            print(f"{text}: {identifier:03X} {hexadecimal(words)}, as it was asked for")
        for module in (one, two):
            module.check()
            module.y(0x03, False)


def set_up(module, sends, receives, answers, asks):
    """Parameter and message settings (programs M0 and M1)."""
    module.wait_ready()
    module.set_g(21, 11)
    module.set_g(24, 1000)
    module.save()
    module.restart()                         # the function mode comes into force
    transmit_slot(module, 1, NO_RTR, sends, 8)
    receive_slot(module, 2, receives)
    transmit_slot(module, 3, MANUAL_RTR, answers, 8)
    transmit_slot(module, 4, NO_RTR, asks, REMOTE | 8)
    receive_slot(module, 5, asks)
    module.save()


def transmit_slot(module, slot, rtr, identifier, form):
    module.set_g(6000 + 4 * (slot - 1), 0xFFFF, rtr, TRIGGER, 0)
    module.set_g(block(slot), identifier, 0, form)


def receive_slot(module, slot, identifier):
    module.set_g(6000 + 4 * (slot - 1), identifier, 0, 0, 0)


def block(slot):
    """First word of a slot: CAN-ID low, high, RTR/new/DLC, four words of data (App. 2 G10000)."""
    return 10000 + 7 * (slot - 1)


def send(module, slot):
    """Y1 brings the words into the send buffer, Y4 sends the slot whose trigger flag is set (1.11)."""
    module.handshake(0x01, 2)
    module.set_g(8400, 1 << slot - 1)
    module.handshake(0x04, 2)


def take(module, slot):
    """(CAN-ID, words) of a slot that has received something new; bits 8 to 10 are cleared, as the manual demands."""
    def is_new():
        module.handshake(0x01, 2)
        return module.g(block(slot) + 2) & 0x0200

    module.wait(is_new, f"a message in slot {slot}", 5)
    low, high, form, *words = module.words(block(slot), 7)
    module.set_g(block(slot) + 2, form & 0x00FF)
    require(form & 0x00FF == 8)
    return high << 16 | low, words


def hexadecimal(words):
    return b"".join(word.to_bytes(2, "little") for word in words).hex(" ").upper()


def require(holds):
    if not holds:
        raise SystemExit("something else came than was sent")


if __name__ == "__main__":
    main(*sys.argv[1:3])
