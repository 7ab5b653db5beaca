"""python3-pymodbus against a rack: modbus_pymodbus.py HOST PORT"""
import sys

from pymodbus.client import ModbusTcpClient

client = ModbusTcpClient(sys.argv[1], port=int(sys.argv[2]), timeout=60)
assert client.connect()
assert not client.write_registers(730, [1, 2, 65535], slave=1).isError()
assert client.read_holding_registers(730, 3, slave=1).registers == [1, 2, 65535]
assert not client.write_register(731, 7, slave=1).isError()
assert client.read_holding_registers(731, 1, slave=1).registers == [7]
assert not client.write_coils(0x130, [True, False, True], slave=1).isError()
assert client.read_coils(0x130, 3, slave=1).bits[:3] == [True, False, True]
assert not client.write_coil(0x130, False, slave=1).isError()
assert len(client.read_discrete_inputs(0, 16, slave=1).bits) == 16
assert client.read_input_registers(203, 1, slave=1).registers == [0]
assert client.read_holding_registers(65000, 1, slave=1).isError()
client.close()
print("all held")
