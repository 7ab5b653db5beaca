"""What the frames of a trace mean."""
from __future__ import annotations

import json
import os
from typing import Any, Mapping

from . import _core


def decode(trace: str | os.PathLike[str], *, plant: str | os.PathLike[str] = "", network: str | os.PathLike[str] = "",
           nodes: Mapping[int, str | os.PathLike[str]] | None = None, frames: bool = False) -> list[dict[str, Any]]:
    """What `canopus trace show --json` says of a trace, in any format that is read (docs/traces.md, docs/analyser.md): a
    dictionary for each message. Names come from a `plant` file, a `network` file, or device files (EDS, DCF) by node-ID.
    `frames`: every frame; SDO transfers are not folded. PlantError names the file and the place that cannot be read."""
    files = [f"{node}={os.fspath(file)}" for node, file in (nodes or {}).items()]
    lines = _core.decode_trace(os.fspath(trace), os.fspath(plant), os.fspath(network), files, frames)
    return [json.loads(line) for line in lines.splitlines()]
