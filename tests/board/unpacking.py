#!/usr/bin/python3
"""What tools/pack_image packs, hal/cortex_m/unpack.c makes again: the regions of an image, and bytes
that no image has. And its .bin, made by objcopy, is what the ELF file's segments load.

usage: unpacking.py CC ROOT IMAGE.elf     CC: a compiler of the host; IMAGE.elf: packed
"""

import ctypes
import random
import struct
import subprocess
import sys
import tempfile
from pathlib import Path

from elftools.elf.elffile import ELFFile

sys.path.insert(0, str(Path(__file__).resolve().parents[2] / "tools"))

from arm_image import memory  # noqa: E402
from arm_image.packing import pack  # noqa: E402

BEYOND = b"\xa5" * 16  # behind each region: it must stay


class Region(ctypes.Structure):
    _fields_ = [("begin", ctypes.c_void_p), ("end", ctypes.c_void_p)]


def library(compiler, root, folder):
    file = Path(folder) / "unpack.so"
    options = ["-O1", "-shared", "-fPIC", f"-I{root}", "-o", str(file)]
    subprocess.run([compiler, *options, f"{root}/hal/cortex_m/unpack.c"], check=True)
    return ctypes.CDLL(str(file))


def unpacked(unpack, packed, regions):
    memories = [ctypes.create_string_buffer(bytes(len(r)) + BEYOND, len(r) + 16) for r in regions]
    begins = [ctypes.addressof(memory) for memory in memories]
    table = (Region * len(regions))(*[(at, at + len(r)) for at, r in zip(begins, regions)])
    unpack(packed, table, len(regions))
    return [memory.raw for memory in memories]


def of_image(path):
    """(packed bytes, regions) of an image."""
    with open(path, "rb") as file:
        sections = list(ELFFile(file).iter_sections())
        regions = sorted(
            (s["sh_addr"], s.data()) for s in sections if s.name.startswith(".unpacked.")
        )
        (packed,) = [s.data() for s in sections if s.name == ".packed"]
    return packed, [data for _, data in regions]


def cases():
    numbers = random.Random(1)
    noise = bytes(numbers.randrange(256) for _ in range(30000))
    calls = [numbers.randrange(0xF000, 0x10000) for _ in range(3000)]
    yield "much that looks like calls, an odd number of bytes", [struct.pack("<3000H", *calls) + b"\xf8"]
    yield "one byte", [b"a"]
    yield "an empty region between others", [b"even", b"", b"odd"]
    yield "the same byte throughout", [b"\xff" * 3000]
    yield "a match 30 KB away, in noise", [noise + noise[:300]]
    yield "few different bytes", [bytes(numbers.randrange(3) for _ in range(5000))] * 2


def main():
    if len(sys.argv) != 4:
        sys.exit(__doc__)
    compiler, root, image = sys.argv[1:]
    tried = [(name, pack(regions), regions) for name, regions in cases()]
    tried.append((Path(image).name, *of_image(image)))
    wrong = 0
    with tempfile.TemporaryDirectory() as folder:
        unpack = library(compiler, root, folder).unpack
        for name, packed, regions in tried:
            right = unpacked(unpack, packed, regions) == [region + BEYOND for region in regions]
            wrong += not right
            size = sum(map(len, regions))
            print(f"{'same' if right else 'DIFFERS'}: {name}, {size} B, packed {len(packed)}")
    (start, _), *_ = loaded = memory.loaded(image)
    binary = Path(image).with_suffix(".bin").read_bytes()
    same = all(binary[at - start :][: len(data)] == data for at, data in loaded)
    same &= len(binary) == loaded[-1][0] + len(loaded[-1][1]) - start
    print(f"{'same' if same else 'DIFFERS'}: .bin, {len(binary)} B")
    return 1 if wrong or not same else 0


if __name__ == "__main__":
    sys.exit(main())
