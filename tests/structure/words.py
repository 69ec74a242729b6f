#!/usr/bin/env python3
"""Checks that names, comments, pages and READMEs use the field's words, not our own.

usage: words.py ROOT             exit 1 and one line file:line per word of our own
       words.py --self-test ROOT     plants each in a copy and expects it to be found
"""
import pathlib
import re
import sys
import tempfile

import check

TOPS = ["firmware", "hal", "sil", "tests", "tools", ".github", "README.md", "CMakeLists.txt"]
SUFFIXES = {".c", ".h", ".cpp", ".py", ".md", ".toml", ".txt", ".cmake", ".ld", ".eds", ""}
EVERYWHERE = ""
SYNCHRONISM = ["firmware/application/", "firmware/drive/", "firmware/estimator/",
               "tests/unit/test_synchronism_monitor.c", "tests/mutants/", "sil/scenarios/"]
FIRMWARE = ["firmware/", "tests/unit/", "tests/mutants/", "tests/reference/"]
ALIGNMENT = ["firmware/drive/", "firmware/estimator/", "tests/unit/"]

# What is not said, where, and what is. Names are read as the words that they consist of.
WORDS = [
    (r"told|tell(s|ing)?", [EVERYWHERE], "set, assumed; reported, distinguished"),
    (r"hand(ed|s|ing)? over|handover", [EVERYWHERE], "bumpless transfer; pass"),
    (r"(take|took|taken|taking) over|takes over(?! count)", [EVERYWHERE], "preempt"),
    (r"quiet hold|following hold|(quiet|following) gains", [EVERYWHERE], "settled, load-step"),
    (r"findings?", FIRMWARE, "(initial position) detection"),
    (r"immediate", ["firmware/", "hal/"], "zero delay; at once"),
    (r"doubts?|grip|torn|lagging|mirrored", SYNCHRONISM,
     "load angle, pull-out, stall, opposite half-turn; doubtful"),
    (r"drawing|aside", ALIGNMENT, "aligning, offset"),
    (r"(?<!input )home(?! (the axis|switch))", ALIGNMENT, "final angle"),
    (r"hides?|hidden", [*ALIGNMENT, "firmware/control/"], "blanks"),
    (r"house|rooms|arrows", [EVERYWHERE], "structure, project; modules; dependencies"),
    (r"(the|a|no|each|this|which|next) room(?! (for|on|below|before))", [EVERYWHERE], "module"),
    (r"drive is fault", [EVERYWHERE], "the drive is in fault"),
]

WORD_BREAK = re.compile(r"_+|(?<=[a-z])(?=[A-Z])")


def files(root):
    for top in TOPS:
        base = root / top
        for path in [base] if base.is_file() else sorted(base.rglob("*")):
            if path.is_file() and path.suffix in SUFFIXES and "__pycache__" not in path.parts:
                yield path.relative_to(root).as_posix(), path


PATTERNS = [(re.compile(rf"(?<![a-z])(?:{own})(?![a-z])", re.IGNORECASE), places, words)
            for own, places, words in WORDS]


def words_of_our_own(root):
    """(file, line, what stands there, what the field says) for each."""
    for name, path in files(root):
        if name == "tests/structure/words.py":
            continue
        patterns = [row for row in PATTERNS if name.startswith(tuple(row[1]))]
        for number, line in enumerate(path.read_text(encoding="utf-8").splitlines(), start=1):
            plain = WORD_BREAK.sub(" ", line)
            for pattern, _, words in patterns:
                for match in pattern.finditer(plain):
                    yield name, number, match.group(), words


def violations(root):
    for name, number, found, words in words_of_our_own(root):
        yield f'{name}:{number}: "{found}": the field says {words}'


PLANTED = [
    "the angle it is told", "double told_rad;", "handed over", "the plan takes over", "a quiet hold",
    "struct initial_position *finding", "SLIDING_MODE_IMMEDIATE_MAX", "loses its grip",
    "lagging_blocks", "STAGE_DRAWING", "a quarter turn aside", "the angle at home", "pulses hide it",
    "arrows between the rooms", "no room is left out", "the drive is fault",
]
PROPER = ["room for a record", "a retold tale", "the handle over there", "grips", "homed", "the home switch", "HAL_INPUT_HOME"]


def self_test(root):
    """Every planted word is found, and what only resembles one is not."""
    del root
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch)
        (copy / "firmware/drive").mkdir(parents=True)
        for text, expected in [(t, True) for t in PLANTED] + [(t, False) for t in PROPER]:
            (copy / "firmware/drive/planted.h").write_text(f"/* {text} */\n", encoding="utf-8")
            if bool(list(words_of_our_own(copy))) != expected:
                print(f"planted: {text}\n  expected {'a word' if expected else 'none'}")
                wrong += 1
    print(f"{len(PLANTED) + len(PROPER) - wrong} of {len(PLANTED) + len(PROPER)} texts judged rightly")
    return wrong == 0


if __name__ == "__main__":
    sys.exit(check.of_root(__doc__, violations, self_test, sys.argv[1:], "words of our own"))
