#!/usr/bin/env python3
"""Proves that the unit tests can fail: breaks the firmware in one place at a time.

usage: run.py ROOT UNITY [--compiler CC] [--jobs N] [--only TEXT] [--one-per-file]

Each mutant of mutants.py replaces one text of one firmware file in a copy and must make the tests
it names fail; unbroken, they must pass. exit 1 with one line per mutant that survives, does not
compile, or whose text is no longer found exactly once.
"""
import argparse
import concurrent.futures
import pathlib
import shutil
import subprocess
import sys
import tempfile

from mutants import MUTANTS

FLAGS = ["-std=c11", "-O1", "-ffp-contract=off", "-fno-math-errno", "-w",
         "-DUNITY_INCLUDE_DOUBLE", "-DUNITY_SUPPORT_64"]
RUN_TIMEOUT_S = 60


class Failure(Exception):
    """Why a mutant proves nothing."""


class Build:
    """Objects of the unbroken firmware and tests; a mutant recompiles what its test links and what
    depends on its file."""

    def __init__(self, root, unity, compiler, scratch):
        self.root = root
        self.unity = unity
        self.compiler = compiler
        self.scratch = scratch
        self.dependencies = {}  # (numeric, source): files
        self.linked = {}        # (numeric, test): sources

    def compile(self, tree, source, numeric, target):
        """Compiles `source` of `tree`; returns the project's files it depends on."""
        target.parent.mkdir(parents=True, exist_ok=True)
        command = [self.compiler, *FLAGS, f"-DSTEADYSTEP_NUM=NUM_{numeric.upper()}",
                   f"-I{tree}", f"-I{self.unity}", "-MMD", "-MF", f"{target}.d",
                   "-c", str(source), "-o", str(target)]
        result = subprocess.run(command, check=False, capture_output=True, text=True)
        if result.returncode:
            raise Failure(f"{source.name} does not compile:\n{result.stderr}")
        words = pathlib.Path(f"{target}.d").read_text(encoding="utf-8").split()
        prefix = f"{tree}/"
        return {word[len(prefix):] for word in words if word.startswith(prefix)}

    def objects_of(self, numeric):
        return self.scratch / "unbroken" / numeric

    def prepare(self, pool, wanted):
        """Compiles everything once for each (numeric, test) wanted."""
        firmware = sorted(path.relative_to(self.root)
                          for path in (self.root / "firmware").rglob("*.c"))
        jobs = []
        for numeric in {numeric for numeric, _ in wanted}:
            sources = firmware + [pathlib.Path(f"tests/unit/test_{test}.c")
                                  for other, test in wanted if other == numeric]
            for source in sources:
                target = (self.objects_of(numeric) / source).with_suffix(".o")
                jobs.append((numeric, source,
                             pool.submit(self.compile, self.root, self.root / source, numeric,
                                         target)))
        unity = self.scratch / "unity.o"
        self.compile(self.unity, self.unity / "unity.c", "double", unity)
        self.dependencies = {(numeric, source): job.result() for numeric, source, job in jobs}
        for numeric in {numeric for numeric, _ in wanted}:
            subprocess.run(["ar", "rcsT", self.archive_of(numeric),
                            *(self.object_of(numeric, source) for source in firmware)], check=True)
        for numeric, test in wanted:
            self.linked[numeric, test] = self.sources_of(numeric, test)

    def archive_of(self, numeric):
        return self.objects_of(numeric) / "firmware.a"

    def object_of(self, numeric, source):
        return (self.objects_of(numeric) / source).with_suffix(".o")

    def link(self, arguments, program):
        return subprocess.run([self.compiler, *map(str, arguments), str(self.scratch / "unity.o"),
                               "-lm", "-o", str(program)],
                              check=True, capture_output=True, text=True).stdout

    def sources_of(self, numeric, test):
        """The test's own, and those of the firmware's that the linker takes for it."""
        source = pathlib.Path(f"tests/unit/test_{test}.c")
        taken = self.link([self.object_of(numeric, source), self.archive_of(numeric), "-Wl,-t"],
                          self.scratch / "taken")
        return [other for of, other in self.dependencies
                if of == numeric and (other == source or
                                      str(self.object_of(numeric, other).relative_to(
                                          self.objects_of(numeric))) in taken)]

    def run(self, numeric, test, replaced, folder):
        """Links the test with the objects in `replaced`, runs it, returns what it prints."""
        program = folder / "program"
        self.link([replaced.get(source, self.object_of(numeric, source))
                   for source in self.linked[numeric, test]], program)
        try:
            return subprocess.run([str(program)], check=False, capture_output=True, text=True,
                                  timeout=RUN_TIMEOUT_S).stdout
        except subprocess.TimeoutExpired as expired:
            raise Failure(f"runs for more than {RUN_TIMEOUT_S} s") from expired

    def broken(self, number, mutant):
        """What the test prints with the mutant in place."""
        tree = self.scratch / f"mutant-{number}"
        shutil.copytree(self.root / "firmware", tree / "firmware")
        shutil.copytree(self.root / "hal", tree / "hal")
        shutil.copytree(self.root / "tests" / "unit", tree / "tests" / "unit")
        path = tree / mutant.file
        if not path.is_file():
            raise Failure(f"no such file: {mutant.file}")
        text = path.read_text(encoding="utf-8")
        if text.count(mutant.old) != 1:
            raise Failure(f"found {text.count(mutant.old)} times in {mutant.file}, "
                          f"not once: {mutant.old!r}")
        path.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        replaced = {}
        for source in self.linked[mutant.numeric, mutant.test]:
            if mutant.file in self.dependencies[mutant.numeric, source]:
                replaced[source] = (tree / "objects" / source).with_suffix(".o")
                self.compile(tree, tree / source, mutant.numeric, replaced[source])
        if not replaced:
            raise Failure(f"{mutant.file} is not part of test_{mutant.test}")
        return self.run(mutant.numeric, mutant.test, replaced, tree)


def verdict(output, name):
    """True if Unity reports the test as passed, False if as failed."""
    for line in output.splitlines():
        if f":test_{name}:" in line:
            return f":test_{name}:PASS" in line
    raise Failure(f"no result of test_{name}")


def check(build, number, mutant, unbroken):
    """None if the mutant is caught, else why not."""
    try:
        if not verdict(unbroken[mutant.numeric, mutant.test], mutant.fails):
            raise Failure(f"test_{mutant.fails} fails without it")
        if verdict(build.broken(number, mutant), mutant.fails):
            raise Failure(f"survives test_{mutant.fails}")
    except Failure as failure:
        return f"{mutant.file}: {mutant.old!r} -> {mutant.new!r}: {failure}"
    return None


def unbroken_outputs(build, wanted):
    outputs = {}
    for numeric, test in wanted:
        folder = build.scratch / "programs" / f"{test}-{numeric}"
        folder.mkdir(parents=True)
        outputs[numeric, test] = build.run(numeric, test, {}, folder)
    return outputs


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("unity", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--compiler", default="cc")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="mutants whose file or test contains this")
    parser.add_argument("--one-per-file", action="store_true", help="of each file the first only")
    arguments = parser.parse_args()

    mutants = [mutant for mutant in MUTANTS
               if arguments.only in mutant.file or arguments.only in mutant.test]
    if arguments.one_per_file:
        first = {mutant.file: mutant for mutant in reversed(mutants)}
        mutants = list(first.values())
    wanted = sorted({(mutant.numeric, mutant.test) for mutant in mutants})
    with tempfile.TemporaryDirectory() as scratch, \
            concurrent.futures.ThreadPoolExecutor(arguments.jobs) as pool:
        build = Build(arguments.root, arguments.unity, arguments.compiler, pathlib.Path(scratch))
        try:
            build.prepare(pool, wanted)
            unbroken = unbroken_outputs(build, wanted)
        except Failure as failure:
            print(f"without any mutant: {failure}")
            return 1
        results = pool.map(lambda job: check(build, *job, unbroken), enumerate(mutants))
        failures = [failure for failure in results if failure]
    for failure in failures:
        print(failure)
    print(f"{len(mutants) - len(failures)} of {len(mutants)} mutants caught")
    return 1 if failures or not mutants else 0


if __name__ == "__main__":
    sys.exit(main())
