"""Checks of what the documentation shows: its commands are run as they are written, their output must be what is printed there."""
import contextlib
import pathlib
import re
import shlex
import shutil
import socket
import subprocess
import time

from foreign_stack_checks import lss_example
from kit import (PATIENCE, PYTHON, ROOT, Skip, check, command, covers, first_plant, host_port, program, require, running,
                 scratch, silence)


def blocks(page, language=""):
    """The code blocks of a page that are in this language, as lists of lines."""
    text = (ROOT / page).read_text()
    return [found.splitlines() for kind, found in re.findall(r"(?ms)^```(\w*)\n(.*?)^```$", text) if kind == language]


def transcripts(page):
    """(command, lines shown) of each `$ command` of a page, block by block."""
    for block in blocks(page):
        commands = []
        for line in block:
            if line.startswith("$ "):
                commands.append((re.sub(r"\s+# .*", "", line[2:]), []))
            elif commands:
                commands[-1][1].append(line)
        if commands:
            yield commands


def differs(shown, said, varying):
    """None if the output is what a page shows, else the line of the page that is not there. A line of dots stands for any number
    of lines; `varying` are regular expressions whose matches may differ."""
    def same(line):
        return "".join(f"(?:{part})" if at % 2 else re.escape(part) for at, part in enumerate(split(line)))

    def split(line):
        places = sorted(((m.start(), m.end(), p) for p in varying for m in re.finditer(p, line)), key=lambda p: p[:2])
        parts, end = [], 0
        for start, stop, pattern in places:
            if start >= end:
                parts += [line[end:start], pattern]
                end = stop
        return [*parts, line[end:]]

    skipping, place = False, 0
    for line in shown:
        if line.strip() == "...":
            skipping = True
            continue
        wanted = re.compile(same(line))
        while skipping and place < len(said) and not wanted.fullmatch(said[place]):
            place += 1
        if place == len(said) or not wanted.fullmatch(said[place]):
            return line
        place, skipping = place + 1, False
    return None if skipping or place == len(said) else "(the end)"


def require_shown(page, words, shown, varying=()):
    """Runs a command of a page until it prints what the page shows: a plant in real time is not there at once."""
    end = time.monotonic() + PATIENCE
    while True:
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=5 * PATIENCE,
                              cwd=scratch)
        said = [line for line in done.stdout.splitlines() if not line.startswith("Running as user")]  # tshark as root
        different = differs(shown, said, varying)
        if different is None:
            return
        again = words[1:2] == ["scan"] or words[1:3] in (["plc", "read"], ["sdo", "read"])  # they change nothing
        require(again and time.monotonic() < end, f"{page} shows {different!r}, {shlex.join(words)} says:\n{done.stdout}")
        time.sleep(0.05)


def words_of(command, plant):
    """A command of a page with this plant's ports, the program under test and the examples' full paths."""
    words = [re.sub("^examples/", f"{ROOT}/examples/", word) for word in shlex.split(command)]
    if words[0] not in ("canopus", "build/canopus"):
        return words
    words[0] = program
    if words[1] == "plc":
        words += ["--port", host_port(plant.mc)[1]]
    elif words[1] in ("scan", "sdo", "nmt", "lss", "master"):
        words += ["--bus", f"socketcand:{plant.socketcand}"]
    return words


@check
def the_readme_shows_what_the_commands_print():
    varying = (r"in [0-9.]+ (?:us|ms|s), \d+ times", r"5A[0-9A-F]{2}H", r"\d+  [0-9A-F]{8}H")
    with first_plant() as plant:
        for commands in transcripts("README.md"):
            for command, shown in commands:
                words = words_of(command, plant)
                if not shutil.which(words[0]):
                    print(f"    {words[0]} is absent: {command!r} is not run")
                    continue
                require_shown("README.md", words, shown, varying)


@check
def the_readmes_python_reads_the_encoder():
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python3-can is not installed")
    (snippet,) = blocks("README.md", "python")
    with first_plant() as plant:
        text = "\n".join(snippet)
        require("port=29536" in text, "the snippet names another port than the first plant's")
        text = text.replace("port=29536", f"port={host_port(plant.socketcand)[1]}")
        require_shown("README.md", [PYTHON, "-c", text], ["position 1234"], (r"\d+",))


@check
def the_page_of_commands_shows_what_they_print():
    page = "docs/commands.md"
    network = (ROOT / "examples/network-without-plc/network.toml").read_text()
    devices = scratch / "page-devices.toml"
    devices.write_text((ROOT / "examples/network-without-plc/devices.toml").read_text()
                       .replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{ROOT}/examples/devices/'))
    failing = network.replace('"../devices/', f'"{ROOT}/examples/devices/').replace("node = 4\n", "node = 4\nvendor = 0x195\n")
    require("0x195" in failing, "network.toml has no node 4")
    (scratch / "network.toml").write_text(failing)  # as the page says of it
    with running(devices, has_plc=False) as plant, running(lss_example("plant.toml", "lss-page"), has_plc=False) as lss, \
            running(lss_example("other-rate.toml", "rate-page"), has_plc=False) as other_rate:
        for commands in transcripts(page):
            for command, shown in commands:
                on = other_rate if " lss search " in command else lss if " lss " in command else plant
                words = words_of(command.replace("--timeout 20ms", f"--timeout {silence(100)}"), on)
                require_shown(page, words, shown, (r" *\d+\.\d{6}  ",))


@check
@covers("ME3-IO-003")
def words_go_from_rack_to_rack_as_the_example_shows():
    text = (ROOT / "examples/two-racks/plant.toml").read_text()
    for port in ("29536", "5007", "5008"):
        text = text.replace(f"127.0.0.1:{port}", "127.0.0.1:0")
    (scratch / "two-racks.toml").write_text(text)
    page = "examples/two-racks/README.md"
    with running(scratch / "two-racks.toml") as plant:
        plant.wait_operational([1, 2])
        second = plant.wait(lambda e: e["event"] == "listen" and e["of"] == "plc2")["address"]
        for commands in transcripts(page):
            for command, shown in commands:
                for written, address in (("5007", plant.mc), ("5008", second)):
                    command = command.replace(f"--port {written}", f"--port {host_port(address)[1]}")
                words = [program, *shlex.split(command)[1:]]
                if words[1] == "scan":
                    words += ["--bus", f"socketcand:{plant.socketcand}"]
                require_shown(page, words, shown)


@contextlib.contextmanager
def forced_inputs():
    """The example with its control server, on ports of the system's choice; the plant and the server's address."""
    text = (ROOT / "examples/forced-inputs/plant.toml").read_text()
    for port in ("29540", "29536", "5007"):
        text = text.replace(f"127.0.0.1:{port}", "127.0.0.1:0")
    shutil.copy(ROOT / "examples/forced-inputs/light-barrier.csv", scratch)
    (scratch / "forced-inputs.toml").write_text(text.replace('"../devices/', f'"{ROOT}/examples/devices/'))
    with running(scratch / "forced-inputs.toml") as plant:
        plant.wait_operational([1, 2])
        yield plant, plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "control")["address"]


@check
def a_forced_input_arrives_in_the_plc_as_the_page_shows():
    page = "docs/control.md"
    with forced_inputs() as (plant, control):
        for commands in transcripts(page):
            for command, shown in commands:
                words = words_of(command, plant)
                if words[1] == "module":
                    continue  # of another plant
                if words[1] == "device":
                    words += ["--at", control]
                require_shown(page, words, shown)
        plant.wait(lambda e: e["event"] == "released" and e["object"] == "6401:01")
        (snippet,) = blocks(page, "python")
        text = "\n".join(snippet)
        require("29540" in text, "the snippet names another port than the page")
        require_shown(page, [PYTHON, "-c", text.replace("29540", host_port(control)[1])], ["3"])
        exchange = next(b for b in blocks(page) if b[0].startswith("> ") and '"set"' in b[0])
        with socket.create_connection(("127.0.0.1", int(host_port(control)[1]))) as client:
            lines = client.makefile("rw")
            for line in exchange:
                if line.startswith("> "):
                    print(line[2:], file=lines, flush=True)
                else:
                    said = lines.readline().rstrip("\n")
                    different = differs([line[2:]], [said], (r'"t":[0-9.]+',))
                    require(different is None, f"{page} shows {line!r}, the plant says {said!r}")
        plant.wait(lambda e: e["event"] == "forced" and e["object"] == "6000:01" and e["value"] == 1)  # the script's


@check
def module_status_is_what_its_page_shows():
    page = "docs/control.md"
    path = scratch / "module-status.toml"
    path.write_text(f"""
        [plant]
        control = "127.0.0.1:0"
        [[bus]]
        name = "field"
        bit_rate = 250_000
        serve = "socketcand:127.0.0.1:0"
        [[device]]
        node = 2
        eds = "{ROOT}/examples/devices/io-block.eds"
        [[plc]]
        name = "plc1"
        listen = "127.0.0.1:0"
        [[plc.module]]
        model = "RJ71CN91"
        head = 0x00
        node = 1
    """)
    with running(path) as plant:
        control = plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == "control")["address"]
        plant.wait(lambda e: e["event"] == "boot" and e["node"] == 1)
        command(program, "plc", "write", "U0\\G71", "10", "--port", host_port(plant.mc)[1], expect=1)
        shown = [lines for commands in transcripts(page) for words, lines in commands if words == "canopus module status"]
        require(len(shown) == 1, f"{page} shows module status {len(shown)} times")
        require_shown(page, [program, "module", "status", "--at", control], shown[0])


@check
def a_plant_without_the_key_cannot_be_controlled():
    with first_plant() as plant:
        require(not [e for e in plant.events if e["event"] == "listen" and e["protocol"] == "control"], "it listens")


@check
def the_stuck_slaves_example_says_what_its_how_to_shows():
    page = "docs/how-to/why-is-my-slave-stuck.md"
    for commands in transcripts(page):
        for command, shown in commands:
            require_shown(page, words_of(command, None), shown)


@check
def the_page_of_the_analyser_shows_what_the_commands_print():
    for commands in transcripts("docs/analyser.md"):
        for command, shown in commands:
            line = re.sub("(^| )examples/", rf"\1{ROOT}/examples/", command)
            if ">" in line or line.startswith("tshark"):
                continue  # tests/interop/trace_decode_checks.py loads the script
            words = shlex.split(line)
            require_shown("docs/analyser.md", [program, *words[1:]], shown)


@check
def the_tutorial_leads_where_it_says():
    """Its files are written and its commands run in their order; what takes a real second says so by having no `$`."""
    page = "docs/tutorial.md"
    folder = scratch / "tutorial"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "examples").symlink_to(ROOT / "examples")
    varying = (r"in [0-9.]+ (?:us|ms|s), \d+ times",)
    for language, found in re.findall(r"(?ms)^```(\w*)\n(.*?)^```$", (ROOT / page).read_text()):
        if language == "toml":
            head = found.splitlines()[0]
            base = (re.findall(r"added to (\S+)", head) or [None])[0]        # "# added to plant.toml as other.toml"
            before = (folder / base).read_text() if base else ""
            (folder / head.split()[-1]).write_text(before + found)
            continue
        commands = []
        for line in found.splitlines():
            if line.startswith("$ "):
                commands.append((line[2:], []))
            elif commands:
                commands[-1][1].append(line)
        for words, shown in commands:
            done = subprocess.run([program, *shlex.split(words)[1:]], stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True,
                                  timeout=PATIENCE, cwd=folder)
            different = differs(shown, done.stdout.splitlines(), varying)
            require(different is None, f"{page} shows {different!r}, {words} says:\n{done.stdout}")
    require((folder / "wire.vcd").stat().st_size > 10000 and not (folder / "state").exists(), "the last step left no waveform")


@check
def the_site_of_the_documentation_is_made_without_a_broken_link():
    if not shutil.which("mkdocs"):
        raise Skip("mkdocs is not installed")
    site = pathlib.Path(command(PYTHON, ROOT / "tools/documentation", program, timeout=10 * PATIENCE).stdout.splitlines()[-1]).parent
    commands = (site / "docs/reference/all-commands/index.html").read_text()
    require("canopus trace convert" in commands and "--expect-operational" in commands, "the page of all commands is incomplete")
    require("error_status" in (site / "docs/reference/words/index.html").read_text(), "the page of words is incomplete")
    require((site / "search/search_index.json").stat().st_size > 100_000, "the search finds nothing")
