"""Commands on a bus whose other side has no end: they end when their time is over, by signals, and at a limit of bytes."""
import contextlib
import signal
import socket
import subprocess
import threading
import time

from kit import ANSWER, check, command, program, require

GENEROUS = 120  # s, on a machine with more to do than cores


def slcan_bytes(connection):
    """An adapter acknowledges each command; its frames may come from `O` on."""
    said = b""
    while b"O\r" not in said:
        said += connection.recv(4096)
        connection.sendall(b"\r")
    return b"t1232AABB\r"


def socketcand_bytes(connection):
    connection.sendall(b"< hi >")
    for word in (b"open", b"rawmode"):
        said = connection.recv(4096)
        require(word in said, said)
        connection.sendall(b"< ok >")
    return b"< frame 123 1.000000 AABB >"


def cannelloni_bytes(connection):
    connection.sendall(b"CANNELLONIv1")
    return bytes.fromhex("00000123 02 AABB")


def stream(greet):
    """Sends frames as fast as they are read, and faster."""
    def talk(connection):
        frames = greet(connection) * 4096
        while True:
            connection.sendall(frames)
    return talk


def endless_sdo_server(connection):
    """Node 9, whose objects have no size and no end, read in segments or blocks."""
    socketcand_bytes(connection)
    answer = lambda data: connection.sendall(f"< frame 589 1.000000 {data.hex().upper()} >".encode())
    said = b""
    while part := connection.recv(4096):
        said += part
        while b">" in said:
            element, said = said.split(b">", 1)
            words = element.split()
            if words[1:3] != [b"send", b"609"]:
                continue
            data = bytes(int(byte, 16) for byte in words[4:])
            if data[0] == 0x40:
                answer(bytes([0x40]) + data[1:4] + bytes(4))
            elif data[0] & 0xEF == 0x60:
                answer(bytes([data[0] & 0x10]) + b"endless")
            elif data[0] & 0xE3 == 0xA0:
                answer(bytes([0xC0]) + data[1:4] + bytes(4))
            elif data[0] & 0xE3 in (0xA2, 0xA3):
                for number in range(1, 128):
                    answer(bytes([number]) + b"endless")


@contextlib.contextmanager
def server_that(talk):
    """The port of a server that does this with its one client."""
    server = socket.create_server(("127.0.0.1", 0))
    server.settimeout(GENEROUS)

    def serve():
        with contextlib.suppress(OSError):
            connection = server.accept()[0]
            with connection:
                talk(connection)

    peer = threading.Thread(target=serve, daemon=True)
    peer.start()
    try:
        yield server.getsockname()[1]
    finally:
        server.close()
        peer.join(GENEROUS)


def ended(process, started, what):
    try:
        process.wait(timeout=GENEROUS)
    except subprocess.TimeoutExpired:
        raise AssertionError(f"{what} still runs after {time.monotonic() - started:.0f} s") from None
    finally:
        process.kill()


@check
def a_peer_without_pause_does_not_hold_a_command():
    """`--for`, SIGINT and SIGTERM end commands over slcan, socketcand and cannelloni."""
    by_time, by_signal = (("monitor", "--for", "500ms"), None), (("monitor",), signal.SIGINT)
    others = (("monitor",), signal.SIGTERM), (("scan", "--nodes", "1-2", "--timeout", "100ms"), None)
    for address, greet, cases in (("slcan:tcp:127.0.0.1:{}@250000", slcan_bytes, (by_time, by_signal, *others)),
                                  ("socketcand:127.0.0.1:{}", socketcand_bytes, (by_time, by_signal)),
                                  ("cannelloni:tcp:127.0.0.1:{}", cannelloni_bytes, (by_time, by_signal))):
        for words, stop in cases:
            with server_that(stream(greet)) as port:
                bus = address.format(port)
                started = time.monotonic()
                place = ["--bus", bus]
                process = subprocess.Popen([program, *words, *place], stdout=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL)
                if stop:
                    time.sleep(0.4)  # it is on the bus, and busy
                    process.send_signal(stop)
                ended(process, started, f"canopus {' '.join([*words, *place])}, {stop}")
                require(stop or time.monotonic() - started > 0.1, f"{bus}: {words} ended at once")


@check
def a_value_without_end_is_aborted_at_the_limit():
    for words in ((), ("--block",)):
        with server_that(endless_sdo_server) as port:
            done = command(program, "sdo", "read", "9", "1008", "--bus", f"socketcand:127.0.0.1:{port}", "--limit", "4K", "--timeout", ANSWER, *words, expect=1)
            expected = "canopus: node 9, 1008:00: the value is longer than the limit of 4 KiB, which --limit can raise\n"
            require(done.stderr == expected, done.stderr)
