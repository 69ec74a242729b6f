"""One picture per move: the position error of every law over time."""
import io
import math

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
import numpy as np  # noqa: E402
from PIL import Image  # noqa: E402

from comparison.trace import has_trace, read_trace  # noqa: E402

# Okabe and Ito's palette and three more in its manner: a law keeps its colour in every picture.
COLOURS = ["#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#8c6d31", "#6a51a3",
           "#b2182b", "#4d4d4d", "#1b7837", "#c51b7d"]
STYLE = {
    "figure.dpi": 110,
    "font.size": 9,
    "axes.grid": True,
    "grid.color": "#dddddd",
    "axes.axisbelow": True,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "lines.linewidth": 1.1,
}
OWN_SCALE = "#fff4e5"  # behind a law whose error leaves the common scale
SHOWN_AFTER_STEP_s = 0.04
SHOWN_BEFORE_LOAD_s = 0.005
COMMON_SCALE = 3.0  # times the largest error of the law at the lower quartile; others have their own
WIDE_in, NARROW_in = 9.2, 4.4  # of a page on a screen, and on a telephone


def trace_of(folder):
    trace = read_trace(folder)
    trace["error_mrad"] = 1e3 * (trace["theta_ref_rad"] - trace["theta_rad"])
    return trace


def colour_of(comparison):
    return {entry.name: COLOURS[i % len(COLOURS)] for i, entry in enumerate(comparison.entries)}


def traces_of(comparison, move):
    """Of the laws that ran."""
    return {entry.name: trace_of(comparison.trace(entry, move)) for entry in comparison.entries
            if has_trace(comparison.trace(entry, move))}


def common_limit(traces, begin_s, end_s):
    """Half the height of the common scale in mrad."""
    sizes = []
    for trace in traces.values():
        shown = (trace["time_s"] >= begin_s) & (trace["time_s"] <= end_s)
        sizes.append(size_of(trace["error_mrad"][shown]))
    return 1.15 * min(max(sizes), COMMON_SCALE * float(np.percentile(sizes, 25)))


def size_of(error):
    """Its largest magnitude; what is not finite counts for nothing."""
    return float(np.max(np.abs(np.where(np.isfinite(error), error, 0))))


def draw_error(axes, trace, colour, begin_s, end_s, limit):
    shown = (trace["time_s"] >= begin_s) & (trace["time_s"] <= end_s)
    time, error = trace["time_s"][shown], trace["error_mrad"][shown]
    axes.axhline(0, color="#888888", linewidth=0.6)
    axes.plot(time, error, color=colour)
    axes.set_xlim(begin_s, end_s)
    if size_of(error) > limit:
        axes.set_facecolor(OWN_SCALE)
        axes.set_ylim(-1.15 * size_of(error), 1.15 * size_of(error))
        axes.text(0.995, 0.03, "own scale", transform=axes.transAxes, ha="right", va="bottom",
                  fontsize=7, color="#a05a00",
                  bbox={"facecolor": OWN_SCALE, "edgecolor": "none", "pad": 1})
    elif math.isfinite(limit):
        axes.set_ylim(-limit, limit)


def figures_line(comparison, entry, plant, move):
    cell = comparison.cell(entry, plant, move)
    if cell.lost:
        return "the rotor is lost" if cell.lost == "lost" else "the drive opened the bridge"
    figures = cell.figures
    if move.name == "step":
        settling = figures["settling_time_s"]
        parts = ["does not settle" if settling is None else f"settles in {1e3 * settling:.1f} ms",
                 f"load peak {1e3 * figures['position_error_max_rad']:.2f} mrad"]
    else:
        parts = [f"rms {1e3 * figures['position_error_rms_rad']:.3g}",
                 f"max {1e3 * figures['position_error_max_rad']:.3g} mrad"]
    return ", ".join(parts)


def title(axes, name, line, colour):
    axes.set_title(name, loc="left", fontsize=9, fontweight="bold", color=colour, pad=3)
    axes.set_title(line, loc="right", fontsize=7.5, color="#444444", pad=3)


def in_lines(text, narrow):
    return text.replace(", ", ",\n") if narrow else text


def draw_reference(axes, trace):
    axes.plot(trace["time_s"], trace["omega_ref_rad_s"], color="black")
    axes.set_ylabel("reference\nrad/s")
    axes.set_xlim(0, trace["time_s"][-1])
    load = axes.twinx()
    load.plot(trace["time_s"], trace["load_torque_Nm"], color="#999999", linestyle=(0, (4, 2)))
    load.set_ylabel("load (dashed)\nN·m", color="#777777")
    load.set_ylim(0, 1.6 * max(float(np.max(trace["load_torque_Nm"])), 1e-3))
    load.grid(False)
    load.spines["right"].set_visible(True)


def profile_picture(comparison, plant, move, narrow):
    traces = traces_of(comparison, move)
    colours = colour_of(comparison)
    first = next(iter(traces.values()))
    end_s = float(first["time_s"][-1])
    limit = common_limit(traces, 0, end_s)
    columns = 1 if narrow else 2
    rows = math.ceil(len(traces) / columns)
    figure = plt.figure(figsize=(NARROW_in if narrow else WIDE_in, 1.5 + 1.45 * rows),
                        layout="constrained")
    grid = figure.add_gridspec(rows + 1, columns, height_ratios=[0.9] + rows * [1])
    draw_reference(figure.add_subplot(grid[0, :]), first)
    entries = [entry for entry in comparison.entries if entry.name in traces]
    for place, entry in enumerate(entries):
        axes = figure.add_subplot(grid[1 + place // columns, place % columns])
        draw_error(axes, traces[entry.name], colours[entry.name], 0, end_s, limit)
        title(axes, entry.name, in_lines(figures_line(comparison, entry, plant, move), narrow),
              colours[entry.name])
        if place < len(entries) - columns:
            axes.tick_params(labelbottom=False)
    figure.supylabel("position error, reference − true / mrad", fontsize=9)
    figure.supxlabel("time / s", fontsize=9)
    return figure


def step_picture(comparison, plant, move, narrow):
    """The answer to the step beside the answer to the load."""
    traces = traces_of(comparison, move)
    colours = colour_of(comparison)
    first = next(iter(traces.values()))
    load_s = float(first["time_s"][np.argmax(first["load_torque_Nm"] > 0)])
    begin_s = load_s - SHOWN_BEFORE_LOAD_s
    limit = common_limit(traces, begin_s, first["time_s"][-1])
    step_mrad = 1e3 * comparison.motor.full_step_rad
    figure, panels = plt.subplots(len(traces), 2, figsize=(NARROW_in if narrow else WIDE_in,
                                                           0.5 + 1.25 * len(traces)),
                                  layout="constrained", sharex="col", squeeze=False)
    entries = [entry for entry in comparison.entries if entry.name in traces]
    for (left, right), entry in zip(panels, entries):
        trace, colour = traces[entry.name], colours[entry.name]
        draw_error(left, trace, colour, 0, SHOWN_AFTER_STEP_s, math.inf)
        left.set_ylim(-0.75 * step_mrad, 1.1 * step_mrad)
        draw_error(right, trace, colour, begin_s, first["time_s"][-1], limit)
        title(left, entry.name, "" if narrow else "step of one full step", colour)
        title(right, "", in_lines(figures_line(comparison, entry, plant, move), narrow), colour)
    figure.supylabel("position error, reference − true / mrad", fontsize=9)
    figure.supxlabel("time / s;   left: from the step" + (",\n" if narrow else ", ")
                     + "right: from the load step", fontsize=9)
    return figure


def draw(comparison, plant, move, narrow=False):
    """The picture of a move as PNG bytes, for a wide page or a narrow one; None if no law ran."""
    if not traces_of(comparison, move):
        return None
    with plt.rc_context(STYLE):
        picture = step_picture if move.name == "step" else profile_picture
        figure = picture(comparison, plant, move, narrow)
        drawn, small = io.BytesIO(), io.BytesIO()
        figure.savefig(drawn)
        plt.close(figure)
    # 256 colours are enough for lines, and make half of the file.
    Image.open(drawn).convert("RGB").quantize(256, dither=Image.Dither.NONE).save(
        small, format="PNG", optimize=True)
    return small.getvalue()
