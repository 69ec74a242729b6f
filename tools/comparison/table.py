"""The comparison as aligned text, as JSON, and against its bounds."""
import tomllib
from typing import NamedTuple

from comparison.simulator import Refused

# Columns of a move: metric, heading, factor from SI, digits after the point.
STEP_COLUMNS = [("settling_time_s", "settle ms", 1e3, 1), ("overshoot_rad", "overshoot %", None, 1),
                ("position_error_max_rad", "load peak mrad", 1e3, 2)]
MOVE_COLUMNS = [("position_error_rms_rad", "rms mrad", 1e3, 3),
                ("position_error_max_rad", "max mrad", 1e3, 2)]


class Column(NamedTuple):
    group: str
    heading: str
    texts: list      # one per entry
    values: list     # None: lost, refused or without value
    bold: object     # index of the best entry; None


def columns_of_move(move):
    return STEP_COLUMNS if move.name == "step" else MOVE_COLUMNS


def value_in(cell, metric, factor, step_rad):
    value = cell.figures.get(metric)
    if cell.lost or cell.refused or value is None:
        return None
    return 100 * value / step_rad if factor is None else factor * value


def text_of(cell, value, digits):
    if cell.refused:
        return "refused"
    if cell.lost:
        return cell.lost
    return "–" if value is None else f"{value:.{digits}f}"


def column(group, heading, cells, metric, factor, digits, step_rad):
    values = [value_in(cell, metric, factor, step_rad) for cell in cells]
    known = [value for value in values if value is not None]
    best = values.index(min(known)) if len(known) > 1 else None
    return Column(group, heading, [text_of(cell, value, digits)
                                   for cell, value in zip(cells, values)], values, best)


def largest(comparison, entry, plant, metric):
    """Over the moves in which the rotor is not lost."""
    cells = [comparison.cell(entry, plant, move) for move in comparison.moves]
    values = [cell.figures.get(metric) for cell in cells if not cell.lost and not cell.refused]
    return max((value for value in values if value is not None), default=None)


def summary_column(comparison, plant, metric, heading, digits):
    values = [largest(comparison, entry, plant, metric) for entry in comparison.entries]
    return Column("largest of the moves", heading,
                  ["–" if value is None else f"{value:.{digits}f}" for value in values], values,
                  None)


def main_columns(comparison, plant):
    """Errors move by move, then what they cost in current and voltage."""
    columns = []
    for move in comparison.moves:
        cells = [comparison.cell(entry, plant, move) for entry in comparison.entries]
        columns += [column(move.name, heading, cells, metric, factor, digits,
                           comparison.motor.full_step_rad)
                    for metric, heading, factor, digits in columns_of_move(move)]
    return columns + [summary_column(comparison, plant, "current_ripple_rms_A", "ripple A", 3),
                      summary_column(comparison, plant, "current_rms_A", "current A", 2),
                      summary_column(comparison, plant, "voltage_rms_V", "voltage V", 2)]


def mismatch_columns(comparison):
    """The rms errors alone, plant by plant."""
    columns = []
    for plant in comparison.plants:
        for move in comparison.moves:
            cells = [comparison.cell(entry, plant, move) for entry in comparison.entries]
            columns.append(column(plant.name, move.name, cells, "position_error_rms_rad", 1e3, 3,
                                  comparison.motor.full_step_rad))
    return columns


def as_text(names, columns):
    """Two lines of headings, one line per law."""
    name_width = max(map(len, ["law", *names]))
    widths = [max(map(len, [one.heading, *one.texts])) for one in columns]
    top, place = "", 0
    while place < len(columns):
        group, width = columns[place].group, -2
        while place < len(columns) and columns[place].group == group:
            width += widths[place] + 2
            place += 1
        top += "  " + group.center(width)[:max(width, len(group))]
    lines = [" " * name_width + top,
             f"{'law':{name_width}}" + "".join(f"  {one.heading:>{width}}"
                                               for one, width in zip(columns, widths))]
    lines += [f"{name:{name_width}}" + "".join(f"  {one.texts[row]:>{width}}"
                                               for one, width in zip(columns, widths))
              for row, name in enumerate(names)]
    return "\n".join(line.rstrip() for line in lines)


def as_json(comparison, version, numeric):
    rows = []
    for entry in comparison.entries:
        for plant in comparison.plants:
            for move in comparison.moves:
                cell = comparison.cell(entry, plant, move)
                rows.append({"law": entry.name, "plant": plant.name, "move": move.name,
                             "parameters": entry.parameters.parent.name + "/"
                             + entry.parameters.stem if entry.parameters else None,
                             "tuned": not entry.note,
                             "set": entry.settings, "lost": cell.lost or None,
                             "refused": cell.refused or None, **cell.figures,
                             "reproduce": cell.reproduce})
    return {"motor": comparison.motor.id, "numeric": numeric, "version": version,
            "seeds": list(comparison.seeds), "rows": rows}


def read_bounds(file):
    try:
        return tomllib.loads(file.read_text(encoding="utf-8"))
    except (OSError, tomllib.TOMLDecodeError) as error:
        raise Refused(f"{file}: {error}") from error


def misses(comparison, plant, bounds):
    """A line for each bound of the nominal plant that does not hold, and how many were asked."""
    lines, asked = [], 0
    for entry in comparison.entries:
        for move in comparison.moves:
            cell = comparison.cell(entry, plant, move)
            for metric, bound in bounds.get(entry.name, {}).get(move.name, {}).items():
                asked += 1
                value = cell.figures.get(metric)
                if cell.refused:
                    lines.append(f"{entry.name}, {move.name}: refused: {cell.refused}")
                elif metric not in cell.figures:
                    lines.append(f"{entry.name}, {move.name}: {metric}: the scenario does not "
                                 "report it")
                elif cell.lost or value is None or value > bound:
                    shown = cell.lost or ("none" if value is None else f"{value:.4g}")
                    lines.append(f"{entry.name}, {move.name}: {metric} {shown}, bound {bound:g}\n"
                                 f"  reproduce: {cell.reproduce}")
    return lines, asked
