"""The debug information (DWARF) of an image: parsed once, whoever asks."""

import os
from functools import lru_cache

from elftools.elf.elffile import ELFFile


def dwarf_of(path):
    """What has been parsed of it stays with it, as long as the file is the same."""
    return _read(str(path), os.stat(path).st_mtime_ns)


@lru_cache(maxsize=2)
def _read(path, _changed):
    with open(path, "rb") as file:
        elf = ELFFile(file)
        if not elf.has_dwarf_info():
            raise ValueError(f"{path}: no debug information; build with -g")
        return elf.get_dwarf_info()
