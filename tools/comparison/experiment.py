"""What the laws are compared on: moves, plants, and how the moves become those of another motor."""
import math
import pathlib
import tomllib
from typing import NamedTuple

from comparison.simulator import ROOT, SCENARIOS, Refused, toml_document
from motor_parameters import NotAMotor, parameters_of
from spread.call import write_files

PARAMETERS = ROOT / "sil/parameters"
HOME_MOTOR = "bendjedia-2012"


class Move(NamedTuple):
    """One of the moves, and how it is carried over to another motor."""
    name: str
    title: str
    scales: str          # "speed": with what the motor can do; "pitch": with its full step
    reference_rad: float  # an rms error that counts 1 in the tuning's cost, on the home motor

    @property
    def scenario(self):
        return f"compare-{self.name}"


# The references are what a good law reaches, so that no move outweighs the others.
MOVES = [
    Move("step", "step of one full step, then a load step", "pitch", 0.5e-3),
    Move("move", "move at medium speed", "speed", 0.2e-3),
    Move("fast", "fast move", "speed", 0.2e-3),
    Move("sine", "sine", "speed", 0.3e-3),
    Move("creep", "creep", "pitch", 0.2e-3),
]
# Once the drive has learned the motor's detent torque: the last second of a longer run.
LEARNED_MOVES = [
    Move("learned-creep", "creep, the detent learned", "pitch", 0.2e-3),
    Move("learned-slow", "slow moves, the detent learned", "pitch", 0.2e-3),
]


class Plant(NamedTuple):
    name: str
    title: str
    settings: dict


PLANTS = [
    Plant("nominal", "the motor as the drive knows it", {}),
    Plant("ideal", "no detent, no friction but viscous, exact bridge and sensing",
          {"plant.model": "ideal"}),
    Plant("warm", "R +20 %, L −15 %, Km −7 %, J +30 %",
          {"plant.resistance_scale": 1.2, "plant.inductance_scale": 0.85, "plant.km_scale": 0.93,
           "plant.inertia_scale": 1.3}),
    Plant("stiff", "R −10 %, L +10 %, Km +5 %, J −20 %",
          {"plant.resistance_scale": 0.9, "plant.inductance_scale": 1.1, "plant.km_scale": 1.05,
           "plant.inertia_scale": 0.8}),
]


def existing(moves):
    """Those whose scenario is there."""
    return [move for move in moves if (SCENARIOS / f"{move.scenario}.toml").is_file()]


def chosen(items, names, what):
    """The items of these names, in the given order; all of them for None."""
    if names is None:
        return list(items)
    by_name = {item.name: item for item in items}
    for name in names:
        if name not in by_name:
            raise Refused(f"unknown {what} \"{name}\", expected one of {', '.join(by_name)}")
    return [by_name[name] for name in names]


class Motor(NamedTuple):
    """What the moves depend on."""
    id: str
    file: pathlib.Path
    rotor_teeth: int
    rated_torque_Nm: float
    rated_speed_rad_s: float         # at which the supply still drives the rated current
    rated_acceleration_rad_s2: float  # of the unloaded rotor by the rated torque
    rated_current_A: float
    electrical_corner_rad_s: float   # R / (N L): speed at which the inductance takes as much voltage
    limit_speed_rad_s: float         # at which the back-EMF alone takes the supply

    @property
    def full_step_rad(self):
        return math.pi / 2 / self.rotor_teeth


def read_motor(name_or_path):
    """A name of sil/motors or a path, which has a / or ends in .toml."""
    path = pathlib.Path(name_or_path)
    if path.suffix != ".toml" and "/" not in str(name_or_path):
        path = ROOT / "sil/motors" / f"{name_or_path}.toml"
    try:
        values = parameters_of(path)
    except NotAMotor as error:
        raise Refused(str(error)) from error
    constant, teeth = values["torque_constant_Nm_A"], values["rotor_teeth"]
    resistance, inductance = values["resistance_ohm"], values["inductance_H"]
    current, supply = values["rated_current_A"], values["supply_V"]
    torque = constant * current
    # (R I + Km w)^2 + (N w L I)^2 = U^2, solved for w.
    a = constant**2 + (teeth * inductance * current) ** 2
    b = resistance * current * constant
    c = (resistance * current) ** 2 - supply**2
    if c >= 0:
        raise Refused(f"{path}: the supply of {supply:g} V does not drive the rated current")
    speed = (-b + math.sqrt(b * b - a * c)) / a
    return Motor(path.stem, path.resolve(), teeth, torque, speed, torque / values["inertia_kgm2"],
                 current, resistance / (teeth * inductance), supply / constant)


def read_scenario(name):
    """The scenario with its bases under it."""
    document = tomllib.loads((SCENARIOS / f"{name}.toml").read_text(encoding="utf-8"))
    if "base" not in document:
        return document
    merged = read_scenario(document.pop("base"))
    for key, value in document.items():
        if isinstance(value, dict) and isinstance(merged.get(key), dict):
            merged[key] = {**merged[key], **value}
        else:
            merged[key] = value
    return merged


class Scales(NamedTuple):
    """Of one move from the home motor to another."""
    angle: float
    time: float
    torque: float


def scales_of(move, motor, home):
    """Speeds are the same part of the rated speed, accelerations at most the same part of the rated
    acceleration; no time gets shorter, because what a drive can do in a millisecond depends on its
    control period more than on its motor. Loads are the same part of the rated torque."""
    torque = motor.rated_torque_Nm / home.rated_torque_Nm
    if move.scales == "pitch":
        return Scales(motor.full_step_rad / home.full_step_rad, 1.0, torque)
    speed = motor.rated_speed_rad_s / home.rated_speed_rad_s
    acceleration = motor.rated_acceleration_rad_s2 / home.rated_acceleration_rad_s2
    time = max(1.0, speed / acceleration)
    return Scales(speed * time, time, torque)


UNIT_SCALES = {"_rad": ("angle", 1), "_s": ("time", 1), "_Nm": ("torque", 1), "_Hz": ("time", -1)}


def scaled_value(key, value, scales):
    for unit, (scale, power) in UNIT_SCALES.items():
        if key.endswith(unit):
            return float(f"{value * getattr(scales, scale) ** power:.9g}")
    return value


def scaled_table(table, scales):
    scaled = {}
    for key, value in table.items():
        if key == "window" and isinstance(value, list):
            scaled[key] = [scaled_value("_s", time, scales) for time in value]
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            scaled[key] = scaled_value(key, value, scales)
        else:
            scaled[key] = value
    return scaled


def scaled_scenario(move, motor, home):
    """The scenario of `move` for another motor, as text of a file beside the motor's. Its
    expectations would be the home motor's."""
    scales = scales_of(move, motor, home)
    document = read_scenario(move.scenario)
    document.pop("expect", None)
    document["motor"] = f"./{motor.file.name}"
    document["description"] = f"Comparison, {move.title}, carried over to {motor.id}"
    document["duration_s"] = scaled_value("_s", document["duration_s"], scales)
    document["settling_band_rad"] = scaled_value(
        "_rad", document.get("settling_band_rad", 2e-3),
        Scales(motor.full_step_rad / home.full_step_rad, 1, 1))
    for key in ("event", "report"):
        document[key] = [scaled_table(table, scales) for table in document.get(key, [])]
    return (f"# Written by tools/compare: angles x {scales.angle:.4g}, times x {scales.time:.4g}, "
            f"loads x {scales.torque:.4g}\n" + toml_document(document))


def files_for(moves, motor):
    """(name or path of each move's scenario, {name: text} of the files that this takes): none for
    the home motor."""
    home = read_motor(HOME_MOTOR)
    if motor.id == home.id and motor.file == home.file:
        return {move.name: move.scenario for move in moves}, {}
    files = {f"{move.scenario}.toml": scaled_scenario(move, motor, home) for move in moves}
    files[motor.file.name] = motor.file.read_text(encoding="utf-8")
    return {move.name: f"./{move.scenario}.toml" for move in moves}, files


def scenarios_for(moves, motor, folder):
    """Name or path of each move's scenario for this motor; another motor's are written to
    `folder`, beside a copy of it."""
    places, files = files_for(moves, motor)
    write_files(folder, files)
    return {name: str((folder / place).resolve()) if files else place
            for name, place in places.items()}


def parameters_for(law, motor, folder=None):
    """(file of the parameter set or None, what there is to say about it)."""
    for place, note in ((folder, ""), (PARAMETERS / motor.id, ""),
                        (PARAMETERS / HOME_MOTOR, f"bandwidths tuned for {HOME_MOTOR}")):
        file = place / f"{law}.toml" if place else None
        if file and file.is_file():
            return file, note
    return None, "the drive's default bandwidths"
