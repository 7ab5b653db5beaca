"""64 clients over all servers of one rack while its network runs: each finds its own words, and the bus loses nothing."""
import json
import socket
import struct
import threading
import time

from kit import PATIENCE, check, first_plant_file, host_port, require, running, scratch

SECONDS = 4.0
WORDS = 16


def pattern(number, turn):
    return [(number * 4096 + turn * 40503 + i * 257) & 0xFFFF for i in range(WORDS)]


class Client:
    """`number` among all 64; D2000 + 16 * number and further are its own."""

    def __init__(self, address, number, among):
        host, port = host_port(address)
        kind = socket.SOCK_DGRAM if self.udp else socket.SOCK_STREAM
        self.socket = socket.socket(socket.AF_INET, kind)
        self.socket.settimeout(PATIENCE)
        self.socket.connect((host, int(port)))
        self.number, self.among, self.first = number, among, 2000 + WORDS * number
        self.turns = 0

    udp = False

    def ask(self, request, size):
        self.socket.sendall(request)
        if self.udp:
            return self.socket.recv(65536)
        reply = b""
        while len(reply) < size:
            more = self.socket.recv(size - len(reply))
            require(more, f"{type(self).__name__} {self.among}: the connection was closed")
            reply += more
        return reply

    def turn(self):
        self.turns += 1
        words = pattern(self.number, self.turns)
        self.write(words)
        found = self.read()
        require(found == words, f"{type(self).__name__} {self.among} reads {found[:4]} in place of {words[:4]}")


class Mc3e(Client):
    subheader, reply = b"\x50\0", b"\xd0\0"

    def request(self, command, data, size):
        body = struct.pack("<HHH", 0, command, 0) + struct.pack("<I", self.first)[:3] + b"\xa8" + struct.pack("<H", WORDS) + data
        route = b"\0\xff\xff\x03\0"
        answer = self.ask(self.subheader + route + struct.pack("<H", len(body)) + body, len(self.reply) + 9 + size)
        expected = self.reply + route + struct.pack("<HH", size + 2, 0)
        require(answer.startswith(expected), f"{type(self).__name__} {self.among}: {answer[:20]!r}")
        return answer[len(expected):]

    def write(self, words):
        self.request(0x1401, struct.pack(f"<{WORDS}H", *words), 0)

    def read(self):
        return list(struct.unpack(f"<{WORDS}H", self.request(0x0401, b"", 2 * WORDS)))


class Mc4eUdp(Mc3e):
    udp = True

    def request(self, command, data, size):
        self.serial = (getattr(self, "serial", 0) + 1) & 0xFFFF
        self.subheader = b"\x54\0" + struct.pack("<HH", self.serial, 0)
        self.reply = b"\xd4\0" + struct.pack("<HH", self.serial, 0)
        return super().request(command, data, size)


class Mc1e(Client):
    def request(self, command, data, size):
        head = struct.pack("<BBHI", command, 0xFF, 0, self.first) + b" D" + struct.pack("<BB", WORDS, 0)
        answer = self.ask(head + data, 2 + size)
        require(answer[:2] == bytes((command | 0x80, 0)), f"1E {self.among}: {answer[:8]!r}")
        return answer[2:]

    def write(self, words):
        self.request(0x03, struct.pack(f"<{WORDS}H", *words), 0)

    def read(self):
        return list(struct.unpack(f"<{WORDS}H", self.request(0x01, b"", 2 * WORDS)))


class Modbus(Client):
    def request(self, pdu, reply):
        self.transaction = (getattr(self, "transaction", 0) + 1) & 0xFFFF
        head = struct.pack(">HH", self.transaction, 0)
        answer = self.ask(head + struct.pack(">HB", len(pdu) + 1, 255) + pdu, 7 + reply)
        require(answer.startswith(head) and answer[7] == pdu[0], f"Modbus {self.among}: {answer[:12]!r}")
        return answer[8:]

    def write(self, words):
        self.request(struct.pack(f">BHHB{WORDS}H", 16, self.first, WORDS, 2 * WORDS, *words), 5)

    def read(self):
        return list(struct.unpack(f">{WORDS}H", self.request(struct.pack(">BHH", 3, self.first, WORDS), 2 + 2 * WORDS)[1:]))


class Control(Client):
    """Forces a value of its own; of the io-block's four analog inputs one each, the others ask what there is."""

    def __init__(self, *arguments):
        super().__init__(*arguments)
        self.lines = self.socket.makefile("rw")

    def request(self, **fields):
        identifier = f"{self.among}-{self.turns}"
        print(json.dumps({"id": identifier, **fields}), file=self.lines, flush=True)
        answer = json.loads(self.lines.readline())
        require(answer.get("id") == identifier and answer["ok"], f"control {self.among}: {answer}")
        return answer

    def turn(self):
        self.turns += 1
        if self.among >= 4:
            require(len(self.request(request="list")["devices"]) == 3, "devices are missing")
            return
        one = {"device": "io-block", "object": f"6401:0{self.among + 1}"}
        value = (self.among * 8000 + self.turns * 7) % 32000
        self.request(request="set", value=value, **one)
        found = self.request(request="get", **one)["objects"][0]["value"]
        require(found == value, f"control {self.among} reads {found} in place of {value}")


def frames_of(path, identifier):
    """Data of this identifier's frames, in their order, from a pcap file."""
    data = path.read_bytes()
    order = "<" if data[:4] in (b"\xd4\xc3\xb2\xa1", b"\x4d\x3c\xb2\xa1") else ">"
    at, found = 24, []
    while at + 16 <= len(data):
        size = struct.unpack(order + "I", data[at + 8:at + 12])[0]
        record = data[at + 16:at + 16 + size]
        if struct.unpack(">I", record[:4])[0] == identifier:
            found.append(record[8:8 + record[4]])
        at += 16 + size
    return found


@check
def sixty_four_clients_find_their_own_words_and_the_bus_loses_nothing():
    path = scratch / "many-clients.toml"
    path.write_text(first_plant_file().read_text().replace("seed = 1\n", 'seed = 1\ncontrol = "127.0.0.1:0"\n', 1)
                    + '[[plc.port]]\nlisten = "127.0.0.1:0"\nframe = "1E"\n'
                    '[[plc.port]]\nlisten = "127.0.0.1:0"\ntransport = "udp"\n[[plc.modbus]]\nlisten = "127.0.0.1:0"\n')
    failures = []

    def hammer(client, end):
        try:
            while time.monotonic() < end:
                client.turn()
        except Exception as error:  # noqa: BLE001  (the check says it, whatever it was)
            failures.append(f"{type(client).__name__} {client.among}: {error}")

    with running(path, operational=[1, 2, 3, 4]) as plant:
        address = lambda protocol: plant.wait(lambda e: e["event"] == "listen" and e["protocol"] == protocol)["address"]
        clients = []
        for kind, protocol, count in ((Mc3e, "MC protocol", 16), (Mc4eUdp, "MC protocol UDP", 16), (Mc1e, "MC protocol 1E", 12),
                                      (Modbus, "Modbus TCP", 12), (Control, "control", 8)):
            clients += [kind(address(protocol), len(clients) + i, i) for i in range(count)]
        require(len(clients) == 64, "not 64")
        before = len(plant.events)
        end = time.monotonic() + SECONDS
        threads = [threading.Thread(target=hammer, args=(client, end)) for client in clients]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        require(not failures, "\n".join(failures))
        idle = [f"{type(client).__name__} {client.among}" for client in clients if client.turns == 0]
        require(not idle, f"never had their turn: {idle}")
        for client in clients:
            client.socket.close()
        code, errors = plant.stop()
        while (line := plant.lines.get(timeout=PATIENCE)) is not None:
            plant.events.append(json.loads(line))
        require((code, errors) == (0, ""), f"exit code {code}: {errors}")
        wrong = [e for e in plant.events[before:] if e["event"] in ("nmt", "emcy") or
                 (e["event"] == "error" and "MC protocol" in str(e))]
        require(not wrong, f"the network noticed: {wrong[:3]}")
        inputs = [frame[0] for frame in frames_of(plant.trace, 0x182)]
        steps = {(b - a) % 256 for a, b in zip(inputs, inputs[1:])}
        require(len(inputs) > 20 and steps <= {0, 1}, f"{len(inputs)} frames of node 2, their counter went on by {sorted(steps)}")
