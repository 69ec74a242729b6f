#!/usr/bin/env python3
"""Checks the dependencies of the modules on their includes, so that they cannot rot.

usage: dependencies.py ROOT         exit 1 and one line file:line per violation
       dependencies.py --self-test ROOT   plants violations in a copy and expects each to be found
"""
import functools
import pathlib
import re
import shutil
import sys
import tempfile

import check

NUMERIC = ["firmware/numeric/", "firmware/linkage.h", "firmware/rare.h", "firmware/simulation.h"]
MOTOR = ["firmware/motor/", "firmware/interface/settings_table.h", *NUMERIC]
DESIGN = ["firmware/design/", *MOTOR]  # blocks are scaled from its gains at start-up

# What each module may include, by prefix; the longest matching one decides. A file is a module of its
# own where the contract names it. "board.h's" stands for all that board.h itself exposes.
MODULES = {
    "firmware/linkage.h": [],
    "firmware/rare.h": [],
    "firmware/simulation.h": [],
    "firmware/numeric/": NUMERIC,
    "firmware/motor/": MOTOR,
    "firmware/design/": DESIGN,
    "firmware/estimator/": ["firmware/estimator/", *DESIGN],
    "firmware/control/": ["firmware/control/", *DESIGN],
    "firmware/motion/": ["firmware/motion/", *DESIGN],
    "firmware/interface/settings_table.h": [],
    "firmware/interface/": ["firmware/interface/", "firmware/control/position_laws.h", *DESIGN],
    "firmware/drive/": ["firmware/drive/", "firmware/interface/", "firmware/estimator/",
                        "firmware/control/", "firmware/motion/", *DESIGN, "hal/hal.h"],
    "firmware/application/": ["firmware/application/", "firmware/interface/", "firmware/drive/",
                              "firmware/estimator/", "firmware/control/", "firmware/motion/",
                              "firmware/link/", *DESIGN, "hal/hal.h"],
    "firmware/link/objects_table.h": [],
    "firmware/link/": ["firmware/link/", "firmware/application/", "firmware/interface/",
                       "firmware/drive/", *DESIGN, "hal/hal.h"],
    "hal/hal.h": [],
    "hal/sil/": ["hal/sil/", "hal/hal.h"],
    "hal/sil/firmware_image.": ["hal/hal.h", "hal/sil/firmware_image.h", "firmware/drive/",
                                "firmware/interface/",
                                "firmware/application/", "firmware/linkage.h"],
    "hal/cortex_m/": ["hal/cortex_m/", "hal/hal.h", "firmware/motor/motor_params.h",
                      "firmware/design/text.h"],
    "hal/stm32g474/": ["hal/stm32g474/", "hal/cortex_m/", "hal/hal.h",
                       "firmware/application/application.h"],
    "hal/stm32g071/": ["hal/stm32g071/", "hal/cortex_m/", "hal/hal.h",
                       "firmware/application/application.h", "firmware/design/text.h"],
    "hal/stm32g474/pin_maps/": [],
    "hal/stm32g071/pin_maps/": [],
    "sil/motors/": [],
    "sil/plant/": ["sil/plant/"],
    "sil/board/": ["sil/board/", "sil/plant/", "hal/", "firmware/interface/",
                   "firmware/application/settings_record.h"],
    "sil/virtual_board/": ["sil/virtual_board/", "sil/board/drive_board.h", "sil/plant/",
                           "hal/hal.h", "firmware/interface/",
                           "firmware/drive/drive_hash.h",
                           "firmware/application/settings_record.h"],
    "sil/scenario/": ["sil/scenario/", "firmware/interface/", "firmware/link/objects_table.h",
                      "sil/board/typed_line.h", "board.h's", "sil/virtual_board/virtual_board.h", "sil/virtual_board/board_facts.h"],
    "sil/scenario/main.cpp": ["sil/scenario/", "sil/serve/", "firmware/interface/"],
    "sil/serve/": ["sil/serve/", "sil/scenario/", "sil/board/drive_board.h", "board.h's",
                   "sil/virtual_board/virtual_board.h", "firmware/link/slcan.h"],
}
EXPOSED_BY = "sil/board/board.h"

# The portable firmware stands on a freestanding C compiler: no heap, no I/O, no libm.
C_HEADERS = {"float.h", "limits.h", "stdatomic.h", "stdbool.h", "stddef.h", "stdint.h", "string.h"}
# What would make a simulation depend on clock, scheduling or library version.
BANNED_IN_SIMULATION = {"chrono", "ctime", "future", "random", "thread", "time.h"}

INCLUDE = re.compile(r'^\s*#\s*include\s*(["<])([^">]+)[">]')
NUMBER_FORMAT = re.compile(r"\b(STEADYSTEP_NUM|NUM_FLOAT|NUM_FIXED|NUM_DOUBLE)\b")
COMMENT = re.compile(r"/\*.*?\*/|//[^\n]*", re.DOTALL)


@functools.cache  # the self-test reads each source many times
def matches(pattern, text):
    """(line, match) for each line of a source that the pattern matches, comments left out."""
    text = COMMENT.sub(lambda match: re.sub(r"[^\n]", " ", match.group()), text)
    found = ((number, pattern.search(line)) for number, line in enumerate(text.splitlines(), start=1))
    return [(number, match) for number, match in found if match]


def matches_in(path, pattern):
    return matches(pattern, path.read_text(encoding="utf-8"))


def includes(path):
    for number, match in matches_in(path, INCLUDE):
        yield number, match.group(1) == '"', match.group(2)


def exposed(root, header, found=None):
    """The headers of the project that `header` includes, directly or through others, and itself."""
    found = set() if found is None else found
    if header not in found and (root / header).is_file():
        found.add(header)
        for _, ours, name in includes(root / header):
            if ours:
                exposed(root, name, found)
    return found


def module_of(name):
    modules = [module for module in MODULES if name.startswith(module)]
    return max(modules, key=len, default=None)


def check_file(root, name, board_exposes):
    """Yields (line, text) for each violation in one source."""
    module = module_of(name)
    if module is None:
        yield 1, "belongs to no module that tests/structure/dependencies.py knows"
        return
    firmware = name.startswith("firmware/")
    simulation = (name.startswith(("sil/plant/", "sil/board/", "sil/virtual_board/", "hal/sil/"))
                  and not name.startswith("sil/plant/bench_"))  # those measure time
    allowed = MODULES[module]
    for number, ours, target in includes(root / name):
        if not ours:
            if firmware and target not in C_HEADERS:
                yield number, f"the firmware must not include <{target}>"
            elif simulation and target in BANNED_IN_SIMULATION:
                yield number, f"a deterministic simulation must not include <{target}>"
        elif not (root / target).is_file():
            yield number, f'"{target}" is no path from the root of the project'
        elif not (target.startswith(tuple(allowed))
                  or "board.h's" in allowed and target in board_exposes):
            yield number, f'{module} must not include "{target}"'
    if not name.startswith("firmware/numeric/"):
        for number, match in matches_in(root / name, NUMBER_FORMAT):
            yield number, f"{match.group()} is tested for in firmware/numeric/ and nowhere else"


def violations(root):
    board_exposes = exposed(root, EXPOSED_BY)
    for top in ("firmware", "hal", "sil"):
        for path in sorted((root / top).rglob("*")):
            if path.suffix in {".c", ".h", ".cpp"}:
                name = path.relative_to(root).as_posix()
                for number, text in check_file(root, name, board_exposes):
                    yield f"{name}:{number}: {text}"


PLANTED = [
    ("firmware/numeric/planted.c", '#include "firmware/motor/motor_params.h"'),
    ("firmware/motor/planted.c", '#include "firmware/interface/drive_interface.h"'),
    ("firmware/control/planted.c", '#include "firmware/interface/drive_interface.h"'),
    ("firmware/control/planted.c", '#include "firmware/estimator/estimate.h"'),
    ("firmware/motion/planted.c", '#include "firmware/control/modulator.h"'),
    ("firmware/control/planted.c", '#include "hal/hal.h"'),
    ("firmware/control/planted.c", '#include "../motor/motor_params.h"'),
    ("firmware/control/planted.c", '#include "motor_params.h"'),
    ("firmware/control/planted.c", "#include <math.h>"),
    ("firmware/control/planted.c", "#include <stdlib.h>"),
    ("firmware/control/planted.c", "#if STEADYSTEP_NUM == NUM_FIXED"),
    ("firmware/drive/planted.c", '#include "hal/sil/firmware_image.h"'),
    ("firmware/drive/planted.c", '#include "firmware/application/application.h"'),
    ("hal/sil/planted.c", '#include "firmware/interface/drive_interface.h"'),
    ("hal/cortex_m/planted.c", '#include "hal/stm32g474/pwm.h"'),
    ("hal/stm32g071/planted.c", '#include "hal/stm32g474/pwm.h"'),
    ("hal/stm32g474/pin_maps/planted.h", '#include "hal/stm32g474/board.h"'),
    ("sil/plant/planted.cpp", '#include "hal/hal.h"'),
    ("sil/plant/planted.cpp", "#include <random>"),
    ("sil/board/planted.cpp", '#include "firmware/numeric/num.h"'),
    ("sil/virtual_board/planted.cpp", '#include "sil/scenario/runner.h"'),
    ("sil/virtual_board/planted.cpp", "#include <chrono>"),
    ("sil/scenario/planted.cpp", '#include "firmware/numeric/num.h"'),
    ("firmware/attic/planted.c", "int planted;"),
]


def self_test(root):
    """Every planted violation is found, at its line; a comment that names one is not."""
    missed = 0
    with tempfile.TemporaryDirectory() as scratch:
        copy = pathlib.Path(scratch)
        for top in ("firmware", "hal", "sil"):
            shutil.copytree(root / top, copy / top)
        for name, line in PLANTED:
            planted = copy / name
            planted.parent.mkdir(exist_ok=True)
            planted.write_text(f"/* {line} */\n// {line}\n{line}\n", encoding="utf-8")
            found = [text for text in violations(copy) if text.startswith(name)]
            planted.unlink()
            expected_line = 1 if name.startswith("firmware/attic") else 3
            if len(found) != 1 or not found[0].startswith(f"{name}:{expected_line}:"):
                print(f"planted in {name}: {line}\n  reported: {found}")
                missed += 1
    print(f"{len(PLANTED) - missed} of {len(PLANTED)} planted violations found")
    return missed == 0


if __name__ == "__main__":
    sys.exit(check.of_root(__doc__, violations, self_test, sys.argv[1:], "violations of the dependencies"))
