"""The package as pip installs it: a wheel of a copy of the source, in an environment of its own, without a
network; its command, five lines of a session, and its page.

usage: installed.py SIL
"""
import os
import pathlib
import shutil
import subprocess
import tempfile
import zipfile

from operated import FOLDERS, PACKAGE
from served import Checks, Served

CHECKS = Checks()
PYTHON = "/usr/bin/python3"  # whose pip, setuptools and wheel tools/setup installs
DRAWS = "steadystep/page/vendor/uPlot.iife.min.js"  # fetched, not committed
SESSION = """import steadystep
drive = steadystep.Drive("{link}")
drive.enable()
drive.move(1.5)
print(steadystep.__file__, drive.position_rad)
"""


def without_network():
    """What the package needs is where tools/setup has put it; its sources are not."""
    return {**os.environ, "PYTHONPATH": os.pathsep.join(FOLDERS[1:]), "PIP_NO_INDEX": "1", "PIP_CONFIG_FILE": os.devnull,
            "PIP_DISABLE_PIP_VERSION_CHECK": "1"}


def ran(*command):
    done = subprocess.run([*map(str, command)], capture_output=True, text=True, env=without_network(), timeout=100,
                          cwd=tempfile.gettempdir(), check=False)
    return done.returncode, done.stdout, done.stderr


def wheel_of(source, folder):
    """setuptools leaves a folder build/ beside what it packs."""
    code, _, said = ran(PYTHON, "-m", "pip", "wheel", "--no-deps", "--no-build-isolation", "--wheel-dir", folder,
                        source)
    CHECKS.that(code == 0, f"a wheel is made: {said}")
    return next(iter(folder.glob("steadystep-*-none-any.whl")), None)


def it_carries_what_the_source_has(wheel, has_uplot):
    names = zipfile.ZipFile(wheel).namelist()
    for name in ("dictionary.json", "steadystep.eds", "py.typed", "page/static/index.html", "page/handlers.py"):
        CHECKS.that(f"steadystep/{name}" in names, f"{name} is in the wheel")
    CHECKS.that((DRAWS in names) == has_uplot, f"uPlot is in it: {has_uplot}")
    CHECKS.that(("steadystep/page/vendor/LICENSE" in names) == has_uplot, "with its licence")


def installed(wheel, folder):
    """The environment's folder of commands; it has no pip of its own."""
    ran(PYTHON, "-m", "venv", "--without-pip", folder)
    code, _, said = ran(PYTHON, "-m", "pip", "--python", folder / "bin" / "python", "install", "--no-deps", wheel)
    CHECKS.that(code == 0, f"it is installed: {said}")
    return folder / "bin"


def it_operates_a_drive(commands, environment):
    code, said, _ = ran(commands / "steadystep", "--help")
    CHECKS.that(code == 0 and "usage: steadystep" in said and "capture" in said, f"its command helps: {said}")
    with Served() as served:
        code, said, complaint = ran(commands / "python", "-c", SESSION.format(link=served.link))
        CHECKS.that(code == 0 and said.startswith(str(environment)), f"what is installed operates: {said}{complaint}")
        CHECKS.that(code == 0 and abs(float(said.split()[1]) - 1.5) < 0.01, f"the drive moves: {said}")


def its_page_is_there_where_uplot_is(commands, has_uplot):
    code, _, said = ran(commands / "steadystep", "--port", "/dev/no-such", "page")
    CHECKS.that(code == 2 and ("No such file" in said) == has_uplot, f"the page begins: {said}")
    CHECKS.that(("tools/setup page" in said and "pip install" in said) != has_uplot, f"or says what is missing: {said}")


with tempfile.TemporaryDirectory() as scratch:
    SCRATCH = pathlib.Path(scratch)
    for HAS_UPLOT in (True, False):
        PLACE = SCRATCH / str(HAS_UPLOT)
        shutil.copytree(PACKAGE, PLACE / "source", ignore=shutil.ignore_patterns("build", "*.egg-info", "__pycache__"))
        if not HAS_UPLOT:
            shutil.rmtree(PLACE / "source" / "steadystep" / "page" / "vendor")
        WHEEL = wheel_of(PLACE / "source", PLACE)
        if WHEEL:
            it_carries_what_the_source_has(WHEEL, HAS_UPLOT)
            COMMANDS = installed(WHEEL, PLACE / "environment")
            if HAS_UPLOT:
                it_operates_a_drive(COMMANDS, PLACE)
            its_page_is_there_where_uplot_is(COMMANDS, HAS_UPLOT)
CHECKS.end()
