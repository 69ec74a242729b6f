"""A drive that one operates: its connection, its settings, captures; what the axis does is in axis.py."""
import os
import weakref
from types import TracebackType
from typing import TYPE_CHECKING, Sequence

from . import capture_in_drive
from .axis import Axis
from .byte_line import ByteLine, open_line
from .capture import Armed, Capture, Recorder, record
from .capture_in_drive import CONTROL_PERIOD_S, Trigger
from .dictionary import dictionary
from .errors import Refused, WrongPort, WrongVersion
from .objects import Objects
from .settings import Progress, Settings, unseen

if TYPE_CHECKING:
    from .resonance_curve import Resonance

SAVE, LOAD = 0x65766173, 0x64616F6C


class Drive(Axis):
    """`Drive("/dev/ttyACM0")`, a pseudo-terminal, or `Drive("tcp://127.0.0.1:4001")`. When it is closed the
    drive goes on with what it does."""

    def __init__(self, place: str | ByteLine, node: int = 1, *, any_version: bool = False) -> None:
        objects = _objects_on(place, node) if isinstance(place, ByteLine) else _objects_at(place, node)
        line = objects.bus.line
        try:
            self.name = str(objects.read(0x1008))
            self.version = str(objects.read(0x100A))
            if not any_version:
                check_version(objects, self.version, line.place)
            super().__init__(objects, dictionary())
            self.settings = Settings(objects, self.known)
            objects.node.nmt.state = "OPERATIONAL"  # as a stop by process data asks for
        except BaseException:
            objects.close()
            raise

    def __enter__(self) -> "Drive":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def __repr__(self) -> str:
        return f"<{self.version} on {self.objects.bus.channel_info}>"

    def close(self) -> None:
        self.objects.close()

    def store(self) -> None:
        """Settings and what was learned, to flash."""
        self.objects.write(0x1010, SAVE, 1)

    def defaults(self) -> None:
        """Of all settings but the motor's, at the next enabling, and to flash."""
        self.objects.write(0x1011, LOAD, 1)

    # ---- captures ----

    def capture(self, signals: Sequence[str], duration_s: float, rate_Hz: float = 1000.0, *,
                trigger: Trigger | None = None, recorder: Recorder | None = None, armed: Armed | None = None,
                preempt: bool = False, progress: Progress = unseen) -> Capture:
        """These signals over a time. `recorder`: how; else the drive records them by itself, at rate_Hz, or, if it cannot or
        has not the memory, they are asked for as quickly as the link allows, up to rate_Hz. `armed` is called when it has
        begun, or waits for its trigger. `preempt`: even if the drive records for another program, or for one that has ended."""
        rows = [self.known.signal(name) for name in signals]
        if not rows or not 0 < duration_s <= 86400 or not 0 < rate_Hz <= 1e5:
            raise Refused("capture: expected signals, a duration of up to 86400 s and a rate of up to 100000 Hz")
        if recorder is None and capture_in_drive.is_there(self.objects):
            try:
                return capture_in_drive.record_in_drive(self.objects, rows, duration_s, rate_Hz, CONTROL_PERIOD_S,
                                                        progress, trigger, armed, preempt)
            except capture_in_drive.TooMuch:
                if trigger:
                    raise
        if trigger:
            raise Refused("capture: this drive records nothing by itself, and knows no trigger")
        if recorder is None:
            return record(self.objects, rows, duration_s, rate_Hz, CONTROL_PERIOD_S, progress, armed)
        if armed:
            armed()
        return recorder(self.objects, rows, duration_s, rate_Hz, CONTROL_PERIOD_S, progress)

    # ---- the machine behind the rotor ----

    def find_resonance(self, lowest_Hz: float = 30.0, highest_Hz: float | None = None,
                       torque_share: float | None = None, *, progress: Progress = unseen) -> "Resonance":
        """Of a belt or a coupling, by small sines of an axis at rest, which is switched off before and behind them: a hanging
        load falls. To what the drive's sines go, if highest_Hz is not given."""
        from . import resonance

        return resonance.plan(self, lowest_Hz, highest_Hz, torque_share).run(progress)


_open: "weakref.WeakValueDictionary[tuple[str, int], Objects]" = weakref.WeakValueDictionary()  # of this process


def _objects_on(line: ByteLine, node: int) -> Objects:
    try:
        return Objects(line, node)
    except BaseException:
        line.close()
        raise


def _objects_at(place: str, node: int) -> Objects:
    """A port has one reader: an earlier Drive of this process gives it up, as that of a notebook's cell that is run again. On TCP
    there may be room for both."""
    is_tcp = "://" in place
    where = place if is_tcp else os.path.realpath(place)
    earlier = {number: one for (at, number), one in list(_open.items()) if at == where and not one.closed}
    objects = None
    if is_tcp or not earlier:
        try:
            objects = _objects_on(open_line(place), node)
        except WrongPort:
            if not earlier:
                raise
    if objects is None:
        if node not in earlier:
            raise WrongPort(f"{place}: a Drive of this program has it open, of node {', '.join(map(str, earlier))}; close that, or "
                            "share the line, steadystep.share")
        earlier[node].close("another Drive of this program has taken its line")
        objects = _objects_on(open_line(place), node)
    _open[where, node] = objects
    return objects


def check_version(objects: Objects, version: str, place: str) -> None:
    """Identity, and MAJOR.MINOR, within which indexes keep their meaning; raises WrongVersion."""
    for sub in (1, 2, 3):
        known, found = objects.entries[0x1018][sub], objects.read(0x1018, sub)
        if found != known.default:
            raise WrongVersion(f"{place}: {known.name} is {found:#x}, this package is for {known.default:#x}; "
                               f"the drive says: {version}")
    words, ours = version.split(), dictionary().version
    number = words[1] if len(words) > 1 else version
    if number.split(".")[:2] != ours.split(".")[:2]:
        raise WrongVersion(f"{place}: the drive has version {number}, this package is for {ours}; install that of the "
                           "drive's version")
