"""`Drive.find_resonance` and the command `steadystep resonance` on served drives with a belt: what is found, proposed, and put
back. And how a curve is judged.

usage: resonance.py SIL [full]    full: more belts, a rigid machine, an encoder
"""
import cmath
import math
import pathlib
import signal
import subprocess
import sys
import tempfile
import threading
import time

from operated import Simulated, environment, refusal, steadystep
from served import Checks
from steadystep import resonance
from steadystep.resonance_curve import FOUND, NONE, NOT_SURE, Point, find_antiresonance, judge
from steadystep.resonance_proposal import propose

CHECKS = Checks()
SIL = sys.argv[1]
SWEPT = ("synchronism_policy", "rotor_inertia_percent", "law_bandwidth_rad_s")


# ---- a curve ----


def curve(of, lowest_Hz=30.0, highest_Hz=450.0):
    count = int(math.log(highest_Hz / lowest_Hz) / math.log(1.1))
    return [Point(f, of(f)) for f in (lowest_Hz * 1.1**n for n in range(count + 1))]


def belt(share, resonance_Hz, damping=0.05):
    """The apparent inertia in front of one."""
    def of(frequency_Hz):
        x = frequency_Hz / (resonance_Hz * math.sqrt(1 - share))
        spring = 1 + 2j * damping * x
        return 1 - share + share * spring / (spring - x * x)
    return of


def with_detent(of, swing_Hz, friction=0.0):
    """A spring to the ground and friction besides: what is shown falls to nothing, and turns, below."""
    return lambda frequency_Hz: of(frequency_Hz) - (swing_Hz / frequency_Hz) ** 2 - 1j * friction * 30 / frequency_Hz


def rigid(_):
    return 1 + 0j


def estimated(of, corner_Hz=250.0):
    """As the estimate shows it: less, and later, above its corner."""
    return lambda frequency_Hz: of(frequency_Hz) / (1 - 0.6j * frequency_Hz / corner_Hz)


def a_resonance_is_placed():
    for share in (0.3, 0.5, 0.7):
        for at_Hz in (80.0, 120.0, 200.0):
            for seen in (lambda of: of, estimated):
                found = judge(curve(seen(belt(share, at_Hz))))
                CHECKS.that(found.verdict == FOUND and abs(found.resonance_Hz / at_Hz - 1) < 0.06,
                            f"{share} behind {at_Hz} Hz: {found}")
    found = judge(curve(belt(0.5, 120.0)))
    CHECKS.that(abs(found.antiresonance_Hz - 85) < 5 and abs(found.rotor_share - 0.5) < 0.1, f"{found} {found.rotor_share}")


def what_is_no_resonance_is_none():
    for what, of in (("rigid", rigid), ("seen by the estimate", estimated(rigid)),
                     ("friction below", with_detent(rigid, 0.0, friction=1.0)),
                     ("detent torque below", with_detent(rigid, 25.0, friction=0.3)),
                     ("a ripple", lambda f: 1 + 0.15 * math.sin(f / 15)),
                     ("a belt far above", belt(0.5, 1500.0))):
        found = judge(curve(of))
        CHECKS.that(found.verdict == NONE and found.resonance_Hz is None, f"{what}: {found}")


def friction_and_detent_torque_below_do_not_hide_one():
    for swing_Hz in (15.0, 25.0):
        found = judge(curve(with_detent(belt(0.5, 160.0), swing_Hz, friction=0.3)))
        CHECKS.that(found.verdict == FOUND and abs(found.resonance_Hz / 160 - 1) < 0.06, f"detent {swing_Hz} Hz: {found}")


def at_an_edge_nothing_is_certain():
    found = judge(curve(belt(0.5, 470.0)))
    CHECKS.that(found.verdict != FOUND, f"above the highest: {found}")
    found = judge(curve(belt(0.5, 32.0)))
    CHECKS.that(found.verdict != FOUND, f"at the lowest: {found}")
    found = judge(curve(rigid, highest_Hz=200.0), lost_Hz=220.0)
    CHECKS.that(found.verdict == NOT_SURE and "lost step at 220 Hz" in str(found), f"lost on the way: {found}")
    CHECKS.that("rigid" not in str(found) and "varies" not in str(found), f"and nothing else is said of it: {found}")
    found = judge(curve(lambda f: (f / 100) ** -1.5))
    CHECKS.that(found.verdict == NOT_SURE and "varies" in str(found), f"no minimum, and not rigid: {found}")
    shallow = judge(curve(lambda f: 1 - 0.4 * cmath.exp(-(math.log(f / 150) / 0.1) ** 2 - 9j * math.log(f / 150))))
    CHECKS.that(shallow.verdict != FOUND, f"little less is not certain: {shallow}")
    still = judge(curve(lambda f: 1 - 0.7 * math.exp(-(math.log(f / 110) / 0.15) ** 2)))
    CHECKS.that(still.verdict != FOUND, f"nor what does not turn the angle: {still}")
    found = judge(curve(belt(0.5, 380.0)))
    CHECKS.that(found.verdict == NOT_SURE, f"nor what hardly rises again: {found}")
    CHECKS.that(judge(curve(belt(0.5, 120.0)), torque=0.25).verdict == NOT_SURE, "with next to no torque")
    CHECKS.that(find_antiresonance(curve(rigid), 400.0) is None, "nor is there an antiresonance")


def a_swing_on_the_detent_torque_is_not_certain():
    """A light rotor at rest swings on it, rigid as it may be."""
    for of, lowest_Hz in ((with_detent(rigid, 80.0), 30.0), (belt(0.5, 120.0), 90.0)):  # where it may be either
        found = judge(curve(of, lowest_Hz), detent_per_s2=(2 * math.pi * 80) ** 2)
        CHECKS.that(found.verdict == NOT_SURE, str(found))
    CHECKS.that(judge(curve(belt(0.5, 120.0), 90.0)).verdict == FOUND, "but for the detent torque it would be")


def the_detent_torque_makes_it_a_range():
    found = judge(curve(belt(0.5, 120.0)), detent_per_s2=(2 * math.pi * 33) ** 2)
    CHECKS.that(found.without_detent_Hz < 0.97 * found.resonance_Hz and " to 1" in str(found), str(found))


# ---- a swing that is too strong ----


class Sweeper:
    """A drive whose rotor turns for a while behind each fault, and a sweep of it that ends in given faults."""

    def __init__(self, *faults):
        self.faults, self.torques, self.period, self.turns, self.resets = list(faults), [], 0, 0, 0
        self.sweep = resonance._Sweep(resonance.Plan(self, 40.0, 400.0, 0.2, 1e-5, 0.4, 50), lambda what, share: None)
        self.sweep._inertia_at = self.swing

    settings, fault = {"torque_constant_Nm_A": 0.1, "rated_current_A": 4.0}, None

    def swing(self, _):
        self.torques.append(self.sweep._torque)
        if self.faults and self.faults[0]:
            raise steadystep.DriveFault(self.faults.pop(0), 0, "", "")
        return 1 + 0j

    def read(self, name):
        self.period += 1000
        return self.period if name == "period" else 0

    def reset(self):
        self.resets += 1

    def enable(self):
        if self.turns > 0:
            self.turns -= 1
            raise steadystep.DriveFault(resonance.TURNS, 0, "", "")


def a_swing_that_is_too_strong_is_made_with_half_the_torque():
    for fault in ("lost-synchronism", "stalled", "following-error", "estimate-range"):
        drive = Sweeper(fault)
        CHECKS.that(drive.sweep._measure(100.0, 10) and drive.torques == [1.0, 0.5], f"{fault}: {drive.torques}")
    drive = Sweeper("stalled", "stalled", "stalled")
    CHECKS.that(not drive.sweep._measure(100.0, 10) and drive.torques == [1.0, 0.5, 0.25], f"twice: {drive.torques}")
    drive = Sweeper("current-sensor-b")
    CHECKS.that(refusal(lambda: drive.sweep._measure(100.0, 10), steadystep.DriveFault) and drive.torques == [1.0],
                "what the swing is not to blame for ends it")


def a_rotor_that_still_turns_is_waited_for():
    drive = Sweeper("lost-synchronism")
    drive.turns = 3
    CHECKS.that(drive.sweep._measure(100.0, 10) and drive.resets == 4, f"{drive.resets} resets")
    drive = Sweeper("lost-synchronism")
    drive.turns = 100
    CHECKS.that(refusal(lambda: drive.sweep._measure(100.0, 10), steadystep.DriveFault) and drive.resets == 5, "not for ever")


# ---- a served drive ----


def belted(share, belt_Hz, *more):
    given = ["plant=as-built", *more]
    if share:
        given += [f"plant.belt_inertia_share={share}", f"plant.belt_frequency_Hz={belt_Hz}"]
    return Simulated("--speed", "2", *(word for one in given for word in ("--set", one)), program=SIL)


def in_force(drive):
    return [drive.settings[name] for name in SWEPT]


def it_is_found(share, belt_Hz, *more):
    with belted(share, belt_Hz, *more) as simulated, steadystep.Drive(simulated.place) as drive:
        drive.enable()
        before = in_force(drive)
        CHECKS.that(before[2] == resonance.default_bandwidth_rad_s(drive), f"the default bandwidth is the drive's: {before}")
        drive.disable()
        found = drive.find_resonance(lowest_Hz=40.0)
        CHECKS.that(found.verdict == FOUND and abs(found.resonance_Hz / belt_Hz - 1) < 0.06, f"{share}, {belt_Hz} Hz: {found}")
        CHECKS.that(drive.state == "SWITCH ON DISABLED", f"switched off, as it was: {drive.state}")
        drive.enable()
        CHECKS.that(in_force(drive) == before, f"put back: {in_force(drive)}")
        proposal = propose(drive, found)
        CHECKS.that(proposal.settings.keys() == {"rotor_inertia_percent"}, f"{proposal}")
        CHECKS.that(propose(drive, found, 0.42 * drive.settings["inertia_kgm2"]).settings
                    == {"rotor_inertia_percent": 42}, "of the data sheet")


def a_rigid_machine_has_none():
    with belted(0, 0) as simulated, steadystep.Drive(simulated.place) as drive:
        found = drive.find_resonance()
        CHECKS.that(found.verdict == NONE and "rigid" in str(found), f"rigid: {found}")


def the_command(folder):
    """A bandwidth that is given, an enabled drive, what is proposed applied."""
    with belted(0.5, 120) as simulated:
        with steadystep.Drive(simulated.place) as drive:
            drive.settings["law_bandwidth_rad_s"] = 250.0
            drive.enable()
        words = [sys.executable, "-m", "steadystep", "--port", simulated.place, "resonance", "--lowest", "60"]
        done = subprocess.run(words, input="n\n", env=environment(), capture_output=True, text=True, timeout=60, check=False)
        CHECKS.that(done.returncode == 2 and "nothing has moved" in done.stderr and "°" in done.stdout, f"{done}")
        done = subprocess.run([*words, "--apply", "--out", f"{folder}/a.csv"], input="y\n", env=environment(), capture_output=True,
                              text=True, timeout=100, check=False)
        CHECKS.that(done.returncode == 0 and "applied" in done.stdout, f"{done}")
        with steadystep.Drive(simulated.place) as drive:
            CHECKS.that(in_force(drive) == ["fault", 30, 90.0] and drive.state in resonance.ENABLED, f"{in_force(drive)}")
    rows = (pathlib.Path(folder) / "a.csv").read_text(encoding="utf-8").splitlines()
    CHECKS.that(rows[0] == "frequency_Hz,inertia_share,angle_deg" and len(rows) > 10, f"{rows[:2]}")


def what_is_cut_short_is_put_back():
    with belted(0.5, 120) as simulated:
        with steadystep.Drive(simulated.place) as drive:
            drive.enable()
            before = in_force(drive)
        command = subprocess.Popen([sys.executable, "-m", "steadystep", "--port", simulated.place, "resonance", "--yes"],
                                   env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        command.stdout.readline()  # it begins
        time.sleep(2)
        command.send_signal(signal.SIGINT)
        said = command.communicate(timeout=30)
        with steadystep.Drive(simulated.place) as drive:
            CHECKS.that(command.returncode == 1 and in_force(drive) == before, f"Ctrl-C: {said} {in_force(drive)}")
            CHECKS.that(drive.state in resonance.ENABLED, f"and enabled again: {drive.state}")
            timer = threading.Timer(3, lambda: simulated.knobs.turn("plant.bus_V = 8"))
            timer.start()
            found = refusal(drive.find_resonance, steadystep.DriveFault)
            timer.join()
            CHECKS.that(found.startswith("bus-voltage"), f"a fault ends it: {found}")
            CHECKS.that(in_force(drive)[:2] == before[:2] and drive.state == "FAULT", f"put back: {in_force(drive)}")
            CHECKS.that(refusal(drive.find_resonance, steadystep.DriveFault), "and keeps it from beginning")
            simulated.knobs.turn("plant.bus_V = 24")
            drive.reset()
            for name, value, said in (("law", "pid", "the law is pid"), ("current_limit_A", 1.0, "no torque to swing with")):
                kept = drive.settings[name]
                drive.settings[name] = value
                found = refusal(drive.find_resonance)
                CHECKS.that(said in found, f"{name}: {found}")
                drive.settings[name] = kept
            CHECKS.that("expected frequencies" in refusal(lambda: drive.find_resonance(highest_Hz=900.0)), "too high")
            drive.enable()
            drive.velocity(5)
            time.sleep(0.2)
            CHECKS.that("the axis moves" in refusal(drive.find_resonance), "in motion")
            drive.stop()
            CHECKS.that("enable or disable it first" in refusal(drive.find_resonance), f"stopped: {drive.state}")


a_resonance_is_placed()
what_is_no_resonance_is_none()
friction_and_detent_torque_below_do_not_hide_one()
at_an_edge_nothing_is_certain()
a_swing_on_the_detent_torque_is_not_certain()
the_detent_torque_makes_it_a_range()
a_swing_that_is_too_strong_is_made_with_half_the_torque()
a_rotor_that_still_turns_is_waited_for()
if sys.argv[2:] == ["full"]:
    for SHARE, BELT_Hz in ((0.5, 120), (0.7, 350), (0.5, 250)):
        it_is_found(SHARE, BELT_Hz)
    it_is_found(0.5, 120, "drive.feedback=encoder", "plant.encoder_counts_per_turn=4000")
    a_rigid_machine_has_none()
else:
    it_is_found(0.7, 300)
    with tempfile.TemporaryDirectory() as scratch:
        the_command(scratch)
    what_is_cut_short_is_put_back()
CHECKS.end()
