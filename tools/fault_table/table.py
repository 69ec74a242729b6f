"""The cells as a table: in a README between its markers, and as lines of CSV."""
import csv
import io

from data_sheets.readme import replaced
from fault_table.cells import FAULTS, POINTS
from fault_table.outcome import worst_of

BEGIN, END = "<!-- tools/faults --readme writes from here -->", "<!-- to here -->"
PAGE = "../interface/faults.md"


def linked(name):
    """By the definitions behind the tables."""
    return name if name == "warning" else f"[{name}]"


def definitions_of(found):
    names = {one.detected_as for outcomes in found.values() for one in outcomes} - {"", "warning"}
    return "\n".join(f"[{name}]: {PAGE}#{name}" for name in sorted(names))


def names_of(outcomes):
    found = sorted({outcome.detected_as for outcome in outcomes if outcome.detected_as})
    return " or ".join(linked(name) for name in found)


def size_text(cells, outcomes):
    """Of the worst: peak current in rated currents and, of one motor, A; off its reference."""
    peaks = [(outcome.peak_A / cell.motor.rated_current_A, outcome.peak_A)
             for cell, outcome in zip(cells, outcomes) if outcome.peak_A is not None]
    steps = worst_of(outcome.error_rad / cell.motor.full_step_rad
                     for cell, outcome in zip(cells, outcomes) if outcome.error_rad is not None)
    rated, peak_A = max(peaks, default=(0.0, 0.0))
    one = len({cell.motor.id for cell in cells}) == 1
    amperes = f" ({peak_A:.1f} A)" if one else ""
    return f"{rated:.1f} ×{amperes}, {steps or 0.0:.2g} steps"


def cell_text(cells, outcomes):
    """Of the runs of one fault in one operating point."""
    if not outcomes:
        return "–"
    said = [outcome for outcome in outcomes if outcome.detected_as]
    at_once = [outcome for outcome in said if not outcome.in_next]
    later = [outcome for outcome in said if outcome.in_next]
    silent = len(outcomes) - len(said)
    parts = []
    for these, where in ((at_once, ""), (later, " of the next motion")):
        if these:
            after_ms = 1e3 * worst_of(outcome.after_s for outcome in these)
            share = "" if len(these) == len(outcomes) else f" in {len(these)} of {len(outcomes)}"
            parts.append(f"{names_of(these)}{share}, {after_ms:.3g} ms{where}")
    if silent:
        share = "" if silent == len(outcomes) else f" in {silent} of {len(outcomes)}"
        parts.append(f"not detected{share}")
    return "; ".join(parts) + ": " + size_text(cells, outcomes)


def table_of(found, drive, motors):
    """`found`: {cell: its outcomes}."""
    lines = [["fault", *(point.title for point in POINTS)], ["---"] * (1 + len(POINTS))]
    for fault in FAULTS:
        if drive.feedback not in fault.feedbacks:
            continue
        line = [fault.title]
        for point in POINTS:
            runs = [(cell, outcome) for cell, outcomes in found.items()
                    if (cell.drive, cell.fault, cell.point) == (drive, fault, point)
                    and cell.motor.id in motors for outcome in outcomes]
            line.append(cell_text([cell for cell, _ in runs], [outcome for _, outcome in runs]))
        lines.append(line)
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def section_of(found, drives, home, conditions):
    """The text between the markers."""
    others = [motor for motor in dict.fromkeys(cell.motor.id for cell in found) if motor != home]
    parts = [conditions]
    for drive in drives:
        parts += [f"### {drive.title[0].upper()}{drive.title[1:]}", table_of(found, drive, [home])]
    if others:
        for drive in drives[:2]:
            parts += [f"### {drive.title[0].upper()}{drive.title[1:]}: {', '.join(others)}",
                      table_of(found, drive, others)]
    parts.append(definitions_of(found))
    return "\n\n".join(parts)


def with_table(text, *what):
    return replaced(text, BEGIN, END, section_of(*what))


def as_csv(found):
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    writer.writerow(["motor", "drive", "fault", "point", "numeric", "seed", "detected_as",
                     "after_ms", "in_next_motion", "peak_A", "peak_rated", "error_rad",
                     "error_steps", "failure"])
    for cell, outcomes in found.items():
        for one in outcomes:
            after = "" if one.after_s is None else f"{1e3 * one.after_s:.1f}"
            sizes = [""] * 4 if one.failure else [
                f"{one.peak_A:.4g}", f"{one.peak_A / cell.motor.rated_current_A:.3g}",
                f"{one.error_rad:.4g}", f"{one.error_rad / cell.motor.full_step_rad:.3g}"]
            writer.writerow([cell.motor.id, cell.drive.name, cell.fault.name, cell.point.name,
                             one.numeric, one.seed, one.detected_as, after, int(one.in_next), *sizes,
                             one.failure])
    return out.getvalue()
