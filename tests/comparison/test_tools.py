"""What the comparison is made of: optimiser, cost, moves of another motor, table, bounds, page.

usage: test_tools.py PROGRAM ROOT
"""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from comparison import evolution, experiment, results, simulator, table, tuning  # noqa: E402

HOME = experiment.read_motor(experiment.HOME_MOTOR)
STEP, MOVE = (move for move in experiment.MOVES if move.name in ("step", "move"))


def summary(rms_rad=0.0, ripple_A=0.0, **changes):
    reports = [{"metric": "position_error_rms_rad", "value": rms_rad},
               {"metric": "current_ripple_rms_A", "value": ripple_A}]
    if "settling_time_s" in changes:
        reports.append({"metric": "settling_time_s", "value": changes["settling_time_s"]})
    return {"failure": changes.get("failure"), "reports": reports, "reproduce": "steadystep-sil …",
            "metrics": {"all": {"fault": changes.get("fault", "none"),
                                "position_error_final_rad": changes.get("final_rad", 0.0)}}}


def bowl(points):
    """Lowest at 0.3, 0.7; its upper edge is not allowed."""
    return [math.inf if point[0] > 0.9 else (point[0] - 0.3) ** 2 + (point[1] - 0.7) ** 2
            for point in points]


class Optimiser(unittest.TestCase):
    def test_it_finds_the_bottom_of_a_bowl(self):
        *_, (done, point, cost) = evolution.minimise(bowl, 2, 400, seed=1)
        self.assertEqual(done, 400)
        self.assertLess(cost, 1e-6)
        self.assertAlmostEqual(point[0], 0.3, delta=1e-3)

    def test_the_seed_alone_decides(self):
        runs = [list(evolution.minimise(bowl, 2, 100, seed)) for seed in (1, 1, 2)]
        self.assertEqual(runs[0], runs[1])
        self.assertNotEqual(runs[0], runs[2])

    def test_points_stay_in_the_cube(self):
        seen = []

        def cost(points):
            seen.extend(points)
            return bowl(points)

        list(evolution.minimise(cost, 2, 200, seed=3))
        self.assertTrue(all(0 <= value <= 1 for point in seen for value in point))

    def test_what_is_not_allowed_takes_nothing_of_the_budget_but_ends(self):
        calls = []

        def refused(points):
            calls.extend(points)
            return [math.inf] * len(points)

        *_, (done, _, cost) = evolution.minimise(refused, 2, 20, seed=1)
        self.assertEqual((done, cost), (0, math.inf))
        self.assertLessEqual(len(calls), 20 * evolution.MOST_TRIALS + 2 * evolution.members(2))


class Cost(unittest.TestCase):
    def cost(self, run, move=MOVE):
        return tuning.cost_of_run(run, move, HOME, HOME)

    def test_an_error_as_large_as_the_reference_costs_one(self):
        self.assertAlmostEqual(self.cost(summary(MOVE.reference_rad)), 1)

    def test_a_step_also_pays_for_its_settling(self):
        run = summary(STEP.reference_rad, settling_time_s=0.02)
        self.assertAlmostEqual(self.cost(run, STEP), 3)

    def test_ripple_costs_beyond_its_limit_only(self):
        self.assertEqual(self.cost(summary(ripple_A=0.149)), 0)
        self.assertAlmostEqual(self.cost(summary(ripple_A=0.3)), tuning.RIPPLE_COST)

    def test_a_lost_rotor_costs_the_most_whatever_else_it_does(self):
        for run in (summary(failure="the drive did not become ready"), summary(fault="overcurrent"),
                    summary(final_rad=3 * HOME.full_step_rad), summary(final_rad=None)):
            self.assertEqual(self.cost(run), tuning.LOST)
        self.assertEqual(self.cost(summary(1e6)), tuning.LOST)

    def test_a_refused_move_counts_as_lost_and_refused_settings_are_not_allowed(self):
        refused, fine = simulator.Refused("too fast"), [summary(MOVE.reference_rad)]
        moves = [MOVE, MOVE]
        self.assertAlmostEqual(tuning.cost_of_moves([refused, fine], moves, HOME, HOME),
                               tuning.LOST + 1)
        self.assertEqual(tuning.cost_of_moves([refused, refused], moves, HOME, HOME), math.inf)

    def test_settings_and_points_are_the_same_thing(self):
        tunables = tuning.tunables_of("pid", 1e-4)
        settings = tuning.settings_at([0.0, 0.5, 1.0], tunables)
        self.assertEqual(settings["drive.law_bandwidth_rad_s"], 50)
        self.assertEqual(settings["drive.observer_bandwidth_rad_s"], 3000)


class Moves(unittest.TestCase):
    def test_every_move_has_its_scenario_and_reports_what_the_table_shows(self):
        for move in experiment.MOVES:
            reported = {one["metric"] for one in experiment.read_scenario(move.scenario)["report"]}
            shown = {metric for metric, *_ in table.columns_of_move(move)}
            needed = {"position_error_rms_rad", "current_ripple_rms_A", "current_rms_A",
                      "voltage_rms_V"}
            self.assertLessEqual(shown | needed, reported, move.name)

    def test_the_rated_speed_takes_the_whole_supply(self):
        # 24 V: (0.37 ohm 3 A + 0.157 w)^2 + (50 0.9 mH 3 A w)^2
        w = HOME.rated_speed_rad_s
        self.assertAlmostEqual(math.hypot(1.11 + 0.157 * w, 0.135 * w), 24)

    def test_on_the_home_motor_nothing_changes(self):
        self.assertEqual(experiment.scales_of(MOVE, HOME, HOME), (1, 1, 1))

    def test_a_weak_motor_gets_slower_moves_and_longer_ramps(self):
        weak = HOME._replace(rated_acceleration_rad_s2=HOME.rated_acceleration_rad_s2 / 4)
        scales = experiment.scales_of(MOVE, weak, HOME)
        self.assertEqual((scales.time, scales.angle), (4, 4))  # same speed, a quarter of the ramp
        strong = HOME._replace(rated_acceleration_rad_s2=HOME.rated_acceleration_rad_s2 * 4)
        self.assertEqual(experiment.scales_of(MOVE, strong, HOME).time, 1)

    def test_a_step_is_a_full_step_of_any_motor(self):
        fine = HOME._replace(id="fine", rotor_teeth=100)
        text = experiment.scaled_scenario(STEP, fine, HOME)
        self.assertIn("position_rad = 0.0157079635", text)
        self.assertNotIn("[[expect]]", text)

    def test_units_decide_what_is_scaled(self):
        scales = experiment.Scales(angle=2, time=4, torque=3)
        scaled = experiment.scaled_table(
            {"time_s": 1.0, "command": "sine", "amplitude_rad": 0.5, "frequency_Hz": 8.0,
             "cycles": 4, "load_torque_Nm": 0.1, "window": [0.5, 1.0]}, scales)
        self.assertEqual(scaled, {"time_s": 4.0, "command": "sine", "amplitude_rad": 1.0,
                                  "frequency_Hz": 2.0, "cycles": 4, "load_torque_Nm": 0.3,
                                  "window": [2.0, 4.0]})

    def test_another_motors_scenario_is_one_that_the_simulator_takes(self):
        motor = experiment.read_motor("kim-2016")
        with tempfile.TemporaryDirectory() as scratch:
            files = experiment.scenarios_for([STEP, MOVE], motor, pathlib.Path(scratch))
            runs = simulator.Simulator(PROGRAM).run(list(files.values()))
        self.assertEqual([run["motor"] for run in runs], ["kim-2016"] * 2)

    def test_another_motor_takes_a_parameter_set_whole(self):
        foc, stmms = results.entries_of(["foc", "stmms"], experiment.read_motor("kim-2016"))
        self.assertEqual((foc.parameters.parent.name, foc.settings), (experiment.HOME_MOTOR, {}))
        self.assertEqual(list(stmms.settings), ["drive.speed_limit_rad_s"])

    def test_a_file_that_is_no_motor_is_refused_with_its_name(self):
        with self.assertRaisesRegex(simulator.Refused, "compare-step.toml: not a motor file"):
            experiment.read_motor(ROOT / "sil/scenarios/compare-step.toml")


class Table(unittest.TestCase):
    def comparison(self, cells):
        one = results.Comparison(None, HOME, results.entries_of(["pid", "foc"], HOME), [MOVE],
                                 experiment.PLANTS[:1], (1, 1), pathlib.Path("unused"))
        one.cells = {(entry.name, "nominal", "move"): cell
                     for entry, cell in zip(one.entries, cells)}
        return one

    def cells(self, *runs):
        return [results.cell_of([run], HOME) for run in runs]

    def test_the_worst_seed_decides_up_to_nineteen(self):
        self.assertEqual(results.percentile_95([3, 1, 2]), 3)
        self.assertEqual(results.percentile_95([1.0] * 19 + [9.0]), 1.0)
        self.assertIsNone(results.percentile_95([1, None]))

    def test_a_fault_and_a_lost_rotor_are_distinguished(self):
        fault, lost, fine = self.cells(summary(fault="overcurrent"), summary(final_rad=0.2),
                                       summary())
        self.assertEqual((fault.lost, lost.lost, fine.lost), ("fault", "lost", ""))

    def test_the_best_of_a_column_is_marked_and_lost_ones_are_not(self):
        one = self.comparison(self.cells(summary(1e-4), summary(1e-5, final_rad=0.2)))
        column = table.column("move", "rms mrad", list(one.cells.values()),
                              "position_error_rms_rad", 1e3, 3, HOME.full_step_rad)
        self.assertEqual((column.texts, column.bold), (["0.100", "lost"], None))

    def test_a_bound_that_does_not_hold_is_named_with_its_value(self):
        one = self.comparison(self.cells(summary(3e-4), summary(1e-4)))
        bounds = {law: {"move": {"position_error_rms_rad": 2e-4}} for law in ("pid", "foc")}
        (line,), asked = table.misses(one, experiment.PLANTS[0], bounds)
        self.assertEqual(asked, 2)
        for part in ("pid, move", "position_error_rms_rad 0.0003", "bound 0.0002", "reproduce"):
            self.assertIn(part, line)

    def test_a_lost_rotor_holds_no_bound(self):
        one = self.comparison(self.cells(summary(1e-5, fault="overcurrent"), summary()))
        lines, _ = table.misses(one, experiment.PLANTS[0],
                                {"pid": {"move": {"position_error_rms_rad": 1.0}}})
        self.assertEqual(len(lines), 1)


class Programs(unittest.TestCase):
    """tools/compare and tools/tune from outside."""

    def call(self, tool, *arguments):
        return subprocess.run([sys.executable, ROOT / "tools" / tool, *map(str, arguments),
                               "--program", PROGRAM], capture_output=True, text=True, check=False)

    def test_a_bound_that_is_missed_ends_with_1_and_one_that_holds_with_0(self):
        with tempfile.TemporaryDirectory() as scratch:
            bounds = pathlib.Path(scratch, "bounds.toml")
            for limit, code in ((1.0, 0), (1e-9, 1)):
                bounds.write_text(f"[pid.move]\nposition_error_rms_rad = {limit}\n",
                                  encoding="utf-8")
                done = self.call("compare", "--quick", "--laws", "pid", "--moves", "move",
                                 "--check", bounds)
                self.assertEqual(done.returncode, code, done.stdout + done.stderr)
                self.assertEqual("NOT HELD" in done.stdout, code == 1)

    def test_a_law_that_is_not_tuned_for_a_motor_is_not_shown_as_if_it_were(self):
        with tempfile.TemporaryDirectory() as scratch:
            for motor, tuned in (("kim-2016", False), ("bendjedia-2012", True)):
                done = self.call("compare", "--laws", "pid", "--moves", "step", "--plants", "ideal",
                                 "--seeds", "1", "--motor", motor, "--out", scratch)
                self.assertEqual(done.returncode, 0, done.stderr)
                self.assertEqual("Not tuned for kim-2016, so no statement about these laws on it: "
                                 "pid: bandwidths tuned for bendjedia-2012." in done.stdout,
                                 not tuned)
                written = json.loads(pathlib.Path(scratch, "table.json").read_text())
                self.assertEqual([row["tuned"] for row in written["rows"]], [tuned])

    def test_a_law_that_nobody_knows_ends_with_2_and_one_line(self):
        for tool, arguments in (("compare", ["--laws", "pip"]), ("compare", ["--moves", "jump"]),
                                ("compare", ["--motor", "nothing"])):
            done = self.call(tool, *arguments)
            self.assertEqual(done.returncode, 2, done.stderr)
            self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)

    def test_a_tuned_law_is_the_same_with_any_number_of_jobs(self):
        texts = []
        with tempfile.TemporaryDirectory() as scratch:
            for jobs in (1, 2):
                done = self.call("tune", "--law", "pid", "--moves", "move", "--budget", "20",
                                 "--jobs", jobs, "--fresh", "--out", scratch,
                                 "--state", pathlib.Path(scratch, "state"))
                self.assertEqual(done.returncode, 0, done.stderr)
                texts.append(pathlib.Path(scratch, "pid.toml").read_text(encoding="utf-8"))
            run = simulator.Simulator(PROGRAM).run(["compare-move"],
                                                   pathlib.Path(scratch, "pid.toml"))
        self.assertEqual(texts[0], texts[1])
        self.assertEqual(run[0]["law"], "pid")

    def test_a_run_that_was_cut_off_goes_on(self):
        with tempfile.TemporaryDirectory() as scratch:
            state = pathlib.Path(scratch, "state")
            arguments = ["--law", "pid", "--moves", "move", "--budget", "20", "--jobs", "1",
                         "--out", scratch, "--state", state]
            self.call("tune", *arguments)
            first = pathlib.Path(scratch, "pid.toml").read_text(encoding="utf-8")
            (journal,) = state.glob("*.jsonl")
            lines = journal.read_text(encoding="utf-8").splitlines()
            journal.write_text("\n".join(lines[:len(lines) // 2]) + '\n{"key": "ab',
                               encoding="utf-8")
            self.call("tune", *arguments)
            self.assertEqual(pathlib.Path(scratch, "pid.toml").read_text(encoding="utf-8"), first)
            kept = journal.read_text(encoding="utf-8").splitlines()
            kept.remove('{"key": "ab')
            self.assertEqual(sorted(kept), sorted(lines))

    def test_the_table_is_written_with_every_figure(self):
        with tempfile.TemporaryDirectory() as scratch:
            done = self.call("compare", "--laws", "pid", "--moves", "move", "--plants", "ideal",
                             "--seeds", "1", "--out", scratch)
            self.assertEqual(done.returncode, 0, done.stderr)
            written = json.loads(pathlib.Path(scratch, "table.json").read_text(encoding="utf-8"))
        (row,) = written["rows"]
        self.assertEqual((row["law"], row["plant"], row["move"]), ("pid", "ideal", "move"))
        self.assertGreater(row["position_error_rms_rad"], 0)
        self.assertIn("steadystep-sil run compare-move", row["reproduce"])


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
