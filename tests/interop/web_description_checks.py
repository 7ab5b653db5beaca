"""Checks of the description of what has the focus and of the strip with the newest events, in a real Chromium."""
import json
import re

from kit import BROWSER_PATIENCE, HERE, browser, check, command, first_plant_file, require, running, tier
from web_checks import page_of, pictures_of


@check
@tier("browser")
def web_description_in_chromium():
    """What an object or a word is, its range and default, what it is for; the newest events lead to their frames."""
    chromium = browser()
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_description.mjs", chromium, page_of(plant)[0], pictures_of("views"), timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["wide"] and not seen["small"] and seen["small_asked"] and seen["pressed"] == "true", seen)
    heartbeat = seen["heartbeat"]
    require("heartbeat" in heartbeat["title"].lower() and heartbeat["facts"]["Object"] == "1017:00" and heartbeat["facts"]["Type"] == "UNSIGNED16", heartbeat)
    require(heartbeat["facts"]["In words"].startswith("every "), heartbeat)
    require("How often the device sends its heartbeat" in heartbeat["meaning"] and heartbeat["meaning"].endswith("Unit: ms."), heartbeat)
    require(heartbeat["source"] == "CiA 301 7.5.2.20", heartbeat)
    require(seen["own"]["Object"] == "6004:00", seen["own"])
    require(seen["word"]["facts"]["Address"] == "G24" and "1000" in seen["word"]["facts"]["Range"] and seen["word"]["facts"]["Manual"], seen["word"])
    require(seen["word"]["meaning"] == "", seen["word"])
    require(seen["hidden"] and seen["stays_hidden"], "the description stays")
    require(1 <= len(seen["newest"]) <= 3 and seen["in_sight"] and seen["folded"], seen["newest"])
    found = re.match(r"([\d.]+) s  ", seen["event"]["text"])
    require(found and seen["event"]["link"].startswith("#trace/bus=line1 from="), seen["event"])
    require(seen["filter"].startswith("bus=line1 from="), seen["filter"])
    require(abs(float(seen["frame"][0]) - float(found[1])) < 0.012, (seen["frame"], seen["event"]))
