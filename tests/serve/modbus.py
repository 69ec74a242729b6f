"""Unmodified Modbus clients on a served drive: minimalmodbus moves it, mbpoll reads and writes.

usage: modbus.py SIL
"""
import struct
import subprocess
import sys
import time

from canopen_bus import CLIENTS, wait_for
from served import Checks, Line, Served

try:
    import minimalmodbus
except ImportError:
    sys.exit(f"minimalmodbus is not in {CLIENTS}: tools/setup clients installs it")

CHECKS = Checks()
STATUS, CONTROL, MODE, TARGET, POSITION = 0x6041, 0x6040, 0x6060, 0x607A, 0x6064
LIMIT, MODBUS, STORE, NAME = 0x2120, 0x2126, 0x1010, 0x1008
SAVE = int.from_bytes(b"save", "little")


def client(place):
    drive = minimalmodbus.Instrument(str(place), 1)
    drive.serial.baudrate = 921600
    drive.serial.timeout = 1.0
    return drive


def state_follows(drive, word, state):
    drive.write_register(CONTROL, word, functioncode=6)
    return wait_for(lambda: drive.read_register(STATUS) & 0x6F == state)


def it_is_moved(drive):
    CHECKS.that(drive.read_long(0x1000) == 0x00040192, "the device's type")
    CHECKS.that(drive.read_string(NAME, 16).rstrip("\0") != "", "its name")
    drive.write_register(MODE, 1)
    CHECKS.that(state_follows(drive, 0x06, 0x21), "it is ready to be switched on")
    CHECKS.that(state_follows(drive, 0x07, 0x23), "switched on")
    CHECKS.that(state_follows(drive, 0x0F, 0x27), "enabled")
    drive.write_long(TARGET, -30000, signed=True)
    drive.write_register(CONTROL, 0x1F, functioncode=6)
    CHECKS.that(wait_for(lambda: drive.read_register(STATUS) & 0x400), "it gets there")
    CHECKS.that(wait_for(lambda: abs(drive.read_long(POSITION, signed=True) + 30000) < 100),
                "which is where it was sent")


def what_cannot_be_is_refused(drive):
    for what, error in ((lambda: drive.read_register(0x1234), minimalmodbus.IllegalRequestError),
                        (lambda: drive.write_register(MODE, 4, functioncode=6),
                         minimalmodbus.IllegalRequestError)):
        try:
            what()
            CHECKS.that(False, f"no {error.__name__}")
        except error:
            CHECKS.that(True, "")


def mbpoll(place, *words, values=()):
    done = subprocess.run(["mbpoll", "-m", "rtu", "-a", "1", "-0", "-1", "-b", "921600", "-P", "none", *words,
                           str(place), *values], capture_output=True, text=True, timeout=20)
    return done.stdout


def another_client_reads_it(place):
    said = mbpoll(place, "-B", "-t", "4:int", "-r", str(POSITION))
    CHECKS.that(abs(int(said.split(f"[{POSITION}]:")[-1].split()[0]) + 30000) < 100, "mbpoll reads")
    mbpoll(place, "-B", "-t", "4:int", "-r", str(TARGET), values=["12345"])
    said = mbpoll(place, "-B", "-t", "4:int", "-r", str(TARGET))
    CHECKS.that("12345" in said, "and writes")


def clients_come_one_by_one(place):
    """Each opens the line and closes it, as programs do that ask once."""
    for _ in range(3):
        said = mbpoll(place, "-r", str(LIMIT), "-c", "4")
        CHECKS.that(f"[{LIMIT}]:" in said, f"who comes when another has gone is answered: {said}")


def it_is_kept(drive):
    drive.write_registers(LIMIT, list(struct.unpack(">4H", struct.pack(">d", 1.25))))
    CHECKS.that(state_follows(drive, 0x00, 0x40), "it is off again")
    drive.write_register(MODBUS, 1)
    drive.write_long(STORE, SAVE)


def it_speaks_modbus_from_power_up(drive):
    def answers():
        try:
            return drive.read_register(MODBUS) == 1
        except minimalmodbus.ModbusException:
            return False

    CHECKS.that(wait_for(answers, 10), "the stored setting opens it")
    words = drive.read_registers(LIMIT, 4)
    CHECKS.that(struct.unpack(">d", struct.pack(">4H", *words))[0] == 1.25, "what was stored is there")


with Served() as served:
    console = Line(str(served.link))
    console.send("modbus\n")
    CHECKS.that(console.until("ok modbus"), "the console hands the line over")
    drive = client(served.link)
    it_is_moved(drive)
    what_cannot_be_is_refused(drive)
    another_client_reads_it(served.link)
    it_is_kept(drive)
    knobs = Line(str(served.knobs_link))
    CHECKS.that(knobs.ask('command = "power-cycle"').startswith("ok"), "the supply is switched off and on")
    it_speaks_modbus_from_power_up(drive)
    knobs.close()
    drive.serial.close()
    console.close()
    clients_come_one_by_one(served.link)
    console = Line(str(served.link))
    console.send("C\r")
    time.sleep(0.2)  # a silence: it stands alone
    console.send("state\n")
    CHECKS.that(console.until("ok "), "the console comes back")
    console.close()
CHECKS.end()
