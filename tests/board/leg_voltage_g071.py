#!/usr/bin/env python3
"""Compares hal/stm32g071/leg_voltage.h with the mean voltage of switched legs behind their filters.

usage: leg_voltage_g071.py CC ROOT     exit 1 if a mean is off by more than promised

Legs switch centre-aligned with duties that change from period to period; the filters' voltages are
computed exactly, edge by edge, and sampled as the board does, about the peak.
"""

import math
import subprocess
import sys
import tempfile
from pathlib import Path

T, TAU, BUS, SAMPLES = 100e-6, 18.75e-6, 24.0, 8
LEG_CODES_PER_V = 4096 / 31.2
PROMISED_V = 0.045 + 62.4 / 4096  # the 8th harmonic of a phase's legs, and a code
PERIODS = 400


def duty(k, leg):
    """A sine of 360 Hz electrical, 7 V of 24 V, phase b a quarter of it later."""
    angle = 2 * math.pi * 360 * k * T - (leg // 2) * math.pi / 2
    return 0.5 + (1 if leg % 2 == 0 else -1) * 0.5 * 7 / BUS * math.sin(angle)


class Leg:
    """Voltage behind the filter; the period begins at the peak, where the leg is low."""

    def __init__(self):
        self.v = 0.0

    def until(self, now, end, level):
        self.v = level + (self.v - level) * math.exp(-(end - now) / TAU)

    def period(self, high, skew):
        """Samples at T/8 ... T, each `skew` later; returns them as codes."""
        first, last = (1 - high) * T / 2, (1 + high) * T / 2
        events = [(first, None), (last, None)]
        events += [(n * T / SAMPLES + skew, n) for n in range(1, SAMPLES)]
        now, codes = skew, []  # the window begins where the last one ended
        for at, sample in sorted(events, key=lambda e: e[0]) + [(T + skew, SAMPLES)]:
            level = BUS if first <= (now + at) / 2 < last else 0.0
            self.until(now, at, level)
            now = at
            if sample is not None:
                codes.append(round(self.v * LEG_CODES_PER_V))
        return codes


def codes():
    legs = [Leg() for _ in range(4)]
    skews = [-1.25e-6, 1.25e-6, -0.75e-6, 0.75e-6]  # a+, a-, b+, b-
    rows = []
    for k in range(PERIODS):
        rows.append([legs[n].period(duty(k, n), skews[n]) for n in range(4)])
    return rows


PROGRAM = """
#include <stdio.h>
#include "hal/stm32g071/leg_voltage.h"
int main(void)
{
    struct leg_voltage_mean mean = {0, 0};
    unsigned c[4];
    for (;;) {
        struct leg_voltages legs = {0, 0, 0, 0};
        for (int n = 0; n < LEG_VOLTAGE_SAMPLES; n++) {
            if (scanf("%u %u %u %u", &c[0], &c[1], &c[2], &c[3]) != 4)
                return 0;
            legs.plus_last = c[0] | (uint32_t)c[2] << 16; /* A+, B+ */
            legs.minus_last = c[3] | (uint32_t)c[1] << 16; /* B-, A- */
            legs.plus_sum += legs.plus_last;
            legs.minus_sum += legs.minus_last;
        }
        struct phase_voltage_codes v = leg_voltage_mean_step(&mean, &legs);
        printf("%d %d\\n", v.a, v.b);
    }
}
"""


def computed(cc, root, rows):
    with tempfile.TemporaryDirectory() as scratch:
        source, program = Path(scratch) / "mean.c", Path(scratch) / "mean"
        source.write_text(PROGRAM, encoding="utf-8")
        subprocess.run([cc, "-std=c11", "-I", root, source, "-o", program], check=True)
        text = "\n".join(
            " ".join(str(row[leg][n]) for leg in range(4)) for row in rows for n in range(SAMPLES)
        )
        done = subprocess.run([program], input=text, capture_output=True, text=True, check=True)
    return [tuple(map(int, line.split())) for line in done.stdout.splitlines()]


def main(arguments):
    if len(arguments) != 2:
        sys.exit(__doc__)
    rows = codes()
    worst = 0.0
    for k, phases in enumerate(computed(*arguments, rows)):
        for phase in range(2):
            true_V = BUS * (duty(k, 2 * phase) - duty(k, 2 * phase + 1))
            if k > 0:
                worst = max(worst, abs(phases[phase] * 62.4 / 4096 - true_V))
    worst_mV, promised_mV = worst * 1e3, PROMISED_V * 1e3
    print(f"{PERIODS} periods, worst error {worst_mV:.1f} mV, promised {promised_mV:.1f} mV")
    return 0 if worst <= PROMISED_V else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
