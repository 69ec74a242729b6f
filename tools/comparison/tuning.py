"""What is tuned, within which ranges, and what a set of gains costs."""
import math
from typing import NamedTuple

from comparison.experiment import PLANTS, chosen
from comparison.simulator import Refused

# The plants that a law is tuned on; the ideal one would only reward what detent forbids.
TUNING_PLANTS = ("nominal", "warm", "stiff")
LOST = 1000.0           # cost of a move in which the rotor is lost, and the most any may cost
RIPPLE_LIMIT = 0.05     # rms current ripple allowed, of the rated current: 0.15 A of 3 A
RIPPLE_COST = 100.0     # of each RIPPLE_LIMIT beyond it
SINE_Hz = 5.0           # of the scenario compare-sine
SETTLING_REFERENCE_s = 0.01  # settling of the step that costs 1


class Tunable(NamedTuple):
    """A number of the optimiser, searched on a logarithmic scale."""
    key: str
    low: float
    high: float


# Ranges in control periods: from the slowest loop worth having (of the current: four times the
# bandwidth of the hold) to the most that a design takes; many laws refuse earlier.
PER_PERIOD = {
    "drive.law_bandwidth_rad_s": (0.005, 0.3),
    "drive.current_bandwidth_rad_s": (0.08, 0.3),
    "drive.observer_bandwidth_rad_s": (0.01, 0.3),
}
# A law that makes no use of some of them.
NOT_TUNED = {
    "microstepping": ("drive.law_bandwidth_rad_s", "drive.observer_bandwidth_rad_s"),
}
# Numbers of one law alone, with their ranges.
MORE = {
    "feedback-linearisation": {"drive.law_gains.damping": (0.4, 1.0)},
    "csmc": {"drive.law_gains.k0_q": (10, 2000), "drive.law_gains.k0_d": (10, 1000)},
    "csmc-equivalent": {"drive.law_gains.k0_q": (10, 2000), "drive.law_gains.k0_d": (10, 1000)},
}


def tunables_of(law, period_s):
    shared = [Tunable(key, low / period_s, high / period_s)
              for key, (low, high) in PER_PERIOD.items() if key not in NOT_TUNED.get(law, ())]
    return shared + [Tunable(key, low, high) for key, (low, high) in MORE.get(law, {}).items()]


# It follows no estimate, so it has nothing to learn the detent torque from.
WITHOUT_ENCODER = ("microstepping",)


def settings_by_motor(law, motor):
    """What a law has to be given besides, whoever's parameter set it has."""
    if law == "stmms":  # without current control it refuses speeds of N w L / R > 4
        return {"drive.speed_limit_rad_s": float(f"{3.999 * motor.electrical_corner_rad_s:.4g}")}
    if law == "csmc-servo":  # the sine's
        return {"drive.law_gains.servo_frequency_rad_s": float(f"{2 * math.pi * SINE_Hz:.6g}")}
    return {}


def fixed_settings(law, motor, learning):
    """What it is tuned with. `learning`: whether it learns the detent torque."""
    learns = {} if law in WITHOUT_ENCODER else {"drive.detent_learning": learning}
    return {**learns, **settings_by_motor(law, motor)}


def settings_at(point, tunables):
    """Settings for a point of the unit cube; four digits, so that a file says all there is."""
    return {one.key: float(f"{one.low * (one.high / one.low) ** place:.4g}")
            for one, place in zip(tunables, point)}


def point_at(settings, tunables):
    """The point of the unit cube nearest to these settings."""
    return [min(1.0, max(0.0, math.log(settings[one.key] / one.low) / math.log(one.high / one.low)))
            for one in tunables]


def figures_of(summary):
    """Figures of one run by metric, in SI units; None where there is none."""
    return {report["metric"]: report["value"] for report in summary["reports"]}


def is_lost(summary, full_step_rad):
    """A fault, or a rotor that does not end where it should: the next stable place is four full
    steps away."""
    everything = summary["metrics"]["all"]
    final = everything["position_error_final_rad"]
    return (summary["failure"] is not None or everything["fault"] != "none" or final is None
            or final > 2 * full_step_rad)


def cost_of_moves(runs, moves, motor, home):
    """Of one plant: `runs` as Simulator.run_each gives them. A move that is refused costs as much
    as a lost one; if all are, it is the settings that are not allowed, and the cost is infinite."""
    if all(isinstance(one, Refused) for one in runs):
        return math.inf
    return sum(LOST if isinstance(one, Refused) else cost_of_run(one[0], move, motor, home)
               for one, move in zip(runs, moves))


def cost_of_run(summary, move, motor, home):
    """Position error rms by the move's reference, and for a step its settling time; a penalty for
    current ripple beyond the limit."""
    if is_lost(summary, motor.full_step_rad):
        return LOST
    figures = figures_of(summary)
    scale = motor.full_step_rad / home.full_step_rad
    cost = figures["position_error_rms_rad"] / (move.reference_rad * scale)
    if "settling_time_s" in figures:
        settling = figures["settling_time_s"]
        cost += LOST if settling is None else settling / SETTLING_REFERENCE_s
    ripple = figures["current_ripple_rms_A"] / (RIPPLE_LIMIT * motor.rated_current_A)
    return min(LOST, cost + RIPPLE_COST * max(0.0, ripple - 1))


def tuning_plants():
    return chosen(PLANTS, TUNING_PLANTS, "plant")


DESCRIPTION = f"""\
sum over moves and plants of (position error rms) / (the move's reference),
plus the step's settling time / {1e3 * SETTLING_REFERENCE_s:g} ms,
plus {RIPPLE_COST:g} x (current ripple rms / ({RIPPLE_LIMIT:g} x rated current) - 1) where positive;
a lost rotor or a move that the drive refuses costs {LOST:g}, and no move costs more"""
