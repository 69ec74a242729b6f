"""The points of the envelope: speeds, loads, parameter errors, and the scenario of each."""
from typing import NamedTuple

from comparison.simulator import toml_document

# Shares of the speed at which the back-EMF alone takes the supply, and of the rated torque.
SPEEDS = (0.0, 0.0065, 0.013, 0.033, 0.065, 0.13, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
LOADS = (0.0, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9)
QUICK_SPEEDS = (0.0, 0.033, 0.3, 0.7)
QUICK_LOADS = (0.0, 0.3, 0.6)

ACCELERATION = 0.2  # of what the rated torque gives the rotor: three times the inertia can follow
JERK_TIME_s = 5e-3
SPEED_LIMIT = 1.4   # above its default of 1.3, so that references may lag for want of voltage
AT_REST_s = 1.0     # at no speed: a hold that is going to swing does so within it
AT_SPEED_s = 0.1    # from the end of the acceleration to the load step
WINDOW_s = 0.3      # from the load step on: what is judged


class Panel(NamedTuple):
    """One map: what the true motor is, relative to what the drive believes."""
    name: str
    title: str
    settings: dict


PANELS = (
    Panel("nominal", "motor as in its file", {}),
    Panel("resistance-low", "R −30 %", {"resistance_scale": 0.7}),
    Panel("inductance-low", "L −20 %", {"inductance_scale": 0.8}),
    Panel("km-low", "Km −10 %", {"km_scale": 0.9}),
    Panel("inertia-low", "J / 2", {"inertia_scale": 0.5}),
    Panel("resistance-high", "R +30 %", {"resistance_scale": 1.3}),
    Panel("inductance-high", "L +20 %", {"inductance_scale": 1.2}),
    Panel("km-high", "Km +10 %", {"km_scale": 1.1}),
    Panel("inertia-high", "J × 3", {"inertia_scale": 3.0}),
)


class Point(NamedTuple):
    panel: Panel
    speed_rad_s: float
    load_share: float
    load_Nm: float


def rounded(value, digits=4):
    return float(f"{value:.{digits}g}")


def speeds_of(motor, quick):
    return [rounded(share * motor.limit_speed_rad_s, 3)
            for share in (QUICK_SPEEDS if quick else SPEEDS)]


def points_of(motor, panels, quick):
    return [Point(panel, speed, share, rounded(share * motor.rated_torque_Nm))
            for panel in panels
            for share in (QUICK_LOADS if quick else LOADS)
            for speed in speeds_of(motor, quick)]


def up_to_speed(point, motor):
    """(events, time of the load); at no speed the drive rests."""
    if point.speed_rad_s == 0:
        return [], AT_REST_s
    acceleration = rounded(ACCELERATION * motor.rated_acceleration_rad_s2)
    jerk = rounded(acceleration / JERK_TIME_s)
    up_s = point.speed_rad_s / acceleration + JERK_TIME_s
    event = {"time_s": 0.0, "command": "velocity", "speed_rad_s": point.speed_rad_s,
             "acceleration_rad_s2": acceleration, "jerk_rad_s3": jerk}
    return [event], round(up_s + AT_SPEED_s, 3)


def scenario_of(point, motor, plant):
    """Up to speed or at rest, a while there, then the load, against the motion. Text of a file
    that stands beside the motor's."""
    events, load_s = up_to_speed(point, motor)
    end_s = round(load_s + WINDOW_s, 3)
    window = [load_s, end_s]
    return toml_document({
        "description": f"envelope: {point.panel.title}, {point.speed_rad_s:g} rad/s, "
                       f"{point.load_Nm:g} Nm",
        "motor": f"./{motor.file.name}",
        "duration_s": end_s,
        "drive": {"speed_limit_rad_s": rounded(SPEED_LIMIT * motor.limit_speed_rad_s)},
        "plant": {"model": plant, **point.panel.settings},
        "event": [*events, {"time_s": load_s, "load_torque_Nm": point.load_Nm}],
        "report": [
            {"metric": "estimate_error_max_rad", "window": window},
            {"metric": "estimate_error_rms_rad", "window": window},
            {"metric": "position_error_final_rad", "window": window},
        ],
    })
