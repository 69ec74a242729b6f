"""Settings as text: a line each, `name = value  # unit`, which is the TOML of `steadystep-sil --settings`."""
import dataclasses
import math
import re
import tomllib
from typing import Container, Iterable, Mapping

from .dictionary import Dictionary, Scalar, Setting, Value
from .errors import Refused

NOT_GIVEN = math.nan  # it follows from motor, board and period
MAY_FOLLOW = "given, or what followed at the last enable"


def _text(setting: Setting, value: Scalar) -> str:
    if setting.type == "choice":
        return f'"{value}"'
    if setting.type == "flag":
        return "true" if value else "false"
    return str(value) if setting.type == "count" else repr(float(value))


def _line(setting: Setting, name: str, text: str, mark: str) -> str:
    remark = "; ".join(filter(None, (setting.unit, mark)))
    return f"{name} = {text}" + (f"  # {remark}" if remark else "") + "\n"


def line_of(known: Dictionary, setting: Setting, value: Value, law: str, mark: str = "") -> str:
    """The lines of a setting; of a law's gains one for each that it has."""
    if not isinstance(value, list):
        return _line(setting, setting.name, _text(setting, value), mark)
    if setting.name == "law_gains":
        return "".join(_line(setting, f"{setting.name}.{gain}", _text(setting, number), mark)
                       for gain, number in zip(known.law_gains[law], value))
    return _line(setting, setting.name, "[" + ", ".join(_text(setting, one) for one in value) + "]", mark)


def text_of(known: Dictionary, values: Mapping[str, Value], following: Container[str] | None) -> str:
    """`following`: what is not given, by the console's names; None: that is not known."""
    law, lines = str(values["law"]), ["# Settings of a drive; nan: not given, it follows from motor and board.\n"]
    for name, value in values.items():
        setting = known.setting(name)
        if setting.follows and following is not None:
            shown = value if isinstance(value, list) else [value]
            numbers = [NOT_GIVEN if one in following else float(number) for one, number in zip(setting.elements_named, shown)]
            value = numbers if isinstance(value, list) else numbers[0]
        lines.append(line_of(known, setting, value, law, MAY_FOLLOW if setting.follows and following is None else ""))
    return "".join(lines)


@dataclasses.dataclass(frozen=True)
class Given:
    """A line of the text: a setting, or one element of it."""

    line: int
    setting: Setting
    gain: str  # "": the whole setting
    value: Value

    @property
    def numbers(self) -> list[Scalar]:
        return [*self.value] if isinstance(self.value, list) else [self.value]

    @property
    def name(self) -> str:
        return self.setting.name + (f".{self.gain}" if self.gain else "")


def given_in(known: Dictionary, text: str, place: str = "settings") -> Iterable[Given]:
    """Each line that sets something; raises Refused with place and line."""
    for number, line in enumerate(text.splitlines(), start=1):
        try:
            table = tomllib.loads(line)
            for name, value in table.items():
                setting = known.setting(name)
                if isinstance(value, dict):
                    for gain, one in value.items():
                        yield Given(number, setting, gain, setting.value_of(setting.number_of(one)))
                else:
                    yield Given(number, setting, "", _checked(setting, value))
        except tomllib.TOMLDecodeError as error:
            said = re.sub(r" \(at .*\)$", "", str(error))
            raise Refused(f"{place}:{number}: {line.strip()!r}: expected `name = value`: {said}") from None
        except Refused as error:
            raise Refused(f"{place}:{number}: {error}") from None


def _checked(setting: Setting, value: object) -> Value:
    if setting.elements == 1:
        return setting.value_of(setting.number_of(value))
    if not isinstance(value, list) or len(value) != setting.elements:
        raise Refused(f"{setting.name}: expected {setting.elements} numbers, got {value!r}")
    return [setting.number_of(one) for one in value]
