"""Operates a steadystep drive, on a board's serial port or simulated.

    import steadystep
    drive = steadystep.Drive("/dev/ttyACM0")    # or a pseudo-terminal, or "tcp://127.0.0.1:4001"
    drive.enable()
    drive.move(1.5)
    drive.capture(["theta_est_rad"], duration_s=1).save("move.csv")
"""
from . import simulator
from .capture import Capture
from .capture_in_drive import Trigger
from .dictionary import dictionary
from .drive import Drive
from .errors import DriveFault, LostLink, NotHomed, Refused, SteadystepError, TimedOut, WrongPort, WrongVersion

__all__ = ["Capture", "Drive", "DriveFault", "LostLink", "NotHomed", "Refused", "SteadystepError", "TimedOut",
           "Trigger", "WrongPort", "WrongVersion", "dictionary", "simulator"]
