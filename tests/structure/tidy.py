#!/usr/bin/env python3
"""Runs clang-tidy (.clang-tidy) over the portable firmware in one number format.

usage: tidy.py ROOT BUILD NUMERIC [--without-analyzer]
BUILD holds compile_commands.json; exit 1 with the findings, 77 (skipped) without clang-tidy.
--without-analyzer leaves out the paths of the static analyzer: a fifteenth of the time.
"""
import concurrent.futures
import json
import os
import pathlib
import shutil
import subprocess
import sys

SKIPPED = 77


def jobs(root, build, numeric):
    """(source, compiler arguments) of each source, once: the image for one motor is in fixed point, too."""
    definition = f"-DSTEADYSTEP_NUM=NUM_{numeric.upper()}"
    commands = json.loads((build / "compile_commands.json").read_text(encoding="utf-8"))
    sources = {pathlib.Path(entry["file"]) for entry in commands
               if definition in entry["command"].split()}
    for source in sources:
        if (root / "firmware") in source.parents:
            yield str(source), ["-std=c11", "-ffp-contract=off", "-Wall", "-Wextra",
                                "-Wconversion", f"-I{root}", definition]


def check(tool, options, job):
    source, arguments = job
    result = subprocess.run([tool, "--quiet", "--warnings-as-errors=*", *options, source, "--",
                             *arguments], check=False, capture_output=True, text=True)
    return result.stdout if result.returncode else ""


def main(arguments):
    options = ["--checks=-clang-analyzer-*"] if arguments[3:] == ["--without-analyzer"] else []
    if len(arguments) != 3 + len(options):
        print(__doc__, file=sys.stderr)
        return 2
    root, build = (pathlib.Path(argument).resolve() for argument in arguments[:2])
    tool = shutil.which("clang-tidy-14") or shutil.which("clang-tidy")
    if tool is None:
        print("clang-tidy is not installed")
        return SKIPPED
    work = sorted(jobs(root, build, arguments[2]))
    if not work:
        print(f"no firmware in {arguments[2]} in {build}/compile_commands.json")
        return 1
    with concurrent.futures.ThreadPoolExecutor(os.cpu_count()) as pool:
        findings = list(filter(None, pool.map(lambda job: check(tool, options, job), work)))
    print("\n".join(dict.fromkeys(findings)))
    print(f"{len(work)} firmware sources checked, {len(findings)} with findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
