"""MC protocol, binary code, 3E and 4E frames, over TCP. Frames and end codes: SH-080008."""
from __future__ import annotations

import socket
import struct
from types import TracebackType
from typing import Callable, NamedTuple, Sequence, TypeVar

from .errors import EndCodeError, PlcError


class Device(NamedTuple):
    """A device of a CPU, as its manuals name it."""

    name: str
    code: int
    is_bit: bool
    base: int  # of its numbers as people write them


DEVICES = {
    device.name: device
    for device in (
        Device("X", 0x9C, True, 16), Device("Y", 0x9D, True, 16), Device("M", 0x90, True, 10),
        Device("L", 0x92, True, 10), Device("F", 0x93, True, 10), Device("V", 0x94, True, 10),
        Device("B", 0xA0, True, 16), Device("SB", 0xA1, True, 16), Device("SM", 0x91, True, 10),
        Device("S", 0x98, True, 10), Device("TS", 0xC1, True, 10), Device("TC", 0xC0, True, 10),
        Device("STS", 0xC7, True, 10), Device("STC", 0xC6, True, 10), Device("CS", 0xC4, True, 10),
        Device("CC", 0xC3, True, 10), Device("D", 0xA8, False, 10), Device("W", 0xB4, False, 16),
        Device("SW", 0xB5, False, 16), Device("SD", 0xA9, False, 10), Device("R", 0xAF, False, 10),
        Device("ZR", 0xB0, False, 10), Device("Z", 0xCC, False, 10), Device("TN", 0xC2, False, 10),
        Device("STN", 0xC8, False, 10), Device("CN", 0xC5, False, 10), Device("RD", 0x2C, False, 10),
        Device("U3E0\\HG", 0x2E, False, 10),
    )
}

Connection = TypeVar("Connection", bound="McConnection")

MOST_WORDS = 960  # of one request
MOST_BITS = 7168


class McConnection:
    """A TCP connection to a port of a PLC."""

    def __init__(self, host: str, port: int, timeout: float) -> None:
        self._place = f"{host}:{port}"
        try:
            self._socket: socket.socket | None = socket.create_connection((host, port), timeout)
        except OSError as error:
            raise PlcError(f"{self._place}: {error.strerror or error}") from error
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def close(self) -> None:
        if self._socket is not None:
            self._socket.close()
        self._socket = None

    def __enter__(self: Connection) -> Connection:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def exchange(self, request: bytes, answer: Callable[[], bytes], what: str) -> bytes:
        """Sends a request; what `answer` makes of the bytes that it receives. `what` names it in errors."""
        if self._socket is None:
            raise PlcError(f"{what}: the connection to {self._place} is closed")
        try:
            self._socket.sendall(request)
            return answer()
        except OSError as error:
            self.close()  # a late answer would pass for that of the next request
            raise PlcError(f"{what}: {self._place}: {error.strerror or error}") from error
        except EndCodeError:
            raise
        except BaseException:
            self.close()
            raise

    def receive(self, length: int, what: str) -> bytes:
        """So many bytes of the answer."""
        assert self._socket is not None
        data = b""
        while len(data) < length:
            piece = self._socket.recv(length - len(data))
            if not piece:
                raise PlcError(f"{what}: {self._place} closed the connection")
            data += piece
        return data


class McClient(McConnection):
    """One connection. Any number of points: several requests where one cannot hold them."""

    def __init__(self, host: str = "127.0.0.1", port: int = 5007, *, timeout: float = 5.0, frame: str = "3E") -> None:
        """`timeout` in seconds, to connect and for each answer; `frame` is "3E" or "4E"."""
        if frame not in ("3E", "4E"):
            raise ValueError(f"frame {frame!r}: expected '3E' or '4E'")
        self._is_4e = frame == "4E"
        self._serial = 0
        super().__init__(host, port, timeout)

    def read_words(self, device: Device, first: int, count: int) -> list[int]:
        """Words 0 to 65535; of a bit device 16 points each."""
        return self._read_words(*_words(device, first), device.name, first, count, 16 if device.is_bit else 1)

    def write_words(self, device: Device, first: int, words: Sequence[int]) -> None:
        """Numbers from -32768 to 65535."""
        self._write_words(*_words(device, first), device.name, first, words, 16 if device.is_bit else 1)

    def read_buffer(self, unit: int, first: int, count: int) -> list[int]:
        """Buffer memory of the module whose head I/O number is 16 * unit: U1\\G0 is unit 1."""
        return self._read_words(0x0080, _buffer(unit, first), f"U{unit:X}\\G", first, count, 1)

    def write_buffer(self, unit: int, first: int, words: Sequence[int]) -> None:
        self._write_words(0x0080, _buffer(unit, first), f"U{unit:X}\\G", first, words, 1)

    def read_bits(self, device: Device, first: int, count: int) -> list[bool]:
        bits: list[bool] = []
        while len(bits) < count:
            number = min(count - len(bits), MOST_BITS)
            what = f"read {device.name}{shown_number(device, first + len(bits))}"
            place = _bit_device(device, first + len(bits))
            data = self._ask(0x0401, 0x0001, place + struct.pack("<H", number), what, (number + 1) // 2)
            bits += [bool(data[i // 2] >> (0 if i % 2 else 4) & 1) for i in range(number)]
        return bits

    def write_bits(self, device: Device, first: int, bits: Sequence[bool]) -> None:
        for done in range(0, len(bits), MOST_BITS):
            some = [bool(bit) for bit in bits[done:done + MOST_BITS]]
            pairs = [*some, False] if len(some) % 2 else some
            values = bytes(high << 4 | low for high, low in zip(pairs[::2], pairs[1::2]))
            what = f"write {device.name}{shown_number(device, first + done)}"
            place = _bit_device(device, first + done)
            self._ask(0x1401, 0x0001, place + struct.pack("<H", len(some)) + values, what, 0)

    def remote_run(self) -> None:
        """Forced when another client stopped the CPU; nothing is cleared."""
        self._ask(0x1001, 0x0000, bytes((3, 0, 0, 0)), "remote RUN", 0)

    def remote_stop(self) -> None:
        self._ask(0x1002, 0x0000, bytes((1, 0)), "remote STOP", 0)

    def remote_pause(self) -> None:
        self._ask(0x1003, 0x0000, bytes((3, 0)), "remote PAUSE", 0)

    def cpu_name(self) -> str:
        return self._ask(0x0101, 0x0000, b"", "read CPU model", 18)[:16].decode("ascii", "replace").rstrip()

    def _read_words(self, subcommand: int, place: bytes, name: str, first: int, count: int, points: int) -> list[int]:
        words: list[int] = []
        while len(words) < count:
            number = min(count - len(words), MOST_WORDS)
            what = f"read {number} words from {name}, {points * len(words)} behind {first}" if words else f"read {name}{first}"
            data = self._ask(0x0401, subcommand, _moved(place, subcommand, points * len(words))
                             + struct.pack("<H", number), what, 2 * number)
            words += struct.unpack(f"<{number}H", data)
        return words

    def _write_words(self, subcommand: int, place: bytes, name: str, first: int, words: Sequence[int], points: int) -> None:
        values = [word_of(word, name, first + i) for i, word in enumerate(words)]
        for done in range(0, len(values), MOST_WORDS):
            some = values[done:done + MOST_WORDS]
            self._ask(0x1401, subcommand, _moved(place, subcommand, points * done)
                      + struct.pack(f"<H{len(some)}H", len(some), *some), f"write {name}{first + points * done}", 0)

    def _ask(self, command: int, subcommand: int, data: bytes, what: str, length: int) -> bytes:
        reply = self.request(command, subcommand, data, what)
        if len(reply) != length:
            self.close()
            raise PlcError(f"{what}: {len(reply)} bytes of data in the reply, expected {length}")
        return reply

    def request(self, command: int, subcommand: int, data: bytes, what: str = "request") -> bytes:
        """Any command; the data of its reply. `what` names it in errors."""
        # network 0, PC FFH, module I/O 03FFH, station 0: the CPU this port belongs to; timer 16 x 250 ms
        body = struct.pack("<HHH", 0x0010, command, subcommand) + data
        self._serial = (self._serial + 1) & 0xFFFF
        head = struct.pack("<HHH", 0x0054, self._serial, 0) if self._is_4e else struct.pack("<H", 0x0050)
        return self.exchange(head + bytes.fromhex("00FFFF0300") + struct.pack("<H", len(body)) + body, lambda: self._reply(what),
                             what)

    def _reply(self, what: str) -> bytes:
        size = 13 if self._is_4e else 9
        head = self.receive(size, what)
        expected = struct.pack("<HHH", 0x00D4, self._serial, 0) if self._is_4e else struct.pack("<H", 0x00D0)
        if not head.startswith(expected):
            raise PlcError(f"{what}: the answer is no frame that was expected but starts with {head.hex(' ')}")
        reply = self.receive(struct.unpack("<H", head[-2:])[0], what)
        if len(reply) < 2:
            raise PlcError(f"{what}: the answer has no end code")
        end_code = int.from_bytes(reply[:2], "little")
        if end_code != 0:
            raise EndCodeError(end_code, what)
        return reply[2:]


def shown_number(device: Device, number: int) -> str:
    """As people write it."""
    return f"{number:X}" if device.base == 16 else f"{number:o}" if device.base == 8 else str(number)


def _number(number: int) -> bytes:
    if not 0 <= number < 1 << 24:
        raise ValueError(f"{number} is no device number or address; expected 0 to 16777215")
    return number.to_bytes(3, "little")


def _device(device: Device, number: int) -> bytes:
    return _number(number) + bytes((device.code,))


def _words(device: Device, number: int) -> tuple[int, bytes]:
    """Subcommand and place; CPU buffer memory has the extended device specification alone."""
    if device.code != 0x2E:
        return 0x0000, _device(device, number)
    return 0x0080, bytes(2) + _device(device, number) + bytes(2) + b"\xE0\x03\xFA"


def _bit_device(device: Device, number: int) -> bytes:
    if not device.is_bit:
        raise ValueError(f"{device.name} holds words, not bits")
    return _device(device, number)


def _buffer(unit: int, address: int) -> bytes:
    if not 0 <= unit <= 0xFF:
        raise ValueError(f"unit {unit}: expected 0 to 255, the head I/O number divided by 16")
    return bytes(2) + _number(address) + b"\xAB" + bytes(2) + struct.pack("<H", unit) + b"\xF8"


def _moved(place: bytes, subcommand: int, points: int) -> bytes:
    """The device so many points further."""
    at = 2 if subcommand == 0x0080 else 0
    return place[:at] + _number(int.from_bytes(place[at:at + 3], "little") + points) + place[at + 3:]


def word_of(word: int, name: str, number: int) -> int:
    """The 16 bits of a number from -32768 to 65535."""
    if not -32768 <= word <= 65535:
        raise ValueError(f"{name}{number}: {word} is no word; expected -32768 to 65535")
    return word & 0xFFFF
