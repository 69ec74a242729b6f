#!/usr/bin/python3
"""The image of the board, served by the virtual board, is operated by python-canopen as the simulator's
drive is.

usage: canopen_image.py SIL IMAGE.elf
"""
import pathlib
import sys

IMAGE = pathlib.Path(sys.argv.pop()).resolve()
from canopen_bus import Bus, canopen  # noqa: E402
from image_node import SPEED, operate  # noqa: E402
from served import Checks, Served  # noqa: E402

CHECKS = Checks()


def the_sheet_is_left_out(node):
    try:
        node.sdo.upload(0x1021, 0)
        CHECKS.that(False, "the image carries a sheet")
    except canopen.SdoAbortedError as refused:
        CHECKS.that(refused.code == 0x08000024, f"no data: {refused}")


def operate_with_a_setting(node):
    node.sdo["current_limit_A"].raw = 2.5
    CHECKS.that(node.sdo["current_limit_A"].raw == 2.5, "a setting is written and read")
    operate(node, CHECKS)


with Served("--image", IMAGE, "--speed", SPEED) as served:
    with Bus(served.link) as bus:
        the_sheet_is_left_out(bus.node)
        operate_with_a_setting(bus.node)
    code, said, _ = served.end()
    CHECKS.that(code == 0 and said.startswith("served "), f"it ends in order: {code} {said}")
CHECKS.end()
