"""The table of sil/motors/README.md, from what `steadystep-sil check-motor` says of the files."""
import re

BEGIN, END = "<!-- tools/datasheet --library writes from here -->", "<!-- to here -->"
HEADINGS = ("motor", "class", "R, Ω", "L, mH", "I, A", "Km, N·m/A", "T, N·m", "J, g·cm²",
            "detent, mN·m", "N", "supply, V", "√(N Km I / J), rad/s")


def row_of(motor):
    detent = motor.get("detent_torque_Nm")
    return (motor["id"], motor["description"], f"{motor['resistance_ohm']:.4g}",
            f"{motor['inductance_H'] * 1e3:.4g}", f"{motor['rated_current_A']:.4g}",
            f"{motor['torque_constant_Nm_A']:.3g}", f"{motor['holding_torque_Nm']:.3g}",
            f"{motor['inertia_kgm2'] * 1e7:.4g}", f"{detent * 1e3:.3g}" if detent else "–",
            f"{motor['rotor_teeth']:g}", f"{motor['supply_V']:g}",
            f"{motor['hold_frequency_rad_s']:.0f}")


def frame(motor):
    """NEMA size first, motors of papers behind."""
    found = re.search(r"NEMA (\d+)", motor["description"])
    return (int(found[1]) if found else 1000, motor["id"])


def table_of(motors):
    rows = [HEADINGS, ("---",) * len(HEADINGS), *(row_of(one) for one in sorted(motors, key=frame))]
    return "\n".join("| " + " | ".join(row) + " |" for row in rows)


def replaced(text, first, last, table):
    """The README with what stands between two lines replaced."""
    before, begin, rest = text.partition(first)
    _, end, after = rest.partition(last)
    if not begin or not end:
        raise ValueError(f"sil/motors/README.md: expected the lines {first} and {last}")
    return f"{before}{first}\n{table}\n{last}{after}"


def with_table(text, motors):
    """The README with its table replaced."""
    return replaced(text, BEGIN, END, table_of(motors))
