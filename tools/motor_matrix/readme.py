"""The table of sil/motors/README.md that says which motors hold and how well, from the cells."""
from data_sheets.readme import replaced
from motor_matrix.cells import FEEDBACKS, MOVES, PLANTS
from motor_matrix.table import by_motor, settling_text
from motor_matrix.verdict import HELD, LIMIT, REFUSED

BEGIN, END = "<!-- tools/motors --readme writes from here -->", "<!-- to here -->"


def held_text(row, plant, feedback):
    """Of the moves: how many hold, which do not, and which keep within a computed limit."""
    cells = [row[plant.name, feedback.name, move] for move in MOVES
             if (plant.name, feedback.name, move) in row]
    held = sum(cell["verdict"] == HELD for cell in cells)
    text = f"{held}/{len(cells)}"
    if not held:
        return "refused" if all(cell["verdict"] == REFUSED for cell in cells) else text
    limits = [cell["move"] for cell in cells if cell["verdict"] == LIMIT]
    misses = [cell["move"] for cell in cells if cell["verdict"] not in (HELD, LIMIT)]
    parts = ([f"limit {', '.join(limits)}"] if limits else []) + (
        [f"not {', '.join(misses)}"] if 0 < len(misses) < 4 else [])
    return f"{text}: {'; '.join(parts)}" if parts else text


def final_text(row):
    """Worst final position error on bench, sensorless, full steps."""
    errors = [cell["final_steps"] for (plant, feedback, _), cell in row.items()
              if plant == "bench" and feedback == "sensorless"
              and cell.get("final_steps") is not None]
    return f"{max(errors):.3f}" if errors else "–"


def table_of(cells):
    columns = [(plant, feedback) for feedback in FEEDBACKS for plant in PLANTS]
    heads = ["motor", *(f"{plant.name}{', encoder' if feedback.counts else ''}"
                        for plant, feedback in columns),
             "worst final error on bench, steps", "to 1/16 step: sensorless", "encoder"]
    lines = [heads, ["---"] * len(heads)]
    for name, row in by_motor(cells).items():
        lines.append([name, *(held_text(row, *column) for column in columns), final_text(row),
                      *(settling_text(row, feedback.name) for feedback in FEEDBACKS)])
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def with_table(text, cells):
    """The README with its table replaced."""
    return replaced(text, BEGIN, END, table_of(cells))
