"""Tests of a PLC program's plant with pytest: python3 -m pytest examples/python-pytest

Each test has a plant of its own, in virtual time. `plant` comes with the package canopus.
"""
import pytest

pytestmark = pytest.mark.plant("../python-device/plant.toml")


@pytest.fixture
def started(plant):
    plant.plc.wait(r"U0\G601 == 5", timeout=60)     # node 2 is Operational
    return plant


def test_an_input_reaches_the_plc(started):
    started.force("tank", "6000:01", 80)
    started.plc.wait(lambda: started.plc.g[0][10000] & 0xFF == 80)


def test_an_output_reaches_the_device(started):
    started.plc.g[0][13000] = 1
    started.plc.wait(lambda: started.value("tank", "6200:01") == 1)


def test_the_tank_is_operational(started):
    assert started.states() == {"tank": "operational"}
