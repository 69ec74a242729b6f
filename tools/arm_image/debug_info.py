"""What the image's debug information (DWARF) says: source lines, constants of a type."""

import bisect
import os.path

from elftools.elf.elffile import ELFFile

from .dwarf import dwarf_of

DW_OP_ADDR = 0x03
TYPES = (
    "DW_TAG_structure_type",
    "DW_TAG_union_type",
    "DW_TAG_enumeration_type",
    "DW_TAG_array_type",
    "DW_TAG_subroutine_type",
)


def _units(path):
    dwarf = dwarf_of(path)
    for unit in dwarf.iter_CUs():
        yield dwarf, unit


class SourceLines:
    """Source file and line of an instruction."""

    def __init__(self, path, root):
        rows = sorted(
            row for dwarf, unit in _units(path) for row in self._rows(dwarf, unit, str(root))
        )
        self._addresses = [row[0] for row in rows]
        self._places = [row[1] for row in rows]

    @staticmethod
    def _rows(dwarf, unit, root):
        program = dwarf.line_program_for_CU(unit)
        if program is None:
            return
        header = program.header
        first = 0 if header["version"] >= 5 else 1
        folder = unit.get_top_DIE().attributes["DW_AT_comp_dir"].value.decode()
        folders = [entry.decode() for entry in header["include_directory"]]
        names = []
        for entry in header["file_entry"]:
            place = folders[entry.dir_index - first] if entry.dir_index >= first else folder
            full = os.path.normpath(os.path.join(folder, place, entry.name.decode()))
            inside = full.startswith(root + os.sep)
            names.append(os.path.relpath(full, root) if inside else os.path.basename(full))
        for entry in program.get_entries():
            state = entry.state
            if state and not state.end_sequence:
                yield state.address, f"{names[state.file - first]}:{state.line}"

    def at(self, address):
        k = bisect.bisect_right(self._addresses, address) - 1
        return self._places[k] if k >= 0 else "?"


def _variables(die):
    """Those of a unit and of its functions. Most of a unit are members of types, which are not parsed."""
    for child in die.iter_children():
        if child.tag == "DW_TAG_variable":
            yield child
        elif child.tag not in TYPES:
            yield from _variables(child)


def members(path, wanted):
    """Addresses of the wanted members, [(struct, member)], of every object of such a type."""
    structs = {struct for struct, _ in wanted}
    found = []
    for _, unit in _units(path):
        for die in _variables(unit.get_top_DIE()):
            if "DW_AT_location" not in die.attributes:
                continue
            location = die.attributes["DW_AT_location"].value
            if not isinstance(location, list) or location[:1] != [DW_OP_ADDR]:
                continue
            kind = _struct_of(die)
            if kind is None or _name(kind) not in structs:
                continue
            address = int.from_bytes(bytes(location[1:5]), "little")
            offsets = {
                _name(child): child.attributes["DW_AT_data_member_location"].value
                for child in kind.iter_children()
                if "DW_AT_data_member_location" in child.attributes
            }
            found += [
                address + offsets[member] for struct, member in wanted if struct == _name(kind)
            ]
    return found


def flash_of(path, root, folder):
    """Bytes of the code that comes from a folder of sources: sizes of its functions with their
    constants. Tables and texts, some hundred bytes, are not distinguished from the test's and left out.
    """
    source = SourceLines(path, root)
    with open(path, "rb") as file:
        symbols = ELFFile(file).get_section_by_name(".symtab").iter_symbols()
        functions = {
            s["st_value"] & ~1: s["st_size"] for s in symbols if s["st_info"]["type"] == "STT_FUNC"
        }
    return sum(size for start, size in functions.items() if source.at(start).startswith(folder))


def _name(die):
    return die.attributes["DW_AT_name"].value.decode() if "DW_AT_name" in die.attributes else None


def _struct_of(variable):
    """The structure type of a variable, behind const and volatile; None of other types."""
    die = variable
    while "DW_AT_type" not in die.attributes:  # stands where it is declared
        links = ("DW_AT_specification", "DW_AT_abstract_origin")
        link = next((a for a in links if a in die.attributes), None)
        if link is None:
            return None
        die = die.get_DIE_from_attribute(link)
    while "DW_AT_type" in die.attributes:
        die = die.get_DIE_from_attribute("DW_AT_type")
        if die.tag == "DW_TAG_structure_type":
            return die
        if die.tag not in ("DW_TAG_const_type", "DW_TAG_volatile_type", "DW_TAG_typedef"):
            return None
    return None
