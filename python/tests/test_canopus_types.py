"""mypy over the packages, and stubtest over the stub of the part in C++."""
import os
import pathlib
import shutil
import subprocess

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(canopus._core.__file__).parents[1]


def run(program, *words, cwd):
    if shutil.which(program) is None:
        pytest.skip(f"{program} is not installed")
    environment = {**os.environ, "PYTHONPATH": str(BUILT), "MYPYPATH": str(BUILT)}
    return subprocess.run([program, *words], capture_output=True, text=True, timeout=300, cwd=cwd, env=environment)


def test_types_hold(tmp_path):
    done = run("mypy", "--strict", f"--cache-dir={tmp_path}", "canopus", "canopus_plc", "pytest_canopus.py", cwd=ROOT / "python")
    assert done.returncode == 0, done.stdout + done.stderr


def test_the_stub_is_what_the_module_has(tmp_path):
    done = run("stubtest", "canopus._core", cwd=tmp_path)
    # What pybind11 makes: its metaclass, and classes that nobody makes from Python.
    harmless = ("metaclass differs", '__init__ is inconsistent, stub does not have *args argument "args"')
    wrong = [line for line in done.stdout.splitlines() if line.startswith("error:") and not any(each in line for each in harmless)]
    assert wrong == [] and ("Found" in done.stdout or "Success" in done.stdout), done.stdout + done.stderr
