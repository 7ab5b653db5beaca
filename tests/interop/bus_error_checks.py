"""Errors of a simulated bus as SocketCAN error frames, judged by tshark, can-utils and python-can; its waveform by sigrok-cli and GTKWave."""
import json
import re
import shutil
import subprocess

import two_rates
from kit import HERE, PYTHON, Skip, check, command, program, require, scratch

DEVICE = HERE / "interop_device.eds"
# How often each kind comes, by the bit that a fault inverts for everybody in 703#7F at 500 kbit/s; a run of 2 s has 100 of them.
STUFF_CODE, FORM_CODE, BIT_CODE = 0x04, 0x02, 0x01


def plant(fault):
    text = '[plant]\nname = "errors"\n[[bus]]\nname = "line1"\nbit_rate = 500_000\n' + fault
    for node in (3, 4):
        text += f'[[device]]\nnode = {node}\nname = "n{node}"\neds = "{DEVICE}"\nobjects = {{ "1017:00" = 20 }}\n'
    path = scratch / "errors.toml"
    path.write_text(text)
    return path


def run(path, *words):
    return command(program, "run", path, "--virtual", "--for", "2s", *words).stdout


@check
def tshark_and_can_utils_read_the_error_frames_of_a_run():
    """Each `bus error` that begins an error frame is one SocketCAN error frame, decoded by others as what the events say."""
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    for fault, kind, location in (('kind = "corrupt"\nbit = 30\nevery = 4\ncount = 25', "bit", "8"),
                                  ('kind = "corrupt"\nbit = 1\nreceiver = "n4"\nsender = "n3"\nevery = 3\ncount = 25', None, None),
                                  ('kind = "drive"\nfield = "CRC delimiter"\nbits = "0"\nevery = 3\ncount = 25', None, "24"),
                                  ('kind = "drive"\nfield = "ACK slot"\nbits = "R"\nevery = 3\ncount = 25', None, "25")):
        path = plant("[[bus.fault]]\n" + fault + "\n")
        counts = {}
        for suffix in ("pcap", "pcapng", "log"):
            trace = scratch / f"errors.{suffix}"
            events = [json.loads(line) for line in run(path, "--json", "--trace", trace).splitlines()]
            summary = next(e for e in events if e["event"] == "summary")
            error_frames = summary["buses"][0]["error_frames"]
            require(error_frames >= 20, f"{fault}: {error_frames} error frames")
            if suffix == "log":
                words = [line.split()[2] for line in trace.read_text().splitlines()]
                counts[suffix] = sum(word.startswith(("20000288#", "200002A8#")) for word in words)
                decoded = subprocess.run(["log2long"], input=trace.read_text(), capture_output=True, text=True)
                if shutil.which("log2long"):
                    require(decoded.stdout.count("ERRORFRAME") >= counts[suffix], decoded.stdout[:500])
                continue
            fields = ["can.err.prot", "can.err.buserror", "can.err.prot.location", "can.err.prot.type.tx"]
            shown = command("tshark", "-r", trace, "-Y", "can.flags.err == 1", "-T", "fields", "-E", "separator=;",
                            *[word for field in fields for word in ("-e", field)]).stdout.splitlines()
            protocol = [line.split(";") for line in shown if line.split(";")[0] in ("1", "True")]
            counts[suffix] = len(protocol)
            if location is not None:
                require(all(int(line[2], 0) == int(location) for line in protocol), f"{fault}: {[line for line in protocol if line[2] != location][:3]}")
            if kind == "bit":
                require(all(line[3] in ("1", "True") for line in protocol), f"{fault}: the sender's view is missing: {protocol[:3]}")
        require(set(counts.values()) == {error_frames}, f"{fault}: {counts}, the bus counted {error_frames}")


@check
def python_can_reads_the_error_frames_of_a_run():
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python-can is not installed")
    trace = scratch / "errors.log"
    run(plant('[[bus.fault]]\nkind = "corrupt"\nbit = 30\nevery = 4\ncount = 25\n'), "--quiet", "--trace", trace)
    script = ("import can, sys\n"
              "messages = list(can.CanutilsLogReader(sys.argv[1]))\n"
              "print(sum(m.is_error_frame for m in messages), len(messages))\n"
              "from can.interfaces.socketcand.socketcand import convert_ascii_message_to_can_message as convert\n"
              "m = convert('< error 288 12.000345 >')\n"
              "print(m is None or (m.is_error_frame, m.arbitration_id == 0x288, m.timestamp))\n")
    errors, parsed = command(PYTHON, "-c", script, trace).stdout.splitlines()
    # Its reader takes those of the class "bus error" alone for error frames.
    expected = sum(" 20000288#" in line or " 200002A8#" in line for line in trace.read_text().splitlines())
    require(int(errors.split()[0]) == expected > 0, f"{errors}: the trace has {expected}")
    if parsed == "True":
        print("    this python-can knows no error frames of socketcand: only its reader of traces is asked")
    else:
        require(parsed == "(True, True, 12.000345)", parsed)


@check
def a_plant_without_errors_records_none():
    trace = scratch / "good.log"
    text = run(plant(""), "--json", "--trace", trace)
    require("bus error" not in text and '"controller"' not in text, text[:500])
    require(" 2000" not in trace.read_text(), "an error frame in a run without errors")


@check
def a_node_that_is_alone_does_not_flood_the_events():
    """It finds one and the same error thousands of times: the events say it until nothing changes any more."""
    path = plant("")
    path.write_text(path.read_text().replace("node = 4", 'node = 4\nstart = "1900ms"'))
    events = [json.loads(line) for line in run(path, "--json").splitlines()]
    alone = [e for e in events if e["event"] == "bus error" and e["t"] < 1.8]
    summary = next(e for e in events if e["event"] == "summary")
    require(summary["buses"][0]["error_frames"] > 1000, f"{summary['buses']}")
    require(len(alone) == 16 and all(e["error"] == "acknowledgement" for e in alone), f"{len(alone)} events: {alone[-3:]}")
    require([e["nodes"][0]["tec"] for e in alone[:3]] == [8, 16, 24] and alone[-1]["nodes"][0]["tec"] == 128, alone[-1])


@check
def sigrok_reads_the_waveform_beside_counters_and_fields():
    """The values of a waveform (TEC, REC, field) do not keep sigrok-cli from its wires."""
    if not shutil.which("sigrok-cli"):
        raise Skip("sigrok-cli is not installed")
    wave = scratch / "wave.vcd"
    run(plant('[[bus.fault]]\nkind = "drive"\nfield = "CRC delimiter"\nbits = "0"\ncount = 1\n'), "--quiet", "--vcd", wave)
    done = command("sigrok-cli", "-i", wave, "-I", "vcd:downsample=25", "-P", "can:can_rx=can:nominal_bitrate=500000:sample_point=75", "-A",
                   "can=id:warnings")
    lines = done.stdout.splitlines()
    require(sum("Identifier: 1795" in line or "Identifier: 1796" in line for line in lines) > 150, done.stdout[:400])
    require(any("CRC delimiter must be a recessive bit" in line for line in lines), "the error is not seen")
    text = wave.read_text()
    require("$var real 64" in text and "n3_tec" in text and "\nr8 " in text, "no counters in the waveform")
    codes = {words[4]: words[3] for words in map(str.split, text.splitlines()) if words[:2] == ["$var", "real"]}
    changes = {name: re.findall(rf"^r(-?\d+) {re.escape(code)}$", text, re.MULTILINE) for name, code in codes.items()}
    require(len(changes["field"]) > 1000 and "-1" not in changes["field"], "the bus has no field")
    require(changes["n3_field"][0] == "-1" and len(changes["n3_field"]) < 100, f"{changes['n3_field'][:20]}")


def changes(vcd):
    """What comes to which signal when: [(time, {name: number})], where something changes."""
    names, values, moments, time = {}, {}, [], 0
    for line in vcd.read_text().splitlines():
        words = line.split()
        if line.startswith("$var"):
            names[words[3]] = words[4]
        elif line.startswith("#"):
            time = int(line[1:])
        elif line[:1] in ("0", "1", "r"):
            code, value = (words[1], float(words[0][1:])) if line[0] == "r" else (words[0][1:], float(line[0]))
            if values.get(names[code]) != value:
                values[names[code]] = value
                if not moments or moments[-1][0] != time:
                    moments.append((time, {}))
                moments[-1][1][names[code]] = value
    return moments


@check
def gtkwave_reads_every_change_of_the_waveform():
    """Read by GTKWave's vcd2fst and written again by its fst2vcd, a waveform with errors says the same."""
    if not shutil.which("vcd2fst"):
        raise Skip("gtkwave is not installed")
    wave, again = scratch / "gtkwave.vcd", scratch / "gtkwave-again.vcd"
    run(plant('[[bus.fault]]\nkind = "corrupt"\nreceiver = "n4"\nsender = "n3"\nevery = 3\nbit = 30\n'), "--quiet", "--vcd", wave)
    command("vcd2fst", wave, scratch / "gtkwave.fst")
    command("fst2vcd", scratch / "gtkwave.fst", "-o", again)
    ours, theirs = changes(wave), changes(again)
    require(len(ours) > 10_000 and {"field", "n3_field", "n4_rec", "can"} <= ours[0][1].keys(), f"{len(ours)} moments, {ours[0]}")
    for one, other in zip(ours, theirs, strict=True):
        require(one == other, f"{one}, GTKWave has {other}")


def new_errors(errors):
    """Without those that repeat the last one in everything but the moment."""
    kept = []
    for error in errors:
        if not kept or kept[-1][1:] != error[1:]:
            kept.append(error)
    return kept


@check
def who_is_bus_off_first_with_two_bit_rates_is_what_the_standard_predicts():
    """Errors, counters and bus-off of two devices with different bit rates, moment for moment (ME3-BAUD-006)."""
    wanted = {}
    for rate, other in ((250_000, 125_000), (125_000, 250_000), (500_000, 250_000), (1_000_000, 125_000), (125_000, 1_000_000), (500_000, 800_000),
                        (50_000, 125_000)):
        path = scratch / "rates.toml"
        text = f'[plant]\nname = "rates"\n[[bus]]\nname = "line1"\nbit_rate = {rate}\n'
        for node, own in ((3, ""), (4, f"bit_rate = {other}\n")):
            text += f'[[device]]\nnode = {node}\nname = "n{node}"\neds = "{DEVICE}"\n{own}'
        path.write_text(text)
        # As many bits that recovery from bus-off, 128 times 11, has not ended.
        until = 1_000_000_000 // max(rate, other) * 2_800
        events = [json.loads(line) for line in command(program, "run", path, "--virtual", "--for", f"{until}ns", "--json").stdout.splitlines()]
        seen = [(round(event["t"] * 1e6), node["name"], event["error"], node["tec"], node["rec"])
                for event in events if event["event"] == "bus error" for node in event["nodes"]]
        nodes = two_rates.Node("n3", rate), two_rates.Node("n4", other, joins=True)
        predicted = [(moment // 1000, *rest) for moment, *rest in
                     two_rates.predict(nodes, [(0, nodes[0], 0x703, [0]), (0, nodes[1], 0x704, [0])], until)]
        seen, predicted = new_errors(seen), new_errors(predicted)
        for one, two in zip(seen, predicted):
            require(abs(one[0] - two[0]) <= 1 and one[1:] == two[1:], f"{rate} and {other} bit/s: {one}, predicted {two}")
        require(len(seen) == len(predicted) > 1, f"{rate} and {other} bit/s: {len(seen)} errors, predicted {len(predicted)}")
        off = [event["name"] for event in events if event["event"] == "controller" and event["state"] == "bus-off"]
        require(off == [node.name for node in nodes if node.off], f"{rate} and {other} bit/s: bus-off {off}")
        wanted[rate, other] = off
    require(any(wanted.values()), f"nobody is bus-off: {wanted}")
