"""Cyclic synchronous torque at 250 Hz of the drive's time, by one PDO each way, of a drive with an encoder, through an
unmodified python-canopen; and that one without an encoder refuses the mode. The drive's time is slowed.

usage: canopen_torque.py SIL
"""
import math
import statistics
import time

from canopen_bus import Bus, canopen, map_one_each_way, slow, wait_for
from served import Checks, Served

CHECKS = Checks()
SPEED = 0.1  # simulated seconds in a second
INTERVAL_S = 0.004 / SPEED
TURN = 65536
CYCLES, A_CYCLE = 125, 20  # intervals, in all and of a sine
TORQUE = 200  # thousandths of the rated one
KM, INERTIA, RATED_A = 0.157, 15.62e-5, 3.0


def follow(node):
    """A sine of A_CYCLE intervals: the speed is its integral."""
    heard, began, n = [], [], 0
    node.tpdo[1].add_callback(lambda pdo: heard.append((n, pdo[1].raw, pdo[2].raw * 2 * math.pi / TURN)))
    start = time.monotonic()
    for n in range(CYCLES):
        node.rpdo[1][0].raw = 0x0F
        node.rpdo[1][1].raw = round(TORQUE * math.cos(2 * math.pi * n / A_CYCLE))
        node.rpdo[1].transmit()
        network.sync.transmit()
        if n % A_CYCLE == 0:
            began.append(1e-4 * node.sdo[0x2301].raw)  # by the drive's clock: this process may come late
        time.sleep(max(0.0, start + (n + 1) * INTERVAL_S - time.monotonic()))
    CHECKS.that(len(heard) > CYCLES / 4, f"the drive shows what it does: {len(heard)} times")
    torques = [torque for _, torque, _ in heard]
    CHECKS.that(abs(max(torques) - TORQUE) < 40 and abs(min(torques) + TORQUE) < 40,
                f"6077h goes from {min(torques)} to {max(torques)}")
    per_second = TORQUE / 1000 * KM * RATED_A / INERTIA / (2 * math.pi)
    swings = [(half_swing(speed for at, _, speed in heard if at // A_CYCLE == cycle),
               per_second * (began[cycle + 1] - began[cycle])) for cycle in range(1, CYCLES // A_CYCLE)]
    CHECKS.that(abs(statistics.median(swing / expected for swing, expected in swings) - 1) < 0.15,
                f"the speed swings by, and its integral: {swings} rad/s")


def half_swing(speeds):
    speeds = list(speeds)
    return (max(speeds) - min(speeds)) / 2 if speeds else 0.0


def sends(node, torque, word=0x0F):
    node.rpdo[1][0].raw, node.rpdo[1][1].raw = word, torque
    node.rpdo[1].transmit()
    network.sync.transmit()


def speed(node):
    return node.sdo[0x606C].raw * 2 * math.pi / TURN


def reaches_the_speed(node):
    node.sdo[0x6080].raw = 300
    sends(node, TORQUE)
    CHECKS.that(wait_for(lambda: abs(speed(node) - 10 * math.pi) < 0.5, 20), f"300 turns a minute: {speed(node):.1f} rad/s")
    CHECKS.that(node.sdo[0x6041].raw & 0x1827 == 0x1827, f"and says that it is cut: {node.sdo[0x6041].raw:#x}")
    CHECKS.that(wait_for(lambda: node.sdo[0x6074].raw < TORQUE // 4), f"6074h: {node.sdo[0x6074].raw}")


def goes_on_in_position(node):
    node.op_mode = "CYCLIC SYNCHRONOUS POSITION"
    CHECKS.that(abs(speed(node)) < 1, "another mode begins at rest")
    CHECKS.that(wait_for(lambda: abs(node.sdo[0x60F4].raw) < 100, 5), "and in its place")
    node.op_mode = "CYCLIC SYNCHRONOUS TORQUE"


def stops_quickly(node):
    sends(node, -TORQUE)
    CHECKS.that(wait_for(lambda: speed(node) < -20, 20), "the other way")
    node.sdo[0x605A].raw = 6
    sends(node, -TORQUE, 0x02)
    CHECKS.that(wait_for(lambda: abs(speed(node)) < 0.5, 5), f"a quick stop: {speed(node):.1f} rad/s")
    time.sleep(0.05 / SPEED)
    CHECKS.that(node.sdo[0x6041].raw & 0x6F == 0x07 and abs(speed(node)) < 0.5, "and stays")
    CHECKS.that(node.sdo[0x603F].raw == 0, "without a fault")


with Served("--speed", SPEED, "torque") as served, Bus(served.link) as bus:  # the scenario's drive
    NODE, network = bus.node, bus.network
    slow(NODE, SPEED)
    map_one_each_way(NODE, (0x6040, 0x6071), (0x6041, 0x6077, 0x606C))
    CHECKS.that(NODE.sdo[0x6502].raw == 0x2A5, f"6502h: {NODE.sdo[0x6502].raw:#x}")
    NODE.setup_402_state_machine(read_pdos=False)
    NODE.nmt.state = "OPERATIONAL"
    wait_for(lambda: NODE.state == "SWITCH ON DISABLED")
    NODE.op_mode = "CYCLIC SYNCHRONOUS TORQUE"
    NODE.state = "OPERATION ENABLED"
    NODE.sdo[0x1400][2].raw = 1  # from now on with SYNC
    follow(NODE)
    reaches_the_speed(NODE)
    goes_on_in_position(NODE)
    stops_quickly(NODE)

with Served() as served, Bus(served.link) as bus:
    CHECKS.that(bus.node.sdo[0x6502].raw == 0xA5, "without an encoder 6502h has no bit of it")
    try:
        bus.node.sdo[0x6060].raw = 10
        CHECKS.that(False, "and 6060h refuses it")
    except canopen.SdoAbortedError as abort:
        CHECKS.that(abort.code == 0x06090030, f"and 6060h refuses it: {abort}")
CHECKS.end()
