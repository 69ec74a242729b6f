"""An ARM Thumb ELF image, decoded once: instructions, functions, data words."""

import bisect
import re
from dataclasses import dataclass, field
from functools import cached_property

from capstone import CS_ARCH_ARM, CS_MODE_MCLASS, CS_MODE_THUMB, Cs
from elftools.elf.elffile import ELFFile

SHF_WRITE, SHF_ALLOC, SHF_EXECINSTR = 1, 2, 4
CONDITIONS = "eq ne cs hs cc lo mi pl vs vc hi ls ge lt gt le".split()
# Mnemonics whose last two letters look like a condition and are none.
UNCONDITIONAL = set("adcs bics lsls mls movs muls sbcs smlals smmls svc teq vmls vnmls".split())


@dataclass(eq=False)
class Instruction:
    address: int
    size: int
    mnemonic: str  # without width suffix and condition, in lower case: "ldr", "vmul.f32"
    condition: str  # "" if none
    operands: str
    registers: list = field(default_factory=list)  # as written, ranges expanded

    @property
    def next(self):
        return self.address + self.size

    @cached_property
    def base(self):
        """Mnemonic without data types."""
        return self.mnemonic.split(".")[0]

    @cached_property
    def register_list(self):
        """Registers between braces, expanded."""
        match = re.search(r"\{(.*)\}", self.operands)
        return expand(match.group(1)) if match else []

    @property
    def is_branch(self):
        """The program may go on elsewhere than at the next instruction."""
        if self.base in ("b", "bl", "bx", "blx", "cbz", "cbnz", "tbb", "tbh"):
            return True
        if self.base in ("pop", "ldm", "ldmia", "ldmdb"):
            return "pc" in self.register_list
        return self.operands.startswith("pc,") and self.base in ("ldr", "mov", "add")

    @property
    def is_call(self):
        return self.base in ("bl", "blx")

    @property
    def target(self):
        """Address of a direct branch, None of an indirect one."""
        match = re.search(r"#(0x[0-9a-f]+|\d+)$", self.operands)
        if self.base in ("b", "bl", "cbz", "cbnz") and match:
            return int(match.group(1), 0)
        return None


def expand(text):
    """'r4-r6, lr' -> [r4, r5, r6, lr]"""
    registers = []
    for part in text.split(","):
        first, _, last = part.strip().partition("-")
        first, last = first.strip(), last.strip()
        if last:
            letter = first[0]
            registers += [f"{letter}{k}" for k in range(int(first[1:]), int(last[1:]) + 1)]
        elif first:
            registers.append(first)
    return registers


def split_condition(mnemonic):
    name = mnemonic.replace(".w", "").replace(".n", "")
    base, dot, types = name.partition(".")
    if base.startswith("it") and re.fullmatch(r"it[te]{0,3}", base):
        return base, ""
    if base not in UNCONDITIONAL and len(base) > 2 and base[-2:] in CONDITIONS:
        return base[:-2] + dot + types, base[-2:]
    return base + dot + types, ""


class Image:
    def __init__(self, path):
        self.path = str(path)
        self._engine = Cs(CS_ARCH_ARM, CS_MODE_THUMB | CS_MODE_MCLASS)
        with open(path, "rb") as file:
            elf = ELFFile(file)
            self.sections = [
                (
                    s.name,
                    s["sh_addr"],
                    s["sh_size"],
                    s["sh_flags"],
                    b"" if s["sh_type"] == "SHT_NOBITS" else s.data(),
                )
                for s in elf.iter_sections()
                if s["sh_flags"] & SHF_ALLOC
            ]
            code = {k for k, s in enumerate(elf.iter_sections()) if s["sh_flags"] & SHF_EXECINSTR}
            symbols = list(elf.get_section_by_name(".symtab").iter_symbols())
        self.symbols = {
            s.name: s["st_value"] for s in symbols if s.name and not s.name.startswith("$")
        }
        functions = {}
        for s in symbols:
            if s["st_info"]["type"] == "STT_FUNC":
                start = s["st_value"] & ~1
                old = functions.get(start)
                if not old or s["st_info"]["bind"] == "STB_GLOBAL":
                    functions[start] = (start, s["st_size"], s.name)
        self.functions = sorted(functions.values())
        self._starts = [f[0] for f in self.functions]
        marks = sorted(
            (s["st_value"], s.name[1])
            for s in symbols
            if s["st_shndx"] in code and re.fullmatch(r"\$[tda](\..*)?", s.name)
        )
        self.called = None  # what call_graph.indirect_targets has found
        self.undecoded = []  # addresses marked as code that hold no instruction
        self.instructions = self._decode(marks)

    def _decode(self, marks):
        instructions = {}
        for _, start, size, flags, data in self.sections:
            if not flags & SHF_EXECINSTR:
                continue
            inside = [m for m in marks if start <= m[0] < start + size]
            for k, (at, kind) in enumerate(inside):
                if kind != "t":
                    continue
                end = inside[k + 1][0] if k + 1 < len(inside) else start + size
                while at < end:
                    instruction = self._decode_one(data[at - start : min(at + 4, end) - start], at)
                    if instruction:
                        instructions[at] = instruction
                    else:
                        self.undecoded.append(at)
                    at += instruction.size if instruction else 2
        return instructions

    def _decode_one(self, code, at):
        found = next(self._engine.disasm_lite(code, at, 1), None)
        if not found:
            return None
        _, length, mnemonic, operands = found
        name, condition = split_condition(mnemonic)
        words = re.findall(r"\b(?:r\d+|s\d+|d\d+|sp|lr|pc|sb|sl|fp|ip)\b", operands)
        return Instruction(at, length, name, condition, operands, words)

    def instruction(self, address):
        """The instruction at an address that is known to be executed; library code written in
        assembly is not always marked as code."""
        if address not in self.instructions:
            code = (self.word(address) or 0).to_bytes(4, "little")
            self.instructions[address] = self._decode_one(code, address)
        return self.instructions[address]

    def function_at(self, address):
        """(start, size, name) of the function that holds an address."""
        k = bisect.bisect_right(self._starts, address) - 1
        if k < 0:
            return (address, 0, "?")
        return self.functions[k]

    def function_from(self, address):
        """(start, size, name) of the function from an address on. Library code in assembly is
        entered in the middle, too, and goes on behind the end that its symbol says."""
        start, size, name = self.function_at(address)
        if start == address:
            return start, size, name
        if address not in self.instructions:
            raise ValueError(f"{self.path}: {address:#x} is called, but no function begins there")
        k = bisect.bisect_right(self._starts, address)
        end = self._starts[k] if k < len(self._starts) else address + 2
        end = min(end, start + size) if address < start + size else end
        return address, end - address, f"{name}+{address - start:#x}"

    def name_at(self, address):
        """Name of the symbol at exactly this address."""
        return next(
            (name for name, value in self.symbols.items() if value & ~1 == address), hex(address)
        )

    def body(self, function):
        start, size, _ = function
        return [
            self.instructions[a] for a in range(start, start + size, 2) if a in self.instructions
        ]

    def bytes(self, address, count):
        """What the image holds from an address on, None if it holds less than that."""
        for _, start, _, _, data in self.sections:
            if start <= address and address + count <= start + len(data):
                return data[address - start : address - start + count]
        return None

    def numeric(self):
        """Number format, as a board's image itself says, behind version, sources, board and pin map
        (tools/board_image.py)."""
        start, text = self.symbols["image_version"], b""
        while not text.endswith(b"\0"):
            text += self.bytes(start + len(text), 1)
        return text.split()[5].decode()

    def word(self, address):
        data = self.bytes(address, 4)
        return None if data is None else int.from_bytes(data, "little")
