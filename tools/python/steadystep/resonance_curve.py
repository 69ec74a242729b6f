"""The inertia that a rotor shows at each frequency, and the resonance in it: what resonance.py has measured, judged.

A load behind a spring shows the most where it swings alone, the antiresonance, and the least where rotor and load
swing against one another, the resonance. A rigid one shows the same at each frequency, but for what friction and detent
torque take below and the estimate above."""
import cmath
import dataclasses
import math
import pathlib
from typing import Sequence

from .capture_files import check_place

SUFFIXES = (".csv", ".png", ".svg")
FOUND, NOT_SURE, NONE = "found", "not sure", "none"
REACH = 2.5                       # ratio of frequencies within which what is beside a minimum is looked for
BESIDE = 1.2                      # ratio of frequencies across which the angle turns
SURE, SURE_ABOVE, POSSIBLE, RISES = 2.0, 1.8, 1.5, 1.2  # what is shown beside the minimum over what is shown at it
SURE_deg, POSSIBLE_deg, TURNED_deg = 45.0, 25.0, 60.0  # 180 where nothing damps; friction and detent torque: up to 25
DEEP = 4.0                        # what is shown below over what is shown at it: it need not turn, or not rise
RIGID = 5.0                       # the most over the least that a rigid machine shows
WIDE = 0.5                        # of the frequency
ABOUT = 1.08                      # ratio of frequencies about a minimum whose points place it
ANTIRESONANCE, FLANK = 1.3, 1.15  # of the inertia; over what is shown on either side
LEAST_RATIO = 0.35                # of antiresonance and resonance: seven eighths behind the spring
CLEAR = 0.97                      # of the frequency: what is left of it without detent torque
HALF = 0.5                        # of the frequency: what must be left of it without detent torque
LEAST_TORQUE = 0.5                # of what was meant
LEAST_SHARE = 0.3                 # of the inertia before the spring, where it is not seen
TICKS_Hz, TICKS = (20, 30, 50, 70, 100, 150, 200, 300, 400), (0.05, 0.1, 0.2, 0.5, 1, 2, 5, 10)
WIDTH = 1.5                       # over what is shown at the minimum, where its width is taken


@dataclasses.dataclass(frozen=True)
class Point:
    """Torque over acceleration at a frequency, as a share of the inertia in the settings."""

    frequency_Hz: float
    inertia: complex


@dataclasses.dataclass(frozen=True)
class Minimum:
    """`below`, `above`: the most that is shown beside it, over what is shown at it; `turn_deg`: by which the angle rises
    across; `width`: over the frequency, 0: it is not seen on both sides."""

    frequency_Hz: float
    inertia: float
    below: float
    above: float
    turn_deg: float
    width: float

    @property
    def verdict(self) -> str:
        turned, rises = self.turn_deg >= TURNED_deg, self.above >= POSSIBLE
        if self.below >= SURE and self.above >= SURE_ABOVE and self.turn_deg >= SURE_deg and self.width < WIDE:
            return FOUND
        if self.below >= DEEP and (rises or turned):
            return NOT_SURE
        rises = rises or (turned and self.above >= RISES)
        return NOT_SURE if self.below >= POSSIBLE and rises and self.turn_deg >= POSSIBLE_deg else NONE


def _beside(points: Sequence[Point], n: int, step: int) -> float:
    """The most on one side of the n-th, within reach and before anything lower."""
    most = least = abs(points[n].inertia)
    k = n + step
    while 0 <= k < len(points) and abs(points[k].inertia) >= least:
        ratio = points[k].frequency_Hz / points[n].frequency_Hz
        if not 1 / REACH <= ratio <= REACH:
            break
        most = max(most, abs(points[k].inertia))
        k += step
    return most / least if least > 0 else math.inf


def _turn_deg(points: Sequence[Point], n: int) -> float:
    at = points[n].frequency_Hz
    below = next((one for one in reversed(points[:n]) if one.frequency_Hz <= at / BESIDE), points[0])
    above = next((one for one in points[n:] if one.frequency_Hz >= at * BESIDE), points[-1])
    first, second = (cmath.phase(b.inertia / a.inertia) if a.inertia and b.inertia else 0.0
                     for a, b in ((below, points[n]), (points[n], above)))
    return math.degrees(first + second)


def _placed(points: Sequence[Point], n: int) -> float:
    """A parabola through the logarithms about the n-th."""
    at = points[n].frequency_Hz
    near = [k for k in range(len(points)) if 1 / ABOUT <= points[k].frequency_Hz / at <= ABOUT or abs(k - n) <= 1]
    x = [math.log(points[k].frequency_Hz / at) for k in near]
    y = [math.log(abs(points[k].inertia)) for k in near]
    s = [sum(one**power for one in x) for power in range(5)]
    t = [sum(a * b**power for a, b in zip(y, x)) for power in range(3)]
    whole = _determinant([s[0:3], s[1:4], s[2:5]])
    slope = _determinant([[s[0], t[0], s[2]], [s[1], t[1], s[3]], [s[2], t[2], s[4]]])
    bend = _determinant([[s[0], s[1], t[0]], [s[1], s[2], t[1]], [s[2], s[3], t[2]]])
    if not whole or bend / whole <= 0:
        return at
    return at * math.exp(min(max(-slope / (2 * bend), x[0]), x[-1]))


def _determinant(rows: Sequence[Sequence[float]]) -> float:
    (a, b, c), (d, e, f), (g, h, i) = rows
    return a * (e * i - f * h) - b * (d * i - f * g) + c * (d * h - e * g)


def _width(points: Sequence[Point], n: int) -> float:
    edges = []
    for side in (range(n - 1, -1, -1), range(n + 1, len(points))):
        edge = next((points[k].frequency_Hz for k in side if abs(points[k].inertia) >= WIDTH * abs(points[n].inertia)), None)
        if edge is None:
            return 0.0
        edges.append(edge)
    return (edges[1] - edges[0]) / points[n].frequency_Hz


def find_minimum(points: Sequence[Point]) -> Minimum | None:
    """Of the local minima the one that is most certain; None: it falls or rises all along."""
    found = []
    for n in range(1, len(points) - 1):
        here = abs(points[n].inertia)
        if 0 < here <= min(abs(points[n - 1].inertia), abs(points[n + 1].inertia)):
            found.append(Minimum(_placed(points, n), here, _beside(points, n, -1), _beside(points, n, 1),
                                 _turn_deg(points, n), _width(points, n)))
    rank = (NONE, NOT_SURE, FOUND)
    return max(found, key=lambda one: (rank.index(one.verdict), one.below * min(one.above, SURE_ABOVE)), default=None)


def is_passed(points: Sequence[Point]) -> bool:
    """A resonance is certain, and the highest points lie well above it: no need to go on to where a rotor may be lost."""
    found = find_minimum(points)
    return found is not None and found.verdict == FOUND and found.above >= SURE \
        and points[-1].frequency_Hz > BESIDE**2 * found.frequency_Hz


def find_antiresonance(points: Sequence[Point], resonance_Hz: float) -> float | None:
    """Where below the resonance the most is shown, more than all the inertia, less on either side, and the angle falls; the
    estimate shows it up to some 100 Hz."""
    below = [one for one in points if one.frequency_Hz < resonance_Hz]
    most = max(range(len(below)), key=lambda n: abs(below[n].inertia), default=0)
    if not below or below[most].frequency_Hz < LEAST_RATIO * resonance_Hz or -_turn_deg(points, most) < SURE_deg:
        return None
    flanks = max(abs(below[0].inertia), abs(below[-1].inertia))
    return below[most].frequency_Hz if abs(below[most].inertia) >= max(ANTIRESONANCE, FLANK * flanks) else None


@dataclasses.dataclass(frozen=True)
class Resonance:
    """What a sweep has shown. `detent_per_s2`: the stiffness of the detent torque that such a motor may have, at the amplitude
    of the sweep, over the inertia."""

    points: list[Point]
    minimum: Minimum | None
    verdict: str               # FOUND, NOT_SURE or NONE
    lost_Hz: float | None      # where the rotor has lost step, and the sweep has ended
    detent_per_s2: float = 0.0
    lost_step: bool = False    # on the way: the position may be off

    @property
    def resonance_Hz(self) -> float | None:
        return self.minimum.frequency_Hz if self.minimum and self.verdict != NONE else None

    @property
    def antiresonance_Hz(self) -> float | None:
        return find_antiresonance(self.points, self.resonance_Hz) if self.resonance_Hz is not None else None

    @property
    def rotor_share(self) -> float | None:
        """Of the inertia what is before the spring; None: the antiresonance is not seen. It is antiresonance^2 / resonance^2, once
        load / rotor of the detent torque's stiffness is taken from the latter."""
        if self.antiresonance_Hz is None or self.resonance_Hz is None:
            return None
        return (self.antiresonance_Hz**2 + self._detent_Hz2) / (self.resonance_Hz**2 + self._detent_Hz2)

    @property
    def without_detent_Hz(self) -> float | None:
        """What it may be without the stiffness of the detent torque, which a rotor that turns does not feel."""
        if self.resonance_Hz is None:
            return None
        rotor = self.rotor_share or LEAST_SHARE
        return math.sqrt(max(0.0, self.resonance_Hz**2 - (1 - rotor) / rotor * self._detent_Hz2))

    @property
    def _detent_Hz2(self) -> float:
        return self.detent_per_s2 / (2 * math.pi) ** 2

    def __str__(self) -> str:
        said = ["not sure"] if self.verdict == NOT_SURE else []
        if self.resonance_Hz is not None and self.minimum is not None:
            said += self._as_found(self.resonance_Hz, self.minimum)
        else:
            said += [f"none up to {one.frequency_Hz:.0f} Hz" for one in self.points[-1:]]
            said += ["rigid"] if self.verdict == NONE else []
            said += ["but the inertia that is shown varies"] if self.verdict != NONE and self.lost_Hz is None else []
        if self.lost_Hz is not None:
            said += [f"the rotor has lost step at {self.lost_Hz:.0f} Hz, where the sweep has ended: home the axis"]
        elif self.lost_step:
            said += ["the rotor has lost step on the way: home the axis"]
        return "resonance: " + "; ".join(said)

    def _as_found(self, resonance_Hz: float, minimum: Minimum) -> list[str]:
        least_Hz = self.without_detent_Hz or resonance_Hz
        is_range = least_Hz < CLEAR * resonance_Hz
        said = [(f"{least_Hz:.0f} to " if is_range else "") + f"{resonance_Hz:.0f} Hz"
                + f", {min(minimum.below, minimum.above):.1f} times less inertia than beside it"
                + (f", {100 * minimum.width:.0f} % wide" if minimum.width else "")]
        if self.antiresonance_Hz:
            said += [f"antiresonance: {self.antiresonance_Hz:.0f} Hz"]
        return said + ["the lower one without what detent torque may add at rest"] * is_range

    def save(self, path: str | pathlib.Path) -> None:
        """To .csv, or as a picture to .png or .svg."""
        place = pathlib.Path(path)
        check_place(place, SUFFIXES)
        if place.suffix == ".csv":
            rows = (f"{one.frequency_Hz:.6g},{abs(one.inertia):.6g},{math.degrees(cmath.phase(one.inertia)):.4g}\n"
                    for one in self.points)
            place.write_text("frequency_Hz,inertia_share,angle_deg\n" + "".join(rows), encoding="utf-8")
        else:
            self._draw(place)

    def _draw(self, place: pathlib.Path) -> None:
        from matplotlib.figure import Figure

        figure = Figure(figsize=(7, 4), layout="constrained")
        axes = figure.subplots()
        shown = [abs(one.inertia) for one in self.points]
        axes.loglog([one.frequency_Hz for one in self.points], shown, ".-")
        for found, what in ((self.resonance_Hz, "resonance"), (self.antiresonance_Hz, "antiresonance")):
            if found is not None:
                axes.axvline(found, color="0.6", linestyle="--")
                axes.annotate(f" {what}: {found:.0f} Hz", (found, max(shown)), rotation=90, va="top", ha="right")
        axes.set_xlabel("frequency, Hz")
        axes.set_ylabel("apparent inertia, of that in the settings")
        for axis, ticks in ((axes.xaxis, TICKS_Hz), (axes.yaxis, TICKS)):
            low, high = axis.get_view_interval()
            seen = [tick for tick in ticks if low <= tick <= high]
            axis.set_ticks(seen, labels=[f"{tick:g}" for tick in seen])
        axes.minorticks_off()
        axes.grid(True, alpha=0.3)
        figure.savefig(place, dpi=120)


def _varies(points: Sequence[Point]) -> bool:
    shown = [abs(one.inertia) for one in points]
    return max(shown, default=0.0) > RIGID * min(shown, default=0.0)


def judge(points: Sequence[Point], lost_Hz: float | None = None, detent_per_s2: float = 0.0, torque: float = 1.0) -> Resonance:
    """`points` with rising frequency; `torque`: about the minimum, of what was meant: less where the rotor has lost step."""
    minimum = find_minimum(points)
    found = Resonance(list(points), minimum, minimum.verdict if minimum else NONE, lost_Hz, detent_per_s2)
    at_Hz, least_Hz = found.resonance_Hz, found.without_detent_Hz
    if at_Hz is not None and least_Hz is not None and least_Hz < HALF * at_Hz:
        return dataclasses.replace(found, verdict=NOT_SURE)  # detent torque alone may do it
    if found.verdict == FOUND and torque < LEAST_TORQUE:
        return dataclasses.replace(found, verdict=NOT_SURE)  # friction and detent torque may be all that is seen
    if found.verdict == NONE and (lost_Hz is not None or _varies(points)):
        return dataclasses.replace(found, verdict=NOT_SURE, minimum=None)
    return found
