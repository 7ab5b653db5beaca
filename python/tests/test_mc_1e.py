"""1E frames byte by byte, against a server that knows nothing but what it is to answer."""
import struct

import pytest

from canopus_plc import EndCode1eError, PlcError
from canopus_plc.mc import DEVICES
from test_mc import script  # noqa: F401  (a fixture)


@pytest.fixture
def fx(script):  # noqa: F811
    return lambda *replies: script(*replies, frame="1E")


def test_words_are_read_as_the_manual_shows(fx):
    plc, server = fx("81 00 34 12 02 00 ef 1d")
    assert plc.d[100:103] == [0x1234, 0x0002, 0x1DEF]
    assert server.requests == ["01 ff 00 00 64 00 00 00 20 44 03 00"]


def test_words_are_written(fx):
    plc, server = fx("83 00")
    plc.d[100:103] = [0x1234, 0x9876, -1]
    assert server.requests == ["03 ff 00 00 64 00 00 00 20 44 03 00 34 12 76 98 ff ff"]


def test_bits_are_read_and_written_in_pairs(fx):
    plc, server = fx("80 00 10 11 10", "82 00")
    assert plc.m[100:105] == [True, False, True, True, True]
    plc.y[8:11] = [True, False, True]
    assert server.requests == ["00 ff 00 00 64 00 00 00 20 4d 05 00", "02 ff 00 00 08 00 00 00 20 59 03 00 10 10"]


def test_buffer_memory_counts_bytes(fx):
    plc, server = fx("8e 00 01 00 ff ff", "8f 00")
    assert plc.g[2][25:27] == [1, 0xFFFF]
    plc.g[0][10000] = 0x0102
    assert server.requests == ["0e ff 00 00 32 00 00 04 02 00", "0f ff 00 00 20 4e 00 02 00 00 02 01"]


def test_many_points_are_several_requests(fx):
    first = "81 00" + bytes(128).hex()
    plc, server = fx(first, "81 00" + struct.pack("<6H", *range(6)).hex(), "81 00" + bytes(20).hex(), "81 00 07 00")
    assert plc.d[0:70] == [0] * 64 + list(range(6))
    assert plc.mc.read_words(DEVICES["M"], 0, 11) == [0] * 10 + [7]  # an FX3 reads 160 bits at once
    assert server.requests[1:] == ["01 ff 00 00 40 00 00 00 20 44 06 00", "01 ff 00 00 00 00 00 00 20 4d 0a 00",
                                   "01 ff 00 00 a0 00 00 00 20 4d 01 00"]


def test_contacts_and_current_values_have_names_of_two_letters(fx):
    plc, server = fx("81 00 05 00", "80 00 10")
    assert plc.tn[3] == 5
    assert plc.cs[1] is True
    assert server.requests == ["01 ff 00 00 03 00 00 00 4e 54 01 00", "00 ff 00 00 01 00 00 00 53 43 01 00"]


def test_refusals_have_an_end_code_and_an_abnormal_code(fx):
    plc, _ = fx("81 5b 10 00", "81 56", "81 00 01 00")
    with pytest.raises(EndCode1eError, match=r"read D0: end code 5BH 10H: the CPU refuses") as refused:
        plc.d[0]
    assert (refused.value.end_code, refused.value.abnormal_code) == (0x5B, 0x10)
    with pytest.raises(EndCode1eError, match="end code 56H"):
        plc.d[1]
    assert plc.d[2] == 1  # the connection goes on


def test_another_answer_closes_the_connection(fx):
    plc, _ = fx("83 00")
    with pytest.raises(PlcError, match="starts with 83 00"):
        plc.d[0]
    with pytest.raises(PlcError, match="is closed"):
        plc.d[0]


def test_run_stop_and_model(fx):
    plc, server = fx("93 00", "94 00", "95 00 f3 00")
    plc.remote_run()
    plc.remote_stop()
    assert plc.cpu_name == "FX3U"
    assert server.requests == ["13 ff 00 00", "14 ff 00 00", "15 ff 00 00"]


def test_what_1e_frames_cannot_say_is_not_sent(fx):
    plc, server = fx()
    for wrong, error in ((lambda: plc.sd[0], ValueError), (lambda: plc.zr[0], ValueError), (lambda: plc.cn[200], ValueError),
                         (lambda: plc.cn[199:201], ValueError), (lambda: plc.remote_pause(), PlcError),
                         (lambda: plc.g[256][0], ValueError), (lambda: plc.g[0][1 << 23], ValueError)):
        with pytest.raises(error):
            wrong()
    assert server.requests == []
