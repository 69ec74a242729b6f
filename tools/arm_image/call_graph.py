"""What a function can reach, and how deep its stack can get, read from the machine code."""

import re
from dataclasses import dataclass, field

from . import debug_info

# The function pointers the interrupt calls through: struct type, member. Every constant of that
# type in the image is a possible target.
CALLED_MEMBERS = [("position_law", "step")]  # firmware/control/position_law.h


@dataclass
class Node:
    name: str
    stack_B: int
    calls: set = field(default_factory=set)  # start addresses
    indirect: bool = False
    instructions: list = field(default_factory=list)


def indirect_targets(image):
    """Start addresses of the functions that CALLED_MEMBERS may point to."""
    return {
        image.word(address + offset) & ~1
        for struct, member in CALLED_MEMBERS
        for address, offset in debug_info.members(image.path, struct, member)
    }


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
        if function[0] != start:
            raise ValueError(f"{image.path}: {start:#x} is called, but no function begins there")
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
        depth += _stack_growth(instruction, name)
        deepest = max(deepest, depth)
        if not instruction.is_branch:
            continue
        target = instruction.target
        if _is_return(instruction, node.instructions):
            depth = deepest  # code behind a return belongs to another path; frames are set up once
        elif target is None:
            node.indirect |= instruction.base in ("bx", "blx", "ldr")  # MOV PC: a switch
        elif not start <= target < start + max(size, 2):
            node.calls.add(target)
    node.stack_B = deepest
    return node


def _is_return(instruction, before):
    """POP with PC in either of its forms, BX LR, or BX of a register popped right before."""
    if instruction.base == "ldr":
        return instruction.operands.startswith("pc, [sp]")
    if instruction.base == "bx":
        popped = {r for i in before[-4:] if i.base == "pop" for r in i.register_list}
        return instruction.operands in popped | {"lr"}
    return "pc" in instruction.register_list


def _stack_growth(instruction, name):
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
    if base in ("sub", "add") and re.match(r"sp, (sp, )?r\d", operands):
        raise ValueError(f"{name}: stack frame of variable or very large size")
    return 0


def deepest_stack(nodes, start):
    """Bytes of stack from a function down, and the chain of names that needs them."""

    def depth(address, chain):
        if address in chain:
            raise ValueError(f"recursion through {nodes[address].name}")
        below = max(
            (depth(call, chain + (address,)) for call in nodes[address].calls), default=(0, ())
        )
        return nodes[address].stack_B + below[0], (nodes[address].name,) + below[1]

    return depth(start, ())
