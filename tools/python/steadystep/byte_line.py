"""A line of bytes to a drive: a serial port, a pseudo-terminal, or TCP."""
import abc
import os
import select
import socket
import sys
import threading

import serial

from .errors import LostLink, WrongPort

BAUD = 921600
LOST_S = 3.0  # of silence, behind which a link is lost; programs on a busy machine stand still for a second or two
MOST_BYTES = 65536
PORT_ERRORS = (serial.SerialException, OSError, ValueError, TypeError)  # closed meanwhile, too


class ByteLine(abc.ABC):
    """What is open. Reads from one thread and writes from others; lost once, it stays lost."""

    def __init__(self, place: str) -> None:
        self.place = place

    @abc.abstractmethod
    def read(self, timeout_s: float) -> bytes:
        """What has come, b"" if nothing in that time; raises LostLink."""

    @abc.abstractmethod
    def write(self, data: bytes) -> None:
        """All of it; raises LostLink."""

    @abc.abstractmethod
    def close(self) -> None:
        """No more of it."""


class PortLine(ByteLine):
    """Of the operating system, whose errors it says in words."""

    def read(self, timeout_s: float) -> bytes:
        try:
            data = self._receive(timeout_s)
        except PORT_ERRORS as error:
            raise LostLink(f"{self.place}: {_reason(error)}") from None
        if data is None:
            return b""
        if not data:
            raise LostLink(f"{self.place}: the other end is gone")
        return data

    def write(self, data: bytes) -> None:
        try:
            self._send(data)
        except PORT_ERRORS as error:
            raise LostLink(f"{self.place}: {_reason(error)}") from None

    @abc.abstractmethod
    def _receive(self, timeout_s: float) -> bytes | None:
        """None: nothing in that time; b"": the other end is gone."""

    @abc.abstractmethod
    def _send(self, data: bytes) -> None:
        """All of it."""


class SerialLine(PortLine):
    def __init__(self, place: str) -> None:
        super().__init__(place)
        terminal = place.startswith("/dev/pts/") or os.path.realpath(place).startswith("/dev/pts/")
        try:
            # a pseudo-terminal has no rate, and some refuse to be locked
            self._port = serial.Serial(place, BAUD, timeout=0, write_timeout=LOST_S,
                                       exclusive=None if terminal else True)
        except (serial.SerialException, OSError, ValueError) as error:
            raise WrongPort(f"{place}: {_reason(error)}{_hint(place)}") from None

    def _receive(self, timeout_s: float) -> bytes | None:
        if sys.platform == "win32":  # select() knows sockets only
            self._port.timeout = timeout_s
            return bytes(self._port.read(max(1, self._port.in_waiting))) or None
        if not select.select([self._port.fileno()], [], [], timeout_s)[0]:
            return None
        return os.read(self._port.fileno(), MOST_BYTES)

    def _send(self, data: bytes) -> None:
        self._port.write(data)

    def close(self) -> None:
        self._port.close()


class TcpLine(PortLine):
    def __init__(self, place: str) -> None:
        super().__init__(place)
        scheme, _, address = place.partition("://")
        host, _, port = address.rpartition(":")
        if scheme != "tcp" or not host or not port.isdecimal() or not 0 < int(port) < 65536:
            raise WrongPort(f"{place}: expected tcp://HOST:PORT, or the name of a serial port")
        try:
            self._socket = socket.create_connection((host, int(port)), timeout=LOST_S)
        except OSError as error:
            raise WrongPort(f"{place}: {_reason(error)}; no drive is served there") from None
        self._socket.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)

    def _receive(self, timeout_s: float) -> bytes | None:
        if not select.select([self._socket], [], [], timeout_s)[0]:
            return None
        return self._socket.recv(MOST_BYTES)

    def _send(self, data: bytes) -> None:
        self._socket.sendall(data)

    def close(self) -> None:
        self._socket.close()


class PairedLine(ByteLine):
    """One of two ends within this program."""

    def __init__(self, place: str) -> None:
        super().__init__(place)
        self._other: "PairedLine | None" = None
        self._waiting = bytearray()
        self._changed = threading.Condition()
        self._gone = False

    @staticmethod
    def two(place: str) -> "tuple[PairedLine, PairedLine]":
        one, other = PairedLine(place), PairedLine(place)
        one._other, other._other = other, one
        return one, other

    def read(self, timeout_s: float) -> bytes:
        with self._changed:
            self._changed.wait_for(lambda: self._waiting or self._gone, timeout_s)
            if self._gone and not self._waiting:
                raise LostLink(f"{self.place}: the other end is gone")
            data = bytes(self._waiting)
            self._waiting.clear()
            return data

    def write(self, data: bytes) -> None:
        other = self._other
        if self._gone or other is None:
            raise LostLink(f"{self.place}: the other end is gone")
        with other._changed:
            other._waiting += data
            other._changed.notify()

    def close(self) -> None:
        for end in (self, self._other):
            if end is not None:
                with end._changed:
                    end._gone = True
                    end._changed.notify()


def open_line(place: str) -> ByteLine:
    """A port by its name, or tcp://HOST:PORT; raises WrongPort."""
    return TcpLine(place) if "://" in place else SerialLine(place)


def _reason(error: BaseException) -> str:
    number = getattr(error, "errno", None)
    if isinstance(number, int) and number > 0:
        return os.strerror(number)
    text = str(error)
    if "Could not configure port" in text:
        return "it is no serial port"
    return "another program has it open" if "exclusively lock" in text else text


def _hint(place: str) -> str:
    from serial.tools import list_ports

    ports = [port.device for port in list_ports.comports() if port.vid is not None]
    return "" if os.path.exists(place) else f"; serial adapters here: {', '.join(ports) or 'none'}"
