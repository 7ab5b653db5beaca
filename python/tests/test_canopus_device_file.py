"""Device files read and written. The judge of what is written is configparser; what is expected is written out."""
import configparser
import os
import pathlib
import struct

import pytest

pytest.importorskip("canopus._core", reason="the Python module is not built")
import canopus  # noqa: E402
from canopus import DeviceFile, DeviceFileError  # noqa: E402

ROOT = pathlib.Path(__file__).resolve().parents[2]
BLOCK = ROOT / "examples/devices/io-block.eds"
FOREIGN = ROOT.parent / "shared/data/eds"
TYPES = {"a": ("0x0001", "BOOLEAN"), "b": ("0x0003", "INTEGER16"), "c": ("0x0008", "REAL32"), "d": ("0x0009", "VISIBLE_STRING"),
         "e": ("0x000A", "OCTET_STRING"), "f": ("0x000B", "UNICODE_STRING"), "10": ("0x0010", "INTEGER24"),
         "11": ("0x0011", "REAL64"), "12": ("0x001B", "UNSIGNED64"), "13": ("0x000F", "DOMAIN"), "14": ("0x0007", "UNSIGNED32")}
OF_ALL_TYPES = "[FileInfo]\nFileName=types.eds\n[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0\n" + "".join(
    f"[20{int(n, 16):02X}]\nParameterName={t}\nObjectType=7\nDataType={code}\nAccessType=rw\n" for n, (code, t) in TYPES.items())


def sections(path):
    parser = configparser.RawConfigParser(strict=True, delimiters="=", comment_prefixes=";", interpolation=None)
    parser.optionxform = str
    parser.read_string(pathlib.Path(path).read_bytes().decode("latin-1"))
    return parser


def written(tmp_path, value, index):
    file = DeviceFile("types.eds", text=OF_ALL_TYPES).write_dcf(tmp_path / "t.dcf", node=3, values={index: value})
    return file[index], sections(tmp_path / "t.dcf")[f"{index:04X}"]["ParameterValue"]


def test_a_file_says_what_the_device_is():
    file = DeviceFile(BLOCK)
    assert file.device.product_name == "Canopus I/O block" and file.device.product_number == 0x401
    assert file.device.bit_rates == (10_000, 20_000, 50_000, 125_000, 250_000, 500_000, 800_000, 1_000_000)
    assert file.info.eds_version == "4.0" and file.info.creation_date == "01-05-2026"
    assert file.commissioning is None and file.problems == []
    assert "Canopus I/O block" in repr(file)


def test_objects_have_types_access_and_defaults():
    file = DeviceFile(BLOCK)
    entry = file["1018:02"]
    assert (entry.name, entry.type, entry.access, entry.default, entry.bits) == ("Product code", "UNSIGNED32", "ro", 0x401, 32)
    assert str(entry) == "1018:02"
    assert file[0x1018, 2] == entry and file["0x1018:02"] == entry and file["1018H:2"] == entry
    assert file[0x1000].default == 0xF0191
    identity = file.objects[0x1018]
    assert (identity.code, len(identity), list(identity)) == ("RECORD", 5, [0, 1, 2, 3, 4])
    assert identity[1].name == "Vendor-ID"
    assert file["6411:01"].rpdo_mappable and not file["6411:01"].tpdo_mappable and file["6411:01"].type == "INTEGER16"
    assert list(file.objects)[:3] == [0x1000, 0x1001, 0x1003]
    assert "5FFF:00" not in file and file.find("5FFF:00") is None


def test_a_default_may_follow_the_node_id():
    text = OF_ALL_TYPES + "[1014]\nParameterName=COB-ID EMCY\nDataType=7\nAccessType=rw\nDefaultValue=$NODEID+0x80\n"
    file = DeviceFile("x.eds", text=text)
    assert file[0x1014].adds_node_id and file[0x1014].default == 0x80
    assert file.default(0x1014, node=5) == 0x85
    assert not file[0x1000].adds_node_id
    with pytest.raises(ValueError):
        file.default(0x1014, node=128)


def test_pdos_and_what_is_mapped():
    file = DeviceFile(BLOCK)
    first, second = file.tpdos(node=2)
    assert (first.number, first.parameter, first.cob_id, first.valid, first.transmission_type) == (1, 0x1800, 0x182, True, 255)
    assert [(str(entry), bits) for entry, bits in first.mapping] == [("6000:01", 8), ("6000:02", 8)]
    assert (second.cob_id, second.inhibit_time) == (0x282, 0.01)
    assert [pdo.cob_id for pdo in file.rpdos(node=127)] == [0x27F, 0x37F]


def test_limits_are_those_of_the_file():
    text = OF_ALL_TYPES + "[2100]\nParameterName=Speed\nDataType=3\nAccessType=rw\nDefaultValue=5\nLowLimit=-10\nHighLimit=10\n"
    entry = DeviceFile("x.eds", text=text)[0x2100]
    assert (entry.low, entry.high) == (-10, 10)
    assert entry.encode(-10) == b"\xf6\xff"
    for value, words in ((11, "above"), (-11, "below"), (40000, "does not fit INTEGER16"), ("x", "integer"), (1.5, "integer"),
                         (b"\0", "1 byte;")):
        with pytest.raises(DeviceFileError, match=words):
            entry.encode(value)


@pytest.mark.parametrize("index, value, data, text", [
    (0x200A, True, b"\x01", "1"), (0x200B, -2, b"\xfe\xff", "-2"), (0x200C, 1.5, struct.pack("<f", 1.5), "1.5"),
    (0x200D, "drive 7", b"drive 7", "drive 7"), (0x200E, b"\x01\xab", b"\x01\xab", "01AB"), (0x200F, "aé", b"a\0\xe9\0", "a\xc3\xa9"),
    (0x2010, -70000, b"\x90\xee\xfe", "-70000"), (0x2011, 0.1, struct.pack("<d", 0.1), "0.1"),
    (0x2012, 2**64 - 1, b"\xff" * 8, "0xFFFFFFFFFFFFFFFF"), (0x2013, b"\0\x7f", b"\0\x7f", "007F"),
    (0x2014, 300, b"\x2c\x01\0\0", "0x0000012C")], ids=[t for _, t in TYPES.values()])
def test_values_of_each_type(tmp_path, index, value, data, text):
    entry, shown = written(tmp_path, value, index)
    assert shown == text
    assert entry.encode(value) == data and entry.decode(data) == value
    assert entry.default == value and entry.configured


def test_a_dcf_is_the_file_with_a_node_and_values(tmp_path):
    file = DeviceFile(BLOCK)
    before = sections(BLOCK)
    done = file.write_dcf(tmp_path / "two.dcf", node=2, name="press", bit_rate=125_000, values={"1017:00": 500, "1800:05": 20})
    after = sections(tmp_path / "two.dcf")
    assert dict(after["DeviceComissioning"]) == {"NodeID": "2", "NodeName": "press", "Baudrate": "125", "NetNumber": "0",
                                                 "NetworkName": "", "CANopenManager": "0", "LSS_SerialNumber": "0"}
    assert after["1017"]["ParameterValue"] == "0x01F4" and after["1800sub5"]["ParameterValue"] == "0x0014"
    assert after["FileInfo"]["LastEDS"] == "io-block.eds"
    for name in before.sections():
        expected = dict(before[name])
        rest = {key: value for key, value in after[name].items() if key in expected}
        assert rest == expected
    assert done.commissioning.node == 2 and done.commissioning.bit_rate == 125_000 and done.commissioning.node_name == "press"
    assert [str(entry) for each in done.objects.values() for entry in each.values() if entry.configured] == ["1017:00", "1800:05"]


def test_a_dcf_keeps_what_it_says_and_gets_another_node(tmp_path):
    first = DeviceFile(BLOCK).write_dcf(tmp_path / "two.dcf", node=2, values={"1017:00": 500})
    text = (tmp_path / "two.dcf").read_bytes().replace(b"NetNumber=0", b"NetNumber=4")
    first = DeviceFile(tmp_path / "two.dcf", text=text)
    second = first.write_dcf(tmp_path / "three.dcf", node=3, values={"1800:05": 20})
    assert second.commissioning.node == 3 and second.commissioning.net_number == 4 and second.info.last_eds == "io-block.eds"
    assert second["1017:00"].default == 500 and second["1017:00"].configured


def test_every_other_line_stays_as_it_is(tmp_path):
    original = BLOCK.read_bytes().replace(b"\r\n", b"\n").replace(b"\n", b"\r\n")
    file = DeviceFile("x.eds", text=original)
    file.write_eds(tmp_path / "x.eds", {"1017:00": 250})
    old, new = original.split(b"\r\n"), (tmp_path / "x.eds").read_bytes().split(b"\r\n")
    changed = [(a, b) for a, b in zip(old, new) if a != b]
    assert len(old) == len(new) and [b for _, b in changed] == [b"DefaultValue=0x00FA"]
    assert DeviceFile(tmp_path / "x.eds")["1017:00"].default == 250 and not DeviceFile(tmp_path / "x.eds")["1017:00"].configured


def test_lines_may_end_in_different_ways(tmp_path):
    text = OF_ALL_TYPES.replace("\n", "\r\n", 3) + "; a comment\rwith a strange end\n[2100]\nParameterName=Speed\rDataType=5\nAccessType=rw"
    file = DeviceFile("x.eds", text=text)
    file.write_eds(tmp_path / "x.eds", {0x2100: 3})
    assert (tmp_path / "x.eds").read_bytes() == (text + "\r\nDefaultValue=3").encode()
    file.write_dcf(tmp_path / "x.dcf", node=4, values={0x2100: 3})
    written = (tmp_path / "x.dcf").read_bytes()
    head = text.replace("FileName=types.eds\r\n", "FileName=types.eds\r\nLastEDS=x.eds\r\n").encode() + b"\r\nParameterValue=3\r\n"
    assert written.startswith(head + b"\r\n[DeviceComissioning]\r\nNodeID=4\r\n")


def test_sub_indexes_that_stand_in_a_list(tmp_path):
    text = OF_ALL_TYPES + ("[1016]\nParameterName=Consumer heartbeat time\nObjectType=8\nDataType=7\nAccessType=rw\nDefaultValue=0\n"
                           "CompactSubObj=12\n")
    file = DeviceFile("x.eds", text=text)
    done = file.write_dcf(tmp_path / "x.dcf", node=1, values={"1016:02": 0x10064, "1016:0B": 5})
    assert dict(sections(tmp_path / "x.dcf")["1016Value"]) == {"NrOfEntries": "2", "2": "0x00010064", "11": "5"}
    assert [done[0x1016, sub].default for sub in (1, 2, 11, 12)] == [0, 0x10064, 5, 0]
    again = done.write_dcf(tmp_path / "x.dcf", node=1, values={"1016:02": 7})
    assert again["1016:02"].default == 7 and sections(tmp_path / "x.dcf")["1016Value"]["NrOfEntries"] == "2"
    with pytest.raises(DeviceFileError, match="no section of its own"):
        file.write_eds(tmp_path / "y.eds", {"1016:02": 1})


def test_a_cob_id_may_follow_the_node_id(tmp_path):
    done = DeviceFile(BLOCK).write_dcf(tmp_path / "x.dcf", node=9, values={"1800:01": "$NODEID+0x300"})
    assert done.tpdos(node=9)[0].cob_id == 0x309
    with pytest.raises(DeviceFileError, match="NODEID"):
        DeviceFile(BLOCK).write_dcf(tmp_path / "x.dcf", node=9, values={"1800:01": "many"})


@pytest.mark.parametrize("values, words", [({"5FFF:00": 1}, "no object 5FFF:00"), ({"1017:00": 70000}, "does not fit UNSIGNED16"),
                                           ({"1017:00": "\n[1000]"}, "NODEID"), ({"nothing": 1}, "6000:01"),
                                           ({0x200D: "a\nDefaultValue=9"}, "printable"), ({0x200D: " a"}, "cannot be written"),
                                           ({0x200D: '"a"'}, "cannot be written"), ({0x200D: "\x1b[2J"}, "printable")])
def test_what_cannot_be_written_leaves_no_file(tmp_path, values, words):
    file = DeviceFile("types.eds", text=OF_ALL_TYPES + "[1017]\nParameterName=Producer heartbeat time\nDataType=6\nAccessType=rw\n")
    with pytest.raises(DeviceFileError, match=words):
        file.write_dcf(tmp_path / "x.dcf", node=1, values=values)
    assert os.listdir(tmp_path) == []


def test_a_file_in_latin_1_stays_one(tmp_path):
    text = OF_ALL_TYPES.encode() + "; Drehgeber für Öl\n[2100]\nParameterName=Größe\nDataType=5\nAccessType=rw\n".encode("latin-1")
    file = DeviceFile("x.eds", text=text)
    assert file[0x2100].name == "Größe"
    file.write_eds(tmp_path / "x.eds", {0x2100: 3})
    assert (tmp_path / "x.eds").read_bytes() == text.rstrip(b"\n") + b"\nDefaultValue=3\n"
    with pytest.raises(DeviceFileError, match="Latin-1"):
        file.write_dcf(tmp_path / "y.dcf", node=1, name="Ω")


def test_files_that_make_no_sense_are_refused_with_their_line():
    for text in ("", "<?xml version='1.0'?>", "\0" * 1000, "[1"):
        with pytest.raises(DeviceFileError, match=r"^bad\.eds:\d+: "):
            DeviceFile("bad.eds", text=text)
    with pytest.raises(DeviceFileError, match="cannot read"):
        DeviceFile("/nowhere/x.eds")
    with pytest.raises(DeviceFileError, match="cannot read"):
        DeviceFile("x\0.eds")


def test_what_is_repaired_is_said_with_its_line():
    text = OF_ALL_TYPES + "[2100]\nParameterName=Speed\nDataType=5\nAccessType=rw\nDefaultValue=0x1FF\n"
    problem = next(p for p in DeviceFile("x.eds", text=text).problems if "0x1FF" in p.message)
    assert (problem.severity, problem.line) == ("loss", text.count("\n"))


def test_a_plant_takes_what_was_written(tmp_path):
    DeviceFile(BLOCK).write_dcf(tmp_path / "two.dcf", node=2, values={"1008:00": "press 7"})
    text = '[plant]\nname = "x"\n[[bus]]\nname = "a"\nbit_rate = 125_000\n[[device]]\nnode = 2\neds = "two.dcf"\n'
    with canopus.Plant(tmp_path / "plant.toml", text=text) as plant:
        plant.run(1)
        assert plant.sdo_upload(2, 0x1008) == b"press 7"


def foreign():
    return sorted(FOREIGN.rglob("*.[eEdD][dDcC][sSfF]")) if FOREIGN.is_dir() else []


@pytest.mark.skipif(not foreign(), reason=f"{FOREIGN} is absent")
def test_files_of_others_are_read_and_written(tmp_path):
    count = 0
    for path in foreign():
        try:
            file = DeviceFile(path)
        except DeviceFileError:
            continue
        for each in file.objects.values():
            for entry in each.values():
                if entry.bits and entry.low is None and entry.high is None and entry.default == entry.default:
                    assert entry.decode(entry.encode(entry.default)) == entry.default
        entry = file.find(0x1017)
        values = {0x1017: 1234} if entry is not None and entry.type == "UNSIGNED16" and entry.access == "rw" else {}
        done = file.write_dcf(tmp_path / "x.dcf", node=5, values=values)
        assert done.commissioning.node == 5 and list(done.objects) == list(file.objects)
        assert all(done[name].default == value for name, value in values.items())
        count += bool(values)
    assert count >= 10


def test_an_xdd_is_read_and_not_changed(tmp_path):
    text = ('<ISO15745ProfileContainer xmlns:xsi="http://www.w3.org/2001/XMLSchema-instance"><ISO15745Profile>'
            '<ProfileBody xsi:type="ProfileBody_CommunicationNetwork_CANopen"><ApplicationLayers><CANopenObjectList>'
            '<CANopenObject index="2000" name="Speed" objectType="7" dataType="0003" accessType="rw" defaultValue="-5" highLimit="9"/>'
            '</CANopenObjectList></ApplicationLayers></ProfileBody></ISO15745Profile></ISO15745ProfileContainer>')
    file = DeviceFile("x.xdd", text=text)
    assert (file[0x2000].name, file[0x2000].default, file[0x2000].high) == ("Speed", -5, 9)
    with pytest.raises(DeviceFileError, match="eds convert"):
        file.write_dcf(tmp_path / "x.dcf", node=2)
    assert not (tmp_path / "x.dcf").exists()
    assert b"HighLimit=9" in file.plain_text()
