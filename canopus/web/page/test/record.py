#!/usr/bin/env python3
"""Writes test/recorded.ts: messages of runs as their servers sent them, so that the types of store/protocol.ts are checked against them.

  test/record.py URL...      as `canopus run --web` prints them
"""
import base64
import json
import os
import pathlib
import socket
import struct
import sys
import time
import urllib.parse

VIEWS = [{"words": 0, "find": "", "from": 0, "count": 3}, {"objects": 1, "find": "", "from": 0, "count": 4}, {"boots": True}, {"traffic": 0}, {"errors": 0},
         {"meaning": "1017:00"}, {"values": ["words 0 25", "objects 1 1000:00"]}]
COMMANDS = [{"command": "hello"}, {"command": "faults"}, {"command": "trace", "filter": "", "fold": True, "count": 3}]


def record(url):
    place = urllib.parse.urlsplit(url)
    link = socket.create_connection((place.hostname, place.port), 10)
    link.sendall((f"GET /events?{place.fragment} HTTP/1.1\r\nHost: {place.netloc}\r\nOrigin: http://{place.netloc}\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
                  f"Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: {base64.b64encode(os.urandom(16)).decode()}\r\n\r\n").encode())
    file = link.makefile("rb")
    while file.readline().strip():
        pass
    for message in [{"views": VIEWS}, *({"do": one, "id": i} for i, one in enumerate(COMMANDS))]:
        data = json.dumps(message).encode()
        size = bytes([0x80 | len(data)]) if len(data) < 126 else b"\xFE" + struct.pack("!H", len(data))
        link.sendall(b"\x81" + size + bytes(4) + data)
    kept, end = {}, time.time() + 4
    while time.time() < end:
        first, size = file.read(2)
        size = {126: lambda: struct.unpack("!H", file.read(2))[0], 127: lambda: struct.unpack("!Q", file.read(8))[0]}.get(size & 0x7F, lambda: size & 0x7F)()
        data = file.read(size)
        for event in json.loads(data) if first == 0x81 else []:
            kept[(event["event"], event.get("id"), event.get("step"))] = event
    return list(kept.values())


def main():
    events = [event for url in sys.argv[1:] for event in record(url)]
    views = {"state", "words", "objects", "boots", "traffic", "errors", "meaning", "values"}
    for event in events:  # a few of each list are enough
        for key, value in event.items():
            if isinstance(value, list) and len(value) > 12:
                event[key] = value[:12]
        event.get("code") is not None and event.pop("version", None)
    shown = [json.dumps(event, ensure_ascii=False) for event in events if event["event"] in views]
    others = [json.dumps(event, ensure_ascii=False) for event in events if event["event"] not in views]
    text = "// Made by test/record.py of running plants: what the types of store/protocol.ts are checked against.\n"
    text += "import type { RunEvent, RunState, View } from \"../src/store/protocol.js\";\n\n"
    text += "export const recorded_views = [\n  " + ",\n  ".join(shown) + ",\n] satisfies (RunState | View)[];\n\n"
    text += "export const recorded_events: RunEvent[] = [\n  " + ",\n  ".join(others) + ",\n];\n"
    (pathlib.Path(__file__).parent / "recorded.ts").write_text(text)


main()
