"""The package `steadystep` operates a served drive: settings, motion, faults, captures, and what it says
when something is wrong.

usage: package.py SIL
"""
import csv
import math
import pathlib
import re
import signal
import sys
import tempfile
import threading
import time
import tomllib

from operated import PACKAGE, Simulated, refusal, steadystep
from served import Checks, Served
from steadystep import capture_in_drive
from steadystep.capture import record
from steadystep.capture_files import TOPIC

CHECKS = Checks()
SIL = sys.argv[1]


def settings_go_out_and_come_back(drive):
    text = drive.settings.export()
    CHECKS.that("current_limit_A = 3.0  # A\n" in text and 'law = "state-feedback"\n' in text, text)
    changed = drive.settings.load(text.replace("current_limit_A = 3.0", "current_limit_A = 2.5"))
    CHECKS.that(changed == ["current_limit_A"], f"only what differs is written: {changed}")
    CHECKS.that(drive.settings["current_limit_A"] == 2.5, "it is in force")
    drive.settings.default("current_limit_A")
    CHECKS.that(drive.settings.export() == text, "taken back, all is as before")
    drive.settings.load('law_gains.rho_per_s = 100.0\nlaw = "foc"\n')
    CHECKS.that("law_gains.rho_per_s = 100.0\n" in drive.settings.export(), "gains by their names")
    drive.settings.load(text)
    drive.settings.default("law_gains")
    CHECKS.that(drive.settings.export() == text, "and the law before")


def what_nobody_has_given_is_not_exported(drive):
    """It has followed another motor, and is not this one's before it is enabled."""
    text = drive.settings.export()
    followed = [name for name, row in drive.known.settings.items() if row.follows and row.elements == 1]
    followed.remove("speed_limit_rad_s")  # the drive always gives that
    CHECKS.that(all(f"{name} = nan" in text for name in followed), text)
    CHECKS.that(drive.settings.load(text) == [], "to what follows it is no change")
    drive.settings["hold_current_A"] = 1.5
    given = drive.settings.export()
    CHECKS.that("hold_current_A = 1.5  # A\n" in given and "idle_current_A = nan  # A\n" in given, "what is given is")
    CHECKS.that(drive.settings.load(text) == ["hold_current_A"], "and comes back as not given")
    speed_limit = drive.settings["speed_limit_rad_s"]
    drive.settings.take_motor("17hs4417")
    CHECKS.that(drive.settings["speed_limit_rad_s"] != speed_limit, "a limit that the drive computes is computed anew")
    of_motor = drive.settings.export()
    CHECKS.that("hold_current_A = nan  # A\n" in of_motor, of_motor)
    drive.settings.load(text)
    drive.enable()
    CHECKS.that("hold_current_A = 3.0  # A; given, or what followed at the last enable\n" in drive.settings.export(),
                "an enabled drive does not say")
    CHECKS.that(drive.settings.load(drive.settings.export()) == [], "and takes it back")
    CHECKS.that("disable first" in refusal(lambda: drive.settings.load(text)), "but nothing that is not given")
    drive.disable()
    CHECKS.that(drive.state != "OPERATION ENABLED" and drive.settings.export() == text, "off it says so again")


def what_is_no_setting_is_refused(drive, folder):
    for name, value, said in (("current_limit_A", 100.0, "0.01 × rated…2 × rated A, got 100.0"),
                              ("law", "best", "one of state-feedback, pid"),
                              ("curent_limit_A", 1.0, "is it current_limit_A"),
                              ("rotor_teeth", 1.5, "a whole number"), ("feed_forward", 1, "true, false")):
        found = refusal(lambda name=name, value=value: drive.settings.__setitem__(name, value))
        CHECKS.that(said in found, f"{name} = {value}: {found}")
    before = drive.settings["current_limit_A"]
    for text, said in (("current_limit_A = 1.0\nlaw = best", "drive.toml:2: "),
                       ("current_limit_A = 1.0\n\nnode_id = 1000", "drive.toml:3: node_id"),
                       ("current_limit_A = 1.0\ncurrent = 1.0", "drive.toml:2: current: no such setting"),
                       ("law_gains.nothing = 1.0", "drive.toml:1: law_gains.nothing")):
        found = refusal(lambda text=text: drive.settings.load(text, "drive.toml"))
        CHECKS.that(found.startswith(said), f"{text}: {found}")
        CHECKS.that(drive.settings["current_limit_A"] == before, f"{text}: is read as a whole")
    for text, said in (("current_limit_A = 0.5\nrated_current_A = 0.4\nhold_current_A = 0.5", "drive.toml:3: hold_current_A"),
                       ("current_limit_A = 1.0\nlaw = \"foc\"\nlaw_gains.nothing = 1.0", "drive.toml:3: law_gains.nothing"),
                       ("current_limit_A = 1.0\nrotor_teeth = 1000000000000", "drive.toml:2: rotor_teeth: expected a whole")):
        found = refusal(lambda text=text: drive.settings.load(text, "drive.toml"))
        CHECKS.that(found.startswith(said) and found.endswith("nothing has been set"), f"{text}: {found}")
        CHECKS.that(drive.settings["current_limit_A"] == before, f"{text}: nothing is")
    found = refusal(lambda: drive.settings.__setitem__("rotor_teeth", 10**12))
    CHECKS.that("rotor_teeth: expected a whole number in" in found, f"more than the object holds: {found}")
    (folder / "binary.toml").write_bytes(b"\xff\xfe\x00")
    found = refusal(lambda: drive.settings.load_file(folder / "binary.toml"))
    CHECKS.that(found.startswith(f"{folder / 'binary.toml'}: expected settings as text"), found)


def a_motor_takes_back_what_was_given_for_another(drive):
    text = drive.settings.export()
    for name, value in (("current_limit_A", 3.0), ("law_bandwidth_rad_s", 100.0), ("feed_forward", False)):
        drive.settings[name] = value
    drive.settings.take_motor("14hs10-0404s")
    CHECKS.that(drive.settings["current_limit_A"] == drive.settings["rated_current_A"] == 0.4, "the limit is the new motor's")
    CHECKS.that(drive.settings["law_bandwidth_rad_s"] != 100.0, "what follows from a motor follows this one")
    CHECKS.that(drive.settings["feed_forward"] is False, "and nothing else is touched")
    drive.settings.load(text)
    drive.settings.default("law_bandwidth_rad_s")


def numbers_of_numpy_are_numbers(drive):
    """Its scalars and arrays, or what looks so."""
    class Scalar:
        def __init__(self, value):
            self.value = value

        def item(self):
            return self.value

    for name, value in (("current_limit_A", 2.5), ("rotor_teeth", 50), ("feed_forward", True)):
        drive.settings[name] = Scalar(value)
        CHECKS.that(drive.settings[name] == value, f"{name}: {drive.settings[name]}")
    drive.settings["detent_torque_Nm"] = tuple(Scalar(0.0) for _ in range(6))
    drive.settings.default("current_limit_A")


def a_torque_is_a_drive_s_with_an_encoder(drive):
    found = refusal(lambda: drive.torque(0.1))
    CHECKS.that("without an encoder" in found, f"without one: {found}")
    with Served("torque") as served, steadystep.Drive(str(served.link)) as drive:  # the scenario's drive
        drive.enable()
        drive.torque(0.1, speed_rad_s=10 * math.pi)
        time.sleep(0.3)
        CHECKS.that(abs(drive.speed_rad_s - 10 * math.pi) < 0.5, f"up to its speed: {drive.speed_rad_s}")
        drive.torque(-0.1)
        time.sleep(0.3)
        CHECKS.that(abs(drive.speed_rad_s + 10 * math.pi) < 0.5, f"and back: {drive.speed_rad_s}")
        CHECKS.that("torque_Nm" in refusal(lambda: drive.torque(100.0)), "not any")
        CHECKS.that("speed_rad_s" in refusal(lambda: drive.torque(0.1, speed_rad_s=0)), "nor up to no speed")
        drive.stop()
        CHECKS.that(abs(drive.speed_rad_s) < 2, f"it stops: {drive.speed_rad_s}")
        drive.enable()
        time.sleep(0.1)
        CHECKS.that(abs(drive.speed_rad_s) < 2, f"enabled again nothing pushes it: {drive.speed_rad_s}")
        drive.move(1.0)
        CHECKS.that(abs(drive.position_rad - 1.0) < 0.01, "and moves")


def it_moves(drive, knobs):
    CHECKS.that("enable it first" in refusal(lambda: drive.move(1.0)), "off it does not move")
    seen = []
    drive.enable(progress=lambda what, share: seen.append(share))
    CHECKS.that(seen[-1] == 1.0 and len(seen) > 3, f"enabling shows its progress: {len(seen)}")
    drive.move(1.5)
    CHECKS.that(abs(float(knobs.truth()["theta_rad"]) - 1.5) < 0.01, "the rotor goes to its target")
    drive.move(-0.5, relative=True, speed_rad_s=20, acceleration_rad_s2=2000)
    CHECKS.that(abs(drive.position_rad - 1.0) < 0.01, f"and on from there: {drive.position_rad}")
    drive.move(1000.0, speed_rad_s=20, wait=False)
    time.sleep(0.1)
    drive.move(1.0)
    CHECKS.that(abs(drive.position_rad - 1.0) < 0.01, "a newer target counts at once")
    found = refusal(lambda: drive.velocity(1e9))
    CHECKS.that(found.startswith("speed_rad_s: expected a number in ±"), found)
    drive.velocity(10, wait=True)
    CHECKS.that(abs(float(drive.read("omega_ref_rad_s")) - 10) < 0.1, "it turns at a speed")
    drive.stop()
    CHECKS.that(drive.state == "QUICK STOP ACTIVE" and not drive.read("reference_moving"), "it stops")
    CHECKS.that("enable it first" in refusal(lambda: drive.move(1.0)), "and stays so")
    drive.enable()
    time.sleep(0.1)
    CHECKS.that(not drive.read("reference_moving"), "enabled again it does not go on")
    drive.set_position(0.0)
    drive.move(0.2, relative=True)
    CHECKS.that(abs(drive.position_rad - 0.2) < 0.01, f"from a new zero: {drive.position_rad}")
    drive.command("sine", amplitude_rad=0.1, frequency_Hz=5)
    time.sleep(0.1)
    CHECKS.that(drive.read("reference_moving") is True, "any command by its name")
    drive.stop()
    for parameters, said in (({"amplitude_rad": 0.1}, "frequency_Hz is missing"),
                             ({"amplitude": 0.1}, "no parameter amplitude"),
                             ({"amplitude_rad": 1e9, "frequency_Hz": 5}, "amplitude_rad: expected")):
        found = refusal(lambda parameters=parameters: drive.command("sine", **parameters))
        CHECKS.that(said in found, f"sine {parameters}: {found}")
    drive.enable()
    drive.objects.send_controlword(steadystep.axis.QUICK_STOP)  # of a stop what comes first
    time.sleep(0.3)
    CHECKS.that(drive.state == "QUICK STOP ACTIVE", f"a rotor at rest is held on: {drive.state}")
    drive.enable()


def it_is_homed(drive, knobs):
    """On a stop above, and where it stands; on nothing it is not."""
    drive.move(0.0)
    stop = float(knobs.truth()["theta_rad"]) + 0.5
    knobs.turn(f"stops = true, stop_high_rad = {stop}")
    seen = []
    drive.home("stop-up", 2.0, progress=lambda what, share: seen.append(what))
    off = drive.position_rad - 2.0 - (float(knobs.truth()["theta_rad"]) - stop)
    CHECKS.that(abs(off) < 0.01, f"the stop is at 2 rad: {off}")
    CHECKS.that(drive.read("position_reference") == "referenced" and set(seen) == {"homing"}, "and it is homed")
    knobs.turn("stops = false")
    found = refusal(lambda: drive.home("stop-down", travel_rad=0.3), steadystep.NotHomed)
    CHECKS.that("within its travel" in found, f"no stop: {found}")
    found = refusal(lambda: drive.home("index-up"), steadystep.NotHomed)
    CHECKS.that("no encoder with an index" in found, f"no index: {found}")
    found = refusal(lambda: drive.home("stop-down", travel_rad=9, speed_rad_s=5, timeout_s=0.2), steadystep.TimedOut)
    CHECKS.that("0.2 s" in found, f"in time: {found}")
    for method, more, said in (("up", {}, "one of here, stop-down"), ("here", {"position_rad": 1e9}, "position_rad: expected"),
                               ("stop-up", {"torque_share": 0}, "torque_share"), ("stop-up", {"travel_rad": math.nan}, "travel_rad")):
        found = refusal(lambda method=method, more=more: drive.home(method, **more), steadystep.Refused)
        CHECKS.that(said in found, f"{method} {more}: {found}")
    drive.home("here")
    CHECKS.that(abs(drive.position_rad) < 0.01, f"here is 0: {drive.position_rad}")


def parquet_has_what_csv_has(made, path, rows):
    import pyarrow.parquet

    made.save(path)
    table = pyarrow.parquet.read_table(path)
    CHECKS.that(table.column_names == list(rows[0]), f"the columns of the CSV: {table.column_names}")
    units = {"time_s": "s", **{signal.name: signal.unit for signal in made.signals}}
    for name in table.column_names:
        CHECKS.that([f"{value:.12g}" for value in table[name].to_pylist()] == [f"{float(row[name]):.12g}" for row in rows],
                    f"the values of {name}")
        CHECKS.that(table.field(name).metadata[b"unit"].decode() == units[name], f"and its unit, {units[name]}")


def without_its_package_a_format_says_so(made, folder):
    for package, suffix in (("pyarrow", ".parquet"), ("mcap.writer", ".mcap")):
        there, sys.modules[package] = sys.modules.pop(package, None), None
        found = refusal(lambda suffix=suffix: made.save(folder / f"none{suffix}"))
        del sys.modules[package]
        if there:
            sys.modules[package] = there
        needed = package.split(".", maxsplit=1)[0]
        CHECKS.that(found.startswith(f"{suffix} needs the package {needed}: pip install {needed} ("), found)
        CHECKS.that(not (folder / f"none{suffix}").exists(), "and leaves no file")


def layouts_name_signals_of_the_drive():
    """By name, and on the topic that captures have."""
    known = {signal.name for signal in steadystep.dictionary().signals.values()}
    for file, separator in (("foxglove.json", "."), ("plotjuggler.xml", "/")):
        text = (PACKAGE / "layouts" / file).read_text(encoding="utf-8")
        shown = re.findall(rf'"{TOPIC}{re.escape(separator)}(\w+)"', text)
        CHECKS.that(len(shown) == 7 and shown == [name for name in shown if name in known], f"{file}: {shown}")
        CHECKS.that(len(shown) == text.count(TOPIC), f"{file} has nothing else of {TOPIC}")


def it_captures(drive, folder):
    names = ["theta_est_rad", "load_torque_est_Nm", "i_q_A", "bus_V", "synchronism"]
    for count, least_Hz in ((3, 50), (5, 5)):  # the fourth real number comes by SDO
        drive.move(2.0, relative=True, wait=False, speed_rad_s=3)
        made = drive.capture(names[:count], 0.4, 200, recorder=record)
        CHECKS.that(made.rate_Hz > least_Hz, f"{count} signals at {made.rate_Hz:.0f} Hz")
        CHECKS.that(made["theta_est_rad"][-1] - made["theta_est_rad"][0] > 0.3, "it shows the motion")
        drive.wait()
    CHECKS.that(0.2 < made.time_s[-1] < 0.6, f"in the drive's time: {made.time_s[-1]}")
    CHECKS.that(abs(made["bus_V"][0] - 24) < 1, f"the supply: {made['bus_V'][0]}")
    made.save(folder / "move.csv")
    with (folder / "move.csv").open(encoding="utf-8") as file:
        rows = list(csv.DictReader(file))
    CHECKS.that(len(rows) == len(made) and set(rows[0]) == {"time_s", *names}, "written as CSV")
    parquet_has_what_csv_has(made, folder / "move.parquet", rows)
    made.save(folder / "move.mcap")
    from mcap.reader import make_reader
    with (folder / "move.mcap").open("rb") as file:
        messages = list(make_reader(file).iter_messages())
    CHECKS.that(len(messages) == len(made) and messages[0][1].topic == "/drive", "and as MCAP")
    without_its_package_a_format_says_so(made, folder)
    CHECKS.that("expected a name that ends with .csv" in refusal(lambda: made.save(folder / "a.xls")), "else")
    CHECKS.that("is it" in refusal(lambda: drive.capture(["theta_est"], 1)), "an unknown signal")


def what_the_drive_records_itself(drive):
    """Every interrupt, around the begin of a move, where the drive has that."""
    if not capture_in_drive.is_there(drive.objects):
        found = refusal(lambda: drive.capture(["period"], 0.1, trigger=steadystep.Trigger("reference_moving")))
        CHECKS.that("knows no trigger" in found, found)
        return
    names = ["theta_ref_rad", "theta_est_rad", "reference_moving", "period", "fault"]

    def moves_when_it_waits():
        while drive.objects.read(capture_in_drive.CONTROL, capture_in_drive.ARM) == capture_in_drive.OFF:
            time.sleep(0.01)
        time.sleep(0.1)  # of the drive's memory before the trigger
        drive.move(1.0, relative=True, wait=False)

    mover = threading.Thread(target=moves_when_it_waits)
    mover.start()
    made = drive.capture(names, 0.05, 10000, trigger=steadystep.Trigger("reference_moving", before_s=0.01))
    mover.join()
    CHECKS.that(len(made) == 500 and made.time_s[0] == -0.01 and abs(made.rate_Hz - 10000) < 1, f"{len(made)} samples")
    periods = made["period"]
    CHECKS.that(all(b - a == 1 for a, b in zip(periods, periods[1:])), "none is left out")
    begin = made["reference_moving"].index(1.0)
    CHECKS.that(abs(made.time_s[begin]) <= 1e-4, f"the time counts from the trigger: {made.time_s[begin]}")
    drive.wait()
    found = refusal(lambda: drive.capture(names, 10, 10000, trigger=steadystep.Trigger("reference_moving")))
    CHECKS.that("memory does not hold 100000 samples" in found, found)
    found = refusal(lambda: drive.capture(["period"], 0.1, trigger=steadystep.Trigger("reference_moving", timeout_s=0.1)),
                    steadystep.TimedOut)
    CHECKS.that("reference_moving has not risen above 0.5 within 0.1 s" in found, found)


def the_recorder_is_one_program_s(drive):
    """Another one has armed it, has left what it has recorded, or takes it in the midst of a capture."""
    control, signals, arm = capture_in_drive.CONTROL, capture_in_drive.SIGNALS, capture_in_drive.ARM

    def another_arms(index, trigger, samples=10):
        for sub, value in ((arm, capture_in_drive.OFF), (capture_in_drive.TRIGGER, trigger), (capture_in_drive.DIVIDER, 1),
                           (capture_in_drive.BEFORE, 0), (capture_in_drive.SAMPLES, samples)):
            drive.objects.write(control, value, sub)
        for n in range(8):
            drive.objects.write(signals, index if n == 0 else 0, n + 1)
        drive.objects.write(control, capture_in_drive.ON, arm)

    bus_V, moving, period = (drive.known.signal(name).index for name in ("bus_V", "reference_moving", "period"))
    another_arms(bus_V, moving)
    found = refusal(lambda: drive.capture(["period"], 0.01), steadystep.Refused)
    CHECKS.that("records for another program" in found, f"it waits for that one's trigger: {found}")
    CHECKS.that(drive.objects.read(control, arm) == 2 and drive.objects.read(signals, 1) == bus_V, "and goes on with that")
    CHECKS.that(len(drive.capture(["period"], 0.01, preempt=True)) == 10, "unless it is preempted")
    another_arms(bus_V, 0)
    time.sleep(0.1)
    made = drive.capture(["period"], 0.01)
    CHECKS.that(made["period"][1] - made["period"][0] == 10, f"what was left undone is no hindrance: {made['period']}")
    for what, index, samples in (("of another signal", bus_V, 10), ("of another length", period, 20)):
        found = refusal(lambda index=index, samples=samples: drive.capture(
            ["period"], 0.01, armed=lambda: another_arms(index, 0, samples)), steadystep.Refused)
        CHECKS.that("another program has taken the drive's recorder" in found, f"{what}: {found}")
        CHECKS.that(drive.objects.read(control, arm) == capture_in_drive.DONE, "it has its own")
    drive.objects.write(control, capture_in_drive.OFF, arm)
    found = refusal(lambda: drive.capture(["period"], 0.1, trigger=steadystep.Trigger("reference_moving", before_s=-1)))
    CHECKS.that("before_s: expected a number in 0…0.1 s" in found, found)


def what_is_asked_for_lasts_as_long(drive):
    """More quickly than the link carries it, all the same."""
    made = drive.capture(["theta_est_rad"], 0.5, 1e5, recorder=record)
    CHECKS.that(0.5 <= made.time_s[-1] < 0.7 and made.rate_Hz > 50, f"{made.time_s[-1]} s, {made.rate_Hz:.0f} Hz")
    begun = []
    drive.capture(["period"], 0.05, 200, armed=lambda: begun.append(True))
    drive.capture(["period"] * 9, 0.05, 200, armed=lambda: begun.append(True))
    CHECKS.that(begun == [True, True], f"that it has begun is said once: {begun}")


def a_fault_is_in_words(drive, knobs):
    knobs.turn("plant.bus_V = 8")
    time.sleep(0.2)
    found = refusal(drive.wait, steadystep.DriveFault)
    CHECKS.that(found.startswith("bus-voltage (0x3200): the supply is outside"), found)
    CHECKS.that("supply_V to the supply's voltage" in drive.faults[0].remedy, "and what to do")
    knobs.turn("plant.bus_V = 24")
    drive.reset()
    CHECKS.that(drive.state == "SWITCH ON DISABLED" and drive.fault is None, "it is reset")
    drive.settings["torque_constant_Nm_A"] = 0.001
    CHECKS.that("too little back-EMF" in refusal(drive.enable), "a refusal to be enabled, too")
    drive.settings["torque_constant_Nm_A"] = 0.157


def a_response_that_comes_late_is_not_the_next_one_s(drive, process):
    """Ctrl-C behind a request that will be refused, to a drive that stands still for a while."""
    sdo, before = drive.objects.node.sdo, drive.settings["current_limit_A"]
    read = sdo.read_response

    def interrupted():
        sdo.read_response = read
        raise KeyboardInterrupt

    process.send_signal(signal.SIGSTOP)
    threading.Timer(0.3, lambda: process.send_signal(signal.SIGCONT)).start()
    sdo.read_response = interrupted
    try:
        with drive.objects.transfer():
            sdo.upload(0x5FFF, 0)
    except KeyboardInterrupt:
        pass
    found = refusal(lambda: drive.settings["current_limit_A"])
    CHECKS.that(found == "" and drive.settings["current_limit_A"] == before, f"it is the next one's: {found}")


def an_interrupt_in_what_is_written_remains_one(drive):
    """In segments: 2205h has eight bytes."""
    sdo, before = drive.objects.node.sdo, drive.objects.read(0x2205)
    read, send, went_on = sdo.read_response, sdo.send_request, True

    def interrupted():
        sdo.read_response = read
        read()
        raise KeyboardInterrupt

    def at_a_segment(request):
        if request[0] & 0xE0 == 0x00:
            sdo.send_request, sdo.read_response = send, interrupted
        send(request)

    sdo.send_request = at_a_segment
    try:
        found = refusal(lambda: drive.objects.write(0x2205, before))
    except KeyboardInterrupt:
        found, went_on = "", False
    CHECKS.that(not went_on and drive.objects.read(0x2205) == before, f"it is an interrupt: {found}")


def a_lost_link_is_said(drive, knobs):
    def fails(_, share):
        if share > 0.3:
            knobs.turn('command = "power-cycle"')

    begin = time.monotonic()
    found = refusal(lambda: drive.capture(["period"], 1.0, 100, recorder=record, progress=fails), steadystep.LostLink)
    CHECKS.that("the drive has restarted; connect anew" in found and time.monotonic() - begin < 1.0, f"in a capture: {found}")
    found = refusal(lambda: drive.state, steadystep.LostLink)
    CHECKS.that("the drive has restarted; connect anew" in found, found)


def what_is_no_drive_is_said(place, folder):
    (folder / "file").write_text("")
    for wrong, said in (("/dev/no-such", "No such file"), (str(folder / "file"), "no serial port"),
                        ("tcp://127.0.0.1:1", "Connection refused"), ("tcp://here", "expected tcp://HOST:PORT")):
        found = refusal(lambda wrong=wrong: steadystep.Drive(wrong), steadystep.WrongPort)
        CHECKS.that(said in found, f"{wrong}: {found}")
    found = refusal(lambda: steadystep.Drive(place, node=0), steadystep.Refused)
    CHECKS.that(found == "node: expected a number in 1…127, got 0", found)
    closed = steadystep.Drive(place)
    closed.close()
    for what in (lambda: closed.state, closed.quick_stop, closed.enable):
        found = refusal(what, steadystep.LostLink)
        CHECKS.that("the drive has been closed" in found, f"closed by this program: {found}")
    found = refusal(lambda: steadystep.Drive(place, node=5), steadystep.WrongPort)
    CHECKS.that("node 5 does not answer; heard: 1" in found, found)
    known = steadystep.dictionary()
    version, known.version = known.version, "9.9.0"
    found = refusal(lambda: steadystep.Drive(place), steadystep.WrongVersion)
    CHECKS.that("this package is for 9.9.0" in found, found)
    steadystep.Drive(place, any_version=True).close()
    known.version = version


def a_node_that_refuses_enables_no_other():
    """The console is node 1's."""
    with Simulated("--nodes", "2", program=SIL) as simulated, steadystep.Drive(simulated.place, node=2) as drive:
        drive.settings["torque_constant_Nm_A"] = 0.001
        found = refusal(drive.enable, steadystep.Refused)
        CHECKS.that(found.startswith("node 2 refuses to be enabled") and "shared with node 1" in found, found)
        time.sleep(0.2)
        for n in ("", "2: "):
            found = simulated.knobs.turn(n + "state")
            CHECKS.that("state=switch-on-disabled" in found, f"{n}nothing is switched on: {found}")


def a_terminal_serves_as_well():
    with Served() as served, steadystep.Drive(str(served.link)) as drive:
        drive.enable()
        drive.move(0.5)
        CHECKS.that(abs(drive.position_rad - 0.5) < 0.01, "on a pseudo-terminal")
        for place in (str(served.link), f"tcp://{served.serial[-1]}"):  # the latter serves one at a time
            first = steadystep.Drive(place)
            again = steadystep.Drive(place)
            CHECKS.that(abs(again.position_rad - 0.5) < 0.01, f"{place}: opened once more, as by a notebook's cell")
            found = refusal(lambda first=first: first.state, steadystep.LostLink)
            CHECKS.that("another Drive of this program has taken its line" in found, f"{place}: {found}")
            found = refusal(lambda place=place: steadystep.Drive(place, node=2), steadystep.WrongPort)
            CHECKS.that("has it open, of node 1" in found or "node 2 does not answer" in found, f"{place}: {found}")
            again.close()
        drive = steadystep.Drive(str(served.link))
        served.end()
        CHECKS.that("drive" in refusal(lambda: drive.state, steadystep.LostLink), "whose end is noticed")


def its_version_is_that_of_the_drive():
    project = tomllib.loads((PACKAGE / "pyproject.toml").read_text(encoding="utf-8"))["project"]
    CHECKS.that(project["version"] == steadystep.dictionary().version, project["version"])


its_version_is_that_of_the_drive()
layouts_name_signals_of_the_drive()
with tempfile.TemporaryDirectory() as scratch, Simulated(program=SIL) as simulated:
    FOLDER = pathlib.Path(scratch)
    what_is_no_drive_is_said(simulated.place, FOLDER)
    with steadystep.Drive(simulated.place) as DRIVE:
        settings_go_out_and_come_back(DRIVE)
        what_nobody_has_given_is_not_exported(DRIVE)
        what_is_no_setting_is_refused(DRIVE, FOLDER)
        a_motor_takes_back_what_was_given_for_another(DRIVE)
        numbers_of_numpy_are_numbers(DRIVE)
        a_torque_is_a_drive_s_with_an_encoder(DRIVE)
        it_moves(DRIVE, simulated.knobs)
        it_is_homed(DRIVE, simulated.knobs)
        it_captures(DRIVE, FOLDER)
        what_the_drive_records_itself(DRIVE)
        the_recorder_is_one_program_s(DRIVE)
        what_is_asked_for_lasts_as_long(DRIVE)
        a_fault_is_in_words(DRIVE, simulated.knobs)
        a_response_that_comes_late_is_not_the_next_one_s(DRIVE, simulated.process)
        an_interrupt_in_what_is_written_remains_one(DRIVE)
        a_lost_link_is_said(DRIVE, simulated.knobs)
a_node_that_refuses_enables_no_other()
a_terminal_serves_as_well()
CHECKS.end()
