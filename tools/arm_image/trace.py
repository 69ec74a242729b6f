"""
What an image executes, from QEMU's log of translation blocks, and what that costs.

QEMU logs the instructions of a block when it translates it (in_asm) and the block's identity each
time before it runs it (exec); nochain makes it log every execution.
"""

import os
import subprocess
from collections import Counter

MACHINE = {
    "m4f": ["mps2-an386"],
    "m0plus": ["microbit", "-global", "nrf51-soc.flash-size=524288"],  # as tools/cmake has it
}


def qemu_command(core, elf):
    return [
        "qemu-system-arm", "-M", *MACHINE[core], "-nodefaults", "-display", "none",
        "-chardev", "stdio,id=text",
        "-semihosting-config", "enable=on,target=native,chardev=text", "-kernel", str(elf),
    ]  # fmt: skip


def run(core, elf):
    """Runs an image; the words of each line it writes: {first word: second word}."""
    done = subprocess.run(
        qemu_command(core, elf),
        stdin=subprocess.DEVNULL,
        capture_output=True,
        text=True,
        check=True,
    )
    return dict(line.split(None, 1) for line in done.stdout.splitlines() if len(line.split()) == 2)


class Block:
    """A translation block: a straight line of instructions."""

    __slots__ = ("start", "addresses")

    def __init__(self, addresses):
        self.start = addresses[0]
        self.addresses = addresses


def executed_blocks(core, elf):
    """The blocks of a run of the image, in the order of execution."""
    log, log_input = os.pipe()
    command = qemu_command(core, elf) + ["-d", "exec,nochain,in_asm", "-D", f"/dev/fd/{log_input}"]
    process = subprocess.Popen(
        command,
        pass_fds=[log_input],
        stdin=subprocess.DEVNULL,
        stdout=subprocess.PIPE,
        stderr=subprocess.DEVNULL,
        text=True,
    )
    os.close(log_input)
    blocks, translated, pending = {}, [], None
    with os.fdopen(log, buffering=1 << 20) as lines:
        for line in lines:
            if line.startswith("Trace "):
                if pending is not None:
                    yield pending
                identity = line[9:27]
                if translated:
                    blocks[identity] = Block(translated)
                    translated = []
                pending = blocks[identity]
            elif line.startswith("0x"):
                translated.append(int(line[2:10], 16))
            elif line.startswith("IN:"):
                translated = []
            elif line.startswith("Stopped execution"):
                pending = None  # logged, but not run
    if pending is not None:
        yield pending
    text = process.stdout.read()
    if process.wait() != 0:
        raise RuntimeError(f"{elf} ended with status {process.returncode}: {text.strip()}")


class Run:
    """One execution of a block, up to where it went on, and its cost."""

    __slots__ = ("costs", "instructions", "nominal", "pessimistic", "last", "return_address")

    def __init__(self, image, core, block, following, before):
        """`before`: address of the instruction executed right before, None after a branch."""
        self.costs = []  # (address, nominal cycles, pessimistic cycles)
        self.last = None  # address of the last instruction, if the program went straight on
        self.return_address = None  # if the block ends in a call
        previous = image.instruction(before) if before is not None else None
        for address in block.addresses:
            instruction = image.instruction(address)
            nominal = core.cycles(instruction, previous, "nominal")
            pessimistic = core.cycles(instruction, previous, "pessimistic")
            previous = instruction
            if instruction.is_branch and address == block.addresses[-1]:
                if following != instruction.next or instruction.is_call:
                    nominal += core.refill["nominal"]
                    pessimistic += core.refill["pessimistic"]
                if instruction.is_call:
                    self.return_address = instruction.next
            self.costs.append((address, nominal, pessimistic))
        if not previous.is_branch:
            self.last = previous.address
        self.instructions = len(self.costs)
        self.nominal = sum(cost[1] for cost in self.costs)
        self.pessimistic = sum(cost[2] for cost in self.costs)


class Calls:
    """The calls of one function: worst and total cost, and what the worst one consists of."""

    def __init__(self):
        self.count = 0
        self.instructions = 0
        self.worst_instructions = 0
        self.worst_cycles = 0
        self.worst_pessimistic = 0
        self.worst_index = 0
        self.total_cycles = 0
        self.worst_path = []
        self.executions = Counter()  # of each run, over all calls
        self.calls = []  # (cycles, runs in their order) of each call

    def add(self, path):
        instructions = sum(run.instructions for run in path)
        cycles = sum(run.nominal for run in path)
        pessimistic = sum(run.pessimistic for run in path)
        self.worst_instructions = max(self.worst_instructions, instructions)
        self.worst_pessimistic = max(self.worst_pessimistic, pessimistic)
        self.total_cycles += cycles
        if cycles > self.worst_cycles:
            self.worst_cycles, self.worst_path, self.worst_index = cycles, path, self.count
        self.executions.update(path)
        self.calls.append((cycles, tuple(path)))
        self.count += 1

    def executed(self):
        """Addresses of all instructions executed in any call."""
        return {cost[0] for run in self.executions for cost in run.costs}

    def breakdown(self, key, mean=False):
        """Nominal cycles and instructions by key(address), most costly first: of the worst call or
        of the mean over all calls."""
        cycles, instructions = Counter(), Counter()
        for run, times in (self.executions if mean else Counter(self.worst_path)).items():
            for address, nominal, _ in run.costs:
                cycles[key(address)] += nominal * times
                instructions[key(address)] += times
        calls = self.count if mean else 1
        return [
            (name, count / calls, instructions[name] / calls)
            for name, count in cycles.most_common()
        ]


def count_calls(image, core, names):
    """Runs an image and counts the calls of the named functions, a call within one of them as part
    of that one: {name: Calls}."""
    entries = {image.symbols[name] & ~1: name for name in names}
    calls = {name: Calls() for name in names}
    runs = {}
    name, path, return_address, before = None, [], None, None
    last = None
    for block in executed_blocks(core.name, image.path):
        start = block.start
        if name is not None:
            key = (last, start, before)
            run = runs.get(key)
            if run is None:
                run = runs[key] = Run(image, core, last, start, before)
            path.append(run)
            before = run.last
            if start == return_address:
                calls[name].add(path)
                name, path = None, []
        if name is None and start in entries:
            return_address = Run(image, core, last, start, None).return_address
            if return_address is None:
                raise ValueError(f"{image.path}: {entries[start]} is entered without a call")
            name, before = entries[start], None
        last = block
    return calls
