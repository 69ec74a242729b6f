#!/usr/bin/python3
"""Rubbish on the bus does not delay the control interrupt of a board's image, and breaks nothing.

Lines of every kind, some of them frames for the node, as fast as the line carries them, while the drive
is in operation. What the console then says of the interrupt's cycles, counted from the sampling instant,
is compared with the same time without.

usage: flood.py SIL IMAGE.elf [FRAMES]
"""
import os
import pathlib
import random
import select
import sys
import time

ARGUMENTS = sys.argv[2:]
IMAGE = pathlib.Path(ARGUMENTS[0]).resolve()
FRAMES = int(ARGUMENTS[1]) if len(ARGUMENTS) > 1 else 4000
from served import Checks, Line, Served  # noqa: E402

CHECKS = Checks()
SPEED = 0.2  # at most: a line that is full holds the rest back
PIECE = 200  # frames that are on their way
MORE_CYCLES = 30  # what a background that holds the interrupt back for some instructions may cost
DRAW = random.Random(1)


def rubbish():
    """A line: of any bytes but a line feed, a frame for nobody, one that is cut off, a foreign node's."""
    kind = DRAW.randrange(5)
    if kind == 0:
        return bytes(DRAW.choice(b"tTrRtabcdef0123456789 \x07\x7f") for _ in range(DRAW.randrange(1, 9)))
    if kind == 1:
        return b"t%03X0" % DRAW.randrange(0x800)
    if kind == 2:
        return b"t601" + DRAW.randbytes(2).hex().encode()
    if kind == 3:
        return b"t%03X2%s" % (DRAW.randrange(0x102, 0x580), DRAW.randbytes(2).hex().upper().encode())
    return b"t6018" + b"40" + DRAW.randbytes(7).hex().upper().encode()


def pump(line, data):
    """Writes all of it, with a question behind it, and reads until that is answered: nothing is lost."""
    left = memoryview(data + b"V\r")
    heard = b""
    while left or b"V1010" not in heard:
        readable, writable, _ = select.select([line.file], [line.file] if left else [], [], 30.0)
        if readable:
            heard += os.read(line.file, 65536)
        elif not writable:
            sys.exit(f"the line is stuck behind {heard[-60:]}")
        if writable:
            left = left[os.write(line.file, left[:256]):]
    return len(heard)


def drain(line, quiet_s=0.7):
    """Reads until nothing comes."""
    heard = 0
    while select.select([line.file], [], [], quiet_s)[0]:
        heard += len(os.read(line.file, 65536))
    line.rest = b""
    return heard


def most_cycles(line):
    said = line.ask("cycles")
    CHECKS.that(said.startswith("ok cycles"), said)
    return int(said.split("most=")[1].split()[0])


with Served("--image", IMAGE, "--speed", SPEED) as served:
    drive = Line(str(served.link))
    drive.ask("state")
    drive.send("enable\n")
    CHECKS.that(drive.until("ready:", 60), "it becomes ready")
    time.sleep(1)
    drive.ask("cycles reset")
    began = time.monotonic()
    drive.send("O\r")
    heard = sum(pump(drive, b"".join(rubbish() + b"\r" for _ in range(min(PIECE, FRAMES - done))))
                for done in range(0, FRAMES, PIECE))
    heard += drain(drive)
    drive.send("\rC\r")
    drain(drive)
    flooded = most_cycles(drive)
    lasted_s = time.monotonic() - began
    drive.ask("cycles reset")
    time.sleep(lasted_s)  # what is rare in a hold comes as often
    quiet = most_cycles(drive)
    print(f"{FRAMES} frames, {heard} bytes of answers; at most {flooded} cycles, without {quiet}")
    CHECKS.that(heard > FRAMES // 10, "it answers meanwhile")
    CHECKS.that(flooded <= quiet + MORE_CYCLES, f"{flooded} cycles, {quiet} without rubbish")
    state = drive.ask("state")
    CHECKS.that(state.startswith("ok operation-enabled"), f"it goes on: {state}")
    drive.close()
CHECKS.end()
