"""What the drive records by itself: signals in each control period, or in every n-th, around a trigger, into
the memory that it has left; uploaded in blocks when it is done. firmware/link/README.md, "Capture"."""
import contextlib
import dataclasses
import struct
import time
from typing import Sequence

from .capture import Armed, Capture
from .dictionary import Signal, dictionary
from .errors import Refused, TimedOut
from .objects import NoAnswer, Objects
from .settings import Progress

CONTROL, SIGNALS, VALUES = 0x2400, 0x2401, 0x2402
ARM, DIVIDER, TRIGGER, LEVEL, EDGE, BEFORE, SAMPLES, BEGAN = 1, 2, 3, 4, 5, 6, 7, 9
OFF, ON, DONE = 0, 1, 4
MOST_SIGNALS, VALUE_BYTES = 8, 8
CONTROL_PERIOD_S = 1e-4  # of the boards and of the simulated one
LOOK_S, LATE_S = 0.05, 5.0
LEFT_S = 1.0  # what is done and not fetched for so long has been left by a program that has ended
TRIES = 2


@dataclasses.dataclass(frozen=True)
class Trigger:
    """A capture begins `before_s` before a signal rises above a level, or falls to it. Of a flag the level 0.5 is
    its change; an enumeration counts by its place."""

    signal: str
    level: float = 0.5
    rising: bool = True
    before_s: float = 0.0
    timeout_s: float = 60.0


class TooMuch(Refused):
    """The drive's memory does not hold it, or it has none."""


def is_there(objects: Objects) -> bool:
    return CONTROL in objects.entries


def record_in_drive(objects: Objects, signals: Sequence[Signal], duration_s: float, rate_Hz: float,
                    period_s: float, progress: Progress, trigger: Trigger | None = None,
                    armed: Armed | None = None, preempt: bool = False) -> Capture:
    """At rate_Hz, rounded to a whole part of the control rate; the time counts from the trigger. `armed` is called
    when the drive waits for it. Raises TooMuch, and Refused while it records for another program; `preempt`: all the
    same."""
    divider = min(max(1, round(1 / (rate_Hz * period_s))), 0xFFFF)
    samples = max(1, round(duration_s / (divider * period_s)))
    if trigger and not 0 <= trigger.before_s <= duration_s:
        raise Refused(f"before_s: expected a number in 0…{duration_s:g} s, got {trigger.before_s:g}")
    before = min(round(trigger.before_s / (divider * period_s)), samples - 1) if trigger else 0
    if not preempt:
        _check_that_it_is_free(objects)
    _arm(objects, signals, divider, samples, before, trigger)
    asked = _asked_for(objects)
    try:
        if asked[:MOST_SIGNALS] != _indexes(signals):
            raise _taken()
        if armed:
            armed()
        _wait(objects, duration_s, trigger, progress)
        began = objects.read(CONTROL, BEGAN)
        rows = _uploaded(objects, len(signals), progress)
        if len(rows) != samples or objects.read(CONTROL, BEGAN) != began or _asked_for(objects) != asked:
            raise _taken()
    finally:
        if not objects.bus.lost and _asked_for(objects) == asked:
            objects.write(CONTROL, OFF, ARM)
    time_s = [(n - before) * divider * period_s for n in range(len(rows))]
    columns = {signal.name: [_shown(signal, row[n]) for row in rows] for n, signal in enumerate(signals)}
    return Capture(list(signals), time_s, columns)


def _check_that_it_is_free(objects: Objects) -> None:
    end = time.monotonic() + LEFT_S
    while (state := objects.read(CONTROL, ARM)) != OFF:
        if state != DONE:
            raise Refused("the drive records for another program, until that has its capture; from one that has ended "
                          "preempt takes it")
        if time.monotonic() > end:
            return
        time.sleep(LOOK_S)


def _taken() -> Refused:
    return Refused("another program has taken the drive's recorder meanwhile; this capture is lost")


def _indexes(signals: Sequence[Signal]) -> list[int]:
    return [signals[n].index if n < len(signals) else 0 for n in range(MOST_SIGNALS)]


def _asked_for(objects: Objects) -> list[int]:
    """By whoever has armed it."""
    return [*(int(objects.read(SIGNALS, n + 1)) for n in range(MOST_SIGNALS)),
            *(int(objects.read(CONTROL, sub)) for sub in (DIVIDER, TRIGGER, BEFORE, SAMPLES))]


def _shown(signal: Signal, value: float) -> float:
    """A fault is its place in the list there, and its code elsewhere."""
    if signal.name != "fault":
        return value
    codes = [0, *dictionary().faults]
    return float(codes[int(value)]) if 0 <= value < len(codes) else value


def _arm(objects: Objects, signals: Sequence[Signal], divider: int, samples: int, before: int,
         trigger: Trigger | None) -> None:
    if len(signals) > MOST_SIGNALS:
        raise TooMuch(f"the drive records {MOST_SIGNALS} signals at most")
    objects.write(CONTROL, OFF, ARM)
    for n, index in enumerate(_indexes(signals)):
        objects.write(SIGNALS, index, n + 1)
    for sub, value in ((DIVIDER, divider), (BEFORE, before), (SAMPLES, samples),
                       (TRIGGER, dictionary().signal(trigger.signal).index if trigger else 0)):
        objects.write(CONTROL, value, sub)
    if trigger:
        objects.write(CONTROL, float(trigger.level), LEVEL)
        objects.write(CONTROL, 1 if trigger.rising else -1, EDGE)
    try:
        objects.write(CONTROL, ON, ARM)
    except Refused:
        raise TooMuch(f"the drive's memory does not hold {samples} samples of {len(signals)} signals; take less, or a "
                      "lower rate") from None


def _wait(objects: Objects, duration_s: float, trigger: Trigger | None, progress: Progress) -> None:
    begin = time.monotonic()
    while (state := objects.read(CONTROL, ARM)) != DONE:
        if state == OFF:
            raise _taken()
        passed_s = time.monotonic() - begin
        if trigger and passed_s > trigger.timeout_s + duration_s:
            raise TimedOut(f"{trigger.signal} has not {'risen above' if trigger.rising else 'fallen to'} "
                           f"{trigger.level:g} within {trigger.timeout_s:g} s")
        if not trigger and passed_s > 20 * duration_s + LATE_S:  # a simulation may be slow
            raise TimedOut("the drive has not come to the end of the capture")
        progress("waiting for the trigger" if trigger else "capturing", min(passed_s / duration_s, 0.99))
        time.sleep(LOOK_S)


def _uploaded(objects: Objects, width: int, progress: Progress) -> list[tuple[float, ...]]:
    """Once more, if a byte was lost on the way."""
    for _ in range(TRIES):
        with contextlib.suppress(NoAnswer):
            return _upload(objects, width, progress)
    return _upload(objects, width, progress)


def _upload(objects: Objects, width: int, progress: Progress) -> list[tuple[float, ...]]:
    progress("uploading", 0.0)
    with objects.transfer(), objects.node.sdo[VALUES].open("rb", block_transfer=True, buffering=0) as stream:
        size, pieces = int(stream.size or 0), bytearray()
        while piece := stream.read(7):
            pieces += piece
            if len(pieces) % 4096 < 7:
                progress("uploading", min(len(pieces) / size, 1.0) if size else 0.0)
    progress("uploading", 1.0)
    values = struct.unpack(f"<{len(pieces) // VALUE_BYTES}d", pieces)
    return [tuple(values[n:n + width]) for n in range(0, len(values), width)]
