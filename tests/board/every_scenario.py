#!/usr/bin/env python3
"""Runs every scenario that the board can be on the image and on the simulated board, typed on both.

usage: every_scenario.py ROOT SIMULATOR IMAGE [OPTION]...

Fails if drive_hash, trace_hash or the failure of one differ, or if fewer than 106 are taken. Those that
ask for another board (16-bit sensors, another period, delay or range), or for what images leave to
simulations, are refused by the simulator: they are counted, no more. Expectations that are not held are reported; whether that is a failure says
the scenario's own test. OPTION: of `steadystep-sil run`.
"""

import os
import sys
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from same_as_simulator import Refused, complaints, run

AT_LEAST = 106  # scenarios
FOR_SIMULATION = "for simulation"  # in the words of a refusal
ALIKE = ("drive_hash", "trace_hash", "failure")


def both(simulator, image, scenario, options):
    """The summaries of both boards; what is said if the image's refuses the scenario."""
    try:
        executed = run(simulator, "--image", image, scenario, *options)
    except Refused as refusal:
        return str(refusal)
    return executed, run(simulator, "--typed", scenario, *options)


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    root, simulator, image, *options = sys.argv[1:]
    names = sorted(path.stem for path in Path(root, "sil", "scenarios").glob("*.toml"))
    refused, simulated_only, different = 0, 0, []
    with ThreadPoolExecutor(os.cpu_count()) as pool:
        runs = pool.map(lambda name: both(simulator, image, name, options), names)
        for number, (name, pair) in enumerate(zip(names, runs), 1):
            if number % 25 == 0:
                print(f"{number} of {len(names)}", file=sys.stderr)
            if isinstance(pair, str):
                refused += 1
                simulated_only += FOR_SIMULATION in pair
                continue
            executed, simulated = pair
            if any(executed[key] != simulated[key] for key in ALIKE):
                different.append(name)
                print(f"{name}: the boards differ")
            for complaint in complaints(name, executed):
                print(complaint)
    taken = len(names) - refused
    print(f"{taken} scenarios on both boards, {len(different)} differ; {refused} refused, "
          f"{simulated_only} of them for simulation, the others want another board")
    return 1 if different or taken < AT_LEAST else 0


if __name__ == "__main__":
    sys.exit(main())
