"""The matrix as text: a row per motor, a group of columns per plant and feedback."""
from motor_matrix.cells import ALL_PLANTS, FEEDBACKS, MOVES
from motor_matrix.verdict import HELD, LIMIT, REFUSED, WORST_FIRST

SIGNS = {HELD: "·", "fault": "F", "slip": "S", "commutation": "C", "position": "p", "slow": "t",
         REFUSED: "R", LIMIT: "l"}
LEGEND = ("· held, F fault, S slip, C commutation beyond 45°, p position at the end, "
          "t load step too slow,\nR refused, l position at the end within what the hold is computed "
          "to yield")


def groups_of(cells):
    """(plant, feedback) in order, those that are there."""
    present = {(cell["plant"], cell["feedback"]) for cell in cells}
    return [(plant, feedback) for plant in ALL_PLANTS for feedback in FEEDBACKS
            if (plant.name, feedback.name) in present]


def moves_of(cells):
    present = {cell["move"] for cell in cells}
    return [move for move in MOVES if move in present]


def by_motor(cells):
    rows = {}
    for cell in cells:
        rows.setdefault(cell["motor"], {})[cell["plant"], cell["feedback"], cell["move"]] = cell
    return rows


def settling_text(row, feedback):
    """Time to a sixteenth of a step after the load step on bench."""
    cell = row.get(("bench", feedback, "step"))
    if cell is None:
        return ""
    time_s = cell.get("settling_s")
    return "–" if time_s is None else f"{1e3 * time_s:.0f} ms"


def as_text(cells):
    groups, moves = groups_of(cells), moves_of(cells)
    width = max(len(moves), 5)
    rows = by_motor(cells)
    first = max(len(name) for name in rows)
    plants = [f"{plant.name if feedback is FEEDBACKS[0] or len(groups) == 1 else '':{width}}"
              for plant, feedback in groups]
    heads = [f"{'enc.' if feedback.counts else 'sl.':{width}}" for _, feedback in groups]
    lines = [f"{'':{first}}  " + " ".join(plants) + "  to 1/16 step on bench",
             f"{'motor':{first}}  " + " ".join(heads) + "  sl.     enc."]
    for name, row in rows.items():
        signs = []
        for plant, feedback in groups:
            found = [row.get((plant.name, feedback.name, move)) for move in moves]
            signs.append("".join(SIGNS[cell["verdict"]] if cell else " " for cell in found)
                         .ljust(width))
        lines.append(f"{name:{first}}  " + " ".join(signs)
                     + f"  {settling_text(row, 'sensorless'):7} {settling_text(row, 'encoder')}")
    return "\n".join(line.rstrip() for line in lines)


def legend(cells):
    return "moves: " + ", ".join(MOVES[move] for move in moves_of(cells)) + "\n" + LEGEND


def summary(cells):
    """Lines: how many cells hold, by plant and feedback, and what the others are."""
    lines = [f"{'':24}{'cells':>7}{'held':>7}"
             + "".join(f"{kind:>13}" for kind in WORST_FIRST) + f"{'wrong ready':>13}"]
    for plant, feedback in [*groups_of(cells), (None, None)]:
        these = [cell for cell in cells if plant is None
                 or (cell["plant"], cell["feedback"]) == (plant.name, feedback.name)]
        name = "all" if plant is None else f"{plant.name}, {feedback.name}"
        counts = [sum(cell["verdict"] == kind for cell in these)
                  for kind in (HELD, *WORST_FIRST)]
        wrong = sum(cell["wrong_ready"] for cell in these)
        lines.append(f"{name:24}{len(these):7}{counts[0]:7}"
                     + "".join(f"{count:13}" for count in counts[1:]) + f"{wrong:13}")
    return "\n".join(lines)


def limit_text(cell):
    limit = cell.get("limit_steps")
    if cell["verdict"] not in (LIMIT, "position") or limit is None:
        return ""
    return f", computed limit {limit:.3f} of a step"


def not_held_lines(cells, most):
    """What there is to say of the cells that do not hold: those of one motor, plant and feedback
    in a line, refusals of one text together."""
    places, refusals, wrong = {}, {}, {}
    for cell in cells:
        where = cell["motor"], cell["plant"], cell["feedback"]
        if cell["verdict"] == REFUSED:
            refusals.setdefault((cell["motor"], cell["words"]), []).append(cell)
        elif cell["verdict"] != HELD:
            places.setdefault(where, []).append(cell)
        if cell["wrong_ready"]:
            wrong.setdefault(where, []).append(cell)
    lines = []
    for where, those in places.items():
        worst = min(those, key=lambda cell: WORST_FIRST.index(cell["verdict"]))
        what = "LIMIT" if worst["verdict"] == LIMIT else "NOT HELD"
        lines.append(f"{what}  {', '.join(where)}: {', '.join(cell['move'] for cell in those)}; "
                     f"{worst['move']}, {worst['held_seeds']} of {worst['seeds']} seeds held: "
                     f"{worst['words']}{limit_text(worst)}; {worst['reproduce']}")
    for where, those in wrong.items():
        worst = max(those, key=lambda cell: cell["ready_deg"])
        lines.append(f"WRONG READY  {', '.join(where)}: {worst['ready_deg']:.1f}° electrical; "
                     f"{worst['reproduce']}")
    shown = lines[:most]
    if len(lines) > most:
        shown.append(f"and {len(lines) - most} more; --json lists them all")
    for (motor, words), those in refusals.items():
        shown.append(f"REFUSED  {motor}, {len(those)} cells: {words}")
    return shown
