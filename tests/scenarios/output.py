"""What --out receives: complete, consistent, and readable by others."""
import csv
import json
import math
import pathlib

from program import SMALL, Checks, run, scratch

CHECKS = Checks()

COLUMNS = """time_s theta_ref_rad theta_rad theta_est_rad omega_rad_s omega_est_rad_s load_torque_Nm
load_torque_est_Nm i_a_A i_b_A u_a_V u_b_V drive_state i_d_A i_q_A i_d_ref_A i_q_ref_A u_d_V u_q_V
omega_ref_rad_s resistance_est_ohm""".split()

METRICS = """position_error_max_rad position_error_rms_rad position_error_final_rad
estimate_error_max_rad estimate_error_rms_rad estimate_error_final_rad speed_error_rms_rad_s
load_torque_error_rms_Nm load_torque_error_final_Nm overshoot_rad settling_time_s current_peak_A
current_rms_A voltage_peak_V voltage_rms_V slip_full_steps fault""".split()

SUMMARY = """scenario description motor numeric seed set version reproduce passed failure simulated_s
cpu_s trace_hash drive_hash metrics expectations""".split()


def table(folder, place="out/small"):
    with open(folder / place / "trace.csv", encoding="utf-8", newline="") as file:
        rows = list(csv.reader(file))
    return rows[0], [[float(cell) for cell in row] for row in rows[1:]]


def summary_of(folder, place="out/small"):
    return json.loads((folder / place / "summary.json").read_text(encoding="utf-8"))


def run_small(folder, text, *arguments):
    (folder / "small.toml").write_text(text, encoding="utf-8")
    return run("run", "small.toml", *arguments, "--out", "out", cwd=folder)


def files_are_complete(folder):
    run_small(folder, SMALL)
    names = sorted(path.name for path in (folder / "out/small").iterdir())
    CHECKS.that(names == ["serial.txt", "summary.json", "trace.csv"],
                f"three files, nothing aside: {names}")
    summary = summary_of(folder)
    for key in SUMMARY:
        CHECKS.that(key in summary, f"summary has {key}")
    for window in ("move", "rest", "all"):
        for key in METRICS:
            value = summary["metrics"][window].get(key, "absent")
            CHECKS.that(value != "absent", f"{window} has {key}")
    CHECKS.that(summary["passed"] is True and summary["failure"] is None, "summary says passed")
    CHECKS.that(summary["expectations"] == [{"metric": "fault", "window": "all", "equals": "none",
                                             "value": "none", "passed": True}],
                f"expectations: {summary['expectations']}")
    CHECKS.that(abs(summary["hold_torque_Nm"] - 0.471) < 1e-9 and abs(summary["hold_heat_W"] - 3.33) < 1e-9,
                f"the hold bears {summary['hold_torque_Nm']} N m for {summary['hold_heat_W']} W")
    CHECKS.that(len(summary["trace_hash"]) == 16 and int(summary["trace_hash"], 16) > 0,
                "a trace hash of 64 bits")


def trace_is_complete(folder):
    run_small(folder, SMALL)
    head, rows = table(folder)
    for column in COLUMNS:
        CHECKS.that(column in head, f"trace has {column}")
    CHECKS.that(len(rows) == 501, f"0...0.05 s at 10 kHz are 501 rows, got {len(rows)}")
    times = [row[0] for row in rows]
    CHECKS.that(times == [n / 10000 for n in range(501)], "times are the nearest to the decimals")
    state = head.index("drive_state")
    CHECKS.that({row[state] for row in rows} == {4.0}, "the drive is ready from time zero on")


def metrics_agree_with_the_trace(folder):
    run_small(folder, SMALL)
    head, rows = table(folder)
    column = {name: [row[i] for row in rows] for i, name in enumerate(head)}
    errors = [a - b for a, b in zip(column["theta_rad"], column["theta_est_rad"])]
    figures = summary_of(folder)["metrics"]["all"]
    rms = math.sqrt(sum(error * error for error in errors) / len(errors))
    CHECKS.that(figures["estimate_error_max_rad"] == max(map(abs, errors)), "largest error")
    CHECKS.that(math.isclose(figures["estimate_error_rms_rad"], rms, rel_tol=1e-12), "rms error")
    CHECKS.that(figures["estimate_error_final_rad"] == abs(errors[-1]), "last error")


def enabling_is_recorded_on_request(folder):
    run_small(folder, "record_enabling = true\n" + SMALL)
    _, rows = table(folder)
    CHECKS.that(rows[0][0] < 0 and rows[-1][0] == 0.05, "times run from before zero to the end")
    (time_zero,) = [i for i, row in enumerate(rows) if row[0] == 0]
    run_small(folder, SMALL)
    _, plain = table(folder)
    CHECKS.that(rows[time_zero:] == plain, "from time zero on the trace is the same")


def events_act_at_their_time(folder):
    load = "\n[[event]]\ntime_s = 0.03\nload_torque_Nm = 0.02\n"
    drift = "\n[[event]]\ntime_s = 0.01\nplant.resistance_scale = 1.5\nramp_s = 0.02\n"
    run_small(folder, SMALL + load + drift)
    head, rows = table(folder)
    load = [row[head.index("load_torque_Nm")] for row in rows]
    ohm = [row[head.index("resistance_ohm")] for row in rows]
    CHECKS.that(load == [0.0] * 300 + [0.02] * 201, "load from 0.03 s on")
    CHECKS.that(ohm[99] == 0.37 and math.isclose(ohm[199], 0.37 * 1.25)
                and math.isclose(ohm[299], 0.37 * 1.5) and ohm[-1] == ohm[299],
                "resistance drifts between 0.01 and 0.03 s")
    moving = [row[head.index("reference_moving")] for row in rows]
    CHECKS.that(moving[2] == 0 and moving[3] == 1 and moving[210] == 0,
                "a move at time zero begins two periods late and takes its 0.02 s")


def a_load_ramps_and_vibrates(folder):
    ramp = "\n[[event]]\ntime_s = 0.01\nload_torque_Nm = 0.02\nramp_s = 0.01\n"
    sine = "\n[[event]]\ntime_s = 0.03\nload_vibration_Nm = 0.01\nload_vibration_Hz = 100\n"
    end = "\n[[event]]\ntime_s = 0.045\nload_vibration_Nm = 0\n"
    run_small(folder, SMALL + ramp + sine + end)
    head, rows = table(folder)
    load = [row[head.index("load_torque_Nm")] for row in rows]
    expected = [0.0] * 100 + [0.02 * (k + 1) / 100 for k in range(100)] + [0.02] * 301
    for k in range(300, 450):
        expected[k] += 0.01 * math.sin(2 * math.pi * 100 * (k - 300) * 1e-4)
    CHECKS.that(all(math.isclose(a, b, abs_tol=1e-9) for a, b in zip(load, expected)),
                "a ramp to 0.02 N m, a sine of 1.5 cycles on top")


def a_drive_that_does_not_get_ready_fails(folder):
    result = run_small(folder, SMALL, "--set", "plant.current_offset_a_A=4.0")
    CHECKS.that(result.returncode == 1, f"exit code {result.returncode}")
    CHECKS.that("did not become ready" in result.stdout, f"says why: {result.stdout}")
    CHECKS.that("did not become ready" in (summary_of(folder)["failure"] or ""), "in the summary")


def a_rotor_that_is_turned_while_it_is_enabled_fails(folder):
    """3 rad/s: the currents of its back-EMF in the windings that stage 2 joins, on both bridges."""
    for model in ("bench", "ideal"):
        result = run_small(folder, SMALL, "--set", f"plant.model={model}", "--set",
                           "drive.calibrate_offsets=true", "--set", "plant.initial_omega_rad_s=5",
                           "--set", "plant.inertia_scale=100")
        CHECKS.that("did not become ready" in result.stdout and "offset-range" in result.stdout,
                    f"{model}: {result.stdout}")


def base_and_set_change_only_what_they_name(folder):
    run_small(folder, SMALL)
    plain = summary_of(folder)
    (folder / "child.toml").write_text('base = "./small.toml"\n[drive]\nlaw = "pid"\n',
                                       encoding="utf-8")
    run("run", "child.toml", "--out", "out", cwd=folder)
    run("run", "small.toml", "--set", "drive.law=pid", "--out", "set", cwd=folder)
    child, with_set = summary_of(folder, "out/child"), summary_of(folder, "set/small")
    CHECKS.that(child["trace_hash"] == with_set["trace_hash"], "base and --set mean the same")
    CHECKS.that(child["trace_hash"] != plain["trace_hash"], "and they do change the law")
    CHECKS.that(with_set["set"] == ["drive.law=pid"], "the summary names the setting")


PID = 'description = "a set"\n[drive]\nlaw = "pid"\nhold_at_rest = false\n'


def parameter_sets_lie_under_the_scenario(folder):
    """--set counts more than --parameters, that more than [drive], that more than `parameters`."""
    (folder / "set.toml").write_text(PID, encoding="utf-8")

    def law(text, *arguments):
        run_small(folder, text, *arguments)
        return summary_of(folder)["law"]

    named = 'parameters = "./set.toml"\n' + SMALL
    own = named.replace("[drive]", '[drive]\nlaw = "state-feedback"')
    CHECKS.that(law(SMALL) != "pid", "the default is another law")
    CHECKS.that(law(named) == "pid", "a named set counts")
    with_set = summary_of(folder)
    CHECKS.that(with_set["parameters"] == "./set.toml", "the summary names the set")
    plain = SMALL.replace("[drive]", '[drive]\nlaw = "pid"\nhold_at_rest = false')
    run_small(folder, plain)
    CHECKS.that(summary_of(folder)["trace_hash"] == with_set["trace_hash"],
                "a set means the same as its keys in the scenario")
    CHECKS.that(law(own) == "state-feedback", "the scenario's own settings count more")
    CHECKS.that(law(own, "--parameters", "set.toml") == "pid", "--parameters counts more yet")
    CHECKS.that("--parameters set.toml" in summary_of(folder)["reproduce"], "and is reproduced")
    CHECKS.that(law(own, "--parameters", "set.toml", "--set", "drive.law=microstepping")
                == "microstepping", "--set counts most")


def reports_are_figures_without_a_bound(folder):
    text = SMALL + ('[[report]]\nmetric = "position_error_rms_rad"\nwindow = [0.0, 0.05]\n'
                    '[[report]]\nmetric = "load_torque_t90_s"\n')
    result = run_small(folder, text)
    summary = summary_of(folder)
    rms, t90 = summary["reports"]
    CHECKS.that(result.returncode == 0, f"what is only reported holds: {result.stdout}")
    CHECKS.that(rms["value"] == summary["metrics"]["all"]["position_error_rms_rad"]
                and rms["window"] == "0...0.05", f"a report's value: {rms}")
    CHECKS.that(t90["value"] is None, f"a report without a value: {t90}")
    CHECKS.that(result.stdout.count("reported") == 2, f"a line each: {result.stdout}")


def json_takes_the_place_of_the_report(folder):
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    (folder / "other.toml").write_text('base = "./small.toml"\n', encoding="utf-8")
    result = run("run", "small.toml", "other.toml", "--seeds", "1-2", "--json", cwd=folder)
    runs = json.loads(result.stdout)
    CHECKS.that([(one["scenario"], one["seed"]) for one in runs]
                == [("small", 1), ("small", 2), ("other", 1), ("other", 2)], "all runs, in order")
    CHECKS.that(not (folder / "out").exists(), "nothing written")
    run_small(folder, SMALL)
    written = summary_of(folder)
    CHECKS.that({key: value for key, value in written.items() if key != "cpu_s"}
                == {key: value for key, value in runs[0].items() if key != "cpu_s"},
                "the same as summary.json")


def every_tenth_period_is_recorded_on_request(folder):
    run_small(folder, SMALL)
    _, all_rows = table(folder)
    run_small(folder, "record_every = 10\n" + SMALL)
    _, rows = table(folder)
    CHECKS.that(rows == all_rows[::10], f"{len(rows)} of {len(all_rows)} rows, the same")


def sweep_writes_its_table(folder):
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    (folder / "sweep.toml").write_text(
        'description = "two scales"\n[[row]]\nfigure = "none"\nparameter = "resistance_scale"\n'
        'scales = [0.9, 1.1]\nscenario = "./small.toml"\npaper = "nothing"\nbound_max_rad = 1.0\n',
        encoding="utf-8")
    result = run("sweep", "./sweep.toml", "--seeds", "1-2", "--out", "swept", cwd=folder)
    rows = json.loads((folder / "swept/table.json").read_text(encoding="utf-8"))["rows"]
    CHECKS.that(result.returncode == 0, f"exit code {result.returncode}")
    CHECKS.that([row["scale"] for row in rows] == [0.9, 1.1], "a row per scale")
    CHECKS.that(all(row["held"] and row["estimate_error_max_rad"] > 0 for row in rows), "figures")


def a_sweep_shows_the_error_and_the_window_it_is_asked_for(folder):
    (folder / "small.toml").write_text(
        SMALL + '[[report]]\nmetric = "position_error_max_rad"\nwindow = [0.0, 0.005]\n',
        encoding="utf-8")
    (folder / "sweep.toml").write_text(
        'description = "a window"\nerror = "position"\nbegin_s = 0.0\nend_s = 0.005\n[[row]]\n'
        'figure = "none"\nparameter = "resistance_scale"\nscales = [1.0]\n'
        'scenario = "./small.toml"\npaper = "nothing"\n', encoding="utf-8")
    run("run", "small.toml", "--out", "out", cwd=folder)
    run("sweep", "./sweep.toml", "--seeds", "1-1", "--out", "swept", cwd=folder)
    rows = json.loads((folder / "swept/table.json").read_text(encoding="utf-8"))["rows"]
    expected = summary_of(folder)["reports"][0]["value"]
    CHECKS.that(rows[0]["position_error_max_rad"] == expected, f"{rows[0]} has {expected}")


def a_creep_that_the_sensing_hides_is_reported(folder):
    """Four codes of +-25 A are 48.8 mA, over 0.37 ohm and 0.157 N m/A 0.115 rad/s."""
    motion = ("[{time_s=0.0,command='velocity',speed_rad_s=SPEED,acceleration_rad_s2=50.0,"
              "jerk_rad_s3=1e5}]")
    for speed, blind in (("0.1", 0.11507), ("0.2", None)):
        done = run_small(folder, SMALL, "--set", "plant.current_range_A=25", "--set",
                         "event=" + motion.replace("SPEED", speed), "--set", "duration_s=0.2")
        said = summary_of(folder)["blind_below_rad_s"]
        CHECKS.that(said is None if blind is None else abs(said - blind) < 1e-4,
                    f"{speed} rad/s: {said}")
        CHECKS.that(("blind: +-25 A for a 3 A motor: creep below 0.12 rad/s is out of reach"
                     in done.stdout) == (blind is not None), f"{speed} rad/s: {done.stdout}")


for check in (files_are_complete, trace_is_complete, metrics_agree_with_the_trace,
              enabling_is_recorded_on_request, events_act_at_their_time, a_load_ramps_and_vibrates,
              a_drive_that_does_not_get_ready_fails,
              a_rotor_that_is_turned_while_it_is_enabled_fails, base_and_set_change_only_what_they_name,
              parameter_sets_lie_under_the_scenario,
              reports_are_figures_without_a_bound, json_takes_the_place_of_the_report,
              every_tenth_period_is_recorded_on_request, sweep_writes_its_table,
              a_sweep_shows_the_error_and_the_window_it_is_asked_for,
              a_creep_that_the_sensing_hides_is_reported):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
