"""What python-canopen does with the image of the board, whatever carries its frames."""
from canopen_bus import slow, wait_for

SPEED = 0.1  # what a busy machine still executes of the image


def operate(node, checks):
    slow(node, SPEED)
    checks.that("stm32g474" in node.sdo[0x100A].raw, "it is the image")
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    wait_for(lambda: node.state == "SWITCH ON DISABLED")
    node.state = "OPERATION ENABLED"
    node.op_mode = "PROFILED POSITION"
    node.sdo[0x607A].raw = 16384
    node.controlword = 0x1F
    checks.that(wait_for(lambda: node.sdo[0x6041].raw & 0x1000, 20), "a set-point is acknowledged")
    checks.that(wait_for(lambda: node.sdo[0x6041].raw & 0x400, 30), "and reached")
    checks.that(abs(node.sdo[0x6064].raw - 16384) < 100, f"it is there: {node.sdo[0x6064].raw}")
