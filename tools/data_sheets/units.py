"""Values with the units that data sheets print, as SI numbers with the digits that were printed."""
import decimal
import re
from decimal import Decimal

OZ_in_Nm = Decimal("7.0615518e-3")  # 0.028349523 kg x 9.80665 m/s2 x 0.0254 m
OZ_in2_kgm2 = Decimal("1.8289979e-5")  # 0.028349523 kg x (0.0254 m)^2
KGF_cm_Nm = Decimal("0.0980665")

UNITS = {
    "resistance": {"ohm": Decimal(1), "mohm": Decimal("1e-3")},
    "inductance": {"H": Decimal(1), "mH": Decimal("1e-3"), "uH": Decimal("1e-6")},
    "current": {"A": Decimal(1), "mA": Decimal("1e-3")},
    "torque": {"Nm": Decimal(1), "Ncm": Decimal("1e-2"), "mNm": Decimal("1e-3"),
               "Nmm": Decimal("1e-3"), "ozin": OZ_in_Nm, "kgcm": KGF_cm_Nm,
               "gcm": KGF_cm_Nm / 1000},
    "inertia": {"kgm2": Decimal(1), "kgcm2": Decimal("1e-4"), "gcm2": Decimal("1e-7"),
                "ozin2": OZ_in2_kgm2},
    "voltage": {"V": Decimal(1)},
    "angle": {"deg": Decimal(1)},
    "friction": {"Nms/rad": Decimal(1)},
}
# What one unit is written as; dots, blanks and carets between its parts do not matter.
SPELLINGS = {"Ω": "ohm", "Ω": "ohm", "ohms": "ohm", "mΩ": "mohm", "mΩ": "mohm", "µH": "uH",
             "μH": "uH", "°": "deg", "degrees": "deg", "kgfcm": "kgcm", "gfcm": "gcm",
             "gcmcm": "gcm2"}


class BadValue(ValueError):
    """What was expected, what was found."""


def in_si(text, quantity):
    """"6.6 mH" as Decimal("0.0066")."""
    units = UNITS[quantity]
    found = re.fullmatch(r"\s*([-+]?[0-9]*\.?[0-9]+(?:[eE][-+]?[0-9]+)?)\s*(.*?)\s*", text)
    expected = f"expected a number and one of {', '.join(units)}, as in \"1 {next(iter(units))}\""
    if not found:
        raise BadValue(f"{expected}, got \"{text}\"")
    unit = re.sub(r"[\s.·⋅*^-]", "", found[2]).replace("²", "2")
    unit = SPELLINGS.get(unit, unit)
    if unit not in units:
        raise BadValue(f"{expected}, got " + (f"the unit \"{found[2]}\"" if unit else "no unit"))
    return Decimal(found[1]) * units[unit]


def toml_number(value):
    """Six digits of it at most, and none that were not there."""
    rounded = decimal.Context(prec=6).plus(value)
    return f"{float(rounded):.6g}" if "e" in f"{float(rounded):.6g}" or rounded % 1 else (
        f"{float(rounded):.1f}")
