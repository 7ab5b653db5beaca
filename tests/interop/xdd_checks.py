"""XDD and XDC files: what the program writes, judged by xmllint, by the structure of files of other tools, and by readers that
know only CiA 311 (xml.etree) and only CiA 306 (configparser)."""
import configparser
import shutil
import struct
import subprocess
import xml.etree.ElementTree as ET

from kit import DEVICE_FILES, ROOT, Skip, check, program, require, scratch

XSI_TYPE = "{http://www.w3.org/2001/XMLSchema-instance}type"
BITS = {0x02: 8, 0x03: 16, 0x04: 32, 0x05: 8, 0x06: 16, 0x07: 32, 0x10: 24, 0x15: 64, 0x16: 24, 0x1B: 64}
# What an application process calls them.
TYPES = {"BOOL": 1, "SINT": 2, "INT": 3, "DINT": 4, "LINT": 0x15, "USINT": 5, "UINT": 6, "UDINT": 7, "ULINT": 0x1B, "REAL": 8,
         "LREAL": 0x11, "STRING": 9, "WSTRING": 0xB, "BITSTRING": 0xA}
ACCESS = {"read": "ro", "readWrite": "rw", "write": "wo", "const": "const"}


def local(name):
    return name.rsplit("}", 1)[-1]


def child(element, name):
    for found in element if element is not None else ():
        if local(found.tag) == name:
            return found
    return None


def profile(root, kind):
    for body in root.iter():
        if local(body.tag) == "ProfileBody" and body.get(XSI_TYPE, "").rsplit(":", 1)[-1] == f"ProfileBody_{kind}_CANopen":
            return body
    raise AssertionError(f"no profile of kind {kind}")


def plain(value, data_type):
    """A value as something that two spellings of it have in common."""
    text = (value or "").strip()
    if data_type in (0x9, 0xB):
        return text
    if data_type in (0xA, 0xF):
        return text.replace(" ", "").upper()
    node = text.upper().startswith("$NODEID")
    text = text[8:] if node and len(text) > 7 else text
    if data_type in (0x8, 0x11):
        size, form = (4, "f") if data_type == 0x8 else (8, "d")
        if text.lower().startswith("0x"):
            return struct.unpack(f">{form}", int(text, 16).to_bytes(size, "big"))[0]
        return struct.unpack(form, struct.pack(form, float(text or 0)))[0]
    number = int(text or "0", 0)
    return node, number & ((1 << BITS.get(data_type, 64)) - 1)


def read_xdd(path):
    """(index, sub) -> name, type, access, mappable, default, low, high."""
    root = ET.parse(path).getroot()
    objects = {}
    parameters = {}
    try:
        process = child(profile(root, "Device"), "ApplicationProcess")
    except AssertionError:
        process = None
    for parameter in child(process, "parameterList") or ():
        parameters[parameter.get("uniqueID")] = parameter
    listed = child(child(profile(root, "CommunicationNetwork"), "ApplicationLayers"), "CANopenObjectList")

    def take(key, element):
        parameter = parameters.get(element.get("uniqueIDRef"))
        data_type, access, default = element.get("dataType"), element.get("accessType"), element.get("defaultValue")
        if parameter is not None:
            named = [TYPES[local(e.tag)] for e in parameter if local(e.tag) in TYPES]
            data_type = data_type or (f"{named[0]:04X}" if named else None)
            access = access or ACCESS[parameter.get("access", "read")]
            value = child(parameter, "defaultValue")
            default = default or (value.get("value") if value is not None else None)
        number = int(data_type, 16)
        limits = tuple(plain(element.get(n), number) if element.get(n) else None for n in ("lowLimit", "highLimit"))
        objects[key] = (element.get("name"), number, access, element.get("PDOmapping", "no") != "no", plain(default, number), *limits)

    for element in listed:
        index = int(element.get("index"), 16)
        members = [e for e in element if local(e.tag) == "CANopenSubObject"]
        for member in members:
            take((index, int(member.get("subIndex"), 16)), member)
        if not members and element.get("objectType") in ("7", "2"):
            take((index, 0), element)
    return objects


def read_eds(path):
    """The same of an EDS, whose rwr and rww an XDD calls rw."""
    sections = configparser.RawConfigParser(strict=False, delimiters=("=",), comment_prefixes=(";",), inline_comment_prefixes=None)
    sections.read(path, encoding="utf-8")
    objects = {}
    for name in sections.sections():
        index, _, sub = name.lower().partition("sub")
        try:
            key = int(index, 16), int(sub or "0", 16)
        except ValueError:
            continue
        keys = {k.lower(): v for k, v in sections.items(name)}
        if key[0] < 0x1000 or len(index) != 4 or "datatype" not in keys:
            continue
        number = int(keys["datatype"], 0)
        limits = tuple(plain(keys[n], number) if keys.get(n) else None for n in ("lowlimit", "highlimit"))
        access = keys["accesstype"].lower()
        objects[key] = (keys["parametername"], number, "rw" if access in ("rwr", "rww") else access,
                        keys.get("pdomapping", "0") == "1", plain(keys.get("defaultvalue"), number), *limits)
    return objects


def convert(source, target):
    done = subprocess.run([program, "eds", "convert", str(source), str(target)], capture_output=True, text=True, timeout=60)
    require(done.returncode == 0, f"{source}: exit code {done.returncode}: {done.stderr}")
    return done.stderr


def without_mapped_octets(objects):
    """2100H of the demo device: an octet string is in no PDO, whatever the file says."""
    objects[(0x2100, 0)] = (*objects[(0x2100, 0)][:3], False, *objects[(0x2100, 0)][4:])


def same(written, expected, what):
    require(written.keys() == expected.keys(), f"{what}: {sorted(written.keys() ^ expected.keys())}")
    for key, object_ in expected.items():
        index, sub = key
        require(written[key] == object_, f"{what}: {index:04X}H:{sub:02X}: {written[key]}, expected {object_}")


def device_file(name):
    path = DEVICE_FILES / name
    if not path.exists():
        raise Skip(f"{path} is not there")
    return path


@check
def xdd_of_an_eds_says_what_the_eds_says():
    for source in sorted((ROOT / "examples" / "devices").glob("*.eds")):
        target = scratch / (source.stem + ".xdd")
        convert(source, target)
        expected = read_eds(source)
        written = read_xdd(target)
        same_keys = expected.keys() & written.keys()
        require(len(same_keys) > 10, f"{source.name}: {len(same_keys)} objects")
        for key in same_keys:  # beside the values, which the EDS may leave to the reader
            require(written[key][:4] == expected[key][:4], f"{source.name} {key}: {written[key]}, expected {expected[key]}")


@check
def xdd_of_a_foreign_eds_and_back_keeps_every_value():
    source = device_file("canopennode_demo-device.eds")
    target = scratch / "demo.xdd"
    back = scratch / "demo.eds"
    convert(source, target)
    convert(target, back)
    expected = read_eds(source)
    without_mapped_octets(expected)
    same(read_xdd(target), expected, "XDD")
    same(read_eds(back), expected, "EDS")


@check
def eds_of_a_foreign_xdd_says_what_the_xdd_says():
    source = device_file("canopennode_demo-device.xdd")
    target = scratch / "demo2.eds"
    warnings = convert(source, target)
    require("ApplicationProcess" in warnings, warnings)
    expected = read_xdd(source)
    without_mapped_octets(expected)
    same(read_eds(target), expected, "EDS")


@check
def xdd_is_well_formed_and_built_like_those_of_other_tools():
    if shutil.which("xmllint") is None:
        raise Skip("xmllint is not installed")
    known = {}  # element -> its children and attributes in files of other tools
    for name in ("canopennode_demo-device.xdd", "edsdcfnet_sample-device.xdd"):
        for element in ET.parse(device_file(name)).getroot().iter():
            entry = known.setdefault(local(element.tag), (set(), set()))
            entry[0].update(local(e.tag) for e in element)
            entry[1].update(local(a) for a in element.attrib)
    # What CiA 311 has besides and those two files have not.
    known["CANopenObject"][1].update({"lowLimit", "highLimit", "objFlags", "actualValue", "denotation"})
    known["CANopenSubObject"][1].update({"lowLimit", "highLimit", "objFlags", "actualValue", "denotation"})
    known["NetworkManagement"][0].add("deviceCommissioning")
    known["deviceCommissioning"] = (set(), {"nodeID", "nodeName", "actualBaudRate", "networkNumber", "networkName", "CANopenManager"})
    known["ISO15745ProfileContainer"][1].add("schemaLocation")
    known["DeviceIdentity"][0].add("orderNumber")
    known["orderNumber"] = (set(), set())
    for name in ("canopennode_demo-device.eds", "delta_asda-a3.eds", "elmo_gold-drive.dcf", "edsdcfnet_modular-device.dcf"):
        source = device_file(name)
        target = scratch / (source.stem + ".xdc")
        convert(source, target)
        done = subprocess.run(["xmllint", "--noout", "--nonet", str(target)], capture_output=True, text=True, timeout=60)
        require(done.returncode == 0 and done.stderr == "", done.stderr)
        for element in ET.parse(target).getroot().iter():
            tag = local(element.tag)
            require(tag in known, f"{name}: <{tag}> is in no file of another tool")
            children, attributes = known[tag]
            for inner in element:
                require(local(inner.tag) in children, f"{name}: <{local(inner.tag)}> in <{tag}>")
            for attribute in element.attrib:
                require(local(attribute) in attributes, f"{name}: {attribute} of <{tag}>")


@check
def device_of_a_plant_may_be_an_xdd_or_an_xdc():
    xdd = device_file("canopennode_demo-device.xdd")
    xdc = scratch / "station.xdc"
    done = subprocess.run([program, "eds", "convert", str(ROOT / "examples/devices/io-block.eds"), str(xdc)], capture_output=True)
    require(done.returncode == 0, done.stderr)
    plant, trace = scratch / "xdd.toml", scratch / "xdd.log"
    plant.write_text(f'[plant]\nname = "x"\n[[bus]]\nname = "a"\nbit_rate = 250_000\n[[device]]\nnode = 5\neds = "{xdd}"\n'
                     f'[[device]]\nnode = 6\neds = "{xdc}"\nobjects = {{ "1017:00" = 100 }}\n')
    done = subprocess.run([program, "run", str(plant), "--virtual", "--for", "1s", "--trace", str(trace)], capture_output=True, text=True)
    require(done.returncode == 0, done.stderr)
    frames = [line.split()[-1] for line in trace.read_text().splitlines()]
    require("705#00" in frames and "706#00" in frames, f"no boot-up of both: {frames[:5]}")
    require(frames.count("706#7F") >= 5, f"no heartbeats of the XDC: {frames[:9]}")
