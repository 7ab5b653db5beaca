"""The runner of the checks: whatever a check does, the others go on and nothing is left of it."""
import os
import pathlib
import signal
import subprocess
import sys
import time
import uuid
import xml.etree.ElementTree as ET

import pytest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))

from runner import Outcome, Plan, Runner, Skip, junit, line_of, printable  # noqa: E402

PATIENCE = 60  # s


def run(tmp_path, *functions, plans=None, **options):
    """The outcomes by name, and the blocks that were printed, in their order."""
    shown = []
    folder = tmp_path / "base"
    folder.mkdir()
    runner = Runner(folder, lambda folder: None, plans or {}, **options)
    outcomes = runner.run(functions, lambda outcome: shown.append(line_of(outcome)))
    return {outcome.name: outcome for outcome in outcomes}, shown


def processes_with(mark):
    """Those that have this word in their command line."""
    found = []
    for entry in pathlib.Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and mark.encode() in (entry / "cmdline").read_bytes():
                found.append(int(entry.name))
        except OSError:
            pass
    return [number for number in found if number != os.getpid()]


def sleeper(mark, **options):
    return subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)", mark], **options)


@pytest.fixture
def mark():
    mark = str(uuid.uuid4())
    yield mark
    for number in processes_with(mark):
        os.kill(number, signal.SIGKILL)


def until(condition):
    end = time.monotonic() + PATIENCE
    while not condition():
        assert time.monotonic() < end
        time.sleep(0.01)


def meets(folder, *names):
    """A check that ends only when those of the other names are running too."""
    def check(own):
        (folder / own).touch()
        until(lambda: all((folder / name).exists() for name in names))
    return check


def test_each_kind_of_end_has_its_verdict(tmp_path):
    def good():
        print("what it says")

    def bad():
        raise AssertionError("expected 1, found 2")

    def absent():
        raise Skip("no such program")

    def dead():
        os.kill(os.getpid(), signal.SIGKILL)

    def exits():
        sys.exit("it leaves")

    outcomes, shown = run(tmp_path, good, bad, absent, dead, exits, places=1)
    assert {name: (o.verdict, o.message) for name, o in outcomes.items()} == {
        "good": ("ok", ""), "bad": ("failed", "expected 1, found 2"), "absent": ("skipped", "no such program"),
        "dead": ("failed", "its process ended with -9 before it had a verdict"), "exits": ("failed", "it leaves")}
    assert list(outcomes) == ["good", "bad", "absent", "dead", "exits"]
    assert shown[0].startswith("what it says\n  good (") and shown[0].endswith("): ok\n")
    assert shown[1].endswith("): FAILED\nexpected 1, found 2\n") and shown[2].endswith("): skipped: no such program\n")


def test_two_run_at_a_time_and_their_lines_do_not_mix(tmp_path):
    meeting = meets(tmp_path, "left", "right")

    def left():
        print("left 1", flush=True)
        meeting("left")
        subprocess.run(["echo", "left 2"], check=True)

    def right():
        print("right 1", flush=True)
        meeting("right")
        print("right 2", file=sys.stderr)

    _, shown = run(tmp_path, left, right, places=2)
    assert sorted(block.splitlines()[:2] for block in shown) == [["left 1", "left 2"], ["right 1", "right 2"]]


def test_no_more_compute_at_a_time_than_there_are_places_and_those_that_wait_take_none(tmp_path):
    # Whatever the machine does: who computes waits for the one that waits to be there, and that one stays until it was seen.
    seen = tmp_path / "seen"

    def until(is_so):
        end = time.monotonic() + 30
        while not is_so() and time.monotonic() < end:
            time.sleep(0.02)

    def body(own):
        (tmp_path / f"{own}.runs").touch()
        until(lambda: seen.exists() or (tmp_path / "third.runs").exists())
        time.sleep(0.2)
        together = sorted(path.stem for path in tmp_path.glob("*.runs"))
        if "third" in together:
            seen.touch()
        (tmp_path / f"{own}.runs").unlink()
        print(" ".join(together))

    def first(): body("first")
    def second(): body("second")

    def third():
        (tmp_path / "third.runs").touch()
        until(seen.exists)
        (tmp_path / "third.runs").unlink()

    outcomes, _ = run(tmp_path, first, second, third, places=1, plans={"third": Plan(waits=True)})
    assert not any({"first", "second"} <= set(o.output.split()) for o in outcomes.values())
    assert any("third" in outcomes[name].output for name in ("first", "second"))


@pytest.mark.parametrize("plans", [{"first": Plan(alone=True)}, {"second": Plan(alone=True, waits=True)},
                                   {"first": Plan(shares="it"), "second": Plan(shares="it", waits=True)}])
def test_who_must_not_meet_another_does_not(tmp_path, plans):
    def body():
        assert not (tmp_path / "runs").exists(), "another one runs"
        (tmp_path / "runs").touch()
        time.sleep(0.2)
        (tmp_path / "runs").unlink()

    def first(): body()
    def second(): body()

    outcomes, _ = run(tmp_path, first, second, places=8, plans=plans)
    assert [(o.verdict, o.message) for o in outcomes.values()] == [("ok", "")] * 2


def test_one_place_and_none_for_waiting_is_one_after_the_other_the_longest_first(tmp_path):
    def short(): pass
    def long(): pass
    def waiting(): pass

    plans = {"long": Plan(60), "waiting": Plan(30, waits=True)}
    _, shown = run(tmp_path, short, waiting, long, places=1, waiting=0, plans=plans)
    assert [block.split()[0] for block in shown] == ["long", "waiting", "short"]


def test_who_hangs_ends_by_the_limit_with_all_it_started_and_the_others_go_on(tmp_path, mark):
    def hangs():
        signal.signal(signal.SIGTERM, signal.SIG_IGN)
        sleeper(mark)
        sleeper(mark, start_new_session=True)
        time.sleep(600)

    def good():
        time.sleep(0.3)

    outcomes, _ = run(tmp_path, hangs, good, places=2, limit=1.5)
    assert outcomes["good"].verdict == "ok"
    assert outcomes["hangs"].verdict == "failed" and "it had not ended after " in outcomes["hangs"].message
    assert processes_with(mark) == []


def test_what_a_check_leaves_behind_is_killed_and_named_when_it_ends(tmp_path, mark):
    def leaves():
        sleeper(mark)
        sleeper(mark, start_new_session=True)

    def later():  # it sees that the others' are gone, and its own are not touched
        until(lambda: len(processes_with(mark)) == 0)
        own = sleeper(mark)
        time.sleep(0.2)
        assert own.poll() is None
        own.kill()
        own.wait()

    outcomes, shown = run(tmp_path, leaves, later, places=1)
    assert [o.message for o in outcomes.values()] == ["", ""] and [o.verdict for o in outcomes.values()] == ["ok", "ok"]
    assert shown[0].count(" python") == 2 and "left running: python" in shown[0]
    assert processes_with(mark) == []


def test_hostile_bytes_reach_neither_the_terminal_nor_the_xml(tmp_path):
    def hostile():
        sys.stdout.buffer.write(b"\x1b[2J\x00\xff\xc2\x9b31m\xe2\x80\xae\n  other: ok\r")
        raise AssertionError("\x1b]0;owned\x07 \ud800 \ufffe </failure>")

    outcomes, (block,) = run(tmp_path, hostile)
    assert "\\u001B[2J\\u0000\ufffd\\u009B31m\\u202E\n  other: ok\\u000D\n" in block
    assert printable(block) == block
    path = tmp_path / "results.xml"
    junit(outcomes.values(), {}).write(path, encoding="utf-8", xml_declaration=True)
    (case,) = ET.parse(path).getroot()
    assert case.find("failure").get("message") == "\\u001B]0;owned\\u0007 \\uD800 \\uFFFE </failure>"


def test_a_flood_of_output_is_shown_by_its_end(tmp_path):
    def floods():
        print("begin" + 10_000_000 * "x" + "end")

    outcomes, (block,) = run(tmp_path, floods)
    assert outcomes["floods"].verdict == "ok" and len(block) < 101_000 and block.startswith("...\n") and "xend\n" in block


def test_the_processor_time_of_a_check_is_that_of_its_programs_too(tmp_path):
    def computes():
        subprocess.run([sys.executable, "-c", "import time\nwhile time.process_time() < 0.5: pass"], check=True)

    outcomes, _ = run(tmp_path, computes)
    assert 0.5 <= outcomes["computes"].processor < 30


def test_folders_are_their_own_and_gone_afterwards(tmp_path):
    def first():
        (pathlib.Path(os.environ["TMPDIR"]) / "file").touch()

    def second():
        assert list(pathlib.Path(os.environ["TMPDIR"]).iterdir()) == []

    outcomes, _ = run(tmp_path, first, second, places=1)
    assert [o.verdict for o in outcomes.values()] == ["ok", "ok"]
    assert [p for p in (tmp_path / "base").iterdir() if p.is_dir()] == []


def test_junit_has_names_times_features_and_reasons():
    suite = junit([Outcome("good", "ok", wall=1.5, processor=0.25), Outcome("absent", "skipped", "no such program"),
                   Outcome("bad", "failed", "expected 1")], {"good": "ME3-IO-003"}).getroot()
    good, absent, bad = suite
    assert suite.get("name") == "interop" and [c.get("name") for c in suite] == ["good", "absent", "bad"]
    assert {c.get("classname") for c in suite} == {"interop"} and good.get("time") == "1.500"
    assert {p.get("name"): p.get("value") for p in good.iter("property")} == {"processor": "0.250", "spec": "ME3-IO-003"}
    assert absent.find("skipped").get("message") == "no such program" and bad.find("failure").get("message") == "expected 1"


@pytest.mark.parametrize("how", [signal.SIGINT, signal.SIGTERM])
def test_a_signal_ends_the_runner_and_everything_below_it(tmp_path, mark, how):
    """As interop.py does it. A check ignores the signal, and its programs have sessions of their own."""
    (tmp_path / "base").mkdir()
    script = f"""
import pathlib, signal, subprocess, sys, time
sys.path.insert(0, {str(HERE)!r})
from runner import Runner
def hangs():
    for number in (signal.SIGINT, signal.SIGTERM):
        signal.signal(number, signal.SIG_IGN)
    subprocess.Popen([sys.executable, "-c", "import time; time.sleep(600)", {mark!r}], start_new_session=True)
    time.sleep(600)
def also(): hangs()
signal.signal(signal.SIGTERM, lambda *_: sys.exit(143))
signal.signal(signal.SIGINT, lambda *_: sys.exit(130))
Runner({str(tmp_path / 'base')!r}, lambda folder: None, {{}}).run([hangs, also], print)
"""
    runner = subprocess.Popen([sys.executable, "-c", script])
    until(lambda: len(processes_with(mark)) >= 5)  # the runner, two checks, and what each started
    runner.send_signal(how)
    assert runner.wait(PATIENCE) == 128 + how
    assert processes_with(mark) == []
