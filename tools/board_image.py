#!/usr/bin/env python3
"""Writes the C file that tells an image its version and its default motor.

usage: board_image.py --root ROOT --motor NAME --version V --board NAME --numeric FORMAT
                      --flags FLAGS OUTPUT.c

The hash is of the sources that the image is made of, the motor file and the compiler's flags, so
that the same sources give the same image, wherever and whenever they are built. OUTPUT.c is left
alone if nothing has changed.
"""

import argparse
import hashlib
import sys
import tomllib
from pathlib import Path

KEYS = (
    "resistance_ohm",
    "inductance_H",
    "torque_constant_Nm_A",
    "viscous_friction_Nms_rad",
    "inertia_kgm2",
    "rated_current_A",
    "supply_V",
    "rotor_teeth",
)


def motor_file(root, name):
    motors = {path.stem: path for path in sorted((root / "sil" / "motors").glob("*.toml"))}
    if name not in motors:
        sys.exit(f"STEADYSTEP_MOTOR is '{name}'; expected one of {', '.join(motors)}")
    return motors[name]


def source_hash(root, board, motor, flags):
    digest = hashlib.sha256(flags.encode())
    folders = ("firmware", f"hal/{board}")
    files = [root / "hal" / "hal.h", motor]
    for folder in folders:
        files += [p for p in (root / folder).rglob("*") if p.suffix in {".c", ".h", ".ld"}]
    for path in sorted(files):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0")
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def motor_text(path):
    values = tomllib.loads(path.read_text(encoding="utf-8"))
    for key in KEYS:
        if key not in values:
            sys.exit(f"{path}: {key} is missing")
    return "".join(f"    .{key} = {values[key]!r},\n" for key in KEYS)


def main():
    parser = argparse.ArgumentParser()
    for name in ("root", "motor", "version", "board", "numeric", "flags"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("output", type=Path)
    given = parser.parse_args()
    root = Path(given.root)
    motor = motor_file(root, given.motor)
    digest = source_hash(root, given.board, motor, f"{given.flags} {given.numeric}")
    text = (
        f'#include "hal/{given.board}/image.h"\n\n'
        f"const struct motor_params motor_default = {{\n{motor_text(motor)}}};\n\n"
        'const char image_version[] =\n'
        f'    "steadystep {given.version} {digest} {given.board} {given.numeric} {motor.stem}";\n'
    )
    if not given.output.exists() or given.output.read_text(encoding="utf-8") != text:
        given.output.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
