"""Every fault that the drive knows is caused by one line on the knobs of a served drive.

usage: knobs.py SIL [REPEATS]
"""
import json
import sys
import time

from operated import PACKAGE
from served import Checks, Line, Served

CHECKS = Checks()
REPEATS = int(sys.argv[2]) if len(sys.argv) > 2 else 1
SPEED = 20  # times real time

ENCODER = ("--set", "drive.feedback=encoder", "--set", "plant.encoder_counts_per_turn=4000")
ZERO_KNOWN = ("--set", "drive.encoder_zero_known=true")
VELOCITY = "velocity speed_rad_s={} acceleration_rad_s2=500 jerk_rad_s3=1e5"
REST, SLOW, FAST, BACK = (), *((VELOCITY.format(speed),) for speed in (20, 100, -100))
OFF = None  # the knob is turned before the drive is enabled

FULL_STEP = "move 0.0314159"  # where phase a takes b's part
LOADED = "load_torque_Nm = 0.1"

# fault, the drive, what is done before, the knob, what is done behind it
CASES = (
    ("bus-voltage", (), REST, "plant.bus_V = 8", ()),
    ("hardware-overcurrent", (), REST, 'short_circuit = "A+", short_circuit_A = 30', ()),
    ("overcurrent", (), REST, "plant.current_gain_a = 5", ()),
    ("deadline-missed", (), REST, "stall_us = 110", ()),
    ("bridge-overheated", (), REST, "plant.bridge_temperature_C = 150", ()),
    ("voltage-sensor", (), REST, 'stuck_adc = "phase_voltage_a", code = 800', ()),
    ("lost-synchronism", (), REST, "load_torque_Nm = 0.75, ramp_s = 0.3", ()),
    ("stalled", (), SLOW, "load_torque_Nm = 0.9", ()),
    ("offset-range", (), OFF, 'stuck_adc = "current_a", code = 4000', ()),
    ("phase-imbalance", (), OFF, "plant.current_gain_a = 1.4", ()),
    ("inductance", (), OFF, "plant.inductance_scale = 3", ()),
    ("open-phase-a", ENCODER + ZERO_KNOWN, SLOW, 'open_phase = "a"', ()),
    ("open-phase-b", ENCODER + ZERO_KNOWN, SLOW, 'open_phase = "b"', ()),
    ("current-sensor-a", ENCODER + ZERO_KNOWN, (FULL_STEP, LOADED), 'stuck_adc = "current_a"', BACK),
    ("current-sensor-b", ENCODER + ZERO_KNOWN, (LOADED,), 'stuck_adc = "current_b"', FAST),
    ("following-error", ENCODER + ZERO_KNOWN, SLOW, "jam = true", ()),
    ("estimate-range", ENCODER + ZERO_KNOWN, FAST, 'encoder = "frozen"', ()),
    ("encoder", ENCODER, (LOADED,), 'encoder = "frozen"', ()),
    ("position-not-found", ENCODER, OFF, "jam = true", ()),
    ("motor-overheated", ("motor-heat-microstepping",), REST, "jam = true", ()),
)

# A current that nothing shows may grow to the trip, or be taken for none, before it is known for what it is.
COMES_BEFORE = {f"current-sensor-{phase}": ("hardware-overcurrent", f"open-phase-{phase}") for phase in "ab"}
TRIES = 8


class Table:
    """A drive that is served, its console and its knobs."""

    def __init__(self, served, fault):
        self.drive, self.knobs, self.fault = Line(served.serial[-1]), Line(served.knobs[-1]), fault

    def close(self):
        self.drive.close()
        self.knobs.close()

    def wait(self, seconds):
        """In the drive's time, however quickly the machine lets it live."""
        end = self.time_s() + seconds
        while self.time_s() < end:
            time.sleep(0.005)

    def time_s(self):
        return float(self.knobs.ask("state").split("time_s=")[1].split()[0])

    def do(self, lines):
        for line in lines:
            to = self.knobs if "_Nm" in line else self.drive
            CHECKS.that(to.ask(line).startswith("ok "), f"{self.fault}: {line}")

    def turn(self, knob):
        CHECKS.that("fault=none" in self.knobs.ask("state"), f"{self.fault}: not before {knob}")
        CHECKS.that(self.knobs.ask(knob).startswith("ok time_s="), f"{knob}: is a knob")


def what_a_knob_causes(fault, arguments, before, knob, behind):
    with Served("--speed", 1 if behind else SPEED, *arguments) as served:
        table = Table(served, fault)
        if before is OFF:
            table.turn(knob)
            table.drive.send("enable\n")
        else:
            table.drive.send("enable\n")
            CHECKS.that(table.drive.until("ready:"), f"{fault}: the drive becomes ready")
            table.do(before)
            table.wait(0.5)
            table.turn(knob)
            table.drive.send("".join(line + "\n" for line in behind))
        said = table.drive.until("fault: ").removeprefix("fault: ").split(":")[0]
        CHECKS.that(f"state=fault fault={said}" in table.knobs.ask("state"), f"{said}: and it is true")
        table.close()
        return said


def a_knob_causes(fault, *case):
    said = [what_a_knob_causes(fault, *case)]
    while said[-1] in COMES_BEFORE.get(fault, ()) and len(said) < TRIES:
        said.append(what_a_knob_causes(fault, *case))
    CHECKS.that(said[-1] == fault, f"{case[2]}: expected {fault}, got {said}")


TABLE = {row["name"] for row in json.loads((PACKAGE / "steadystep" / "dictionary.json").read_text())["faults"]}
MISSING = TABLE - {"none"} - {case[0] for case in CASES}
CHECKS.that(not MISSING, f"no knob for {MISSING}")
for _ in range(REPEATS):
    for case in CASES:
        a_knob_causes(*case)
CHECKS.end()
