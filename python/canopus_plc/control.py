"""The control server of a plant: lines of JSON over TCP (docs/control.md)."""
from __future__ import annotations

import json
import socket
from typing import Any

from .errors import PlantError

_LONGEST_ANSWER = 64 << 20  # bytes


class ControlClient:
    """One connection. A request waits for its answer as long as that takes."""

    def __init__(self, host: str, port: int, *, timeout: float = 5.0) -> None:
        """`timeout` in seconds, to connect."""
        self._place = f"{host}:{port}"
        try:
            self._socket = socket.create_connection((host, port), timeout)
        except OSError as error:
            raise PlantError(f"control server {self._place}: {error.strerror or error}") from error
        self._socket.settimeout(None)
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._input = bytearray()
        self._number = 0
        #: Plant time of the last answer, in seconds.
        self.time = 0.0
        #: The plant has closed the connection: it ends.
        self.has_ended = False

    def close(self) -> None:
        self._socket.close()

    def ask(self, request: str, **fields: Any) -> dict[str, Any]:
        """The answer. What the plant refuses is a PlantError, and nothing has happened."""
        self._number += 1
        line = json.dumps({"request": request, "id": self._number, **fields}) + "\n"
        try:
            self._socket.sendall(line.encode())
            answer = self._answer()
        except OSError as error:
            raise PlantError(f"control server {self._place}: {error.strerror or error}") from error
        self.time = float(answer.get("t", self.time))
        if not answer.get("ok"):
            raise PlantError(f"{request}: {answer.get('error', answer)}")
        return answer

    def _answer(self) -> dict[str, Any]:
        """That of the last request: those of requests that were interrupted are passed over."""
        searched = 0
        while True:
            end = self._input.find(b"\n", searched)
            if end < 0:
                searched = len(self._input)
                if searched > _LONGEST_ANSWER:
                    raise PlantError(f"control server {self._place}: its answer is longer than {_LONGEST_ANSWER} bytes")
                more = self._socket.recv(65536)
                if not more:
                    self.has_ended = True
                    raise PlantError(f"control server {self._place} closed the connection: the plant has ended")
                self._input += more
                continue
            line, searched = bytes(self._input[:end]), 0
            del self._input[:end + 1]
            try:
                answer: dict[str, Any] = json.loads(line)
            except (ValueError, RecursionError) as error:  # the latter: nested too deep
                raise PlantError(f"control server {self._place}: its answer cannot be read as JSON: {error}") from error
            if not isinstance(answer, dict):
                raise PlantError(f"control server {self._place}: its answer is no object of JSON")
            if answer.get("id", self._number) == self._number:
                return answer
