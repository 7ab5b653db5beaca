"""Programs of python-can on a bus of a plant. What is expected is written out, or was put on the bus by the test."""
import asyncio
import os
import pathlib
import subprocess
import sys
import threading
import time

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
can = pytest.importorskip("can", reason="python3-can is not installed")
import canopus  # noqa: E402
from canopus.python_can import CanopusBus  # noqa: E402

PLANT = pathlib.Path(__file__).with_name("plant.toml")
BUILT = pathlib.Path(canopus._core.__file__).parents[1]
QUIET = '[plant]\nname = "quiet"\n[[bus]]\nname = "a"\nbit_rate = 500_000\n[[bus]]\nname = "b"\nbit_rate = 250_000\n'


@pytest.fixture(autouse=True)
def patient(monkeypatch):
    """A thread may get no processor for some seconds."""
    monkeypatch.setattr("canopus.python_can.NOTIFIER_PATIENCE", 30)
    monkeypatch.setattr("canopus.python_can.LISTENER_PATIENCE", 120)


@pytest.fixture
def quiet():
    with canopus.Plant("quiet.toml", text=QUIET) as plant:
        yield plant


def message(identifier, *data, **more):
    return can.Message(arbitration_id=identifier, is_extended_id=False, data=bytes(data), **more)


def program(text, *arguments, **more):
    """Runs in a Python of its own, which finds the package as an installed one is found."""
    return subprocess.run([sys.executable, *(["-c", text] if text else []), *map(str, arguments)], capture_output=True, text=True,
                          timeout=300, env={**os.environ, "PYTHONPATH": str(BUILT), **more})


def test_python_can_finds_the_interface_by_its_entry_point():
    done = program(f"""
import can
with can.Bus(interface="canopus", channel="line1", plant={str(PLANT)!r}, bitrate=250000) as bus:
    print(next(m for m in bus if m.arbitration_id == 0x702))
""")
    assert done.returncode == 0, done.stderr
    assert " 0702 " in done.stdout and "Channel: line1" in done.stdout


def test_python_cans_configuration_names_the_plant(tmp_path):
    (tmp_path / "can.conf").write_text(f"[default]\ninterface = canopus\nchannel = line1\nplant = {PLANT}\n")
    done = program("import can\nwith can.Bus() as bus:\n    print(bus.recv().timestamp > 0)", HOME=str(tmp_path))
    assert done.stdout == "True\n", done.stderr


def test_python_cans_logger_writes_what_a_plant_says(tmp_path):
    words = ["-m", "can.logger", "-i", "canopus", "-c", "line1", "-f", str(tmp_path / "log.asc"), f"--plant={PLANT}"]
    logger = subprocess.Popen([sys.executable, *words], env={**os.environ, "PYTHONPATH": str(BUILT)}, stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE)
    try:
        limit = time.monotonic() + 120
        while time.monotonic() < limit and logger.poll() is None:
            if (tmp_path / "log.asc").exists() and (tmp_path / "log.asc").stat().st_size > 4096:
                break
            time.sleep(0.05)
    finally:
        logger.kill()
        _, errors = logger.communicate()
    assert " 702 " in (tmp_path / "log.asc").read_text(), errors


def test_a_time_out_is_plant_time_and_not_more(quiet):
    with CanopusBus("a", plant=quiet) as bus:
        begin = time.monotonic()
        assert bus.recv(1000) is None
        assert quiet.time == 1000 and time.monotonic() - begin < 300
        assert bus.recv(0) is None and quiet.time == 1000


def test_messages_that_a_filter_refuses_do_not_prolong_a_time_out(quiet):
    with CanopusBus("a", plant=quiet) as sender, CanopusBus("a", plant=quiet, can_filters=[{"can_id": 5, "can_mask": 0x7FF}]) as bus:
        sender.send_periodic(message(6), 0.01)
        assert bus.recv(0.505) is None
        assert quiet.time == 0.505


def test_a_periodic_message_is_sent_in_plant_time(quiet):
    with CanopusBus("a", plant=quiet) as sender, CanopusBus("a", plant=quiet) as bus:
        quiet.run(0.5)
        task = sender.send_periodic(message(0x123, 1), 0.1, duration=0.45)
        seen = list(iter(lambda: bus.recv(0.2), None))
        # Five at 500 kbit/s: the first begins at 0.5 s.
        assert [round(m.timestamp, 3) for m in seen] == [0.5, 0.6, 0.7, 0.8, 0.9]
        assert {(m.arbitration_id, bytes(m.data)) for m in seen} == {(0x123, b"\x01")}
        task.start()
        assert bus.recv(0.05).timestamp == pytest.approx(quiet.time, abs=0.001)


def test_a_periodic_message_is_changed_and_stopped(quiet):
    with CanopusBus("a", plant=quiet) as sender, CanopusBus("a", plant=quiet) as bus:
        task = sender.send_periodic([message(0x10, 1), message(0x10, 2)], 0.1)
        assert [bus.recv(0.2).data[0] for _ in range(4)] == [1, 2, 1, 2]
        task.modify_data([message(0x10, 7), message(0x10, 8)])
        changed = [bus.recv(0.2) for _ in range(2)]
        assert [m.data[0] for m in changed] == [7, 8]
        assert changed[1].timestamp - changed[0].timestamp == pytest.approx(0.1, abs=1e-5)  # stuff bits
        task.stop()
        assert bus.recv(1) is None
        with pytest.raises(ValueError):
            task.modify_data([message(0x10, 7)])


def test_a_bus_that_is_shut_down_sends_nothing_more(quiet):
    with CanopusBus("a", plant=quiet) as bus:
        sender = CanopusBus("a", plant=quiet)
        sender.send_periodic(message(1), 0.1)
        assert bus.recv(0.2) is not None
        sender.shutdown()
        sender.shutdown()
        assert bus.recv(1) is None
        for use in (lambda: sender.send(message(1)), lambda: sender.recv(0)):
            with pytest.raises(can.CanOperationError, match="shut down"):
                use()


def test_a_period_that_is_none_is_refused(quiet):
    with CanopusBus("a", plant=quiet) as bus:
        for period in (0, 1e-6):
            with pytest.raises(can.CanOperationError, match="10 us"):
                bus.send_periodic(message(1), period)
        for period in (-1, float("nan"), float("inf")):
            with pytest.raises(ValueError):
                bus.send_periodic(message(1), period)


def test_a_listener_gets_each_message_at_its_moment(quiet):
    seen = []
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        sender.send_periodic(message(0x20), 0.1)
        notifier = can.Notifier(bus, [lambda m: seen.append((m.timestamp, quiet.time))], timeout=0.05)
        quiet.run(1.05)
        assert len(seen) == 11
        assert all(stamp == now for stamp, now in seen)
        notifier.stop()
        quiet.run(1)
        assert len(seen) == 11


def test_a_thread_of_ones_own_gets_each_message_at_its_moment(quiet):
    seen = []
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        ready = threading.Event()

        def reads():
            assert bus.recv(0) is None
            ready.set()
            while (m := bus.recv(5)) is not None and m.arbitration_id != 0x7FF:
                seen.append((m.timestamp, quiet.time))
        thread = threading.Thread(target=reads)
        thread.start()
        assert ready.wait(10)
        sender.send_periodic(message(0x20), 0.1, duration=0.5)
        quiet.run(1)
        sender.send(message(0x7FF))
        quiet.run(0.1)
        thread.join(10)
        assert len(seen) == 5 and all(stamp == now for stamp, now in seen)


def test_plant_time_waits_until_a_listener_has_returned(quiet):
    seen = []

    def slow(m):
        before = quiet.time
        time.sleep(0.1)
        seen.append((before, quiet.time))
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        notifier = can.Notifier(bus, [slow], timeout=0.05)
        sender.send_periodic(message(0x20), 0.1, duration=0.3)
        quiet.run(1)
        assert len(seen) == 3 and all(before == after for before, after in seen)
        notifier.stop()


def test_plant_time_waits_for_a_notifier_that_begins(quiet):
    seen = []
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        with pytest.raises(NotImplementedError):
            bus.fileno()  # as can.Notifier does before its thread begins

        def reads():
            time.sleep(0.2)
            seen.append((bus.recv(5).timestamp, quiet.time))
            bus.recv(0.05)
        thread = threading.Thread(target=reads)
        thread.start()
        sender.send(message(0x20))
        quiet.run(1)
        thread.join(10)
        assert seen and seen[0][0] == seen[0][1] < 0.01


@pytest.mark.parametrize("run", range(3))
def test_a_listener_answers_at_the_moment_of_the_question(quiet, run):
    with CanopusBus("a", plant=quiet) as asker, CanopusBus("a", plant=quiet) as answerer:
        def answer(m):
            if m.arbitration_id == 0x100:
                answerer.send(message(0x101, *m.data))
        notifier = can.Notifier(answerer, [answer], timeout=0.05)
        asker.send_periodic(message(0x100, 9), 0.05)
        moments = [asker.recv(0.2).timestamp for _ in range(5)]
        # The answer follows the question by three bits of intermission and its own length, 47 bits and stuff bits.
        assert [round(m, 4) for m in moments] == [0.0002, 0.0502, 0.1002, 0.1502, 0.2002]
        notifier.stop()


def test_a_listener_that_raises_does_not_stop_the_plant(quiet, monkeypatch):
    monkeypatch.setattr(threading, "excepthook", lambda details: None)
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        notifier = can.Notifier(bus, [lambda m: 1 / 0], timeout=0.05)
        sender.send_periodic(message(0x20), 0.1)
        quiet.run(1)
        assert quiet.time == 1 and isinstance(notifier.exception, ZeroDivisionError)
        notifier.stop()


def test_a_listener_cannot_let_time_pass(quiet):
    refused = []

    def runs(m):
        try:
            quiet.run(1)
        except canopus.PlantError as error:
            refused.append(str(error))
    with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
        notifier = can.Notifier(bus, [runs], timeout=0.05)
        sender.send(message(1))
        quiet.run(0.1)
        notifier.stop()
    assert len(refused) == 1 and "runs just now" in refused[0]


def test_a_notifier_of_an_event_loop_gets_messages(quiet):
    async def main():
        with CanopusBus("a", plant=quiet) as bus, CanopusBus("a", plant=quiet) as sender:
            reader = can.AsyncBufferedReader()
            notifier = can.Notifier(bus, [reader], timeout=0.05, loop=asyncio.get_running_loop())
            sender.send(message(0x33, 4))
            quiet.run(0.1)
            received = await asyncio.wait_for(reader.get_message(), 10)
            notifier.stop()
            return received
    assert asyncio.run(main()).arbitration_id == 0x33


def test_a_plant_in_step_with_the_clock_serves_programs_that_sleep():
    seen = []
    with can_bus(pace=50) as bus:
        notifier = can.Notifier(bus, [seen.append], timeout=0.05)
        limit = time.monotonic() + 120
        while not any(m.arbitration_id == 0x702 for m in seen) and time.monotonic() < limit:
            time.sleep(0.01)
        bus.send(message(0x602, *bytes.fromhex("4000100000000000")))
        while not any(m.arbitration_id == 0x582 and m.data[1:3] == b"\x00\x10" for m in seen) and time.monotonic() < limit:
            time.sleep(0.01)
        notifier.stop()
    assert any(m.arbitration_id == 0x582 and m.data[1:3] == b"\x00\x10" for m in seen)


def test_in_step_with_the_clock_means_that(quiet):
    with CanopusBus("a", plant=quiet, pace=20) as bus:
        begin = time.monotonic()
        assert bus.recv(0.5) is None
        real = time.monotonic() - begin
        assert 1 < quiet.time < 20 * real + 2


def can_bus(**more):
    return CanopusBus("line1", plant=PLANT, **more)


def test_a_plant_with_a_pace_ends_with_the_program():
    done = program(f"import can\nbus = can.Bus(interface='canopus', channel='line1', plant={str(PLANT)!r}, pace=1)\nbus.recv(0.2)")
    assert done.returncode == 0, done.stderr


def test_what_a_callback_raises_reaches_a_program_with_a_pace():
    with canopus.Plant(PLANT) as plant:
        plant.device("io-block").every(0.1)(lambda device: 1 / 0)
        with CanopusBus("line1", plant=plant, pace=10) as bus, pytest.raises(can.CanOperationError, match="division"):
            while True:
                bus.recv(5)


def test_buses_that_name_one_file_share_its_plant(tmp_path):
    file = tmp_path / "two.toml"
    file.write_text(QUIET)
    first, second = CanopusBus("a", plant=file), CanopusBus("a", plant=str(file))
    assert first.plant is second.plant
    first.send(message(0x55, 1))
    assert second.recv(0.1).arbitration_id == 0x55
    first.shutdown()
    assert second.recv(0.1) is None
    second.shutdown()
    with pytest.raises(canopus.PlantError, match="closed"):
        second.plant.run(1)
    with CanopusBus("a", plant=file) as again:
        assert again.plant is not first.plant and again.plant.time == 0


def test_what_does_not_fit_is_an_initialization_error(quiet, tmp_path):
    for wrong in ({}, {"plant": tmp_path / "absent.toml"}, {"plant": quiet}, {"plant": quiet, "channel": "c"},
                  {"plant": quiet, "channel": "a", "bitrate": 125000}, {"plant": quiet, "channel": "a", "pace": 0},
                  {"plant": quiet, "channel": "a", "fd": True}):
        with pytest.raises(can.CanInitializationError):
            CanopusBus(**wrong)
    with CanopusBus("a", plant=quiet, pace=1), pytest.raises(can.CanInitializationError, match="pace"):
        CanopusBus("b", plant=quiet, pace=2)


def test_a_burst_finds_room(quiet):
    with CanopusBus("a", plant=quiet) as sender, CanopusBus("a", plant=quiet) as bus:
        for number in range(500):
            sender.send(message(0x40, number & 0xFF))
        assert [bus.recv(1).data[0] for _ in range(500)] == [number & 0xFF for number in range(500)]


def test_nobody_to_acknowledge_fills_the_queue(quiet):
    with CanopusBus("a", plant=quiet) as bus:
        with pytest.raises(can.CanOperationError, match="queue is full"):
            for number in range(200):
                bus.send(message(number), timeout=0.01)
        assert bus.state == can.BusState.PASSIVE


def test_a_closed_plant_is_a_can_error(quiet):
    bus = CanopusBus("a", plant=quiet)
    quiet.close()
    for use in (lambda: bus.send(message(1)), lambda: bus.recv(1)):
        with pytest.raises(can.CanOperationError, match="closed"):
            use()
    bus.shutdown()
