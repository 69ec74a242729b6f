#!/usr/bin/env python3
"""Proves that the unit tests can fail: breaks the firmware in one place at a time.

usage: run.py ROOT UNITY [--compiler CC] [--jobs N] [--only TEXT] [--one-per-folder]

Each mutant of mutants.py replaces one text of one firmware file in a copy and must make the tests
it names fail; unbroken, they must pass. exit 1 with one line per mutant that survives, does not
compile, or whose text is no longer found exactly once; the last is asked of every mutant.
"""
import argparse
import concurrent.futures
import pathlib
import sys
import tempfile

from build import Build, Failure, overlay_of
from mutants import MUTANTS


def text_of(root, mutant):
    """The file that the mutant breaks; a Failure unless it holds the mutant's text once."""
    path = root / mutant.file
    if not path.is_file():
        raise Failure(f"no such file: {mutant.file}")
    text = path.read_text(encoding="utf-8")
    if text.count(mutant.old) != 1:
        raise Failure(f"found {text.count(mutant.old)} times in {mutant.file}, "
                      f"not once: {mutant.old!r}")
    return text


def outdated(root, mutants):
    """One line per mutant whose text is not there, run or not."""
    for mutant in mutants:
        try:
            text_of(root, mutant)
        except Failure as failure:
            yield f"{mutant.fails}: {failure}"


def broken(build, number, mutant):
    """What the test prints with the mutant in place."""
    text = text_of(build.root, mutant)
    folder = build.scratch / f"mutant-{number}"
    overlay = overlay_of(folder / "tree", mutant.file, text.replace(mutant.old, mutant.new))
    replaced = {}
    for source in build.affected(mutant.numeric, mutant.test, mutant.file):
        replaced[source] = (folder / "objects" / source).with_suffix(".o")
        build.compile(source, mutant.numeric, replaced[source], overlay)
    if not replaced:
        raise Failure(f"{mutant.file} is not part of test_{mutant.test}")
    return build.run(mutant.numeric, mutant.test, replaced, folder).output


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
        if verdict(broken(build, number, mutant), mutant.fails):
            raise Failure(f"survives test_{mutant.fails}")
    except Failure as failure:
        return f"{mutant.file}: {mutant.old!r} -> {mutant.new!r}: {failure}"
    return None


def unbroken_outputs(build, wanted):
    outputs = {}
    for numeric, test in wanted:
        folder = build.scratch / "programs" / f"{test}-{numeric}"
        outputs[numeric, test] = build.run(numeric, test, {}, folder).output
    return outputs


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("root", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("unity", type=lambda text: pathlib.Path(text).resolve())
    parser.add_argument("--compiler", default="cc")
    parser.add_argument("--jobs", type=int, default=2)
    parser.add_argument("--only", default="", help="mutants whose file or test contains this")
    parser.add_argument("--one-per-folder", action="store_true", help="of each folder the first only")
    arguments = parser.parse_args()

    stale = list(outdated(arguments.root, MUTANTS))
    if stale:
        print("\n".join(stale))
        return 1
    mutants = [mutant for mutant in MUTANTS
               if arguments.only in mutant.file or arguments.only in mutant.test]
    if arguments.one_per_folder:
        first = {pathlib.PurePath(mutant.file).parent: mutant for mutant in reversed(mutants)}
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
