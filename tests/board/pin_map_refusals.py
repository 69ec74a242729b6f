#!/usr/bin/env python3
"""What the compiler must refuse of a pin map of the STM32G474, and of a motor on it, and with which
text.

usage: pin_map_refusals.py COMPILER ROOT CMSIS   exit 1 and one line for each that passes, or is
                                                 refused with another text
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

PORT = Path("hal/stm32g474")
GATES, INTEGRATED = "nucleo_g474re", "nucleo_g474re_drv8412"
FLAGS = "-mcpu=cortex-m4 -mthumb -mfpu=fpv4-sp-d16 -mfloat-abi=softfp -std=c11 -fsyntax-only".split()

# pin map, name of a definition (or text), what it becomes, in the compiler's words
REFUSED = [
    (GATES, "CRYSTAL_Hz", "25000000", "a whole multiple of 4 MHz"),
    (GATES, "PIN(C, 5, ALTERNATE", "PIN(C, 3, ALTERNATE", "names a pin twice"),
    (GATES, "PIN(A, 1, ANALOG, 0, NONE", "PIN(A, 1, ANALOG, 0, UP", "must not be pulled"),
    (GATES, "BRIDGE", "3", "BRIDGE_OF_GATES or BRIDGE_INTEGRATED"),
    (GATES, "BRIDGE", "BRIDGE_INTEGRATED", "needs BRIDGE_RESET_PORT"),
    (INTEGRATED, "BRIDGE", "BRIDGE_OF_GATES", "needs a dead time"),
    (GATES, "CHANNEL_A_PLUS", "1\n#define LOW_GATES_ACTIVE_LOW 2", "must be 0 or 1"),
    (INTEGRATED, "CHANNEL_A_PLUS", "1\n#define HIGH_GATES_ACTIVE_LOW 1", "has no gates"),
    (INTEGRATED, "DEAD_TIME_CYCLES", "170", "has its own dead time"),
    (INTEGRATED, "BRIDGE_RESET_PIN", "16", "must be 0...15"),
    (GATES, "DEAD_TIME_CYCLES", "0", "needs a dead time"),
    (GATES, "DEAD_TIME_CYCLES", "171", "TIM1 cannot count"),
    (GATES, "CHANNEL_B_PLUS", "1", "each once"),
    (GATES, "AMPLIFIER_A", "2", "sees OPAMP1 alone"),
    (GATES, "AMPLIFIER_B", "3", "OPAMP3 on 18"),
    (GATES, "AMPLIFIER_B_INPUT", "3", "VINP0...VINP2"),
    (GATES, "AMPLIFIER_GAIN", "10", "must be 2, 4, 8, 16, 32 or 64"),
    (GATES, "CURRENT_ZERO_CODE", "4096", "must be 1...4095"),
    (GATES, "BUS_CHANNEL", "13", "two channels"),
    (GATES, "TEMPERATURE_CHANNEL", "19", "are 1...18"),
    (GATES, "COMPARATOR(4, 0)", "", "on the shunt of every leg"),
    (GATES, "COMPARATOR(4, 0)", "COMPARATOR(1, 0)", "names a comparator twice"),
    (GATES, "COMPARATOR(4, 0)", "COMPARATOR(8, 0)", "COMPARATOR(1...7, input 0 or 1)"),
    (GATES, "OVERCURRENT_mA", "100000", "beyond what the comparators"),
    (GATES, "LEGS_B_CONVERTER", "3", "must be two of 3, 4 and 5"),
    (GATES, "LEG_B_MINUS_CHANNEL", "3", "need two channels"),
    (GATES, "#define BRAKE_PIN  6", "", "a brake needs BRAKE_PORT and BRAKE_PIN"),
    (GATES, "#define HAS_BRAKE  1", "", "HAS_BRAKE must be 1, or 0"),
    (GATES, "BRAKE_PIN", "16", "BRAKE_PIN must be 0...15"),
    (GATES, "MACHINE_INPUTS_PIN", "12", "the first of five"),
    (GATES, "MACHINE_OUTPUTS_PIN", "14", "of three"),
    (GATES, "#define MACHINE_INPUTS_PIN   8", "", "the machine needs"),
    (GATES, "ENCODER_TIMER", "3", "must be 4, 5 or 8"),
    (GATES, "ENCODER_INDEX_CHANNEL", "2", "must be 3 or 4, of ENCODER_TIMER"),
    (GATES, "BAUD", "300", "must be 9600...3000000"),
    (GATES, "CAN_BIT_Hz", "800000", "CAN_BIT_Hz must be 125000"),
]

# what becomes of the pin map's definition, and the motor it is then too small for
MOTORS = [
    ("BUS_V_PER_CODE", "(31.2 / 4096.0)", "bendjedia-2012", ""),
    ("BUS_V_PER_CODE", "(31.2 / 4096.0)", "bendjedia-2012-48V", "1.29 x supply_V = 48.0"),
    ("BUS_V_PER_CODE", "(62.4 / 4096.0)", "bendjedia-2012-48V", ""),
    ("CURRENT_A_PER_CODE", "(7.52 / 4096.0)", "bendjedia-2012", ""),
    ("CURRENT_A_PER_CODE", "(7.50 / 4096.0)", "bendjedia-2012", "rated_current_A = 3.0"),
]


def words(compiler, root, cmsis, pin_map, sources=("pin_map_check.c", "pins.c")):
    """What the compiler says of a pin map; "" if nothing."""
    device, faults = (f'"{PORT}/{name}.h"' for name in ("device", "faults"))
    command = [compiler, *FLAGS, f"-I{root}", f"-isystem{cmsis}"]
    command += [f"-DSTEADYSTEP_DEVICE={device}", f"-DSTEADYSTEP_FAULTS={faults}"]
    command += [f'-DSTEADYSTEP_PIN_MAP="{pin_map}"', "-DENCODER_COUNTS_PER_TURN=0u"]
    command.append("-DSTEADYSTEP_CONTROL_PERIOD_us=100")
    # The pin map's own file is not the only one that may not compile.
    found = [
        subprocess.run(
            [*command, str(root / PORT / name)], capture_output=True, text=True, check=False
        )
        for name in sources
    ]
    return "".join(one.stderr for one in found if one.returncode)


def changed(text, name, value):
    if re.fullmatch(r"\w+", name):
        return re.subn(rf"(?m)^(#define {name}) +\S+$", rf"\1 {value}", text)
    return text.replace(name, value, 1), text.count(name)


def motors(compiler, root, cmsis, scratch):
    """Yields a line for each motor that is not judged as expected."""
    source = (root / PORT / "pin_maps" / f"{GATES}.h").read_text(encoding="utf-8")
    trial, image = scratch / "trial.h", scratch / "image.c"
    for name, value, motor, expected in MOTORS:
        text, count = re.subn(rf"(?m)^(#define {name}) +\(.*\)$", rf"\1 {value}", source)
        trial.write_text(text, encoding="utf-8")
        said = {"root": root, "motor": root / f"sil/motors/{motor}.toml", "version": "0", "board": "stm32g474"}
        said |= {"pin-map": trial, "numeric": "float", "flags": ""}
        words_of = [word for key, what in said.items() for word in (f"--{key}", str(what))]
        subprocess.run([sys.executable, root / "tools/board_image.py", *words_of, image], check=True)
        said = words(compiler, root, cmsis, trial, [image])
        refused = f"STEADYSTEP_MOTOR {motor}: " in said
        if count != 1 or refused != bool(expected) or expected not in said or (said and not refused):
            yield f"{motor}, {name} {value}: expected '{expected}'\n{said or 'compiles'}"


def main(arguments):
    if len(arguments) != 3:
        sys.exit(__doc__)
    compiler, root, cmsis = arguments[0], Path(arguments[1]).resolve(), arguments[2]
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        trial = Path(scratch) / "trial.h"
        for name in (GATES, INTEGRATED):
            if said := words(compiler, root, cmsis, root / PORT / "pin_maps" / f"{name}.h"):
                print(f"{name}: refused\n{said}")
                wrong += 1
        for pin_map, name, value, expected in REFUSED:
            text = (root / PORT / "pin_maps" / f"{pin_map}.h").read_text(encoding="utf-8")
            text, count = changed(text, name, value)
            trial.write_text(text, encoding="utf-8")
            said = words(compiler, root, cmsis, trial)
            if count != 1 or "pin map: " not in said or expected not in said:
                print(f"{pin_map}: {name} -> {value}: expected '{expected}'\n{said or 'compiles'}")
                wrong += 1
        for line in motors(compiler, root, cmsis, Path(scratch)):
            print(line)
            wrong += 1
    cases = len(REFUSED) + len(MOTORS) + 2
    print(f"{cases - wrong} of {cases} as expected")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
