"""Checks of the example of the AS-FCOPM: pymodbus drives its slaves and runs requests; the EDS file of the card."""
import socket
import subprocess

from kit import HERE, PYTHON, ROOT, Skip, check, command, covers, host_port, program, require, running, scratch
from port_checks import port_of


def example():
    """The example, with servers on free ports, and that of the slave's PLC off."""
    text = (ROOT / "examples/as-fcopm/plant.toml").read_text()
    for old, new in [("127.0.0.1:29536", "127.0.0.1:0"), ("127.0.0.1:5021", "127.0.0.1:0"),
                     ('[[plc.modbus]]\nlisten = "127.0.0.1:5022"\n', ""), ("../devices/", f"{ROOT}/examples/devices/")]:
        require(old in text, f"plant.toml has no {old}")
        text = text.replace(old, new)
    path = scratch / "as-fcopm.toml"
    path.write_text(text)
    return path


@check
@covers("ASF-SDOREQ-001 ASF-SDOREQ-002 ASF-NMTREQ-001 ASF-EMCYREQ-001 ASF-EMCYREQ-002 ASF-REQ-003")
def pymodbus_drives_an_as_fcopm_and_runs_its_requests():
    if subprocess.run([PYTHON, "-c", "import pymodbus"], capture_output=True).returncode != 0:
        raise Skip("python3-pymodbus is not installed")
    with running(example(), has_plc=False) as plant:
        for name in ("drive", "io-block"):
            plant.wait(lambda e, name=name: e["event"] == "nmt" and e.get("name") == name and e["state"] == "operational")
        # A node of the bus sends an emergency message as the I/O block.
        with socket.create_connection(host_port(plant.socketcand), 60) as bus:
            answer = bus.makefile("rb")
            require(answer.read(6) == b"< hi >", "no socketcand")
            for words in (b"< open machine >", b"< rawmode >"):
                bus.sendall(words)
                require(answer.read(6) == b"< ok >", words)
            bus.sendall(b"< send 82 8 43 54 20 14 0 0 0 0 >")
            command(PYTHON, HERE / "as_fcopm_pymodbus.py", *port_of(plant, "Modbus TCP"))
        code, errors = plant.stop()
        require(code == 0, errors)


@check
@covers("ASF-OD-002 ASF-GEN-008")
def the_eds_file_of_an_as_fcopm_is_accepted():
    eds = scratch / "as-fcopm.eds"
    command(program, "module", "eds", "as-fcopm", "-o", eds)
    checked = command(program, "eds", "check", eds).stdout
    require("accepted, 0 warnings:" in checked and checked.count("\n") == 1, checked)
