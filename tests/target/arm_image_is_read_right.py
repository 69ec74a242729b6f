#!/usr/bin/python3
"""What tools/image_map and tools/longest_path make of small programs whose answer is known by hand.

usage: arm_image_is_read_right.py CC FLAGS...
"""

import importlib.machinery
import importlib.util
import json
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image.image import Image  # noqa: E402
from arm_image.longest_path import Costs, LongestPath  # noqa: E402
from arm_image.variables import Variables  # noqa: E402


def tool(name):
    loader = importlib.machinery.SourceFileLoader(name, str(ROOT / "tools" / name))
    module = importlib.util.module_from_spec(importlib.util.spec_from_loader(name, loader))
    loader.exec_module(module)
    return module


longest_path, image_map = tool("longest_path"), tool("image_map")

ASSEMBLY = (
    "__attribute__((naked, used, aligned(4))) void interrupt(void) {{ __asm__ volatile({}); }}\n"
)


def assembly(*lines):
    return ASSEMBLY.format(" ".join(f'"{line}\\n"' for line in (".syntax unified", *lines)))


# Program, most turns of its loops, cycles in columns nominal and worst_ccm: Cortex-M4F, Cortex-M0+.
COUNTED = {
    # 1, and 1 + 1 with a jump (refill 2, 3; 1) but the last time, and 1 with a jump
    "loop": (assembly("movs r0, #4", "1: subs r0, #1", "bne 1b", "bx lr"), 4, (18, 22), (14, 14)),
    # entered at its test, which so comes once more than its body
    "loop from its test": (
        assembly("b 2f", "1: nop", "2: subs r0, #1", "bne 1b", "bx lr"),
        4,
        (28, 34),
        (22, 22),
    ),
    # entered in two places: a turn that begins in the middle comes before the others
    "loop with two entries": (
        assembly("cbz r0, 2f", "1: nop", "2: subs r0, #1", "bne 1b", "bx lr"),
        4,
        (28, 34),
        None,
    ),
    "loop in a loop": (
        assembly("1: movs r1, #9", "2: subs r1, #1", "bne 2b", "subs r0, #1", "bne 1b", "bx lr"),
        3,
        (46, 55),
        (37, 37),
    ),
    "the longer way": (
        assembly("cmp r0, #0", "beq 1f", "nop", "nop", "nop", "nop", "1: bx lr"),
        1,
        (9, 10),
        (8, 8),
    ),
    "return on a condition": (
        assembly("cmp r0, #0", "it eq", "bxeq lr", "nop", "nop", "nop", "nop", "bx lr"),
        1,
        (10, 11),
        None,
    ),
    "call": (
        "__attribute__((naked, used)) void callee(void) { __asm__ volatile("
        '"nop\\n nop\\n bx lr\\n"); }\n' + assembly("push {r4, lr}", "bl callee", "pop {r4, pc}"),
        1,
        (3 + 3 + 5 + 5, 3 + 5 + 6 + 6),  # BL lies across two words
        (3 + 3 + 4 + 5, 3 + 3 + 4 + 5),
    ),
    "what does not return": (
        assembly("cmp r0, #0", "bne 1f", "bx lr", "1: nop", "nop", "nop", "b 1b"),
        1,
        (1 + 1 + 3, 1 + 1 + 4),
        (1 + 1 + 2, 1 + 1 + 2),
    ),
}

# Program, what the refusal must say.
REFUSED = {
    "loop without a bound": (
        "void interrupt(volatile int *p)\n{\n    for (int i = 0; i < *p; i++) {\n"
        "        p[1] += p[2];\n    }\n}\n",
        ["loop in interrupt", "program.c:", "no bounds"],
    ),
    "recursion": (
        "__attribute__((noinline)) int deeper(volatile int *p)\n"
        "{ return *p > 0 ? deeper(p + 1) + *p : 0; }\n"
        "int interrupt(volatile int *p) { return deeper(p); }\n",
        ["recursion: deeper -> deeper"],
    ),
    "call through a pointer": (
        "void (*volatile hook)(void);\nint interrupt(void) { hook(); return 0; }\n",
        ["interrupt", "blx", "goes where nothing says"],
    ),
}

VARIABLES = """
#include <stdbool.h>
#include <stdint.h>
struct inner { uint8_t a; union { double d; struct { int16_t x; float y[3]; } pair; }; };
enum colour { RED, GREEN };
struct application { int32_t n; struct inner part[2]; enum colour colour; volatile bool on;
                     uint64_t hash; unsigned bits : 3; };
struct application application = {.n = 1};
void interrupt(void) { application.n++; }
"""
PLACES = {  # offset, size, type
    "application.n": (0, 4, "int32"),
    "application.part[1].a": (32, 1, "uint8"),
    "application.part[1].d": (40, 8, "double"),
    "application.part[0].pair.y[2]": (28, 4, "float"),
    "application.colour": (56, 1, "enum colour"),
    "application.on": (57, 1, "bool"),
    "application.hash": (64, 8, "uint64"),
}
MISPLACED = {
    "application.m": "no member `m` in structure `application`",
    "application.part[2].a": "[2] of an array of 2",
    "application.n.x": "no structure",
    "application.part[0]": "no single value",
    "application.bits": "bits is a bit field",
    "other.n": "no global variable `other`",
}


class Compiler:
    def __init__(self, command, folder):
        self._command = command
        self._folder = Path(folder)

    def image(self, program):
        source, elf = self._folder / "program.c", self._folder / "program.elf"
        source.write_text(program, encoding="utf-8")
        options = ["-O1", "-g", "-ffreestanding", "-nostdlib", "-Wl,-e,interrupt"]
        subprocess.run([*self._command, *options, source, "-o", elf], check=True)
        return elf


def check(what, found, expected):
    ok = found == expected
    print(f"{'ok' if ok else 'WRONG':6}{what}: {found}" + ("" if ok else f", not {expected}"))
    return not ok


def count(elf, turns):
    analysis = longest_path.Analysis(elf)
    paths = LongestPath(
        analysis.image,
        Costs(analysis.core, lambda address: False),
        lambda function, members, header: turns
        + (not longest_path.ends_at_its_end(function, members, header)),
        lambda instruction, body: None,
        lambda instruction: False,
        lambda instruction: False,
    )
    start = analysis.image.symbols["interrupt"] & ~1
    return tuple(paths.of(start, column).cycles for column in (0, 1))


def refusal(ask):
    try:
        return f"no refusal: {ask()}"
    except ValueError as error:
        return str(error)


def check_variables(compiler):
    elf = compiler.image(VARIABLES)
    variables = Variables(elf)
    base = longest_path.Analysis(elf).image.symbols["application"]
    wrong = 0
    for expression, expected in PLACES.items():
        place = variables.place(expression)
        wrong += check(expression, (place.address - base, place.size, place.type), expected)
    for expression, text in MISPLACED.items():
        said = refusal(lambda: variables.place(expression))
        wrong += check(f"{expression}: {said}", text in said, True)
    said = refusal(lambda: image_map.signals(Image(elf), elf))
    return wrong + check(f"signals: {said}", "no member `drive`" in said, True)


def check_map(compiler, m4f):
    elf = compiler.image(assembly("ldr r0, 1f", "ldr r1, [sp]", "bx lr", ".balign 4", "1: .word 1"))
    output = elf.with_suffix(".map.json")
    written = []
    for _ in range(2):
        image_map.write(image_map.image_map(elf, with_signals=False), output)
        written.append(output.read_bytes())
    content = json.loads(written[0])
    kinds = [kind for run in content["code"] for kind in bytes.fromhex(run["costs"])]
    costs = [content["costs"][kind] for kind in kinds[:3]]
    known = (
        [[2, 2, 2, 3, 3, 1], [2, 1, 2, 2, 2, 0], [2, 1, 1, 1, 1, 0]]
        if m4f
        else [[2, 2, 2, 2, 2, 1], [2, 2, 2, 2, 2, 0], [2, 1, 1, 1, 1, 0]]
    )
    return check("map: the same bytes twice", written[0] == written[1], True) + check(
        "map: costs", costs, known
    )


def main(command):
    wrong = 0
    m4f = any("cortex-m4" in word for word in command)
    with tempfile.TemporaryDirectory() as folder:
        compiler = Compiler(command, folder)
        for what, (program, turns, cycles_m4f, cycles_m0plus) in COUNTED.items():
            expected = cycles_m4f if m4f else cycles_m0plus
            if expected is not None:
                wrong += check(what, count(compiler.image(program), turns), expected)
        for what, (program, texts) in REFUSED.items():
            analysis = longest_path.Analysis(compiler.image(program))
            said = refusal(lambda: analysis.row("any", "interrupt"))
            wrong += check(f"{what}: {said}", all(text in said for text in texts), True)
        wrong += check_variables(compiler)
        wrong += check_map(compiler, m4f)
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]) if len(sys.argv) > 1 else __doc__)
