"""Commands on a bus whose other side sends without pause: they end when their time is over, and by signals."""
import contextlib
import signal
import socket
import subprocess
import threading
import time

from kit import check, program, require

GENEROUS = 40  # s, on a machine with more to do than cores


def slcan_bytes(connection):
    """An adapter acknowledges each command; its frames may come from `O` on."""
    said = b""
    while b"O\r" not in said:
        said += connection.recv(4096)
        connection.sendall(b"\r")
    return b"t1232AABB\r"


def socketcand_bytes(connection):
    connection.sendall(b"< hi >")
    for command in (b"open", b"rawmode"):
        said = connection.recv(4096)
        require(command in said, said)
        connection.sendall(b"< ok >")
    return b"< frame 123 1.000000 AABB >"


def cannelloni_bytes(connection):
    connection.sendall(b"CANNELLONIv1")
    return bytes.fromhex("00000123 02 AABB")


@contextlib.contextmanager
def endless_peer(greet):
    """The port of a server that has always more frames to send than its client reads."""
    server = socket.create_server(("127.0.0.1", 0))
    server.settimeout(GENEROUS)

    def serve():
        with contextlib.suppress(OSError):
            connection = server.accept()[0]
            with connection:
                frames = greet(connection) * 4096
                while True:
                    connection.sendall(frames)

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
    for address, greet in (("slcan:tcp:127.0.0.1:{}@250000", slcan_bytes), ("socketcand:127.0.0.1:{}", socketcand_bytes),
                           ("cannelloni:tcp:127.0.0.1:{}", cannelloni_bytes)):
        for words, stop in ((("monitor", "--for", "1s"), None), (("monitor",), signal.SIGINT), (("monitor",), signal.SIGTERM),
                            (("scan", "--nodes", "1-2", "--timeout", "100ms"), None)):
            with endless_peer(greet) as port:
                bus = address.format(port)
                started = time.monotonic()
                place = [bus] if words[0] == "monitor" else ["--bus", bus]
                process = subprocess.Popen([program, *words, *place], stdout=subprocess.DEVNULL,
                                           stderr=subprocess.DEVNULL)
                if stop:
                    time.sleep(0.7)  # it is on the bus, and busy
                    process.send_signal(stop)
                ended(process, started, f"canopus {' '.join([*words, *place])}, {stop}")
                require(stop or time.monotonic() - started > 0.1, f"{bus}: {words} ended at once")
