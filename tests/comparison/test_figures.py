"""tools/figures: marks, entries, what is stale.

usage: test_figures.py PROGRAM ROOT
"""
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from readme_figures import marks, reading, registry  # noqa: E402
from readme_figures.declared import ENTRIES  # noqa: E402
from readme_figures.record import Record  # noqa: E402
from readme_figures.registry import Cost, Entry  # noqa: E402
from readme_figures.sources import NOISE, Sources  # noqa: E402

PAGE = """# A page
Within <!--= one.error -->1.2<!--=--> mrad, <!--= two -->7<!--=--> N.

<!--: three -->
| a | b |
|---|---|
| 1 | 2 |

Sample: <!--: four -->

    first

    last
`<!--= shown -->like this<!--=-->` is no mark.
"""


class InFolder(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def page(self, text=PAGE):
        file = self.folder / "page.md"
        file.write_text(text, encoding="utf-8")
        return file


class Marks(InFolder):
    def test_figures_tables_and_samples_are_found_with_their_line(self):
        found = [(mark.name, mark.line, mark.text) for mark in marks.marks_of(self.page())]
        self.assertEqual(found, [
            ("one.error", 2, "1.2"), ("two", 2, "7"),
            ("three", 5, "| a | b |\n|---|---|\n| 1 | 2 |\n"),
            ("four", 11, "    first\n\n    last\n")])

    def test_only_what_is_given_is_replaced(self):
        new = marks.with_values(PAGE, marks.marks_of(self.page()),
                                {"one.error": "1.25", "three": "| c |\n", "four": "    only\n"})
        self.assertIn("Within <!--= one.error -->1.25<!--=--> mrad, <!--= two -->7<!--=--> N.", new)
        self.assertIn("<!--: three -->\n| c |\n\nSample: <!--: four -->\n\n    only\n`", new)

    def test_a_mark_that_does_not_end_is_refused(self):
        for text in ("<!--= one -->1.2\n", "<!--: three -->\nno table\n"):
            with self.assertRaisesRegex(ValueError, "1 marks begin, 0 are whole"):
                marks.marks_of(self.page(text))


class Records(InFolder):
    def test_a_record_is_stale_once_its_runs_answer_otherwise(self):
        answers = ["1"]
        entry = Entry("dear", "a command", Cost.DEAR, None, (lambda _: answers[0],), "")
        sources, file = Sources(PROGRAM, self.folder), self.folder / "record.json"
        self.assertIsNone(Record(file).figures(entry))
        Record(file).keep(entry, sources, {"part": "7"})
        self.assertEqual(Record(file).figures(entry), {"part": "7"})
        self.assertTrue(Record(file).holds(entry, sources))
        answers[0] = "2"
        self.assertFalse(Record(file).holds(entry, sources))
        self.assertIsNone(Record(file).figures(entry._replace(command="another")))

    def test_a_probe_hears_the_drive_and_not_the_clock(self):
        once, again, other = (Sources(PROGRAM, self.folder).probe((command,)) for command in (
            *["run csmc-fig4 --json --seed 1"] * 2, "run csmc-fig4 --json --seed 2"))
        self.assertEqual(once, again)
        self.assertNotEqual(once, other)
        self.assertEqual(NOISE.sub("", '"cpu_s":0.01,"a":1'), '"a":1')


class Figures(unittest.TestCase):
    def test_within_is_rounded_upwards(self):
        self.assertEqual([reading.up(value, 1) for value in (0.71, 0.7, 1.0)], ["0.8", "0.7", "1.0"])
        self.assertEqual(reading.spelled(1234.5, 0), "1,234")

    def test_every_mark_of_the_readmes_has_an_entry_and_every_entry_a_mark(self):
        names = {mark.name for file in marks.files(ROOT) for mark in marks.marks_of(file)}
        self.assertEqual({name for name in names if registry.entry_of(name) is None}, set())
        used = {registry.entry_of(name).name for name in names}
        self.assertEqual({one.name for one in ENTRIES.values() if not one.picture} - used, set())

    def test_every_picture_of_the_readmes_has_an_entry(self):
        declared = {one.picture for one in ENTRIES.values()} - {""}
        there = {file.name for file in (ROOT / "tools/pictures").glob("*.png")}
        self.assertEqual(there, declared)


class Command(unittest.TestCase):
    def figures(self, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools/figures", *arguments, "--program",
                               PROGRAM], capture_output=True, text=True, check=False)

    def test_a_figure_that_stands_as_the_command_gives_it_is_not_stale(self):
        done = self.figures("--check", "--only", "csmc-sampled")
        self.assertEqual((done.returncode, done.stdout), (0, done.stdout), done.stderr)
        self.assertIn("4 figures of 1 entries, 0 stale", done.stdout)

    def test_an_entry_that_is_not_there_is_refused(self):
        self.assertIn("expected one of", self.figures("--only", "nothing").stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
