"""MC protocol, 3E frame, binary code: a PLC's devices and the buffer memory of its modules over TCP.

    plc = McClient("127.0.0.1", 5007)
    plc.write("D100", [1, 2, 3])              # words
    plc.read("D100", 3)                       # [1, 2, 3]
    plc.write_bits("Y1", [True])              # bits
    plc.read_bits("X10", 2)                   # [False, False]
    plc.read(r"U4\\G25")                       # buffer memory of the module with head address X/Y40

The CPU's Ethernet port must be open for it: data code binary, and writing in RUN allowed. Standard library only; copy
this file as it is. Frames and end codes: MELSEC Communication Protocol Reference Manual (SH-080008).
"""
import re
import socket
import struct

# Device: (code, number base, is a bit device)
DEVICES = {
    "SM": (0x91, 10, True), "SD": (0xA9, 10, False), "X": (0x9C, 16, True), "Y": (0x9D, 16, True),
    "M": (0x90, 10, True), "L": (0x92, 10, True), "B": (0xA0, 16, True), "D": (0xA8, 10, False),
    "W": (0xB4, 16, False), "R": (0xAF, 10, False), "ZR": (0xB0, 10, False),
}
MOST_WORDS, MOST_BITS = 960, 7168  # of one request

END_CODES = {
    0x4031: "the device number is beyond the last one",
    0x4041: "the address is beyond the module's buffer memory",
    0x4043: "there is no intelligent function module at this head address",
    0xC051: "too many or too few bits in one request",
    0xC052: "too many or too few words in one request",
    0xC056: "the device number is beyond the last one",
    0xC059: "the CPU does not know this command or subcommand",
    0xC05B: "the CPU does not know this device",
    0xC05C: "bits of a word device, or another mistake in the request's contents",
    0xC05F: "the request is for another network or station",
    0xC060: "bit data other than 0 and 1",
    0xC061: "the length does not fit the request",
}


class McError(Exception):
    """The PLC refused a request; `end_code` is its reason."""

    def __init__(self, end_code, request):
        meaning = END_CODES.get(end_code, "see the CPU's manual")
        super().__init__(f"{request}: end code {end_code:04X}H: {meaning}")
        self.end_code = end_code


class McClient:
    def __init__(self, host, port, timeout=5.0):
        self._socket = socket.create_connection((host, port), timeout)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self):
        self._socket.close()

    def __enter__(self):
        return self

    def __exit__(self, *_):
        self.close()

    def read(self, device, count=1):
        """`count` words from `device` on, as numbers 0 to 65535."""
        self._check(device, count, MOST_WORDS)
        subcommand, place = _words(device)
        data = self._request(0x0401, subcommand, place + struct.pack("<H", count), f"read {device}")
        return list(struct.unpack(f"<{count}H", self._sized(data, 2 * count, device)))

    def write(self, device, words):
        """Writes words; numbers from -32768 to 65535."""
        self._check(device, len(words), MOST_WORDS)
        subcommand, place = _words(device)
        values = struct.pack(f"<{len(words)}H", *(word & 0xFFFF for word in words))
        self._request(0x1401, subcommand, place + struct.pack("<H", len(words)) + values, f"write {device}")

    def read_bits(self, device, count=1):
        """`count` bits from `device` on, as True and False."""
        self._check(device, count, MOST_BITS)
        data = self._request(0x0401, 1, _bits(device) + struct.pack("<H", count), f"read {device}")
        data = self._sized(data, (count + 1) // 2, device)
        return [bool(data[i // 2] >> (0 if i % 2 else 4) & 1) for i in range(count)]

    def write_bits(self, device, bits):
        self._check(device, len(bits), MOST_BITS)
        pairs = [*bits, False] if len(bits) % 2 else list(bits)
        values = bytes(bool(a) << 4 | bool(b) for a, b in zip(pairs[::2], pairs[1::2]))
        self._request(0x1401, 1, _bits(device) + struct.pack("<H", len(bits)) + values, f"write {device}")

    @staticmethod
    def _check(device, count, most):
        if not 1 <= count <= most:
            raise ValueError(f"{device}: {count} points in one request, expected 1 to {most}")

    @staticmethod
    def _sized(data, length, device):
        if len(data) != length:
            raise ConnectionError(f"{device}: {len(data)} bytes of data in the reply, expected {length}")
        return data

    def _request(self, command, subcommand, data, what):
        # network 0, PC FFH, module I/O 03FFH, station 0: the CPU this port belongs to; timer 16 x 250 ms
        body = struct.pack("<HHH", 0x0010, command, subcommand) + data
        self._socket.sendall(bytes.fromhex("5000 00 FF FF03 00") + struct.pack("<H", len(body)) + body)
        head = self._receive(9)
        if head[:2] != b"\xD0\x00":
            raise ConnectionError(f"{what}: the answer is no binary 3E frame but starts with {head.hex(' ')}")
        reply = self._receive(struct.unpack("<H", head[7:9])[0])
        if len(reply) < 2:
            raise ConnectionError(f"{what}: the answer has no end code")
        end_code = struct.unpack("<H", reply[:2])[0]
        if end_code != 0:
            raise McError(end_code, what)
        return reply[2:]

    def _receive(self, length):
        data = b""
        while len(data) < length:
            piece = self._socket.recv(length - len(data))
            if not piece:
                raise ConnectionError("the PLC closed the connection")
            data += piece
        return data


def _plain(device, want_bits):
    match = re.fullmatch(r"([A-Z]+?)([0-9][0-9A-F]*)", device.upper())
    if not match or match[1] not in DEVICES:
        raise ValueError(rf"{device!r} is no device; expected for example D100, M0, X1F or U0\G25")
    code, base, is_bit = DEVICES[match[1]]
    if want_bits and not is_bit:
        raise ValueError(f"{device} is a word, not a bit")
    try:
        number = int(match[2], base)
    except ValueError:
        raise ValueError(f"{device}: the number of {match[1]} is decimal") from None
    return struct.pack("<I", number)[:3] + bytes([code])


def _bits(device):
    return _plain(device, want_bits=True)


def _words(device):
    """Subcommand and device specification."""
    module = re.fullmatch(r"U([0-9A-F]+)[\\/]G([0-9]+)", device.upper())
    if not module:
        return 0x0000, _plain(device, want_bits=False)
    # extension specification: the module's head address without its last digit, F8H = buffer memory
    return 0x0080, (bytes(2) + struct.pack("<I", int(module[2]))[:3] + b"\xAB" + bytes(2)
                    + struct.pack("<H", int(module[1], 16)) + b"\xF8")
