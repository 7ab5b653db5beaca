"""What a plant was doing when a test failed, as lines for its report."""
from __future__ import annotations

import json
from typing import Any, Iterable, Mapping

#: Events that a report shows at most.
MOST_EVENTS = 20


def boot_reasons(events: Iterable[Mapping[str, Any]]) -> list[str]:
    """A line for each slave whose boot has not ended well, from the events of a run: "node 2 (io-block): failed (D, ...)"."""
    latest: dict[tuple[Any, Any], Mapping[str, Any]] = {}
    for event in events:
        if event.get("event") == "boot slave":
            latest[event.get("bus"), event.get("node")] = event
    lines = []
    for (_, node), event in latest.items():
        if event.get("step") != "booted":
            name = f" ({event['name']})" if event.get("name") else ""
            lines.append(f"node {node}{name}: {event.get('reason') or event.get('step')}")
    return lines


def describe(time: float, states: Mapping[str, str], events: list[Any], trace: Any = None) -> str:
    """Plant time, NMT states, boot reasons, the latest events, and the file with the frames."""
    lines = [f"time {time:g} s"]
    lines += [_printable(f"{name}: {state}") for name, state in states.items()]
    lines += [_printable(line) for line in boot_reasons(events)]
    lines += [f"frames: {trace}"] if trace is not None else []
    lines += [_printable(json.dumps(event, ensure_ascii=False)) for event in events[-MOST_EVENTS:]]
    return "\n".join(lines)


def _printable(text: str) -> str:
    return "".join(letter if letter.isprintable() else letter.encode("unicode_escape").decode() for letter in text)
