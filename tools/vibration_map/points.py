"""A point: one frequency on one plant, at rest or in motion, and the amplitude that is borne there."""
import math
from typing import NamedTuple

from comparison.simulator import Refused, toml_document

BEGIN_s, DURATION_s = 0.2, 2.2
TURNS_BACK_s = 1.2        # in motion the speed is reversed under the load
SPEED_SHARE = 0.2         # of the rated speed
PLANTS, STATES = ("bench", "real"), ("at rest", "in motion")
COARSE = (0.1, 0.2, 0.3, 0.45, 0.6, 0.8, 1.0)  # of the rated torque, upwards until one is not borne
FINE = 0.01


class Point(NamedTuple):
    plant: str
    state: str
    frequency_Hz: float


def points_of(frequencies_Hz, plants=PLANTS, states=STATES):
    return [Point(plant, state, frequency)
            for plant in plants for state in states for frequency in frequencies_Hz]


def frequencies(count, low_Hz=15.0, high_Hz=90.0):
    return [float(f"{low_Hz * (high_Hz / low_Hz) ** (place / (count - 1)):.3g}")
            for place in range(count)]


def scenario_of(point, share, motor):
    """Of an amplitude that is `share` of the motor's rated torque."""
    events = [{"time_s": BEGIN_s, "load_vibration_Nm": float(f"{share * motor.rated_torque_Nm:.5g}"),
               "load_vibration_Hz": point.frequency_Hz}]
    if point.state == "in motion":
        speed = float(f"{SPEED_SHARE * motor.rated_speed_rad_s:.3g}")
        limit = float(f"{0.2 * motor.rated_acceleration_rad_s2:.3g}")
        limits = {"acceleration_rad_s2": limit, "jerk_rad_s3": 100 * limit}
        events = [{"time_s": 0.0, "command": "velocity", "speed_rad_s": speed, **limits}, *events,
                  {"time_s": TURNS_BACK_s, "command": "velocity", "speed_rad_s": -speed, **limits}]
    return toml_document({
        "description": f"{100 * share:.0f} % of the rated torque at {point.frequency_Hz:g} Hz, "
                       f"{point.state}", "motor": str(motor.file), "duration_s": DURATION_s,
        "plant": {"model": point.plant, "current_range_rated": 2.0}, "event": events})


def is_borne(runs, rotor_teeth):
    """As `campaign load` judges: no fault, and never half an electrical turn from its place."""
    return all(not run["failure"] and run["metrics"]["all"]["fault"] == "none"
               and run["metrics"]["all"]["position_error_max_rad"] < math.pi / rotor_teeth
               for run in runs)


def borne(point, motor, simulator, seeds, folder):
    """The largest share of the rated torque below the first that one seed does not bear."""
    file = folder / f"{point.plant}-{point.state.replace(' ', '-')}-{point.frequency_Hz:g}.toml"

    def holds(share):
        file.write_text(scenario_of(point, share, motor), encoding="utf-8")
        answer = simulator.run_each([file], seeds=seeds)[0]
        if isinstance(answer, Refused):
            raise answer
        return is_borne(answer, motor.rotor_teeth)

    low, high = 0.0, None
    for share in COARSE:
        if not holds(share):
            high = share
            break
        low = share
    while high is not None and high - low > FINE * 1.001:
        middle = round((low + high) / 2, 4)
        low, high = (middle, high) if holds(middle) else (low, middle)
    return low, high is None
