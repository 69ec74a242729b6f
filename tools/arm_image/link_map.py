"""Which object file each piece of an image comes from, read from the linker's map."""

import re
from dataclasses import dataclass


@dataclass
class Piece:
    section: str  # input section, as ".text.park"
    address: int
    size: int
    origin: str  # object, or archive(member)


def read(path):
    """Every piece that is in memory."""
    with open(path, encoding="utf-8") as file:
        text = file.read()
    text = text[text.index("Linker script and memory map") :]
    # " .text.f  0x0000 0x10 file.o"; a long section name stands on a line of its own.
    pattern = re.compile(
        r"^ (\.[\w.$]+|COMMON)\s+0x([0-9a-f]+)\s+0x([0-9a-f]+) (\S.*)$", re.MULTILINE
    )
    pieces = []
    for section, address, size, origin in pattern.findall(text):
        if int(size, 16) and not section.startswith(
            (".debug", ".comment", ".ARM.attributes", ".stab")
        ):
            pieces.append(Piece(section, int(address, 16), int(size, 16), origin))
    return pieces


def of_firmware(pieces):
    """What the project's own compilation made: the firmware as one object, or the objects of its
    library; those of the toolchain's libraries are never part of it."""
    own = re.compile(r"\bfirmware_\w+\.(dir/|o$)|libfirmware_\w+\.a\(")
    return [p for p in pieces if own.search(p.origin)]


def origin_of(pieces, address):
    """Object file of an address, None if none of the pieces holds it."""
    return next((p.origin for p in pieces if p.address <= address < p.address + p.size), None)
