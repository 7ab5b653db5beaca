"""Checks of `canopus gateway`: its lines, several clients, and clients that do not behave."""
import contextlib
import random
import signal
import socket
import struct
import subprocess
import threading
import time

from kit import HERE, PATIENCE, check, command, program, require, running, scratch, talking, until

DEVICE = HERE / "interop_device.eds"


class Client:
    def __init__(self, port):
        self.socket = socket.create_connection(("127.0.0.1", port), PATIENCE)
        self.file = self.socket.makefile("r", newline="\r\n", encoding="latin-1")

    def say(self, text):
        self.socket.sendall(text.encode("latin-1") + b"\r\n")

    def line(self):
        return self.file.readline().removesuffix("\r\n")

    def ask(self, text, wanted):
        """Passes over events up to the answer."""
        self.say(text)
        answer = self.line()
        while answer.startswith("1 ") and not wanted.startswith("1 "):
            answer = self.line()
        require(answer == wanted, f"{text}: expected {wanted!r}, found {answer!r}")

    def wait(self, wanted):
        while (line := self.line()) != wanted:
            require(line != "", f"{wanted!r} does not come")


def patient(port):
    """A client whose nodes have time to answer."""
    client = Client(port)
    client.ask("[1] set sdo_timeout 60000", "[1] OK")
    return client


@contextlib.contextmanager
def gateway_on(plant, *words):
    with talking(program, "gateway", "--bus", f"socketcand:{plant.socketcand}", "--listen", "127.0.0.1:0", *words) as server:
        line = server.wait_line(lambda text: text.startswith("gateway on "))
        yield int(line.rsplit(":", 1)[1]), server


@contextlib.contextmanager
def gateway(*words):
    path = scratch / "gateway.toml"
    path.write_text('[plant]\nname = "gateway"\n[[bus]]\nname = "line1"\nbit_rate = 1000000\nserve = "socketcand:127.0.0.1:0"\n'
                    f'[[device]]\nnode = 5\neds = "{DEVICE}"\n[[device]]\nnode = 6\neds = "{DEVICE}"\n')
    with running(path, has_plc=False) as plant, gateway_on(plant, *words) as (port, server):
        server.bus = f"socketcand:{plant.socketcand}"
        yield port, server


@check
def gateway_answers_the_commands_of_cia_309_3():
    with gateway("--node-id", "100") as (port, server):
        client = patient(port)
        client.ask("[1] 1 5 r 0x1018 2 u32", "[1] 1280")
        client.ask("[2] 5 r 0x1018 2 x32", "[2] 0x00000500")
        client.ask("[3] 5 r 0x1018 2", "[3] 00 05 00 00")
        client.ask('[4] 5 r 0x1008 0 vs', '[4] "Interop device"')
        client.ask("[5] set node 5", "[5] OK")
        client.ask("[6] w 0x2003 0 u16 0x1F4", "[6] OK")
        client.ask("[7] r 0x2003 0 u16", "[7] 500")
        client.ask("[8] r 0x3333 0", "[8] ERROR:0x06020000 #object does not exist")
        client.ask("[9] r 0x2003 0 u32", "[9] ERROR:0x06070010 #data type or length does not match")
        client.ask('[10] w 0x2000 0 vs "two words, ""quoted"""', "[10] OK")
        client.ask("[11] r 0x2000 0 vs", '[11] "two words, ""quoted"""')
        client.ask("[12] set sdo_block 1", "[12] OK")
        client.ask("[13] r 0x2000 0 os", "[13] dHdvIHdvcmRzLCAicXVvdGVkIg==")
        client.ask("[14] 99 set sdo_timeout 100", "[14] ERROR:106 #unsupported network")
        client.ask("[15] set sdo_timeout 100", "[15] OK")
        client.say("[16] 99 r 0x1000 0 u32")
        require(client.line().startswith("[16] ERROR:0x05040000"), "the time-out of a node that is not there")
        client.ask("[17] 5 enable heartbeat 60000", "[17] OK")
        client.ask("[18] set sdo_timeout 60000", "[18] OK")
        client.ask("[19] w 0x1017 0 u16 50", "[19] OK")
        client.wait("1 5 ERROR 202 #heartbeat started")
        client.ask("[20] start", "[20] OK")
        client.wait("1 5 ERRORx OPER")
        client.ask("[21] reset node", "[21] OK")
        client.wait("1 5 BOOT_UP")
        client.ask("[22] hello", "[22] ERROR:101 #syntax error")
        server.process.send_signal(signal.SIGINT)
        require(server.process.wait(PATIENCE) == 0, "the exit code of Ctrl-C")


@check
def gateway_outlives_clients_that_do_not_behave():
    with gateway() as (port, _server):
        good = patient(port)
        chance = random.Random(1)
        clients = []
        for _ in range(10):  # garbage, long lines, clients that leave in the middle of a command
            hostile = Client(port)
            hostile.socket.sendall(chance.randbytes(5000) + b"x" * 300000 + b"\n5 r 0x1000 0\n")
            clients.append(hostile)
        for hostile in clients:
            hostile.socket.close()
        good.ask("[1] 5 r 0x1018 2 u32", "[1] 1280")
        slow = Client(port)  # takes nothing, and asks for much
        slow.socket.setblocking(False)
        end = time.monotonic() + 10
        with contextlib.suppress(BlockingIOError, ConnectionError):
            while time.monotonic() < end:
                slow.socket.sendall(b"info version\n" * 1000)
        good.ask("[2] 6 r 0x1018 2 u32", "[2] 1280")
        many = [patient(port) for _ in range(20)]
        for number, client in enumerate(many):
            client.say(f"[{number}] {5 + number % 2} r 0x1018 2 u32")
        for number, client in enumerate(many):
            require(client.line() == f"[{number}] 1280", f"the answer of client {number}")


@check
def gateway_answers_each_of_many_commands_sent_at_once():
    """A client that writes all before it reads, one that only then closes its half, and one that says a byte at a time."""
    count = 200000
    refused = "ERROR:102 #request not processed due to the internal state"
    with gateway() as (port, _server):
        client = patient(port)
        text = b"".join(b"[%d] %s\n" % (i, b"r p 1" if i % 1000 else b"5 r 0x1018 2 u32") for i in range(count))
        writer = threading.Thread(target=client.socket.sendall, args=(text,), daemon=True)
        writer.start()
        time.sleep(1)  # there is no room for 13 MB of answers: they wait, and so do the commands
        for i in range(count):
            while (line := client.line()).startswith("1 "):
                pass
            require(line == f"[{i}] {refused if i % 1000 else '1280'}", f"answer {i}: {line!r}")
        writer.join(PATIENCE)
        half = patient(port)
        half.socket.sendall(b"5 r 0x1018 2 u32\n" * 300)
        half.socket.shutdown(socket.SHUT_WR)
        said = [line for line in half.file.read().splitlines() if not line.startswith("1 ")]
        require(said == ["1280"] * 300, f"{len(said)} answers to a client that had closed its half: {said[:3]}")
        slow = patient(port)
        slow.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        for byte in b"[4294967295] 5 r 0x1018 2 u32\n" * 40:
            slow.socket.sendall(bytes([byte]))
        for _ in range(40):
            require(slow.line() == "[4294967295] 1280", "the answers to bytes that come one by one")


@check
def gateway_gives_a_node_back_that_a_lost_client_waits_for():
    with gateway() as (port, _server):
        lost = Client(port)
        lost.ask("[1] set sdo_timeout 65535", "[1] OK")
        lost.say("99 r 0x1000 0")
        time.sleep(0.5)
        lost.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        lost.file.close()
        lost.socket.close()  # a reset: it is gone for good
        start = time.monotonic()
        good = Client(port)
        good.ask("[2] set sdo_timeout 100", "[2] OK")
        good.say("[3] 99 r 0x1000 0")
        require(good.line().startswith("[3] ERROR:0x05040000"), "a node that is not there")
        require(time.monotonic() - start < 60, "the lost client's transfer was waited for")


@check
def gateway_has_a_place_again_after_a_thousand_connections():
    with gateway() as (port, server):
        for i in range(1000):
            client = socket.create_connection(("127.0.0.1", port), PATIENCE)
            client.sendall((b"5 r 0x1018 2 u32\n", b"[1] 5 r 0x10", b"", b"[1\n\n\x00\xff")[i % 4])
            client.close()
        def place():
            """A client that is answered, or None: its connection was refused, as those before it are still being closed."""
            with contextlib.suppress(ConnectionError, AssertionError):
                client = patient(port)
                client.ask("[5] 5 r 0x1018 2 u32", "[5] 1280")
                return client
            return None
        full = []
        until(lambda: full.append(place()) or sum(client is not None for client in full) == 32, "there are not 32 places")
        for _ in range(8):
            said = Client(port).line()
            require(said == "ERROR:102 #connection refused", said)
        full.clear()
        until(place, "no place is free")
        server.process.send_signal(signal.SIGINT)
        require(server.process.wait(PATIENCE) == 0, "the exit code of Ctrl-C")


def reads_on(client):
    with contextlib.suppress(OSError):
        while client.line():
            pass


@check
def gateway_ends_a_client_that_takes_no_events():
    with gateway() as (port, server):
        busy = Client(port)
        deaf = socket.socket()
        deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
        deaf.connect(("127.0.0.1", port))
        busy.ask("[1] set rpdo 1 0x205 event 8 u8 u8 u8 u8 u8 u8 u8 u8", "[1] OK")
        log = scratch / "events.log"
        log.write_text("".join(f"({i / 10000:.6f}) can0 205#0102030405060708\n" for i in range(300000)))
        threading.Thread(target=reads_on, args=(busy,), daemon=True).start()
        with talking(program, "replay", log, "--bus", server.bus, "--speed", "max", "--loop", "0"):
            server.wait_line(lambda text: text.endswith("takes nothing; its connection ends"), 5 * PATIENCE)
        good = patient(port)

        def answered():
            good.say("[3] 5 r 0x1018 2 u32")
            while (line := good.line()).startswith("1 "):
                pass
            return line == "[3] 1280"
        until(answered, "node 5 does not answer")  # what the replay left behind comes first on the bus
        deaf.close()


@check
def gateway_goes_on_when_nobody_reads_what_it_reports():
    with gateway() as (_port, first):
        server = subprocess.Popen([program, "gateway", "--bus", first.bus, "--listen", "127.0.0.1:0"], stdout=subprocess.PIPE,
                                  stderr=subprocess.PIPE)
        try:
            port = int(server.stdout.readline().rsplit(b":", 1)[1])
            clients = [patient(port) for _ in range(32)]
            for client in clients:
                client.ask("[1] 5 r 0x1018 2 u32", "[1] 1280")
            for _ in range(5000):  # each refusal is a line on stderr, which holds 64 KiB
                socket.create_connection(("127.0.0.1", port), PATIENCE).close()
            clients[31].ask("[2] 5 r 0x1018 2 u32", "[2] 1280")
            server.send_signal(signal.SIGTERM)
            require(server.wait(PATIENCE) == 0, "the exit code of SIGTERM")
        finally:
            server.kill()
            server.wait()


@check
def gateway_refuses_what_it_cannot_do():
    for words, text in ((("--node-id", "128"), '--node-id: "128" is not a node'), (("--listen", "0.0.0.0:7600"), "other machines can reach"),
                        (("--listen", "nowhere"), "--listen: "), (("--allow", "1.2.3"), "--allow: ")):
        said = command(program, "gateway", *words, expect=2).stderr
        require(text in said, f"{words}: {said}")
    said = command(program, "gateway", "--bus", "socketcand:127.0.0.1:1", expect=1).stderr
    require("Connection refused" in said, said)
