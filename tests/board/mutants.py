#!/usr/bin/env python3
"""Mutants of the board port: each is a mistake in a register or in the order of things that no unit
test could see. The virtual board must catch each, for its own reason: by what it refuses, by a
drive_hash that is not the simulator's, or by an expectation of stm32g474_disturbances that is not
held.

usage: mutants.py ROOT BUILD SIMULATOR DISTURBANCES [--only TEXT] [--one-of PARTS]

BUILD: folder of the preset board-stm32g474, with steadystep.elf built. A mutant recompiles the
sources of the port that read what was changed, and links them to the firmware as it is.
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

TOOLS = Path(__file__).resolve().parents[2] / "tools"
PORT = ("hal/stm32g474", "hal/cortex_m")
# What is run: a shorted leg; an interrupt held up; motion; `store` in motion.
SHORT_CIRCUIT = ["board-overcurrent"]
OVERRUN = ["board-overrun"]
MOVE = ["board-short-stall"]
STORE = ["board-busy-line"]


@dataclass
class Mutant:
    name: str
    file: str  # of the port, its name
    text: str
    instead: str
    run: list | str  # of the simulator: scenario and options; str: case of the disturbances
    expected: str  # in the failure of the run, or what is not held; "" another drive_hash
    numeric: str = ""  # the number format it is a mistake in; "" any


MUTANTS = [
    Mutant(
        "the converters are triggered in the high state",
        "pwm.c",
        "TIM1->ccr5 = PWM_HALF_PERIOD - CURRENT_SAMPLING_LEAD;",
        "TIM1->ccr5 = 1;",
        MOVE,
        "the current is sampled before the peak",
    ),
    Mutant(
        "the phases are swapped",
        "pwm.h",
        "    TIM1->ccr[CHANNEL_A_PLUS - 1] = high_counts[HAL_LEG_A_PLUS];\n"
        "    TIM1->ccr[CHANNEL_A_MINUS - 1] = high_counts[HAL_LEG_A_MINUS];\n"
        "    TIM1->ccr[CHANNEL_B_PLUS - 1] = high_counts[HAL_LEG_B_PLUS];\n"
        "    TIM1->ccr[CHANNEL_B_MINUS - 1] = high_counts[HAL_LEG_B_MINUS];\n",
        "    TIM1->ccr[CHANNEL_A_PLUS - 1] = high_counts[HAL_LEG_B_PLUS];\n"
        "    TIM1->ccr[CHANNEL_A_MINUS - 1] = high_counts[HAL_LEG_B_MINUS];\n"
        "    TIM1->ccr[CHANNEL_B_PLUS - 1] = high_counts[HAL_LEG_A_PLUS];\n"
        "    TIM1->ccr[CHANNEL_B_MINUS - 1] = high_counts[HAL_LEG_A_MINUS];\n",
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
        "phase_voltage_sampling.h",
        "    done += left_a > LEG_SUMS ? LEG_GROUPS : 0;\n",
        "    done += left_a > LEG_SUMS ? 0 : LEG_GROUPS;\n",
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
        "TIM_BDTR_DTG(PWM_DEAD_TIME_CODE)",
        "TIM_BDTR_DTG(0)",
        MOVE,
        "dead time",
    ),
    Mutant(
        "the registers of the FPU are not saved",
        "startup.c",
        "    SCB->CPACR |= ",
        "    *(volatile uint32_t *)0xe000ef34u = 0; /* FPCCR: no automatic state preservation */\n"
        "    SCB->CPACR |= ",
        MOVE,
        "FPCCR",
        numeric="float",
    ),
    Mutant(
        "the watchdog is not fed",
        "board_hal.c",
        "    port_watchdog_feed();",
        "",
        MOVE,
        "watchdog",
    ),
    Mutant(
        "the vector table is misplaced",
        "startup.c",
        "SCB->VTOR = (uint32_t)&vectors;",
        "SCB->VTOR = (uint32_t)&vectors + 64;",
        MOVE,
        "VTOR",
    ),
    Mutant(
        "the store is erased in the program's bank",
        "parameter_flash.c",
        "FLASH_CR_PER | FLASH_CR_BKER | ",
        "FLASH_CR_PER | ",
        STORE,
        "the flash outside of the parameter store",
    ),
    Mutant(
        "the running program keeps the debugger out",
        "clock.c",
        "FLASH_ACR_DBG_SWEN | ",
        "",
        MOVE,
        "DBG_SWEN cleared",
    ),
    Mutant(
        "a halt leaves the bridge closed",
        "pwm.c",
        "    DBGMCU->apb2fzr |= DBGMCU_APB2FZR_TIM1;\n",
        "",
        "halt",
        "opens the bridge",
    ),
    Mutant(
        "a halt puts the leg voltages out of step",
        "pwm.c",
        "    DBGMCU->apb1lfzr |= DBGMCU_APB1LFZR_TIM3;\n",
        "",
        "halt",
        "all conversions are in step",
    ),
    Mutant(
        "leg voltages out of step go unseen",
        "phase_voltage_sampling.c",
        "return in_half + 2u - expected <= 4u;",
        "return in_half + expected + 2u > 0u;",
        "conversions-lost",
        "conversions out of step with the period open the bridge",
    ),
    Mutant(
        "the break flags are looked at once",
        "pwm.h",
        "        if (pwm_break_latched()) {\n            pwm_open_bridge();\n        }\n",
        "",
        "break-while-closing",
        "a trip while the bridge closes opens it within 1 us",
    ),
    Mutant(
        "a fault of the core leaves the bridge closed",
        "crash.c",
        '                     "blx r3\\n"\n',
        "",
        "program-leaves-memory",
        "behind a jump to nowhere the program opens the bridge",
    ),
    Mutant(
        "a reset clears the crash record",
        "crash.c",
        '} record __attribute__((section(".no_init")));',
        "} record;",
        "starts-fail-for-ever",
        "behind three starts that failed the board stays off and says why",
    ),
    Mutant(
        "the rest of a line that has lost its beginning is obeyed",
        "serial_line.c",
        "receive.behind = receive.bytes[(receive.stored - 1u) % RECEIVE_BYTES] != '\\n';",
        "receive.behind = false;",
        "lines-overflow",
        "a line that has lost its beginning is not obeyed",
    ),
    Mutant(
        "only LF makes room in the buffer",
        "serial_line.c",
        "if ((int32_t)(receive.read - receive.stored) > 0) {",
        "if (false) {",
        "line-ends",
        "nothing is lost of lines that CR alone ends",
    ),
    Mutant(
        "what a loss of power has spoilt is a crash",
        "parameter_flash.c",
        "if ((eccr & FLASH_ECCR_ECCD) == 0 || (eccr & FLASH_ECCR_BK_ECC) == 0) {",
        "if (eccr != 1u) {",
        "supply-fails-in-store",
        "and the drive starts",
    ),
    Mutant(
        "a cell that has been corrected hides a torn one",
        "parameter_flash.c",
        "if (FLASH->eccr & FLASH_ECCR_ECCC) {",
        "if (false) {",
        "supply-fails-beside-weak-cell",
        "and the drive starts",
    ),
    Mutant(
        "the supply's monitor does not reach the PWM timer",
        "pwm.c",
        " | SYSCFG_CFGR2_PVDL",
        "",
        "chip-supply-sags",
        "one of 2.85 V opens the bridge without the program",
    ),
    Mutant(
        "the brake resistor is switched the wrong way round",
        "control_interrupt.c",
        "on ? BIT(BRAKE_PIN) : BIT(BRAKE_PIN + 16)",
        "on ? BIT(BRAKE_PIN + 16) : BIT(BRAKE_PIN)",
        "bus-is-braked",
        "the brake is off below 1.25 of the supply",
    ),
    Mutant(
        "the CAN bus is clocked by the crystal",
        "fdcan.c",
        " | RCC_CCIPR_FDCANSEL(RCC_FDCAN_PCLK1)",
        "",
        "can-registers",
        "kernel clock",
    ),
    Mutant(
        "frames for others are received",
        "fdcan.c",
        "FDCAN_RXGFC_ANFS(FDCAN_REJECT)",
        "FDCAN_RXGFC_ANFS(0)",
        "can-registers",
        "what no filter names, remote and extended frames are rejected",
    ),
    Mutant(
        "frames wait for the background",
        "fdcan.c",
        "    FDCAN3->ile = FDCAN_ILE_EINT0;\n",
        "",
        "can-overrun",
        "the chip itself loses none",
    ),
    Mutant(
        "bus-off is for ever",
        "fdcan.c",
        "        FDCAN3->cccr = FDCAN_CCCR_INIT | FDCAN_CCCR_CCE;\n        FDCAN3->cccr = 0;\n",
        "",
        "can-bus-off",
        "once in a second it tries to come back",
    ),
    Mutant(
        "what was to be sent before bus-off is sent behind it",
        "fdcan.c",
        "        transmit.sent = transmit.written;\n        FDCAN3->cccr = FDCAN_CCCR_INIT | FDCAN_CCCR_CCE;\n",
        "",
        "can-bus-off",
        "then it says that it is back, first",
    ),
    Mutant(
        "what is to be sent while the bus is off is sent behind it",
        "fdcan.c",
        "if (!off && room(context) > 0u)",
        "if (room(context) > 0u)",
        "can-bus-off",
        "then it says that it is back, first",
    ),
    Mutant(
        "the index captures nothing",
        "encoder.c",
        "ENCODER->ccer = edge | INDEX_ON;",
        "ENCODER->ccer = edge;",
        "homing-on-index",
        "homing is attained",
    ),
    Mutant(
        "what the index has captured before counts",
        "encoder.c",
        "    ENCODER->sr = ~(uint32_t)INDEX_CAPTURED;\n",
        "",
        "homing-on-index",
        "on the index",
    ),
    Mutant(
        "a count that the index has captured is not extended",
        "encoder.c",
        "near + (int16_t)(ENCODER->ccr[INDEX] - (uint32_t)near)",
        "(int32_t)ENCODER->ccr[INDEX] + 0 * near",
        "homing-on-index",
        "homing is attained",
    ),
    Mutant(
        "the end of a line is as urgent as the control interrupt",
        "device.h",
        "PRIORITY_LINE = 8,",
        "PRIORITY_LINE = 1,",
        "line-flood",
        "the control interrupt begins as soon as without a flood",
    ),
]


def output_of(*words, check=True, folder=None):
    done = subprocess.run(
        [str(word) for word in words],
        cwd=folder,
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
    """(source, words, folder to run them in) of steadystep.elf; other images share its sources."""
    for one in json.loads((build / "compile_commands.json").read_text(encoding="utf-8")):
        if "/steadystep.dir/" in one["command"]:
            yield Path(one["file"]), shlex.split(one["command"]), Path(one["directory"])


def relink(build, folder, recompiled):
    """Links the image in `folder`, of the build's objects but for those that `recompiled` gives.

    recompiled(source, words): the words of another compilation, without output; None: as it is.
    """
    linked = link_command(build)  # of steadystep.elf alone: other images have the same sources
    needed = {str((build / word).resolve()) for word in linked if word.endswith(".obj")}
    objects = {}
    for source, words, directory in compile_commands(build):
        at = words.index("-o")
        target = str((directory / words[at + 1]).resolve())
        other = recompiled(source, words[:at] + words[at + 2 :]) if target in needed else None
        if other is not None:
            objects[target] = str(folder / f"{len(objects)}.obj")
            output_of(*other, "-o", objects[target], folder=directory)
    image = folder / "steadystep.elf"
    words = [objects.get(str((build / word).resolve()), word) for word in linked]
    words[words.index("-o") + 1] = str(image)
    words = [f"-Wl,-Map={image}.map" if word.startswith("-Wl,-Map=") else word for word in words]
    output_of(*words, folder=build)
    output_of(TOOLS / "pack_image", image)
    return image


def numeric_of(build):
    return json.loads((build / "steadystep.map.json").read_text(encoding="utf-8"))["numeric"]


def port_files(root, pattern="*"):
    """The port's files, relative to the root."""
    return [
        file.relative_to(root)
        for port in PORT
        for file in sorted((root / port).rglob(pattern))
        if file.is_file()
    ]


def reads(changed, source, root):
    """Whether a file of the port is, or includes, the changed one; both relative to the root."""
    if source == changed:
        return True
    if not (root / source).is_file():  # not the port's, or made by the build
        return False
    text = (root / source).read_text(encoding="utf-8")
    included = re.findall(r'#include "([^"]+)"', text)
    return any(reads(changed, Path(name), root) for name in included)


def place_of(mutant, root):
    """The port's file, relative to the root, that has the mutant's text once; and what it says."""
    found = port_files(root, mutant.file)
    text = (root / found[0]).read_text(encoding="utf-8") if len(found) == 1 else ""
    if text.count(mutant.text) != 1:
        raise RuntimeError(f"{mutant.name}: {mutant.file}: not exactly one\n{mutant.text}")
    return found[0], text


def change(mutant, root, folder):
    """Copies the port into `folder` and makes the change there; returns the file changed."""
    for port in PORT:
        if (root / port).is_dir():
            shutil.copytree(root / port, folder / port)
    changed, text = place_of(mutant, folder)
    (folder / changed).write_text(text.replace(mutant.text, mutant.instead), encoding="utf-8")
    return changed


def build_mutant(mutant, root, build, folder):
    """Returns the image of a mutant, linked in `folder`."""
    changed = change(mutant, root, folder)

    def recompiled(source, words):
        if root not in source.parents or not reads(changed, source.relative_to(root), folder):
            return None
        inside = str(folder / source.relative_to(root))
        words = [inside if Path(word) == source else word for word in words]
        return [words[0], f"-I{folder}", *words[1:]]

    try:
        return relink(build, folder, recompiled)
    except RuntimeError as error:
        raise RuntimeError(f"{mutant.name}: {error}") from None


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


def judge_case(mutant, image, disturbances):
    """The same of a case of the disturbances."""
    done = output_of(disturbances, image, mutant.run, check=False)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{mutant.name}: {done.stdout}{done.stderr}")
    failed = [line for line in done.stdout.splitlines() if line.endswith("NOT HELD")]
    happened = "; ".join(" ".join(line.split()) for line in failed) or "all expectations held"
    return any(mutant.expected in line for line in failed), happened


def try_mutant(mutant, options):
    with tempfile.TemporaryDirectory() as folder:
        image = build_mutant(mutant, options.root, options.build, Path(folder))
        if isinstance(mutant.run, str):  # needs no map, which takes longer than the run
            return judge_case(mutant, image, options.disturbances)
        output_of(options.root / "tools" / "image_map", image)
        return judge(mutant, image, options.simulator, options.numeric)


def commits(root):
    """How many commits lead to this one; 0 where that is not known."""
    done = subprocess.run(
        ["git", "-C", str(root), "rev-list", "--count", "HEAD"], capture_output=True, text=True
    )
    return int(done.stdout) if done.returncode == 0 else 0


def main():
    parser = argparse.ArgumentParser(
        description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter
    )
    parser.add_argument("root", type=lambda text: Path(text).resolve())
    parser.add_argument("build", type=lambda text: Path(text).resolve())
    parser.add_argument("simulator", type=lambda text: Path(text).resolve())
    parser.add_argument("disturbances", type=lambda text: Path(text).resolve())
    parser.add_argument("--only", metavar="TEXT", default="", help="mutants whose name has TEXT")
    parser.add_argument(
        "--one-of",
        type=int,
        default=1,
        metavar="PARTS",
        help="one part of them; which, the number of commits says: each in its turn",
    )
    options = parser.parse_args()
    built = (options.build / "steadystep.elf").stat().st_mtime
    newer = [
        file
        for file in port_files(options.root, "*.[ch]")
        if (options.root / file).stat().st_mtime > built
    ]
    if newer:
        sys.exit(f"{newer[0]} is newer than the image: build it first")
    options.numeric = numeric_of(options.build)
    chosen = [
        mutant
        for mutant in MUTANTS
        if options.only in mutant.name and mutant.numeric in ("", options.numeric)
    ]
    for mutant in MUTANTS:  # run or not
        place_of(mutant, options.root)
    chosen = chosen[commits(options.root) % options.one_of :: options.one_of]
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
