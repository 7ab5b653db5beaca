#!/usr/bin/env python3
"""Talks to a PLC in 1E frames over TCP and UDP, and in 3E and 4E frames over UDP, with every byte written by hand.

    plc_1e.py HOST TCP_PORT UDP_PORT

Both ports take 1E, the UDP port 3E and 4E besides. D900 to D902 and M900 to M902 are written. Prints what it checks; exit code
0 when everything held, 1 otherwise.
"""
import socket
import struct
import sys

TIMEOUT = 60.0  # seconds; a PLC answers at once, a busy machine may not
failures = 0


def check(what, held, found=b""):
    global failures
    print(("ok    " if held else "FAIL  ") + what + ("" if held else f": got {found!r}"))
    failures += 0 if held else 1


def header(command):
    return struct.pack("<BBH", command, 0xFF, 10)


def device(name, number):
    return struct.pack("<I", number) + name.encode("ascii").ljust(2)[::-1]


def ascii_device(name, number):
    return name.encode("ascii").ljust(2).hex().upper().encode() + b"%08X" % number


def conversation(what, ask):
    reply = ask(header(0x15))
    check(f"{what}: 15 answers a CPU model", len(reply) == 4 and reply[:2] == b"\x95\x00", reply)
    words = struct.pack("<3H", 0x1234, 0xABCD, 1)
    reply = ask(header(0x03) + device("D", 900) + b"\x03\x00" + words)
    check(f"{what}: 03 writes D900 to D902", reply == b"\x83\x00", reply)
    reply = ask(header(0x01) + device("D", 900) + b"\x03\x00")
    check(f"{what}: 01 reads them back", reply == b"\x81\x00" + words, reply)
    reply = ask(header(0x02) + device("M", 900) + b"\x03\x00\x10\x10")
    check(f"{what}: 02 writes M900 ON, M901 OFF, M902 ON", reply == b"\x82\x00", reply)
    reply = ask(header(0x00) + device("M", 900) + b"\x03\x00")
    check(f"{what}: 00 reads them back, and a dummy", reply == b"\x80\x00\x10\x10", reply)
    reply = ask(header(0x04) + b"\x02\x00" + device("M", 900) + b"\x00" + device("M", 902) + b"\x00")
    check(f"{what}: 04 resets them", reply == b"\x84\x00", reply)
    reply = ask(header(0x05) + b"\x02\x00" + device("D", 900) + b"\x05\x00" + device("D", 902) + b"\x06\x00")
    check(f"{what}: 05 writes D900 and D902", reply == b"\x85\x00", reply)
    reply = ask(b"01FF000A" + ascii_device("D", 900) + b"0300")
    check(f"{what}: 01 in ASCII reads them", reply == b"81000005ABCD0006", reply)
    reply = ask(header(0x0E) + b"\x32\x00\x00\x02\x00\x00")
    check(f"{what}: 0E reads U0\\G25 at byte address 32H", len(reply) == 4 and reply[:2] == b"\x8e\x00", reply)
    reply = ask(header(0x16) + b"\x03ABC")
    check(f"{what}: 16 returns what it got", reply == b"\x96\x00\x03ABC", reply)
    for name, request, expected in (
            ("an unknown subheader", header(0x3B), "bb50"),
            ("an unknown device", header(0x01) + device("Q", 0) + b"\x01\x00", "8156"),
            ("too many points", header(0x03) + device("M", 0) + b"\x29\x00" + bytes(82), "8357"),
            ("D999999", header(0x01) + device("D", 999999) + b"\x01\x00", "8158"),
            ("bits of D", header(0x00) + device("D", 0) + b"\x01\x00", "8058"),
            ("PC number 1", b"\x01\x01\x0a\x00" + device("D", 0) + b"\x01\x00", "815b1000"),
            ("a slot without a module", header(0x0E) + b"\0\0\0\x02\xFE\0", "8e5b1200")):
        reply = ask(request)
        check(f"{what}: {name}: {expected.upper()}", reply.hex() == expected, reply)


def tcp(host, port):
    # The data code is the connection's: ASCII needs another one.
    with socket.create_connection((host, port), TIMEOUT) as binary, \
            socket.create_connection((host, port), TIMEOUT) as text:
        def ask(request):
            connection = text if request[:1] == b"0" and request[1:2].isdigit() else binary
            connection.sendall(request)
            return connection.recv(4096)
        conversation("TCP", ask)
        binary.sendall(header(0x01) + device("D", 900)[:3])
        text.sendall(b"01FF000A" + ascii_device("D", 900) + b"0100")
        check("TCP: half a request of one client does not stop another", text.recv(4096) == b"81000005")
        binary.sendall(device("D", 900)[3:] + b"\x01\x00")
        check("TCP: and is answered when it is complete", binary.recv(4096) == b"\x81\x00\x05\x00")


def udp(host, port):
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as datagrams:
        datagrams.settimeout(TIMEOUT)
        datagrams.connect((host, port))

        def ask(request):
            datagrams.send(request)
            return datagrams.recv(65536)
        conversation("UDP", ask)
        reply = ask(header(0x01) + device("D", 900) + b"\x01")
        check("UDP: a datagram that is too short: 57H", reply == b"\x81\x57", reply)
        request = bytes.fromhex("500000ffff03000c00100001040000840300a80100")
        reply = ask(request)
        check("UDP: 3E reads D900", reply == bytes.fromhex("d00000ffff030004000000") + b"\x05\x00", reply)
        reply = ask(b"\x54\x00\x34\x12\x00\x00" + request[2:])
        check("UDP: 4E carries the serial number", reply[:6] == b"\xd4\x00\x34\x12\x00\x00", reply)
        reply = ask(request + b"\x00")
        check("UDP: a datagram that is too long: C061H", reply[9:11] == b"\x61\xc0", reply)
        for garbage in (b"", b"\x50", b"GET / HTTP/1.1\r\n\r\n", bytes(range(0x40, 0x50)) * 100):
            datagrams.send(garbage)
        reply = ask(request)
        check("UDP: what is no request gets no answer", reply[:2] == b"\xd0\x00", reply)


def main():
    host, tcp_port, udp_port = sys.argv[1], int(sys.argv[2]), int(sys.argv[3])
    try:
        tcp(host, tcp_port)
        udp(host, udp_port)
    except OSError as error:
        print(f"FAIL  {host}: {error}")
        return 1
    print(f"{failures} failed" if failures else "all held")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
