"""The bearable amplitude over frequency, as a picture."""
import io

import matplotlib

matplotlib.use("Agg")
import matplotlib.pyplot as plt  # noqa: E402
from PIL import Image  # noqa: E402

from vibration_map.points import COARSE, PLANTS, STATES  # noqa: E402

# Okabe and Ito's palette, as tools/plot.
COLOURS = {"bench": "#0072b2", "real": "#d55e00"}
LINES = {"at rest": ("-", "o"), "in motion": ("--", "s")}
MUST, STRETCH = 10, 30


def draw(found, motor, hold_Hz, seeds, numeric):
    """`found`: {point: (share, whether no amplitude that was tried is too much)}."""
    plt.rcParams.update({"font.size": 10, "axes.axisbelow": True, "figure.dpi": 110})
    figure, axes = plt.subplots(figsize=(8.6, 4.6), layout="constrained")
    for state in STATES:
        for plant in PLANTS:
            points = sorted((point for point in found if (point.plant, point.state) == (plant, state)),
                            key=lambda point: point.frequency_Hz)
            if points:
                style, mark = LINES[state]
                axes.plot([point.frequency_Hz for point in points],
                          [100 * found[point][0] for point in points], style, marker=mark,
                          markersize=5, color=COLOURS[plant], label=f"{state}, plant {plant}")
    frequencies = sorted({point.frequency_Hz for point in found})
    for level, name in ((MUST, "must be borne"), (STRETCH, "wanted")):
        axes.axhline(level, color="#009e73", linewidth=1.2)
        axes.annotate(f"{level} %, {name}", (frequencies[0], level), xytext=(2, 3),
                      textcoords="offset points", color="#00694d", fontsize=9)
    if any(all_borne for _, all_borne in found.values()):
        axes.annotate("the most that was tried: borne", (frequencies[-1], 100 * COARSE[-1]),
                      xytext=(0, 5), textcoords="offset points", ha="right", color="#444444",
                      fontsize=9)
    if frequencies[0] < hold_Hz < frequencies[-1]:
        axes.axvline(hold_Hz, color="#555555", linewidth=1, linestyle=":")
        axes.annotate(f"the held rotor's own\nfrequency, {hold_Hz:.0f} Hz", (hold_Hz, 0),
                      xytext=(4, 6), textcoords="offset points", color="#444444", fontsize=9)
    axes.set_xscale("log")
    axes.set_xticks(frequencies, [f"{frequency:.0f}" for frequency in frequencies])
    axes.xaxis.set_minor_locator(matplotlib.ticker.NullLocator())
    axes.set_ylim(0, 100 * COARSE[-1] * 1.1)
    axes.set_xlabel("frequency of the load / Hz")
    axes.set_ylabel("amplitude that is borne for 2 s\n/ % of the rated torque (Km × rated current)")
    axes.grid(color="#dddddd")
    axes.spines[["top", "right"]].set_visible(False)
    axes.legend(loc="upper left", bbox_to_anchor=(1.005, 1.0), frameon=False, fontsize=9)
    figure.suptitle(f"Oscillating load that {motor.id} bears without an encoder, firmware in "
                    f"{numeric}, worst of {seeds[1] - seeds[0] + 1} seeds", fontsize=11)
    drawn = io.BytesIO()
    figure.savefig(drawn)
    plt.close(figure)
    return Image.open(drawn).convert("RGB").quantize(64, dither=Image.Dither.NONE)
