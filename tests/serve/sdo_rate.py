"""How many objects a client reads in a second, one behind the other: of frames as such, and by python-canopen.

A second is one of the drive's: on a machine that does not keep up with it, time is slowed (--speed).

usage: sdo_rate.py SIL [SPEED]      prints both; fails if the first is below 800
"""
import os
import select
import sys
import time

from canopen_bus import Bus
from served import Checks, Served

READS = 1000
LEAST_PER_S = 800
SPEED = float(sys.argv[2]) if len(sys.argv) > 2 else 1.0
CHECKS = Checks()


def answer(file, end):
    """What comes until a frame of the SDO server is whole."""
    heard = b""
    while end not in heard or not heard.endswith(b"\r"):
        if not select.select([file], [], [], 5.0)[0]:
            sys.exit(f"no answer, only {heard}")
        heard += os.read(file, 4096)
    return heard


def by_frames(place):
    """Reads of 6041h in a second of the drive."""
    file = os.open(place, os.O_RDWR | os.O_NOCTTY)
    os.write(file, b"C\rS6\rO\r")
    answer(file, b"t7011")
    begin = time.monotonic()
    for _ in range(READS):
        os.write(file, b"t60184041600000000000\r")
        answer(file, b"t58184B4160")
    taken_s = time.monotonic() - begin
    os.write(file, b"C\r")
    os.close(file)
    return READS / taken_s / SPEED


def by_client(place):
    with Bus(place) as bus:
        status = bus.node.sdo[0x6041]
        begin = time.monotonic()
        for _ in range(READS):
            status.raw  # noqa: B018, the reading of which is a transfer
        return READS / (time.monotonic() - begin) / SPEED


with Served("--speed", SPEED) as served:
    rate = by_frames(str(served.link))
    print(f"SDO: {rate:.0f} reads/s by frames, {by_client(served.link):.0f} by python-canopen")
    CHECKS.that(rate >= LEAST_PER_S, f"{rate:.0f} reads/s, at least {LEAST_PER_S}")
CHECKS.end()
