"""The ports of a PLC: 1E frames, UDP and Modbus TCP, judged by clients that are not ours and by bare sockets."""
import pathlib
import shutil
import subprocess
import sys

from kit import HERE, PYTHON, Skip, check, command, first_plant_file, host_port, node_modules, program, require, running, scratch


def with_ports():
    """The first plant with a port for each frame and transport, and one for Modbus TCP."""
    text = first_plant_file().read_text()
    ports = ('[[plc.port]]\nlisten = "127.0.0.1:0"\nframe = "1E"\n'
             '[[plc.port]]\nlisten = "127.0.0.1:0"\ntransport = "udp"\nframe = "any"\n'
             '[[plc.modbus]]\nlisten = "127.0.0.1:0"\n'
             '[[plc.modbus]]\nlisten = "127.0.0.1:0"\nframing = "rtu"\n')
    path = scratch / "with-ports.toml"
    path.write_text(text + ports)
    return running(path, operational=[1])


def port_of(plant, protocol):
    return host_port(plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == protocol)["address"])


@check
def python_speaks_1e_and_udp_byte_by_byte():
    with with_ports() as plant:
        host, tcp = port_of(plant, "MC protocol 1E")
        _, udp = port_of(plant, "MC protocol UDP")
        command(sys.executable, HERE / "plc_1e.py", host, tcp, udp)


@check
def npm_mcprotocol_speaks_1e():
    node_modules()
    with with_ports() as plant:
        for code in ("binary", "ascii"):
            command("node", HERE / "mcprotocol_1e.js", *port_of(plant, "MC protocol 1E"), code)


@check
def python_speaks_modbus_byte_by_byte():
    with with_ports() as plant:
        command(sys.executable, HERE / "modbus_raw.py", *port_of(plant, "Modbus TCP"))


@check
def npm_modbus_serial_and_jsmodbus_read_and_write():
    node_modules()
    with with_ports() as plant:
        for client in ("modbus-serial", "jsmodbus"):
            command("node", HERE / "modbus_clients.js", *port_of(plant, "Modbus TCP"), client)


@check
def npm_modbus_serial_speaks_rtu_over_tcp():
    node_modules()
    with with_ports() as plant:
        command("node", HERE / "modbus_clients.js", *port_of(plant, "Modbus RTU"), "modbus-serial-rtu")


@check
def pymodbus_reads_and_writes():
    if subprocess.run([PYTHON, "-c", "import pymodbus"], capture_output=True).returncode != 0:
        raise Skip("python3-pymodbus is not installed")
    with with_ports() as plant:
        command(PYTHON, HERE / "modbus_pymodbus.py", *port_of(plant, "Modbus TCP"))


@check
def libmodbus_reads_and_writes():
    if not shutil.which("gcc") or not pathlib.Path("/usr/include/modbus/modbus.h").is_file():
        raise Skip("libmodbus-dev is not installed")
    client = scratch / "modbus_libmodbus"
    command("gcc", "-Wall", "-Wextra", "-Werror", "-O1", HERE / "modbus_libmodbus.c", "-o", client, "-lmodbus")
    with with_ports() as plant:
        command(client, *port_of(plant, "Modbus TCP"))


@check
def canopus_plc_speaks_what_the_ports_speak():
    text = first_plant_file().read_text()
    path = scratch / "every-port.toml"
    path.write_text(text + '[[plc.port]]\nlisten = "127.0.0.1:0"\nframe = "1E"\n'
                    '[[plc.port]]\nlisten = "127.0.0.1:0"\ntransport = "udp"\nremote_password = "secret"\n'
                    '[[plc]]\nname = "as"\nfamily = "AS300"\nlisten = "off"\n[[plc.modbus]]\nlisten = "127.0.0.1:0"\n')
    with running(path, operational=[1]) as plant:
        def plc(protocol, *options):
            _, port = port_of(plant, protocol)
            return lambda *words, expect=0: command(program, "plc", *words, "--plc", port, *options, expect=expect)
        ports = [plc("MC protocol 1E", "--1e"), plc("MC protocol 1E", "--1e", "--ascii"),
                 plc("MC protocol UDP", "--udp", "--password", "secret"),
                 plc("MC protocol UDP", "--udp", "--4e", "--ascii", "--password", "secret")]
        for number, port in enumerate(ports):
            port("write", f"D{900 + number}", str(number + 1))
            port("set", f"M{900 + number}")
            require(port("read", r"U0\G25").stdout.startswith(r"U0\G25"), "no buffer memory")
        for port in ports:
            said = port("read", "D900", "-n", "4", "--format", "dec").stdout.split()
            require(said == ["D900", "1", "D901", "2", "D902", "3", "D903", "4"], said)
            said = port("read", "M900", "-n", "5").stdout.split()[1::2]
            require(said == ["ON"] * 4 + ["OFF"], said)
        locked = plc("MC protocol UDP", "--udp")
        require("C201H" in locked("read", "D900", expect=1).stderr, "the port stayed unlocked")
        modbus = plc("Modbus TCP", "--modbus")
        modbus("write", "D100", "7", "-1")
        modbus("set", "Y0.15")
        saved = scratch / "as300.csv"
        modbus("dump", "D100..D101", "Y0.14..Y1.0", "SR0", "X0", "-o", saved)
        require(saved.read_text().splitlines()[:6] == ["address,value", "D100,7", "D101,65535", "Y0.14,OFF", "Y0.15,ON", "Y1.0,OFF"],
                saved.read_text())
        modbus("write", "D100", "0")
        head = scratch / "head.csv"
        head.write_text("address,value\nD100,7\nY0.15,OFF\n")
        require("2 points written" in modbus("load", head).stdout, "load does not say what it did")
        require(modbus("read", "Y0", "--format", "dec").stdout == "Y0  0\n", "Y0.15 is not off")
        require("exception 02H" in modbus("read", "coil:65535", expect=1).stderr, "no exception")
        wrong = plc("Modbus TCP", "--1e", "--timeout", "1s")
        require(wrong("read", "D0", expect=1).stderr.startswith("canopus plc: "), "another protocol is not said")
