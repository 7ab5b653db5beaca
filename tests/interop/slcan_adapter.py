#!/usr/bin/env python3
"""A Lawicel CAN adapter at a pseudo terminal or a TCP port, whose bus is one of python-can.

usage: slcan_adapter.py pty|tcp INTERFACE CHANNEL [OPTION=VALUE ...]

Prints where it is (the device, or the port), then each command that sets it up. Frames go to python-can's bus and come from it.
Without `O` there is no bus. At random moments it cuts what it sends.
"""
import os
import pty
import random
import select
import socket
import sys
import tty

import can

where, interface, channel = sys.argv[1:4]
options = dict(word.split("=", 1) for word in sys.argv[4:])
bus = can.Bus(interface=interface, channel=channel, **{k: int(v) if v.isdigit() else v for k, v in options.items()})
chance = random.Random(1)
if where == "pty":
    master, slave = pty.openpty()
    tty.setraw(slave)
    print(os.ttyname(slave), flush=True)
else:
    server = socket.create_server(("127.0.0.1", 0))
    print(server.getsockname()[1], flush=True)
    connection = server.accept()[0]
    master = connection.fileno()


def say(text):
    data = text.encode()
    cut = chance.randrange(len(data) + 1)
    for part in (data[:cut], data[cut:]):
        if part:
            os.write(master, part)


def frame_of(line):
    extended, remote = line[0] in "TR", line[0] in "rR"
    digits = 8 if extended else 3
    length = int(line[1 + digits])
    data = bytes.fromhex(line[2 + digits:])
    assert len(data) == (0 if remote else length), line
    return can.Message(arbitration_id=int(line[1:1 + digits], 16), is_extended_id=extended, is_remote_frame=remote, dlc=length,
                       data=None if remote else data)


opened, rate, rest = False, None, ""
sent = []  # python-can's multicast bus hears what it sends itself
while True:
    readable, _, _ = select.select([master], [], [], 0 if opened else 0.05)
    if readable:
        try:
            data = os.read(master, 4096)
        except OSError:
            data = b""
        if not data and where == "tcp":
            break
        *lines, rest = (rest + data.decode()).split("\r")
        for line in lines:
            if line and line[0] in "tTrR":
                if not opened:
                    say("\a")
                    continue
                message = frame_of(line)
                sent.append((message.arbitration_id, bytes(message.data)))
                bus.send(message)
                say("z\r" if line[0] in "tr" else "Z\r")
                continue
            if line == "F":
                say("F00\r" if opened else "\a")
                continue
            if line:
                print(line, flush=True)
            if line == "C":
                say("\r" if opened else "\a")
                opened = False
            elif line == "O":
                opened = rate is not None
                say("\r" if opened else "\a")
            elif line[:1] in ("S", "s"):
                rate = line
                say("\a" if opened else "\r")
            elif line == "V":
                say("V1013\r")
            else:
                say("\r")
    if not opened:
        continue
    message = bus.recv(timeout=0.005)
    if message is None:
        continue
    if (message.arbitration_id, bytes(message.data)) in sent:
        sent.remove((message.arbitration_id, bytes(message.data)))
        continue
    digits = f"{message.arbitration_id:08X}" if message.is_extended_id else f"{message.arbitration_id:03X}"
    letter = "tTrR"[2 * message.is_remote_frame + message.is_extended_id]
    say(f"{letter}{digits}{message.dlc}{bytes(message.data).hex().upper()}\r")
