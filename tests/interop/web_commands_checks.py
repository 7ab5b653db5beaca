"""Checks of what the page can have done on the buses of a run, by its commands as a program sends them: scan, LSS, SDO, NMT, a boot tried
again, a module's errors; and of what a page sees of a run that has lost its bus."""
import base64
import json
import re
import shutil

from bus_checks import on_bus
from kit import (ANSWER, ROOT, attempts, check, command, first_plant_file, host_port, program, require, running, running_page, scratch,
                 silence, until)
from sdo_words_checks import GOOD, plant_of_words
from web_checks import PageClient

DEVICES = ROOT / "examples/devices"


@check
def web_scan_lss_and_sdo():
    """A scan from one node to another; devices without a node-ID are found and get one; an object is read, written and refused with its reason."""
    text = (ROOT / "examples/lss/plant.toml").read_text().replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{DEVICES}/')
    plant_file = scratch / "web-lss.toml"
    plant_file.write_text("\n".join(line for line in text.splitlines() if not line.startswith("store")) + "\n")
    with running(plant_file, has_plc=False, words=["--web"]) as plant:
        page = PageClient(plant)
        reply, rows = page.do(command="scan", nodes="1-5")
        require(rows == [] and "no node answers" in reply["message"], (reply, rows))
        reply, found = page.do(command="lss scan")
        require(reply["code"] == 0 and len(found) == 3 and all("node" not in row for row in found), (reply, found))
        require((found[0]["vendor"], found[0]["product"], found[0]["serial"]) == (0, 0x401, 0xA01), found)
        reply, named = page.do(command="lss assign", assign="10")
        require(reply["code"] == 0 and [row["node"] for row in named] == [10, 11, 12], (reply, named))
        require(page.do(command="lss scan")[1] == [], "a device has no node-ID")
        reply, rows = page.do(command="scan", nodes="11-20")
        require([row["node"] for row in rows] == [11, 12], rows)
        require(page.do(command="scan", nodes="12-11")[0]["code"] == 2, "12-11")
        require(page.do(command="sdo read", node="10", object="1018:02", type="u32")[1][0]["value"] == 1025, "1018:02")
        require(page.do(command="sdo read", node="10", object="1018:02")[1][0]["bytes"] == "01040000", "1018:02")
        reply, rows = page.do(command="sdo read", node="10", object="5000:02")
        require(reply["code"] == 1 and rows[0]["abort"] == "06020000", rows)
        require(page.do(command="sdo write", node="10", object="1017", type="u16", value="250")[0]["code"] == 0, "1017")
        require(page.do(command="sdo read", node="10", object="1017", type="u16")[1][0]["value"] == 250, "1017")
        reply, _ = page.do(command="sdo write", node="10", object="1017", value="100")
        require(reply["code"] == 2 and "type missing: use --type u16" in reply["message"], reply)
        looker = PageClient(plant, key=False)
        for words in ({"command": "scan"}, {"command": "lss scan"}, {"command": "sdo read", "node": "10", "object": "1017"}):
            require(looker.do(**words)[0]["code"] == 7, words)


def other_rate_file(name):
    plant_file = scratch / name
    text = (ROOT / "examples/lss/other-rate.toml").read_text()
    plant_file.write_text(text.replace("127.0.0.1:29536", "127.0.0.1:0").replace('"../devices/', f'"{ROOT}/examples/devices/'))
    return plant_file


@check
@attempts(3)
def lss_search_over_bit_rates():
    """The same by the command, by LSS address; who is not there, refusals, and the exit codes."""
    with running(other_rate_file("rates.toml"), has_plc=False) as plant:
        bus = f"--bus=socketcand:{plant.socketcand}"
        address = ["--vendor=0x71", "--product=0x406", "--revision=0x10000"]

        def search(code, *words):
            return command(program, "lss", "search", bus, f"--timeout={silence(150)}", *words, expect=code)

        done = search(2, "7")
        require("give --bit-rate, for example 125k" in done.stderr, done.stderr)
        done = search(1, "7", "--bit-rate=125k", *address, "--serial=0xB03")
        require(done.stderr == "canopus: vendor 00000071  product 00000406  revision 00010000  serial 00000B03: no answer at any bit rate of LSS\n", done.stderr)
        done = search(0, "7", "--bit-rate=125k", "--json", *address, "--serial=0xB02")
        require(json.loads(done.stdout) == {"vendor": 0x71, "product": 0x406, "revision": 0x10000, "serial": 0xB02, "node": 7, "bit_rate": 125000, "found_at": 500000}, done.stdout)
        done = command(program, "sdo", "read", bus, "7", "1018:04", "--timeout", ANSWER)
        require("00000B02H" in done.stdout, done.stdout)
        done = search(1, "8", "--bit-rate=125k")
        require(done.stderr == "canopus: no device without a node-ID answers at any bit rate of LSS\n", done.stderr)


@check
def web_lss_over_bit_rates():
    """A device that waits at another bit rate is found there, and has a node-ID at the bit rate of the network."""
    with running(other_rate_file("web-rates.toml"), has_plc=False, words=["--web"]) as plant:
        page = PageClient(plant)
        reply, _ = page.do(command="lss search", node="9", bit_rate="125k", vendor="0x71")
        require(reply["code"] == 2 and "four parts" in reply["message"], reply)
        reply, rows = page.do(command="lss search", node="9", bit_rate="125k")
        require(reply["code"] == 0 and rows == [{"vendor": 0x71, "product": 0x406, "revision": 0x10000, "serial": 0xB02, "node": 9, "bit_rate": 125000,
                                                 "found_at": 500000}], (reply, rows))


@check
def web_nmt_commands():
    """To all nodes of a bus, and to one; nothing for who only looks."""
    text = first_plant_file().read_text()
    plant_file = scratch / "web-nmt.toml"
    plant_file.write_text(text[:text.index("[[plc]]")])  # slaves that no master starts again
    with running(plant_file, has_plc=False, words=["--web"]) as plant:
        page = PageClient(plant)
        states = lambda e: [node["state"] for node in e["nodes"]]
        reply, _ = page.do(command="nmt stop", node="all")
        require(reply["code"] == 0 and reply["command"].startswith("canopus nmt stop "), reply)
        page.state(lambda e: states(e) == ["stopped"] * 3)
        require(page.do(command="nmt start", node="3")[0]["code"] == 0, "start")
        page.state(lambda e: sorted(states(e)) == ["operational", "stopped", "stopped"])
        require(page.do(command="nmt preop", node="all")[0]["code"] == 0, "preop")
        page.state(lambda e: states(e) == ["pre-operational"] * 3)
        require(PageClient(plant, key=False).do(command="nmt start", node="all")[0]["code"] == 7, "who only looks")


def plant_with_wrong_product(name, mandatory):
    text = first_plant_file().read_text().replace('"1016:01" =', '"1F86:04" = 0x1234, "1016:01" =', 1)
    require("1F86:04" in text, text)
    if not mandatory:
        text = text.replace("[[plc.module.slave]]", "[[plc.module.slave]]\nmandatory = false", 1)
    path = scratch / name
    path.write_text(text)
    return path


@check
def web_retry_of_one_slave():
    """An optional slave with another product code failed; with what is expected put right, a retry boots it."""
    with running(plant_with_wrong_product("retry-one.toml", mandatory=False), words=["--web"]) as plant:
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e.get("error") == "M")
        plant.wait_operational([2, 3])
        page = PageClient(plant)
        boots = page.view(boots=True)
        require([one["start_up"] for one in boots["masters"]] != ["halted"], boots["masters"])
        failed = len([step for slave in boots["slaves"] if slave["node"] == 4 for step in slave["steps"] if step["step"] == "failed"])
        reply, _ = page.do(command="boot retry", master="1", node="4")
        require(reply["command"].startswith("canopus nmt reset-comm --wait --timeout=5s --json --bus="), reply)
        attempts = lambda: [step for slave in page.view(boots=True)["slaves"] if slave["node"] == 4 for step in slave["steps"] if step["step"] == "failed"]
        until(lambda: len(attempts()) == failed + 1, "the boot was not tried again")
        require("product code" in attempts()[-1]["reason"], "the reason of the second attempt")
        on_bus(plant, "sdo", "write", "1", "1F86:04", "0x402", "--type", "u32")
        require(page.do(command="boot retry", master="1", node="4")[0]["code"] == 0, "retry")
        plant.wait_operational([4])
        require(PageClient(plant, key=False).do(command="boot retry", master="1", node="4")[0]["code"] == 7, "who only looks")


@check
def web_retry_of_a_halted_start_up():
    """A mandatory slave halted the start-up: the page gets that, and a retry of all boots all."""
    with running(plant_with_wrong_product("retry-all.toml", mandatory=True), words=["--web"]) as plant:
        plant.wait(lambda e: e["event"] == "boot slave" and e["node"] == 4 and e.get("error") == "M")
        page = PageClient(plant)
        require([one["start_up"] for one in page.view(boots=True)["masters"]] == ["halted"], "start-up")
        on_bus(plant, "sdo", "write", "1", "1F86:04", "0x402", "--type", "u32")
        on_bus(plant, "sdo", "write", "1", "1010:01", "0x65766173", "--type", "u32")  # the master is reset, too
        require(page.do(command="boot retry all", master="1", node="all")[0]["code"] == 0, "retry")
        plant.wait_operational([2, 3, 4])


@check
def web_values_and_errors_in_words():
    """A concise DCF and another domain by SDO and in a node's objects; the time of a flying master; a module's errors, cleared, and the module reset."""
    with running(plant_of_words(), operational=[1, 2, 3], words=["--web"]) as plant:
        command(program, "plc", "write", "U0\\G27", "200", "--plc", host_port(plant.mc)[1], expect=1)
        emergencies = scratch / "web-in-words.log"  # of nodes 3 and 4; the newest stands first
        emergencies.write_text("(0.0) line1 083#1030110000000000\n(0.1) line1 084#008281AB00000000\n")
        command(program, "replay", emergencies, "--bus", f"socketcand:{plant.socketcand}")
        page = PageClient(plant)
        reply, rows = page.do(command="sdo write", node="1", object="1F22:03", type="domain", value=GOOD.hex())
        require(reply["code"] == 0 and rows[0].get("transfer", {}).get("form") == "segmented" and rows[0]["transfer"]["bytes"] == 22, (reply, rows))
        words = page.do(command="sdo read", node="1", object="1F22:03")[1][0]["domain"]
        require(words["heading"] == "concise DCF, 22 bytes, 2 entries" and words["entries"][0]["value"] == "500 ms", words)
        named = page.do(command="domain words", bus="line1", object="1F22:03", bytes=GOOD.hex())[1][0]
        require(named["entries"][1] == {"object": "6000:00", "name": "Operating parameters", "value": "1"}, named)
        view = page.view(domain=0, object="1F22:03")
        require(view["size"] == 22 and [one["object"] for one in view["words"]["entries"]] == ["1017:00", "6000:00"], view)
        text = b"hello domain of a no"
        require(page.do(command="sdo write", node="5", object="2001", type="domain", value=text.hex())[0]["code"] == 0, "2001")
        words = page.do(command="sdo read", node="5", object="2001", type="domain")[1][0]["domain"]
        require(words["heading"] == "20 bytes" and words["dump"][0].endswith("|hello domain of |"), words)
        flying = page.view(objects=0, find="1f90", **{"from": 0, "count": 10})["rows"]
        row = next(one for one in flying if "words" in one)
        require(row["words"].startswith("negotiation: 500 ms + 2 x 100 ms + 1 x 10 ms = 710 ms after a reset") and "overlap" in row["warning"], row)
        groups = {group["title"]: group["lines"] for group in page.view(errors=0)["groups"]}
        present = [" ".join(str(value) for value in line.values()) for line in groups["errors now"]]
        require(any("G29 bit 6" in one and "buffer memory setting error" in one for one in present), present)
        require(any("G39" in one and "G27" in one for one in present), present)
        received = groups["emergencies received"]
        require([re.search(r"node (\d)", line["where"])[1] for line in received] == ["4", "3"], received)
        require([line["code"] for line in received] == ["8200H", "3010H"] and "error register 81H" in received[0]["meaning"], received)
        cleared = page.do(command="clear errors", number=0)[1][0]
        require(cleared["said"].startswith("errors cleared: Y0F ON until X0F is OFF"), cleared)
        restarted = page.do(command="reset module", number=0)[1][0]
        require(re.fullmatch(r"restarted in [\d.]+ s: Y02 ON until X02 is ON", restarted["said"]), restarted)


@check
def web_error_frames_and_arbitration():
    """What was wrong where, with the bits of the frame, the flags and the delimiter; who lost the arbitration to a frame; waiting frames."""
    text = first_plant_file().read_text()
    fault = '[[bus.fault]]\nkind = "corrupt"\nidentifier = 0x183\nbit = 30\nevery = 50\n\n'
    plant_file = scratch / "web-error-frames.toml"
    plant_file.write_text(text.replace("[[device]]", fault + "[[device]]", 1))
    with running(plant_file, operational=[1, 2, 3], words=["--web"]) as plant:
        page = PageClient(plant, key=False)
        page.watcher.say({"views": [{"traffic": 0, "can_id": 0x183}]})
        seen = page.watcher.event(lambda e: e["event"] == "traffic" and any("bits" in one for one in e["error_frames"]) and "lost" in e.get("frame", {}))
        frames = seen["error_frames"]
        require(1 <= len(frames) <= 8 and all(one["error"] in ("bit", "stuff") and one["bit"] == 30 for one in frames), frames)
        bits = next(one["bits"] for one in frames if "bits" in one)
        count = {part: len([bit for bit in bits if bit["part"] == part]) for part in ("frame", "error flag", "error delimiter")}
        require(count["frame"] == 31 and 6 <= count["error flag"] <= 12 and count["error delimiter"] == 8, count)
        fields = [bit["field"] for bit in seen["frame"]["bits"]]
        require(fields[0] == "SOF" and fields[-1] == "EOF" and len(fields) > 50, fields)
        require(all("waiting" in node for node in page.state()["nodes"]), "waiting frames")


@check
def web_bus_that_is_gone_is_not_shown_as_there():
    folder = scratch / "web-truth"
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder)
    command(program, "project", "add", folder, DEVICES / "encoder.eds", "--bit-rate", "250k")
    plant_file = scratch / "web-truth.toml"
    plant_file.write_text(f'[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\nproject = "{folder}/nodelist.cpj"\n')
    with running(plant_file, has_plc=False) as plant:
        with running_page(folder, "--bus", f"socketcand:{plant.socketcand}") as page:
            client = PageClient(page)
            require(client.state()["live"] and "gone" not in client.state()["buses"][0], "the bus is there")
            require(client.do(command="project write", yes=True)[0]["code"] == 8, "not armed")
            plant.process.kill()
            plant.process.wait()
            client.state(lambda e: e["buses"][0].get("gone"))
            reply, rows = client.do(command="project diff")
            require(reply["code"] == 1 and not rows, (reply, rows))


@check
def web_looking_asks_no_node():
    """Every view is looked at by who may do everything: nothing is on the bus but what was there before, heartbeats and PDOs."""
    folder = scratch / "web-looking"
    shutil.rmtree(folder, ignore_errors=True)
    command(program, "project", "new", folder)
    for name in ("encoder", "drive"):
        command(program, "project", "add", folder, DEVICES / f"{name}.eds", "--bit-rate", "250k")
        command(program, "project", "set", folder, "1" if name == "encoder" else "2", "1017=200")
    with running_page(folder) as page:
        client = PageClient(page)

        def frames(which):
            """How many there have been of these services."""
            row = client.trace(filter=which, fold=False, count=1)
            return row["end"] - row["first"]

        before = frames("service=error-control")
        for wish in ({"objects": 0, "find": "", "from": 0, "count": 256}, {"boots": True}, {"traffic": 0}, {"meaning": "1017:00"},
                     {"values": ["objects 0 1017:00"]}, {"domain": 0, "object": "1008:00"}):
            client.watcher.say({"views": [wish]})
            client.watcher.event(lambda e, kind=next(iter(wish)): e["event"] in (kind, "state"))
            require(client.state()["buses"], "state")
        client.do(command="project show")
        until(lambda: frames("service=error-control") > before + 10, "the trace has nothing to say")
        require(frames("service=sdo,nmt,lss,sync,time,mpdo") == 0, "looking has sent something")


@check
def web_words_frames_and_single_faults():
    """A word of the buffer memory is written and reaches the device; a list of frames is on the bus; one fault is ended and the other goes on."""
    with running(first_plant_file(), operational=[1, 2, 3], words=["--web"]) as plant:
        page, looker = PageClient(plant), PageClient(plant, key=False)
        offers = page.do(command="hello")[0]["offers"]
        require({"write word", "send frames", "stop frames", "open trace", "trace files", "close trace", "upload trace", "upload part", "end fault"} <= set(offers), offers)
        reply, rows = page.do(command="write word", number=0, address=13000, value=0x5A)
        require(reply["code"] == 0 and rows[0]["value"] == 0x5A, (reply, rows))
        require("5A" in command(program, "plc", "read", r"U0\G13000", "--plc", host_port(plant.mc)[1], "--format", "hex").stdout, "G13000")
        require(page.do(command="write word", number=0, address=27, value=200)[0]["message"].endswith("200 does not fit; expected 1 to 127"), "G27")
        reply, rows = page.do(command="send frames", bus="line1", frames=["300#0102", "18FF1234#"], interval="5ms")
        require(reply["code"] == 0 and rows[0]["frames"] == 2, (reply, rows))
        found = page.trace(filter="id=300,18FF1234", fold=False)
        require([row["id"] for row in found["rows"]] == ["300", "18FF1234"], found)
        there = page.trace(at=found["rows"][0]["t"], fold=False, count=9)
        require(any(row["n"] == there["at"] and row["id"] == "300" for row in there["rows"]), there)
        drop = lambda identifier: {"text": f'kind = "drop"\nidentifier = {identifier}\nreceiver = "ME3CAN1-Q U0"', "on": True}
        require(page.do(command="run faults", bus="line1", faults=[drop(0x182), drop(0x183)])[0]["code"] == 0, "faults")
        acting = lambda: page.do(command="faults")[1][0]["buses"][0]["faults"]
        until(lambda: acting()[1]["hits"] > 0, "183H is not lost")
        hits = acting()[1]["hits"]
        require(page.do(command="end fault", bus="line1", number=0)[0]["code"] == 0 and len(acting()) == 1 and acting()[0]["hits"] >= hits, acting())
        for words in ({"command": "write word", "number": 0, "address": 13000, "value": 1}, {"command": "send frames", "bus": "line1", "frames": ["300#"]},
                      {"command": "trace files"}, {"command": "open trace", "path": "x"}, {"command": "upload trace", "name": "x", "size": 1}, {"command": "upload part", "upload": 1, "data": ""}, {"command": "end fault", "bus": "line1", "number": 0}):
            require(looker.do(**words)[0]["code"] == 7, words)


@check
def web_real_bus_takes_words_and_frames_when_armed():
    """On a bus outside of the program a word and a frame are written once writing is armed, and not before."""
    with running(first_plant_file(), operational=[1, 2, 3]) as far:
        plant_file = scratch / "web-live.toml"
        plant_file.write_text(f'[[bus]]\nname = "line1"\nbit_rate = 250_000\nlink = "socketcand:{far.socketcand}/line1"\n'
                              '[[plc]]\nlisten = "off"\n[[plc.module]]\nmodel = "ME3CAN1-Q"\nhead = 0\nnode = 9\n')
        with running(plant_file, has_plc=False, words=["--web"], is_served=False) as plant:
            page = PageClient(plant)
            word = {"command": "write word", "number": 0, "address": 13000, "value": 5}
            frames = {"command": "send frames", "bus": "line1", "frames": ["300#0102"]}
            for words in (word, frames):
                reply, _ = page.do(**words)
                require(reply["code"] == 8 and "line1 is a live bus; arm writing first" in reply["message"], reply)
            require(page.do(command="arm", on=True)[0]["code"] == 0, "arm")
            for words in (word, frames):
                require(page.do(**words)[0]["code"] == 0, words)
            outside = lambda e: {node["node"]: node["state"] for node in e["outside"]}
            page.state(lambda e: outside(e).get(3) == "operational" and 9 not in outside(e))


@check
def web_recorded_traces_of_the_plants_folder():
    folder = scratch / "web-recorded"
    shutil.rmtree(folder, ignore_errors=True)
    (folder / "old").mkdir(parents=True)
    (folder / "old/run.log").write_text("(1700000000.5) can0 703#05\n(1700000001.4) can0 603#4017100000000000\n(1700000001.5) can0 583#8017100000000206\n")
    (folder / "secret.txt").write_text("none of a trace")
    plant_file = folder / "plant.toml"
    plant_file.write_text(first_plant_file().read_text())
    with running(plant_file, operational=[1], words=["--web"]) as plant:
        page = PageClient(plant)
        files = page.do(command="trace files")[1][0]
        require([one["path"] for one in files["files"]] == ["old/run.log"], files)
        require("there is no trace file" in page.do(command="open trace", path="../../etc/hostname")[0]["message"], "outside")
        opened = page.do(command="open trace", path="old/run.log")[1][0]
        require(opened["records"] == 3 and opened["begin"] == 1700000000.5, opened)
        rows = page.trace(file=opened["file"], filter="abort=06020000")["rows"]
        require(len(rows) == 1 and rows[0]["t"] == 1, rows)
        part = page.do(command="export trace", file=opened["file"], filter="", format="csv", part=0)[1][0]
        require(part["frames"] == 3 and part["done"], part)
        require(page.do(command="close trace", file=opened["file"])[0]["code"] == 0, "close")
        # One of the browser's machine: its name is no path.
        brought = b"(1.5) can0 703#05\n"
        number = page.do(command="upload trace", name="../old/run.log", size=len(brought))[1][0]["upload"]
        for piece in (brought[:7], brought[7:]):
            page.do(command="upload part", upload=number, data=base64.b64encode(piece).decode())
        brought_file = page.do(command="open trace", upload=number)[1][0]
        require(brought_file["path"] == "../old/run.log" and brought_file["records"] == 1, brought_file)
        require([one["path"] for one in page.do(command="trace files")[1][0]["files"]] == ["old/run.log"], "it is in no folder")
        require("open it again" in page.do(command="trace", file=opened["file"])[0]["message"], "closed")


@check
def web_plant_of_a_form_runs():
    """A new plant of module, bus and device file runs with its page; one that is wrong is not kept; a new project has its devices."""
    folder = scratch / "web form"
    shutil.rmtree(folder, ignore_errors=True)
    folder.mkdir()
    device = lambda name: {"file": {"name": f"{name}.eds", "text": (DEVICES / f"{name}.eds").read_text()}, "name": name}
    with running_page(cwd=folder) as page:
        client = PageClient(page)
        reply, rows = client.do(command="new plant", name="press", model="FX3U-CAN", bit_rate="125k", devices=[device("encoder"), device("drive")])
        require(reply["code"] == 0 and "url" in rows[0], reply)
        (plant,) = client.do(command="plants")[1][0]["plants"]
        require((plant["path"], plant["name"]) == ("press/plant.toml", "press"), plant)
        require(plant["buses"] == [{"bus": "line1", "bit_rate": 125000, "live": False, "modules": ["FX3U-CAN"], "devices": ["encoder", "drive"]}], plant)
        done = command(program, "run", folder / "press/plant.toml", "--virtual", "--for", "15s", "--quiet", "--expect-operational")
        require(done.returncode == 0, done.stderr)
        reply, _ = client.do(command="new plant", name="bad", model="FX3U-CAN", devices=[{"file": {"name": "x.eds", "text": "nothing"}}])
        require(reply["code"] == 5 and "x.eds" in reply["message"] and not (folder / "bad").exists(), reply)
        reply, rows = client.do(command="new project", name="line", bit_rate="500k", devices=[device("encoder")])
        require(reply["code"] == 0 and "url" in rows[0], reply)
        require("500 kbit/s" in command(program, "project", "show", folder / "line").stdout, "the bit rate of the project")
