"""What stands behind each figure: a name, the command, what it costs, and how it is read."""
import enum
from typing import Callable, NamedTuple


class Cost(enum.Enum):
    CHEAP = "seconds: checked by tools/test"
    DEAR = "minutes: checked by --full, recorded"
    CAMPAIGN = "on demand, recorded"


class Entry(NamedTuple):
    name: str
    command: str      # as a reader types it
    cost: Cost
    figures: Callable  # of Sources: {part: text}, or the text if there is one part
    probe: tuple      # commands of the simulator whose answers say whether a record still holds
    picture: str      # file of tools/pictures that `figures` draws; ""


ENTRIES = {}


def entry(name, command, cost=Cost.CHEAP, probe=(), picture=""):
    """Declares the entry `name`: marks call its parts `name.part`."""
    def declare(figures):
        assert name not in ENTRIES, f"{name}: declared twice"
        assert probe or (cost is Cost.CHEAP and not picture), f"{name}: a record wants a probe"
        ENTRIES[name] = Entry(name, command, cost, figures, probe, picture)
        return figures
    return declare


def entry_of(mark_name):
    """The entry of a mark; None if there is none."""
    while mark_name:
        if mark_name in ENTRIES:
            return ENTRIES[mark_name]
        mark_name = mark_name.rpartition(".")[0]
    return None


def by_mark(one, figures):
    """{name of a mark: text} of what an entry gives."""
    if isinstance(figures, str):
        return {one.name: figures}
    return {f"{one.name}.{part}": text for part, text in figures.items()}


def table(heads, rows):
    """As Markdown, to stand at a block's mark."""
    def line(cells):
        return "|" + "|".join(f" {cell} " if cell else " " for cell in cells) + "|\n"

    return line(heads) + "|---" * len(heads) + "|\n" + "".join(map(line, rows))
