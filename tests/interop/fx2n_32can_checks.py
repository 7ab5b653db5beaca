"""Checks of the FX2N-32CAN: a stack that is not ours configures it, and an FX3U-CAN takes its place in a network."""
import re

from fx3u_can_checks import fx3_plant
from kit import HERE, ROOT, check, command, host_port, node_modules, program, require, running, scratch, talking, until
from module_checks import Plc, in_order, recorded


@check
def npm_canopen_configures_an_fx2n_32can_as_its_slave():
    """And takes its EDS file."""
    node_modules()
    eds = scratch / "fx2n-32can.eds"
    command(program, "module", "eds", "fx2n-32can", "-o", eds)
    done = command(program, "eds", "check", eds)
    checked = (done.stdout + done.stderr).splitlines()  # CiA 301 V3 had no 1018H
    require(len(checked) == 2 and any("accepted, 1 warning:" in line for line in checked)
            and any("mandatory object 1018H" in line for line in checked), "\n".join(checked))
    path = fx3_plant("fx2n-32can-slave", 'node = 5\nbuffer = { G26 = 0 }\n')
    path.write_text(path.read_text().replace("FX3U-CAN", "FX2N-32CAN"))
    with running(path) as plant:
        plant.wait(lambda e: e["event"] == "nmt" and e["node"] == 5 and e["state"] == "pre-operational")
        bus = [*host_port(plant.socketcand), "line1"]
        command("node", HERE / "sdo_client_peer.mjs", *bus, "5",
                "upload,1000:0,u32,405", "upload,1001:0,u8,0", "upload,1004:0,u32,1966110", "upload,100B:0,u32,5",
                "abort-upload,1017:0,06020000", "abort-upload,1016:0,06020000",
                "upload,1400:1,u32,517", "upload,1401:1,u32,773", "upload,1600:0,u8,4", "upload,1600:1,u32,2776629520",
                "upload,1800:1,u32,389", "upload,1A00:4,u32,2701132816",
                *(f"eds,{eds},{entry}" for entry in ("1000:0", "1004:0", "1600:1", "1A00:4")),
                "download,100C:0,u16,100", "download,100D:0,u8,3",
                "abort-download,1800:3,u16,50,06090030",  # while the PDO is valid
                "download,1800:1,u32,2147484037", "download,1800:2,u8,254", "download,1800:3,u16,50", "download,1800:1,u32,389",
                "abort-download,1000:0,u32,1,06010002", "abort-upload,141E:1,06020000")
        host, port = host_port(plant.mc)
        # The peer stays: a module alone on its bus is acknowledged by nobody.
        with (talking("node", HERE / "services_peer.mjs", *bus, "nmt,start,5", "pause,200",
                      "pdo,205,u16+u16+u16+u16,4660+1+65535+32768", "wait-pdo,185,u16+u16+u16+u16,48879+2+3+4", "stay") as peer,
              Plc(host, int(port)) as plc):
            words = plc.g[0]
            until(lambda: words[25] & 1, "the peer did not start the node")
            words[0:4] = [0xBEEF, 2, 3, 4]

            def exchanged():
                require(peer.process.poll() is None, "\n".join(peer.said))
                words[20] = 1
                return words[0:4] == [0x1234, 1, 0xFFFF, 0x8000]
            until(exchanged, "#0 to #3 are not what the peer sent")

            def heard():  # when it listens for it
                words[0:4] = [0xBEEF, 2, 3, 5]
                words[20] = 1
                words[0:4] = [0xBEEF, 2, 3, 4]
                words[20] = 1
                return any("PDO 185H" in line for line in peer.said)
            until(heard, "the peer did not hear TPDO1")
            peer.process.stdin.close()
            peer.require_end()
        code, errors = plant.stop()
        require(code == 0, errors)
        in_order(recorded(plant.trace), [(0x000, "01 05"), (0x205, "34 12 01 00 FF FF 00 80"),
                                         (0x185, "EF BE 02 00 03 00 04 00")])


@check
def an_fx3u_can_takes_the_place_of_an_fx2n_32can():
    """Node 3 of three in mode A: the other two see the same frames, and their programs the same words."""
    text = (ROOT / "examples/fx2n-32can/plant.toml").read_text()
    text = re.sub(r"127\.0\.0\.1:\d+", "127.0.0.1:0", text)
    begin = text.index('name = "node3"')
    networks = {"FX2N-32CAN": text,
                "FX3U-CAN": text[:begin] + text[begin:].replace("FX2N-32CAN", "FX3U-CAN").replace("G0 = 3000", "G11000 = 3000")}
    seen = {}
    for model, plant_text in networks.items():
        path = scratch / f"place-of-{model}.toml"
        path.write_text(plant_text.replace('position = 7\n', 'position = 7\nbuffer = { G26 = 0 }\n').replace(
            'position = 0\n', 'position = 0\nbuffer = { G26 = 0 }\n'))
        with running(path) as plant:
            ports = [plant.wait(lambda e, name=name: e["event"] == "listen" and e["protocol"] == "MC protocol" and e["of"] == name)["address"]
                     for name in ("plc1", "plc2", "plc3")]
            plant.wait(lambda e: e["event"] == "nmt" and e["bus"] == "field" and e["node"] == 3 and e["state"] == "operational")
            plcs = [Plc(host, int(port)) for host, port in map(host_port, ports)]
            first, second, third = plcs[0].g[0], plcs[1].g[0], plcs[2].g[7]
            received, sent = (10000, 11000) if model == "FX3U-CAN" else (0, 0)
            until(lambda: first[112] == 3000, "node 1 does not see #0 of node 3")
            first[0:2] = [0x1111, 0x2222]
            second[0] = 0x3333
            third[sent:sent + 2] = [0x4444, 0x5555]
            until(lambda: first[112:114] == [0x4444, 0x5555] and second[112:114] == [0x4444, 0x5555], "words of node 3")
            until(lambda: third[received:received + 2] == [0x1111, 0x2222] and second[0] == 0x1111, "words of node 1")
            until(lambda: third[received + 16] == 0x3333 and first[16] == 0x3333, "words of node 2")
            for plc in plcs:
                plc.close()
            code, errors = plant.stop()
            require(code == 0, errors)
            seen[model] = [data for identifier, data in recorded(plant.trace) if identifier == 0x183][-1]
    require(seen["FX2N-32CAN"] == seen["FX3U-CAN"], str(seen))
