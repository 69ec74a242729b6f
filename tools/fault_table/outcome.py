"""What came of a cell in each number format and seed, and whether it keeps its bound."""
import fnmatch
import math
import tomllib
from typing import NamedTuple

from comparison.simulator import Refused


class Outcome(NamedTuple):
    """Of one run. `detected_as`: what the drive said, "" nothing, "warning": a line without a fault."""
    numeric: str
    seed: int
    failure: str = ""
    detected_as: str = ""
    after_s: float = None   # behind the fault, or behind the begin of the next motion
    in_next: bool = False   # said in the next motion only
    early: bool = False     # said before there was a fault
    peak_A: float = None    # of a phase, from the fault on
    error_rad: float = None  # of the rotor off its reference, until the drive has said so


def outcome_of(cell, numeric, run):
    """Of a run's summary, without `error_rad`."""
    _, at_s, next_s, _ = cell.timeline()
    seed = run["seed"]
    if run["failure"] is not None and not run["faults"]:
        return Outcome(numeric, seed, failure=run["failure"])  # behind a fault a motion is refused
    peak_A = max((report["value"] or 0.0 for report in run["reports"]
                  if report["metric"] == "current_peak_A"), default=0.0)
    if run["faults"]:
        first = run["faults"][0]
        time_s = first["time_s"]
        in_next = next_s is not None and time_s >= next_s
        return Outcome(numeric, seed, "", first["fault"], time_s - (next_s if in_next else at_s),
                       in_next, time_s < at_s - 1e-9, peak_A)
    if cell.fault.said and not cell.point.rests:
        return Outcome(numeric, seed, "", "warning", cell.fault.said[1], peak_A=peak_A)
    return Outcome(numeric, seed, peak_A=peak_A)


def until_said_s(cell, outcome):
    """When the drive has said so; None: it has not."""
    if outcome.failure or outcome.after_s is None or outcome.early or outcome.detected_as == "warning":
        return None
    _, at_s, next_s, _ = cell.timeline()
    return round((next_s if outcome.in_next else at_s) + outcome.after_s, 4)


def error_of(run):
    """Of all windows."""
    values = [report["value"] for report in run["reports"]
              if report["metric"] == "position_error_max_rad"]
    return max((value for value in values if value is not None), default=0.0)


class Bound(NamedTuple):
    faults: list
    drives: list
    points: list
    reason: str
    said: list = []         # what the drive may say; empty: it need not say anything
    within_ms: float = None  # behind the fault; for `next` behind the begin of the next motion
    next: bool = False      # may be said in the next motion only
    silent: bool = False    # may also say nothing
    peak_rated: float = None
    error_steps: float = None
    motors: list = ["*"]

    def covers(self, cell):
        return all(any(fnmatch.fnmatchcase(name, pattern) for pattern in patterns)
                   for name, patterns in ((cell.fault.name, self.faults),
                                          (cell.drive.name, self.drives),
                                          (cell.point.name, self.points),
                                          (cell.motor.id, self.motors)))


def read_bounds(file):
    try:
        tables = tomllib.loads(file.read_text(encoding="utf-8")).get("bound")
    except tomllib.TOMLDecodeError as error:
        raise Refused(f"{file}: {error}") from error
    if not isinstance(tables, list):
        raise Refused(f"{file}: expected an array of [[bound]]")
    bounds = []
    for i, table in enumerate(tables):
        unknown = set(table) - set(Bound._fields)
        missing = {"faults", "drives", "points", "reason"} - set(table)
        if unknown or missing:
            raise Refused(f"{file}: bound {i + 1}: " + (
                f"unknown {', '.join(sorted(unknown))}" if unknown
                else f"without {', '.join(sorted(missing))}"))
        bounds.append(Bound(**table))
    return bounds


def bound_of(cell, bounds, file):
    """The first that covers the cell."""
    for bound in bounds:
        if bound.covers(cell):
            return bound
    raise Refused(f"{file}: no bound covers {cell.motor.id} {cell.name}")


def misses_of(cell, outcome, bound):
    """Texts, one for each that the outcome does not keep."""
    if outcome.failure:
        return [f"failed: {outcome.failure}"]
    misses = []
    if outcome.early:
        misses.append(f"{outcome.detected_as} before there is a fault")
    elif not outcome.detected_as:
        if bound.said and not bound.silent:
            misses.append("nothing said")
    elif outcome.detected_as not in bound.said:
        misses.append(f"says {outcome.detected_as}")
    elif outcome.in_next and not bound.next:
        misses.append("said in the next motion only")
    elif bound.within_ms is not None and 1e3 * outcome.after_s > bound.within_ms + 0.05:
        misses.append(f"after {1e3 * outcome.after_s:.1f} ms, bound {bound.within_ms:g}")
    rated = outcome.peak_A / cell.motor.rated_current_A
    if bound.peak_rated is not None and rated > bound.peak_rated:
        misses.append(f"peak {rated:.2f} of the rated current, bound {bound.peak_rated:g}")
    steps = outcome.error_rad / cell.motor.full_step_rad
    if bound.error_steps is not None and not steps <= bound.error_steps:
        misses.append(f"{steps:.3g} full steps off, bound {bound.error_steps:g}")
    return misses


def worst_of(values):
    return max((value for value in values if value is not None and math.isfinite(value)),
               default=None)
