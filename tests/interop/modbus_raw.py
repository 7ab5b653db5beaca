#!/usr/bin/env python3
"""Talks Modbus TCP to a rack with every byte written by hand: modbus_raw.py HOST PORT

The rack has the map that goes without a map: coils are Y, discrete inputs X, holding registers D, input registers SD.
"""
import socket
import struct
import sys

failures = 0


def check(what, held, found=b""):
    global failures
    print(("ok    " if held else "FAIL  ") + what + ("" if held else f": got {found.hex()}"))
    failures += 0 if held else 1


def main():
    connection = socket.create_connection((sys.argv[1], int(sys.argv[2])), 60)
    transaction = 0

    def ask(pdu, unit=255):
        nonlocal transaction
        transaction += 1
        connection.sendall(struct.pack(">HHHB", transaction, 0, len(pdu) + 1, unit) + pdu)
        reply = connection.recv(4096)
        if reply[:4] != struct.pack(">HH", transaction, 0) or len(reply) != 6 + struct.unpack(">H", reply[4:6])[0]:
            check("the header is the request's", False, reply)
        return reply[7:]

    def expect(what, request, reply):
        found = ask(bytes.fromhex(request))
        check(what, found == bytes.fromhex(reply), found)

    expect("16 writes D700 to D702", "10 02bc 0003 06 1234 abcd 0001", "10 02bc 0003")
    expect("3 reads them", "03 02bc 0003", "03 06 1234 abcd 0001")
    expect("6 writes D700", "06 02bc 0012", "06 02bc 0012")
    expect("22 masks it", "16 02bc 00f2 0025", "16 02bc 00f2 0025")
    expect("23 writes D701 and reads D700", "17 02bc 0002 02bd 0001 02 5678", "17 04 0017 5678")
    expect("5 sets Y100", "05 0100 ff00", "05 0100 ff00")
    expect("15 writes Y101 to Y103", "0f 0101 0003 01 05", "0f 0101 0003")
    expect("1 reads Y100 to Y103", "01 0100 0004", "01 01 0b")
    expect("15 resets them", "0f 0100 0004 01 00", "0f 0100 0004")
    found = ask(bytes.fromhex("02 0000 0020"))
    check("2 reads X0 to X1F", len(found) == 6 and found[:2] == b"\x02\x04", found)
    expect("4 reads SD203: RUN", "04 00cb 0001", "04 02 0000")
    found = ask(bytes.fromhex("2b 0e 01 00"))
    check("43/14 says who it is", found[:4] == bytes.fromhex("2b0e0182") and b"Canopus" in found, found)
    expect("exception 1", "08 0000 0000", "88 01")
    expect("exception 2", "03 ffff 0001", "83 02")
    expect("exception 3", "03 0000 007e", "83 03")
    connection.sendall(b"GET / HTTP/1.1\r\n\r\n")
    try:
        rest = connection.recv(4096)
    except ConnectionError:
        rest = b""
    check("what is no request closes the connection", rest == b"", rest)
    print(f"{failures} failed" if failures else "all held")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
