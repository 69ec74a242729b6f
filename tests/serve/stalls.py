"""A drive that stands still, as one does whose machine is busy: the package waits for it, and takes no late answer for another
request's; of one that stands still for good it says so, in the time that it states.

usage: stalls.py SIL
"""
import signal
import sys
import threading
import time

from operated import Simulated, refusal, steadystep
from served import Checks
from steadystep.byte_line import LOST_S, open_line
from steadystep.share import Share

CHECKS = Checks()
SIL = sys.argv[1]
STANDS_STILL_S = (1.2, 2.5)  # within the patience for an answer, and behind it
LATE_S = 1.5  # of the test on a busy machine


def known_values(drive):
    """What is read has values of its own, in one frame and in segments."""
    settings = ["current_limit_A", "inductance_H", "resistance_ohm", "torque_constant_Nm_A", "supply_V", "law"]
    return {**{name: drive.settings[name] for name in settings}, **{n: drive.objects.read(0x1018, n) for n in (1, 2, 3)}}


def campaign_of_reads(drive, expected, ended):
    """Wrong values and refusals, and how long the longest read took."""
    wrong, longest_s = [], 0.0
    while not ended.is_set():
        for name, value in expected.items():
            begin, found = time.monotonic(), None
            said = refusal(lambda name=name: wrong.append((name, found)) if (found := (
                drive.objects.read(0x1018, name) if isinstance(name, int) else drive.settings[name])) != value else None)
            longest_s = max(longest_s, time.monotonic() - begin)
            wrong += [(name, said)] if said else []
    return wrong, longest_s


def read_while_it_stands_still(drives, process, seconds):
    expected, ended, results = known_values(drives[0]), threading.Event(), []
    threads = [threading.Thread(target=lambda drive=drive: results.append(campaign_of_reads(drive, expected, ended)))
               for drive in drives]
    for thread in threads:
        thread.start()
    time.sleep(0.2)
    process.send_signal(signal.SIGSTOP)
    time.sleep(seconds)
    process.send_signal(signal.SIGCONT)
    time.sleep(0.5)
    ended.set()
    for thread in threads:
        thread.join()
    for wrong, longest_s in results:
        CHECKS.that(not wrong, f"{len(drives)} read while it stands still for {seconds:g} s: {wrong[:3]}")
        CHECKS.that(longest_s > 0.8 * seconds, f"and one of them waited: {longest_s:.2f} s")


def a_write_is_not_taken_for_accepted(drive, process):
    """One that is refused, behind one that was given up and is answered late: that answer says no more than `written`."""
    before = drive.settings["current_limit_A"]
    process.send_signal(signal.SIGSTOP)
    said = refusal(lambda: drive.objects.write(0x607C, 1), steadystep.LostLink)
    CHECKS.that("does not answer any more" in said, f"the first is given up: {said}")
    process.send_signal(signal.SIGCONT)
    said = refusal(lambda: drive.objects.write(0x6098, 100), steadystep.Refused)
    CHECKS.that("out of range" in said, f"the next is refused: {said}")
    CHECKS.that(drive.settings["current_limit_A"] == before and drive.objects.read(0x607C) == 1, "and all goes on")


def one_that_stands_still_for_good_is_lost(drive, process):
    process.send_signal(signal.SIGSTOP)
    for _ in range(2):
        begin = time.monotonic()
        said = refusal(lambda: drive.position_rad, steadystep.LostLink)
        taken_s = time.monotonic() - begin
        CHECKS.that("the drive does not answer any more" in said, f"it is said: {said}")
        CHECKS.that(taken_s < LOST_S + LATE_S, f"within {LOST_S:g} s: {taken_s:.2f} s")
    begin = time.monotonic()
    process.kill()
    said = refusal(lambda: [drive.position_rad for _ in range(2)], steadystep.LostLink)
    taken_s = time.monotonic() - begin
    CHECKS.that(any(one in said for one in ("the other end is gone", "reset by peer", "Broken pipe")), f"of one that ends, why: {said}")
    CHECKS.that(taken_s < 1.0, f"at once: {taken_s:.2f} s")


with Simulated(program=SIL) as simulated:
    with steadystep.Drive(simulated.place) as DRIVE:
        for stands_still_s in STANDS_STILL_S:
            read_while_it_stands_still([DRIVE], simulated.process, stands_still_s)
        a_write_is_not_taken_for_accepted(DRIVE, simulated.process)
    share = Share(open_line(simulated.place))
    drives = [steadystep.Drive(share.line()) for _ in range(2)]
    for stands_still_s in STANDS_STILL_S:
        read_while_it_stands_still(drives, simulated.process, stands_still_s)
    for one in drives:
        one.close()
    share.close()
    with steadystep.Drive(simulated.place) as DRIVE:
        one_that_stands_still_for_good_is_lost(DRIVE, simulated.process)
CHECKS.end()
