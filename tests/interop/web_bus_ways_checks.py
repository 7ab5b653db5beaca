"""Checks of scan, LSS and single objects on the page of a run, in a real Chromium."""
import json
import re

import kit
from kit import BROWSER_PATIENCE, HERE, ROOT, browser, check, command, first_plant_file, require, running, scratch, tier
from web_checks import page_of, page_with_key, pictures_of


@check
@tier("browser")
def web_scan_lss_and_sdo_in_chromium():
    """A scan from one node to another; devices without a node-ID are found and get one; an object is read, written and refused with its reason."""
    chromium = browser()
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


def other_rate_file(name):
    plant_file = scratch / name
    text = (ROOT / "examples/lss/other-rate.toml").read_text()
    plant_file.write_text(text.replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{ROOT}/examples/devices/'))
    return plant_file


@check
@tier("browser")
def web_lss_over_bit_rates_in_chromium():
    """A device that waits at another bit rate is found there, and has a node-ID at the bit rate of the network."""
    chromium = browser()
    with running(other_rate_file("web-rates.toml"), has_plc=False, words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_rates.mjs", chromium, page_with_key(plant), pictures_of("views"), timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require("four parts" in seen["half"], seen["half"])
    require(seen["found"] == "found at 500 kbit/s: is node 9 at 125 kbit/s now", seen["found"])
    require(seen["rows"] == ["00000071H00000406H00010000H00000B02H9"], seen["rows"])


@check
def lss_search_over_bit_rates():
    """The same by the command, by LSS address; who is not there, refusals, and the exit codes."""
    with running(other_rate_file("rates.toml"), has_plc=False) as plant:
        bus = f"--bus=socketcand:{plant.socketcand}"
        address = ["--vendor=0x71", "--product=0x406", "--revision=0x10000"]

        def search(code, *words):
            return command(kit.program, "lss", "search", bus, "--timeout=50ms", *words, expect=code)

        done = search(2, "7")
        require("give --bit-rate, for example 125k" in done.stderr, done.stderr)
        done = search(1, "7", "--bit-rate=125k", *address, "--serial=0xB03")
        require(done.stderr == "canopus: vendor 00000071  product 00000406  revision 00010000  serial 00000B03: no answer at any bit rate of LSS\n", done.stderr)
        done = search(0, "7", "--bit-rate=125k", "--json", *address, "--serial=0xB02")
        require(json.loads(done.stdout) == {"vendor": 0x71, "product": 0x406, "revision": 0x10000, "serial": 0xB02, "node": 7, "bit_rate": 125000, "found_at": 500000}, done.stdout)
        done = command(kit.program, "sdo", "read", bus, "7", "1018:04")
        require("00000B02H" in done.stdout, done.stdout)
        done = search(1, "8", "--bit-rate=125k")
        require(done.stderr == "canopus: no device without a node-ID answers at any bit rate of LSS\n", done.stderr)


@check
@tier("browser")
def web_error_frames_and_arbitration_in_chromium():
    """What was wrong where, with the bits of the frame, the flags and the delimiter; who lost the arbitration to a frame; waiting frames."""
    chromium = browser()
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
