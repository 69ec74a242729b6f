"""firmware/link/README.md: what a client waits for, and how much code carries it."""
import math
import re
import sys

from comparison.simulator import ROOT
from readme_figures.reading import spelled, up
from readme_figures.registry import entry, table

FOLDER = ROOT / "firmware/link"
GROUPS = (
    ("channel, NMT, emergencies, CAN bus", ("link", "can_bus", "can_frame")),
    ("dictionary, SDO, PDO", ("objects", "objects_table", "link_objects", "data_sheet", "sdo", "sdo_block", "pdo")),
    ("CiA 402: states, modes, quantities", ("cia402", "cia402_objects", "axis_motion", "axis_homing", "axis_homing_stop", "axis_homing_switch", "axis_stream", "axis_torque")),
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


@entry("capture-bytes", "tools/figures --only capture-bytes")
def capture_bytes(_):
    """Of a board's memory for what it captures."""
    words = re.search(r"HAL_CAPTURE_WORDS = (\d+)", (ROOT / "hal/hal.h").read_text(encoding="utf-8"))[1]
    return f"{4 * int(words):,}"


MODES = {"pp": "profile position", "pv": "profile velocity", "csp": "cyclic position", "sync": "cyclic position with SYNC",
         "cst": "cyclic torque"}


@entry("motion-delay", "build/sil/tests/unit/unit_motion_delay_float")
def motion_delay(sources):
    said = sources.text(sources.built("sil/tests/unit/unit_motion_delay_float", "sil"))
    found = {part: re.search(rf"^{mode}: ([\d.]+) ms$", said, re.M)[1] for part, mode in MODES.items()}
    found["rms"], found["most"] = re.search(r"off by (\d+) us rms, (\d+) us at most", said).groups()
    return found


@entry("enabling", "tests/serve/enabling_times.py build/sil/steadystep-sil")
def enabling(sources):
    said = sources.text(sys.executable, ROOT / "tests/serve/enabling_times.py", sources.program)

    def times(what):
        return [float(time) for time in re.search(rf"^{what}: ([\d.]+) s.* to ([\d.]+) s", said, re.M).groups()]

    least, most = times("in all")
    return {"motors": re.search(r"^(\d+) motors enabled", said, re.M)[1],
            "first": up(times("to SWITCHED ON")[1], 2), "second": up(times("on to OPERATION ENABLED")[1], 2),
            "least": spelled(math.floor(100 * least) / 100, 2), "most": up(most, 2)}
