"""Fixtures for pytest. In conftest.py: pytest_plugins = ["canopus_plc.pytest_plugin"]

    @pytest.mark.canopus_plant("plant.toml")        # relative to the test's file; further arguments as of Plant
    def test_an_output_comes_back(canopus_plant, plc):
        plc.g[0][13000] = 0x5A
        plc.wait(lambda: plc.g[0][10000] >> 8 == 0x5A)

Each test has a plant of its own. Without a mark it is plant.toml in the folder of the test's file. The report of a failed test
shows plant time, NMT states, why slaves are not booted, the file with the frames (`trace=`), and the latest events.
"""
from __future__ import annotations

import pathlib
from typing import Any, Iterator

import pytest

from .plant import Plant
from .plc import Plc


_KEY = pytest.StashKey[Plant]()


def pytest_configure(config: Any) -> None:
    config.addinivalue_line("markers", "canopus_plant(plant_file, ...): the plant of the fixtures canopus_plant and plc")


@pytest.fixture
def canopus_plant(request: Any) -> Iterator[Plant]:
    """The plant of the test, in step."""
    mark = request.node.get_closest_marker("canopus_plant")
    arguments = mark.args if mark is not None and mark.args else ("plant.toml",)
    options = mark.kwargs if mark is not None else {}
    folder = pathlib.Path(request.node.path).parent
    with Plant(folder / arguments[0], *arguments[1:], **options) as plant:
        request.node.stash[_KEY] = plant
        yield plant


@pytest.hookimpl(hookwrapper=True)  # type: ignore[misc]
def pytest_runtest_makereport(item: Any, call: Any) -> Iterator[None]:
    outcome: Any = yield
    result = outcome.get_result()
    plant = item.stash.get(_KEY, None)
    if call.when != "call" or not result.failed or plant is None:
        return
    try:
        result.sections.append(("plant", plant.report()))
    except Exception as error:  # pylint: disable=broad-except
        # The test has failed already: it may have ended its plant, or lost it.
        result.sections.append(("plant", f"no report of the plant: {error}"))


@pytest.fixture
def plc(canopus_plant: Plant) -> Plc:
    """The only PLC of the test's plant."""
    return canopus_plant.plc
