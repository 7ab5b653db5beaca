#!/usr/bin/env python3
"""A tank as an I/O block whose behaviour is Python, and a PLC that keeps its level: a plant within this program, in virtual time.

The pump is the PLC's first output; level and full switch are inputs. Nothing waits for a clock: a minute takes a moment.
"""
import pathlib

import canopus

FILE = pathlib.Path(__file__).with_name("plant.toml")


def main():
    with canopus.Plant(FILE) as plant:
        tank = plant.device("tank")
        level = 0.0                                     # litres

        @tank.every(0.1)                                # seconds of plant time
        def flow(tank):
            nonlocal level
            level += 0.5 if tank["6200:01"] & 1 else -0.2
            level = min(max(level, 0.0), 100.0)
            tank["6000:01"] = int(level)                # an event-driven TPDO follows
            tank["6000:02"] = int(level >= 30)

        plc = plant.plc
        plc.wait(r"U0\G601 == 5", timeout=60)           # node 2 is Operational
        begin = plant.time
        for low, pump in ((30, 1), (20, 0), (30, 1)):
            plc.g[0][13000] = pump                      # the device's first two output bytes
            plc.wait(lambda: (plc.g[0][10000] & 0xFF >= low) == bool(pump), timeout=60)
            print(f"{plant.time - begin:5.1f} s: {plc.g[0][10000] & 0xFF} litres, full switch {plc.g[0][10000] >> 8}")


if __name__ == "__main__":
    main()
