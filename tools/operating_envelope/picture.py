"""The envelope as one picture: a map per panel, the nominal motor's the largest."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from matplotlib.colors import BoundaryNorm, ListedColormap  # noqa: E402
from matplotlib.patches import Patch, Rectangle  # noqa: E402
from PIL import Image  # noqa: E402

STYLE = {"figure.dpi": 110, "font.size": 9}
BOUNDS_deg = [0, 2, 4, 8, 15, 30, 90]
# Light is accurate. Left behind and slipped are no shades of the same thing.
SHADES = ["#f0f9e8", "#ccebc5", "#a8ddb5", "#7bccc4", "#43a2ca", "#0868ac"]
BEHIND_COLOUR, SLIPPED_COLOUR = "#d9d9d9", "#c0392b"
DARK_FROM_deg = 15  # on these cells the figure is written in white


def shade_of(row):
    colours, norm = ListedColormap(SHADES), BoundaryNorm(BOUNDS_deg, len(SHADES))
    return colours(norm(min(row["error_deg"], BOUNDS_deg[-1] - 1e-9)))


def cell(axes, row, x, y, font_size):
    slipped, behind = row["outcome"] == "slipped", row["outcome"] == "behind"
    colour = SLIPPED_COLOUR if slipped else BEHIND_COLOUR if behind else shade_of(row)
    axes.add_patch(Rectangle((x - 0.5, y - 0.5), 1, 1, facecolor=colour, edgecolor="white",
                             linewidth=0.8, hatch="////" if behind else None))
    if slipped:
        share = row["slipped_runs"] / row["runs"]
        text, ink = "×" if share == 1 else f"{100 * share:.0f}%", "white"
    elif behind:
        return
    else:
        error = row["error_deg"]
        text = f"{error:.1f}" if error < 9.95 else f"{error:.0f}"
        ink = "white" if error >= DARK_FROM_deg else "#222222"
    axes.text(x, y, text, ha="center", va="center", fontsize=font_size, color=ink)


def panel_map(axes, rows, title, font_size, labelled=(True, True)):
    speeds = sorted({row["speed_rad_s"] for row in rows})
    loads = sorted({row["load_share"] for row in rows})
    for row in rows:
        cell(axes, row, speeds.index(row["speed_rad_s"]), loads.index(row["load_share"]),
             font_size)
    axes.set_xlim(-0.5, len(speeds) - 0.5)
    axes.set_ylim(-0.5, len(loads) - 0.5)
    axes.set_xticks(range(len(speeds)), [f"{speed:.3g}" if speed else "rest" for speed in speeds],
                    rotation=90 if font_size < 6 else 0)
    axes.set_yticks(range(len(loads)), [f"{100 * load:.0f}" for load in loads])
    axes.tick_params(length=0, labelsize=max(6.5, font_size), labelbottom=labelled[0],
                     labelleft=labelled[1])
    axes.set_title(title, fontsize=9, fontweight="bold", pad=3)
    for spine in axes.spines.values():
        spine.set_visible(False)


def legend(figure, with_behind):
    names = [f"{low}…{high}°" for low, high in zip(BOUNDS_deg, BOUNDS_deg[1:])]
    items = [Patch(facecolor=shade, edgecolor="#999999", label=name)
             for shade, name in zip(SHADES, names)]
    if with_behind:
        items.append(Patch(facecolor=BEHIND_COLOUR, hatch="////", edgecolor="white",
                           label="does not follow"))
    items.append(Patch(facecolor=SLIPPED_COLOUR, label="slipped (×: every seed)"))
    figure.legend(handles=items, loc="center", ncols=len(items), fontsize=8, frameon=False,
                  handlelength=1.5, columnspacing=1.2, title_fontsize=8.5,
                  title="largest error of the estimate from the load step on, electrical degrees")


def axis_names(figure, table):
    figure.supxlabel("speed / rad/s", fontsize=9)
    figure.supylabel(f"load / % of {table['rated_torque_Nm']:.3g} Nm", fontsize=9)


def draw(table, panels):
    """PNG bytes."""
    rows_of = {panel.name: [row for row in table["rows"] if row["panel"] == panel.name]
               for panel in panels}
    first, *others = panels
    columns = (len(others) + 1) // 2
    # Inches: the nominal motor's map, the others', the legend.
    heights = [4.0] + ([5.2] if others else []) + [0.6]
    with plt.rc_context(STYLE):
        figure = plt.figure(figsize=(10.5, sum(heights)), layout="constrained")
        parts = figure.subfigures(len(heights), 1, height_ratios=heights)
        parts[0].suptitle(f"{table['motor']} without an encoder, load step at speed: plant "
                          f"{table['plant']}, {table['numeric']}, seeds "
                          f"{table['seeds'][0]} to {table['seeds'][1]}", fontsize=10)
        panel_map(parts[0].subplots(), rows_of[first.name], first.title, 8)
        axis_names(parts[0], table)
        if others:
            maps = parts[1].subplots(2, columns, sharey=True, squeeze=False)
            for i, panel in enumerate(others):
                place = (i // columns, i % columns)
                panel_map(maps[place], rows_of[panel.name], panel.title, 5.2,
                          (place[0] == 1, place[1] == 0))
            axis_names(parts[1], table)
        legend(parts[-1], any(row["outcome"] == "behind" for row in table["rows"]))
        drawn, small = io.BytesIO(), io.BytesIO()
        figure.savefig(drawn)
        plt.close(figure)
    Image.open(drawn).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        small, format="PNG", optimize=True)
    return small.getvalue()
