"""Fixtures for pytest, which pytest finds by itself where the package is installed; elsewhere, in conftest.py:
pytest_plugins = ["pytest_canopus"].

    @pytest.mark.plant("plant.toml")            # relative to the test's file; further arguments as of canopus.Plant
    def test_an_output_comes_back(plant):
        plant.plc.wait(r"U0\\G601 == 5", timeout=60)
        plant.plc.g[0][13000] = 0x5A

Each test has a plant of its own, in virtual time. Without a mark it is plant.toml in the folder of the test's file. Of a test
that fails the report shows the plant's time, NMT states, why slaves are not booted, and the latest events; with
--plant-traces=FOLDER its frames are kept as FOLDER/TEST.log, in the format of candump -l.
"""
from __future__ import annotations

import pathlib
import re
from typing import TYPE_CHECKING, Any, Callable, Iterator

import pytest

if TYPE_CHECKING:  # a pytest that uses no plant does not load the package
    from canopus import Plant

_KEY = pytest.StashKey["list[Plant]"]()


def pytest_addoption(parser: Any) -> None:
    parser.getgroup("canopus").addoption("--plant-traces", metavar="FOLDER",
                                         help="keep the frames of plants whose tests fail, in the format of candump -l")


def pytest_configure(config: Any) -> None:
    config.addinivalue_line("markers", "plant(plant_file, *, text=None, seed=None): the plant of the fixture plant")


@pytest.fixture
def make_plant(request: Any) -> Iterator[Callable[..., Plant]]:
    """Makes plants, with the arguments of canopus.Plant; a path is relative to the test's file. They end with the test."""
    from canopus import Plant
    plants: list[Plant] = request.node.stash.setdefault(_KEY, [])

    def make(plant_file: Any = "plant.toml", **options: Any) -> Plant:
        plant = Plant(pathlib.Path(request.node.path).parent / plant_file, **options)
        plants.append(plant)
        if request.config.getoption("--plant-traces"):
            for bus in plant.buses:
                plant.record(bus)
        return plant
    yield make
    for plant in plants:
        plant.close()


@pytest.fixture
def plant(request: Any, make_plant: Callable[..., Plant]) -> Plant:
    """The plant of the test, as its mark says."""
    mark = request.node.get_closest_marker("plant")
    return make_plant(*mark.args, **mark.kwargs) if mark is not None else make_plant()


@pytest.hookimpl(hookwrapper=True)  # type: ignore[misc]
def pytest_runtest_makereport(item: Any, call: Any) -> Iterator[None]:
    outcome: Any = yield
    report = outcome.get_result()
    if call.when != "call" or not report.failed:
        return
    for number, plant in enumerate(item.stash.get(_KEY, [])):
        if plant._core.closed:
            continue
        try:
            report.sections.append(("plant", _summary(plant)))
            folder = item.config.getoption("--plant-traces")
            if folder:
                name = re.sub(r"[^A-Za-z0-9._-]+", "_", item.nodeid).strip("_")[-200:] + (f"-{number}" if number else "") + ".log"
                report.sections.append(("plant's frames", _keep(plant, pathlib.Path(folder) / name)))
        except Exception as error:  # pylint: disable=broad-except
            # The test has failed already: what is wrong with its plant is said and no more.
            report.sections.append(("plant", f"no report of the plant: {error}"))


def _summary(plant: Plant) -> str:
    from canopus_plc import report
    return report.describe(plant.time, plant.states(), plant.events)


def _keep(plant: Plant, file: pathlib.Path) -> str:
    frames = [(frame, bus) for bus in plant.buses for frame in plant.frames(bus)]
    frames.sort(key=lambda each: each[0].time)
    file.parent.mkdir(parents=True, exist_ok=True)
    with file.open("w", encoding="utf-8") as out:
        for frame, bus in frames:
            name = re.sub(r"[^\x21-\x7e]", "_", bus) or "can0"
            identifier = f"{frame.identifier:08X}" if frame.extended else f"{frame.identifier:03X}"
            data = f"R{frame.dlc}" if frame.remote else frame.data.hex().upper()
            out.write(f"({frame.time:017.6f}) {name} {identifier}#{data}\n")
    return f"{file} ({len(frames)} frame{'' if len(frames) == 1 else 's'})"
