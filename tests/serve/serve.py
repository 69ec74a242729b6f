"""The served drive: its console on a pseudo-terminal and on TCP, its knobs, its time, its end.

usage: serve.py SIL
"""
import contextlib
import os
import signal
import subprocess
import time

from served import SIL, Checks, Line, Served

CHECKS = Checks()


def value_of(line, name):
    return float(line.split(f"{name}=")[1].split()[0])


def a_drive_moves_as_on_a_table(served):
    drive, knobs = Line(str(served.link)), Line(str(served.knobs_link))
    drive.send("state\n")
    CHECKS.that(drive.until("ok switch-on-disabled"), "the console answers")
    drive.send("enable\n")
    CHECKS.that(drive.until("ready:"), "it becomes ready")
    CHECKS.that(drive.ask("move 1.5").startswith("ok move"), "it takes a move")
    time.sleep(0.5)
    CHECKS.that(abs(value_of(knobs.ask("state"), "theta_rad") - 1.5) < 0.01, "it has moved")
    drive.close()
    knobs.close()


def a_client_that_comes_back_reads_nothing_old(served):
    first = Line(str(served.link))
    first.send("help\n")
    time.sleep(0.2)
    first.close()
    time.sleep(0.1)
    second = Line(str(served.link))
    CHECKS.that(second.ask("cycles").startswith("ok cycles"), "the answer is its own")
    second.close()


def tcp_carries_the_same(served):
    drive, knobs = Line(served.serial[-1]), Line(served.knobs[-1])
    CHECKS.that(drive.ask("state").startswith("ok operation-enabled"), "the console answers on TCP")
    CHECKS.that(knobs.ask("state").startswith("ok time_s="), "the knobs answer on TCP")
    drive.close()
    drive = Line(served.serial[-1])
    CHECKS.that(drive.ask("get law").startswith("ok get law"), "and the next client, too")
    drive.close()
    knobs.close()


def a_browser_is_not_heard(served):
    """A page of any origin makes it send lines of its own behind the head of a request."""
    for place, line in ((served.serial[-1], "\rC\renable\n"), (served.knobs[-1], "plant.bus_V = 8\n")):
        for head in ("POST / HTTP/1.1\r\n\r\n", "P", "GET "):
            browser = Line(place)
            browser.send(head)
            time.sleep(0.02)
            with contextlib.suppress(OSError):
                browser.send(("OST " if head == "P" else "") + line)
            try:
                said = browser.socket.recv(100)
            except OSError:
                said = b""
            CHECKS.that(said == b"", f"{head!r}: its line is closed: {said}")
            browser.close()
    knobs = Line(served.knobs[-1])
    CHECKS.that("state=switch-on-disabled fault=none" in knobs.ask("state"), "and nothing of it acts")
    knobs.close()


def a_flood_is_lost_as_on_a_wire():
    """SYNCs, for each of which the drive would send: more than it reads of."""
    with Served() as served:
        line = Line(served.serial[-1])
        line.send("\rS6\rO\r")
        line.socket.setblocking(False)
        end = time.monotonic() + 1.5
        while time.monotonic() < end and served.process.poll() is None:
            with contextlib.suppress(OSError):
                line.send("t0800\r" * 100)
            with contextlib.suppress(OSError):
                line.socket.recv(65536)
        line.close()
        CHECKS.that(served.process.poll() is None, f"it goes on: {served.process.poll()}")
        line = Line(str(served.link))
        end, said = time.monotonic() + 10, ""
        while not said and time.monotonic() < end:  # what came before is being read yet, or this is lost, too
            line.send("\rC\r\nstate\nstate\n")
            said = line.until("ok switch-on-disabled", 0.3)
        CHECKS.that(said != "", "and answers")
        line.close()


def knobs_do_what_events_do(served):
    drive, knobs = Line(served.serial[-1]), Line(served.knobs[-1])
    CHECKS.that(knobs.ask("load_torque_Nm = 0.05, ramp_s = 0.1").startswith("ok time_s="), "a load")
    time.sleep(0.3)
    CHECKS.that(abs(value_of(knobs.ask("state"), "load_torque_Nm") - 0.05) < 1e-6, "is on it")
    CHECKS.that(knobs.ask("load_torque_Nm = 0").startswith("ok"), "and goes")
    CHECKS.that(knobs.ask("plant.bus_V = 8").startswith("ok"), "the supply sags")
    CHECKS.that(drive.until("fault: bus-voltage"), "which the drive sees")
    CHECKS.that(knobs.ask("plant.bus_V = 24").startswith("ok"), "and comes back")
    for bad, said in (("load_torque_Nm = 1000", "load_torque_Nm: expected"),
                      ("jam", "error:"), ("open_phase = \"c\"", "one of a, b"),
                      ("command = \"enable\"", "serial line"), ("x = 1 } ]\ny = 3", "error:")):
        answer = knobs.ask(bad)
        CHECKS.that(answer.startswith("error: ") and said in answer, f"{bad}: {answer}")
    knobs.until("error", 0.2)
    drive.close()
    knobs.close()


def a_switch_on_the_wires_is_obeyed(served):
    drive, knobs = Line(str(served.link)), Line(served.knobs[-1])
    drive.send("set inputs_used 10\nset inputs_low 2\n")
    drive.until("ok set inputs_low")
    CHECKS.that(value_of(knobs.ask("state"), "outputs") == 0, "off: the brake holds")
    drive.send("enable\n")
    CHECKS.that(drive.until("ready:"), "it becomes ready")
    time.sleep(0.1)
    CHECKS.that(value_of(knobs.ask("state"), "outputs") == 6, "in position, the brake is released")
    CHECKS.that(knobs.ask("inputs = 29").startswith("ok"), "a limit switch")
    time.sleep(0.1)
    CHECKS.that("limit switch + is active" in drive.ask("move 100"), "refuses")
    CHECKS.that(knobs.ask("inputs = 23").startswith("ok"), "the enable switch")
    CHECKS.that(drive.until("warning: stop: the enable input is not active"), "at rest it is said, too")
    time.sleep(0.2)
    CHECKS.that(drive.ask("state").startswith("ok switch-on-disabled"), "switches off")
    CHECKS.that(knobs.ask("inputs = 32").startswith("error: "), "there are five")
    knobs.ask("inputs = 31")
    drive.send("set inputs_used 0\n")
    drive.until("ok set inputs_used")
    drive.close()
    knobs.close()


def a_power_cycle_keeps_what_was_stored(served):
    drive, knobs = Line(str(served.link)), Line(served.knobs[-1])
    drive.send("disable\nset current_limit_A 2\nset law_bandwidth_rad_s 180\n")
    drive.until("ok set law_bandwidth")
    CHECKS.that(drive.ask("store") == "ok store", "it stores")
    drive.ask("set current_limit_A 1")
    CHECKS.that(knobs.ask("command = \"power-cycle\"").startswith("ok"), "the supply fails")
    CHECKS.that("steadystep" in drive.read(), "it announces itself anew")
    CHECKS.that(drive.ask("get current_limit_A").startswith("ok get current_limit_A=2 A"),
                "what was stored is in force")
    CHECKS.that("=180 " in drive.ask("get law_bandwidth_rad_s"), "all of it")
    drive.close()
    knobs.close()


def it_ends_in_order(number):
    with Served("--speed", "20") as served:
        time.sleep(0.3)
        code, said, complaint = served.end(number)
        words = said.split()
        CHECKS.that(code == 0 and complaint == "", f"{code} {complaint}")
        CHECKS.that(words[0] == "served" and float(words[1]) > 10 * float(words[4]),
                    f"twenty times as fast, or nearly: {said}")
        CHECKS.that(not os.path.lexists(served.link), "no link stays")


def what_cannot_be_had_is_said():
    for arguments, said in ((["--link", "/nowhere/at/all"], "/nowhere/at/all: No such file"),
                            (["--speed", "0"], "--speed"), (["no-such-scenario"], "no-such"),
                            (["--set", "motor=nothing"], "nothing")):
        done = subprocess.run([SIL, "serve", *arguments], capture_output=True, text=True,
                              timeout=20, check=False)
        CHECKS.that(done.returncode == 2 and said in done.stderr and done.stderr.count("\n") == 1,
                    f"{arguments}: {done.returncode} {done.stderr}")


with Served() as one:
    a_browser_is_not_heard(one)
    a_drive_moves_as_on_a_table(one)
    a_client_that_comes_back_reads_nothing_old(one)
    tcp_carries_the_same(one)
    knobs_do_what_events_do(one)
    a_power_cycle_keeps_what_was_stored(one)
    a_switch_on_the_wires_is_obeyed(one)
a_flood_is_lost_as_on_a_wire()
it_ends_in_order(signal.SIGTERM)
it_ends_in_order(signal.SIGINT)
what_cannot_be_had_is_said()
CHECKS.end()
