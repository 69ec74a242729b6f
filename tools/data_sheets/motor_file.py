"""A row of a data sheet as a motor file: what is stated is taken, what is missing is assumed
and said."""
from decimal import Decimal

from comparison.simulator import toml_value
from data_sheets.units import BadValue, in_si, toml_number

# Column, key of the motor file, quantity; the order is the file's.
STATED = (
    ("resistance", "resistance_ohm", "resistance"),
    ("inductance", "inductance_H", "inductance"),
    ("rated_current", "rated_current_A", "current"),
    ("holding_torque", "holding_torque_Nm", "torque"),
    ("torque_constant", "torque_constant_Nm_A", "torque"),
    ("detent_torque", "detent_torque_Nm", "torque"),
    ("rotor_inertia", "rotor_inertia_kgm2", "inertia"),
    ("load_inertia", "load_inertia_kgm2", "inertia"),
)
TEXTS = ("id", "description", "source")
COLUMNS = (*TEXTS, "step_angle", *(column for column, _, _ in STATED), "supply",
           "viscous_friction", "remark")
NEEDED = (*TEXTS, "step_angle", "resistance", "inductance", "rated_current", "rotor_inertia")

SUPPLIES_V = (24, 36, 48)
HEADROOM = 4  # supply / (R x rated current) at least
# Bearings and iron: what the motors of the library were given, for a holding torque of 0.3 N m.
FRICTION_Nms_rad, OF_TORQUE_Nm = Decimal("1e-4"), Decimal("0.3")


def value_of(row, column, quantity):
    try:
        return in_si(row[column].replace("/A", "") if column == "torque_constant" else row[column],
                     quantity)
    except BadValue as error:
        raise BadValue(f"{column}: {error}") from error


def rotor_teeth(row):
    """90 degrees are as many full steps as the rotor has teeth."""
    angle = value_of(row, "step_angle", "angle")
    teeth = 90 / angle if angle > 0 else Decimal(0)
    if teeth < 1 or teeth != teeth.to_integral_value():
        raise BadValue(f"step_angle: expected 90 degrees / a whole number of rotor teeth, got "
                       f"\"{row['step_angle']}\"")
    return int(teeth)


def supply_of(row, values, assumed):
    if row.get("supply"):
        return value_of(row, "supply", "voltage")
    rated_V = values["resistance_ohm"] * values["rated_current_A"]
    chosen = next((Decimal(volts) for volts in SUPPLIES_V if volts >= HEADROOM * rated_V), None)
    if chosen is None:
        raise BadValue(f"supply: expected to be given, {SUPPLIES_V[-1]} V are less than {HEADROOM} "
                       f"x R x rated current = {HEADROOM * rated_V:.4g} V")
    assumed.append(f"supply, of 24, 36 and 48 V the first with {HEADROOM} x R x rated current")
    return chosen


def friction_of(row, values, assumed):
    if row.get("viscous_friction"):
        return value_of(row, "viscous_friction", "friction")
    holding = values.get("holding_torque_Nm")
    if holding is None:
        holding = values["torque_constant_Nm_A"] * values["rated_current_A"] * Decimal("1.41421")
    assumed.append("viscous friction, 1e-4 N m s/rad per 0.3 N m of holding torque")
    return FRICTION_Nms_rad * holding / OF_TORQUE_Nm


def motor_file(row):
    """(text of the TOML file, what it assumes) of a row {column: text}; BadValue names the column."""
    unknown = sorted(set(row) - set(COLUMNS))
    if unknown:
        raise BadValue(f"{unknown[0]}: unknown column, expected one of {', '.join(COLUMNS)}")
    for column in NEEDED:
        if not row.get(column):
            raise BadValue(f"{column}: is missing")
    if not row.get("holding_torque") and not row.get("torque_constant"):
        raise BadValue("holding_torque: is missing; torque_constant will do as well")
    values = {key: value_of(row, column, quantity)
              for column, key, quantity in STATED if row.get(column)}
    teeth = rotor_teeth(row)
    assumed = []
    supply, friction = supply_of(row, values, assumed), friction_of(row, values, assumed)
    if "detent_torque_Nm" not in values:
        assumed.append("detent torque on the plant real, the shares that it has by default")
    stated = "; ".join(f"{column.replace('_', ' ')} {row[column]}" for column in COLUMNS
                       if column not in TEXTS and column != "remark" and row.get(column))
    if row.get("remark"):
        assumed.append(row["remark"])
    lines = [f"{key} = {toml_value(row[key])}" for key in TEXTS]
    lines.append(f"stated = {toml_value(stated)}")
    if assumed:
        lines.append(f"assumed = {toml_value('; '.join(assumed))}")
    lines += [f"{key} = {toml_number(value)}" for key, value in values.items()]
    lines += [f"viscous_friction_Nms_rad = {toml_number(friction)}",
              f"supply_V = {toml_number(supply)}", f"rotor_teeth = {teeth}"]
    return "\n".join(lines) + "\n", assumed
