"""Plants on buses that are not simulated: those of another process, of a kernel with SocketCAN (in a virtual machine), and
traces."""
from kit import HERE, ROOT, check, command, host_port, in_machine, program, require, running, scratch, tier, until


def example(name, **changes):
    """An example plant of real-bus/ with free ports and a store of its own."""
    text = (ROOT / "examples/real-bus" / name).read_text().replace('"../devices/', f'"{ROOT}/examples/devices/')
    text = text.replace("127.0.0.1:5007", "127.0.0.1:0").replace("127.0.0.1:29536", changes.get("serve", "127.0.0.1:0"))
    path = scratch / f"{changes.get('as_name', name)}"
    path.write_text(text.replace('"state"', f'"{path}.store"'))
    return path


def words(plant, address, count=1):
    host, port = host_port(plant.mc)
    said = command(program, "plc", "read", f"U0\\G{address}", "--count", count, "--plc", f"{host}:{port}", "--format", "dec")
    return [int(line.split()[-1]) for line in said.stdout.splitlines()]


def operational(plant, nodes):
    return words(plant, 600 + min(nodes), max(nodes) - min(nodes) + 1) == [5] * len(nodes)


@check
def module_masters_devices_of_another_process():
    """examples/real-bus: an ME3CAN1-Q in one process, its slaves in another; then the slaves' process ends and comes again."""
    with running(example("devices.toml"), has_plc=False) as devices:
        link = f"socketcand:{devices.socketcand}/line1"
        with running(example("module.toml"), words=("--bus", link), is_served=False) as plant:
            until(lambda: operational(plant, [2, 3]), "the slaves of another process are operational")
            seen = set()
            until(lambda: seen.update(words(plant, 10000)) or len(seen) > 3, "their process data move")
            devices.stop()
            lost = plant.wait(lambda e: e["event"] == "error" and "tried again" in e["message"])
            require(lost["source"] == "bus line1", lost)
            until(lambda: not operational(plant, [2, 3]), "their heartbeats are missed")
            with running(example("devices.toml", serve=devices.socketcand, as_name="again.toml"), has_plc=False):
                plant.wait(lambda e: e["event"] == "error" and "there again" in e["message"])
                until(lambda: operational(plant, [2, 3]), "the module boots its slaves when they are there again")
            code, said = plant.stop()
            require(code == 0 and not said, f"{code} {said}")


@check
def linked_bus_is_refused_where_it_cannot_be():
    """A link that nobody serves, in virtual time, with a waveform, without a file."""
    plant = str(example("module.toml"))
    for link, more, code, told in (
            ("socketcand:127.0.0.1:1", (), 2, "Connection refused"),
            ("socketcan:nosuchcan9", (), 2, "--bus socketcan:nosuchcan9: "),
            ("replay:/none/run.log", (), 2, "/none/run.log"),
            ("line7=sim", (), 2, 'there is no bus "line7"; expected one of line1'),
            ("socketcan:can0", ("--virtual", "--for", "1s"), 2, "runs ahead of a real bus")):
        done = command(program, "run", plant, "--bus", link, *more, expect=code)
        require(told in done.stderr, f"{link}: {done.stderr}")
    log = scratch / "wave.log"
    log.write_text("(1.000000) can0 702#00\n")
    done = command(program, "run", plant, "--bus", f"replay:{log}", "--virtual", "--for", "1s", "--vcd", scratch / "w.vcd", expect=1)
    require("is not simulated" in done.stderr, done.stderr)
    done = command(program, "run", plant, "--bus", f"replay:{log}", "--virtual", "--for", "1s", "--trace", log, expect=1)
    require("would be overwritten" in done.stderr and log.read_text().endswith("702#00\n"), done.stderr)
    twice = command(program, "run", plant, "--bus", f"replay:{log}", "--bus", "sim", "--virtual", "--for", "1s", expect=2)
    require("has a --bus already" in twice.stderr, twice.stderr)
    here = command(program, "run", plant, "--bus", "replay:wave.log", "--virtual", "--for", "1s", "--quiet", cwd=scratch)
    require(not here.stderr, f"a path of the command line is meant from where the user is: {here.stderr}")


@check
def trace_of_a_run_is_a_bus():
    """A plant's own recording played back: a module elsewhere sees the same devices come up, at the same times."""
    trace = scratch / "devices.log"
    command(program, "run", example("devices.toml"), "--virtual", "--for", "3s", "--trace", trace, "--quiet")
    recorded = trace.read_text().splitlines()
    again = scratch / "again.log"
    command(program, "run", example("module.toml"), "--bus", f"replay:{trace}", "--virtual", "--for", "3s", "--trace", again,
            "--quiet")
    played = [line for line in again.read_text().splitlines() if "#" in line]
    first = float(recorded[0].split(")")[0][1:])
    for line in recorded:
        time, _, frame = line.split()
        wanted = f"({float(time[1:-1]) - first:017.6f}) line1 {frame}"
        require(any(abs(float(p.split(")")[0][1:]) - (float(time[1:-1]) - first)) < 2e-6 and p.endswith(" " + frame) for p in played),
                f"{wanted} is missing in the replay")


@check
@tier("machine")
def plants_on_socketcan():
    """In a virtual machine: a module as master on vcan0 and on a controller with real bit timing, its slaves in another process;
    candump and cansend take part; the interface goes down and up; bus-off and recovery."""
    for theirs, ours in (("vcan0", "vcan0"), ("can0", "can1")):
        done = in_machine("bash", HERE / "socketcan_plant.sh", program, theirs, ours)
        require("socketcan plant ok" in done.stdout, f"{theirs} to {ours}:\n{done.stdout[-12000:]}\n{done.stderr[-2000:]}")
