"""The words of the command `steadystep`."""
import argparse
import os
import re
from typing import TYPE_CHECKING, Callable

from .axis import HOMING_METHODS

if TYPE_CHECKING:
    Commands = argparse._SubParsersAction[argparse.ArgumentParser]

NEGATIVE = re.compile(r"-(\d+\.?\d*|\.\d+)([eE][+-]?\d+)?$")  # argparse takes -1e-3 for an option
PORT, COMMAND = "STEADYSTEP_PORT", "STEADYSTEP_COMMAND"


def command_name() -> str:
    """As it can be typed again: tools/steadystep says how it has been called."""
    return os.environ.get(COMMAND, "steadystep")


def _number_in(least: int, most: int) -> Callable[[str], int]:
    """A type of argparse, which says the range."""
    def number(text: str) -> int:
        if not text.isdecimal() or not least <= int(text) <= most:
            raise argparse.ArgumentTypeError(f"expected a number in {least}…{most}, got {text}")
        return int(text)

    return number


PORT_NUMBER = _number_in(0, 65535)


def _add(commands: "Commands", name: str, about: str) -> argparse.ArgumentParser:
    parser = commands.add_parser(name, help=about, description=about)
    parser._negative_number_matcher = NEGATIVE
    return parser


def _add_settings(commands: "Commands") -> None:
    settings = _add(commands, "settings", "get, set, export, import, motor, defaults").add_subparsers(
        dest="settings_command", required=True, metavar="WHAT")
    _add(settings, "get", "these, or all").add_argument("names", nargs="*")
    one = _add(settings, "set", "one; `default` takes it back")
    one.add_argument("name")
    one.add_argument("value")
    _add(settings, "export", "all of them as text").add_argument("file", nargs="?", default="-")
    _add(settings, "import", "from such a text what differs").add_argument("file")
    _add(settings, "motor", "those of a motor of the library").add_argument("motor")
    _add(settings, "defaults", "all but the motor's back, and stored")
    _add(commands, "store", "settings and what was learned, to flash")


def _add_motion(commands: "Commands") -> None:
    enable = _add(commands, "enable", "until it is ready")
    enable.add_argument("--reset", action="store_true", help="a fault, first")
    enable.add_argument("--timeout", type=float, default=10.0, metavar="S")
    _add(commands, "disable", "opens the bridge")
    _add(commands, "reset", "a fault; the bridge stays open")
    _add(commands, "stop", "to rest, quickly, and holds")
    move = _add(commands, "move", "to a position")
    move.add_argument("position_rad", type=float)
    move.add_argument("--relative", action="store_true")
    move.add_argument("--speed", type=float, metavar="RAD_S")
    move.add_argument("--timeout", type=float, default=60.0, metavar="S")
    move.add_argument("--no-wait", action="store_true")
    velocity = _add(commands, "velocity", "a speed for ever")
    velocity.add_argument("speed_rad_s", type=float)
    torque = _add(commands, "torque", "with an encoder: a torque for ever, up to a speed")
    torque.add_argument("torque_Nm", type=float)
    torque.add_argument("--speed", type=float, metavar="RAD_S")
    for each in (move, velocity):
        each.add_argument("--acceleration", type=float, metavar="RAD_S2")
    for each in (move, velocity, torque):
        each.add_argument("--enable", action="store_true", help="first")
    _add(commands, "set-position", "the axis, at rest, is here").add_argument("position_rad", type=float)
    home = _add(commands, "home", "finds where the axis is: here, on a hard stop, a switch, or the encoder's index")
    home.add_argument("method", metavar="METHOD", help=", ".join(HOMING_METHODS))
    home.add_argument("--at", type=float, default=0.0, metavar="RAD", help="where that is (0)")
    home.add_argument("--torque", type=float, metavar="SHARE", help="that a stop bears, of the rated torque")
    home.add_argument("--travel", type=float, metavar="RAD", help="within which a stop or a switch is")
    home.add_argument("--speed", type=float, metavar="RAD_S")
    home.add_argument("--timeout", type=float, default=120.0, metavar="S")
    home.add_argument("--enable", action="store_true", help="first")
    command = _add(commands, "command", "any of the dictionary")
    command.add_argument("name")
    command.add_argument("parameters", nargs="*", metavar="NAME=VALUE")


def _add_signals(commands: "Commands") -> None:
    _add(commands, "state", "state and every signal")
    _add(commands, "faults", "the fault, and the last ones: cause, and what to do")
    capture = _add(commands, "capture", "signals over time, to .csv, .parquet or .mcap")
    capture.add_argument("signals", nargs="+")
    capture.add_argument("--duration", type=float, default=1.0, metavar="S")
    capture.add_argument("--rate", type=float, default=1000.0, metavar="HZ")
    capture.add_argument("--trigger", metavar="SIGNAL", help="it rises above --level")
    capture.add_argument("--level", type=float, default=0.5)
    capture.add_argument("--falling", action="store_true", help="or falls to it")
    capture.add_argument("--before", type=float, default=0.0, metavar="S", help="what lies before the trigger")
    capture.add_argument("--preempt", action="store_true", help="even if the drive records for another program")
    capture.add_argument("--out", required=True, metavar="FILE")
    resonance = _add(commands, "resonance", "of a belt or a coupling, by small sines, and the settings that it asks for")
    resonance.add_argument("--rotor-inertia", type=float, metavar="KGM2", help="the rotor's own, of its data sheet")
    resonance.add_argument("--lowest", type=float, default=30.0, metavar="HZ")
    resonance.add_argument("--highest", type=float, metavar="HZ", help="0.9 of what the drive's sines go to")
    resonance.add_argument("--torque", type=float, metavar="SHARE", help="of the rated torque: 0.2, with an encoder 0.5")
    resonance.add_argument("--out", metavar="FILE", help="the apparent inertia, to .csv, .png or .svg")
    resonance.add_argument("--yes", action="store_true", help="the axis may move")
    resonance.add_argument("--apply", action="store_true", help="sets what is proposed")
    resonance.add_argument("--store", action="store_true", help="and keeps it in flash")
    _add(commands, "signals", "what there is to capture")
    _add(commands, "motors", "the library's")


def _add_programs(commands: "Commands") -> None:
    simulate = _add(commands, "simulate", "a simulated drive, until interrupted")
    page = _add(commands, "page", "the page, on loopback")
    share = _add(commands, "share", "the drive for several programs, until interrupted")
    for each in (simulate, page):
        each.add_argument("--motor", help="of the library, or a file")
        each.add_argument("--simulator", help="steadystep-sil", metavar="PROGRAM")
    simulate.add_argument("--link", default="/tmp/steadystep", help="of the drive; its knobs: with -knobs behind it")
    simulate.add_argument("more", nargs="*", help="behind --: options of steadystep-sil serve")
    page.add_argument("--simulate", action="store_true", help="with a simulated drive of its own")
    page.add_argument("--http", type=PORT_NUMBER, default=0, metavar="PORT", help="of the page; 0: a free one")
    page.add_argument("--open", action="store_true", help="in the browser")
    page.add_argument("--knobs", help="tcp://127.0.0.1:PORT of a simulated drive that is served elsewhere")
    page.add_argument("--link", help="pseudo-terminal for another program")
    share.add_argument("--link", help="pseudo-terminal for a program", default="/tmp/steadystep")
    for each in (page, share):
        each.add_argument("--tcp", type=PORT_NUMBER, default=0, metavar="PORT",
                          help="for any number of other programs; 0: a free one")


def parser() -> argparse.ArgumentParser:
    top = argparse.ArgumentParser(prog="steadystep", description="Operates a steadystep drive.")
    top.add_argument("--port", help=f"serial port, pseudo-terminal or tcp://127.0.0.1:PORT; else {PORT}, or the only "
                                    "serial adapter there is")
    top.add_argument("--node", type=_number_in(1, 127), default=1, help="the drive's number on a bus (1)")
    top.add_argument("--any-version", action="store_true", help="go on with a drive of another version")
    commands = top.add_subparsers(dest="command", required=True, metavar="COMMAND")
    _add_signals(commands)
    _add_settings(commands)
    _add_motion(commands)
    _add_programs(commands)
    return top
