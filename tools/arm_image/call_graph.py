"""What a function can reach, and how deep its stack can get, read from the machine code."""

import re
from dataclasses import dataclass, field

from . import debug_info

# The function pointers that are called through: struct type, member. Every object of that type that
# the image holds initialised is a possible target.
CALLED_MEMBERS = [
    ("position_law", "step"),  # of a registry, if there is one
    ("hal", "bridge_enable"),  # hal/hal.h
    ("hal", "bridge_disable"),
    ("hal", "cycle_count"),
    ("hal", "time_us"),
    ("hal", "watchdog_feed"),
    ("hal", "stream_read"),
    ("hal", "stream_write"),
    ("hal", "parameters_erase"),
    ("hal", "parameters_program"),
    ("hal", "parameters_read"),
]


@dataclass
class Node:
    name: str
    stack_B: int
    calls: set = field(default_factory=set)  # start addresses
    indirect: bool = False
    instructions: list = field(default_factory=list)


def indirect_targets(image):
    """Start addresses of the functions that CALLED_MEMBERS may point to."""
    if image.called is None:
        words = (image.word(place) for place in debug_info.members(image.path, CALLED_MEMBERS))
        image.called = {word & ~1 for word in words if word}
    return image.called


def constant_target(image, instruction, body):
    """Where a jump through a register or a word goes, if that is a constant of the code around it
    (far calls, the linker's veneers); else None."""
    if instruction.base == "ldr":
        return _code(_literal(image, instruction))
    if instruction.base not in ("bx", "blx"):
        return None
    return _code(_constant(image, instruction.operands, instruction, body))


def table_targets(image, instruction, function, body):
    """Where MOV PC may go: the compiler's switch on ARMv6-M, by a table of addresses. As many of
    its words as point into the function; more than the table has do no harm."""
    start, size, name = function
    register = instruction.operands.rpartition(" ")[2]
    load = _last_write(register, instruction, body)
    match = load and load.base == "ldr" and re.fullmatch(r"\w+, \[(\w+), (\w+)\]", load.operands)
    for base in match.groups() if match else ():
        table = _constant(image, base, load, body)
        targets = []
        while table is not None:
            word = image.word(table + 4 * len(targets))
            if word is None or not start <= word & ~1 < start + size:
                break
            targets.append(word & ~1)
        if targets:
            return sorted(set(targets))
    raise ValueError(f"{image.path}: {name} at {instruction.address:#x}: no table of jumps")


def _constant(image, register, instruction, body):
    """The word that a register holds at an instruction, if it is loaded shortly before."""
    write = _last_write(register, instruction, body)
    if write is None:
        return None
    if write.base == "ldr":
        return _literal(image, write)
    if write.base in ("mov", "movs") and len(write.registers) == 2:
        return _constant(image, write.registers[1], write, body)
    number = re.search(r"#(0x[0-9a-f]+|\d+)$", write.operands)
    if write.base in ("mov", "movs", "movw") and number:
        return int(number.group(1), 0)
    if write.base == "lsls" and number:
        source = write.registers[-1]
        shifted = _constant(image, source, write, body)
        return None if shifted is None else shifted << int(number.group(1), 0)
    return None


def _last_write(register, instruction, body):
    """The instruction that has set a register, in the straight line before another one."""
    before = [i for i in body if i.address < instruction.address][-CONSTANT_WITHIN:]
    for earlier in reversed(before):
        if earlier.registers[:1] == [register] and not earlier.base.startswith(
            ("str", "cmp", "tst", "push", "stm")
        ):
            return None if earlier.register_list else earlier
        if register in earlier.register_list and earlier.base in ("pop", "ldm", "ldmia"):
            return None
        if earlier.is_call or earlier.is_branch and earlier.base not in ("cbz", "cbnz", "b"):
            return None
    return None


CONSTANT_WITHIN = 12  # instructions between the load of a constant address and the call


def _literal(image, instruction):
    match = re.search(r"\[pc(?:, #(-?(?:0x)?[0-9a-f]+))?\]", instruction.operands)
    if not match:
        return None
    return image.word((instruction.address + 4 & ~3) + int(match.group(1) or "0", 0))


def _code(word):
    return word & ~1 if word is not None and word & 1 else None


def walk(image, root, is_own=lambda address: True):
    """{start address: Node} of everything reachable from the function named `root`. What is not
    `is_own` appears, but is not walked into."""
    nodes = {}
    waiting = [image.symbols[root] & ~1]
    while waiting:
        start = waiting.pop()
        if start in nodes:
            continue
        if not is_own(start):
            nodes[start] = Node(image.name_at(start), 0)
            continue
        function = image.function_at(start)
        # Library code in assembly is entered in the middle, too; the whole function counts.
        if not function[0] <= start < function[0] + max(function[1], 2):
            function = image.function_from(start)
        node = nodes[start] = _node(image, function)
        if node.indirect:
            targets = indirect_targets(image)
            if not targets:
                raise ValueError(f"{image.path}: {node.name} calls through an undeclared pointer")
            node.calls |= targets
        waiting += node.calls
    return nodes


def _node(image, function):
    start, size, name = function
    node = Node(name, 0)
    depth = deepest = 0
    for instruction in image.body(function):
        node.instructions.append(instruction)
        depth += _stack_growth(image, instruction, node)
        deepest = max(deepest, depth)
        if not instruction.is_branch:
            continue
        target = instruction.target
        if is_return(instruction, node.instructions):
            depth = deepest  # code behind a return belongs to another path; frames are set up once
        elif target is None:
            if instruction.base in ("bx", "blx", "ldr"):  # else a switch
                constant = constant_target(image, instruction, node.instructions)
                node.calls |= {constant} if constant is not None else set()
                node.indirect |= constant is None
        elif not start <= target < start + max(size, 2):
            node.calls.add(target)
    node.stack_B = deepest
    return node


def is_return(instruction, before):
    """POP with PC in either of its forms, BX LR, or BX of a register popped right before."""
    if instruction.base == "ldr":
        return instruction.operands.startswith("pc, [sp]")
    if instruction.base == "bx":
        popped = {r for i in before[-4:] if i.base == "pop" for r in i.register_list}
        return instruction.operands in popped | {"lr"}
    return "pc" in instruction.register_list


def _stack_growth(image, instruction, node):
    base, operands = instruction.base, instruction.operands
    count = len(instruction.register_list)
    if base == "push" or (
        base in ("stmdb", "vpush") and (base == "vpush" or operands.startswith("sp!"))
    ):
        return count * (8 if base == "vpush" and re.search(r"\bd\d", operands) else 4)
    match = re.fullmatch(r"sp, (?:sp, )?#(-?(?:0x)?[0-9a-f]+)", operands)
    if base in ("sub", "subw", "sub.w") and match:
        return int(match.group(1), 0)
    if base == "str" and (match := re.search(r"\[sp, #-(0x[0-9a-f]+|\d+)\]!", operands)):
        return int(match.group(1), 0)
    match = re.fullmatch(r"sp, (?:sp, )?(r\d+)", operands)
    if base in ("sub", "add") and match:
        size = _constant(image, match.group(1), instruction, node.instructions)
        if size is None:
            raise ValueError(f"{node.name}: stack frame of a size that nothing says")
        signed = size - (1 << 32) if size >> 31 else size
        return signed if base == "sub" else max(-signed, 0)
    return 0


def deepest_stack(nodes, start):
    """Bytes of stack from a function down, and the chain of names that needs them."""

    found = {}

    def depth(address, chain):
        if address in chain:
            raise ValueError(f"recursion through {nodes[address].name}")
        if address not in found:
            node, chain = nodes[address], chain + (address,)
            below_B, names = max((depth(call, chain) for call in node.calls), default=(0, ()))
            found[address] = node.stack_B + below_B, (node.name,) + names
        return found[address]

    return depth(start, ())
