"""tools/vibration: what it asks, and that it finds the amplitude that is borne.

usage: test_vibration.py PROGRAM ROOT
"""
import pathlib
import sys
import tempfile
import tomllib
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from comparison.experiment import HOME_MOTOR, read_motor  # noqa: E402
from comparison.simulator import Simulator  # noqa: E402
from vibration_map import points  # noqa: E402

MOTOR = read_motor(HOME_MOTOR)


class Below:
    """A drive that bears what is below a share of the rated torque."""

    def __init__(self, limit):
        self.limit, self.asked = limit, []

    def run_each(self, files, seeds):
        document = tomllib.loads(files[0].read_text(encoding="utf-8"))
        share = document["event"][0]["load_vibration_Nm"] / MOTOR.rated_torque_Nm
        self.asked.append(share)
        fault = "none" if share < self.limit else "lost-synchronism"
        return [[{"failure": None, "metrics": {"all": {"fault": fault,
                                                       "position_error_max_rad": 0.01}}}]]


class Bearable(unittest.TestCase):
    POINT = points.Point("bench", "at rest", 50.0)

    def found(self, simulator, point=POINT, seeds=(1, 1)):
        with tempfile.TemporaryDirectory() as folder:
            return points.borne(point, MOTOR, simulator, seeds, pathlib.Path(folder))

    def test_the_amplitude_is_found_to_one_per_cent(self):
        for limit in (0.0531, 0.437, 0.99):
            share, all_borne = self.found(Below(limit))
            self.assertFalse(all_borne)
            self.assertTrue(limit - 0.0101 <= share < limit, f"{share} for {limit}")
        self.assertEqual(self.found(Below(2.0)), (1.0, True))

    def test_half_an_electrical_turn_is_not_borne(self):
        for error_rad, borne in ((0.9, True), (1.1, False)):
            run = {"failure": None, "metrics": {"all": {
                "fault": "none", "position_error_max_rad": error_rad * 3.14159 / 50}}}
            self.assertEqual(points.is_borne([run], 50), borne)

    def test_the_drive_bears_a_tenth_of_its_rated_torque(self):
        simulator = Simulator(PROGRAM)
        for state in points.STATES:
            with tempfile.TemporaryDirectory() as folder:
                file = pathlib.Path(folder, "point.toml")
                file.write_text(points.scenario_of(points.Point("real", state, 50.0), 0.1, MOTOR),
                                encoding="utf-8")
                self.assertTrue(points.is_borne(simulator.run([file]), MOTOR.rotor_teeth), state)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1], verbosity=1)
