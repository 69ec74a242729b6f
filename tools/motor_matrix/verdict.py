"""What came of a cell: held, refused, or what the worst of its seeds has done."""
import math

from motor_matrix.cells import expectations_of, ready_error_rad

HELD, LIMIT, REFUSED = "held", "limit", "refused"
# Of a run that does not hold, the first that applies; as expectations_of lists them.
KINDS = ("fault", "slip", "commutation", "position", "slow")
# Of the runs of a cell the first that there is: a fault that the drive states before it is ready is
# a refusal, and an error within what the hold is computed to yield is the motor's limit.
WORST_FIRST = (*KINDS, REFUSED, LIMIT)
# Faults with which the drive says that this motor is none for it, instead of ready.
REFUSING_FAULTS = ("position-not-found",)


def failure_of(run, expectations):
    """(kind, words) of one run in one cell; None: it held."""
    limit_rad = run["hold_yield_rad"]
    if run["failure"] is not None:
        refused = any(f"fault {fault}" in run["failure"] for fault in REFUSING_FAULTS)
        return REFUSED if refused else "fault", run["failure"]
    for kind, expected in zip(KINDS, expectations):
        if not expected["passed"]:
            within = (kind == "position" and limit_rad is not None
                      and expected["value"] is not None and expected["value"] <= limit_rad)
            return LIMIT if within else kind, words_of(kind, expected)
    return None


def words_of(kind, expected):
    value, bound = expected["value"], expected.get("max")
    if kind == "fault":
        return f"fault {value}"
    if value is None:
        return f"{expected['metric']}: no value"
    if kind == "slip":
        return f"{value:.0f} full steps lost"
    return f"{expected['metric']} {value:.3g}, allowed {bound:.3g}"


def in_steps(rad, motor):
    return None if rad is None else rad / motor.full_step_rad


def figures_of(runs, which, span, motor):
    """The worst of the seeds; but for the first instant, none if one ended in a fault, behind which
    a rotor coasts."""
    faulty = any(run["failure"] is not None or not run["expectations"][which][0]["passed"]
                 for run in runs)

    def worst(values, sound=not faulty):
        values = list(values)
        return max(values) if sound and all(value is not None for value in values) else None

    expected = [run["expectations"][which] for run in runs]
    electrical = math.degrees(motor.rotor_teeth)
    commutation = worst(one[2]["value"] for one in expected)
    ready = worst((run["reports"][0]["value"] for run in runs), sound=True)
    figures = {
        "commutation_deg": commutation and commutation * electrical,
        "final_steps": in_steps(worst(one[3]["value"] for one in expected), motor),
        "ready_deg": ready and ready * electrical,
    }
    if span.load_at_s is not None:
        figures["settling_s"] = worst(run["reports"][1]["value"] for run in runs)
    return figures


def cell(run_plan, span, first, runs):
    """Of the summaries of all seeds; `first`: index of the cell's first expectation."""
    count = len(expectations_of(span, run_plan.motor, run_plan.plant, run_plan.feedback))
    which = slice(first, first + count)
    failures = [(run, failure_of(run, run["expectations"][which])) for run in runs]
    failed = [(run, failure) for run, failure in failures if failure]
    verdict, words, seed = HELD, "", runs[0]["seed"]
    if failed:
        run, (verdict, words) = min(failed, key=lambda one: WORST_FIRST.index(one[1][0]))
        seed = run["seed"]
    figures = figures_of(runs, which, span, run_plan.motor)
    ready = figures["ready_deg"]
    ready_limit = (math.degrees(ready_error_rad(run_plan.motor, run_plan.feedback))
                   * run_plan.motor.rotor_teeth if run_plan.feedback.counts else None)
    return {
        **place(run_plan, span), "verdict": verdict, "words": words, "seeds": len(runs),
        "held_seeds": len(runs) - len(failed), "worst_seed": seed, "limit_steps": in_steps(runs[0]["hold_yield_rad"], run_plan.motor),
        **figures,
        "wrong_ready": ready_limit is not None and ready is not None and ready > ready_limit,
    }


def place(run_plan, span):
    return {"motor": run_plan.motor.id, "plant": run_plan.plant.name,
            "feedback": run_plan.feedback.name, "move": span.move, "scenario": run_plan.name}


def refused_cell(run_plan, span, text):
    return {**place(run_plan, span), "verdict": REFUSED, "words": text, "seeds": 0,
            "held_seeds": 0, "worst_seed": None, "wrong_ready": False}


def cells_of(run_plan, runs):
    """Of one scenario: `runs` are its summaries, or the refusal (a text) in their place."""
    found, first = [], 0
    for span in run_plan.course.spans:
        if isinstance(runs, str):
            found.append(refused_cell(run_plan, span, runs))
        else:
            found.append(cell(run_plan, span, first, runs))
        first += len(expectations_of(span, run_plan.motor, run_plan.plant, run_plan.feedback))
    return found


def bound_misses(cells, bounds):
    """(a line for each bound that does not hold, how many were asked) of {plant: {feedback: {held:
    least share of cells, within_limits: that of those that hold, keep within the computed limit or
    are refused, wrong_ready: most cells}}}; the plant "all" and the feedback "all" stand for every
    one."""
    lines, asked = [], 0
    for plant, by_feedback in bounds.items():
        for feedback, bound in by_feedback.items():
            these = [cell for cell in cells if plant in ("all", cell["plant"])
                     and feedback in ("all", cell["feedback"])]
            if not these:
                continue
            verdicts = [cell["verdict"] for cell in these]
            found = {"held": verdicts.count(HELD) / len(these),
                     "within_limits": sum(verdicts.count(kind) for kind in (HELD, LIMIT, REFUSED))
                     / len(these),
                     "wrong_ready": sum(cell["wrong_ready"] for cell in these)}
            for key, limit in bound.items():
                asked += 1
                if found[key] > limit if key == "wrong_ready" else found[key] < limit:
                    lines.append(f"{plant}, {feedback}: {key} {found[key]:.4g} of {len(these)} "
                                 f"cells, bound {limit:g}")
    return lines, asked
