"""A closed pipe, INT and TERM: said on standard error, no success, and no file half-written."""
import os
import pathlib
import signal
import subprocess
import time

from program import SIL, SMALL, Checks, scratch

CHECKS = Checks()


def a_closed_pipe_is_no_success(folder):
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    for command in (["run", "small.toml"], ["list"], ["run", "small.toml", "--json"]):
        read, write = os.pipe()
        os.close(read)
        done = subprocess.run([SIL, *command], stdout=write, stderr=subprocess.PIPE, text=True,
                              cwd=folder, check=False)
        os.close(write)
        CHECKS.that(done.returncode == 2 and done.stderr == "steadystep-sil: standard output: "
                    "cannot be written: Broken pipe\n", f"{command}: {done.returncode} {done.stderr}")


def an_interrupted_run_says_what_was_done(folder):
    (folder / "small.toml").write_text(SMALL.replace("duration_s = 0.05", "duration_s = 5", 1),
                                       encoding="utf-8")
    for number, kind in ((signal.SIGINT, "csv"), (signal.SIGTERM, "npy")):
        out = folder / kind
        with subprocess.Popen([SIL, "run", "small.toml", "--seeds", "1-1000", "--jobs", "2", "--out",
                               out, "--trace", kind], stdout=subprocess.DEVNULL,
                              stderr=subprocess.PIPE, text=True, cwd=folder) as running:
            while not any(out.glob("*/*.part")):
                time.sleep(0.02)
            running.send_signal(number)
            said = running.communicate()[1].splitlines()
        CHECKS.that(running.returncode == -number, f"ends by the signal: {running.returncode}")
        CHECKS.that(said[-1].startswith("steadystep-sil: interrupted: ")
                    and "of 1000 runs" in said[-1], f"says so: {said}")
        CHECKS.that(not any(out.rglob("*.part")), f"no part stays: {list(out.rglob('*.part'))}")


for check in (a_closed_pipe_is_no_success, an_interrupted_run_says_what_was_done):
    with scratch() as place:
        check(pathlib.Path(place))
CHECKS.end()
