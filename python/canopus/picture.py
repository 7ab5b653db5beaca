"""Pictures of a bus over time, and tables, for notebooks."""
from __future__ import annotations

import base64
import html
import os
import pathlib
from typing import Any, Iterable, Mapping, Sequence

from canopus_plc.errors import PlantError

from . import _core


class Picture:
    """Load of a bus, values of PDOs and states of the nodes over time, as SVG. A notebook shows it by itself."""

    def __init__(self, source: _core.PlantPicture | tuple[str, list[str]], title: str) -> None:
        self._source, self.title = source, title

    @property
    def svg(self) -> str:
        """As it is now."""
        return self._source[0] if isinstance(self._source, tuple) else self._source.svg(self.title)

    @property
    def missing(self) -> list[str]:
        """Signals that were asked for and have not come: "3.6004:00"."""
        return self._source[1] if isinstance(self._source, tuple) else self._source.missing

    def save(self, path: str | os.PathLike[str]) -> None:
        """Writes the SVG file."""
        try:
            pathlib.Path(path).write_text(self.svg, encoding="utf-8")
        except OSError as error:
            raise PlantError(f"{os.fspath(path)}: cannot write it: {error.strerror or error}") from error

    def _repr_html_(self) -> str:
        # As an image: its styles stay inside, and nothing in it is run.
        data = base64.b64encode(self.svg.encode()).decode()
        return f'<img alt="{html.escape(self.title)}" src="data:image/svg+xml;base64,{data}">'


def draw(trace: str | os.PathLike[str], *, signals: Sequence[str] = (), bit_rate: int = 0, plant: str | os.PathLike[str] = "",
         network: str | os.PathLike[str] = "", nodes: Mapping[int, str | os.PathLike[str]] | None = None) -> Picture:
    """A picture of a trace, as `canopus trace plot` draws it. `signals`: values of PDOs, such as "encoder.6004" or "3.6004:00";
    without one the first eight that come. `bit_rate` in bit/s: the load in per cent, else in kbit/s. Names as of decode().
    PlantError names the file and the place that cannot be read, or the signal."""
    files = [f"{node}={os.fspath(file)}" for node, file in (nodes or {}).items()]
    title = os.path.basename(os.fspath(trace))
    return Picture(_core.draw_trace(os.fspath(trace), os.fspath(plant), os.fspath(network), files, list(signals), bit_rate, title), title)


def _table(caption: str, heads: Sequence[str], rows: Iterable[Sequence[Any]]) -> str:
    """As HTML; every text is only text."""
    def row(cells: Sequence[Any], tag: str) -> str:
        return "<tr>" + "".join(f"<{tag}>{html.escape(str(cell))}</{tag}>" for cell in cells) + "</tr>"
    return f"<table><caption>{html.escape(caption)}</caption>{row(heads, 'th')}{''.join(row(cells, 'td') for cells in rows)}</table>"
