#!/usr/bin/env python3
"""Writes the C file that gives an image its version and its default motor.

usage: board_image.py --root ROOT --motor FILE --version V --board NAME --pin-map FILE
                      --numeric FORMAT [--shifts FILE] --flags FLAGS OUTPUT.c

The hash is of the sources that the image is made of, motor, pin map, shifts (of an image for one
motor, firmware/numeric/coefficients.h) and the compiler's flags, so
that the same sources give the same image, wherever and whenever they are built. OUTPUT.c is left
alone if nothing has changed.
"""

import argparse
import hashlib
import sys
from pathlib import Path

from motor_parameters import NotAMotor, parameters_of


def source_hash(root, board, named, flags):
    """What is `named` counts by its name, as it may lie anywhere."""
    digest = hashlib.sha256(flags.encode())
    files = [root / "hal" / "hal.h"]
    for folder in ("firmware", "hal/cortex_m", f"hal/{board}"):
        files += [p for p in (root / folder).rglob("*") if p.suffix in {".c", ".h", ".ld"}]
    for path in sorted(p for p in files if p.parent.name != "pin_maps"):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0")
        digest.update(path.read_bytes())
    for path in named:
        digest.update(path.name.encode() + b"\0" + path.read_bytes())
    return digest.hexdigest()[:12]


def board_checks(motor, values, board):
    """What the compiler refuses of this motor on this pin map."""
    checks = (
        (
            f"{values['supply_V']!r} <= BOARD_SUPPLY_LIMIT_V(CONVERTER_CODES, BUS_V_PER_CODE)",
            f"its over-voltage, 1.29 x supply_V = {values['supply_V']}, is beyond what the pin map's"
            " BUS_V_PER_CODE measures",
        ),
        (
            f"{values['rated_current_A']!r} <= RATED_CURRENT_SHARE * "
            "BOARD_CURRENT_RANGE_A(CONVERTER_CODES, CURRENT_ZERO_CODE, CURRENT_A_PER_CODE)",
            f"rated_current_A = {values['rated_current_A']} is beyond 0.8 of what the pin map's"
            " CURRENT_A_PER_CODE measures",
        ),
    )
    return f'#include "firmware/drive/board_limits.h"\n#include "hal/{board}/board.h"\n\n' + "".join(
        f'__extension__ _Static_assert({true},\n    "STEADYSTEP_MOTOR {motor}: {text}");\n'
        for true, text in checks
    )


def motor_values(path):
    try:
        return parameters_of(path)
    except NotAMotor as error:
        sys.exit(str(error))


def main():
    parser = argparse.ArgumentParser()
    for name in ("root", "motor", "version", "board", "pin-map", "numeric", "flags"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("--shifts", type=Path)
    parser.add_argument("output", type=Path)
    given = parser.parse_args()
    root = Path(given.root)
    motor = Path(given.motor)
    pin_map = Path(given.pin_map)
    named = [motor, pin_map] + ([given.shifts] if given.shifts else [])
    digest = source_hash(root, given.board, named, f"{given.flags} {given.numeric}")
    values = motor_values(motor)
    numbers = "".join(f"    .{key} = {value!r},\n" for key, value in values.items())
    text = (
        '#include "hal/cortex_m/image.h"\n\n'
        f"{board_checks(motor.stem, values, given.board)}\n"
        f"const struct motor_params motor_default = {{\n{numbers}}};\n\n"
        "const char image_version[] =\n"
        f'    "steadystep {given.version} {digest} {given.board} {pin_map.stem} {given.numeric}'
        f' {motor.stem}";\n'
    )
    if not given.output.exists() or given.output.read_text(encoding="utf-8") != text:
        given.output.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
