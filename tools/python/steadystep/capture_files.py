"""A capture as a file: .csv, .parquet (pyarrow) or .mcap (mcap)."""
import csv
import importlib
import json
import os
import pathlib
from typing import TYPE_CHECKING, Any, Iterable

from .dictionary import Signal
from .errors import SteadystepError
from .settings import Progress

if TYPE_CHECKING:
    from .capture import Capture

TOPIC = "/drive"  # as layouts/ has it
ROWS = 1000  # between two looks at the progress
PACKAGES = {".parquet": ("pyarrow", "pyarrow.parquet"), ".mcap": ("mcap.writer",),
            ".png": ("matplotlib.figure",), ".svg": ("matplotlib.figure",)}


def _needs(package: str, suffix: str, error: ImportError) -> SteadystepError:
    return SteadystepError(f"{suffix} needs the package {package}: pip install {package} ({error})")


def cell(value: float) -> str:
    """With as many digits as it has."""
    return repr(value).removesuffix(".0")


def _cells(capture: "Capture", row: int) -> list[float]:
    return [capture.time_s[row], *(capture.columns[signal.name][row] for signal in capture.signals)]


def _save_csv(capture: "Capture", path: pathlib.Path, progress: Progress) -> None:
    with path.open("w", newline="", encoding="utf-8") as file:
        writer = csv.writer(file)
        writer.writerow(["time_s", *(signal.name for signal in capture.signals)])
        for row in range(len(capture)):
            time_s, *values = _cells(capture, row)
            writer.writerow([f"{time_s:.12g}", *map(cell, values)])
            if row % ROWS == 0:
                progress("writing", row / len(capture))


def _save_parquet(capture: "Capture", path: pathlib.Path, progress: Progress) -> None:
    import pyarrow
    import pyarrow.parquet

    fields = [pyarrow.field("time_s", pyarrow.float64(), metadata={"unit": "s"})]
    fields += [pyarrow.field(signal.name, pyarrow.float64(), metadata=_described(signal))
               for signal in capture.signals]
    columns = [capture.time_s, *(capture.columns[signal.name] for signal in capture.signals)]
    table = pyarrow.table(columns, schema=pyarrow.schema(fields))
    pyarrow.parquet.write_table(table, path)
    progress("writing", 1.0)


def _described(signal: Signal) -> dict[str, str]:
    return {"unit": signal.unit, "meaning": signal.meaning, "words": ",".join(signal.words)}


def _schema(capture: "Capture") -> dict[str, Any]:
    unit = {signal.name: f" [{signal.unit}]" if signal.unit else "" for signal in capture.signals}
    return {"type": "object", "title": "steadystep.signals", "properties": {
        "time_s": {"type": "number", "description": "[s]"},
        **{signal.name: {"type": "number", "description": signal.meaning + unit[signal.name]}
           for signal in capture.signals}}}


def _save_mcap(capture: "Capture", path: pathlib.Path, progress: Progress) -> None:
    from mcap.writer import Writer

    names = ["time_s", *(signal.name for signal in capture.signals)]
    with path.open("wb") as file:
        writer = Writer(file)
        writer.start(profile="", library="steadystep")
        schema = writer.register_schema("steadystep.signals", "jsonschema",
                                        json.dumps(_schema(capture)).encode())
        channel = writer.register_channel(TOPIC, "json", schema)
        for row in range(len(capture)):
            at = round(1e9 * (capture.time_s[row] - capture.time_s[0]))
            message = json.dumps(dict(zip(names, _cells(capture, row)))).encode()
            writer.add_message(channel, at, message, at)
            if row % ROWS == 0:
                progress("writing", row / len(capture))
        writer.finish()


WRITERS = {".csv": _save_csv, ".parquet": _save_parquet, ".mcap": _save_mcap}


def check_place(path: pathlib.Path, suffixes: Iterable[str] = WRITERS) -> None:
    """Before what goes there is made."""
    if path.suffix not in suffixes:
        raise SteadystepError(f"{path}: expected a name that ends with {', '.join(suffixes)}")
    if not path.parent.is_dir():
        raise SteadystepError(f"{path}: there is no folder {path.parent}")
    if path.is_dir() or not os.access(path if path.exists() else path.parent, os.W_OK):
        raise SteadystepError(f"{path}: it cannot be written")
    for package in PACKAGES.get(path.suffix, ()):
        try:
            importlib.import_module(package)
        except ImportError as error:
            raise _needs(package.partition(".")[0], path.suffix, error) from None


def save(capture: "Capture", path: pathlib.Path, progress: Progress) -> None:
    check_place(path)
    WRITERS[path.suffix](capture, path, progress)
    progress("writing", 1.0)
