#!/usr/bin/env python3
"""A CANopen master in Python: boots a network, reads and writes objects, hears PDOs.

    master.py                       on a simulated bus, in virtual time
    master.py socketcan:can0        on a real one, at any address that `canopus sdo --bus` takes
"""
import pathlib
import sys

import canopus

HERE = pathlib.Path(__file__).parent
BLOCK = HERE.parent / "devices/io-block.eds"


def work(bus):
    with canopus.Master(bus, slaves={2: BLOCK}) as master:
        for result in master.boot(timeout=20).values():
            print(f"node {result.node}: {result.result}")
        print("product", master.read(2, "1008:00"), "heartbeat", master.read(2, "1017:00"), "ms")
        inputs = master.subscribe(node=2, tpdo=1)
        while inputs.receive(0.1) is not None:          # what it says of itself when it is started
            pass
        master.write(2, "6200:01", 0x5A)                # the device's second input follows its first output
        print("inputs", inputs.receive(timeout=2).values)
        master.stop(2)
        master.run(0.1)
        print("node 2 is", master.state(2))


def main():
    if len(sys.argv) > 1:
        return work(sys.argv[1])
    with canopus.Plant(HERE / "bus.toml") as plant:
        work(plant)


if __name__ == "__main__":
    main()
