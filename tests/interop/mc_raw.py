#!/usr/bin/env python3
r"""Talks MC protocol to a PLC over plain TCP, with every byte written by hand.

    mc_raw.py HOST PORT [--remote]

Works on any rack with a module at start I/O 0 whose U0\\G25 can be read. D900 to D902 are written and restored,
M900 to M902 written and left OFF. --remote also pauses and runs the CPU. Prints what it checks; exit code 0 when everything held, 1 otherwise.
"""
import argparse
import socket
import sys

TIMEOUT = 60.0  # seconds; a PLC answers at once, a busy machine may not
failures = 0


def connect(host, port):
    connection = socket.create_connection((host, port), TIMEOUT)
    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
    return connection


def exchange(connection, request, size=None):
    """Sends and takes the reply of one recv() call, as simple clients do; `size` when several are due."""
    connection.sendall(request)
    reply = connection.recv(65536)
    while size is not None and len(reply) < size:
        more = connection.recv(65536)
        if not more:
            break
        reply += more
    return reply


def check(what, held, found=b""):
    global failures
    print(("ok    " if held else "FAIL  ") + what + ("" if held else f": got {found!r}"))
    if not held:
        failures += 1


def h(text):
    return bytes.fromhex(text)


def binary_3e(plc):
    reply = exchange(plc, h("5000 00 ff ff03 00 0600 1000 0101 0000".replace(" ", "")))
    check("0101 answers 16 characters of a CPU name and its code",
          len(reply) == 29 and reply[:11] == h("d00000ffff030014000000") and reply[11:12] in (b"R", b"Q"), reply)

    # U0\G25: extension, number 25, code AB, module 0000, F8; 1 word.
    by_device = exchange(plc, h("5000 00 ff ff03 00 1300 1000 0104 8000 0000 190000 ab 0000 0000 f8 0100"
                                .replace(" ", "")))
    check("0401/0080 reads U0\\G25", len(by_device) == 13 and by_device[:11] == h("d00000ffff030004000000"),
          by_device)
    by_device_iqr = exchange(plc, h("5000 00 ff ff03 00 1500 1000 0104 8200 0000 19000000 ab00 0000 0000 f8 0100"
                                    .replace(" ", "")))
    check("0401/0082 reads U0\\G25 likewise, or a Q CPU refuses it with C059",
          (len(by_device_iqr) == 13 and by_device_iqr[:11] == by_device[:11])
          or by_device_iqr[9:11] == h("59c0"), by_device_iqr)
    # The same word by its byte address 50 = 32H, 2 bytes, module number 0000.
    by_bytes = exchange(plc, h("5000 00 ff ff03 00 0e00 1000 0106 0000 32000000 0200 0000".replace(" ", "")))
    check("0601 reads U0\\G25 at byte address 32H", len(by_bytes) == 13
          and by_bytes[:11] == h("d00000ffff030004000000"), by_bytes)
    print(f"      U0\\G25 = {int.from_bytes(by_device[11:13], 'little'):04X}H by device,"
          f" {int.from_bytes(by_bytes[11:13], 'little'):04X}H by byte address")

    before = exchange(plc, h("500000ffff03000c00100001040000840300a80300"))
    check("0401/0000 reads D900 to D902", len(before) == 17, before)
    reply = exchange(plc, h("500000ffff03001200100001140000840300a80300 3412 cdab 0100".replace(" ", "")))
    check("1401/0000 writes D900 to D902", reply == h("d00000ffff030002000000"), reply)
    reply = exchange(plc, h("500000ffff03000c00100001040000840300a80300"))
    check("they read back", reply == h("d00000ffff030008000000 3412 cdab 0100".replace(" ", "")), reply)
    exchange(plc, h("500000ffff03001200100001140000840300a80300".replace(" ", "")) + before[11:17])

    reply = exchange(plc, h("500000ffff03000e0010000114010084030090 0300 1010".replace(" ", "")))
    check("1401/0001 writes M900 ON, M901 OFF, M902 ON", reply == h("d00000ffff030002000000"), reply)
    reply = exchange(plc, h("500000ffff03000c00100001040100840300900300"))
    check("0401/0001 reads them back, two points a byte", reply == h("d00000ffff030004000000 1010".replace(" ", "")),
          reply)
    reply = exchange(plc, h("500000ffff03000c00100001040000840300900100"))
    check("0401/0000 reads M900 to M915 as a word", reply == h("d00000ffff030004000000 0500".replace(" ", "")), reply)
    exchange(plc, h("500000ffff03000e0010000114010084030090 0300 0000".replace(" ", "")))

    reply = exchange(plc, h("500000ffff03000c001000010401000000009c0200"))
    check("0401/0001 reads X0 and X1: 0 or 1 each", len(reply) == 12 and reply[:11] == h("d00000ffff030003000000")
          and reply[11] in (0x00, 0x01, 0x10, 0x11), reply)
    reply = exchange(plc, h("500000ffff03000c001000010401000000009d1000"))
    check("0401/0001 reads Y0 to YF: 8 bytes", len(reply) == 19 and reply[:11] == h("d00000ffff03000a000000"), reply)
    reply = exchange(plc, h("500000ffff03000c00100001040100900100910200"))
    check("SM400 is ON, SM401 OFF", reply == h("d00000ffff030003000000 10".replace(" ", "")), reply)
    reply = exchange(plc, h("500000ffff03000d00100019060000 0500 4142433132".replace(" ", "")))
    check("0619 sends ABC12 back", reply == h("d00000ffff030009000000 0500 4142433132".replace(" ", "")), reply)
    reply = exchange(plc, h("500000ffff03000d00100019060000 0500 00ff0d0a67".replace(" ", "")))
    check("0619 sends any bytes back", reply == h("d00000ffff030009000000 0500 00ff0d0a67".replace(" ", "")), reply)


def own_buffer(plc):
    reply = exchange(plc, h("500000ffff03000c00100013060000 10000000 0200".replace(" ", "")))
    if reply[9:11] == h("59c0"):
        print("      0613: this CPU has no buffer memory of its own")
        return
    check("0613 reads two words", len(reply) == 15 and reply[:11] == h("d00000ffff030006000000"), reply)
    before = reply[11:]
    written = exchange(plc, h("500000ffff03001000100013160000 10000000 0200 3412cdab".replace(" ", "")))
    check("1613 writes them", written == h("d00000ffff030002000000"), written)
    reply = exchange(plc, h("500000ffff03000c00100013060000 10000000 0200".replace(" ", "")))
    check("they read back", reply[11:] == h("3412cdab"), reply)
    exchange(plc, h("500000ffff0300100010001316000010000000 0200".replace(" ", "")) + before)


def device_points(plc):
    """What a client does that looks for the devices of an unknown CPU: each one's last point can be read, the next not."""
    reply = exchange(plc, h("500000ffff03000600100001010000"))
    iqr = reply[11:12] == b"R"
    first, count = (260, 50) if iqr else (286, 26)
    request = bytearray(h("500000ffff03000c00100001040000 000000 a9 0000".replace(" ", "")))
    request[15:18] = first.to_bytes(3, "little")
    request[19:21] = count.to_bytes(2, "little")
    reply = exchange(plc, bytes(request))
    words = [int.from_bytes(reply[at:at + 2], "little") for at in range(11, len(reply), 2)]
    check(f"SD{first} to SD{first + count - 1} are read", len(words) == count, reply)
    if len(words) != count:
        return

    def points(number, double):
        return words[number - first] | (words[number + 1 - first] << 16 if double else 0)

    devices = ({"X": (260, 0x9C), "Y": (262, 0x9D), "M": (264, 0x90), "B": (266, 0xA0), "L": (274, 0x92), "D": (280, 0xA8),
                "W": (282, 0xB4), "TN": (288, 0xC2), "CN": (292, 0xC5), "ZR": (306, 0xB0)} if iqr else
               {"X": (290, 0x9C), "Y": (291, 0x9D), "M": (286, 0x90), "B": (288, 0xA0), "L": (293, 0x92), "D": (308, 0xA8),
                "W": (310, 0xB4), "TN": (299, 0xC2), "CN": (301, 0xC5), "ZR": (306, 0xB0)})
    for name, (number, code) in devices.items():
        found = points(number, iqr or number in (286, 288, 306, 308, 310))
        if found == 0:
            continue
        is_bit = name in ("X", "Y", "M", "B", "L")
        ends = []
        for last in (found - 1, found):
            subcommand = b"\x01\x00" if is_bit else b"\x00\x00"
            reply = exchange(plc, h("500000ffff03000c0010000104") + subcommand + last.to_bytes(3, "little") + bytes([code])
                             + b"\x01\x00")
            ends.append(reply[9:11])
        check(f"SD{number} says {found} points of {name}: the last one is read, the next is 4031", ends == [h("0000"), h("3140")],
              b"".join(ends))


def remote_pause(plc):
    def status():
        return exchange(plc, h("500000ffff03000c00100001040000cb0000a90100"))[11:13]

    reply = exchange(plc, h("500000ffff03000800100003100000 0100".replace(" ", "")))
    check("1003 is completed", reply == h("d00000ffff030002000000"), reply)
    check("SD203 says PAUSE by remote operation", status() == h("2300"), status())
    reply = exchange(plc, h("500000ffff03000800100005100000 0100".replace(" ", "")))
    check("latch clear is refused in PAUSE", reply[9:11] == h("1340"), reply)
    reply = exchange(plc, h("500000ffff03000a00100001100000 0100 0000".replace(" ", "")))
    check("1001 ends it", reply == h("d00000ffff030002000000") and status() == h("0000"), reply)


def binary_errors(plc):
    def refused(what, request, end_code, command):
        reply = exchange(plc, h(request.replace(" ", "")))
        check(f"{what}: end code {end_code}H",
              reply == h("d00000ffff03000b00") + bytes.fromhex(end_code)[::-1] + h("00ffff0300")
              + h(command.replace(" ", "")), reply)

    refused("an unknown command", "500000ffff0300060010009999 0000", "C059", "9999 0000")
    refused("an unknown subcommand", "500000ffff03000c0010000104 0700 640000a80300", "C059", "0104 0700")
    refused("D9999999", "500000ffff03000c0010000104 0000 7f9698a80100", "4031", "0104 0000")
    refused("961 words", "500000ffff03000c0010000104 0000 000000a8c103", "C052", "0104 0000")
    refused("0 words", "500000ffff03000c0010000104 0000 000000a80000", "C052", "0104 0000")
    refused("7169 bits", "500000ffff03000c0010000104 0100 00000090011c", "C051", "0104 0100")
    refused("single bits of D", "500000ffff03000c0010000104 0100 640000a80100", "C05C", "0104 0100")
    refused("an unknown device code", "500000ffff03000c0010000104 0000 640000010100", "C05B", "0104 0000")
    refused("a request that ends early", "500000ffff0300090010000104 0000 640000", "C061", "0104 0000")
    reply = exchange(plc, h("500001ffff03000c0010000104 0000 640000a80100".replace(" ", "")))
    check("a request for network 1: end code C05FH", reply[:11] == h("d00001ffff03000b005fc0"), reply)
    refused("0601 of a slot without module", "500000ffff03000e0010000106 0000 00000000 0200 fe00", "4043", "0106 0000")


def binary_4e(plc):
    reply = exchange(plc, h("5400 3412 0000 00 ff ff03 00 0c00 1000 0104 0000 900100 a9 0100".replace(" ", "")))
    check("a 4E reply carries the request's serial number",
          reply[:15] == h("d400 3412 0000 00ffff0300 0400 0000".replace(" ", "")) and len(reply) == 17, reply)
    # Three requests in one segment, serials 1 to 3: three replies of 17 bytes in order.
    one = "5400 {:02x}00 0000 00 ff ff03 00 0c00 1000 0104 0000 000000 a8 0100"
    reply = exchange(plc, h("".join(one.format(serial) for serial in (1, 2, 3)).replace(" ", "")), 51)
    check("pipelined 4E requests are answered in order",
          len(reply) == 51 and [reply[2], reply[19], reply[36]] == [1, 2, 3], reply)


def ascii_3e(plc):
    reply = exchange(plc, b"500000FF03FF00000C001001010000")
    check("ASCII 0101 answers name and code",
          len(reply) == 42 and reply[:22] == b"D00000FF03FF0000180000", reply)
    reply = exchange(plc, b"500000FF03FF000018001004010000D*0009030002")
    check("ASCII reads D903 and D904", len(reply) == 30 and reply[:22] == b"D00000FF03FF00000C0000", reply)
    reply = exchange(plc, b"500000FF03FF00002400100401008000U000000G*0000250000001")
    check("ASCII 0401/0080 reads U0\\G25", len(reply) == 26 and reply[:22] == b"D00000FF03FF0000080000", reply)
    reply = exchange(plc, b"500000FF03FF000018001004010001SM0004000002")
    check("ASCII reads SM400 and SM401 as characters", reply == b"D00000FF03FF000006000010", reply)
    reply = exchange(plc, b"500000FF03FF000018001004010000D*0999990001")
    check("ASCII D99999: end code 4031H", reply == b"D00000FF03FF0000164031" + b"00FF03FF00" + b"04010000", reply)
    reply = exchange(plc, b"500000FF03FF000018001004010000D*00000x0001")
    check("ASCII that is no number: end code C050H", reply[18:22] == b"C050", reply)


def separate_clients(host, port):
    with connect(host, port) as half, connect(host, port) as other:
        half.sendall(h("500000ffff0300"))
        reply = exchange(other, h("500000ffff03000c00100001040000900100a90100"))
        check("a half-sent request of one client does not stop another", len(reply) == 13, reply)
        half.sendall(h("0c00100001040000900100a90100"))
        check("and is answered when it is complete", len(half.recv(4096)) == 13)
    with connect(host, port) as lost:
        lost.sendall(b"GET / HTTP/1.1\r\n\r\n")
        try:
            reply = lost.recv(4096)
        except ConnectionError:
            reply = b""
        check("what is no request closes the connection", reply == b"", reply)


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("host")
    parser.add_argument("port", type=int)
    parser.add_argument("--remote", action="store_true", help="pause the CPU and let it run again")
    arguments = parser.parse_args()
    try:
        for conversation in (binary_3e, own_buffer, device_points, binary_errors, binary_4e, ascii_3e,
                             *([remote_pause] if arguments.remote else [])):
            with connect(arguments.host, arguments.port) as plc:
                conversation(plc)
        separate_clients(arguments.host, arguments.port)
    except OSError as error:
        print(f"FAIL  {arguments.host}:{arguments.port}: {error}")
        return 1
    print(f"{failures} failed" if failures else "all held")
    return 1 if failures else 0


if __name__ == "__main__":
    sys.exit(main())
