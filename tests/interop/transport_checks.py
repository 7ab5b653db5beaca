"""Checks of the transports of real buses: python-can is on the other side, in a network namespace that nothing leaves."""
import shutil
import subprocess

from kit import HERE, PYTHON, Skip, args, check, in_machine, program, require, tier

PROBE = args.program.resolve().parent / "tests/transport_probe"


def need_probe():
    if not PROBE.is_file():
        raise Skip(f"{PROBE} is not built (cmake --build build --target transport_probe)")


def transport(name):
    need_probe()
    for module in ("can", "msgpack"):
        if subprocess.run([PYTHON, "-c", f"import {module}"], capture_output=True).returncode != 0:
            raise Skip(f"python3-{module} is not installed")
    if not shutil.which("unshare") or subprocess.run(["unshare", "-n", "true"], capture_output=True).returncode != 0:
        raise Skip("no network namespaces: unshare -n is not permitted")
    done = subprocess.run(["unshare", "-n", "bash", HERE / "transport_commands.sh", program, PROBE, name], capture_output=True,
                          text=True, errors="replace", timeout=600)
    require(done.stdout.endswith("transport ok\n"), f"{name}:\n{done.stdout[-4000:]}\n{done.stderr[-2000:]}")


@check
def python_can_and_udp_multicast_understand_each_other():
    transport("udp-multicast")


@check
def python_can_and_udp_multicast_over_ipv6_understand_each_other():
    transport("udp-multicast-6")


@check
def slcan_adapter_at_a_serial_device_carries_every_frame():
    transport("slcan-pty")


@check
def slcan_adapter_over_tcp_carries_every_frame():
    transport("slcan-tcp")


@check
def cannelloni_over_udp_carries_every_frame():
    transport("cannelloni-udp")


@check
def cannelloni_over_tcp_carries_every_frame():
    transport("cannelloni-tcp")


@check
@tier("machine")
def socketcan_says_what_the_controller_does():
    """In a virtual machine: confirmation by echo, time stamps, netlink, interface down and up, bit rate, filters."""
    need_probe()
    done = in_machine("bash", HERE / "socketcan_transport.sh", program, PROBE)
    require("socketcan ok" in done.stdout, f"{done.stdout[-4000:]}\n{done.stderr[-2000:]}")
