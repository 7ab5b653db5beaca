"""The clients of the soak: one of socketcand that does all that clients do, a process of its own, and one of the MC protocol."""
import collections
import contextlib
import json
import os
import random
import re
import signal
import socket
import struct
import threading
import time

DEVICES = {"io-block": 2, "encoder": 3, "drive": 4}
# What a server reports of the bus and of the client's frames, at any time: an error frame, frames lost, frames that the bus did not take.
REPORTS = re.compile(rb"< error ([0-9A-F]{3} \d+\.\d{6} |lost |the bus takes no frames)")
ANSWER_TIME = 60.0       # an answer later than this never comes; a machine at load 8 has been seen to need 5 s


# --- a socketcand client, a process of its own ------------------------------------------------------------------------

class NoAnswer(Exception):
    pass


class BusClient:
    def __init__(self, port):
        self.text = b""
        self.socket = socket.create_connection(("127.0.0.1", port), timeout=ANSWER_TIME)
        self.socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def answer(self, wanted, timeout=ANSWER_TIME):
        """Reads on until this element comes; frames before it are passed over. How long it took."""
        start = time.monotonic()
        while True:
            element, bracket, rest = self.text.partition(b">")
            if bracket:
                self.text = rest
                if element.strip().startswith(wanted):
                    return time.monotonic() - start
                if element.strip().startswith(b"< error") and not REPORTS.match(element.strip() + b" "):
                    raise NoAnswer(f"expected {wanted.decode()}, received {element.decode(errors='replace')}")
                continue
            left = start + timeout - time.monotonic()
            if left <= 0:
                raise NoAnswer(f"no {wanted.decode()} within {timeout:.0f} s")
            self.socket.settimeout(left)
            try:
                received = self.socket.recv(65536)
            except TimeoutError:
                raise NoAnswer(f"no {wanted.decode()} within {timeout:.0f} s") from None
            if not received:
                raise NoAnswer(f"the connection was closed in place of {wanted.decode()}")
            self.text += received

    def read_for(self, seconds):
        end = time.monotonic() + seconds
        size = 0
        while (left := end - time.monotonic()) > 0:
            self.socket.settimeout(left)
            with contextlib.suppress(TimeoutError):
                received = self.socket.recv(65536)
                if not received:
                    raise NoAnswer("the connection was closed")
                size += len(received)
        return size

    def send(self, *elements):
        self.socket.settimeout(ANSWER_TIME)
        self.socket.sendall("".join(elements).encode())

    def join(self, raw=True):
        self.answer(b"< hi")
        self.send("< open line1 >")
        self.answer(b"< ok")
        if raw:
            self.send("< rawmode >")
            self.answer(b"< ok")

    def echo(self):
        self.send("< echo >")
        return self.answer(b"< echo")

    def flood(self, seconds, frames):
        """Sends as fast as the connection takes it; does not care whether the bus keeps up."""
        data = "".join(frames).encode()
        end = time.monotonic() + seconds
        sent = 0
        self.socket.setblocking(False)
        while time.monotonic() < end:
            try:
                sent += self.socket.send(data[sent % len(data):])
            except BlockingIOError:
                time.sleep(0.01)
            except (ConnectionResetError, BrokenPipeError):
                break
        return sent

    def leave(self, how):
        if how == "half":  # says that nothing more comes, and waits for the server's end
            self.socket.shutdown(socket.SHUT_WR)
            self.socket.settimeout(ANSWER_TIME)
            try:
                while self.socket.recv(65536):
                    pass
            except ConnectionResetError:
                pass
            except TimeoutError:
                raise NoAnswer("the server did not end a connection that its client had closed") from None
        if how == "reset":
            self.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))
        if how == "kill":
            os.kill(os.getpid(), signal.SIGKILL)
        self.socket.close()


def some_frames(dice, count):
    """Frames that disturb no node: of low priority, a few of them extended, remote, or before everybody else's."""
    frames = []
    for _ in range(count):
        data = " ".join(f"{dice.randrange(256):x}" for _ in range(8))
        kind = dice.random()
        if kind < 0.8:
            frames.append(f"< send {dice.randrange(0x780, 0x7C0):x} 8 {data} >")
        elif kind < 0.9:
            frames.append(f"< send {dice.randrange(0x1FFFFFFF):08x} 8 {data} >")
        elif kind < 0.95:
            frames.append(f"< sendrtr {dice.randrange(0x780, 0x7C0):x} 2 >")
        else:
            frames.append(f"< send {dice.randrange(0x10, 0x80):x} 8 {data} >")
    return frames


def upload_request(node):
    return f"< send {0x600 + node:x} 8 40 00 10 00 0 0 0 0 >"


def conversation(dice, port, count):
    client = BusClient(port)
    count["joins"] += 1
    try:
        what = dice.choices(["greeting", "open", "read", "ask", "flood", "deaf", "short"], [5, 5, 20, 30, 15, 10, 15])[0]
        if what == "greeting":
            client.answer(b"< hi")
        elif what == "open":
            client.join(raw=False)
            count["longest echo"] = max(count["longest echo"], client.echo())
            count["echoes"] += 1
        elif what == "read":
            client.join()
            count["bytes read"] += client.read_for(dice.uniform(0.05, 5))
        elif what == "ask":
            client.join()
            for _ in range(dice.randrange(1, 20)):
                count["longest echo"] = max(count["longest echo"], client.echo())
                count["echoes"] += 1
                client.send(upload_request(dice.choice(list(DEVICES.values()))), *some_frames(dice, dice.randrange(5)))
                count["bytes read"] += client.read_for(dice.uniform(0, 0.2))
        elif what == "flood":
            client.join(raw=dice.random() < 0.5)
            count["floods"] += 1
            count["bytes flooded"] += client.flood(dice.uniform(0.05, 1), some_frames(dice, 500))
        elif what == "deaf":
            client.join()
            count["deaf"] += 1
            client.send(*some_frames(dice, dice.randrange(100)))
            time.sleep(dice.uniform(0.5, 15))
        elif what == "short":
            client.join(raw=False)
            client.send(*some_frames(dice, 3))
        client.leave(dice.choices(["close", "half", "reset", "kill"], [50, 20, 25, 5])[0])
    except (ConnectionResetError, BrokenPipeError):
        if what != "deaf":  # the server ends clients that do not read
            raise
    finally:
        client.socket.close()


def client_process(port, seed, end):
    dice = random.Random(seed)
    count = collections.Counter()
    while time.monotonic() < end:
        problem = None
        try:
            conversation(dice, port, count)
        except (NoAnswer, OSError) as error:
            problem = f"{type(error).__name__}: {error}"
        print(json.dumps({"count": count, "problem": problem}), flush=True)
        count = collections.Counter()
        if problem:
            return 1
        time.sleep(dice.expovariate(2))
    return 0


# --- the PLC client ---------------------------------------------------------------------------------------------------

class PlcClient(threading.Thread):
    """Asks without a pause worth the name; every answer is compared with what it must be."""

    def __init__(self, port, seed):
        super().__init__(daemon=True)
        self.port, self.dice = port, random.Random(seed)
        self.stop, self.problem = threading.Event(), None
        self.answers, self.longest = 0, 0.0

    def ask(self, connection, command, data):
        body = struct.pack("<HHH", 16, command[0], command[1]) + data
        start = time.monotonic()
        connection.sendall(bytes.fromhex("5000 00 ff ff03 00") + struct.pack("<H", len(body)) + body)
        head = self.read(connection, 11)
        length, end_code = struct.unpack("<HH", head[7:11])
        answer = self.read(connection, length - 2)
        self.longest = max(self.longest, time.monotonic() - start)
        if head[:7] != bytes.fromhex("d000 00 ff ff03 00") or end_code != 0:
            raise NoAnswer(f"{command[0]:04X} was answered with {head.hex()}")
        self.answers += 1
        return answer

    @staticmethod
    def read(connection, size):
        data = b""
        while len(data) < size:
            received = connection.recv(size - len(data))
            if not received:
                raise NoAnswer("the MC protocol's connection was closed")
            data += received
        return data

    def converse(self, connection):
        words = [self.dice.randrange(0x10000) for _ in range(self.dice.randrange(1, 64))]
        packed = struct.pack(f"<{len(words)}H", *words)
        first = self.dice.randrange(10000)
        where = struct.pack("<I", first)[:3] + b"\xa8" + struct.pack("<H", len(words))
        self.ask(connection, (0x1401, 0), where + packed)
        if self.ask(connection, (0x0401, 0), where) != packed:
            raise NoAnswer(f"D{first} and its neighbours are not what was written")
        buffer = bytes.fromhex("0000") + struct.pack("<I", 10000)[:3] + bytes.fromhex("ab 0000 0000 f8") + struct.pack("<H", 16)
        if len(self.ask(connection, (0x0401, 0x0080), buffer)) != 32:
            raise NoAnswer("U0\\G10000: not 16 words")
        self.ask(connection, (0x0401, 0), bytes.fromhex("000000 9c 0200"))  # X0, 32 points

    def run(self):
        try:
            while not self.stop.is_set():
                with socket.create_connection(("127.0.0.1", self.port), timeout=ANSWER_TIME) as connection:
                    connection.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
                    for _ in range(self.dice.randrange(1, 2000)):
                        self.converse(connection)
                        if self.stop.wait(0.02):
                            break
        except (NoAnswer, OSError) as error:
            self.problem = f"MC protocol: {type(error).__name__}: {error}"
