#!/usr/bin/env python3
"""Checks every source against .clang-format.

usage: format.py [--fix] ROOT    exit 1 with one line per difference; 77 (skipped) without
                                 clang-format 14, since other versions format differently
       --fix                     formats the sources instead
"""
import pathlib
import re
import shutil
import subprocess
import sys

VERSION = "14"
SKIPPED = 77


def clang_format():
    for name in (f"clang-format-{VERSION}", "clang-format"):
        path = shutil.which(name)
        if path:
            text = subprocess.run([path, "--version"], check=True, capture_output=True,
                                  text=True).stdout
            if re.search(rf"version {VERSION}\.", text):
                return path
    return None


def main(arguments):
    fix = arguments[:1] == ["--fix"]
    if len(arguments) != 1 + fix:
        print(__doc__, file=sys.stderr)
        return 2
    root = pathlib.Path(arguments[-1])
    tool = clang_format()
    if tool is None:
        print(f"clang-format {VERSION} is not installed")
        return SKIPPED
    sources = sorted(str(path) for top in ("firmware", "hal", "sil", "tests", "tools")
                     for path in (root / top).rglob("*")
                     if path.suffix in {".c", ".h", ".cpp"})
    mode = ["-i"] if fix else ["--dry-run", "-Werror"]
    result = subprocess.run([tool, *mode, "--style=file", *sources], check=False)
    print(f"{len(sources)} sources {'formatted' if fix else 'checked'}")
    return 1 if result.returncode else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
