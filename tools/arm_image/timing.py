"""
Published instruction timings, zero-wait memory.

Cortex-M4: Arm Cortex-M4 Technical Reference Manual (100166), 3.3.1 instruction set, 3.3.3
load/store timings, 7.2.3 FPU instruction set; the same text in TI SWCU192, 3.9.
Cortex-M0+: Arm Cortex-M0+ Technical Reference Manual (DDI 0484C), table 3-1, with the
single-cycle multiplier (as on the STM32G0) and no single-cycle I/O port.

An instruction in an IT block is charged whether its condition holds or not. Interrupt entry and
exit are no instructions: EXCEPTION.
"""

import re


class CortexM4:
    name = "m4f"
    clock_Hz = 170e6
    # A taken branch refills the pipeline in P = 1...3 cycles, by alignment and width of the target.
    refill = {"nominal": 2, "pessimistic": 3}

    @staticmethod
    def cycles(instruction, before, column):
        """`before`: the instruction executed right before in a straight line, or None.
        Column `pessimistic` gives no credit for pipelined loads and charges every fetch hazard."""
        pessimistic = column == "pessimistic"
        base, operands = instruction.base, instruction.operands
        cost = _m4_base(instruction)
        if is_load_store(instruction) and before is not None:
            if _pipelines(before, instruction) and not pessimistic:
                cost -= 1
            elif _is_data_processing(before) and _destination(before) in _address_registers(
                instruction
            ):
                cost += 1  # no forwarding path from the ALU to an address
        if (
            before is not None
            and _is_fp_arithmetic(before)
            and _reads(instruction, _destination(before))
        ):
            cost += 1  # the result of FP arithmetic is consumed by the following instruction
        if pessimistic:
            if loads_literal(instruction):
                cost += 1  # contention of a literal load with the fetch unit
            if instruction.size == 4 and instruction.address & 3:
                cost += 1  # unaligned fetch of a wide instruction
        return cost


class CortexM0plus:
    name = "m0plus"
    clock_Hz = 64e6
    refill = {"nominal": 1, "pessimistic": 1}  # B 2 taken, 1 not taken

    @staticmethod
    def cycles(instruction, before, column):
        base, operands = instruction.base, instruction.operands
        count = len(instruction.register_list)
        if base in ("pop", "ldm", "ldmia") and "pc" in instruction.register_list:
            return 3 + count - CortexM0plus.refill[column]  # POP with return: 3 + N in all
        if base in ("push", "pop", "ldm", "ldmia", "stm", "stmia"):
            return 1 + count
        if base.startswith("ldr") or base.startswith("str"):
            return 2
        if base == "bl":
            return 2  # 3 with the refill of a taken branch
        if base in ("mrs", "msr", "dsb", "dmb", "isb"):
            return 3
        return 1


def _m4_base(instruction):
    base, operands = instruction.base, instruction.operands
    count = len(instruction.register_list)
    double = bool(re.search(r"\bd\d", operands))
    if base in ("sdiv", "udiv"):
        return 12  # 2...12 by operands
    if base in ("vdiv", "vsqrt"):
        return 14
    if base in ("vmla", "vmls", "vnmla", "vnmls", "vfma", "vfms", "vfnma", "vfnms"):
        return 3
    if base in ("vldr", "vstr"):
        return 3 if double else 2
    if base.startswith(("vldm", "vstm", "vpush", "vpop")):
        return 1 + count * (2 if double else 1)
    if base == "vmov" and operands.count(",") >= 2:
        return 2  # two core registers
    if base in ("push", "pop", "ldm", "ldmia", "ldmdb", "stm", "stmia", "stmdb"):
        return 1 + count
    if base in ("ldrd", "strd"):
        return 3
    if base.startswith("ldr"):
        return 3 if operands.startswith("pc,") else 2  # into PC: 5 in all
    if base.startswith("str"):
        return 2 if re.search(r"\[\w+, [rs]\w+", operands) else 1  # register offset 2
    if base in ("tbb", "tbh"):
        return 4  # 6 in all: load 2, add 1, refill 3
    if base in ("mrs", "msr"):
        return 2
    if base in ("dsb", "dmb", "isb"):
        return 4
    return 1


def is_load_store(instruction):
    return instruction.base.startswith(("ldr", "str", "vldr", "vstr"))


def _pipelines(first, second):
    """LDR [any] followed by LDR or STR: one cycle less for the second, if its address does not
    use what the first loads. LDRD, STRD, LDM, STM and the FPU's loads get no credit."""
    single = lambda i: i.base.startswith(("ldr", "str")) and i.base not in ("ldrd", "strd")
    if not (single(first) and single(second) and first.base.startswith("ldr")):
        return False
    return _m4_base(second) == 2 and first.registers[0] not in _address_registers(second)


def _address_registers(instruction):
    match = re.search(r"\[(.*?)\]", instruction.operands)
    return re.findall(r"\b(?:r\d+|sp|lr|sb|sl|fp|ip)\b", match.group(1)) if match else []


def _is_fp_arithmetic(instruction):
    return instruction.base.startswith(
        (
            "vadd",
            "vsub",
            "vmul",
            "vnmul",
            "vdiv",
            "vsqrt",
            "vmla",
            "vmls",
            "vnmla",
            "vnmls",
            "vfma",
            "vfms",
            "vfnm",
            "vcvt",
        )
    )


def _is_data_processing(instruction):
    base = instruction.base
    return not (
        instruction.is_branch
        or is_load_store(instruction)
        or base.startswith(
            (
                "cmp",
                "cmn",
                "tst",
                "teq",
                "v",
                "it",
                "push",
                "pop",
                "ldm",
                "stm",
                "nop",
                "mrs",
                "msr",
            )
        )
    )


def _destination(instruction):
    return instruction.registers[0] if instruction.registers else None


def _reads(instruction, register):
    """Does an instruction read an FPU register? All operands but a pure destination are read."""
    registers = instruction.registers
    if register is None or register not in registers:
        return False
    base = instruction.base
    first_is_source = base.startswith(
        ("vstr", "vstm", "vpush", "vcmp", "vmla", "vmls", "vnml", "vfm", "vfnm")
    )
    return register in (registers if first_is_source else registers[1:])


def loads_literal(instruction):
    return instruction.base in ("ldr", "vldr", "ldrd") and "[pc" in instruction.operands


# Cycles to enter and to leave an interrupt, and for either of them more with the frame of the FPU.
# Columns nominal, worst in CCM (a bus that is busy), worst in flash (vector and first line from
# there).
EXCEPTION = {
    "m4f": {"enter": [12, 14, 22], "leave": [12, 14, 22], "fpu": [17, 17, 17]},
    "m0plus": {"enter": [15, 17, 25], "leave": [15, 17, 25], "fpu": [0, 0, 0]},
}

# An access to a peripheral takes this much more than one to memory: the bridges between the buses.
# Assumed, not measured on silicon.
PERIPHERAL = [2, 5, 5]

# Flash without credit for prefetch and caches: wait states for each line of 64 bits. STM32G4 at
# 170 MHz (RM0440, embedded flash memory, read access latency), STM32G0 at 64 MHz (RM0444, the same).
FLASH = {"m4f": {"wait": 4, "line_bytes": 8}, "m0plus": {"wait": 2, "line_bytes": 8}}


CORES = {core.name: core for core in (CortexM4, CortexM0plus)}
