"""Device files: EDS and DCF [CiA 306], read forgivingly, and written with other values.

    file = canopus.DeviceFile("io-block.eds")
    print(file.device.product_name, file["1017:00"].default)
    for pdo in file.tpdos(node=2):
        print(f"{pdo.cob_id:X}", [entry.name for entry, bits in pdo.mapping])
    file.write_dcf("station2.dcf", node=2, values={"1017:00": 500})
"""
from __future__ import annotations

import dataclasses
import itertools
import os
import pathlib
import re
import struct
from typing import Iterator, Mapping, NamedTuple

from canopus_plc.errors import PlantError

from . import _core
from .picture import _table

#: A value of an object: by its type a number, a boolean, a text, or bytes.
ObjectValue = int | float | bool | str | bytes
#: "6000:01", (0x6000, 1), or 0x1017 for sub-index 00H.
ObjectName = str | int | tuple[int, int]


class DeviceFileError(PlantError):
    """A device file cannot be read, has no such object, or a value does not fit."""


class Problem(NamedTuple):
    """Something that is not as it should be, and was repaired."""

    severity: str  #: "loss": something of the file is not in it, "warning", or "note": unusual and harmless
    line: int  #: from 1
    column: int  #: from 1; 0: the whole line
    message: str


@dataclasses.dataclass(frozen=True)
class FileInfo:
    """[FileInfo]; empty or 0 where the file says nothing."""

    file_name: str
    version: int
    revision: int
    eds_version: str  #: "4.0"
    description: str
    creation_time: str  #: hh:mmAM
    creation_date: str  #: MM-DD-YYYY
    created_by: str
    modification_time: str
    modification_date: str
    modified_by: str
    last_eds: str  #: of a DCF: the EDS it was made from


@dataclasses.dataclass(frozen=True)
class DeviceInfo:
    """[DeviceInfo]. None: the file does not say."""

    vendor_name: str
    product_name: str
    order_code: str
    vendor_number: int | None
    product_number: int | None
    revision_number: int | None
    bit_rates: tuple[int, ...]  #: that are supported, in bit/s
    granularity: int  #: bits of a mapped object; 0: the mapping is fixed
    lss: bool


@dataclasses.dataclass(frozen=True)
class Commissioning:
    """[DeviceComissioning] of a DCF."""

    node: int | None  #: 1 to 127
    node_name: str
    bit_rate: int  #: bit/s; 0: not given
    net_number: int
    network_name: str


_INTEGER = re.compile(r"(INTEGER|UNSIGNED)(\d+)")
_REALS = {"REAL32": "<f", "REAL64": "<d"}


@dataclasses.dataclass(frozen=True)
class ObjectEntry:
    """A sub-index of an object."""

    index: int
    sub: int
    name: str
    type: str  #: as CiA 301 names it: "UNSIGNED16"
    access: str  #: ro wo rw rwr rww const
    bits: int  #: length as mapped into a PDO; 0: variable
    rpdo_mappable: bool
    tpdo_mappable: bool
    low: int | float | None  #: LowLimit; None: that of the type
    high: int | float | None
    adds_node_id: bool  #: the node-ID is added to the default ($NODEID+...)
    configured: bool  #: a DCF gives it a ParameterValue
    denotation: str
    default: ObjectValue  #: the default or ParameterValue, without the node-ID

    def __str__(self) -> str:
        return f"{self.index:04X}:{self.sub:02X}"

    def encode(self, value: ObjectValue) -> bytes:
        """As an SDO carries it. DeviceFileError when it does not fit the type or exceeds the file's limits."""
        if isinstance(value, (bytes, bytearray)):
            if self.bits and len(value) != (self.bits + 7) // 8:
                raise DeviceFileError(f"{self}: {_counted(len(value), 'byte')}; {self.type} has {(self.bits + 7) // 8}")
            return bytes(value)
        integer = _INTEGER.fullmatch(self.type)
        if integer or self.type == "BOOLEAN":
            return self._encode_integer(value, integer is not None and integer[1] == "INTEGER")
        if self.type in _REALS:
            if not isinstance(value, (int, float)):
                raise DeviceFileError(f"{self}: {value!r}; expected a number")
            self._check_limits(value)
            try:
                return struct.pack(_REALS[self.type], value)
            except OverflowError as error:
                raise DeviceFileError(f"{self}: {value!r} does not fit {self.type}") from error
        if isinstance(value, str) and self.type in ("VISIBLE_STRING", "UNICODE_STRING"):
            return value.encode("utf-8" if self.type == "VISIBLE_STRING" else "utf-16-le")
        raise DeviceFileError(f"{self}: {value!r}; {self.type} takes {'str' if self.type.endswith('STRING') else 'bytes'}")

    def _encode_integer(self, value: ObjectValue, is_signed: bool) -> bytes:
        if not isinstance(value, int):
            raise DeviceFileError(f"{self}: {value!r}; expected an integer")
        low, high = (-(1 << self.bits - 1), (1 << self.bits - 1) - 1) if is_signed else (0, (1 << self.bits) - 1)
        if not low <= value <= high:
            raise DeviceFileError(f"{self}: {value} does not fit {self.type}: expected {low} to {high}")
        self._check_limits(value)
        return int(value).to_bytes((self.bits + 7) // 8, "little", signed=is_signed)

    def _check_limits(self, value: int | float) -> None:
        if self.low is not None and value < self.low:
            raise DeviceFileError(f"{self}: {value} is below the device file's limit {self.low}")
        if self.high is not None and value > self.high:
            raise DeviceFileError(f"{self}: {value} is above the device file's limit {self.high}")

    def decode(self, data: bytes) -> ObjectValue:
        """The value that an SDO carried. DeviceFileError when it is not as long as the type."""
        if self.bits and len(data) != (self.bits + 7) // 8:
            raise DeviceFileError(f"{self}: {_counted(len(data), 'byte')} came; {self.type} has {(self.bits + 7) // 8}")
        integer = _INTEGER.fullmatch(self.type)
        if integer:
            return int.from_bytes(data, "little", signed=integer[1] == "INTEGER")
        if self.type == "BOOLEAN":
            return data != b"\0"
        if self.type in _REALS:
            return float(struct.unpack(_REALS[self.type], data)[0])
        if self.type == "VISIBLE_STRING":
            return data.rstrip(b"\0").decode("utf-8", "replace")
        if self.type == "UNICODE_STRING":
            return data.decode("utf-16-le", "replace")
        return bytes(data)


class DeviceObject(Mapping[int, ObjectEntry]):
    """An object and its sub-indexes."""

    def __init__(self, file: DeviceFile, index: int, name: str, code: str, highest_sub: int) -> None:
        self._file, self.index, self.name = file, index, name
        self.code = code  #: VAR ARRAY RECORD DOMAIN
        self._highest = highest_sub

    def __getitem__(self, sub: int) -> ObjectEntry:
        entry = self._file._entry(self.index, sub)
        if entry is None:
            raise KeyError(sub)
        return entry

    def __iter__(self) -> Iterator[int]:
        return (sub for sub in range(self._highest + 1) if self._file._core.entry(self.index, sub) is not None)

    def __len__(self) -> int:
        return sum(1 for _ in self)

    def __repr__(self) -> str:
        return f"<object {self.index:04X}H {self.name!r}, {self.code}>"


class Pdo(NamedTuple):
    """A PDO as a device has it by default [CiA 301 7.5.2.35 to 38]."""

    number: int  #: from 1
    parameter: int  #: index of its communication parameter: 1400H..., 1800H...
    cob_id: int  #: 11 or 29 bits
    valid: bool  #: bit 31 of the COB-ID is 0
    transmission_type: int
    inhibit_time: float  #: in seconds
    event_time: float  #: in seconds; 0: none
    mapping: tuple[tuple[ObjectEntry | None, int], ...]  #: entry and bits, in the frame's order; None: a dummy, or no such object


class DeviceFile:
    """An EDS, DCF, XDD or XDC. `file["1018:01"]` is an entry; `file.objects` has every object by its index."""

    def __init__(self, path: str | os.PathLike[str], *, text: str | bytes | None = None) -> None:
        """`text` takes the place of the file. DeviceFileError when it cannot be read; whatever was repaired is in
        `problems`."""
        self.path = os.fspath(path)
        if text is None:
            try:
                text = pathlib.Path(path).read_bytes()
            except (OSError, ValueError) as error:
                raise DeviceFileError(f"{self.path}: cannot read it: {getattr(error, 'strerror', None) or error}") from error
        self._text = text.encode() if isinstance(text, str) else bytes(text)
        try:
            self._core = _core.NativeDeviceFile(self._text)
        except PlantError as error:
            raise DeviceFileError(f"{self.path}:{error}") from error
        #: What was repaired, worst first.
        self.problems: list[Problem] = [Problem(*problem) for problem in self._core.problems]
        self.info = FileInfo(**self._core.file_info)
        self.device = DeviceInfo(**self._core.device_info)
        commissioning = self._core.commissioning
        #: Of a DCF or XDC; None: the file is an EDS or XDD.
        self.commissioning: Commissioning | None = None if commissioning is None else Commissioning(**commissioning)
        #: By index, in order.
        self.objects: dict[int, DeviceObject] = {index: DeviceObject(self, index, name, code, highest)
                                                 for index, name, code, highest in self._core.objects}

    def _entry(self, index: int, sub: int) -> ObjectEntry | None:
        if not 0 <= index <= 0xFFFF or not 0 <= sub <= 0xFF:
            return None
        raw = self._core.entry(index, sub)
        if raw is None:
            return None
        entry = ObjectEntry(index, sub, *raw, default=b"")
        return dataclasses.replace(entry, default=entry.decode(self._core.default_value(index, sub, 0)))

    def find(self, name: ObjectName) -> ObjectEntry | None:
        """The entry, or None."""
        return self._entry(*_numbers(name))

    def __getitem__(self, name: ObjectName) -> ObjectEntry:
        """KeyError when there is none."""
        entry = self.find(name)
        if entry is None:
            raise KeyError("{:04X}:{:02X}".format(*_numbers(name)))
        return entry

    def __contains__(self, name: ObjectName) -> bool:
        return self.find(name) is not None

    def default(self, name: ObjectName, node: int) -> ObjectValue:
        """The default, or a DCF's ParameterValue, of a device with this node-ID."""
        if not 0 <= node <= 127:
            raise ValueError(f"node {node}: a node-ID is 1 to 127")
        entry = self[name]
        return entry.decode(self._core.default_value(entry.index, entry.sub, node))

    def rpdos(self, node: int) -> list[Pdo]:
        """RPDOs with a communication parameter, as a device with this node-ID has them by default."""
        return self._pdos(0x1400, node)

    def tpdos(self, node: int) -> list[Pdo]:
        """TPDOs, likewise."""
        return self._pdos(0x1800, node)

    def _pdos(self, first: int, node: int) -> list[Pdo]:
        return [self._pdo(index, index - first, node) for index in self.objects if first <= index < first + 0x200]

    def _number(self, index: int, sub: int, node: int) -> int:
        if self._entry(index, sub) is None:
            return 0
        value = self.default((index, sub), node)
        return value if isinstance(value, int) else 0

    def _pdo(self, index: int, number: int, node: int) -> Pdo:
        cob_id = self._number(index, 1, node)
        mapping: list[tuple[ObjectEntry | None, int]] = []
        for sub in range(1, min(self._number(index + 0x200, 0, node), 64) + 1):
            mapped = self._number(index + 0x200, sub, node)
            mapping.append((self._entry(mapped >> 16, mapped >> 8 & 0xFF), mapped & 0xFF))
        return Pdo(number + 1, index, cob_id & (0x1FFFFFFF if cob_id & 1 << 29 else 0x7FF), not cob_id & 1 << 31,
                   self._number(index, 2, node), self._number(index, 3, node) / 1e4, self._number(index, 5, node) / 1e3,
                   tuple(mapping))

    def edited(self, values: Mapping[ObjectName, ObjectValue], *, key: str = "DefaultValue") -> DeviceFile:
        """The same file with other values: every other line stays as it is. `key`: "DefaultValue", or "ParameterValue" as a DCF
        has it. An integer may be a text, too: "$NODEID+0x200". DeviceFileError when an object is missing or a value does not fit,
        or cannot stand in such a file."""
        from ._device_text import DeviceText
        text = DeviceText(self._text)
        for name, value in values.items():
            if name not in self:
                raise DeviceFileError("{}: no object {:04X}:{:02X}".format(self.path, *_numbers(name)))
            entry = self[name]
            text.set_value(entry, _value_text(entry, value), key)
        result = DeviceFile(self.path, text=text.bytes())
        for name, value in values.items():
            entry = self[name]
            is_formula = isinstance(value, str) and entry.bits != 0
            if name not in result or not is_formula and result._core.default_value(entry.index, entry.sub, 0) != entry.encode(value):
                raise DeviceFileError(f"{entry}: {value!r} cannot be written into a device file")
        return result

    def write_eds(self, path: str | os.PathLike[str], values: Mapping[ObjectName, ObjectValue] | None = None) -> DeviceFile:
        """Writes the file with other defaults; what was written."""
        result = self.edited(values or {})
        _write(path, result._text)
        result.path = os.fspath(path)
        return result

    def write_dcf(self, path: str | os.PathLike[str], *, node: int, values: Mapping[ObjectName, ObjectValue] | None = None,
                  bit_rate: int = 0, name: str = "") -> DeviceFile:
        """Writes a DCF for one node: `values` are its ParameterValues, which a master downloads; `bit_rate` in bit/s (0: not said),
        `name` the node's. What was written."""
        from ._device_text import DeviceText
        if not 1 <= node <= 127:
            raise DeviceFileError(f"node {node}: a node-ID is 1 to 127")
        if bit_rate % 1000:
            raise DeviceFileError(f"{bit_rate} bit/s: a DCF has whole kbit/s")
        text = DeviceText(self.edited(values or {}, key="ParameterValue")._text)
        if self.commissioning is None:
            text.set_key("FileInfo", "LastEDS", os.path.basename(self.path))
        text.set_key("DeviceComissioning", "NodeID", str(node))
        text.set_key("DeviceComissioning", "NodeName", name)
        text.set_key("DeviceComissioning", "Baudrate", str(bit_rate // 1000))
        for key, value in (("NetNumber", "0"), ("NetworkName", ""), ("CANopenManager", "0"), ("LSS_SerialNumber", "0")):
            text.set_key("DeviceComissioning", key, value, keep=True)
        result = DeviceFile(path, text=text.bytes())
        _write(path, result._text)
        return result

    def plain_text(self) -> bytes:
        """An EDS made anew of what was understood: in order, repaired, without comments and what a vendor added."""
        return self._core.plain_text()

    def __repr__(self) -> str:
        return f"<{'EDS' if self.commissioning is None else 'DCF'} {self.device.product_name!r}, {_counted(len(self.objects), 'object')}>"

    def _repr_html_(self) -> str:
        def shown(value: ObjectValue) -> object:
            return value.hex() if isinstance(value, bytes) else value
        rows = ((str(entry), entry.name, entry.type, entry.access, shown(entry.default))
                for each in itertools.islice(self.objects.values(), 1000) for entry in itertools.islice(each.values(), 16))
        return _table(f"{self.device.product_name}, {_counted(len(self.objects), 'object')}", ("object", "name", "type", "access", "default"), rows)


def _counted(count: int, noun: str) -> str:
    """1 byte, 2 bytes"""
    return f"{count} {noun}{'' if count == 1 else 's'}"


def _numbers(name: ObjectName) -> tuple[int, int]:
    if isinstance(name, int):
        return name, 0
    if isinstance(name, tuple):
        return name
    match = re.fullmatch(r"\s*(?:0x)?([0-9A-Fa-f]{1,4})H?(?::(?:0x)?([0-9A-Fa-f]{1,2})H?)?\s*", name)
    if match is None:
        raise DeviceFileError(f"{name!r} is no object; expected for example 6000:01")
    return int(match[1], 16), int(match[2] or "0", 16)


def _value_text(entry: ObjectEntry, value: ObjectValue) -> str:
    if isinstance(value, str):
        if entry.bits and not re.fullmatch(r"\s*\$NODEID\s*\+\s*(0x[0-9A-Fa-f]+|[0-9]+)\s*", value, re.IGNORECASE):
            raise DeviceFileError(f"{entry}: {value!r}; expected a number, or a text such as $NODEID+0x200")
        return value
    plain = entry.decode(entry.encode(value))
    if isinstance(plain, bool):
        return str(int(plain))
    if isinstance(plain, bytes):
        return f"0x{int.from_bytes(plain, 'little'):X}" if entry.bits else plain.hex().upper()
    if isinstance(plain, int):
        return str(plain) if plain < 10 else f"0x{plain:0{entry.bits // 4}X}"
    return plain if isinstance(plain, str) else repr(plain)


def _write(path: str | os.PathLike[str], text: bytes) -> None:
    try:
        pathlib.Path(path).write_bytes(text)
    except OSError as error:
        raise DeviceFileError(f"{os.fspath(path)}: cannot write it: {error.strerror or error}") from error


__all__: list[str] = ["Commissioning", "DeviceFile", "DeviceFileError", "DeviceInfo", "DeviceObject", "FileInfo", "ObjectEntry", "Pdo",
                      "Problem"]
