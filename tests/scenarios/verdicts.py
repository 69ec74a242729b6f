"""What a drive does against what it is asked is reported with its time, and must be expected exactly."""
import json
import pathlib
from xml.etree import ElementTree

from program import ROOT, SMALL, Checks, run, scratch

CHECKS = Checks()
SAMPLE = SMALL[:SMALL.index("[[event]]")].replace("duration_s = 0.05", "duration_s = 0.2")
MOVE = 'command = "move-trapezoid", position_rad = 1.0, duration_s = 0.08, ramp_s = 0.03'
VELOCITY = 'command = "velocity", speed_rad_s = 5.0, acceleration_rad_s2 = 500.0, jerk_rad_s3 = 1e5'
OVERLOAD = "{ time_s = 0.06, load_torque_Nm = 3.0 }"  # six times what the motor can bear
STALL = [f"{{ time_s = 0.0, {MOVE} }}", OVERLOAD]
REFUSED = "move refused: the drive is switch-on-disabled, enable it first"


def scenario(events, expects):
    lists = {"event": events, "expect": expects}
    return "".join(f"{name} = [{', '.join(entries)}]\n" for name, entries in lists.items()) + SAMPLE


def outcome(folder, events, expects, *options):
    """Exit code, report and summary."""
    (folder / "one.toml").write_text(scenario(events, expects), encoding="utf-8")
    report = run("run", "./one.toml", *options, cwd=folder)
    (summary,) = json.loads(run("run", "./one.toml", "--json", *options, cwd=folder).stdout)
    CHECKS.that(summary["passed"] == (report.returncode == 0), "report and JSON say the same")
    return report.returncode, report.stdout, summary


def a_fault_that_is_not_expected_is_not_held(folder):
    for expects in ([], ['{ metric = "current_peak_A", max = 100.0 }'],
                    ['{ metric = "fault", window = [0.0, 0.06], equals = "none" }']):
        code, report, summary = outcome(folder, STALL, expects)
        (fault,) = summary["faults"]
        CHECKS.that(code == 1, f"exit code {code} with {expects}")
        CHECKS.that(0.06 < fault["time_s"] < 0.2 and fault["expected"] is False, f"{fault}")
        CHECKS.that(f"NOT EXPECTED  seed 1: fault {fault['fault']} at {fault['time_s']:g} s" in report,
                    f"named with its time: {report}")


def a_fault_must_be_expected_by_its_name_and_in_its_time(folder):
    (fault,) = outcome(folder, STALL, [])[2]["faults"]
    name = fault["fault"]
    held = [f'{{ metric = "fault", equals = "{name}" }}',
            f'{{ metric = "fault", window = [0.06, 0.2], equals = "{name}" }}',
            f'{{ metric = "fault", equals = ["overcurrent", "{name}"] }}']
    not_held = ['{ metric = "fault", equals = "bus-voltage" }',
                '{ metric = "fault", equals = ["none", "bus-voltage"] }',
                f'{{ metric = "fault", window = [0.19, 0.2], equals = "{name}" }}']
    for expect in held + not_held:
        code, report, summary = outcome(folder, STALL, [expect])
        CHECKS.that(code == (0 if expect in held else 1), f"{expect}: {report}")
        CHECKS.that(summary["faults"][0]["expected"] == (expect in held), f"{expect}: {summary}")


def every_seed_counts(folder):
    (folder / "one.toml").write_text(scenario(STALL, []), encoding="utf-8")
    done = run("run", "./one.toml", "--seeds", "1-3", cwd=folder)
    CHECKS.that(done.returncode == 1 and done.stdout.count("NOT EXPECTED") == 3,
                f"each seed: {done.stdout}")


def a_fault_between_two_recorded_rows_counts(folder):
    events = [*STALL, '{ time_s = 0.19, type = "disable" }']
    code, _, summary = outcome(folder, events, [], "--set", "record_every=10000")
    CHECKS.that(code == 1 and len(summary["faults"]) == 1, f"{summary['faults']}")
    CHECKS.that(summary["metrics"]["all"]["fault"] == summary["faults"][0]["fault"], "as a metric, too")


DISABLED = ['{ time_s = 0.05, command = "disable" }', f"{{ time_s = 0.10, {MOVE} }}"]
STANDS = '{ metric = "position_error_max_rad", max = 0.05 }'


def a_refused_command_is_not_held(folder):
    for options in ([], ["--typed"]):
        code, report, summary = outcome(folder, DISABLED, [STANDS], *options)
        (refused,) = summary["commands_refused"]
        CHECKS.that(code == 1, f"{options}: exit code {code}: {report}")
        CHECKS.that(refused["time_s"] == 0.1 and refused["expected"] is False, f"{refused}")
        CHECKS.that(REFUSED in refused["reason"] and "one.toml:1" in refused["reason"], f"{refused}")
        CHECKS.that("NOT EXPECTED  seed 1: refused at 0.1 s: " in report and REFUSED in report, report)
        CHECKS.that(REFUSED in summary["failure"], f"{summary['failure']}")


def a_refused_command_can_be_expected(folder):
    late = f"{{ time_s = 0.11, {MOVE} }}"
    for count, window, held in ((1, "[0.1, 0.11]", True), (1, '"all"', True), (0, '"all"', False),
                                (2, '"all"', False), (1, "[0.0, 0.09]", False)):
        expect = f'{{ metric = "commands_refused", window = {window}, equals = {count} }}'
        for options in ([], ["--typed"]):
            code, report, _ = outcome(folder, DISABLED, [STANDS, expect], *options)
            CHECKS.that((code == 0) == held, f"{expect} {options}: {report}")
    two = '{ metric = "commands_refused", equals = 2 }'
    code, report, summary = outcome(folder, [*DISABLED, late], [two])
    CHECKS.that(code == 0 and len(summary["commands_refused"]) == 2, f"the run goes on: {report}")


def a_command_that_a_fault_overtakes_is_dropped(folder):
    """The second move waits for the end of the first, the third comes when the drive is in fault."""
    events = [*STALL, f"{{ time_s = 0.05, {MOVE.replace('1.0', '2.0')} }}",
              f"{{ time_s = 0.18, {VELOCITY} }}"]
    code, report, summary = outcome(folder, events, [])
    (fault,), (dropped,), (refused,) = (
        summary[name] for name in ("faults", "commands_dropped", "commands_refused"))
    CHECKS.that(code == 1, f"exit code {code}")
    CHECKS.that(dropped["command"] == "move-trapezoid" and dropped["time_s"] >= fault["time_s"],
                f"{dropped}")
    CHECKS.that(f"dropped at {dropped['time_s']:g} s: move-trapezoid" in report, report)
    CHECKS.that("velocity refused: the drive is in fault, disable clears it" in refused["reason"],
                f"{refused}")
    expects = [f'{{ metric = "fault", equals = "{fault["fault"]}" }}',
               '{ metric = "commands_dropped", equals = 1 }',
               '{ metric = "commands_refused", equals = 1 }']
    code, report, _ = outcome(folder, events, expects)
    CHECKS.that(code == 0, f"all expected: {report}")
    for left_out in range(3):
        some = expects[:left_out] + expects[left_out + 1:]
        CHECKS.that(outcome(folder, events, some)[0] == 1, f"without {expects[left_out]}")


def a_drive_that_restarts_counts_from_zero(folder):
    events = [*STALL, f"{{ time_s = 0.05, {MOVE.replace('1.0', '2.0')} }}",
              '{ time_s = 0.15, command = "power-cycle" }']
    _, _, summary = outcome(folder, events, [])
    CHECKS.that([len(summary[name]) for name in ("faults", "commands_dropped")] == [1, 1],
                f"one each: {summary['faults']} {summary['commands_dropped']}")


def a_stream_ends_with_its_first_refusal(folder):
    points = ('command = "set-points", interval_s = 0.01, positions_rad = [0.0, 0.0, 0.0, 0.0], '
              "acceleration_rad_s2 = 100.0, jerk_rad_s3 = 1e5")
    events = [f"{{ time_s = 0.0, {points} }}", '{ time_s = 0.025, command = "disable" }']
    _, _, summary = outcome(folder, events, [])
    CHECKS.that([(one["time_s"], one["command"]) for one in summary["commands_refused"]]
                == [(0.03, "set-points")], f"{summary['commands_refused']}")


def an_error_on_the_serial_line_must_be_expected(folder):
    wrong = '{ time_s = 0.05, type = "mvoe 1" }'
    answer = "{ time_s = 0.06, expect = 'error: \"mvoe\": expected a command' }"
    code, report, summary = outcome(folder, [wrong], [])
    CHECKS.that(code == 1 and 'mvoe 1: error: "mvoe"' in report, f"{report}")
    CHECKS.that(summary["commands_refused"][0]["time_s"] == 0.05, f"{summary['commands_refused']}")
    CHECKS.that(outcome(folder, [wrong, answer], [])[0] == 0, "expected as an event")
    CHECKS.that(outcome(folder, [wrong], ['{ metric = "commands_refused", equals = 1 }'])[0] == 0,
                "expected as a count")


def a_command_for_a_drive_that_restarts_is_judged_by_its_state(folder):
    events = ['{ time_s = 0.02, command = "power-cycle" }', f"{{ time_s = 0.03, {MOVE} }}",
              '{ time_s = 0.04, command = "enable" }', f"{{ time_s = 0.2, {MOVE} }}"]
    _, _, summary = outcome(folder, events, [], "--set", "duration_s=0.4")
    CHECKS.that([one["time_s"] for one in summary["commands_refused"]] == [0.03],
                f"{summary['commands_refused']}")


def counts_take_equals_alone(folder):
    for expect, text in (('{ metric = "commands_refused", max = 1 }', "equals"),
                         ('{ metric = "commands_dropped", equals = 0.5 }', "an integer in 0..."),
                         ('{ metric = "fault", equals = [] }', "at least one fault"),
                         ('{ metric = "fault", equals = ["stallde"] }', "did you mean stalled?")):
        (folder / "one.toml").write_text(scenario([], [expect]), encoding="utf-8")
        done = run("run", "./one.toml", cwd=folder)
        CHECKS.that(done.returncode == 2 and text in done.stderr, f"{expect}: {done.stderr}")


def a_sweep_does_not_hold_with_a_fault(folder):
    (folder / "one.toml").write_text(scenario(STALL, []), encoding="utf-8")
    for bound in ("bound_max_rad = 1000.0\n", ""):
        (folder / "sweep.toml").write_text(
            'description = "one scale"\n[[row]]\nfigure = "none"\nparameter = "resistance_scale"\n'
            'scales = [1.0]\nscenario = "./one.toml"\npaper = "nothing"\n' + bound, encoding="utf-8")
        done = run("sweep", "./sweep.toml", "--out", "swept", cwd=folder)
        (row,) = json.loads((folder / "swept/table.json").read_text(encoding="utf-8"))["rows"]
        CHECKS.that(done.returncode == 1, f"exit code {done.returncode}: {done.stdout}")
        CHECKS.that("fault " in done.stdout and "(seed 1)" in done.stdout, done.stdout)
        CHECKS.that("fault " in (row["unexpected"] or ""), f"{row}")


def the_sample_of_the_readme_holds(folder):
    """What ends in a fault under three times its torque is the sample of sil/README.md."""
    text = (ROOT / "sil/README.md").read_text(encoding="utf-8")
    begin = text.index("    description = ", text.index("## A scenario in ten lines"))
    lines = text[begin:text.index("\n\n", begin)].splitlines()
    (folder / "my-move.toml").write_text("\n".join(line[4:] for line in lines) + "\n",
                                         encoding="utf-8")
    done = run("run", "./my-move.toml", cwd=folder)
    CHECKS.that(done.returncode == 0, f"it holds: {done.stdout}{done.stderr}")
    stalled = (folder / "my-move.toml").read_text(encoding="utf-8").replace("0.05 }", "3.0 }")
    stalled = stalled.replace("max = 2e-3", "max = 1e3")
    (folder / "my-move.toml").write_text(stalled, encoding="utf-8")
    done = run("run", "./my-move.toml", cwd=folder)
    CHECKS.that(done.returncode == 1 and "NOT EXPECTED  seed 1: fault" in done.stdout,
                f"and does not with a fault: {done.stdout}")


def junit_has_a_case_per_run(folder):
    report = folder / "verdicts.xml"
    (folder / "good.toml").write_text(SMALL, encoding="utf-8")
    (folder / "bad.toml").write_text('base = "./good.toml"\n[[expect]]\n'
                                     'metric = "current_peak_A"\nmax = 0.1\n', encoding="utf-8")
    done = run("run", "good.toml", "bad.toml", "--seeds", "1-2", "--numeric", "fixed", "--junit",
               report, cwd=folder)
    CHECKS.that(done.returncode == 1, f"exit code {done.returncode} {done.stderr}")
    suites = ElementTree.parse(report).getroot()
    cases = [(case.get("classname"), case.get("name"), len(case.findall("failure")))
             for case in suites.iter("testcase")]
    CHECKS.that(cases == [("good", "fixed seed 1", 0), ("good", "fixed seed 2", 0),
                          ("bad", "fixed seed 1", 1), ("bad", "fixed seed 2", 1)], f"{cases}")
    CHECKS.that(suites.get("tests") == "4" and suites.get("failures") == "2", f"{suites.attrib}")
    message = next(suites.iter("failure")).get("message")
    CHECKS.that(message.startswith("current_peak_A in all: ") and "expected <= 0.1" in message,
                message)
    command = next(suites.iter("system-out")).text
    CHECKS.that(command == "steadystep-sil run good.toml --numeric fixed --seed 1", command)
    refused = run("run", "good.toml", "--junit", "good.toml/report.xml", cwd=folder)
    CHECKS.that(refused.returncode == 2 and "cannot be written" in refused.stderr, refused.stderr)


for check in (a_fault_that_is_not_expected_is_not_held, junit_has_a_case_per_run,
              a_fault_must_be_expected_by_its_name_and_in_its_time, every_seed_counts,
              a_fault_between_two_recorded_rows_counts, a_refused_command_is_not_held,
              a_refused_command_can_be_expected, a_command_that_a_fault_overtakes_is_dropped,
              a_drive_that_restarts_counts_from_zero, a_stream_ends_with_its_first_refusal,
              an_error_on_the_serial_line_must_be_expected,
              a_command_for_a_drive_that_restarts_is_judged_by_its_state,
              counts_take_equals_alone, a_sweep_does_not_hold_with_a_fault,
              the_sample_of_the_readme_holds):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
