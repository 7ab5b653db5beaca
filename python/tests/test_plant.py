"""Plants of the real program."""
import pathlib

import pytest

from canopus_plc import EndCodeError, Plant, PlantError, Plc

HERE = pathlib.Path(__file__).resolve().parent


def exchange(plc):
    """A data exchange as the module's manual has it: Y01 ON, X01 comes, Y01 OFF."""
    plc.y[1] = True
    plc.wait(lambda: plc.x[1])
    plc.y[1] = False
    plc.wait(lambda: not plc.x[1])


def operational(plc):
    plc.wait(r"U0\G601 == 5", timeout=60)


def test_an_output_comes_back(canopus_plant, plc):
    operational(plc)
    assert canopus_plant.states() == {"io-block": "operational"}
    plc.g[0][13000:13004] = [0x5A, 0, 0, 0]

    def echoed():
        exchange(plc)
        return plc.g[0][10000] >> 8 == 0x5A

    plc.wait(echoed)
    assert canopus_plant.value("io-block", "6200:01") == 0x5A


def test_scans_are_counted(canopus_plant, plc):
    assert plc.sm[402] and plc.sd[420] == 0
    assert plc.run(scans=100) == 100
    assert canopus_plant.time == 0.5
    assert plc.sd[420] == 100 and not plc.sm[402]
    assert plc.run(seconds=0.012) == 2
    assert plc.run(scans=10, until="SD420 >= 104") == 2
    canopus_plant.run(0.5)
    assert canopus_plant.time == 1.02
    assert plc.cpu_name == "R04CPU"
    plc.remote_stop()
    plc.run(scans=3)
    assert plc.sd[420] == 204 and plc.sm[203]


def test_what_does_not_come_is_a_time_out_of_plant_time(canopus_plant, plc):
    with pytest.raises(TimeoutError, match="'M0' did not come true within 2 s"):
        plc.wait("M0", timeout=2)
    assert canopus_plant.time == 2
    with pytest.raises(TimeoutError):
        plc.wait(lambda: plc.m[0], timeout=2)
    assert canopus_plant.time == 4


def test_forced_values_arrive(canopus_plant, plc):
    operational(plc)
    canopus_plant.force("io-block", "6000:01", 0x11)

    def arrived():
        exchange(plc)
        return plc.g[0][10000] & 0xFF == 0x11

    plc.wait(arrived)
    canopus_plant.release("io-block")
    assert canopus_plant.value("io-block", "6000:01") == 0


def test_wrong_requests_are_said_in_words_and_harm_nothing(canopus_plant, plc):
    for wrong, text in ((lambda: plc.run(until="Q1"), "is no device"), (lambda: canopus_plant.force("x", "6000:01", 1), "no device"),
                        (lambda: plc.run(scans=-1), "scans: expected a number from 0 on")):
        with pytest.raises(PlantError, match=text):
            wrong()
    with pytest.raises(ValueError):
        canopus_plant.run(0)
    assert plc.run(scans=1) == 1


def test_one_program_gives_one_trace(tmp_path):
    traces = []
    for number in range(2):
        path = tmp_path / f"{number}.log"
        with Plant(HERE / "plant.toml", trace=path, seed=7) as plant:
            operational(plant.plc)
            for word in range(50):
                plant.plc.g[0][13000] = word
                exchange(plant.plc)
                plant.plc.run(scans=word % 5)
        traces.append(path.read_bytes())
    assert traces[0] == traces[1] and traces[0].count(b"\n") > 100


def test_plants_run_side_by_side():
    with Plant(HERE / "plant.toml") as one, Plant(HERE / "plant.toml") as other:
        one.plc.run(scans=10)
        assert (one.time, other.time) == (0.05, 0)
        assert one.socketcand()[1] != other.socketcand("line1")[1]


def test_in_real_time_a_plant_runs_by_itself(tmp_path):
    text = (HERE / "plant.toml").read_text().replace("../../examples", str(HERE.parents[1] / "examples"))
    (tmp_path / "plant.toml").write_text(text)
    with Plant(tmp_path / "plant.toml", step=False) as plant:
        plant.plc.wait(lambda: plant.plc.sd[420] > 5, timeout=60)
        with pytest.raises(PlantError, match="needs `control`"):
            plant.run(1)
    (tmp_path / "plant.toml").write_text(text.replace("[plant]", '[plant]\ncontrol = "127.0.0.1:0"'))
    with Plant(tmp_path / "plant.toml", step=False) as plant:
        assert plant.plc.run(scans=5) == 5


def test_a_wrong_plant_file_says_what_is_wrong(tmp_path):
    (tmp_path / "wrong.toml").write_text("[[plc]]\nscan = 5\n")
    with pytest.raises(PlantError, match=r"(?s)did not start, exit code 2:.*wrong.toml:2:8: scan = 5: expected a time with a unit in quotes"):
        Plant(tmp_path / "wrong.toml")
    with pytest.raises(PlantError, match="nothing-there: No such file"):
        Plant(HERE / "plant.toml", program="/nothing-there")


def test_a_plant_that_has_ended(tmp_path):
    with Plant(HERE / "plant.toml", arguments=["--for", "1s"]) as plant:
        with pytest.raises(PlantError, match="the run of the plant ended first"):
            plant.plc.run(seconds=2)
        with pytest.raises(PlantError):
            plant.plc.run(scans=1)
    assert plant.events[-1]["event"] == "summary"


def test_several_plcs_have_names(tmp_path):
    (tmp_path / "plant.toml").write_text(
        '[[bus]]\nname = "line1"\nbit_rate = 250_000\n[[plc]]\nname = "a"\n[[plc]]\nname = "b"\nlisten = "127.0.0.1:5008"\nscan = "1ms"\n')
    with Plant(tmp_path / "plant.toml") as plant:
        with pytest.raises(PlantError, match="has 2 PLCs"):
            plant.plc
        plant.plcs["b"].run(scans=5)
        assert plant.time == 0.005
        plant.plcs["a"].d[0] = 1
        assert plant.plcs["b"].d[0] == 0


def test_devices_of_the_iqr_series(canopus_plant, plc):
    plc.rd[524280:524288] = range(8)
    assert plc.rd[524286:524288] == [6, 7]
    plc.hg[10:1010] = range(1000)  # two requests
    assert plc.hg[10:1010] == list(range(1000))
    with pytest.raises(EndCodeError, match=r"U3E0\\HG12288.*4031H"):
        plc.hg[12288]


def test_a_plc_of_another_family(tmp_path):
    (tmp_path / "plant.toml").write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\n[[plc]]\nfamily = "FX5"\nscan = "1ms"\n')
    with Plant(tmp_path / "plant.toml") as plant:
        plc = plant.plc
        plc.run(scans=3)
        assert (plc.sd[420], plc.sd[8010], plc.sm[8000]) == (3, 10, True)
        plc.y["17"] = True
        assert plc.y[0o17] and not plc.y[0o16]


def test_without_a_plant_it_is_any_plc(canopus_plant):
    host, port = canopus_plant.plc.mc._place.rsplit(":", 1)
    with Plc(host, int(port), frame="4E") as plc:
        plc.d[0:3] = [1, 2, 3]
        assert canopus_plant.plc.d[0:3] == [1, 2, 3]
        plc.rd[524286:524288] = [7, 8]
        assert canopus_plant.plc.rd[524286:524288] == [7, 8]


def test_the_fixtures_as_somebody_else_uses_them(pytester):
    pytester.makeconftest('pytest_plugins = ["canopus_plc.pytest_plugin"]')
    (pytester.path / "other.toml").write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\n[[plc]]\nscan = "1ms"\n')
    pytester.makepyfile("""
        import pytest

        @pytest.mark.canopus_plant("other.toml", seed=3)
        def test_it(canopus_plant, plc):
            plc.run(scans=2)
            assert canopus_plant.time == 0.002
    """)
    pytester.runpytest("--strict-markers").assert_outcomes(passed=1)


def test_a_failed_wait_shows_what_the_plant_was_doing(pytester):
    root = HERE.parents[1]
    pytester.makefile(".toml", other="""
[[bus]]
name = "line1"
bit_rate = 250_000
[[plc]]
listen = "127.0.0.1:0"
[[plc.module]]
model = "ME3CAN1-Q"
head = 0
node = 1
master = true
[plc.module.objects]
"1F81:09" = 0x05
""")
    pytester.makeconftest(f"import sys\nsys.path.insert(0, {str(root / 'python')!r})\npytest_plugins = ['canopus_plc.pytest_plugin']\n")
    pytester.makepyfile("""
        import pytest
        @pytest.mark.canopus_plant("other.toml", trace="frames.log")
        def test_it(canopus_plant, plc):
            plc.wait("M0", timeout=4)
        """)
    result = pytester.runpytest_subprocess("-p", "no:cacheprovider")
    result.assert_outcomes(failed=1)
    result.stdout.fnmatch_lines(["*TimeoutError: 'M0' did not come true within 4 s", "*- plant -*", "time 4 s",
                                 "node 9: no answer to 1000H*Check that the device is powered*", "frames: frames.log",
                                 '{*"event": *'])
