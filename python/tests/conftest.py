"""Tests of the package as it lies here: python3 -m pytest python/tests. CANOPUS_PROGRAM names the program under test."""
import pathlib
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))

pytest_plugins = ["canopus_plc.pytest_plugin", "pytester"]
