"""Tests of the package as it lies here: python3 -m pytest python/tests. CANOPUS_PROGRAM is the absolute path of
the program under test."""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
BUILT = pathlib.Path(os.environ.get("CANOPUS_PYTHON", ROOT / "build/python-module/python"))
sys.path.insert(0, str(ROOT / "python"))
if list((BUILT / "canopus").glob("_core.*")):  # both packages, with the part in C++
    sys.path.insert(0, str(BUILT))

pytest_plugins = ["canopus_plc.pytest_plugin", "pytester"]
