"""MC protocol, binary code, 1E frames (A-compatible: FX3U-ENET, E71), over TCP. Frames: SH-080008, JY997D14101."""
from __future__ import annotations

import struct
from typing import Sequence

from .errors import EndCode1eError, PlcError
from .mc import Device, McConnection, shown_number, word_of

# As much as an FX3 takes in one request; a unit of buffer memory transfer is a byte, at most 256.
MOST_WORDS = 64
MOST_BITS = 160
MOST_BUFFER_WORDS = 64

_NAMES = ("X", "Y", "M", "L", "F", "B", "S", "D", "W", "R", "TS", "TC", "TN", "CS", "CC", "CN")
_READ_BITS, _READ_WORDS, _WRITE_BITS, _WRITE_WORDS = 0x00, 0x01, 0x02, 0x03
_READ_BUFFER, _WRITE_BUFFER, _RUN, _STOP, _MODEL = 0x0E, 0x0F, 0x13, 0x14, 0x15
_CPU_REFUSES = 0x5B
_MODELS = {0xF3: "FX3U", 0xF4: "FX3G"}
_FIRST_WIDE_COUNTER = 200


class Mc1eClient(McConnection):
    """As McClient, with shorter requests. 1E frames have no length and no number: a connection whose answer was not as expected
    is closed."""

    def read_words(self, device: Device, first: int, count: int) -> list[int]:
        words: list[int] = []
        points = 16 if device.is_bit else 1
        most = MOST_BITS // 16 if device.is_bit else MOST_WORDS
        while len(words) < count:
            number = min(count - len(words), most)
            place = first + points * len(words)
            data = self._ask(_READ_WORDS, _device(device, place, number), f"read {device.name}{shown_number(device, place)}",
                             2 * number)
            words += struct.unpack(f"<{number}H", data)
        return words

    def write_words(self, device: Device, first: int, words: Sequence[int]) -> None:
        values = [word_of(word, device.name, first + i) for i, word in enumerate(words)]
        points = 16 if device.is_bit else 1
        most = MOST_BITS // 16 if device.is_bit else MOST_WORDS
        for done in range(0, len(values), most):
            some = values[done:done + most]
            place = first + points * done
            self._ask(_WRITE_WORDS, _device(device, place, len(some)) + struct.pack(f"<{len(some)}H", *some),
                      f"write {device.name}{shown_number(device, place)}", 0)

    def read_bits(self, device: Device, first: int, count: int) -> list[bool]:
        bits: list[bool] = []
        while len(bits) < count:
            number = min(count - len(bits), MOST_BITS)
            place = first + len(bits)
            data = self._ask(_READ_BITS, _bits(device, place, number), f"read {device.name}{shown_number(device, place)}",
                             (number + 1) // 2)
            bits += [bool(data[i // 2] >> (0 if i % 2 else 4) & 1) for i in range(number)]
        return bits

    def write_bits(self, device: Device, first: int, bits: Sequence[bool]) -> None:
        for done in range(0, len(bits), MOST_BITS):
            some = [bool(bit) for bit in bits[done:done + MOST_BITS]]
            pairs = [*some, False] if len(some) % 2 else some
            values = bytes(high << 4 | low for high, low in zip(pairs[::2], pairs[1::2]))
            self._ask(_WRITE_BITS, _bits(device, first + done, len(some)) + values,
                      f"write {device.name}{shown_number(device, first + done)}", 0)

    def read_buffer(self, unit: int, first: int, count: int) -> list[int]:
        """Buffer memory of a module, by its number. An FX3U-ENET refuses it (50H), an FX5 does not."""
        words: list[int] = []
        while len(words) < count:
            number = min(count - len(words), MOST_BUFFER_WORDS)
            place = first + len(words)
            data = self._ask(_READ_BUFFER, _buffer(unit, place, number), f"read BFM #{place} of unit {unit}", 2 * number)
            words += struct.unpack(f"<{number}H", data)
        return words

    def write_buffer(self, unit: int, first: int, words: Sequence[int]) -> None:
        values = [word_of(word, f"U{unit:X}\\G", first + i) for i, word in enumerate(words)]
        for done in range(0, len(values), MOST_BUFFER_WORDS):
            some = values[done:done + MOST_BUFFER_WORDS]
            self._ask(_WRITE_BUFFER, _buffer(unit, first + done, len(some)) + struct.pack(f"<{len(some)}H", *some),
                      f"write BFM #{first + done} of unit {unit}", 0)

    def remote_run(self) -> None:
        self._ask(_RUN, b"", "remote RUN", 0)

    def remote_stop(self) -> None:
        self._ask(_STOP, b"", "remote STOP", 0)

    def remote_pause(self) -> None:
        raise PlcError("remote PAUSE: 1E frames have none")

    def cpu_name(self) -> str:
        """1E frames bring a number, not a name; one that is not known is shown as it is."""
        code = self._ask(_MODEL, b"", "read CPU model", 2)[0]
        return _MODELS.get(code, f"CPU code {code:02X}H")

    def _ask(self, command: int, data: bytes, what: str, length: int) -> bytes:
        def answer() -> bytes:
            head = self.receive(2, what)
            if head[0] != command | 0x80:
                raise PlcError(f"{what}: the answer is no frame that was expected but starts with {head.hex(' ')}")
            if head[1] == _CPU_REFUSES:
                raise EndCode1eError(head[1], self.receive(2, what)[0], what)
            if head[1] != 0:
                raise EndCode1eError(head[1], 0, what)
            return self.receive(length, what)

        no_time_limit = b"\0\0"
        return self.exchange(bytes((command, 0xFF)) + no_time_limit + data, answer, what)


def _device(device: Device, number: int, points: int) -> bytes:
    if device.name not in _NAMES:
        raise ValueError(f"1E frames do not know {device.name}; they know {' '.join(_NAMES)}")
    if not 0 <= number < 1 << 32:
        raise ValueError(f"{number} is no device number; expected 0 to 4294967295")
    if device.name == "CN" and number + points > _FIRST_WIDE_COUNTER:
        raise ValueError("C200 to C255 hold 32 bits, which 1E frames bring in another way; read them over 3E frames")
    name = device.name.ljust(2).encode("ascii")
    return struct.pack("<I", number) + name[::-1] + bytes((points & 0xFF, 0))


def _bits(device: Device, number: int, points: int) -> bytes:
    if not device.is_bit:
        raise ValueError(f"{device.name} holds words, not bits")
    return _device(device, number, points)


def _buffer(unit: int, address: int, words: int) -> bytes:
    """Addresses and lengths count bytes."""
    if not 0 <= unit <= 0xFF:
        raise ValueError(f"unit {unit}: expected 0 to 255")
    if not 0 <= address < 1 << 23:
        raise ValueError(f"{address} is no address of buffer memory; expected 0 to 8388607")
    return (2 * address).to_bytes(3, "little") + bytes((2 * words & 0xFF, unit, 0))
