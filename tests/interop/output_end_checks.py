"""Checks of how an output ends: its reader goes, the disk is full; and what names from outside may do to it."""
import json
import re
import signal
import socket
import subprocess
import threading

from output_checks import started, mc_address
from kit import (PATIENCE, ROOT, check, first_plant_file, program, require, scratch)


# --- the reader goes, the disk is full


@check
def the_run_ends_with_its_reader():
    """`canopus run ... | head -5`"""
    for words in (["--json"], [], ["--virtual", "--json"], ["--virtual"]):
        with started("run", first_plant_file(), *words) as (process, lines):
            for _ in range(5):
                lines.line()
            process.stdout.close()
            require(process.wait(timeout=PATIENCE) == -signal.SIGPIPE, f"{words}: ended with {process.returncode}")
            require(process.stderr.read() == b"", "it says something")


@check
def a_full_disk_is_an_error_of_every_command():
    plant = first_plant_file()
    eds = ROOT / "examples/devices/encoder.eds"
    with started("run", plant, "--json") as (_, lines):
        host, port = mc_address(lines)
        commands = [["--help"], ["--version"], ["run", "--help"], ["check", plant], ["eds", "check", eds],
                    ["eds", "check", "--json", eds], ["module", "list"], ["module", "info", "me3can1-q"],
                    ["module", "eds", "me3can1-q"], ["plc", "read", "D100", "--plc", port], ["plc", "type", "--plc", port],
                    ["plc", "watch", "D100", "--plc", port], ["run", plant], ["run", plant, "--json"],
                    ["run", plant, "--virtual", "--for", "2s"], ["run", plant, "--virtual", "--for", "2s", "--json"]]
        for words in commands:
            with open("/dev/full", "wb") as full:
                done = subprocess.run([program, *map(str, words)], stdout=full, stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
            require(done.returncode == 1, f"{words}: exit code {done.returncode}")
            require(done.stderr == "canopus: cannot write the output: No space left on device\n", f"{words}: {done.stderr}")


@check
def a_closed_output_is_no_file_of_the_run():
    """Without the care for it the trace would get the number of the standard output, and the lines."""
    trace = scratch / "closed-output.log"
    done = subprocess.run(["sh", "-c", f"exec '{program}' run '{first_plant_file()}' --virtual --for 2s --trace '{trace}' >&-"],
                          stderr=subprocess.PIPE, text=True, timeout=PATIENCE)
    require(done.returncode == 1 and "cannot write the output: Bad file descriptor" in done.stderr, done.stderr)
    for line in trace.read_text().splitlines():
        require(re.fullmatch(r"\(\d+\.\d+\) line1 [0-9A-F]{3}#[0-9A-FR]*", line), f"a line of the trace: {line}")


# --- names from outside

HOSTILE = "x\x1b]0;owned\x07\x1b[2J\ncanopus: forged\x9b\u202e\u2028"


def require_harmless(text, where):
    wrong = re.search("[\x00-\x09\x0b-\x1f\x7f-\x9f\u2028\u2029\u202a-\u202e\u2066-\u2069]", text)
    require(not wrong, f"{where}: {wrong and ascii(text[max(0, wrong.start() - 40):wrong.end() + 10])}")
    require(not re.search("(?m)^canopus: forged", text), f"{where}: a forged line:\n{text}")


def every_word_of(words, **options):
    done = subprocess.run([program, *map(str, words)], capture_output=True, timeout=PATIENCE, **options)
    return (done.stdout + done.stderr).decode("utf-8", "strict")


@check
def names_from_outside_control_no_terminal():
    escaped = json.dumps(HOSTILE)
    text = first_plant_file().read_text()
    plant = scratch / "hostile.toml"
    plant.write_text(text.replace('name = "encoder"', f"name = {escaped}"))
    require("owned" in plant.read_text(), "the plant has no device named encoder")
    eds = scratch / "hostile.eds"
    content = (ROOT / "examples/devices/encoder.eds").read_bytes()
    eds.write_bytes(re.sub(rb"(?m)^(ParameterName)=.*$", b"\\1=bad\x1b[31m\xc2\x9b2Jname\x85 \xe2\x80\xae", content, count=3) + b"\n[\x1b[2J]\n\x1b]0;t\x07=1\n1000=\x1b[2J\n")
    wrong = scratch / "wrong-name.toml"
    wrong.write_text(f"[[bus]]\nname = {escaped}\nbit_rate = 250000\n[[device]]\nname = {escaped}\nbus = {escaped}\nnode = 200\n"
                     f"eds = {escaped}\n")
    shown = every_word_of(["run", plant, "--virtual", "--for", "3s"])
    require("x\\x1B]0;owned\\x07\\x1B[2J\\ncanopus: forged\\u009B\\u202E\\u2028" in shown, ascii(shown))
    require_harmless(shown, "run")
    lines = every_word_of(["run", plant, "--virtual", "--for", "3s", "--json"])
    require_harmless(lines, "run --json")
    names = {json.loads(line).get("name") for line in lines.splitlines()}
    require(HOSTILE in names, f"the JSON says another name: {names}")
    for words in (["check", plant], ["check", wrong], ["run", wrong], ["eds", "check", eds], ["eds", "check", "--json", eds],
                  ["check", HOSTILE], ["eds", "check", HOSTILE], ["nonsense" + HOSTILE], ["plc", "read", HOSTILE],
                  ["module", "info", HOSTILE], ["sdo", "read", HOSTILE, "1000"], ["scan", "--bus", HOSTILE]):
        require_harmless(every_word_of(words), words)


@check
def answers_of_a_socketcand_server_control_no_terminal():
    server = socket.create_server(("127.0.0.1", 0))

    def serve():
        peer, _ = server.accept()
        with peer:
            peer.sendall(b"< hi >")
            peer.recv(100)
            peer.sendall(b"< error \x1b[2J\x1b]0;owned\x07 \xc2\x9b31m >")
            peer.recv(100)

    threading.Thread(target=serve, daemon=True).start()
    shown = every_word_of(["scan", "--bus", f"socketcand:127.0.0.1:{server.getsockname()[1]}/can0"])
    require("error" in shown or "refuse" in shown, shown)
    require_harmless(shown, "scan")
