#!/usr/bin/python3
"""Fails if the control interrupt can reach anything but the firmware's own code.

usage: interrupt_is_clean.py IMAGE.elf BACKGROUND.c...    (its linker map beside it: IMAGE.elf.map)
       interrupt_is_clean.py --self-test CC OBJECT_FLAGS...

Walks the static call graph from the interrupt, through the declared call tables, and names every
function that does not come from firmware/ (compiler helpers for division, long multiplication,
switches and soft float, libm, the heap) and every instruction on double precision. memcpy and
memset are let pass where the code shows a constant size of at most 64 bytes. Of the firmware's own,
what comes from one of the BACKGROUND sources is named: those are made small and not inlined.
"""

import re
import subprocess
import sys
import tempfile
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image import call_graph, link_map  # noqa: E402
from arm_image.debug_info import SourceLines  # noqa: E402
from arm_image.image import Image  # noqa: E402

INTERRUPT = "drive_control_cycle"
COPIES = {"memcpy", "memmove", "memset"}
COPY_LIMIT_B = 64


def large_copies(node, start):
    """Sizes, None for unknown, of the calls of memcpy or memset at `start` that are too large."""
    for k, instruction in enumerate(node.instructions):
        if instruction.is_branch and instruction.target == start:
            # the last write of r2, the size, within the straight line before the call
            size = None
            for before in reversed(node.instructions[max(0, k - 12) : k]):
                if before.is_branch:
                    break
                if before.registers[:1] == ["r2"]:
                    constant = re.fullmatch(r"r2, #(0x[0-9a-f]+|\d+)", before.operands)
                    size = (
                        int(constant.group(1), 0)
                        if constant and before.base.startswith("mov")
                        else None
                    )
                    break
            if size is None or size > COPY_LIMIT_B:
                yield size


def violations(image, pieces, root=INTERRUPT):
    """Texts, one per violation, and the names of the functions reached."""
    own = link_map.of_firmware(pieces)
    nodes = call_graph.walk(image, root, lambda start: link_map.origin_of(own, start) is not None)
    found = []
    for start, node in sorted(nodes.items()):
        callers = [n for n in nodes.values() if start in n.calls]
        if node.name in COPIES:
            for caller in callers:
                found += [
                    f"{node.name} of {size or 'unknown'} bytes in {caller.name}"
                    for size in large_copies(caller, start)
                ]
        elif link_map.origin_of(own, start) is None:
            origin = (link_map.origin_of(pieces, start) or "?").rpartition("/")[2]
            found.append(
                f"{node.name} ({origin}), called by {', '.join(sorted(n.name for n in callers))}"
            )
        for instruction in node.instructions:
            if ".f64" in instruction.mnemonic:
                found.append(f"{node.name}: {instruction.mnemonic} {instruction.operands}")
    return found, [node.name for node in nodes.values()]


def from_background(path, image, background):
    """Texts, one for each function that the interrupt reaches in one of these sources."""
    places = {str(Path(source).resolve().relative_to(ROOT)) for source in background}
    lines = SourceLines(path, ROOT)
    for start, node in sorted(call_graph.walk(image, INTERRUPT).items()):
        source = lines.at(start).rpartition(":")[0]
        if source in places:
            yield f"{node.name} of {source}, which is declared to be background"


def check(path, background):
    image = Image(path)
    found, reached = violations(image, link_map.read(f"{path}.map"))
    found += from_background(path, image, background)
    for text in found:
        print(f"the interrupt reaches {text}")
    print(f"{len(reached)} functions: {', '.join(sorted(reached))}")
    print(f"{len(found)} violations")
    return 1 if found else 0


# Each of these must be found in an interrupt that contains it.
PLANTED = {
    "double": "double x = s[0]; s[0] = (float)(x * 1.1);",
    "libm": "s[0] = __builtin_sinf(s[0]);",
    "long division": "n[0] = (int)((long long)n[1] * n[2] / n[3]);",
    "heap": "n[0] = (int)(unsigned long)malloc((unsigned)n[1]);",
    "large copy": "memcpy(s, n, 400);",
    "copy of unknown size": "memcpy(s, n, (unsigned)n[1]);",
    "through a table": "s[0] = registry[n[0] & 1]->step(s[0]);",
}
CLEAN = "n[0] += n[1]; memset(s, 0, 60);"


def self_test(compiler):
    """Builds small interrupts with planted violations, and a clean one, and checks each."""
    failures = 0
    for name, body in {"nothing": CLEAN, **PLANTED}.items():
        with tempfile.TemporaryDirectory() as scratch:
            folder = Path(scratch) / "firmware_planted.dir"
            folder.mkdir()
            source, elf = folder / "planted.c", Path(scratch) / "planted.elf"
            source.write_text(
                "#include <stdlib.h>\n#include <string.h>\n"
                "struct position_law { const char *name; void *design; float (*step)(float); };\n"
                "static float plain(float x) { return x; }\n"
                "static float bad(float x) { return __builtin_expf(x); }\n"
                'static const struct position_law a = {"a", 0, plain}, b = {"b", 0, bad};\n'
                "static const struct position_law *const registry[2] = {&a, &b};\n"
                f"void {INTERRUPT}(float *s, int *n) {{ (void)registry; {body} }}\n"
                "static float s[100];\nstatic int n[100];\n"
                f"int main(void) {{ {INTERRUPT}(s, n); return n[0]; }}\n"
            )
            made = [
                *compiler,
                "-O2",
                "-g",
                "-ffreestanding",
                "-fno-inline",
                "-ffunction-sections",
                "--specs=nosys.specs",
            ]
            objects = [*made, "-c", source.name, "-o", "planted.o"]
            subprocess.run(objects, cwd=folder, check=True)
            link = [
                *made,
                "firmware_planted.dir/planted.o",
                "-o",
                str(elf),
                f"-Wl,-Map={elf}.map",
                "-lm",
            ]
            subprocess.run(link, cwd=scratch, check=True, stderr=subprocess.DEVNULL)
            found, _ = violations(Image(elf), link_map.read(f"{elf}.map"))
        ok = bool(found) == (name != "nothing")
        failures += not ok
        print(f"{'ok' if ok else 'WRONG':6} planted {name}: {'; '.join(found) or 'no violation'}")
    return 1 if failures else 0


if __name__ == "__main__":
    if len(sys.argv) > 2 and sys.argv[1] == "--self-test":
        sys.exit(self_test(sys.argv[2:]))
    if len(sys.argv) > 2:
        sys.exit(check(sys.argv[1], sys.argv[2:]))
    sys.exit(__doc__)
