"""A PLC as a program sees it."""
from __future__ import annotations

import time
from types import TracebackType
from typing import Any, Callable, TypeVar

from .connection import CpuConnection, PlantControl
from .devices import Bits, BufferMemories, DeviceWords, Words
from .errors import PlantError
from .mc import DEVICES, McClient
from .mc_1e import Mc1eClient

Value = TypeVar("Value")

#: How often a PLC without a control server is asked again, in seconds.
POLL_INTERVAL = 0.01


class Plc:
    """Reads and writes a PLC over the MC protocol.

    Bit devices are x y m l f v b sb sm s, and ts tc sts stc cs cc (contacts and coils); word devices d w sw sd r zr z, and tn
    stn cn (current values). `g[n]` is the buffer memory of the module whose head I/O number is 16 * n. An index is a number, or a
    string as people write it: plc.x["1F"]. A range is one request for each 960 words or 7168 bits, and of one moment when it
    fits into one.
    """

    def __init__(self, host: str = "127.0.0.1", port: int = 5007, *, timeout: float = 5.0, frame: str = "3E",
                 octal: bool = False, control: PlantControl | None = None, name: str | None = None,
                 client: CpuConnection | None = None) -> None:
        """`timeout` in seconds, to connect and for each answer; `frame` is "3E", "4E" or "1E" (as an FX3's and FX5's
        ports speak); `octal`: X and Y are counted in octal, as by
        an FX, when an index is a string. `control` and `name`: the control server of
        the plant that this PLC is in, and its name there. They come from `Plant`. `client`: takes the place of a connection."""
        self.mc: CpuConnection
        if client is not None:
            self.mc = client
        elif frame == "1E":
            self.mc = Mc1eClient(host, port, timeout)
        else:
            self.mc = McClient(host, port, timeout=timeout, frame=frame)
        self.name = name
        self._control = control
        self._octal = octal
        self.g = BufferMemories(self.mc)
        bits, words = self._bits, self._words
        self.x, self.y, self.m, self.l, self.f = bits("X"), bits("Y"), bits("M"), bits("L"), bits("F")  # noqa: E741
        self.v, self.b, self.sb, self.sm, self.s = bits("V"), bits("B"), bits("SB"), bits("SM"), bits("S")
        self.ts, self.tc, self.sts, self.stc = bits("TS"), bits("TC"), bits("STS"), bits("STC")
        self.cs, self.cc = bits("CS"), bits("CC")
        self.d, self.w, self.sw, self.sd = words("D"), words("W"), words("SW"), words("SD")
        self.r, self.zr, self.z = words("R"), words("ZR"), words("Z")
        self.tn, self.stn, self.cn = words("TN"), words("STN"), words("CN")
        self.rd, self.hg = words("RD"), words("U3E0\\HG")

    def _bits(self, name: str) -> Bits:
        device = DEVICES[name]
        return Bits(self.mc, device._replace(base=8) if self._octal and name in ("X", "Y") else device)

    def _words(self, name: str) -> Words:
        return Words(DeviceWords(self.mc, DEVICES[name]))

    def close(self) -> None:
        self.mc.close()

    def __enter__(self) -> Plc:
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None) -> None:
        self.close()

    @property
    def cpu_name(self) -> str:
        """As the CPU names itself: "R04CPU"."""
        return self.mc.cpu_name()

    def remote_run(self) -> None:
        self.mc.remote_run()

    def remote_stop(self) -> None:
        self.mc.remote_stop()

    def remote_pause(self) -> None:
        self.mc.remote_pause()

    def run(self, *, scans: int | None = None, seconds: float | None = None, until: str | None = None) -> int:
        """Lets the plant run until so many scans of this PLC have ended, so much plant time has passed, or a condition holds
        ("X1", "D100 >= 5", "U0\\\\G601 == 5"): the first of them. How many scans have ended meanwhile."""
        if scans is None and seconds is None and until is None:
            raise ValueError("run() needs scans, seconds or until")
        return int(self._run(scans, seconds, until)["scans"])

    def _run(self, scans: int | None, seconds: float | None, until: str | None) -> dict[str, Any]:
        if self._control is None:
            raise PlantError("only a PLC of a Plant can be run; this one runs by itself")
        fields: dict[str, Any] = {}
        if self.name is not None:
            fields["plc"] = self.name
        if scans is not None:
            fields["scans"] = scans
        if seconds is not None:
            fields["for"] = plant_duration(seconds)
        if until is not None:
            fields["until"] = until
        return self._control.ask("run", **fields)

    def wait(self, condition: str | Callable[[], Value], timeout: float = 10.0) -> Value | bool:
        """Lets the plant run, scan by scan, until the condition is true; what it gave then. It is a function, or a string as
        run() takes it, which is looked at inside the plant and much faster. `timeout` in seconds of plant time; TimeoutError when
        they are over. Of a PLC that is in no Plant, seconds are those of the clock."""
        if isinstance(condition, str):
            if not self._run(None, timeout, condition)["met"]:
                raise TimeoutError(f"{condition!r} did not come true within {timeout:g} s")
            return True
        start = self._now()
        while not (value := condition()):
            if self._now() - start >= timeout:
                raise TimeoutError(f"the condition did not come true within {timeout:g} s")
            if self._control is None:
                time.sleep(POLL_INTERVAL)
            else:
                self._run(1, None, None)
        return value

    def _now(self) -> float:
        return time.monotonic() if self._control is None else self._control.time


def plant_duration(seconds: float) -> str:
    """As plant files and the control server write a time."""
    if not seconds > 0:
        raise ValueError(f"{seconds} seconds: expected more than 0")
    return f"{round(seconds * 1e6)}us"
