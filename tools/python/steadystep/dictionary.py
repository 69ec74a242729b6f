"""What a drive has by name: dictionary.json, which `steadystep-sil dictionary` writes from the tables of the
firmware, and steadystep.eds, which has the same by number."""
import dataclasses
import functools
import json
import math
import pathlib
from typing import Any, Mapping, TypeVar

from .errors import Refused

FOLDER = pathlib.Path(__file__).resolve().parent
EDS = FOLDER / "steadystep.eds"
EDGE = 1e-9  # of a bound: what rounding leaves

_Row = TypeVar("_Row")
Scalar = bool | int | float | str
Value = Scalar | list[float]


@dataclasses.dataclass(frozen=True)
class Bound:
    """A limit or a default: a number, or so many times the motor's rated current."""

    number: float
    of_rated: bool

    def value(self, rated_current_A: float) -> float:
        return self.number * rated_current_A if self.of_rated else self.number

    def __str__(self) -> str:
        if not self.of_rated:
            return f"{self.number:.10g}"
        return "rated" if self.number == 1 else f"{self.number:.10g} × rated"


@dataclasses.dataclass(frozen=True)
class Choice:
    name: str
    meaning: str


@dataclasses.dataclass(frozen=True)
class Setting:
    name: str
    index: int
    elements: int
    type: str  # choice, flag, real, count
    unit: str
    group: str
    least: Bound
    most: Bound
    default: Bound | None  # None: of the motor, or it follows
    in_motion: bool
    meaning: str
    choices: tuple[Choice, ...]

    @property
    def elements_named(self) -> list[str]:
        """As the console names each."""
        return [self.name] if self.elements == 1 else [f"{self.name}.{n + 1}" for n in range(self.elements)]

    @property
    def follows(self) -> bool:
        """From motor, board and period, unless it is given."""
        return self.default is None and self.group != "Motor"

    def check(self, number: float, rated_current_A: float) -> None:
        """Raises Refused beyond the range; what is at its edge the drive knows best."""
        if self.type not in ("real", "count") or (math.isnan(number) and self.follows):
            return
        least, most = (bound.value(rated_current_A) for bound in (self.least, self.most))
        if not least - EDGE * abs(least) <= number <= most + EDGE * abs(most):
            raise self.out_of_range(self.value_of(number) if math.isfinite(number) else number)

    @property
    def range(self) -> str:
        if self.type == "choice":
            return ", ".join(choice.name for choice in self.choices)
        return "true, false" if self.type == "flag" else f"{self.least}…{self.most}"

    def number_of(self, value: object) -> float:
        """An element as the drive has it, numpy's scalars, too; raises Refused."""
        if callable(item := getattr(value, "item", None)):
            value = item()
        if self.type == "choice":
            for number, choice in enumerate(self.choices):
                if value == choice.name:
                    return number
        elif self.type == "flag":
            if isinstance(value, bool):
                return float(value)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            if self.type == "real" or float(value).is_integer():
                return float(value)
        raise Refused(f"{self.name}: expected {self._expected()}, got {value!r}")

    def _expected(self) -> str:
        kind = {"choice": "one of ", "flag": "", "real": "a number in ", "count": "a whole number in "}
        return kind[self.type] + self.range + (f" {self.unit}" if self.unit else "")

    def out_of_range(self, value: object) -> Refused:
        return Refused(f"{self.name}: expected {self._expected()}, got {value!r}")

    def value_of(self, number: float) -> Scalar:
        """The same the other way round."""
        if self.type == "choice":
            return self.choices[int(number)].name
        if self.type == "flag":
            return bool(number)
        return int(number) if self.type == "count" else float(number)


@dataclasses.dataclass(frozen=True)
class Signal:
    name: str
    index: int
    unit: str
    words: tuple[str, ...]  # by number; (): it is one
    meaning: str


@dataclasses.dataclass(frozen=True)
class Parameter:
    name: str
    index: int
    unit: str
    least: float
    most: float
    optional: bool
    meaning: str


@dataclasses.dataclass(frozen=True)
class Command:
    name: str
    number: int
    parameters: tuple[Parameter, ...]
    legal: str
    meaning: str


@dataclasses.dataclass(frozen=True)
class Fault:
    name: str
    code: int
    cause: str
    remedy: str
    limit: str | None  # the setting that stands behind it


@dataclasses.dataclass(frozen=True)
class Motor:
    name: str
    description: str
    settings: Mapping[str, float]


class Dictionary:
    """The tables, by name."""

    def __init__(self, tables: Mapping[str, Any]) -> None:
        self.version: str = tables["version"]
        self.settings = {row["name"]: _setting(row) for row in tables["settings"]}
        self.signals = {row["name"]: Signal(**{**row, "words": tuple(row["words"])})
                        for row in tables["signals"]}
        self.commands = {row["name"]: _command(row) for row in tables["commands"]}
        self.faults = {row["code"]: Fault(**row) for row in tables["faults"]}
        self.motors = {row["name"]: Motor(**row) for row in tables["motors"]}
        self.law_gains: Mapping[str, list[str]] = tables["law_gains"]

    def setting(self, name: str) -> Setting:
        return _named(self.settings, name, "setting")

    def signal(self, name: str) -> Signal:
        return _named(self.signals, name, "signal")

    def command(self, name: str) -> Command:
        return _named(self.commands, name, "command")

    def motor(self, name: str) -> Motor:
        return _named(self.motors, name, "motor of the library")


def _named(table: Mapping[str, _Row], name: str, what: str) -> _Row:
    if name in table:
        return table[name]
    raise Refused(f"{name}: no such {what}{_nearest(name, table)}")


def _nearest(name: str, table: Mapping[str, object]) -> str:
    import difflib

    close = difflib.get_close_matches(name, table, 3)
    return f"; is it {' or '.join(close)}?" if close else ""


def _bound(entry: object) -> Bound:
    if isinstance(entry, dict):
        return Bound(entry["rated"], True)
    assert isinstance(entry, (int, float))
    return Bound(entry, False)


def _setting(row: Mapping[str, Any]) -> Setting:
    choices = tuple(Choice(**choice) for choice in row.get("choices", ()))
    default = row["default"]
    return Setting(row["name"], row["index"], row["elements"], row["type"], row["unit"], row["group"],
                   _bound(row["least"]), _bound(row["most"]),
                   None if default is None else _bound(default), row["in_motion"], row["meaning"],
                   choices)


def _command(row: Mapping[str, Any]) -> Command:
    return Command(row["name"], row["number"], tuple(Parameter(**one) for one in row["parameters"]),
                   row["legal"], row["meaning"])


@functools.cache
def dictionary() -> Dictionary:
    return Dictionary(json.loads((FOLDER / "dictionary.json").read_text(encoding="utf-8")))


def same(one: float, other: float) -> bool:
    """As settings: not given is not given."""
    return one == other or (math.isnan(one) and math.isnan(other))
