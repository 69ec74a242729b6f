#!/usr/bin/env python3
"""Holds the runs of the image to the budget of the control interrupt, and to the static bound.

usage: budget.py ROOT BOUND FOLDER [OPTION]...

BOUND: what tools/longest_path --json has written of the image. FOLDER: summaries of
same_as_simulator.py. OPTION: of tools/interrupt_budget, to which both are handed;
--update-baseline writes baseline.json. Neither
the serial line, nor DMA, nor the flash may shift the start of the interrupt by more than 1 us.
The sensorless default, with the bridge on, is held to what the board, and all of it, may take in the
mean.
"""

import json
import subprocess
import sys
from pathlib import Path


JITTER_CYCLES = 170  # 1 us
# Their events hold the interrupt up: they say nothing of what it takes.
HELD_UP = {"board-overrun", "board-short-stall"}
# Mean cycles of the sensorless default with the bridge on, nominal: of stages, and of the interrupt.
SENSORLESS = "bendjedia-fig12"
STAGE_CYCLES = {"sampling": 220, "cycle counts": 30}
WHOLE_CYCLES = {"float": 1200}  # by number format: that of a drive with an FPU


def shifted(files):
    """Prints what a reader wants to know of the start; yields the runs that start too unevenly."""
    print("start behind S(k), cycles: least, mean, worst; preemptions; bytes in, out; flash writes")
    for file in files:
        interrupt = json.loads(file.read_text(encoding="utf-8"))[0]["interrupt"]
        start, line, flash = (
            interrupt[key] for key in ("start_latency_cycles", "serial_line", "flash")
        )
        print(
            f"  {file.stem:24} {start['least']} {start['mean']:.2f} {start['worst']};"
            f" {interrupt['preemptions']}; {line['bytes_in']}, {line['bytes_out']};"
            f" {flash['pages_erased'] + flash['double_words_programmed']}"
        )
        if interrupt["start_jitter_cycles"] > JITTER_CYCLES:
            yield f"{file.stem}: the start varies by {interrupt['start_jitter_cycles']} cycles"


def exceeded(summary):
    """Yields what of the sensorless default takes more than it may."""
    interrupt = summary["interrupt"]
    means = {name: columns["nominal"]["mean"] for name, columns in interrupt["stage_cycles"].items()}
    limits = dict(STAGE_CYCLES)
    if summary["numeric"] in WHOLE_CYCLES:
        means["whole interrupt"] = interrupt["total_cycles"]["nominal"]["mean"]
        limits["whole interrupt"] = WHOLE_CYCLES[summary["numeric"]]
    for name, most in limits.items():
        print(f"  {SENSORLESS}: {name} {means[name]:.1f} of {most} cycles in the mean")
        if means[name] > most:
            yield f"{SENSORLESS}: {name} takes {means[name]:.1f} cycles, must be at most {most}"


def main():
    if len(sys.argv) < 4:
        sys.exit(__doc__)
    tools, bound, folder = Path(sys.argv[1]) / "tools", sys.argv[2], Path(sys.argv[3])
    runs = [file for file in sorted(folder.glob("*.json")) if file.stem not in HELD_UP]
    if not runs:
        sys.exit(f"{folder}: no summaries; run the tests board.run.* first")
    judged = [tools / "interrupt_budget", *runs, "--longest-path", bound, *sys.argv[4:]]
    wrong = [f"{text}, must be at most {JITTER_CYCLES}" for text in shifted(runs)]
    default = next((file for file in runs if file.stem == SENSORLESS), None)
    if default is None:
        sys.exit(f"{folder}: no {SENSORLESS}.json; run the test board.run.{SENSORLESS} first")
    wrong += exceeded(json.loads(default.read_text(encoding="utf-8"))[0])
    sys.stdout.flush()
    for text in wrong:
        print(text, file=sys.stderr)
    return subprocess.run(judged, check=False).returncode or len(wrong) > 0


if __name__ == "__main__":
    sys.exit(main())
