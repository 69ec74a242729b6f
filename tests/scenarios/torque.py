"""Torque of a drive with an encoder, by its trace: acceleration, speed limit, standstill; set-points at 250 Hz; and
that a drive without an encoder refuses it. The loads' own scenario: sil/scenarios/torque.toml."""
import csv
import math

from program import Checks, run, scratch

CHECKS = Checks()
KM, INERTIA, FRICTION = 0.157, 15.62e-5, 0.000307  # bendjedia-2012

HEAD = """description = "torques"
motor = "bendjedia-2012"
duration_s = {duration_s}

[drive]
feedback = "{feedback}"
encoder_zero_known = true
{drive}
[plant]
model = "{plant}"
encoder_counts_per_turn = 16384

[[expect]]
metric = "fault"
equals = "none"
"""


def trace_of(folder, scenario, *arguments):
    done = run("run", scenario, "--out", folder, *arguments, cwd=folder)
    CHECKS.that(done.returncode == 0, f"{scenario}: it holds\n{done.stdout}{done.stderr}")
    with open(f"{folder}/{scenario.removesuffix('.toml')}/trace.csv", encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    kept = ("time_s", "omega_rad_s", "omega_ref_rad_s", "i_q_A", "i_q_ref_A", "theta_rad")
    return [{name: float(row[name]) for name in kept} for row in rows]


def within(trace, begin_s, end_s):
    return [row for row in trace if begin_s <= row["time_s"] < end_s]


def mean(rows, name):
    return sum(row[name] for row in rows) / len(rows)


def accelerates_as(trace, begin_s, end_s, torque_Nm):
    """J dw = integral of T - Kv w."""
    rows = within(trace, begin_s, end_s)
    gained = rows[-1]["omega_rad_s"] - rows[0]["omega_rad_s"]
    push = (torque_Nm - FRICTION * mean(rows, "omega_rad_s")) * (rows[-1]["time_s"] - rows[0]["time_s"])
    CHECKS.that(abs(gained * INERTIA / push - 1) < 0.02,
                f"{torque_Nm} N m from {begin_s} s on: {gained * INERTIA / push:.3f} of T/J")


def is_held_at(trace, begin_s, end_s, speed_rad_s):
    rows = within(trace, begin_s, end_s)
    off = [row["omega_rad_s"] - speed_rad_s for row in rows]
    CHECKS.that(max(map(abs, off)) < 0.02 * abs(speed_rad_s), f"{speed_rad_s} rad/s: off by {max(map(abs, off)):.2f}")
    CHECKS.that(abs(sum(off) / len(off)) < 0.005 * abs(speed_rad_s), f"{speed_rad_s} rad/s: mean off {sum(off) / len(off):.3f}")
    current = [row["i_q_A"] for row in rows]
    swing = math.sqrt(sum((i - mean(rows, "i_q_A"))**2 for i in current) / len(current))
    CHECKS.that(swing < 0.08, f"{speed_rad_s} rad/s: the torque does not swing, {swing:.3f} A rms")


def the_scenario(folder, numeric):
    trace = trace_of(folder, "torque", "--numeric", numeric)
    accelerates_as(trace, 0.055, 0.105, 0.1)
    is_held_at(trace, 0.13, 0.148, 40)
    is_held_at(trace, 0.17, 0.198, 40)  # under a load
    is_held_at(trace, 0.22, 0.248, 40)
    accelerates_as(trace, 0.255, 0.36, -0.1)
    is_held_at(trace, 0.39, 0.418, -40)
    rows = within(trace, 0.53, 0.598)
    CHECKS.that(abs(mean(rows, "i_q_A") * KM / 0.47 - 1) < 0.01, f"a held rotor: {mean(rows, 'i_q_A') * KM:.4f} N m")
    is_held_at(trace, 0.64, 0.649, 40)
    jump = max(abs(b["omega_ref_rad_s"] - a["omega_ref_rad_s"])
               for a, b in zip(trace, trace[1:]) if 0.42 < b["time_s"] < 0.48 or b["time_s"] > 0.65)
    CHECKS.that(jump < 0.35, f"a stop, a speed and a target begin at the rotor's speed: a jump of {jump:.3f} rad/s")


def set_points(folder, numeric):
    """A sine of torque in steps of 4 ms, 12.5 Hz: the current follows each within two periods and some."""
    text = HEAD.format(duration_s=0.5, feedback="encoder", drive="", plant="bench")
    target = [0.1 * math.cos(2 * math.pi * 12.5 * 0.004 * n) for n in range(100)]
    for n, torque in enumerate(target):
        text += f'\n[[event]]\ntime_s = {0.05 + 0.004 * n:.3f}\ncommand = "torque"\ntorque_Nm = {torque:.6f}\nspeed_rad_s = 50.0\n'
    (folder / "sine.toml").write_text(text + '\n[[event]]\ntime_s = 0.45\ncommand = "stop"\n')
    trace = trace_of(str(folder), "sine.toml", "--numeric", numeric)
    late = [row["time_s"] for n, torque in enumerate(target)
            for row in within(trace, 0.0512 + 0.004 * n, 0.0539 + 0.004 * n)
            if abs(row["i_q_A"] - torque / KM) > 0.12]
    CHECKS.that(len(late) < 0.02 * 100 * 27, f"{numeric}: the current is the set-point's: {len(late)} are off")
    for n in range(0, 100, 10):
        accelerates_as(trace, 0.0512 + 0.004 * n, 0.0538 + 0.004 * n, target[n]) if abs(target[n]) > 0.09 else None
    CHECKS.that(abs(trace[-1]["omega_rad_s"]) < 1, "and rests behind it")


def refused(folder):
    text = HEAD.format(duration_s=0.2, feedback="sensorless", drive="", plant="bench")
    text = text.replace("encoder_zero_known = true\n", "").replace("encoder_counts_per_turn = 16384\n", "")
    typed = text + '\n[[event]]\ntime_s = 0.05\ntype = "torque 0.1"\n'
    (folder / "typed.toml").write_text(
        typed + '\n[[event]]\ntime_s = 0.1\nexpect = "error: torque refused: without an encoder a slow rotor is lost"\n')
    done = run("run", "typed.toml", cwd=folder)
    CHECKS.that(done.returncode == 0, f"sensorless: the console says why\n{done.stdout}{done.stderr}")
    (folder / "posted.toml").write_text(text + '\n[[event]]\ntime_s = 0.05\ncommand = "torque"\ntorque_Nm = 0.1\nspeed_rad_s = 50.0\n')
    done = run("run", "posted.toml", cwd=folder)
    CHECKS.that(done.returncode != 0 and "without an encoder" in done.stderr, f"and a scenario: {done.stderr}")


with scratch() as place:
    from pathlib import Path
    for number in ("float", "fixed"):
        the_scenario(place, number)
        set_points(Path(place), number)
    refused(Path(place))
CHECKS.end()
