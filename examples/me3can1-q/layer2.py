#!/usr/bin/env python3
"""Sets an ME3CAN1-Q up for plain CAN (11-bit Layer 2 mode) as table 6-5 of its manual, and exchanges messages.

usage: layer2.py [HOST [PORT]]               against `canopus run examples/me3can1-q/layer2.toml`, or a real PLC

The module (head address 40H) sends message 123H with every data exchange, takes messages 180H, 182H, 184H and 186H,
asks for message 222H by a remote frame, and announces the PLC's stop by message 080H. Numbers in parentheses are sections
of the ME3CAN1-Q User's Manual.
"""
import sys

from me3can1q import Me3Can1Q, Plc

# Parameter B of a transmit slot: what a remote frame with its CAN-ID does (3.6.2)
AUTOMATIC_RTR, MANUAL_RTR, NO_RTR = 0x7FFF, 0x6FFF, 0x5FFF
# Parameter C: when it is sent
EVERY_EXCHANGE, CHANGED, CYCLE, CYCLE_CHANGED, TRIGGER = range(5)
REMOTE = 0x8000                              # bit 15 of RTR/new/DLC: send a remote frame (3.6.6)
NEW_DATA, NEW_FRAME, OVERFLOW = 0x0100, 0x0200, 0x0400


def main(host="127.0.0.1", port="5007"):
    with Plc(host, int(port)) as plc:
        module = Me3Can1Q(plc, head=0x40)
        module.wait_ready()

        step("1 to 3", "function mode 11, save, restart")
        module.set_g(21, 11)
        module.save()
        module.restart()

        step("4 to 6", "baud rate 500 kbps, save, restart")
        module.set_g(24, 500)
        module.save()
        module.restart()
        if (module.g(21), module.g(37)) != (11, 5000):
            raise SystemExit("the module is not in 11-bit Layer 2 mode at 500 kbps")

        step("7", "slots: 1 sends, 2 receives through a filter, 3 sends a remote frame, 4 receives the answer")
        transmit_slot(module, 1, NO_RTR, EVERY_EXCHANGE)
        receive_slot(module, 2, 0x180, any_bits=0x006)
        transmit_slot(module, 3, NO_RTR, TRIGGER)
        receive_slot(module, 4, 0x222)

        step("8", "CAN-IDs of the transmit slots")
        module.set_g(block(1), 0x123, 0)
        module.set_g(block(3), 0x222, 0)

        step("9", "RUN>STOP message 1: 080H [FF]")
        module.set_g(8450, 0x080, 0, 1, 0x00FF)

        step("10", "save")
        module.save()

        # The lengths and the data are not among what is saved: every start writes them.
        module.set_g(block(1) + 2, 4)
        module.set_g(block(3) + 2, REMOTE | 2)

        module.y(0x03, True)                 # online (3.3.2); G29.6 and G39 name a setting that makes no sense
        module.wait(lambda: module.x(0x03) or module.g(29), "X03", 2)
        module.check()
        print("the module is online")

        module.set_g(block(1) + 3, 0x2211, 0x4433)
        module.handshake(0x01, 2)            # Y01: slot 1 goes out, what was received comes in
        module.wait(lambda: received(module, 2), "a message in slot 2", 5)
        identifier, flags, data = take(module, 2)
        print(f"slot 2 has {identifier:03X} [{data.hex(' ').upper()}], flags {flags:02X}H")

        module.set_g(8400, 1 << 3 - 1)       # trigger flag of slot 3, and Y04: the remote frame (3.6.4)
        module.handshake(0x04, 2)
        module.wait(lambda: received(module, 4), "the answer in slot 4", 5)
        identifier, flags, data = take(module, 4)
        print(f"slot 4 has {identifier:03X} [{data.hex(' ').upper()}], flags {flags:02X}H")

        # One message without a slot, by the command interface (3.6.7)
        result = module.command([0x000C, 0x321, 0, 0, 3, 0x0201, 0x0003], "Layer 2 send")
        print(f"321 [01 02 03] is sent: G1000 = {result[0]:04X}H")
        module.check()


def transmit_slot(module, slot, rtr, transmission_type, cycle=0):
    """`cycle` in 10 ms, for CYCLE and CYCLE_CHANGED."""
    module.set_g(6000 + 4 * (slot - 1), 0xFFFF, rtr, transmission_type, cycle)


def receive_slot(module, slot, identifier, any_bits=0):
    """`any_bits`: bits of the identifier that do not matter."""
    module.set_g(6000 + 4 * (slot - 1), identifier & 0xFFFF, identifier >> 16, any_bits & 0xFFFF, any_bits >> 16)


def block(slot):
    """First word of a slot: CAN-ID low, high, RTR/new/DLC, four words of data (3.6.6)."""
    return 10000 + 7 * (slot - 1)


def received(module, slot):
    module.handshake(0x01, 2)
    return module.g(block(slot) + 2) & NEW_FRAME


def take(module, slot):
    """(identifier, flags, data) of a receive slot; its flags are cleared, as the module expects of the program."""
    low, high, form, *words = module.words(block(slot), 7)
    module.set_g(block(slot) + 2, 0)
    data = b"".join(word.to_bytes(2, "little") for word in words)
    return high << 16 | low, form >> 8, data[:form & 0xFF]


def step(numbers, what):
    print(f"step {numbers}: {what}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:3])
