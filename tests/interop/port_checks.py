"""The ports of a PLC: 1E frames, UDP and Modbus TCP, judged by clients that are not ours and by bare sockets."""
import subprocess
import sys

from kit import HERE, PYTHON, Skip, check, command, first_plant_file, host_port, node_modules, running, scratch


def with_ports():
    """The first plant with a port for each frame and transport, and one for Modbus TCP."""
    text = first_plant_file().read_text()
    ports = ('[[plc.port]]\nlisten = "127.0.0.1:0"\nframe = "1E"\n'
             '[[plc.port]]\nlisten = "127.0.0.1:0"\ntransport = "udp"\nframe = "any"\n'
             '[[plc.modbus]]\nlisten = "127.0.0.1:0"\n')
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
def pymodbus_reads_and_writes():
    if subprocess.run([PYTHON, "-c", "import pymodbus"], capture_output=True).returncode != 0:
        raise Skip("python3-pymodbus is not installed")
    with with_ports() as plant:
        command(PYTHON, HERE / "modbus_pymodbus.py", *port_of(plant, "Modbus TCP"))
