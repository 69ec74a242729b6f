"""The memory of a run does not grow with what it simulates: neither with the figures that are made of it, nor with a trace."""
import contextlib
import os
import pathlib
import subprocess
import time

from program import ROOT, SIL, Checks, scratch

CHECKS = Checks()
SCENARIO = ROOT / "sil" / "scenarios" / "bendjedia-fig12.toml"
SHORT_S, LONG_S, TRACED_S = 1, 40, 10
MOST_KB = 1024  # less than three bytes for a row of the long run, whose numbers are eight each
LOOK_S, LOOKS = 0.01, 5


def full_pipe():
    """One that lets nobody write until it is read: a run waits with its report."""
    reader, writer = os.pipe()
    os.set_blocking(writer, False)
    with contextlib.suppress(BlockingIOError):
        while True:
            os.write(writer, bytes(4096))
    os.set_blocking(writer, True)
    return reader, writer


def waits(process):
    """Every thread of it, or it has ended."""
    try:
        tasks = pathlib.Path(f"/proc/{process.pid}/task").glob("*/stat")
        return all(stat.read_text(encoding="ascii").rsplit(")", 1)[1].split()[0] in "SZ" for stat in tasks)
    except OSError:  # one has just ended
        return False


def peak_kb(folder, seconds, *arguments):
    """The most of resident memory, by the kernel's own mark, which a run that has ended shows no more."""
    reader, writer = full_pipe()
    process = subprocess.Popen([SIL.resolve(), "run", SCENARIO, "--set", f"duration_s={seconds}", *arguments], cwd=folder,
                               stdout=writer, stderr=subprocess.DEVNULL)
    os.close(writer)
    looks = 0
    while looks < LOOKS:
        looks = looks + 1 if waits(process) else 0
        time.sleep(LOOK_S)
    lines = pathlib.Path(f"/proc/{process.pid}/status").read_text(encoding="ascii").splitlines()
    with os.fdopen(reader, "rb") as report:
        report.read()
    CHECKS.that(process.wait() == 0, f"{seconds} s {arguments}: it ends with {process.returncode}")
    return sum(int(line.split()[1]) for line in lines if line.startswith("VmHWM:"))


with scratch() as name:
    for long_s, arguments in ((LONG_S, ()), (TRACED_S, ("--out", "out", "--trace", "both"))):
        short_kb, long_kb = peak_kb(name, SHORT_S, *arguments), peak_kb(name, long_s, *arguments)
        print(f"{SHORT_S} s: {short_kb} kB, {long_s} s: {long_kb} kB {' '.join(arguments)}")
        CHECKS.that(0 < short_kb and long_kb - short_kb < MOST_KB,
                    f"{long_s} s take {long_kb} kB, {SHORT_S} s {short_kb} {' '.join(arguments)}")
CHECKS.end()
