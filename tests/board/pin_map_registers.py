#!/usr/bin/python3
"""Runs an image from its reset to the start of the PWM timer, then its control interrupt once with
given duties, and compares what it has written to the STM32G474's registers with its pin map.

usage: pin_map_registers.py IMAGE.elf PIN_MAP              exit 1 and one line for each difference
       pin_map_registers.py --self-test IMAGE.elf PIN_MAP  changes what is expected, entry by
                                                           entry, and expects each to be found

For any pin map, whatever is wired: registers are plain memory here, and what the start waits for
comes at once. The virtual board models them, for the reference wiring.
"""

import copy
import re
import struct
import sys
from pathlib import Path

import unicorn
from unicorn import arm_const

HERE = Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parents[1] / "tools"))

from arm_image import memory  # noqa: E402
from arm_image.image import Image  # noqa: E402
from pin_map import PinMap  # noqa: E402

CORE_HZ = 170e6
PEAK = 8500
DUTIES = {"A_PLUS": 1001, "A_MINUS": 2002, "B_PLUS": 3003, "B_MINUS": 4004}
MEMORY = [(0x08000000, 0x80000), (0x10000000, 0x8000), (0x20000000, 0x20000)]
REGISTERS = [(0x40000000, 0x30000), (0x48000000, 0x2000), (0x50000000, 0x2000)]
CORE = [(0xE0000000, 0x100000)]
INSTRUCTIONS = 200_000_000
RCC, FLASH = 0x40021000, 0x40022000
ADC = {n: 0x50000000 + at for n, at in enumerate((0x000, 0x100, 0x400, 0x500, 0x600), start=1)}
ADC12_CSR = 0x50000300
DAC = {3: 0x50001000, 4: 0x50001400}
TIMER = {1: 0x40012C00, 4: 0x40000800, 5: 0x40000C00, 8: 0x40013400}
DMAMUX, LPUART, FDCAN = 0x40020800, 0x40008000, 0x40006C00
CAN_PRESCALER = 5
MODES = {"INPUT": 0, "OUTPUT": 1, "ALTERNATE": 2, "ANALOG": 3}
PULLS = {"NONE": 0, "UP": 1, "DOWN": 2}


class Chip:
    def __init__(self, elf):
        self.core = unicorn.Uc(unicorn.UC_ARCH_ARM, unicorn.UC_MODE_THUMB)
        self.core.ctl_set_cpu_model(arm_const.UC_CPU_ARM_CORTEX_M4)
        for start, size in MEMORY + REGISTERS + CORE:
            self.core.mem_map(start, size)
        self.image = image = Image(elf)
        self.core.mem_write(0x08000000, b"\xff" * 0x80000)
        for address, data in memory.loaded(elf):
            self.core.mem_write(address, bytes(data))
        self.put(FLASH + 0x20, 1 << 22)  # OPTR: two banks
        for start, size in REGISTERS:
            self.core.hook_add(
                unicorn.UC_HOOK_MEM_READ, self.before_read, begin=start, end=start + size - 1
            )
        stack, reset = self.get(0x08000000), self.get(0x08000004)
        self.core.reg_write(arm_const.UC_ARM_REG_SP, stack)
        self.run(reset, image.symbols["pwm_start"])
        self.control_interrupt()

    def run(self, start, stop):
        self.core.emu_start(start | 1, stop & ~1, count=INSTRUCTIONS)
        if self.core.reg_read(arm_const.UC_ARM_REG_PC) & ~1 != stop & ~1:
            sys.exit(f"{start:#x}: does not reach {stop:#x} within {INSTRUCTIONS} instructions")

    def control_interrupt(self):
        """At the peak, all converted; the application, left out, answers with the duties DUTIES."""

        def application(core, address, size, data):
            outputs = core.reg_read(arm_const.UC_ARM_REG_R0)  # the application: it is left out
            core.mem_write(outputs, struct.pack("<4H?", *DUTIES.values(), False))
            core.reg_write(arm_const.UC_ARM_REG_PC, core.reg_read(arm_const.UC_ARM_REG_LR))

        at = self.image.symbols["application_control_interrupt"] & ~1
        self.core.hook_add(unicorn.UC_HOOK_CODE, application, begin=at, end=at)
        self.put(TIMER[1], self.get(TIMER[1]) | 1 << 4)  # CR1: counts down
        self.put(TIMER[1] + 0x24, PEAK)
        self.put(ADC[1] + 0x84, 0xFFF)  # JDR2: the bus, as high as can be
        back = 0x08000000  # where no code is
        self.core.reg_write(arm_const.UC_ARM_REG_LR, back | 1)
        self.run(self.image.symbols["control_interrupt"], back)

    def get(self, address):
        return struct.unpack("<I", self.core.mem_read(address, 4))[0]

    def put(self, address, value):
        self.core.mem_write(address, struct.pack("<I", value))

    def before_read(self, core, access, address, size, value, data):
        """What hardware answers when it is ready."""
        now = self.get(address & ~3)
        if address == RCC:  # CR: crystal and PLL are ready when on
            now |= (now & (1 << 16 | 1 << 24)) << 1
        elif address == RCC + 0x08:  # CFGR: SWS follows SW
            now = now & ~0xC | (now & 3) << 2
        elif address in [base + 0x08 for base in ADC.values()]:  # CR: calibrated
            now &= 0x7FFFFFFF
        elif address in ADC.values():  # ISR: ready
            now |= 1
        elif address == ADC12_CSR:  # injected sequences of both done
            now |= 1 << 5 | 1 << 21
        elif address in [base + 0x34 for base in DAC.values()]:  # SR: ready
            now |= 1 << 11 | 1 << 27
        self.put(address & ~3, now)


def field(value, position, width):
    return value >> position & (1 << width) - 1


def dead_time_cycles(code):
    """Of TIM1's DTG (RM0440)."""
    if code < 0x80:
        return code
    if code < 0xC0:
        return 2 * (64 + (code & 0x3F))
    return (8 if code < 0xE0 else 16) * (32 + (code & 0x1F))


def expected_pins(chosen):
    for pin, mode, function, pull, *_ in chosen.pins:
        port, number = 0x48000000 + 0x400 * (ord(pin[1]) - ord("A")), int(pin[2:])
        yield f"{pin} MODER", port, 2 * number, 2, MODES[mode]
        yield f"{pin} PUPDR", port + 0x0C, 2 * number, 2, PULLS[pull]
        if mode == "ALTERNATE":
            yield f"{pin} AFR", port + 0x20 + 4 * (number // 8), 4 * (number % 8), 4, int(function)


def expected_currents(chosen):
    for phase, adc, slow in (("A", 1, "BUS"), ("B", 2, "TEMPERATURE")):
        amplifier = chosen.number(f"AMPLIFIER_{phase}")
        if amplifier:
            csr, name = 0x40010300 + 4 * (amplifier - 1), f"OPAMP{amplifier}"
            yield f"{name} enabled, to the converter alone", csr, 0, 1, 1
            yield f"{name} OPAINTOEN", csr, 8, 1, 1
            yield f"{name} VP_SEL", csr, 2, 2, chosen.number(f"AMPLIFIER_{phase}_INPUT")
            gain = chosen.number("AMPLIFIER_GAIN").bit_length() - 2
            yield f"{name} PGA_GAIN", csr, 14, 5, gain
        jsqr = ADC[adc] + 0x4C
        yield f"ADC{adc} JSQ1", jsqr, 9, 5, chosen.number(f"CURRENT_{phase}_CHANNEL")
        yield f"ADC{adc} JSQ2", jsqr, 15, 5, chosen.number(f"{slow}_CHANNEL")


def expected_legs(chosen):
    for channel, phase in enumerate("AB"):
        number = chosen.number(f"LEGS_{phase}_CONVERTER")
        sqr1 = ADC[number] + 0x30
        yield f"ADC{number} SQ1", sqr1, 6, 5, chosen.number(f"LEG_{phase}_PLUS_CHANNEL")
        yield f"ADC{number} SQ2", sqr1, 12, 5, chosen.number(f"LEG_{phase}_MINUS_CHANNEL")
        yield f"DMA of phase {phase}", DMAMUX + 4 * channel, 0, 8, 34 + number  # RM0440: ADC3 37


def expected_trip(chosen):
    used = dict(chosen.comparators)
    for number in range(1, 8):
        csr, name = 0x40010200 + 4 * (number - 1), f"COMP{number}"
        on = number in used
        yield f"{name} enabled", csr, 0, 1, int(on)
        yield f"{name} on TIM1's break", TIMER[1] + 0x60, number, 1, int(on)
        if on:
            yield f"{name} locked", csr, 31, 1, 1
            yield f"{name} INPSEL", csr, 8, 1, used[number]
            millivolt = (
                chosen.number("COMPARATOR_uV")
                + chosen.number("COMPARATOR_uV_PER_A") * chosen.number("OVERCURRENT_mA") / 1000
            ) / 1000
            channel = 2 if number in (2, 4, 6) else 1
            at = DAC[3 if number <= 4 else 4] + (0x08 if channel == 1 else 0x14)
            yield f"threshold of {name}", at, 0, 12, round(millivolt / 3300 * 4096)
    yield "BKIN on TIM1's break", TIMER[1] + 0x60, 0, 1, int(chosen.integrated())


def expected_rest(chosen):
    low_sides = 0 if chosen.integrated() else 1
    inverted = [
        chosen.number(name) if name in chosen.defined else 0
        for name in ("HIGH_GATES_ACTIVE_LOW", "LOW_GATES_ACTIVE_LOW")
    ]
    for n in range(4):
        yield f"TIM1 CC{n + 1}P", TIMER[1] + 0x20, 4 * n + 1, 1, inverted[0]
        yield f"TIM1 CC{n + 1}NP", TIMER[1] + 0x20, 4 * n + 3, 1, inverted[1]
        yield f"TIM1 OIS{n + 1}", TIMER[1] + 0x04, 8 + 2 * n, 1, inverted[0]
        yield f"TIM1 OIS{n + 1}N", TIMER[1] + 0x04, 9 + 2 * n, 1, inverted[1]
        yield f"TIM1 CC{n + 1}E", TIMER[1] + 0x20, 4 * n, 1, 1
        yield f"TIM1 CC{n + 1}NE", TIMER[1] + 0x20, 4 * n + 2, 1, low_sides
    yield "TIM1 MOE", TIMER[1] + 0x44, 15, 1, 0
    yield "TIM1 BKE", TIMER[1] + 0x44, 12, 1, 1
    for leg, duty in DUTIES.items():
        compare = TIMER[1] + 0x30 + 4 * chosen.number(f"CHANNEL_{leg}")
        yield f"compare of leg {leg}", compare, 0, 16, duty
    if chosen.number("HAS_BRAKE"):  # the bus is high, so it is switched on
        port = 0x48000000 + 0x400 * (ord(chosen["BRAKE_PORT"][-1]) - ord("A"))
        yield "BSRR of the brake", port + 0x18, chosen.number("BRAKE_PIN"), 1, 1
    timer = chosen.number("ENCODER_TIMER")
    if timer:
        yield f"TIM{timer} counts an encoder", TIMER[timer] + 0x08, 0, 3, 3
        yield f"TIM{timer} runs", TIMER[timer], 0, 1, 1
    index = int(chosen.defined.get("ENCODER_INDEX_CHANNEL", "0"))
    if index:
        mode = TIMER[timer] + 0x1C
        yield f"TIM{timer} CC{index}S: its pin", mode, 8 * (index - 3), 2, 1
        yield f"TIM{timer} IC{index}F", mode, 8 * (index - 3) + 4, 4, 3
    yield "LPUART1 BRR", LPUART + 0x0C, 0, 20, round(256 * CORE_HZ / chosen.number("BAUD"))
    can = int(chosen.defined.get("CAN_BIT_Hz", "0"))
    yield "FDCANEN", RCC + 0x58, 25, 1, int(can > 0)
    if can:
        quanta = round(CORE_HZ / CAN_PRESCALER / can)
        behind = -(-quanta // 8)  # the sample point is as late as can be up to 87.5 %
        yield "FDCANSEL: PCLK1", RCC + 0x88, 24, 2, 2
        yield "NBRP", FDCAN + 0x1C, 16, 9, CAN_PRESCALER - 1
        yield "NTSEG1", FDCAN + 0x1C, 8, 8, quanta - 1 - behind - 1
        yield "NTSEG2", FDCAN + 0x1C, 0, 7, behind - 1
        yield "NSJW", FDCAN + 0x1C, 25, 7, behind - 1
        yield "CCCR: on the bus", FDCAN + 0x18, 0, 16, 0
    crystal = chosen.number("CRYSTAL_Hz")
    yield "PLLSRC", RCC + 0x0C, 0, 2, 3 if crystal else 2
    yield "PLLM", RCC + 0x0C, 4, 4, (crystal or 16000000) // 4000000 - 1


def differences(chip, chosen):
    for part in (expected_pins, expected_currents, expected_legs, expected_trip, expected_rest):
        for name, address, position, width, expected in part(chosen):
            found = field(chip.get(address), position, width)
            if found != expected:
                yield f"{name}: {found}, expected {expected}"
    cycles = dead_time_cycles(field(chip.get(TIMER[1] + 0x44), 0, 8))
    if cycles != chosen.number("DEAD_TIME_CYCLES"):
        yield f"TIM1 dead time: {cycles} cycles, expected {chosen['DEAD_TIME_CYCLES']}"


def changes(chosen):
    """(what, pin map) that this image is not made for."""
    for name in (
        *("CRYSTAL_Hz", "DEAD_TIME_CYCLES", "AMPLIFIER_A_INPUT", "AMPLIFIER_B_INPUT"),
        *("AMPLIFIER_GAIN", "CURRENT_A_CHANNEL", "CURRENT_B_CHANNEL", "BUS_CHANNEL"),
        *("LEGS_A_CONVERTER", "LEG_A_PLUS_CHANNEL", "LEG_B_MINUS_CHANNEL", "BAUD", "CAN_BIT_Hz"),
        *("TEMPERATURE_CHANNEL", "OVERCURRENT_mA", "CHANNEL_A_PLUS", "CHANNEL_B_MINUS"),
        *("LOW_GATES_ACTIVE_LOW", "BRAKE_PIN"),
    ):
        if name in chosen.defined:
            other = copy.deepcopy(chosen)
            now = chosen.number(name)
            other.defined[name] = {
                "CRYSTAL_Hz": "8000000",
                "LEGS_A_CONVERTER": str(5 if now == 3 else 3),
                "CHANNEL_B_MINUS": str(now % 4 + 1),
            }.get(name, str(2 * now or 1))
            yield name, other
    for at, (number, given) in enumerate(chosen.comparators):
        other = copy.deepcopy(chosen)
        other.comparators[at] = number, 1 - given
        yield f"COMPARATOR({number}, {given})", other
    for at, (pin, mode, function, *rest) in enumerate(chosen.pins):
        other = copy.deepcopy(chosen)
        changed = str(int(function) ^ 1) if mode == "ALTERNATE" else function
        mode = {"ALTERNATE": "ALTERNATE", "INPUT": "ANALOG"}.get(mode, "INPUT")
        other.pins[at] = (pin, mode, changed, *rest)
        yield pin, other


def main(arguments):
    testing = arguments[:1] == ["--self-test"]
    if len(arguments) != 2 + testing or any(re.match("-", a) for a in arguments[testing:]):
        sys.exit(__doc__)
    elf, path = map(Path, arguments[testing:])
    chip, chosen = Chip(elf), PinMap(path)
    found = list(differences(chip, chosen))
    for text in found:
        print(text)
    print(f"{path.name}: {len(found)} differences")
    if not testing:
        return 1 if found else 0
    missed = [what for what, other in changes(chosen) if not list(differences(chip, other))]
    print(
        f"{len(list(changes(chosen))) - len(missed)} of {len(list(changes(chosen)))} changes found"
    )
    for what in missed:
        print(f"WRONG: {what} changed, and not found")
    return 1 if found or missed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
