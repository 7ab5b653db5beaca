"""`canopus trace` against tshark, field by field: foreign recordings and those of our own example plants."""
import json
import shutil

from kit import ROOT, Skip, check, command, program, require, scratch

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
    identifier = int(theirs["can.id"])
    if theirs["can.flags.err"] in ("1", "True"):
        return None if frame["service"] == "error-frame" else "error frame"
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
        trace = scratch / f"{example.parent.name}.pcap"
        command(program, "run", example, "--virtual", "--for", "10s", "--trace", trace, "--quiet")
        agree(trace)
        agree(trace, "--plant", example)
