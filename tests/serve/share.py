"""What lets several programs share one drive, by itself: whose turn a transfer is, and a program that does
not read, answers that come late.

usage: share.py SIL    (which it does not need)
"""
import os
import socket
import tempfile
import threading
import time

from operated import refusal, steadystep
from served import Checks
from steadystep.byte_line import PairedLine
from steadystep.program_lines import ProgramLine, TerminalLine
from steadystep.sdo_turns import Turns
from steadystep.share import TURN_S, Share

CHECKS = Checks()
# Requests and responses, by their first bytes, of each kind of transfer, up to its end.
TRANSFERS = {
    "upload in one frame": [(0x40, 0x43)],
    "upload in segments": [(0x40, 0x41), (0x60, 0x00), (0x70, 0x11)],
    "download in one frame": [(0x23, 0x60)],
    "download in segments": [(0x21, 0x60), (0x00, 0x20), (0x11, 0x30)],
    "refused": [(0x40, 0x80)],
    "block upload": [(0xA4, 0xC6), (0xA3, 0x01), (None, 0x02), (None, 0x83), (0xA2, 0xC1), (0xA1, None)],
    "block upload that becomes one of segments": [(0xA4, 0x41), (0x60, 0x01)],
    "block download of 33 frames": [(0xC6, 0xA4), (0xA1, 0xA2), (0xC1, 0xA1)],
    "block download": [(0xC6, 0xA4), (0x01, None), (0x82, 0xA2), (0xC1, 0xA1)],
}


def a_transfer_is_one_program_s_to_its_end():
    for name, steps in TRANSFERS.items():
        turns = Turns()
        for n, (request, response) in enumerate(steps):
            if request is not None:
                CHECKS.that(turns.take("first", request), f"{name}: {n} is its own")
            if n + 1 < len(steps) or response is not None:
                CHECKS.that(not turns.take("second", 0x40), f"{name}: {n}: another one waits")
            if response is not None:
                turns.hear(response)
        CHECKS.that(turns.owner is None and turns.take("second", 0x40), f"{name}: then it is its turn")


def a_program_that_gives_up_is_not_served_later():
    turns = Turns()
    turns.take("first", 0x40)
    for request in (0x40, 0x40):
        turns.wait("second", request, b"again")
    CHECKS.that(len(turns.waiting) == 1, "what it has asked before, it does not ask any more")
    turns.wait("second", 0x80, b"")
    CHECKS.that(not turns.waiting, "nor what it has given up")


def a_program_that_goes_leaves_no_turn():
    turns = Turns()
    turns.take("first", 0x40)
    turns.waiting.append(("second", b""))
    turns.leave("second")
    turns.leave("first")
    CHECKS.that(turns.owner is None and not turns.waiting, "neither its own nor one it waits for")


def a_program_that_does_not_read_holds_up_nobody():
    listener = socket.create_server(("127.0.0.1", 0))
    deaf = socket.socket()
    deaf.setsockopt(socket.SOL_SOCKET, socket.SO_RCVBUF, 4096)
    deaf.connect(listener.getsockname())
    line = ProgramLine(listener.accept()[0])
    begin = time.monotonic()
    try:
        for _ in range(20000):
            line.write(b"t5818" + 1000 * b"00" + b"\r")
        CHECKS.that(True, "what is for it is lost")
    except steadystep.LostLink:
        CHECKS.that(True, "or its line ends")
    CHECKS.that(time.monotonic() - begin < 5, "and nobody waits")
    deaf.close()
    listener.close()


def a_browser_is_no_program():
    """Whatever it sends, in whatever pieces, none of it is read; a program's first bytes are."""
    listener = socket.create_server(("127.0.0.1", 0))
    for pieces, read in (([b"POST / HTTP/1.1\r\n\r\n\rC\renable\n"], None), ([b"P", b"OST ", b"\rC\renable\n"], None),
                         ([b"GET /\r"], None), ([b"O", b"PTIONS * x"], None), ([b"O\r"], b"O\r"),
                         ([b"\rV\r"], b"\rV\r"), ([b"get law\n"], b"get law\n"), ([b"C", b"\renable\n"], b"C\renable\n")):
        client = socket.create_connection(listener.getsockname())
        line, found = ProgramLine(listener.accept()[0]), b""
        try:
            for piece in pieces:
                client.sendall(piece)
                found += line.read(1.0)
        except steadystep.LostLink:
            found = None
        CHECKS.that(found == read, f"{pieces}: {found}")
        client.close()
        line.close()
    listener.close()


def a_link_is_one_server_s():
    """Until it has gone; what another one has put there is not its own."""
    with tempfile.TemporaryDirectory() as scratch:
        link = f"{scratch}/drive"
        first = TerminalLine(link)
        found = refusal(lambda: TerminalLine(link), steadystep.WrongPort)
        CHECKS.that("which another program serves" in found, found)
        os.unlink(link)
        second = TerminalLine(link)
        first.close()
        CHECKS.that(os.path.exists(link), "the first one's end leaves the second's link")
        second.close()
        CHECKS.that(not os.path.lexists(link), "which goes with the second")
        os.symlink("/dev/pts/no-such", link)
        TerminalLine(link).close()
        CHECKS.that(not os.path.lexists(link), "one that was left behind is replaced")


class Scripted:
    """A drive that answers nothing but the opening of its channel; the test does."""

    def __init__(self):
        self.line, outer = PairedLine.two("scripted")
        threading.Thread(target=lambda: self.line.write(b"V1010\r") if self.heard(b"V") else None).start()
        self.share = Share(outer)
        self.heard(b"O")

    def heard(self, begin, seconds=5.0, line=None):
        """The next text that begins so on a line, the drive's if none is given; b"" if none comes in time."""
        end, rest = time.monotonic() + seconds, b""
        while (left := end - time.monotonic()) > 0:
            *texts, rest = (rest + (line or self.line).read(left)).split(b"\r")
            found = [text for text in texts if text.startswith(begin)]
            if found:
                return found[0]
        return b""

    def program(self):
        line = self.share.line()
        line.write(b"O\r")
        return line


ASKS_TYPE, TYPE = b"t60184000100000000000\r", b"t58184300100092010200\r"
ASKS_ERRORS, ERRORS = b"t60184001100000000000\r", b"t58184F01100000000000\r"
GIVES_UP = b"t60188000000000000405\r"


def a_late_answer_is_for_nobody(how, gives_up, wait_s):
    drive = Scripted()
    first, second = drive.program(), drive.program()
    first.write(ASKS_TYPE)
    CHECKS.that(drive.heard(ASKS_TYPE[:-1]) != b"", f"{how}: it is asked")
    second.write(ASKS_ERRORS)
    gives_up(first)
    marker = drive.heard(b"t6018400000", wait_s)
    CHECKS.that(marker != b"", f"{how}: then for a marker")
    drive.line.write(TYPE)
    CHECKS.that(drive.heard(b"t5818", 0.2, second) == b"", f"{how}: the answer that is late is not the next one's")
    CHECKS.that(drive.heard(ASKS_ERRORS[:-1], 0.2) == b"", f"{how}: which is not asked yet")
    drive.line.write(b"t581880" + marker[7:13] + b"00000206\r")
    CHECKS.that(drive.heard(ASKS_ERRORS[:-1]) != b"", f"{how}: behind the marker it is")
    drive.line.write(ERRORS)
    CHECKS.that(drive.heard(b"t5818", 5.0, second) == ERRORS[:-1], f"{how}: and gets its answer")
    drive.share.close()


a_transfer_is_one_program_s_to_its_end()
a_program_that_gives_up_is_not_served_later()
a_program_that_goes_leaves_no_turn()
a_program_that_does_not_read_holds_up_nobody()
a_browser_is_no_program()
a_link_is_one_server_s()
a_late_answer_is_for_nobody("given up", lambda program: program.write(GIVES_UP), 1.0)
a_late_answer_is_for_nobody("gone", lambda program: program.close(), 1.0)
a_late_answer_is_for_nobody("silent", lambda program: None, TURN_S + 2)
CHECKS.end()
