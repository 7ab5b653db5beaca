#!/usr/bin/env python3
"""The other side of a cannelloni connection, of a few lines and from its format alone; its bus is one of python-can.

usage: cannelloni_peer.py udp OUR-PORT THEIR-PORT INTERFACE CHANNEL [OPTION=VALUE ...]
       cannelloni_peer.py tcp INTERFACE CHANNEL [OPTION=VALUE ...]          (prints its port)
"""
import select
import socket
import struct
import sys

import can

words = sys.argv[2:]
if sys.argv[1] == "udp":
    ours, theirs, *words = words
    link = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
    link.bind(("127.0.0.1", int(ours)))
    link.connect(("127.0.0.1", int(theirs)))
interface, channel, *words = words
options = dict(word.split("=", 1) for word in words)
bus = can.Bus(interface=interface, channel=channel, **{k: int(v) if v.isdigit() else v for k, v in options.items()})
if sys.argv[1] == "tcp":
    server = socket.create_server(("127.0.0.1", 0))
    print(server.getsockname()[1], flush=True)
    link = server.accept()[0]
    link.sendall(b"CANNELLONIv1")
    greeting = b""
    while len(greeting) < 12:
        greeting += link.recv(12 - len(greeting))
    assert greeting == b"CANNELLONIv1", greeting
else:
    print("ready", flush=True)


def record(message):
    identifier = message.arbitration_id | message.is_extended_id << 31 | message.is_remote_frame << 30
    return struct.pack(">IB", identifier, message.dlc) + bytes(message.data)


def take(data):
    """The message at the front and what is behind it, or None and all of it."""
    if len(data) < 5:
        return None, data
    identifier, length = struct.unpack(">IB", data[:5])
    remote = bool(identifier & 1 << 30)
    end = 5 + (0 if remote else length)
    if len(data) < end:
        return None, data
    return can.Message(arbitration_id=identifier & 0x1FFFFFFF, is_extended_id=bool(identifier >> 31), is_remote_frame=remote,
                       dlc=length, data=None if remote else data[5:end]), data[end:]


sequence, expected, rest, sent = 0, 0, b"", []
while True:
    if select.select([link], [], [], 0)[0]:
        try:
            data = link.recv(65536)
        except ConnectionRefusedError:
            continue
        if sys.argv[1] == "tcp":
            if not data:
                break
            rest += data
        else:
            version, operation, number, count = struct.unpack(">BBBH", data[:5])
            assert (version, operation) == (2, 0), data
            if number != expected and number != 0:
                print(f"sequence {number}, expected {expected}", flush=True)
            expected = (number + 1) % 256
            rest = data[5:]
        found = 0
        while True:
            message, rest = take(rest)
            if message is None:
                break
            found += 1
            sent.append((message.arbitration_id, bytes(message.data)))
            bus.send(message)
        if sys.argv[1] == "udp":
            assert found == count and not rest, data
    message = bus.recv(timeout=0.005)
    if message is None:
        continue
    if (message.arbitration_id, bytes(message.data)) in sent:
        sent.remove((message.arbitration_id, bytes(message.data)))
        continue
    if sys.argv[1] == "udp":
        link.send(struct.pack(">BBBH", 2, 0, sequence, 1) + record(message))
        sequence = (sequence + 1) % 256
    else:
        link.sendall(record(message))
