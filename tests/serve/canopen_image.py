#!/usr/bin/python3
"""The image of the board, served by the virtual board, is operated by python-canopen as the simulator's
drive is.

usage: canopen_image.py SIL IMAGE.elf
"""
import pathlib
import sys

IMAGE = pathlib.Path(sys.argv.pop()).resolve()
from canopen_bus import Bus, wait_for  # noqa: E402
from served import Checks, Served  # noqa: E402

CHECKS = Checks()
SPEED = 0.1  # what a busy machine still executes of the image


def operate(node):
    for name in ("TIMEOUT_SWITCH_STATE_FINAL", "TIMEOUT_SWITCH_STATE_SINGLE", "TIMEOUT_CHECK_TPDO",
                 "TIMEOUT_SWITCH_OP_MODE"):
        setattr(node, name, getattr(node, name) / SPEED)
    CHECKS.that("stm32g474" in node.sdo[0x100A].raw, "it is the image")
    node.sdo["current_limit_A"].raw = 2.5
    CHECKS.that(node.sdo["current_limit_A"].raw == 2.5, "a setting is written and read")
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    wait_for(lambda: node.state == "SWITCH ON DISABLED")
    node.state = "OPERATION ENABLED"
    node.op_mode = "PROFILED POSITION"
    node.sdo[0x607A].raw = 16384
    node.controlword = 0x1F
    CHECKS.that(wait_for(lambda: node.sdo[0x6041].raw & 0x1000, 20), "a set-point is acknowledged")
    CHECKS.that(wait_for(lambda: node.sdo[0x6041].raw & 0x400, 30), "and reached")
    CHECKS.that(abs(node.sdo[0x6064].raw - 16384) < 100, f"it is there: {node.sdo[0x6064].raw}")


with Served("--image", IMAGE, "--speed", SPEED) as served:
    with Bus(served.link) as bus:
        operate(bus.node)
    code, said, _ = served.end()
    CHECKS.that(code == 0 and said.startswith("served "), f"it ends in order: {code} {said}")
CHECKS.end()
