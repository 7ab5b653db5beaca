#!/usr/bin/env python3
"""Runs the program for real and lets programs we did not write judge it. Writes JUnit XML.

usage: interop.py --program build/canopus --results build/results/interop.xml [--only NAME] [--tier TIER] [--list] [--keep] [--jobs N]

A check that needs something absent (a package, ../shared) is skipped with the reason. Ports are always chosen by the
system; the program says which in its `listen` events. Checks run side by side (runner.py, schedule.py): each has a process and a
scratch folder of its own.
"""
import json
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import tempfile
import time

import as_fcopm_checks  # noqa: F401  (registers its checks)
import as_fcopm_example_checks  # noqa: F401
import as_fcopm_network_checks  # noqa: F401
import bus_checks  # noqa: F401
import campaign_checks  # noqa: F401
import configure_checks  # noqa: F401
import configure_rj71cn91_checks  # noqa: F401
import bus_error_checks  # noqa: F401
import docs_checks  # noqa: F401
import endless_peer_checks  # noqa: F401
import foreign_stack_checks  # noqa: F401
import fx2n_32can_checks  # noqa: F401
import fx3u_can_checks  # noqa: F401
import gateway_checks  # noqa: F401
import gateway_service_checks  # noqa: F401
import language_checks  # noqa: F401
import lift_checks  # noqa: F401
import link_checks  # noqa: F401
import many_clients_checks  # noqa: F401
import module_checks  # noqa: F401
import new_plant_checks  # noqa: F401
import output_checks  # noqa: F401
import output_end_checks  # noqa: F401
import page_checks  # noqa: F401
import plc_checks  # noqa: F401
import port_checks  # noqa: F401
import project_checks  # noqa: F401
import project_corpus_checks  # noqa: F401
import project_file_checks  # noqa: F401
import real_time_checks  # noqa: F401
import reference_checks  # noqa: F401
import schedule
import schema_checks  # noqa: F401
import screen_checks  # noqa: F401
import sdo_answer_checks  # noqa: F401
import sdo_words_checks  # noqa: F401
import step_checks  # noqa: F401
import trace_checks  # noqa: F401
import trace_decode_checks  # noqa: F401
import trace_witness_checks  # noqa: F401
import transport_checks  # noqa: F401
import web_checks  # noqa: F401
import web_commands_checks  # noqa: F401
import web_log_in_checks  # noqa: F401
import web_hostile_checks  # noqa: F401
import web_pace_checks  # noqa: F401
import web_settings_checks  # noqa: F401
import web_project_checks  # noqa: F401
import web_transfer_checks  # noqa: F401
import xdd_checks  # noqa: F401
from kit import (DEVICE_FILES, HERE, PATIENCE, PYTHON, ROOT, Skip, args, check, checks, command, covers, first_plant, first_plant_file,
                 host_port, node_modules, program, require, running, scratch, until)
from runner import Runner, junit, line_of


# --- the program itself


@check
def plant_stops_cleanly_on_interrupt():
    with first_plant() as plant:
        code, errors = plant.stop(signal.SIGINT)
        require(code == 0, f"exit code {code}, expected 0")
        require(errors == "", f"printed on stderr: {errors}")


@check
def plant_runs_for_the_time_asked():
    done = command(program, "run", ROOT / "examples/first-plant/plant.toml", "--virtual", "--for", "15s")
    require("all 4 nodes operational" in done.stdout, done.stdout[-2000:])


@check
def one_seed_gives_one_trace():
    traces = []
    for number in range(2):
        path = scratch / f"trace-{number}.log"
        command(program, "run", first_plant_file(), "--virtual", "--for", "5s", "--seed", "42", "--trace", path, "--quiet")
        traces.append(path.read_bytes())
    require(traces[0] == traces[1], "two runs with one seed recorded different frames")
    require(traces[0].count(b"\n") > 500, "the trace is almost empty")


@check
def a_wrong_plant_file_starts_nothing():
    path = scratch / "wrong.toml"
    path.write_text('[[bus]]\nname = "a"\nbit_rate = 250000\n[[device]]\nnode = 200\neds = "missing.eds"\n')
    for words in (["check", path], ["run", path]):
        done = command(program, *words, expect=2)
        require(f"{path}:5:8: node = 200: a node-ID is 1 to 127" in done.stderr, done.stderr)
    path.write_text('[[bus]]\nname = "a"\nbit_rate = 250000\n[[device]]\nnode = 20\neds = "missing.eds"\n')
    done = command(program, "check", path, expect=2)
    require(f"{path}:6:7: eds = \"missing.eds\": cannot read" in done.stderr, done.stderr)


@check
def help_and_version_are_where_a_user_looks():
    version = (ROOT / "VERSION").read_text().strip()
    require(command(program, "--version").stdout.strip() == f"canopus {version}", "wrong --version")
    for words in (["--help"], ["run", "--help"], ["check", "--help"], ["plc", "--help"], ["eds", "check", "--help"]):
        require("Usage" in command(program, *words).stdout, f"no usage in {words}")
    command(program, expect=2)
    command(program, "run", expect=2)
    command(program, "nonsense", expect=2)


# --- the PLC's Ethernet port


@check
def client_reads_and_writes_the_plc():
    with first_plant() as plant:
        _, port = host_port(plant.mc)
        plc = lambda *words, **options: command(program, "plc", *words, "--plc", port, **options).stdout
        require("33281" in plc("read", r"U0\G25") and "8201" in plc("read", r"U0\G25"), plc("read", r"U0\G25"))
        plc("write", "D100", "1234", "-1", "0x10")
        words = plc("read", "D100", "--count", "3", "--format", "dec")
        for value in ("1234", "65535", "16"):
            require(value in words, words)
        # with a heartbeat consumer the words show what the last heartbeat said
        until(lambda: plc("read", r"U0\G602", "--count", "3", "--format", "dec").split().count("5") >= 3,
              "G602 to G604 do not become 5")
        plc("set", "M10")
        require("1" in plc("read", "M10"), "M10 did not come on")
        command(program, "plc", "read", "D999999", "--plc", port, expect=1)
        command(program, "plc", "read", "?5", "--plc", port, expect=2)


@check
def output_words_reach_the_device():
    """G13000 is the first transmit word: RPDO1 of node 2, whose second input byte echoes the first output byte."""
    with first_plant() as plant:
        _, port = host_port(plant.mc)
        command(program, "plc", "write", r"U0\G13000", "0x005A", "--plc", port)
        until(lambda: re.search(r"5A[0-9A-F]{2}", command(program, "plc", "read", r"U0\G10000", "--plc", port,
                                                          "--format", "hex").stdout),
              "the echo of 5AH does not come back")


@check
def saved_settings_survive_a_killed_program():
    """G22 and Y1F save G70; the program is killed without warning; the next one has it. An unsaved word is lost."""
    text = first_plant_file().read_text().replace('listen = "127.0.0.1:0"', 'listen = "127.0.0.1:0"\nstore = "state"')
    path = scratch / "with-store.toml"
    path.write_text(text)
    with running(path, operational=[1, 2, 3, 4]) as plant:
        _, port = host_port(plant.mc)
        plc = lambda *words: command(program, "plc", *words, "--plc", port).stdout
        plc("write", r"U0\G70", "1000")
        plc("write", r"U0\G22", "1")
        plc("set", "Y1F")
        until(lambda: plc("read", "X1F").split()[-1] == "ON", "X1F does not come on")
        require(plc("read", r"U0\G22", "--format", "dec").split()[-1] == "0", "G22 is not 0 after the save")
        plc("reset", "Y1F")
        plc("write", r"U0\G71", "900")
        plant.process.kill()
        plant.process.wait()
    require(any((scratch / "state").rglob("*")), "nothing was stored")
    with running(path, operational=[1]) as plant:
        _, port = host_port(plant.mc)
        words = command(program, "plc", "read", r"U0\G70", "--count", "2", "--plc", port, "--format", "dec").stdout.split()
        require("1000" in words and "500" in words, f"G70 and G71 after the restart: {words}")


@check
def python_speaks_mc_protocol_byte_by_byte():
    with first_plant() as plant:
        command(sys.executable, HERE / "mc_raw.py", *host_port(plant.mc), "--remote")


# --- CANopen peers on socketcand


@check
def javascript_speaks_socketcand():
    if not shutil.which("node"):
        raise Skip("node is not installed")
    with first_plant() as plant:
        command("node", HERE / "socketcand_client.js", *host_port(plant.socketcand), "line1", "2")


@check
def npm_canopen_reads_three_devices_and_starts_one():
    node_modules()
    with first_plant() as plant:
        command("node", HERE / "canopen_peer.mjs", *host_port(plant.socketcand), "line1",
                "2:0x000F0191", "3:0x00010196", "4:0x00020192")


@check
def python_can_hears_and_commands_the_bus():
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python3-can is not installed")
    with first_plant() as plant:
        command(PYTHON, HERE / "socketcand_python_can.py", *host_port(plant.socketcand), "line1", "3")


# --- real device files


# Good files that have no place in a plant of strangers: this one is the configuration of another network's master,
# with that network's COB-IDs, and watches the heartbeats of that network's slaves.
OTHER_MASTERS = {"lely_pilz-master"}


def device_files():
    if not DEVICE_FILES.is_dir():
        raise Skip(f"{DEVICE_FILES} is absent")
    return sorted(p for p in DEVICE_FILES.iterdir() if p.suffix in (".eds", ".dcf"))


@check
def eds_check_takes_at_least_30_of_38_real_files():
    files = device_files()
    accepted = 0
    for path in files:
        done = subprocess.run([program, "eds", "check", str(path)], capture_output=True, text=True, errors="replace", timeout=PATIENCE)
        require(done.returncode in (0, 1, 3), f"{path.name}: exit code {done.returncode}\n{done.stderr}")
        accepted += done.returncode != 1
        require((done.returncode == 3) == (": loss: " in done.stdout), f"{path.name}: exit code {done.returncode}\n{done.stdout}")
        if done.returncode == 1:
            require(re.search(rf"{re.escape(path.name)}:\d+:(\d+:)? error: ", done.stdout), f"{path.name}: refused without a line")
    require(accepted >= 30, f"{accepted} of {len(files)} files accepted, expected at least 30")
    print(f"    {accepted} of {len(files)} device files accepted")


CONNECTION = re.compile(r"U0\\G(\d+)(?:-G(\d+))? <- TPDO1 of node (\d+) \(.*\), ([0-9A-F]{3})H")


def connections_of(plant):
    """node -> (words, COB-ID) of its TPDO1, as `canopus check` tells them."""
    found = {}
    for match in CONNECTION.finditer(command(program, "check", plant).stdout):
        first, last, node, cob_id = match.groups()
        found[int(node)] = (range(int(first), int(last or first) + 1), int(cob_id, 16))
    return found


def many_devices_plant(moving=False, model="ME3CAN1-Q"):
    """Every real device file on one bus under one module as NMT master, configured as a network tool would do it: heartbeat,
    event-driven TPDO1 on the default COB-ID, as far as the device has these objects. With `moving` the first object of
    each TPDO1 that the file describes counts, and the words it arrives in are watched."""
    bus = '[plant]\nname = "many makers"\n[[bus]]\nname = "line1"\nbit_rate = 1_000_000\n'
    trial = scratch / "trial.toml"
    devices, used = [], {}
    node = 1
    for path in device_files():
        if path.stem in OTHER_MASTERS:
            continue
        node += 1
        head = f'[[device]]\nnode = {node}\nname = "{path.stem}"\neds = "{path}"\n'
        wanted = {"1017:00": 500, "1800:01": 0x4000_0180 + node, "1800:02": 255}
        settings = {}
        for name, value in wanted.items():
            trial.write_text(f'{bus}{head}objects = {{ "{name}" = {value} }}\n')
            if subprocess.run([program, "check", str(trial)], capture_output=True).returncode == 0:
                settings[name] = value
        text = head + "objects = { " + ", ".join(f'"{n}" = {v}' for n, v in settings.items()) + " }\n"
        mapped = moving and first_mapped_object(path)
        if mapped:
            motion = (f'[[device.behaviour]]\nobject = "{mapped}"\nkind = "counter"\nlow = 1\nhigh = 100\n'
                      'period = "100ms"\n')
            trial.write_text(bus + text + motion)
            if subprocess.run([program, "check", str(trial)], capture_output=True).returncode == 0:
                text += motion
        devices.append(text)
        used[node] = path.stem
    family = "iQ-R" if model == "RJ71CN91" else "Q"
    module = (f'[[plc]]\nname = "plc1"\nfamily = "{family}"\nlisten = "off"\n[[plc.module]]\nmodel = "{model}"\nhead = 0\n'
              'node = 1\nmaster = true\nexchange = "10ms"\nslaves = "all"\n')
    path = scratch / f"many-makers-{model}{'-moving' if moving else ''}.toml"
    path.write_text(bus + "".join(devices) + module)
    words = connections_of(path)
    watch = [600 + n for n in used] + [w for words_of, _ in words.values() for w in words_of]
    path.write_text(path.read_text() + "watch = [" + ", ".join(f'"G{w}"' for w in watch) + "]\n")
    return path, used, words


def run_and_collect(plant, trace):
    """Runs 20 s of plant time. Returns the values each watched word had, and the summary."""
    done = command(program, "run", plant, "--virtual", "--for", "20s", "--json", "--trace", trace, timeout=600)
    values, summary = {}, None
    for line in done.stdout.splitlines():
        event = json.loads(line)
        if event["event"] == "buffer":
            values.setdefault(event["address"], []).append(event["value"])
        if event["event"] == "summary":
            summary = event
    return values, summary


@check
def a_plant_of_real_device_files_boots():
    path, used, words = many_devices_plant()
    require(len(used) >= 20, f"only {len(used)} real device files can be used")
    values, summary = run_and_collect(path, scratch / "many-makers.log")
    down = [n["name"] for n in summary["nodes"] if n["state"] != "operational"]
    require(not down, f"not operational: {down}")
    wrong = {name: values.get(600 + node) for node, name in used.items() if values.get(600 + node, [None])[-1] != 5}
    require(not wrong, f"NMT state words that do not end with 5: {wrong}")
    print(f"    {len(used)} real device files operational, TPDO1 of {len(words)} connected")


@check
@covers("RJ71-STARTUP-007")
def an_rj71cn91_boots_a_plant_of_real_device_files():
    path, used, words = many_devices_plant(model="RJ71CN91")
    require(len(used) >= 20, f"only {len(used)} real device files can be used")
    values, summary = run_and_collect(path, scratch / "many-makers-rj71cn91.log")
    down = [n["name"] for n in summary["nodes"] if n["state"] != "operational"]
    require(not down, f"not operational: {down}")
    wrong = {name: values.get(600 + node) for node, name in used.items() if values.get(600 + node, [None])[-1] != 5}
    require(not wrong, f"NMT state words that do not end with 5: {wrong}")
    print(f"    {len(used)} real device files operational under an RJ71CN91, TPDO1 of {len(words)} connected")


@check
def process_data_of_real_devices_arrive_in_the_buffer_memory():
    path, used, words = many_devices_plant(moving=True)
    trace = scratch / "many-makers-moving.log"
    values, summary = run_and_collect(path, trace)
    arrived = [n for n, (words_of, _) in words.items() if any(len(set(values.get(w, []))) >= 3 for w in words_of)]
    silent = [used[n] for n in words if n not in arrived]
    require(len(arrived) >= 20, f"TPDO1 of {len(arrived)} devices arrived, expected at least 20; silent: {silent}")
    print(f"    TPDO1 of {len(arrived)} of {len(words)} devices arrives in the buffer memory"
          + (f"; nothing moves in {', '.join(silent)}" if silent else ""))
    if shutil.which("tshark"):
        command(sys.executable, HERE / "tshark_trace.py", trace)
    else:
        print("    tshark is absent: the trace is not decoded")


@check
def mode_b_binds_pdos_of_real_devices_to_an_fx3u_can():
    """8300H reads the COB-ID of each device's TPDO1 by SDO; the module's RPDO takes it [FX3U-CAN 7.2.5, 7.2.6]."""
    source, used, words = many_devices_plant(moving=True)
    bound = dict(zip(sorted(words)[:30], range(1, 31)))  # node: RPDO
    parameters = [0x8300] + [word for node, rpdo in bound.items() for word in (node << 8 | 1, rpdo)] + [0xFFFF]
    values = ", ".join(f"G{1000 + i} = {value}" for i, value in enumerate(parameters))
    devices = source.read_text().split("[[plc]]")[0]
    slaves = "".join(f"[[plc.module.slave]]\nnode = {node}\n" for node in bound)
    watched = [1000] + [10000 + 4 * (rpdo - 1) + i for rpdo in bound.values() for i in range(4)]
    shown = ", ".join(f'"G{word}"' for word in watched)
    # A PDO that is shorter than the RPDO's mapping is refused with 8210H: as many words as it brings.
    mapping = ", ".join(f'"{0x15FF + rpdo:04X}:00" = {len(words[node][0])}' for node, rpdo in bound.items())
    path = scratch / "many-makers-mode-b.toml"
    path.write_text(f'{devices}[[plc]]\nname = "plc1"\nfamily = "FX3"\nlisten = "off"\n[[plc.module]]\nmodel = "FX3U-CAN"\n'
                    f'position = 0\nnode = 1\nmaster = true\nexchange = "10ms"\nbuffer = {{ G26 = 0 }}\nwrite = {{ {values} }}\n'
                    f'objects = {{ {mapping} }}\n'
                    f'watch = [{shown}]\n{slaves}')
    seen, summary = run_and_collect(path, scratch / "many-makers-mode-b.log")
    require(seen.get(1000, [None])[-1] == 0x8301, f"#1000: {seen.get(1000)}")
    arrived = [node for node, rpdo in bound.items() if any(len(set(seen.get(10000 + 4 * (rpdo - 1) + i, []))) >= 3 for i in range(4))]
    silent = [used[node] for node in bound if node not in arrived]
    require(len(arrived) >= 20, f"TPDO1 of {len(arrived)} devices arrived, expected at least 20; silent: {silent}")
    print(f"    TPDO1 of {len(arrived)} of {len(bound)} real devices bound in mode B"
          + (f"; an odd number of bytes, or nothing moves, in {', '.join(silent)}" if silent else ""))


def first_mapped_object(path):
    """First object of TPDO1 that the file describes, read from the file itself and not by the program under test."""
    text = path.read_bytes().decode("latin-1")
    for sub in range(1, 9):
        section = re.search(rf"(?ims)^\[\s*1A00\s*sub\s*{sub}\s*\](.*?)(?=^\[|\Z)", text)
        value = section and (re.search(r"(?im)^\s*ParameterValue\s*=\s*(\w+)", section.group(1))
                             or re.search(r"(?im)^\s*DefaultValue\s*=\s*(\w+)", section.group(1)))
        if not value:
            continue
        entry = int(value.group(1), 0)
        if re.search(rf"(?im)^\[\s*{entry >> 16:04X}\s*\]", text):
            return f"{entry >> 16:04X}:{entry >> 8 & 0xFF:02X}"
    return None


# --- run them


def show_list():
    """Every check: tier, seconds on a quiet machine, why it is not in the shorter tier."""
    for function in sorted(checks, key=lambda f: (schedule.TIERS.index(schedule.tier_of(f)), f.__name__)):
        tier, plan = schedule.tier_of(function), schedule.plan_of(function)
        print(f"{tier:8} {plan.seconds:4.0f} s  {function.__name__}{': ' + schedule.reason_of(function) if tier != 'check' else ''}")
    return 0


def main():
    # A shell ignores them for what it starts in the background, and who is started here would inherit that.
    signal.signal(signal.SIGINT, signal.default_int_handler)
    for number in (signal.SIGQUIT, signal.SIGHUP):
        signal.signal(number, signal.SIG_DFL)
    unknown = schedule.PLANS.keys() - {function.__name__ for function in checks}
    if unknown:
        print(f"interop: schedule.py plans checks that there are not: {', '.join(sorted(unknown))}", file=sys.stderr)
        return 2
    if args.list:
        return show_list()
    chosen = [f for f in checks if (not args.only or args.only in f.__name__) and (not args.tier or schedule.tier_of(f) in args.tier)]
    base = pathlib.Path(tempfile.mkdtemp(prefix="canopus-interop-"))
    runner = Runner(base, scratch.move_to, schedule.PLANS, places=args.jobs, waiting=schedule.WAITING if args.jobs > 1 else 0,
                    limit=schedule.LIMIT, keep=args.keep)
    begun = time.monotonic()
    try:
        outcomes = runner.run(chosen, lambda outcome: print(line_of(outcome), end="", flush=True))
    except KeyboardInterrupt:
        print("interop: interrupted", file=sys.stderr)
        return 130
    finally:
        if args.keep:
            print(f"  scratch folders: {base}")
        else:
            shutil.rmtree(base, ignore_errors=True)
    if args.results:
        args.results.parent.mkdir(parents=True, exist_ok=True)
        features = {function.__name__: function.features for function in checks if hasattr(function, "features")}
        junit(outcomes, features).write(args.results, encoding="utf-8", xml_declaration=True)
    failed = [outcome.name for outcome in outcomes if outcome.verdict == "failed"]
    print(f"  {len(outcomes)} checks in {time.monotonic() - begun:.0f} s, {sum(o.wall for o in outcomes):.0f} s one after the other, "
          f"{sum(o.processor for o in outcomes):.0f} s of processors" + (f"; failed: {', '.join(failed)}" if failed else ""))
    return 1 if failed else 0


if __name__ == "__main__":
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))  # programs that run are stopped, too
    sys.exit(main())
