"""Checks of scan, LSS and single objects on the page of a run, in a real Chromium."""
import json
import shutil

from kit import HERE, ROOT, Skip, check, command, node_modules, require, running, scratch
from web_checks import page_with_key, pictures_of


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
        seen = json.loads(command("node", HERE / "web_bus_ways.mjs", chromium, page_with_key(plant), pictures_of("views"), timeout=240).stdout)
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
