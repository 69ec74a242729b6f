"""An unmodified npm `canopen` operates the drive, through TCP: canopen_node.js.

Skipped, with exit code 77, where it is not installed: tools/setup clients installs it if there is a
Node.js.

usage: canopen_npm.py SIL
"""
import pathlib
import shutil
import subprocess
import sys

from served import Checks, Served

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIENTS = ROOT / "build" / "clients"
NODE = shutil.which("node")
SKIPPED = 77

if not NODE or not (CLIENTS / "node_modules" / "canopen").exists():
    print("skipped: no Node.js, or npm canopen is not in build/clients")
    sys.exit(SKIPPED)
CHECKS = Checks()
with Served() as served:
    done = subprocess.run([NODE, pathlib.Path(__file__).with_name("canopen_node.js"), CLIENTS,
                           served.serial[-1], ROOT / "firmware" / "interface" / "steadystep.eds"],
                          capture_output=True, text=True, timeout=90, check=False)
    said = done.stdout.splitlines()
    for line in said:
        CHECKS.that(line.startswith("ok "), line)
    CHECKS.that(done.returncode == 0 and len(said) >= 16, f"it ends in order: {done.stderr}")
CHECKS.end()
