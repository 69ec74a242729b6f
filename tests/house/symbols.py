#!/usr/bin/env python3
"""Checks the symbols of firmware objects: no globals, no heap, no I/O, no libm; and that an image
shows nothing but itself.

usage: symbols.py NM OBJECT...          objects or archives of the portable firmware
       symbols.py NM --image NAME OBJECT  NAME must be the one global definition
"""
import subprocess
import sys

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


def main(arguments):
    if len(arguments) == 4 and arguments[1] == "--image":
        found = list(check_image(arguments[0], arguments[2], arguments[3]))
    elif len(arguments) >= 2:
        found = list(check_firmware(arguments[0], arguments[1:]))
    else:
        print(__doc__, file=sys.stderr)
        return 2
    for text in found:
        print(text)
    print(f"{len(found)} violations")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
