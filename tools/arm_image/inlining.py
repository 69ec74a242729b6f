"""Which source functions an instruction comes from: the function that holds it and what has been
inlined into that one, read from the debug information (DWARF)."""

import bisect
import os.path
from dataclasses import dataclass

from elftools.dwarf.descriptions import describe_form_class
from elftools.dwarf.ranges import BaseAddressEntry

from .dwarf import dwarf_of

CODE = ("DW_TAG_subprogram", "DW_TAG_inlined_subroutine")


@dataclass(frozen=True, order=True)
class Frame:
    function: str
    file: str  # where the function is defined; relative to the project if it lies in there


class Inlining:
    def __init__(self, path, root):
        self._root = str(root)
        self._files = {}
        self._named = {}
        spans = []  # (start, end, depth, Frame)
        self._dwarf = dwarf_of(path)
        self._range_lists = self._dwarf.range_lists()
        for unit in self._dwarf.iter_CUs():
            self._collect(unit, unit.get_top_DIE(), 0, spans)
        self._starts, self._chains = _flatten(spans)

    def frames(self, address):
        """The frames an instruction belongs to, the innermost first; () where nothing is known."""
        k = bisect.bisect_right(self._starts, address) - 1
        return self._chains[k] if k >= 0 else ()

    def _collect(self, unit, die, depth, spans):
        for child in die.iter_children():
            below = depth
            if _is_discarded(child):
                continue
            if child.tag in CODE:
                ranges = [r for r in self._ranges(unit, child) if r[0] < r[1]]
                frame = self._frame(child) if ranges else None
                spans += [(start, end, depth, frame) for start, end in ranges]
                below = depth + 1
            if child.has_children and child.tag in CODE + ("DW_TAG_lexical_block",):
                self._collect(unit, child, below, spans)

    def _ranges(self, unit, die):
        attributes = die.attributes
        if "DW_AT_low_pc" in attributes and "DW_AT_high_pc" in attributes:
            low, high = attributes["DW_AT_low_pc"].value, attributes["DW_AT_high_pc"]
            absolute = describe_form_class(high.form) == "address"
            yield low, high.value if absolute else low + high.value
        elif "DW_AT_ranges" in attributes:
            top = unit.get_top_DIE().attributes
            base = top["DW_AT_low_pc"].value if "DW_AT_low_pc" in top else 0
            offset = attributes["DW_AT_ranges"].value
            for entry in self._range_lists.get_range_list_at_offset(offset, unit):
                if isinstance(entry, BaseAddressEntry):
                    base = entry.base_address
                elif getattr(entry, "is_absolute", False):
                    yield entry.begin_offset, entry.end_offset
                else:
                    yield base + entry.begin_offset, base + entry.end_offset

    def _frame(self, die):
        """Name and file stand in the DIE that a concrete one was made from."""
        if die.offset not in self._named:
            function, file, at = "?", "?", die
            while True:
                attributes = at.attributes
                if "DW_AT_name" in attributes and function == "?":
                    function = attributes["DW_AT_name"].value.decode()
                if "DW_AT_decl_file" in attributes and file == "?":
                    file = self._file_names(at.cu)[attributes["DW_AT_decl_file"].value]
                link = next(
                    (
                        a
                        for a in ("DW_AT_abstract_origin", "DW_AT_specification")
                        if a in attributes
                    ),
                    None,
                )
                if link is None:
                    break
                at = at.get_DIE_from_attribute(link)
            self._named[die.offset] = Frame(function, file)
        return self._named[die.offset]

    def _file_names(self, unit):
        if unit.cu_offset not in self._files:
            program = self._dwarf.line_program_for_CU(unit)
            header = program.header
            first = 0 if header["version"] >= 5 else 1
            folder = unit.get_top_DIE().attributes["DW_AT_comp_dir"].value.decode()
            folders = [entry.decode() for entry in header["include_directory"]]
            names = {}
            for index, entry in enumerate(header["file_entry"], first):
                inside = entry.dir_index >= first
                place = folders[entry.dir_index - first] if inside else folder
                full = os.path.normpath(os.path.join(folder, place, entry.name.decode()))
                own = full.startswith(self._root + os.sep)
                names[index] = os.path.relpath(full, self._root) if own else full
            self._files[unit.cu_offset] = names
        return self._files[unit.cu_offset]


def _is_discarded(die):
    """Of a function that the linker has left out only the debug information stays, at address 0."""
    low = die.attributes.get("DW_AT_low_pc")
    return die.tag == "DW_TAG_subprogram" and low is not None and low.value == 0


def _flatten(spans):
    """Where the chain of frames changes, and the chain from there on."""
    edges = sorted({edge for start, end, _, _ in spans for edge in (start, end)})
    chains = [{} for _ in edges]
    position = {edge: k for k, edge in enumerate(edges)}
    for start, end, depth, frame in spans:
        for k in range(position[start], position[end]):
            chains[k][depth] = frame
    return edges, [tuple(chain[d] for d in sorted(chain, reverse=True)) for chain in chains]
