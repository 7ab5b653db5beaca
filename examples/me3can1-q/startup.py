#!/usr/bin/env python3
"""Starts an ME3CAN1-Q up in CANopen 405 mode, step by step as table 6-4 of its manual.

usage: startup.py [HOST [PORT]]              against `canopus run examples/me3can1-q/startup.toml`, or a real PLC

The module (head address 40H) becomes NMT master with node-ID 1; node 2, an I/O block, and node 3, an encoder, become its
slaves. At the end the network is Operational, and an output of the I/O block is switched.
"""
import sys

from me3can1q import OWN_NODE, Me3Can1Q, Plc, number, receive_word, transmit_word, u32


def main(host="127.0.0.1", port="5007"):
    with Plc(host, int(port)) as plc:
        module = Me3Can1Q(plc, head=0x40)

        step("1 to 3", "function mode 405, save, restart")
        step("4 to 7", "baud rate 250 kbps, node address 1, save, restart")
        module.initialize(node=1, kbps=250, mode=405)

        step("8", "NMT master (1F80H), store (1010H), restart")
        module.set_master()
        module.store_objects()
        module.restart()
        if not module.g(25) & 0x8000:
            raise SystemExit("the module did not become NMT master")

        step("9", "heartbeat: own every 1000 ms; nodes 2 and 3 must be heard every 1500 ms")
        module.produce_heartbeat(OWN_NODE, 1000)
        module.consume_heartbeat(1, node=2, milliseconds=1500)
        module.consume_heartbeat(2, node=3, milliseconds=1500)

        step("10", "RPDO1 takes the I/O block's inputs into G10000, RPDO2 the encoder's position into G10001 and G10002")
        module.set_up_rpdo(1, 0x182, receive_word(10000))
        module.set_up_rpdo(2, 0x183, receive_word(10001, 2))

        step("11", "TPDO1 sends G13000 to the I/O block's outputs")
        module.set_up_tpdo(1, 0x202, transmit_word(13000))

        step("12", "slave assignment (1F81H), identification (1F84H), boot time (1F89H)")
        module.assign_slave(2, device_type=0x000F0191)
        module.assign_slave(3, device_type=0x00010196)
        module.sdo_write(OWN_NODE, 0x1F89, 0, u32(10000))

        step("13", "store (1010H), restart")
        module.store_objects()
        module.restart()

        # The master boots its slaves: presence, identity, heartbeat, start.
        module.wait(lambda: module.nmt_states(1, 3) == {1: 5, 2: 5, 3: 5}, "an Operational network", 20)
        module.check()
        print("the network is Operational: nodes 1, 2 and 3")

        module.set_g(13000, 0x005A)
        module.exchange()

        def echoed():
            module.exchange()
            return module.g(10000) >> 8 == 0x5A

        module.wait(echoed, "the echo of 5AH", 5)
        print(f"the I/O block's outputs are {module.g(13000):04X}H, its inputs {module.g(10000):04X}H")
        name = module.sdo_read(2, 0x1008).decode()
        print(f"node 2 is a {name!r}, revision {number(module.sdo_read(2, 0x1018, 3)):08X}H")


def step(numbers, what):
    print(f"step {numbers}: {what}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:3])
