"""The RJ71CN91 over SLMP: its words, signals and commands are those of the ME3CAN1-Q, so that example's functions are used.

    module = Rj71Cn91(Plc("127.0.0.1", 5007), head=0x00)

What it does otherwise: YF clears errors (G29 takes no writes), there is no G40, and going online in a Layer 2 mode takes the bit
rate of G24 over. Numbers in parentheses are sections of the MELSEC iQ-R CANopen Module User's Manual (Application).
"""
import pathlib
import sys

sys.path.append(str(pathlib.Path(__file__).resolve().parents[1] / "me3can1-q"))
from me3can1q import OWN_NODE, START, Me3Can1Q, ModuleError, Plc, number, receive_word, transmit_word, u32  # noqa: E402,F401

# Bits of G29 (5.3)
ERROR_BITS = {1: "hardware error", 3: "bus-off", 4: "flash ROM error", 5: "save or restore while online",
              6: "value out of range", 8: "send or receive buffer overflow", 15: "message slot error"}


class Rj71Cn91(Me3Can1Q):
    def check(self):
        """ModuleError with the meaning of G29 that turns XF on, and the address in G39."""
        bits = self.g(29)
        names = [name for bit, name in ERROR_BITS.items() if bits >> bit & 1]
        if names:
            raise ModuleError(f"G29 = {bits:04X}H: {', '.join(names)}, G39 = {self.g(39)}")

    def clear_errors(self):
        """YF (App. 1)."""
        self.y(0x0F, True)
        self.y(0x0F, False)

    def go_online(self):
        """Y3; G29.6 and G39 name a setting that keeps the module offline (App. 1 Y3)."""
        self.y(0x03, True)
        self.wait(lambda: self.x(0x03) or self.g(29), "X3", 2)
        self.check()
