"""Every function of the package `steadystep` is typed, and mypy agrees.

usage: types_of_package.py SIL    (which it does not need)
"""
import subprocess
import sys

from operated import PACKAGE, ROOT, environment

done = subprocess.run([sys.executable, "-m", "mypy", "--cache-dir", str(ROOT / "build" / "mypy")], cwd=PACKAGE,
                      env=environment(), check=False)
sys.exit(done.returncode)
