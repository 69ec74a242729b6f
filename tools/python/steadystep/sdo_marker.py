"""The end of the answers to requests that were given up. An SDO answer does not say which request it is for, so one that comes
late would pass for the next one's. A marker is a request for an object that no drive has: its refusal bears the marker's
number, and with it all that was asked before has been answered or never will be."""
import struct

UPLOAD, REFUSED = 0x40, 0x80
NO_INDEX, NUMBERS = 0x0000, 256  # reserved by CiA 301; numbers stand in the sub-index
AGAIN_S = 1.0  # one that is lost on the way is asked for anew


class Markers:
    """Of one client of a server."""

    def __init__(self) -> None:
        self._number = 0

    def request(self) -> bytes:
        """The next one."""
        self._number = (self._number + 1) % NUMBERS
        return struct.pack("<BHB4x", UPLOAD, NO_INDEX, self._number)

    def is_answered_by(self, response: bytes) -> bool:
        return response[:4] == struct.pack("<BHB", REFUSED, NO_INDEX, self._number)
