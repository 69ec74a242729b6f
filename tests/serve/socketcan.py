"""SocketCAN, the CAN of the Linux kernel, on a served drive: slcand makes a network of the drive's
serial line, and an unmodified python-canopen, candump and cansend use it.

The kernel is Debian's user-mode Linux: it has slcan, boots in a second and needs no privilege; its
root is the host's, read-only. Skipped, with exit code 77, where it is not installed: tools/setup
kernel installs it.

usage: socketcan.py SIL
"""
import contextlib
import math
import os
import pathlib
import re
import shutil
import signal
import subprocess
import sys
import time

import canopen_bus  # noqa: F401: says so if there is no python-canopen
from served import Checks, Line, Served

INIT = pathlib.Path(__file__).resolve().with_name("socketcan_init.sh")
PATH = os.pathsep.join([os.environ["PATH"], "/usr/sbin", "/sbin"])
NEEDED = ("linux.uml", "slcand", "candump", "cansend", "insmod", "ip")
LONGEST_S = 90
SKIPPED = 77


def boot(served):
    """What the machine says on its console until it is off, after LONGEST_S at the latest, and the
    plant's states meanwhile."""
    knobs, states = Line(str(served.knobs_link)), []
    console = served.folder / "console"
    # TMPDIR holds the machine's memory, for which a container's /dev/shm is too small.
    with open(console, "wb") as output:
        machine = subprocess.Popen(
            ["linux.uml", "mem=96M", "quiet", "rootfstype=hostfs", "rootflags=/", "ro",
             f"uml_dir={served.folder}", "umid=machine",
             "con=null", "con0=null,fd:1", "ssl=null", f"ssl0=tty:{served.link.resolve()}",
             f"init={INIT}", "--", sys.executable],
            env={**os.environ, "TMPDIR": str(served.folder)}, start_new_session=True,
            stdin=subprocess.DEVNULL, stdout=output, stderr=subprocess.STDOUT)
    # A machine is a group of processes, which would outlive this one if it is killed.
    guard = subprocess.Popen(
        ["sh", "-c", 'read -r _ || kill -KILL "$@"', "sh", f"-{machine.pid}",
         str(served.process.pid)], start_new_session=True, stdin=subprocess.PIPE)
    end = time.monotonic() + LONGEST_S
    try:
        while machine.poll() is None and time.monotonic() < end:
            states.append(knobs.ask("state"))
            time.sleep(0.05)
    finally:
        with contextlib.suppress(ProcessLookupError):
            os.killpg(machine.pid, signal.SIGKILL)
        machine.wait()
        guard.communicate(b"\n")
        knobs.close()
    return console.read_text(errors="replace").splitlines(), states


def the_client_is_content(said):
    verdicts = [line for line in said if line.startswith(("ok ", "FAILED "))]
    for line in verdicts:
        CHECKS.that(line.startswith("ok "), line)
    CHECKS.that(len(verdicts) == 11, f"all of the client's checks, {len(verdicts)}")
    CHECKS.that("exit code 0" in said, "it ends in order")


def the_kernel_has_nothing_to_complain_of(said):
    for counter in ("rx_errors", "rx_over_errors", "rx_dropped", "tx_errors", "tx_dropped"):
        CHECKS.that(f"{counter} 0" in said, f"no {counter}")


def candump_shows(said):
    """Frames of both directions, as "ID#DATA", in the order in which the kernel saw them."""
    frames = [found[1] for found in (re.match(r"\(\d+\.\d+\) can0 (\S+)$", line)
                                     for line in said) if found]
    CHECKS.that(frames[:2] == ["601#4000100000000000", "581#4300100092010400"],
                f"cansend asks for 1000h, the drive answers: {frames[:2]}")
    for frame, what in (("701#00", "boot-up"), ("701#05", "a heartbeat, operational"),
                        ("201#1F00", "the set-point's controlword, an RPDO")):
        CHECKS.that(frame in frames, what)
    statuswords = [int.from_bytes(bytes.fromhex(frame[4:8]), "little") for frame in frames
                   if frame.startswith("181#")]
    states = [word & 0x6F for word in statuswords]
    path = [state for state, last in zip(states, [None, *states]) if state != last]
    CHECKS.that(path == [0x40, 0x21, 0x23, 0x27, 0x40], f"states by TPDO: {list(map(hex, path))}")


def the_rotor_has_turned(states):
    held = [state for state in states if "state=operation-enabled" in state]
    truth = float(held[-1].split("theta_rad=")[1].split()[0]) if held else math.nan
    CHECKS.that(abs(truth - 2 * math.pi) < 0.01, f"the rotor has turned once: {truth} rad")


def the_console_is_back(served):
    console = Line(str(served.link))
    CHECKS.that(console.ask("state").startswith("ok switch-on-disabled"),
                "slcand has closed the channel, the console answers")
    console.close()


MISSING = [name for name in NEEDED if not shutil.which(name, path=PATH)]
if MISSING:
    print(f"skipped: no {', '.join(MISSING)}: tools/setup kernel installs what is missing")
    sys.exit(SKIPPED)
signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))
CHECKS = Checks()
with Served() as served:
    SAID, STATES = boot(served)
    the_client_is_content(SAID)
    the_kernel_has_nothing_to_complain_of(SAID)
    candump_shows(SAID)
    the_rotor_has_turned(STATES)
    the_console_is_back(served)
    CHECKS.that(served.end()[0] == 0, "the server ends in order")
if CHECKS.failed:
    print("\nThe console:", *SAID, sep="\n")
CHECKS.end()
