"""Checks of `canopus sdo` and `canopus eds concise` where values are said in words: concise DCFs and other domains."""
import json
import re

from bus_checks import on_bus
from kit import HERE, check, command, first_plant_file, program, require, running, scratch


def concise(*entries):
    """As 1F22H has it: index, sub-index, bytes."""
    return len(entries).to_bytes(4, "little") + b"".join(index.to_bytes(2, "little") + bytes([sub]) + len(data).to_bytes(4, "little") + data for index, sub, data in entries)


GOOD = concise((0x1017, 0, b"\xf4\x01"), (0x6000, 0, b"\x01\x00"))
BAD = GOOD[:4] + GOOD[4:13] + b"\x00\x60\x01\x70\x11\x01\x00" + bytes(12)


def plant_of_words():
    path = scratch / "web-in-words.toml"
    text = first_plant_file().read_text()
    device = f'[[device]]\nnode = 5\nname = "domains"\neds = "{HERE}/interop_device.eds"\n\n'
    text = text.replace("[[plc]]", device + "[[plc]]", 1).replace('objects = { "1017:00" = 1000,', 'objects = { "1F90:03" = 2, "1F90:04" = 100, "1017:00" = 1000,', 1)
    require("1F90" in text, "the module of the first plant has no objects of its own")
    path.write_text(text)
    return path


@check
def sdo_command_says_domains_and_concise_dcfs_in_words():
    """A concise DCF is shown as its objects with the names of the slave's file, what does not fit is said; other domains as bytes with text; with the speed."""
    files = {name: scratch / f"words-{name}.cdcf" for name in ("good", "bad", "text")}
    for name, content in (("good", GOOD), ("bad", BAD), ("text", b"firmware 1.2\n" * 500)):
        files[name].write_bytes(content)
    encoder = HERE.parent.parent / "examples/devices/encoder.eds"
    with running(plant_of_words(), operational=[1, 2, 3], words=[]) as plant:
        said = on_bus(plant, "sdo", "write", "1", "1F22:03", "--file", files["good"]).stdout
        require(re.search(r"1F22:03  22 bytes written\n  22 bytes in [\d.]+ m?s, [\d.]+ kB/s, segmented\n", said), said)
        said = on_bus(plant, "sdo", "read", "1", "1F22:03", "--eds", encoder).stdout
        require(re.fullmatch(r"1F22:03  concise DCF, 22 bytes, 2 entries\n  1017:00  \S.*  500 ms\n  6000:00  Operating parameters  +1\n  22 bytes in .* kB/s, segmented\n", said), said)
        require("Operating" not in on_bus(plant, "sdo", "read", "1", "1F22:03").stdout, "a name without a device file")
        on_bus(plant, "sdo", "write", "5", "2001", "--file", files["text"], "--block")
        said = on_bus(plant, "sdo", "read", "5", "2001", "--type", "domain", "--block").stdout.splitlines()
        require(said[0] == "2001:00  6500 bytes, the first 4096 of them" and len(said) == 258 and said[1].endswith("  |firmware 1.2.fir|"), said[:3])
        require(re.fullmatch(r"  6500 bytes in [\d.]+ m?s, [\d.]+ kB/s, block", said[-1]), said[-1])
        line = json.loads(on_bus(plant, "sdo", "read", "5", "2001", "--json").stdout)
        require(line["domain"]["heading"] == "6500 bytes, the first 4096 of them", line.keys())
        require(line["transfer"]["bytes"] == 6500 and line["transfer"]["form"] == "segmented" and line["transfer"]["seconds"] > 0, line["transfer"])
        line = json.loads(on_bus(plant, "sdo", "read", "1", "1F22:03", "--json").stdout)
        require([one["object"] for one in line["domain"]["entries"]] == ["1017:00", "6000:00"] and line["bytes"] == GOOD.hex().upper(), line)
        require("transfer" not in json.loads(on_bus(plant, "sdo", "read", "1", "1017", "--json").stdout), "1017H")
        require(on_bus(plant, "sdo", "read", "1", "1F22:03", "--eds", scratch / "none.eds", expect=2).stderr.count("none.eds") == 1, "--eds")
    said = command(program, "eds", "concise", files["good"], "--eds", encoder).stdout
    require("6000:00  Operating parameters" in said, said)
    said = command(program, "eds", "concise", files["bad"], expect=1).stdout
    require("entry 2 says 70000 bytes, 12 are left" in said, said)
    require(json.loads(command(program, "eds", "concise", files["bad"], "--json", expect=1).stdout)["problem"].startswith("entry 2"), "--json")
    command(program, "eds", "concise", scratch / "none.cdcf", expect=2)
