#!/usr/bin/env python3
"""Compares the register headers of hal/stm32g071 with independent descriptions of chip and core.

usage: check_registers_g071.py CC ROOT               exit 1 and one line for each difference
       check_registers_g071.py --self-test CC ROOT   plants errors, and expects each to be found

The comparison is that of check_registers.py; here are the names of this chip, and its DMA requests
and ADC trigger.
"""

import re
import sys
from pathlib import Path

import check_registers as check

PORT = Path("hal/stm32g071")
check.PORT = PORT
check.FAMILIES = {
    "TIM": ["TIM1", "TIM2", "TIM3"],
    "GPIO": ["GPIOA", "GPIOB", "GPIOC"],
    "ADC": ["ADC1"],
    "DMA": ["DMA1"],
    "DMAMUX": ["DMAMUX1"],
    "LPUART": ["LPUART1"],
}
check.REGISTERS = {
    "CCMR": "ccmr_output[0]",
    "CCR": {"DMAMUX": "ccr[0]"},
    "CR": {"DMA": "ch[0].cr"},
}


def members():
    """Names in the structs -> names in the description."""
    tim = {f"ccr{n}": f"ccr[{n - 1}]" for n in (1, 2, 3, 4)}
    tim |= {f"ccmr{n}": f"ccmr_output[{n - 1}]" for n in (1, 2)}
    channels = {
        f"channel[{n}].{register}": f"ch[{n}].{register}"
        for n in range(7)
        for register in ("cr", "ndtr", "par", "mar")
    }
    ports = {"afrl": "afr[0]", "afrh": "afr[1]"}
    return {
        **{f"TIM{n}": {**tim, "or1": "or"} for n in (1, 2, 3)},
        "DMA1": channels,
        **{f"GPIO{port}": ports for port in "ABC"},
    }


check.MEMBERS = members()

# Where the description is silent or another name is used: RM0444.
EXPECTED_ODD = {
    # GPIOx_BRR, offset 0x28, is not described.
    "struct gpio_registers: brr is not in the description",
    # SR has BSY1, the description calls it BSY.
    "FLASH_SR_BSY1: no such field in the description",
}


def check_pins(root, facts):
    text = check.without_comments((root / PORT / "pins.h").read_text(encoding="utf-8"))
    entries = re.findall(
        r"PIN\((\w), (\d+), (\w+), (\d+), (\w+), (\w+), (\w+)\)", text.replace("\\\n", "")
    )
    if len(entries) != 17:
        yield f"{len(entries)} pins found, expected 17"
    at = {}
    for port, number, mode, function, _, peripheral, signal in entries:
        pin = f"P{port}{number}"
        if pin in at.values():
            yield f"{pin} has two uses"
        at[peripheral, signal] = pin
        expected = function if mode == "ALTERNATE" else "-"
        if mode != "OUTPUT" and (peripheral, pin, signal, expected) not in facts.pins:
            yield f"{pin}: no {peripheral} {signal} with function {expected} there"
    for name, channel in re.findall(r"CHANNEL_(\w+) = (\d+)", text):
        if ("ADC1", f"IN{channel}") not in at:
            yield f"CHANNEL_{name}: no pin leads to ADC1 IN{channel}"
        if int(channel) > 14:
            yield f"CHANNEL_{name}: the sequencer knows channels 0...14 only"


def check_numbers(root, file):
    """DMA requests and the converter's trigger."""
    text = (root / PORT / "registers.h").read_text(encoding="utf-8")
    requests, triggers = {}, {}
    for line in file.read_text(encoding="utf-8").splitlines():
        word = line.split()
        if word[:1] == ["DMA"]:
            name = word[1] if word[1] == word[2] else f"{word[1]}_{word[2]}"
            requests[name] = int(word[3])
        elif word[:1] == ["TRIG"]:
            triggers[word[3]] = int(re.search(r"\d+$", word[2]).group())
    found = re.findall(r"DMA_REQUEST_(\w+) = (\d+)", text)
    found_triggers = re.findall(r"ADC_TRIGGER_(\w+) = (\d+)", text)
    if len(found) != 3 or len(found_triggers) != 1:
        yield "DMA requests or the converter's trigger not found"
    for name, number in found:
        if requests.get(name) != int(number):
            yield f"DMA_REQUEST_{name}: {number}, expected {requests.get(name)}"
    for name, number in found_triggers:
        if triggers.get(name) != int(number):
            yield f"ADC_TRIGGER_{name}: {number}, expected {triggers.get(name)}"


def check_memory(root, facts):
    script = check.without_comments((root / PORT / "memory.ld").read_text(encoding="utf-8"))
    store = 8 * 1024  # behind the program
    for name, memory, kept in (("FLASH", "BANK_1", store), ("RAM", "SRAM", 0)):
        pattern = rf"{name}\s+\(\w+\)\s*: ORIGIN = (0x\w+), LENGTH = (\d+)K"
        origin, length = re.search(pattern, script).groups()
        start, size = facts.memories[memory]
        if int(origin, 16) != start or int(length) * 1024 + kept != size:
            yield f"memory.ld: {name} is {origin}, {length}K; the chip has {start:#x}, {size} bytes"


def differences(cc, root):
    file = check.HERE / "stm32g071-registers.txt"
    chip, core = check.Facts(file), check.Facts(check.HERE / "cortex-m0plus-registers.txt")
    odd = set()
    for text in check.check_header(cc, root, PORT / "registers.h", chip):
        if text in EXPECTED_ODD:
            odd.add(text)
        else:
            yield text
    yield from (f"expected, but did not come: {text}" for text in EXPECTED_ODD - odd)
    yield from check.check_header(cc, root, PORT / "core.h", core)
    yield from check.check_interrupts(root, chip)
    yield from check_pins(root, chip)
    yield from check_numbers(root, file)
    yield from check.check_clocks(root, chip)
    yield from check_memory(root, chip)


check.differences = differences
check.PLANTED = [
    ("registers.h", "0x40012c00u", "0x40012d00u"),
    ("registers.h", "TIM_BDTR_MOE BIT(15)", "TIM_BDTR_MOE BIT(14)"),
    (
        "registers.h",
        "RCC_CFGR_SWS(value) FIELD(value, 3, 3)",
        "RCC_CFGR_SWS(value) FIELD(value, 2, 2)",
    ),
    (
        "registers.h",
        "ADC_CFGR1_EXTSEL(value) FIELD(value, 6, 3)",
        "ADC_CFGR1_EXTSEL(value) FIELD(value, 5, 3)",
    ),
    ("registers.h", "INTERRUPT_TIM2 = 15", "INTERRUPT_TIM2 = 16"),
    ("registers.h", "DMA_REQUEST_LPUART1_RX = 14", "DMA_REQUEST_LPUART1_RX = 34"),
    ("registers.h", "ADC_TRIGGER_TIM3_TRGO = 3", "ADC_TRIGGER_TIM3_TRGO = 4"),
    ("registers.h", "kr, pr, rlr", "kr, rlr, pr"),
    ("registers.h", "#define RCC_APBENR2_ADCEN BIT(20)", ""),
    ("core.h", "icsr, vtor, aircr", "vtor, icsr, aircr"),
    ("core.h", "reserved3[95]", "reserved3[94]"),
    ("pins.h", "PIN(C, 8, ALTERNATE, 2,", "PIN(C, 8, ALTERNATE, 6,"),
    ("pins.h", "CHANNEL_BUS = 10", "CHANNEL_BUS = 12"),
    ("memory.ld", "LENGTH = 120K", "LENGTH = 128K"),
]

if __name__ == "__main__":
    sys.exit(check.main(sys.argv[1:]))
