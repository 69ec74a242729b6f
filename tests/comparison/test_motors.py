"""What the matrix of motors is made of, and a tiny one.

usage: test_motors.py PROGRAM ROOT
"""
import importlib.util
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]).absolute(), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from comparison.experiment import read_motor  # noqa: E402
from motor_matrix import cells, table, verdict  # noqa: E402

KIM = read_motor("kim-2016")
IDEAL, BENCH, REAL, SMOOTH = cells.PLANTS
SENSORLESS, ENCODER = cells.FEEDBACKS


def run_of(course, plant=BENCH, feedback=SENSORLESS, motor=KIM):
    (found,) = [run for run in cells.runs_of(motor, [plant], [feedback])
                if run.course.name == course]
    return found


def summary(run, seed=1, missed=None, failure=None, ready_rad=0.0, settling_s=0.02, by=2.0,
            limit_rad=None):
    """Of a run in which all expectations hold but number `missed`, `by` times its bound."""
    expected = tomllib.loads(run.scenario())["expect"]
    return {"seed": seed, "failure": failure, "hold_yield_rad": limit_rad,
            "expectations": [{**one, "passed": i != missed and failure is None,
                              "value": "overcurrent" if one["metric"] == "fault" else
                              by * one["max"] if i == missed else one["max"] / 2}
                             for i, one in enumerate(expected)],
            "reports": [{"metric": "estimate_error_max_rad", "value": ready_rad},
                        {"metric": "settling_time_s", "value": settling_s}]}


def verdicts(run, *summaries):
    return [cell["verdict"] for cell in verdict.cells_of(run, list(summaries))]


class Scenarios(unittest.TestCase):
    def test_every_move_is_judged_once_on_every_plant_with_every_feedback(self):
        judged = [(run.plant.name, run.feedback.name, span.move)
                  for run in cells.runs_of(KIM) for span in run.course.spans]
        self.assertEqual(len(judged), len(set(judged)))
        self.assertEqual(len(judged), 4 * 2 * len(cells.MOVES))

    def test_bounds_are_those_of_a_full_step_and_of_a_count(self):
        step = math.pi / 100
        for plant, feedback, steps, counts in (
                (BENCH, SENSORLESS, 1 / 16, 0), (REAL, SENSORLESS, 1 / 5, 0),
                (SMOOTH, ENCODER, 1 / 16, 1), (REAL, ENCODER, 1 / 5, 1)):
            document = tomllib.loads(run_of("rest", plant, feedback).scenario())
            fault, slip, commutation, position = document["expect"]
            self.assertEqual((fault["equals"], slip["max"]), ("none", 0))
            self.assertAlmostEqual(commutation["max"], math.radians(45) / 50, places=6)
            self.assertAlmostEqual(position["max"], steps * step + counts * 2 * math.pi / 4000,
                                   places=6)
            self.assertEqual(position["window"], [2.75, 3.0])
            self.assertEqual(document["plant"]["current_range_rated"], 2.2)

    def test_the_load_is_a_quarter_of_the_rated_torque_and_is_borne_in_60_ms(self):
        document = tomllib.loads(run_of("step").scenario())
        self.assertAlmostEqual(document["event"][0]["load_torque_Nm"], 0.25 * 0.48 * 2.0)
        soon = document["expect"][-1]
        self.assertAlmostEqual(soon["window"][0], document["event"][0]["time_s"] + 0.06)
        self.assertAlmostEqual(soon["max"], math.pi / 100 / 8, places=6)

    def test_a_turn_asks_a_moderate_share_of_the_motor(self):
        duration, ramp = cells.turn_of(KIM)
        speed = 2 * math.pi / (duration - ramp)
        self.assertAlmostEqual(speed, 0.3 * KIM.rated_speed_rad_s, delta=0.1)
        self.assertLessEqual(speed / ramp, 0.31 * KIM.rated_acceleration_rad_s2)


class Verdicts(unittest.TestCase):
    def test_a_cell_holds_if_every_seed_does(self):
        run = run_of("turn")
        self.assertEqual(verdicts(run, summary(run), summary(run, 2)), ["held"])
        self.assertEqual(verdicts(run, summary(run), summary(run, 2, missed=3)), ["position"])

    def test_the_worst_seed_gives_the_verdict_and_is_named(self):
        run = run_of("step")
        (cell,) = verdict.cells_of(run, [summary(run), summary(run, 2, missed=4),
                                         summary(run, 3, missed=0), summary(run, 4, missed=2)])
        self.assertEqual((cell["verdict"], cell["worst_seed"], cell["held_seeds"], cell["words"]),
                         ("fault", 3, 1, "fault overcurrent"))
        self.assertIsNone(cell["final_steps"])
        (cell,) = verdict.cells_of(run, [summary(run), summary(run, 2, missed=4)])
        self.assertAlmostEqual(cell["final_steps"], 1 / 32, places=4)

    def test_a_run_that_ended_early_is_no_cell_that_holds(self):
        run = run_of("rest")
        (cell,) = verdict.cells_of(run, [summary(run, failure="did not become ready")])
        self.assertEqual((cell["verdict"], cell["words"]), ("fault", "did not become ready"))

    def test_a_loaded_turn_can_hold_whose_release_does_not(self):
        run = run_of("loaded")
        self.assertEqual(verdicts(run, summary(run, missed=7)), ["held", "position"])
        self.assertEqual(verdicts(run, summary(run, missed=3)), ["position", "held"])

    def test_what_the_hold_is_computed_to_yield_is_distinguished(self):
        run = run_of("rest", REAL)
        bound = KIM.full_step_rad / 5
        for by, missed, limit_rad, expected in (
                (1.29, 3, 1.3 * bound, "limit"), (1.31, 3, 1.3 * bound, "position"),
                (1.29, 3, None, "position"), (0.5, 1, 1.3 * bound, "slip")):
            seed = summary(run, 2, missed=missed, by=by, limit_rad=limit_rad)
            self.assertEqual(verdicts(run, summary(run), seed), [expected])

    def test_a_motor_that_alignment_refuses_is_refused(self):
        run = run_of("turn", feedback=ENCODER)
        words = "the drive did not become ready: fault after 1.022 s, fault position-not-found"
        self.assertEqual(verdicts(run, summary(run), summary(run, 2, failure=words)), ["refused"])
        self.assertEqual(verdicts(run, summary(run, missed=1), summary(run, 2, failure=words)),
                         ["slip"])

    def test_a_refusal_keeps_its_words(self):
        (cell,) = verdict.cells_of(run_of("turn"), "motor.toml:3: inertia: too small")
        self.assertEqual((cell["verdict"], cell["words"]),
                         ("refused", "motor.toml:3: inertia: too small"))

    def test_ready_is_wrong_beyond_three_quarters_of_a_count_with_an_encoder_only(self):
        three_quarters = 0.75 * 2 * math.pi / 4000
        for feedback, ready_rad, wrong in ((ENCODER, 1.01 * three_quarters, True),
                                           (ENCODER, 0.99 * three_quarters, False),
                                           (SENSORLESS, 0.01, False)):
            run = run_of("turn", feedback=feedback)
            (cell,) = verdict.cells_of(run, [summary(run), summary(run, 2, ready_rad=ready_rad)])
            self.assertEqual(cell["wrong_ready"], wrong)

    def test_bounds_are_of_shares_of_cells(self):
        found = [{"plant": plant, "feedback": "encoder", "verdict": verdict_, "wrong_ready": wrong}
                 for plant, verdict_, wrong in (("ideal", "held", False), ("bench", "held", True),
                                                ("ideal", "limit", False), ("bench", "fault", False))]
        bounds = {"all": {"all": {"held": 0.5, "wrong_ready": 1, "within_limits": 0.75}},
                  "bench": {"encoder": {"held": 0.6, "wrong_ready": 0}},
                  "ideal": {"encoder": {"within_limits": 1.0}},
                  "real": {"encoder": {"held": 1}}}
        lines, asked = verdict.bound_misses(found, bounds)
        self.assertEqual(asked, 6)
        self.assertEqual(lines, ["bench, encoder: held 0.5 of 2 cells, bound 0.6",
                                 "bench, encoder: wrong_ready 1 of 2 cells, bound 0"])

    def test_the_table_has_a_sign_per_move_and_a_line_for_what_does_not_hold(self):
        found = []
        for course in cells.courses_of(KIM):
            run = run_of(course.name)
            missed = 3 if course.name == "creep" else None
            found += verdict.cells_of(run, [summary(run, missed=missed)])
        for cell in found:
            cell["reproduce"] = "steadystep-sil run …"
        self.assertIn("···p···", table.as_text(found))
        (line,) = table.not_held_lines(found, 9)
        self.assertIn("kim-2016, bench, sensorless: creep;", line)


class Program(unittest.TestCase):
    def call(self, folder, *arguments, program=PROGRAM):
        return subprocess.run([sys.executable, ROOT / "tools/motors", "--motor", "kim-2016",
                               "--program", program, "--out", folder, *arguments],
                              capture_output=True, text=True, check=False)

    def test_a_motor_that_holds_everywhere_on_ideal_and_goes_on_where_it_was_cut_off(self):
        with tempfile.TemporaryDirectory() as scratch:
            quick = "--quick", "--plants", "ideal", "--seeds", "1-1", "--json"
            first = self.call(scratch, *quick)
            self.assertEqual(first.returncode, 0, first.stdout + first.stderr)
            found = json.loads(first.stdout)
            self.assertEqual([cell["verdict"] for cell in found], ["held"] * 14)
            journal = pathlib.Path(scratch, "results.jsonl")
            lines = journal.read_text(encoding="utf-8").splitlines()
            journal.write_text("\n".join(lines[:7]) + '\n{"key": "ab', encoding="utf-8")
            second = self.call(scratch, *quick)
            self.assertIn("1 of 2 calls", second.stderr)
            self.assertEqual(second.stdout, first.stdout)
            if importlib.util.find_spec("matplotlib"):
                self.assertEqual(pathlib.Path(scratch, "motors.png").read_bytes()[:4], b"\x89PNG")
            again = subprocess.run([PROGRAM, "run", pathlib.Path(
                scratch, "scenarios/kim-2016/ideal-encoder-rest.toml")], capture_output=True,
                text=True, check=False)
            self.assertEqual(again.returncode, 0, again.stdout + again.stderr)

    def test_a_drive_that_assumes_a_wrong_angle_does_not_hold(self):
        with tempfile.TemporaryDirectory() as scratch:
            wrong = pathlib.Path(scratch, "wrong")
            wrong.write_text(f"#!/bin/sh\nexec '{PROGRAM}' \"$@\" "
                             "--set drive.hold_on_enable=false "
                             "--set drive.initial_angle_error_rad=0.063\n", encoding="utf-8")
            wrong.chmod(0o755)
            done = self.call(scratch, "--plants", "ideal", "--feedback", "sensorless", "--seeds",
                             "1-1", "--moves", "turn", program=wrong)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("NOT HELD  kim-2016, ideal, sensorless: turn", done.stdout)

    def test_a_sample_is_of_so_many_cells_and_the_same_each_time(self):
        with tempfile.TemporaryDirectory() as scratch:
            drawn = [self.call(scratch, "--sample", "5", "--seeds", "1-1", "--plants", "ideal",
                               "--fresh", "--json") for _ in range(2)]
        self.assertEqual(drawn[0].stdout, drawn[1].stdout)
        self.assertIn(len(json.loads(drawn[0].stdout)), (5, 6), drawn[0].stderr)

    def test_a_motor_that_the_drive_refuses_is_a_refused_cell(self):
        with tempfile.TemporaryDirectory() as scratch:
            refusing = pathlib.Path(scratch, "refusing")
            refusing.write_text(f"#!/bin/sh\nexec '{PROGRAM}' \"$@\" "
                                "--set drive.current_limit_A=99\n", encoding="utf-8")
            refusing.chmod(0o755)
            done = self.call(scratch, "--plants", "ideal", "--feedback", "sensorless", "--moves",
                             "turn", "--seeds", "1-1", program=refusing)
        self.assertEqual(done.returncode, 1, done.stdout + done.stderr)
        self.assertIn("REFUSED  kim-2016, 1 cells:", done.stdout)
        self.assertIn("current_limit_A", done.stdout)

    def test_a_simulator_that_crashes_is_not_a_refusal(self):
        with tempfile.TemporaryDirectory() as scratch:
            broken = pathlib.Path(scratch, "broken")
            broken.write_text("#!/bin/sh\nkill -SEGV $$\n", encoding="utf-8")
            broken.chmod(0o755)
            done = self.call(scratch, "--plants", "ideal", program=broken)
        self.assertEqual(done.returncode, 2)
        self.assertIn("ended with code -11", done.stderr)

    def test_bad_input_ends_with_2_and_one_line(self):
        with tempfile.TemporaryDirectory() as scratch:
            for arguments, named in ((["--moves", "dance"], "release"),
                                     (["--motor", f"{scratch}/none.toml"], "none.toml"),
                                     (["--motor", "kim-2016"], "twice")):
                done = self.call(scratch, *arguments)
                self.assertEqual(done.returncode, 2)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)
                self.assertIn(named, done.stderr)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
