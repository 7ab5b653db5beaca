#!/usr/bin/env python3
"""Starts an RJ71CN91 up in CANopen 405 mode without the configuration tool (App. 5), by words and objects.

usage: startup.py [HOST [PORT]]              against `canopus run examples/rj71cn91/startup.toml`, or a real PLC

The module (start I/O number 0) becomes NMT master with node-ID 1 at 500 kbit/s; node 2, an I/O block, becomes its slave, whose
heartbeat it watches. At the end an output of the I/O block is switched.

Settings of the slave itself are no business of the program: 1F22H cannot be set by the command interface (App. 5 note 2). The I/O
block comes with its heartbeat.
"""
import sys

from rj71cn91 import OWN_NODE, Plc, Rj71Cn91, number, receive_word, transmit_word, u32


def main(host="127.0.0.1", port="5007"):
    with Plc(host, int(port)) as plc:
        module = Rj71Cn91(plc, head=0x00)
        module.wait_ready()

        step("function mode, baud rate, node-ID, waiting time, SDO time-out: words, saved by G22 and Y1F (App. 5)")
        module.set_g(21, 405)
        module.set_g(24, 500)
        module.set_g(27, 1)
        module.set_g(70, 600, 400)
        module.save()
        module.restart()                     # Y2: they come into force
        if (module.g(27), module.g(37), module.g(70)) != (1, 5000, 600):
            raise SystemExit("the settings were not taken over")

        step("NMT master (1F80H), slave 2 (1F81H, 1F84H), boot time (1F89H)")
        module.set_master()
        module.assign_slave(2, device_type=0x000F0191)
        module.sdo_write(OWN_NODE, 0x1F89, 0, u32(10000))

        step("heartbeat of node 2, every 200 ms: heard within 700 ms (1016H)")
        module.consume_heartbeat(1, node=2, milliseconds=700)

        step("RPDO1 takes the inputs into G10000, TPDO1 sends G13000 to the outputs")
        module.set_up_rpdo(1, 0x182, receive_word(10000))
        module.set_up_tpdo(1, 0x202, transmit_word(13000))

        step("Store parameters (1010H), restart")
        module.store_objects()
        module.restart()
        if not module.g(25) & 0x8000:
            raise SystemExit("the module did not become NMT master")
        module.wait(lambda: module.nmt_states(1, 2) == {1: 5, 2: 5}, "an Operational network", 20)
        module.check()
        print("the network is Operational: nodes 1 and 2")

        module.set_g(13000, 0x005A)
        module.exchange()

        def echoed():
            module.exchange()
            return module.g(10000) >> 8 == 0x5A

        module.wait(echoed, "the echo of 5AH", 5)
        print(f"the I/O block's outputs are {module.g(13000):04X}H, its inputs {module.g(10000):04X}H")
        heartbeat = number(module.sdo_read(2, 0x1017))
        print(f"node 2 has a heartbeat of {heartbeat} ms, G402 = {module.g(402):04X}H")


def step(what):
    print(f"- {what}", flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:3])
