"""SDO answers as some devices give them: without the number of bytes (42H), with too many of them (43H), of 7 bytes; read by the
commands that know the type of an object."""
import contextlib

from endless_peer_checks import server_that, socketcand_bytes
from kit import ANSWER, check, command, program, require, scratch

EDS = """[FileInfo]
FileName=n60.eds
FileVersion=1
FileRevision=1
EDSVersion=4.0
[DeviceInfo]
VendorName=Example
VendorNumber=0x123
ProductName=N60
ProductNumber=1
RevisionNumber=1
BaudRate_500=1
SimpleBootUpSlave=1
Granularity=8
NrOfRXPDO=0
NrOfTXPDO=0
LSS_Supported=0
[MandatoryObjects]
SupportedObjects=3
1=0x1000
2=0x1001
3=0x1018
[OptionalObjects]
SupportedObjects=1
1=0x6041
[ManufacturerObjects]
SupportedObjects=1
1=0x2000
[1000]
ParameterName=Device type
DataType=0x0007
AccessType=ro
DefaultValue=0x00020192
[1001]
ParameterName=Error register
DataType=0x0005
AccessType=ro
[1018]
ParameterName=Identity
ObjectType=0x9
SubNumber=4
[1018sub0]
ParameterName=Number of entries
DataType=0x0005
AccessType=ro
DefaultValue=3
[1018sub1]
ParameterName=Vendor
DataType=0x0007
AccessType=ro
DefaultValue=0x123
[1018sub2]
ParameterName=Product
DataType=0x0007
AccessType=ro
DefaultValue=1
[1018sub3]
ParameterName=Revision
DataType=0x0007
AccessType=ro
DefaultValue=1
[2000]
ParameterName=Level
DataType=0x0006
AccessType=rw
DefaultValue=0
[6041]
ParameterName=Statusword
DataType=0x0006
AccessType=ro
"""

ANSWERS = {  # the bytes before and behind index and sub-index
    (0x1000, 0): ("43", "92010200"), (0x1018, 1): ("43", "23010000"), (0x1018, 2): ("43", "01000000"),
    (0x1018, 3): ("43", "01000000"), (0x2000, 0): ("42", "34120000"), (0x2008, 0): ("43", "920102"),
    (0x2009, 0): ("43", "34120000"), (0x200A, 0): ("43", "34120001"), (0x6041, 0): ("42", "37068899"),
}


def node_60(connection):
    """Answers each upload once, as ANSWERS has it; every other request with an abort."""
    socketcand_bytes(connection)
    said = b""
    while part := connection.recv(4096):
        said += part
        while b">" in said:
            element, said = said.split(b">", 1)
            words = element.split()
            if words[1:3] != [b"send", b"63C"]:
                continue
            request = bytes(int(byte, 16) for byte in words[4:])
            first, rest = ANSWERS.get((request[1] | request[2] << 8, request[3]), ("80", "00000206"))
            if request[0] == 0x40:
                answer = bytes.fromhex(first) + request[1:4] + bytes.fromhex(rest)
                connection.sendall(f"< frame 5BC 1.000000 {answer.hex().upper()} >".encode())


@contextlib.contextmanager
def bus_of_node_60():
    with server_that(node_60) as port:
        yield f"socketcand:127.0.0.1:{port}"


def sdo(*words, **options):
    with bus_of_node_60() as bus:
        return command(program, "sdo", "read", "60", *words, "--bus", bus, "--timeout", ANSWER, **options)


@check
def a_value_without_its_size_has_the_bytes_of_its_type():
    file = scratch / "n60.eds"
    file.write_text(EDS)
    done = sdo("2000", "--type", "u16")
    require((done.stdout, done.stderr) == ("2000:00  4660  1234H\n", ""), done)
    require(sdo("Level", "--eds", file).stdout == "2000:00 Level  4660  1234H\n", "by the device file")
    words = "operation enabled (ready to switch on, switched on, voltage enabled, quick stop, remote, target reached)"
    require(sdo("0x6041", "--eds", file).stdout == f"6041:00 Statusword  1591  0637H  {words}\n", "in words")
    done = sdo("2000")
    require(done.stdout == "2000:00  34 12 00 00  4660  00001234H\n", done)
    require("did not indicate how many of the 4 bytes are the value" in done.stderr, done)


@check
def four_bytes_of_a_shorter_type_are_a_warning_or_an_error():
    done = sdo("2009", "--type", "u16")
    require(done.stdout == "2009:00  4660  1234H\n" and "4 bytes came, u16 has 2: the others are 0" in done.stderr, done)
    done = sdo("200A", "--type", "u16", expect=1)
    require("4 bytes came (34 12 00 01), u16 has 2" in done.stderr, done)


@check
def an_answer_of_7_bytes_is_an_error_that_names_it():
    done = sdo("2008", "--type", "u32", expect=1)
    require(done.stderr == "canopus: node 60, 2008:00: its answer has 7 bytes, expected 8: 43 08 20 00 92 01 02\n", done)


@check
def a_project_that_has_the_value_of_the_device_is_the_same():
    file, project = scratch / "n60.eds", scratch / "sizes"
    file.write_text(EDS)
    command(program, "project", "new", project)
    command(program, "project", "add", project, file, "--node-id", "60", "--name", "n60")
    command(program, "project", "set", project, "n60", "2000=4660")
    with bus_of_node_60() as bus:
        command(program, "project", "diff", project, "--bus", bus, "--timeout", ANSWER)
