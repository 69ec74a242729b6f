"""An unmodified python-canopen on a CAN network of the kernel: each check is a line, "ok ..." or
"FAILED ...".

usage: socketcan_client.py NETWORK
"""
import sys
import time

from canopen_bus import EDS, BaseNode402, canopen, wait_for

TURN = 65536
HEARTBEAT_MS = 50


def that(condition, what):
    print(f"{'ok' if condition else 'FAILED'} {what}")


def it_says_what_it_is(node):
    node.nmt.send_command(0x82)  # reset communication
    that(wait_for(lambda: node.nmt.state == "PRE-OPERATIONAL"), "it says that it has started")
    sheet = node.object_dictionary
    that(node.sdo[0x1000].raw == sheet[0x1000].default, f"1000h: {node.sdo[0x1000].raw:#x}")
    identity = {part: node.sdo[0x1018][part].raw for part in (1, 2, 3, 4)}
    that(all(sheet[0x1018][part].default == value for part, value in identity.items()),
         f"1018h: {identity}")


def its_heart_beats(node, network):
    times_s, states = [], []

    def hear(_, data, time_s):
        times_s.append(time_s)
        states.append(data[0])

    network.subscribe(0x701, hear)
    node.sdo[0x1017].raw = HEARTBEAT_MS
    that(wait_for(lambda: len(times_s) > 20), "its heart beats")
    mean_ms = 1000 * (times_s[-1] - times_s[0]) / (len(times_s) - 1)
    that(abs(mean_ms - HEARTBEAT_MS) < 10, f"every {mean_ms:.1f} ms")
    node.setup_402_state_machine()
    node.nmt.state = "OPERATIONAL"
    that(wait_for(lambda: states[-1] == 5), "and says that it is operational")


def it_turns_once(node):
    wait_for(lambda: node.state == "SWITCH ON DISABLED")
    node.state = "OPERATION ENABLED"
    that(node.state == "OPERATION ENABLED", "enabled")
    node.op_mode = "PROFILED POSITION"
    begin = node.sdo[0x6064].raw
    node.sdo[0x607A].raw = begin + TURN
    node.controlword = 0x1F
    that(wait_for(lambda: node.statusword & 0x1000), "the set-point is acknowledged")
    node.controlword = 0x0F
    that(wait_for(lambda: node.statusword & 0x400), "the target is reached")
    moved = node.sdo[0x6064].raw - begin
    that(abs(moved - TURN) < 100, f"6064h has moved by {moved}")
    time.sleep(0.5)  # the test looks at the rotor
    node.state = "SWITCH ON DISABLED"
    that(wait_for(lambda: node.state == "SWITCH ON DISABLED"), "disabled")


with canopen.Network() as network:
    network.connect(interface="socketcan", channel=sys.argv[1])
    drive = network.add_node(BaseNode402(1, EDS))
    # A machine may be busy; what the drive takes with python-canopen's own is tested elsewhere.
    drive.sdo.RESPONSE_TIMEOUT = drive.TIMEOUT_CHECK_TPDO = drive.TIMEOUT_SWITCH_OP_MODE = 5
    drive.TIMEOUT_SWITCH_STATE_SINGLE = drive.TIMEOUT_SWITCH_STATE_FINAL = 5
    it_says_what_it_is(drive)
    its_heart_beats(drive, network)
    it_turns_once(drive)
