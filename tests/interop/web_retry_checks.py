"""Checks of [Retry] on the page: a failed boot is tried again by the master, one slave or the whole start-up, in a real Chromium."""
import json

from bus_checks import on_bus
from kit import BROWSER_PATIENCE, HERE, browser, check, command, first_plant_file, require, running, scratch, tier
from web_checks import page_with_key


def look(address):
    """One visit of the page: what it shows before and after one click."""
    chromium = browser()
    return json.loads(command("node", HERE / "web_retry.mjs", chromium, address, scratch, "drive", timeout=BROWSER_PATIENCE).stdout)


def plant_with_wrong_product(name, mandatory):
    text = first_plant_file().read_text().replace('"1016:01" =', '"1F86:04" = 0x1234, "1016:01" =', 1)
    require("1F86:04" in text, text)
    if not mandatory:
        text = text.replace("[[plc.module.slave]]", "[[plc.module.slave]]\nmandatory = false", 1)
    path = scratch / name
    path.write_text(text)
    return path


@check
@tier("browser")
def web_retry_of_one_slave():
    """An optional slave with another product code failed; with what is expected put right, one click boots it."""
    with running(plant_with_wrong_product("retry-one.toml", mandatory=False), words=["--web"]) as plant:
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e.get("error") == "M")
        plant.wait_operational([2, 3])
        again = look(page_with_key(plant))
        require(again["problems"] == [] and again["axe"] == [] and again["overflow"] == [], again)
        require(again["buttons"] == ["Retry"] and again["halts"] == [], again)
        require(again["show"] == [["Show", "false", False], ["Hide", "true", True]] * 2, again["show"])
        require(again["clicks"] == {"clicks": 1, "typed": 0} and again["still"] and again["attempts"] == 2, again)
        require(again["command"].startswith("canopus nmt reset-comm --wait --timeout=5s --json --bus="), again["command"])
        require(again["look"] == 0, "who only looks")
        on_bus(plant, "sdo", "write", "1", "1F86:04", "0x402", "--type", "u32")
        done = look(page_with_key(plant))
        require(done["result"].startswith("booted in ") and done["buttons_left"] == 0 and done["pauses"] > 0, done)
        plant.wait_operational([4])


@check
@tier("browser")
def web_retry_of_a_halted_start_up():
    """A mandatory slave halted the start-up: the page says so, offers that of all, and all are booted."""
    with running(plant_with_wrong_product("retry-all.toml", mandatory=True), words=["--web"]) as plant:
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e.get("error") == "M")
        on_bus(plant, "sdo", "write", "1", "1F86:04", "0x402", "--type", "u32")
        on_bus(plant, "sdo", "write", "1", "1010:01", "0x65766173", "--type", "u32")  # the master is reset, too
        seen = look(page_with_key(plant))
        require(seen["problems"] == [] and seen["axe"] == [] and seen["overflow"] == [], seen)
        require(len(seen["halts"]) == 1 and "master 1 ME3CAN1-Q U0 has halted its start-up: a mandatory slave was not booted." in seen["halts"][0], seen)
        require(seen["buttons"] == ["Retry start-up"] and seen["halts_left"] == 0, seen)
        require(seen["result"].startswith("booted in "), seen["result"])
        plant.wait_operational([2, 3, 4])
