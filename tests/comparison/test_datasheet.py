"""tools/datasheet: units, what it assumes, what it refuses, and that the library is what it writes.

usage: test_datasheet.py PROGRAM ROOT
"""
import pathlib
import subprocess
import sys
import tempfile
import tomllib
import unittest
from decimal import Decimal

PROGRAM, ROOT = pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from data_sheets import motor_file, readme, units  # noqa: E402

QSH4218 = {"id": "qsh4218", "description": "NEMA 17", "source": "its manual", "step_angle": "1.8°",
           "resistance": "5.3 Ω", "inductance": "6.6 mH", "rated_current": "1.0 A",
           "holding_torque": "27 N·cm", "rotor_inertia": "35 g·cm²"}


def datasheet(*arguments, cwd=None):
    return subprocess.run([sys.executable, ROOT / "tools/datasheet", "--program", PROGRAM,
                           *map(str, arguments)], capture_output=True, text=True, cwd=cwd,
                          check=False)


def as_options(row):
    return [word for key, text in row.items() for word in (f"--{key.replace('_', '-')}", text)]


def read(row):
    text, assumed = motor_file.motor_file(row)
    return tomllib.loads(text), assumed


class Units(unittest.TestCase):
    def test_every_unit_that_sheets_print(self):
        for text, quantity, expected in (
                ("27 N·cm", "torque", "0.27"), ("270 mN.m", "torque", "0.27"),
                ("0.27Nm", "torque", "0.27"), ("2.0 kg·cm", "torque", "0.196133"),
                ("2.0 kgf-cm", "torque", "0.196133"), ("400 g·cm", "torque", "0.0392266"),
                ("38.2 oz·in", "torque", "0.26975"), ("38.2 oz-in", "torque", "0.26975"),
                ("35 g·cm²", "inertia", "3.5e-6"), ("35 g-cm^2", "inertia", "3.5e-6"),
                ("0.035 kg cm2", "inertia", "3.5e-6"), ("0.19 oz-in²", "inertia", "3.4751e-6"),
                ("35e-7 kg·m²", "inertia", "3.5e-6"), ("6600 µH", "inductance", "6.6e-3"),
                ("670 mA", "current", "0.67"), ("350 mΩ", "resistance", "0.35")):
            with self.subTest(text):
                value = units.in_si(text, quantity)
                self.assertAlmostEqual(value / Decimal(expected), Decimal(1), delta=Decimal("1e-5"))

    def test_a_number_without_its_unit_or_with_anothers_is_refused(self):
        for text, quantity in (("6.6", "inductance"), ("6.6 mA", "inductance"), ("mH", "inductance"),
                               ("35 g·cm", "inertia"), ("35 g·cm²", "torque"), ("1,5 A", "current")):
            with self.subTest(text), self.assertRaisesRegex(units.BadValue, "expected a number and"):
                units.in_si(text, quantity)

    def test_digits_stay_those_of_the_sheet(self):
        self.assertEqual([units.toml_number(units.in_si(text, quantity)) for text, quantity in (
            ("6.6 mH", "inductance"), ("24 V", "voltage"), ("35 gcm2", "inertia"),
            ("38.2 ozin", "torque"))], ["0.0066", "24.0", "3.5e-06", "0.269751"])


class MotorFile(unittest.TestCase):
    def test_it_has_what_the_sheet_states_and_says_what_is_assumed(self):
        values, assumed = read(QSH4218)
        self.assertEqual({key: values[key] for key in (
            "resistance_ohm", "inductance_H", "rated_current_A", "holding_torque_Nm",
            "rotor_inertia_kgm2", "rotor_teeth", "supply_V")}, {
                "resistance_ohm": 5.3, "inductance_H": 0.0066, "rated_current_A": 1.0,
                "holding_torque_Nm": 0.27, "rotor_inertia_kgm2": 3.5e-6, "rotor_teeth": 50,
                "supply_V": 24.0})
        self.assertAlmostEqual(values["viscous_friction_Nms_rad"], 9e-5)
        self.assertEqual(len(assumed), 3)  # supply, friction, detent
        self.assertIn("27 N·cm", values["stated"])

    def test_what_is_stated_is_not_assumed(self):
        values, assumed = read({**QSH4218, "supply": "48 V", "viscous_friction": "1e-4 Nms/rad",
                                "detent_torque": "22 mN·m", "load_inertia": "1 kg·cm²"})
        self.assertEqual((values["supply_V"], values["viscous_friction_Nms_rad"],
                          values["detent_torque_Nm"], values["load_inertia_kgm2"], assumed),
                         (48.0, 1e-4, 0.022, 1e-4, []))

    def test_the_supply_leaves_four_times_the_rated_voltage(self):
        for resistance, supply in (("6 ohm", 24.0), ("6.1 ohm", 36.0), ("12 ohm", 48.0)):
            self.assertEqual(read({**QSH4218, "resistance": resistance})[0]["supply_V"], supply)
        with self.assertRaisesRegex(units.BadValue, "supply: expected to be given"):
            read({**QSH4218, "resistance": "12.1 ohm"})

    def test_a_torque_constant_will_do(self):
        row = {key: text for key, text in QSH4218.items() if key != "holding_torque"}
        values, _ = read({**row, "torque_constant": "19 N·cm/A"})
        self.assertEqual(values["torque_constant_Nm_A"], 0.19)
        with self.assertRaisesRegex(units.BadValue, "holding_torque: is missing"):
            read(row)

    def test_steps_are_teeth(self):
        self.assertEqual(read({**QSH4218, "step_angle": "0.9 deg"})[0]["rotor_teeth"], 100)
        with self.assertRaisesRegex(units.BadValue, "step_angle: expected 90 degrees"):
            read({**QSH4218, "step_angle": "1.7 deg"})


class Tool(unittest.TestCase):
    def setUp(self):
        scratch = tempfile.TemporaryDirectory()
        self.addCleanup(scratch.cleanup)
        self.folder = pathlib.Path(scratch.name)

    def refuses(self, done, *parts):
        self.assertEqual((done.returncode, done.stdout), (2, ""), done.stderr)
        for part in parts:
            self.assertIn(part, done.stderr)
        self.assertEqual(list(self.folder.glob("*.toml")), [])

    def test_a_row_becomes_a_file_that_the_simulator_takes(self):
        done = datasheet(*as_options(QSH4218), "--out", self.folder / "qsh4218.toml")
        self.assertEqual((done.returncode, done.stderr.count("assumed: ")), (0, 3), done.stderr)
        check = subprocess.run([PROGRAM, "check-motor", self.folder / "qsh4218.toml"], check=False,
                               stdout=subprocess.DEVNULL)
        self.assertEqual(check.returncode, 0)

    def test_an_implausible_row_is_refused_by_the_simulators_own_rule(self):
        self.refuses(datasheet(*as_options({**QSH4218, "inductance": "6.6 H"}), cwd=self.folder),
                     "qsh4218.toml:", "inductance_H", "slip of a unit")

    def test_a_doubtful_row_is_refused_unless_somebody_says_why(self):
        row = as_options({**QSH4218, "inductance": "35 mH"})
        self.refuses(datasheet(*row, cwd=self.folder), "inductance_H", "as other motors", "--unusual")
        done = datasheet(*row, "--unusual", 'its "sheet"\'s', cwd=self.folder)
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertEqual(tomllib.loads(done.stdout)["unusual"], 'its "sheet"\'s')

    def test_the_file_has_the_name_of_the_motor(self):
        self.refuses(datasheet(*as_options(QSH4218), "--out", self.folder / "other.toml"),
                     "expected qsh4218.toml")
        row = {key: text for key, text in QSH4218.items() if key != "id"}
        done = datasheet(*as_options(row), "--out", self.folder / "own.toml")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_bad_value_is_refused_with_its_option(self):
        self.refuses(datasheet(*as_options({**QSH4218, "rotor_inertia": "35"}), cwd=self.folder),
                     "--rotor-inertia: expected a number and one of kgm2")

    def test_a_table_is_refused_as_a_whole_with_its_line(self):
        table = self.folder / "rows.csv"
        head, good = ",".join(QSH4218), ",".join(QSH4218.values())
        table.write_text(f"{head}\n{good}\n{good.replace('6.6 mH', '6.6')}\n", encoding="utf-8")
        self.refuses(datasheet(table, "--out", self.folder), "rows.csv:3: inductance: expected")
        table.write_text(f"{head}\n{good}\n{good}\n", encoding="utf-8")
        self.refuses(datasheet(table, "--out", self.folder), "rows.csv:3: id:", "twice")
        table.write_text(f"{head},colour\n{good},red\n", encoding="utf-8")
        self.refuses(datasheet(table, "--out", self.folder), "rows.csv:2: colour: unknown column")
        table.write_text(f"{head}\n{good}\n", encoding="utf-8")
        done = datasheet(table, "--out", self.folder / "mine")
        self.assertEqual(done.returncode, 0, done.stderr)
        self.assertTrue((self.folder / "mine/qsh4218.toml").is_file())

    def test_the_library_is_what_it_writes(self):
        done = datasheet("--library", "--check")
        self.assertEqual(done.returncode, 0, done.stderr)

    def test_a_stale_table_is_seen(self):
        text = (ROOT / "sil/motors/README.md").read_text(encoding="utf-8")
        self.assertNotEqual(readme.with_table(text, []), text)


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
