"""python3-pymodbus as somebody's hands: modbus_words.py HOST PORT, then a line of the standard input each:
read ADDRESS COUNT -> the words; write ADDRESS WORD... -> ok. Addresses are decimal, words hexadecimal; a refusal is "exception N"."""
import sys

from pymodbus.client import ModbusTcpClient

client = ModbusTcpClient(sys.argv[1], port=int(sys.argv[2]), timeout=60)
assert client.connect()
for line in sys.stdin:
    what, address, *fields = line.split()
    if what == "read":
        answer = client.read_holding_registers(int(address), int(fields[0]), slave=1)
        said = "exception" if answer.isError() else " ".join(f"{word:04X}" for word in answer.registers)
    else:
        words = [int(word, 16) for word in fields]
        answer = (client.write_register(int(address), words[0], slave=1) if len(words) == 1
                  else client.write_registers(int(address), words, slave=1))
        said = "exception" if answer.isError() else "ok"
    print(said if said != "exception" else f"exception {answer.exception_code}", flush=True)
client.close()
