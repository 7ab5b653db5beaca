"""The program in step with the machine's clock: what is the machine's fault, what is a suspension, what a client does to the
bus when it comes and goes."""
import calendar
import os
import re
import signal
import socket
import time

from kit import PATIENCE, RawClient, check, command, host_port, program, require, running, scratch


def empty_plant(has_plc=False):
    path = scratch / "empty-plant.toml"
    path.write_text('[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:127.0.0.1:0"\n'
                    + ('[[plc]]\nlisten = "127.0.0.1:0"\n' if has_plc else ""))
    return running(path, has_plc=has_plc)


def waited_for_a_processor(plant):
    with open(f"/proc/{plant.process.pid}/schedstat") as file:
        return int(file.read().split()[1]) * 1e-9


def end_of(plant):
    """The summary, and all errors reported."""
    plant.process.send_signal(signal.SIGTERM)
    summary = plant.wait(lambda e: e["event"] == "summary")
    return summary, [e["message"] for e in plant.events if e["event"] == "error"]


def join(plant):
    client = socket.create_connection(host_port(plant.socketcand), timeout=PATIENCE)
    require(client.recv(100) == b"< hi >", "not greeted")
    return client


@check
def clients_of_a_quiet_bus_make_no_lag():
    with empty_plant() as plant:
        for pause in (0.3, 0.9, 0.6, 0.8):
            time.sleep(pause)  # nothing happens on the bus but a report once a second
            client = join(plant)
            time.sleep(pause)
            client.close()
        waited = waited_for_a_processor(plant)
        summary, errors = end_of(plant)
        require(summary["lag"] < 0.2 + waited, f"a lag of {summary['lag']} s, waited {waited} s for a processor: {errors}")


@check
def a_suspended_process_is_not_the_machines_fault():
    with empty_plant() as plant:
        time.sleep(0.5)
        plant.process.send_signal(signal.SIGSTOP)
        time.sleep(4)
        plant.process.send_signal(signal.SIGCONT)
        event = plant.wait(lambda e: e["event"] == "error", timeout=PATIENCE)
        found = re.fullmatch(r"the process was suspended for ([\d.]+) s: plant time stood still", event["message"])
        require(found, event["message"])
        require(2.5 < float(found[1]), event["message"])  # up to a second passes until something is due
        waited = waited_for_a_processor(plant)
        summary, errors = end_of(plant)
        require(summary["lag"] < 0.2 + waited, f"a lag of {summary['lag']} s, waited {waited} s for a processor: {errors}")
        require(summary["t"] < summary["wall"] - 2.5, f"plant time ran on: {summary}")


def flood_and_leave(plant):
    """Sends frames as fast as the connection takes them for a second; how long the bus was busy after that."""
    client = join(plant)
    client.sendall(b"< open line1 >")
    require(client.recv(100) == b"< ok >", "the bus was not opened")
    client.setblocking(False)
    frames = b"< send 123 8 1 2 3 4 5 6 7 8 >" * 1000
    sent, end = 0, time.monotonic() + 1
    while time.monotonic() < end:
        try:
            sent += client.send(frames[sent % len(frames):])
        except BlockingIOError:
            time.sleep(0.01)
    client.close()
    left = time.monotonic()
    seen = len(plant.events)
    plant.wait(lambda e: e["event"] == "load" and e["now"] < 0.1 and plant.events.index(e) >= seen)
    return time.monotonic() - left


@check
def a_client_that_left_does_not_keep_the_bus_busy():
    with empty_plant() as plant, join(plant):  # who has joined acknowledges
        busy = flood_and_leave(plant)
        require(busy < 20, f"the bus was busy for {busy:.0f} s")


@check
def a_client_that_left_does_not_keep_a_bus_busy_where_nobody_acknowledges():
    with empty_plant() as plant:
        busy = flood_and_leave(plant)
        require(busy < 20, f"the bus was busy for {busy:.0f} s")
        plant.wait(lambda e: e["event"] == "error" and e["message"].endswith(" frames that it had sent were dropped"))


@check
def clients_that_send_and_leave_have_their_frames_sent():
    with empty_plant() as plant:
        listener = RawClient(plant)
        for how in ("close", "reset"):
            client = join(plant)
            client.sendall(b"< open line1 >< send 1 0 >< send 2 0 >< send 3 0 >")
            if how == "close":
                require(client.recv(100) == b"< ok >", "the bus was not opened")
            client.close()  # what is not read makes it a reset
            for identifier in (1, 2, 3):
                require(listener.frame() == (identifier, b""), how)
        summary, errors = end_of(plant)
        require(summary["buses"][0]["frames"] == 6 and not errors, f"{summary} {errors}")


@check
def the_cpus_clock_shows_local_time():
    before = os.environ.get("TZ")
    os.environ["TZ"] = "HERE-9:30"
    try:
        with empty_plant(has_plc=True) as plant:
            host, port = host_port(plant.mc)
            done = command(program, "plc", "read", "SD210", "--count", "7", "--format", "dec", "--plc", f"{host}:{port}")
            words = [int(line.split()[1]) for line in done.stdout.splitlines()]
    finally:
        os.environ.pop("TZ") if before is None else os.environ.update(TZ=before)
    shown = calendar.timegm((*words[:6], 0, 0, 0))
    ahead = shown - time.time()
    require(abs(ahead - 9.5 * 3600) < PATIENCE, f"{words}: {ahead / 3600:.2f} h ahead of UTC, expected 9.5")


@check
def idle_plc_clients_give_way_and_it_is_said():
    with empty_plant(has_plc=True) as plant:
        address = host_port(plant.mc)
        idle = [socket.create_connection(address, timeout=PATIENCE) for _ in range(16)]
        time.sleep(11)
        done = command(program, "plc", "read", "D0", "--plc", f"{address[0]}:{address[1]}")
        require(done.stdout.startswith("D0"), done.stdout)
        event = plant.wait(lambda e: e["event"] == "error" and "its connection gives way to" in e["message"])
        require("has sent no request for" in event["message"], event["message"])
        for client in idle:
            client.close()


@check
def a_server_for_other_machines_needs_an_allow_list():
    path = scratch / "open-plant.toml"
    text = '[[bus]]\nname = "line1"\nbit_rate = 250_000\nserve = "socketcand:0.0.0.0:0"\n'
    path.write_text(text)
    for words in (["check", path], ["run", path]):
        done = command(program, *words, expect=2)
        require(f"{path}:4:9: serve: other machines can reach 0.0.0.0" in done.stderr, done.stderr)
    path.write_text(text + 'allow = "192.0.2.0/24"\n')
    command(program, "check", path)
