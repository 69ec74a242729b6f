"""The settings of a drive, as a mapping by name."""
import math
import pathlib
from typing import Callable, Iterator, Mapping

from .dictionary import Dictionary, Setting, Value, same
from .errors import Refused
from .objects import Objects, OutOfRange
from .settings_text import Given, given_in, text_of

Progress = Callable[[str, float], None]  # what, and the share of it that is done


def unseen(what: str, share: float) -> None:
    """No progress is shown."""


class Settings(Mapping[str, Value]):
    """`settings["current_limit_A"] = 2`; raises Refused with the range."""

    def __init__(self, objects: Objects, known: Dictionary) -> None:
        self._objects, self._known = objects, known

    def __iter__(self) -> Iterator[str]:
        return iter(self._known.settings)

    def __len__(self) -> int:
        return len(self._known.settings)

    def __getitem__(self, name: str) -> Value:
        setting = self._known.setting(name)
        values = [setting.value_of(self._read(setting, n)) for n in range(setting.elements)]
        return [float(one) for one in values] if setting.elements > 1 else values[0]

    def __setitem__(self, name: str, value: Value) -> None:
        setting = self._known.setting(name)
        if setting.elements == 1:
            self._write(setting, 0, setting.number_of(value))
            return
        if not isinstance(value, list) or len(value) != setting.elements:
            raise Refused(f"{name}: expected {setting.elements} numbers, got {value!r}")
        for n, one in enumerate(value):
            self._write(setting, n, setting.number_of(one))

    def _read(self, setting: Setting, element: int) -> float:
        return float(self._objects.read(setting.index + element))

    def _write(self, setting: Setting, element: int, number: float) -> None:
        value = {"flag": bool, "real": float}.get(setting.type, int)(number)
        try:
            self._objects.write(setting.index + element, value)
        except OutOfRange:
            raise setting.out_of_range(setting.value_of(number)) from None
        except Refused as refusal:
            when = "" if setting.in_motion else "; it changes while the bridge is off: disable first"
            raise Refused(f"{setting.name}: {refusal}{when}") from None

    def default(self, name: str) -> None:
        """Takes one back: what the motor, the board and the period make of it."""
        setting = self._known.setting(name)
        if setting.group == "Motor":
            raise Refused(f"{name}: the motor's values have no default")
        if setting.default is None:
            number = math.nan
        else:
            number = setting.default.value(float(self._objects.read(
                self._known.setting("rated_current_A").index)))
        for n in range(setting.elements):
            self._write(setting, n, number)

    def all(self, progress: Progress = unseen) -> dict[str, Value]:
        values = {}
        for n, name in enumerate(self):
            values[name] = self[name]
            progress("settings", (n + 1) / len(self))
        return values

    def export(self, progress: Progress = unseen) -> str:
        """As text, a line each."""
        return text_of(self._known, self.all(progress))

    def load(self, text: str, place: str = "settings", progress: Progress = unseen) -> list[str]:
        """Of such a text what differs from what the drive has; the names of that. All of it is read before
        anything is written. In the order of the table, as feedback and law bring their defaults with them."""
        order = list(self)
        given = sorted(given_in(self._known, text, place), key=lambda one: order.index(one.setting.name))
        changed = []
        for n, one in enumerate(given):
            try:
                if self._put(one):
                    changed.append(one.setting.name + (f".{one.gain}" if one.gain else ""))
            except Refused as error:
                raise Refused(f"{place}:{one.line}: {error}") from None
            progress("settings", (n + 1) / len(given))
        return changed

    def load_file(self, path: str | pathlib.Path, progress: Progress = unseen) -> list[str]:
        return self.load(pathlib.Path(path).read_text(encoding="utf-8"), str(path), progress)

    def _put(self, one: Given) -> bool:
        setting = one.setting
        if one.gain:
            gains = self._known.law_gains[str(self["law"])]
            if one.gain not in gains:
                raise Refused(f"{setting.name}.{one.gain}: this law has {', '.join(gains) or 'none'}")
            elements: dict[int, object] = {gains.index(one.gain): one.value}
        else:
            values: list[object] = [*one.value] if isinstance(one.value, list) else [one.value]
            elements = dict(enumerate(values))
        numbers = {n: setting.number_of(value) for n, value in elements.items()}
        written = {n: number for n, number in numbers.items()
                   if not same(number, self._read(setting, n))}
        for n, number in written.items():
            self._write(setting, n, number)
        return bool(written)
