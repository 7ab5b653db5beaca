#!/usr/bin/env python3
"""python-can over socketcand: hears the bus, reads an object by SDO, commands a node by NMT.

usage: socketcand_python_can.py HOST PORT BUS NODE [DEVICE_TYPE]

Needs Debian's python3-can (run it with /usr/bin/python3).
"""
import struct
import sys
import time

import can


def main():
    if len(sys.argv) < 5:
        print(__doc__)
        return 2
    host, port, name, node = sys.argv[1], int(sys.argv[2]), sys.argv[3], int(sys.argv[4])
    bus = can.Bus(interface="socketcand", host=host, port=port, channel=name)
    failures = 0

    def check(what, actual, expected):
        nonlocal failures
        failures += actual != expected
        print(f"{'ok   ' if actual == expected else 'FAIL '} {what}: {actual!r}" +
              ("" if actual == expected else f", expected {expected!r}"))

    def send(identifier, *data):
        bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=False))

    def wait(condition, seconds=60.0):
        """The first frame from now on for which the condition holds, or None."""
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            message = bus.recv(timeout=max(0.0, end - time.monotonic()))
            if message is not None and condition(message):
                return message
        return None

    def sdo(*request):
        send(0x600 + node, *request)
        answer = wait(lambda m: m.arbitration_id == 0x580 + node and bytes(m.data[1:4]) == bytes(request[1:4]))
        return None if answer is None else bytes(answer.data)

    heard = wait(lambda m: True)
    check("a frame of the bus arrives", heard is not None, True)

    answer = sdo(0x40, 0x00, 0x10, 0x00, 0, 0, 0, 0)
    check("SDO read of 1000H is answered by an expedited upload of 4 bytes", answer and answer[0], 0x43)
    device_type = struct.unpack("<I", answer[4:])[0] if answer else None
    if len(sys.argv) > 5:
        check("device type", device_type, int(sys.argv[5], 0))
    else:
        print(f"      device type: {device_type:#010x}" if answer else "")

    answer = sdo(0x40, 0xFF, 0x2F, 0x00, 0, 0, 0, 0)
    check("SDO read of an object that does not exist is aborted", answer,
          bytes([0x80, 0xFF, 0x2F, 0x00, 0x00, 0x00, 0x02, 0x06]))

    before = sdo(0x40, 0x17, 0x10, 0x00, 0, 0, 0, 0)
    check("heartbeat time is read", before and before[0], 0x4B)
    check("heartbeat time is set to 100 ms", sdo(0x2B, 0x17, 0x10, 0x00, 100, 0, 0, 0),
          bytes([0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0]))
    for command, state, text in ((0x80, 0x7F, "Pre-operational"), (0x01, 0x05, "Operational")):
        send(0x000, command, node)
        seen = wait(lambda m, s=state: m.arbitration_id == 0x700 + node and m.data[0] == s)
        check(f"heartbeats say {text} after NMT command {command:02X}H", seen and seen.data[0], state)
    if before:
        check("heartbeat time is set back", sdo(0x2B, 0x17, 0x10, 0x00, before[4], before[5], 0, 0),
              bytes([0x60, 0x17, 0x10, 0x00, 0, 0, 0, 0]))

    if heard is not None:
        later = wait(lambda m: True)
        check("time stamps increase", later is not None and later.timestamp > heard.timestamp, True)
    bus.shutdown()
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
