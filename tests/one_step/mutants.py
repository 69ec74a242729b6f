#!/usr/bin/python3
"""Proves that one_step can fail: breaks an image in one place at a time, and not that in double.

usage: mutants.py ROOT BUILD NINJA

Each mutant replaces one text of one file of the firmware, found exactly once, as one source of one
number format is compiled. A scenario in that format must then have periods that are not explained;
unbroken, it has none.
"""
import json
import os
import pathlib
import shlex
import subprocess
import sys
import tempfile
from typing import NamedTuple

try:
    import elftools  # noqa: F401, what fields.py reads the objects with
except ImportError:
    print("left out: python3-pyelftools is not installed (tools/setup)")
    sys.exit(77)


class Mutant(NamedTuple):
    what: str
    numeric: str
    file: str
    source: str  # what is compiled anew
    scenario: str
    old: str
    new: str


INTERRUPT = "firmware/drive/control_cycle.c"
NUM = "firmware/numeric/num.h"

MUTANTS = [
    Mutant("a term that is small", "float", "firmware/motor/motor_model.h", INTERRUPT,
           "bendjedia-fig12", "speed - num_mul(droop, speed)", "speed"),
    Mutant("a torque that is small", "float", "firmware/motor/motor_model.h", INTERRUPT,
           "bendjedia-fig12", "i_q - num_mul_coef(rotor->speed, model->friction)", "i_q"),
    Mutant("a difference of fewer bits", "float", "firmware/numeric/angle.h", INTERRUPT,
           "bendjedia-fig12", "(num_t)(int32_t)(difference >> 5) * NUM(1.0 / 134217728.0)",
           "(num_t)(int32_t)(difference >> 9) * NUM(1.0 / 8388608.0)"),
    Mutant("a series without its last term", "float", "firmware/numeric/trig.c",
           "firmware/numeric/trig.c", "bendjedia-fig12", "x * (NUM(S1) + x2 * NUM(S3));",
           "x * NUM(S1);"),
    Mutant("a constant that is off by 2e-5", "float", "firmware/numeric/trig.c",
           "firmware/numeric/trig.c", "bendjedia-fig12", "#define S1        6.283185307179586",
           "#define S1        6.283085307179586"),
    Mutant("a limit that is another", "float", "firmware/motor/actuation.h", INTERRUPT,
           "bendjedia-fig12", "LOSS_MAX NUM(0.1)", "LOSS_MAX NUM(0.01)"),
    Mutant("a product that loses low bits", "fixed", NUM, INTERRUPT, "bendjedia-fig12",
           "return (num_t)(((int64_t)a * u) >> 15);",
           "return (num_t)(((int64_t)a * u) >> 15) & ~INT32_C(0xfff);"),
    Mutant("a factor of two bits less", "fixed", NUM, INTERRUPT, "bendjedia-fig12",
           "static inline num_t num_mul(num_t a, num_t b)\n{\n"
           "    const int32_t factor = b >> (NUM_FRACTION_BITS - 14);\n",
           "static inline num_t num_mul(num_t a, num_t b)\n{\n"
           "    const int32_t factor = (b >> (NUM_FRACTION_BITS - 14)) & ~3;\n"),
    Mutant("a term that is small", "fixed", "firmware/motor/motor_model.h", INTERRUPT,
           "bendjedia-fig12", "speed - num_mul(droop, speed)", "speed"),
]


class Tree:
    """The build, and how it makes its objects."""

    def __init__(self, root, build, ninja):
        self.root, self.build, self.ninja = root, build, ninja
        with open(build / "compile_commands.json", encoding="utf-8") as file:
            self.commands = [one["command"] for one in json.load(file)]

    def last_command(self, target):
        return subprocess.run([self.ninja, "-C", self.build, "-t", "commands", target], check=True,
                              capture_output=True, text=True).stdout.splitlines()[-1]

    def run(self, command):
        subprocess.run(command, check=True, shell=isinstance(command, str), cwd=self.build,
                       capture_output=True)

    def compile(self, mutant, scratch):
        """The object of the mutant's source, and that whose place it takes."""
        text = (self.root / mutant.file).read_text(encoding="utf-8")
        if text.count(mutant.old) != 1:
            raise ValueError(f"found {text.count(mutant.old)} times in {mutant.file}, not once: {mutant.old}")
        copy = scratch / mutant.file
        copy.parent.mkdir(parents=True)
        copy.write_text(text.replace(mutant.old, mutant.new), encoding="utf-8")
        command = next(shlex.split(one) for one in self.commands
                       if f"/firmware_{mutant.numeric}.dir/" in one
                       and one.endswith(f" -c {self.root / mutant.source}"))
        place = command.index("-o") + 1
        unbroken, command[place] = command[place], str(scratch / "mutant.o")
        if mutant.source == mutant.file:
            command[-1] = str(copy)
        self.run([*command[:1], f"-I{scratch}", *command[1:], "-w"])
        return unbroken, command[place]

    def program(self, mutant, scratch):
        """one_step with an image that has the mutant in it."""
        unbroken, broken = self.compile(mutant, scratch)
        name = f"firmware_image_{mutant.numeric}.o"
        image = scratch / name
        link = self.last_command(f"hal/{name}").split()
        found = [i for i, word in enumerate(link) if os.path.normpath(word).endswith("/" + unbroken)]
        link[found[0]] = broken
        self.run(" ".join(link).replace(str(self.build / "hal" / name), str(image)))
        program = scratch / "one_step"
        self.run(self.last_command("one_step")
                 .replace("-o tests/one_step/one_step", f"{image} -o {program}"))
        return program


def explains(tree, program, mutant):
    images = tree.build / "hal/CMakeFiles"
    layout = subprocess.run(
        [sys.executable, pathlib.Path(__file__).with_name("fields.py"),
         *(images / f"firmware_image_{numeric}.dir/sil/firmware_image.c.o"
           for numeric in (mutant.numeric, "double"))], check=True, capture_output=True).stdout
    with tempfile.NamedTemporaryFile() as file:
        file.write(layout)
        file.flush()
        result = subprocess.run([program, file.name, mutant.numeric, mutant.scenario], check=False,
                                capture_output=True, text=True)
    if result.returncode not in (0, 1) or "periods" not in result.stdout:
        raise ValueError(result.stderr)
    return result


def main():
    root, build, ninja = (pathlib.Path(one).resolve() for one in sys.argv[1:4])
    tree = Tree(root, build, ninja)
    survived = 0
    for mutant in MUTANTS:
        with tempfile.TemporaryDirectory() as scratch:
            result = explains(tree, tree.program(mutant, pathlib.Path(scratch)), mutant)
        survived += result.returncode == 0
        print(f"{'SURVIVES' if result.returncode == 0 else 'fails'}: {mutant.numeric}, {mutant.what}: "
              f"{result.stdout.splitlines()[0]}", flush=True)
    print(f"{len(MUTANTS) - survived} of {len(MUTANTS)} mutants fail")
    return 1 if survived else 0


if __name__ == "__main__":
    sys.exit(main())
