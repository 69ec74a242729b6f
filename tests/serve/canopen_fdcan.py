#!/usr/bin/python3
"""The image of the board is operated by python-canopen over its CAN bus, as by any adapter there, while
the console goes on; and on the serial line instead, for as long as that has the channel.

usage: canopen_fdcan.py SIL IMAGE.elf
"""
import pathlib
import sys

IMAGE = pathlib.Path(sys.argv.pop()).resolve()
from canopen_bus import Bus, wait_for  # noqa: E402
from image_node import SPEED, operate  # noqa: E402
from served import Checks, Line, Served  # noqa: E402

CHECKS = Checks()


def the_line_takes_the_channel(network, console):
    seen = []
    network.subscribe(0x701, lambda number, data, stamp: seen.append(data[0]))
    console.send("O\r")
    CHECKS.that(wait_for(lambda: b"t701100\r" in console.heard(), 20), "boot-up, on the line")
    CHECKS.that(not seen, "and not on the bus")
    console.send("C\r")
    CHECKS.that(wait_for(lambda: seen == [0], 20), f"it closes: boot-up on the bus: {seen}")


class Console(Line):
    def heard(self):
        self.read(0.05)
        return self.rest


with Served("--image", IMAGE, "--speed", SPEED, "--can-link", "can") as served:
    place = served.process.stdout.readline().split()[1]
    console = Console(str(served.link))
    with Bus(place, lives=True) as bus:
        CHECKS.that(console.ask("state").startswith("steadystep"), "the console is there, too")
        operate(bus.node, CHECKS)
        CHECKS.that(console.until("ready:", 60), "it announces what happens on the bus")
        CHECKS.that(console.ask("state").startswith("ok operation-enabled"), "and answers")
        bus.node.state = "SWITCH ON DISABLED"
        CHECKS.that(bus.node.sdo[0x1001].raw == 0, "no error")
        the_line_takes_the_channel(bus.network, console)
    console.close()
    code, said, _ = served.end()
    CHECKS.that(code == 0 and said.startswith("served "), f"it ends in order: {code} {said}")
CHECKS.end()
