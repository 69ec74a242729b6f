"""The matrix as a picture: a square per cell, a row per motor."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.patches import Patch, Rectangle  # noqa: E402

from motor_matrix.cells import MOVES  # noqa: E402
from motor_matrix.table import by_motor, groups_of, moves_of  # noqa: E402
from motor_matrix.verdict import HELD, LIMIT, REFUSED  # noqa: E402

COLOURS = {HELD: "#a8ddb5", "fault": "#7f1d1d", "slip": "#c0392b", "commutation": "#e67e22",
           "position": "#f1c40f", "slow": "#f9e79f", LIMIT: "#e9f5b1", REFUSED: "#bdc3c7"}
TITLES = {HELD: "held", "fault": "fault", "slip": "slipped", "commutation": "commutation > 45°",
          "position": "position at the end", "slow": "load step too slow", LIMIT: "within its computed limit",
          REFUSED: "refused"}
SQUARE_in = 0.2


def draw(cells, title):
    """PNG."""
    groups, moves, rows = groups_of(cells), moves_of(cells), by_motor(cells)
    gap = 0.6
    pitch = len(moves) + gap
    width, height = pitch * len(groups), len(rows)
    figure, axes = plt.subplots(figsize=(2.6 + SQUARE_in * width, 2.2 + SQUARE_in * height))
    for y, row in enumerate(rows.values()):
        for g, (plant, feedback) in enumerate(groups):
            for m, move in enumerate(moves):
                cell = row.get((plant.name, feedback.name, move))
                if cell:
                    axes.add_patch(Rectangle((g * pitch + m, y), 1, 1, edgecolor="white",
                                             linewidth=0.8, facecolor=COLOURS[cell["verdict"]]))
                    if cell["wrong_ready"]:
                        axes.text(g * pitch + m + 0.5, y + 0.5, "!", ha="center", va="center",
                                  fontsize=7)
    for g, (plant, feedback) in enumerate(groups):
        axes.text(g * pitch + len(moves) / 2, -0.4, f"{plant.title}\n{feedback.name}",
                  ha="center", va="bottom", fontsize=6.5)
    axes.set_xlim(-0.2, width)
    axes.set_ylim(height, 0)
    axes.set_yticks([y + 0.5 for y in range(height)], list(rows), fontsize=7)
    axes.set_xticks([g * pitch + m + 0.5 for g in range(len(groups)) for m in range(len(moves))],
                    [MOVES[move] for _ in groups for move in moves], rotation=90, fontsize=4.5)
    axes.tick_params(length=0)
    for spine in axes.spines.values():
        spine.set_visible(False)
    present = {cell["verdict"] for cell in cells}
    items = [Patch(facecolor=COLOURS[kind], label=TITLES[kind])
             for kind in COLOURS if kind in present]
    axes.legend(handles=items, loc="lower left", bbox_to_anchor=(0, 1 + 2.2 / height),
                ncols=len(items), fontsize=7, frameon=False)
    axes.set_title(title, fontsize=9, loc="left", pad=52)
    buffer = io.BytesIO()
    figure.savefig(buffer, format="png", dpi=150, bbox_inches="tight")
    plt.close(figure)
    return buffer.getvalue()
