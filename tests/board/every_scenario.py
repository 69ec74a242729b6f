#!/usr/bin/env python3
"""Runs every scenario that the board can be on the image and on the simulated board, typed on both.

usage: every_scenario.py ROOT SIMULATOR IMAGE [OPTION]...

Fails if drive_hash, trace_hash or the failure of one differ, or if fewer than 105 are taken. Those that
ask for another board (16-bit sensors, another period, delay or range) are refused by the simulator:
they are counted, no more. Expectations that are not held are told; whether that is a failure says
the scenario's own test. OPTION: of `steadystep-sil run`.
"""

import json
import os
import subprocess
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

AT_LEAST = 105  # scenarios
REFUSED = 2  # exit status
ALIKE = ("drive_hash", "trace_hash", "failure")


def summary(simulator, *options):
    """None if the simulator refuses the scenario."""
    done = subprocess.run(
        [simulator, "run", "--json", *options], capture_output=True, text=True, check=False
    )
    return None if done.returncode == REFUSED else json.loads(done.stdout)[0]


def both(simulator, image, scenario, options):
    executed = summary(simulator, "--image", image, scenario, *options)
    return executed, executed and summary(simulator, "--typed", scenario, *options)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    root, simulator, image, *options = sys.argv[1:]
    names = sorted(path.stem for path in Path(root, "sil", "scenarios").glob("*.toml"))
    refused, different = 0, []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = pool.map(lambda name: both(simulator, image, name, options), names)
        for number, (name, (executed, simulated)) in enumerate(zip(names, runs), 1):
            if number % 25 == 0:
                print(f"{number} of {len(names)}", file=sys.stderr)
            if executed is None:
                refused += 1
                continue
            if any(executed[key] != simulated[key] for key in ALIKE):
                different.append(name)
                print(f"{name}: the boards differ; the image's run: {executed['failure'] or 'ended'}")
            for bound in executed["expectations"]:
                if not bound["passed"]:
                    print(f"{name}: not held: {json.dumps(bound)}")
    taken = len(names) - refused
    print(f"{taken} scenarios on both boards, {len(different)} differ; {refused} want another board")
    return 1 if different or taken < AT_LEAST else 0


if __name__ == "__main__":
    sys.exit(main())
