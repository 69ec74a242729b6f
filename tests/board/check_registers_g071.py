#!/usr/bin/env python3
"""Compares registers and pin maps of hal/stm32g071 with an independent description of the chip.

usage: check_registers_g071.py [--self-test] CC ROOT CMSIS PIN_MAP...    as check_registers.py

The comparison is that of check_registers.py; here are the names of this chip, and its DMA requests
and ADC trigger.
"""

import re
import sys
from pathlib import Path

import check_registers as check
from pin_map import PinMap, without_comments

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
    # DBG is not described.
    "DBG: not in the description",
    "struct dbg_registers: idcode is not in the description",
    "struct dbg_registers: cr is not in the description",
    "struct dbg_registers: apbfz1 is not in the description",
    "struct dbg_registers: apbfz2 is not in the description",
    "DBG_APBFZ1_TIM3: no such field in the description",
    "DBG_APBFZ1_IWDG: no such field in the description",
    "DBG_APBFZ2_TIM1: no such field in the description",
}


CHANNELS = [
    f"{name}_CHANNEL"
    for name in (
        *("CURRENT_A", "CURRENT_B", "BUS", "TEMPERATURE"),
        *("LEG_A_PLUS", "LEG_A_MINUS", "LEG_B_PLUS", "LEG_B_MINUS"),
    )
]


def check_pin_map(path, facts):
    chosen = PinMap(path)
    yield from chosen.differences(facts)
    yield from chosen.channels_without_pin(dict.fromkeys(CHANNELS, "ADC1"))
    if ("TIM1", "BK") not in chosen.at:
        yield "no pin leads to TIM1 BK"


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
    script = without_comments((root / PORT / "memory.ld").read_text(encoding="utf-8"))
    store = 4 * 1024  # behind the program
    for name, memory, kept in (("FLASH", "BANK_1", store), ("RAM", "SRAM", 0)):
        pattern = rf"{name}\s+\(\w+\)\s*: ORIGIN = (0x\w+), LENGTH = (?:DEFINED\(unpacked\) \? \d+K : )?(\d+)K"
        origin, length = re.search(pattern, script).groups()
        start, size = facts.memories[memory]
        if int(origin, 16) != start or int(length) * 1024 + kept != size:
            yield f"memory.ld: {name} is {origin}, {length}K; the chip has {start:#x}, {size} bytes"


def differences(cc, root, cmsis, pin_maps):
    file = check.HERE / "stm32g071-registers.txt"
    chip = check.Facts(file)
    odd = set()
    for text in check.check_header(cc, root, cmsis, chip):
        if text in EXPECTED_ODD:
            odd.add(text)
        else:
            yield text
    yield from (f"expected, but did not come: {text}" for text in EXPECTED_ODD - odd)
    yield from check.check_interrupts(root, chip)
    for path in pin_maps:
        yield from (f"{path.name}: {text}" for text in check_pin_map(path, chip))
    yield from check_numbers(root, file)
    yield from check.check_clocks(root, chip)
    yield from check_memory(root, chip)


PIN_MAP = "pin_maps/nucleo_g071rb.h"
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
    ("device.h", "TIM2_IRQn = 15", "TIM2_IRQn = 16"),
    ("registers.h", "DMA_REQUEST_LPUART1_RX = 14", "DMA_REQUEST_LPUART1_RX = 34"),
    ("registers.h", "ADC_TRIGGER_TIM3_TRGO = 3", "ADC_TRIGGER_TIM3_TRGO = 4"),
    ("registers.h", "kr, pr, rlr", "kr, rlr, pr"),
    ("registers.h", "#define RCC_APBENR2_ADCEN BIT(20)", ""),
    (PIN_MAP, "PIN(C, 8, ALTERNATE, 2,", "PIN(C, 8, ALTERNATE, 6,"),
    (PIN_MAP, "#define BUS_CHANNEL 10", "#define BUS_CHANNEL 12"),
    (PIN_MAP, "#define BRIDGE_RESET_PIN 13", "#define BRIDGE_RESET_PIN 12"),
    ("memory.ld", ": 124K", ": 128K"),
]

if __name__ == "__main__":
    sys.exit(check.main(sys.argv[1:]))
