"""What the control interrupt of a board's image can reach, by the static call graph.

Constants are the addresses of read-only memory that the reached functions load. What the interrupt calls only
while the drive is being enabled, or once as it is disabled, may run from flash: ENABLING.
"""

import re

from . import call_graph
from .image import SHF_WRITE

INTERRUPTS = ["control_interrupt", "deadline_guard_interrupt"]
# And what they alone call.
ENABLING = {
    "align_encoder",
    "disable",
    "encoder_aligning_step",
    "end_first_hold",
    "find_position_or_power_up",
    "position_detecting_cycle",
    "offset_calibration_step",
    "phase_balancing_start",
    "phase_balancing_step",
    "power_up",
    "realign",
    "start_enabling",
}
CCM = range(0x10000000, 0x10008000)
FLASH = range(0x08000000, 0x08080000)
VENEER = re.compile(r"__(.+)_veneer")


def enabling(image):
    """Addresses of what may run from flash, as far as the image has it."""
    return [start for start, _, name in image.functions if base_name(name) in ENABLING]


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
        if start not in operating and base_name(nodes[start].name) not in ENABLING:
            operating[start] = nodes[start]
            to_visit.extend(nodes[start].calls)
    return operating


def read_only(image):
    """Sections that nothing writes to: of the firmware's constants, in RAM."""
    return [
        range(start, start + size)
        for _, start, size, flags, _ in image.sections
        if not flags & SHF_WRITE
    ]


def outside(image, roots, inside=CCM):
    """(functions, constants): names of what is reached and does not lie inside."""
    nodes = reached(image, roots)
    functions = {n.name for start, n in nodes.items() if start not in inside}
    constants = set()
    constant = [FLASH, CCM, *read_only(image)]
    for node in nodes.values():
        if VENEER.fullmatch(node.name):
            continue
        for value in loaded_constants(image, node):
            if value is None or value in inside or value & ~1 in nodes:
                continue
            if any(value in memory for memory in constant):
                constants.add(object_at(image, value))
    return functions, constants


def base_name(name):
    """Without what the optimiser appends to the name of a function that it has split or copied."""
    return re.sub(r"(\.(part|constprop|isra|cold|lto_priv|\d+))+$", "", name)


def tables_of_jumps(image, roots, left):
    """Names of the functions whose switches jump by a table of addresses, a constant of its own."""
    for node in reached(image, roots).values():
        jumps = (i.base == "mov" and i.operands.startswith("pc,") for i in node.instructions)
        if base_name(node.name) not in left and any(jumps):
            yield node.name


def input_sections(image, left=()):
    """Of a linker script: those that the interrupts need, wherever they lie in the image, but for
    the functions `left` in flash. Refuses (ValueError) one that the interrupts do not reach, unless
    a question mark says that it may be compiled into another."""
    roots = [name for name in INTERRUPTS if name in image.symbols]
    functions, constants = outside(image, roots, inside=range(0))
    names = {base_name(f) for f in functions if not VENEER.fullmatch(f)}
    for name in left:
        if not name.endswith("?") and name not in names:
            raise ValueError(f"{name}: the interrupt does not reach it, in flash or elsewhere")
    left = [name.removesuffix("?") for name in left]
    for name in sorted(names.difference(left)):
        yield f"*(.text.{name} .text.{name}.* .text.unlikely.{name} .text.unlikely.{name}.*)"
    for name in sorted({base_name(c) for c in constants if not VENEER.fullmatch(c)}):
        yield f"*(.rodata.{name} .rodata.{name}.*)"
    for name in sorted(set(tables_of_jumps(image, roots, left))):
        yield f"*(.rodata.{name})"
