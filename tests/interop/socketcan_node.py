#!/usr/bin/env python3
"""A node of a few lines on a SocketCAN interface: SDO uploads of 1000H and 1018H, downloads to 2000H, NMT, and LSS.

usage: socketcan_node.py INTERFACE NODE    (255: no node-ID yet, LSS finds it by fastscan)
"""
import socket
import struct
import sys

interface, node = sys.argv[1], int(sys.argv[2])
identity = (0x195, 0x402, 0x10001, 77)  # vendor, product, revision, serial
objects = {(0x1000, 0): 0x000F0191, (0x1018, 0): 4, (0x2000, 0): 0}
objects.update({(0x1018, 1 + i): value for i, value in enumerate(identity)})
lss_sub, configuring, future_node = 0, False, node

bus = socket.socket(socket.PF_CAN, socket.SOCK_RAW, socket.CAN_RAW)
bus.bind((interface,))


def send(identifier, data):
    bus.send(struct.pack("=IB3x8s", identifier, len(data), data))


def boot_up():
    if node <= 127:
        send(0x700 + node, b"\0")


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


def nmt(command):
    if command == 1:
        send(0x700 + node, b"\x05")
    elif command in (129, 130):
        boot_up()


def lss(data):
    global lss_sub, configuring, future_node, node
    command = data[0]
    if command == 0x51 and node == 255 and not configuring:
        number, bit, sub, following = struct.unpack("<IBBB", data[1:8])
        if bit == 0x80:
            lss_sub = 0
        elif sub != lss_sub or (number ^ identity[sub]) >> bit:
            return
        elif bit == 0:
            configuring = sub == 3
            lss_sub = following
        send(0x7E4, b"\x4F" + bytes(7))
    elif command == 0x11 and configuring:
        future_node = data[1]
        send(0x7E4, b"\x11" + bytes(7))
    elif command == 0x17 and configuring:
        send(0x7E4, b"\x17" + bytes(7))
    elif command == 0x04 and data[1] == 0 and configuring:
        configuring = False
        if node == 255:
            node = future_node
            boot_up()


boot_up()
print("ready", flush=True)
while True:
    identifier, length, data = struct.unpack("=IB3x8s", bus.recv(16))
    if identifier == 0x600 + node:
        sdo(data)
    elif identifier == 0 and data[1] in (0, node):
        nmt(data[0])
    elif identifier == 0x7E5:
        lss(data)
