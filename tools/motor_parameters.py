#!/usr/bin/env python3
"""The eight parameters of a motor file, given or derived, as sil/scenario/motor_file.cpp reads them.

usage: motor_parameters.py FILE

For what is built or drawn without steadystep-sil. Whether the values go together only `steadystep-sil
check-motor` says; the test sil.motors holds both to the same numbers.
"""
import math
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
MAY_BE_0 = ("viscous_friction_Nms_rad", "load_inertia_kgm2")


class NotAMotor(Exception):
    """What is wrong with the file, its name included."""


def parameters_of(path):
    """{key: value} of a motor file."""
    try:
        values = tomllib.loads(path.read_text(encoding="utf-8"))
    except OSError as error:
        raise NotAMotor(f"{path}: {error.strerror}") from error
    except ValueError as error:
        raise NotAMotor(f"{path}: not a motor file: {error}") from error
    if "torque_constant_Nm_A" not in values and "holding_torque_Nm" in values:
        values["torque_constant_Nm_A"] = (number(path, values, "holding_torque_Nm")
                                          / (math.sqrt(2) * number(path, values, "rated_current_A")))
    if "inertia_kgm2" not in values and "rotor_inertia_kgm2" in values:
        values.setdefault("load_inertia_kgm2", 0)
        values["inertia_kgm2"] = (number(path, values, "rotor_inertia_kgm2")
                                  + number(path, values, "load_inertia_kgm2"))
    return {key: number(path, values, key) for key in KEYS}


def number(path, values, key):
    if key not in values:
        raise NotAMotor(f"{path}: not a motor file: {key} is missing")
    value = values[key]
    is_number = isinstance(value, (int, float)) and not isinstance(value, bool)
    if not is_number or not 0 <= value < 1e9 or (value == 0 and key not in MAY_BE_0):
        raise NotAMotor(f"{path}: not a motor file: {key}: expected a number above 0, got {value!r}")
    return value


def main():
    if len(sys.argv) != 2:
        sys.exit(__doc__.strip())
    try:
        for key, value in parameters_of(Path(sys.argv[1])).items():
            print(f"{key} = {value!r}")
    except NotAMotor as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
