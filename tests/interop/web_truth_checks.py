"""Checks of what the page says when things are not as they were: a run that hangs, a bus that falls silent and goes, somebody else who changes
the project, nodes of one name."""
import json
import shutil

from kit import BROWSER_PATIENCE, HERE, ROOT, browser, check, command, program, require, running, running_page, scratch, tier
from web_checks import Watcher, page_of, page_with_key, pictures_of

DEVICES = ROOT / "examples/devices"


def look(address, name, *words):
    """What a real Chromium saw."""
    chromium = browser()
    seen = json.loads(command("node", HERE / "web_truth.mjs", chromium, address, pictures_of(name), *words, timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], (seen["problems"], seen["axe"], seen["overflow"]))
    return seen


@check
@tier("browser")
def web_run_that_hangs_is_not_shown_as_alive():
    """A process that stands still keeps its connections: the page says so, and its time stands still, too. Devices of one name are each shown once."""
    plant_file = scratch / "web-twins.toml"
    twin = f'[[device]]\nnode = "unconfigured"\neds = "{DEVICES}/io-block.eds"\nobjects = {{ "1018:04" = %d }}\n'
    plant_file.write_text(f'[plant]\nname = "{"a long name " * 40}"\n[[bus]]\nname = "{"a bus with a long name " * 4}"\nbit_rate = 250_000\n'
                          f'[[device]]\nnode = 5\nname = "{"W" * 120}"\neds = "{DEVICES}/encoder.eds"\nobjects = {{ "1017:00" = 500 }}\n'
                          + twin % 1 + twin % 2 + twin % 3)
    with running(plant_file, has_plc=False, words=["--web"], is_served=False) as plant:
        seen = look(page_with_key(plant), "hangs", "run", plant.process.pid)
    require(len(seen["nodes"]) == 4 and len(seen["tree"]) == 4, (seen["nodes"], seen["tree"]))
    require(seen["bar_height"] < 160 and seen["title_fits"], f"names take {seen['bar_height']} pixels of the bar")
    require(seen["plotted_of_twin"] == 0, "which of the three would be plotted?")
    require(seen["seed"] == "4711", "the seed was forgotten")
    require(seen["silent"] == "The run does not answer. What is shown here is old." and seen["bar"] == "waiting", seen)
    require(seen["stood_still"] and seen["again"] == "", "time goes on without the run")


@check
@tier("browser")
def web_bus_that_is_gone_is_not_shown_as_there():
    """Nothing that was found on a bus before is shown as found now; a refused write stays to be written; what others change is seen."""
    folder = scratch / "web-truth"
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder)
    for name in ("encoder", "drive"):
        command(program, "project", "add", folder, DEVICES / f"{name}.eds", "--bit-rate", "250k")
    plant_file = scratch / "web-truth.toml"
    plant_file.write_text(f'[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\nproject = "{folder}/nodelist.cpj"\n')
    with running(plant_file, has_plc=False) as plant:
        with running_page(folder, "--bus", f"socketcand:{plant.socketcand}") as page:
            seen = look(page_with_key(page), "gone", "project", plant.process.pid)
    require(seen["worst"] == "no node is known", "all is well where nothing is known")
    require(seen["devices"] == ["as the project"] * 2, seen["devices"])
    require("!" in seen["typed"] and "by somebody else" in seen["seen_by_others"], seen)
    require(seen["plan"].endswith("this is what will be written"), seen["plan"])
    said, facts, is_disabled = seen["not_armed"]
    require("arm writing first" in said and facts == seen["plan"] and not is_disabled, seen["not_armed"])
    said, devices, rows = seen["silent"]
    require("no answer" in said and devices == ["", ""] and rows == 0, seen["silent"])
    require(seen["not_planned"] == ["what is to be written is not known", True], seen["not_planned"])
    where, worst, facts = seen["gone"]
    require(where.startswith("LIVE socketcand:") and worst == "bus network is gone" and facts.startswith("GONE: nothing is heard and sent"), seen["gone"])


@check
@tier("browser")
def web_looking_asks_no_node():
    """Every view of the page is opened by who may do everything: nothing is on the bus but what was there before, heartbeats and PDOs."""
    folder = scratch / "web-looking"
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder)
    for name in ("encoder", "drive"):
        command(program, "project", "add", folder, DEVICES / f"{name}.eds", "--bit-rate", "250k")
        command(program, "project", "set", folder, "1" if name == "encoder" else "2", "1017=200")
    with running_page(folder) as page:
        watcher = Watcher(page_of(page)[1])
        number = iter(range(1, 100))

        def frames(which):
            """How many there have been of these services."""
            own = next(number)
            watcher.say({"do": {"command": "trace", "filter": which, "fold": False, "count": 1}, "id": own})
            while True:
                reply = watcher.event(lambda e: e["event"] == "reply" and e["id"] == own)
                if "progress" not in reply["rows"][0]:
                    return reply["rows"][0]["end"] - reply["rows"][0]["first"]
                own = next(number)
                watcher.say({"do": {"command": "trace", "filter": which, "fold": False, "count": 1}, "id": own})
        look(page_with_key(page), "looking", "views")
        require(frames("service=error-control") > 10, "the trace has nothing to say")
        require(frames("service=sdo,nmt,lss,sync,time,mpdo") == 0, "looking has sent something")
