"""Answers of a control server that is not ours: an error in words, whatever comes."""
from __future__ import annotations

import socket
import threading

import pytest

import canopus_plc.control
from canopus_plc import PlantError
from canopus_plc.control import ControlClient


def _asked(answer: bytes) -> str:
    """The error of a request that is answered with these bytes."""
    with socket.create_server(("127.0.0.1", 0)) as server:

        def serve() -> None:
            connection, _ = server.accept()
            with connection:
                connection.recv(4096)
                try:
                    connection.sendall(answer)
                except OSError:  # the client has closed
                    pass

        thread = threading.Thread(target=serve)
        thread.start()
        client = ControlClient(*server.getsockname())
        try:
            with pytest.raises(PlantError) as error:
                client.ask("status")
        finally:
            client.close()
            thread.join()
        return str(error.value)


@pytest.mark.parametrize(
    "answer",
    [
        pytest.param(b"[" * 200_000 + b"]" * 200_000, id="deep arrays"),
        pytest.param(b'{"a":' * 200_000, id="deep objects"),
        pytest.param(b"status", id="no JSON"),
        pytest.param(b"\xff", id="no UTF-8"),
    ],
)
def test_answer_that_is_too_deep_or_no_json_is_an_error(answer: bytes) -> None:
    assert "its answer cannot be read as JSON" in _asked(answer + b"\n")


def test_answer_that_is_no_object_is_an_error() -> None:
    assert _asked(b"[1]\n").endswith("its answer is no object of JSON")


def test_answer_without_end_is_an_error_that_names_the_limit(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(canopus_plc.control, "_LONGEST_ANSWER", 100_000)
    assert _asked(b"x" * 400_000).endswith("its answer is longer than 100000 bytes")
