"""Checks of `canopus new`: the plant that it writes boots, its test passes, and a bus is found again."""
import os

from kit import ANSWER, PYTHON, ROOT, check, command, program, require, running, scratch

DEVICES = ROOT / "examples/devices"
MODULES = ("ME3CAN1-Q", "RJ71CN91", "FX3U-CAN", "FX2N-32CAN", "AS-FCOPM")


@check
def new_plants_boot_and_their_tests_pass():
    """The lines that the command prints boot the plant of each module, and run the test that it writes."""
    for module in MODULES:
        folder = scratch / module
        printed = command(program, "new", folder, "--module", module, "--device", DEVICES / "io-block.eds", "--device",
                          f"9={DEVICES / 'drive.eds'}", "--test").stdout.splitlines()
        run = next(line for line in printed if line.startswith("canopus run ")).split()
        ran = command(program, *run[1:])
        require("all 3 nodes operational" in ran.stdout, f"{module}: {ran.stdout}")
        words = next(line for line in printed if "pytest" in line).split()
        settings = dict(word.split("=", 1) for word in words[:words.index("python3")])
        environment = {**os.environ, **settings, "CANOPUS_PROGRAM": program, "PYTHONDONTWRITEBYTECODE": "1"}
        tested = command(PYTHON, *words[words.index("python3") + 1:], "-q", "-p", "no:cacheprovider", env=environment)
        require("1 passed" in tested.stdout, f"{module}: {tested.stdout}")


@check
def a_bus_becomes_a_plant():
    """The devices of a running plant, found by --from-bus, boot in the new one under the same node-IDs and names."""
    old = scratch / "old"
    command(program, "new", old, "--module", "ME3CAN1-Q", "--device", f"5={DEVICES / 'encoder.eds'}", "--device", f"12={DEVICES / 'drive.eds'}")
    text = (old / "plant.toml").read_text()
    (old / "plant.toml").write_text(text.replace("bit_rate = 250000", 'bit_rate = 250000\nserve = "socketcand:127.0.0.1:0"')
                                    .replace("127.0.0.1:5007", "127.0.0.1:0"))
    with running(old / "plant.toml") as plant:
        command(program, "new", scratch / "found", "--module", "RJ71CN91", "--from-bus", "--eds", DEVICES, "--bus",
                f"socketcand:{plant.socketcand}", "--timeout", ANSWER)
    ran = command(program, "run", scratch / "found/plant.toml", "--virtual", "--expect-operational=60s")
    for node in (5, 12):
        require(f"node {node} (" in ran.stdout, ran.stdout)
    require("all 3 nodes operational" in ran.stdout, ran.stdout)


@check
def new_without_a_terminal_asks_nothing():
    """Where no user can answer, what is missing is said, and the exit code is 2."""
    done = command(program, "new", scratch / "nothing", expect=2, stdin=open(os.devnull, encoding="utf-8"))
    require("--module is missing" in done.stderr, done.stderr)
    require(not (scratch / "nothing").exists(), "something was written")
