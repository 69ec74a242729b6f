"""What can go wrong, each in words that say what to do."""


class SteadystepError(Exception):
    """Of all that this package raises by itself."""


class WrongPort(SteadystepError):
    """There is no such port, it is in use, or what answers there is no drive."""


class WrongVersion(SteadystepError):
    """The drive is not the one that this package's dictionary describes."""


class LostLink(SteadystepError):
    """The drive does not answer any more."""


class Refused(SteadystepError):
    """The drive, or its dictionary, does not accept a value or a command."""


class NotHomed(SteadystepError):
    """The axis has not been homed; where it is, is not known better than before."""


class TimedOut(SteadystepError):
    """What was waited for has not come in time."""


class DriveFault(SteadystepError):
    """The drive has opened its bridge."""

    def __init__(self, name: str, code: int, cause: str, remedy: str) -> None:
        super().__init__(f"{name} (0x{code:04x}): {cause}; {remedy}")
        self.name, self.code, self.cause, self.remedy = name, code, cause, remedy
