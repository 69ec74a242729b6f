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

from .byte_line import LOST_S, ByteLine
from .dictionary import EDS
from .errors import LostLink, Refused, WrongPort
from .sdo_marker import AGAIN_S, Markers
from .text_bus import TextBus

logging.getLogger("canopen").addHandler(logging.NullHandler())  # what it says is raised here

OUT_OF_RANGE, WRONG_STATE, STORE_FAILED = 0x06090030, 0x08000022, 0x06060000
ANSWER_S, TRIES = LOST_S - AGAIN_S, 1  # behind which a request is given up; the rest of the time is for finding out why
PATIENCE_S = 10.0  # with a server that serves another program
END = bytes([0x80, 0, 0, 0, 0xFF, 0xFF, 0xFF, 0xFF])  # ends what waits for a response when there will be none

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
        if not 1 <= node <= 127:
            raise Refused(f"node: expected a number in 1…127, got {node}")
        self.number = node
        self.bus = TextBus(line)
        self.network = canopen.Network(self.bus)
        self.node = canopen.RemoteNode(node, str(EDS))
        self.network.add_node(self.node)
        self.network.NOTIFIER_CYCLE = 0.1  # closing waits for so long
        self.network.connect()
        self.node.sdo.RESPONSE_TIMEOUT, self.node.sdo.MAX_RETRIES = ANSWER_S, TRIES
        self.bus.on_end = lambda: self.node.sdo.responses.put(END)
        self._lock = threading.RLock()
        self._markers, self._begun_s = Markers(), 0.0
        self._is_late = False  # an answer to what has been given up may come yet
        self.closed = ""  # why
        self.is_capturing = False
        try:
            self.read(0x1000)
        except LostLink:
            heard = sorted(set(self.network.scanner.nodes))
            self.close()
            raise WrongPort(f"{line.place}: node {node} does not answer; heard: "
                            f"{', '.join(map(str, heard)) or 'none'}") from None

    def close(self, why: str = "the drive has been closed; open it again") -> None:
        if not self.closed:
            self.closed = why
            self.network.disconnect()

    @property
    def others(self) -> list[int]:
        """Nodes on the line that have been heard beside this one, by what only a node sends."""
        return sorted({*self.network.scanner.nodes} - {0, self.number})

    @property
    def entries(self) -> Any:
        return self.node.object_dictionary

    def _variable(self, index: int, sub: int) -> Any:
        entry = self.node.sdo[index]
        return entry if isinstance(entry.od, ODVariable) else entry[sub]

    def read(self, index: int, sub: int = 0) -> Any:
        return self._asked(lambda: self._variable(index, sub).raw)

    def write(self, index: int, value: Number, sub: int = 0) -> None:
        def put() -> None:
            try:
                self._variable(index, sub).raw = value
            except (ValueError, OverflowError, struct.error):
                raise OutOfRange("out of range") from None  # of the object's type

        self._asked(put)

    def _asked(self, work: Callable[[], Any]) -> Any:
        """Anew, if the request or its answer was lost on a line that is alive."""
        end = time.monotonic() + PATIENCE_S
        while True:
            try:
                with self.transfer():
                    return work()
            except NoAnswer:
                if time.monotonic() > end:
                    raise

    def send_controlword(self, word: int) -> None:
        """By RPDO1, as it is mapped unless a client has mapped something else; then it is passed over."""
        self.check()
        self.network.send_message(0x200 + self.number, word.to_bytes(2, "little"))

    def check(self) -> None:
        """Raises LostLink if there is no link any more."""
        if self._is_over:
            raise self._loss("")

    def ask_console(self, *lines: str) -> list[str]:
        """Its answers; fewer, or none, where it does not answer, where other nodes are on the line, whose console it may be, or
        while process data is captured. For all programs the channel is as if it had just been opened."""
        if self.others or self.is_capturing:
            return []
        with self._lock:
            self._pass_what_is_late()
            answers = self.bus.ask_console(lines)
            self.node.nmt.state = "OPERATIONAL"
        return answers

    @contextlib.contextmanager
    def transfer(self) -> Iterator[None]:
        """Raises LostLink, OutOfRange or Refused for what python-canopen does."""
        with self._lock:
            self._pass_what_is_late()
            self._begun_s = time.monotonic()
            try:
                yield
            except SdoError as error:
                if _hides_an_interrupt(error):
                    self._give_up()
                    raise KeyboardInterrupt from None
                if isinstance(error, SdoAbortedError) and not self._is_over:
                    raise self._refusal(error) from None
                self._is_late = True
                raise self._loss(str(error)) from None
            except Refused:  # by this package
                raise
            except BaseException:
                if self.closed:  # by another thread, in the midst of it
                    raise self._loss("") from None
                self._give_up()
                raise

    def _give_up(self) -> None:
        self._is_late = True
        self.node.sdo.abort()

    @property
    def _is_over(self) -> bool:
        return bool(self.closed) or self.bus.lost is not None or self.bus.restarted

    def _pass_what_is_late(self) -> None:
        """With the answer to a marker it has come. While others are heard, the marker waits for its turn."""
        begin = time.monotonic()
        while self._is_late and not self._is_over:
            self._is_late = not self._is_marker_answered()
            if self._is_over:
                break
            now = time.monotonic()
            silent_s = now - max(self._begun_s, self.bus.heard_s.get(self.number, 0.0))
            if self._is_late and (silent_s >= LOST_S or now - begin > PATIENCE_S):
                raise LostLink(f"{self.bus.channel_info}: the drive does not answer any more")
        self.check()

    def _is_marker_answered(self) -> bool:
        sdo = self.node.sdo
        sdo.abort()
        sdo.send_request(self._markers.request())
        end = time.monotonic() + AGAIN_S
        while not self._is_over:
            try:
                if self._markers.is_answered_by(sdo.responses.get(timeout=max(end - time.monotonic(), 0.0))):
                    return True
            except queue.Empty:
                return False
        return False

    def _refusal(self, error: SdoAbortedError) -> Refused:
        if error.code == OUT_OF_RANGE:
            return OutOfRange("out of range")
        if error.code == WRONG_STATE:
            return Refused("not in the state that the drive is in")
        if error.code == STORE_FAILED:
            return Refused("it could not be stored; not while a sine or set-points go on")
        return Refused(str(error))

    def _loss(self, said: str) -> LostLink:
        if self.closed:
            return LostLink(f"{self.bus.channel_info}: {self.closed}")
        if self.bus.lost:
            return self.bus.lost
        if self.bus.restarted:
            return LostLink(f"{self.bus.channel_info}: the drive has restarted; connect anew")
        return NoAnswer(f"{self.bus.channel_info}: the drive does not answer any more: {said}")
