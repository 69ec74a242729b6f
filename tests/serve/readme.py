"""What the READMEs have for a program of one's own does what they say, on a served drive: word by word, but for the port.

usage: readme.py SIL
"""
import os
import pathlib
import re
import subprocess
import sys

from canopen_bus import ANSWER_S, ROOT, wait_for
from operated import environment
from served import Checks, Line, Served

CHECKS = Checks()
TURN_RAD = 6.2832
PATIENT = f"import canopen; canopen.sdo.SdoClient.RESPONSE_TIMEOUT = {ANSWER_S}\n"  # on a busy machine


def block_with(file, words):
    """The indented lines around them."""
    for block in re.findall(r"(?:^    .*\n)+", (ROOT / file).read_text(encoding="utf-8"), re.MULTILINE):
        if words in block:
            return re.sub(r"^    ", "", block, flags=re.MULTILINE)
    sys.exit(f"{file}: no block with {words}")


def ran(text, served):
    """In the server's folder, where files may be written."""
    done = subprocess.run([sys.executable, "-"], input=text, capture_output=True, text=True, timeout=60, check=False,
                          cwd=served.folder, env=environment())
    CHECKS.that(done.returncode == 0, done.stderr)


def true_position(served):
    knobs = Line(str(served.knobs_link))
    said = knobs.ask("state")
    knobs.close()
    return float(said.split("theta_rad=")[1].split()[0])


def five_lines_operate_a_drive():
    for file, port in (("README.md", "/tmp/steadystep"), ("tools/python/README.md", "/dev/ttyACM0")):
        with Served() as served:
            ran(block_with(file, "drive = steadystep.Drive(").replace(port, str(served.link), 1), served)
            CHECKS.that(abs(true_position(served) - 1.5) < 0.01, f"{file}: it is moved")
            head = (served.folder / "move.csv").read_text(encoding="utf-8").split("\n", 1)[0]
            CHECKS.that(head == "time_s,theta_est_rad,i_q_A", f"{file}: and captured: {head}")


def a_turn_by_canopen():
    file = "firmware/link/README.md"
    with Served() as served:
        text = block_with(file, "network = canopen.Network()").replace("/tmp/drive", str(served.link))
        eds = os.path.relpath(ROOT / "firmware" / "interface" / "steadystep.eds", served.folder)
        more = re.search(r"and `(drive\.sdo\[.*)` is a turn", pathlib.Path(ROOT / file).read_text(encoding="utf-8"))
        CHECKS.that(more is not None, "the turn's line is there")
        ran(PATIENT + text.replace("firmware/interface/steadystep.eds", eds) + more[1] + "\nnetwork.disconnect()", served)
        CHECKS.that(wait_for(lambda: abs(true_position(served) - TURN_RAD) < 0.01), f"a turn: {true_position(served)} rad")


five_lines_operate_a_drive()
a_turn_by_canopen()
CHECKS.end()
