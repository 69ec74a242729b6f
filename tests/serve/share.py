"""What lets several programs share one drive, by itself: whose turn a transfer is, and a program that does
not read.

usage: share.py SIL    (which it does not need)
"""
import socket
import time

from operated import steadystep
from served import Checks
from steadystep.program_lines import ProgramLine
from steadystep.sdo_turns import Turns

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


a_transfer_is_one_program_s_to_its_end()
a_program_that_gives_up_is_not_served_later()
a_program_that_goes_leaves_no_turn()
a_program_that_does_not_read_holds_up_nobody()
CHECKS.end()
