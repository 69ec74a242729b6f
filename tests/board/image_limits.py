#!/usr/bin/python3
"""Fails if an image takes more memory than promised, or has something where it must not be.

usage: image_limits.py IMAGE.elf             prints what is used and exits 1 if that is too much
       image_limits.py --self-test IMAGE.elf expects each limit, lowered, to be found

The stack's worst case is another test: tools/stack_bound.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image import memory  # noqa: E402
from arm_image.image import Image  # noqa: E402

CAPTURE_B = 4 * int(re.search(r"HAL_CAPTURE_WORDS = (\d+)", (ROOT / "hal/hal.h").read_text())[1])

# flash: 128 KB; ccm: what is in use in November 2026, and little more, 26,214 at most;
# ram: all but what is captured, less 0.5 KB, as designs that are packed fill it
LIMITS_B = {"flash": 131_072, "ccm": 25_984, "ram": 96 * 1024 - CAPTURE_B - 512}
FLASH_BY_CONSOLE_B = 108_800  # without what a machine operates the drive by
# In fixed point: of ccm the 80 % that it must; of flash what it takes.
FIXED_B = {"flash": 134_800, "ccm": 26_214}
RAM = 0x20000000
SRAM2 = range(0x20014000, 0x20018000)
DMA_BUFFERS = ("leg_sums", "receive", "transmit")
VECTORS = 0x10000000  # aligned to more than the table takes


def limits_of(image):
    functions = {function[2] for function in image.functions}
    limits = dict(LIMITS_B)
    if functions.isdisjoint(("link_background", "machine_io_active")):
        limits["flash"] = FLASH_BY_CONSOLE_B
    if image.numeric() == "fixed":
        limits |= FIXED_B
    return limits


def used(image):
    """Bytes by memory; of flash what is loaded into it."""
    totals = {"flash": sum(len(data) for _, data in memory.loaded(image.path))}
    for name, start, size, _, _ in image.sections:
        where = name if name == ".capture" else memory.region(start)
        if where in ("ccm", "ram"):
            totals[where] = totals.get(where, 0) + size
    return totals


def violations(image, limits):
    for name, size in used(image).items():
        print(f"{name:5} {size:6} of {limits[name]} B")
        if size > limits[name]:
            yield f"{name}: {size} B, at most {limits[name]}"
    if image.symbols["stack_bottom"] != RAM:
        yield "stack: not at the bottom of SRAM, an overflow would not fault"
    for name in DMA_BUFFERS:
        if image.symbols[name] not in SRAM2:
            yield f"{name}: DMA works on it, it belongs into SRAM2 (DMA_BUFFER)"
    if image.symbols["vectors"] != VECTORS:
        yield f"vector table at {image.symbols['vectors']:#x}, expected {VECTORS:#x}"


def self_test(image):
    found = [list(violations(image, {**LIMITS_B, name: 1000})) for name in LIMITS_B]
    for texts in found:
        print(texts)
    return 0 if all(len(texts) == 1 for texts in found) else 1


def main(arguments):
    if len(arguments) == 2 and arguments[0] == "--self-test":
        return self_test(Image(arguments[1]))
    if len(arguments) != 1:
        sys.exit(__doc__)
    image = Image(arguments[0])
    found = list(violations(image, limits_of(image)))
    for text in found:
        print(text)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
