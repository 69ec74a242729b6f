"""A campaign: reproducible by hand, whatever --jobs is, and it goes on where it was cut off."""
import json
import pathlib

from program import Checks, run, scratch

CHECKS = Checks()
SHORT = ("campaign", "long-run", "--duration", "0.6")


def campaign(folder, *arguments):
    return run(*SHORT, *arguments, cwd=folder)


def jobs_change_nothing(folder):
    alone = campaign(folder, "--seeds", "1-4", "--jobs", "1", "--json")
    together = campaign(folder, "--seeds", "1-4", "--jobs", "3", "--json")
    CHECKS.that(alone.stdout == together.stdout, "--jobs changes nothing")
    runs = json.loads(alone.stdout)["runs"]
    CHECKS.that([one["seed"] for one in runs] == [1, 2, 3, 4], "every seed, in order")
    CHECKS.that(len({one["trace_hash"] for one in runs}) == 4, "every seed another run")


def a_written_scenario_is_the_same_run(folder):
    for numeric in ("float", "fixed"):
        (drawn,) = json.loads(campaign(folder, "--seed", "17", "--numeric", numeric,
                                       "--json").stdout)["runs"]
        written = campaign(folder, "--seed", "17", "--write-scenario", "drawn.toml")
        CHECKS.that(written.returncode == 0 and written.stdout == "", "writes and runs nothing")
        (by_hand,) = json.loads(run("run", "./drawn.toml", "--numeric", numeric, "--json",
                                    cwd=folder).stdout)
        for key in ("trace_hash", "drive_hash"):
            CHECKS.that(by_hand[key] == drawn[key], f"{numeric}: the same {key}")


def settings_lie_over_every_scenario(folder):
    plain = campaign(folder, "--seed", "1", "--json")
    done = campaign(folder, "--seed", "1", "--set", "drive.law=pid", "--json")
    (one,), (other,) = (json.loads(text.stdout)["runs"] for text in (plain, done))
    CHECKS.that(one["trace_hash"] != other["trace_hash"], "--set counts")
    CHECKS.that("--set drive.law=pid" in other["reproduce"], f"and is repeated: {other}")


def it_goes_on_where_it_was_cut_off(folder):
    first = campaign(folder, "--seeds", "1-3", "--out", "out")
    CHECKS.that("already" not in first.stderr, "nothing to go on from")
    journal = folder / "out/long-run-float.jsonl"
    lines = journal.read_text(encoding="utf-8").splitlines()
    CHECKS.that(len(lines) == 3, f"a line per run: {lines}")
    journal.write_text("\n".join(lines[:2]) + "\n" + lines[2][:40] + "\n", encoding="utf-8")
    second = campaign(folder, "--seeds", "1-4", "--out", "out")
    CHECKS.that("2 of 4 runs are in" in second.stderr, f"two lines count: {second.stderr}")
    fresh = campaign(folder, "--seeds", "1-4")
    CHECKS.that(second.stdout == fresh.stdout, "the report is that of a campaign in one go")
    table = json.loads((folder / "out/long-run-float.json").read_text(encoding="utf-8"))
    CHECKS.that(len(table["runs"]) == 4, "the table has all runs")
    other = campaign(folder, "--seeds", "1-4", "--out", "out", "--set", "drive.law=pid")
    CHECKS.that("already" not in other.stderr, "runs of other settings do not count")


def a_run_that_does_not_hold_is_named(folder):
    """An offset with which no drive gets ready."""
    done = campaign(folder, "--seeds", "1-2", "--set", "plant.current_offset_a_A=4.0")
    CHECKS.that(done.returncode == 1, f"exit code {done.returncode}: {done.stderr}")
    CHECKS.that("did not become ready" in done.stderr, f"why: {done.stderr}")
    CHECKS.that("steadystep-sil campaign long-run --seed 1 --numeric float --duration 0.6"
                in done.stdout, f"with the command that repeats it: {done.stdout}")


def bad_input_is_refused(folder):
    for arguments, text in ((("campaign", "long-rum"), "unknown kind"),
                            ((*SHORT, "--seeds", "1-2", "--write-scenario", "x.toml"), "one seed"),
                            (("campaign", "long-run", "--duration", "0"), "--duration")):
        done = run(*arguments, cwd=folder)
        CHECKS.that(done.returncode == 2 and text in done.stderr
                    and len(done.stderr.splitlines()) == 1, f"{arguments}: {done.stderr}")
    CHECKS.that(not (folder / "x.toml").exists(), "nothing written")


for check in (jobs_change_nothing, a_written_scenario_is_the_same_run,
              settings_lie_over_every_scenario, it_goes_on_where_it_was_cut_off,
              a_run_that_does_not_hold_is_named, bad_input_is_refused):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
