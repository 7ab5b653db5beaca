"""python3-pymodbus against the AS300 of examples/as-fcopm: as_fcopm_pymodbus.py HOST PORT"""
import sys
import time

from pymodbus.client import ModbusTcpClient

SR = 0xC000
client = ModbusTcpClient(sys.argv[1], port=int(sys.argv[2]), timeout=60)
assert client.connect()


def read(first, count=1):
    answer = client.read_holding_registers(first, count, slave=1)
    assert not answer.isError(), answer
    return answer.registers


def write(first, words):
    assert not client.write_registers(first, words, slave=1).isError()


def until(what, condition):
    end = time.monotonic() + 60
    while not condition():
        assert time.monotonic() < end, what
        time.sleep(0.02)


def ask(words):
    """A request in one write; its answer."""
    write(25000, words)
    until(f"no answer to {words}", lambda: read(24000)[0] >> 8 == words[0] >> 8 and read(24000)[0] & 0xFF != 2)
    return read(24000, 24)


until("an emergency message", lambda: read(SR + 831) == [0xE0])
assert read(SR + 822) == [1000]
assert read(SR + 826) == [2]
write(25032, [0x000F, 1500, 0, 0x0201])
until("the drive turns", lambda: read(24033, 2) == [1500, 0])
assert ask([0x0101, 4, 0x0103, 0x6083, 0, 0, 0])[:7] == [0x0101, 8, 0x4303, 0x6083, 0, 2000, 0]
assert ask([0x0201, 8, 0x0203, 0x6083, 0, 3000, 0])[:7] == [0x0201, 4, 0x6003, 0x6083, 0, 0, 0]
assert ask([0x0301, 4, 0x0103, 0x6083, 0, 0, 0])[:7] == [0x0301, 8, 0x4303, 0x6083, 0, 3000, 0]
assert ask([0x0401, 4, 0x0103, 0x9999, 0, 0, 0])[:7] == [0x040A, 8, 0x8003, 0x9999, 0, 0x0000, 0x0602]
assert ask([0x0501, 0, 0x0402, 0, 0, 0, 0])[:8] == [0x0501, 42, 0x0402, 0x0101, 0x5443, 0x1420, 0, 0]
assert ask([0x0601, 4, 0x0303, 2, 3, 0, 0])[:3] == [0x0601, 0, 3]
write(25033, [1000])
time.sleep(0.3)
assert read(24033) == [1500], "the drive is stopped"
assert ask([0x0701, 4, 0x0303, 1, 3, 0, 0])[:3] == [0x0701, 0, 3]
until("the drive turns again", lambda: read(24033) == [1000])
client.close()
print("all held")
