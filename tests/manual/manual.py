#!/usr/bin/python3
"""Plays the procedures and example programs of the modules' manuals against the program. Writes JUnit XML.

usage: manual.py [--program build/canopus] [--results build/results/manual.xml] [--only NAME] [--jobs N] [--list]

Plays run side by side (tests/interop/runner.py), each in a process and a folder of its own, in virtual time.
"""
import argparse
import os
import pathlib
import re
import shutil
import signal
import sys
import tempfile
import time

import rig
from runner import Plan, Runner, junit, line_of

import as_fcopm  # noqa: F401  (registers its plays)
import fx2n_32can  # noqa: F401
import fx3u_can  # noqa: F401
import fx3u_can_modes  # noqa: F401
import me3can1_q  # noqa: F401
import rj71cn91  # noqa: F401

LIMIT = 900  # s for one play


def the_list_names_every_play():
    """README.md beside this file has the same sections and plays as the marks."""
    listed, module = set(), None
    for line in (pathlib.Path(__file__).parent / "README.md").read_text().splitlines():
        if line.startswith("## "):
            module = line[3:]
        elif module and line.startswith("| "):
            section, cell = line.strip("| ").split(" | ", 1)
            listed |= {(module, section, name) for name in re.findall(r"`([a-z0-9]+_[a-z0-9_]+)`", cell)}
    marked = {(play.module, section, play.__name__) for play in rig.plays for section in play.sections}
    assert len({play.__name__ for play in rig.plays}) == len(rig.plays), "two plays have one name"
    assert listed == marked, f"not in README.md: {sorted(marked - listed)}; no such mark: {sorted(listed - marked)}"


def main():
    parser = argparse.ArgumentParser(description="Plays the procedures of the manuals against the program.")
    parser.add_argument("--program", type=pathlib.Path, default=rig.ROOT / "build/canopus")
    parser.add_argument("--results", type=pathlib.Path)
    parser.add_argument("--only", help="only plays whose name or module contains this")
    parser.add_argument("--jobs", type=int, default=os.cpu_count(), help="plays at one time")
    parser.add_argument("--list", action="store_true", help="print the plays with module and sections, and run none")
    arguments = parser.parse_args()
    plays = [*rig.plays]
    if arguments.list:
        for play in plays:
            print(f"{play.module:10} {', '.join(play.sections):30} {play.__name__}")
        return 0
    if arguments.only:
        plays = [play for play in plays if arguments.only in play.__name__ or arguments.only == play.module]
    else:
        plays.append(the_list_names_every_play)
    if not plays:
        sys.exit(f"{parser.prog}: no play is called {arguments.only}")
    rig.program = str(arguments.program.resolve())
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
    base = pathlib.Path(tempfile.mkdtemp(prefix="canopus-manual-"))
    begin = time.monotonic()
    try:
        plans = {play.__name__: Plan(1) for play in plays}
        outcomes = Runner(base, rig.prepare, plans, places=arguments.jobs, limit=LIMIT).run(
            plays, lambda outcome: print(line_of(outcome), end="", flush=True))
    finally:
        shutil.rmtree(base, ignore_errors=True)
    if arguments.results:
        arguments.results.parent.mkdir(parents=True, exist_ok=True)
        junit(outcomes, {}, "manual").write(arguments.results, encoding="utf-8", xml_declaration=True)
    failed = [outcome.name for outcome in outcomes if outcome.verdict == "failed"]
    print(f"{len(outcomes) - len(failed)} of {len(outcomes)} passed in {time.monotonic() - begin:.0f} s")
    if failed:
        print(f"failed: {', '.join(failed)}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
