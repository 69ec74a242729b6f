#!/usr/bin/env python3
"""Mutants of the board port: each is a mistake in a register or in the order of things that no unit
test could see. The virtual board must refuse each, loudly or by a drive_hash that is not the
simulator's.

usage: mutants.py ROOT BUILD SIMULATOR [--only TEXT]

BUILD: folder of the preset board-stm32g474, with steadystep.elf built. A mutant recompiles the
sources of hal/stm32g474 and links them to the firmware as it is.
"""

import argparse
import json
import shlex
import shutil
import subprocess
import sys
import tempfile
from dataclasses import dataclass
from pathlib import Path

PORT = Path("hal/stm32g474")
SCENARIO = ["bendjedia-fig12", "--set", "duration_s=0.05"]
SHORT_CIRCUIT = ["--inject", "short-circuit:A+:30:0.01"]


@dataclass
class Mutant:
    name: str
    file: str  # of the port
    text: str
    instead: str
    run: list  # of the simulator: scenario and options
    expected: str  # in what it prints; "" a drive_hash that differs, whatever is printed


MUTANTS = [
    Mutant(
        "the converters are triggered in the high state",
        "pwm.c",
        "TIM1->ccr5 = PWM_HALF_PERIOD - 1;",
        "TIM1->ccr5 = 1;",
        SCENARIO,
        "",
    ),
    Mutant(
        "the phases are swapped",
        "pwm.h",
        "TIM1->ccr[leg] = high_counts[leg];",
        "TIM1->ccr[leg ^ 2] = high_counts[leg];",
        SCENARIO,
        "",
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
        SCENARIO,
        "",
    ),
    Mutant(
        "the voltage mean is one period old",
        "phase_voltage_sampling.c",
        "stored_a < HALF ? HALF : 0;",
        "stored_a < HALF ? 0 : HALF;",
        SCENARIO,
        "",
    ),
    Mutant(
        "the break input is ignored",
        "pwm.h",
        "TIM_BDTR_BKE | ",
        "",
        SCENARIO + SHORT_CIRCUIT,
        "overcurrent",
    ),
    Mutant(
        "the dead time is zero",
        "pwm.h",
        "TIM_BDTR_DTG(0x80 | (DEAD_TIME_CYCLES / 2 - 64))",
        "TIM_BDTR_DTG(0)",
        SCENARIO,
        "dead time",
    ),
    Mutant(
        "the registers of the FPU are not saved",
        "startup.c",
        "    SCB->cpacr |= ",
        "    *(volatile uint32_t *)0xe000ef34u = 0; /* FPCCR: no automatic state preservation */\n"
        "    SCB->cpacr |= ",
        SCENARIO,
        "",
    ),
    Mutant(
        "the watchdog is not fed",
        "board_hal.c",
        "    watchdog_feed();",
        "",
        SCENARIO,
        "watchdog",
    ),
    Mutant(
        "the vector table is misplaced",
        "startup.c",
        "SCB->vtor = (uint32_t)&vectors;",
        "SCB->vtor = (uint32_t)&vectors + 64;",
        SCENARIO,
        "",
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
    return {Path(one["file"]): (shlex.split(one["command"]), Path(one["directory"])) for one in listed}


def build_mutant(mutant, root, build, folder):
    """Returns the image of a mutant, linked in `folder`."""
    port = folder / PORT
    shutil.copytree(root / PORT, port, dirs_exist_ok=True)
    changed = port / mutant.file
    text = changed.read_text()
    if text.count(mutant.text) != 1:
        raise RuntimeError(f"{mutant.name}: {PORT / mutant.file} has not exactly one\n{mutant.text}")
    changed.write_text(text.replace(mutant.text, mutant.instead))
    objects = {}
    for source, (words, directory) in compile_commands(build).items():
        if root / PORT not in source.parents:
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
    words = [word if not word.startswith("-Wl,-Map=") else f"-Wl,-Map={image}.map" for word in words]
    done = subprocess.run(words, cwd=build, capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(f"{mutant.name}: {done.stderr}")
    output_of(root / "tools" / "image_map", image)
    return image


def drive_hash(text):
    try:
        return json.loads(text)[0]["drive_hash"]
    except (ValueError, LookupError):
        return None


def judge(mutant, image, simulator):
    """None if the mutant was caught, else what happened instead."""
    done = output_of(simulator, "run", "--image", image, "--json", *mutant.run, check=False)
    text = done.stdout + done.stderr
    if mutant.expected:
        return None if done.returncode and mutant.expected in text else text
    wanted = drive_hash(output_of(simulator, "run", "--typed", "--json", *mutant.run, check=False).stdout)
    if wanted is None:
        raise RuntimeError("the simulator itself gives no drive_hash")
    return None if drive_hash(done.stdout) != wanted else text


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("root", type=lambda text: Path(text).resolve())
    parser.add_argument("build", type=lambda text: Path(text).resolve())
    parser.add_argument("simulator", type=lambda text: Path(text).resolve())
    parser.add_argument("--only", metavar="TEXT", default="", help="mutants whose name contains TEXT")
    options = parser.parse_args()
    survivors = 0
    chosen = [mutant for mutant in MUTANTS if options.only in mutant.name]
    for mutant in chosen:
        with tempfile.TemporaryDirectory() as folder:
            image = build_mutant(mutant, options.root, options.build, Path(folder))
            survived = judge(mutant, image, options.simulator)
        print(f"{'SURVIVED' if survived else 'caught':9} {mutant.name}", flush=True)
        if survived:
            survivors += 1
            print(survived)
    print(f"{len(chosen) - survivors} of {len(chosen)} caught")
    return 1 if survivors or not chosen else 0


if __name__ == "__main__":
    sys.exit(main())
