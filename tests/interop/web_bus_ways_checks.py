"""Checks of scan, LSS and single objects on the page of a run, in a real Chromium."""
import json
import re
import shutil

from kit import BROWSER_PATIENCE, HERE, ROOT, Skip, check, command, first_plant_file, node_modules, require, running, scratch
from web_checks import page_of, page_with_key, pictures_of


@check
def web_scan_lss_and_sdo_in_chromium():
    """A scan from one node to another; devices without a node-ID are found and get one; an object is read, written and refused with its reason."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not chromium:
        raise Skip("no Chromium: tools/install-packages check")
    node_modules()
    text = (ROOT / "examples/lss/plant.toml").read_text().replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{ROOT}/examples/devices/')
    plant_file = scratch / "web-lss.toml"
    plant_file.write_text("\n".join(line for line in text.splitlines() if not line.startswith("store")) + "\n")
    with running(plant_file, has_plc=False, words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_bus_ways.mjs", chromium, page_with_key(plant), pictures_of("views"), timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["nobody"] == "no node answers", seen["nobody"])
    require(seen["found"] == "3 devices" and all(row.endswith("none") for row in seen["devices"]) and "00000405" not in seen["devices"][0], seen)
    require(seen["devices"][0].startswith("00000000H00000401H00010000H00000A01H"), seen["devices"])
    require(seen["assigned"] == "3 devices" and [row[-2:] for row in seen["named"]] == ["10", "11", "12"], seen["named"])
    require(seen["none_left"] == "no device without a node-ID answers", seen["none_left"])
    require(seen["scanned"] == "2 nodes are on the bus" and [row[:2] for row in seen["nodes"]] == ["11", "12"], seen["nodes"])
    require(seen["refused"].startswith('"12-11"') or "expected" in seen["refused"], seen["refused"])
    require(seen["read"] == "1018:02 reads: 1025 (01 04 00 00)", seen["read"])
    require(seen["bytes"] == "1018:02 reads: 01 04 00 00", seen["bytes"])
    require(seen["abort"] == "5000:02: abort 06020000H: object does not exist", seen["abort"])
    require(seen["written"] == "1017:00 is written: 250 (FA 00)" and seen["after"] == "1017:00 reads: 250 (FA 00)", seen)
    require("which type has the value" in seen["no_type"], seen["no_type"])
    require(seen["look"] == 0, "who only looks")


@check
def web_error_frames_and_arbitration_in_chromium():
    """What was wrong where, with the bits of the frame, the flags and the delimiter; who lost the arbitration to a frame; waiting frames."""
    chromium = shutil.which("chromium") or shutil.which("chromium-browser") or shutil.which("google-chrome")
    if not chromium:
        raise Skip("no Chromium: tools/install-packages check")
    node_modules()
    text = first_plant_file().read_text()
    fault = '[[bus.fault]]\nkind = "corrupt"\nidentifier = 0x183\nbit = 30\nevery = 50\n\n'
    plant_file = scratch / "web-error-frames.toml"
    plant_file.write_text(text.replace("[[device]]", fault + "[[device]]", 1))
    with running(plant_file, operational=[1, 2, 3], words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_error_frames.mjs", chromium, page_of(plant)[0], pictures_of("views"), timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(1 <= len(seen["latest"]) <= 8 and all(re.fullmatch(r"\d+\.\d{6} s: (bit|stuff) error in [^,]+, bit 30, found by [^,]+(, which sends it)?( and \d+ more)?", one) for one in seen["latest"]), seen["latest"])
    require(seen["parts"] == ["frame", "error flag", "error delimiter"], seen["parts"])
    require(seen["bits"][0] == 31 and 6 <= seen["bits"][1] <= 12 and seen["bits"][2] == 8 and seen["wrong"] == 1, seen["bits"])
    require(re.match(r"Nobody else began to send with it\.|Lost the arbitration to it: ", seen["lost"]), seen["lost"])
    require(seen["cut_off"] == 0, f"the right-hand {seen['cut_off']} pixels of the error counters are not in sight")
    require(len(seen["waiting"]) == 4 and all(re.fullmatch(r"\d+, at most \d+", one) for one in seen["waiting"]), seen["waiting"])
