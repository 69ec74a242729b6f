"""Every value of a drive, and where it lies in two images: from their debug information (DWARF).

usage: fields.py OBJECT_OF_ONE_FORMAT OBJECT_IN_DOUBLE > LAYOUT

What is computed in the number format is found by its typedef. Lines of a layout, offsets and sizes
in bytes, each offset of the one image and of double:

    size <of struct drive> <the same in double>
    block <offset> <size> <offset> <size> <name>          a member of struct drive
    condition <number> <offset> <size> <value>...         holds while the integer there is one of those
    target <offset> <offset>                              what a pointer may point to
    field <kind> <offset> <offset> <size> <size> <condition> <path>

A condition is that of a union's member being in use, -1: none. Kinds: num, unit, coef, real;
position and angle; integer of a magnitude; exact; pointer. A union's member without any of the
first four is copied with `bytes`, and not compared: which of them is in use does not matter then.
"""
import re
import sys

from elftools.elf.elffile import ELFFile

QUALIFIERS = ("DW_TAG_const_type", "DW_TAG_volatile_type")
STRUCTURE, UNION, ARRAY = "DW_TAG_structure_type", "DW_TAG_union_type", "DW_TAG_array_type"
OF_THE_FORMAT = {"num_t": "num", "unit_t": "unit", "coef_t": "coef", "num_real": "real"}
ENCODER = ["ESTIMATOR_ENCODER_OBSERVER", "ESTIMATOR_HIGH_GAIN_OBSERVER"]
KIND = "params.estimator.kind"

# Which value decides of a union: its path; and the enumerators of members whose name is not the end
# of the enumerator's.
UNIONS = [
    (r"estimator", KIND, {}),
    (r"params\.estimator", KIND, {"encoder_observer+high_gain_observer": ENCODER}),
    (r"(params\.)?law", "params.position_law", {}),
    (r"commands\.entry\[(\d+)\]", "commands.entry[{}].kind", {}),
    (r"enabling", KIND, {"alignment": ENCODER, "alignment_params": ENCODER, "+": None}),
]


def name_of(die):
    attribute = die.attributes.get("DW_AT_name")
    return attribute.value.decode() if attribute else ""


def type_of(die):
    """What is behind typedefs and qualifiers, and the names of the former."""
    names = []
    while "DW_AT_type" in die.attributes:
        die = die.get_DIE_from_attribute("DW_AT_type")
        if die.tag == "DW_TAG_typedef":
            names.append(name_of(die))
        elif die.tag not in QUALIFIERS:
            return die, names
    return None, names


def count_of(subrange):
    if "DW_AT_upper_bound" in subrange.attributes:
        return subrange.attributes["DW_AT_upper_bound"].value + 1
    return subrange.attributes["DW_AT_count"].value


def size_of(kind):
    if kind.tag == ARRAY:
        size = size_of(type_of(kind)[0])
        for subrange in kind.iter_children():
            size *= count_of(subrange)
        return size
    if "DW_AT_byte_size" not in kind.attributes and kind.tag == "DW_TAG_pointer_type":
        return kind.cu["address_size"]  # clang leaves it out
    return kind.attributes["DW_AT_byte_size"].value


def members_of(kind):
    """(name, offset, type, typedefs)"""
    for child in kind.iter_children():
        if child.tag == "DW_TAG_member":
            offset = child.attributes.get("DW_AT_data_member_location")
            bits = child.attributes.get("DW_AT_data_bit_offset")  # then it is the byte that holds it
            at = offset.value if offset else bits.value // 8 if bits else 0
            yield (name_of(child), at, *type_of(child))


def leaf_kind(kind, typedefs):
    for name in typedefs:
        if name in OF_THE_FORMAT:
            return OF_THE_FORMAT[name]
    if kind.tag == "DW_TAG_pointer_type":
        return "pointer"
    if "angle_t" in typedefs:
        return "angle"
    if any(name in ("int32_t", "int64_t", "uint64_t") for name in typedefs):
        return "integer"
    return "exact"


class Drive:
    """What is found of one image: fields by path, in their order."""

    def __init__(self, path):
        self.fields, self.blocks, self.targets, self.unions, self.enumerators = {}, {}, {}, {}, {}
        with open(path, "rb") as file:
            drive = self._find(ELFFile(file).get_dwarf_info())
            self.size = size_of(drive)
            for name, offset, kind, typedefs in members_of(drive):
                self.blocks[name] = (offset, size_of(kind))
                self._walk(name, offset, kind, typedefs, [])

    @staticmethod
    def _find(dwarf):
        for unit in dwarf.iter_CUs():
            for die in unit.get_top_DIE().iter_children():
                if die.tag == STRUCTURE and name_of(die) == "drive" and "DW_AT_byte_size" in die.attributes:
                    return die
        raise SystemExit("fields.py: no struct drive: build with -g")

    def _walk(self, path, offset, kind, typedefs, members):
        """`members`: (union, member) that it is part of."""
        if kind.tag == ARRAY:
            element, names = type_of(kind)
            for i in range(size_of(kind) // size_of(element)):
                self._walk(f"{path}[{i}]", offset + i * size_of(element), element, names, members)
        elif "coef_t" in typedefs or kind.tag not in (STRUCTURE, UNION):
            if kind.tag == "DW_TAG_enumeration_type":
                self.enumerators[path] = {name_of(one): one.attributes["DW_AT_const_value"].value
                                          for one in kind.iter_children()}
            self.fields[path] = (leaf_kind(kind, typedefs), offset, size_of(kind), members)
        elif name_of(kind) == "position":
            self.fields[path] = ("position", offset, size_of(kind), members)
        elif kind.tag == STRUCTURE:
            self.targets[path] = offset
            for name, at, inner, names in members_of(kind):
                self._walk(f"{path}.{name}".rstrip("."), offset + at, inner, names, members)
        else:
            self.targets[path] = offset
            self.unions[path] = (offset, size_of(kind))
            for name, at, inner, names in members_of(kind):
                tag = name or "+".join(one[0] for one in members_of(inner))
                self._walk(f"{path}.{name}".rstrip("."), offset + at, inner, names,
                           members + [(path, tag)])


def values_in_use(drive, union, member):
    """The path of what decides, and its values; None: those that no other member takes."""
    for pattern, decides, given in UNIONS:
        match = re.fullmatch(pattern, union)
        if match:
            path = decides.format(*match.groups())
            enumerators = drive.enumerators[path]
            if member in given:
                return path, [enumerators[one] for one in given[member]]
            if "+" in given:
                taken = sum((one for one in given.values() if one), [])
                return path, [value for one, value in enumerators.items() if one not in taken]
            return path, [value for one, value in enumerators.items()
                          if one.endswith("_" + member.upper())]
    raise SystemExit(f"fields.py: what says which member of the union {union} is in use?")


def layout(one, double):
    yield f"size {one.size} {double.size}"
    for name, (offset, size) in one.blocks.items():
        yield f"block {offset} {size} {double.blocks[name][0]} {double.blocks[name][1]} {name}"
    for path, offset in one.targets.items():
        yield f"target {offset} {double.targets[path]}"
    computed = {member for kind, _, _, members in one.fields.values()
                if kind in OF_THE_FORMAT.values() for member in members}
    conditions = {}
    for path, (kind, offset, size, members) in one.fields.items():
        condition = -1
        if members:
            if members[-1] not in computed:
                continue
            decides, values = values_in_use(one, *members[-1])
            if not values:
                continue
            if members[-1] not in conditions:
                conditions[members[-1]] = len(conditions)
                yield (f"condition {len(conditions) - 1} {one.fields[decides][1]} "
                       f"{one.fields[decides][2]} {' '.join(map(str, values))}")
            condition = conditions[members[-1]]
        _, in_double, double_size, _ = double.fields[path]
        if size != double_size and kind not in OF_THE_FORMAT.values():
            raise SystemExit(f"fields.py: {path} has {size} bytes, and {double_size} in double")
        yield f"field {kind} {offset} {in_double} {size} {double_size} {condition} {path}"
    for path, (offset, _) in one.unions.items():
        plain = {member for _, _, _, members in one.fields.values() for member in members
                 if member[0] == path} - computed
        ends = [at + size for _, at, size, members in one.fields.values()
                if any(member in plain for member in members)]
        if ends:
            size = max(ends) - offset
            yield f"field bytes {offset} {double.unions[path][0]} {size} {size} -1 {path}"


def main():
    one, double = (Drive(path) for path in sys.argv[1:3])
    if one.fields.keys() != double.fields.keys():
        raise SystemExit("fields.py: the images do not have the same fields")
    print("\n".join(layout(one, double)))


if __name__ == "__main__":
    main()
