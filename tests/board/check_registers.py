#!/usr/bin/env python3
"""Compares registers and pin maps of hal/stm32g474 with an independent description of the chip.

usage: check_registers.py CC ROOT CMSIS PIN_MAP...  exit 1 and one line for each difference
       check_registers.py --self-test CC ROOT CMSIS PIN_MAP...
                                                    plants errors, and expects each to be found

Every address, offset, bit position, width, interrupt number, pin and alternate function that the
headers name is looked up; what is not in the description, or not in the form that registers.h
promises, is a difference. Offsets and masks are what the compiler makes of the headers. CMSIS: the
folder of CMSIS-Core's headers, which answer for the core's own registers.
"""

import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from pin_map import PinMap, without_comments

HERE = Path(__file__).resolve().parent
PORT = Path("hal/stm32g474")

# Families of peripherals: prefix of the field macros -> peripherals that share the registers.
FAMILIES = {
    "TIM": ["TIM1", "TIM2", "TIM3", "TIM4", "TIM5", "TIM8"],
    "GPIO": ["GPIOA", "GPIOB", "GPIOC"],
    "ADC": [*(f"ADC{n}" for n in range(1, 6)), "ADC12_COMMON", "ADC345_COMMON"],
    "OPAMP": ["OPAMP1", "OPAMP2", "OPAMP3"],
    "COMP": [f"COMP{n}" for n in range(1, 8)],
    "DAC": ["DAC3", "DAC4"],
    "DMA": ["DMA1"],
    "DMAMUX": ["DMAMUX1"],
    "LPUART": ["LPUART1"],
    "FDCAN": ["FDCAN3"],
}
# Registers whose name in the macros or structs is not the one of the description.
REGISTERS = {
    "CCMR": "ccmr_output[0]",
    "CCR": {"DMAMUX": "ccr[0]"},
    "CR": {"DMA": "ch[0].cr"},
    "RXF0S": "rxfs[0]",
}
DAC = {
    **{f"dhr{n}{k}": f"dhr{n}[{k - 1}]" for n in ("12r", "12l", "8r") for k in (1, 2)},
    **{f"dor{k}": f"dor[{k - 1}]" for k in (1, 2)},
}
FDCAN = {f"rxf{n}{k}": f"rxf{k}[{n}]" for n in (0, 1) for k in "sa"}
MEMBERS = {"DAC3": DAC, "DAC4": DAC, "FDCAN3": FDCAN}
# Where the description is wrong: RM0440 and the vendor's own header have PWR_CR5.R1MODE in bit 8.
CORRECTIONS = {("PWR", "cr5", "r1mode"): (8, 1)}
# In capture mode CCMR1 has other fields.
CAPTURE = {"IC1F", "IC2F"}

FORM = re.compile(
    r"#define (?:"
    r"(?P<flag>[A-Z0-9_]+)\s+BIT\(\d+\)|"
    r"(?P<field>[A-Z0-9_]+)\((?P<parameters>[a-z, ]+)\)\s+FIELD\(.*\)|"
    r"(?P<peripheral>[A-Z0-9_]+)\s+\(\(struct (?P<struct>\w+) \*\)0x(?P<address>[0-9a-f]+)u\)|"
    r"FLASH_(?:BANK_1|BANK_BYTES|PAGE_BYTES)\s+\w+|"
    r"(?:BIT|FIELD)\(.*|STEADYSTEP_\w+_H"
    r")(?:\s*/\*.*)?"
)


class Facts:
    def __init__(self, *files):
        self.registers, self.fields, self.clocks = {}, {}, {}
        self.interrupts, self.pins, self.memories = {}, set(), {}
        for file in files:
            for line in file.read_text(encoding="utf-8").splitlines():
                word = line.split()
                if not word or word[0] == "#":
                    continue
                kind = word.pop(0)
                if kind == "REG":
                    self.registers[word[0], word[1]] = int(word[2], 16)
                elif kind == "FIELD":
                    self.fields.setdefault((word[0], word[1]), []).append(word[2:])
                elif kind == "IRQ":
                    self.interrupts[word[0]] = int(word[1])
                elif kind == "PIN":
                    self.pins.add(tuple(word))
                elif kind == "MEM":
                    self.memories[word[0]] = (int(word[1], 16), int(word[2]))
                elif kind == "CLKEN":
                    self.clocks[word[0]] = (word[1].lower(), word[2].lower())

    def masks(self, peripheral, register, name):
        """Masks that a field may have: of an array the element that the digit in its name counts;
        of one in parts the first part."""
        if (peripheral, register, name) in CORRECTIONS:
            low, count = CORRECTIONS[peripheral, register, name]
            return {(1 << count) - 1 << low}
        found = set()
        index = int(re.sub(r"\D", "", name) or 1) - 1
        if register == "ccmr3":
            index -= 4  # of channels 5 and 6
        plain = re.sub(r"\d", "", name)
        for field, position, width, *array in self.fields.get((peripheral, register), []):
            if field not in (name, plain) or (field == plain != name and not array):
                continue
            first, _, last = position.split(",")[0].partition("..")
            low, count = int(first), int(last) - int(first) + 1 if last else int(width)
            if array:
                if index >= int(array[0][1:]):
                    continue
                low += index * int(array[1][1:])
            found.add((1 << count) - 1 << low)
        return found


def structs(text):
    """{struct: [member expression]} in words or bytes; of arrays the first and the last element."""
    found = {}
    for name, body in re.findall(r"^struct (\w+) \{\n(.*?)^\};", text, re.DOTALL | re.MULTILINE):
        members = []
        inner = re.search(r"struct \w+ \{(.*?)\} (\w+)\[(\d+)\];", body, re.DOTALL)
        if inner:
            body = body.replace(inner.group(), "")
        for declaration in re.findall(r"volatile uint(?:32|8)_t ([^;]*);", body):
            members += declaration.replace("\n", " ").split(",")
        if inner:
            plain = re.findall(r"volatile uint32_t ([^;]*);", inner.group(1))
            inside = [m for part in plain for m in part.split(",")]
            last = int(inner.group(3)) - 1
            members += [f"{inner.group(2)}[{k}].{m.strip()}" for k in (0, last) for m in inside]
        found[name] = [
            element
            for member in (m.strip() for m in members)
            if "reserved" not in member
            for element in elements(member)
        ]
    return found


def elements(member):
    array = re.fullmatch(r"(\w+)\[(\d+)\]", member)
    if not array:
        return [member]
    return [f"{array.group(1)}[{k}]" for k in (0, int(array.group(2)) - 1)]


def compiled(cc, root, cmsis, header, expressions):
    """Values of C expressions, with the header included."""
    lines = "".join(f'    printf("%llx\\n", (unsigned long long)({e}));\n' for e in expressions)
    text = (
        f'#include <stddef.h>\n#include <stdio.h>\n#include "{header}"\n'
        f"int main(void)\n{{\n{lines}    return 0;\n}}\n"
    )
    with tempfile.TemporaryDirectory() as scratch:
        source, program = Path(scratch) / "values.c", Path(scratch) / "values"
        source.write_text(text, encoding="utf-8")
        made = [cc, "-w", "-std=gnu11", f"-I{root}", f"-I{cmsis}", str(source), "-o", str(program)]
        subprocess.run(made, check=True)
        output = subprocess.run([program], check=True, capture_output=True, text=True).stdout
    return [int(line, 16) for line in output.split()]


def register_of(prefix, macro, registers):
    """(peripherals, register, field) that TIM_CR2_MMS stands for."""
    peripherals = FAMILIES.get(prefix, [prefix])
    rest = macro[len(prefix) + 1 :]
    for end in [m.start() for m in re.finditer("_", rest)]:
        short, field = rest[:end], rest[end + 1 :]
        alias = REGISTERS.get(short, short.lower())
        if isinstance(alias, dict):
            alias = alias.get(prefix, short.lower())
        if field in CAPTURE:
            alias = "ccmr_input[0]"
        if any((p, alias) in registers for p in peripherals):
            yield peripherals, alias, field.lower()


def check_fields(facts, masks):
    for macro, mask in masks.items():
        prefixes = [*FAMILIES, "RCC", "PWR", "FLASH", "SYSCFG", "IWDG", "DBGMCU"]
        prefix = next((p for p in prefixes if macro.startswith(p + "_")), "")
        places = list(register_of(prefix, macro, facts.registers))
        known = [
            allowed
            for peripherals, register, field in places
            for p in peripherals
            if (allowed := facts.masks(p, register, field))
        ]
        if not known:
            yield f"{macro}: no such field in the description"
        elif not any(mask in allowed for allowed in known):
            expected = sorted(hex(m) for allowed in known for m in allowed)
            yield f"{macro}: {mask:#x}, expected {' or '.join(dict.fromkeys(expected))}"


def check_header(cc, root, cmsis, facts):
    """Form, addresses and fields of the register header."""
    header = PORT / "registers.h"
    text = without_comments((root / header).read_text(encoding="utf-8"))
    lines = text.replace("\\\n", " ").splitlines()
    forms = [(line, FORM.fullmatch(line.rstrip())) for line in lines if line.startswith("#define")]
    yield from (f"not in the promised form: {line}" for line, form in forms if not form)
    forms = [form for _, form in forms if form]
    members = structs(text)

    expressions, meanings = [], []
    for form in forms:
        if form["peripheral"]:
            for member in members.get(form["struct"], []):
                expressions.append(
                    f"0x{form['address']}u + offsetof(struct {form['struct']}, {member})"
                )
                meanings.append((form["peripheral"], member))
        elif form["flag"]:
            expressions.append(form["flag"])
            meanings.append(form["flag"])
        elif form["field"]:
            count = form["parameters"].count(",") + 1
            one = form["parameters"] == "channel"
            arguments = "0" if one else ", ".join(["0"] * (count - 1) + ["~0u"])
            expressions.append(f"{form['field']}({arguments})")
            meanings.append(form["field"])

    masks, seen = {}, set()
    for meaning, value in zip(meanings, compiled(cc, root, cmsis, header.as_posix(), expressions)):
        if isinstance(meaning, str):
            masks[meaning] = value
            continue
        peripheral, member = meaning
        register = MEMBERS.get(peripheral, {}).get(member, member)
        expected = facts.registers.get((peripheral, register))
        if expected is None:
            continue  # the struct serves larger relatives of this peripheral; see below
        seen.add((peripheral, member))
        if value != expected:
            yield f"{peripheral}->{member}: {value:#x}, expected {expected:#x}"
    for form in forms:
        if form["peripheral"] and not any(p == form["peripheral"] for p, _ in seen):
            yield f"{form['peripheral']}: not in the description"
    for name, expected in members.items():
        owners = [form["peripheral"] for form in forms if form["struct"] == name]
        for member in expected:
            if owners and not any((p, member) in seen for p in owners):
                yield f"struct {name}: {member} is not in the description"
    yield from check_fields(facts, masks)


def check_interrupts(root, facts):
    text = without_comments((root / PORT / "device.h").read_text(encoding="utf-8"))
    lines = dict(re.findall(r"\b(\w+)_IRQn = (\d+)", text))
    if not lines:
        yield "no interrupt lines found"
    for name, number in lines.items():
        if facts.interrupts.get(name) != int(number):
            yield f"{name}_IRQn: {number}, expected {facts.interrupts.get(name)}"
    total = re.search(r"INTERRUPTS = (\d+)", text)
    if not total or int(total.group(1)) != max(facts.interrupts.values()) + 1:
        yield f"INTERRUPTS: expected {max(facts.interrupts.values()) + 1}"


def check_pin_map(path, facts):
    chosen = PinMap(path)
    yield from chosen.differences(facts)
    legs_a, legs_b = chosen["LEGS_A_CONVERTER"], chosen["LEGS_B_CONVERTER"]
    converters = {
        "BUS_CHANNEL": "ADC1",
        "TEMPERATURE_CHANNEL": "ADC2",
        "LEG_A_PLUS_CHANNEL": f"ADC{legs_a}",
        "LEG_A_MINUS_CHANNEL": f"ADC{legs_a}",
        "LEG_B_PLUS_CHANNEL": f"ADC{legs_b}",
        "LEG_B_MINUS_CHANNEL": f"ADC{legs_b}",
    }
    for phase, converter in (("A", "ADC1"), ("B", "ADC2")):
        amplifier = chosen.number(f"AMPLIFIER_{phase}")
        if amplifier == 0:
            converters[f"CURRENT_{phase}_CHANNEL"] = converter
            continue
        signal = f"VINP{chosen[f'AMPLIFIER_{phase}_INPUT']}"
        if (f"OPAMP{amplifier}", signal) not in chosen.at:
            yield f"AMPLIFIER_{phase}: no pin leads to OPAMP{amplifier} {signal}"
    yield from chosen.channels_without_pin(converters)
    analog = {pin for pin, mode, *_ in chosen.pins if mode == "ANALOG"}
    for number, given in chosen.comparators:
        seen = {pin for pin in analog if (f"COMP{number}", pin, f"INP{given}", "-") in facts.pins}
        if not seen:
            yield f"COMPARATOR({number}, {given}): no analog pin leads to COMP{number} INP{given}"
    timer = chosen["ENCODER_TIMER"]
    index = chosen.defined.get("ENCODER_INDEX_CHANNEL", "0")
    signals = ["CH1", "CH2"] if timer != "0" else []
    for signal in signals + ([f"CH{index}"] if index != "0" else []):
        if (f"TIM{timer}", signal) not in chosen.at:
            yield f"ENCODER_TIMER: no pin leads to TIM{timer} {signal}"
    if chosen.integrated() and ("TIM1", "BKIN") not in chosen.at:
        yield "BRIDGE_INTEGRATED: no pin leads to TIM1 BKIN"


def check_clocks(root, facts):
    """Every peripheral that the port has registers of can be switched on."""
    text = (root / PORT / "registers.h").read_text(encoding="utf-8")
    for peripheral in re.findall(r"#define (\w+) +\(\(struct", text):
        if peripheral in facts.clocks:
            register, bit = facts.clocks[peripheral]
            if f"RCC_{register.upper()}_{bit.upper()} " not in text:
                yield f"{peripheral}: RCC_{register.upper()}_{bit.upper()} is missing"


def check_memory(root, facts):
    script = without_comments((root / PORT / "memory.ld").read_text(encoding="utf-8"))
    regions = re.findall(r"(\w+)\s+\(\w+\)\s*: ORIGIN = (0x\w+), LENGTH = (\d+)(K?)", script)
    regions = sorted(
        (int(origin, 16), int(length) * (1024 if kilo else 1), name)
        for name, origin, length, kilo in regions
    )
    first = {"FLASH": "BANK_1", "CCM": "CCMRAM_ICODE", "RAM": "SRAM1"}
    end = max(start + size for start, size in facts.memories.values() if start >= 0x20000000)
    for (start, size, name), (following, _, other) in zip(regions, regions[1:] + [(end, 0, "the end")]):
        begin, room = facts.memories[first[name]] if name in first else (start, end - start)
        if start != begin or size > room:
            yield f"memory.ld: {name} is {start:#x}, {size} bytes; the chip has {begin:#x}, {room}"
        if start + size > following:
            yield f"memory.ld: {name} reaches over the beginning of {other}"
    dma, (start, size) = next(one for one in regions if one[2] == "SRAM2"), facts.memories["SRAM2"]
    if not start <= dma[0] <= dma[0] + dma[1] <= start + size:
        yield f"memory.ld: SRAM2 is not in SRAM2, which begins at {start:#x}"


def differences(cc, root, cmsis, pin_maps):
    chip = Facts(HERE / "stm32g474-registers.txt")
    yield from check_header(cc, root, cmsis, chip)
    yield from check_interrupts(root, chip)
    for path in pin_maps:
        yield from (f"{path.name}: {text}" for text in check_pin_map(path, chip))
    yield from check_clocks(root, chip)
    yield from check_memory(root, chip)


PIN_MAP = "pin_maps/nucleo_g474re.h"

# file, what is there, what is planted instead
PLANTED = [
    ("registers.h", "0x40012c00u", "0x40012d00u"),
    ("registers.h", "TIM_BDTR_MOE BIT(15)", "TIM_BDTR_MOE BIT(14)"),
    (
        "registers.h",
        "TIM_CR2_MMS2(value) FIELD(value, 20, 4)",
        "TIM_CR2_MMS2(value) FIELD(value, 20, 3)",
    ),
    (
        "registers.h",
        "TIM_CR2_MMS(value) FIELD(value, 4, 3)",
        "TIM_CR2_MMS(value) FIELD(value, 5, 3)",
    ),
    ("registers.h", "TIM_AF1_BKCMP3E BIT(3)", "TIM_AF1_BKCMP3E BIT(4)"),
    (
        "registers.h",
        "ADC_JSQR_JSQ2(value) FIELD(value, 15, 5)",
        "ADC_JSQR_JSQ2(value) FIELD(value, 14, 5)",
    ),
    ("registers.h", "TIM_CCMR_OC2PE BIT(11)", "TIM_CCMR_OC2PE BIT(10)"),
    ("registers.h", "DAC_SR_DAC2RDY BIT(27)", "DAC_SR_DAC2RDY BIT(12)"),
    ("device.h", "TIM1_UP_TIM16_IRQn = 25", "TIM1_UP_TIM16_IRQn = 26"),
    ("registers.h", "bdtr, ccr5", "ccr5, bdtr"),
    ("registers.h", "kr, pr, rlr", "kr, rlr, pr"),
    ("registers.h", "#define PWR_SR2_VOSF BIT(10)", "#define PWR_SR2_VOSF (1u << 10)"),
    ("registers.h", "#define RCC_AHB2ENR_DAC3EN BIT(18)", ""),
    ("registers.h", "0x40006c00u", "0x40006800u"),
    ("registers.h", "NTSEG1(value) FIELD(value, 8, 8)", "NTSEG1(value) FIELD(value, 8, 7)"),
    ("registers.h", "FDCAN_TXFQS_TFQF BIT(21)", "FDCAN_TXFQS_TFQF BIT(20)"),
    ("registers.h", "txbc, txfqs", "txfqs, txbc"),
    ("device.h", "FDCAN3_IT0_IRQn = 88", "FDCAN3_IT0_IRQn = 89"),
    ("registers.h", "0x50000600u", "0x50000700u"),
    (PIN_MAP, "PIN(B, 15, ALTERNATE, 4,", "PIN(B, 15, ALTERNATE, 6,"),
    (PIN_MAP, "PIN(A, 15, ALTERNATE, 11,", "PIN(A, 15, ALTERNATE, 9,"),
    (PIN_MAP, "PIN(B, 3, ALTERNATE, 11, UP, FDCAN3, RX)", ""),
    (PIN_MAP, "PIN(A, 7, ANALOG, 0, NONE, OPAMP2", "PIN(A, 6, ANALOG, 0, NONE, OPAMP2"),
    (PIN_MAP, "PIN(C, 5, ALTERNATE, 6, DOWN, TIM1, CH4N)", ""),
    (PIN_MAP, "#define AMPLIFIER_B_INPUT 0", "#define AMPLIFIER_B_INPUT 1"),
    (PIN_MAP, "COMPARATOR(3, 0)", "COMPARATOR(3, 1)"),
    (PIN_MAP, "#define LEGS_A_CONVERTER 3", "#define LEGS_A_CONVERTER 5"),
    (PIN_MAP, "#define BUS_CHANNEL 14", "#define BUS_CHANNEL 13"),
    (PIN_MAP, "#define ENCODER_TIMER 4", "#define ENCODER_TIMER 8"),
    (PIN_MAP, "#define ENCODER_INDEX_CHANNEL 4", "#define ENCODER_INDEX_CHANNEL 3"),
    (PIN_MAP, "PIN(B, 9, ALTERNATE, 2, UP, TIM4, CH4)", "PIN(B, 9, ALTERNATE, 3, UP, TIM4, CH4)"),
    (PIN_MAP, "#define LED_PIN 5", "#define LED_PIN 6"),
    ("memory.ld", "ORIGIN = 0x10000000", "ORIGIN = 0x10001000"),
    ("memory.ld", "ORIGIN = 0x20016340, LENGTH = 7360", "ORIGIN = 0x20016340, LENGTH = 8K"),
    ("memory.ld", "ORIGIN = 0x20016340", "ORIGIN = 0x20011C00"),
    ("memory.ld", "ORIGIN = 0x2000FF00, LENGTH = 25664", "ORIGIN = 0x2000FF00, LENGTH = 26K"),
]


def self_test(cc, root, cmsis, pin_maps):
    """Pin maps are those of the port, in the copy."""
    wrong = 0
    with tempfile.TemporaryDirectory() as scratch:
        copy = Path(scratch)
        (copy / "hal").mkdir()
        shutil.copytree(root / PORT, copy / PORT)
        pin_maps = sorted((copy / PORT / "pin_maps").iterdir())
        if found := list(differences(cc, copy, cmsis, pin_maps)):
            print("WRONG: nothing is planted, and found:", found)
            return 1
        for name, there, planted in PLANTED:
            path = copy / PORT / name
            text = path.read_text(encoding="utf-8")
            pattern = r"\s+".join(re.escape(part) for part in there.split())
            changed, count = re.subn(pattern, lambda _, new=planted: new, text, count=1)
            path.write_text(changed, encoding="utf-8")
            try:
                found = list(differences(cc, copy, cmsis, pin_maps)) if count else []
            except subprocess.CalledProcessError:
                found = ["does not compile"]
            path.write_text(text, encoding="utf-8")
            wrong += not found
            print(f"{'ok' if found else 'WRONG':6} {there} -> {planted or 'nothing'}: {found[:1]}")
    return 1 if wrong else 0


def main(arguments):
    testing = arguments[:1] == ["--self-test"]
    arguments = arguments[testing:]
    if len(arguments) < 4:
        sys.exit(__doc__)
    given = arguments[0], *map(Path, arguments[1:3]), [Path(text) for text in arguments[3:]]
    if testing:
        return self_test(*given)
    found = list(differences(*given))
    for text in found:
        print(text)
    print(f"{len(found)} differences")
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
