#!/usr/bin/env python3
"""Many seeds of passengers for the lift program of examples/lift: everyone arrives, and nothing is unsafe.

usage: lift_campaign.py [--seeds 1000] [--first 1] [--jobs 2] [--passengers 20] [--minutes 4] [--program build/canopus]

Each seed is a run of the example's plant in virtual time with its own passengers. Prints a line every 50 seeds, each run that is not
good with what the lift program said, and at the end the count, waiting times and the time of the whole campaign. Exit code 1 when a run
was not good.
"""
import argparse
import concurrent.futures
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
EXAMPLE = ROOT / "examples" / "lift"
SUMMARY = re.compile(r"(\d+) of (\d+) passengers arrived after (\d+) s; waiting ([\d.]+) s \(at most ([\d.]+) s\)")


def plant(folder, passengers, minutes):
    """The example's plant with other passengers, whose seed is the plant's."""
    text = (EXAMPLE / "plant.toml").read_text()
    text = re.sub(r"(?m)^\[lift\.passengers\]\n(?:.+\n)*",
                  f'[lift.passengers]\ncount = {passengers}\nfrom = "10s"\nuntil = "{10 + 60 * minutes:g}s"\n', text)
    path = pathlib.Path(folder) / "plant.toml"
    path.write_text(text)
    return path


def run(seed, path, arguments):
    command = [sys.executable, EXAMPLE / "program.py", "--plant", path, "--seed", str(seed), "--scan", "0.1",
               "--until", str(10 + 60 * arguments.minutes)]
    environment = {**os.environ, "CANOPUS_PROGRAM": str(pathlib.Path(arguments.program).resolve())}
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True, env=environment, timeout=1800)
    return seed, done.returncode, done.stdout + done.stderr


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n\n")[0])
    parser.add_argument("--seeds", type=int, default=1000)
    parser.add_argument("--first", type=int, default=1)
    parser.add_argument("--jobs", type=int, default=os.cpu_count())
    parser.add_argument("--passengers", type=int, default=20)
    parser.add_argument("--minutes", type=float, default=4)
    parser.add_argument("--program", default=ROOT / "build" / "canopus")
    arguments = parser.parse_args()
    begin = time.monotonic()
    arrived = passengers = seconds = bad = 0
    waiting, longest, done = 0.0, 0.0, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        path = plant(folder, arguments.passengers, arguments.minutes)
        seeds = range(arguments.first, arguments.first + arguments.seeds)
        for seed, code, text in pool.map(lambda seed: run(seed, path, arguments), seeds):
            done += 1
            found = SUMMARY.search(text)
            if found:
                arrived += int(found[1])
                passengers += int(found[2])
                seconds += int(found[3])
                waiting += float(found[4])
                longest = max(longest, float(found[5]))
            if code != 0 or not found:
                bad += 1
                print(f"seed {seed}: exit code {code}\n{text}", flush=True)
            if done % 50 == 0:
                print(f"{done} of {arguments.seeds} seeds, {bad} not good, {time.monotonic() - begin:.0f} s", flush=True)
    print(f"{done} seeds, {bad} not good: {arrived} of {passengers} passengers arrived, waiting {waiting / max(1, done):.1f} s "
          f"(at most {longest:.1f} s); {seconds / 3600:.1f} h of plant time in {time.monotonic() - begin:.0f} s")
    return 1 if bad or not done else 0


if __name__ == "__main__":
    sys.exit(main())
