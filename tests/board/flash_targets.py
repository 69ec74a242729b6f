#!/usr/bin/env python3
"""The targets `flash`, `flash-st` and `debug` of a board's build, with programs that only say how
they were called: each connects under reset, before it does anything else, and writes this image.

usage: flash_targets.py BUILD      folder of a board preset
"""

import os
import subprocess
import sys
import tempfile
from pathlib import Path

UNDER_RESET = "connect_assert_srst"


def called(build, target, program):
    """The words that the target calls the program with."""
    commands = subprocess.run(
        ["ninja", "-C", str(build), "-t", "commands", target],
        capture_output=True,
        text=True,
        check=True,
    ).stdout.strip()
    with tempfile.TemporaryDirectory() as folder:
        stand_in = Path(folder) / program
        stand_in.write_text("#!/bin/sh\nfor word; do echo \"word: $word\"; done\n", "ascii")
        stand_in.chmod(0o755)
        path = f"{folder}{os.pathsep}{os.environ['PATH']}"
        done = subprocess.run(
            ["sh", "-c", commands.splitlines()[-1]],
            env={**os.environ, "PATH": path},
            capture_output=True,
            text=True,
            check=True,
        )
    return [line[len("word: ") :] for line in done.stdout.splitlines() if line.startswith("word: ")]


def place(words, *texts):
    """Of the first word that has all texts; behind the last word if there is none."""
    found = [i for i, word in enumerate(words) if all(text in word for text in texts)]
    return found[0] if found else len(words)


def main():
    build = Path(sys.argv[1]).resolve()
    wrong = []
    for target, acts in (
        ("flash", ("program ", f"{build}/steadystep.elf", "verify", "reset", "exit")),
        ("debug", ("init",)),
    ):
        words = called(build, target, "openocd")
        print(f"{target}: openocd", *words)
        act = place(words, *acts)
        if act == len(words):
            wrong.append(f"{target}: nothing does {' '.join(acts)}")
        if place(words, "reset_config", UNDER_RESET) > min(act, place(words, "init")):
            wrong.append(f"{target}: connects before {UNDER_RESET} is set")
    words = called(build, "flash-st", "st-flash")
    print("flash-st: st-flash", *words)
    if place(words, "--connect-under-reset") >= place(words, "write"):
        wrong.append("flash-st: does not connect under reset")
    if words[-1:] != [f"{build}/steadystep.hex"]:
        wrong.append("flash-st: does not write steadystep.hex")
    print("\n".join(wrong) or "all connect under reset")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
