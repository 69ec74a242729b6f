#!/usr/bin/env python3
"""Builds the image for an encoder, by STEADYSTEP_ENCODER_COUNTS, and runs it with one.

usage: encoder_counts.py ROOT BUILD DISTURBANCES

BUILD: folder of the preset board-stm32g474, built. The project is configured anew with 4000 counts;
what then is compiled differently is, and linked to the rest of BUILD. Counts that are no number are
refused.
"""

import sys
import tempfile
from pathlib import Path

from mutants import compile_commands, output_of, relink

COUNTS = "4000"
# What the configuration of BUILD has fetched or was given.
HANDED_ON = ("CMSIS_DIR", "STEADYSTEP_MOTOR", "STEADYSTEP_BOARD_NUMERIC", "STEADYSTEP_PIN_MAP")


def handed_on(build):
    for line in (build / "CMakeCache.txt").read_text(encoding="utf-8").splitlines():
        name, _, value = line.partition("=")
        if name.partition(":")[0] in HANDED_ON:
            yield f"-D{name.partition(':')[0]}={value}"


def configure(root, build, folder, counts):
    return output_of(
        "cmake",
        "--preset",
        "board-stm32g474",
        "-S",
        root,
        "-B",
        folder,
        f"-DSTEADYSTEP_HOST_BUILD={build}",  # none of its programs is run
        f"-DSTEADYSTEP_ENCODER_COUNTS={counts}",
        *handed_on(build),
        check=False,
        folder=root,
    )


def words_without_output(words):
    at = words.index("-o")
    return words[:at] + words[at + 2 :]


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    root, build = Path(sys.argv[1]).resolve(), Path(sys.argv[2]).resolve()
    with tempfile.TemporaryDirectory() as scratch:
        folder = Path(scratch)
        refused = configure(root, build, folder / "refused", "4e3")
        if refused.returncode == 0 or "STEADYSTEP_ENCODER_COUNTS is '4e3'" not in refused.stderr:
            sys.exit(f"4e3 counts per turn are not refused:\n{refused.stdout}{refused.stderr}")
        configured = configure(root, build, folder / "build", COUNTS)
        if configured.returncode:
            sys.exit(f"{COUNTS} counts per turn: {configured.stdout}{configured.stderr}")
        asked = {
            source: words_without_output(words)
            for source, words, _ in compile_commands(folder / "build")
        }
        changed = []

        def recompiled(source, words):
            if source not in asked or asked[source] == words:
                return None
            if "ENCODER_COUNTS_PER_TURN" not in source.read_text(encoding="utf-8"):
                return None
            changed.append(source.name)
            return asked[source]

        image = relink(build, folder, recompiled)
        print(f"compiled for {COUNTS} counts per turn: {', '.join(changed) or 'nothing'}")
        done = output_of(sys.argv[3], image, f"encoder-of-{COUNTS}-counts", check=False)
    print(done.stdout + done.stderr, end="")
    return done.returncode


if __name__ == "__main__":
    sys.exit(main())
