"""What a call of the simulator comes to, wherever it runs."""
from typing import NamedTuple


class Refused(Exception):
    """The simulator, the drive or a tool refuses its input; the text says what and why."""


class Answer(NamedTuple):
    """What a call has left."""
    code: int
    out: str
    err: str
    files: dict  # text by name, of those that were asked for and are there


def checked(answer):
    """Of what spread.call hands back; TimeoutError for a call that did not end."""
    if isinstance(answer, str):
        raise TimeoutError(answer)
    return Answer(*answer)
