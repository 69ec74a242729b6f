"""
The longest path through a function and all it calls: a bound of its cycles, whatever its data.

Each function's blocks and jumps form a graph. Its loops (strongly connected parts) are bounded by
hand (loop_bounds.toml) and collapsed, the inner ones first; what is left has no cycle, and its
longest path is found in one pass. Any execution is a path of this graph, so none costs more than
the longest one by the same timings. The bound knows nothing of data: it also contains paths that
no data can take.
"""

from collections import Counter
from dataclasses import dataclass

from . import memory
from .control_flow import Function, strong_components
from .timing import EXCEPTION, FLASH, PERIPHERAL, is_load_store, loads_literal

COLUMNS = ["nominal", "worst_ccm", "worst_flash"]


@dataclass(frozen=True)
class Path:
    cycles: int
    blocks: Counter  # (function, start of a block) -> times run


class Costs:
    """Cycles of instructions and blocks, by column."""

    def __init__(self, core, in_peripherals):
        self._core = core
        self._in_peripherals = in_peripherals  # does an instruction's code access peripherals?
        self._flash = FLASH[core.name]
        self.refill = [core.refill[c] for c in ("nominal", "pessimistic", "pessimistic")]

    def instructions(self, block, before, column):
        """Cycles of each instruction of a block. `before`: what stands at the address before it, if
        the program can come from there; the first one costs what it costs at most."""
        kind = "nominal" if column == 0 else "pessimistic"
        costs = []
        previous = before
        for k, instruction in enumerate(block.instructions):
            cycles = self._core.cycles(instruction, previous, kind)
            if k == 0:
                cycles = max(cycles, self._core.cycles(instruction, None, kind))
            from_flash = column == 2 or (
                column == 1 and memory.region(instruction.address) == "flash"
            )
            if from_flash and loads_literal(instruction):
                cycles += self._flash["wait"]
            if is_load_store(instruction) and self._in_peripherals(instruction.address):
                cycles += PERIPHERAL[column]
            costs.append(cycles)
            previous = instruction
        if column == 2 or (column == 1 and memory.region(block.start) == "flash"):
            size = self._flash["line_bytes"]
            costs[0] += self._flash["wait"] * (
                (block.last.next - 1) // size - block.start // size + 1
            )
        return costs


class LongestPath:
    """Longest paths through the functions of an image."""

    def __init__(self, image, costs, bounds, targets_of, is_excluded, chooses):
        """`bounds(function, blocks, header)`: most times the header of a loop is run each time the
        loop is entered. `is_excluded(instruction)`: of a function that is not in use.
        `chooses(instruction)`: a jump that leads only to what is in use."""
        self._image = image
        self._costs = costs
        self._bounds = bounds
        self._targets_of = targets_of
        self._is_excluded = is_excluded
        self._chooses = chooses
        self._functions = {}
        self._paths = {}
        self._open = []

    def function(self, start):
        if start not in self._functions:
            place = self._image.function_from(start)
            self._functions[start] = Function(self._image, place, self._targets_of)
        return self._functions[start]

    def of(self, start, column):
        """Path, or None if no way through the function returns, or all that do are excluded."""
        key = start, column
        if key in self._paths:
            return self._paths[key]
        function = self.function(start)
        if start in self._open:
            chain = [self.function(s).name for s in self._open[self._open.index(start) :]]
            raise ValueError(
                f"{self._image.path}: recursion: {' -> '.join(chain)} -> {function.name}"
            )
        self._open.append(start)
        self._paths[key] = self._solve_function(function, column)
        self._open.pop()
        return self._paths[key]

    def instruction_cycles(self, block, column):
        """Cycles of each instruction of a block, without jumps and what it calls."""
        known = self._image.instructions
        before = next(
            (
                known[block.start - size]
                for size in (2, 4)
                if block.start - size in known and known[block.start - size].size == size
            ),
            None,
        )
        straight = None if before is None or before.is_branch else before
        return self._costs.instructions(block, straight, column)

    def jumps(self, function):
        """{block: [(block, taken)]} of what can be run.

        Code of a function that is not in use is entered neither from its beginning nor where it
        is chosen. Only there: the compiler lets functions share code, and then says of it that it
        belongs to one of them; it is entered from the others without a choice."""
        out = {
            start
            for start, block in function.blocks.items()
            if all(self._is_excluded(i) for i in block.instructions)
        }
        found, waiting = {}, [function.start] if function.start not in out else []
        while waiting:
            start = waiting.pop()
            if start in found:
                continue
            block = function.blocks[start]
            choice = self._chooses(block.last)
            found[start] = [
                (t, taken) for t, taken in block.successors if not (choice and t in out)
            ]
            waiting += [target for target, _ in found[start]]
        return found

    def reachable(self, start):
        """Every block that can be reached from a function, with its calls: {start: Block}."""
        found, entered, waiting = {}, set(), [start]
        while waiting:
            at = waiting.pop()
            if at not in entered:
                entered.add(at)
                function = self.function(at)
                for block in self.jumps(function):
                    found[block] = function.blocks[block]
                    waiting += function.blocks[block].calls
        return found

    def _solve_function(self, function, column):
        jumps, weights, leaving, called = self.jumps(function), {}, {}, {}
        for start in jumps:
            block = function.blocks[start]
            cycles = sum(self.instruction_cycles(block, column))
            path = self._longest_call(block, column)
            more = self._costs.refill[column]
            if block.calls and path is None:  # then it only goes on if it does not call
                if all(taken for _, taken in jumps[start]):
                    continue
            elif block.calls:
                called[start] = path.blocks
                more += path.cycles
            if block.leaves and (path or not block.calls):
                leaving[start] = more
            elif path:
                cycles += more
            weights[start] = cycles
        weights = {n: weights[n] for n in _reaching(leaving, jumps, weights)}
        if function.start not in weights:
            return None
        edges = {
            start: [
                (t, self._costs.refill[column] if taken and not function.blocks[start].calls else 0)
                for t, taken in jumps[start]
                if t in weights
            ]
            for start in weights
        }
        graph = _Graph(function, weights, edges, self._bounds)
        end = graph.solve(set(weights), {function.start: (0, None)}, None)
        last = max(leaving.keys() & end.keys(), key=lambda n: (end[n][0] + leaving[n], n))
        blocks = Counter()
        for start, times in _unfold(end[last][1]).items():
            blocks[function.start, start] += times
            if start == last or not function.blocks[start].leaves:
                for key, inner in called.get(start, {}).items():
                    blocks[key] += times * inner
        return Path(end[last][0] + leaving[last], blocks)

    def _longest_call(self, block, column):
        """Path of what a block calls; None if it calls nothing, or nothing that returns."""
        paths = [p for p in (self.of(c, column) for c in sorted(block.calls)) if p]
        return max(paths, key=lambda p: p.cycles) if paths else None


def _reaching(ends, jumps, nodes):
    """Those of `nodes` from which one of `ends` can be reached: what does not return, as the way
    into a fault, is no part of an interrupt that ends."""
    sources = {}
    for node in nodes:
        for target, _ in jumps[node]:
            sources.setdefault(target, []).append(node)
    found, waiting = set(), sorted(ends)
    while waiting:
        node = waiting.pop()
        if node not in found:
            found.add(node)
            waiting += sources.get(node, [])
    return sorted(found)


class _Graph:
    """Longest distances in one function. A run is a chain (before, block or (loop, turns)), so that
    it can be said afterwards what it consists of."""

    def __init__(self, function, weights, edges, bounds):
        self._function = function
        self._weights = weights  # block -> cycles
        self._edges = edges  # block -> [(block, cycles)]
        self._bounds = bounds

    def solve(self, nodes, begin, header):
        """{block: (longest distance to its end, run)}, within `nodes` and without jumps to
        `header`, from the blocks and distances in `begin`."""
        inside = lambda n: [t for t, _ in self._edges[n] if t in nodes and t != header]
        begin, end = dict(begin), {}
        for component in reversed(strong_components(sorted(begin), inside)):
            members = set(component)
            if len(component) == 1 and component[0] not in inside(component[0]):
                node = component[0]
                distance, run = begin[node]
                end[node] = (distance + self._weights[node], (run, node))
            else:
                self._solve_loop(members, begin, end)
            for node in component:
                for target, cycles in self._edges[node]:
                    if target in nodes and target != header and target not in members:
                        _raise(begin, target, (end[node][0] + cycles, end[node][1]))
        return end

    def _solve_loop(self, members, begin, end):
        """Whatever turns in a loop passes one of its blocks, the header, once a turn. Before the
        first time it runs from where it has entered, and after the last to where it leaves,
        without passing the header, which is where it is entered, if it is so in one place only."""
        entries = {n: begin[n] for n in members if n in begin}
        choice = members if len(entries) > 1 else entries
        header = min(choice, key=lambda n: (self._loops_without(members, n), n))
        first = entries.pop(header, (-1, None))
        for node, (distance, run) in self.solve(members, entries, header).items():
            end[node] = (distance, run)
            for target, cycles in self._edges[node]:
                if target == header and distance + cycles > first[0]:
                    first = (distance + cycles, run)
        inner = self.solve(members, {header: (0, None)}, header)
        turn = (-1, None)
        for node, (distance, run) in inner.items():
            for target, cycles in self._edges[node]:
                if target == header and distance + cycles > turn[0]:
                    turn = (distance + cycles, run)
        times = self._bounds(self._function, members, header) - 1
        for node, (distance, run) in inner.items():
            _raise(
                end,
                node,
                (
                    first[0] + times * turn[0] + distance,
                    ((first[1], (turn[1], times)), (run,)),
                ),
            )

    def _loops_without(self, members, header):
        """How many loops do not pass the header."""
        inside = lambda n: [t for t, _ in self._edges[n] if t in members and t != header]
        return sum(
            len(part) > 1 or part[0] in inside(part[0])
            for part in strong_components(sorted(members), inside)
        )


def _raise(distances, node, candidate):
    if node not in distances or distances[node][0] < candidate[0]:
        distances[node] = candidate


def _unfold(run):
    """Counter of the blocks of a run."""
    counts = Counter()
    work = [(run, 1)]
    while work:
        link, times = work.pop()
        if link is None:
            continue
        if len(link) == 1:  # a run inside a loop, joined on
            work.append((link[0], times))
            continue
        before, item = link
        work.append((before, times))
        if isinstance(item, int):
            counts[item] += times
        elif len(item) == 1:
            work.append((item, times))
        else:
            work.append((item[0], times * item[1]))
    return counts


def exception_cycles(core, column):
    """To enter and to leave the interrupt, with a floating-point frame if the core has one."""
    cost = EXCEPTION[core.name]
    return cost["enter"][column] + cost["leave"][column] + 2 * cost["fpu"][column]
