"""A bus of a plant for programs of python-can: CanopusBus(plant=plant, channel="line1").

Plant time passes while the program waits in recv(), and not otherwise. Time stamps are plant time in seconds.
"""
from __future__ import annotations

from typing import Any

from can.bus import BusABC
from can.exceptions import CanInitializationError, CanOperationError
from can.message import Message

from .plant import Plant


class CanopusBus(BusABC):
    """A node of one's own on a bus of a plant."""

    def __init__(self, channel: str = "", plant: Plant | str | None = None, can_filters: Any = None,
                 receive_own_messages: bool = False, **others: Any) -> None:
        """`plant`: a Plant, or a plant file, which is this bus's alone then and ends with it."""
        if plant is None:
            raise CanInitializationError("plant is missing: a canopus.Plant or the path of a plant file")
        self._owns_plant = not isinstance(plant, Plant)
        self._plant: Plant = plant if isinstance(plant, Plant) else Plant(plant)
        self._own = receive_own_messages
        self._port = self._plant.port(channel or "", "python-can")
        self.channel_info = f"canopus {channel}"
        super().__init__(channel=channel, can_filters=can_filters, **others)

    def _recv_internal(self, timeout: float | None) -> tuple[Message | None, bool]:
        limit = 3600.0 if timeout is None else timeout
        end = self._plant.time + limit
        while True:
            left = max(0.0, end - self._plant.time)
            frame = self._port.receive(left)
            if frame is None:
                return None, False
            if frame.sent and not self._own:
                continue
            return Message(timestamp=frame.time, arbitration_id=frame.identifier, is_extended_id=frame.extended,
                               is_remote_frame=frame.remote, dlc=min(frame.dlc, 8), data=None if frame.remote else frame.data,
                               is_rx=not frame.sent), False

    def send(self, msg: Message, timeout: float | None = None) -> None:
        if msg.is_fd or msg.is_error_frame:
            raise CanOperationError("only data and remote frames of classical CAN")
        self._port.send(msg.arbitration_id, bytes(msg.data or b""), extended=msg.is_extended_id, remote=msg.is_remote_frame,
                        dlc=msg.dlc)

    def shutdown(self) -> None:
        super().shutdown()
        self._port.close()
        if self._owns_plant:
            self._plant.close()
