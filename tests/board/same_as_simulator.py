#!/usr/bin/env python3
"""Runs a scenario on the image of the board and on the simulated board, with the same typed lines.

usage: same_as_simulator.py SIMULATOR IMAGE NUMERIC FOLDER SCENARIO [OPTION]...

All expectations must hold on both, and both drives must have the same drive_hash. The summary of
the image's run goes to FOLDER/SCENARIO.json, for tools/interrupt_budget. OPTION: of
`steadystep-sil run`.
"""

import json
import subprocess
import sys
from pathlib import Path


REFUSED = 2  # exit status


class Refused(Exception):
    """The simulator refuses the scenario or an option; the text says why."""


def run(simulator, *options):
    """The summary of a run, also of one that has failed."""
    done = subprocess.run(
        [simulator, "run", "--json", *options], capture_output=True, text=True, check=False
    )
    if done.returncode == REFUSED:
        raise Refused(done.stderr)
    try:
        return json.loads(done.stdout)[0]
    except (ValueError, LookupError):
        sys.exit(f"no summary, exit status {done.returncode}:\n{done.stdout}{done.stderr}")


def complaints(name, summary):
    if summary["failure"]:
        yield f"{name}: {summary['failure']}"
    for bound in summary["expectations"]:
        if not bound["passed"]:
            yield f"{name}: not held: {json.dumps(bound)}"
    if not summary["passed"]:
        yield f"{name}: failed"


def main():
    if len(sys.argv) < 6:
        sys.exit(__doc__)
    simulator, image, numeric, folder, scenario, *options = sys.argv[1:]
    asked = [scenario, "--numeric", numeric, *options]
    try:
        simulated = run(simulator, "--typed", *asked)
        executed = run(simulator, "--image", image, *asked)
    except Refused as refusal:
        sys.exit(str(refusal))
    file = Path(folder) / f"{scenario}.json"
    file.parent.mkdir(parents=True, exist_ok=True)
    file.write_text(json.dumps([executed], indent=1), encoding="utf-8")

    wrong = [*complaints("simulator", simulated), *complaints("image", executed)]
    for name, summary in (("simulator", simulated), ("image", executed)):
        print(
            f"{name:10} drive_hash {summary['drive_hash']}, trace_hash {summary['trace_hash']}"
            f", {summary['simulated_s']:.4f} s in {summary['cpu_s']:.2f} s"
        )
    if simulated["drive_hash"] != executed["drive_hash"]:
        wrong.append("the drives differ")
    for complaint in wrong:
        print(complaint, file=sys.stderr)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
