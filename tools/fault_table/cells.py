"""The rows and columns of the table: faults, operating points, drives, and the scenario of a cell.

A fault is a row here and nothing else: the events that make it, the drives that can have it. What it
must come to stands in tests/comparison/faults.toml.
"""
import dataclasses
import math
from typing import NamedTuple

from comparison.simulator import toml_document
from motor_matrix.cells import CURRENT_RANGE, ENCODER_COUNTS, SHORTEST_RAMP_s
from operating_envelope.points import rounded

ZERO_CODE, RAIL_CODE = 2048, 4095  # of the current converters
CREEP_rad_s = 0.5
SETTLED_s = 0.15      # behind a ramp, before the fault
OBSERVED_s = 0.4      # behind the fault; longer where a motion takes longer to show it
NEXT_s = 0.3          # a next motion, behind what was observed without one
LOAD_SHARE = 0.25     # of the rated torque
ACCELERATION = 0.3    # of what the rated torque gives the rotor
STEP_s = 1e-4


class Fault(NamedTuple):
    """`events(motor, at_s)`: what happens; `feedbacks`: that can have it; `drive`: settings that it
    takes; `said`: what the drive writes where it does not open the bridge, and how soon, s."""
    name: str
    title: str
    events: object
    feedbacks: tuple = ("sensorless", "encoder")
    drive: dict = {}
    said: tuple = ()


def plain(**keys):
    return lambda motor, at_s: [{"time_s": at_s, **keys}]


def torque(share, **more):
    """A load of this share of the rated torque, against the motion."""
    return lambda motor, at_s: [{"time_s": at_s, **more,
                                 "load_torque_Nm": rounded(share * motor.rated_torque_Nm)}]


def vibration(share, frequency_Hz):
    return lambda motor, at_s: [{"time_s": at_s, "load_vibration_Hz": frequency_Hz,
                                 "load_vibration_Nm": rounded(share * motor.rated_torque_Nm)}]


def supply_V(motor):
    return motor.limit_speed_rad_s * motor.rated_torque_Nm / motor.rated_current_A


def supply(share):
    return lambda motor, at_s: [{"time_s": at_s, "ramp_s": 1e-3,
                                 "plant.bus_V": rounded(share * supply_V(motor))}]


def both(*parts):
    return lambda motor, at_s: [event for events in parts for event in events(motor, at_s)]


TIMEOUT_s = 0.1

FAULTS = (
    *(Fault(f"open-phase-{phase}", f"a lead of phase {phase} breaks", plain(open_phase=phase))
      for phase in "ab"),
    *(Fault(f"sensor-{phase}-last", f"current sensor {phase} stuck at its last value",
            plain(stuck_adc=f"current_{phase}")) for phase in "ab"),
    *(Fault(f"sensor-{phase}-zero", f"current sensor {phase} stuck at zero",
            plain(stuck_adc=f"current_{phase}", code=ZERO_CODE)) for phase in "ab"),
    *(Fault(f"sensor-{phase}-rail", f"current sensor {phase} stuck at its rail",
            plain(stuck_adc=f"current_{phase}", code=RAIL_CODE)) for phase in "ab"),
    Fault("leg-voltage-last", "leg voltage a stuck at its last value",
          plain(stuck_adc="phase_voltage_a")),
    Fault("bus-sensor-last", "bus voltage reading stuck", plain(stuck_adc="bus")),
    *(Fault(f"bus-sensor-{name}", f"the same, and the supply at {share:g} of its voltage",
            both(plain(stuck_adc="bus"), supply(share)))
      for name, share in (("high", 1.4), ("low", 0.4))),
    Fault("encoder-frozen", "the encoder's count stands still", plain(encoder="frozen"),
          ("encoder",)),
    Fault("encoder-half", "half of the encoder's counts", plain(encoder="half"), ("encoder",)),
    Fault("encoder-reversed", "the encoder's channels exchanged", plain(encoder="reversed"),
          ("encoder",)),
    Fault("encoder-noisy", "1,000 miscounts in a second",
          plain(encoder="noisy", miscounts_per_s=1000.0), ("encoder",)),
    Fault("encoder-lossy", "one edge in twenty lost", plain(encoder="lossy", lost_share=0.05),
          ("encoder",)),
    Fault("jam", "the rotor is held", plain(jam=True)),
    Fault("overload", "load of 1.6 times the rated torque", torque(1.6)),
    Fault("overload-slow", "the same, grown in 0.3 s", torque(1.6, ramp_s=0.3)),
    *(Fault(f"vibration-{frequency}Hz", f"load that swings by 1.2 times rated at {frequency} Hz",
            vibration(1.2, float(frequency))) for frequency in (17, 40, 87)),
    Fault("over-voltage", "the supply at 1.4 of its voltage", supply(1.4)),
    Fault("under-voltage", "the supply at 0.4 of its voltage", supply(0.4)),
    Fault("short-circuit", "leg A+ shorted to ground",
          lambda motor, at_s: [{"time_s": at_s, "short_circuit": "A+",
                                "short_circuit_A": rounded(10 * motor.rated_current_A)}]),
    Fault("late-interrupt", "a control interrupt held up for 100 µs", plain(stall_us=100.0)),
    Fault("silence", f"the console is unheard for {1e3 * TIMEOUT_s:g} ms", lambda motor, at_s: [],
          drive={"command_timeout_s": TIMEOUT_s},
          said=("warning: stop: no line for command_timeout_s", TIMEOUT_s + 2e-3)),
)


class Drive(NamedTuple):
    name: str
    title: str
    feedback: str
    settings: dict
    leaves_out: tuple = ()  # operating points that it does not reach


DRIVES = (
    Drive("sensorless", "sensorless, its default law", "sensorless", {}),
    Drive("encoder", "encoder, its default law", "encoder", {"feedback": "encoder"}),
    Drive("encoder-foc", "encoder, field-oriented control", "encoder",
          {"feedback": "encoder", "law": "foc"}),
    Drive("encoder-csmc", "encoder, sliding mode (csmc)", "encoder",
          {"feedback": "encoder", "law": "csmc"}, ("fast",)),
)


class Point(NamedTuple):
    """What the drive does as the fault comes: speed in shares of the rated speed, or rad/s."""
    name: str
    title: str
    share: float = 0.0
    speed_rad_s: float = 0.0
    load: float = 0.0
    observed_s: float = OBSERVED_s

    @property
    def rests(self):
        return self.share == 0.0 and self.speed_rad_s == 0.0


POINTS = (
    Point("rest", "at rest"),
    Point("held", "at rest under a quarter of the rated torque", load=LOAD_SHARE),
    Point("creep", f"{CREEP_rad_s:g} rad/s", speed_rad_s=CREEP_rad_s, observed_s=2 * OBSERVED_s),
    Point("move", "30 % of the rated speed", share=0.3),
    Point("loaded", "the same under a quarter", share=0.3, load=LOAD_SHARE),
    Point("fast", "60 % of the rated speed", share=0.6),
)
NEXT = Point("next", "the next motion", share=0.3)


def speed_of(point, motor):
    return point.speed_rad_s or point.share * motor.rated_speed_rad_s


def velocity(point, motor, at_s):
    """(event, when it is at speed)."""
    speed = speed_of(point, motor)
    ramp_s = max(SHORTEST_RAMP_s, speed / (ACCELERATION * motor.rated_acceleration_rad_s2))
    return ({"time_s": at_s, "command": "velocity", "speed_rad_s": rounded(speed),
             "acceleration_rad_s2": rounded(speed / ramp_s),
             "jerk_rad_s3": rounded(10 * speed / ramp_s**2)}, at_s + 1.1 * ramp_s)


def tick(time_s):
    return round(math.ceil(time_s / STEP_s) * STEP_s, 4)


@dataclasses.dataclass(frozen=True, eq=False)
class Cell:
    """One scenario: a fault in an operating point of a drive with a motor."""
    motor: object
    drive: Drive
    fault: Fault
    point: Point

    @property
    def name(self):
        return f"{self.drive.name}-{self.fault.name}-{self.point.name}"

    def timeline(self):
        """(events, time of the fault, of the next motion or None, of the end)."""
        events, at_s = [], SETTLED_s
        if not self.point.rests:
            begin, at_speed = velocity(self.point, self.motor, 0.0)
            events.append(begin)
            at_s = tick(at_speed + SETTLED_s)
        if self.point.load:
            events.append({"time_s": 0.0, "load_torque_Nm":
                           rounded(self.point.load * self.motor.rated_torque_Nm)})
        if self.fault.said and not self.point.rests:
            events.append({"time_s": at_s, "type": "state"})
        events += self.fault.events(self.motor, at_s)
        end_s, next_s = tick(at_s + self.point.observed_s), None
        if self.fault.said and not self.point.rests:
            text, within_s = self.fault.said
            events.append({"time_s": tick(at_s + within_s), "expect": text})
        if self.point.rests:
            next_s = end_s
            begin, at_speed = velocity(NEXT, self.motor, next_s)
            events.append(begin)
            end_s = tick(at_speed + NEXT_s)
        return events, at_s, next_s, end_s

    def scenario(self, until_s=None, seed=None):
        """Text of a file beside the motor's. `until_s`: judges up to there, not to the end."""
        events, at_s, next_s, end_s = self.timeline()
        last_s = next_s or end_s
        plant = {"model": "bench", "current_range_rated": CURRENT_RANGE}
        if self.drive.feedback == "encoder":
            plant["encoder_counts_per_turn"] = ENCODER_COUNTS
        windows = [[at_s, min(last_s, until_s or last_s)]]
        if next_s and (until_s is None or until_s > next_s):
            windows.append([next_s, until_s or end_s])
        document = {
            "description": f"{self.fault.title}, {self.point.title}: {self.drive.title}",
            "motor": f"./{self.motor.file.name}",
            "duration_s": until_s and tick(until_s + STEP_s) or end_s,
            "drive": {**self.drive.settings, **self.fault.drive},
            "plant": plant,
            "event": [event for event in events
                      if until_s is None or event["time_s"] <= until_s],
            "report": [{"metric": metric, "window": window} for window in windows
                       for metric in ("current_peak_A", "position_error_max_rad",
                                      "estimate_error_max_rad")],
        }
        if seed is not None:
            document["seed"] = seed
        return toml_document(document)


def cells_of(motor, drives=DRIVES, faults=FAULTS, points=POINTS):
    return [Cell(motor, drive, fault, point) for drive in drives for fault in faults
            for point in points
            if drive.feedback in fault.feedbacks and point.name not in drive.leaves_out]
