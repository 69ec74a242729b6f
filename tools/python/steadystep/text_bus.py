"""CAN frames as text (slcan) on a line of bytes, as a bus of python-can."""
import collections
import threading
import time
from typing import Any, Callable, Sequence

import can

from .byte_line import LOST_S, ByteLine
from .errors import LostLink, WrongPort

NODE_BITS = 0x07F
ENDS = b"\r\n\a"


def frame_text(frame: can.Message) -> bytes:
    return b"t%03X%d%s\r" % (frame.arbitration_id, frame.dlc, frame.data.hex().upper().encode())


def frame_of(text: bytes) -> can.Message | None:
    """None: it is no frame with an identifier of 11 bits."""
    try:
        if text[:1] != b"t" or len(text) != 5 + 2 * int(text[4:5]):
            return None
        return can.Message(arbitration_id=int(text[1:4], 16), is_extended_id=False,
                           data=bytes.fromhex(text[5:].decode()), timestamp=time.time())
    except ValueError:
        return None


class Pieces:
    """Bytes as they come, by what ends with a carriage return, a line feed or a bell."""

    def __init__(self) -> None:
        self._rest = b""

    def of(self, data: bytes) -> list[tuple[bytes, bytes]]:
        """(text, its end) of each."""
        pieces, begin = [], 0
        data = self._rest + data
        for place, byte in enumerate(data):
            if byte in ENDS:
                pieces.append((data[begin:place], data[place:place + 1]))
                begin = place + 1
        self._rest = data[begin:][-4096:]
        return pieces


class TextBus(can.BusABC):
    """Opens the drive's channel; `lost` says why there is none any more."""

    def __init__(self, line: ByteLine, **kwargs: Any) -> None:
        self.line = line
        self._frames: collections.deque[can.Message] = collections.deque()
        self._pieces = Pieces()
        self._lock = threading.Lock()
        self._said = threading.Condition()
        self._answer = ""
        self.lost: LostLink | None = None
        self.restarted = False
        self.on_end: Callable[[], object] = lambda: None  # of either
        self.heard_s: dict[int, float] = {}  # the last frame of each node, or to it
        super().__init__(channel=line.place, **kwargs)
        self.channel_info = line.place
        try:
            self._open()
        except WrongPort:
            super().shutdown()
            line.close()
            raise

    def _ask(self, command: bytes, answers: tuple[bytes, ...]) -> bool:
        self.line.write(command)
        end = time.monotonic() + LOST_S
        while time.monotonic() < end:
            for text, ending in self._pieces.of(self.line.read(max(0.0, end - time.monotonic()))):
                if ending == b"\r" and text.startswith(answers):
                    return True
        return False

    def _open(self) -> None:
        """What an earlier client left behind is answered before V is."""
        try:
            if not self._ask(b"\rV\r", (b"V1010",)):
                raise WrongPort(f"{self.line.place}: no drive answers; is it a steadystep drive, powered, at 921600 "
                                "baud, and not in use by another program?")
            self.line.write(b"S6\rO\r")
        except LostLink as error:
            raise WrongPort(str(error)) from None

    def _recv_internal(self, timeout: float | None) -> tuple[can.Message | None, bool]:
        end = time.monotonic() + (1.0 if timeout is None else timeout)
        while not self._frames:
            left = end - time.monotonic()
            if left < 0:
                return None, False
            if self.lost:
                time.sleep(left)
                return None, False
            try:
                self._take(self.line.read(left))
            except LostLink as error:
                self._end(error)
        return self._frames.popleft(), False

    def _take(self, data: bytes) -> None:
        for text, ending in self._pieces.of(data):
            frame = frame_of(text) if ending == b"\r" else None
            if frame is not None:
                self.heard_s[frame.arbitration_id & NODE_BITS] = time.monotonic()
                self._frames.append(frame)
            elif ending == b"\n" and text.startswith(b"steadystep "):
                self.restarted = True  # it announces itself on its console: the channel is closed
                self.on_end()
            elif ending == b"\n" and text.startswith((b"ok", b"error:")):
                with self._said:
                    self._answer = text.decode(errors="replace")
                    self._said.notify_all()

    def ask_console(self, lines: Sequence[str]) -> list[str]:
        """The answers to lines of the console, up to the first that has none. The channel is closed for them, and opened
        anew."""
        answers: list[str] = []
        self._put(b"C\r")
        for line in lines:
            self._answer = ""
            self._put(line.encode() + b"\n")
            with self._said:
                self._said.wait_for(lambda: self._answer or self.lost, LOST_S)
            if not self._answer:
                break
            answers.append(self._answer)
        self._put(b"O\r")
        return answers

    def send(self, msg: can.Message, timeout: float | None = None) -> None:
        self._put(frame_text(msg))

    def _put(self, data: bytes) -> None:
        try:
            with self._lock:
                self.line.write(data)
        except LostLink as error:
            self._end(error)

    def _end(self, error: LostLink) -> None:
        self.lost = error
        self.on_end()

    def shutdown(self) -> None:
        """The drive goes on with what it does."""
        if not self._is_shutdown:
            super().shutdown()
            try:
                self.line.write(b"C\r")
            except LostLink:
                pass
            self.line.close()
