#!/usr/bin/env python3
"""Many seeds of passengers for the lift program of examples/lift: everyone arrives, and nothing is unsafe.

usage: lift_campaign.py [--seeds 1000] [--first 1] [--jobs 2] [--passengers 20] [--minutes 4] [--program build/canopus] [--structured-text]

With --structured-text the PLC's own program (lifts.st) controls the lifts, instead of program.py.

Each seed is a run of the example's plant in virtual time with its own passengers. Prints a line every 50 seeds, each run that is not
good with what the lift program said, and at the end the count, waiting times and the time of the whole campaign. Exit code 1 when a run
was not good.
"""
import argparse
import concurrent.futures
import json
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


UNSAFE = ("door_open_between_floors", "door_open_while_moving", "overload_travels", "overspeeds")


def plant(folder, passengers, minutes, structured_text):
    """The example's plant with other passengers, whose seed is the plant's."""
    text = (EXAMPLE / ("programmed.toml" if structured_text else "plant.toml")).read_text()
    text = text.replace('"lifts.st"', f'"{EXAMPLE}/lifts.st"')
    text = re.sub(r"(?m)^\[lift\.passengers\]\n(?:.+\n)*",
                  f'[lift.passengers]\ncount = {passengers}\nfrom = "10s"\nuntil = "{10 + 60 * minutes:g}s"\n', text)
    path = pathlib.Path(folder) / "plant.toml"
    path.write_text(text)
    return path


def run_program_of_the_plc(seed, path, arguments):
    """Until everyone had five minutes more than the last one to come; the result as program.py words it."""
    end = 10 + 60 * arguments.minutes + 300
    done = subprocess.run([str(arguments.program), "run", str(path), "--virtual", "--for", f"{end:g}s", "--seed", str(seed), "--json"],
                          capture_output=True, text=True, timeout=1800)
    events = [json.loads(line) for line in done.stdout.splitlines() if '"summary"' in line or '"event":"error"' in line]
    text = "".join(f"{event['source']}: {event['message']}\n" for event in events if event["event"] == "error") + done.stderr
    good = done.returncode == 0 and not text
    for lifts in events[-1]["lifts"] if events and events[-1]["event"] == "summary" else []:
        text += (f"{lifts['arrived']} of {lifts['passengers']} passengers arrived after {end:.0f} s; "
                 f"waiting {lifts['mean_waiting']:.1f} s (at most {lifts['longest_waiting']:.1f} s)\n")
        unsafe = {name: sum(car[name] for car in lifts["cars"]) for name in UNSAFE}
        text += "".join(f"UNSAFE: {count} {name}\n" for name, count in unsafe.items() if count)
        good = good and lifts["arrived"] == lifts["passengers"] and not any(unsafe.values())
    return seed, 0 if good else 1, text


def run(seed, path, arguments):
    if arguments.structured_text:
        return run_program_of_the_plc(seed, path, arguments)
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
    parser.add_argument("--structured-text", action="store_true", help="the PLC's own program controls the lifts")
    arguments = parser.parse_args()
    begin = time.monotonic()
    arrived = passengers = seconds = bad = 0
    waiting, longest, done = 0.0, 0.0, 0
    with tempfile.TemporaryDirectory() as folder, concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        path = plant(folder, arguments.passengers, arguments.minutes, arguments.structured_text)
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
