"""What the map of the envelope is made of, and a tiny one.

usage: test_envelope.py PROGRAM ROOT
"""
import importlib.util
import json
import pathlib
import shutil
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from comparison import experiment, simulator  # noqa: E402
from operating_envelope import outcome, points  # noqa: E402

HOME = experiment.read_motor(experiment.HOME_MOTOR)
POINT = points.Point(points.PANELS[0], 20.0, 0.5, 0.2355)
DEGREE_rad = 3.4907e-4  # electrical


def summary(error_deg=1.0, **changes):
    worst = changes.get("worst_deg", error_deg)
    return {"failure": changes.get("failure"), "seed": changes.get("seed", 1),
            "metrics": {"all": {"fault": changes.get("fault", "none"),
                                "estimate_error_max_rad": worst and worst * DEGREE_rad}},
            "reports": [{"metric": "estimate_error_max_rad", "value": error_deg * DEGREE_rad},
                        {"metric": "position_error_final_rad",
                         "value": changes.get("lag_rad", 1e-3)}]}


class Outcome(unittest.TestCase):
    def of(self, *runs):
        return outcome.outcome_of([outcome.figures_of(run) for run in runs], POINT, HOME)

    def test_a_run_that_keeps_up_is_locked_with_its_error(self):
        found = self.of(summary(3.0))
        self.assertEqual(found["outcome"], "locked")
        self.assertAlmostEqual(found["error_deg"], 3.0, places=3)

    def test_a_fault_a_failure_and_a_right_angle_are_slips(self):
        for run in (summary(fault="overcurrent"), summary(failure="did not become ready"),
                    summary(worst_deg=91.0), summary(worst_deg=None)):
            self.assertEqual(self.of(run)["outcome"], "slipped")
        self.assertEqual(self.of(summary(worst_deg=89.0))["outcome"], "locked")

    def test_a_rotor_far_from_its_reference_is_left_behind(self):
        self.assertEqual(self.of(summary(lag_rad=0.5))["outcome"], "behind")  # way: 6 rad
        self.assertEqual(self.of(summary(fault="stalled"))["outcome"], "behind")
        self.assertEqual(self.of(summary(fault="lost-synchronism"))["outcome"], "slipped")

    def test_one_seed_decides_and_is_named(self):
        found = self.of(summary(), summary(fault="overcurrent", seed=2), summary(lag_rad=1.0))
        self.assertEqual((found["outcome"], found["seed"], found["slipped_runs"], found["fault"]),
                         ("slipped", 2, 1, "overcurrent"))

    def test_the_error_is_the_95th_percentile(self):
        runs = [summary(float(n)) for n in range(1, 21)]
        self.assertAlmostEqual(self.of(*runs)["error_deg"], 19.0, places=2)
        self.assertAlmostEqual(self.of(*runs[:4])["error_deg"], 4.0, places=2)


def run_of(point):
    """(summary, lines of the trace) of the reference motor on bench."""
    with tempfile.TemporaryDirectory() as scratch:
        file = pathlib.Path(scratch, "point.toml")
        file.write_text(points.scenario_of(point, HOME, "bench"), encoding="utf-8")
        shutil.copy(HOME.file, scratch)
        (run,) = simulator.Simulator(PROGRAM).run([file], out=scratch)
        return run, pathlib.Path(scratch, "point/trace.csv").read_text().splitlines()


class Points(unittest.TestCase):
    def test_a_motor_gets_shares_of_its_own_limits(self):
        found = points.points_of(HOME, points.PANELS[:1], quick=False)
        self.assertEqual(len(found), len(points.SPEEDS) * len(points.LOADS))
        self.assertLess(max(one.speed_rad_s for one in found), 24 / 0.157)
        self.assertAlmostEqual(max(one.load_Nm for one in found), 0.9 * 0.471, places=3)

    def test_the_load_comes_at_speed_and_the_true_motor_is_the_panels(self):
        panel = points.PANELS[1]
        run, (head, *rows) = run_of(points.Point(panel, 20.0, 0.5, 0.2355))
        column = {name: i for i, name in enumerate(head.split(","))}
        rows = [[float(cell) for cell in row.split(",")] for row in rows]
        loaded = [row for row in rows if row[column["load_torque_Nm"]] > 0]
        before = rows[len(rows) - len(loaded) - 1]
        self.assertAlmostEqual(before[column["omega_rad_s"]], 20.0, delta=0.3)
        self.assertAlmostEqual(rows[0][column["resistance_ohm"]], 0.7 * 0.37)
        self.assertEqual(run["metrics"]["all"]["fault"], "none")

    def test_the_drive_accepts_the_fastest_point(self):
        fastest = max(points.speeds_of(HOME, quick=False))
        run, _ = run_of(points.Point(points.PANELS[0], fastest, 0.1, 0.0471))
        self.assertIsNone(run["failure"])

    def test_a_point_of_no_speed_rests_and_then_bears_the_load(self):
        text = points.scenario_of(points.Point(points.PANELS[0], 0.0, 0.3, 0.1413), HOME, "bench")
        (load,) = tomllib.loads(text)["event"]
        self.assertEqual(load, {"time_s": points.AT_REST_s, "load_torque_Nm": 0.1413})
        self.assertIn(0.0, points.speeds_of(HOME, quick=False))
        self.assertIn(0.0, points.speeds_of(HOME, quick=True))


class Program(unittest.TestCase):
    def call(self, folder, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools/envelope", "--quick", "--program",
                               PROGRAM, "--out", folder, *arguments], capture_output=True,
                              text=True, check=False)

    def test_a_tiny_map_is_locked_everywhere_and_goes_on_where_it_was_cut_off(self):
        with tempfile.TemporaryDirectory() as scratch:
            table, journal = (pathlib.Path(scratch, name)
                              for name in ("table.json", "results.jsonl"))
            first = self.call(scratch)
            self.assertEqual(first.returncode, 0, first.stderr)
            whole = table.read_text(encoding="utf-8")
            rows = json.loads(whole)["rows"]
            self.assertEqual([row["outcome"] for row in rows], ["locked"] * 12)
            self.assertLess(max(row["error_deg"] for row in rows if row["speed_rad_s"]), 15)
            self.assertLess(max(row["error_deg"] for row in rows), 20)
            lines = journal.read_text(encoding="utf-8").splitlines()
            journal.write_text("\n".join(lines[:5]) + '\n{"key": "ab', encoding="utf-8")
            second = self.call(scratch, "--jobs", "1")
            self.assertIn("5 of 12 points", second.stderr)
            self.assertEqual(table.read_text(encoding="utf-8"), whole)
            if importlib.util.find_spec("matplotlib"):
                picture = pathlib.Path(scratch, "envelope.png").read_bytes()
                self.assertEqual(picture[:4], b"\x89PNG")

    def test_a_drive_that_assumes_a_wrong_angle_slips_on_the_map(self):
        with tempfile.TemporaryDirectory() as scratch:
            done = self.call(scratch, "--set", "drive.hold_on_enable=false",
                             "--set", "drive.initial_angle_error_rad=0.063")
            self.assertEqual(done.returncode, 0, done.stderr)
            rows = json.loads(pathlib.Path(scratch, "table.json").read_text())["rows"]
        self.assertEqual({row["outcome"] for row in rows}, {"slipped"})

    def test_a_panel_that_nobody_knows_ends_with_2_and_one_line(self):
        with tempfile.TemporaryDirectory() as scratch:
            done = self.call(scratch, "--panels", "weather")
        self.assertEqual(done.returncode, 2)
        self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
        self.assertIn("nominal", done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
