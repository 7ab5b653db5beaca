"""The examples in Python run, and print what they are to print; the wheel and the reference are made and hold."""
import os
import pathlib
import re
import subprocess
import sys
import zipfile

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(canopus._core.__file__).parents[1]
PRINTED = {
    "python-device/device.py": "  6.0 s: 30 litres, full switch 1\n 11.1 s: 19 litres, full switch 0\n 13.2 s: 30 litres, full switch 1\n",
    "python-master/master.py": "node 2: booted\nproduct Canopus I/O block heartbeat 500 ms\n"
                               "inputs {'6000:01': 0, '6000:02': 90}\nnode 2 is stopped\n",
    "python-can/count.py": "000 1\n080 50\n182 1\n183 1\n184 1\n282 1\n283 50\n284 1\n384 1\n484 1\n702 1\n703 1\n704 1\n",
}


def run(*words, **more):
    environment = {**os.environ, "PYTHONPATH": str(BUILT), "PYTHONDONTWRITEBYTECODE": "1"}
    return subprocess.run([str(word) for word in words], capture_output=True, text=True, timeout=600, env=environment, **more)


@pytest.mark.parametrize("name", PRINTED)
def test_an_example_prints_what_it_is_to_print(name):
    if "can" in name.split("/")[0]:
        pytest.importorskip("can", reason="python3-can is not installed")
    done = run(sys.executable, ROOT / "examples" / name)
    assert (done.stdout, done.stderr, done.returncode) == (PRINTED[name], "", 0)


def test_the_example_of_pytest_passes(tmp_path):
    done = run(sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", ROOT / "examples/python-pytest", cwd=tmp_path)
    assert re.search(r"^3 passed", done.stdout, re.MULTILINE), done.stdout + done.stderr


@pytest.fixture(scope="module")
def wheel(tmp_path_factory):
    folder = tmp_path_factory.mktemp("wheel")
    done = run(sys.executable, ROOT / "tools/python-wheel", BUILT, folder)
    assert done.returncode == 0, done.stderr
    return pathlib.Path(done.stdout.strip())


def test_a_wheel_is_installed_in_an_environment_of_its_own(wheel, tmp_path):
    made = subprocess.run([sys.executable, "-m", "venv", tmp_path / "venv"], capture_output=True, text=True)
    if made.returncode != 0:
        pytest.skip(f"python3-venv is not installed: {made.stdout[:80]}")
    python = tmp_path / "venv/bin/python"
    environment = {key: value for key, value in os.environ.items() if not key.startswith(("PYTHON", "PIP"))}
    done = subprocess.run([python, "-m", "pip", "install", "--no-index", "--no-deps", wheel], capture_output=True, text=True,
                          env=environment, timeout=600)
    assert done.returncode == 0, done.stderr
    words = ("import canopus, canopus_plc, importlib.metadata\n"
             f"with canopus.Plant({str(ROOT / 'examples/first-plant/plant.toml')!r}) as plant:\n    plant.run(1)\n    print(plant.time)\n"
             "print(sorted(e.name for g in ('can.interface', 'pytest11') for e in importlib.metadata.entry_points(group=g)))\n"
             "print(importlib.metadata.version('canopus'), canopus.__file__)\n")
    shown = subprocess.run([python, "-c", words], capture_output=True, text=True, env=environment, timeout=300, cwd=tmp_path)
    version = (ROOT / "VERSION").read_text().strip()
    lines = shown.stdout.splitlines()
    assert lines[:2] == ["1.0", "['canopus', 'pytest_canopus']"], shown.stderr
    assert lines[2].startswith(f"{version} {tmp_path}")
    removed = subprocess.run([python, "-m", "pip", "uninstall", "--yes", "canopus"], capture_output=True, text=True, env=environment)
    assert removed.returncode == 0 and not list(tmp_path.glob("venv/lib/*/site-packages/canopus*"))


def test_a_wheel_says_what_is_in_it(wheel, tmp_path):
    assert re.fullmatch(r"canopus-[0-9.]+-cp3\d+-cp3\d+-linux_\w+\.whl", wheel.name)
    with zipfile.ZipFile(wheel) as archive:
        assert archive.testzip() is None
        names = archive.namelist()
        record = next(name for name in names if name.endswith(".dist-info/RECORD"))
        listed = [line.split(",")[0] for line in archive.read(record).decode().splitlines()]
    assert sorted(listed) == sorted(names) and not any("__pycache__" in name for name in names)
    assert {"canopus/__init__.py", "canopus/_core.pyi", "canopus/py.typed", "canopus_plc/__init__.py", "pytest_canopus.py"} <= set(names)
    again = run(sys.executable, ROOT / "tools/python-wheel", BUILT, tmp_path)
    assert pathlib.Path(again.stdout.strip()).read_bytes() == wheel.read_bytes()


def test_without_a_build_there_is_no_wheel(tmp_path):
    done = run(sys.executable, ROOT / "tools/python-wheel", tmp_path, tmp_path)
    assert done.returncode == 1 and "cmake --preset python" in done.stderr and "Traceback" not in done.stderr


def test_the_reference_has_everything_that_is_public():
    done = run(sys.executable, ROOT / "tools/python-reference")
    assert done.returncode == 0, done.stderr
    for name in canopus.__all__:
        assert f"`{name}" in done.stdout, name
        documented = getattr(canopus, name)
        assert documented.__doc__, name
        for member, value in vars(documented).items() if isinstance(documented, type) else ():
            if not member.startswith("_") and callable(value):
                assert f"`{member}(" in done.stdout, f"{name}.{member}"
                assert value.__doc__, f"{name}.{member} has no docstring"
    assert "seconds of plant time" in done.stdout and "CiA 301" in done.stdout and not re.search(r"\bself\b", done.stdout)
