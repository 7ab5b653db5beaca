"""Traces of real runs, judged by tshark and python-can; a replay, heard by a client of its own."""
import csv
import json
import shutil
import subprocess
import time

from kit import PYTHON, ROOT, RawClient, Skip, check, command, first_plant, first_plant_file, program, require, scratch


def recorded_as(extension):
    path = scratch / f"formats.{extension}"
    command(program, "run", first_plant_file(), "--virtual", "--for", "5s", "--seed", "7", "--quiet", "--trace", path)
    return path


def python_can_frames(path, kind):
    """Identifier and data of each frame, and its time in us since the first one."""
    code = ("import sys, can\n"
            f"messages = list({kind}(sys.argv[1]))\n"
            "for m in messages: print(m.arbitration_id, bytes(m.data).hex() or '-', round((m.timestamp - messages[0].timestamp) * 1e6))\n")
    return command(PYTHON, "-c", code, path).stdout.splitlines()


@check
def a_run_is_recorded_alike_in_every_format():
    done = subprocess.run([PYTHON, "-c", "import can"], capture_output=True)
    if done.returncode != 0:
        raise Skip("python3-can is not installed")
    log = python_can_frames(recorded_as("log"), "can.CanutilsLogReader")
    require(len(log) > 500, f"only {len(log)} frames in the log")
    for extension, kind in (("asc", "can.ASCReader"), ("trc", "can.TRCReader")):
        frames = python_can_frames(recorded_as(extension), kind)
        require(frames == log, f"{extension}: python-can reads {len(frames)} frames, {len(log)} of the log")
    with open(recorded_as("csv"), newline="") as file:
        rows = list(csv.DictReader(file))
    first = float(rows[0]["time"])
    frames = [f"{int(row['id'], 16)} {bytes.fromhex(row['data']).hex() or '-'} {round((float(row['time']) - first) * 1e6)}"
              for row in rows]
    require(frames == log, "csv: other frames than in the log")


@check
def tshark_reads_the_captures_of_a_run_alike():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    fields = ["-T", "fields", "-e", "frame.time_epoch", "-e", "can.id", "-e", "can.len", "-d", "can.subdissector,canopen",
              "-e", "_ws.col.Info"]
    pcap, pcapng = (command("tshark", "-r", recorded_as(extension), *fields).stdout for extension in ("pcap", "pcapng"))
    require(pcap.count("\n") > 500, "the pcap is almost empty")
    require(pcap == pcapng, "the pcap and the pcapng differ")
    names = command("tshark", "-r", recorded_as("pcapng"), "-T", "fields", "-e", "frame.interface_name").stdout
    require(set(names.split()) == {"line1"}, "the interface is not named as the bus")


@check
def traces_of_other_programs_are_counted_as_tshark_counts_them():
    folder = ROOT.parent / "shared" / "data" / "traces"
    if not shutil.which("tshark") or not folder.is_dir():
        raise Skip("tshark or ../shared/data/traces is not there")
    for path in sorted(folder.glob("*.pcapng")):
        counted = command("tshark", "-r", path, "-Y", "can", "-T", "fields", "-e", "frame.number").stdout.count("\n")
        info = json.loads(command(program, "trace", "info", path, "--json").stdout)
        require(info["frames"] + info["error_frames"] == counted, f"{path.name}: {info['frames']} frames, tshark has {counted}")


@check
def diff_ends_as_diff_does():
    log = recorded_as("log")
    asc = recorded_as("asc")
    command(program, "trace", "diff", log, asc, "--ignore-channels", "--tolerance", "0ms", "-q")
    lines = log.read_text().splitlines()
    changed = scratch / "changed.log"
    changed.write_text("\n".join(lines[:100] + lines[101:]) + "\n")
    done = command(program, "trace", "diff", log, changed, expect=1)
    require("1 only in" in done.stdout and done.stdout.startswith("- "), done.stdout[:500])
    command(program, "trace", "diff", log, scratch / "nothing.log", expect=2)


@check
def an_output_nobody_reads_ends_a_conversion_quietly():
    big = scratch / "big.log"
    big.write_text("(1.000000) can0 123#0102030405060708\n" * 200000)
    done = subprocess.run(f"{program} trace convert {big} - --to csv | head -1", shell=True, capture_output=True, text=True)
    require(done.stdout.startswith("time,"), done.stdout[:200])
    require("terminate" not in done.stderr, done.stderr[:500])


@check
def a_replay_keeps_the_times_of_the_trace():
    path = scratch / "replay.log"
    path.write_text("(10.000000) a 123#01\n(10.300000) a 124#02\n(10.400000) a 1ABCDEF0#03\n")
    with first_plant() as plant:
        client = RawClient(plant)
        start = time.monotonic()
        done = command(program, "replay", path, "--bus", f"socketcand:{plant.socketcand}")
        require(time.monotonic() - start >= 0.4, "the replay was faster than the trace")
        require("3 frames sent" in done.stdout, done.stdout)
        heard = []
        while len(heard) < 3:
            words = client.element()
            if words[0] == "frame" and words[1].upper() in ("123", "124", "1ABCDEF0"):
                heard.append((words[1].upper(), float(words[2])))
        require([name for name, _ in heard] == ["123", "124", "1ABCDEF0"], str(heard))
        apart = heard[1][1] - heard[0][1]
        require(0.25 < apart < 2, f"the second frame came after {apart} s instead of 0.3 s")
        done = command(program, "replay", path, "--bus", f"socketcand:{plant.socketcand}", "--speed", "max", "--loop", "5", "--id", "123-124")
        require("10 frames sent" in done.stdout, done.stdout)
