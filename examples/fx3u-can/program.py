#!/usr/bin/env python3
"""The program example of the FX3U-CAN manual's chapter 13, as far as its list of labels and its captions tell it.

usage: program.py [HOST [PORT [FRAME [UNIT]]]]      against `canopus run examples/fx3u-can/program.toml`

FRAME is 3E (default), 4E or 1E; UNIT is the module's number: 0 behind an FX3, 1 to 16 behind an FX5. An FX3U-ENET's 1E frames do not
reach buffer memory, an FX5's do (program-fx5.toml).

Sets the module up, makes it the master of one I/O station, sets up heartbeats and four PDOs, writes an object of the
station, starts the network and exchanges process data while it watches state and heartbeat.
"""
import sys
import time

from fx3u_can import (ALL_NODES, ASSIGNED, BOOT_SLAVE, MANDATORY, OWN_NODE, PRE_OPERATIONAL, START, STATES, STOP,
                      CommandError, Fx3uCan, Plc, number, receive_word, transmit_word, u16)

STATION = 3  # the I/O station's node-ID (TargetSlaveNumber)


def main(host="127.0.0.1", port="5007", frame="3E", unit="0"):
    with Plc(host, int(port), frame=frame) as plc:
        module = Fx3uCan(plc, unit=int(unit))

        module.initialize(node=1, kbps=250)                       # CANopenInit
        # NMTMasterSettings: master, and bit 3: the slaves are started by this program, not by the module.
        module.set_master(0x0000_0009)
        # NMTSlaveSettings: GuardedTime and RetryFactor stay 0, heartbeat is used instead. A station without 100CH and 100DH
        # is answered with a copy of these four words, 84FFH (10.4).
        module.assign_slaves((STATION, ASSIGNED | BOOT_SLAVE | MANDATORY, 0, 0))
        module.store_objects()
        module.restart()
        module.wait(lambda: not module.g(25) & 0x4000, "the end of the slave's start-up", 20)
        print("initialized: node 1, NMT master")

        # HeartbeatProducerSetup of the own and the remote node, HeartbeatConsumerSetup
        module.produce_heartbeats((OWN_NODE, 500), (STATION, 200))
        module.consume_heartbeats((STATION, 1000))
        module.wait(lambda: module.error_control()[STATION] & 2, "the station's heartbeat", 5)
        print("heartbeat of the station is heard")

        # SDOWrite. ReleaseAnalogInputdata of the manual's example is one: many stations send analogue inputs only after
        # 6423:00 = 1 (CiA 401); this one needs none.
        module.sdo_write(STATION, 0x6411, 1, u16(1))
        print(f"the station is of device type {number(module.sdo_read(STATION, 0x1000)):08X}H")

        # PDOSetup, four times: digital and analogue inputs, digital and analogue outputs
        module.set_up_rpdo(1, 0x180 + STATION, receive_word(10000))
        module.set_up_rpdo(2, 0x280 + STATION, receive_word(10004, 4))
        module.set_up_tpdo(1, 0x200 + STATION, transmit_word(11000))
        module.set_up_tpdo(2, 0x300 + STATION, transmit_word(11004, 4))
        print("four PDOs are set up")

        module.nmt_request(ALL_NODES, START)                      # NMTRequestWrite, RequestData 5
        wait_for_state(module, START, "all nodes started")

        echoes, values = 0, set()
        for cycle in range(40):                                   # the cyclic part
            module.write_pdo(1, 0x0080 + cycle)                   # PDOWrite
            module.write_pdo(2, 10 * cycle, 0, 0, 0)
            module.exchange()
            time.sleep(0.02)
            module.exchange()
            echoes += module.read_pdo(1)[0] >> 8 == 0x0080 + cycle  # PDORead
            values.add(module.read_pdo(2)[0])
            failures = module.error_control()[STATION] & 0xFC     # HeartbeatStatus
            if failures:
                raise SystemExit(f"error control of node {STATION}: {failures:02X}H")
        module.check()
        output = number(module.sdo_read(STATION, 0x6411, 1))
        print(f"40 cycles: {echoes} outputs came back, {len(values)} values of the analogue input, analogue output {output}")

        module.nmt_request(STATION, PRE_OPERATIONAL)
        wait_for_state(module, PRE_OPERATIONAL, "the station is pre-operational", only=STATION)
        module.nmt_request(STATION, STOP)
        wait_for_state(module, STOP, "the station is stopped", only=STATION)
        try:
            module.sdo_read(STATION, 0x1000)                      # a stopped node answers no SDO
        except CommandError as error:
            print(f"as expected: {error}")

        # A lost heartbeat, and the end of the error (ErrorReset)
        module.nmt_request(STATION, START)
        wait_for_state(module, START, "the station is operational", only=STATION)
        module.produce_heartbeats((STATION, 0))
        module.wait(lambda: module.g(29) & 0x0400, "#29 bit 10", 5)
        print(f"heartbeat lost: #901 = {module.g(901):04X}H, #29 = {module.g(29):04X}H")
        module.clear_errors()
        print(f"cleared: #901 = {module.g(901):04X}H, #29 = {module.g(29):04X}H")


def wait_for_state(module, state, what, only=None):
    nodes = [only] if only else [1, STATION]
    module.wait(lambda: all(module.nmt_states(node, 1)[node] == state for node in nodes), f"state {STATES[state]}", 10)
    print(what)


if __name__ == "__main__":
    main(*sys.argv[1:5])
