"""Masters without a plant's PLC. What they send is judged by the frames on the bus, which the test writes out."""
import json
import os
import pathlib
import signal
import socket
import subprocess
import threading
import time

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = ROOT / "examples/devices/io-block.eds"
PROGRAM = pathlib.Path(os.environ.get("CANOPUS_PROGRAM", ROOT / "build/canopus"))


def plant_text(serve=""):
    return ('[plant]\nname = "line"\n[[bus]]\nname = "a"\nbit_rate = 250_000\n' + serve +
            f'[[device]]\nnode = 2\nname = "block"\neds = {json.dumps(str(BLOCK))}\nobjects = {{ "1017:00" = 100 }}\n'
            '[[device.behaviour]]\nobject = "6000:02"\nkind = "echo"\nsource = "6200:01"\n')


@pytest.fixture
def plant():
    with canopus.Plant("line.toml", text=plant_text()) as plant:
        plant.record()
        yield plant


def sent(plant, *identifiers):
    return [(frame.identifier, frame.data.hex()) for frame in plant.frames() if frame.identifier in identifiers]


def test_a_slave_is_booted_and_started(plant):
    with canopus.Master(plant, slaves={2: BLOCK}) as master:
        assert master.boot(timeout=5) == {2: canopus.BootResult(2, "", "booted", "operational")}
        master.run(0.01)
        assert plant.states() == {"block": "operational"}
        frames = sent(plant, 0x000, 0x602)
        # Reset communication for all; device type, identity; start of node 2.
        assert frames[0] == (0x000, "8200") and frames[1] == (0x602, "4000100000000000") and frames[-1] == (0x000, "0102")
        assert master.state(2) == "operational"
        assert [event["event"] for event in master.events if event["event"] != "state"] == ["booted"]


def test_a_slave_that_is_another_device_is_not_started(plant, tmp_path):
    other = canopus.DeviceFile(BLOCK).write_eds(tmp_path / "other.eds", {"1018:02": 0x999})
    with canopus.Master(plant, slaves={2: other}) as master:
        result = master.boot(timeout=5)[2]
        assert (result.result, result.node) == ("failed", 2) and "999" in result.reason.upper()
        assert plant.states() == {"block": "pre-operational"}


def test_a_slave_that_is_missing_is_said(plant):
    with canopus.Master(plant, slaves={2: BLOCK, 9: None}) as master:
        with pytest.raises(TimeoutError, match="not booted: .*9"):
            master.boot(timeout=5)
        assert plant.time == pytest.approx(5, abs=0.01)


def test_nmt_commands_are_frames(plant):
    with canopus.Master(plant) as master:
        master.boot(timeout=5)
        master.run(0.2)
        plant.frames()
        for command in (master.start, master.stop, master.pre_operational, master.reset_communication, master.reset_node):
            command(2)
            master.run(0.2)
        assert sent(plant, 0) == [(0, "0102"), (0, "0202"), (0, "8002"), (0, "8202"), (0, "8102")]
        master.start()
        master.run(0.2)
        assert sent(plant, 0) == [(0, "0100")] and plant.states() == {"block": "operational"}


def test_objects_are_read_and_written_by_bytes_and_by_type(plant):
    with canopus.Master(plant, slaves={2: BLOCK}) as master:
        master.boot(timeout=5)
        plant.frames()
        assert master.upload(2, 0x1018, 2) == b"\x01\x04\0\0" and master.read(2, "1018:02") == 0x401
        assert master.read(2, "1008:00") == "Canopus I/O block"
        master.write(2, "1017:00", 300)
        assert master.upload(2, 0x1017) == b"\x2c\x01"
        assert (0x602, "2b1710002c010000") in sent(plant, 0x602)
        master.download(2, 0x1017, 0, b"\x64\0")
        assert master.read(2, 0x1017) == 100


def test_failures_are_exceptions(plant):
    with canopus.Master(plant, slaves={2: BLOCK}) as master:
        master.boot(timeout=5)
        with pytest.raises(canopus.SdoAbort, match="object does not exist") as missing:
            master.upload(2, 0x5FFF)
        assert missing.value.code == 0x06020000
        before = plant.time
        with pytest.raises(canopus.SdoAbort, match="no answer within"):
            master.upload(5, 0x1000, timeout=0.25)
        assert plant.time == pytest.approx(before + 0.25, abs=0.01)
        plant.frames()
        for wrong in (lambda: master.write(2, "1017:00", 70000), lambda: master.read(2, "5FFF:00"), lambda: master.read(3, "1000:00"),
                      lambda: master.subscribe(node=3), lambda: master.subscribe(node=2, tpdo=3), lambda: master.start(128),
                      lambda: master.upload(0, 0x1000), lambda: master.upload(2, 0x10000), lambda: master.state(0),
                      lambda: master.send(1, b"123456789")):
            with pytest.raises(canopus.PlantError):
                wrong()
        for wrong in (lambda: master.subscribe(), lambda: master.subscribe(1 << 29), lambda: master.run(-1)):
            with pytest.raises(ValueError):
                wrong()
        assert sent(plant, 0x602) == []


def test_pdos_come_with_their_values(plant):
    with canopus.Master(plant, slaves={2: BLOCK}) as master:
        master.boot(timeout=5)
        inputs, raw = master.subscribe(node=2, tpdo=1), master.subscribe(0x182)
        while inputs.receive(0.1) is not None:
            pass
        master.send(0x202, b"\x5a\x00")  # RPDO1: the device echoes its first byte
        pdo = inputs.receive(1)
        assert (pdo.cob_id, pdo.data, pdo.values) == (0x182, b"\x00\x5a", {"6000:01": 0, "6000:02": 0x5A})
        assert inputs.latest == pdo and pdo.time <= plant.time
        before = plant.time
        assert inputs.receive(0.5) is None and plant.time == pytest.approx(before + 0.5)
        taken = list(iter(lambda: raw.receive(), None))
        assert taken[-1].data == b"\x00\x5a" and taken[-1].values == {}
        raw.close()
        raw.close()
        master.send(0x202, b"\x01\x00")
        assert inputs.receive(1).data == b"\x00\x01" and raw.receive() is None


def test_signed_values_and_bits_that_are_missing(plant):
    with canopus.Master(plant, slaves={2: BLOCK}) as master:
        master.boot(timeout=5)
        analogue = master.subscribe(node=2, tpdo=2)
        plant.force("block", "6401:02", -5)
        pdo = analogue.receive(1)
        while pdo.values["6401:02"] != -5:
            pdo = analogue.receive(1)
        assert pdo.data[2:4] == b"\xfb\xff"
        port = plant.port()
        port.send(0x282, b"\x01\x00\x02")
        while (pdo := analogue.receive(1)).data != b"\x01\x00\x02":
            pass
        assert pdo.values == {"6401:01": 1}


def test_a_network_file_says_what_the_slaves_are(plant, tmp_path):
    (tmp_path / "network.toml").write_text(
        f'[master]\nnode = 100\n[[slave]]\nnode = 2\nname = "block"\neds = {json.dumps(str(BLOCK))}\nobjects = {{ "1017:00" = 250 }}\n'
        'consumer_heartbeat_time = "1s"\n[[slave]]\nnode = 3\nmandatory = false\n')
    with canopus.Master(plant, network=tmp_path / "network.toml") as master:
        results = master.boot(timeout=20)
        assert results[2].result == "booted" and results[2].name == "block" and results[3].result == "absent"
        assert master.read(2, "1017:00") == 250
        plant.frames()
        plant.force("block", "6000:01", 1)
        master.write(2, "1017:00", 0)  # its heartbeat is gone
        master.run(2)
        assert any(event["event"] == "error control" and event["node"] == 2 for event in master.events)


def test_mistakes_have_their_place(plant, tmp_path):
    (tmp_path / "network.toml").write_text("[[slave]]\nnode = 200\n")
    with pytest.raises(canopus.PlantError, match=r"network\.toml:2:\d+: "):
        canopus.Master(plant, network=tmp_path / "network.toml")
    with pytest.raises(canopus.PlantError, match="cannot read"):
        canopus.Master(plant, network=tmp_path / "absent.toml")
    with pytest.raises(canopus.PlantError, match="no bus"):
        canopus.Master(plant, "b")
    with pytest.raises(canopus.PlantError):
        canopus.Master(plant, slaves={2: "/nowhere/x.eds"})
    with pytest.raises(canopus.PlantError, match="node"):
        canopus.Master(plant, slaves={300: None})
    with pytest.raises(ValueError):
        canopus.Master(plant, network="x", slaves={})


def test_nothing_crashes_after_close(plant):
    master = canopus.Master(plant, slaves={2: BLOCK})
    inputs = master.subscribe(0x182)
    master.run(0.1)
    master.close()
    master.close()
    plant.run(1)
    other = canopus.Master(plant)
    plant.close()
    for use in (lambda: master.run(1), lambda: master.upload(2, 0x1000), lambda: inputs.receive(1), lambda: master.boot(),
                lambda: master.results, lambda: other.run(1), lambda: other.upload(2, 0x1000), lambda: other.send(1), lambda: other.state(2)):
        with pytest.raises(canopus.PlantError, match="closed"):
            use()
    other.close()
    assert master.time == 0.1 and other.time == plant.time


def test_a_master_cannot_leave_from_a_callback(plant):
    device = plant.device("block")
    masters = []

    @device.every(0.1)
    def leaves(device):
        masters[0].close()
    masters.append(canopus.Master(plant))
    with pytest.raises(canopus.PlantError, match="time passes just now"):
        plant.run(1)
    masters[0].close()


@pytest.fixture
def address(tmp_path):
    """A plant in real time in a process of its own, and the address of its bus."""
    if not PROGRAM.exists():
        pytest.skip(f"{PROGRAM} is not built")
    (tmp_path / "line.toml").write_text(plant_text('serve = "socketcand:127.0.0.1:0"\n'))
    process = subprocess.Popen([PROGRAM, "run", tmp_path / "line.toml", "--json"], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    while True:
        line = process.stdout.readline()
        assert line, process.stderr.read()
        event = json.loads(line)
        if event["event"] == "listen":
            break
    yield f"socketcand:{event['address']}"
    process.terminate()
    process.communicate(timeout=120)


def test_a_real_bus_has_its_master(address):
    with canopus.Master(address, slaves={2: BLOCK}) as master:
        assert master.boot(timeout=60)[2].result == "booted"
        assert master.read(2, "1018:02", timeout=10) == 0x401
        inputs = master.subscribe(node=2, tpdo=1)
        master.write(2, "6200:01", 0x33, timeout=10)
        pdo = inputs.receive(60)
        while pdo is not None and pdo.values["6000:02"] != 0x33:
            pdo = inputs.receive(60)
        assert pdo is not None
        refused = []

        def other():
            try:
                master.run(1)
            except canopus.PlantError as error:
                refused.append(str(error))
        thread = threading.Timer(0.1, other)
        thread.start()
        begin = time.monotonic()
        master.run(2.5)  # other threads run meanwhile
        thread.join()
        assert 2.4 < time.monotonic() - begin and refused and "another thread" in refused[0]


def test_a_bus_that_is_not_there_is_a_sentence():
    with socket.socket() as deaf:  # it does not listen, and keeps the port from others
        deaf.bind(("127.0.0.1", 0))
        with pytest.raises(canopus.PlantError, match="refused"):
            canopus.Master(f"socketcand:127.0.0.1:{deaf.getsockname()[1]}", timeout=20)
    with pytest.raises(canopus.PlantError):
        canopus.Master("nothing:1")


def test_ctrl_c_ends_waiting_for_a_real_bus(address):
    def ctrl_c():
        os.kill(os.getpid(), signal.SIGINT)
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell in the background has it ignored
    with canopus.Master(address) as master:
        master.boot(timeout=60)
        begin = time.monotonic()
        with pytest.raises(KeyboardInterrupt):
            threading.Timer(0.3, ctrl_c).start()
            master.run(60)
        assert time.monotonic() - begin < 40
        with pytest.raises(KeyboardInterrupt):
            ctrl_c()
            time.sleep(10)
        master.run(0.05)


def test_a_master_alone_on_its_bus_gives_up():
    with canopus.Plant("empty.toml", text='[plant]\nname = "x"\n[[bus]]\nname = "a"\nbit_rate = 125_000\n') as plant:
        with canopus.Master(plant) as master:
            master.run(1)
            with pytest.raises(canopus.SdoAbort, match="no answer"):
                master.upload(5, 0x1000, timeout=0.25)
