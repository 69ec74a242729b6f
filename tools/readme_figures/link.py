"""How much code carries the drive on a fieldbus."""
import re

from comparison.simulator import ROOT
from readme_figures.registry import entry, table

FOLDER = ROOT / "firmware/link"
GROUPS = (
    ("channel, NMT, emergencies, CAN bus", ("link", "can_bus", "can_frame")),
    ("dictionary, SDO, PDO", ("objects", "objects_table", "link_objects", "data_sheet", "sdo", "sdo_block", "pdo")),
    ("CiA 402: states, modes, quantities", ("cia402", "cia402_objects", "axis_motion", "axis_stream", "axis_torque")),
    ("slcan", ("slcan",)),
    ("Modbus RTU", ("modbus",)),
    ("capture", ("capture",)),
)


def code_lines(path):
    """Those that are neither empty nor a comment."""
    text = re.sub(r"/\*.*?\*/|//[^\n]*", lambda found: "\n" * found[0].count("\n"), path.read_text(encoding="utf-8"),
                  flags=re.DOTALL)
    return sum(bool(line.strip()) for line in text.splitlines())


@entry("link-lines", "tools/figures --only link-lines")
def lines_of_link(_):
    counted = {path.name: code_lines(path) for path in FOLDER.glob("*.[ch]")}
    groups = [(what, sum(counted.pop(f"{name}.{suffix}", 0) for name in names for suffix in "ch"))
              for what, names in GROUPS]
    assert not counted, f"in no group: {counted}"
    return {"canopen": f"{sum(count for _, count in groups[:3]):,}",
            "table": table(["code of", "lines"], [[what, f"{count:,}"] for what, count in groups])}
