#!/usr/bin/python3
"""Each period of a number format is that in double, but for its rounding: runs one_step.

usage: one_step.py PROGRAM OBJECT OBJECT_IN_DOUBLE README FORMAT SCENARIO...

The objects have the debug information of struct drive. What is printed of a block of the drive must
not be beyond the README's table.
"""
import pathlib
import re
import subprocess
import sys
import tempfile

try:
    import elftools  # noqa: F401, what fields.py reads the objects with
except ImportError:
    print("left out: python3-pyelftools is not installed (tools/setup)")
    sys.exit(77)

HERE = pathlib.Path(__file__).parent


def table_of(readme, numeric):
    """{block: last places}"""
    rows = [[cell.strip() for cell in line.strip().strip("|").split("|")]
            for line in readme.read_text(encoding="utf-8").splitlines() if line.startswith("|")]
    column = rows[0].index(f"`{numeric}`")
    return {row[0].strip("`"): float(row[column].replace(",", "")) for row in rows[2:]}


def main():
    program, one, double, readme, numeric, *scenarios = sys.argv[1:]
    with tempfile.NamedTemporaryFile() as layout:
        subprocess.run([sys.executable, HERE / "fields.py", one, double], stdout=layout, check=True)
        result = subprocess.run([program, layout.name, numeric, *scenarios], check=False,
                                stdout=subprocess.PIPE, text=True)
    print(result.stdout)
    failed = result.returncode
    allowed = table_of(pathlib.Path(readme), numeric)
    for block, places in re.findall(r"^block (\w+): +([\d.]+) last places", result.stdout, re.MULTILINE):
        if float(places) > allowed.get(block, 1.0):
            print(f"FAILED: {block} differs by {places} last places, README.md has {allowed.get(block, 1.0)}")
            failed = 1
    return failed


if __name__ == "__main__":
    sys.exit(main())
