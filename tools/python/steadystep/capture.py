"""Signals over time, as the host polls them: each SYNC asks for one sample, which the drive sends as process data,
all of one period; what does not fit into that is read by SDO behind it. What the drive records by itself is
in capture_in_drive.py."""
import dataclasses
import pathlib
import threading
import time
from typing import Any, Callable, Protocol, Sequence

from .byte_line import LOST_S
from .dictionary import Signal
from .errors import LostLink
from .objects import Objects
from .settings import Progress, unseen

PERIOD_INDEX, STATUS_INDEX = 0x2301, 0x6041
PDOS, PDO_BYTES, INVALID, NO_REMOTE = 4, 8, 0x80000000, 0x40000000
ANSWER_S = 0.1  # a sample that has not come by then is lost, and another is asked for

Armed = Callable[[], object]


@dataclasses.dataclass
class Capture:
    """A column of numbers for each signal; of an enumeration their places in `words`."""

    signals: list[Signal]
    time_s: list[float]
    columns: dict[str, list[float]]

    def __len__(self) -> int:
        return len(self.time_s)

    def __getitem__(self, name: str) -> list[float]:
        return self.columns[name]

    @property
    def rate_Hz(self) -> float:
        """As it came out."""
        span_s = self.time_s[-1] - self.time_s[0] if len(self) > 1 else 0.0
        return (len(self) - 1) / span_s if span_s > 0 else 0.0

    def save(self, path: str | pathlib.Path, progress: Progress = unseen) -> None:
        """To .csv, .parquet or .mcap."""
        from .capture_files import save

        save(self, pathlib.Path(path), progress)


class Recorder(Protocol):
    """How a capture comes about."""

    def __call__(self, objects: Objects, signals: Sequence[Signal], duration_s: float, rate_Hz: float,
                 period_s: float, progress: Progress) -> Capture: ...


def _bytes_of(objects: Objects, index: int) -> int:
    return len(objects.entries[index]) // 8


class ProcessData:
    """What the drive sends on SYNC: the first frame has the period that a sample is of."""

    def __init__(self, objects: Objects, signals: Sequence[Signal]) -> None:
        self._objects = objects
        self.frames: list[list[int]] = [[STATUS_INDEX, PERIOD_INDEX], [], [], []]
        self.polled: list[Signal] = []
        self.samples: list[dict[int, Any]] = []
        self.changed = threading.Condition()
        self.first = self.last = 0  # periods
        self._sample: dict[int, Any] = {}
        self._kept: list[tuple[Any, ...]] = []
        for signal in sorted(signals, key=lambda one: -_bytes_of(objects, one.index)):
            self._place(signal)

    def _place(self, signal: Signal) -> None:
        if any(signal.index in frame for frame in self.frames):
            return
        size = _bytes_of(self._objects, signal.index)
        for frame in self.frames:
            if sum(_bytes_of(self._objects, index) for index in frame) + size <= PDO_BYTES:
                frame.append(signal.index)
                return
        self.polled.append(signal)

    def __enter__(self) -> "ProcessData":
        self._objects.is_capturing = True
        for n, indexes in enumerate(self.frames):
            self._kept.append(self._parameters(n))
            if indexes:
                entries = [index << 16 | 8 * _bytes_of(self._objects, index) for index in indexes]
                self._put(n, self._id(n) | NO_REMOTE, 1, 0, entries)
                self._objects.network.subscribe(self._id(n), self._take)
            else:
                self._objects.write(0x1800 + n, self._id(n) | INVALID, 1)
        self._objects.node.nmt.state = "OPERATIONAL"
        return self

    def __exit__(self, *_: object) -> None:
        self._objects.is_capturing = False
        for n in range(PDOS):
            if self.frames[n]:
                self._objects.network.unsubscribe(self._id(n), self._take)
        if not self._objects.bus.lost:
            for n, (cob_id, kind, event, entries) in enumerate(self._kept):
                self._put(n, cob_id, kind, event, entries)

    def _id(self, n: int) -> int:
        return 0x180 + 0x100 * n + int(self._objects.number)

    def _parameters(self, n: int) -> tuple[Any, ...]:
        read = self._objects.read
        entries = [read(0x1A00 + n, sub + 1) for sub in range(read(0x1A00 + n))]
        return read(0x1800 + n, 1), read(0x1800 + n, 2), read(0x1800 + n, 5), entries

    def _put(self, n: int, cob_id: int, kind: int, event: int, entries: list[int]) -> None:
        write = self._objects.write
        write(0x1800 + n, cob_id | INVALID, 1)
        write(0x1A00 + n, 0)
        for sub, entry in enumerate(entries):
            write(0x1A00 + n, entry, sub + 1)
        write(0x1A00 + n, len(entries))
        write(0x1800 + n, kind, 2)
        write(0x1800 + n, event, 5)
        write(0x1800 + n, cob_id, 1)

    def _take(self, can_id: int, data: bytearray, _: float) -> None:
        n = (can_id - 0x180) // 0x100
        if n == 0:
            self._sample = {}
        begin = 0
        for index in self.frames[n]:
            end = begin + _bytes_of(self._objects, index)
            self._sample[index] = self._objects.entries[index].decode_raw(bytes(data[begin:end]))
            begin = end
        if len(self._sample) == sum(map(len, self.frames)):
            with self.changed:
                self.last = self._sample[PERIOD_INDEX]
                self.first = self.first if self.samples else self.last
                self.samples.append(self._sample)
                self.changed.notify_all()
            self._sample = {}

    def ask(self) -> None:
        """For a sample, and waits for it: what is asked for more quickly than it comes would be lost."""
        before = len(self.samples)
        self._objects.network.sync.transmit()
        read = {signal.index: self._objects.read(signal.index) for signal in self.polled}
        with self.changed:
            self.changed.wait_for(lambda: len(self.samples) > before, ANSWER_S)
            if len(self.samples) > before:
                self.samples[-1].update(read)

    def span_s(self, period_s: float) -> float:
        """Of what has come, in the drive's time."""
        return (self.last - self.first) % 2**32 * period_s


def record(objects: Objects, signals: Sequence[Signal], duration_s: float, rate_Hz: float,
           period_s: float, progress: Progress, armed: Armed | None = None) -> Capture:
    """At rate_Hz, or as quickly as the link and this machine do; the time, and its end, are the drive's own. `armed` is
    called behind the first sample."""
    with ProcessData(objects, signals) as data:
        due = heard_s = time.monotonic()
        heard = 0
        while data.span_s(period_s) < duration_s:
            objects.check()
            data.ask()
            now = time.monotonic()
            if len(data.samples) > heard:
                if armed and not heard:
                    armed()
                heard_s, heard = now, len(data.samples)
            elif now - heard_s > LOST_S:
                raise LostLink(f"{objects.bus.channel_info}: no sample has come for {LOST_S:g} s")
            due = max(due + 1 / rate_Hz, now)
            progress("capturing", min(data.span_s(period_s) / duration_s, 0.99))
            time.sleep(max(0.0, due - time.monotonic()))
    progress("capturing", 1.0)
    return _capture(data.samples, signals, period_s)


def _capture(samples: list[dict[int, Any]], signals: Sequence[Signal], period_s: float) -> Capture:
    wanted = [sample for sample in samples if all(signal.index in sample for signal in signals)]
    first = wanted[0][PERIOD_INDEX] if wanted else 0
    time_s = [(sample[PERIOD_INDEX] - first) % 2**32 * period_s for sample in wanted]
    return Capture(list(signals), time_s,
                   {signal.name: [float(sample[signal.index]) for sample in wanted]
                    for signal in signals})
