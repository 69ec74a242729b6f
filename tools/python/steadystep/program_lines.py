"""Where programs come in that share a drive. None of them can make the others wait: what is for one that does not
read is lost, as on a wire."""
import contextlib
import os
import pathlib
import select
import socket
import time

from .byte_line import ByteLine, TcpLine
from .errors import LostLink, WrongPort


# A page of any origin makes a browser send what it likes behind one of these.
HTTP = tuple(method + b" " for method in (b"GET", b"HEAD", b"POST", b"PUT", b"DELETE", b"OPTIONS", b"PATCH", b"TRACE", b"CONNECT"))


class ProgramLine(TcpLine):
    """A program that has connected. A browser is none: its line ends before anything of it is read."""

    def __init__(self, connected: socket.socket) -> None:
        ByteLine.__init__(self, "tcp://%s:%d" % connected.getpeername()[:2])
        connected.setsockopt(socket.IPPROTO_TCP, socket.TCP_NODELAY, 1)
        self._socket = connected
        self._begin: bytes | None = b""  # None: it is a program's

    def _receive(self, timeout_s: float) -> bytes | None:
        data = super()._receive(timeout_s)
        if not data or self._begin is None:
            return data
        self._begin += data
        if self._begin.startswith(HTTP):
            self.close()
            return b""
        if any(one.startswith(self._begin) for one in HTTP):
            return None  # not known yet
        data, self._begin = self._begin, None
        return data

    def write(self, data: bytes) -> None:
        try:
            sent = self._socket.send(data, socket.MSG_DONTWAIT)
        except BlockingIOError:
            return
        except OSError as error:
            raise LostLink(f"{self.place}: {error}") from None
        if sent < len(data):
            self.close()  # half a frame is no frame
            raise LostLink(f"{self.place}: it does not read")


class TerminalLine(ByteLine):
    """The inner end of a pseudo-terminal, with a link to the other. It is quiet while nobody has that open."""

    def __init__(self, link: str) -> None:
        import termios
        import tty

        super().__init__(link)
        self._inner, outer = os.openpty()
        tty.setraw(outer, termios.TCSANOW)
        os.set_blocking(self._inner, False)
        self._path, self._name = pathlib.Path(link), os.ttyname(outer)
        try:
            self._link()
        except OSError as error:
            os.close(self._inner)
            raise WrongPort(f"{link}: {error.strerror}") from None
        except WrongPort:
            os.close(self._inner)
            raise
        finally:
            os.close(outer)
        self.closed = False

    def _link(self) -> None:
        """In the place of one whose server has gone, and its terminal with it."""
        if self._path.is_symlink():
            if self._path.exists() and os.readlink(self._path) != self._name:
                raise WrongPort(f"{self.place}: it is a link to {os.readlink(self._path)}, which another program serves; choose "
                                "another one, or remove it")
            self._path.unlink()
        self._path.symlink_to(self._name)

    def read(self, timeout_s: float) -> bytes:
        """Raises LostLink while nobody is there."""
        waiting = select.poll()
        waiting.register(self._inner, select.POLLIN)
        events = waiting.poll(1000 * timeout_s)
        if self.closed:
            raise LostLink(f"{self.place}: closed")
        if events and not events[0][1] & select.POLLIN:
            time.sleep(min(timeout_s, 0.05))
            raise LostLink(f"{self.place}: nobody has it open")
        try:
            return os.read(self._inner, 65536) if events else b""
        except OSError as error:
            raise LostLink(f"{self.place}: {error}") from None

    def write(self, data: bytes) -> None:
        try:
            os.write(self._inner, data)
        except OSError:
            pass  # lost, as on a wire that nobody reads

    def close(self) -> None:
        if not self.closed:
            self.closed = True
            with contextlib.suppress(OSError):
                if os.readlink(self._path) == self._name:
                    self._path.unlink()
            os.close(self._inner)
