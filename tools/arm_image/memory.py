"""What an image puts where: loaded bytes, regions of memory, vector table, core."""

from elftools.elf.elffile import ELFFile

ARCHITECTURES = {13: "m4f", 11: "m0plus", 12: "m0plus"}  # Tag_CPU_arch: v7E-M, v6-M, v6S-M

# STM32G474: RM0440, memory map. Data SRAM from 0x20000000 (SRAM1, SRAM2, CCM's second address).
REGIONS = [
    ("flash", 0x08000000, 0x08080000),
    ("ccm", 0x10000000, 0x10008000),
    ("ram", 0x20000000, 0x20020000),
]


def core(path):
    """m4f or m0plus, from the build attributes."""
    with open(path, "rb") as file:
        section = ELFFile(file).get_section_by_name(".ARM.attributes")
        if section is None:
            raise ValueError(f"{path}: no ARM build attributes")
        for part in section.iter_subsections():
            for inner in part.iter_subsubsections():
                for attribute in inner.iter_attributes("TAG_CPU_ARCH"):
                    if attribute.value in ARCHITECTURES:
                        return ARCHITECTURES[attribute.value]
                    raise ValueError(f"{path}: architecture {attribute.value} is not counted for")
    raise ValueError(f"{path}: the build attributes name no architecture")


def loaded(path):
    """[(physical address, bytes)] of what is written to memory, by address."""
    with open(path, "rb") as file:
        return sorted(
            (segment["p_paddr"], segment.data())
            for segment in ELFFile(file).iter_segments()
            if segment["p_type"] == "PT_LOAD" and segment["p_filesz"]
        )


def region(address):
    return next((name for name, start, end in REGIONS if start <= address < end), "other")


def vectors(image):
    """[(exception number, name of the handler)] of the vector table: the symbol `vectors`, or else
    the begin of the image. Its first word is the stack, its second the reset handler."""
    start = image.symbols.get(
        "vectors", min(section[1] for section in image.sections if section[4])
    )
    found = []
    starts = {function[0]: function[2] for function in image.functions}
    number = 1
    while number < 256:
        word = image.word(start + 4 * number)
        if word is None or (word and not word & 1) or (word and word & ~1 not in starts):
            break  # past the end of the table
        if word:
            found.append((number, starts[word & ~1]))
        number += 1
    return found
