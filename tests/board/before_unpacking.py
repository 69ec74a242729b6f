#!/usr/bin/python3
"""Fails if what runs before an image has unpacked its memory needs any of it.

usage: before_unpacking.py IMAGE.elf FUNCTION...     what runs before: what main calls until then,
                                                     and handlers
       before_unpacking.py --self-test IMAGE.elf FUNCTION    one that needs it, and must be found
"""

import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tools"))

from arm_image import call_graph  # noqa: E402
from arm_image.image import Image  # noqa: E402
from arm_image.interrupt_code import loaded_constants, object_at  # noqa: E402


def needed(image, root):
    """Names of functions and constants in unpacked memory that `root` reaches."""
    unpacked = [
        range(start, start + size)
        for name, start, size, _, _ in image.sections
        if name.startswith(".unpacked.")
    ]
    stack_top = image.symbols["stack_top"]  # may be where the first begins
    for start, node in call_graph.walk(image, root).items():
        for address in (start, *loaded_constants(image, node)):
            if address != stack_top and any(address in memory for memory in unpacked):
                yield object_at(image, address)


def main():
    if len(sys.argv) < 3:
        sys.exit(__doc__)
    self_test = sys.argv[1] == "--self-test"
    path, *roots = sys.argv[1 + self_test :]
    image = Image(path)
    found = {root: sorted(set(needed(image, root))) for root in roots}
    for root, names in found.items():
        print(f"{root}: needs {', '.join(names) or 'nothing'}")
    return int(self_test != any(found.values()))


if __name__ == "__main__":
    sys.exit(main())
