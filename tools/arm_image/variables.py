"""Where the parts of a global variable lie and what they are, from debug information (DWARF)."""

import re
from dataclasses import dataclass

from .dwarf import dwarf_of

DW_OP_ADDR = 0x03
DW_ATE_BOOLEAN, DW_ATE_FLOAT, DW_ATE_SIGNED, DW_ATE_SIGNED_CHAR = 0x02, 0x04, 0x05, 0x06
STRUCTURES = ("DW_TAG_structure_type", "DW_TAG_union_type")
TRANSPARENT = ("DW_TAG_const_type", "DW_TAG_volatile_type", "DW_TAG_typedef")


@dataclass(frozen=True)
class Place:
    address: int
    size: int
    type: str  # float, double, bool, int8...int64, uint8...uint64, pointer; enum <tag> of a size


class Variables:
    """The global variables of an image."""

    def __init__(self, path):
        self._path = path
        self._found = {}
        for unit in dwarf_of(path).iter_CUs():
            for die in unit.get_top_DIE().iter_children():
                self._consider(die)

    def _consider(self, die):
        if die.tag != "DW_TAG_variable" or "DW_AT_location" not in die.attributes:
            return
        location = die.attributes["DW_AT_location"].value
        if not isinstance(location, list) or location[:1] != [DW_OP_ADDR]:
            return
        name = _name(die)
        if name is not None:
            address = int.from_bytes(bytes(location[1:5]), "little")
            self._found[name] = (address, die)

    def place(self, expression):
        """`variable.member.array[2].member` -> Place. Members of unnamed unions and structures are
        named directly, as in C."""
        parts = re.findall(r"\w+|\[\d+\]", expression)
        if parts[0] not in self._found:
            raise ValueError(f"{self._path}: no global variable `{parts[0]}` (for {expression})")
        address, die = self._found[parts[0]]
        kind = _type_of(die)
        for part in parts[1:]:
            offset, kind = self._step(kind, part, expression)
            address += offset
        return self._leaf(address, kind, expression)

    def _step(self, kind, part, expression):
        where = f"{self._path}: {expression}"
        if part.startswith("["):
            if kind is None or kind.tag != "DW_TAG_array_type":
                raise ValueError(f"{where}: what {part} is applied to is no array")
            ranges = [c for c in kind.iter_children() if c.tag == "DW_TAG_subrange_type"]
            count = _count(ranges[0])
            if len(ranges) != 1 or int(part[1:-1]) >= count:
                raise ValueError(f"{where}: {part} of an array of {count}")
            element = _type_of(kind)
            return int(part[1:-1]) * _size(element), element
        if kind is None or kind.tag not in STRUCTURES:
            raise ValueError(f"{where}: `{part}` is asked of what is no structure")
        found = _member(kind, part)
        if found is None:
            raise ValueError(f"{where}: no member `{part}` in {kind.tag[7:-5]} `{_name(kind)}`")
        return found

    def _leaf(self, address, kind, expression):
        if kind is None or kind.tag in STRUCTURES + ("DW_TAG_array_type",):
            raise ValueError(f"{self._path}: {expression} is no single value")
        size = _size(kind)
        if kind.tag == "DW_TAG_pointer_type":
            return Place(address, size, "pointer")
        if kind.tag == "DW_TAG_enumeration_type":
            return Place(address, size, f"enum {_name(kind)}")
        encoding = kind.attributes["DW_AT_encoding"].value
        if encoding == DW_ATE_FLOAT:
            return Place(address, size, {4: "float", 8: "double"}[size])
        if encoding == DW_ATE_BOOLEAN:
            return Place(address, size, "bool")
        signed = encoding in (DW_ATE_SIGNED, DW_ATE_SIGNED_CHAR)
        return Place(address, size, f"{'int' if signed else 'uint'}{8 * size}")


def _member(kind, name):
    """(offset, type) of a member, also one of an unnamed structure inside, or None."""
    for child in kind.iter_children():
        if child.tag != "DW_TAG_member":
            continue
        attribute = child.attributes.get("DW_AT_data_member_location")
        offset = attribute.value if attribute else 0  # of a union
        own = _name(child)
        if own == name:
            if "DW_AT_bit_size" in child.attributes:
                raise ValueError(f"{name} is a bit field")
            return offset, _type_of(child)
        inner = _type_of(child) if own is None else None
        if inner is not None and inner.tag in STRUCTURES:
            found = _member(inner, name)
            if found:
                return offset + found[0], found[1]
    return None


def _origin(die, attribute):
    """The DIE that has an attribute, behind what this one was made from."""
    while attribute not in die.attributes:
        links = ("DW_AT_abstract_origin", "DW_AT_specification")
        link = next((a for a in links if a in die.attributes), None)
        if link is None:
            return None
        die = die.get_DIE_from_attribute(link)
    return die


def _name(die):
    die = _origin(die, "DW_AT_name")
    return die.attributes["DW_AT_name"].value.decode() if die else None


def _type_of(die):
    """The type of a variable, member or element, behind typedefs and qualifiers."""
    die = _origin(die, "DW_AT_type")
    while die is not None:
        if "DW_AT_type" not in die.attributes:
            return None  # void
        die = die.get_DIE_from_attribute("DW_AT_type")
        if die.tag not in TRANSPARENT:
            return die
    return None


def _size(kind):
    if kind.tag == "DW_TAG_array_type":
        size = _size(_type_of(kind))
        for child in kind.iter_children():
            size *= _count(child)
        return size
    return kind.attributes["DW_AT_byte_size"].value


def _count(subrange):
    if "DW_AT_upper_bound" in subrange.attributes:
        return subrange.attributes["DW_AT_upper_bound"].value + 1
    return subrange.attributes["DW_AT_count"].value
