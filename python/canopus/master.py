"""An NMT master without a PLC: on a bus of a plant in this process, in plant time, or on a real bus, in the clock's time.

    with canopus.Master("socketcan:can0", slaves={2: "io-block.eds"}) as master:
        print(master.boot(timeout=10))
        print(master.read(2, "1008:00"))
        inputs = master.subscribe(node=2, tpdo=1)
        master.write(2, "6200:01", 0x5A)
        print(inputs.receive(timeout=1).values)
"""
from __future__ import annotations

import json
import os
import pathlib
from types import TracebackType
from typing import Any, Mapping, NamedTuple

from canopus_plc.errors import PlantError

from . import _core
from .device_file import DeviceFile, DeviceFileError, ObjectEntry, ObjectName, ObjectValue, Pdo, _numbers
from .picture import _table
from .plant import Plant, SdoAbort, _nanoseconds, _uploaded_value

#: Request NMT [CiA 302-2, 1F82H].
_COMMANDS = {"start": 0x05, "stop": 0x04, "pre-operational": 0x7F, "reset node": 0x06, "reset communication": 0x07}


class BootResult(NamedTuple):
    """What has become of a slave in the start-up [CiA 302-2]."""

    node: int
    name: str
    result: str  #: "booted", "absent", "given up", "failed", "left to the active master"
    state: str  #: "operational", "pre-operational", "stopped", "missing", "unknown"
    reason: str = ""  #: of a failed one: what is wrong and what to check


class ReceivedPdo(NamedTuple):
    """A PDO as it came."""

    time: float  #: in seconds, of the master's time
    cob_id: int
    data: bytes
    values: dict[str, ObjectValue]  #: by "6000:01"; empty without a device file


class Subscription:
    """The PDOs of one identifier, from now on; the latest 100000 that were not yet read."""

    def __init__(self, master: Master, cob_id: int, pdo: Pdo | None) -> None:
        self._master, self.cob_id, self.pdo = master, cob_id, pdo
        #: The last one that was received.
        self.latest: ReceivedPdo | None = None
        self._token = master._core.subscribe(cob_id, cob_id > 0x7FF)

    def receive(self, timeout: float = 0.0) -> ReceivedPdo | None:
        """The next one; time passes until there is one, `timeout` seconds at most: then None."""
        raw = self._master._core.receive(self._token, _nanoseconds(timeout, "timeout"))
        if raw is None:
            return None
        self.latest = ReceivedPdo(raw[0] / 1e9, self.cob_id, raw[2], _values(self.pdo, raw[2]))
        return self.latest

    def close(self) -> None:
        """Keeps no more of them; again: nothing."""
        self._master._core.unsubscribe(self._token)


def _values(pdo: Pdo | None, data: bytes) -> dict[str, ObjectValue]:
    """The mapped objects that lie whole within the bytes [CiA 301 7.5.2.36]."""
    values: dict[str, ObjectValue] = {}
    number, first = int.from_bytes(data, "little"), 0
    for entry, bits in pdo.mapping if pdo is not None else ():
        if entry is not None and first + bits <= 8 * len(data) and bits >= 1:
            raw = (number >> first & (1 << bits) - 1).to_bytes((bits + 7) // 8, "little")
            values[str(entry)] = entry.decode(raw) if bits == entry.bits else raw
        first += bits
    return values


class Master:
    """A CANopen master. Time passes in boot(), run(), SDO transfers and receive(); of a plant, also when others run it. On a real
    bus it is heard and kept alive only meanwhile: heartbeats are not sent or watched in between."""

    def __init__(self, bus: Plant | str, name: str = "", *, network: str | os.PathLike[str] | None = None,
                 slaves: Mapping[int, str | os.PathLike[str] | DeviceFile | None] | None = None, node: int = 127,
                 timeout: float = 5.0) -> None:
        """`bus`: a plant, with `name` of its bus if it has several; or the address of a real one, such as "socketcan:can0" or
        "socketcand:HOST:PORT/BUS" (`canopus sdo --bus`), which is joined within `timeout` seconds. `network`: a network file
        (docs/commands.md); without one `slaves` are the node-IDs of mandatory slaves and their device files, or None, and `node`
        is the master's own. It is switched on at once: its start-up [CiA 302-2] happens while time passes, and begins with NMT
        reset communication for all nodes. PlantError has every mistake of the network file with its line."""
        self.files: dict[int, DeviceFile] = {}
        number, text = int(node), None
        if not 1 <= number <= 127:
            raise PlantError(f"node {number}: a node-ID is 1 to 127")
        path = os.path.join(os.getcwd(), "slaves")
        if network is not None:
            if slaves is not None:
                raise ValueError("slaves are those of the network file")
            path = os.fspath(network)
            try:
                text = pathlib.Path(path).read_text(encoding="utf-8")
            except (OSError, ValueError) as error:
                raise PlantError(f"{path}: cannot read it: {getattr(error, 'strerror', None) or error}") from error
            self._read_files(pathlib.Path(path).parent, text)
        elif slaves:
            text = f"[master]\nnode = {number}\n" + "".join(self._slave(*slave) for slave in slaves.items())
        if isinstance(bus, Plant):
            self._core = _core.MasterRun.on_plant(bus._core, name, text, path, number)
        else:
            self._core = _core.MasterRun.on_bus(bus, _nanoseconds(timeout, "timeout"), text, path, number)
        self._events: list[dict[str, Any]] = []

    def _slave(self, node: int, file: str | os.PathLike[str] | DeviceFile | None) -> str:
        text = f"[[slave]]\nnode = {int(node)}\n"
        if file is None:
            return text
        known = file if isinstance(file, DeviceFile) else DeviceFile(file)
        self.files[int(node)] = known
        return text + f"eds = {json.dumps(os.path.abspath(known.path), ensure_ascii=False)}\n"

    def _read_files(self, folder: pathlib.Path, text: str) -> None:
        import tomllib
        try:
            sections = tomllib.loads(text).get("slave", [])
            files = {section["node"]: folder / section["eds"] for section in sections if "eds" in section}
        except (tomllib.TOMLDecodeError, TypeError, KeyError, AttributeError):
            return  # the network file's own reader says more
        for number, file in files.items():
            try:
                self.files[number] = DeviceFile(file)
            except DeviceFileError:
                continue

    def __enter__(self) -> Master:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Leaves the bus; the slaves stay as they are."""
        self._core.close()

    @property
    def time(self) -> float:
        """In seconds: plant time, or since the bus was joined."""
        return self._core.now / 1e9

    @property
    def events(self) -> list[dict[str, Any]]:
        """What has happened to slaves so far: dictionaries with t (seconds), event ("booted", "failed", "state", "error control",
        "heard again"), node, name, what."""
        self._events += [json.loads(line) for line in self._core.drain_events().splitlines()]
        return self._events

    def run(self, seconds: float) -> None:
        """Lets so much time pass."""
        self._core.run_for(_nanoseconds(seconds, "run"))

    def boot(self, timeout: float = 30.0) -> dict[int, BootResult]:
        """Lets time pass until the start-up is over: every mandatory slave booted and every other one booted, failed or absent.
        What has become of each slave; the last NMT commands are on the bus a moment later. TimeoutError when that takes longer."""
        if not self._core.boot(_nanoseconds(timeout, "timeout")):
            missing = [str(result.node) for result in self.results.values() if result.result != "booted"]
            raise TimeoutError(f"the start-up is not over after {timeout:g} s; not booted: {', '.join(missing) or 'the master itself'}")
        return self.results

    @property
    def results(self) -> dict[int, BootResult]:
        """What has become of each slave so far."""
        lines = [json.loads(line) for line in self._core.results().splitlines()]
        return {line["node"]: BootResult(line["node"], line["name"], line["result"], line["state"], line.get("reason", ""))
                for line in lines}

    def _repr_html_(self) -> str:
        return _table(f"{self.time:g} s", ("node", "slave", "start-up", "NMT state", "reason"), self.results.values())

    def state(self, node: int) -> str:
        """Its NMT state as the master knows it: by heartbeat or guarding, else the one last commanded."""
        return self._core.state(node)

    def start(self, node: int = 0) -> None:
        """NMT start remote node; 0: all. The command is sent as time passes."""
        self._core.command(node, _COMMANDS["start"])

    def stop(self, node: int = 0) -> None:
        """NMT stop remote node."""
        self._core.command(node, _COMMANDS["stop"])

    def pre_operational(self, node: int = 0) -> None:
        """NMT enter pre-operational."""
        self._core.command(node, _COMMANDS["pre-operational"])

    def reset_node(self, node: int = 0) -> None:
        """NMT reset node. A slave of this master is booted again."""
        self._core.command(node, _COMMANDS["reset node"])

    def reset_communication(self, node: int = 0) -> None:
        """NMT reset communication, likewise."""
        self._core.command(node, _COMMANDS["reset communication"])

    def upload(self, node: int, index: int, sub: int = 0, *, timeout: float = 0.5, block: bool = False, size: int = 0) -> bytes:
        """Reads an object over SDO [CiA 301 7.2.4]: the bytes as they came, numbers the low byte first. `timeout` in seconds for
        each answer; `block`: block transfer; `size`: bytes of its type, as some nodes answer four without the number of those that
        count, 0: not known. SdoAbort when it fails."""
        return self._sdo(node, index, sub, None, timeout, block, size)

    def download(self, node: int, index: int, sub: int, value: bytes, *, timeout: float = 0.5, block: bool = False) -> None:
        """Writes one, likewise."""
        self._sdo(node, index, sub, bytes(value), timeout, block)

    def _sdo(self, node: int, index: int, sub: int, value: bytes | None, timeout: float, block: bool, size: int = 0) -> bytes:
        code, reason, data, size_indicated = self._core.sdo(node, index, sub, value, _nanoseconds(timeout, "timeout"), block)
        if code != 0:
            raise SdoAbort(code, f"node {node}, {index:04X}:{sub:02X}: {reason}")
        return _uploaded_value(data, size_indicated, size, f"node {node}, {index:04X}:{sub:02X}")

    def _entry(self, node: int, name: ObjectName) -> ObjectEntry:
        file = self.files.get(node)
        if file is None:
            raise DeviceFileError(f"node {node} has no device file: expected upload() and download(), in bytes")
        entry = file.find(name)
        if entry is None:
            raise DeviceFileError("node {}: {} has no object {:04X}:{:02X}".format(node, file.path, *_numbers(name)))
        return entry

    def read(self, node: int, name: ObjectName, *, timeout: float = 0.5) -> ObjectValue:
        """Reads an object whose type the slave's device file gives: a number, a boolean, a text or bytes."""
        entry = self._entry(node, name)
        return entry.decode(self.upload(node, entry.index, entry.sub, timeout=timeout, size=(entry.bits + 7) // 8))

    def write(self, node: int, name: ObjectName, value: ObjectValue, *, timeout: float = 0.5) -> None:
        """Writes one, likewise. DeviceFileError, before anything is sent, when the value does not fit."""
        entry = self._entry(node, name)
        self.download(node, entry.index, entry.sub, entry.encode(value), timeout=timeout)

    def send(self, cob_id: int, data: bytes = b"") -> None:
        """Queues a frame, such as an RPDO of a slave; more than 7FFH: with 29 bits."""
        self._core.send(cob_id, bytes(data), cob_id > 0x7FF)

    def subscribe(self, cob_id: int | None = None, *, node: int | None = None, tpdo: int = 1) -> Subscription:
        """From now on the PDOs of this identifier are kept; or those of a slave's TPDO (from 1), with the values that its device
        file maps: as the file has it, not as the slave may have been configured since."""
        if (cob_id is None) == (node is None):
            raise ValueError("expected cob_id, or node and tpdo")
        if cob_id is not None:
            if not 0 <= cob_id <= 0x1FFFFFFF:
                raise ValueError(f"cob_id {cob_id}: expected 0 to 1FFFFFFFH")
            return Subscription(self, cob_id, None)
        assert node is not None
        file = self.files.get(node)
        if file is None:
            raise DeviceFileError(f"node {node} has no device file: expected cob_id")
        found = next((pdo for pdo in file.tpdos(node) if pdo.number == tpdo), None)
        if found is None or not found.valid:
            raise DeviceFileError(f"node {node}: {file.path} has no TPDO {tpdo}" + ("" if found is None else " that is valid"))
        return Subscription(self, found.cob_id, found)
