"""An unmodified python-canopen on a served drive, as it would be on a board's serial adapter."""
import contextlib
import pathlib
import sys
import time

ROOT = pathlib.Path(__file__).resolve().parents[2]
CLIENTS = ROOT / "build" / "clients"
sys.path.insert(0, str(CLIENTS))
EDS = str(ROOT / "firmware" / "interface" / "steadystep.eds")

try:
    import canopen  # noqa: E402
    from canopen.profiles.p402 import BaseNode402  # noqa: E402
except ImportError:
    sys.exit(f"python-canopen is not in {CLIENTS}: tools/setup clients installs it")

PATIENCE = 15  # its waits go by the wall's clock, and a busy machine lets drive or client wait
ANSWER_S = 5
WAITS = ("TIMEOUT_SWITCH_STATE_FINAL", "TIMEOUT_SWITCH_STATE_SINGLE", "TIMEOUT_CHECK_TPDO",
         "TIMEOUT_SWITCH_OP_MODE")


class Bus:
    """A network on slcan; `with` connects and disconnects. `lives`: the nodes have said so before, and
    do so again when communication is reset."""

    def __init__(self, place, nodes=(1,), kind=BaseNode402, lives=False):
        self.network = canopen.Network()
        self.place, self.ids, self.kind, self.lives = str(place), nodes, kind, lives

    def __enter__(self):
        self.nodes = [self.network.add_node(self.kind(number, EDS)) for number in self.ids]
        self.network.connect(interface="slcan", channel=self.place, bitrate=500000,
                             sleep_after_open=0)
        self.node = self.nodes[0]
        if self.lives:
            self.network.nmt.state = "RESET COMMUNICATION"
        for node in self.nodes:
            node.sdo.RESPONSE_TIMEOUT = ANSWER_S
            slow(node, 1 / PATIENCE)
            wait_for(lambda node=node: node.nmt.state == "PRE-OPERATIONAL")
        return self

    def __exit__(self, *_):
        self.network.disconnect()


def slow(node, speed):
    """What python-canopen waits for is the drive's, whose seconds last longer."""
    for name in WAITS:
        setattr(node, name, getattr(node, name) / speed)


@contextlib.contextmanager
def as_it_comes(node):
    """With the waits of an unmodified client."""
    kept = {name: vars(node).pop(name) for name in WAITS}
    try:
        yield
    finally:
        vars(node).update(kept)


def map_one_each_way(node, received, sent):
    """Objects of RPDO1 and TPDO1, which is sent every 4 to 8 ms."""
    node.tpdo.read()
    node.rpdo.read()
    for pdo, objects in ((node.rpdo[1], received), (node.tpdo[1], sent)):
        pdo.clear()
        for number in objects:
            pdo.add_variable(number)
    node.tpdo[1].event_timer = 8
    node.tpdo[1].inhibit_time = 40
    node.rpdo.save()
    node.tpdo.save()


def wait_for(condition, timeout_s=5.0):
    """Whether it has come true in that time."""
    end = time.monotonic() + timeout_s
    while time.monotonic() < end:
        if condition():
            return True
        time.sleep(0.005)
    return bool(condition())
