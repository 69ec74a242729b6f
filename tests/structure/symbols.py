#!/usr/bin/env python3
"""Checks the symbols of firmware objects: no globals, no heap, no I/O, no libm; and that an image
shows nothing but itself.

usage: symbols.py NM OBJECT...          objects or archives of the portable firmware
       symbols.py NM --image NAME OBJECT  NAME must be the one global definition
       symbols.py NM --self-test CC       compiles planted violations and expects each to be found
"""
import pathlib
import subprocess
import sys
import tempfile

import check

# What a freestanding compiler may call of its own accord; the rest must be ours.
FREESTANDING = {"memcpy", "memmove", "memset", "memcmp"}
COMPILER_RUNTIME = ("__aeabi_", "__gnu_", "__stack_chk_fail", "_GLOBAL_OFFSET_TABLE_")


def symbols(nm, path):
    """(object, name, class letter, section) of each symbol."""
    listing = subprocess.run([nm, "-f", "sysv", "-A", path], check=True, capture_output=True,
                             text=True).stdout
    for line in listing.splitlines():
        fields = [field.strip() for field in line.split("|")]
        if len(fields) == 7:
            place, _, name = fields[0].rpartition(":")
            yield place.rpartition(":")[2].rpartition("/")[2], name.strip(), fields[2], fields[6]


def is_writable(section):
    """Tables of pointers are constant, though a loader relocates them once (.data.rel.ro)."""
    return section.startswith((".data", ".bss", ".tdata", ".tbss", "*COM*")) \
        and not section.startswith(".data.rel.ro")


def check_firmware(nm, paths):
    everything = [symbol for path in paths for symbol in symbols(nm, path)]
    defined = {name for _, name, letter, _ in everything if letter != "U"}
    if not defined:
        yield "no symbols at all: nothing was checked"
    for place, name, letter, section in everything:
        if letter != "U" and is_writable(section):
            yield f"{place}: {name} is a global variable ({section}); keep state in the drive"
        if letter == "U" and name not in defined | FREESTANDING \
                and not name.startswith(COMPILER_RUNTIME):
            yield f"{place}: calls {name}, which the firmware does not define"


def check_image(nm, name, path):
    listing = subprocess.run([nm, "-g", "--defined-only", path], check=True, capture_output=True,
                             text=True).stdout
    shown = [line.split()[-1] for line in listing.splitlines()]
    if shown != [name]:
        yield f"{path}: shows {', '.join(shown) or 'nothing'}; expected {name} alone"


PLANTED = [
    ("int counter;", "counter is a global variable"),
    ("static int calls; int count(void) { return ++calls; }", "calls is a global variable"),
    ("void *malloc(unsigned long); void *take(void) { return malloc(8); }", "calls malloc"),
    ("double sin(double); double f(double x) { return sin(x); }", "calls sin"),
    ("int puts(const char *); void say(void) { puts(\"x\"); }", "calls puts"),
    ("static const char *const names[] = {\"a\", \"b\"};"
     " const char *name(int i) { return names[i]; }", None),
]


def self_test(nm, compiler):
    """Every planted violation is found; a constant table is none."""
    missed = 0
    with tempfile.TemporaryDirectory() as scratch:
        source, planted = pathlib.Path(scratch, "planted.c"), pathlib.Path(scratch, "planted.o")
        for code, expected in PLANTED:
            source.write_text(code + "\n", encoding="utf-8")
            subprocess.run([compiler, "-O1", "-fPIC", "-c", source, "-o", planted], check=True)
            found = list(check_firmware(nm, [planted]))
            if len(found) != (expected is not None) or expected and expected not in found[0]:
                print(f"planted: {code}\n  reported: {found}")
                missed += 1
        source.write_text("int shown; int shown_too;\n", encoding="utf-8")
        subprocess.run([compiler, "-c", source, "-o", planted], check=True)
        if not list(check_image(nm, "shown", planted)):
            print("planted: a second visible name in an image; not reported")
            missed += 1
    print(f"{len(PLANTED) + 1 - missed} of {len(PLANTED) + 1} judged rightly")
    return missed == 0


def main(arguments):
    if len(arguments) == 3 and arguments[1] == "--self-test":
        return 0 if self_test(arguments[0], arguments[2]) else 1
    if len(arguments) == 4 and arguments[1] == "--image":
        found = list(check_image(arguments[0], arguments[2], arguments[3]))
    elif len(arguments) >= 2:
        found = list(check_firmware(arguments[0], arguments[1:]))
    else:
        print(__doc__, file=sys.stderr)
        return 2
    return check.report(found)


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
