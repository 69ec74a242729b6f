"""A simulated drive in real time: `steadystep-sil serve` as a process of one's own."""
import os
import pathlib
import shutil
import signal
import subprocess
import threading
import weakref
from types import TracebackType

from .byte_line import TcpLine
from .errors import LostLink, Refused, SteadystepError
from .text_bus import Pieces

NAME, VARIABLE = "steadystep-sil", "STEADYSTEP_SIL"


def find_simulator(given: str | None = None) -> str:
    """That of the option, of the variable, of the source tree, or of the path."""
    built = pathlib.Path(__file__).resolve().parents[3] / "build" / "sil" / NAME
    for place in (given, os.environ.get(VARIABLE), str(built) if built.exists() else None, shutil.which(NAME)):
        if place:
            return place
    raise SteadystepError(f"{NAME}: not found; build it (cmake --preset sil && cmake --build --preset sil) or name "
                          f"it by {VARIABLE}")


class Knobs:
    """The motor's world: what a timeline does, by the keys of an event."""

    def __init__(self, place: str) -> None:
        self._place, self._lock = place, threading.Lock()
        self._line: TcpLine | None = TcpLine(place)
        self._pieces = Pieces()

    def turn(self, line: str) -> str:
        """`load_torque_Nm = 0.1, ramp_s = 0.5`, `plant.bus_V = 18`, `jam = true`, `state`; the answer. Connects anew if
        the simulated drive has been started anew."""
        if "\n" in line or "\r" in line or not line.strip():
            raise Refused("a knob is one line, as `load_torque_Nm = 0.1` or `state`")
        with self._lock:
            try:
                said = self._asked(line)
            except LostLink:
                self._disconnect()
                raise
        if said.startswith("error: "):
            raise Refused(said.removeprefix("error: "))
        return said

    def _asked(self, line: str) -> str:
        if self._line is None:
            self._line, self._pieces = TcpLine(self._place), Pieces()
        self._line.write(line.encode() + b"\n")
        for _ in range(50):
            for text, _ending in self._pieces.of(self._line.read(0.1)):
                if text:
                    return text.decode(errors="replace")
        raise LostLink("the simulated drive does not answer any more")

    def _disconnect(self) -> None:
        if self._line:
            self._line.close()
        self._line = None

    def truth(self) -> dict[str, str]:
        """What is true of the motor, unseen by the drive."""
        return dict(pair.split("=", 1) for pair in self.turn("state").split()[1:])

    def close(self) -> None:
        with self._lock:
            self._disconnect()


class Simulated:
    """`with Simulated(motor="17hs19-2004s1") as simulated: Drive(simulated.place)`."""

    def __init__(self, *arguments: str, motor: str | None = None, program: str | None = None) -> None:
        given = ["--set", f"motor={motor}"] if motor else []
        command = [find_simulator(program), "serve", "--tcp", "0", "--knobs-tcp", "0", *given, *arguments]
        try:
            self.process = subprocess.Popen(command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True,
                                            start_new_session=True)  # an interrupt is for who has started it
        except OSError as error:
            raise SteadystepError(f"{command[0]}: {error.strerror}") from None
        weakref.finalize(self, _end, self.process)  # at the end of a program that does not close it, too
        assert self.process.stdout
        self.places = [self.process.stdout.readline().split()[1:] for _ in range(2)]
        if not all(self.places):
            said = self.process.communicate()[1].strip()
            raise SteadystepError(said or f"{command[0]}: it has ended")
        self.place, knobs = ("tcp://" + places[-1] for places in self.places)
        self.knobs = Knobs(knobs)

    def __enter__(self) -> "Simulated":
        return self

    def __exit__(self, kind: type[BaseException] | None, error: BaseException | None,
                 trace: TracebackType | None) -> None:
        self.close()

    def close(self) -> None:
        self.knobs.close()
        _end(self.process)


def _end(process: "subprocess.Popen[str]") -> None:
    if process.poll() is None:
        process.send_signal(signal.SIGTERM)
    if process.stdout and not process.stdout.closed:
        process.communicate(timeout=20)
