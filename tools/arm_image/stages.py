"""
Which block of the drive an instruction of the control interrupt belongs to: the blocks of the
diagram in firmware/drive/control_cycle.c, and what the board does before and after them.

An instruction comes from a chain of functions inlined into each other. The outermost one that
belongs to a block decides, so that the state machine pays for what it starts. What only puts blocks
together is looked through. Code that serves every block (numbers, library) and stands as a function
of its own belongs to whoever calls it: stage CALLER, known at run time only.
"""

from fnmatch import fnmatch

STAGES = [
    "sampling",  # entry into the interrupt, raw samples
    "measurement",
    "state machine",
    "estimator",  # and the prediction to the instant of action
    "reference",
    "position law",  # and hold, and detent compensation
    "current control",
    "modulator",  # and loss compensation
    "protection",  # and synchronism monitor
    "outputs",  # compares, bridge, leaving the interrupt
    "cycle counts",  # that the application keeps
    "other",  # what puts the blocks together
]
CALLER = len(STAGES)

# Claimed wherever it is called from.
CLAIMED = {
    "firmware/drive/measurement.*": "measurement",
    "firmware/drive/protection.*": "protection",
}

# File -> block.
BLOCKS = [
    ("firmware/drive/synchronism.*", "protection"),
    ("firmware/estimator/synchronism_monitor.*", "protection"),
    ("firmware/drive/block_reset.*", "state machine"),
    ("firmware/drive/state_machine.*", "state machine"),
    ("firmware/drive/command_queue.*", "state machine"),
    ("firmware/estimator/*", "estimator"),
    ("firmware/motion/*", "reference"),
    ("firmware/control/current_control.*", "current control"),
    ("firmware/control/voltage_limit.*", "current control"),
    ("firmware/control/modulator.*", "modulator"),
    ("firmware/motor/actuation.*", "modulator"),
    ("firmware/control/*", "position law"),
]

# Function of firmware/drive/control_cycle.c -> block.
CONTROL_CYCLE = {
    "predict": "estimator",
    "present": "estimator",
    "expect_current": "estimator",
    "remember_demand": "estimator",
    "compensate_detent": "position law",
    "regulate_voltage": "position law",
    "hold_rotor": "position law",
    "move_rotor": "position law",
    "transfer": "position law",
    "enter_or_leave_hold": "position law",
    "enter_hold": "position law",
    "leave_or_lead_hold": "position law",
    "work_on_hold": "position law",
    "turn_reference": "reference",
    "modulate": "modulator",
    "watch_synchronism": "protection",
    "act_on_synchronism": "protection",
}

INTERRUPT = "control_interrupt"
CYCLE_COUNTS = "control_cycles_count"

# Looked through: (file, function) -> block of what is left. Other functions of the files: "other".
THROUGH = {
    ("firmware/drive/control_cycle.c", "observe"): "estimator",
    ("firmware/drive/control_cycle.c", "observe_sensorless"): "estimator",
    ("firmware/drive/control_cycle.c", "regulate_current"): "current control",
}
THROUGH_FILES = ["firmware/drive/control_cycle.c", "firmware/application/*"]

# Words in the names of a board port's functions that belong to the outputs.
OUTPUT_WORDS = ("output", "actuate", "bridge", "pwm_write")


def _block(frame):
    """Block of a frame, None: look further inwards."""
    if frame.file == "firmware/drive/control_cycle.c" and frame.function in CONTROL_CYCLE:
        return CONTROL_CYCLE[frame.function]
    if frame.file.startswith("firmware/application/") and frame.function == CYCLE_COUNTS:
        return "cycle counts"
    return next((block for pattern, block in BLOCKS if fnmatch(frame.file, pattern)), None)


def _remainder(frame):
    """Block of what a frame has besides the blocks inlined into it, None: its caller's."""
    if (frame.file, frame.function) in THROUGH:
        return THROUGH[frame.file, frame.function]
    if any(fnmatch(frame.file, pattern) for pattern in THROUGH_FILES):
        return "other"
    return None


def of_frames(frames):
    """Index of the stage of a chain of frames, innermost first."""
    for frame in frames:
        for pattern, block in CLAIMED.items():
            if fnmatch(frame.file, pattern):
                return STAGES.index(block)
    for frame in reversed(frames):
        block = _block(frame)
        if block:
            return STAGES.index(block)
    for frame in frames:
        block = _remainder(frame)
        if block:
            return STAGES.index(block)
    board = [frame.function for frame in frames if frame.file.startswith("hal/")]
    if any(word in function for function in board for word in OUTPUT_WORDS):
        return STAGES.index("outputs")
    return STAGES.index("sampling") if board else CALLER


def of_return(function):
    """Index of the stage of the instruction by which a function returns, None: as of all others."""
    return STAGES.index("outputs") if function == INTERRUPT else None


def by_stage(stage_at, paths):
    """Cycles by name of the stage, of the calls whose runs (trace.Run) `paths` holds in their order;
    stage_at: of an address, as Stages.at."""
    pieces, cycles, stage = {}, [0] * len(STAGES), STAGES.index("other")
    for path in paths:
        for run in path:
            if run not in pieces:
                pieces[run] = [(stage_at(address), nominal) for address, nominal, _ in run.costs]
            for of, nominal in pieces[run]:
                stage = stage if of == CALLER else of
                cycles[stage] += nominal
    return dict(zip(STAGES, cycles))


class Stages:
    """Stage of each instruction of an image."""

    def __init__(self, inlining):
        self._inlining = inlining
        self._known = {}

    def at(self, address):
        frames = self._inlining.frames(address)
        if frames not in self._known:
            self._known[frames] = of_frames(frames)
        return self._known[frames]
