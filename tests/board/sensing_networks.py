#!/usr/bin/env python3
"""What the resistors around the STM32G474 make of currents and voltages, and what their tolerance and
their drift cost (hal/stm32g474/README.md, "Around the chip").

usage: sensing_networks.py PIN_MAP   prints it; exit 1 if a network is not what the pin map says
"""

import math
import re
import sys
from pathlib import Path

REFERENCE_V, CODES = 3.3, 4096
SUPPLY_V, WARM_K = 24.0, 20.0
SHUNT_OHM = 40e-3
# Resistors from one node to what it measures, to the reference, to ground.
SHUNT = {"input": 1.0e3, "reference": 13.7e3, "ground": 11.0e3}
LEG = {"input": 9.53e3, "reference": 16.0e3, "ground": 1.21e3}
BUS = {"input": 84.5e3, "reference": math.inf, "ground": 10.0e3}
AMPLIFIER_GAIN, AMPLIFIER_OFFSET_V = 8, 3e-3  # of OPAMP1, 2; DS12288, over temperature
OFFSET_CODES_MAX = 64  # beyond it the drive faults: firmware/drive/offset_calibration.h


def node(network):
    """Share of the input and voltage of the node without it."""
    total = sum(1 / ohm for ohm in network.values())
    return 1 / network["input"] / total, REFERENCE_V / network["reference"] / total


def errors(network, figure):
    """Relative change of `figure` per relative change of one resistor: worst sum, and root of the
    squares for resistors that are spread evenly over their tolerance."""
    slopes = []
    for name, ohm in network.items():
        if math.isfinite(ohm):
            moved = figure(node({**network, name: ohm * 1.0001}))
            slopes.append((moved / figure(node(network)) - 1) / 1e-4)
    return sum(map(abs, slopes)), math.sqrt(sum(s * s for s in slopes) / 3)


def gain(at_node):
    return at_node[0]


def zero(at_node):
    return at_node[1]


def defined(text, name):
    value = re.search(rf"(?m)^#define {name} +\(?([\d./ ]+)\)?", text)[1].split("/")
    return float(value[0]) / (float(value[1]) if len(value) > 1 else 1.0)


def networks(text):
    """(what, by the resistors, by the pin map)"""
    share, bias_V = node(SHUNT)
    code_V = REFERENCE_V / CODES
    yield "uV per A at the comparators", share * SHUNT_OHM * 1e6, defined(text, "COMPARATOR_uV_PER_A")
    yield "uV at the comparators without current", bias_V * 1e6, defined(text, "COMPARATOR_uV")
    yield (
        "A per code",
        code_V / (share * SHUNT_OHM * AMPLIFIER_GAIN),
        defined(text, "CURRENT_A_PER_CODE"),
    )
    yield "V per code of the bus", code_V / node(BUS)[0], defined(text, "BUS_V_PER_CODE")
    yield (
        "V per code of a phase",
        2 * code_V / node(LEG)[0],
        defined(text, "PHASE_VOLTAGE_V_PER_CODE"),
    )


def print_tolerance(tolerance, drift_ppm):
    zero_codes = node(SHUNT)[1] * AMPLIFIER_GAIN / REFERENCE_V * CODES
    amplifier_codes = AMPLIFIER_OFFSET_V * AMPLIFIER_GAIN / REFERENCE_V * CODES
    worst_zero, root_zero = errors(SHUNT, zero)
    worst_leg, root_leg = errors(LEG, gain)
    half_V = SUPPLY_V / 2
    warm = drift_ppm * 1e-6 * WARM_K
    print(f"resistors of {100 * tolerance:g} %, {drift_ppm} ppm/K")
    print(f"  gain of the currents, without shunt {100 * errors(SHUNT, gain)[0] * tolerance:6.2f} %")
    print(f"  zero of the currents, worst         {worst_zero * tolerance * zero_codes:6.1f} codes")
    print(f"    with the amplifier's {amplifier_codes:.0f} codes, of {OFFSET_CODES_MAX}"
          f"       {worst_zero * tolerance * zero_codes + amplifier_codes:6.1f} codes")
    print(f"    drift of {WARM_K:g} K, one sigma          {root_zero * warm * zero_codes:6.2f} codes")
    print(f"  trip, worst                         "
          f"{worst_zero * tolerance * node(SHUNT)[1] / (node(SHUNT)[0] * SHUNT_OHM):6.3f} A")
    print(f"  bus, worst                          {100 * errors(BUS, gain)[0] * tolerance:6.2f} %")
    print(f"  legs of a phase at half the bus     "
          f"{2e3 * worst_leg * tolerance * half_V:6.0f} mV worst, "
          f"{1e3 * math.sqrt(2) * root_leg * tolerance * half_V:.0f} mV one sigma")
    print(f"    per volt of the bus               {1e3 * worst_leg * tolerance:6.1f} mV worst")
    print(f"    drift of {WARM_K:g} K                     "
          f"{2e3 * worst_leg * warm * half_V:6.1f} mV worst, "
          f"{1e3 * math.sqrt(2) * root_leg * warm * half_V:.1f} mV one sigma")


def main(arguments):
    if len(arguments) != 1:
        sys.exit(__doc__)
    text = Path(arguments[0]).read_text(encoding="utf-8")
    off = 0
    for what, made, stated in networks(text):
        print(f"{what:38} {made:12.6g}   pin map {stated:12.6g}")
        off += abs(made / stated - 1) > 0.005
    ohm = 1 / sum(1 / ohm for ohm in LEG.values())
    print(f"{'ohm behind 10 nF of a leg':38} {ohm:12.6g}")
    for tolerance, drift_ppm in ((1e-2, 100), (1e-3, 25)):
        print_tolerance(tolerance, drift_ppm)
    return 1 if off else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
