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
from kit import (ANSWER, PATIENCE, PYTHON, ROOT, Skip, attempts, check, command, covers, first_plant, host_port, program, require, running,
                 scratch, silence)


SPEED = r"in [0-9.]+ (?:us|ms|s), [0-9.]+ times"  # of a run in virtual time


def blocks(page, language=""):
    """The code blocks of a page that are in this language, as lists of lines."""
    text = (ROOT / page).read_text()
    return [found.splitlines() for kind, found in re.findall(r"(?ms)^```(\w*)\n(.*?)^```$", text) if kind == language]


def shown_commands(block):
    """(command, lines shown) of each `$ command` of a block."""
    commands = []
    for line in block:
        if line.startswith("$ "):
            commands.append((re.sub(r"\s+# .*", "", line[2:]), []))
        elif commands:
            commands[-1][1].append(line)
    return commands


def transcripts(page):
    """The shown commands of a page, block by block."""
    for block in blocks(page):
        if commands := shown_commands(block):
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


def require_shown(page, words, shown, varying=(), folder=scratch):
    """Runs a command of a page until it prints what the page shows: a plant in real time is not there at once."""
    end = time.monotonic() + PATIENCE
    while True:
        done = subprocess.run(words, stdout=subprocess.PIPE, stderr=subprocess.STDOUT, text=True, timeout=5 * PATIENCE,
                              cwd=folder)
        said = [line for line in done.stdout.splitlines() if not line.startswith("Running as user")]  # tshark as root
        different = differs(shown, said, varying)
        if different is None:
            return
        again = words[1:2] == ["scan"] or words[1:3] in (["plc", "read"], ["sdo", "read"], ["lss", "identify"], ["lss", "inquire"])  # they change nothing
        require(again and time.monotonic() < end, f"{page} shows {different!r}, {shlex.join(words)} says:\n{done.stdout}")
        time.sleep(0.05)


def words_of(command, plant, examples=f"{ROOT}/examples/"):
    """A command of a page with this plant's ports, the program under test and the examples' full paths."""
    words = [re.sub("^examples/", examples, word) for word in shlex.split(command)]
    if words[0] not in ("canopus", "build/canopus"):
        return words
    words[0] = program
    if words[1:3] == ["plc", "signals"]:
        return words  # it asks no PLC
    if words[1] == "plc":
        words += ["--plc", host_port(plant.mc)[1]]
    elif words[1] in ("scan", "sdo", "nmt", "lss", "master"):
        words += ["--bus", f"socketcand:{plant.socketcand}"]
        if words[1] == "master" or words[1:3] == ["sdo", "write"]:
            words += ["--timeout", ANSWER]
    return words


@check
def the_readme_shows_what_the_commands_print():
    (scratch / "examples").symlink_to(ROOT / "examples")
    with first_plant() as plant:
        for commands in transcripts("README.md"):
            for command, shown in commands:
                require_shown("README.md", words_of(command, plant, "examples/"), shown, (SPEED, r"5A[0-9A-F]{2}H"))


def named_commands(page):
    """The commands of a page, in its text and in its blocks: line number, words behind `canopus`."""
    for number, line in enumerate(page.read_text().splitlines(), 1):
        texts = re.findall(r"`(?:build/)?canopus ([^`]+)`", line)
        if block := re.match(r"(?:\$ )?(?:build/)?canopus (.*)", line):
            texts.append(re.sub(r"\s+#.*", "", block[1]))
        for text in texts:
            with contextlib.suppress(ValueError):  # a quote that goes on in the next line
                yield number, shlex.split(text)


@check
def every_command_and_option_of_the_pages_exists():
    helps = {}

    def help_of(path):
        if path not in helps:
            helps[path] = command(program, *path, "--help").stdout
        return helps[path]

    def inner(path):
        _, _, listed = help_of(path).partition("\nSubcommands:\n")
        return [path + (word,) for word in re.findall(r"(?m)^  ([a-z][\w-]*)", listed.partition("\n\n")[0])]

    def has(path, option):
        return (re.search(rf"(?m)(^|[\s,]){re.escape(option)}([\s,=\[]|$)", help_of(path)) is not None
                or any(has(one, option) for one in inner(path)))  # canopus plc --modbus: of those in it

    pages = [ROOT / "README.md", *sorted((ROOT / "docs").rglob("*.md")), *sorted((ROOT / "examples").rglob("*.md"))]
    wrong = []
    for page in pages:
        for number, words in named_commands(page):
            path = ()
            while len(path) < len(words) and path + (words[len(path)],) in inner(path):
                path += (words[len(path)],)
            place = f"{page.relative_to(ROOT)}:{number}: canopus {' '.join(words)[:60]}"
            if not path and words and re.fullmatch(r"[a-z-]*[a-z]", words[0]) and not words[0].startswith("-"):
                wrong.append(f"{place}: no such command")
            wrong += [f"{place}: {word}" for word in (re.match(r"--[\w-]+|", word)[0] for word in words)
                      if word and not has(path, word)]
    require(len(helps) > 50 and not wrong, "\n".join(wrong))


@check
def the_readme_names_files_that_exist():
    text = (ROOT / "README.md").read_text()
    for name in re.findall(r"examples/[\w./-]+", text):
        require((ROOT / name).is_file(), f"README.md names {name}")
    for line in re.findall(r"`canopus ([^`\n]+)`", text):  # what needs hardware or a browser is not run: its options must exist
        words = line.split()
        usage = command(program, *[word for word in words[:2] if word.isalpha()], "--help").stdout
        require(all(word in usage for word in words if word.startswith("--")), f"README.md: canopus {line}")


@check
def python_can_reads_the_encoder_as_the_page_of_commands_shows():
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python3-can is not installed")
    page = "docs/commands.md"
    (snippet,) = blocks(page, "python")
    with first_plant() as plant:
        text = "\n".join(snippet)
        require("port=29536" in text, "the snippet names another port than the first plant's")
        text = text.replace("port=29536", f"port={host_port(plant.socketcand)[1]}")
        require_shown(page, [PYTHON, "-c", text], ["position 1234"], (r"\d+",))


@check
def signals_are_read_and_written_by_name_as_the_page_shows():
    page = "docs/mc-protocol.md"
    with first_plant() as plant:
        for commands in transcripts(page):
            for command, shown in commands:
                require_shown(page, words_of(command, plant), shown)


@check
def tshark_decodes_a_run_as_the_page_of_traces_shows():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    for commands in transcripts("docs/traces.md"):
        for command, shown in commands:
            require_shown("docs/traces.md", words_of(command, None), shown)


def of_the_page_of_commands(of_lss):
    """What the page shows of LSS, or all else."""
    for commands in transcripts("docs/commands.md"):
        for command, shown in commands:
            if command.startswith("canopus lss ") == of_lss:
                yield command, shown


@check
@attempts(2)
def the_page_of_commands_shows_what_lss_prints():
    with running(lss_example("plant.toml", "lss-page"), has_plc=False) as lss, \
            running(lss_example("other-rate.toml", "rate-page"), has_plc=False) as other_rate:
        for command, shown in of_the_page_of_commands(of_lss=True):
            words = words_of(command.replace("--timeout 20ms", f"--timeout {silence(100)}"), other_rate if " lss search " in command else lss)
            require_shown("docs/commands.md", words, shown)


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
    with running(devices, has_plc=False) as plant:
        for command, shown in of_the_page_of_commands(of_lss=False):
            words = words_of(command.replace("--timeout 2s", f"--timeout {ANSWER}"), plant)
            if words[1] == "master":
                shown = ["...", *shown]  # a heartbeat may come before the first reset
            require_shown(page, words, shown, (r" *\d+\.\d{6}  ", r"\d+\.\d s ago"))


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
                    command = command.replace(f"--plc {written}", f"--plc {host_port(address)[1]}")
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
        command(program, "plc", "write", "U0\\G71", "10", "--plc", host_port(plant.mc)[1], expect=1)
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
def one_program_on_two_modules_does_what_the_how_to_of_the_migration_shows():
    page = "docs/how-to/migrate-fx2n-32can-to-fx3u-can.md"
    for commands in transcripts(page):
        for command, shown in commands:
            require_shown(page, words_of(command, None), shown)


@check
def the_page_of_the_library_names_its_blocks():
    page = (ROOT / "docs/structured-text-library.md").read_text()
    internal = {"CANOPEN_SDO", "CANOPEN_COMMAND_TRANSFER", "CANOPEN_HANDSHAKE", "CANOPEN_COLLECT_EMCY", "CANOPEN_KEEP_EMCY", "CANOPEN_ADD_PDO"}
    for path in sorted((ROOT / "canopus/plant/libraries/canopen").glob("*.st")):
        for name in re.findall(r"(?m)^FUNCTION(?:_BLOCK)? (\w+)", path.read_text()):
            require((f"`{name}`" in page) != (name in internal), f"{path.name}: {name}")


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
def troubleshooting_shows_what_the_commands_print():
    page = "docs/troubleshooting.md"
    for commands in transcripts(page):
        for command, shown in commands:
            require_shown(page, words_of(command, None), shown)


@check
def troubleshooting_lists_mistakes_that_check_refuses():
    """Each mistake of its last table is refused where the right spelling is accepted."""
    plant = """
        [[bus]]
        name = "line1"
        bit_rate = 250_000
        [[device]]
        name = "io"
        node = 2
        eds = "{0}/examples/devices/io-block.eds"
        [[device.behaviour]]
        object = "6000:01"
        kind = "counter"
        [[plc]]
        [[plc.module]]
        model = "ME3CAN1-Q"
        head = 0
        node = 1
        master = true
        exchange = "20ms"
        [[plc.module.slave]]
        node = 2
        receive = [{{ pdo = 1, at = "G10000" }}]
    """.format(ROOT)
    text = (ROOT / "docs/troubleshooting.md").read_text().split("## The plant file is refused")[1].split("## ")[0]
    rows = re.findall(r"(?m)^\| `([^`]+)`[^|]*\| `([^`]+)`", text)
    require(len(rows) >= 6, "the table is gone")
    path = scratch / "mistake.toml"
    path.write_text(plant)
    command(program, "check", path)
    for wrong, right in rows:
        require(right in plant, f"the plant has no {right}")
        path.write_text(plant.replace(right, wrong))
        command(program, "check", path, expect=2)


@check
def a_pc_replaces_a_module_as_its_page_shows():
    """Two processes: the devices of the page's first command, and the module on their bus."""
    page = "docs/how-to/replace-a-module.md"
    shutil.copytree(ROOT / "examples", scratch / "examples")  # a store is written beside its plant
    for name in ("devices", "module"):
        path = scratch / f"examples/real-bus/{name}.toml"
        path.write_text(path.read_text().replace("127.0.0.1:29536", "127.0.0.1:0").replace("127.0.0.1:5007", "127.0.0.1:0"))
    (starts, reads) = list(transcripts(page))
    (devices, _), (module, _) = starts
    with running(scratch / devices.split()[2], has_plc=False) as bus:
        words = [word.replace("127.0.0.1:29536", bus.socketcand) for word in module.split()[3:]]
        with running(scratch / module.split()[2], words=words, is_served=False) as plant:
            for command, shown in reads:
                require_shown(page, words_of(command, plant), shown, (r" *[0-9.]+ s  U0\\G10000 +\d+  [0-9A-F]{4}H",))


@check
def the_tutorial_leads_where_it_says():
    """Its files are written and its commands run in their order. A plant in real time runs until the tutorial has ended."""
    page = "docs/tutorial.md"
    folder = scratch / "tutorial"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    (folder / "examples").symlink_to(ROOT / "examples")
    varying = (SPEED, r" *[0-9.]+ s  U0\\G10004 +\d+  [0-9A-F]{4}H")
    with contextlib.ExitStack() as stack:
        plant = None
        for language, found in re.findall(r"(?ms)^```(\w*)\n(.*?)^```$", (ROOT / page).read_text()):
            if language == "toml":
                # "# plant.toml", "# added to plant.toml", "# added to plant.toml as other.toml"
                first = found.splitlines()[0].split()
                base = folder / (first[3] if first[1] == "added" else "")
                (folder / first[-1]).write_text((base.read_text() if base != folder else "") + found)
                continue
            for line, shown in shown_commands(found.splitlines()):
                words = shlex.split(line)
                if words[0] == "canopus":
                    words[0] = program
                if words[1] == "run" and "--virtual" not in words:
                    plant = stack.enter_context(running(folder / words[2], operational=[1, 2, 3], words=["--free-ports"],
                                                        is_served=False))
                    continue
                if words[1] == "plc":
                    words += ["--plc", host_port(plant.mc)[1]]
                require_shown(page, words, shown, varying, folder)
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
