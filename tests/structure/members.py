#!/usr/bin/env python3
"""Checks that a member of a block of struct drive is written by the block's own functions only, and
that what the background reads of the interrupt is read in one place.

usage: members.py ROOT         exit 1 and one line file:line per violation
       members.py --self-test ROOT   plants violations in a copy and expects each to be found

Read are drive/ and application/, which hold or reach a whole drive. A block is a member of struct
drive that is a struct itself, a write is `drive->block.member =`, through whatever pointer to drive
or block the file declares.
"""
import pathlib
import re
import shutil
import sys
import tempfile

import check

DRIVE = "firmware/drive/drive.h"
VIEW = "firmware/drive/interrupt_view.h"

# Sources that write the members of a block. Those of the others are written by what knows no drive.
WRITERS = {
    "params": ["drive", "estimator_design", "settings_in_motion", "belt_watch", "torque_constant",
               "inductance"],
    "belt_watch": ["belt_watch"],
    "lead_watch": ["lead_watch"],
    "torque_constant": ["torque_constant"],
    "settings": ["drive", "settings_in_motion", "belt_watch"],
    "supervision": ["state_machine"],
    "axis": ["axis"],
    "synchronism": ["synchronism", "settings_in_motion"],
    "input": ["prepared_input"],
    "standstill": ["standstill_angle"],
    "enabling": ["drive", "encoder_aligning", "inductance", "phase_balancing", "state_machine"],
    "thermal": ["thermal_watch"],
    "planner": ["planner"],
    "planned_end": ["planned_end"],
}
VALUES = {"position", "phases", "channels", "dq", "sincos"}  # structs that are one value

COMMENT = re.compile(r"/\*.*?\*/", re.DOTALL)
MEMBER = re.compile(r"^    (?:const )?(?:struct|union) (\w+) (\w+);", re.MULTILINE)
POINTER = re.compile(r"(?<!const )(?:struct|union) \w+ \*(\w+) = &(\w+(?:(?:->|\.)\w+)+);")
WRITE = re.compile(r"(?<![\w.>])(\w+)((?:(?:->|\.)\w+(?:\[[^\]]*\])*)+)\s*(?:[-+*/|&^]|<<|>>)?=(?!=)"
                   r"|(?<![\w.>])(\w+)((?:(?:->|\.)\w+(?:\[[^\]]*\])*)+)(?:\+\+|--)")
CAST = re.compile(r"\([^()]*\bvolatile\b[^()]*\*\)")


def code_of(path):
    return COMMENT.sub(lambda match: re.sub(r"[^\n]", " ", match.group()),
                       path.read_text(encoding="utf-8"))


def blocks_of(root):
    """Members of struct drive that are structs with members of their own."""
    body = re.search(r"^struct drive \{(.*?)^\};", code_of(root / DRIVE), re.DOTALL | re.MULTILINE)
    return {name for kind, name in MEMBER.findall(body.group(1)) if kind not in VALUES}


def words(path):
    return re.findall(r"\w+", re.sub(r"\[[^\]]*\]", "", path))


def written(code):
    """(offset, members from the drive on) of each write; of an unknown variable, none."""
    pointers = {"drive": []}
    for name, target in POINTER.findall(code):
        owner, *members = words(target)
        if owner == "application" and members[:1] == ["drive"]:
            pointers[name] = members[1:]
        elif owner in pointers:
            pointers[name] = pointers[owner] + members
    for match in WRITE.finditer(code):
        name, path = match.group(1) or match.group(3), match.group(2) or match.group(4)
        members = words(path)
        if name == "application" and members[0] == "drive":
            yield match.start(), members[1:]
        elif name in pointers:
            yield match.start(), pointers[name] + members


def violations(root):
    blocks = blocks_of(root)
    for path in sorted((root / "firmware").rglob("*.[ch]")):
        name = path.relative_to(root).as_posix()
        code = code_of(path)
        line = lambda offset: code.count("\n", 0, offset) + 1
        if name != VIEW:
            for match in CAST.finditer(code):
                yield f"{name}:{line(match.start())}: a cast to volatile: that is for {VIEW}"
        if not name.startswith(("firmware/drive/", "firmware/application/")):
            continue
        for offset, members in written(code):
            foreign = len(members) > 1 and members[0] in blocks
            if foreign and path.stem not in WRITERS.get(members[0], []):
                member = ".".join(members)
                yield f"{name}:{line(offset)}: writes {member}: give the block a function"


PLANTED = [
    ("firmware/drive/planted.c", "drive->hold.active = false;"),
    ("firmware/drive/planted.c", "drive->current_control.integral.d = NUM(0.0);"),
    ("firmware/drive/planted.c", "drive->supervision.period++;"),
    ("firmware/drive/planted.c", "drive->planner.lead_periods *= 2u;"),
    ("firmware/drive/planted.c", "struct command_queue *q = &drive->commands; q->looked = 0u;"),
    ("firmware/drive/planted.c", "struct planner *p = &drive->planner; p->plan[0].epoch = 1u;"),
    ("firmware/application/planted.c", "application->drive.hold.active = true;"),
    ("firmware/application/planted.c", "x = *(const volatile uint32_t *)&drive->period;"),
]
ALLOWED = "if (drive->hold.active == held) { drive->current.d = held; next->rotor.speed = held; }"


def self_test(root):
    """Every planted violation is found; what reads, or writes a value of its own, is none."""
    missed = 0
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch)
        shutil.copytree(root / "firmware", copy / "firmware")
        for name, line in [*PLANTED, ("firmware/drive/planted.c", ALLOWED)]:
            planted = copy / name
            planted.write_text(f"/* {line} */\n{line}\n", encoding="utf-8")
            found = [text for text in violations(copy) if text.startswith(f"{name}:")]
            planted.unlink()
            if len(found) != (line != ALLOWED) or found and not found[0].startswith(f"{name}:2:"):
                print(f"planted in {name}: {line}\n  reported: {found}")
                missed += 1
    print(f"{len(PLANTED) + 1 - missed} of {len(PLANTED) + 1} judged rightly")
    return missed == 0


if __name__ == "__main__":
    sys.exit(check.of_root(__doc__, violations, self_test, sys.argv[1:]))
