"""The package `steadystep` as a test imports it, and a simulated drive for it."""
import pathlib
import sys

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIENTS, PACKAGE = ROOT / "build" / "clients", ROOT / "tools" / "python"
sys.path[:0] = [str(PACKAGE), str(CLIENTS)]

try:
    import steadystep  # noqa: E402,F401
    from steadystep.simulator import Simulated  # noqa: E402,F401
except ImportError as missing:
    sys.exit(f"{missing.name} is not in {CLIENTS}: tools/setup clients installs it")


def refusal(action, kind=None):
    """What it raises of the package's own errors, in words; "" if nothing."""
    try:
        action()
    except (kind or steadystep.SteadystepError) as error:
        return str(error)
    return ""
