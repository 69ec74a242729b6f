"""Initial position, table of the experiment: 36 rotor angles by saturation depths, in both number
formats. What the impulses find is compared with the true rotor in the first period that is ready.
The published order shows its error; a motor that shows impulses nothing is aligned; a rotor that
cannot follow the alignment is a named failure."""

import json
import math
from concurrent.futures import ThreadPoolExecutor

from program import Checks, run

CHECKS = Checks()

ANGLES = 36
TURN_RAD = 2 * math.pi / 50  # an electrical turn, mechanical
OFF_GRID = 0.37  # of a step: no angle is an axis of symmetry

# Degrees electrical, by order and depth: rms, largest, motion that is left.
BOUNDS = {
    ("impulses", 0.05): (2.9, 8.5, 0.7),
    ("impulses", 0.10): (1.6, 4.8, 1.15),
    ("impulses", 0.20): (1.2, 2.8, 2.3),
    ("published-impulses", 0.05): (11.5, 20.0, 1.8),
    ("published-impulses", 0.10): (5.8, 9.5, 1.8),
    ("published-impulses", 0.20): (2.9, 4.5, 1.9),
}


def electrical_degrees(rad):
    return rad / TURN_RAD * 360


def found(order, depth, numeric, step):
    """Errors of the angle and net motion, degrees electrical."""
    angle_rad = (step + OFF_GRID) / ANGLES * TURN_RAD
    # Assumed wrong by up to 0.4 electrical turn, another amount for each angle.
    assumed_wrong_rad = 0.4 * TURN_RAD * math.sin(2.4 * step)
    answer = run(
        "run",
        "initial-position",
        "--json",
        "--numeric",
        numeric,
        "--seed",
        str(step + 1),
        "--set",
        f"plant.initial_theta_rad={angle_rad!r}",
        "--set",
        f"plant.saturation_depth={depth}",
        "--set",
        f'drive.initial_position="{order}"',
        "--set",
        f"drive.initial_angle_error_rad={assumed_wrong_rad!r}",
    )
    try:
        metrics = json.loads(answer.stdout)[0]["metrics"]["all"]
    except (ValueError, LookupError):
        return math.inf, math.inf
    if metrics["fault"] != "none":
        return math.inf, math.inf
    return (
        electrical_degrees(metrics["estimate_error_max_rad"]),
        electrical_degrees(metrics["enabling_displacement_rad"]),
    )


def check_table():
    print("order, depth, format: rms, max, net motion in degrees electrical")
    table = {}
    with ThreadPoolExecutor(2) as pool:
        for (order, depth), bounds in BOUNDS.items():
            for numeric in ("float", "fixed"):
                rows = list(
                    pool.map(
                        lambda step, row=(order, depth, numeric): found(*row, step), range(ANGLES)
                    )
                )
                errors = [error for error, _ in rows]
                rms = math.sqrt(sum(error * error for error in errors) / ANGLES)
                row = (rms, max(errors), max(motion for _, motion in rows))
                table[order, depth, numeric] = row
                text = f"{order}, {depth:g}, {numeric}: {row[0]:.2f}, {row[1]:.2f}, {row[2]:.2f}"
                print(text)
                CHECKS.that(
                    all(value <= bound for value, bound in zip(row, bounds)),
                    f"{text}; allowed: {bounds}",
                )
    for depth in (0.05, 0.10):
        best = table["impulses", depth, "float"][0]
        published = table["published-impulses", depth, "float"][0]
        CHECKS.that(
            published > 2.5 * best,
            f"depth {depth:g}: + - - + is better by far than + -: {best:.2f}, {published:.2f}",
        )


def check_failure():
    for numeric in ("float", "fixed"):
        answer = run(
            "run",
            "initial-position-alignment",
            "--numeric",
            numeric,
            "--set",
            "plant.coulomb_friction=3",  # a rotor that is stuck
        )
        CHECKS.that(
            answer.returncode == 1 and "fault position-not-found" in answer.stdout,
            f"{numeric}: a stuck rotor is position-not-found: {answer.stdout}{answer.stderr}",
        )


def check_typed():
    """Enabling is timed from when its command acts, not from its first character."""
    times = [
        json.loads(run("run", "initial-position", "--json", *how).stdout)[0]["metrics"]["all"][
            "enabling_time_s"
        ]
        for how in ([], ["--typed"])
    ]
    CHECKS.that(times[0] == times[1], f"enabling takes {times[0]} s, typed {times[1]} s")


check_table()
check_failure()
check_typed()
CHECKS.end()
