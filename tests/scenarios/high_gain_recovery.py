"""The high-gain observer recovers state feedback as epsilon falls, Seshagiri and Khalil Fig 3b: the
largest difference of the two runs' positions is that of the paper's model, and falls with epsilon."""
import csv
import pathlib

from program import Checks, run, scratch

CHECKS = Checks()

STATE_FEEDBACK = "csmc-fig3"
# Reproduced from the paper's equations in continuous time, without quantisation.
DIFFERENCE_RAD = {"e300u": 1.58e-2, "e100u": 7.0e-3, "e30u": 2.63e-3, "e10u": 1.04e-3}
TOLERANCE = 0.02


def positions(folder, name):
    with open(folder / name / "trace.csv", encoding="utf-8", newline="") as file:
        rows = csv.reader(file)
        column = next(rows).index("theta_rad")
        return [float(row[column]) for row in rows]


with scratch() as scratch_folder:
    out = pathlib.Path(scratch_folder)
    names = [f"{STATE_FEEDBACK}-{epsilon}" for epsilon in DIFFERENCE_RAD]
    answer = run("run", STATE_FEEDBACK, *names, "--out", out)
    CHECKS.that(answer.returncode == 0, f"the scenarios hold: {answer.stdout}{answer.stderr}")
    state_feedback = positions(out, STATE_FEEDBACK)
    previous = float("inf")
    for name, expected in zip(names, DIFFERENCE_RAD.values()):
        difference = max(abs(a - b) for a, b in zip(positions(out, name), state_feedback))
        print(f"{name}: {difference:.4g} rad")
        CHECKS.that(abs(difference / expected - 1) <= TOLERANCE,
                    f"{name}: {difference:.4g} rad instead of {expected:.4g}")
        CHECKS.that(difference < previous, f"{name}: closer to state feedback than the one before")
        previous = difference
CHECKS.end()
