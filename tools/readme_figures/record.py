"""Figures that are dear, as they were found: their command, and what its probe answered then."""
import json
import pathlib

FILE = pathlib.Path(__file__).resolve().parent / "record.json"


class Record:
    def __init__(self, file=FILE):
        self.file = file
        self.rows = self.kept()

    def kept(self):
        return json.loads(self.file.read_text(encoding="utf-8")) if self.file.is_file() else {}

    def figures(self, entry):
        """None: never run, or by another command."""
        row = self.rows.get(entry.name)
        return row["figures"] if row and row["command"] == entry.command else None

    def holds(self, entry, sources):
        """Whether the probe answers what it answered then."""
        return self.rows[entry.name]["probe"] == sources.probe(entry.probe)

    def keep(self, entry, sources, figures):
        self.rows = self.kept()  # others may have been found meanwhile
        self.rows[entry.name] = {"command": entry.command, "probe": sources.probe(entry.probe),
                                 "figures": figures}
        text = json.dumps(self.rows, indent=1, sort_keys=True, ensure_ascii=False)
        self.file.write_text(text + "\n", encoding="utf-8")
