"""Three drives on one bus: each answers for itself, moves by itself, and one hears the heartbeat of another.

usage: canopen_nodes.py SIL
"""
import time

from canopen_bus import Bus, wait_for
from served import Checks, Line, Served

CHECKS = Checks()


def enable(node):
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    wait_for(lambda: node.state == "SWITCH ON DISABLED")
    node.state = "OPERATION ENABLED"
    node.op_mode = "PROFILED POSITION"


def each_moves_by_itself(nodes):
    for node in nodes:
        enable(node)
    for number, node in enumerate(nodes):
        node.sdo[0x607A].raw = 10000 * (number + 1)
        node.controlword = 0x1F
    for number, node in enumerate(nodes):
        CHECKS.that(wait_for(lambda node=node: node.sdo[0x6041].raw & 0x400), "it gets there")
        wait_for(lambda node=node, number=number:
                 abs(node.sdo[0x6064].raw - 10000 * (number + 1)) < 100)
        CHECKS.that(abs(node.sdo[0x6064].raw - 10000 * (number + 1)) < 100, "each where it was sent")


def a_fault_is_of_one(nodes, knobs):
    CHECKS.that(knobs.ask("2: plant.bus_V = 8").startswith("ok"), "the second one's supply sags")
    CHECKS.that(wait_for(lambda: nodes[1].state == "FAULT"), "which is its fault")
    CHECKS.that(nodes[0].state == nodes[2].state == "OPERATION ENABLED", "alone")
    CHECKS.that("expected a node" in knobs.ask("4: state"), "there are three")


def one_listens_to_another(nodes):
    nodes[0].sdo[0x1017].raw = 50
    nodes[2].sdo[0x1016][1].raw = 1 << 16 | 500
    time.sleep(0.3)
    nodes[0].sdo[0x1017].raw = 0
    CHECKS.that(wait_for(lambda: nodes[2].state == "SWITCH ON DISABLED"), "silence switches it off")
    CHECKS.that(wait_for(lambda: 0x8130 in [error.code for error in nodes[2].emcy.log]), "it says so")
    CHECKS.that(nodes[0].state == "OPERATION ENABLED", "and the silent one goes on")


with Served("--nodes", 3) as served:
    KNOBS = Line(str(served.knobs_link))
    with Bus(served.link, nodes=(1, 2, 3)) as bus:
        each_moves_by_itself(bus.nodes)
        one_listens_to_another(bus.nodes)
        a_fault_is_of_one([bus.nodes[0], bus.nodes[1], bus.nodes[0]], KNOBS)
    KNOBS.close()
CHECKS.end()
