#!/usr/bin/python3
"""Fails if control interrupt or guard can reach code or constants outside CCM SRAM.

usage: interrupt_in_ccm.py IMAGE.elf            exit 1 and one line for each function or constant
       interrupt_in_ccm.py --sections IMAGE.elf the input sections they need, for the linker script
                                                fragment hal/stm32g474/interrupt_sections.ld
       interrupt_in_ccm.py --self-test IMAGE.elf

Walks the static call graph. Constants are the addresses in flash that the reached functions load.
What the interrupt calls only while the drive is being enabled may run from flash: ENABLING.
"""

import re
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image import call_graph  # noqa: E402
from arm_image.image import Image  # noqa: E402

INTERRUPTS = ["control_interrupt", "deadline_guard_interrupt"]
ENABLING = {"encoder_aligning_step", "offset_calibration_step"}  # and what they alone call
CCM = range(0x10000000, 0x10008000)
FLASH = range(0x08000000, 0x08080000)
VENEER = re.compile(r"__(.+)_veneer")


def loaded_constants(image, node):
    """Values that a function loads whole: literals, and pairs of MOVW and MOVT."""
    low = {}
    for instruction in node.instructions:
        literal = re.search(r"\[pc(?:, #(-?(?:0x)?[0-9a-f]+))?\]", instruction.operands)
        if literal and instruction.base == "ldr":
            at = (instruction.address + 4 & ~3) + int(literal.group(1) or "0", 0)
            yield image.word(at)
        half = re.fullmatch(r"(\w+), #(0x[0-9a-f]+|\d+)", instruction.operands)
        if half and instruction.base in ("movw", "mov"):
            low[half.group(1)] = int(half.group(2), 0)
        elif half and instruction.base == "movt" and half.group(1) in low:
            yield low[half.group(1)] | int(half.group(2), 0) << 16


def object_at(image, address):
    """Name of the symbol that begins nearest below an address."""
    below = [(value & ~1, name) for name, value in image.symbols.items() if value & ~1 <= address]
    return max(below)[1]


def reached(image, roots):
    nodes = {}
    for root in roots:
        nodes.update(call_graph.walk(image, root))
    operating = {}
    to_visit = [start for start, node in nodes.items() if node.name in roots]
    while to_visit:
        start = to_visit.pop()
        if start not in operating and nodes[start].name not in ENABLING:
            operating[start] = nodes[start]
            to_visit.extend(nodes[start].calls)
    return operating


def outside(image, roots, inside=CCM):
    """(functions, constants): names of what is reached and does not lie inside."""
    nodes = reached(image, roots)
    functions = {n.name for start, n in nodes.items() if start not in inside}
    constants = set()
    for node in nodes.values():
        if VENEER.fullmatch(node.name):
            continue
        for value in loaded_constants(image, node):
            if value is None or value in inside or value & ~1 in nodes:
                continue
            if value in FLASH or value in CCM:
                constants.add(object_at(image, value))
    return functions, constants


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


def base_name(name):
    """Without what the optimiser appends to the name of a function that it has split or copied."""
    return re.sub(r"\.(part|constprop|isra|cold)\..*$|\.\d+$", "", name)


def print_sections(path):
    image = Image(path)
    functions, constants = outside(image, INTERRUPTS, inside=range(0))
    own = set(image.symbols)
    for name in sorted({base_name(f) for f in functions if not VENEER.fullmatch(f)} & own):
        print(f"*(.text.{name} .text.{name}.*)")
    for name in sorted({base_name(c) for c in constants}):
        print(f"*(.rodata.{name} .rodata.{name}.*)")
    return 0


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
    if len(sys.argv) == 3 and sys.argv[1] == "--sections":
        sys.exit(print_sections(sys.argv[2]))
    if len(sys.argv) == 3 and sys.argv[1] == "--self-test":
        sys.exit(self_test(sys.argv[2]))
    sys.exit(__doc__)
