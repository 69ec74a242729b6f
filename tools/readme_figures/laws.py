"""firmware/control/README.md and the default law with an encoder: tools/compare."""
import json
import pathlib
import tempfile

from comparison.experiment import HOME_MOTOR, read_motor
from readme_figures.reading import mrad, p95, spelled, up
from readme_figures.registry import Cost, entry, table

DEFAULT = "feedback-linearisation"
COMPARED = [
    (DEFAULT, f"**default** (`{DEFAULT}`), cold"),
    ("pid", "PID with feed-forward (Bendjedia)"),
    ("state-feedback", "state feedback + load torque (Bendjedia)"),
    ("csmc-equivalent", "CSMC around the equivalent control (Seshagiri, Khalil)"),
    ("csmc", "CSMC −M sat (Seshagiri, Khalil)"),
    ("csmc-servo", "the same with servocompensator"),
    ("foc", "FOC (Kim), retuned"),
    ("stmms-plus", "STMMS with inductance feed-forward, no current sensor"),
    ("stmms", "STMMS (Kim)"),
    ("microstepping", "open-loop microstepping, 3 A"),
]
MOVES = ("move", "fast", "sine", "creep")
ONLY_SINE = ("csmc-servo",)  # made for a sine of known frequency
PARTS = [
    ("no voltage-disturbance observer", "without voltage disturbance observer",
     "`control/voltage_disturbance.h`"),
    ("no detent learning", "without detent learning", "`control/detent_compensation.h`"),
    ("no bridge-loss compensation", "without loss compensation", "`motor/actuation.h`"),
    ("no load compensation", "without load compensation", "`estimator/encoder_observer.h`"),
    ("no jerk feed-forward", "without jerk feed-forward", "`motion/reference.h`"),
]
COMPARE = "tools/compare --plants nominal --seeds 1-32"
PROBES = ("run compare-step compare-move compare-sine --json",
          "run compare-step compare-move compare-sine --json --parameters bendjedia-2012/foc",
          "run compare-move compare-creep --json --parameters bendjedia-2012/csmc-equivalent")


def compared(sources, *arguments):
    """{(law, move): row} of tools/compare, and the same of its ablation."""
    with tempfile.TemporaryDirectory() as folder:
        sources.tool("compare", *COMPARE.split()[1:], *arguments, "--out", folder, "--program",
                     sources.program)
        if pathlib.Path(folder, "creep.png").exists():
            sources.keep_picture(f"{folder}/creep.png", "compare-creep.png")
        with open(f"{folder}/table.json", encoding="utf-8") as file:
            found = json.load(file)
    return tuple({(row["law"], row["move"]): row for row in rows}
                 for rows in (found["rows"], found["ablation"] or ()))


def short(value_rad):
    """In mrad, as in a table of figures that are nearly all below one."""
    value = 1e3 * value_rad
    return f"{value:.3f}".removeprefix("0") if value < 1 else f"{value:.3g}"


def error_text(row):
    if row["refused"]:
        return "refused"
    return row["lost"] or short(row["position_error_rms_rad"])


def step_text(row, step_rad):
    settling, overshoot = 1e3 * row["settling_time_s"], 100 * row["overshoot_rad"] / step_rad
    return f"{settling:.{0 if settling > 20 else 1}f} ms, {overshoot:.0f} %"


def row_of(rows, law, title, step_rad):
    cells = [step_text(rows[law, "step"], step_rad), *(error_text(rows[law, move]) for move in MOVES)]
    if law in ONLY_SINE:
        cells = [cell if move == "sine" else "–" for move, cell in zip(("step", *MOVES), cells)]
    return [title, *(f"**{cell}**" if law == DEFAULT and place else cell
                     for place, cell in enumerate(cells))]


def lead(rows, move, metric="position_error_rms_rad"):
    """How many times the default's figure the best of the other laws has."""
    others = [row[metric] for (law, of), row in rows.items()
              if of == move and law != DEFAULT and not row["lost"] and not row["refused"]
              and not (law in ONLY_SINE and move != "sine") and row.get(metric) is not None]
    return f"{min(others) / rows[DEFAULT, move][metric]:.2f}"


@entry("laws", f"{COMPARE} --ablation", Cost.DEAR, probe=PROBES, picture="compare-creep.png")
def laws(sources):
    rows, parts = compared(sources, "--ablation")
    step_rad = read_motor(HOME_MOTOR).full_step_rad
    heads = ["law", "step settles, overshoot", "turn at 44 rad/s", "five at 93 rad/s",
             "sine 0.5 rad 5 Hz", "creep 0.5 rad/s"]
    found = {"table": table(heads, [row_of(rows, law, title, step_rad) for law, title in COMPARED])}
    for move in MOVES:
        found[f"lead-{move}"] = lead(rows, move)
    found["lead-step"] = lead(rows, "step", "settling_time_s")
    found |= {f"part-{move}": short(rows[DEFAULT, move]["position_error_rms_rad"])
              for move in ("move", "fast", "creep")}
    for name, _, _ in PARTS:
        key = name.removeprefix("no ").replace(" ", "-")
        found[key] = " / ".join(short(parts[name, move]["position_error_rms_rad"])
                                for move in ("move", "fast", "creep"))
    found["all"] = " / ".join(found.pop(f"part-{move}") for move in ("move", "fast", "creep"))
    return found


@entry("laws-learned", "tools/compare --plants nominal --seeds 1-8 --moves learned-creep --ablation "
       f"--laws {DEFAULT}", Cost.DEAR,
       probe=("run compare-learned-creep --json",
              "run compare-learned-creep --json --parameters bendjedia-2012/foc"))
def laws_learned(sources):
    rows, parts = compared(sources, "--seeds", "1-8", "--moves", "learned-creep", "--ablation",
                           "--laws", DEFAULT)
    creep = "learned-creep"
    return {"default": short(rows[DEFAULT, creep]["position_error_rms_rad"]),
            "up": up(1e3 * rows[DEFAULT, creep]["position_error_rms_rad"], 2),
            "without": short(parts["no detent learning", creep]["position_error_rms_rad"])}


@entry("default-law", "steadystep-sil run default-law-move default-law-creep-learned --seeds 1-32")
def default_law(sources):
    learned = sources.run("default-law-creep-learned")
    return {"move": spelled(1e3 * p95(sources.run("default-law-move"), "position_error_rms_rad",
                                      "0.03...0.28"), 3),
            "stored": short(p95(learned, "position_ripple_rms_rad", "4.23...5.2"))}



RATES = {"5 kHz": {"plant.period_s": 2e-4, "plant.half_period_counts": 17000}, "10 kHz": {},
         "20 kHz": {"plant.period_s": 5e-5, "plant.half_period_counts": 4250}}


@entry("control-rates", "steadystep-sil run SCENARIO --seeds 1-32 --set plant.period_s=5e-5 "
       "--set plant.half_period_counts=4250", Cost.DEAR,
       probe=("run bendjedia-fig12 hold-transition --json",
              "run bendjedia-fig12 --json --set plant.period_s=5e-5"))
def control_rates(sources):
    def errors(scenario, metric, window="move", digits=2):
        return [mrad(sources.run(scenario, settings=one), metric, window, digits, spelled)
                for one in RATES.values()]

    estimate = "estimate_error_max_rad"
    holds = [", ".join(column) for column in
             zip(*(errors("hold-transition", "position_error_max_rad", window, 1)
                   for window in ("0.39...0.5", "0.5...3.2", "3.2...3.5")))]
    fig12, move = errors("bendjedia-fig12", estimate), errors(
        "default-law-move", "position_error_rms_rad", "0.03...0.28", 3)
    return table(["", *RATES], [
        ["`bendjedia-fig10`, estimate in motion, mrad", *errors("bendjedia-fig10", estimate)],
        ["`bendjedia-fig12`, estimate in motion, mrad (bound 1.8)", *held(fig12, 1.8)],
        ["`bendjedia-fig13`, estimate in motion, mrad", *errors("bendjedia-fig13", estimate)],
        ["`hold-transition`, position error of arrival, rest, departure, mrad", *holds],
        ["`default-law-move`, position error, mrad rms (bound 0.15)", *held(move, 0.15)]])


def held(texts, bound):
    return [text if float(text) <= bound else f"{text}, not held" for text in texts]
