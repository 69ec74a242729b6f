"""Random clients of a served drive for hours: links are cut, the supply fails, faults come, rubbish arrives.

What must not be: a stored setting that is lost, a fault that no emergency says, a rotor that turns half a
second after a supervised master is gone, a node that answers no more. A session is a drive and forty
things that happen to it; each is a line of the journal, with which a campaign that was ended goes on.

usage: campaign.py SIL [--hours H] [--journal FILE] [--jobs N] [--session N]

--jobs sessions are under way at a time: each lasts half as long as it does to its drive, and waits for most
of that. --session repeats one of them, and says what happens in it. exit 1 if anything was that must not be.
"""
import argparse
import concurrent.futures
import itertools
import json
import pathlib
import random
import struct
import sys
import time

from bus_client import BusClient, Lost, MASTER, Refused
from served import Line, Served

SPEED = 2.0
DEEDS = 40
TURN = 65536
SAVE = 0x65766173
HEARTBEAT_LOST = 0x8130
LOST_ms = 400  # of the drive: until a master counts as gone
STOPPED_s = 0.5
STATE, FAULT, READY, ON, ENABLED, OFF = 0x6F, 0x08, 0x21, 0x23, 0x27, 0x40
SETTINGS = {"current_limit_A": (0x2120, 1.5, 3.0), "law_bandwidth_rad_s": (0x2110, 120.0, 200.0)}


class Session:
    def __init__(self, number, talks):
        self.draw, self.talks = random.Random(number), talks
        self.bad, self.counts = [], {}
        self.stored, self.chosen = {}, {}

    def say(self, text):
        if self.talks:
            print(f"  {text}")

    def check(self, condition, what):
        if not condition:
            self.bad.append(what)
            self.say(f"BAD: {what}")

    # ---- the drive's time, and the truth of it ----

    def truth(self):
        said = self.knobs.ask("state")
        end = time.monotonic() + 60.0  # of a machine that does much else
        while not said.startswith("ok time_s=") and time.monotonic() < end:
            said = self.knobs.read()
        return {word.split("=")[0]: float(word.split("=")[1]) for word in said.split()[1:4]}

    def pass_time(self, seconds):
        end = self.truth()["time_s"] + seconds
        while self.truth()["time_s"] < end:
            if self.client:
                self.client.pump(0.01)
            else:
                time.sleep(0.01)

    def comes(self, condition, seconds):
        """Whether it has come true in so many of the drive's seconds."""
        end = self.truth()["time_s"] + seconds
        while self.truth()["time_s"] < end:
            if condition():
                return True
            self.client.pump(0.005)
        return condition()

    # ---- what happens ----

    def connect(self):
        self.client = BusClient(self.place)
        self.client.send(b"t00020101\r")
        self.check(struct.unpack("<I", self.client.read(0x1000))[0] == 0x00040192, "it answers")

    def cut(self):
        self.client.close()
        self.client = None

    def enable(self, mode):
        """Of a rotor at rest: without an encoder one that coasts is not found."""
        self.client.control(0x80)
        self.client.control(0x00)
        self.check(self.comes(lambda: self.client.status() & STATE == OFF, 1.0), "it can be switched off")
        self.comes(lambda: abs(self.truth()["omega_rad_s"]) < 0.1, 10.0)
        heard = len(self.client.emergencies)
        for word, wanted in ((0x06, READY), (0x07, ON), (0x0F, ENABLED)):
            self.client.control(word)
            if not self.comes(lambda wanted=wanted: self.client.status() & STATE in (wanted, FAULT), 3.0):
                # this process may not have been run for so long that the drive missed its heartbeat
                late = HEARTBEAT_LOST in self.client.emergencies[heard:]
                self.check(late, f"state {wanted:02x} comes, not {self.client.status():04x}")
        self.client.put(0x6060, mode, "<b")
        return self.client.status() & STATE == ENABLED

    def settings_are_set(self):
        name = self.draw.choice(list(SETTINGS))
        index, least, most = SETTINGS[name]
        value = round(self.draw.uniform(least, most), 3)
        try:
            self.client.put(index, value, "<d")
            self.chosen[name] = value
        except Refused as refusal:
            self.check(refusal.code == 0x08000022, f"{name}: {refusal}")

    def they_are_stored(self):
        try:
            self.client.put(0x1010, SAVE, "<I", 1)
            self.stored = dict(self.chosen)
        except Refused as refusal:
            self.check(self.client.status() & STATE not in (OFF, READY), f"store: {refusal}")

    def the_supply_fails(self):
        self.knobs.ask('command = "power-cycle"')
        self.cut()
        self.connect()
        self.chosen = dict(self.stored)
        for name, value in self.stored.items():
            now = self.client.number(SETTINGS[name][0], form="<d")
            self.check(now == value, f"{name} was stored as {value} and is {now}")

    def it_moves(self):
        if self.enable(1):
            self.knobs.ask(f"load_torque_Nm = {self.draw.uniform(-0.05, 0.05):.3f}")
            self.client.put(0x607A, self.draw.randrange(-4 * TURN, 4 * TURN))
            self.client.control(0x1F)
            self.client.control(0x0F)
            self.pass_time(self.draw.uniform(0.0, 0.5))
            self.knobs.ask("load_torque_Nm = 0")

    def it_turns(self):
        if self.enable(3):
            self.client.put(0x60FF, self.draw.randrange(-5 * TURN, 5 * TURN))
            self.pass_time(self.draw.uniform(0.0, 0.5))

    def its_bus_sags(self):
        if not self.enable(1):
            return
        heard = len(self.client.emergencies)
        self.knobs.ask("plant.bus_V = 8")
        self.check(self.comes(lambda: self.client.status() & STATE == FAULT, 1.0), "a sagging bus is a fault")
        self.check(self.comes(lambda: 0x3200 in self.client.emergencies[heard:], 1.0),
                   f"an emergency says it: {self.client.emergencies[heard:]}, {self.client.number(0x603F, form='<H'):04x}")
        self.knobs.ask("plant.bus_V = 24")
        self.pass_time(0.05)
        self.client.control(0x80)

    def the_master_is_gone(self):
        self.client.put(0x1016, MASTER << 16 | LOST_ms, "<I", 1)
        self.client.supervised = True
        self.draw.choice((self.it_turns, self.it_moves))()
        on = "state=switch-on-disabled" not in self.knobs.ask("state")
        self.cut()
        self.pass_time(1e-3 * LOST_ms + STOPPED_s)
        before, state = self.truth()["theta_rad"], self.knobs.ask("state")
        self.say(state)
        self.pass_time(0.3)
        off = abs(self.truth()["theta_rad"] - before)
        # a rotor that coasts because the client switched off, or was late before, has no master
        self.check(off < 0.015 or not on,
                   f"it turns by {off:.3f} rad, {STOPPED_s} s after its master is gone: {state}")
        self.connect()

    def a_client_leaves(self):
        self.draw.choice((self.it_turns, self.it_moves))()
        self.cut()
        self.connect()
        self.pass_time(1.0)
        before = self.truth()["theta_rad"]
        self.pass_time(0.3)
        off = abs(self.truth()["theta_rad"] - before)
        self.check(off < 0.05, f"who comes finds it turning: {off:.3f} rad, {self.client.status():04x}")

    def rubbish_comes(self):
        for _ in range(self.draw.randrange(1, 200)):
            self.client.send(bytes(self.draw.choice(b"tTrRsz0123456789abcdefABDEF \x18\x00")
                                   for _ in range(self.draw.randrange(30))) + b"\r")
            self.client.pump(0.0)
        self.client.pump(0.2)

    def faults_are_said(self):
        """Of a drive in fault, whatever it was: the list of errors is not empty, nor the register."""
        if self.client.status() & STATE == FAULT:
            self.pass_time(0.01)
            self.check(self.client.read(0x1001)[0] != 0 and self.client.number(0x1003, 1) != 0
                       and self.client.number(0x603F, form="<H") != 0, "a fault is in the list")

    def run(self, sil_arguments=()):
        deeds = (self.settings_are_set, self.settings_are_set, self.they_are_stored, self.the_supply_fails,
                 self.it_moves, self.it_turns, self.its_bus_sags, self.the_master_is_gone,
                 self.a_client_leaves, self.rubbish_comes)
        with Served("--speed", SPEED, *sil_arguments) as served:
            self.place, self.knobs = str(served.link), Line(str(served.knobs_link))
            self.connect()
            for _ in range(DEEDS):
                deed = self.draw.choice(deeds)
                self.say(f"{self.truth()['time_s']:8.3f} s  {deed.__name__}")
                self.counts[deed.__name__] = self.counts.get(deed.__name__, 0) + 1
                try:
                    deed()
                    self.faults_are_said()
                except (Lost, Refused, IndexError) as trouble:
                    self.check(False, f"{deed.__name__}: {trouble!r}")
                    self.knobs.rest = b""
                    if self.client:
                        self.cut()
                    self.connect()
            lasted_s = self.truth()["time_s"]
            self.cut()
            self.knobs.close()
        return lasted_s


def read_journal(file):
    return [json.loads(line) for line in file.read_text().splitlines()] if file.exists() else []


def summary(lines):
    deeds = sum(sum(line["deeds"].values()) for line in lines)
    bad = sum(len(line["bad"]) for line in lines)
    return f"{len(lines)} sessions, {sum(line['drive_s'] for line in lines) / 3600:.2f} h, {deeds} deeds, {bad} bad"


def session_line(number):
    session = Session(number, False)
    lasted_s = session.run()
    return {"session": number, "drive_s": lasted_s, "deeds": session.counts, "bad": session.bad}


def until_it_lasted(lines, drive_s, jobs):
    """Lines of new sessions, as they end."""
    done = {line["session"] for line in lines}
    numbers = (number for number in itertools.count() if number not in done)
    lasted_s = sum(line["drive_s"] for line in lines)
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        running = set()
        while lasted_s < drive_s or running:
            while lasted_s < drive_s and len(running) < jobs:
                running.add(pool.submit(session_line, next(numbers)))
            ended, running = concurrent.futures.wait(running, return_when=concurrent.futures.FIRST_COMPLETED)
            for line in (session.result() for session in ended):
                lasted_s += line["drive_s"]
                yield line


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawTextHelpFormatter)
    parser.add_argument("sil")
    parser.add_argument("--hours", type=float, default=24.0, help="of the drive's time, in all")
    parser.add_argument("--journal", type=pathlib.Path, default=pathlib.Path("build/link-campaign.jsonl"))
    parser.add_argument("--jobs", type=int, default=1)
    parser.add_argument("--session", type=int)
    options = parser.parse_args()
    if options.session is not None:
        session = Session(options.session, True)
        session.run()
        return 1 if session.bad else 0
    lines = read_journal(options.journal)
    for line in until_it_lasted(lines, 3600 * options.hours, options.jobs):
        lines.append(line)
        with options.journal.open("a") as journal:
            journal.write(json.dumps(line) + "\n")
        print(f"{summary(lines)}{''.join('; ' + bad for bad in line['bad'])}", flush=True)
    print(summary(lines))
    return 1 if any(line["bad"] for line in lines) else 0


if __name__ == "__main__":
    sys.exit(main())
