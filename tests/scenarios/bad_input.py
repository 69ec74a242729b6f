"""Bad input: one clear line that names file, line and key, exit code 2, and nothing written."""
import os
import pathlib
import resource
import subprocess

from program import ROOT, SIL, SMALL, Checks, run, scratch

CHECKS = Checks()
MOTOR = (ROOT / "sil/motors/bendjedia-2012.toml").read_text(encoding="utf-8")


def replaced(old, new, text=SMALL):
    assert old in text, old
    return text.replace(old, new)


EVENT = "[[event]]\ntime_s = 0.02\n"

# name, text of the scenario, line of the complaint, what the complaint must contain
SCENARIOS = [
    ("no TOML", replaced("duration_s = 0.05", "duration_s = = 0.05"), 3, ["not valid TOML"]),
    ("cut off", SMALL + "[plan", 21, ["not valid TOML"]),
    ("a key twice", replaced("hold_on_enable = false", "hold_on_enable = false\n" * 2), 7,
     ["not valid TOML"]),
    ("unknown key at the top", replaced("duration_s = 0.05", "durations = 0.05"), None,
     ["duration_s"]),
    ("unknown key in a table", replaced('model = "bench"', "bus_v = 24"), 9,
     ["plant.bus_v", "did you mean bus_V?"]),
    ("unknown table", SMALL + "[plants]\n", 21, ["plants", "did you mean plant?"]),
    ("text for a number", replaced("duration_s = 0.05", 'duration_s = "0.05"'), 3,
     ["duration_s", "expected a number in 0.001...600"]),
    ("number for a text", replaced('motor = "bendjedia-2012"', "motor = 2012"), 2,
     ["motor", "expected a text"]),
    ("number for a boolean", replaced("hold_on_enable = false", "hold_on_enable = 0"), 6,
     ["drive.hold_on_enable", "expected true or false"]),
    ("fraction for an integer", replaced('model = "bench"', "delay_periods = 0.5"), 9,
     ["plant.delay_periods", "expected an integer in 0...1"]),
    ("value for a table", "drive = 3\n" + replaced("[drive]\nhold_on_enable = false\n", ""), 1,
     ["drive", "expected a table"]),
    ("date", replaced("duration_s = 0.05", "duration_s = 2012-02-01"), 3, ["date"]),
    ("zero period", replaced('model = "bench"', "period_s = 0"), 9,
     ["plant.period_s", "1e-06...0.001", "got 0"]),
    ("negative inductance", replaced('model = "bench"', "inductance_scale = -1"), 9,
     ["plant.inductance_scale", "0.01...100", "got -1"]),
    ("NaN", replaced('model = "bench"', "bus_V = nan"), 9, ["plant.bus_V", "got nan"]),
    ("more hysteresis than iron has", replaced('model = "bench"', "hysteresis = 0.5"), 9,
     ["plant.hysteresis", "0...0.2", "got 0.5"]),
    ("all of the inertia behind a belt", replaced('model = "bench"', "belt_inertia_share = 1.0"), 9,
     ["plant.belt_inertia_share", "0...0.99", "got 1"]),
    ("a stop that gives at once", replaced('model = "bench"', "stop_stiffness_Nm_rad = 0"), 9,
     ["plant.stop_stiffness_Nm_rad", "0.1...100000", "got 0"]),
    ("stops that overlap", replaced('model = "bench"', "stop_low_rad = 1\nstop_high_rad = 0.5"), 10,
     ["plant.stop_high_rad", "more than stop_low_rad"]),
    ("stops that are none", SMALL + EVENT + "stops = true\n", 23, ["event[2].stops", "stop_low_rad"]),
    ("stops that have gone", SMALL + EVENT + "stops = false\nstop_low_rad = 1\n", 23,
     ["event[2].stops", "false without"]),
    ("a magnet hotter than magnets get", SMALL + EVENT + "plant.magnet_rise_K = 300\n", 23,
     ["event[2].plant.magnet_rise_K", "-100...200", "got 300"]),
    ("infinity", replaced("position_rad = 0.05", "position_rad = inf"), 14,
     ["event[1].position_rad", "got inf"]),
    ("unknown number format", 'numerics = ["fixd"]\n' + SMALL, 1,
     ["numerics", "did you mean fixed?"]),
    ("a number format twice", 'numerics = ["fixed", "fixed"]\n' + SMALL, 1,
     ["numerics", "given twice"]),
    ("no number format", "numerics = []\n" + SMALL, 1, ["numerics", "at least one"]),
    ("more rows than there is room for",
     replaced("duration_s = 0.05", "duration_s = 600").replace('model = "bench"', "period_s = 1e-5"),
     None, ["record_every"]),
    ("no row at all", "record_every = 0\n" + SMALL, 1, ["record_every", "1...1000000"]),
    ("duration zero", replaced("duration_s = 0.05", "duration_s = 0"), 3, ["duration_s"]),
    ("a setting that the drive refuses",
     replaced("hold_on_enable = false", "hold_current_A = 30.0"), 6, ["hold_current_A", "30"]),
    ("a trip that the board cannot see",
     replaced("hold_on_enable = false", "overcurrent_trip_A = 6.5"), 6,
     ["overcurrent_trip_A 6.5 A: must be at most 5.994 A, the board measures"]),
    ("a move that the back-EMF forbids", replaced("position_rad = 0.05", "position_rad = 3.0"), None,
     ["cruise speed", "where the back-EMF takes up the supply"]),
    ("unknown motor", replaced("bendjedia-2012", "bendjedia-2013"), 2,
     ["unknown motor", "did you mean bendjedia-2012?"]),
    ("no motor", replaced('motor = "bendjedia-2012"\n', ""), None, ["motor: is missing"]),
    ("unknown law", replaced("hold_on_enable = false", 'law = "pip"'), 6,
     ["drive.law", "state-feedback, pid", "did you mean pid?"]),
    ("unknown estimator", replaced("hold_on_enable = false", 'estimator = "ukf"'), 6,
     ["drive.estimator", "invariant-ekf, steady-state-ekf"]),
    ("unknown plant model", replaced('"bench"', '"perfect"'), 9, ["plant.model", "ideal, bench"]),
    ("unknown command", replaced("move-trapezoid", "move"), 13, ["event[1].command"]),
    ("command without its fields", replaced("ramp_s = 0.01\n", ""), 11,
     ["event[1].ramp_s", "missing"]),
    ("ramps longer than the move", replaced("ramp_s = 0.01", "ramp_s = 0.02"), 16,
     ["event[1].ramp_s", "0.0001...0.01"]),
    ("field of another command", replaced("ramp_s = 0.01", "ramp_s = 0.01\njerk_s = 0.001"), 17,
     ["event[1].jerk_s", "unknown key"]),
    ("event after the end", replaced("time_s = 0.0", "time_s = 0.06"), 12,
     ["event[1].time_s", "0...0.05"]),
    ("event of two kinds", replaced("time_s = 0.0", "time_s = 0.0\nload_torque_Nm = 1.0"), None,
     ["event[1].command", "exactly one of"]),
    ("a vibration of no frequency", SMALL + EVENT + "load_vibration_Nm = 0.1\n", 21,
     ["event[2].load_vibration_Hz", "missing"]),
    ("a load and its vibration at once",
     SMALL + EVENT + "load_torque_Nm = 0.1\nload_vibration_Nm = 0.1\n", 21, ["exactly one of"]),
    ("short circuit without a current", SMALL + EVENT + 'short_circuit = "A+"\n', 21,
     ["event[2].short_circuit_A", "missing"]),
    ("short circuit of no leg", SMALL + EVENT + 'short_circuit = "C+"\nshort_circuit_A = 9\n', 23,
     ["event[2].short_circuit", "A+, A-, B+, B-"]),
    ("stall beyond the next period", SMALL + EVENT + "stall_us = 200\n", 23,
     ["event[2].stall_us", "10...120"]),
    ("drift of what cannot drift", SMALL + EVENT + "plant.dead_time_s = 2e-6\n", 23,
     ["event[2].plant.dead_time_s", "unknown key"]),
    ("drift beyond its range", SMALL + EVENT + "plant.inertia_scale = 2000\n", 23,
     ["event[2].plant.inertia_scale", "0.01...1000", "got 2000"]),
    ("offset of exact sensing", replaced('model = "bench"', 'model = "ideal"') + EVENT +
     "plant.current_offset_a_A = 0.02\n", 21, ["current_offset_a_A", "not exact"]),
    ("bus above the brake", replaced('model = "bench"', 'model = "real"\nbrake_V = 30.0') + EVENT +
     "plant.bus_V = 40.0\n", 22, ["brake_V"]),
    ("jam by a torque that has gone", SMALL + EVENT + "jam = false\njam_torque_Nm = 1.0\n", 24,
     ["event[2].jam_torque_Nm", "jam = true"]),
    ("a lead of no phase", SMALL + EVENT + 'open_phase = "c"\n', 23, ["event[2].open_phase", "a, b"]),
    ("no such converter", SMALL + EVENT + 'stuck_adc = "current_c"\n', 23,
     ["event[2].stuck_adc", "did you mean current_"]),
    ("a code that the converter has not", SMALL + EVENT + 'stuck_adc = "bus"\ncode = 4096\n', 21,
     ["code", "0...4095"]),
    ("noise without its size", SMALL + EVENT + 'noisy_adc = "bus"\n', 21,
     ["event[2].noise_codes", "missing"]),
    ("two faults at once", SMALL + EVENT + 'jam = true\nopen_phase = "a"\n', 24,
     ["event[2].open_phase", "one fault per event"]),
    ("drift of nothing", replaced("position_rad = 0.05\nduration_s = 0.02\nramp_s = 0.01",
                                  "").replace('command = "move-trapezoid"', "plant = {}"), None,
     ["event[1].plant", "expected a scale"]),
    ("unknown metric", replaced('"fault"', '"faults"'), 19,
     ["expect[1].metric", "did you mean fault?"]),
    ("unknown fault", replaced('"none"', '"nothing"'), 20, ["expect[1].equals"]),
    ("no bound", replaced('"fault"\nequals = "none"', '"overshoot_rad"'), None,
     ["expect[1].max", "max, min, equals"]),
    ("unknown window", SMALL + 'window = "moving"\n', 21, ["expect[1].window", '"move", "rest"']),
    ("window that ends first", SMALL + "window = [0.04, 0.02]\n", 21, ["expect[1].window"]),
    ("window beyond the end", SMALL + "window = [0.04, 0.2]\n", 21,
     ["expect[1].window", "end <= 0.05"]),
    ("report with a bound",
     SMALL + '[[report]]\nmetric = "overshoot_rad"\nmax = 1.0\n', 23,
     ["report[1].max", "unknown key"]),
    ("report of no figure", SMALL + '[[report]]\nmetric = "fault"\n', 22,
     ["report[1].metric", "position_error_max_rad"]),
    ("unknown parameter set", 'parameters = "bendjedia-2012/pip"\n' + SMALL, 1,
     ["parameters", "unknown parameter set", "did you mean bendjedia-2012/pid?"]),
    ("number for a parameter set", "parameters = 3\n" + SMALL, 1,
     ["parameters", "expected a text"]),
    ("unknown base", 'base = "bendjedia-fig100"\n' + SMALL, 1,
     ["base", "did you mean bendjedia-fig10"]),
    ("value without an end", replaced("duration_s = 0.05", "duration_s = [}"), 3,
     ["not valid TOML"]),
    ("brackets that close nothing", SMALL + "[[[\n", 21, ["not valid TOML"]),
    ("table without a bottom", SMALL + "[" + "a." * 50000 + "a]\n", 21,
     ["not valid TOML", "more than 16 parts"]),
    ("arrays without a bottom", replaced("duration_s = 0.05", "duration_s = " + "[" * 50000), 3,
     ["not valid TOML"]),
    ("a line feed in a key", replaced("duration_s = 0.05", '"a\\nb" = 1'), None, ["duration_s"]),
    ("base of itself", 'base = "./scenario.toml"\n' + SMALL, 1, ["base", "itself"]),
]

# name, text of the motor file, line, what the complaint must contain
MOTORS = [
    ("negative inductance", replaced("inductance_H = 0.9e-3", "inductance_H = -0.9e-3", MOTOR), 5,
     ["inductance_H", "1e-06...10", "got -0.0009"]),
    ("no inertia", replaced("inertia_kgm2 = 15.62e-5", "", MOTOR), None,
     ["inertia_kgm2: is missing"]),
    ("NaN", replaced("inertia_kgm2 = 15.62e-5", "inertia_kgm2 = nan", MOTOR), 8, ["got nan"]),
    ("half a tooth", replaced("rotor_teeth = 50", "rotor_teeth = 50.5", MOTOR), 11,
     ["rotor_teeth", "integer in 1...1000"]),
    ("unknown key", MOTOR + "resistance_mohm = 3\n", 12,
     ["resistance_mohm", "did you mean resistance_ohm?"]),
    ("another's name", replaced('id = "bendjedia-2012"', 'id = "kim"', MOTOR), 1,
     ["id", "the name of the file"]),
    ("no TOML", "id = \n", 1, ["not valid TOML"]),
]

# name, text of the parameter set, line, what the complaint must contain
PARAMETERS = [
    ("no description", '[drive]\nlaw = "pid"\n', None, ["description: is missing"]),
    ("no drive settings", 'description = "nothing"\n', None, ["drive: is missing"]),
    ("another table", 'description = "a plant"\n[drive]\n[plant]\nbus_V = 24.0\n', 3,
     ["plant", "unknown key"]),
    ("unknown setting", 'description = "a slip"\n[drive]\nlay = "pid"\n', 3,
     ["drive.lay", "did you mean law?"]),
    ("wrong type", 'description = "a slip"\n[drive]\nlaw_bandwidth_rad_s = "fast"\n', 3,
     ["drive.law_bandwidth_rad_s", "expected a number"]),
    ("a bandwidth that the law cannot bear",
     'description = "too fast"\n[drive]\nlaw = "pid"\nlaw_bandwidth_rad_s = 5000.0\n', None,
     ["bandwidth"]),
    ("no TOML", "description = \n", 1, ["not valid TOML"]),
]

# name, text of the file of settings, line, what the complaint must contain
SETTINGS = [
    ("unknown key", 'law = "pid"\nhold_curent_A = 1.0\n', 2,
     ["hold_curent_A", "did you mean hold_current_A?"]),
    ("a key like no other", "colour = 1\n", 1,
     ["colour: unknown key, expected one of resistance_ohm, ", "initial_angle_error_rad"]),
    ("out of range", "hold_current_A = 3.5\n", 1,
     ["hold_current_A: expected a number in 0.03...3, got 3.5"]),
    ("out of range, of the motor", "supply_V = 1000.0\n", 1, ["supply_V", "5...400", "got 1000"]),
    ("wrong type", 'hold_ramp_s = "slow"\n', 1, ["hold_ramp_s", "expected a number", '"slow"']),
    ("not given where it must be", "hold_ramp_s = nan\n", 1, ["hold_ramp_s", "got nan"]),
    ("a fraction of a tooth", "rotor_teeth = 50.5\n", 1, ["rotor_teeth", "expected an integer"]),
    ("unknown choice", 'law = "pip"\n', 1, ["law", "did you mean pid?"]),
    ("another law's gain", 'law = "pid"\nlaw_gains.k = 1.0\n', 2, ["law_gains.k", "unknown key"]),
    ("what does not go together", "\nstandstill_pulses = true\n", 2,
     ["standstill_pulses: needs initial_position impulses"]),
    ("more than the board measures", "overcurrent_trip_A = 6.5\n", 1,
     ["overcurrent_trip_A 6.5 A: must be at most 5.994 A, the board measures"]),
    ("no TOML", 'law = "pid"\nsupply_V = 24 V\n', 2, ["not valid TOML"]),
    ("a key twice", "supply_V = 24\nsupply_V = 24\n", 2, ["not valid TOML"]),
]

# name, arguments after a good scenario, what the complaint must contain
ARGUMENTS = [
    ("a key set twice", ["--set", "plant.bus_V=24", "--set", "plant.bus_V=30"],
     ["--set plant.bus_V=30", "twice"]),
    ("no value", ["--set", "plant.bus_V"], ["--set plant.bus_V", "table.key=value"]),
    ("out of range", ["--set", "plant.resistance_scale=-1"],
     ["--set plant.resistance_scale=-1", "0.01...100", "got -1"]),
    ("a plant of an unknown name", ["--set", "plant=built"], ["plant.model", "as-built", '"built"']),
    ("wrong type", ["--set", "plant.resistance_scale=much"], ["resistance_scale", '"much"']),
    ("NaN", ["--set", "plant.bus_V=nan"], ["--set plant.bus_V=nan", "got nan"]),
    ("unknown key", ["--set", "drive.lay=pid"], ["drive.lay", "did you mean law?"]),
    ("a divider too small for the supply", ["--set", "plant.bus_range_V=30"],
     ["bendjedia-2012.toml:", "supply_V 24 V: must be at most 23.24 V, over-voltage"]),
    ("unknown law", ["--set", "drive.law=lqr"], ["--set drive.law=lqr", "state-feedback, pid"]),
    ("below a value", ["--set", "duration_s.x=1"], ["duration_s", "no keys"]),
    ("unknown motor", ["--set", "motor=kim-2017"], ["unknown motor", "kim-2016"]),
    ("unknown parameter set", ["--parameters", "bendjedia-2012/pip"],
     ["--parameters bendjedia-2012/pip", "unknown parameter set"]),
    ("a parameter set that is not there", ["--parameters", "pip.toml"],
     ["pip.toml", "no such file"]),
    ("a motor without parameter sets", ["--parameters", "bendjedia/pid"],
     ["did you mean bendjedia-2012/pid?"]),
    ("a file of settings that is not there", ["--settings", "missing.toml"],
     ["missing.toml", "no such file"]),
    ("no file of settings", ["--settings", ""], ["--settings"]),
    ("no file for settings", ["--write-settings", ""], ["--write-settings"]),
    ("settings of a bad scenario", ["--set", "drive.lay=pid", "--write-settings", "settings.toml"],
     ["drive.lay"]),
    ("settings of two scenarios", ["bendjedia-fig12", "--write-settings", "settings.toml"],
     ["--write-settings settings.toml", "one scenario"]),
    ("unknown format", ["--numeric", "half"], ["--numeric", "half"]),
    ("negative seed", ["--seed", "-1"], ["--seed"]),
    ("a seed beyond 64 bits", ["--seed", "99999999999999999999"],
     ["--seed 99999999999999999999", "0...9223372036854775807"]),
    ("a seed beyond 63 bits", ["--seed", "9223372036854775808"], ["0...9223372036854775807"]),
    ("half a seed", ["--seed", "1.5"], ["--seed 1.5"]),
    ("no seed", ["--seed", ""], ["--seed"]),
    ("no seeds", ["--seeds", ""], ["--seeds"]),
    ("no parameter set", ["--parameters", ""], ["--parameters"]),
    ("a key without a bottom", ["--set", "a." * 50000 + "a=1"], ["more than 16 parts"]),
    ("seeds backwards", ["--seeds", "4-1"], ["--seeds 4-1", "A-B"]),
    ("seeds of letters", ["--seeds", "a-b"], ["--seeds a-b"]),
    ("seed and seeds", ["--seed", "1", "--seeds", "1-4"], ["--seed"]),
    ("no jobs", ["--jobs", "0"], ["--jobs"]),
    ("unknown option", ["--fast"], ["--fast"]),
    ("a scenario twice", ["scenario.toml"], ["scenario.toml", "twice"]),
    ("a missing file beside a good one", ["missing.toml"], ["missing.toml", "no such file"]),
    ("an unknown name", ["bendjedia-fig9"], ["unknown scenario", "bendjedia-fig"]),
]


def complains(name, folder, arguments, expected, prefix=""):
    before = sorted(folder.rglob("*"))
    result = run("run", *arguments, "--out", "out", cwd=folder)
    lines = result.stderr.splitlines()
    text = lines[0] if lines else ""
    CHECKS.that(result.returncode == 2, f"{name}: exit code {result.returncode}, expected 2")
    CHECKS.that(len(lines) == 1, f"{name}: one line, got {lines}")
    CHECKS.that(result.stdout == "", f"{name}: standard output is empty")
    CHECKS.that(text.startswith("steadystep-sil: " + prefix), f"{name}: starts with {prefix}: {text}")
    for part in expected:
        CHECKS.that(part in text, f"{name}: names '{part}': {text}")
    CHECKS.that(sorted(folder.rglob("*")) == before, f"{name}: nothing written")


def scenario_files(folder):
    for name, text, line, expected in SCENARIOS:
        (folder / "scenario.toml").write_text(text, encoding="utf-8")
        prefix = f"scenario.toml:{line}: " if line else "scenario.toml"
        complains(name, folder, ["scenario.toml"], expected, prefix)


def motor_files(folder):
    (folder / "scenario.toml").write_text(
        replaced('"bendjedia-2012"', '"./bendjedia-2012.toml"'), encoding="utf-8")
    for name, text, line, expected in MOTORS:
        (folder / "bendjedia-2012.toml").write_text(text, encoding="utf-8")
        prefix = "./bendjedia-2012.toml" + (f":{line}: " if line else "")
        complains("motor: " + name, folder, ["scenario.toml"], expected, prefix)


def parameter_sets(folder):
    (folder / "scenario.toml").write_text('parameters = "set.toml"\n' + SMALL, encoding="utf-8")
    for name, text, line, expected in PARAMETERS:
        (folder / "set.toml").write_text(text, encoding="utf-8")
        prefix = f"set.toml:{line}: " if line else ""
        complains("parameter set: " + name, folder, ["scenario.toml"], expected, prefix)
        # A path on the command line means the same set, from where the command is given.
        complains("--parameters: " + name, folder, ["scenario.toml", "--parameters", "set.toml"],
                  expected, prefix)


def settings_files(folder):
    (folder / "scenario.toml").write_text(SMALL, encoding="utf-8")
    for name, text, line, expected in SETTINGS:
        (folder / "settings.toml").write_text(text, encoding="utf-8")
        complains("settings: " + name, folder, ["scenario.toml", "--settings", "settings.toml"],
                  expected, f"settings.toml:{line}: ")


def arguments(folder):
    (folder / "scenario.toml").write_text(SMALL, encoding="utf-8")
    for name, more, expected in ARGUMENTS:
        complains("argument: " + name, folder, ["scenario.toml", *more], expected)
    for name, command in [("no scenario", ["run"]), ("no command", []), ("unknown", ["walk"]),
                          ("unknown sweep", ["sweep", "bendjedia"])]:
        result = run(*command, cwd=folder)
        CHECKS.that(result.returncode == 2, f"{name}: exit code {result.returncode}")
        CHECKS.that(len(result.stderr.splitlines()) == 1, f"{name}: one line: {result.stderr}")


def output_folder(folder):
    (folder / "scenario.toml").write_text(SMALL, encoding="utf-8")
    (folder / "taken").write_text("a file", encoding="utf-8")
    places = ["taken", "taken/below", "/proc/steadystep"]
    if os.geteuid() != 0:  # root may write anywhere
        (folder / "locked").mkdir(mode=0o500)
        places.append("locked")
    for place in places:
        result = run("run", "scenario.toml", "--out", place, cwd=folder)
        CHECKS.that(result.returncode == 2, f"--out {place}: exit code {result.returncode}")
        CHECKS.that(result.stderr.startswith(f"steadystep-sil: --out {place}: "),
                    f"--out {place}: {result.stderr}")
        CHECKS.that(result.stdout == "", f"--out {place}: nothing has run: {result.stdout}")


def nowhere_to_write(folder):
    """A full device, a closed one, a file system without room, no name at all."""
    (folder / "scenario.toml").write_text(SMALL, encoding="utf-8")
    (folder / "sweep.toml").write_text(
        'description = "one"\n[[row]]\nfigure = "a"\nparameter = "km_scale"\nscales = [1.0]\n'
        'scenario = "./scenario.toml"\npaper = "none"\n', encoding="utf-8")
    campaign = ["campaign", "long-run", "--duration", "0.2"]
    for command in (["run", "scenario.toml"], ["run", "scenario.toml", "--json"], ["list"],
                    ["sweep", "./sweep.toml"], campaign, [*campaign, "--json"], ["--help"],
                    ["--version"]):
        with open("/dev/full", "w", encoding="utf-8") as full:
            result = subprocess.run([SIL, *command], stdout=full, stderr=subprocess.PIPE, text=True,
                                    cwd=folder, check=False)
        CHECKS.that(result.returncode == 2, f"{command} > /dev/full: {result.returncode}")
        CHECKS.that(result.stderr == "steadystep-sil: standard output: cannot be written: "
                    "No space left on device\n", f"{command} > /dev/full: {result.stderr}")
    result = subprocess.run(f"'{SIL}' run scenario.toml --out closed >&-", shell=True, text=True,
                            stderr=subprocess.PIPE, cwd=folder, check=False)
    CHECKS.that(result.returncode == 2 and "standard output: is closed" in result.stderr,
                f"closed: {result.returncode} {result.stderr}")
    for command in (["run", "scenario.toml"], ["sweep", "./sweep.toml"], campaign):
        result = run(*command, "--out", "", cwd=folder)
        CHECKS.that(result.returncode == 2 and "--out" in result.stderr and result.stdout == "",
                    f"{command} --out '': {result.returncode} {result.stderr}")
        full = subprocess.run(
            [SIL, *command, "--out", "small"], capture_output=True, text=True, cwd=folder,
            check=False, restore_signals=False,  # it would end by SIGXFSZ
            preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (100, 100)))
        CHECKS.that(full.returncode == 2 and "cannot be written" in full.stderr
                    and len(full.stderr.splitlines()) == 1,
                    f"{command} without room: {full.returncode} {full.stderr}")
    result = run("run", "scenario.toml", "--write-settings", "sweep.toml/settings.toml", cwd=folder)
    CHECKS.that(result.returncode == 2 and result.stdout == "" and result.stderr
                == "steadystep-sil: sweep.toml/settings.toml: cannot be written\n",
                f"--write-settings below a file: {result.returncode} {result.stderr}")
    result = run(*campaign, "--seed", "1", "--write-scenario", "", cwd=folder)
    CHECKS.that(result.returncode == 2, f"--write-scenario '': {result.returncode}")
    for option, kind, words in (("--stretch", "slip", ["--stretch", "slip", "as-built"]),
                                ("--duration=2", "as-built", ["--duration", "as-built", "its own"])):
        result = run("campaign", kind, option, cwd=folder)
        CHECKS.that(result.returncode == 2 and all(word in result.stderr for word in words),
                    f"campaign {kind} {option}: {result.stderr}")
    result = run("campaign", "long-run", "--duration", "nan", cwd=folder)
    CHECKS.that(result.returncode == 2 and "--duration" in result.stderr,
                f"--duration nan: {result.returncode} {result.stderr}")


def many_bases(folder):
    """Each is held in memory while the ones below it are read."""
    for depth in (16, 400):
        (folder / "0.toml").write_text(SMALL, encoding="utf-8")
        for i in range(depth):
            (folder / f"{i + 1}.toml").write_text(f'base = "./{i}.toml"\n', encoding="utf-8")
        result = run("run", f"{depth}.toml", cwd=folder)
        good = depth == 16
        CHECKS.that(result.returncode == (0 if good else 2), f"{depth} bases: {result.returncode}")
        CHECKS.that(("base: expected at most 16" in result.stderr) != good
                    and len(result.stderr.splitlines()) == (0 if good else 1),
                    f"{depth} bases: {result.stderr}")


def good_input(folder):
    """What the cases above break works when it is whole."""
    (folder / "scenario.toml").write_text(SMALL, encoding="utf-8")
    (folder / "bendjedia-2012.toml").write_text(MOTOR, encoding="utf-8")
    for name, command in [("run", ["run", "scenario.toml"]),
                          ("motor by path", ["run", "scenario.toml", "--set",
                                             "motor=./bendjedia-2012.toml"]),
                          ("list", ["list"]), ("help", ["--help"]), ("version", ["--version"])]:
        result = run(*command, cwd=folder)
        CHECKS.that(result.returncode == 0, f"{name}: exit code {result.returncode}")
        CHECKS.that(result.stderr == "", f"{name}: {result.stderr}")


def broken_expectation(folder):
    """An expectation that does not hold: exit code 1, and a line that repeats it."""
    text = SMALL + '\n[[expect]]\nmetric = "current_peak_A"\nmax = 1e-6\n'
    (folder / "scenario.toml").write_text(text, encoding="utf-8")
    result = run("run", "scenario.toml", "--seed", "7", "--numeric", "fixed", "--set",
                 "plant.bus_V=23", cwd=folder)
    CHECKS.that(result.returncode == 1, f"broken: exit code {result.returncode}")
    command = ("steadystep-sil run scenario.toml --numeric fixed --seed 7 --set plant.bus_V=23")
    CHECKS.that(command in result.stdout, f"broken: how to reproduce it: {result.stdout}")
    line = [text for text in result.stdout.splitlines() if "current_peak_A" in text]
    CHECKS.that(len(line) == 1 and "<= 1e-06" in line[0] and "NOT HELD" in line[0],
                f"broken: named with its bound: {line}")


for part in (scenario_files, motor_files, parameter_sets, settings_files, arguments, output_folder,
             nowhere_to_write, many_bases, good_input, broken_expectation):
    with scratch() as name:
        part(pathlib.Path(name))
CHECKS.end()
