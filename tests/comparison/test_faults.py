"""What the table of faults is made of, and a tiny one.

usage: test_faults.py PROGRAM ROOT
"""
import csv
import json
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]).absolute(), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from comparison.experiment import read_motor  # noqa: E402
from fault_table import cells, outcome, table  # noqa: E402
from spread.answer import Refused  # noqa: E402

HOME = read_motor("bendjedia-2012")
BOUNDS = ROOT / "tests/comparison/faults.toml"


def cell_of(fault, point, drive="sensorless"):
    (found,) = [cell for cell in cells.cells_of(HOME)
                if (cell.fault.name, cell.point.name, cell.drive.name) == (fault, point, drive)]
    return found


def summary(faults=(), failure=None, peak_A=2.0):
    return {"seed": 3, "failure": failure,
            "faults": [{"time_s": time_s, "fault": name} for time_s, name in faults],
            "reports": [{"metric": "current_peak_A", "value": peak_A},
                        {"metric": "position_error_max_rad", "value": 0.1}]}


def said(cell, at_s, name="stalled", peak_A=2.0):
    return outcome.outcome_of(cell, "float", summary([(at_s, name)], peak_A=peak_A))._replace(
        error_rad=0.1)


class Outcomes(unittest.TestCase):
    def test_what_is_said_counts_from_the_fault_on_or_from_the_next_motion(self):
        cell = cell_of("jam", "rest")
        _, at_s, next_s, _ = cell.timeline()
        self.assertAlmostEqual(0.02, said(cell, at_s + 0.02).after_s)
        later = said(cell, next_s + 0.03)
        self.assertTrue(later.in_next)
        self.assertAlmostEqual(0.03, later.after_s)

    def test_a_fault_before_its_event_is_a_false_alarm(self):
        cell = cell_of("jam", "move")
        early = said(cell, cell.timeline()[1] - 0.01)
        self.assertTrue(early.early)
        self.assertEqual(["stalled before there is a fault"],
                         outcome.misses_of(cell, early, self.bound()))

    def test_a_motion_that_is_refused_behind_a_fault_is_no_failure(self):
        cell = cell_of("jam", "rest")
        run = summary([(cell.timeline()[1] + 0.01, "stalled")], failure="a command was refused")
        self.assertEqual("stalled", outcome.outcome_of(cell, "float", run).detected_as)
        run["faults"] = []
        self.assertEqual("a command was refused", outcome.outcome_of(cell, "float", run).failure)

    @staticmethod
    def bound(**keys):
        return outcome.Bound(**{"faults": ["*"], "drives": ["*"], "points": ["*"], "reason": "",
                                "said": ["stalled"], "within_ms": 20, "peak_rated": 1.0,
                                "error_steps": 5, **keys})

    def test_each_part_of_a_bound_is_asked_for(self):
        cell = cell_of("jam", "move")
        at_s = cell.timeline()[1]
        good = said(cell, at_s + 0.02)
        self.assertEqual([], outcome.misses_of(cell, good, self.bound()))
        for keys, text in (({"within_ms": 19}, "after 20.0 ms"), ({"peak_rated": 0.6}, "peak 0.67"),
                           ({"error_steps": 3}, "3.18 full steps"), ({"said": ["encoder"]}, "says")):
            (miss,) = outcome.misses_of(cell, good, self.bound(**keys))
            self.assertIn(text, miss)
        silent = outcome.outcome_of(cell, "float", summary())._replace(error_rad=0.0)
        self.assertEqual(["nothing said"], outcome.misses_of(cell, silent, self.bound()))
        self.assertEqual([], outcome.misses_of(cell, silent, self.bound(silent=True)))
        self.assertEqual([], outcome.misses_of(cell, silent, self.bound(said=[])))


class Bounds(unittest.TestCase):
    def test_every_cell_has_its_bound_and_every_bound_its_cell_and_reason(self):
        bounds = outcome.read_bounds(BOUNDS)
        others = [read_motor(name) for name in ("8hs15-0604s", "17hs19-2004s1", "87hs78-4204")]
        unnamed = read_motor("sh1603-5240")
        used = [outcome.bound_of(cell, bounds, BOUNDS) for cell in
                (*cells.cells_of(HOME), *(cell for motor in others
                                          for cell in cells.cells_of(motor, cells.DRIVES[:2])),
                 *cells.cells_of(unnamed))]
        self.assertEqual([], [bound for bound in bounds if not any(bound is one for one in used)])
        self.assertEqual([], [bound for bound in bounds if len(bound.reason) < 10])

    def test_what_is_wrong_in_the_file_is_named(self):
        with tempfile.TemporaryDirectory() as folder:
            file = pathlib.Path(folder, "bounds.toml")
            for text, words in (('[[bound]]\nfaults = ["*"]\n', "without drives"),
                                ("bound = 1", "expected an array"),
                                ('[[bound]]\nfaults = ["*"]\ndrives = ["*"]\npoints = ["*"]\n'
                                 'reason = "x"\nwithin_s = 1\n', "unknown within_s")):
                file.write_text(text, encoding="utf-8")
                with self.assertRaises(Refused) as refused:
                    outcome.read_bounds(file)
                self.assertIn(words, str(refused.exception))


class Table(unittest.TestCase):
    def test_a_cell_says_worst_and_what_was_not_detected(self):
        cell = cell_of("jam", "rest")
        _, at_s, next_s, _ = cell.timeline()
        runs = [said(cell, at_s + 0.01), said(cell, next_s + 0.02, peak_A=4.5),
                outcome.outcome_of(cell, "float", summary())._replace(error_rad=0.1)]
        self.assertEqual(
            "[stalled] in 1 of 3, 10 ms; [stalled] in 1 of 3, 20 ms of the next motion; "
            "not detected in 1 of 3: 1.5 × (4.5 A), 3.2 steps",
            table.cell_text([cell] * 3, runs))

    def test_each_fault_is_linked_to_its_place_on_the_page(self):
        cell = cell_of("jam", "rest")
        links = table.definitions_of({cell: [said(cell, cell.timeline()[1] + 0.01)]})
        self.assertEqual("[stalled]: ../interface/faults.md#stalled", links)
        page = (ROOT / "firmware/interface/faults.md").read_text(encoding="utf-8")
        self.assertIn('<a id="stalled"></a>', page)

    def test_scenarios_are_written_once_for_each_cell(self):
        names = [cell.name for cell in cells.cells_of(HOME)]
        self.assertEqual(len(names), len(set(names)))
        for cell in cells.cells_of(HOME)[::17]:
            tomllib.loads(cell.scenario())


class Program(unittest.TestCase):
    def tool(self, *arguments):
        return subprocess.run(
            [sys.executable, ROOT / "tools/faults", "--program", PROGRAM, *map(str, arguments)],
            capture_output=True, text=True, check=False)

    def test_a_bound_that_is_missed_is_named_with_its_command(self):
        with tempfile.TemporaryDirectory() as folder:
            bounds = pathlib.Path(folder, "bounds.toml")
            bounds.write_text('[[bound]]\nfaults = ["*"]\ndrives = ["*"]\npoints = ["*"]\n'
                              'said = ["bus-voltage"]\nwithin_ms = 0.1\nreason = "too soon"\n',
                              encoding="utf-8")
            done = self.tool("--quick", "--faults", "over-voltage", "--out", folder, "--check",
                             bounds)
            self.assertEqual(1, done.returncode, done.stderr)
            self.assertIn("NOT HELD  bendjedia-2012, sensorless, over-voltage, rest: after",
                          done.stderr)
            self.assertIn("steadystep-sil run", done.stderr)
            rows = list(csv.DictReader(pathlib.Path(folder, "faults.csv").open(encoding="utf-8")))
            self.assertEqual({"bus-voltage"}, {row["detected_as"] for row in rows})
            cells_found = json.loads(pathlib.Path(folder, "faults.json").read_text(encoding="utf-8"))
            self.assertEqual({("over-voltage", "bus-voltage")},
                             {(cell["fault"], cell["detected_as"]) for cell in cells_found})

    def test_what_is_unknown_is_refused(self):
        done = self.tool("--faults", "rust")
        self.assertEqual(2, done.returncode)
        self.assertIn('unknown fault "rust"', done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
