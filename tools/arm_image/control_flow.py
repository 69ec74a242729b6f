"""Basic blocks of a function, and where they go on, read from the machine code."""

import re
from dataclasses import dataclass, field

from .call_graph import is_return, table_targets


@dataclass
class Block:
    """A straight line of instructions, entered at its first and left at its last one only."""

    instructions: list
    successors: list = field(default_factory=list)  # (address of a block, taken: by a jump)
    calls: set = field(default_factory=set)  # start addresses; one of them is run at the end
    leaves: bool = False  # the function may end here, by returning or in what it calls last

    @property
    def start(self):
        return self.instructions[0].address

    @property
    def last(self):
        return self.instructions[-1]


class Function:
    """The blocks that can be reached from the begin of a function."""

    def __init__(self, image, function, targets_of):
        """`targets_of(instruction, body)`: where an indirect call or jump may go, None if it
        cannot be known."""
        self.start, self.size, self.name = function
        self._image = image
        self._targets_of = targets_of
        self.body = image.body(function)
        if not self.body or self.body[0].address != self.start:
            raise ValueError(f"{image.path}: no code at the begin of {self.name}")
        self._index = {i.address: k for k, i in enumerate(self.body)}
        self._conditional = _in_it_blocks(self.body)
        self.blocks = self._find_blocks()

    def _find_blocks(self):
        ends = {}  # address of an instruction that ends a line -> (successors, calls, leaves)
        leaders, waiting = {self.start}, [self.start]
        while waiting:
            at = waiting.pop()
            while True:
                if at not in self._index:
                    raise ValueError(f"{self._image.path}: {self.name} runs into data at {at:#x}")
                instruction = self.body[self._index[at]]
                if instruction.is_branch or instruction.base == "udf":
                    break
                at = instruction.next
                if at in leaders:
                    break
            if at in ends or not (instruction.is_branch or instruction.base == "udf"):
                continue
            ends[at] = self._go_on(instruction)
            for target, _ in ends[at][0]:
                if target not in leaders:
                    leaders.add(target)
                    waiting.append(target)
        blocks = {}
        for leader in sorted(leaders):
            line, at = [], leader
            while True:
                line.append(self.body[self._index[at]])
                if at in ends:
                    blocks[leader] = Block(line, *ends[at])
                    break
                at = line[-1].next
                if at in leaders:
                    blocks[leader] = Block(line, [(at, False)])
                    break
        return blocks

    def _go_on(self, instruction):
        """(successors, calls, leaves) of an instruction that may not go on behind itself."""
        conditional = instruction.address in self._conditional or instruction.condition != ""
        conditional |= instruction.base in ("cbz", "cbnz")
        past = [(instruction.next, False)] if conditional else []
        if instruction.base == "udf":
            return past, set(), False  # a trap: no way back
        if instruction.base in ("tbb", "tbh"):
            return past + [(t, True) for t in self._table(instruction)], set(), False
        if instruction.base == "mov":
            function = (self.start, self.size, self.name)
            targets = table_targets(self._image, instruction, function, self.body)
            return past + [(t, True) for t in targets], set(), False
        if is_return(instruction, self.body[: self._index[instruction.address] + 1]):
            return past, set(), True
        target = instruction.target
        targets = {target} if target is not None else self._targets_of(instruction, self.body)
        if not targets:
            raise ValueError(
                f"{self._image.path}: {self.name} at {instruction.address:#x}:"
                f" {instruction.mnemonic} {instruction.operands} goes where nothing says"
            )
        inside = [t for t in targets if self.start <= t < self.start + max(self.size, 2)]
        # A BL into the middle of its own function is a jump: no other reaches as far on ARMv6-M.
        if instruction.is_call and inside in ([], [self.start]):
            returns = [(instruction.next, True)] if self._is_code(instruction.next) else []
            return past + returns, targets, False
        if inside:
            return past + [(t, True) for t in inside], set(), False
        return past, targets, True

    def _is_code(self, address):
        """Behind a call without return stands none, or only what aligns the data behind it."""
        while address in self._index and self.body[self._index[address]].base == "nop":
            address = self.body[self._index[address]].next
        return address in self._index

    def _table(self, instruction):
        """Targets of a jump by a table that stands behind the instruction: as many as the comparison
        before it lets through, for constants may stand behind the table."""
        base = instruction.next
        index = re.match(r"\[pc, (\w+)", instruction.operands).group(1)
        before = self.body[: self._index[instruction.address]]
        compared = next((i for i in reversed(before) if i.base == "cmp"), None)
        bound = compared and re.fullmatch(rf"{index}, #(\d+)", compared.operands)
        width = 1 if instruction.base == "tbb" else 2
        following = min((a for a in self._index if a >= base), default=base)
        data = self._image.bytes(base, following - base)
        offsets = [
            int.from_bytes(data[k : k + width], "little") for k in range(0, len(data), width)
        ]
        if bound:
            offsets = offsets[: int(bound.group(1)) + 1]
        elif width == 1 and offsets and offsets[-1] == 0:
            offsets.pop()  # aligns the code behind the table
        targets = sorted({base + 2 * offset for offset in offsets})
        if not targets or any(t not in self._index for t in targets):
            raise ValueError(
                f"{self._image.path}: {self.name} at {instruction.address:#x}: no table of jumps"
            )
        return targets


def _in_it_blocks(body):
    """Addresses of the instructions that an IT makes conditional."""
    found, left = set(), 0
    for instruction in body:
        if left:
            found.add(instruction.address)
            left -= 1
        elif re.fullmatch(r"it[te]{0,3}", instruction.base):
            left = len(instruction.base) - 1
    return found


def strong_components(nodes, successors):
    """Tarjan: lists of nodes that reach each other; a list comes behind those it leads to."""
    index, low, on_stack, stack, found = {}, {}, set(), [], []
    for root in nodes:
        if root in index:
            continue
        work = [(root, iter(successors(root)))]
        index[root] = low[root] = len(index)
        stack.append(root)
        on_stack.add(root)
        while work:
            node, following = work[-1]
            for target in following:
                if target not in index:
                    index[target] = low[target] = len(index)
                    stack.append(target)
                    on_stack.add(target)
                    work.append((target, iter(successors(target))))
                    break
                if target in on_stack:
                    low[node] = min(low[node], index[target])
            else:
                work.pop()
                if work:
                    low[work[-1][0]] = min(low[work[-1][0]], low[node])
                if low[node] == index[node]:
                    component = []
                    while True:
                        component.append(stack.pop())
                        on_stack.discard(component[-1])
                        if component[-1] == node:
                            break
                    found.append(component)
    return found
