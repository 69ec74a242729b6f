"""The package `steadystep` as a test imports it, and a simulated drive for it."""
import os
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
PACKAGE = ROOT / "tools" / "python"
FOLDERS = [str(PACKAGE), str(ROOT / "build" / "clients"), str(ROOT / "build" / "page")]
sys.path[:0] = FOLDERS

try:
    import steadystep  # noqa: E402,F401
    from steadystep.simulator import Simulated  # noqa: E402,F401
except ImportError as missing:
    sys.exit(f"{missing.name} is not in {', '.join(FOLDERS[1:])}: tools/setup page installs it")


def environment():
    """For a process that imports the package."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(FOLDERS)}


def refusal(action, kind=None):
    """What it raises of the package's own errors, in words; "" if nothing."""
    try:
        action()
    except (kind or steadystep.SteadystepError) as error:
        return str(error)
    return ""
