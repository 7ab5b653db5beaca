"""A bus of a plant for programs of python-can: can.Bus(interface="canopus", channel="line1", plant="plant.toml").

Plant time passes while the thread that made the bus waits in recv(), or runs the plant, and not otherwise. Other threads, such
as those of can.Notifier, get each message at its moment: plant time waits until their listeners have returned. With `pace` the
plant runs by itself, in step with the clock. Time stamps are plant time in seconds.
"""
from __future__ import annotations

import logging
import os
import threading
import time
from typing import Any, Callable, Sequence

from can.broadcastmanager import LimitedDurationCyclicSendTaskABC, ModifiableCyclicTaskABC, RestartableCyclicTaskABC
from can.bus import BusABC, BusState
from can.exceptions import CanInitializationError, CanOperationError
from can.message import Message

from canopus_plc.errors import PlantError

from . import _core
from .plant import Plant

#: Seconds of the clock that plant time waits at most: for a listener to return, and for a Notifier to begin.
LISTENER_PATIENCE, NOTIFIER_PATIENCE = 10.0, 1.0
#: Seconds of plant time that send() waits for room when it is given no timeout.
SEND_PATIENCE = 1.0
_STATES = {"error active": BusState.ACTIVE, "error passive": BusState.PASSIVE, "bus-off": BusState.ERROR}
_log = logging.getLogger("can.canopus")


class _Pace(threading.Thread):
    """Keeps a plant in step with the clock."""

    def __init__(self, plant: Plant, pace: float) -> None:
        super().__init__(name="canopus pace", daemon=True)
        self.plant, self.pace = plant, pace
        self.ends = threading.Event()
        self.error: BaseException | None = None

    def run(self) -> None:
        start, begin = self.plant.time, time.monotonic()
        while not self.ends.wait(0.001) and not self.plant._core.closed:
            ahead = start + (time.monotonic() - begin) * self.pace - self.plant.time
            try:
                if ahead > 0:
                    self.plant.run(ahead)
            except Exception as error:  # pylint: disable=broad-except
                if not _runs_just_now(error):
                    self.error = error
                    return


class _Shared:
    """A plant and the buses of this program on it. Those that name the same file share the plant; the last one closes it."""

    _all: list[_Shared] = []
    _lock = threading.Lock()

    def __init__(self, plant: Plant, path: str | None) -> None:
        self.plant, self.path, self.buses = plant, path, 0
        self.pace: _Pace | None = None

    @classmethod
    def join(cls, plant: Plant | str | os.PathLike[str], seed: int | None, pace: float | None) -> _Shared:
        with cls._lock:
            path = None if isinstance(plant, Plant) else os.path.realpath(plant)
            found = next((each for each in cls._all if (each.path == path if path else each.plant is plant)), None)
            if found is None:
                found = cls(plant if isinstance(plant, Plant) else Plant(plant, seed=seed), path)
                cls._all.append(found)
            found.buses += 1
        if pace is not None and found.pace is None:
            found.pace = _Pace(found.plant, pace)
            found.pace.start()
        return found

    def leave(self) -> None:
        with self._lock:
            self.buses -= 1
            if self.buses > 0:
                return
            self._all.remove(self)
        if self.pace is not None:
            self.pace.ends.set()
            if self.pace is not threading.current_thread():
                self.pace.join()
        if self.path is not None:
            self.plant.close()


def _runs_just_now(error: BaseException) -> bool:
    return isinstance(error, PlantError) and "runs just now" in str(error)


def _raw(message: Message) -> tuple[int, bytes, bool, bool, int]:
    if message.is_fd or message.is_error_frame:
        raise CanOperationError("only data and remote frames of classical CAN")
    return message.arbitration_id, bytes(message.data or b""), message.is_extended_id, message.is_remote_frame, message.dlc


def _nanoseconds(seconds: float, what: str) -> int:
    if not 0 <= seconds <= 1e9:
        raise ValueError(f"{what}: {seconds} s; expected 0 to 1e9")
    return round(seconds * 1e9)


class PlantCyclicTask(ModifiableCyclicTaskABC, LimitedDurationCyclicSendTaskABC, RestartableCyclicTaskABC):
    """Sends in plant time, to the nanosecond: the first message at once. What meets a full queue is not sent."""

    def __init__(self, bus: CanopusBus, messages: Sequence[Message] | Message, period: float, duration: float | None) -> None:
        """`period` and `duration` in seconds of plant time; a period is 10 us at least."""
        super().__init__(messages, period, duration)
        self._bus = bus
        self._token: int | None = None

    def start(self) -> None:
        """From the first message on, also when it was not stopped; `duration` begins anew."""
        self.stop()
        frames = [_raw(message) for message in self.messages]
        period, duration = _nanoseconds(self.period, "period"), _nanoseconds(self.duration or 0, "duration")
        self._token = self._bus._patiently(lambda: self._bus._port.repeat(frames, period, duration))

    def stop(self) -> None:
        token, self._token = self._token, None
        if token is not None:
            self._bus._patiently(lambda: self._bus._port.stop(token))

    def modify_data(self, messages: Sequence[Message] | Message) -> None:
        """Other data from the next message on, at the same moments."""
        super().modify_data(messages)
        token, frames = self._token, [_raw(message) for message in self.messages]
        if token is not None:
            self._bus._patiently(lambda: self._bus._port.change(token, frames))


class CanopusBus(BusABC):
    """A node of one's own on a bus of a plant. Errors are can.CanError."""

    def __init__(self, channel: Any = None, plant: Plant | str | os.PathLike[str] | None = None, can_filters: Any = None,
                 receive_own_messages: bool = False, bitrate: int | None = None, seed: int | None = None,
                 pace: float | None = None, fd: bool = False, **others: Any) -> None:
        """`channel`: the bus's name; without one the only bus. `plant`: a Plant, or the path of a plant file: buses that name the
        same file share one plant, which ends with the last of them; `seed` in place of the file's, for the first. `bitrate`, in
        bit/s, must be the bus's. `pace`: seconds of plant time that pass in a second of the clock; None: plant time passes in
        recv() and run() only. CanInitializationError when something does not fit."""
        if plant is None:
            raise CanInitializationError("plant is missing: a canopus.Plant or the path of a plant file")
        if fd:
            raise CanInitializationError("fd: the buses of a plant are classical CAN")
        rate = None if pace is None else float(pace)
        if rate is not None and not 0 < rate <= 1e6:
            raise CanInitializationError(f"pace: {pace}; expected more than 0, and 1e6 at most")
        bus = "" if channel is None else str(channel)
        try:
            self._shared = _Shared.join(plant, None if seed is None else int(seed), rate)
        except PlantError as error:
            raise CanInitializationError(str(error)) from error
        #: The plant, whose run(), sdo_upload() ... let time pass in place of time.sleep().
        self.plant: Plant = self._shared.plant
        try:
            if rate is not None and self._shared.pace is not None and self._shared.pace.pace != rate:
                raise CanInitializationError(f"pace: {rate:g}; another bus of the plant has {self._shared.pace.pace:g}")
            has = self._patiently(lambda: self.plant._core.bit_rate(bus))
            if bitrate is not None and int(bitrate) != has:
                raise CanInitializationError(f"bitrate: {bitrate}; the bus has {has} bit/s")
            self._port = self._patiently(lambda: _core.PlantPort(self.plant._core, bus, "python-can"))
        except CanOperationError as error:
            self._shared.leave()
            raise CanInitializationError(str(error)) from error
        except CanInitializationError:
            self._shared.leave()
            raise
        self._own = receive_own_messages
        self._bus = bus or self.plant.buses[0]
        self._thread = threading.get_ident()
        self._meeting = threading.Condition()
        self._reader: threading.Thread | None = None  # another thread that takes the messages
        self._is_idle = False                         # it waits for one
        self._is_awaited = False                      # plant time waits for it
        self._is_shut = False
        self.plant._takers.append(self._hand_over)
        self.channel_info = f"canopus {self._bus}"
        super().__init__(channel=channel, can_filters=can_filters, **others)

    def _patiently(self, access: Callable[[], Any]) -> Any:
        """The access, when the plant does not run just now in another thread."""
        limit = time.monotonic() + LISTENER_PATIENCE
        while True:
            try:
                return access()
            except PlantError as error:
                is_own = self._shared.pace is None and threading.get_ident() == getattr(self, "_thread", threading.get_ident())
                if is_own or not _runs_just_now(error) or time.monotonic() > limit:
                    raise CanOperationError(str(error)) from error
                time.sleep(0.0005)

    def _drives(self) -> bool:
        """This thread lets time pass."""
        return self._shared.pace is None and threading.get_ident() == self._thread

    def _check(self) -> None:
        if self._is_shut:
            raise CanOperationError("the bus is shut down")
        if self.plant._core.closed:
            raise CanOperationError("the plant is closed")
        if self._shared.pace is not None and self._shared.pace.error is not None:
            raise CanOperationError(f"the plant has ended: {self._shared.pace.error}") from self._shared.pace.error

    def recv(self, timeout: float | None = None) -> Message | None:
        """The next message that passes the filters, or None after `timeout` seconds: of plant time in the thread that made the
        bus, of the clock in others and with `pace`."""
        self._check()
        return self._recv_driving(timeout) if self._drives() else self._recv_waiting(timeout)

    def _recv_driving(self, timeout: float | None) -> Message | None:
        end = None if timeout is None else self.plant.time + max(0.0, timeout)
        while True:
            left = 3600.0 if end is None else max(0.0, end - self.plant.time)
            try:
                raw = self._port.receive(_nanoseconds(left, "timeout"))
            except PlantError as error:
                raise CanOperationError(str(error)) from error
            message = None if raw is None else self._message(raw)
            if message is not None or (raw is None and end is not None):
                return message

    def _recv_waiting(self, timeout: float | None) -> Message | None:
        end = None if timeout is None else time.monotonic() + timeout
        with self._meeting:
            self._reader = threading.current_thread()
            self._await(True)
            while not self._is_shut:
                raw = self._port.take()
                if raw is not None:
                    message = self._message(raw)
                    if message is not None:
                        self._is_idle = False
                        return message
                    continue
                self._is_idle = True
                self._meeting.notify_all()
                left = 0.2 if end is None else end - time.monotonic()
                if left <= 0:
                    return None
                self._meeting.wait(min(left, 0.2))
                self._check()
        return None

    def _hand_over(self) -> None:
        """Called while plant time waits: the other thread takes what there is, and comes back for more."""
        begin = time.monotonic()
        with self._meeting:
            self._meeting.notify_all()
            while self._is_awaited and not self._is_shut and (
                    self._port.waiting > 0 or (self._reader is not None and not self._is_idle)):
                if self._reader is threading.current_thread():
                    return
                self._meeting.wait(0.02)
                waited = time.monotonic() - begin
                if self._reader is None:
                    if waited < NOTIFIER_PATIENCE:
                        continue
                elif self._reader.is_alive():
                    if waited < LISTENER_PATIENCE:
                        continue
                    _log.warning("%s: a listener has not returned for %g s; plant time goes on", self.channel_info, waited)
                self._reader = None
                self._await(False)

    def _await(self, is_awaited: bool) -> None:
        self._is_awaited = is_awaited
        self._port.set_awaited(is_awaited)

    def fileno(self) -> int:
        """There is none. can.Notifier asks before its thread begins: plant time waits for it."""
        self._await(True)
        raise NotImplementedError("a bus of a plant has no file descriptor")

    def _message(self, raw: tuple[int, int, bytes, bool, bool, int, bool]) -> Message | None:
        moment, identifier, data, extended, remote, dlc, sent = raw
        if sent and not self._own:
            return None
        message = Message(timestamp=moment / 1e9, arbitration_id=identifier, is_extended_id=extended, is_remote_frame=remote,
                          dlc=min(dlc, 8), data=None if remote else data, is_rx=not sent, channel=self._bus)
        return message if self._matches_filters(message) else None

    def send(self, msg: Message, timeout: float | None = None) -> None:
        """Queues the message; it is sent as time passes. When 128 messages wait already, plant time passes until there is room,
        `timeout` at most (None: 1 s); in other threads that is an error."""
        self._check()
        frame = _raw(msg)
        end = self.plant.time + (SEND_PATIENCE if timeout is None else timeout)
        while not self._patiently(lambda: self._port.offer(*frame)):
            if not self._drives() or self.plant.time >= end:
                raise CanOperationError("the transmit queue is full: let time pass")
            self.plant.run(0.0001)

    def _send_periodic_internal(self, msgs: Sequence[Message] | Message, period: float, duration: float | None = None,
                                autostart: bool = True, modifier_callback: Any = None) -> PlantCyclicTask:
        if modifier_callback is not None:
            raise NotImplementedError("modifier_callback: use modify_data()")
        task = PlantCyclicTask(self, msgs, period, duration)
        if autostart:
            task.start()
        return task

    @property
    def state(self) -> BusState:
        """Of the controller: ACTIVE, PASSIVE, or ERROR (bus-off)."""
        return _STATES[self._patiently(lambda: self._port.state)]

    @state.setter
    def state(self, new_state: BusState) -> None:
        raise NotImplementedError("the state of a controller follows from its error counters")

    def shutdown(self) -> None:
        """Leaves the bus; again: nothing."""
        if self._is_shut:
            return
        super().shutdown()
        with self._meeting:
            self._is_shut = True
            self._meeting.notify_all()
        if self._hand_over in self.plant._takers:
            self.plant._takers.remove(self._hand_over)
        self._port.close()
        self._shared.leave()

    @staticmethod
    def _detect_available_configs() -> list[Any]:
        return []
