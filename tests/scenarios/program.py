"""Runs steadystep-sil for the tests of its outside."""
import pathlib
import subprocess
import sys
import tempfile

SIL = pathlib.Path(sys.argv[1])
ROOT = pathlib.Path(sys.argv[2])

# The smallest scenario that moves; tests put lines in or change them.
SMALL = """description = "a short move"
motor = "bendjedia-2012"
duration_s = 0.05

[drive]
hold_on_enable = false

[plant]
model = "bench"

[[event]]
time_s = 0.0
command = "move-trapezoid"
position_rad = 0.05
duration_s = 0.02
ramp_s = 0.01

[[expect]]
metric = "fault"
equals = "none"
"""


def run(*arguments, cwd=None):
    return subprocess.run([SIL, *map(str, arguments)], capture_output=True, text=True, cwd=cwd,
                          check=False)


class Checks:
    """Collects what is not as it should be."""

    def __init__(self):
        self.failed = 0
        self.passed = 0

    def that(self, condition, what):
        if condition:
            self.passed += 1
        else:
            self.failed += 1
            print(f"FAILED: {what}")

    def end(self):
        print(f"{self.passed} checks passed, {self.failed} failed")
        sys.exit(1 if self.failed else 0)


def scratch():
    return tempfile.TemporaryDirectory()
