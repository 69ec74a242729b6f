"""Cyclic synchronous position at 250 Hz of the drive's time, by one PDO each way, and homing, through an
unmodified python-canopen. The drive's time is slowed, so that a machine that is busy is no bad bus.

usage: canopen_cyclic.py SIL
"""
import math
import time

from canopen_bus import Bus, map_one_each_way, slow, wait_for
from served import Checks, Served

CHECKS = Checks()
SPEED = 0.1  # simulated seconds in a second
INTERVAL_S = 0.004 / SPEED
TURN = 65536
CYCLES = 150


def target(n):
    """A quarter of a turn and back, smoothly."""
    return TURN // 8 * (1 - math.cos(2 * math.pi * n / (CYCLES - 20))) if n < CYCLES - 20 else 0


def follow(node):
    begin, heard = node.sdo[0x6064].raw, []
    node.tpdo[1].add_callback(lambda pdo: heard.append(pdo[1].raw - begin))
    start = time.monotonic()
    for n in range(CYCLES):
        node.rpdo[1][0].raw = 0x0F
        node.rpdo[1][1].raw = begin + round(target(n))
        node.rpdo[1].transmit()
        time.sleep(max(0.0, start + (n + 1) * INTERVAL_S - time.monotonic()))
    CHECKS.that(len(heard) > CYCLES / 4, f"the drive shows where it is: {len(heard)} times")
    CHECKS.that(abs(max(heard) - TURN // 4) < TURN // 100, f"it goes a quarter turn: {max(heard)}")
    CHECKS.that(wait_for(lambda: abs(node.sdo[0x6064].raw - begin) < 100, 20), "and back")
    status = node.sdo[0x6041].raw
    CHECKS.that(status & 0x206F == 0x0027, f"in operation, without a following error: {status:#x}")


def home(node):
    node.op_mode = "HOMING"
    node.sdo[0x607C].raw = 1000
    node.controlword = 0x1F
    CHECKS.that(wait_for(lambda: node.sdo[0x6041].raw & 0x1400 == 0x1400, 20), "homing is attained")
    CHECKS.that(abs(node.sdo[0x6064].raw - 1000) < 100, f"here is 1000: {node.sdo[0x6064].raw}")


with Served("--speed", SPEED) as served, Bus(served.link) as bus:
    NODE = bus.node
    slow(NODE, SPEED)
    map_one_each_way(NODE, (0x6040, 0x607A), (0x6041, 0x6064))
    NODE.setup_402_state_machine()
    NODE.nmt.state = "OPERATIONAL"
    wait_for(lambda: NODE.state == "SWITCH ON DISABLED")
    NODE.op_mode = "CYCLIC SYNCHRONOUS POSITION"
    NODE.state = "OPERATION ENABLED"
    follow(NODE)
    home(NODE)
CHECKS.end()
