"""The drive behind the page: connected again when it was lost, read many times a second while somebody looks,
and obedient to what the page asks for."""
import threading
import time
from typing import Any, Callable, Mapping

from ..byte_line import open_line
from ..capture import Capture
from ..dictionary import dictionary
from ..drive import Drive
from ..errors import LostLink, Refused, SteadystepError
from ..share import Share
from ..simulator import Knobs
from ..states import state_of

SAMPLE_S, LOOK_S, RETRY_S = 0.05, 0.2, 1.0
CAPTURING_LOOK_S = 0.5  # of a capture that is polled a look takes some samples
KNOBS_AGAIN_S = 5.0     # behind knobs that have not answered
LEAD_S = 0.3            # of a capture before its move, but a tenth of it at most
TRACES, MOST_CAPTURE_S = 4, 600
SHOWN = ["theta_est_rad", "omega_est_rad_s", "load_torque_est_Nm", "i_q_A"]  # at first

Listener = Callable[[dict[str, Any]], None]


class Stopped(SteadystepError):
    """What was begun has been ended by a stop."""


class Operation:
    """`knobs`: of a simulated drive. Threads of the page call it as they come."""

    def __init__(self, place: str, knobs: Knobs | None, link: str | None, tcp_port: int) -> None:
        self.place, self.knobs, self.link = place, knobs, link
        self.tcp_port = tcp_port
        self.signals = list(SHOWN)
        self.listeners: list[Listener] = []
        self._drive: Drive | None = None
        self._share: Share | None = None
        self._acting = threading.Lock()
        self._stopping = threading.Event()
        self._ended = threading.Event()
        self._capturing = threading.Lock()
        self._ends_capture = threading.Event()
        self._no_knobs_until_s = 0.0
        self._lost = ""
        self._doing = ""
        self._connect()
        threading.Thread(target=self._live, daemon=True).start()

    def close(self) -> None:
        self._ended.set()
        self._disconnect()

    @property
    def drive(self) -> Drive:
        if self._drive is None:
            raise LostLink(self._lost or f"{self.place}: no drive is connected")
        return self._drive

    def _connect(self) -> None:
        self._share = Share(open_line(self.place), self.link, self.tcp_port)
        self.tcp_port = self._share.tcp_port
        try:
            self._drive = Drive(self._share.line())
        except SteadystepError:
            self._disconnect()
            raise
        self._lost = ""

    def _disconnect(self) -> None:
        drive, share = self._drive, self._share
        self._drive = self._share = None
        if drive:
            drive.close()
        if share:
            share.close()

    # ---- what it shows ----

    def show(self, signals: list[str]) -> None:
        """These from now on."""
        known = dictionary()
        if not 1 <= len(signals) <= TRACES:
            raise Refused(f"expected one to {TRACES} signals")
        self.signals = [known.signal(name).name for name in signals]

    def _live(self) -> None:
        looked_s = 0.0
        while not self._ended.is_set():
            begin = time.monotonic()
            if self.listeners:
                is_capturing = self._capturing.locked()
                looks = begin - looked_s >= (CAPTURING_LOOK_S if is_capturing else LOOK_S)
                if looks or not is_capturing:
                    message = self._sample(not is_capturing, looks)
                    looked_s = begin if "status" in message else looked_s
                    self._report(message)
            self._ended.wait(max(0.005, SAMPLE_S - (time.monotonic() - begin)))

    def _report(self, message: dict[str, Any]) -> None:
        for listener in list(self.listeners):
            listener(message)

    def _sample(self, with_values: bool, with_status: bool) -> dict[str, Any]:
        message: dict[str, Any] = {"time_s": time.monotonic(), "signals": list(self.signals)}
        try:
            drive = self.drive
            if with_values:
                message["values"] = [float(drive.objects.read(drive.known.signal(name).index))
                                     for name in message["signals"]]
            if with_status:
                message["status"] = self._status(drive)
        except SteadystepError as error:
            message["status"] = {"lost": str(error), "simulated": self.knobs is not None}
            self._again(error)
        return message

    def _status(self, drive: Drive) -> dict[str, Any]:
        fault = drive.fault
        return {
            "lost": "", "version": drive.version, "place": self.place, "doing": self._doing,
            "shared": [*([self.link] if self.link else []), f"tcp://127.0.0.1:{self.tcp_port}"],
            "state": state_of(drive.status), "drive_state": drive.read("state"),
            "fault": vars(fault) if fault else None, "position_rad": drive.position_rad,
            "moving": drive.read("reference_moving"), "bus_V": drive.read("bus_V"),
            "synchronism": drive.read("synchronism"), "reference": drive.read("position_reference"),
            "simulated": self.knobs is not None, "truth": self._truth()}

    def _truth(self) -> dict[str, str] | None:
        """None: it has no knobs, or they do not answer, which the drive behind them may do all the same."""
        if self.knobs is None or time.monotonic() < self._no_knobs_until_s:
            return None
        try:
            return self.knobs.truth()
        except SteadystepError:
            self._no_knobs_until_s = time.monotonic() + KNOBS_AGAIN_S
            return None

    def _again(self, error: SteadystepError) -> None:
        if self._drive is not None:
            self._lost = str(error)
            self._disconnect()
        self._ended.wait(RETRY_S)
        if not self._ended.is_set():
            try:
                self._connect()
            except SteadystepError as refusal:
                self._lost = str(refusal)

    # ---- what it does ----

    def stop(self) -> None:
        """At once, whatever else is going on; an enabling ends with the bridge off, homing with the rotor held, a capture
        without what it has."""
        self._stopping.set()
        self._ends_capture.set()
        self.drive.quick_stop()

    def end_capture(self) -> None:
        """The axis goes on."""
        self._ends_capture.set()

    def _progress(self, what: str, share: float) -> None:
        self._doing = "" if share >= 1 else what
        if self._stopping.is_set():
            raise Stopped("stopped")

    def act(self, action: str, values: Mapping[str, Any]) -> None:
        """One at a time; raises SteadystepError."""
        if action == "stop":
            self.stop()
            return
        if action == "end-capture":
            self.end_capture()
            return
        actions: dict[str, Callable[[Drive], object]] = {
            "enable": lambda drive: drive.enable(progress=self._progress),
            "disable": lambda drive: drive.disable(),
            "reset": lambda drive: drive.reset(),
            "store": lambda drive: drive.store(),
            "defaults": lambda drive: drive.defaults(),
            "move": lambda drive: drive.move(
                _number(values, "position_rad"), relative=bool(values.get("relative")), wait=False,
                speed_rad_s=_optional(values, "speed_rad_s"),
                acceleration_rad_s2=_optional(values, "acceleration_rad_s2")),
            "velocity": lambda drive: drive.velocity(_number(values, "speed_rad_s")),
            "set-position": lambda drive: drive.set_position(_number(values, "position_rad")),
            "home": lambda drive: drive.home(
                str(values.get("method")), _number(values, "position_rad"), torque_share=_optional(values, "torque_share"),
                travel_rad=_optional(values, "travel_rad"), speed_rad_s=_optional(values, "speed_rad_s"),
                progress=self._progress),
            "motor": lambda drive: drive.settings.take_motor(str(values.get("motor"))),
        }
        if action not in actions:
            raise Refused(f"{action}: expected one of {', '.join(actions)}")
        if not self._acting.acquire(timeout=0.5):
            raise Refused(f"{action}: the drive is busy: {self._doing}")
        try:
            self._stopping.clear()
            actions[action](self.drive)
        except SteadystepError:
            if not self._stopping.is_set():
                raise
            if action == "home":
                self.drive.quick_stop()  # once more: homing has ended with a word of its own
            else:
                self.drive.disable()  # no matter how far it has come
            raise Stopped("stopped") from None
        finally:
            self._doing = ""
            self._acting.release()

    def capture(self, signals: list[str], duration_s: float, rate_Hz: float,
                move: Mapping[str, Any] | None = None) -> tuple[Capture, str]:
        """Live traces wait meanwhile; how far it is comes in their place. `move`: begins when the capture has; with the
        capture comes why it was refused, or ""."""
        if not 0 < duration_s <= MOST_CAPTURE_S:
            raise Refused(f"duration_s: expected a number above 0, at most {MOST_CAPTURE_S} s on the page")
        if not self._capturing.acquire(blocking=False):
            raise Refused("a capture is under way; end it first")
        refused: list[str] = []
        mover = threading.Timer(min(LEAD_S, duration_s / 10), lambda: self._move_along(move or {}, refused))
        shown_s = 0.0

        def show(_: str, share: float) -> None:
            nonlocal shown_s
            if self._ends_capture.is_set():
                raise Stopped("the capture has been ended")
            if time.monotonic() - shown_s >= LOOK_S or share >= 1:
                shown_s = time.monotonic()
                self._report({"capturing": share})

        try:
            self._ends_capture.clear()
            made = self.drive.capture(signals, duration_s, rate_Hz, progress=show,
                                      armed=None if move is None else mover.start)
        except BaseException:
            mover.cancel()
            raise
        finally:
            self._capturing.release()
        if mover.ident:
            mover.join()
        return made, "".join(refused)

    def _move_along(self, move: Mapping[str, Any], refused: list[str]) -> None:
        try:
            self.act("move", move)
        except SteadystepError as error:
            refused.append(str(error))

    def turn_knob(self, line: str) -> str:
        if self.knobs is None:
            raise Refused("a drive that is not simulated has no knobs")
        return self.knobs.turn(line)


def _number(values: Mapping[str, Any], name: str) -> float:
    value = values.get(name)
    if value is None:
        raise Refused(f"{name} is missing")
    if isinstance(value, bool) or not isinstance(value, (int, float)):
        raise Refused(f"{name}: expected a number, got {value!r}")
    return float(value)


def _optional(values: Mapping[str, Any], name: str) -> float | None:
    return None if values.get(name) is None else _number(values, name)
