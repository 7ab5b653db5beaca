"""Checks of the AS-FCOPM: Modbus clients that are not ours run its requests, and the example a user copies from. Expected words and
frames are written out, from chapter 10 of the manual and CiA 301."""
import contextlib
import itertools
import pathlib
import shutil
import subprocess

from docs_checks import transcripts
from kit import (HERE, PATIENCE, PYTHON, ROOT, RawClient, Skip, attempts, check, command, covers, node_modules, require, running,
                 scratch, talking, tshark_agrees, until)
from module_checks import in_order, recorded
from port_checks import port_of

EXAMPLES = ROOT / "examples/as-fcopm"
SR = 0xC000  # Modbus address of SR0


def example(name):
    """The example with servers on free ports."""
    text = (EXAMPLES / f"{name}.toml").read_text()
    for old in ("127.0.0.1:29536", "127.0.0.1:5021"):
        require(old in text, f"{name}.toml has no {old}")
        text = text.replace(old, "127.0.0.1:0")
    path = scratch / f"as-fcopm-{name}.toml"
    path.write_text(text.replace('"../devices/', f'"{ROOT}/examples/devices/'))
    return path


def card_plant(name, download, devices="", card=""):
    """An AS300 with the card on a bus of 1 Mbit/s."""
    path = scratch / f"as-fcopm-{name}.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 1_000_000\nserve = "socketcand:127.0.0.1:0"\n' + devices
                    + '[[plc]]\nfamily = "AS300"\nlisten = "off"\n[[plc.modbus]]\nlisten = "127.0.0.1:0"\n'
                    f'[[plc.module]]\nmodel = "AS-FCOPM"\ncard = 2\n{card}\n[plc.module.download]\n{download}')
    return path


class Hands:
    """A Modbus client that is not ours, which does what it is bidden."""

    def __init__(self, talker):
        self.talker = talker

    def bid(self, line):
        print(line, file=self.talker.process.stdin, flush=True)
        return self.talker.wait_line(lambda _: True)

    def read(self, address, count=1):
        return self.bid(f"read {address} {count}")

    def write(self, address, words):
        said = self.bid(f"write {address} {words}")
        require(said == "ok", f"writing {words} from {address}: {said}")

    def become(self, address, words):
        """Waits until the words from an address on are these."""
        count = len(words.split())
        last = [""]

        def there():
            last[0] = self.read(address, count)
            return last[0] == words
        try:
            until(there, "")
        except AssertionError:
            raise AssertionError(f"the words from {address} are {last[0]}, expected {words}") from None

    def answered(self, request):
        """The answer's words from D24000 on have the ReqID, and its status is no longer 2."""
        until(lambda: (word := self.read(24000))[:2] == request[:2] and word[2:] != "02", f"no answer to {request}")

    def ask(self, request, answer):
        """A request in one write, and how its answer begins."""
        self.write(25000, request)
        self.answered(request)
        said = self.read(24000, len(answer.split()))
        require(said == answer, f"the answer to {request} is {said}, expected {answer}")


def pymodbus():
    if subprocess.run([PYTHON, "-c", "import pymodbus"], capture_output=True).returncode != 0:
        raise Skip("python3-pymodbus is not installed")
    return [PYTHON, HERE / "modbus_words.py"]


def modbus_serial():
    node_modules()
    return ["node", HERE / "modbus_words.js"]


def libmodbus():
    if not shutil.which("gcc") or not pathlib.Path("/usr/include/modbus/modbus.h").is_file():
        raise Skip("libmodbus-dev is not installed")
    client = scratch / "modbus_words"
    command("gcc", "-Wall", "-Wextra", "-Werror", "-O1", HERE / "modbus_words.c", "-o", client, "-lmodbus")
    return [client]


@contextlib.contextmanager
def hands(client, plant):
    with talking(*client, *port_of(plant, "Modbus TCP")) as talker:
        yield Hands(talker)
        talker.process.stdin.close()
        talker.require_end()


def ended(plant):
    """Ends the run; its frames."""
    code, errors = plant.stop()
    require(code == 0, f"exit code {code}: {errors}")
    return recorded(plant.trace)


def await_frame(bus, wanted):
    while bus.frame() != wanted:
        pass


# --- requests by registers


def run_the_requests(plc, plant):
    plc.become(SR + 821, "0192 03E8")                                   # DS301 V4.02, 1000 kbit/s
    plc.become(24032, "0250")                                           # the drive's statusword: it is Operational
    require(plc.read(24000, 2) == "0000 0000", "a status before the first request")
    # 10.4.1: writes and reads of 4, 2 and 1 bytes
    plc.ask("0101 0008 0203 6083 0000 03E8 0102", "0101 0004 6003 6083 0000 0000 0000")
    plc.ask("0201 0004 0103 6083 0000 0000 0000", "0201 0008 4303 6083 0000 03E8 0102")
    plc.ask("0301 0006 0203 605A 0000 0006 FFFF", "0301 0004 6003 605A 0000 0000 0000")
    plc.ask("0401 0004 0103 605A 0000 0000 0000", "0401 0006 4B03 605A 0000 0006 0000")
    plc.ask("0501 0005 0203 6098 0000 FF11 0000", "0501 0004 6003 6098 0000 0000 0000")
    plc.ask("0601 0004 0103 6098 0000 0000 0000", "0601 0005 4F03 6098 0000 0011 0000")
    # what the slave refuses: no object, read only
    plc.ask("0701 0004 0103 9999 0001 0000 0000", "070A 0008 8003 9999 0001 0000 0602")
    plc.ask("0801 0008 0203 1000 0000 0001 0000", "080A 0008 8003 1000 0000 0002 0601")
    # each status code
    plc.ask("0901 0004 0103 1008 0000 0000 0000", "0906 0000 0003 0000 0000 0000 0000")  # a text
    plc.ask("0A01 0004 0180 1000 0000 0000 0000", "0A09 0000 0080 0000")                 # node 128
    plc.ask("0B01 0004 0503 1000 0000 0000 0000", "0B08 0000 0003 0000")                 # type 5
    plc.ask("0C02 0004 0103 1000 0000 0000 0000", "0C04 0000 0003 0000")                 # command 2
    plc.ask("0D01 0009 0203 6083 0000 0000 0000", "0D05 0000 0003 0000")                 # size 9
    plc.ask("0E01 0004 0109 1000 0000 0000 0000", "0E03 0000 0009 0000")                 # nobody is node 9
    # word by word, D25000 last; the same ReqID again asks nothing
    for address, word in ((25001, "0004"), (25002, "0103"), (25003, "1018"), (25004, "0002"), (25000, "0F01")):
        plc.write(address, word)
    plc.answered("0F01")
    require(plc.read(24000, 7) == "0F01 0008 4303 1018 0002 0402 0000", plc.read(24000, 7))
    plc.write(25003, "1000")
    plc.write(25000, "0F01")
    require(plc.read(24003) == "1018", "the same ReqID has asked")
    # 10.4.3: emergency messages, as of the manual's slave No. 2
    plc.ask("1001 0000 0402 0000 0000 0000 0000", "1001 002A 0402 0000 0000 0000 0000 0000")
    bus = RawClient(plant)
    with bus.socket:
        bus.send(0x082, bytes.fromhex("43 54 20 14 00 00 00 00"))
        bus.send(0x082, bytes.fromhex("42 54 20 15 00 00 00 00"))
        until(lambda: plc.read(SR + 831) == "00E0", "SR831 is not E0H")
        require(plc.read(SR + 826) == "0002", "SR826 has another node than 2")
        requests = itertools.cycle(("1101", "1201"))

        def both_came():
            request = next(requests)
            plc.ask(f"{request} 0000 0402", f"{request} 002A 0402")
            return plc.read(24003) == "0202"
        until(both_came, "D24003 is not 0202H")
        require(plc.read(24004, 20) == "5442 1520 0000 0000 5443 1420" + 14 * " 0000", plc.read(24004, 20))
    # 10.4.2: NMT
    plc.ask("2101 0004 0303 0002 0003 0000 0000", "2101 0000 0003 0000 0000")
    plc.ask("2201 0004 0303 0080 0003 0000 0000", "2201 0000 0003 0000 0000")
    plc.ask("2301 0004 0303 0001 0003 0000 0000", "2301 0000 0003 0000 0000")
    plc.ask("2401 0004 0300 0002 0000 0000 0000", "2401 0000 0000 0000 0000")
    plc.ask("2501 0004 0300 0001 0000 0000 0000", "2501 0000 0000 0000 0000")
    plc.ask("2601 0004 0303 0003 0003 0000 0000", "2604 0000 0003 0000 0000")  # no such service
    plc.ask("2701 0004 0301 0002 0001 0000 0000", "2709 0000 0001 0000 0000")  # the master itself
    # process data, both ways, when a drive that was reset is booted again
    bus = RawClient(plant)
    with bus.socket:
        plc.ask("2801 0004 0303 0082 0003 0000 0000", "2801 0000 0003 0000 0000")
        for wanted in ((0x703, b"\x00"), (0x000, b"\x01\x03")):
            await_frame(bus, wanted)
        plc.write(25032, "0006")
        plc.become(24032, "0231")
        plc.write(25033, "1234 0001")
        await_frame(bus, (0x303, bytes.fromhex("34 12 01 00")))
    require(plc.read(25032, 3) == "0006 1234 0001", plc.read(25032, 3))
    require(plc.read(65000) == "exception 2", "65000 is no address of an AS300")


REQUEST_FRAMES = [
    (0x603, "23 83 60 00 E8 03 02 01"), (0x583, "60 83 60 00 00 00 00 00"),
    (0x603, "40 83 60 00 00 00 00 00"), (0x583, "43 83 60 00 E8 03 02 01"),
    (0x603, "2B 5A 60 00 06 00 00 00"), (0x583, "60 5A 60 00 00 00 00 00"),
    (0x603, "40 5A 60 00 00 00 00 00"), (0x583, "4B 5A 60 00 06 00 00 00"),
    (0x603, "2F 98 60 00 11 00 00 00"), (0x583, "60 98 60 00 00 00 00 00"),
    (0x603, "40 98 60 00 00 00 00 00"), (0x583, "4F 98 60 00 11 00 00 00"),
    (0x603, "40 99 99 01 00 00 00 00"), (0x583, "80 99 99 01 00 00 02 06"),
    (0x603, "23 00 10 00 01 00 00 00"), (0x583, "80 00 10 00 02 00 01 06"),
    (0x603, "40 08 10 00 00 00 00 00"),
    (0x609, "40 00 10 00 00 00 00 00"),
    (0x603, "40 18 10 02 00 00 00 00"), (0x583, "43 18 10 02 02 04 00 00"),
    (0x082, "43 54 20 14 00 00 00 00"), (0x082, "42 54 20 15 00 00 00 00"),
    (0x000, "02 03"), (0x000, "80 03"), (0x000, "01 03"), (0x000, "02 00"), (0x000, "01 00"),
    (0x000, "82 03"), (0x703, "00"), (0x000, "01 03"), (0x203, "06 00"), (0x303, "34 12 01 00")]


def requests_of_an_as_fcopm(client):
    devices = "".join(f'[[device]]\nnode = {node}\nname = "{name}"\neds = "{ROOT}/examples/devices/{name}.eds"\n'
                      for node, name in ((2, "io-block"), (3, "drive"))) + "[device.drive]\n"
    path = card_plant("requests", "\n".join([
        "[[plc.module.download.slave]]", "node = 3", 'heartbeat = "200ms"', 'heartbeat_time_out = "30s"',
        'rx_pdo = [{ number = 1, objects = ["6040:00"] }, { number = 2, objects = ["60FF:00"] }]',
        'tx_pdo = [{ number = 1, type = 1, objects = ["6041:00"] }]',
        "[[plc.module.download.slave]]", "node = 2"]), devices, "node = 1")
    with running(path, has_plc=False) as plant:
        with hands(client, plant) as plc:
            run_the_requests(plc, plant)
        frames = ended(plant)
    in_order(frames, REQUEST_FRAMES)
    require(sum(frame == (0x603, bytes.fromhex("40 00 10 00 00 00 00 00")) for frame in frames) <= 2,
            "1000H was read by a request that was none")  # the two boots read it


REQUESTS = ("ASF-REQ-001 ASF-REQ-002 ASF-REQ-003 ASF-REQ-005 ASF-REQ-008 ASF-REQ-009 ASF-REQ-010 ASF-REQ-012 ASF-REQ-013 "
            "ASF-REQ-014 ASF-REQ-015 ASF-REQ-017 ASF-REQ-018 ASF-REQ-019 ASF-SDOREQ-001 ASF-SDOREQ-002 ASF-SDOREQ-003 "
            "ASF-SDOREQ-004 ASF-SDOREQ-005 ASF-SDOREQ-006 ASF-NMTREQ-001 ASF-NMTREQ-003 ASF-NMTREQ-004 ASF-NMTREQ-005 ASF-EMCYREQ-001 "
            "ASF-EMCYREQ-002 ASF-EMCYREQ-004 ASF-EMCYREQ-006")


@check
@covers(REQUESTS)
def pymodbus_runs_the_requests_of_an_as_fcopm():
    requests_of_an_as_fcopm(pymodbus())


@check
@covers(REQUESTS)
def npm_modbus_serial_runs_the_requests_of_an_as_fcopm():
    requests_of_an_as_fcopm(modbus_serial())


@check
@covers(REQUESTS)
def libmodbus_runs_the_requests_of_an_as_fcopm():
    requests_of_an_as_fcopm(libmodbus())


# --- codes of the card itself


@check
@covers("ASF-SRM-002 ASF-SRM-005 ASF-SRS-003 ASF-CFG-010 ASF-CFG-011 ASF-CFG-012")
@attempts(3)  # F2H is there for 2 s
def a_wrong_node_id_and_downloads_of_an_as_fcopm_are_shown_in_sr825():
    """F5H of a node-ID that is none: nothing is sent. F2H, as slave A3H, while the running PLC gets a download, then as before."""
    client = pymodbus()
    for name, download, shown in (("wrong-node", "node_id = 200", ("00F5",)),
                                  ("download", 'again_at = "3s"', ("00F1", "00F2", "00F1")),
                                  ("download-slave", 'work_mode = "slave"\nagain_at = "3s"', ("00A1", "00A3", "00A1"))):
        listener = f'[[device]]\nnode = 5\neds = "{ROOT}/examples/devices/io-block.eds"\n'  # it acknowledges
        with running(card_plant(name, download, listener, "node = 1"), has_plc=False) as plant:
            with hands(client, plant) as plc:
                for code in shown:
                    plc.become(SR + 825, code)
            frames = ended(plant)
        sent = [frame for frame in frames if frame[0] in (0x000, 0x080, 0x701)]
        require(bool(sent) == (name != "wrong-node"), f"{name}: {sent}")


# --- the servo


@check
@covers("ASF-GEN-001 ASF-PDO-016 ASF-PDO-017 ASF-SDO-006 ASF-PDO-004 ASF-PDO-005")
def the_servo_example_of_the_as_fcopm_runs_as_its_page_shows():
    pymodbus()
    page = "docs/modules/as-fcopm.md"
    shown = [lines for commands in transcripts(page) for words, lines in commands if words == "python3 examples/as-fcopm/servo.py"]
    require(len(shown) == 1, f"{page} shows servo.py {len(shown)} times")
    with running(example("servo"), has_plc=False) as plant:
        said = command(PYTHON, EXAMPLES / "servo.py", *port_of(plant, "Modbus TCP"), timeout=5 * PATIENCE).stdout.splitlines()
        again = command(PYTHON, EXAMPLES / "servo.py", *port_of(plant, "Modbus TCP"), timeout=5 * PATIENCE).stdout.splitlines()
        tshark_agrees(plant, "boot-up,NMT,SDO,PDO,SYNC,heartbeat")
        frames = recorded(plant.trace)
    lasting = lambda lines: [line for line in lines if not line.startswith("  on the way: ")]
    require(lasting(said) == lasting(shown[0]), f"{page} shows\n" + "\n".join(shown[0]) + "\nservo.py says\n" + "\n".join(said))
    require(again[-3:] == said[-3:], "the second run says\n" + "\n".join(again))
    in_order(frames, [
        (0x603, "23 00 16 01 20 00 7A 60"), (0x603, "23 00 16 02 10 00 40 60"), (0x603, "23 00 16 03 08 00 60 60"),  # RxPDO1
        (0x603, "2F 00 16 00 03 00 00 00"),
        (0x603, "23 7F 60 00 60 EA 00 00"),                           # auto SDO: 607FH = 60000
        (0x000, "01 03"),                                             # started
        (0x603, "2F 98 60 00 11 00 00 00"),                           # homing method 17, by a request
        (0x603, "2B 41 60 00 00 00 00 00"), (0x583, "80 41 60 00 02 00 01 06"),
        (0x203, "E0 2E 00 00 0F 00 06"),                              # 12000, homing mode
        (0x203, "E0 2E 00 00 1F 00 06"),                              # homing
        (0x203, "50 C3 00 00 3F 00 01"), (0x203, "50 C3 00 00 0F 00 01"),  # 50000, a new set-point and its end
        (0x183, "50 C3 00 00 37 06 01"),                              # is there: target reached
        (0x203, "F0 49 02 00 3F 00 01"), (0x183, "F0 49 02 00 37 06 01"),  # 150000
        (0x203, "20 4E 00 00 3F 00 01"), (0x183, "20 4E 00 00 37 06 01"),  # 20000
        (0x303, "78 EC FF FF"), (0x283, "78 EC FF FF"),               # -5000/s
        (0x303, "00 00 00 00"), (0x283, "00 00 00 00"),
        (0x203, "20 4E 00 00 00 00 03")])                             # voltage off
