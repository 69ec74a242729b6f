"""The axis of a drive: signals, states of CiA 402, motion, faults."""
import math
import time
from typing import Callable, NoReturn

from .dictionary import Dictionary, Fault
from .errors import DriveFault, NotHomed, Refused, TimedOut
from .objects import Objects, OutOfRange
from .settings import Progress, unseen
from .states import state_of

LOOK_S = 0.01

PROFILE_POSITION, PROFILE_VELOCITY, HOMING, CYCLIC_TORQUE = 1, 3, 6, 10
TORQUE_CARRIED = 0x0200  # of 6502h
QUICK_STOP_OPTION, STAYS = 0x605A, 6  # in QUICK STOP ACTIVE, and holds
SHUTDOWN, SWITCH_ON, ENABLE_OPERATION, QUICK_STOP, RESET = 0x06, 0x07, 0x0F, 0x02, 0x80
NEW_SET_POINT, AT_ONCE, RELATIVE = 0x10, 0x20, 0x40
REFUSED, REACHED, ACKNOWLEDGED = 0x0080, 0x0400, 0x1000
START, ATTAINED, HOMING_ERROR = 0x10, 0x1000, 0x2000
HOMING_METHODS = {"here": 37, "stop-down": -1, "stop-up": -2, "index-down": 33, "index-up": 34, "limit-down": 17,
                  "limit-up": 18, "switch-down": 28, "switch-up": 24}
STOP_TORQUE, STOP_TRAVEL = (0x2403, 1), (0x2403, 2)
WHY_NOT = {"here": "the axis moves",
           "stop": "within its travel nothing bore the torque and stood, or no place was found twice, or the drive's law "
                   "knows no load",
           "index": "none has passed in a turn, or the drive has no encoder with an index",
           "limit": "no limit switch is wired there (inputs_used), or none within the travel",
           "switch": "no home switch is wired (inputs_used), or none within the travel and between the limit switches"}


class Axis:
    """Of a drive that is connected."""

    def __init__(self, objects: Objects, known: Dictionary) -> None:
        self.objects, self.known = objects, known
        self._seen_state = ""
        self._unit_rad = self._read_unit()

    def _read_unit(self) -> float:
        """CiA 402's factor group: rad in a position unit."""
        gear, feed = ([self.objects.read(index, sub) for sub in (1, 2)] for index in (0x6091, 0x6092))
        return float(2 * math.pi * feed[1] * gear[0] / (feed[0] * gear[1]))

    # ---- what it shows ----

    def read(self, signal: str) -> bool | int | float | str:
        """A signal by its name; of an enumeration its word."""
        row = self.known.signal(signal)
        number = self.objects.read(row.index)
        if row.name == "fault":
            return self.fault_name(number)
        if row.words == ("no", "yes"):
            return bool(number)
        if row.words:
            return row.words[int(number)]
        return number if isinstance(number, (int, float)) else float(number)

    def fault_name(self, code: int) -> str:
        return self.known.faults[code].name if code in self.known.faults else "none" if code == 0 else hex(code)

    @property
    def position_rad(self) -> float:
        return float(self.read("theta_est_rad"))

    @property
    def speed_rad_s(self) -> float:
        return float(self.read("omega_est_rad_s"))

    @property
    def status(self) -> int:
        status = int(self.objects.read(0x6041))
        self._seen_state = state_of(status)
        return status

    @property
    def state(self) -> str:
        """Of CiA 402."""
        return state_of(self.status)

    @property
    def fault(self) -> Fault | None:
        """Why the bridge is open; None: it is not in fault."""
        return self.known.faults.get(int(self.objects.read(0x603F)))

    @property
    def faults(self) -> list[Fault]:
        """The last ones since the channel was opened, the newest first."""
        count = int(self.objects.read(0x1003))
        codes = [int(self.objects.read(0x1003, n + 1)) & 0xFFFF for n in range(count)]
        return [self.known.faults[code] for code in codes if code in self.known.faults]

    def raise_fault(self) -> NoReturn:
        """The fault that it is in, with cause and remedy."""
        fault = self.fault
        if fault:
            raise DriveFault(fault.name, fault.code, fault.cause, fault.remedy)
        raise DriveFault("fault", 0, "its cause is gone", "reset it")

    # ---- states ----

    def _control(self, word: int) -> None:
        self.objects.write(0x6040, word)

    def enable(self, timeout_s: float = 10.0, progress: Progress = unseen) -> None:
        """Until it is ready to move. A fault is raised, not reset."""
        begin = time.monotonic()
        while (state := self.state) != "OPERATION ENABLED":
            if state == "FAULT":
                self.raise_fault()
            word = {"SWITCH ON DISABLED": SHUTDOWN, "READY TO SWITCH ON": SWITCH_ON,
                    "SWITCHED ON": ENABLE_OPERATION, "QUICK STOP ACTIVE": ENABLE_OPERATION}.get(state, 0)
            self._control(word)
            if word == SWITCH_ON and self.status & REFUSED:
                self._enable_in_words()
            passed_s = time.monotonic() - begin
            progress("enabling", min(passed_s / timeout_s, 1.0))
            if passed_s > timeout_s:
                raise TimedOut(f"enabling has not ended within {timeout_s:g} s; the drive is {state.lower()}")
            time.sleep(LOOK_S)
        self.objects.write(QUICK_STOP_OPTION, STAYS)  # ahead of a stop, whose process data does not wait for it
        progress("enabling", 1.0)

    def _enable_in_words(self) -> None:
        """A fieldbus has no words. The console says why not, or enables; where other nodes are on the line it may be
        one of theirs."""
        others = self.objects.others
        if others:
            raise Refused(f"node {self.objects.number} refuses to be enabled: settings or rotor forbid it; why, says the "
                          f"console of its own line, as this one is shared with node {', '.join(map(str, others))}")
        for answer in self.objects.ask_console("enable") or ["the drive refuses to be enabled"]:
            if not answer.startswith("ok"):
                raise Refused(answer.removeprefix("error: "))

    def disable(self) -> None:
        """Opens the bridge."""
        self._control(0)

    def reset(self, timeout_s: float = 2.0) -> None:
        """A fault; the bridge stays open."""
        self._control(0)
        self._control(RESET)
        self._until(lambda status: state_of(status) != "FAULT", timeout_s, "the fault has not gone")
        self._control(0)

    def _until(self, condition: Callable[[int], object], timeout_s: float, otherwise: str) -> int:
        end = time.monotonic() + timeout_s
        while True:
            status = self.status
            if condition(status):
                return status
            if time.monotonic() > end:
                raise TimedOut(f"{otherwise} within {timeout_s:g} s")
            time.sleep(LOOK_S)

    # ---- motion ----

    def _in_mode(self, mode: int) -> None:
        """From another mode: the drive comes to rest first."""
        if self.state == "FAULT":
            self.raise_fault()
        if self.state == "SWITCHED ON":
            self.enable()  # the rotor is held already
        if self.state != "OPERATION ENABLED":
            raise Refused(f"the drive is {self.state.lower()}: enable it first")
        self.objects.write(0x6060, mode)
        end = time.monotonic() + 10
        while self.objects.read(0x6061) != mode:
            if time.monotonic() > end:
                raise TimedOut("the drive has not come to rest within 10 s, as another mode asks for")
            time.sleep(LOOK_S)

    def _profile(self, speed_rad_s: float | None, acceleration_rad_s2: float | None) -> None:
        for index, name, value in ((0x6081, "speed_rad_s", speed_rad_s),
                                   (0x6083, "acceleration_rad_s2", acceleration_rad_s2),
                                   (0x6084, "acceleration_rad_s2", acceleration_rad_s2)):
            if value is not None and index in self.objects.entries:  # 6084h: not of every version
                self.objects.write(index, _whole(name, value, self._unit_rad))

    def _units(self, name: str, value: float, unit: str = "rad") -> int:
        most = (2**31 - 1) * self._unit_rad
        if not abs(value) <= most:
            raise Refused(f"{name}: expected a number in ±{most:.6g} {unit}, got {value:g}")
        return round(value / self._unit_rad)

    def move(self, position_rad: float, *, relative: bool = False, speed_rad_s: float | None = None,
             acceleration_rad_s2: float | None = None, wait: bool = True, timeout_s: float = 60.0,
             progress: Progress = unseen) -> None:
        """To a position, from whatever motion. What is not given stays as it was, at first the motor's."""
        units = self._units("position_rad", position_rad)
        self._in_mode(PROFILE_POSITION)
        self._profile(speed_rad_s, acceleration_rad_s2)
        self._control(ENABLE_OPERATION)
        self.objects.write(0x607A, units)
        self._control(ENABLE_OPERATION | NEW_SET_POINT | AT_ONCE | (RELATIVE if relative else 0))
        self._until(lambda status: status & ACKNOWLEDGED, 2.0, "the target has not been accepted")
        self._control(ENABLE_OPERATION)
        if wait:
            self.wait(timeout_s, progress)

    def wait(self, timeout_s: float = 60.0, progress: Progress = unseen) -> None:
        """Until the target is reached; raises DriveFault."""
        begin = time.monotonic()
        while not (status := self.status) & REACHED or state_of(status) != "OPERATION ENABLED":
            if state_of(status) == "FAULT":
                self.raise_fault()
            if state_of(status) != "OPERATION ENABLED":
                raise Refused(f"the target is not reached: the drive is {state_of(status).lower()}")
            passed_s = time.monotonic() - begin
            progress("moving", min(passed_s / timeout_s, 1.0))
            if passed_s > timeout_s:
                raise TimedOut(f"the target is not reached within {timeout_s:g} s; the position is "
                               f"{self.position_rad:.5g} rad")
            time.sleep(LOOK_S)
        progress("moving", 1.0)

    def velocity(self, speed_rad_s: float, *, acceleration_rad_s2: float | None = None,
                 wait: bool = False, timeout_s: float = 60.0) -> None:
        """A speed for ever; 0 comes to rest."""
        units = self._units("speed_rad_s", speed_rad_s, "rad/s")
        self._in_mode(PROFILE_VELOCITY)
        self._profile(None, acceleration_rad_s2)
        self._control(ENABLE_OPERATION)
        self.objects.write(0x60FF, units)
        if wait:
            self.wait(timeout_s)

    def torque(self, torque_Nm: float, *, speed_rad_s: float | None = None) -> None:
        """Of a drive with an encoder: a torque for ever, up to a speed; the load makes the position of it. Of what
        is more than the current limit allows the drive makes that."""
        rated_Nm = 1e-3 * self.objects.read(0x6076)
        thousandths = round(1e3 * torque_Nm / rated_Nm) if math.isfinite(torque_Nm) else 2**15
        if not abs(thousandths) < 2**15:
            raise Refused(f"torque_Nm: expected a number in ±{32.767 * rated_Nm:.6g} N m, got {torque_Nm:g}")
        if self.objects.read(0x6502) & TORQUE_CARRIED == 0:
            raise Refused("torque: without an encoder a slow rotor is lost; "
                          "the drive has the mode with feedback = encoder")
        if speed_rad_s is not None:
            self.objects.write(0x6080, _whole("speed_rad_s", speed_rad_s, math.pi / 30))
        self.objects.write(0x6071, thousandths)
        self._in_mode(CYCLIC_TORQUE)
        self._control(ENABLE_OPERATION)

    def stop(self, timeout_s: float = 10.0) -> None:
        """Brings it to rest, quickly, and holds. No motion begins until the drive is enabled again."""
        self.quick_stop()
        end = time.monotonic() + timeout_s
        while self.read("reference_moving"):
            if time.monotonic() > end:
                raise TimedOut(f"it has not come to rest within {timeout_s:g} s")
            time.sleep(LOOK_S)

    def quick_stop(self) -> None:
        """The same without waiting, not even for an SDO transfer that is under way: by process data first. If another
        client has enabled the drive and no transfer comes to its end in time, it ends switched off."""
        if self._seen_state == "OPERATION ENABLED":
            self.objects.send_controlword(QUICK_STOP)
        if self.state in ("OPERATION ENABLED", "QUICK STOP ACTIVE"):
            self.objects.write(QUICK_STOP_OPTION, STAYS)
            self._control(QUICK_STOP)
            self.objects.write(0x60FF, 0)  # what would go on when enabled
            if 0x6071 in self.objects.entries:  # not of every version
                self.objects.write(0x6071, 0)
        elif self.read("reference_moving"):
            self.command("stop")  # the console's motion

    def set_position(self, position_rad: float) -> None:
        """The axis, at rest, is at this position from now on."""
        if self.state == "OPERATION ENABLED":
            self._in_mode(HOMING)
            self.command("set-position", position_rad=position_rad)
            self._until(lambda _: not self.read("reference_moving"), 2.0, "it has not come to rest")
            self._in_mode(PROFILE_POSITION)
        else:
            self.command("set-position", position_rad=position_rad)

    def home(self, method: str, position_rad: float = 0.0, *, torque_share: float | None = None,
             travel_rad: float | None = None, speed_rad_s: float | None = None, timeout_s: float = 120.0,
             progress: Progress = unseen) -> None:
        """Finds where the axis is: `here`, or on a hard stop (`stop-down`, `stop-up`), on the encoder's index
        (`index-down`, `index-up`), on a limit switch (`limit-down`, `limit-up`) or on the home switch, where it is
        entered (`switch-down`, `switch-up`). There is position_rad. Of a stop: the torque that it bears, as a share of
        the rated torque; of a stop or a switch the travel within which it is. What is not given stays as it was.
        Raises NotHomed, DriveFault."""
        if method not in HOMING_METHODS:
            raise Refused(f"method: expected one of {', '.join(HOMING_METHODS)}, got {method}")
        offset = self._units("position_rad", position_rad)
        self._in_mode(HOMING)
        try:
            self.objects.write(0x6098, HOMING_METHODS[method])
            if torque_share is not None:
                self.objects.write(STOP_TORQUE[0], _whole("torque_share", torque_share, 1e-3, 2**16), STOP_TORQUE[1])
            if travel_rad is not None:
                self.objects.write(STOP_TRAVEL[0], _whole("travel_rad", travel_rad, self._unit_rad), STOP_TRAVEL[1])
            if speed_rad_s is not None:
                units = _whole("speed_rad_s", speed_rad_s, self._unit_rad)
                for sub in (1, 2):
                    self.objects.write(0x6099, units, sub)
        except OutOfRange:
            raise Refused(f"home: {method} is not of this drive, or a value is out of its range") from None
        self.objects.write(0x607C, offset)
        self._control(ENABLE_OPERATION)
        self._control(ENABLE_OPERATION | START)
        try:
            self._until_homed(method, timeout_s, progress)
        finally:
            if self.state == "OPERATION ENABLED":
                self._control(ENABLE_OPERATION)  # interrupts what goes on yet

    def _until_homed(self, method: str, timeout_s: float, progress: Progress) -> None:
        begin = time.monotonic()
        time.sleep(LOOK_S)  # the statusword is that of the start
        while not (status := self.status) & ATTAINED:
            if state_of(status) == "FAULT":
                self.raise_fault()
            if status & HOMING_ERROR:
                raise NotHomed(f"not homed, {method}: {WHY_NOT[method.partition('-')[0]]}")
            if status & REACHED or state_of(status) != "OPERATION ENABLED":
                raise NotHomed(f"not homed, {method}: interrupted; the drive is {state_of(status).lower()}")
            passed_s = time.monotonic() - begin
            progress("homing", min(passed_s / timeout_s, 1.0))
            if passed_s > timeout_s:
                raise TimedOut(f"homing has not ended within {timeout_s:g} s")
            time.sleep(LOOK_S)
        progress("homing", 1.0)

    def command(self, name: str, **parameters: float) -> None:
        """Any command of the dictionary, with its parameters by name."""
        row = self.known.command(name)
        known = {parameter.name: parameter for parameter in row.parameters}
        for given in parameters:
            if given not in known:
                raise Refused(f"{name}: no parameter {given}; it has {', '.join(known) or 'none'}")
        for parameter in row.parameters:
            if parameter.name not in parameters and not parameter.optional:
                raise Refused(f"{name}: {parameter.name} is missing: {parameter.meaning}")
            value = float(parameters.get(parameter.name, 0.0))
            if parameter.name in parameters and not parameter.least <= value <= parameter.most:
                raise Refused(f"{name}: {parameter.name}: expected a number in {parameter.least:g}…"
                              f"{parameter.most:g} {parameter.unit}, got {value:g}")
            self.objects.write(parameter.index, value)
        try:
            self.objects.write(0x2200, row.number)
        except OutOfRange:
            raise Refused(f"{name}: the drive has no such command") from None
        except Refused:
            raise Refused(f"{name}: legal {row.legal}; the drive is {self.read('state')}") from None


def _whole(name: str, value: float, unit: float, end: int = 2**32) -> int:
    """So many units, more than none and within an object that has no more than `end`."""
    units = round(value / unit) if math.isfinite(value) else 0
    if not 0 < units < end:
        raise Refused(f"{name}: expected a number above 0, at most {unit * (end - 1):.6g}, got {value:g}")
    return units

