"""Reads the trace of a run, trace.npy or else trace.csv."""
import numpy as np


class NoTrace(Exception):
    """In one line: there is none, or not all of it."""


def has_trace(folder):
    return any((folder / name).is_file() for name in ("trace.npy", "trace.csv"))


def read_trace(folder):
    """An array per column."""
    if not has_trace(folder):
        unfinished = any(folder.glob("trace.*.part"))
        raise NoTrace(f"{folder}: " + ("the run has not finished" if unfinished else
                                       "no trace.npy and no trace.csv"))
    binary, text = folder / "trace.npy", folder / "trace.csv"
    try:
        if binary.is_file():
            table = np.load(binary)
        else:
            with open(text, encoding="utf-8") as file:
                names = file.readline().strip().split(",")
                rows = np.loadtxt(file, delimiter=",", ndmin=2)
            table = dict(zip(names, rows.T, strict=True))
    except (ValueError, EOFError):
        broken = binary if binary.is_file() else text
        raise NoTrace(f"{broken}: not a whole trace, its end is missing or it is another file") \
            from None
    return table if isinstance(table, dict) else {name: table[name] for name in table.dtype.names}
