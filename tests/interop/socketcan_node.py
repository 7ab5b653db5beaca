#!/usr/bin/env python3
"""A node of a few lines on a SocketCAN interface: answers SDO uploads of 1000H (expedited) and NMT start with a heartbeat.

usage: socketcan_node.py INTERFACE NODE
"""
import socket
import struct
import sys

interface, node = sys.argv[1], int(sys.argv[2])
bus = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
bus.bind((interface,))


def send(identifier, data):
    bus.send(struct.pack("=IB3x8s", identifier, len(data), data))


send(0x700 + node, b"\0")
print("ready", flush=True)
while True:
    identifier, length, data = struct.unpack("=IB3x8s", bus.recv(16))
    if identifier == 0x600 + node and data[0] == 0x40:
        if data[1:4] == b"\x00\x10\x00":
            send(0x580 + node, b"\x43\x00\x10\x00\x91\x01\x0f\x00")
        else:
            send(0x580 + node, b"\x80" + data[1:4] + struct.pack("<I", 0x06020000))
    elif identifier == 0 and data[0] == 1 and data[1] in (0, node):
        send(0x700 + node, b"\x05")
