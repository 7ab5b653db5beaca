"""The plant of the benches and checks that need a full bus: an RJ71CN91 and 125 encoders that send a PDO every 15 ms each, at 1 Mbit/s: 8,400 frames
a second. The master does not pause between the starts of two nodes, so that all are operational at once."""
import pathlib

ROOT = pathlib.Path(__file__).resolve().parent.parent
NODES = 126


def plant_text():
    text = ['[plant]\nname = "126 nodes"\n\n[[bus]]\nname = "line1"\nbit_rate = 1_000_000\n']
    for node in range(2, NODES + 1):
        text.append(f'[[device]]\nnode = {node}\nname = "encoder {node}"\neds = "{ROOT}/examples/devices/encoder.eds"\n'
                    'objects = { "1017:00" = 1000, "1800:05" = 15, "1801:01" = ' f'0x{0x80000280 + node:08X} }}\n')
    text.append('[[plc]]\n\n[[plc.module]]\nmodel = "RJ71CN91"\nhead = 0\nnode = 1\nmaster = true\nslaves = "all"\nexchange = "20ms"\n'
                'buffer = { G70 = 0 }\n')
    return "\n".join(text)
