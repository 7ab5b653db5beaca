"""The text of a device file in which single values are changed, and every other line stays as it is."""
from __future__ import annotations

import re
from typing import Callable

from .device_file import DeviceFileError, ObjectEntry

_HEADER = re.compile(r"\s*\[\s*([^\]]*?)\s*\]")
_OBJECT = re.compile(r"(?:0x)?([0-9a-f]{1,4})h?(?:\s*sub(?:index)?\s*(?:0x)?([0-9a-f]{1,2})h?|(value))?")


class DeviceText:
    def __init__(self, text: bytes) -> None:
        if text.removeprefix(b"\xef\xbb\xbf").lstrip().startswith(b"<"):
            raise DeviceFileError("an XDD or XDC is not changed here: `canopus eds convert` makes an EDS or DCF of it")
        self._mark = b"\xef\xbb\xbf" if text.startswith(b"\xef\xbb\xbf") else b""
        text = text[len(self._mark):]
        try:
            decoded, self._encoding = text.decode("utf-8"), "utf-8"
        except UnicodeDecodeError:
            decoded, self._encoding = text.decode("latin-1"), "latin-1"
        self._end = "\r\n" if "\r\n" in decoded else "\r" if "\r" in decoded and "\n" not in decoded else "\n"
        # Each line with its own end, which files in the field mix.
        pieces = re.split(r"(\r\n|\r|\n)", decoded)
        self._lines, self._ends = pieces[::2], [*pieces[1::2], ""]

    def bytes(self) -> bytes:
        try:
            text = "".join(line + end for line, end in zip(self._lines, self._ends))
            return self._mark + text.encode(self._encoding)
        except UnicodeEncodeError as error:
            raise DeviceFileError(f"{error.object[error.start]!r} cannot be written: the file is in Latin-1") from error

    def set_value(self, entry: ObjectEntry, value: str, key: str) -> None:
        place = self._find_entry(entry)
        if place is not None:
            return self._set(place, key, value)
        if entry.sub == 0 or key != "ParameterValue" or self._find(lambda name: _is(name, entry.index, None)) is None:
            raise DeviceFileError(f"{entry} has no section of its own in the file: it cannot get a {key}")
        self._set_in_list(entry, value)

    def set_key(self, section: str, key: str, value: str, *, keep: bool = False) -> None:
        """`keep`: what the file says already counts."""
        place = self._find(lambda name: name.lower() == section.lower())
        if place is None:
            place = self._add(section)
        if not keep or self._find_key(place, key) is None:
            self._set(place, key, value)

    def _find_entry(self, entry: ObjectEntry) -> int | None:
        place = self._find(lambda name: _is(name, entry.index, entry.sub))
        if place is None and entry.sub == 0:
            place = self._find(lambda name: _is(name, entry.index, None))
            # The head of an object with sub-indexes has no value.
            if place is not None and (self._find_key(place, "SubNumber") or self._find_key(place, "CompactSubObj")) is not None:
                return None
        return place

    def _set_in_list(self, entry: ObjectEntry, value: str) -> None:
        """Of an object with CompactSubObj: [1016Value]."""
        name = f"{entry.index:04X}Value"
        place = self._find(lambda each: _is(each, entry.index, "value"))
        if place is None:
            place = self._add(name)
            self._set(place, "NrOfEntries", "0")
        known = self._find_key(place, str(entry.sub))
        self._set(place, str(entry.sub), value)
        if known is None:
            count = sum(1 for number in self._body(place) if re.match(r"\s*\d+\s*=", self._lines[number]))
            self._set(place, "NrOfEntries", str(count))

    def _find(self, is_wanted: Callable[[str], bool]) -> int | None:
        for number, line in enumerate(self._lines):
            header = _HEADER.match(line)
            if header is not None and is_wanted(header[1]):
                return number
        return None

    def _body(self, place: int) -> range:
        end = place + 1
        while end < len(self._lines) and _HEADER.match(self._lines[end]) is None:
            end += 1
        return range(place + 1, end)

    def _find_key(self, place: int, key: str) -> int | None:
        pattern = re.compile(rf"\s*{re.escape(key)}\s*=", re.IGNORECASE)
        return next((number for number in self._body(place) if pattern.match(self._lines[number])), None)

    def _set(self, place: int, key: str, value: str) -> None:
        if not value.isprintable():
            raise DeviceFileError(f"{key}={value!r}: only printable letters can stand in a device file")
        number = self._find_key(place, key)
        if number is not None:
            self._lines[number] = f"{key}={value}"
            return
        body = self._body(place)
        last = max((each for each in body if self._lines[each].strip()), default=place)
        self._lines.insert(last + 1, f"{key}={value}")
        self._ends.insert(last + 1, self._end if self._ends[last] else "")
        self._ends[last] = self._ends[last] or self._end

    def _add(self, section: str) -> int:
        if self._lines[-1].strip():
            self._ends[-1] = self._end
            self._lines.append("")
            self._ends.append("")
        # The last line is empty.
        self._lines += [f"[{section}]", ""]
        self._ends[-1:] = [self._end, self._end, ""]
        return len(self._lines) - 2


def _is(name: str, index: int, sub: int | str | None) -> bool:
    match = _OBJECT.fullmatch(name.lower())
    if match is None or int(match[1], 16) != index:
        return False
    if sub == "value":
        return match[3] is not None
    return match[3] is None and (match[2] is None if sub is None else match[2] is not None and int(match[2], 16) == sub)
