"""Checks of the lift example: the lift program a user copies from, in step and in real time."""
import os
import re
import sys

from kit import PATIENCE, ROOT, check, command, host_port, program, require, running, scratch, talking

EXAMPLE = ROOT / "examples/lift"
PASSENGERS = r"(?m)^\[lift\.passengers\]\n(?:.+\n)*"


def plant_with(name, passengers, seconds, listen=None):
    """The example's plant with fewer passengers, all of whom come within so many seconds."""
    text = (EXAMPLE / "plant.toml").read_text()
    text = re.sub(PASSENGERS, f'[lift.passengers]\ncount = {passengers}\nfrom = "5s"\nuntil = "{5 + seconds}s"\n', text)
    if listen:
        text = re.sub(r"127\.0\.0\.1:\d+", listen, text)
    path = scratch / f"{name}.toml"
    path.write_text(text)
    return path


def lift_program(*words, timeout=PATIENCE):
    return command(sys.executable, EXAMPLE / "program.py", *words, timeout=timeout, env={**os.environ, "CANOPUS_PROGRAM": program})


@check
def the_lift_program_brings_everyone_where_they_want():
    svg = scratch / "lift.svg"
    path = plant_with("lift", 12, 90)
    runs = [lift_program("--plant", path, "--seed", seed, "--until", 95, "--svg", svg, timeout=5 * PATIENCE).stdout for seed in (7, 7, 8)]
    for said in runs:
        require(re.match(r"12 of 12 passengers arrived after \d+ s; waiting [\d.]+ s", said), said)
        require(re.search(r"(?m)^lift 2: \d+ m, \d+ starts, \d+ door cycles", said) and "UNSAFE" not in said, said)
    require(runs[0] == runs[1] != runs[2], "one seed, two runs:\n" + "\n".join(runs))
    require(svg.read_text().lstrip().startswith(("<svg", "<?xml")), "no SVG")


@check
def the_lift_program_of_the_plc_brings_everyone_where_they_want():
    said = command(sys.executable, ROOT / "tests/soak/lift_campaign.py", "--structured-text", "--seeds", 6, "--jobs", 1, "--passengers", 12,
                   "--minutes", 1.5, "--program", program, timeout=5 * PATIENCE).stdout
    require(said.startswith("6 seeds, 0 not good: 72 of 72 passengers arrived, waiting "), said)


@check
def the_lift_program_controls_a_plant_in_real_time():
    path = plant_with("lift-now", 1, 2, listen="127.0.0.1:0")
    with running(path) as plant:
        with talking(sys.executable, EXAMPLE / "program.py", "--connect", ":".join(host_port(plant.mc))):
            seen = {what: plant.wait(lambda e, what=what: e["event"] == "lift" and e["what"] == what)
                    for what in ("call registered", "door opened", "passenger boarded", "started", "passenger arrived")}
    require(seen["passenger boarded"]["t"] < seen["passenger arrived"]["t"], str(seen))
