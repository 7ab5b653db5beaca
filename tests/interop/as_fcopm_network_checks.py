"""Checks of the AS-FCOPM on the bus: a CANopen stack that is not ours is its slave, and its master. Modbus TCP is its PLC."""
from as_fcopm_checks import SR, card_plant, ended, hands, modbus_serial
from kit import (HERE, PATIENCE, RawClient, check, command, covers, host_port, node_modules, program, require, running, scratch,
                 talking, until)
from module_checks import in_order


def parameters(index, kind, mapped):
    """A PDO of an EDS file: `mapped` words from an object on, which stay mapped."""
    record = f"[{index:X}]\nParameterName={kind}\nObjectType=9\nSubNumber=3\n"
    sub = lambda number, name, data_type, access: (f"[{index:X}sub{number}]\nParameterName={name}\nDataType={data_type}\n"
                                                   f"AccessType={access}\n")
    mapping = f"[{index + 0x200:X}]\nParameterName={kind} mapping\nObjectType=9\nSubNumber=5\n"
    mapping += f"[{index + 0x200:X}sub0]\nParameterName=Objects\nDataType=5\nAccessType=const\nDefaultValue=4\n"
    for i in range(4):
        mapping += (f"[{index + 0x200:X}sub{i + 1}]\nParameterName=Object {i + 1}\nDataType=7\nAccessType=const\n"
                    f"DefaultValue=0x{mapped + i:04X}0010\n")
    return (record + sub(0, "Entries", 5, "const") + "DefaultValue=2\n" + sub(1, "COB-ID", 7, "rw")
            + f"DefaultValue=$NODEID+0x{0x200 if index < 0x1800 else 0x180:X}\n" + sub(2, "Type", 5, "rw") + "DefaultValue=254\n"
            + mapping)


def npm_slave_eds():
    """nmt_slave_peer.mjs, as far as the card has to know it."""
    words = [*range(0x2100, 0x2104), *range(0x2200, 0x2204), 0x2003]
    entry = lambda index: (f"[{index:X}]\nParameterName=Word {index:X}\nDataType=6\nAccessType=rw\nDefaultValue=0\n"
                           "PDOMapping=1\n")
    optional = [0x1017, 0x1400, 0x1600, 0x1800, 0x1A00]
    listed = lambda title, objects: (f"[{title}]\nSupportedObjects={len(objects)}\n"
                                     + "".join(f"{i + 1}=0x{index:X}\n" for i, index in enumerate(objects)))
    return ("[FileInfo]\nFileName=npm.eds\n[DeviceInfo]\nVendorName=npm canopen\nBaudRate_1000=1\nNrOfRXPDO=1\nNrOfTXPDO=1\n"
            + listed("MandatoryObjects", [0x1000, 0x1001, 0x1018])
            + "[1000]\nParameterName=Device type\nDataType=7\nAccessType=ro\nDefaultValue=0\n"
            "[1001]\nParameterName=Error register\nDataType=5\nAccessType=ro\n"
            "[1018]\nParameterName=Identity\nObjectType=9\nSubNumber=3\n"
            "[1018sub0]\nParameterName=Entries\nDataType=5\nAccessType=const\nDefaultValue=2\n"
            "[1018sub1]\nParameterName=Vendor-ID\nDataType=7\nAccessType=ro\nDefaultValue=0x319\n"
            "[1018sub2]\nParameterName=Product code\nDataType=7\nAccessType=ro\nDefaultValue=0x1234\n"
            + listed("OptionalObjects", optional)
            + "[1017]\nParameterName=Producer heartbeat time\nDataType=6\nAccessType=rw\nDefaultValue=0\n"
            + parameters(0x1400, "RxPDO1", 0x2100) + parameters(0x1800, "TxPDO1", 0x2200)
            + listed("ManufacturerObjects", words) + "".join(entry(index) for index in words))


@check
@covers("ASF-GEN-001 ASF-PDO-005 ASF-SDO-006 ASF-HB-002 ASF-HB-003 ASF-SRN-001 ASF-SRN-008 ASF-EMCYREQ-002 "
        "ASF-EMCY-005 ASF-TOOL-006 ASF-TOOL-007")
def npm_canopen_is_a_slave_of_the_as_fcopm():
    """Identity, PDO parameters, heartbeat, auto SDO, start, PDOs each way, an emergency; killed, it is lost, and booted again."""
    node_modules()
    client = modbus_serial()
    eds = scratch / "as-fcopm-npm.eds"
    eds.write_text(npm_slave_eds())
    objects = lambda first: ", ".join(f'"{index:04X}:00"' for index in range(first, first + 4))
    path = card_plant("npm-slave", "\n".join([
        "[[plc.module.download.slave]]", "node = 5", f'eds = "{eds}"', 'heartbeat = "200ms"', 'heartbeat_time_out = "5s"',
        f"rx_pdo = [{{ number = 1, objects = [{objects(0x2100)}] }}]",
        f"tx_pdo = [{{ number = 1, type = 254, objects = [{objects(0x2200)}] }}]",
        'auto_sdo = [{ object = "2003:00", value = 777 }]']), card="node = 1")
    with running(path, has_plc=False) as plant:
        slave = lambda: talking("node", HERE / "nmt_slave_peer.mjs", *host_port(plant.socketcand), "line1", "5")
        with hands(client, plant) as plc:
            plc.become(SR + 834, "00E6")                                # it is not there yet

            def booted(peer):
                peer.wait_line(lambda line: line.startswith("ready"))
                peer.wait_line(lambda line: line == "written 2003 777")
                peer.wait_line(lambda line: line == "state OPERATIONAL")
                plc.become(SR + 834, "0000")
                require(plc.read(SR + 826, 4) == "0000 0000 0000 0000", "a node is abnormal")

            def exchanged(peer, words, said, answer):
                plc.write(25032, words)
                peer.wait_line(lambda line: line == f"received {said}")
                plc.become(24032, answer)

            with slave() as peer:
                booted(peer)
                exchanged(peer, "0001 0002 0003 0004", "1 2 3 4", "FFFE FFFD FFFC FFFB")
                exchanged(peer, "FFFF 1234 0000 8000", "65535 4660 0 32768", "0000 EDCB FFFF 7FFF")
                exchanged(peer, "0E00 0000 0000 0000", "3584 0 0 0", "F1FF FFFF FFFF FFFF")
                plc.become(SR + 834, "00E0")                            # its emergency message
                plc.ask("0101 0000 0405 0000", "0101 002A 0405 0101 5000")
                require(plc.read(24006, 2) == "0302 0504", plc.read(24004, 4))
                plc.ask("0201 0004 0105 2003 0000 0000 0000", "0201 0006 4B05 2003 0000 0309 0000")
                plc.ask("0301 0008 0205 1018 0001 0000 0000", "030A 0008 8005 1018 0001 0002 0601")
                peer.process.kill()
                plc.become(SR + 834, "00E7")
                require(plc.read(SR + 826) == "0010", "SR826 has another node than 5")
            with slave() as peer:
                booted(peer)
                exchanged(peer, "0005 0006 0007 0008", "5 6 7 8", "FFFA FFF9 FFF8 FFF7")
        frames = ended(plant)
    # The card asks a missing slave for 1000H again and again: a question of that kind may come just before its boot-up message.
    require(len([frame for frame in frames if frame == (0x705, b"\0")]) == 2, "the slave did not boot twice")
    boot = [(0x605, "40 00 10 00 00 00 00 00"), (0x605, "40 18 10 01 00 00 00 00"),
            (0x585, "42 18 10 01 19 03 00 00"),
            (0x605, "23 00 14 01 05 02 00 80"), (0x605, "2F 00 14 02 FF 00 00 00"), (0x605, "23 00 14 01 05 02 00 00"),
            (0x605, "23 00 18 01 85 01 00 80"), (0x605, "2F 00 18 02 FE 00 00 00"), (0x605, "23 00 18 01 85 01 00 00"),
            (0x605, "2B 17 10 00 C8 00 00 00"), (0x605, "2B 03 20 00 09 03 00 00"), (0x000, "01 05")]
    in_order(frames, [*boot, (0x205, "01 00 02 00 03 00 04 00"), (0x185, "FE FF FD FF FC FF FB FF"),
                      (0x205, "FF FF 34 12 00 00 00 80"), (0x205, "00 0E 00 00 00 00 00 00"), *boot,
                      (0x205, "05 00 06 00 07 00 08 00"), (0x185, "FA FF F9 FF F8 FF F7 FF")])


@check
@covers("ASF-GEN-001 ASF-GEN-008 ASF-SLV-001 ASF-SLV-003 ASF-SLV-004 ASF-OD-001 ASF-OD-002 ASF-OD-003 ASF-OD-004 ASF-OD-005 "
        "ASF-OD-007 ASF-HB-005 ASF-HB-006 ASF-SYNC-003 ASF-NMT-003 ASF-SRS-002 ASF-SRS-004 ASF-SRS-005 ASF-EMCY-001 ASF-EMCY-002")
def npm_canopen_is_the_master_of_an_as_fcopm():
    """And takes its EDS file."""
    node_modules()
    client = modbus_serial()
    eds = scratch / "as-fcopm.eds"
    command(program, "module", "eds", "as-fcopm", "-o", eds)
    checked = command(program, "eds", "check", eds).stdout
    require("accepted, 0 warnings:" in checked and checked.count("\n") == 1, checked)
    with running(card_plant("npm-master", 'work_mode = "slave"\n', card="node = 5"), has_plc=False) as plant:
        bus = lambda: [*host_port(plant.socketcand), "line1"]
        with hands(client, plant) as plc:
            plc.become(SR + 825, "00A1")                                # Pre-operational
            command("node", HERE / "sdo_client_peer.mjs", *bus(), "5",
                    "upload,1000:0,u32,0", "upload,1001:0,u8,0", "upload,1005:0,u32,128", "upload,1008:0,text,AS300 Series PLC",
                    "upload,1014:0,u32,133", "upload,1016:1,u32,0", "upload,1017:0,u16,0", "upload,1018:0,u8,3",
                    "upload,1018:1,u32,477", "upload,1018:2,u32,85", "upload,1018:3,u32,65538", "abort-upload,1018:4,06090011",
                    "upload,1400:1,u32,517", "upload,1400:2,u8,255", "upload,1400:3,u16,0",
                    "upload,1600:0,u8,4", "upload,1600:1,u32,536871184", "upload,1401:1,u32,2147483648",
                    "upload,1800:1,u32,389", "upload,1800:2,u8,255", "upload,1800:3,u16,50", "upload,1800:5,u16,100",
                    "upload,1A00:4,u32,536937488", "upload,1A07:0,u8,0", "abort-upload,1408:1,06020000",
                    "abort-download,1014:0,u32,134,06010002", "abort-download,1000:0,u32,1,06010002",
                    "abort-upload,100C:0,06020000",
                    *(f"eds,{eds},{object}" for object in ("1000:0", "1008:0", "1018:1", "1018:2", "1018:3", "1800:3", "1A00:4")),
                    # RPDO2 and TPDO2: one word each, with each SYNC
                    "download,1401:2,u8,1", "download,1601:1,u32,536872208", "download,1601:0,u8,1", "download,1401:1,u32,773",
                    "download,1801:2,u8,1", "download,1A01:1,u32,536937744", "download,1A01:0,u8,1", "download,1801:1,u32,645",
                    "download,1800:5,u16,0", "abort-download,1800:3,u16,0,06090030", "download,1800:1,u32,2147484037",
                    "download,1800:3,u16,0", "download,1800:1,u32,389", "download,1017:0,u16,100", "download,1016:1,u32,8193000")
            # The PLC's program: D25032 = D24032 + 1, D25036 = D24036 inverted.
            steps = ["wait-state,5,7F", "nmt,start,5", "wait-state,5,5",
                     "pdo,205,u16+u16+u16+u16,4660+1+65535+32768", "wait-pdo,185,u16+u16+u16+u16,4661+0+0+43981",
                     "pdo,205,u16+u16+u16+u16,65535+0+0+0", "wait-pdo,185,u16+u16+u16+u16,0+0+0+43981",
                     "pdo,305,u16,255", "pause,300", "sync-on,50", "wait-pdo,285,u16,65280", "pdo,305,u16,43690",
                     "wait-pdo,285,u16,21845", "sync-off", "ready", "stay"]
            plc.write(25035, "ABCD")
            with talking("node", HERE / "services_peer.mjs", *bus(), *steps) as peer:
                def programmed():
                    received = [int(word, 16) for word in plc.read(24032, 5).split()]
                    plc.write(25032, f"{(received[0] + 1) & 0xFFFF:04X}")
                    plc.write(25036, f"{received[4] ^ 0xFFFF:04X}")
                    require(peer.process.poll() is None, "\n".join(peer.said))
                    return "ready" in peer.said
                until(programmed, "the peer is not done with its steps", 5 * PATIENCE)
                require(plc.read(SR + 825) == "0000", "SR825 is not 0 in Operational")
                require(plc.read(24032, 5) == "FFFF 0000 0000 0000 AAAA", plc.read(24032, 5))
                peer.process.stdin.close()
                peer.require_end()
            # The master's heartbeat, node 125, once, then no more: the card leaves Operational.
            raw = RawClient(plant)
            with raw.socket:
                raw.send(0x77D, b"\x05")
                plc.become(SR + 825, "00B0")
                command("node", HERE / "sdo_client_peer.mjs", *bus(), "5", "upload,1001:0,u8,1", "download,1016:1,u32,0")
                plc.become(SR + 825, "00A1")
                command("node", HERE / "services_peer.mjs", *bus(), "nmt,start,5", "wait-state,5,5")
                # a PDO that is too short
                raw.send(0x205, bytes.fromhex("11 22 33 44"))
                plc.become(SR + 825, "00B1")
                require(plc.read(24032) == "FFFF", "a PDO that is too short was taken")
                raw.send(0x205, bytes.fromhex("AA BB CC DD 01 02 03 04"))
                plc.become(24032, "BBAA DDCC 0201 0403")
                plc.become(SR + 825, "0000")
            command("node", HERE / "services_peer.mjs", *bus(), "nmt,preop,5", "wait-state,5,7F", "nmt,stop,5", "wait-state,5,4",
                    "nmt,reset,5")
            plc.become(SR + 825, "00A1")
            require(plc.read(25035) == "ABCD", "the program's words are gone")
            command("node", HERE / "sdo_client_peer.mjs", *bus(), "5", "upload,1017:0,u16,0", "upload,1801:1,u32,2147483648",
                    "upload,1800:5,u16,100", "upload,2001:4,u16,43981")
        frames = ended(plant)
    # The stack sends a PDO for each value that it sets: the program may answer before the last of them is there.
    in_order(frames, [
        (0x000, "01 05"), (0x205, "34 12 00 00 00 00 00 00"), (0x185, "35 12 00 00 00 00 CD AB"),
        (0x205, "FF FF 01 00 FF FF 00 80"), (0x185, "00 00 00 00 00 00 CD AB"), (0x305, "FF 00")])
    in_order(frames, [
        (0x705, "00"), (0x605, "40 00 10 00 00 00 00 00"), (0x585, "43 00 10 00 00 00 00 00"), (0x705, "7F"), (0x000, "01 05"),
        (0x205, "34 12 01 00 FF FF 00 80"), (0x305, "FF 00"), (0x080, ""), (0x285, "00 FF"),
        (0x205, "11 22 33 44"), (0x000, "80 05"), (0x000, "02 05"), (0x705, "04"), (0x000, "81 05"), (0x705, "00")])
    emergencies = [data[:3].hex(" ") for identifier, data in frames if identifier == 0x085]
    require(emergencies == ["30 81 01", "00 00 00", "10 82 01", "00 00 00"], f"emergency messages of the card: {emergencies}")
