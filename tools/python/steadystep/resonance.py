"""The resonance of what hangs on the rotor, a belt or a coupling: found by small sines, and the settings that it asks for.

At each frequency the reference swings, and the drive records current and speed from the beginning of the motion on. A
sensorless drive loses a rotor that a heavy load behind a stiff belt swings; the sweep is made with so little of the law's
bandwidth that the rotor stays, and each sine ends by itself. A rotor that is lost all the same would run away, so the drive
opens its bridge there, whatever its policy; it is enabled again, and the swing is made with half the torque."""
import cmath
import contextlib
import dataclasses
import math
import time
from typing import TYPE_CHECKING, Iterator, Sequence

from . import capture_in_drive
from .capture_in_drive import CONTROL_PERIOD_S, Trigger
from .dictionary import Value
from .errors import DriveFault, LostLink, Refused, TimedOut
from .resonance_curve import BESIDE, NONE, Point, Resonance, find_minimum, is_passed, judge
from .settings import Progress, unseen

if TYPE_CHECKING:
    from .drive import Drive

CURRENT, SPEED = "i_q_A", "omega_est_rad_s"
LAWS = ("state-feedback", "feedback-linearisation")
LOWEST_Hz, PERIODS_A_CYCLE = 20.0, 20   # of a sine of the drive
STEP, FINE_STEP, FINE = 1.1, 1.03, 3    # from frequency to frequency; about what was found
RAMP_S, SETTLING_S, LOOK_S, REST_S = 0.05, 0.05, 0.12, 0.1
FEWEST_CYCLES, SAMPLES_A_CYCLE = 8, 10
SWEEP_PERCENT = 15                      # rotor_inertia_percent of the sweep
SENSORLESS_SHARE, MOST_SHARE = 0.2, 0.5  # of the rated torque
LIMIT_SHARE = 0.8                       # of current_limit_A
DETENT_ZERO = 3.8317 / 4                # N amplitude at which the detent torque, 4 N to a turn, averages out: zero of J1
DETENT_SHARE, DETENT_LOWER = 0.05, 0.3  # of the holding torque; of the stiffness
TRIES = 3                               # with half the torque each, where a rotor loses step
LOST = ("lost-synchronism", "stalled", "following-error", "estimate-range")  # faults of a swing that is too strong
TURNS = "offset-range"                  # fault of enabling where the rotor still turns
COMES_TO_REST_S, REST_TRIES = 0.3, 5
ENABLED, OFF = ("OPERATION ENABLED", "SWITCHED ON"), ("SWITCH ON DISABLED", "READY TO SWITCH ON")


@dataclasses.dataclass(frozen=True)
class Plan:
    """A sweep of a drive: what it may do is checked, and nothing has moved yet."""

    drive: "Drive"
    lowest_Hz: float
    highest_Hz: float
    torque_share: float
    inertia_kgm2: float
    rated_torque_Nm: float
    rotor_teeth: int

    def share(self, frequency_Hz: float) -> float:
        """Of the rated torque, for the inertia alone. More where that takes a light rotor across its detent torque, which
        would pass for a spring."""
        crossing_rad = DETENT_ZERO / self.rotor_teeth
        torque_share = self.inertia_kgm2 * (2 * math.pi * frequency_Hz) ** 2 * crossing_rad / self.rated_torque_Nm
        if torque_share > MOST_SHARE:  # above the frequency of MOST_SHARE it falls with one over the frequency
            torque_share = MOST_SHARE * math.sqrt(MOST_SHARE / torque_share)
        return max(torque_share, self.torque_share)

    def amplitude_rad(self, frequency_Hz: float) -> float:
        torque_Nm = self.share(frequency_Hz) * self.rated_torque_Nm
        return torque_Nm / (self.inertia_kgm2 * (2 * math.pi * frequency_Hz) ** 2)

    @property
    def most_amplitude_rad(self) -> float:
        return self.amplitude_rad(self.lowest_Hz)

    @property
    def frequencies_Hz(self) -> list[float]:
        count = math.floor(math.log(self.highest_Hz / self.lowest_Hz) / math.log(STEP))
        return [self.lowest_Hz * STEP**n for n in range(count + 1)]

    def detent_per_s2(self, frequency_Hz: float) -> float:
        """Stiffness over inertia of a detent torque of 5 % of the holding torque, of the 2 to 7 % that data sheets state, averaged
        over the swing, 2 J1(x)/x of a series, but for its lower harmonics."""
        x = 4 * self.rotor_teeth * self.amplitude_rad(frequency_Hz)
        averaged = 1 - x**2 / 8 + x**4 / 192 - x**6 / 9216 if x < 4 * DETENT_ZERO else 0.0
        stiffness = 4 * self.rotor_teeth * DETENT_SHARE * math.sqrt(2) * self.rated_torque_Nm
        return max(averaged, DETENT_LOWER) * stiffness / self.inertia_kgm2

    def run(self, progress: Progress = unseen) -> Resonance:
        """Raises DriveFault, LostLink, TimedOut; the settings are what they were, and the drive is enabled if it was."""
        with _settings_of_the_sweep(self.drive, progress):
            return _Sweep(self, progress).run()


def plan(drive: "Drive", lowest_Hz: float = 30.0, highest_Hz: float | None = None,
         torque_share: float | None = None) -> Plan:
    """Of a drive at rest, enabled or not; torque_share: 0.2, and 0.5 with an encoder, which loses no rotor. Raises Refused where
    no sweep is possible."""
    most_Hz = 1 / (PERIODS_A_CYCLE * CONTROL_PERIOD_S)
    highest_Hz = 0.9 * most_Hz if highest_Hz is None else highest_Hz
    if torque_share is None:
        torque_share = MOST_SHARE if drive.settings["feedback"] == "encoder" else SENSORLESS_SHARE
    if not LOWEST_Hz <= lowest_Hz < highest_Hz <= most_Hz or not 0.05 <= torque_share <= MOST_SHARE:
        raise Refused(f"resonance: expected frequencies of {LOWEST_Hz:g}…{most_Hz:g} Hz, the lower one first, and a share "
                      f"of 0.05…{MOST_SHARE:g} of the rated torque")
    state = drive.state
    if state == "FAULT":
        drive.raise_fault()
    if state not in (*ENABLED, *OFF):
        raise Refused(f"resonance: the drive is {state.lower()}: enable or disable it first")
    if drive.read("reference_moving"):
        raise Refused("resonance: the axis moves; stop it first")
    settings = drive.settings
    if settings["law"] not in LAWS:
        raise Refused(f"resonance: the law is {settings['law']}; a sweep needs {' or '.join(LAWS)}")
    if not capture_in_drive.is_there(drive.objects):
        raise Refused("resonance: this drive records nothing by itself, and a link is too slow for it")
    rated_A, limit_A = number(settings["rated_current_A"]), number(settings["current_limit_A"])
    if MOST_SHARE * rated_A > LIMIT_SHARE * limit_A:
        raise Refused(f"resonance: current_limit_A leaves no torque to swing with; it takes {MOST_SHARE / LIMIT_SHARE:g} of "
                      "rated_current_A")
    return Plan(drive, lowest_Hz, highest_Hz, torque_share, number(settings["inertia_kgm2"]),
                number(settings["torque_constant_Nm_A"]) * rated_A, int(number(settings["rotor_teeth"])))


def number(value: Value) -> float:
    assert isinstance(value, (int, float))
    return float(value)


# ---- the settings of the sweep ----


def default_bandwidth_rad_s(drive: "Drive") -> float:
    """Of a rigid machine: default_settings.c."""
    fast = (drive.settings["law"], drive.settings["feedback"]) == ("feedback-linearisation", "encoder")
    return 900.0 if fast else 300.0


def switch_off(drive: "Drive") -> None:
    drive.disable()
    end = time.monotonic() + 5.0
    while drive.state not in (*OFF, "FAULT"):
        if time.monotonic() > end:
            raise TimedOut("the drive has not switched off within 5 s")
        time.sleep(0.01)


@contextlib.contextmanager
def _settings_of_the_sweep(drive: "Drive", progress: Progress) -> Iterator[None]:
    settings, enabled = drive.settings, drive.state in ENABLED
    before = {name: settings[name] for name in ("synchronism_policy", "rotor_inertia_percent")}
    try:
        switch_off(drive)
        settings["synchronism_policy"] = "fault"
        percent = number(before["rotor_inertia_percent"])
        settings["rotor_inertia_percent"] = min(percent, SWEEP_PERCENT)
        drive.enable(progress=progress)
        default_rad_s = 0.01 * min(percent, SWEEP_PERCENT) * default_bandwidth_rad_s(drive)
        given_rad_s = number(settings["law_bandwidth_rad_s"])
        if given_rad_s > 1.01 * default_rad_s:  # it does not heed the percentage
            before["law_bandwidth_rad_s"] = given_rad_s
            switch_off(drive)
            settings["law_bandwidth_rad_s"] = default_rad_s
            drive.enable(progress=progress)
        yield
    finally:
        _restore(drive, before, enabled)


def _restore(drive: "Drive", before: dict[str, Value], enabled: bool) -> None:
    """Whatever has happened; an interrupt that comes meanwhile waits for it."""
    interrupted = False
    for last in (False, True):
        try:
            put_back(drive, before, enabled)
            break
        except KeyboardInterrupt:
            if last:
                raise
            interrupted = True
        except LostLink as lost:
            values = ", ".join(f"{name} = {value}" for name, value in before.items())
            raise LostLink(f"{lost}; the settings of the sweep may be in force, before it they were: {values}") from None
    if interrupted:
        raise KeyboardInterrupt


def put_back(drive: "Drive", before: dict[str, Value], enabled: bool) -> None:
    in_fault = drive.state == "FAULT"
    if not in_fault:
        switch_off(drive)
    for name, value in before.items():
        drive.settings[name] = value
    if enabled and not in_fault:
        drive.enable()


# ---- the sweep ----


class _Sweep:
    """Of an enabled drive with the settings of the sweep."""

    def __init__(self, plan: Plan, progress: Progress) -> None:
        self._plan, self._drive, self._progress = plan, plan.drive, progress
        self._found: dict[float, complex] = {}
        self._torque = 1.0  # of the plan's
        self._torque_at: dict[float, float] = {}
        self._lost_step = False
        self._constant = plan.rated_torque_Nm / number(plan.drive.settings["rated_current_A"])

    @property
    def points(self) -> list[Point]:
        return [Point(frequency_Hz, self._found[frequency_Hz]) for frequency_Hz in sorted(self._found)]

    def run(self) -> Resonance:
        coarse, lost_Hz = self._plan.frequencies_Hz, None
        total = len(coarse) + 2 * FINE + 1
        for frequency_Hz in coarse:
            if not self._measure(frequency_Hz, total):
                lost_Hz = frequency_Hz
                break
            if is_passed(self.points):
                break
        about = find_minimum(self.points)
        if about and about.verdict != NONE:
            for n in range(-FINE, FINE + 1):
                frequency_Hz = about.frequency_Hz * FINE_STEP**n
                if coarse[0] <= frequency_Hz <= self._plan.highest_Hz:
                    self._torque = self._torque_about(about.frequency_Hz)
                    self._measure(frequency_Hz, total)
        self._progress("sweeping", 1.0)
        return dataclasses.replace(self._judged(lost_Hz), lost_step=self._lost_step)

    def _judged(self, lost_Hz: float | None) -> Resonance:
        found = find_minimum(self.points)
        if not found:
            return judge(self.points, lost_Hz)
        beside = [torque for at_Hz, torque in self._torque_at.items() if 1 / BESIDE < at_Hz / found.frequency_Hz < BESIDE]
        return judge(self.points, lost_Hz, self._plan.detent_per_s2(found.frequency_Hz), min(beside))

    def _torque_about(self, frequency_Hz: float) -> float:
        return self._torque_at[min(self._torque_at, key=lambda one: abs(one - frequency_Hz))]

    def _measure(self, frequency_Hz: float, total: int) -> bool:
        """False: the rotor loses step there."""
        self._progress(f"{frequency_Hz:.0f} Hz", min(len(self._found) / total, 0.99))
        for _ in range(TRIES):
            try:
                self._found[frequency_Hz], self._torque_at[frequency_Hz] = self._inertia_at(frequency_Hz), self._torque
                return True
            except DriveFault as fault:
                if fault.name not in LOST:
                    raise
            self._torque, self._lost_step = self._torque / 2, True
            _enable_again(self._drive)
        return False

    def _inertia_at(self, frequency_Hz: float) -> complex:
        """As a share of that of the settings. Raises DriveFault, of LOST where the rotor has lost step."""
        begin_s, look_s = RAMP_S + SETTLING_S, max(LOOK_S, FEWEST_CYCLES / frequency_Hz)
        divider = max(1, int(1 / (CONTROL_PERIOD_S * SAMPLES_A_CYCLE * frequency_Hz)))
        made = capture_in_drive.record_in_drive(
            self._drive.objects, [self._drive.known.signal(name) for name in (CURRENT, SPEED)], begin_s + look_s,
            1 / (CONTROL_PERIOD_S * divider), CONTROL_PERIOD_S, unseen, Trigger("reference_moving", timeout_s=5.0),
            lambda: self._begin(frequency_Hz, begin_s + look_s + RAMP_S))
        _rest(self._drive)
        omega = 2 * math.pi * frequency_Hz
        first = next(n for n, at in enumerate(made.time_s) if at >= begin_s)
        half = (first + len(made)) // 2
        current, speed = (_phasor(made.time_s[first:], made[name][first:], omega) for name in (CURRENT, SPEED))
        late = _phasor(made.time_s[half:], made[SPEED][half:], omega)
        if not speed or abs(late) < 0.3 * abs(speed):
            raise TimedOut(f"the sine of {frequency_Hz:.0f} Hz has ended before its time: what has stopped it?")
        return self._constant * current / (1j * omega * speed) / self._plan.inertia_kgm2

    def _begin(self, frequency_Hz: float, lasts_s: float) -> None:
        try:
            self._drive.command("sine", amplitude_rad=self._torque * self._plan.amplitude_rad(frequency_Hz),
                                frequency_Hz=frequency_Hz, cycles=math.ceil(lasts_s * frequency_Hz), ramp_s=RAMP_S)
        except Refused:
            if self._drive.fault:
                self._drive.raise_fault()
            raise


def _enable_again(drive: "Drive") -> None:
    """Behind a fault of the swing, as soon as the rotor has come to rest."""
    for tries_left in reversed(range(REST_TRIES)):
        drive.reset()
        _rest(drive, COMES_TO_REST_S)
        try:
            drive.enable()
            return
        except DriveFault as fault:
            if fault.name != TURNS or not tries_left:
                raise


def _rest(drive: "Drive", lasts_s: float = REST_S) -> None:
    """Until the reference has rested for so long: for the hold to have the rotor, or a lost one to have stopped. By the drive's
    clock: a simulated one may be slow."""
    end, since = time.monotonic() + 20, None
    while True:
        if drive.fault:
            drive.raise_fault()
        period = int(drive.read("period"))
        if drive.read("reference_moving"):
            since = None
        elif since is None:
            since = period
        elif (period - since) % 2**32 * CONTROL_PERIOD_S >= lasts_s:
            return
        if time.monotonic() > end:
            raise TimedOut("the axis has not come to rest within 20 s")
        time.sleep(0.002)


def _phasor(time_s: Sequence[float], values: Sequence[float], omega: float) -> complex:
    """Under a window that fades in and out, so that no whole cycles are needed."""
    count = len(values)
    window = [math.sin(math.pi * (n + 0.5) / count) ** 2 for n in range(count)]
    mean = sum(w * value for w, value in zip(window, values)) / sum(window)
    return sum(w * (value - mean) * cmath.exp(-1j * omega * at)
               for w, value, at in zip(window, values, time_s)) / sum(window)
