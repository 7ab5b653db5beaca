"""Checks of `canopus plc` against a plant that stands still between two commands."""
import json

from kit import ROOT, check, command, host_port, program, require, scratch
from step_checks import stepped


def plc_of(plant):
    _, port = host_port(plant.servers["MC protocol"])
    return lambda *words, **options: command(program, "plc", *words, "--plc", port, **options)


@check
def ranges_are_dumped_and_loaded():
    with stepped() as plant:
        plc = plc_of(plant)
        plant.run(until="X0", **{"for": "20s"})
        plc("write", "D100", "1", "2", "-3")
        plc("set", "M7")
        plc("write", r"U0\G13000", "4", "5")
        saved = scratch / "saved.csv"
        ranges = ("D100..D102", "M6..M8", r"U0\G13000..U0\G13001", "W1F")
        plc("dump", *ranges, "-o", saved)
        lines = ["address,value", "D100,1", "D101,2", "D102,65533", "M6,OFF", "M7,ON", "M8,OFF", r"U0\G13000,4", r"U0\G13001,5", "W1F,0"]
        require(saved.read_text().splitlines() == lines, saved.read_text())
        require(plc("dump", *ranges).stdout == saved.read_text(), "the standard output has something else")
        plc("write", "D100", "0", "0", "0")
        plc("reset", "M7")
        require("9 points written" in plc("load", saved).stdout, "load does not say what it did")
        require(plc("dump", *ranges).stdout == saved.read_text(), "it did not come back")
        for text, expected in (("D100,1\nD101;2\n", ":2: expected ADDRESS,VALUE"), ("D100,70000\n", ":1: '70000' is no 16-bit value"),
                               ("M0,2\n", ":1: '2' is no bit"), ("D100,9\n\n\x1b[2Jx,1\n", ":3: ")):
            wrong = scratch / "wrong.csv"
            wrong.write_text(text)
            said = plc("load", wrong, expect=2).stderr
            require(expected in said and "\x1b" not in said, said)
        require(plc("read", "D100", "--format", "dec").stdout.split()[-1] == "1", "a wrong file was half loaded")
        for wrong in ("D5..D1", "D1..M5", "D0..D99999999", "D1..", "Q7"):
            plc("dump", wrong, expect=2)
        plc("load", scratch / "no-such-file.csv", expect=2)
        plc("dump", "D999999", expect=1)


@check
def words_are_read_by_the_names_of_the_manual():
    with stepped() as plant:
        plc = plc_of(plant)
        plant.run(until=r"U0\G601 == 5", **{"for": "60s"})
        model = ("--module", "ME3CAN1-Q")
        require(plc("read", "U0:communication_status", *model).stdout == plc("read", r"U0\G25").stdout, "another word")
        require(plc("read", "U0:nmt_state[3]", *model).stdout.startswith(r"U0\G604"), "another word")
        plc("write", "U0:sdo_time_out", "600", *model)
        require("600" in plc("read", r"U0\G71").stdout, "it is not written")
        require("did you mean communication_status?" in plc("read", "U0:comunication_status", *model, expect=2).stderr, "no help")
        plc("read", "X:error_status", expect=2)
        require(" communication_status\n" in command(program, "plc", "names").stdout, "the names")


@check
def signals_of_a_pdo_are_read_written_and_watched_by_name():
    example = ("--plant", ROOT / "examples/first-plant/plant.toml")
    with stepped() as plant:
        plc = plc_of(plant)
        plant.run(until=r"U0\G604 == 5", **{"for": "60s"})
        require("U0\\G10008  drive.6041:00 Statusword  64  0040H  switch on disabled\n" == plc("read", "drive.Statusword", *example).stdout,
                plc("read", "drive.Statusword", *example).stdout)
        plc("write", r"U0\G13000", "0x1234")
        plc("write", "io-block.6200:02", "0xA5", *example)
        require("A534H" in plc("read", r"U0\G13000").stdout, "the other byte of the word is not kept")
        require("300 does not fit" in plc("write", "io-block.6200:02", "300", *example, expect=2).stderr, "300 fits into 8 bits")
        require("comes from the node" in plc("write", "encoder.6004", "5", *example, expect=2).stderr, "an input is written")
        require('did you mean "encoder"?' in plc("read", "encodr.6004", *example, expect=2).stderr, "no near name")
        line = json.loads(plc("watch", "drive.6041", "--json", "--for", "1ms", *example).stdout.splitlines()[0])
        require(line.pop("time") >= 0 and line == {"drive.6041:00": 64}, line)
        rows = plc("watch", "drive.6041", "--csv", "--for", "1ms", *example).stdout.splitlines()
        require(rows[0] == "time,drive.6041:00" and rows[1].endswith(",64"), rows)


@check
def changes_are_watched_as_csv_and_json():
    with stepped() as plant:
        plc = plc_of(plant)
        plc("write", "D0", "7", "-1")
        rows = plc("watch", "D0", "-n", "2", "--csv", "--for", "1ms").stdout.splitlines()
        require(rows[0] == "time,D0,D1" and rows[1].split(",")[1:] == ["7", "65535"], rows)
        rows = plc("watch", "D0", "-n", "2", "--csv", "--signed", "--for", "1ms").stdout.splitlines()
        require(rows[1].split(",")[1:] == ["7", "-1"], rows)
        line = json.loads(plc("watch", "M0", "-n", "2", "--json", "--for", "1ms").stdout.splitlines()[0])
        require(line.pop("time") >= 0 and line == {"M0": False, "M1": False}, line)
        plc("watch", "D0", "--csv", "--json", expect=2)


@check
def an_fx_counts_in_octal():
    path = scratch / "fx.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                    '[[plc]]\nname = "fx"\nfamily = "FX5"\nscan = "1ms"\n')
    with stepped(plant=path) as plant:
        plc = plc_of(plant)
        plc("set", "Y17", "--octal")
        require(plc("read", "YF").stdout.split() == ["YF", "ON"], "Y17 is not 15")
        require(plc("read", "Y17", "--octal").stdout.split() == ["Y17", "ON"], "Y17 is not 15")
        plc("read", "Y18", "--octal", expect=2)
        require(plant.run(until="Y17")["met"] and not plant.run(until="Y16", scans=0)["met"], "a condition counts otherwise")
        plant.run(scans=5)
        require(plc("read", "SD8010", "--format", "dec").stdout.split()[-1] == "10", "the scan time")
