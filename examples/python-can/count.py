#!/usr/bin/env python3
"""A program of python-can on a plant's bus: starts the devices, sends a SYNC each 100 ms and counts what comes, in virtual time.

    count.py [PLANT]

With another `interface` it runs on another bus; time.sleep() then takes the place of bus.plant.run().
"""
import collections
import pathlib
import sys

import can

DEVICES = pathlib.Path(__file__).parent.parent / "network-without-plc/devices.toml"


def main():
    seen = collections.Counter()
    plant = sys.argv[1] if len(sys.argv) > 1 else str(DEVICES)
    with can.Bus(interface="canopus", channel=None, plant=plant, receive_own_messages=True) as bus:
        notifier = can.Notifier(bus, [lambda message: seen.update([message.arbitration_id])], timeout=0.1)
        bus.plant.run(0.1)
        bus.send(can.Message(arbitration_id=0, is_extended_id=False, data=[1, 0]))       # NMT start, all nodes
        bus.send_periodic(can.Message(arbitration_id=0x80, is_extended_id=False), period=0.1)
        bus.plant.run(5)
        notifier.stop()
    for identifier, count in sorted(seen.items()):
        print(f"{identifier:03X} {count}")


if __name__ == "__main__":
    main()
