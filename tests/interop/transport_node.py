#!/usr/bin/env python3
"""A CANopen node of a few lines on any bus of python-can: SDO uploads of 1000H and 1018H, downloads to 2000H, NMT.

usage: transport_node.py NODE INTERFACE CHANNEL [OPTION=VALUE ...]    (options of can.Bus; whole numbers are numbers)

Prints "ready", then one line for each frame it hears. The frame with identifier 7F0H makes it send one frame of each kind:
data of every length, base and extended, and remote frames.
"""
import struct
import sys

import can

node, interface, channel = int(sys.argv[1]), sys.argv[2], sys.argv[3]
options = dict(word.split("=", 1) for word in sys.argv[4:])
bus = can.Bus(interface=interface, channel=channel, **{k: int(v) if v.isdigit() else v for k, v in options.items()})
objects = {(0x1000, 0): 0x000F0191, (0x1018, 0): 4, (0x2000, 0): 0}
objects.update({(0x1018, 1 + i): value for i, value in enumerate((0x195, 0x402, 0x10001, 77))})


def send(identifier, data=b"", extended=False, remote=False, dlc=None):
    bus.send(can.Message(arbitration_id=identifier, data=data, is_extended_id=extended, is_remote_frame=remote, dlc=dlc))


def sdo(data):
    index, sub = struct.unpack("<HB", data[1:4])
    if (index, sub) not in objects:
        send(0x580 + node, b"\x80" + data[1:4] + struct.pack("<I", 0x06020000))
    elif data[0] == 0x40:
        one_byte = (index, sub) == (0x1018, 0)
        send(0x580 + node, (b"\x4F" if one_byte else b"\x43") + data[1:4] + struct.pack("<I", objects[index, sub]))
    elif data[0] == 0x23 and index == 0x2000:
        objects[index, sub] = struct.unpack("<I", data[4:])[0]
        send(0x580 + node, b"\x60" + data[1:4] + bytes(4))
    else:
        send(0x580 + node, b"\x80" + data[1:4] + struct.pack("<I", 0x06010002))


def every_kind():
    for length in range(9):
        send(0x300 + length, bytes(range(1, length + 1)))
        send(0x1FFFFFF0 + length, bytes(range(1, length + 1)), extended=True)
    for length in range(9):
        send(0x310 + length, remote=True, dlc=length)
        send(0x10000 + length, remote=True, extended=True, dlc=length)


print("ready", flush=True)
while True:
    message = bus.recv()
    if message is None:
        continue
    kind = ("X" if message.is_extended_id else "B") + ("R" if message.is_remote_frame else "D")
    print(f"{kind} {message.arbitration_id:X} {message.dlc} {bytes(message.data).hex()}", flush=True)
    if message.is_extended_id or message.is_remote_frame:
        continue
    if message.arbitration_id == 0x600 + node:
        sdo(bytes(message.data))
    elif message.arbitration_id == 0 and message.data[1] in (0, node):
        if message.data[0] == 1:
            send(0x700 + node, b"\x05")
        elif message.data[0] in (129, 130):
            send(0x700 + node, b"\0")
    elif message.arbitration_id == 0x7F0:
        every_kind()
