"""One drive for several programs: it owns the line, and each program has a channel of its own, as if it had an
adapter on the same bus. What one sends, the others hear. SDO has one server, so that transfers take turns,
and an answer goes to who has asked. The drive's channel stays open when a program goes."""
import collections
import contextlib
import os
import socket
import threading
import time

from .byte_line import LOST_S, ByteLine, PairedLine
from .errors import LostLink, WrongPort
from .objects import ANSWER_S
from .program_lines import ProgramLine, TerminalLine
from .sdo_marker import AGAIN_S
from .sdo_turns import ABORT, Turns
from .text_bus import NODE_BITS, Pieces, TextBus, frame_of

CONSOLE_S = 0.5  # behind its last line or answer the console gives way to the channel again
TURN_S = (ANSWER_S + LOST_S) / 2  # of silence ends a turn: a program has given up by then, and who waits has not yet
REQUEST, RESPONSE, HEARTBEAT = 0x600, 0x580, 0x700
NMT_STATES = {1: 0x05, 2: 0x04, 0x80: 0x7F}  # by the command that brings about each
ANSWERS = {b"V": b"V1010\r", b"N": b"N0001\r", b"F": b"F00\r"}


class Client:
    """A program with a channel."""

    def __init__(self, line: ByteLine) -> None:
        self.line, self.pieces, self.open, self.lock = line, Pieces(), False, threading.Lock()

    def send(self, data: bytes) -> None:
        try:
            with self.lock:
                self.line.write(data)
        except LostLink:
            self.open = False


class Share:
    """`line` is the drive's. `link`: path of a pseudo-terminal, `tcp_port`: on 127.0.0.1, for any number of
    programs, 0: a free one; None: neither."""

    def __init__(self, line: ByteLine, link: str | None = None, tcp_port: int | None = None) -> None:
        self._line = line
        self._clients: list[Client] = []
        self._turns: dict[int, Turns[Client]] = collections.defaultdict(Turns)
        self._asks_console: Client | None = None
        self._asked_s = 0.0
        self._held: list[bytes] = []  # requests that wait for the channel meanwhile
        self._nmt: dict[int, int] = {}  # states of the nodes that have been heard
        self._lock = threading.RLock()
        self._listener: socket.socket | None = None
        self.lost: LostLink | None = None
        self._ended = False
        self._bus = TextBus(line)  # opens the channel; from here on its line is read here
        self._run(self._hear_drive)
        self.tcp_port = 0
        try:
            if link:
                self._serve(TerminalLine(link))
            if tcp_port is not None:
                self._listen(tcp_port)
        except BaseException:  # an interrupt, too
            self.close()
            raise

    def _run(self, work: object, *arguments: object) -> None:
        threading.Thread(target=work, args=arguments, daemon=True).start()  # type: ignore[arg-type]

    def _listen(self, port: int) -> None:
        try:
            self._listener = socket.create_server(("127.0.0.1", port))
        except OSError as error:
            raise WrongPort(f"127.0.0.1:{port}: {os.strerror(error.errno or 0)}") from None
        self.tcp_port = self._listener.getsockname()[1]
        self._run(self._accept, self._listener)

    def _accept(self, listener: socket.socket) -> None:
        while not self._ended:
            try:
                self._serve(ProgramLine(listener.accept()[0]))
            except OSError:
                return

    def _serve(self, line: ByteLine) -> None:
        client = Client(line)
        with self._lock:
            self._clients.append(client)
        self._run(self._hear, client)

    def line(self) -> ByteLine:
        """A channel for this program."""
        inner, outer = PairedLine.two(self._line.place)
        self._serve(inner)
        return outer

    def close(self) -> None:
        """The drive's channel, and that of everybody."""
        self._ended = True
        if self._listener:
            with contextlib.suppress(OSError):
                self._listener.shutdown(socket.SHUT_RDWR)  # ends the accept() that it is in
            self._listener.close()
        with self._lock:
            for client in self._clients:
                client.line.close()
        self._bus.shutdown()

    # ---- from the programs ----

    def _hear(self, client: Client) -> None:
        while not self._ended:
            try:
                for text, ending in client.pieces.of(client.line.read(0.5)):
                    if ending == b"\r":
                        self._obey(client, text)
                    elif ending == b"\n" and text and not client.open:
                        self._ask_console(client, text)
            except LostLink:
                with self._lock:
                    client.open = False
                    for node, turns in self._turns.items():
                        turns.leave(client)
                        self._next(node)
                    if not isinstance(client.line, TerminalLine):
                        self._clients.remove(client)
                        return

    def _obey(self, client: Client, text: bytes) -> None:
        letter = text[:1]
        if letter in (b"O", b"L", b"C"):
            self._leave_console(client)
            client.open = letter != b"C"
            client.send(b"\r")
            if client.open:  # a node that has been here for long is announced, as one that starts is
                for node, state in self._nmt.items():
                    client.send(b"t%03X1%02X\r" % (HEARTBEAT + node, state))
        elif letter == b"t":
            client.send(b"z\r" if client.open else b"\a")
            if client.open:
                self._forward(client, text)
        else:
            client.send(ANSWERS.get(letter, b"\r" if letter in b"SsMmZ" else b"\a"))

    def _ask_console(self, client: Client, line: bytes) -> None:
        """For all programs the channel is as if it had just been opened. It is closed until the one that asks opens its own,
        or says no more."""
        with self._lock:
            if self._asks_console not in (None, client):
                return
            begins = b"" if self._asks_console else b"C\r"
            self._asks_console, self._asked_s = client, time.monotonic()
            self._put(begins + line + b"\n")

    def _leave_console(self, client: Client | None) -> None:
        with self._lock:
            if self._asks_console and client in (None, self._asks_console):
                self._asks_console = None
                held, self._held = self._held, []
                self._put(b"O\r" + b"".join(held))

    def _forward(self, client: Client, text: bytes) -> None:
        try:
            number, request = int(text[1:4], 16), int(text[5:7] or b"0", 16)
        except ValueError:
            return
        with self._lock:
            if number == 0:
                self._note_state(request, text)
            if number & ~NODE_BITS == REQUEST:
                turns = self._turns[number & NODE_BITS]
                if not turns.take(client, request):
                    turns.wait(client, request, text)
                    return
            for other in self._clients:
                if other is not client and other.open:
                    other.send(text + b"\r")
            self._to_drive(text)
            if number & ~NODE_BITS == REQUEST:
                self._next(number & NODE_BITS)

    def _note_state(self, command: int, text: bytes) -> None:
        node = int(text[7:9] or b"0", 16)
        for known in self._nmt:
            if command in NMT_STATES and node in (0, known):
                self._nmt[known] = NMT_STATES[command]

    def _to_drive(self, text: bytes) -> None:
        with self._lock:
            if self._asks_console and text[1:2] in b"67":  # SDO; process data does not wait
                self._held.append(text + b"\r")
                return
            self._leave_console(None)
            self._put(text + b"\r")

    def _put(self, data: bytes) -> None:
        try:
            self._line.write(data)
        except LostLink as error:
            self._lose(error)

    def _send_request(self, node: int, data: bytes) -> None:
        self._to_drive(b"t%03X8%s" % (REQUEST + node, data.hex().upper().encode()))

    def _next(self, node: int) -> None:
        """The oldest of those that wait, now that it is nobody's turn, and nothing is late."""
        turns = self._turns[node]
        if turns.is_late:
            self._send_request(node, bytes([ABORT]) + bytes(7))  # a block takes no request but that
            self._send_request(node, turns.mark())
        elif turns.owner is None and turns.waiting:
            client, text = turns.waiting.popleft()
            self._forward(client, text)

    # ---- from the drive ----

    def _hear_drive(self) -> None:
        pieces = Pieces()
        while not self._ended and not self.lost:
            try:
                for text, ending in pieces.of(self._line.read(0.1)):
                    self._deliver(text, ending)
            except LostLink as error:
                self._lose(error)
            with self._lock:
                if self._asks_console and time.monotonic() - self._asked_s > CONSOLE_S:
                    self._leave_console(None)
                for node, turns in list(self._turns.items()):
                    self._end_what_is_silent(node, turns)

    def _end_what_is_silent(self, node: int, turns: Turns[Client]) -> None:
        silent_s = time.monotonic() - turns.heard_s
        if turns.owner and silent_s > TURN_S:
            turns.leave(turns.owner)
            self._next(node)
        elif turns.is_late and silent_s > AGAIN_S:
            self._next(node)

    def _deliver(self, text: bytes, ending: bytes) -> None:
        if ending == b"\n" and text.startswith(b"steadystep "):
            self._lose(LostLink(f"{self._line.place}: the drive has restarted"))
        asks = self._asks_console
        if ending == b"\n" and asks and text.startswith((b"ok", b"error:")):
            self._asked_s = time.monotonic()
            asks.send(text + b"\n")
        frame = frame_of(text) if ending == b"\r" else None
        if frame is None:
            return
        node, data = frame.arbitration_id & NODE_BITS, bytes(frame.data)
        kind = frame.arbitration_id & ~NODE_BITS
        if kind == HEARTBEAT and data:
            self._nmt[node] = data[0] or NMT_STATES[0x80]  # 0: it has started
        with self._lock:
            if kind == RESPONSE and self._turns[node].is_late:
                self._turns[node].passes(data)
                if not self._turns[node].is_late:
                    self._next(node)
                return
            listeners = [self._turns[node].owner] if kind == RESPONSE else self._clients
            for client in listeners:
                if client and client.open:
                    client.send(text + b"\r")
            if kind == RESPONSE and data:
                self._turns[node].hear(data[0])
                self._next(node)

    def _lose(self, error: LostLink) -> None:
        """Programs see their line end."""
        self.lost = error
        with self._lock:
            for client in self._clients:
                if not isinstance(client.line, TerminalLine):
                    client.line.close()
                client.open = False
