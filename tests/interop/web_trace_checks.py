"""Checks of the trace on the page of a run, in a real Chromium; exported files are read by python-can and tshark."""
import json
import os
import pathlib
import re
import shutil
import subprocess

from kit import BROWSER_PATIENCE, HERE, browser, check, command, first_plant_file, require, running, scratch, tier
from web_checks import page_of


@check
@tier("browser")
def web_trace_in_chromium():
    """Lines of a trace: they follow, are held, filtered, folded, counted and exported; who only looks may do all of it."""
    chromium = browser()
    pictures = pathlib.Path(os.environ.get("CANOPUS_PICTURES", scratch)) / "trace"
    pictures.mkdir(parents=True, exist_ok=True)
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        seen = json.loads(command("node", HERE / "web_trace.mjs", chromium, page_of(plant)[0], pictures, timeout=BROWSER_PATIENCE).stdout)
    require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
    require(seen["held"] and seen["wheeled"], seen)
    require(re.match(r"0\.000\d+line1702", seen["oldest"]) and "boot-up" in seen["oldest"] and seen["third"].startswith("0.000"), seen["oldest"])
    require(seen["transfer"] == {"clicks": 1, "typed": 0} and len(seen["frames"]) == 2, seen)
    require("40 18 10 02 00 00 00 00" in seen["frames"][0] and "43 18 10 02" in seen["frames"][1] and "1018:02" in seen["facts"], seen["frames"])
    require("upload request" in seen["pair"][0] and "upload response" in seen["pair"][1], seen["pair"])
    require(all("3 encoder" in line and "SDO" in line for line in seen["filtered"]), seen["filtered"])
    require(seen["wrong"] == 'service=sdp: unknown service; did you mean "sdo"?' and seen["invalid"] == "true", seen["wrong"])
    require(seen["link"] == "#trace/id%3D183" and seen["linked"] == "node=3 service=error-control" and seen["hostile"] == 0, seen)
    require(re.search(r"\b0 lines of \d+ frames", seen["last"]), seen["last"])
    require(seen["narrow"] >= 160, f"{seen['narrow']} pixels for the meaning of a line")
    require("+0.0" in seen["delta"] and re.search(r"183HTPDO1 of 3 \(encoder\)\d+", seen["figures"]), seen)
    # Nothing but 183H, and one frame a line; the other format has no fewer.
    log = (pictures / "trace.candump").read_text().splitlines()
    number = int(re.match(r"(\d+) frames are exported", seen["candump"])[1])
    require(len(log) == number > 10 and all(" line1 183#" in line for line in log), log[:3])
    python = "import can, sys; print(sum(m.arbitration_id == 0x183 and len(m.data) == 4 for m in can.CanutilsLogReader(sys.argv[1])))"
    if subprocess.run(["/usr/bin/python3", "-c", "import can"], capture_output=True).returncode == 0:
        require(int(command("/usr/bin/python3", "-c", python, pictures / "trace.candump").stdout) == number, "python-can reads other frames")
    if shutil.which("tshark"):
        found = command("tshark", "-r", pictures / "trace.pcapng", "-T", "fields", "-e", "can.id").stdout.split()
        require(len(found) == int(re.match(r"(\d+)", seen["pcapng"])[1]) >= number and set(found) <= {"387", "0x00000183", "0x183"}, found[:3])
