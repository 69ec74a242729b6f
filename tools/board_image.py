#!/usr/bin/env python3
"""Writes the C file that tells an image its version and its default motor.

usage: board_image.py --root ROOT --motor NAME --version V --board NAME --pin-map FILE
                      --numeric FORMAT --flags FLAGS OUTPUT.c

The hash is of the sources that the image is made of, motor, pin map and the compiler's flags, so
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


def source_hash(root, board, motor, pin_map, flags):
    """Of the pin maps the one that is used counts, by its name, as it may lie anywhere."""
    digest = hashlib.sha256(flags.encode())
    files = [root / "hal" / "hal.h", motor]
    for folder in ("firmware", "hal/cortex_m", f"hal/{board}"):
        files += [p for p in (root / folder).rglob("*") if p.suffix in {".c", ".h", ".ld"}]
    for path in sorted(p for p in files if p.parent.name != "pin_maps"):
        digest.update(path.relative_to(root).as_posix().encode() + b"\0")
        digest.update(path.read_bytes())
    digest.update(pin_map.name.encode() + b"\0" + pin_map.read_bytes())
    return digest.hexdigest()[:12]


def motor_text(path):
    values = tomllib.loads(path.read_text(encoding="utf-8"))
    for key in KEYS:
        if key not in values:
            sys.exit(f"{path}: {key} is missing")
    return "".join(f"    .{key} = {values[key]!r},\n" for key in KEYS)


def main():
    parser = argparse.ArgumentParser()
    for name in ("root", "motor", "version", "board", "pin-map", "numeric", "flags"):
        parser.add_argument(f"--{name}", required=True)
    parser.add_argument("output", type=Path)
    given = parser.parse_args()
    root = Path(given.root)
    motor = motor_file(root, given.motor)
    pin_map = Path(given.pin_map)
    digest = source_hash(root, given.board, motor, pin_map, f"{given.flags} {given.numeric}")
    text = (
        '#include "hal/cortex_m/image.h"\n\n'
        f"const struct motor_params motor_default = {{\n{motor_text(motor)}}};\n\n"
        "const char image_version[] =\n"
        f'    "steadystep {given.version} {digest} {given.board} {pin_map.stem} {given.numeric}'
        f' {motor.stem}";\n'
    )
    if not given.output.exists() or given.output.read_text(encoding="utf-8") != text:
        given.output.write_text(text, encoding="utf-8")
    return 0


if __name__ == "__main__":
    sys.exit(main())
