"""Whose transfer an SDO server is in: it has one at a time, and clients that know nothing of one another."""
import collections
import time
from typing import Generic, TypeVar

from .sdo_marker import Markers

ABORT, BLOCK_END = 0x80, 0xA1
BLOCKS = BLOCK_DOWNLOAD, BLOCK_UPLOAD = 6, 5  # of a request's first byte, the upper three bits

Client = TypeVar("Client")


class Turns(Generic[Client]):
    """Requests and responses by their first bytes. Who waits does so with its request."""

    def __init__(self) -> None:
        self.owner: Client | None = None
        self.waiting: collections.deque[tuple[Client, bytes]] = collections.deque()
        self.heard_s = 0.0
        self.markers = Markers()
        self.is_late = False  # an answer to what its client has given up may come yet, and is for nobody
        self._request = 0
        self._block = 0

    def take(self, client: Client, request: int) -> bool:
        """false: another's turn, or nobody's yet."""
        if self.is_late or self.owner not in (None, client):
            return False
        is_begun = self.owner is not None
        if self.owner is None or (self._block == 0 and request >> 5 in BLOCKS):
            self._block = request >> 5 if request >> 5 in BLOCKS else 0
        self.owner, self._request, self.heard_s = client, request, time.monotonic()
        # what is sent in a block begins with a number, which may look like an end
        if request == ABORT:
            self.is_late = is_begun
            self._end()
        elif self._block == BLOCK_UPLOAD and request == BLOCK_END:
            self._end()
        return True

    def wait(self, client: Client, request: int, text: bytes) -> None:
        """For its turn. One that asks anew, or gives up, does not want its earlier request any more."""
        self.waiting = collections.deque(one for one in self.waiting if one[0] is not client)
        if request != ABORT:
            self.waiting.append((client, text))

    def hear(self, response: int) -> None:
        self.heard_s = time.monotonic()
        if self._block == BLOCK_UPLOAD and not self._request & 3 and response >> 5 == 2:
            self._block = 0  # the server prefers no block
        if self._block:
            is_over = self._block == BLOCK_DOWNLOAD and response == BLOCK_END
        else:
            is_over = self._ends(response)
        if response == ABORT or is_over:
            self._end()

    def _ends(self, response: int) -> bool:
        kind = response >> 5
        if kind == 2:  # upload begins: all of it, or segments
            return bool(response & 2)
        if kind == 0:  # of an upload's segments the last
            return bool(response & 1)
        if kind == 3:  # download begins
            return bool(self._request & 2)
        return bool(self._request & 1)

    def _end(self) -> None:
        self.owner, self._block = None, 0

    def mark(self) -> bytes:
        """A request whose answer is behind what is late."""
        self.heard_s = time.monotonic()
        return self.markers.request()

    def passes(self, response: bytes) -> None:
        """One that is for nobody."""
        self.is_late = not self.markers.is_answered_by(response)

    def leave(self, client: Client) -> None:
        if self.owner is client:
            self.is_late = True
            self._end()
        self.waiting = collections.deque(one for one in self.waiting if one[0] is not client)
