#!/usr/bin/python3
"""Fails if control interrupt or guard can reach code or constants outside CCM SRAM.

usage: interrupt_in_ccm.py IMAGE.elf            exit 1 and one line for each function or constant
       interrupt_in_ccm.py --self-test IMAGE.elf

How it looks: tools/arm_image/interrupt_code.py.
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image.image import Image  # noqa: E402
from arm_image.interrupt_code import ENABLING, INTERRUPTS, outside, reached  # noqa: E402


def check(path):
    image = Image(path)
    functions, constants = outside(image, INTERRUPTS)
    for name in sorted(functions):
        print(f"outside CCM: function {name}")
    for name in sorted(constants):
        print(f"outside CCM: constant {name}")
    count = len(reached(image, INTERRUPTS))
    print(f"{count} functions reached, {len(functions) + len(constants)} outside CCM")
    return 1 if functions or constants else 0


def self_test(path):
    """With nothing allowed, everything must be found: the interrupt, a table of the firmware."""
    functions, constants = outside(Image(path), INTERRUPTS, inside=range(0))
    tables = any(name.startswith("table") for name in constants)
    ok = ENABLING.isdisjoint(functions) and set(INTERRUPTS) <= functions and tables
    print(f"{'ok' if ok else 'WRONG'}: {len(functions)} functions, constants {sorted(constants)}")
    return 0 if ok else 1


if __name__ == "__main__":
    if len(sys.argv) == 2:
        sys.exit(check(sys.argv[1]))
    if len(sys.argv) == 3 and sys.argv[1] == "--self-test":
        sys.exit(self_test(sys.argv[2]))
    sys.exit(__doc__)
