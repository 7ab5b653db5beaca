"""Devices and buffer memory as Python sequences: plc.d[100], plc.y[1:5], plc.g[0].signed[10000]."""
from __future__ import annotations

import struct
from typing import Generic, Protocol, Sequence, TypeVar, overload

from .connection import CpuConnection
from .mc import Device

Number = TypeVar("Number", int, float)
Index = int | str


class WordMemory(Protocol):
    """Words somewhere in a PLC."""

    name: str

    def number(self, index: Index) -> int: ...
    def read(self, first: int, count: int) -> list[int]: ...
    def write(self, first: int, words: Sequence[int]) -> None: ...


def _span(name: str, wanted: slice, number: "_Numbers") -> tuple[int, int]:
    if wanted.start is None or wanted.stop is None or wanted.step not in (None, 1):
        raise IndexError(f"{name}: a range has a first number and one behind its last, for example {name}[0:4]")
    first, behind = number(wanted.start), number(wanted.stop)
    if first > behind:
        raise IndexError(f"{name}: the range ends at {behind}, before it begins at {first}")
    return first, behind - first


class _Numbers(Protocol):
    def __call__(self, index: Index) -> int: ...


def _number(name: str, base: int, index: Index) -> int:
    try:
        number = int(index, base) if isinstance(index, str) else index.__index__()
    except (ValueError, AttributeError):
        kind = "hexadecimal" if base == 16 else "octal" if base == 8 else "decimal"
        raise IndexError(f"{name}: {index!r} is no number; expected an int, or a string that is {kind}") from None
    if number < 0:
        raise IndexError(f"{name}: {index!r} is below 0")
    return number


class Values(Generic[Number]):
    """Numbers of one kind in words: what `signed`, `double` and the like of a memory are."""

    def __init__(self, memory: WordMemory, letter: str, kind: type[Number], low: int = 0, high: int = 0) -> None:
        self._memory, self._letter, self._low, self._high = memory, letter, low, high
        self._kind: type[Number] = kind
        self._words = struct.calcsize("<" + letter) // 2

    @overload
    def __getitem__(self, index: Index) -> Number: ...
    @overload
    def __getitem__(self, index: slice) -> list[Number]: ...
    def __getitem__(self, index: Index | slice) -> Number | list[Number]:
        if isinstance(index, slice):
            first, words = _span(self._memory.name, index, self._memory.number)
            if words % self._words != 0:
                raise IndexError(f"{self._memory.name}: {words} words do not hold values of {self._words} words each")
            return self._read(first, words // self._words)
        return self._read(self._memory.number(index), 1)[0]

    @overload
    def __setitem__(self, index: Index, value: Number) -> None: ...
    @overload
    def __setitem__(self, index: slice, value: Sequence[Number]) -> None: ...
    def __setitem__(self, index: Index | slice, value: Number | Sequence[Number]) -> None:
        if isinstance(index, slice):
            first, words = _span(self._memory.name, index, self._memory.number)
            if not isinstance(value, Sequence) or len(value) * self._words != words:
                raise ValueError(f"{self._memory.name}: {words} words are written with other than {words // self._words} values")
            values: Sequence[Number] = value
        else:
            if isinstance(value, Sequence):
                raise TypeError(f"{self._memory.name}[{index!r}] is one value; a range takes several")
            first, values = self._memory.number(index), [value]
        packed = b"".join(self._packed(each, first + i * self._words) for i, each in enumerate(values))
        self._memory.write(first, struct.unpack(f"<{len(packed) // 2}H", packed))

    def _packed(self, value: Number, number: int) -> bytes:
        if self._kind is float:
            return struct.pack("<f", value)
        value = int(value)
        if not self._low <= value <= self._high:
            raise ValueError(f"{self._memory.name}{number}: {value} is beyond {self._low} to {self._high}")
        size = 2 * self._words
        return (value & (1 << 8 * size) - 1).to_bytes(size, "little")

    def _read(self, first: int, count: int) -> list[Number]:
        words = self._memory.read(first, count * self._words)
        return list(struct.unpack(f"<{count}{self._letter}", struct.pack(f"<{len(words)}H", *words)))


class Words(Values[int]):
    """Words, 0 to 65535 when they are read; -32768 to 65535 can be written."""

    def __init__(self, memory: WordMemory) -> None:
        super().__init__(memory, "H", int, -32768, 65535)
        #: Words as -32768 to 32767.
        self.signed: Values[int] = Values(memory, "h", int, -32768, 65535)
        #: Two words each, the low one first, without and with a sign.
        self.double: Values[int] = Values(memory, "I", int, -(1 << 31), (1 << 32) - 1)
        self.signed_double: Values[int] = Values(memory, "i", int, -(1 << 31), (1 << 32) - 1)
        #: Two words each, the low one first: REAL.
        self.real: Values[float] = Values(memory, "f", float)


class DeviceWords:
    """A word device of the CPU."""

    def __init__(self, client: CpuConnection, device: Device) -> None:
        self.name = device.name
        self._client, self._device = client, device

    def number(self, index: Index) -> int:
        return _number(self.name, self._device.base, index)

    def read(self, first: int, count: int) -> list[int]:
        return self._client.read_words(self._device, first, count)

    def write(self, first: int, words: Sequence[int]) -> None:
        self._client.write_words(self._device, first, words)


class BufferWords:
    """Buffer memory of a module."""

    def __init__(self, client: CpuConnection, unit: int) -> None:
        self.name = f"U{unit:X}\\G"
        self._client, self._unit = client, unit

    def number(self, index: Index) -> int:
        return _number(self.name, 10, index)

    def read(self, first: int, count: int) -> list[int]:
        return self._client.read_buffer(self._unit, first, count)

    def write(self, first: int, words: Sequence[int]) -> None:
        self._client.write_buffer(self._unit, first, words)


class Bits:
    """A bit device: True and False."""

    def __init__(self, client: CpuConnection, device: Device) -> None:
        self._client, self._device = client, device

    def _number(self, index: Index) -> int:
        return _number(self._device.name, self._device.base, index)

    @overload
    def __getitem__(self, index: Index) -> bool: ...
    @overload
    def __getitem__(self, index: slice) -> list[bool]: ...
    def __getitem__(self, index: Index | slice) -> bool | list[bool]:
        if isinstance(index, slice):
            first, count = _span(self._device.name, index, self._number)
            return self._client.read_bits(self._device, first, count)
        return self._client.read_bits(self._device, self._number(index), 1)[0]

    @overload
    def __setitem__(self, index: Index, value: bool) -> None: ...
    @overload
    def __setitem__(self, index: slice, value: Sequence[bool]) -> None: ...
    def __setitem__(self, index: Index | slice, value: bool | Sequence[bool]) -> None:
        if isinstance(index, slice):
            first, count = _span(self._device.name, index, self._number)
            if not isinstance(value, Sequence) or len(value) != count:
                raise ValueError(f"{self._device.name}: {count} points are written with other than {count} values")
            return self._client.write_bits(self._device, first, value)
        if isinstance(value, Sequence):
            raise TypeError(f"{self._device.name}[{index!r}] is one point; a range takes several")
        self._client.write_bits(self._device, self._number(index), [value])


class BufferMemories:
    """plc.g[unit] is the buffer memory of the module whose head I/O number is 16 * unit."""

    def __init__(self, client: CpuConnection) -> None:
        self._client = client

    def __getitem__(self, unit: int) -> Words:
        return Words(BufferWords(self._client, unit))
