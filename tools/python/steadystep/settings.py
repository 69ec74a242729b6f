"""The settings of a drive, as a mapping by name."""
import math
import pathlib
from typing import Callable, Container, Iterator, Mapping, Sequence

from .dictionary import Dictionary, Setting, Value, same
from .errors import Refused
from .objects import Objects, OutOfRange
from .settings_text import Given, given_in, text_of
from .states import BRIDGE_ON, state_of

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
        several = value.tolist() if hasattr(value, "tolist") else value
        if not isinstance(several, (list, tuple)) or len(several) != setting.elements:
            raise Refused(f"{name}: expected {setting.elements} numbers, got {value!r}")
        for n, number in enumerate([setting.number_of(one) for one in several]):
            self._write(setting, n, number)

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
        try:
            for n in range(setting.elements):
                self._write(setting, n, number)
        except Refused:
            if not math.isnan(number) or not self._set_to_default(setting):
                raise

    def _set_to_default(self, setting: Setting) -> bool:
        """Of what the drive has always given, computed from its motor, which it does when its console is asked to."""
        answers = self._objects.ask_console(f"set {setting.name} default") if setting.elements == 1 and self._is_off else []
        return bool(answers) and answers[0].startswith("ok")

    @property
    def _is_off(self) -> bool:
        return state_of(int(self._objects.read(0x6041))) not in BRIDGE_ON

    def _following(self) -> set[str] | None:
        """What nobody has given. SDO shows what followed at the last enable, as if it were given; the console says which.
        That is asked while the bridge is off, as its channel is closed for it. None: it could not be asked."""
        names = [name for row in self._known.settings.values() if row.follows for name in row.elements_named]
        if not self._is_off:
            return None
        answers = self._objects.ask_console(*(f"get {name}" for name in names))
        if len(answers) < len(names):
            return None
        return {name for name, answer in zip(names, answers)
                if any(word in answer.partition(";")[0] for word in ("(follows)", "(not given)"))}

    def take_motor(self, name: str) -> list[str]:
        """Those of a motor of the library. What was given for the motor before is taken back: the current limit is its rated
        current, and what follows from the motor follows. The names of what stays, where other nodes are on the line."""
        motor = self._known.motor(name)
        for setting, value in motor.settings.items():
            self[setting] = value
        stays = []
        for one in self._known.settings.values():
            if one.follows or (one.default is not None and one.default.of_rated):
                try:
                    self.default(one.name)
                except Refused:
                    stays.append(one.name)
        return stays

    def all(self, progress: Progress = unseen) -> dict[str, Value]:
        values = {}
        for n, name in enumerate(self):
            values[name] = self[name]
            progress("settings", (n + 1) / len(self))
        return values

    def export(self, progress: Progress = unseen) -> str:
        """As text, a line each; what nobody has given is not given there. An enabled drive does not say what that is: what may be
        is marked."""
        return text_of(self._known, self.all(progress), self._following())

    def load(self, text: str, place: str = "settings", progress: Progress = unseen) -> list[str]:
        """Of such a text what differs from what the drive has; the names of that. All of it is read, and looked at, before
        anything is written. In the order of the table, as feedback and law bring their defaults with them."""
        order = list(self)
        given = sorted(given_in(self._known, text, place), key=lambda one: order.index(one.setting.name))
        nan = any(math.isnan(number) for one in given for number in one.numbers if isinstance(number, float))
        following = (self._following() if nan else None) or set()
        self._check(given, place, following)
        changed: list[str] = []
        for n, one in enumerate(given):
            try:
                if self._put(one, following):
                    changed.append(one.name)
            except Refused as error:
                before = f"; set before it: {', '.join(changed)}" if changed else ""
                raise Refused(f"{place}:{one.line}: {error}{before}") from None
            progress("settings", (n + 1) / len(given))
        return changed

    def load_file(self, path: str | pathlib.Path, progress: Progress = unseen) -> list[str]:
        try:
            text = pathlib.Path(path).read_text(encoding="utf-8")
        except UnicodeDecodeError:
            raise Refused(f"{path}: expected settings as text, a line each: name = value") from None
        return self.load(text, str(path), progress)

    def _check(self, given: Sequence[Given], place: str, following: Container[str]) -> None:
        """What the drive would refuse, as far as one knows."""
        whole = {one.setting.name: one.value for one in given if not one.gain}
        rated = whole.get("rated_current_A", self["rated_current_A"])
        law = str(whole.get("law", self["law"]))
        assert isinstance(rated, (int, float))
        is_off = self._is_off
        for one in given:
            try:
                numbers = self._numbers(one, law)
                for number in numbers.values():
                    one.setting.check(number, rated)
                if not is_off and not one.setting.in_motion and self._differing(one.setting, numbers, following):
                    raise Refused(f"{one.name}: it changes while the bridge is off: disable first")
            except Refused as error:
                raise Refused(f"{place}:{one.line}: {error}; nothing has been set") from None

    def _numbers(self, one: Given, law: str) -> dict[int, float]:
        """By element."""
        setting = one.setting
        if one.gain:
            gains = self._known.law_gains[law]
            if one.gain not in gains:
                raise Refused(f"{one.name}: this law has {', '.join(gains) or 'none'}")
            return {gains.index(one.gain): setting.number_of(one.value)}
        values: list[object] = [*one.value] if isinstance(one.value, list) else [one.value]
        return {n: setting.number_of(value) for n, value in enumerate(values)}

    def _differing(self, setting: Setting, numbers: Mapping[int, float], following: Container[str]) -> dict[int, float]:
        """`following`: what the drive shows is not given."""
        names = setting.elements_named
        return {n: number for n, number in numbers.items()
                if not (math.isnan(number) if names[n] in following else same(number, self._read(setting, n)))}

    def _put(self, one: Given, following: Container[str]) -> bool:
        written = self._differing(one.setting, self._numbers(one, str(self["law"])), following)
        for n, number in written.items():
            self._write(one.setting, n, number)
        return bool(written)
