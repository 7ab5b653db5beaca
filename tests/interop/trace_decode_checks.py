"""`canopus trace` against tshark, field by field: foreign recordings and those of our own example plants."""
import json
import shutil
import xml.etree.ElementTree as ET

from kit import HERE, ROOT, Skip, check, command, first_plant, first_plant_file, node_modules, program, require, scratch

TRACES = ROOT.parent / "shared" / "data" / "traces"

FIELDS = ["can.id", "can.flags.rtr", "can.flags.xtd", "can.flags.err", "canopen.node_id", "canopen.sdo.cmd", "canopen.sdo.main_idx",
          "canopen.sdo.sub_idx", "canopen.sdo.data.bytes", "canopen.sdo.abort_code", "canopen.pdo.data.bytes",
          "canopen.em.err_code", "canopen.em.err_field", "canopen.nmt_ctrl.cd", "canopen.nmt_ctrl.node_id",
          "canopen.nmt_guard.state", "canopen.nmt_guard.toggle", "canopen.sync.counter", "canopen.time_stamp_ms",
          "canopen.lss.cs", "_ws.malformed", "_ws.col.Info"]

# What tshark 4.0 does otherwise, and why that is no mistake of ours. Each counts how often it happened.
KNOWN = {
    "segment": "tshark decodes each frame alone: it reads the segments of a block transfer as commands, without their object",
    "function code 0": "tshark takes every identifier 001H to 07FH for NMT: 001H is CiA 304's, 071H to 076H are CiA 302-2's",
    "unused bytes": "tshark shows bytes 4 to 7 or 1 to 7 of an SDO; we show those of them that are data, and a size is no data",
    "learnt": "a COB-ID from a device file, or written in the trace itself, says whose PDO it is; tshark knows the default ones",
    "reserved": "identifiers 6E0H, 680H to 6FFH and 780H to 7FFH belong to no service: tshark names a node, we do not",
    "remote": "tshark does not say of a remote frame which service it asks for",
    "error frame": "a class of errors is no identifier, and CANopen has none",
    "malformed": "tshark gives up in a frame that is too short; we say what was expected",
}


def tshark(path, known=()):
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    words = ["tshark", "-r", path, "-d", "can.subdissector,canopen", "-T", "fields", "-E", "separator=|", "-E", "occurrence=f", *known]
    for field in FIELDS:
        words += ["-e", field]
    lines = command(*words).stdout.splitlines()
    return [dict(zip(FIELDS, line.split("|"))) for line in lines if "|" in line]


def ours(path, *words):
    lines = command(program, "trace", "show", path, "--frames", "--json", *words).stdout.splitlines()
    return [json.loads(line) for line in lines]


def number(text):
    return int(text, 0) if text else None


def compare_sdo(theirs, frame, count):
    """Command byte, object, data and abort code."""
    if "segment" in frame["kind"] and frame["kind"].startswith("block"):
        count("segment")
        return None
    index, sub = number(theirs["canopen.sdo.main_idx"]), number(theirs["canopen.sdo.sub_idx"])
    if index is not None and (int(frame["index"], 16), frame["sub"]) != (index, sub):
        return f"object {index:04X}:{sub}"
    code = number(theirs["canopen.sdo.abort_code"])
    if (int(frame["abort"], 16) if "abort" in frame else None) != code:
        return f"abort code {code}"
    data, mine = theirs["canopen.sdo.data.bytes"].upper(), frame.get("data", "")
    if data == mine or code is not None:
        return None
    first = number(theirs["canopen.sdo.cmd"])
    if first is None:
        return None if not mine else "data"
    kind = frame["kind"]
    if kind in ("download request", "upload response"):
        wanted = data[:2 * (4 - (first >> 2 & 3 if first & 1 else 0))] if first & 2 else ""
    elif kind in ("download segment", "upload segment"):
        wanted = data[:2 * (7 - (first >> 1 & 7))]
    else:
        wanted = ""
    if mine != wanted:
        return f"data {data}, of it {wanted}"
    count("unused bytes")
    return None


def compare(theirs, frame, count):
    """None, or in which field the two differ."""
    if theirs["can.flags.err"] in ("1", "True"):
        count("error frame")
        return None if frame["service"] == "error-frame" else "error frame"
    identifier = int(theirs["can.id"])
    if int(frame["id"], 16) != identifier:
        return "identifier"
    if theirs["can.flags.rtr"] in ("1", "True"):
        count("remote")
        return None if frame.get("remote") else "remote frame"
    if theirs["_ws.malformed"]:
        count("malformed")
        return None if frame["kind"] == "malformed" else "malformed"
    service = frame["service"]
    if 0 < identifier < 0x80:
        count("function code 0")
        return None if service in ("failsafe", "flying-master", "layer2") else "function code 0"
    node = number(theirs["canopen.node_id"])
    if theirs["canopen.nmt_ctrl.cd"]:
        data = f"{number(theirs['canopen.nmt_ctrl.cd']):02X}{number(theirs['canopen.nmt_ctrl.node_id']):02X}"
        return None if (service, frame["data"]) == ("nmt", data) else "NMT command"
    if theirs["canopen.nmt_guard.state"]:
        state = number(theirs["canopen.nmt_guard.state"])
        same = service == "error-control" and int(frame["data"], 16) & 0x7F == state and frame["node"] == node
        return None if same else "error control"
    if theirs["canopen.em.err_code"]:
        same = service == "emcy" and int(frame["emcy"], 16) == number(theirs["canopen.em.err_code"]) and frame["node"] == node
        return None if same and frame["data"][6:] == theirs["canopen.em.err_field"].upper() else "EMCY"
    if theirs["canopen.lss.cs"]:
        same = service == "lss" and int(frame["data"][:2], 16) == number(theirs["canopen.lss.cs"])
        return None if same else "LSS"
    if theirs["canopen.time_stamp_ms"]:
        return None if service == "time" else "TIME"
    if theirs["canopen.sdo.cmd"] or theirs["_ws.col.Info"].startswith("Default-SDO"):
        if (service, frame.get("node")) != ("sdo", node):
            return "SDO"
        return compare_sdo(theirs, frame, count)
    if theirs["_ws.col.Info"].startswith("PDO"):
        if service not in ("pdo", "mpdo") or service == "pdo" and frame["data"] != theirs["canopen.pdo.data.bytes"].upper():
            return "PDO"
        if frame.get("node") != node:
            count("learnt")
        return None
    if service == "sync":
        return None if theirs["_ws.col.Info"].startswith("SYNC") else "SYNC"
    count("reserved")
    return None if service == "layer2" else "service"


def agree(path, *words):
    """Every frame of the file; returns how many, and prints what tshark does otherwise."""
    theirs, mine = tshark(path), ours(path, *words)
    require(len(theirs) == len(mine), f"{path}: tshark has {len(theirs)} frames, we {len(mine)}")
    known, wrong = dict.fromkeys(KNOWN, 0), []
    def count(reason):
        known[reason] += 1
    for at, (one, other) in enumerate(zip(theirs, mine), 1):
        difference = compare(one, other, count)
        if difference:
            wrong.append(f"frame {at}: {difference}\n  tshark {({k: v for k, v in one.items() if v})}\n  canopus {other}")
    print(f"    {path.name}: {len(mine)} frames agree" + "".join(f", {n} {reason}" for reason, n in known.items() if n))
    require(not wrong, f"{path}: {len(wrong)} of {len(mine)} frames differ\n" + "\n".join(wrong[:5]))
    return len(mine)


@check
def tshark_agrees_with_our_decoder_on_foreign_traces():
    if not TRACES.is_dir():
        raise Skip(f"{TRACES} is absent")
    frames = sum(agree(path) for path in sorted(TRACES.glob("*.pcapng")))
    require(frames > 20000, f"only {frames} frames were compared")


@check
def tshark_agrees_with_our_decoder_on_block_transfers():
    """The text of a tutorial: its frames are read by us, and by tshark after we wrote them as a pcap."""
    path = TRACES / "canopennode_two-sdo-block-transfers.candump.txt"
    if not path.is_file():
        raise Skip(f"{path} is absent")
    lines = [line.split("  ") for line in path.read_text().splitlines() if "]" in line]
    log = scratch / "block.log"
    log.write_text("".join(f"({at}.000000) can0 {frame[0]}#{''.join(frame[2:])}\n" for at, frame in enumerate(frames_of(path))))
    require(len(lines) > 80, "the tutorial has lost its frames")
    agree(log)
    folded = [json.loads(line) for line in command(program, "trace", "show", log, "--json").stdout.splitlines()]
    require(len(folded) == 2, f"two transfers are {len(folded)} lines: {folded}")
    for transfer in folded:
        require(transfer["end"] in ("done", "unfinished"), str(transfer))


def frames_of(path):
    """(identifier, length, byte, ...) of the frames in the screen form of candump, with remarks behind them."""
    for line in path.read_text().splitlines():
        if "[" not in line:
            continue
        words = line.replace("'", " ").split()
        at = next(i for i, word in enumerate(words) if word.startswith("["))
        length = int(words[at].strip("[]"))
        yield [words[at - 1], words[at], *words[at + 1:at + 1 + length]]


@check
def tshark_agrees_with_our_decoder_on_our_plants():
    for example in sorted((ROOT / "examples").glob("*/plant.toml")):
        if ".so\"]" in example.read_text():
            continue  # native code, which has to be compiled
        trace = scratch / f"{example.parent.name}.pcap"
        command(program, "run", example, "--virtual", "--for", "10s", "--trace", trace, "--quiet")
        agree(trace)
        agree(trace, "--plant", example)


# --- what is written for other programs


def recorded(example):
    trace = scratch / f"export-{example}.pcap"
    plant = ROOT / "examples" / example / "plant.toml"
    command(program, "run", plant, "--virtual", "--for", "10s", "--trace", trace, "--quiet")
    return plant, trace


@check
def npm_candied_decodes_our_pdos_by_the_dbc_file():
    node_modules()
    decoded = 0
    for example in ("first-plant", "rj71cn91"):
        plant, trace = recorded(example)
        dbc = scratch / f"{example}.dbc"
        dbc.write_text(command(program, "trace", "export", "--dbc", "--plant", plant).stdout)
        frames = [frame for frame in ours(trace, "--plant", plant, "--service", "pdo") if "signals" in frame]
        lines = "".join(f"{frame['id']} {frame['data']}\n" for frame in frames)
        theirs = command("node", HERE / "dbc_reader.mjs", dbc, input=lines).stdout.splitlines()
        require(len(theirs) == len(frames), f"{len(theirs)} answers for {len(frames)} frames")
        for frame, line in zip(frames, theirs):
            message = json.loads(line)
            require(message is not None, f"no message for {frame}")
            values = [value for _, value, _ in message["signals"]]
            require(values == [signal["value"] for signal in frame["signals"]], f"{frame}\n{message}")
            decoded += 1
            if message["name"] == "encoder_TPDO1":
                require(message["signals"][0][2] == "Position_value" and 0 <= values[0] <= 4095, str(message))
    print(f"    {decoded} PDOs decoded")
    require(decoded > 1500, f"only {decoded} PDOs were decoded")


HOSTILE = '"] = os.execute("touch /tmp/x")\\u001b[2J</text>&'


def hostile_plant():
    """The first plant with a device whose name is made to break out of every file it is written into."""
    text = (ROOT / "examples/first-plant/plant.toml").read_text().replace('"../devices/', f'"{ROOT}/examples/devices/')
    path = scratch / "hostile.toml"
    path.write_text(text.replace('name = "encoder"', f"name = {json.dumps(HOSTILE)}".replace("\\\\u", "\\u")))
    return path


@check
def tshark_shows_the_plants_names_by_our_lua_script():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    plant, trace = recorded("first-plant")
    script = scratch / "plant.lua"
    script.write_text(command(program, "trace", "export", "--lua", "--plant", plant).stdout)
    words = ["tshark", "-r", trace, "-X", f"lua_script:{script}", "-d", "can.subdissector,canopen", "-T", "fields", "-E", "separator=|"]
    for field in ("can.id", "canopus.node", "canopus.name", "canopus.pdo", "canopus.object", "canopus.signal.n3_position_value"):
        words += ["-e", field]
    done = command(*words)
    require("lua" not in done.stderr.lower(), done.stderr)
    rows = [line.split("|") for line in done.stdout.splitlines()]
    mine = ours(trace, "--plant", plant)
    require(len(rows) == len(mine), f"{len(rows)} rows for {len(mine)} frames")
    for row, frame in zip(rows, mine):
        if frame["service"] == "nmt":
            continue
        require(row[2] == frame["name"], f"name: {row} {frame}")
        require(row[4] == (frame["object"] if frame["service"] == "sdo" else ""), f"object: {row} {frame}")
        if frame["service"] == "pdo":
            require(row[3] == f"{frame['kind']}{frame['pdo']}", f"PDO: {row} {frame}")
        if frame["id"] == "183":
            require(float(row[5]) == frame["signals"][0]["value"], f"value: {row} {frame}")


@check
def hostile_names_stay_names_in_lua_svg_and_text():
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    plant = hostile_plant()
    trace, script, picture = scratch / "hostile.pcap", scratch / "hostile.lua", scratch / "hostile.svg"
    command(program, "run", plant, "--virtual", "--for", "3s", "--trace", trace, "--quiet")
    script.write_text(command(program, "trace", "export", "--lua", "--plant", plant).stdout)
    done = command("tshark", "-r", trace, "-X", f"lua_script:{script}", "-Y", "can.id == 0x183", "-T", "fields", "-e", "canopus.name")
    require("lua" not in done.stderr.lower(), done.stderr)
    require('"] = os.execute("touch /tmp/x")?[2J</text>&' in done.stdout, done.stdout[:500])
    command(program, "trace", "plot", trace, "--plant", plant, "--output", picture)
    texts = [element.text for element in ET.parse(picture).getroot().iter("{http://www.w3.org/2000/svg}text")]
    require(any('os.execute("touch /tmp/x")?[2J</text>&' in text for text in texts), str(texts))
    for words in (["show"], ["show", "--json"], ["stats"], ["stats", "--json"]):
        require("\x1b" not in command(program, "trace", *words, trace, "--plant", plant).stdout, f"{words} lets an escape through")


# --- live


@check
def monitor_shows_and_records_what_is_on_a_bus():
    with first_plant() as plant:
        recording = scratch / "monitor.pcap"
        done = command(program, "monitor", "--bus", f"socketcand:{plant.socketcand}", "--plant", first_plant_file(), "--for", "3s",
                       "--json", "--frames", "--trace", recording)
        shown = [json.loads(line) for line in done.stdout.splitlines()]
        require(len(shown) > 100, f"only {len(shown)} frames")
        beats = {frame["name"] for frame in shown if frame["kind"] == "heartbeat"}
        require(beats == {"ME3CAN1-Q U0", "io-block", "encoder", "drive"}, str(beats))
        require(len(ours(recording)) == len(shown), "the recording has another number of frames")
        agree(recording)
    command(program, "monitor", "--bus", "nonsense", expect=2)
    command(program, "monitor", "--bus", "socketcand:127.0.0.1:1", expect=1)


@check
def who_reads_no_more_ends_show():
    plant, trace = recorded("first-plant")
    shell = f"set -o pipefail; {program} trace show {trace} --plant {plant} | head -2"
    done = command("bash", "-c", f"{{ {shell}; }} || true")
    require(len(done.stdout.splitlines()) == 2, done.stdout)
    whole = command(program, "trace", "show", trace).stdout
    again = command("bash", "-c", f"cat {trace} | {program} trace show -").stdout
    require(again == whole, "the standard input shows another thing than the file")
