"""What can go wrong."""
from __future__ import annotations

_END_CODES = {
    0x4013: "not while the CPU is in RUN or PAUSE",
    0x4030: "the CPU has no such device",
    0x4031: "the device number is beyond the last one",
    0x4041: "the address is beyond the module's buffer memory",
    0x4043: "there is no intelligent function module at this head address",
    0x408B: "the CPU's parameters do not allow it",
    0xC051: "too many or too few bits in one request",
    0xC052: "too many or too few words in one request",
    0xC056: "the device number is beyond the last one",
    0xC059: "the CPU does not know this command or subcommand",
    0xC05B: "the CPU does not know this device",
    0xC05C: "bits of a word device, or another mistake in the request's contents",
    0xC05F: "the request is for another network or station",
    0xC060: "bit data other than 0 and 1",
    0xC061: "the length does not fit the request",
    0xC201: "the port is locked by a remote password",
}


class PlcError(Exception):
    """The PLC or the plant cannot be reached, does not answer, or refuses a request."""


class EndCodeError(PlcError):
    """The PLC refused a request; nothing has happened. `end_code` is its reason."""

    def __init__(self, end_code: int, request: str) -> None:
        meaning = _END_CODES.get(end_code, "see the CPU's manual")
        super().__init__(f"{request}: end code {end_code:04X}H: {meaning}")
        self.end_code = end_code


_END_CODES_1E = {
    0x50: "the CPU does not know this command",
    0x54: "the port takes ASCII text",
    0x55: "writing while the CPU runs is not enabled",
    0x56: "the CPU has no such device",
    0x57: "too many points in one request, or beyond the last one",
    0x58: "the device number is beyond the last one, or bits of a word device",
    0x5B: "the CPU refuses",
    0x60: "no answer from the CPU",
}


class EndCode1eError(EndCodeError):
    """The same in 1E frames: an end code of one byte, and with 5BH an abnormal code besides."""

    def __init__(self, end_code: int, abnormal_code: int, request: str) -> None:
        code = f"{end_code:02X}H" + (f" {abnormal_code:02X}H" if end_code == 0x5B else "")
        PlcError.__init__(self, f"{request}: end code {code}: {_END_CODES_1E.get(end_code, 'see the manual')}")
        self.end_code = end_code
        self.abnormal_code = abnormal_code


class PlantError(PlcError):
    """The plant could not be started, ended, or refused a request of its control server."""
