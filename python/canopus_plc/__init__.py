"""A PLC over the MC protocol, and plants of Canopus that a program or a test drives scan by scan.

    from canopus_plc import Plant

    with Plant("plant.toml") as plant:          # canopus run plant.toml --virtual --step
        plc = plant.plc
        plc.g[0][13000:13004] = [1, 2, 3, 4]    # buffer memory of the module with head address X/Y00
        plc.y[1] = True
        plc.wait(lambda: plc.x[1])
        plc.run(scans=100)
        print(plc.d[100], plc.d.signed[101], plc.m[0:8])

`Plc` alone talks to any PLC that speaks 3E, 4E or 1E frames in binary code, a real one as well. Standard library only.
"""
from .errors import EndCode1eError, EndCodeError, PlantError, PlcError
from .mc import McClient
from .mc_1e import Mc1eClient
from .plant import Plant
from .plc import Plc

__all__ = ["EndCode1eError", "EndCodeError", "Mc1eClient", "McClient", "Plant", "PlantError", "Plc", "PlcError"]
