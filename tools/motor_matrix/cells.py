"""The cells of the matrix: plants, feedbacks, moves, and the scenario that judges them."""
import math
from typing import NamedTuple

from comparison.simulator import toml_document
from operating_envelope.points import rounded

# "25 %" is of the torque constant times the rated current.
LOAD_SHARE = 0.25
CURRENT_RANGE = 2.2          # full scale of the current sensing, in rated currents
ENCODER_COUNTS = 4000        # per turn
TURN_SPEED = 0.3             # of the speed at which the supply still drives the rated current
TURN_ACCELERATION = 0.3      # of what the rated torque gives the rotor
SHORTEST_RAMP_s = 0.02
CREEP_rad_s, CREEP_UP_s = 0.5, 0.05
TENTHS, TENTH_s, TENTH_EVERY_s = 5, 0.02, 0.15
JUDGED_s = 0.25              # of position error, at the end of each cell
REST_s = 0.5                 # behind a move
LOAD_AT_s = 0.3              # of the load step at rest
QUIET_s, STEP_WITHIN_s = 3.0, 0.06

COMMUTATION_deg = 45.0       # electrical, from ready on
READY_deg, READY_COUNTS = 3.0, 0.75  # of the encoder's zero: whichever is more
READY_WINDOW_s = 1e-3
FINAL_STEPS, FINAL_STEPS_DETENT, STEP_WITHIN_STEPS = 1 / 16, 1 / 5, 1 / 8


class PlantKind(NamedTuple):
    name: str
    title: str
    settings: dict
    detent: bool = False
    step_judged: bool = False  # the load step's first 60 ms, too


PLANTS = (
    PlantKind("ideal", "ideal", {"model": "ideal"}),
    PlantKind("bench", "bench", {"model": "bench"}, step_judged=True),
    PlantKind("real", "real", {"model": "real"}, detent=True),
    PlantKind("smooth", "real, no detent, no friction",
              {"model": "real", "detent_4": 0.0, "detent_2": 0.0, "detent_1": 0.0,
               "coulomb_friction": 0.0}),
)
# With one that is run by its name only: it asks for more than the counts of the others.
ALL_PLANTS = (*PLANTS, PlantKind("as-built", "as built", {"model": "as-built"}, detent=True))



class Feedback(NamedTuple):
    name: str
    drive: dict
    plant: dict
    counts: int = 0


FEEDBACKS = (
    Feedback("sensorless", {}, {}),
    Feedback("encoder", {"feedback": "encoder"}, {"encoder_counts_per_turn": ENCODER_COUNTS},
             ENCODER_COUNTS),
)


class Span(NamedTuple):
    """The part of a run in which one move is judged."""
    move: str
    begin_s: float
    end_s: float
    load_at_s: float = None  # of a load step whose settling is reported


class Course(NamedTuple):
    """The timeline of one run, and the moves that it judges; a later one needs those before."""
    name: str
    events: list
    spans: list

    @property
    def duration_s(self):
        return self.spans[-1].end_s


MOVES = {
    "turn": "one turn",
    "loaded": f"one turn under {LOAD_SHARE:.0%} load",
    "release": "the release of that load at rest",
    "creep": f"{CREEP_rad_s:g} rad/s",
    "tenths": "five tenths of a full step",
    "rest": f"{QUIET_s:g} s of rest",
    "step": f"load step of {LOAD_SHARE:.0%} at rest",
}


def turn_of(motor):
    """(duration, ramp) of one turn, s: a trapezoid of a moderate share of what the motor can do."""
    speed = TURN_SPEED * motor.rated_speed_rad_s
    ramp = max(SHORTEST_RAMP_s,
               speed / (TURN_ACCELERATION * motor.rated_acceleration_rad_s2))
    ramp = math.ceil(1e4 * min(ramp, 2 * math.pi / speed)) / 1e4
    return round(max(2 * math.pi / speed, ramp) + ramp, 4), ramp


def turn_event(motor):
    duration, ramp = turn_of(motor)
    return {"time_s": 0.0, "command": "move-trapezoid", "position_rad": round(2 * math.pi, 6),
            "duration_s": duration, "ramp_s": ramp}


def courses_of(motor):
    load_Nm = rounded(LOAD_SHARE * motor.rated_torque_Nm)
    turn, ramp = turn_of(motor)
    turned = round(turn + REST_s, 4)
    released = round(turned + REST_s, 4)
    creep = round(CREEP_UP_s + 1.0, 4)
    tenth = motor.full_step_rad / 10
    moves = [{"time_s": round(i * TENTH_EVERY_s, 4), "command": "move-trapezoid",
              "position_rad": round((i + 1) * tenth, 8), "duration_s": TENTH_s,
              "ramp_s": TENTH_s / 2} for i in range(TENTHS)]
    micro = round((TENTHS - 1) * TENTH_EVERY_s + TENTH_s + REST_s, 4)
    stepped = LOAD_AT_s + 2 * REST_s
    return [
        Course("turn", [turn_event(motor)], [Span("turn", 0.0, turned)]),
        Course("loaded", [turn_event(motor), {"time_s": ramp, "load_torque_Nm": load_Nm},
                          {"time_s": turned, "load_torque_Nm": 0.0}],
               [Span("loaded", 0.0, turned), Span("release", 0.0, released)]),
        Course("creep", [{"time_s": 0.0, "command": "velocity", "speed_rad_s": CREEP_rad_s,
                          "acceleration_rad_s2": CREEP_rad_s / CREEP_UP_s,
                          "jerk_rad_s3": 10 * CREEP_rad_s / CREEP_UP_s**2}],
               [Span("creep", 0.0, creep)]),
        Course("tenths", moves, [Span("tenths", 0.0, micro)]),
        Course("rest", [], [Span("rest", 0.0, QUIET_s)]),
        Course("step", [{"time_s": LOAD_AT_s, "load_torque_Nm": load_Nm}],
               [Span("step", 0.0, stepped, LOAD_AT_s)]),
    ]


def allowed_steps(plant):
    return FINAL_STEPS_DETENT if plant.detent else FINAL_STEPS


def final_error_rad(motor, plant, feedback):
    """A count is what an encoder cannot see."""
    count_rad = 2 * math.pi / feedback.counts if feedback.counts else 0.0
    return allowed_steps(plant) * motor.full_step_rad + count_rad


def ready_error_rad(motor, feedback):
    """Of an encoder's zero."""
    return max(math.radians(READY_deg) / motor.rotor_teeth,
               READY_COUNTS * 2 * math.pi / feedback.counts)


def expectations_of(span, motor, plant, feedback):
    """What a cell that holds has kept, in the order of `verdict.KINDS`."""
    whole = [span.begin_s, span.end_s]
    last = [round(span.end_s - JUDGED_s, 4), span.end_s]
    expected = [
        {"metric": "fault", "window": whole, "equals": "none"},
        {"metric": "slip_full_steps", "window": whole, "max": 0},
        {"metric": "estimate_error_max_rad", "window": whole,
         "max": rounded(math.radians(COMMUTATION_deg) / motor.rotor_teeth, 6)},
        {"metric": "position_error_max_rad", "window": last,
         "max": rounded(final_error_rad(motor, plant, feedback), 6)},
    ]
    if span.load_at_s is not None and plant.step_judged:
        expected.append({"metric": "position_error_max_rad",
                         "window": [round(span.load_at_s + STEP_WITHIN_s, 4), span.end_s],
                         "max": rounded(STEP_WITHIN_STEPS * motor.full_step_rad
                                        + final_error_rad(motor, plant, feedback)
                                        - FINAL_STEPS * motor.full_step_rad, 6)})
    return expected


def reports_of(course):
    """The error with which the drive has become ready, and how soon a load step is borne."""
    reports = [{"metric": "estimate_error_max_rad", "window": [0.0, READY_WINDOW_s]}]
    for span in course.spans:
        if span.load_at_s is not None:
            reports.append({"metric": "settling_time_s", "window": [span.load_at_s, span.end_s]})
    return reports


class Run(NamedTuple):
    """One scenario of the matrix: a motor on a plant, with a feedback, through a course."""
    motor: object
    plant: PlantKind
    feedback: Feedback
    course: Course

    @property
    def name(self):
        return f"{self.plant.name}-{self.feedback.name}-{self.course.name}"

    def scenario(self):
        """Text of a file that stands beside the motor's."""
        motor, plant, feedback = self.motor, self.plant, self.feedback
        expected = [one for span in self.course.spans
                    for one in expectations_of(span, motor, plant, feedback)]
        return toml_document({
            "description": f"{motor.id}, {plant.title}, {feedback.name}: "
                           + ", ".join(MOVES[span.move] for span in self.course.spans),
            "motor": f"./{motor.file.name}",
            "duration_s": self.course.duration_s,
            "settling_band_rad": rounded(FINAL_STEPS * motor.full_step_rad, 6),
            "drive": feedback.drive,
            "plant": {**plant.settings, **feedback.plant, "current_range_rated": CURRENT_RANGE},
            "event": self.course.events,
            "expect": expected,
            "report": reports_of(self.course),
        })


def runs_of(motor, plants=PLANTS, feedbacks=FEEDBACKS, moves=None):
    """Those of one motor in which one of the `moves` is judged."""
    return [Run(motor, plant, feedback, course)
            for plant in plants for feedback in feedbacks for course in courses_of(motor)
            if moves is None or any(span.move in moves for span in course.spans)]
