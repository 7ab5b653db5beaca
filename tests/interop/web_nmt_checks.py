"""Checks of NMT commands on the page of a run, in a real Chromium."""
import json

from kit import BROWSER_PATIENCE, HERE, browser, check, command, first_plant_file, require, running, scratch, tier
from web_checks import page_with_key


@check
@tier("browser")
def web_nmt_in_chromium():
    """Start, Stop and the others to all nodes of a bus and to one, by mouse and keyboard; nothing for who only looks."""
    chromium = browser()
    # Slaves that no master starts again.
    text = first_plant_file().read_text()
    plant_file = scratch / "web-nmt.toml"
    plant_file.write_text(text[:text.index("[[plc]]")])
    with running(plant_file, has_plc=False, words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_nmt.mjs", chromium, page_with_key(plant), scratch, timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["buttons"] == ["Start all", "Stop all", "Pre-operational all", "Reset all", "Reset communication all"], seen["buttons"])
    require(seen["stop"] == {"clicks": 1, "typed": 0} and seen["stopped"] == ["stopped"] * 3, seen["stopped"])
    require(seen["said"] == "Stop all: sent" and seen["command"].startswith("canopus nmt stop --json --bus="), seen)
    require(seen["start"] == {"clicks": 1, "typed": 0} and sorted(seen["started"]) == ["operational", "stopped", "stopped"], seen["started"])
    require(seen["said_of_one"] == "Start: sent", seen["said_of_one"])
    require(seen["look"] == 0, "who only looks")
