#!/usr/bin/env python3
"""Mutants of the board port: each is a mistake in a register or in the order of things that no unit
test could see. The virtual board must catch each, for its own reason: by what it refuses, or by a
drive_hash that is not the simulator's.

usage: mutants.py ROOT BUILD SIMULATOR [--only TEXT]

BUILD: folder of the preset board-stm32g474, with steadystep.elf built. A mutant recompiles the
sources of hal/stm32g474 and links them to the firmware as it is.
"""

import argparse
import json
import re
import shlex
import shutil
import subprocess
import sys
import tempfile
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass
from pathlib import Path

PORT = Path("hal/stm32g474")
# What is run: a shorted leg; an interrupt held up; motion; a fast sine, which the background plans
# all the time.
SHORT_CIRCUIT = ["board-overcurrent"]
OVERRUN = ["board-overrun"]
MOVE = ["board-short-stall"]
PLANNED = [
    "reference-sine",
    "--set",
    "event=[{time_s=0.0,command='sine',amplitude_rad=0.3,frequency_Hz=14.0,cycles=10,ramp_s=0.2}]",
]


@dataclass
class Mutant:
    name: str
    file: str  # of the port
    text: str
    instead: str
    run: list  # of the simulator: scenario and options
    expected: str  # in the failure of the run; "" a drive_hash that is not the simulator's
    numeric: str = ""  # the number format it is a mistake in; "" any


MUTANTS = [
    Mutant(
        "the converters are triggered in the high state",
        "pwm.c",
        "TIM1->ccr5 = PWM_HALF_PERIOD - 1;",
        "TIM1->ccr5 = 1;",
        MOVE,
        "the current is sampled before the peak",
    ),
    Mutant(
        "the phases are swapped",
        "pwm.h",
        "TIM1->ccr[leg] = high_counts[leg];",
        "TIM1->ccr[leg ^ 2] = high_counts[leg];",
        MOVE,
        "the drive computed",
    ),
    Mutant(
        "the duties load a period late",
        "control_interrupt.c",
        "    pwm_write(outputs->high_counts);\n",
        "    static uint16_t late[HAL_LEGS];\n"
        "    pwm_write(late);\n"
        "    for (int leg = 0; leg < HAL_LEGS; leg++) {\n"
        "        late[leg] = outputs->high_counts[leg];\n"
        "    }\n",
        MOVE,
        "the drive computed",
    ),
    Mutant(
        "the voltage mean is one period old",
        "phase_voltage_sampling.c",
        "stored_a < HALF ? HALF : 0;",
        "stored_a < HALF ? 0 : HALF;",
        MOVE,
        "",
    ),
    Mutant(
        "the break input is ignored",
        "pwm.h",
        "TIM_BDTR_BKE | ",
        "",
        SHORT_CIRCUIT,
        "the bridge is closed 1 us after a leg was shorted",
    ),
    Mutant(
        "the deadline guard leaves the bridge closed",
        "deadline_guard.c",
        "    pwm_open_bridge();\n",
        "",
        OVERRUN,
        "the bridge is closed 1 us after the control interrupt's deadline",
    ),
    Mutant(
        "the dead time is zero",
        "pwm.h",
        "TIM_BDTR_DTG(0x80 | (DEAD_TIME_CYCLES / 2 - 64))",
        "TIM_BDTR_DTG(0)",
        MOVE,
        "dead time",
    ),
    Mutant(
        "the registers of the FPU are not saved",
        "startup.c",
        "    SCB->cpacr |= ",
        "    *(volatile uint32_t *)0xe000ef34u = 0; /* FPCCR: no automatic state preservation */\n"
        "    SCB->cpacr |= ",
        PLANNED,
        "",
        numeric="float",
    ),
    Mutant(
        "the watchdog is not fed",
        "board_hal.c",
        "    watchdog_feed();",
        "",
        MOVE,
        "watchdog",
    ),
    Mutant(
        "the vector table is misplaced",
        "startup.c",
        "SCB->vtor = (uint32_t)&vectors;",
        "SCB->vtor = (uint32_t)&vectors + 64;",
        MOVE,
        "VTOR",
    ),
]


def output_of(*words, check=True):
    done = subprocess.run(
        [str(word) for word in words],
        capture_output=True,
        text=True,
        stdin=subprocess.DEVNULL,
        check=False,
    )
    if check and done.returncode:
        raise RuntimeError(f"{shlex.join(map(str, words))}:\n{done.stdout}{done.stderr}")
    return done


def link_command(build):
    """The command that linked steadystep.elf, as words, without what follows it."""
    commands = output_of("ninja", "-C", build, "-t", "commands", "steadystep.elf").stdout
    last = commands.strip().splitlines()[-1]
    words = shlex.split(last.split("&&")[1] if last.startswith(": &&") else last)
    return words


def compile_commands(build):
    """{source below the root: words}"""
    listed = json.loads((build / "compile_commands.json").read_text())
    return {
        Path(one["file"]): (shlex.split(one["command"]), Path(one["directory"])) for one in listed
    }


def numeric_of(build):
    return json.loads((build / "steadystep.map.json").read_text(encoding="utf-8"))["numeric"]


def reads(changed, source):
    """Whether a file of the port is, or includes, the changed one."""
    if source == changed:
        return True
    included = re.findall(rf'#include "{PORT}/(\w+\.h)"', source.read_text(encoding="utf-8"))
    return any(reads(changed, source.parent / name) for name in included)


def build_mutant(mutant, root, build, folder):
    """Returns the image of a mutant, linked in `folder`."""
    port = folder / PORT
    shutil.copytree(root / PORT, port, dirs_exist_ok=True)
    changed = port / mutant.file
    text = changed.read_text()
    if text.count(mutant.text) != 1:
        raise RuntimeError(f"{mutant.name}: {PORT / mutant.file}: not exactly one\n{mutant.text}")
    changed.write_text(text.replace(mutant.text, mutant.instead))
    objects = {}
    for source, (words, directory) in compile_commands(build).items():
        if root / PORT not in source.parents or not reads(changed, port / source.name):
            continue
        target = folder / (source.stem + ".obj")
        at = words.index("-o")
        objects[str((directory / words[at + 1]).resolve())] = str(target)
        words = words[: at + 1] + [str(target)] + words[at + 2 :]
        words = [str(port / source.name) if Path(word) == source else word for word in words]
        words.insert(1, f"-I{folder}")
        done = subprocess.run(words, cwd=directory, capture_output=True, text=True, check=False)
        if done.returncode:
            raise RuntimeError(f"{mutant.name}: {done.stderr}")
    image = folder / "steadystep.elf"
    words = link_command(build)
    words = [objects.get(str((build / word).resolve()), word) for word in words]
    words[words.index("-o") + 1] = str(image)
    words = [f"-Wl,-Map={image}.map" if word.startswith("-Wl,-Map=") else word for word in words]
    done = subprocess.run(words, cwd=build, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{mutant.name}: {done.stderr}")
    output_of(root / "tools" / "image_map", image)
    return image


def summary(simulator, *options):
    done = output_of(simulator, "run", "--json", *options, check=False)
    try:
        return json.loads(done.stdout)[0]
    except (ValueError, LookupError):
        raise RuntimeError(f"{shlex.join(map(str, options))}: {done.stdout}{done.stderr}") from None


def judge(mutant, image, simulator, numeric):
    """(whether the mutant was caught for its reason, what happened)"""
    options = ["--numeric", numeric, *mutant.run]
    run = summary(simulator, "--image", image, *options)
    wanted = summary(simulator, "--typed", *options)["drive_hash"]
    if run["drive_hash"] == wanted:
        happened = f"drive_hash {wanted}, as the simulator's"
    else:
        happened = f"drive_hash {run['drive_hash']}, the simulator's {wanted}"
    if run["failure"]:
        happened = f"{run['failure']}; {happened}"
    if mutant.expected:
        return mutant.expected in (run["failure"] or ""), happened
    return run["drive_hash"] != wanted, happened


def try_mutant(mutant, options):
    with tempfile.TemporaryDirectory() as folder:
        image = build_mutant(mutant, options.root, options.build, Path(folder))
        return judge(mutant, image, options.simulator, options.numeric)


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("root", type=lambda text: Path(text).resolve())
    parser.add_argument("build", type=lambda text: Path(text).resolve())
    parser.add_argument("simulator", type=lambda text: Path(text).resolve())
    parser.add_argument("--only", metavar="TEXT", default="", help="mutants whose name has TEXT")
    options = parser.parse_args()
    built = (options.build / "steadystep.elf").stat().st_mtime
    newer = [file for file in (options.root / PORT).iterdir() if file.stat().st_mtime > built]
    if newer:
        sys.exit(f"{newer[0]} is newer than the image: build it first")
    options.numeric = numeric_of(options.build)
    chosen = [
        mutant
        for mutant in MUTANTS
        if options.only in mutant.name and mutant.numeric in ("", options.numeric)
    ]
    caught = 0
    with ThreadPoolExecutor(max_workers=2) as pool:
        for mutant, (right, happened) in zip(
            chosen, pool.map(lambda mutant: try_mutant(mutant, options), chosen)
        ):
            caught += right
            verdict = "caught" if right else "NOT CAUGHT"
            print(f"{verdict:10} {mutant.name}\n{'':10} {happened}", flush=True)
            if not right and mutant.expected:
                print(f"{'':10} expected: {mutant.expected}")
    print(f"{caught} of {len(chosen)} caught")
    return 0 if caught == len(chosen) > 0 else 1


if __name__ == "__main__":
    sys.exit(main())
