"""A client's access to a drive's objects over SDO: one at a time, and errors in words."""
import contextlib
import logging
import queue
import struct
import threading
import time
from typing import Any, Callable, Iterator

import canopen
from canopen.objectdictionary import ODVariable
from canopen.sdo.exceptions import SdoAbortedError, SdoError

from .byte_line import ByteLine
from .dictionary import EDS
from .errors import LostLink, Refused, WrongPort
from .text_bus import TextBus

logging.getLogger("canopen").addHandler(logging.NullHandler())  # what it says is raised here

OUT_OF_RANGE, WRONG_STATE, STORE_FAILED = 0x06090030, 0x08000022, 0x06060000
RESPONSE_S, TRIES = 0.5, 1
LATE_S = 2.0  # of a response behind an abort
UPLOAD, UPLOADED = 0x40, 0x43  # command bytes of CiA 301, of four bytes
PATIENCE_S, SILENCE_S = 10.0, 0.4  # with a server that serves another program; of a line that is dead

Number = bool | int | float | str


class NoAnswer(LostLink):
    """To a request; the line may be alive."""


class OutOfRange(Refused):
    """The value of an object."""


def _hides_an_interrupt(error: BaseException) -> bool:
    """What is written in segments is closed by one more, which the drive refuses behind an interrupt."""
    cause = error.__context__
    return cause is not None and (isinstance(cause, KeyboardInterrupt) or _hides_an_interrupt(cause))


class Objects:
    """A node on a line. Threads take turns."""

    def __init__(self, line: ByteLine, node: int) -> None:
        self.number = node
        self.bus = TextBus(line)
        self.network = canopen.Network(self.bus)
        self.node = canopen.RemoteNode(node, str(EDS))
        self.network.add_node(self.node)
        self.network.NOTIFIER_CYCLE = 0.1  # closing waits for so long
        self.network.connect()
        self.node.sdo.RESPONSE_TIMEOUT, self.node.sdo.MAX_RETRIES = RESPONSE_S, TRIES
        self._lock = threading.RLock()
        try:
            self.read(0x1000)
        except LostLink:
            heard = sorted(set(self.network.scanner.nodes))
            self.close()
            raise WrongPort(f"{line.place}: node {node} does not answer; heard: "
                            f"{', '.join(map(str, heard)) or 'none'}") from None

    def close(self) -> None:
        self.network.disconnect()

    @property
    def entries(self) -> Any:
        return self.node.object_dictionary

    def _variable(self, index: int, sub: int) -> Any:
        entry = self.node.sdo[index]
        return entry if isinstance(entry.od, ODVariable) else entry[sub]

    def read(self, index: int, sub: int = 0) -> Any:
        return self._asked(lambda: self._variable(index, sub).raw)

    def write(self, index: int, value: Number, sub: int = 0) -> None:
        self._asked(lambda: setattr(self._variable(index, sub), "raw", value))

    def _asked(self, work: Callable[[], Any]) -> Any:
        """While others are heard, one that gets no answer waits for its turn."""
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                with self.transfer():
                    return work()
            except NoAnswer:
                if time.monotonic() > end or time.monotonic() - self.bus.heard_s > SILENCE_S:
                    raise

    def send_controlword(self, word: int) -> None:
        """By RPDO1, as it is mapped unless a client has mapped something else; then it is passed over."""
        self.network.send_message(0x200 + self.number, word.to_bytes(2, "little"))

    @contextlib.contextmanager
    def transfer(self) -> Iterator[None]:
        """Raises LostLink, OutOfRange or Refused for what python-canopen does."""
        with self._lock:
            try:
                yield
            except KeyboardInterrupt:
                self._give_up()
                raise
            except SdoError as error:
                if _hides_an_interrupt(error):
                    self._give_up()
                    raise KeyboardInterrupt from None
                if isinstance(error, SdoAbortedError):
                    raise self._refusal(error) from None
                raise self._loss(str(error)) from None

    def _give_up(self) -> None:
        """What was asked is answered yet, perhaps, and would pass for the response to the next request. So a request of its own
        is behind it: with its response all that came before has come."""
        if self.bus.lost:
            return
        sdo, end = self.node.sdo, time.monotonic() + LATE_S
        sdo.abort()
        asked = struct.pack("<BHB4x", UPLOAD, 0x1000, 0)
        sdo.send_request(asked)
        with contextlib.suppress(queue.Empty):
            while sdo.responses.get(timeout=max(end - time.monotonic(), 0.0))[:4] != bytes([UPLOADED]) + asked[1:4]:
                pass

    def _refusal(self, error: SdoAbortedError) -> Refused:
        if error.code == OUT_OF_RANGE:
            return OutOfRange("out of range")
        if error.code == WRONG_STATE:
            return Refused("not in the state that the drive is in")
        if error.code == STORE_FAILED:
            return Refused("it could not be stored; not while a sine or set-points go on")
        return Refused(str(error))

    def _loss(self, said: str) -> LostLink:
        if self.bus.lost:
            return self.bus.lost
        if self.bus.restarted:
            return LostLink(f"{self.bus.channel_info}: the drive has restarted; connect anew")
        return NoAnswer(f"{self.bus.channel_info}: the drive does not answer any more: {said}")
