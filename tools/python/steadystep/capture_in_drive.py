"""What the drive records by itself: signals in each control period, or in every n-th, around a trigger, into
the memory that it has left; uploaded in blocks when it is done. firmware/link/README.md, "Capture"."""
import contextlib
import dataclasses
import struct
import time
from typing import Callable, Sequence

from .capture import Capture
from .dictionary import Signal, dictionary
from .errors import Refused, TimedOut
from .objects import NoAnswer, Objects
from .settings import Progress

CONTROL, SIGNALS, VALUES = 0x2400, 0x2401, 0x2402
ARM, DIVIDER, TRIGGER, LEVEL, EDGE, BEFORE, SAMPLES = 1, 2, 3, 4, 5, 6, 7
OFF, ON, DONE = 0, 1, 4
MOST_SIGNALS, VALUE_BYTES = 8, 8
CONTROL_PERIOD_S = 1e-4  # of the boards and of the simulated one
LOOK_S, LATE_S = 0.05, 5.0
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
                    armed: Callable[[], object] | None = None) -> Capture:
    """At rate_Hz, rounded to a whole part of the control rate; the time counts from the trigger. `armed` is called
    when the drive waits for it. Raises TooMuch."""
    divider = min(max(1, round(1 / (rate_Hz * period_s))), 0xFFFF)
    samples = max(1, round(duration_s / (divider * period_s)))
    before = min(round(trigger.before_s / (divider * period_s)), samples - 1) if trigger else 0
    _arm(objects, signals, divider, samples, before, trigger)
    try:
        if armed:
            armed()
        _wait(objects, duration_s, trigger, progress)
        rows = _uploaded(objects, len(signals), progress)
    finally:
        if not objects.bus.lost:
            objects.write(CONTROL, OFF, ARM)
    time_s = [(n - before) * divider * period_s for n in range(len(rows))]
    columns = {signal.name: [_shown(signal, row[n]) for row in rows] for n, signal in enumerate(signals)}
    return Capture(list(signals), time_s, columns)


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
    for n in range(MOST_SIGNALS):
        objects.write(SIGNALS, signals[n].index if n < len(signals) else 0, n + 1)
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
    while objects.read(CONTROL, ARM) != DONE:
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
