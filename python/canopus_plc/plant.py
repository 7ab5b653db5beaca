"""A plant of Canopus that this program starts, drives and ends."""
from __future__ import annotations

import collections
import contextlib
import json
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import time
from types import TracebackType
from typing import Any, Iterable, TextIO

from . import report
from .control import ControlClient
from .errors import PlantError
from .plc import Plc, plant_duration

#: So many seconds a plant has to start, and to end.
PATIENCE = 60.0

Text = str | os.PathLike[str]


def find_program() -> str:
    """The program `canopus`: $CANOPUS_PROGRAM, else the one in $PATH, else that of the build folder this package lies beside."""
    named = os.environ.get("CANOPUS_PROGRAM") or shutil.which("canopus")
    built = pathlib.Path(__file__).resolve().parents[2] / "build" / "canopus"
    if named or built.is_file():
        return named or str(built)
    raise PlantError("there is no program canopus in $PATH; name it in $CANOPUS_PROGRAM")


class Plant:
    """A running plant. Every server has a port of its own choice, so plants run side by side.

    In step (the default) plant time stands still but in run() and wait(). With step=False the plant runs in real time by itself; then
    run() and wait() need `control` in the plant file.
    """

    def __init__(self, plant_file: Text, *, step: bool = True, program: Text | None = None, seed: int | None = None,
                 trace: Text | None = None, arguments: Iterable[Text] = ()) -> None:
        """`trace`: every frame goes into this file (candump log, or pcap for *.pcap). `arguments`: further ones of `canopus run`."""
        words: list[str] = [os.fspath(program or find_program()), "run", os.fspath(plant_file), "--free-ports", "--json"]
        words += ["--virtual", "--step"] if step else []
        words += ["--seed", str(seed)] if seed is not None else []
        words += ["--trace", os.fspath(trace)] if trace is not None else []
        words += [os.fspath(word) for word in arguments]
        #: Events of the run so far (docs/events.md). They may come a little later than the answer of run().
        self.events: list[dict[str, Any]] = []
        #: The file with every frame, if there is one.
        self.trace = trace
        self._news = threading.Condition()
        self._has_ended = False
        self._errors: collections.deque[str] = collections.deque(maxlen=100)
        #: The PLCs by their names in the plant file, in its order.
        self.plcs: dict[str, Plc] = {}
        self._control: ControlClient | None = None
        try:
            self._process = subprocess.Popen(words, stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
                                             text=True, encoding="utf-8", errors="replace")
        except OSError as error:
            raise PlantError(f"{words[0]}: {error.strerror or error}") from error
        assert self._process.stdout is not None and self._process.stderr is not None
        self._readers = [threading.Thread(target=self._read_events, args=(self._process.stdout,), daemon=True),
                         threading.Thread(target=self._read_errors, args=(self._process.stderr,), daemon=True)]
        for reader in self._readers:
            reader.start()
        try:
            self._connect(step)
        except BaseException:
            self.kill()
            raise

    def _connect(self, step: bool) -> None:
        # All servers listen before the plant does anything; the PLCs' come before the control server's.
        first = self._wait_event(lambda e: e.get("protocol") == "control" if step else e["event"] not in ("listen", "warning"))
        if first is None:
            raise PlantError(self._why_ended("did not start"))
        control = self._server("control")
        if control is not None:
            self._control = ControlClient(*_place(control["address"]))
        cpus = {cpu["name"]: cpu for cpu in self._control.ask("list")["plcs"]} if self._control is not None else {}
        for event in list(self.events):
            if event["event"] == "listen" and event["protocol"] == "MC protocol" and event["of"] not in self.plcs:
                host, port = _place(event["address"])
                octal = cpus.get(event["of"], {}).get("family") in ("FX3", "FX5")
                self.plcs[event["of"]] = Plc(host, port, timeout=PATIENCE, octal=octal, control=self._control, name=event["of"])

    @property
    def plc(self) -> Plc:
        """The only PLC."""
        if len(self.plcs) != 1:
            names = ", ".join(repr(name) for name in self.plcs)
            raise PlantError(f"the plant has {len(self.plcs)} PLCs with a server; expected plcs[...]: {names}" if names else
                             "the plant has no PLC with a server")
        return next(iter(self.plcs.values()))

    @property
    def time(self) -> float:
        """Plant time in seconds."""
        control = self._controlled()
        control.ask("list")
        return control.time

    def run(self, seconds: float) -> None:
        """Lets so much plant time pass. A Plc's run() counts scans."""
        self._controlled().ask("run", **{"for": plant_duration(seconds)})

    def force(self, device: str, object: str, value: int | float | bool | str, seconds: float | None = None) -> None:
        """Forces a value of a simulated device, for so much plant time or until release(). `object` is "6000:01" or the
        parameter's name."""
        fields: dict[str, Any] = {"device": device, "object": object, "value": value}
        if seconds is not None:
            fields["for"] = plant_duration(seconds)
        self._controlled().ask("set", **fields)

    def release(self, device: str, object: str | None = None) -> None:
        """Ends it, for one object or all of the device."""
        fields = {"device": device} if object is None else {"device": device, "object": object}
        self._controlled().ask("release", **fields)

    def value(self, device: str, object: str) -> Any:
        """The effective value of a simulated device's object."""
        return self._controlled().ask("get", device=device, object=object)["objects"][0]["value"]

    def states(self) -> dict[str, str]:
        """The NMT states of the simulated devices, by name: "operational"."""
        return {device["name"]: device["state"] for device in self._controlled().ask("list")["devices"]}

    def report(self) -> str:
        """What the plant is doing, for the report of a failed test: plant time, NMT states, why slaves are not booted, the file
        with the frames, and the latest events."""
        now, states = self.time, self.states()
        with self._news:
            events = list(self.events)
        return report.describe(now, states, events, self.trace)

    def socketcand(self, bus: str | None = None) -> tuple[str, int]:
        """Host and port where a bus, or the only one, is served to other programs."""
        event = self._wait_event(lambda e: e.get("protocol") == "socketcand" and bus in (None, e["of"]))
        if event is None:
            raise PlantError(f"no bus {bus or ''} is served by socketcand")
        return _place(event["address"])

    def stop(self) -> None:
        """Ends the run as Ctrl-C does. PlantError when it does not end well."""
        if self._control is not None and self._control.has_ended:  # by itself: a signal would only cut off its last lines
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(5)
        if self._process.poll() is None:
            self._process.send_signal(signal.SIGINT)
        try:
            code = self._process.wait(PATIENCE)
        except subprocess.TimeoutExpired:
            self.kill()
            raise PlantError(f"canopus did not end within {PATIENCE:g} s") from None
        self._close()
        if code != 0:
            raise PlantError(self._why_ended("ended"))

    def kill(self) -> None:
        """Ends the program at once, whatever it does."""
        self._process.kill()
        self._process.wait()
        self._close()

    def __enter__(self) -> Plant:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        if kind is None:
            return self.stop()
        with contextlib.suppress(PlantError):  # what went wrong first is what counts
            self.stop()

    def _controlled(self) -> ControlClient:
        if self._control is None:
            raise PlantError("the plant has no control server; with step=False the plant file needs `control`")
        return self._control

    def _server(self, protocol: str) -> dict[str, Any] | None:
        return next((e for e in self.events if e["event"] == "listen" and e["protocol"] == protocol), None)

    def _wait_event(self, wanted: Any) -> dict[str, Any] | None:
        """The first event, past or coming; None when the plant ends, or after PATIENCE."""
        end = time.monotonic() + PATIENCE
        looked_at = 0
        with self._news:
            while True:
                while looked_at < len(self.events):
                    event = self.events[looked_at]
                    if wanted(event):
                        return event
                    looked_at += 1
                if self._has_ended or not self._news.wait(max(0.0, end - time.monotonic())):
                    return None

    def _why_ended(self, what: str) -> str:
        if self._has_ended:
            with contextlib.suppress(subprocess.TimeoutExpired):
                self._process.wait(5)
        for reader in self._readers:
            reader.join(5)
        errors = "".join(self._errors).strip()
        code = self._process.poll()
        return f"canopus {what}" + (f", exit code {code}" if code is not None else "") + (f":\n{errors}" if errors else "")

    def _close(self) -> None:
        for plc in self.plcs.values():
            plc.close()
        if self._control is not None:
            self._control.close()
        for reader in self._readers:
            reader.join(5)
        for stream in (self._process.stdout, self._process.stderr):
            if stream is not None:
                stream.close()

    def _read_events(self, stream: TextIO) -> None:
        for line in stream:
            try:
                event = json.loads(line)
            except (ValueError, RecursionError):
                continue
            with self._news:
                self.events.append(event)
                self._news.notify_all()
        with self._news:
            self._has_ended = True
            self._news.notify_all()

    def _read_errors(self, stream: TextIO) -> None:
        for line in stream:
            self._errors.append(line)


def _place(address: str) -> tuple[str, int]:
    host, port = address.rsplit(":", 1)
    return host.strip("[]"), int(port)
