"""python3-can, tshark and can-utils read the same traces as `canopus trace convert`: compared frame by frame."""
import csv
import shutil
import struct
import subprocess

from kit import PYTHON, ROOT, Skip, check, command, program, require, scratch

TRACES = ROOT.parent / "shared" / "data" / "traces"


def ours(path):
    """(time in us since the first frame, identifier, extended, remote, error, DLC, data) of each frame; of an error frame that it is one."""
    table = scratch / "witness.csv"
    command(program, "trace", "convert", path, table, "--out-format", "csv", "-q")
    with open(table, newline="") as file:
        rows = list(csv.DictReader(file))
    frames = [(microseconds(row["time"]), int(row["id"], 16), int(row["extended"]), int(row["remote"]), int(row["error"]), int(row["dlc"]),
               row["data"].replace(" ", "").lower()) for row in rows]
    return normal(frames)


def microseconds(seconds):
    whole, _, fraction = seconds.partition(".")
    return int(whole) * 1_000_000 + int(fraction[:6].ljust(6, "0"))


def normal(frames):
    first = frames[0][0] if frames else 0
    return [(time - first, "error") if error else (time - first, identifier, extended, remote, dlc, "" if remote else data)
            for time, identifier, extended, remote, error, dlc, data in frames]


def python_can(path, kind):
    """The same as python3-can has it, CAN FD frames left out."""
    if subprocess.run([PYTHON, "-c", "import can"], capture_output=True).returncode != 0:
        raise Skip("python3-can is not installed")
    code = ("import sys, can\n"
            f"for m in {kind}(sys.argv[1]):\n"
            "    if m.is_fd and not m.is_error_frame and not m.is_remote_frame: continue\n"
            "    print(round(m.timestamp * 1e6), m.arbitration_id, int(m.is_extended_id), int(m.is_remote_frame), int(m.is_error_frame), m.dlc,\n"
            "          bytes(m.data).hex() or '-')\n")
    lines = command(PYTHON, "-c", code, path).stdout.splitlines()
    fields = [line.split() for line in lines]
    return normal([(*map(int, words[:6]), words[6].replace("-", "")) for words in fields])


def tshark(path):
    """The same as tshark has it. It does not tell the FD frames of a BLF file from others."""
    if not shutil.which("tshark"):
        raise Skip("tshark is not installed")
    names = ["frame.time_epoch", "can.id", "can.flags.xtd", "can.flags.rtr", "can.flags.err", "can.len", "data"]
    words = ["tshark", "-r", path, "-Y", "can", "-d", "can.subdissector,data", "-T", "fields", "-E", "separator=|"]
    for name in names:
        words += ["-e", name]
    frames = []
    for line in command(*words).stdout.splitlines():
        time, identifier, extended, remote, error, length, data = line.split("|")
        frames.append((microseconds(time), int(identifier or "0", 0), int(extended or "0"), int(remote or "0"), int(error or "0"), int(length), data))
    return normal(frames)


def same(name, mine, theirs, judge):
    # its times are floating point: a microsecond is the rounding of both sides
    differ = [n for n, (a, b) in enumerate(zip(mine, theirs)) if a[1:] != b[1:] or abs(a[0] - b[0]) > 1]
    require(not differ, f"{name}: frame {differ[:1]}: {mine[differ[0]] if differ else ''}, {judge} has {theirs[differ[0]] if differ else ''}")
    require(len(mine) == len(theirs), f"{name}: {len(mine)} frames, {judge} has {len(theirs)}")
    require(mine, f"{name}: no frames")


@check
def tshark_reads_the_foreign_captures_frame_by_frame_alike():
    if not TRACES.is_dir():
        raise Skip("../shared/data/traces is not there")
    for path in sorted(TRACES.glob("*.pcapng")):
        same(path.name, ours(path), tshark(path), "tshark")


@check
def python_can_reads_the_foreign_logs_frame_by_frame_alike():
    if not TRACES.is_dir():
        raise Skip("../shared/data/traces is not there")
    # The line with 64 bytes and no flag FDF is CAN FD for both; one CANFD line is a remote frame, one an error frame.
    asc = TRACES / "python-can_logfile.asc"
    theirs = python_can(asc, "can.ASCReader")
    mine = ours(asc)
    same(asc.name, mine, theirs, "python-can")
    # python-can 4.1 reads no remote rows of TRC, which is its mistake (hardbyte/python-can#1953)
    trc = TRACES / "python-can_v2.1.trc"
    mine = [frame for frame in ours(trc) if frame[1] == "error" or not frame[3]]
    same(trc.name, mine, python_can(trc, "can.TRCReader"), "python-can")


@check
def log2long_and_tshark_read_the_candump_logs_of_a_screen_alike():
    if not shutil.which("log2long"):
        raise Skip("log2long (can-utils) is not installed")
    log = scratch / "screen.log"
    log.write_text("(1.000000) can0 705#05\n(1.100000) can0 20000004#0008000000006000\n(1.200000) can1 12345678#1122\n"
                   "(1.300000) can0 181##1112233\n(1.400000) can0 181#R\n(1.500000) can0 600#\n")
    screen = scratch / "screen.txt"
    screen.write_text(command("log2long", input=log.read_text()).stdout)
    require(ours(screen) == ours(log), f"{screen.read_text()}: {ours(screen)}")


def blf_of_an_fd_channel(path):
    """CAN_FD_MESSAGE and CAN_FD_MESSAGE_64 of a channel that can do CAN FD: six classical frames and two CAN FD ones."""
    def thing(kind, body, at):
        size = 32 + len(body)
        head = struct.pack("<4sHHIIIHHQ", b"LOBJ", 32, 1, size, kind, 2, 0, 0, at)
        return head + body + bytes(size % 4)

    def fd(flags, dlc, identifier, fd_flags, data):
        return struct.pack("<HBBIIBBBBI64sI", 1, flags, dlc, identifier, 0, 0, fd_flags, len(data), 0, 0, data, 0)

    def fd_64(dlc, identifier, flags, data):
        return struct.pack("<BBBBIIIIIIIHBBI", 1, dlc, len(data), 0, identifier, 0, flags, 0, 0, 0, 0, 0, 0, 0, 0) + data

    data = bytes.fromhex("4300100092010200")
    objects = [thing(1, struct.pack("<HBBI8s", 1, 0, 8, 0x601, data), 1_000_000), thing(100, fd(0, 8, 0x581, 0, data), 2_000_000),
               thing(101, fd_64(8, 0x182, 0, data), 3_000_000), thing(101, fd_64(1, 0x80000701, 0, b"\x05"), 4_000_000),
               thing(101, fd_64(0, 0x702, 0x10, b""), 5_000_000), thing(100, fd(0, 2, 0x582, 0, b"\x01\x02"), 6_000_000),
               thing(101, fd_64(8, 0x183, 0x3000, data), 7_000_000), thing(100, fd(0, 8, 0x184, 1, data), 8_000_000)]
    content = b"".join(objects)
    container = struct.pack("<4sHHIIHHIII", b"LOBJ", 16, 1, 32 + len(content), 10, 0, 0, 0, len(content), 0) + content
    start = struct.pack("<8H", 2024, 5, 5, 10, 18, 24, 8, 846)
    head = struct.pack("<4sI8BQQII", b"LOGG", 144, 5, 0, 0, 0, 2, 6, 8, 1, 144 + len(container), 144 + len(content), len(objects), 0) + start + start
    path.write_bytes(head.ljust(144, b"\0") + container)


@check
def blf_of_a_channel_that_can_do_fd_is_read_as_python_can_and_tshark_read_it():
    path = scratch / "fd.blf"
    blf_of_an_fd_channel(path)
    mine = ours(path)
    require(len(mine) == 6, str(mine))
    same(path.name, mine, python_can(path, "can.BLFReader"), "python-can")
    same(path.name, mine, [frame for frame in tshark(path) if frame[1] not in (0x183, 0x184)], "tshark")


@check
def a_busmaster_log_is_read_as_tshark_reads_it():
    path = scratch / "busmaster.log"
    lines = [f"11:49:12:{n * 13:04} {'Tx' if n % 5 == 0 else 'Rx'} {1 + n % 2} 0x{n * 2000000 if n % 3 == 0 else n * 10:X} "
             f"{'x' if n % 3 == 0 else 's'}{'r' if n % 7 == 3 else ''} {n % 9} "
             + ("" if n % 7 == 3 else " ".join(f"{(n * 7 + k) % 256:02X}" for k in range(n % 9))) for n in range(200)]
    path.write_text("***BUSMASTER Ver 2.4.0***\n***PROTOCOL CAN***\n***NOTE: PLEASE DO NOT EDIT THIS DOCUMENT***\n"
                    "***[START LOGGING SESSION]***\n***START DATE AND TIME 8:8:2014 11:49:7:965***\n***HEX***\n***SYSTEM MODE***\n"
                    "***<Time><Tx/Rx><Channel><CAN ID><Type><DLC><DataBytes>***\n" + "\n".join(lines) +
                    "\n***END DATE AND TIME 8:8:2014 11:50:7:965***\n***[STOP LOGGING SESSION]***\n")
    same(path.name, ours(path), tshark(path), "tshark")


@check
def error_rows_of_our_trc_do_not_hide_its_frames_from_python_can():
    log = scratch / "errors.log"
    log.write_text("(1.0) can0 181#01\n(1.1) can0 20000088#0000020000000000\n(1.2) can0 20000088#0000840A00000201\n(1.3) can0 182#0203\n"
                   "(1.4) can0 20000004#0008000000006000\n(1.5) can0 18FF0011#\n")
    for version in ("2.1", "1.1"):  # python-can 4.1 reads no 2.0, and gives up at an error row of 1.0
        trc = scratch / f"errors-{version}.trc"
        command(program, "trace", "convert", log, trc, "--trc-version", version, "-q")
        mine = ours(trc)
        require([frame[1] for frame in mine] == [0x181, "error", "error", 0x182, "error", 0x18FF0011], str(mine))
        same(trc.name, [frame for frame in mine if frame[1] != "error"], python_can(trc, "can.TRCReader"), "python-can")
