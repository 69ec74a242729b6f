"""How long every motor of sil/motors takes from "switch on" to SWITCHED ON and on to OPERATION ENABLED, without an encoder,
by the drive's clock: within the 0.4 s a step and 0.7 s in all that BaseNode402 waits. One that the drive refuses is named.

usage: enabling_times.py SIL [MOTOR...]
"""
import os
import pathlib
import select
import sys
import time

MOTORS = [sys.argv.pop() for _ in range(len(sys.argv) - 2)]
from served import Checks, Served  # noqa: E402

CHECKS = Checks()
ROOT = pathlib.Path(__file__).resolve().parents[2]
STEP_S, ALL_S = 0.4, 0.7
PERIOD_S = 1e-4
READY, SWITCHED_ON, ENABLED, FAULT = 0x21, 0x23, 0x27, 0x08
VOLTAGE = 0x10  # of the statusword: the bridge's enabling has begun
SPEED = 10


class Wire:
    """Frames as text."""

    def __init__(self, place):
        self.file = os.open(place, os.O_RDWR | os.O_NOCTTY)
        self.rest = b""

    def send(self, *lines):
        for line in lines:
            os.write(self.file, line.encode() + b"\r")

    def frames(self, until_s):
        """Lines as they come."""
        while True:
            left = until_s - time.monotonic()
            if left <= 0 or not select.select([self.file], [], [], left)[0]:
                return
            *lines, self.rest = (self.rest + os.read(self.file, 4096)).split(b"\r")
            yield from (line.decode(errors="replace") for line in lines)

    def put(self, index, sub, size, value):
        request = f"{0x23 | (4 - size) << 2:02X}{index & 255:02X}{index >> 8:02X}{sub:02X}"
        self.send("t6018" + request + value.to_bytes(4, "little").hex().upper())
        for line in self.frames(time.monotonic() + 10):
            if line.startswith("t5818"):
                CHECKS.that(line[5:7] == "60", f"{index:04x}h is written: {line}")
                return
        sys.exit(f"no answer to a write of {index:04x}h")


def enable(wire):
    """Periods at which "switch on" had not begun, and each state was there; None for one that did not come."""
    wire.put(0x1800, 1, 4, 0xC0000181)
    wire.put(0x1A00, 0, 1, 0)
    wire.put(0x1A00, 1, 4, 0x60410010)
    wire.put(0x1A00, 2, 4, 0x23010020)
    wire.put(0x1A00, 0, 1, 2)
    wire.put(0x1800, 3, 2, 10)
    wire.put(0x1800, 1, 4, 0x40000181)
    wire.send("t000201" "01")
    wire.put(0x6040, 0, 2, 0x06)
    asked, seen = False, {}
    for line in wire.frames(time.monotonic() + 30):
        if not line.startswith("t1816"):
            continue
        data = bytes.fromhex(line[5:17])
        status, period = int.from_bytes(data[:2], "little"), int.from_bytes(data[2:], "little")
        state = status & 0x6F
        if status & 0x4F == FAULT or (state == READY and status & 0x80):
            return None
        if state == READY and not asked:
            wire.send("t60182B4060000F000000")
            asked = True
        if state == READY and not status & VOLTAGE:
            seen[READY] = period
        elif state in (SWITCHED_ON, ENABLED):
            seen.setdefault(state, period)
        if ENABLED in seen:
            return [PERIOD_S * (seen[later] - seen[before])
                    for before, later in ((READY, SWITCHED_ON), (SWITCHED_ON, ENABLED), (READY, ENABLED))]
    return None


def of_motor(name):
    with Served("--speed", SPEED, "--set", f"motor={name}") as served:
        if not served.serial:
            return None  # not even started: the motor is refused
        wire = Wire(str(served.link))
        wire.send("C", "S6", "O")
        return enable(wire)


names = MOTORS or sorted(file.stem for file in (ROOT / "sil/motors").glob("*.toml"))
taken = {name: of_motor(name) for name in names}
refused = [name for name, steps in taken.items() if steps is None]
steps = {name: steps for name, steps in taken.items() if steps}
for name, (first, second, both) in steps.items():
    CHECKS.that(max(first, second) <= STEP_S and both <= ALL_S, f"{name}: {first:.3f} s, {second:.3f} s more")
for place, what in enumerate(("to SWITCHED ON", "on to OPERATION ENABLED", "in all")):
    by_time = sorted((times[place], name) for name, times in steps.items())
    print(f"{what}: {by_time[0][0]:.3f} s ({by_time[0][1]}) to {by_time[-1][0]:.3f} s ({by_time[-1][1]})")
print(f"{len(steps)} motors enabled, refused: {', '.join(refused) or 'none'}")
CHECKS.that(len(steps) >= 0.8 * len(names), f"most are enabled: {len(steps)} of {len(names)}")
CHECKS.end()
