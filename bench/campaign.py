#!/usr/bin/env python3
"""Speed of campaigns: runs and seconds of plant time for each second of a processor, and of the clock.

    bench/campaign.py [--program build/canopus] [--runs 100] [--plant examples/five-modules/plant.toml] [--duration 60s]

Quiet, with a frame in a hundred corrupted, and a run of 1 ms, which is what building a plant costs; on one thread and on two. And what a
report of the results costs."""
import argparse
import json
import pathlib
import resource
import subprocess
import sys
import tempfile
import time
import tomllib

root = pathlib.Path(__file__).resolve().parent.parent


def seconds(text):
    for unit, factor in (("ms", 1e-3), ("min", 60), ("s", 1)):
        if text.endswith(unit):
            return float(text[: -len(unit)]) * factor
    raise SystemExit(f"{text}: expected a time, for example 60s")


def measured(command, folder):
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    started = time.monotonic()
    run = subprocess.run(command, cwd=folder, capture_output=True, text=True)
    if run.returncode not in (0, 1):
        raise SystemExit(run.stderr)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return time.monotonic() - started, after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime


def memory_of(command, folder):
    """Seconds of a processor, and MB at most, of one process. A process's maximum includes the one that it was forked from: so a small one forks it."""
    small = ("import os, subprocess, sys; p = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL); "
             "u = os.wait4(p.pid, 0)[2]; print(u.ru_utime + u.ru_stime, u.ru_maxrss / 1024)")
    text = subprocess.run([sys.executable, "-c", small, *command], cwd=folder, capture_output=True, text=True, check=True).stdout
    return tuple(map(float, text.split()))


def report_of(program, results, runs):
    """What a report of so many runs costs, and a campaign that continues behind them: of copies of the lines that are there, in order,
    and as they come while it runs."""
    lines = (results / "results.jsonl").read_text().splitlines()
    seeds = json.loads(lines[0])["seeds"]
    head = lines[0].replace(f'"seeds":{seeds}', f'"seeds":{runs}')
    rows = [lines[1 + i % seeds].replace(f'"seed":{1 + i % seeds},', f'"seed":{1 + i},') for i in range(runs)]
    with tempfile.TemporaryDirectory() as folder:
        shown = f"{runs:>7} runs:"
        for name, order in (("results.jsonl", rows), ("results.part.jsonl", sorted(rows, key=hash))):
            pathlib.Path(folder, name).write_text("\n".join([head, *order]) + "\n")
            cpu, memory = memory_of([program, "campaign", "report", folder, "--output", f"{folder}/report"], folder)
            pathlib.Path(folder, name).unlink()
            shown += f"  report of {name} {cpu:.2f} s of a processor, {1e6 * cpu / runs:.0f} us a run, {memory:.0f} MB;"
        return shown


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--program", default=str(root / "build" / "canopus"))
    parser.add_argument("--plant", default=str(root / "examples" / "five-modules" / "plant.toml"))
    parser.add_argument("--duration", default="60s")
    parser.add_argument("--runs", type=int, default=100)
    arguments = parser.parse_args()
    program = str(pathlib.Path(arguments.program).resolve())
    plant = pathlib.Path(arguments.plant).resolve()
    buses = [bus["name"] for bus in tomllib.loads(plant.read_text())["bus"]]
    corrupt = "".join(f'[[rule]]\nname = "corrupt {bus}"\nchance = 1\nbus = "{bus}"\nfault = {{ kind = "corrupt", probability = 0.01 }}\n' for bus in buses)
    print(f"{'':<22}{'runs/s':>10}{'plant s/s':>11}{'runs/cpu s':>12}{'plant s/cpu s':>15}{'ms/run':>9}")
    for name, rules, duration in (("building a plant", "", "1ms"), ("quiet", "", arguments.duration), ("1 % corrupted", corrupt, arguments.duration)):
        for jobs in (1, 2):
            with tempfile.TemporaryDirectory() as folder:
                pathlib.Path(folder, "c.toml").write_text(
                    f'[campaign]\nplant = "{plant}"\nduration = "{duration}"\nseeds = {arguments.runs}\n{rules}'
                    '[[invariant]]\nname = "up"\nkind = "operational"\nwithin = "1h"\n')
                wall, cpu = measured([program, "campaign", "c.toml", "--jobs", str(jobs)], folder)
                plant_time = arguments.runs * seconds(duration)
                print(f"{name + f', {jobs} job' + 's' * (jobs > 1):<22}{arguments.runs / wall:>10.1f}{plant_time / wall:>11.0f}"
                      f"{arguments.runs / cpu:>12.1f}{plant_time / cpu:>15.0f}{1000 * cpu / arguments.runs:>9.2f}")
                if name == "building a plant" and jobs == 1:
                    reports = [report_of(program, pathlib.Path(folder, "c.results"), runs) for runs in (1_000, 10_000, 100_000)]
    print("\n".join(reports))


if __name__ == "__main__":
    main()
