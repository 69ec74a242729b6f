"""Motor files: the library, refusals with file, line and key, and slips of a unit."""
import itertools
import json
import math
import pathlib
import re
import subprocess
import sys

from program import ROOT, Checks, run, scratch

sys.path.insert(0, str(ROOT / "tools"))
from motor_parameters import KEYS, parameters_of  # noqa: E402

CHECKS = Checks()
OF_PAPERS = ("bendjedia-2012", "bendjedia-2012-48V", "kim-2016", "seshagiri-khalil")
LIBRARY = sorted((ROOT / "sil/motors").glob("*.toml"))

NEMA17 = """id = "nema17"
description = "NEMA 17"
source = "a data sheet"
resistance_ohm = 5.3
inductance_H = 6.6e-3
holding_torque_Nm = 0.27
rotor_inertia_kgm2 = 3.5e-6
detent_torque_Nm = 0.022
rated_current_A = 1.0
viscous_friction_Nms_rad = 1e-4
supply_V = 24.0
rotor_teeth = 50
"""

# name, what is written for what, line of the complaint, key, what else it says
REFUSALS = [
    ("mH as H", ("6.6e-3", "6.6"), 5, "inductance_H", ["1.245", "0.0002...0.02 s", "slip of a unit"]),
    ("mA as A", ("rated_current_A = 1.0", "rated_current_A = 1000"), 9, "rated_current_A",
     ["0.01...100"]),
    ("A as mA", ("rated_current_A = 1.0", "rated_current_A = 0.02"), 4, "resistance_ohm",
     ["0.106 V", "0.3...50 V"]),
    ("mohm as ohm", ("5.3", "530"), 5, "inductance_H", ["inductance / resistance"]),
    ("a supply below the rated voltage", ("supply_V = 24.0", "supply_V = 5.0"), 11, "supply_V",
     ["supply / (resistance x rated current)", "1...200"]),
    ("mV as V", ("supply_V = 24.0", "supply_V = 24000"), 11, "supply_V", ["1...1000"]),
    ("N cm as N m", ("0.27", "27"), 7, "rotor_inertia_kgm2", ["rotor inertia / holding torque"]),
    ("g cm2 as kg cm2", ("3.5e-6", "3.5e-3"), 7, "rotor_inertia_kgm2", ["2e-06...0.0012 s^2"]),
    ("both inertias g cm2 as kg m2", ("rotor_inertia_kgm2 = 3.5e-6", "inertia_kgm2 = 1.0"), 7,
     "inertia_kgm2", ["2e-06...0.03 s^2"]),
    ("mN m as N m", ("0.022", "22"), 8, "detent_torque_Nm", ["0.003...0.5"]),
    ("friction in mN m s", ("1e-4", "0.1"), 10, "viscous_friction_Nms_rad", ["0...1"]),
    ("torques that do not agree", ("holding_torque_Nm = 0.27",
                                   "holding_torque_Nm = 0.27\ntorque_constant_Nm_A = 0.27"), 7,
     "torque_constant_Nm_A", ["0.1431891232...0.2386485387", "within 25 %", "got 0.27"]),
    ("no torque", ("holding_torque_Nm = 0.27\n", ""), 1, "torque_constant_Nm_A",
     ["is missing", "holding_torque_Nm"]),
    ("no inertia", ("rotor_inertia_kgm2 = 3.5e-6\n", ""), 1, "inertia_kgm2",
     ["is missing", "rotor_inertia_kgm2"]),
    ("inertia twice", ("rotor_inertia_kgm2 = 3.5e-6",
                       "rotor_inertia_kgm2 = 3.5e-6\ninertia_kgm2 = 3.5e-6"), 7,
     "rotor_inertia_kgm2", ["either inertia_kgm2"]),
    ("a load beside both together", ("rotor_inertia_kgm2 = 3.5e-6",
                                     "inertia_kgm2 = 3.5e-6\nload_inertia_kgm2 = 1e-6"), 8,
     "load_inertia_kgm2", ["either inertia_kgm2"]),
    ("a load without a rotor", ("rotor_inertia_kgm2 = 3.5e-6", "load_inertia_kgm2 = 1e-6"), 1,
     "rotor_inertia_kgm2", ["is missing"]),
    ("a negative load", ("rotor_inertia_kgm2 = 3.5e-6",
                         "rotor_inertia_kgm2 = 3.5e-6\nload_inertia_kgm2 = -1e-6"), 8,
     "load_inertia_kgm2", ["0...10"]),
    ("a word for a torque", ("0.27", '"0.27 Nm"'), 6, "holding_torque_Nm", ["expected a number"]),
]

# key, factor, what was written for what. Of each, how many in a hundred motors of the library are
# refused, and how many are refused or doubted, at least.
SLIPS = [
    ("inductance_H", 1e3, "mH as H", 100, 100),
    ("inductance_H", 1e-3, "H as mH", 100, 100),
    ("inductance_H", 10, "35 mH for 3.5 mH", 30, 100),
    ("inductance_H", 0.1, "3.5 mH for 35 mH", 30, 100),
    ("resistance_ohm", 1e3, "mohm as ohm", 100, 100),
    ("resistance_ohm", 10, "14 ohm for 1.4 ohm", 55, 100),
    ("resistance_ohm", 0.1, "0.14 ohm for 1.4 ohm", 60, 85),
    ("rated_current_A", 1e3, "mA as A", 100, 100),
    ("rated_current_A", 1e-3, "A as mA", 100, 100),
    ("rated_current_A", 10, "20 A for 2.0 A", 60, 100),
    ("rated_current_A", 0.1, "0.2 A for 2.0 A", 40, 100),
    ("holding_torque_Nm", 1e3, "mN m as N m", 100, 100),
    ("holding_torque_Nm", 141.6, "oz in as N m", 100, 100),
    ("holding_torque_Nm", 100, "N cm as N m", 100, 100),
    ("holding_torque_Nm", 10.2, "kg cm as N m", 40, 100),
    ("holding_torque_Nm", 0.01, "N m as N cm", 50, 100),
    ("holding_torque_Nm", 0.1, "N cm as kg cm", 0, 100),
    ("rotor_inertia_kgm2", 1e7, "g cm2 as kg m2", 100, 100),
    ("rotor_inertia_kgm2", 1e4, "kg cm2 as kg m2", 100, 100),
    ("rotor_inertia_kgm2", 1e3, "g cm2 as kg cm2", 100, 100),
    ("rotor_inertia_kgm2", 1 / 183.0, "oz in2 as g cm2", 100, 100),
    ("rotor_inertia_kgm2", 10, "540 g cm2 for 54", 0, 70),
    ("rotor_inertia_kgm2", 0.1, "5.4 g cm2 for 54", 50, 90),
    ("detent_torque_Nm", 1e3, "mN m as N m", 100, 100),
    ("detent_torque_Nm", 100, "N cm as N m", 100, 100),
    ("supply_V", 1e3, "mV as V", 100, 100),
    ("rotor_teeth", 4, "full steps for teeth", 0, 100),
    ("holding_torque_Nm", 1.416, "oz in as N cm: too little to be seen", 0, 0),
]


def judged(folder, text):
    """check-motor's exit code and first complaint: 0 plausible, 1 doubtful, 2 refused."""
    name = re.search(r'id = "([^"]*)"', text)[1]
    (folder / f"{name}.toml").write_text(text, encoding="utf-8")
    done = run("check-motor", f"./{name}.toml", cwd=folder)
    return done.returncode, done.stderr


def the_library_is_plausible(folder):
    """And tools that read a motor file by themselves read the same."""
    done = run("check-motor", "--json", *LIBRARY)
    CHECKS.that(done.returncode == 0, f"no doubts but explained ones: {done.returncode} {done.stderr}")
    motors = json.loads(done.stdout)
    CHECKS.that(len(motors) == len(LIBRARY) >= 29, f"{len(motors)} motors")
    for motor, file in zip(motors, LIBRARY):
        own = parameters_of(file)
        for key in KEYS:
            CHECKS.that(abs(own[key] - motor[key]) <= 1e-15 * motor[key],
                        f"{file.name}: {key} {own[key]} and {motor[key]}")
        CHECKS.that(not motor["doubts"] or motor["unusual"], f"{file.name}: {motor['doubts']}")
        from_a_sheet = file.stem not in OF_PAPERS
        CHECKS.that(motor["source"] and bool(motor["stated"]) == from_a_sheet,
                    f"{file.name}: says where it is from and what the sheet states")


def what_the_drive_bears_is_said(folder):
    """Of every motor; one that the drive would refuse has the refusal instead."""
    for motor in json.loads(run("check-motor", "--json", *LIBRARY).stdout):
        if motor["id"] == "seshagiri-khalil":
            CHECKS.that(motor["refused_sensorless"].startswith("winding_drop_angle_error 117"),
                        f"R x I is 40 V of a 0.135 V s/rad motor: {motor['refused_sensorless']}")
            continue
        CHECKS.that(motor["refused_sensorless"] == "", f"{motor['id']}: accepted")
        torque = motor["hold_torque_Nm"]
        CHECKS.that(abs(torque - motor["torque_constant_Nm_A"] * motor["hold_current_A"]) < 1e-9,
                    f"{motor['id']}: Km x hold current is {torque}")
        CHECKS.that(abs(motor["hold_load_step_Nm"] / torque - 0.7246) < 1e-4,
                    f"{motor['id']}: an undamped rotor bears 0.72 of it at once")
        CHECKS.that(0.033 < motor["hold_noticed_step_Nm"] / torque < 0.165,
                    f"{motor['id']}: notices {motor['hold_noticed_step_Nm'] / torque:.3f} of its torque")
        CHECKS.that(0 < motor["load_step_angle_error_deg"] <= 20, f"{motor['id']}: in motion")
        w_h = math.sqrt(motor["rotor_teeth"] * torque / motor["inertia_kgm2"])
        feigned = 0.025 * motor["resistance_ohm"] * motor["rated_current_A"] / motor["torque_constant_Nm_A"]
        drop = math.degrees(feigned * motor["rotor_teeth"] / w_h)
        CHECKS.that(abs(motor["winding_drop_angle_error_deg"] / drop - 1) < 1e-6 and drop < 20,
                    f"{motor['id']}: {drop} degrees by the drop")
    blind = NEMA17
    for old, new in ("0.27", "0.02"), ("3.5e-6", "3e-7"), ("0.022", "0.001"):
        assert old in blind
        blind = blind.replace(old, new)
    (folder / "nema17.toml").write_text(blind, encoding="utf-8")
    report = run("check-motor", "./nema17.toml", cwd=folder).stdout
    CHECKS.that("  refused: load_step_angle_error " in report, f"says the refusal: {report}")


def refusals_name_file_line_and_key(folder):
    code, complaint = judged(folder, NEMA17)
    CHECKS.that(code == 0 and complaint == "", f"the whole file: {code} {complaint}")
    for name, (old, new), line, key, expected in REFUSALS:
        assert old in NEMA17, old
        code, complaint = judged(folder, NEMA17.replace(old, new))
        prefix = f"steadystep-sil: ./nema17.toml:{line}: {key}: "
        CHECKS.that(code == 2 and len(complaint.splitlines()) == 1, f"{name}: {code} {complaint}")
        CHECKS.that(complaint.startswith(prefix), f"{name}: starts with {prefix}: {complaint}")
        for part in expected:
            CHECKS.that(part in complaint, f"{name}: names '{part}': {complaint}")


def slipped(text, key, factor):
    def times(found):
        return f"{found[1]}{float(found[2]) * factor:.9g}"
    return re.sub(rf"^({key} = )(\S+)", times, text, flags=re.MULTILINE)


def slips_of_a_unit_are_caught(folder):
    all_refused = all_noticed = total = 0
    for key, factor, name, least_refused, least_noticed in SLIPS:
        texts = [text for file in LIBRARY
                 if re.search(rf"^{key} = ", text := file.read_text(encoding="utf-8"), re.MULTILINE)
                 and "unusual = " not in text]
        codes = [judged(folder, slipped(text, key, factor))[0] for text in texts]
        refused, noticed = codes.count(2), len(codes) - codes.count(0)
        all_refused, all_noticed = all_refused + refused, all_noticed + noticed
        total += len(codes)
        print(f"{name:40} {len(codes):3} motors: {refused:3} refused, {noticed - refused:3} doubted")
        CHECKS.that(100 * refused >= least_refused * len(codes),
                    f"{name}: {refused} of {len(codes)} are refused, {least_refused} % expected")
        CHECKS.that(100 * noticed >= least_noticed * len(codes),
                    f"{name}: {noticed} of {len(codes)} are noticed, {least_noticed} % expected")
    print(f"of {total} slips {all_refused} are refused, {all_noticed - all_refused} doubted")
    CHECKS.that(all_refused >= 0.7 * total, "seven in ten are refused")
    CHECKS.that(all_noticed >= 0.94 * total, "nearly all are noticed")


def what_may_be_drawn_as_a_motor_is_not_refused(folder):
    """The corners of the ranges that a campaign of random motors draws from, each on its own."""
    corners = itertools.product((0.4, 0.6, 6.0), (2.0, 6.0), (0.5e-3, 6e-3), (0.03, 4.0),
                                (0.8e-5, 3e-4), (50, 100), (0.0, 60.0))
    for current, volts, time, torque, ratio, teeth, supply in corners:
        volts = 12.0 if current < 0.5 and volts > 2 else volts
        resistance = volts / current
        text = (f'id = "drawn"\ndescription = ""\nsource = ""\nresistance_ohm = {resistance!r}\n'
                f"inductance_H = {time * resistance!r}\nrated_current_A = {current!r}\n"
                f"holding_torque_Nm = {torque!r}\nrotor_teeth = {teeth}\n"
                f"rotor_inertia_kgm2 = {ratio * torque!r}\n"
                f"supply_V = {max(12.0, 4 * volts, supply)!r}\ndetent_torque_Nm = {0.08 * torque!r}\n"
                f"viscous_friction_Nms_rad = {1e-4 * torque / 0.3!r}\n")
        code, complaint = judged(folder, text)
        CHECKS.that(code in (0, 1), f"{text}: {complaint}")


def a_doubt_is_shown_and_can_be_explained(folder):
    doubtful = NEMA17.replace("6.6e-3", "30e-3")
    code, complaint = judged(folder, doubtful)
    CHECKS.that(code == 1 and complaint == "", f"doubted: {code} {complaint}")
    scenario = 'description = "rest"\nmotor = "./nema17.toml"\nduration_s = 0.01\n'
    (folder / "rest.toml").write_text(scenario, encoding="utf-8")
    done = run("run", "./rest.toml", cwd=folder)
    CHECKS.that(done.stderr.startswith("steadystep-sil: doubtful: ././nema17.toml:5: inductance_H: "
                                       "inductance x rated current / torque constant is 0.157"),
                f"a run says so: {done.stderr}")
    code, _ = judged(folder, doubtful.replace("resistance", 'unusual = "mine"\nresistance', 1))
    CHECKS.that(code == 0, f"explained: {code}")
    done = run("run", "./rest.toml", cwd=folder)
    CHECKS.that("doubtful" not in done.stderr, f"and a run is silent: {done.stderr}")


def an_image_takes_a_motor_file_anywhere(folder):
    (folder / "nema17.toml").write_text(NEMA17, encoding="utf-8")
    tool = ROOT / "tools/board_image.py"
    arguments = ["--root", ROOT, "--motor", folder / "nema17.toml", "--version", "1", "--board",
                 "stm32g474", "--pin-map", ROOT / "hal/stm32g474/pin_maps/nucleo_g474re.h",
                 "--numeric", "float", "--flags=", folder / "image.c"]
    done = subprocess.run([sys.executable, tool, *arguments], capture_output=True, text=True,
                          check=False)
    CHECKS.that(done.returncode == 0, f"writes the image's motor: {done.stderr}")
    text = (folder / "image.c").read_text(encoding="utf-8")
    for part in (".torque_constant_Nm_A = 0.190918", ".inertia_kgm2 = 3.5e-06", "float nema17\""):
        CHECKS.that(part in text, f"the image has {part}: {text}")
    (folder / "nema17.toml").write_text(NEMA17.replace("inductance_H = 6.6e-3\n", ""),
                                        encoding="utf-8")
    done = subprocess.run([sys.executable, tool, *arguments], capture_output=True, text=True,
                          check=False)
    CHECKS.that(done.returncode == 1 and "nema17.toml: not a motor file: inductance_H" in done.stderr,
                f"names what is missing: {done.stderr}")


def a_current_range_is_given_once(folder):
    (folder / "rest.toml").write_text(
        'description = "rest"\nmotor = "bendjedia-2012"\nduration_s = 0.01\n[plant]\n'
        "current_range_A = 6.0\ncurrent_range_rated = 2.2\n", encoding="utf-8")
    done = run("run", "./rest.toml", cwd=folder)
    CHECKS.that(done.returncode == 2 and done.stderr.startswith(
        "steadystep-sil: ./rest.toml:6: plant.current_range_rated: "), done.stderr)


for check in (the_library_is_plausible, what_the_drive_bears_is_said, refusals_name_file_line_and_key,
              slips_of_a_unit_are_caught, what_may_be_drawn_as_a_motor_is_not_refused,
              a_doubt_is_shown_and_can_be_explained, an_image_takes_a_motor_file_anywhere,
              a_current_range_is_given_once):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
