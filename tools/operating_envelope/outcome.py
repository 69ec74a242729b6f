"""What came of a point: locked, left behind, or slipped."""
import math

from operating_envelope.points import WINDOW_s

LOCKED, BEHIND, SLIPPED = "locked", "behind", "slipped"
STALLED_FAULT = "stalled"  # the rotor does not follow; it is not lost
SLIP_deg = 90.0       # error of the estimate, electrical
BEHIND_SHARE = 0.05   # of the way in the window


def percentile_95(values):
    """The one that 95 % do not exceed; up to 19 values the largest."""
    return sorted(values)[math.ceil(0.95 * len(values)) - 1]


def figures_of(run):
    """What a summary says of its run."""
    reports = {one["metric"]: one["value"] for one in run["reports"]}
    everywhere = run["metrics"]["all"]
    return {"seed": run["seed"], "failure": run["failure"], "fault": everywhere["fault"],
            "worst_rad": everywhere["estimate_error_max_rad"],
            "error_rad": reports["estimate_error_max_rad"],
            "lag_rad": reports["position_error_final_rad"]}


def outcome_of_run(run, point, motor):
    """Of the figures of one run. `behind`: the estimate is sound, the rotor does not follow the
    reference; supply or current are at their limit, and the drive may have stopped for it. What the
    estimate does once the bridge is open says nothing."""
    degrees = math.degrees(1) * motor.rotor_teeth
    worst, error, fault = run["worst_rad"], run["error_rad"], run["fault"]
    if fault == STALLED_FAULT:
        return {"outcome": BEHIND, "fault": fault, "error_deg": None}
    if run["failure"] or worst is None or error is None or worst * degrees > SLIP_deg:
        return {"outcome": SLIPPED, "fault": fault, "error_deg": None}
    if fault != "none":
        return {"outcome": SLIPPED, "fault": fault, "error_deg": error * degrees}
    way = BEHIND_SHARE * point.speed_rad_s * WINDOW_s
    behind = run["lag_rad"] > max(way, motor.full_step_rad)
    return {"outcome": BEHIND if behind else LOCKED, "fault": fault, "error_deg": error * degrees}


def outcome_of(runs, point, motor):
    """Of the figures of all seeds: one that slips is enough, then one that falls behind."""
    found = [outcome_of_run(run, point, motor) for run in runs]
    for outcome in (SLIPPED, BEHIND):
        those = [(one, run) for one, run in zip(found, runs) if one["outcome"] == outcome]
        if those:
            break
    else:
        those = [(one, run) for one, run in zip(found, runs)]
    errors = [one["error_deg"] for one in found if one["error_deg"] is not None]
    return {
        "outcome": those[0][0]["outcome"],
        "slipped_runs": sum(one["outcome"] == SLIPPED for one in found),
        "runs": len(found),
        "fault": those[0][0]["fault"],
        "error_deg": percentile_95(errors) if len(errors) == len(found) else None,
        "seed": those[0][1]["seed"],
    }
