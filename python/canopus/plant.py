"""A plant in this process, in virtual time."""
from __future__ import annotations

import json
import os
import warnings
import weakref
from types import TracebackType
from typing import Any, Callable, NamedTuple, Sequence, TypeVar, cast

from canopus_plc.errors import PlantError
from canopus_plc.mc import Device as CpuDevice
from canopus_plc.mc import word_of
from canopus_plc.plc import Plc, plant_duration

from . import _core
from .picture import Picture, _table

Callback = TypeVar("Callback", bound=Callable[..., Any])
Value = int | float | bool


def _uploaded_value(data: bytes, size_indicated: bool, size: int, what: str) -> bytes:
    """As many bytes as the type has: a node may answer expedited without their number (42H), or say four of a shorter type and
    fill up with zeros."""
    is_longer = 0 < size < len(data) <= 4
    if not size_indicated:
        if size == 0:
            warnings.warn(f"{what}: the node did not indicate how many of the 4 bytes are the value", stacklevel=4)
        return data[:size] if is_longer else data
    if not is_longer or any(data[size:]):
        return data
    warnings.warn(f"{what}: {len(data)} bytes came, its type has {size}: the others are 0", stacklevel=4)
    return data[:size]


def _nanoseconds(seconds: float, what: str) -> int:
    if not 0 <= seconds <= 1e9:
        raise ValueError(f"{what}: {seconds} s; expected 0 to 1e9")
    return round(seconds * 1e9)


class Frame(NamedTuple):
    """A classical CAN frame [ISO 11898-1]."""

    time: float  #: plant time in seconds at which it was complete on the bus
    identifier: int  #: 0 to 7FFH, or to 1FFFFFFFH when extended
    data: bytes  #: 0 to 8 bytes
    extended: bool = False
    remote: bool = False
    dlc: int = 0  #: 0 to 15; of a remote frame the length asked for
    sent: bool = False  #: by the port that it is received from


def _frame(raw: tuple[int, int, bytes, bool, bool, int, bool]) -> Frame:
    return Frame(raw[0] / 1e9, *raw[1:])


class SdoAbort(PlantError):
    """An SDO transfer failed. `code` is the abort code [CiA 301 table 22]; 05040000H: no answer came in time."""

    def __init__(self, code: int, message: str) -> None:
        super().__init__(message)
        self.code = code


class _Client:
    """What canopus_plc's PLC asks its connection, answered in this process."""

    def __init__(self, core: _core.PlantRun, plc: str) -> None:
        self._core, self._plc = core, plc

    def close(self) -> None:
        """There is no connection."""

    def read_words(self, device: CpuDevice, first: int, count: int) -> list[int]:
        return self._core.read_words(self._plc, device.name, _number(first), count)

    def write_words(self, device: CpuDevice, first: int, words: Sequence[int]) -> None:
        checked = [word_of(word, device.name, first + i) for i, word in enumerate(words)]
        self._core.write_words(self._plc, device.name, _number(first), checked)

    def read_bits(self, device: CpuDevice, first: int, count: int) -> list[bool]:
        return [bool(bit) for bit in self._core.read_bits(self._plc, device.name, _number(first), count)]

    def write_bits(self, device: CpuDevice, first: int, bits: Sequence[bool]) -> None:
        self._core.write_bits(self._plc, device.name, _number(first), [bool(bit) for bit in bits])

    def read_buffer(self, unit: int, first: int, count: int) -> list[int]:
        return self._core.read_buffer(self._plc, unit, _number(first), count)

    def write_buffer(self, unit: int, first: int, words: Sequence[int]) -> None:
        checked = [word_of(word, f"U{unit:X}\\G", first + i) for i, word in enumerate(words)]
        self._core.write_buffer(self._plc, unit, _number(first), checked)

    def remote_run(self) -> None:
        self._core.set_cpu(self._plc, "run")

    def remote_stop(self) -> None:
        self._core.set_cpu(self._plc, "stop")

    def remote_pause(self) -> None:
        self._core.set_cpu(self._plc, "pause")

    def cpu_name(self) -> str:
        return self._core.cpu_name(self._plc)


def _number(number: int) -> int:
    if not 0 <= number < 1 << 32:
        raise PlantError(f"{number} is beyond the last one")
    return number


class _Control:
    """The requests of the control server (docs/control.md), answered in this process."""

    def __init__(self, core: _core.PlantRun) -> None:
        self._core = core

    @property
    def time(self) -> float:
        return self._core.now / 1e9

    def ask(self, request: str, **fields: Any) -> dict[str, Any]:
        answer: dict[str, Any] = json.loads(self._core.ask(json.dumps({"request": request, **fields})))
        if not answer.get("ok"):
            raise PlantError(f"{request}: {answer.get('error', answer)}")
        return answer


class Device:
    """A simulated device whose behaviour is written in Python. Objects are "6000:01" or the parameter's name in the device file,
    numbers from 2000H on. Callbacks read and put values of devices, and nothing else of the plant; what they raise ends the
    run and comes out of run()."""

    def __init__(self, plant: Plant, name: str) -> None:
        self._plant, self.name = plant, name
        self._number = plant._core.device_number(name)

    def __getitem__(self, object: str) -> Value:
        """The effective value."""
        return cast(Value, json.loads(self._plant._core.get(self.name, object)))

    def __setitem__(self, object: str, value: Value) -> None:
        """The device's own value, beneath one that is forced; event-driven TPDOs follow. PlantError when it does not fit."""
        self._plant._core.put(self.name, object, str(value).lower() if isinstance(value, bool) else repr(value))

    def _repr_html_(self) -> str:
        return _table(self.name, ("object", "name", "type", "value"), self._plant._core.object_views(self.name))

    def on_change(self, object: str) -> Callable[[Callback], Callback]:
        """Decorates what is called, with the device and the value, when an RPDO, an SDO or anything else has changed the object.
        To be used before time passes."""
        def decorate(callback: Callback) -> Callback:
            token = self._plant._core.watch(self.name, object)
            self._plant._callbacks[self._number, token] = lambda: callback(self, self[object])
            return callback
        return decorate

    def every(self, seconds: float) -> Callable[[Callback], Callback]:
        """Decorates what is called with the device so often, in plant time, from its start on; 1 us at least."""
        def decorate(callback: Callback) -> Callback:
            token = self._plant._core.every(self.name, _nanoseconds(seconds, "every"))
            self._plant._callbacks[self._number, token] = lambda: callback(self)
            return callback
        return decorate

    def on_start(self, callback: Callback) -> Callback:
        """Decorates what is called with the device when its supply comes, and after each NMT reset."""
        self._plant._core.script(self.name)
        self._plant._callbacks[self._number, 0] = lambda: callback(self)
        return callback


class Port:
    """A node of one's own on a bus: it hears every frame, acknowledges, and sends."""

    def __init__(self, plant: Plant, bus: str = "", name: str = "python") -> None:
        self._core = _core.PlantPort(plant._core, bus, name)

    def send(self, identifier: int, data: bytes = b"", *, extended: bool = False, remote: bool = False, dlc: int = 0) -> None:
        """Queues a frame; it is sent as time passes. PlantError when 128 frames wait already."""
        self._core.send(identifier, bytes(data), extended, remote, dlc)

    def receive(self, timeout: float = 0.0) -> Frame | None:
        """The next frame, also of those that the port has sent itself. Plant time passes until there is one, `timeout`
        seconds at most; then None."""
        raw = self._core.receive(_nanoseconds(timeout, "timeout"))
        return None if raw is None else _frame(raw)

    @property
    def state(self) -> str:
        """Of its controller: "error active", "error passive", "bus-off"."""
        return self._core.state

    def close(self) -> None:
        """Leaves the bus."""
        self._core.close()


class Plant:
    """A plant in this process. Plant time stands still but in run(), wait(), receive() and SDO transfers. One thread at a time."""

    def __init__(self, plant_file: str | os.PathLike[str], *, text: str | None = None, seed: int | None = None) -> None:
        """Reads the plant file; with `text` this is its content, and `plant_file` where it would lie. `seed` in place of the
        file's. PlantError has every mistake, with line and column."""
        self._core = _core.PlantRun(os.fspath(plant_file), text, seed)
        self._callbacks: dict[tuple[int, int], Callable[[], Any]] = {}
        self._events: list[dict[str, Any]] = []
        self._control = _Control(self._core)
        # Without a reference from there back to here Python's garbage collection sees every cycle.
        this = weakref.ref(self)

        def dispatch(device: int, token: int, now: int) -> None:
            plant = this()
            callback = plant._callbacks.get((device, token)) if plant is not None else None
            if callback is not None:
                callback()

        def arrival() -> None:
            plant = this()
            for take in list(plant._takers) if plant is not None else []:
                take()
        self._takers: list[Callable[[], None]] = []
        self._core.set_dispatcher(dispatch)
        self._core.set_arrival(arrival)
        #: The PLCs by their names in the plant file, in its order: canopus_plc.Plc, without a connection.
        self.plcs: dict[str, Plc] = {
            name: Plc(client=_Client(self._core, name), control=self._control, name=name,
                      octal=self._core.cpu_name(name).startswith("FX"))
            for name in self._core.plcs}

    def __enter__(self) -> Plant:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        """Ends the run. Everything but `time` and `events` is a PlantError afterwards."""
        self._core.close()

    @property
    def plc(self) -> Plc:
        """The only PLC."""
        if len(self.plcs) != 1:
            raise PlantError(f"the plant has {len(self.plcs)} PLCs; expected plcs[...]: {', '.join(map(repr, self.plcs))}")
        return next(iter(self.plcs.values()))

    @property
    def buses(self) -> list[str]:
        """Their names."""
        return self._core.buses

    @property
    def time(self) -> float:
        """Plant time in seconds."""
        return self._core.now / 1e9

    def run(self, seconds: float) -> None:
        """Lets so much plant time pass, to the nanosecond."""
        self._core.run_until(self._core.now + _nanoseconds(seconds, "run"))

    def force(self, device: str, object: str, value: Value | str, seconds: float | None = None) -> None:
        """Forces a value of a simulated device, for so much plant time or until release()."""
        until = {} if seconds is None else {"for": plant_duration(seconds)}
        self._control.ask("set", device=device, object=object, value=value, **until)

    def release(self, device: str, object: str | None = None) -> None:
        """Ends it, for one object or all of the device."""
        self._control.ask("release", **({"device": device} if object is None else {"device": device, "object": object}))

    def value(self, device: str, object: str) -> Any:
        """The effective value of a simulated device's object."""
        return self._control.ask("get", device=device, object=object)["objects"][0]["value"]

    def states(self) -> dict[str, str]:
        """The NMT states of the simulated devices, by name: "operational"."""
        return {device["name"]: device["state"] for device in self._control.ask("list")["devices"]}

    def _repr_html_(self) -> str:
        if self._core.closed:
            return _table(f"{self.time:g} s, closed", (), ())
        return _table(f"{self.time:g} s", ("bus", "node", "device", "NMT state"), self._core.device_views)

    @property
    def events(self) -> list[dict[str, Any]]:
        """What has happened so far (docs/events.md)."""
        self._events += [json.loads(line) for line in self._core.drain_events().splitlines()]
        return self._events

    def device(self, name: str) -> Device:
        """A simulated device by its name, "BUS:NODE" or node-ID, for a behaviour in Python."""
        return Device(self, name)

    def port(self, bus: str = "", name: str = "python") -> Port:
        """A node of one's own on the only bus, or on the one of this name."""
        return Port(self, bus, name)

    def record(self, bus: str = "") -> None:
        """From now on the frames of the bus are kept for frames(), the first million of them. This is not visible on the bus."""
        self._core.record(bus)

    def frames(self, bus: str = "") -> list[Frame]:
        """Frames since record() or the last call."""
        return [_frame(raw) for raw in self._core.drain_frames(bus)]

    def draw(self, signals: Sequence[str] = (), *, bus: str = "", title: str = "") -> Picture:
        """A picture of the bus that grows from now on: load, states of the nodes and `signals`, values of PDOs such as
        "encoder.6004" or "3.6004:00"; without one the first eight that come."""
        return Picture(self._core.draw(bus, list(signals)), title or bus or ", ".join(self.buses))

    def monitor(self) -> None:
        """From now on messages() has what the frames of all buses mean."""
        self._core.monitor()

    def messages(self) -> list[dict[str, Any]]:
        """As decode() has them, since monitor() or the last call: PDOs with their signals, named as in the device files."""
        return [json.loads(line) for line in self._core.drain_messages().splitlines()]

    def sdo_upload(self, node: int, index: int, sub: int = 0, *, bus: str = "", timeout: float = 0.5, block: bool = False,
                   size: int = 0) -> bytes:
        """Reads an object of a node over SDO [CiA 301 7.2.4]: the bytes as they came, numbers the low byte first. Plant time passes.
        `timeout` in seconds of plant time, for each answer; `block`: block transfer. `size`: bytes of its type, as some nodes
        answer four without the number of those that count; 0: not known. SdoAbort when it fails."""
        return self._sdo(node, index, sub, None, bus, timeout, block, size)

    def sdo_download(self, node: int, index: int, sub: int, value: bytes, *, bus: str = "", timeout: float = 0.5,
                     block: bool = False) -> None:
        """Writes one, likewise."""
        self._sdo(node, index, sub, bytes(value), bus, timeout, block)

    def _sdo(self, node: int, index: int, sub: int, value: bytes | None, bus: str, timeout: float, block: bool, size: int = 0) -> bytes:
        code, reason, data, size_indicated = self._core.sdo(bus, node, index, sub, value, _nanoseconds(timeout, "timeout"), block)
        if code != 0:
            raise SdoAbort(code, f"node {node}, {index:04X}:{sub:02X}: {reason}")
        return _uploaded_value(data, size_indicated, size, f"node {node}, {index:04X}:{sub:02X}")
