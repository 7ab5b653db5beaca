"""Plants of Canopus in this process: CANopen networks in virtual time, which passes only when the program says so.

    import canopus

    with canopus.Plant("plant.toml") as plant:
        plant.run(1.5)                                  # seconds of plant time
        print(plant.states())
        print(plant.sdo_upload(2, 0x1000))              # of node 2, as bytes
        plant.plc.g[0][13000] = 0x5A                    # buffer memory; likewise x y m d ...

Besides: `DeviceFile` reads and writes EDS and DCF, `Master` is a CANopen master on a plant's bus or a real one, `decode` and `draw` say
and show what a trace means, `canopus.python_can` brings a plant's buses to python-can, `pytest_canopus` plants to pytest.

`canopus_plc` has the same for a plant in a process of its own, and for a real PLC; words, bits, conditions and errors are the same.
"""
from canopus_plc.errors import PlantError, PlcError

from .device_file import DeviceFile, DeviceFileError, DeviceObject, ObjectEntry, Pdo
from .master import BootResult, Master, ReceivedPdo, Subscription
from .picture import Picture, draw
from .plant import Device, Frame, Plant, Port, SdoAbort
from .trace import decode

__all__ = ["BootResult", "Device", "DeviceFile", "DeviceFileError", "DeviceObject", "Frame", "Master", "ObjectEntry", "Pdo", "Picture",
           "Plant", "PlantError", "PlcError", "Port", "ReceivedPdo", "SdoAbort", "Subscription", "decode", "draw"]
