"""Requests byte by byte, against a server that knows nothing but what it is to answer."""
import contextlib
import socket
import struct
import threading

import pytest

from canopus_plc import EndCodeError, Plc, PlcError


class Script:
    """Accepts one client, notes its requests and answers each with the next of the replies."""

    def __init__(self, replies):
        self._socket = socket.create_server(("127.0.0.1", 0))
        self.port = self._socket.getsockname()[1]
        self.requests = []
        self._thread = threading.Thread(target=self._serve, args=(replies,), daemon=True)
        self._thread.start()

    def _serve(self, replies):
        client, _ = self._socket.accept()
        with client:
            for reply in replies:
                request = client.recv(65536)
                self.requests.append(request.hex(" "))
                client.sendall(bytes.fromhex(reply))
            with contextlib.suppress(ConnectionResetError):  # who closes over an answer it did not read
                client.recv(1)

    def close(self):
        self._socket.close()


@pytest.fixture
def script():
    opened = []

    def start(*replies, **options):
        server = Script(replies)
        plc = Plc("127.0.0.1", server.port, **{"timeout": 30, **options})
        opened.extend((plc, server))
        return plc, server

    yield start
    for each in opened:
        each.close()


DONE = "d0 00 00 ff ff 03 00 02 00 00 00"


def test_words_are_read_as_the_manual_shows(script):
    plc, server = script("d0 00 00 ff ff 03 00 08 00 00 00 01 01 01 02 ff ff")
    assert plc.d[100:103] == [0x0101, 0x0201, 0xFFFF]
    assert server.requests == ["50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 64 00 00 a8 03 00"]


def test_numbers_of_x_and_w_may_be_text_in_hexadecimal(script):
    plc, server = script("d0 00 00 ff ff 03 00 03 00 00 00 10", "d0 00 00 ff ff 03 00 04 00 00 00 34 12")
    assert plc.x["1F"] is True
    assert plc.w["2a"] == 0x1234
    assert server.requests == ["50 00 00 ff ff 03 00 0c 00 10 00 01 04 01 00 1f 00 00 9c 01 00",
                               "50 00 00 ff ff 03 00 0c 00 10 00 01 04 00 00 2a 00 00 b4 01 00"]


def test_an_fx_counts_x_and_y_in_octal(script):
    plc, server = script("d0 00 00 ff ff 03 00 03 00 00 00 10", octal=True)
    assert plc.x["17"] is True
    assert server.requests[0].endswith("0f 00 00 9c 01 00")
    with pytest.raises(IndexError, match="expected an int, or a string that is octal"):
        plc.y["8"]


def test_bits_are_two_in_a_byte(script):
    plc, server = script("d0 00 00 ff ff 03 00 04 00 00 00 10 10", DONE)
    assert plc.m[10:13] == [True, False, True]
    plc.y[1:4] = [True, True, False]
    assert server.requests[1] == "50 00 00 ff ff 03 00 0e 00 10 00 01 14 01 00 01 00 00 9d 03 00 11 00"


def test_buffer_memory_is_written_as_u_g(script):
    plc, server = script(DONE)
    plc.g[3][256:258] = [1, -2]
    assert server.requests == [
        "50 00 00 ff ff 03 00 17 00 10 00 01 14 80 00 00 00 00 01 00 ab 00 00 03 00 f8 02 00 01 00 fe ff"]


def test_views_put_words_together_low_word_first(script):
    words = "d0 00 00 ff ff 03 00 06 00 00 00 fe ff ff ff"
    plc, server = script(words, words, words, DONE, DONE, "d0 00 00 ff ff 03 00 06 00 00 00 00 00 c0 3f")
    assert plc.d.double[0] == 0xFFFFFFFE
    assert plc.d.signed_double[0:2] == [-2]
    assert plc.d.signed[0:2] == [-2, -1]
    plc.d.double[4] = 0x12345678
    assert server.requests[-1].endswith("04 00 00 a8 02 00 78 56 34 12")
    plc.d.real[6] = 1.5
    assert server.requests[-1].endswith("06 00 00 a8 02 00 00 00 c0 3f")
    assert plc.d.real[6] == 1.5


def test_more_than_one_request_holds(script):
    first = "d0 00 00 ff ff 03 00 82 07 00 00" + "01 00" * 960
    plc, server = script(first, "d0 00 00 ff ff 03 00 04 00 00 00 02 00")
    assert plc.zr[10:971] == [1] * 960 + [2]
    assert server.requests[1].endswith("ca 03 00 b0 01 00")


def test_a_refusal_names_the_request_and_the_connection_goes_on(script):
    refusal = "d0 00 00 ff ff 03 00 0b 00 31 40 00 ff ff 03 00 01 04 00 00"
    plc, _ = script(refusal, "d0 00 00 ff ff 03 00 04 00 00 00 07 00")
    with pytest.raises(EndCodeError, match="read D999999: end code 4031H: the device number is beyond the last one") as error:
        plc.d[999999]
    assert error.value.end_code == 0x4031
    assert plc.d[0] == 7


def test_4e_frames_have_serial_numbers(script):
    plc, server = script("d4 00 01 00 00 00 00 ff ff 03 00 04 00 00 00 05 00", "d4 00 07 00 00 00 00 ff ff 03 00 04 00 00 00 05 00",
                         frame="4E")
    assert plc.d[0] == 5
    assert server.requests[0].startswith("54 00 01 00 00 00 00 ff ff 03 00 0c 00")
    with pytest.raises(PlcError, match="no frame that was expected"):
        plc.d[0]  # the answer to another request
    with pytest.raises(PlcError, match="is closed"):
        plc.d[0]


@pytest.mark.parametrize("reply, text", [
    ("d4 00 00 00 00 00 00 ff ff", "no frame that was expected but starts with d4"),
    ("d0 00 00 ff ff 03 00 01 00 00", "has no end code"),
    ("d0 00 00 ff ff 03 00 03 00 00 00 07", "1 bytes of data in the reply, expected 2"),
])
def test_an_answer_that_makes_no_sense_ends_the_connection(script, reply, text):
    plc, _ = script(reply)
    with pytest.raises(PlcError, match=text):
        plc.d[0]
    with pytest.raises(PlcError, match="is closed"):
        plc.d[0]


def test_nobody_there():
    with socket.create_server(("127.0.0.1", 0)) as server:
        port = server.getsockname()[1]
    with pytest.raises(PlcError, match=f"127.0.0.1:{port}: Connection refused"):
        Plc("127.0.0.1", port)


def test_what_makes_no_sense_is_not_sent(script):
    plc, server = script()
    for wrong, error in (
            (lambda: plc.d[-1], IndexError), (lambda: plc.d["x"], IndexError), (lambda: plc.d[1.5], IndexError),
            (lambda: plc.d[0:], IndexError), (lambda: plc.d[:4], IndexError), (lambda: plc.d[0:4:2], IndexError),
            (lambda: plc.d[4:0], IndexError), (lambda: plc.d.double[0:3], IndexError), (lambda: plc.d[1 << 24], ValueError),
            (lambda: plc.g[256][0], ValueError), (lambda: plc.d.__setitem__(0, 65536), ValueError),
            (lambda: plc.d.__setitem__(0, -32769), ValueError), (lambda: plc.d.__setitem__(0, [1]), TypeError),
            (lambda: plc.d.__setitem__(slice(0, 2), [1]), ValueError), (lambda: plc.d.__setitem__(slice(0, 2), 1), ValueError),
            (lambda: plc.y.__setitem__(slice(0, 2), [True]), ValueError), (lambda: plc.y.__setitem__(0, [True]), TypeError),
            (lambda: plc.d.double.__setitem__(0, 1 << 32), ValueError), (lambda: Plc(frame="2E"), ValueError),
            (lambda: plc.run(), ValueError), (lambda: plc.run(scans=1), PlcError), (lambda: plc.wait("X1"), PlcError)):
        with pytest.raises(error):
            wrong()
    assert plc.d[5:5] == [] and server.requests == []


def test_wait_of_a_plc_in_no_plant_asks_again(script):
    word = "d0 00 00 ff ff 03 00 04 00 00 00 {:02x} 00"
    plc, _ = script(*(word.format(n) for n in range(4)))
    assert plc.wait(lambda: plc.d[0] >= 3 and "there") == "there"
    with pytest.raises(TimeoutError, match="within 0 s"):
        plc.wait(lambda: False, timeout=0)


def test_the_cpus_name(script):
    name = b"R04CPU".ljust(16)
    plc, _ = script("d0 00 00 ff ff 03 00 14 00 00 00" + name.hex() + struct.pack("<H", 0x4800).hex())
    assert plc.cpu_name == "R04CPU"
