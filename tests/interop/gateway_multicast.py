"""`canopus gateway` on a multicast bus with a running plant; python-can is on the same bus, asks as a node would, and says
what it heard. In a network namespace of its own:     unshare -n gateway_multicast.py PROGRAM PLANT
PLANT has node 5 (interop_device.eds) on udp-multicast:239.74.163.7:43200. Prints "multicast ok"."""
import queue
import socket
import subprocess
import sys
import time

import can

PATIENCE = 60
ADDRESS = "239.74.163.7", 43200
EVENTS = "1 "


def require(condition, message):
    if not condition:
        raise AssertionError(message)


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), PATIENCE)
        self.file = self.socket.makefile("r", newline="\r\n")

    def say(self, text):
        self.socket.sendall(text.encode() + b"\n")

    def line(self, skip_events=True):
        while (line := self.file.readline().removesuffix("\r\n")).startswith(EVENTS) and skip_events:
            pass
        return line

    def ask(self, text, wanted="OK"):
        self.say(f"[9] {text}")
        answer = self.line()
        require(answer == f"[9] {wanted}", f"{text}: expected {wanted!r}, found {answer!r}")

    def ask_until(self, text, wanted):
        """What depends on frames of the other way, which may take longer than the question."""
        end = time.monotonic() + PATIENCE
        answer = None
        while answer != f"[9] {wanted}":
            require(time.monotonic() < end, f"{text}: expected {wanted!r}, found {answer!r}")
            self.say(f"[9] {text}")
            answer = self.line()

    def wait(self, wanted):
        while (line := self.line(skip_events=False)) != wanted:
            require(line != "", f"{wanted!r} does not come")


class Bus:
    """Frames of these identifiers, in order."""

    def __init__(self):
        self.bus = can.Bus(interface="udp_multicast", channel=ADDRESS[0], port=ADDRESS[1], receive_own_messages=False)
        self.frames = queue.Queue()
        self.notifier = can.Notifier(self.bus, [self.frames.put])

    def send(self, identifier, data=b"", **options):
        options.setdefault("is_extended_id", False)
        self.bus.send(can.Message(arbitration_id=identifier, data=data, **options))

    def next(self, identifier, extended=False, remote=False):
        end = time.monotonic() + PATIENCE
        while True:
            frame = self.frames.get(timeout=max(0.01, end - time.monotonic()))
            if (frame.arbitration_id, frame.is_extended_id, frame.is_remote_frame) == (identifier, extended, remote):
                return frame

    def none_of(self, identifier, seconds):
        end = time.monotonic() + seconds
        while time.monotonic() < end:
            try:
                frame = self.frames.get(timeout=max(0.001, end - time.monotonic()))
            except queue.Empty:
                return
            require(frame.arbitration_id != identifier or frame.is_remote_frame, f"a frame nobody waits for: {frame}")


def transmit_pdos(client, bus):
    client.ask("set tpdo 1 0x32345678 event 2 u8 u16")  # 29 bits
    client.ask("w p 1 2 0x11 0x2233")
    require(bus.next(0x12345678, extended=True).data == b"\x11\x33\x22", "the TPDO of 29 bits")
    client.ask("set tpdo 2 0x206 rtr 1 u16")
    bus.send(0x206, is_remote_frame=True, dlc=2)
    bus.none_of(0x206, 0.3)
    client.ask("w p 2 1 0x1234")
    bus.none_of(0x206, 0.3)
    bus.send(0x206, is_remote_frame=True, dlc=2)
    require(bus.next(0x206).data == b"\x34\x12", "the answer to a remote frame")
    client.ask("set tpdox 3 0x207 sync2 3 1 u8")
    client.ask("w p 3 1 7")
    for counter in (1, 2, 3):
        bus.send(0x080, bytes([counter]))
    bus.none_of(0x207, 0.3)
    bus.send(0x080, bytes([4]))
    require(bus.next(0x207).data == b"\x07", "the TPDO of the second SYNC since the one of its start value")
    client.ask("set tpdox 4 0x208 event300 0 1 u8")
    for value in (1, 2, 3):
        client.ask(f"w p 4 1 {value}")
    first, second = bus.next(0x208), bus.next(0x208)
    require((first.data, second.data) == (b"\x01", b"\x03"), f"inhibit time: {first} {second}")
    require(0.25 < second.timestamp - first.timestamp < 5, f"inhibit time: {second.timestamp - first.timestamp}")
    bus.none_of(0x208, 0.5)
    client.ask("set tpdox 5 0x209 event 0 200 1 u8")
    client.ask("w p 5 1 5")
    times = [bus.next(0x209).timestamp for _ in range(4)]
    require(0.4 < times[3] - times[0] < 5, f"event timer: {times}")
    client.ask("set tpdo 5 0x80000209 event 0")
    client.ask("w p 5 1 5", "ERROR:102 #request not processed due to the internal state")


def receive_pdos(client, bus):
    client.ask("set rpdo 1 0x185 rtr 2 u8 u16")
    client.ask("5 start")
    client.ask("5 w 0x6000 1 u8 0x21")
    client.ask("5 w 0x6000 2 u16 0x4365")
    client.ask("r p 1", "1 pdo 2 0x21 0x4365")
    bus.next(0x185, remote=True)
    client.ask("set rpdo 2 0x185 event 1 u8", "ERROR:400 #PDO already used")
    client.ask("set rpdo 2 0x2A000123 event 1 u32")
    bus.send(0x0A000123, b"\x01\x02\x03\x04", is_extended_id=True)
    client.wait("1 pdo 2 1 0x4030201")
    bus.send(0x0A000123, b"\x01\x02", is_extended_id=True)
    client.wait("1 ERROR 401 #PDO length exceeded")
    client.ask("set rpdo 3 0x383 sync2 1 u8")
    bus.send(0x383, b"\x63")
    bus.send(0x080)
    client.ask_until("r p 3", "1 pdo 1 0x63")
    bus.send(0x080)
    client.wait("1 pdo 3 1 0x63")


def own_node(client, bus):
    client.ask("set id 100")
    client.ask("set heartbeat 100")
    require(bus.next(0x764).data == b"\x05", "the gateway's heartbeat")
    client.ask("set heartbeat 0")
    client.ask("init 2", "ERROR:304 #CAN init: the bit rate of this bus is not set from here")


def main():
    program, plant = sys.argv[1:]
    for words in ("link set lo up", "link set lo multicast on", "route add 224.0.0.0/4 dev lo"):
        subprocess.run(["ip", *words.split()], check=True)
    bus = Bus()
    children = [subprocess.Popen([program, "run", plant, "--quiet"])]
    try:
        require(bus.next(0x705).data == b"\x00", "the boot-up of the plant's device")
        children.append(subprocess.Popen([program, "gateway", "--bus", "udp-multicast:%s:%d" % ADDRESS, "--listen", "127.0.0.1:0"],
                                         stdout=subprocess.PIPE, text=True))
        client = Client(int(children[1].stdout.readline().rsplit(":", 1)[1]))
        transmit_pdos(client, bus)
        receive_pdos(client, bus)
        own_node(client, bus)
        print("multicast ok")
    finally:
        for child in children:
            child.terminate()
            child.wait(PATIENCE)


main()
