#!/usr/bin/python3
"""A move is captured at 10 kHz, uploaded in blocks by an unmodified python-canopen, and read on the console.

usage: canopen_capture.py SIL [IMAGE.elf]      of the simulator's drive, or of a board's image
"""
import pathlib
import struct
import sys

IMAGE = ["--image", pathlib.Path(sys.argv.pop()).resolve(), "--speed", 0.1] if len(sys.argv) > 2 else []
from canopen_bus import Bus, slow, wait_for  # noqa: E402
from served import Checks, Line, Served  # noqa: E402

CHECKS = Checks()
SLOWED = 10 if IMAGE else 1
SIGNALS = {"theta_ref_rad": 0x2313, "theta_est_rad": 0x2310, "reference_moving": 0x2302, "period": 0x2301}
BEFORE, SAMPLES, DIVIDER = 100, 800, 3
TURN = 65536
ARM, DONE = 1, 4


def enable(node):
    slow(node, 1 / SLOWED)
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    wait_for(lambda: node.state == "SWITCH ON DISABLED")
    node.state = "OPERATION ENABLED"
    node.op_mode = "PROFILED POSITION"


def arm(node):
    for place, index in enumerate(SIGNALS.values()):
        node.sdo[0x2401][place + 1].raw = index
    for sub, value in ((2, DIVIDER), (3, SIGNALS["reference_moving"]), (4, 0.5), (6, BEFORE), (7, SAMPLES)):
        node.sdo[0x2400][sub].raw = value
    node.sdo[0x2400][1].raw = ARM
    CHECKS.that(wait_for(lambda: node.sdo[0x2400][1].raw == 2, 5 * SLOWED), "it waits for the move")


def upload(node):
    with node.sdo[0x2402].open("rb", block_transfer=True) as stream:
        data = stream.read(-1)
    CHECKS.that(len(data) == 8 * len(SIGNALS) * SAMPLES, f"{len(data)} bytes")
    values = struct.unpack(f"<{len(data) // 8}d", data)
    return [dict(zip(SIGNALS, values[i:i + len(SIGNALS)])) for i in range(0, len(values), len(SIGNALS))]


def check(samples, first_period):
    CHECKS.that([sample["period"] for sample in samples]
                == [first_period + DIVIDER * i for i in range(SAMPLES)], "all of a sample are of one interrupt")
    CHECKS.that([sample["reference_moving"] for sample in samples[BEFORE - 1:BEFORE + 1]] == [0, 1],
                "the move begins where it should")
    rising = [sample["theta_ref_rad"] for sample in samples]
    CHECKS.that(rising == sorted(rising) and rising[0] == 0 and rising[-1] > 0.5, f"it goes {rising[-1]} rad")
    off = max(abs(sample["theta_ref_rad"] - sample["theta_est_rad"]) for sample in samples)
    CHECKS.that(off < 0.01, f"the estimate follows within {off} rad")


with Served(*IMAGE) as served:
    with Bus(served.link) as bus:
        bus.node.sdo.RESPONSE_TIMEOUT = 5
        enable(bus.node)
        arm(bus.node)
        bus.node.sdo[0x607A].raw = TURN
        bus.node.controlword = 0x1F
        CHECKS.that(wait_for(lambda: bus.node.sdo[0x2400][1].raw == DONE, 10 * SLOWED), "it is captured")
        taken = upload(bus.node)
        check(taken, bus.node.sdo[0x2400][9].raw)
    line = Line(str(served.link))
    line.send("C\r")
    said = line.ask("capture").strip()
    CHECKS.that(said == f"ok capture samples={SAMPLES}", f"the console has it, too: {said}")
    shown = line.ask("capture 700")
    expected = " ".join(f"{name}={taken[700][name]:.15g}" for name in ("reference_moving", "period"))
    CHECKS.that(shown.startswith("ok capture period=") and shown.endswith(expected), f"{shown} {expected}")
    line.close()
CHECKS.end()
