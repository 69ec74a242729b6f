"""The command `steadystep`, as a person types it, on a drive that several programs share.

usage: command_line.py SIL
"""
import os
import subprocess
import sys
import tempfile
import threading
import time

from canopen_bus import Bus, wait_for
from operated import Simulated, environment, refusal, steadystep
from served import Checks
from steadystep.byte_line import open_line
from steadystep.share import Share

CHECKS = Checks()
SIL = sys.argv[1]


def typed(port, *words, given=None):
    """Exit code, and what was said."""
    done = subprocess.run([sys.executable, "-m", "steadystep", *map(str, words)], text=True, input=given,
                          env={**environment(), "STEADYSTEP_PORT": port}, capture_output=True, timeout=60,
                          check=False)
    return done.returncode, done.stdout + done.stderr


def each_command_does_its_own(port, folder):
    for words, code, said in (
            (("settings", "set", "current_limit_A", 2), 0, "current_limit_A = 2.0  # A"),
            (("settings", "set", "law", "best"), 2, "steadystep: law: expected one of"),
            (("settings", "set", "current_limit_A", "1,5"), 2, "current_limit_A: expected a number in 0.01 × rated…2 × rated A, got '1,5'"),
            (("settings", "get", "current_limit_A"), 0, "current_limit_A = 2.0  # A"),
            (("command", "sine", "amplitude_rad"), 2, "amplitude_rad: expected a parameter as NAME=NUMBER"),
            (("move", 1.5, "--enable"), 0, "at 1."),
            (("move", -0.5, "--relative"), 0, "at "),
            (("move", "-5e-1", "--relative"), 0, "at "),
            (("capture", "theta_est_rad", "--duration", 0.1, "--out", f"{folder}/a.csv"), 0, "samples"),
            (("home", "here", "--at", 1), 0, "homed; at "),
            (("home", "index-up"), 1, "not homed, index-up: none has passed"),
            (("home", "up"), 2, "expected one of here, stop-down"),
            (("faults",), 0, "now: none"),
            (("--node", 7, "state"), 2, "node 7 does not answer"),
            (("--node", 0, "state"), 2, "expected a number in 1…127"),
            (("page", "--http", 80000), 2, "expected a number in 0…65535"),
            (("settings", "motor", "17hs4417"), 2, "disable first")):
        found, text = typed(port, *words)
        CHECKS.that(found == code and said in text, f"{words}: {found} {text}")
    code, text = typed(port, "settings", "export")
    CHECKS.that(code == 0 and "current_limit_A = 2.0  # A\n" in text, f"export: {code}")
    code, said = typed(port, "settings", "import", "-", given=text.replace("limit_A = 2.0", "limit_A = 2.5"))
    CHECKS.that("changed: current_limit_A\n" in said, f"import: {code} {said}")


def a_motor_is_chosen_beside_another_program(port, share):
    """Whose transfers wait while the console is asked what follows."""
    wrong, ended = [], threading.Event()

    def read(drive):
        while not ended.is_set():
            begin = time.monotonic()
            if drive.settings["rotor_teeth"] != 50 or time.monotonic() - begin > 1.5:
                wrong.append(f"{time.monotonic() - begin:.2f} s")

    with steadystep.Drive(share.line()) as drive:
        drive.disable()
        reader = threading.Thread(target=read, args=(drive,))
        reader.start()
        code, text = typed(port, "settings", "motor", "17hs4417")
        CHECKS.that(code == 0 and "current_limit_A = 1.7  # A, rated; what follows from a motor follows this one\n" in text, text)
        code, text = typed(port, "settings", "export")
        CHECKS.that(code == 0 and "hold_current_A = nan  # A\n" in text, text)
        ended.set()
        reader.join()
    CHECKS.that(not wrong, f"it has its answers, soon: {wrong}")


def programs_take_turns(share):
    """Their transfers do not meet, whatever each is in the midst of."""
    drives = [steadystep.Drive(share.line()) for _ in range(2)]
    drives.append(steadystep.Drive(f"tcp://127.0.0.1:{share.tcp_port}"))
    wrong = []

    def read(drive):
        try:
            for _ in range(40):
                if drive.settings["inductance_H"] != 0.0009 or drive.settings["rotor_teeth"] != 50:
                    wrong.append("another's answer")
        except steadystep.SteadystepError as error:
            wrong.append(str(error))

    threads = [threading.Thread(target=read, args=(drive,)) for drive in drives]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    CHECKS.that(not wrong, f"each has its own answers: {wrong}")
    drives[0].close()
    CHECKS.that(drives[1].state == "OPERATION ENABLED", "one that goes leaves the channel to the others")
    for drive in drives[1:]:
        drive.close()


def a_foreign_client_shares_it(link, drive):
    with Bus(link) as bus:
        bus.node.setup_402_state_machine()
        bus.node.nmt.state = "OPERATIONAL"
        CHECKS.that(wait_for(lambda: bus.node.state == "OPERATION ENABLED"), "python-canopen sees the state")
        bus.node.op_mode = "PROFILED POSITION"
        bus.node.sdo[0x607A].raw = 32768
        bus.node.controlword = 0x1F
        CHECKS.that(wait_for(lambda: abs(drive.position_rad - 3.1416) < 0.01), "and moves it")
        bus.node.controlword = 0x0F
    CHECKS.that(drive.state == "OPERATION ENABLED", "behind it the drive goes on")


def what_goes_on_ends_in_order(port, folder):
    """Terminated, it takes its links and its simulation along; so does a program that does not close its simulation."""
    for words, links in ((("simulate", "--simulator", SIL, "--link", f"{folder}/simulated"), ("simulated", "simulated-knobs")),
                         (("--port", port, "share", "--link", f"{folder}/shared"), ("shared",))):
        process = subprocess.Popen([sys.executable, "-m", "steadystep", *words], env=environment(), stdout=subprocess.PIPE,
                                   stderr=subprocess.PIPE, text=True)
        CHECKS.that(process.stdout.readline() != "" and wait_for(
            lambda: all(os.path.exists(f"{folder}/{link}") for link in links)), f"{words}: it serves")
        process.terminate()
        process.communicate(timeout=20)
        CHECKS.that(not any(os.path.lexists(f"{folder}/{link}") for link in links), f"{words}: no link stays")
    done = subprocess.run([sys.executable, "-c", f"import steadystep; print(steadystep.simulator.Simulated(program={SIL!r}).place)"],
                          env=environment(), capture_output=True, text=True, timeout=60, check=False)
    found = refusal(lambda: open_line(done.stdout.strip()), steadystep.WrongPort)
    CHECKS.that("no drive is served there" in found, f"{done.stdout}{done.stderr}: {found}")


with tempfile.TemporaryDirectory() as scratch, Simulated(program=SIL) as simulated:
    LINK = f"{scratch}/drive"
    SHARE = Share(open_line(simulated.place), LINK, 0)
    each_command_does_its_own(LINK, scratch)
    programs_take_turns(SHARE)
    with steadystep.Drive(SHARE.line()) as DRIVE:
        a_foreign_client_shares_it(LINK, DRIVE)
    a_motor_is_chosen_beside_another_program(LINK, SHARE)
    SHARE.close()
    what_goes_on_ends_in_order(simulated.place, scratch)
    CHECKS.that(not os.path.lexists(LINK), "no link stays")
CHECKS.end()
