"""Random mutants of the firmware: draws them, and finds the unit test that kills each."""
import hashlib
import math
import random
import subprocess
import time
from typing import NamedTuple

from build import Failure, TimedOut, overlay_of
from equivalent import EQUIVALENT
from places import places_of

NUMERICS = ("float", "fixed")
CPU_FACTOR = 10 # of what a test takes unbroken: an endless loop
CPU_LEAST_S = 3


class Draw(NamedTuple):
    file: str
    kind: str
    line: int   # from 1 on
    old: str    # the lines it touches
    new: str
    text: str   # the whole file, mutated

    @property
    def name(self):
        words = [" ".join(part.split()) for part in (self.old, self.new)]
        return f"{self.file}: {words[0]} -> {words[1]}"


class Verdict(NamedTuple):
    kind: str       # killed, survives, equivalent, same-code or does-not-compile
    killer: tuple = ()


def drawn(root, seed, only):
    """All mutants in the order of the seed: a place, uniform over all, and one of its choices."""
    texts = {}
    places = []
    for path in sorted((root / "firmware").rglob("*.[ch]")):
        file = path.relative_to(root).as_posix()
        texts[file] = path.read_text(encoding="utf-8")
        places += places_of(file, texts[file])
    chance = random.Random(seed)
    for place in chance.sample(places, len(places)):
        choice = chance.choice(place.choices)
        if only in place.file:
            yield mutated(place, choice, texts[place.file])


def mutated(place, choice, text):
    """A deleted statement of several lines leaves them, empty."""
    first = text.rfind("\n", 0, place.start) + 1
    last = text.find("\n", place.end)
    kept = choice + "\n" * (text.count("\n", place.start, place.end) - choice.count("\n"))
    new = text[first:place.start] + kept + text[place.end:last]
    return Draw(place.file, place.kind, text.count("\n", 0, place.start) + 1, text[first:last], new,
                text[:first] + new + text[last:])


def equivalence(draw):
    """The reason why the mutant changes nothing, if equivalent.py has one."""
    return next((reason for file, old, new, reason in EQUIVALENT
                 if f"{file}: {' '.join(old.split())} -> {' '.join(new.split())}" == draw.name),
                None)


def state_of(root):
    """A hash of all that a verdict depends on."""
    digest = hashlib.sha256()
    for folder in ("firmware", "hal", "tests/unit"):
        for path in sorted((root / folder).rglob("*.[ch]")):
            digest.update(path.relative_to(root).as_posix().encode())
            digest.update(path.read_bytes())
    return digest.hexdigest()[:16]


class Trial:
    """Tries mutants against every unit test that links their file."""

    def __init__(self, build, pool):
        self.build = build
        tests = sorted(path.stem.removeprefix("test_")
                       for path in (build.root / "tests" / "unit").glob("test_*.c"))
        self.wanted = [(numeric, test) for numeric in NUMERICS for test in tests]
        build.prepare(pool, self.wanted)
        self.took_s = {}
        for numeric, test in self.wanted:
            begun = time.monotonic()
            folder = build.scratch / "programs" / f"{test}-{numeric}"
            if not build.run(numeric, test, {}, folder).passed:
                raise Failure(f"test_{test} fails in {numeric} without any mutant")
            self.took_s[numeric, test] = time.monotonic() - begun

    def order(self, draw, last_killer):
        """The tests that link the file: the one that killed it before, its namesake, the quick."""
        stem = draw.file.rsplit("/", maxsplit=1)[1].split(".")[0]
        tests = [wanted for wanted in self.wanted if self.build.affected(*wanted, draw.file)]
        return sorted(tests, key=lambda wanted: (wanted != last_killer, wanted[1] != stem,
                                                 self.took_s[wanted]))

    def judge(self, number, draw, last_killer=None):
        folder = self.build.scratch / f"mutant-{number}"
        overlay = overlay_of(folder / "tree", draw.file, draw.text)
        changed = {} # (numeric, source): the new object, or None if it is the old one
        try:
            for wanted in self.order(draw, last_killer):
                if self.kills(wanted, draw, folder, overlay, changed):
                    return Verdict("killed", wanted)
        except Failure:
            return Verdict("does-not-compile")
        except subprocess.CalledProcessError: # the linker misses what is named in a size
            return Verdict("does-not-compile")
        if changed and not any(changed.values()):
            return Verdict("same-code")
        return Verdict("survives")

    def kills(self, wanted, draw, folder, overlay, changed):
        numeric, test = wanted
        replaced = {}
        for source in self.build.affected(numeric, test, draw.file):
            if (numeric, source) not in changed:
                target = (folder / numeric / source).with_suffix(".o")
                self.build.compile(source, numeric, target, overlay)
                same = target.read_bytes() == \
                    self.build.object_of(numeric, source).read_bytes()
                changed[numeric, source] = None if same else target
            if changed[numeric, source]:
                replaced[source] = changed[numeric, source]
        if not replaced:
            return False
        cpu_s = math.ceil(CPU_LEAST_S + CPU_FACTOR * self.took_s[wanted])
        try:
            return not self.build.run(numeric, test, replaced, folder, cpu_s).passed
        except TimedOut:
            return True
