"""firmware/README.md: at rest, slow, without voltage sensing, where the rotor stands."""
import math
import re
import statistics

from comparison.simulator import ROOT
from readme_figures.reading import mrad, p95, spelled, up, value_of
from readme_figures.registry import Cost, entry, table

TEETH = 50  # of bendjedia-2012
PLAIN = spelled

REST, RESTS = "0.5...3.2", ("0.39...0.5", "0.5...3.2", "3.2...3.5")
NO_DETENT = {"plant.detent_4": 0.0, "plant.detent_2": 0.0, "plant.detent_1": 0.0}
NO_FRICTION = {**NO_DETENT, "plant.coulomb_friction": 0.0}
REAL = {"plant.model": "real"}
TRANSITIONS = [
    ("`bench`", {}),
    ("`bench` at 20 kHz, `hold-transition-20kHz`",
     {"plant.period_s": 5e-5, "plant.half_period_counts": 4250}),
    ("`plant.model=real`", REAL),
    ("`real`, `drive.hold_current_A=1.5`", {**REAL, "drive.hold_current_A": 1.5}),
    ("`real`, `drive.law_bandwidth_rad_s=200.0`", {**REAL, "drive.law_bandwidth_rad_s": 200.0}),
    ("`real`, the same law on an encoder of 32,000 counts",
     {**REAL, "drive.feedback": "encoder", "drive.law": "state-feedback",
      "drive.law_bandwidth_rad_s": 200.0, "drive.encoder_zero_known": True,
      "plant.encoder_counts_per_turn": 32000}),
    ("`real`, `plant.detent_4`, `_2`, `_1` = 0", {**REAL, **NO_DETENT}),
    ("… and `plant.coulomb_friction=0.0`", {**REAL, **NO_FRICTION}),
    ("… and `plant.current_gain_a`, `_b` = 1",
     {**REAL, **NO_FRICTION, "plant.current_gain_a": 1.0, "plant.current_gain_b": 1.0}),
]


def transition(sources, scenario, settings, digits=1):
    runs = sources.run(scenario, settings=settings)
    return ", ".join(mrad(runs, "position_error_max_rad", window, digits, PLAIN)
                     for window in RESTS)


@entry("hold-transition", "steadystep-sil run hold-transition hold-transition-loaded --seeds 1-32 "
       "--set ROW", Cost.DEAR,
       probe=("run hold-transition hold-transition-loaded --json",
              "run hold-transition hold-transition-loaded --json --set plant.model=real"))
def hold_transition(sources):
    return table(["`--set`", "arrival, rest, departure", "under 0.2 N·m"],
                 [[name, transition(sources, "hold-transition", settings),
                   transition(sources, "hold-transition-loaded", settings)]
                  for name, settings in TRANSITIONS])


@entry("transition", "steadystep-sil run hold-transition hold-transition-loaded --seeds 1-32")
def from_rest_and_back(sources):
    """The worst of the phases, without a load and with one."""
    return up(max(1e3 * p95(sources.run(scenario), "position_error_max_rad", window)
                  for scenario in ("hold-transition", "hold-transition-loaded")
                  for window in RESTS), 1)


@entry("transition-rates", "steadystep-sil run hold-transition hold-transition-20kHz --seeds 1-32")
def at_twice_the_rate(sources):
    """Of each run its worst phase."""
    def typical(scenario):
        runs = sources.run(scenario)
        return spelled(1e3 * statistics.median(
            max(value_of(one, "position_error_max_rad", window) for window in RESTS)
            for one in runs), 2)

    return {"slow": typical("hold-transition"), "fast": typical("hold-transition-20kHz")}


@entry("transition-real", "steadystep-sil run hold-transition --seeds 1-32 --set plant.model=real")
def on_the_plant_real(sources):
    runs = sources.run("hold-transition", settings=REAL)
    return {name: mrad(runs, "position_error_max_rad", window, rounded=PLAIN)
            for name, window in zip(("rest", "departure"), RESTS[1:])}


@entry("commanded-voltage", "tools/commanded_voltage", Cost.DEAR,
       probe=("run commanded-voltage commanded-voltage-slow --json",))
def commanded_voltage(sources):
    """Of the table that the tool prints the rows in which something differs."""
    rows = [line.strip("| ").split(" | ") for line in
            sources.tool("commanded_voltage", "--program", sources.program).splitlines()[2:]]
    by_case = {(row[0], row[1]): row[2:] for row in rows}
    heads = ["dead time", "d current", "0.3 rad/s", "0.5", "1", "2", "5", "20"]
    lines = [[dead, "0 / 1 A", *map(" / ".join, zip(by_case[dead, "0 A"], by_case[dead, "1 A"]))]
             for dead in dict.fromkeys(row[0] for row in rows)]
    return table(heads, lines + [["1 µs", "1.5 A", *by_case["1 µs", "1.5 A"]]])


@entry("commanded-move", "steadystep-sil run commanded-voltage --seeds 1-32")
def commanded_move(sources):
    return {name: mrad(sources.run("commanded-voltage", settings=settings),
                       "estimate_error_max_rad", rounded=PLAIN)
            for name, settings in (("slow", {}), ("default", {"drive.law_bandwidth_rad_s": 300.0}))}


@entry("impulses", "tests/scenarios/initial_position.py build/sil/steadystep-sil .", Cost.DEAR,
       probe=("run initial-position initial-position-published --json",))
def impulses(sources):
    printed = sources.text("/usr/bin/python3", ROOT / "tests/scenarios/initial_position.py",
                           sources.program, ROOT, accepted=(0,))
    found = {}
    for order, depth, numeric, *values in re.findall(
            r"^([\w-]+), ([\d.]+), (\w+): ([\d.]+), ([\d.]+), ([\d.]+)$", printed, re.MULTILINE):
        so_far = found.get((order, float(depth)), (0.0, 0.0, 0.0))
        found[order, float(depth)] = tuple(map(max, so_far, map(float, values)))
    return table(["saturation depth", "+ − − + in each phase, twice: rms, largest error; net motion",
                  "published, + − once"],
                 [[f"{100 * depth:g} %"] + ["{:.1f}°, {:.1f}°; {:.1f}°".format(*found[order, depth])
                                            for order in ("impulses", "published-impulses")]
                  for depth in (0.05, 0.10, 0.20)])


def electrical(value_rad):
    return math.degrees(value_rad) * TEETH


PULSE_WINDOWS = ("0.1...0.3", "0.6...0.8", "1.1...1.3", "1.6...1.8", "2.1...2.3")


@entry("pulses", "steadystep-sil run standstill-pulses standstill-pulses-real --seeds 1-32", Cost.DEAR,
       probe=("run standstill-pulses standstill-pulses-real --json --seeds 1-2",
              "run standstill-pulses --json --numeric fixed"))
def pulses(sources):
    rows = []
    for plant, scenario in (("bench", "standstill-pulses"), ("real", "standstill-pulses-real")):
        runs = [run for numeric in ("float", "fixed")
                for run in sources.run(scenario, numeric=numeric)]
        rows.append([plant] + [f"{max(electrical(one) for one in values(runs, window)):.1f}°"
                               for window in PULSE_WINDOWS])
    return table(["plant", "no load", "0.05", "0.1", "0.15 N·m", "after release"], rows)


def values(runs, window):
    for run in runs:
        yield next(one["value"] for one in run["expectations"]
                   if one["metric"] == "estimate_error_rms_rad" and one["window"] == window)


@entry("phases", "steadystep-sil run SCENARIO --set plant.current_gain_a=1.01 --set "
       "plant.current_gain_b=0.99 --set drive.balance_phases=false")
def phases(sources):
    rows = []
    for share in (0.01, 0.03, 0.06):
        row = [f"±{100 * share:g} %"]
        for scenario in ("hold-transition", "standstill-load", "load-step"):
            pair = []
            for balanced in (False, True):
                runs = sources.run(scenario, "1-1", {
                    "plant.current_gain_a": 1 + share, "plant.current_gain_b": 1 - share,
                    "drive.balance_phases": balanced})
                pair.append(electrical(p95(runs, "estimate_error_max_rad", "all")))
            row.append(" / ".join(spelled(value, 1) for value in pair))
        rows.append(row)
    return table(["current gains", "`hold-transition`", "`standstill-load`", "`load-step`"], rows)


@entry("encoder-faults", "steadystep-sil run encoder-frozen encoder-reversed encoder-half encoder-jam")
def encoder_faults(sources):
    """Milliseconds from the event, or from the motion that shows it, to the fault."""
    begin = {"frozen": 0.1, "reversed": 0.1, "half": 0.1, "jam": 0.12}
    found = {}
    for name, begin_s in begin.items():
        (run,) = sources.run(f"encoder-{name}", "1-1")
        found[name] = spelled(1e3 * (run["faults"][0]["time_s"] - begin_s), 0)
    return found

