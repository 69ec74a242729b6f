#!/usr/bin/env python3
"""What the configuration of an image must refuse, by name and with what it expects.

usage: build_options.py ROOT BUILD    exit 1 and one line for each that passes, or is refused in
                                      other words

BUILD: folder of a board's preset.
"""

import sys
import tempfile
from pathlib import Path

from mutants import output_of

# option, its value, in the words of the refusal
REFUSED = [
    ("STEADYSTEP_CONTROL_kHz", "12", "'12'; expected, of stm32g474: 5, 10, 20"),
    ("STEADYSTEP_CONTROL_kHz", "", "STEADYSTEP_CONTROL_kHz is ''"),
    ("STEADYSTEP_LAWS", "state-feedback;bang-bang", "names 'bang-bang'; expected all, or some of"),
    ("STEADYSTEP_LAWS", "pid", "leaves out state-feedback"),
]


def refusal(root, build, option, value):
    with tempfile.TemporaryDirectory() as folder:
        done = output_of(
            *("cmake", "--preset", "board-stm32g474", "-S", root, "-B", folder),
            *(f"-DSTEADYSTEP_HOST_BUILD={build}", f"-D{option}={value}"),
            check=False,
            folder=root,
        )
    return " ".join(done.stderr.split()) if done.returncode else ""


def main():
    if len(sys.argv) != 3:
        sys.exit(__doc__)
    root, build = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    wrong = 0
    for option, value, words in REFUSED:
        found = refusal(root, build, option, value)
        if words not in found:
            wrong += 1
            print(f"{option}={value}: expected {words!r}, found {found!r}")
    print(f"{len(REFUSED) - wrong} of {len(REFUSED)} refused")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
