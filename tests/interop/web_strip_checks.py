"""Checks of the strip at the bottom of the page and of its list of events, in a real Chromium."""
import json
import re

from kit import BROWSER_PATIENCE, HERE, browser, check, command, first_plant_file, require, running, tier
from web_checks import page_with_key, pictures_of


@check
@tier("browser")
def web_strip_in_chromium():
    """What somebody does stands there in words: what was run, by whom, how it ended; nothing as JSON."""
    chromium = browser()
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_strip.mjs", chromium, page_with_key(plant), pictures_of("strip"), timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    who = r"; by 127\.0\.0\.1:\d+ \(configure\)"
    wanted = [("let plant time stand still: done", ""), ("let plant time go at ×10: done", ""), ("let plant time go at ×1: done", ""),
              (r"canopus nmt preop --json --bus=\S+ -- all: done", ""),
              (r"run the faults of line1 anew, 1 of 1 on, seed \d+: done", ""), (r"run the faults of line1 anew, 1 of 1 on, seed \d+: fault 1: .*expected .*", "error")]
    for (text, tip, mood), (words, wanted_mood) in zip(seen["done"], wanted, strict=True):
        require(re.fullmatch(words + who, text) and tip.endswith(text) and mood == wanted_mood, (text, words, mood))
    require(re.fullmatch(r"change the pace of plant time: pace: the role operate is needed, yours is look; by 127\.0\.0\.1:\d+ \(look\)", seen["refused"][0]) and seen["refused"][2] == "error", seen["refused"])
    require(len([line for line in seen["listed"] if "(configure)" in line]) == 6, seen["listed"])
    require(not [line for line in seen["all"] if re.search(r'[{}]|"\w+": *["\d[]', line)], seen["all"])
