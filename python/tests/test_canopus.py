"""The plant in this process. What is expected is written out, or comes from struct and python-can."""
import gc
import pathlib
import struct
import subprocess
import sys
import threading

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

PLANT = pathlib.Path(__file__).with_name("plant.toml")


@pytest.fixture
def running():
    with canopus.Plant(PLANT) as plant:
        yield plant


def exchange(plc):
    """A data exchange as the module's manual has it: Y01 ON, X01 comes, Y01 OFF."""
    plc.y[1] = True
    plc.wait(lambda: plc.x[1])
    plc.y[1] = False
    plc.wait(lambda: not plc.x[1])


def operational(plant):
    plant.plc.wait(r"U0\G601 == 5", timeout=60)
    return plant


def test_time_stands_still_until_it_is_asked_for(running):
    assert running.time == 0
    running.run(0.25)
    assert running.time == 0.25


def test_words_and_signals_are_those_of_the_module(running):
    operational(running)
    running.plc.g[0][13000:13004] = [0x5A, 0, 0, 0]

    def echoed():
        exchange(running.plc)
        return running.plc.g[0][10000] >> 8 == 0x5A

    running.plc.wait(echoed)
    running.plc.d[100:103] = [1, -2, 0xFFFF]
    assert running.plc.d[100:103] == [1, 65534, 65535] and running.plc.d.signed[101] == -2
    running.plc.m[5] = True
    assert running.plc.m[4:7] == [False, True, False]
    assert running.plc.cpu_name == "R04CPU"


def test_two_runs_give_the_same_frames():
    runs = []
    for _ in range(2):
        with canopus.Plant(PLANT) as plant:
            plant.record()
            plant.run(3)
            runs.append(plant.frames())
    assert runs[0] == runs[1] and len(runs[0]) > 10
    assert [frame.time for frame in runs[0]] == sorted(frame.time for frame in runs[0])


def test_sdo_reads_and_writes_what_the_bus_carries(running):
    running.record()
    operational(running)
    running.frames()
    running.sdo_download(2, 0x1017, 0, struct.pack("<H", 700))
    assert running.sdo_upload(2, 0x1017) == b"\xbc\x02"
    frames = [(frame.identifier, frame.data) for frame in running.frames() if frame.identifier in (0x602, 0x582)]
    assert frames == [(0x602, bytes.fromhex("2b171000bc020000")), (0x582, bytes.fromhex("6017100000000000")),
                      (0x602, bytes.fromhex("4017100000000000")), (0x582, bytes.fromhex("4b171000bc020000"))]


def test_an_answer_without_its_size_has_the_bytes_of_its_type(recwarn):
    from canopus.plant import _uploaded_value
    assert _uploaded_value(b"\x34\x12\xaa\xbb", False, 2, "x") == b"\x34\x12" and not recwarn.list
    assert _uploaded_value(b"\x34\x12\0\0", True, 4, "x") == b"\x34\x12\0\0" and not recwarn.list
    assert _uploaded_value(b"\x34\x12\0\1", True, 2, "x") == b"\x34\x12\0\1" and not recwarn.list
    with pytest.warns(UserWarning, match="did not indicate how many of the 4 bytes"):
        assert _uploaded_value(b"\x34\x12\xaa\xbb", False, 0, "x") == b"\x34\x12\xaa\xbb"
    with pytest.warns(UserWarning, match="4 bytes came, its type has 2: the others are 0"):
        assert _uploaded_value(b"\x34\x12\0\0", True, 2, "x") == b"\x34\x12"


def test_sdo_failures_have_their_abort_code(running):
    operational(running)
    with pytest.raises(canopus.SdoAbort, match="object does not exist") as missing:
        running.sdo_upload(2, 0x5FFF)
    assert missing.value.code == 0x06020000
    before = running.time
    with pytest.raises(canopus.SdoAbort, match="no answer within"):
        running.sdo_upload(99, 0x1000, timeout=0.25)
    assert running.time == pytest.approx(before + 0.25, abs=0.01)


def test_a_behaviour_in_python_answers_an_output_with_an_input(running):
    device = running.device("io-block")
    seen = []

    @device.on_change("6200:02")
    def doubled(device, value):
        seen.append((running.time, value))
        device["6000:01"] = 2 * value

    operational(running)
    port = running.port()
    running.sdo_download(2, 0x6200, 2, b"\x21")
    assert [value for _, value in seen] == [0x21]
    assert running.sdo_upload(2, 0x6000, 1) == b"\x42"
    tpdo = next(frame for frame in iter(lambda: port.receive(0.1), None) if frame.identifier == 0x182)
    assert tpdo.data[0] == 0x42


def test_a_period_is_plant_time(running):
    device = running.device("io-block")
    moments = []
    device.every(0.1)(lambda device: moments.append(running.time))
    running.run(1)
    assert [round(b - a, 9) for a, b in zip(moments, moments[1:])] == [0.1] * (len(moments) - 1) and len(moments) >= 9


def test_what_a_callback_raises_comes_out_of_run(running):
    @running.device("io-block").every(0.1)
    def fails(device):
        raise KeyError("mine")

    with pytest.raises(KeyError, match="mine"):
        running.run(1)
    assert running.time < 0.2


def test_a_callback_cannot_run_the_plant(running):
    @running.device("io-block").every(0.1)
    def runs(device):
        running.run(1)

    with pytest.raises(canopus.PlantError, match="the plant runs just now"):
        running.run(1)


@pytest.mark.parametrize("use", [lambda plant: plant.run(1), lambda plant: plant.close()], ids=["run", "close"])
def test_a_callback_of_the_start_cannot_run_or_close_the_plant(running, use):
    running.device("io-block").on_start(lambda device: use(running))
    with pytest.raises(canopus.PlantError, match="the plant runs just now"):
        running.run(1)


def test_a_behaviour_comes_before_time_passes(running):
    running.run(0.1)
    with pytest.raises(canopus.PlantError, match="before time passes"):
        running.device("io-block").every(1)(print)


def test_mistakes_are_sentences_with_their_place():
    with pytest.raises(canopus.PlantError, match=r"mine\.toml:1:\d+: "):
        canopus.Plant("mine.toml", text="[plant\n")
    with pytest.raises(canopus.PlantError, match="cannot read"):
        canopus.Plant("/nowhere/plant.toml")


def test_wrong_arguments_are_exceptions(running):
    for wrong in (lambda: running.run(-1), lambda: running.run(float("nan")), lambda: running.run(1e300)):
        with pytest.raises(ValueError):
            wrong()
    for wrong in (lambda: running.plc.d[10**9], lambda: running.plc.g[7][0], lambda: running.sdo_upload(0, 0x1000),
                  lambda: running.port("nobody"), lambda: running.device("nobody"),
                  lambda: running.port().send(0x800), lambda: running.port().send(1, b"123456789")):
        with pytest.raises(canopus.PlcError):
            wrong()
    with pytest.raises(TypeError):
        canopus.Plant(3)
    with pytest.raises(TypeError):
        running.port().send("x")


def test_nothing_crashes_after_close():
    plant = canopus.Plant(PLANT)
    port, device = plant.port(), plant.device("io-block")
    plant.run(0.1)
    plant.close()
    plant.close()
    for use in (lambda: plant.run(1), lambda: plant.plc.d[0], lambda: port.send(1), lambda: port.receive(1),
                lambda: device["6000:01"], lambda: plant.sdo_upload(2, 0x1000), plant.states, plant.frames, lambda: plant.buses):
        with pytest.raises(canopus.PlcError, match="closed"):
            use()
    assert plant.time == 0.1
    del plant, device
    gc.collect()
    port.close()


def test_another_thread_is_refused_while_the_plant_runs(running):
    refused = []

    def other():
        try:
            running.run(1)
        except canopus.PlantError as error:
            refused.append(str(error))

    @running.device("io-block").every(0.1)
    def waits(device):
        thread = threading.Thread(target=other)
        thread.start()
        thread.join()

    running.run(0.15)
    assert refused and "the plant runs just now" in refused[0]


def test_messages_name_nodes_and_signals(running):
    running.monitor()
    operational(running)
    messages = running.messages()
    assert any(message.get("name") == "io-block" or "io-block" in str(message) for message in messages)
    assert any(message["service"] == "sdo" for message in messages)


def test_a_trace_is_decoded(tmp_path):
    trace = tmp_path / "candump.log"
    trace.write_text("(1.000000) can0 702#00\n(1.100000) can0 000#0102\n")
    assert [message["service"] for message in canopus.decode(trace)] == ["error-control", "nmt"]
    with pytest.raises(canopus.PlantError):
        canopus.decode(tmp_path / "absent.log")


def test_programs_of_python_can_run_in_plant_time(running):
    can = pytest.importorskip("can")
    from canopus.python_can import CanopusBus
    with CanopusBus(plant=running, can_filters=[{"can_id": 0x582, "can_mask": 0x7FF}]) as bus:
        running.run(1)
        bus.send(can.Message(arbitration_id=0x602, is_extended_id=False, data=bytes.fromhex("4000100000000000")))
        answer = bus.recv(0.5)
        while answer.data[1:4] != b"\x00\x10\x00":
            answer = bus.recv(0.5)
        assert answer.arbitration_id == 0x582 and answer.timestamp <= running.time
        before = running.time
        while bus.recv(0.2) is not None:
            pass
        assert running.time >= before + 0.2


def test_the_page_does_what_it_says(capsys, monkeypatch):
    root = pathlib.Path(__file__).resolve().parents[2]
    monkeypatch.chdir(root)
    page = (root / "docs/python-module.md").read_text().split("## Tests with pytest")[0]
    names = {}
    for block in page.split("```python\n")[1:]:
        exec(block.split("```")[0], names)
    assert capsys.readouterr().out == (
        "operational after 1.51 s\ndevice type 91010f00\n"
        "Producer heartbeat time UNSIGNED16 rw 0\n"
        "182 ['Digital inputs 1 to 8', 'Digital inputs 9 to 16']\n282 ['Analogue input 1', 'Analogue input 2']\n"
        "booted\n1025\n{'6000:01': 7, '6000:02': 0}\n[] <svg\n")


def test_a_plant_that_nobody_closes_ends_with_the_program():
    words = "import canopus\nplant = canopus.Plant(%r)\nport = plant.port()\nplant.me = plant\nplant.run(1)\n" % str(PLANT)
    done = subprocess.run([sys.executable, "-c", "import sys\nsys.path[:0] = %r\n" % sys.path[:3] + words],
                          capture_output=True, text=True, timeout=300)
    assert done.returncode == 0, done.stderr
