"""The pytest plug-in: pytest runs in this process or in one of its own, on test files that are written here."""
import os
import pathlib
import re
import subprocess
import sys

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402

PLANT = pathlib.Path(__file__).with_name("plant.toml")
BUILT = pathlib.Path(canopus._core.__file__).parents[1]
TINY = '[plant]\nname = "tiny"\nseed = 7\n[[bus]]\nname = "a"\nbit_rate = 500_000\n'


@pytest.fixture
def tests(pytester, monkeypatch):
    """pytest in a process of its own, which finds the plug-in by its entry point."""
    monkeypatch.setenv("PYTHONPATH", str(BUILT))
    pytester.makefile(".toml", plant=TINY)

    def run(text, *options):
        pytester.makepyfile(text)
        return pytester.runpytest_subprocess("-p", "no:cacheprovider", *options)
    return run


def test_each_test_has_the_plant_of_its_folder(tests):
    tests("""
        def test_one(plant):
            assert plant.time == 0 and plant.buses == ["a"]
            plant.run(1)

        def test_other(plant):
            assert plant.time == 0
        """).assert_outcomes(passed=2)


def test_a_mark_names_the_plant_and_its_arguments(tests):
    tests(f"""
        import pytest
        @pytest.mark.plant({str(PLANT)!r}, seed=3)
        def test_file(plant):
            assert plant.plc.cpu_name == "R04CPU"

        @pytest.mark.plant("inline.toml", text='[plant]\\nname = "x"\\n[[bus]]\\nname = "other"\\nbit_rate = 125_000\\n')
        def test_text(plant):
            assert plant.buses == ["other"]
        """, "--strict-markers").assert_outcomes(passed=2)


def test_plants_are_closed_after_their_test(tests):
    tests("""
        kept = []

        def test_one(plant, make_plant):
            kept.extend([plant, make_plant(), make_plant("plant.toml", seed=5)])
            kept[1].run(0.5)
            assert plant.time == 0

        def test_other():
            assert [plant._core.closed for plant in kept] == [True] * 3
        """).assert_outcomes(passed=2)


def test_a_wrong_plant_is_an_error_of_the_test_with_its_place(tests):
    result = tests("""
        import pytest
        @pytest.mark.plant("mine.toml", text="[plant\\n")
        def test_it(plant):
            pass
        """)
    result.assert_outcomes(errors=1)
    result.stdout.re_match_lines([r".*mine\.toml:1:\d+: .*"])


def test_a_failed_test_shows_its_plant(tests):
    result = tests(f"""
        import pytest
        @pytest.mark.plant({str(PLANT)!r})
        def test_it(plant):
            plant.run(2)
            assert False

        def test_well(plant):
            plant.run(123)
        """)
    result.assert_outcomes(failed=1, passed=1)
    result.stdout.fnmatch_lines(["*- plant -*", "time 2 s", "io-block: operational", '{*"event": *'])
    assert "123" not in result.stdout.str().split("- plant -")[1]


def test_names_cannot_write_to_the_terminal(tests):
    result = tests("""
        import pytest
        @pytest.mark.plant("p.toml", text='[plant]\\nname = "x"\\n[[bus]]\\nname = "a"\\nbit_rate = 125_000\\n[[device]]\\nnode = 2\\n'
                           'eds = "%s"\\nname = "evil\\\\u001b[2Jname"\\n')
        def test_it(plant):
            assert False
        """ % (PLANT.parents[2] / "examples/devices/io-block.eds"))
    out = result.stdout.str()
    assert "\x1b[2J" not in out and "evil\\x1b[2Jname: pre-operational" in out


def test_the_frames_of_a_failed_test_are_kept_for_candumps_readers(tests, pytester):
    can = pytest.importorskip("can", reason="python3-can is not installed")
    result = tests(f"""
        import pytest
        @pytest.mark.plant({str(PLANT)!r})
        @pytest.mark.parametrize("fails", [True, False], ids=["a/b ../c", "d"])
        def test_it(plant, fails):
            plant.run(2)
            plant.sdo_upload(2, 0x1000)
            assert not fails
        """, "--plant-traces=traces")
    result.assert_outcomes(failed=1, passed=1)
    files = list((pytester.path / "traces").iterdir())
    assert len(files) == 1 and re.fullmatch(r"[A-Za-z0-9._-]+\.log", files[0].name)
    messages = list(can.CanutilsLogReader(str(files[0])))
    assert messages[0].channel == "line1" and messages[0].timestamp == 1.000704 and bytes(messages[0].data) == b"\x82\x00"
    assert any(m.arbitration_id == 0x582 and bytes(m.data).hex() == "4300100091010f00" for m in messages)
    assert [m.timestamp for m in messages] == sorted(m.timestamp for m in messages)


def test_a_pytest_without_plants_does_not_load_the_module(tests):
    tests("""
        import sys
        def test_it(request):
            assert request.config.pluginmanager.hasplugin("pytest_canopus")
            assert "canopus._core" not in sys.modules
        """).assert_outcomes(passed=1)


def test_a_conftest_may_name_the_plug_in_as_well(tests, pytester):
    pytester.makeconftest('pytest_plugins = ["pytest_canopus", "canopus_plc.pytest_plugin"]')
    tests("def test_it(plant):\n    pass\n").assert_outcomes(passed=1)


def test_the_page_shows_a_test_that_passes(tests, pytester):
    root = pathlib.Path(__file__).resolve().parents[2]
    block = (root / "docs/python-module.md").read_text().split("## Tests with pytest")[1].split("```python\n")[1].split("```")[0]
    pytester.makepyfile(block.replace('"examples/', f'"{root}/examples/'))
    done = subprocess.run([sys.executable, "-m", "pytest", "-q", "-p", "no:cacheprovider", str(pytester.path)],
                          capture_output=True, text=True, timeout=300, env={**os.environ, "PYTHONPATH": str(BUILT)})
    assert re.search(r"\b1 passed", done.stdout), done.stdout
