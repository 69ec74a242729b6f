"""The command `steadystep`."""
import argparse
import math
import os
import pathlib
import signal
import subprocess
import sys
import threading
import time
from typing import Callable, NoReturn, Sequence

from .capture_files import check_place
from .capture_in_drive import Trigger
from .cli_words import PORT, command_name, parser
from .dictionary import Value, dictionary
from .drive import Drive
from .errors import DriveFault, LostLink, NotHomed, Refused, SteadystepError, TimedOut, WrongPort, WrongVersion
from .resonance_curve import NOT_SURE, SUFFIXES
from .settings_text import line_of

HELD, NOT_DONE, BAD_INPUT = 0, 1, 2
END_S = 20.0  # for a simulation to end

Arguments = argparse.Namespace


class Bar:
    """Progress on standard error, if somebody looks at it."""

    def __init__(self) -> None:
        self._shown, self._seen = "", 0.0

    def __call__(self, what: str, share: float) -> None:
        if not sys.stderr.isatty() or (share < 1 and time.monotonic() - self._seen < 0.1):
            return
        self._seen = time.monotonic()
        done = share >= 1
        self._shown = "" if done else f"{what} {'#' * int(30 * share):30} {100 * share:3.0f} %"
        sys.stderr.write("\r" + (" " * 60 + "\r" if done else self._shown))
        sys.stderr.flush()


def default_port() -> str:
    from serial.tools import list_ports

    if os.environ.get(PORT):
        return os.environ[PORT]
    adapters = [port.device for port in list_ports.comports() if port.vid is not None]
    if len(adapters) == 1:
        return str(adapters[0])
    raise WrongPort(f"no --port and no {PORT}; serial adapters here: {', '.join(adapters) or 'none'}")


def connect(arguments: Arguments) -> Drive:
    return Drive(arguments.port or default_port(), arguments.node, any_version=arguments.any_version)


def said(value: object) -> str:
    if isinstance(value, bool):
        return "true" if value else "false"
    return f"{value:.7g}" if isinstance(value, float) else str(value)


# ---- settings ----


def typed(name: str, text: str) -> Value:
    """A value as one types it: words need no quotation marks."""
    setting = dictionary().setting(name)
    if setting.type == "choice":
        return text.strip('"')
    if setting.type == "flag":
        return {"true": True, "false": False}.get(text, text)
    try:
        if setting.elements > 1:
            return [float(one) for one in text.strip("[]").split(",")]
        return float(text)
    except ValueError:
        return text  # which is refused with what is expected


def settings_get(drive: Drive, arguments: Arguments) -> None:
    names = arguments.names or list(drive.settings)
    law = str(drive.settings["law"])
    for name in names:
        sys.stdout.write(line_of(drive.known, drive.known.setting(name), drive.settings[name], law))


def settings_set(drive: Drive, arguments: Arguments) -> None:
    if arguments.value == "default":
        drive.settings.default(arguments.name)
    else:
        drive.settings[arguments.name] = typed(arguments.name, arguments.value)
    settings_get(drive, Arguments(names=[arguments.name]))


def settings_export(drive: Drive, arguments: Arguments) -> None:
    text = drive.settings.export(Bar())
    if arguments.file == "-":
        sys.stdout.write(text)
    else:
        pathlib.Path(arguments.file).write_text(text, encoding="utf-8")


def settings_import(drive: Drive, arguments: Arguments) -> None:
    if arguments.file == "-":
        changed = drive.settings.load(sys.stdin.read(), "standard input", Bar())
    else:
        changed = drive.settings.load_file(arguments.file, Bar())
    print(f"changed: {', '.join(changed) or 'nothing'}")


def settings_motor(drive: Drive, arguments: Arguments) -> None:
    motor = drive.known.motor(arguments.motor)
    stays = drive.settings.take_motor(motor.name)
    print(f"{motor.name}, {motor.description}: {len(motor.settings)} settings; they act at the next enable\n"
          f"current_limit_A = {said(drive.settings['current_limit_A'])}  # A, rated; what follows from a motor follows this one"
          + (f", but for {', '.join(stays)}" if stays else ""))


# ---- state and motion ----


def show_state(drive: Drive, arguments: Arguments) -> None:
    del arguments
    print(f"{drive.version}: {drive.state.lower()}")
    for name, row in drive.known.signals.items():
        print(f"{name} = {said(drive.read(name))}" + (f"  # {row.unit}" if row.unit else ""))


def show_faults(drive: Drive, arguments: Arguments) -> None:
    del arguments
    now = drive.fault
    print(f"now: {now.name if now else 'none'}")
    for fault in drive.faults or ([now] if now else []):
        print(f"{fault.name} (0x{fault.code:04x})\n  cause: {fault.cause}\n  what to do: {fault.remedy}")


def enable(drive: Drive, arguments: Arguments) -> None:
    if arguments.reset and drive.state == "FAULT":
        drive.reset()
    drive.enable(arguments.timeout, Bar())
    print(f"ready at {drive.position_rad:.5g} rad")


def move(drive: Drive, arguments: Arguments) -> None:
    if arguments.enable:
        drive.enable(progress=Bar())
    drive.move(arguments.position_rad, relative=arguments.relative, speed_rad_s=arguments.speed,
               acceleration_rad_s2=arguments.acceleration, wait=not arguments.no_wait,
               timeout_s=arguments.timeout, progress=Bar())
    print(f"at {drive.position_rad:.5g} rad")


def velocity(drive: Drive, arguments: Arguments) -> None:
    if arguments.enable:
        drive.enable(progress=Bar())
    drive.velocity(arguments.speed_rad_s, acceleration_rad_s2=arguments.acceleration)
    print("goes on until stop, or velocity 0; share the drive to look at it meanwhile")


def torque(drive: Drive, arguments: Arguments) -> None:
    if arguments.enable:
        drive.enable(progress=Bar())
    drive.torque(arguments.torque_Nm, speed_rad_s=arguments.speed)
    print("goes on until stop, or torque 0, which lets it coast")


def home(drive: Drive, arguments: Arguments) -> None:
    if arguments.enable:
        drive.enable(progress=Bar())
    drive.home(arguments.method, arguments.at, torque_share=arguments.torque, travel_rad=arguments.travel,
               speed_rad_s=arguments.speed, timeout_s=arguments.timeout, progress=Bar())
    print(f"homed; at {drive.position_rad:.5g} rad")


def give_command(drive: Drive, arguments: Arguments) -> None:
    values = {}
    for pair in arguments.parameters:
        name, _, text = pair.partition("=")
        try:
            values[name] = float(text)
        except ValueError:
            raise Refused(f"{pair}: expected a parameter as NAME=NUMBER") from None
    drive.command(arguments.name, **values)


def capture(drive: Drive, arguments: Arguments) -> None:
    check_place(pathlib.Path(arguments.out))
    trigger = Trigger(arguments.trigger, arguments.level, not arguments.falling, arguments.before) \
        if arguments.trigger else None
    made = drive.capture(arguments.signals, arguments.duration, arguments.rate, trigger=trigger,
                         preempt=arguments.preempt, progress=Bar())
    made.save(arguments.out, Bar())
    print(f"{arguments.out}: {len(made)} samples, {made.rate_Hz:.4g} Hz")


def find_resonance(drive: Drive, arguments: Arguments) -> None:
    from . import resonance
    from .resonance_proposal import propose

    if arguments.out:
        check_place(pathlib.Path(arguments.out), SUFFIXES)
    plan = resonance.plan(drive, arguments.lowest, arguments.highest, arguments.torque)
    print(f"the axis swings by ±{math.degrees(plan.most_amplitude_rad):.2g}° at {plan.lowest_Hz:g} Hz, by less above; before and "
          "behind that the bridge opens, and a hanging load falls", flush=True)
    if not arguments.yes and not agreed():
        raise Refused("resonance: nothing has moved; --yes, or y, says that the axis may")
    found = plan.run(Bar())
    print(found)
    if arguments.out:
        found.save(arguments.out)
    proposal = propose(drive, found, arguments.rotor_inertia)
    print(f"proposed: {proposal}")
    if not (arguments.apply or arguments.store) or not proposal.settings:
        return
    if found.verdict == NOT_SURE:
        raise Refused("resonance: what is not sure is not applied; `settings set` sets it")
    proposal.apply(drive)
    if arguments.store:
        drive.store()
    print("stored" if arguments.store else "applied")


def agreed() -> bool:
    try:
        return input("go on? [y/N] ").strip().lower() in ("y", "yes")
    except EOFError:
        return False


def show_signals(arguments: Arguments) -> None:
    del arguments
    for signal in dictionary().signals.values():
        print(f"{signal.name:22} {signal.unit:6} {signal.meaning}")


def show_motors(arguments: Arguments) -> None:
    del arguments
    for motor in dictionary().motors.values():
        print(f"{motor.name:22} {motor.description}")


# ---- programs that go on ----


def simulate(arguments: Arguments) -> int:
    from .simulator import find_simulator

    command = [find_simulator(arguments.simulator), "serve", "--link", arguments.link, "--knobs-link",
               arguments.link + "-knobs", *(["--set", f"motor={arguments.motor}"] if arguments.motor else []),
               *arguments.more]
    print(f"{' '.join(command)}\nin another terminal: {command_name()} --port {arguments.link} move 1.5 --enable", flush=True)
    try:
        process = subprocess.Popen(command)
    except OSError as error:
        raise SteadystepError(f"{command[0]}: {error.strerror}") from None
    try:
        return process.wait()
    except KeyboardInterrupt:
        return HELD
    finally:
        process.terminate()
        process.wait(END_S)


def share(arguments: Arguments) -> int:
    from .byte_line import open_line
    from .share import Share

    shared = Share(open_line(arguments.port or default_port()), arguments.link, arguments.tcp)
    try:
        print(f"shared: {arguments.link} tcp://127.0.0.1:{shared.tcp_port}", flush=True)
        while not shared.lost:
            time.sleep(0.2)
        raise shared.lost
    except KeyboardInterrupt:
        return HELD
    finally:
        shared.close()


def page(arguments: Arguments) -> int:
    try:
        from .page import serve
    except ImportError as error:
        raise SteadystepError(f"the page needs the package {error.name}: pip install {error.name}") from None
    if not arguments.simulate:
        arguments.port = arguments.port or default_port()
    return serve(arguments)


# ---- the command line ----

DRIVE_COMMANDS: dict[str, Callable[[Drive, Arguments], object]] = {
    "state": show_state, "faults": show_faults, "enable": enable, "move": move, "velocity": velocity, "torque": torque, "home": home,
    "command": give_command, "capture": capture, "resonance": find_resonance, "disable": lambda drive, _: drive.disable(),
    "stop": lambda drive, _: drive.stop(), "reset": lambda drive, _: drive.reset(),
    "store": lambda drive, _: drive.store(),
    "set-position": lambda drive, arguments: drive.set_position(arguments.position_rad),
}
SETTINGS_COMMANDS: dict[str, Callable[[Drive, Arguments], object]] = {
    "get": settings_get, "set": settings_set, "export": settings_export, "import": settings_import,
    "motor": settings_motor, "defaults": lambda drive, _: drive.defaults(),
}
OTHER_COMMANDS: dict[str, Callable[[Arguments], int | None]] = {
    "signals": show_signals, "motors": show_motors, "simulate": simulate, "share": share, "page": page,
}


def run(arguments: Arguments) -> int:
    if arguments.command in OTHER_COMMANDS:
        return OTHER_COMMANDS[arguments.command](arguments) or HELD
    of_settings = arguments.command == "settings"
    action = (SETTINGS_COMMANDS[arguments.settings_command] if of_settings else DRIVE_COMMANDS[arguments.command])
    with connect(arguments) as drive:
        action(drive, arguments)
    return HELD


def interrupt(*_: object) -> NoReturn:
    raise KeyboardInterrupt


def main(given: Sequence[str] | None = None) -> int:
    """A termination is an interrupt: what has been begun is put in order."""
    if threading.current_thread() is threading.main_thread():
        signal.signal(signal.SIGTERM, interrupt)
    try:
        return run(parser().parse_args(given))
    except (DriveFault, LostLink, NotHomed, TimedOut) as error:
        print(f"steadystep: {error}", file=sys.stderr)
        return NOT_DONE
    except (WrongPort, WrongVersion, SteadystepError, OSError, ValueError) as error:
        print(f"steadystep: {error}", file=sys.stderr)
        return BAD_INPUT
    except KeyboardInterrupt:
        return NOT_DONE


if __name__ == "__main__":
    sys.exit(main())
