"""A campaign: reproducible by hand, whatever --jobs is, and it goes on where it was cut off."""
import json
import pathlib
import tomllib

from program import Checks, run, scratch

CHECKS = Checks()
ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
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


def a_random_motor_is_written_beside_its_scenario(folder):
    arguments = "campaign", "motors", "--seed", "11"
    (drawn,) = json.loads(run(*arguments, "--json", cwd=folder).stdout)["runs"]
    (folder / "deep").mkdir()
    run(*arguments, "--write-scenario", "deep/drawn.toml", cwd=folder)
    CHECKS.that((folder / "deep/random-11.toml").is_file(), "its motor's file")
    (by_hand,) = json.loads(run("run", "deep/drawn.toml", "--json", cwd=folder).stdout)
    CHECKS.that(by_hand["trace_hash"] == drawn["trace_hash"], "the same run")


def a_motor_of_ones_own_is_taken_and_can_be_written_out(folder):
    """From another folder than the scenario's; loads go with the torque, a quarter of the
    reference motor's."""
    own = (ROOT / "sil/motors/bendjedia-2012.toml").read_text(encoding="utf-8")
    for old, new in (('id = "bendjedia-2012"', 'id = "mine"'), ("= 0.157", "= 0.0785"),
                     ("_A = 3.0", "_A = 1.5"), ("15.62e-5", "3.905e-5"), ("= 0.37", "= 0.74")):
        CHECKS.that(old in own, f"the reference motor has {old}")
        own = own.replace(old, new)
    (folder / "motors").mkdir()
    (folder / "motors/mine.toml").write_text(own, encoding="utf-8")
    (folder / "runs").mkdir()
    for kind in ("long-run", "slip", "load", "as-built"):
        length = () if kind == "as-built" else ("--duration", "0.8")
        arguments = ("campaign", kind, "--seed", "5", *length, "--set", "motor=motors/mine.toml")
        (drawn,) = json.loads(run(*arguments, "--json", cwd=folder).stdout)["runs"]
        CHECKS.that("--set motor=motors/mine.toml" in drawn["reproduce"], drawn["reproduce"])
        written = run(*arguments, "--write-scenario", f"runs/{kind}.toml", cwd=folder)
        CHECKS.that(written.returncode == 0, written.stderr)
        (by_hand,) = json.loads(run("run", f"./{kind}.toml", "--json",
                                    cwd=folder / "runs").stdout)
        CHECKS.that(by_hand["motor"] == "mine", f"{kind}: the motor is {by_hand['motor']}")
        CHECKS.that(by_hand["trace_hash"] == drawn["trace_hash"], f"{kind}: the same run")
        run(*arguments[:-2], "--write-scenario", f"runs/{kind}-reference.toml", cwd=folder)
        mine, reference = (loads_of(folder / f"runs/{kind}{end}.toml") for end in ("", "-reference"))
        CHECKS.that(len(mine) == len(reference) > 0
                    and all(abs(a - 0.25 * b) < 1e-4 for a, b in zip(mine, reference)),
                    f"{kind}: loads {mine} are a quarter of {reference}")


def loads_of(file):
    events = tomllib.loads(file.read_text(encoding="utf-8"))["event"]
    return [event[key] for event in events for key in ("load_torque_Nm", "load_vibration_Nm")
            if key in event]


def a_motor_that_the_drive_refuses_is_a_verdict(folder):
    """A current limit that suits the reference motor and not one that is rated below."""
    done = run("campaign", "motors", "--seeds", "1-20", "--set", "drive.current_limit_A=3", "--json",
               cwd=folder)
    found = json.loads(done.stdout)
    refused = [one for one in found["runs"] if one["verdict"].startswith("refused")]
    CHECKS.that(0 < len(refused) < 20, f"{len(refused)} of 20 are refused")
    CHECKS.that({one["verdict"] for one in refused} == {"refused: current_limit_A"}
                and all("current_limit_A" in one["failure"] for one in refused), f"{refused}")
    wrong = run("campaign", "motors", "--seeds", "1-2", "--set", "drive.curent=3", cwd=folder)
    CHECKS.that(wrong.returncode == 2, "a setting that nobody knows is bad input")


def settings_lie_over_every_scenario(folder):
    plain = campaign(folder, "--seed", "1", "--json")
    done = campaign(folder, "--seed", "1", "--set", "drive.law=pid", "--json")
    (one,), (other,) = (json.loads(text.stdout)["runs"] for text in (plain, done))
    CHECKS.that(one["trace_hash"] != other["trace_hash"], "--set counts")
    CHECKS.that("--set drive.law=pid" in other["reproduce"], f"and is repeated: {other}")
    brief, spelled = (json.loads(campaign(folder, "--seed", "1", "--set", model, "--set", "plant.hysteresis=0.03", "--json").stdout)
                      ["runs"][0] for model in ("plant=as-built", "plant.model=as-built"))
    CHECKS.that(brief["trace_hash"] == spelled["trace_hash"], "a plant in brief goes with keys of its own")


def it_goes_on_where_it_was_cut_off(folder):
    first = campaign(folder, "--seeds", "1-3", "--out", "out")
    CHECKS.that("already" not in first.stderr, "nothing to go on from")
    journal = folder / "out/long-run-float.jsonl"
    lines = journal.read_text(encoding="utf-8").splitlines()
    CHECKS.that(len(lines) == 3, f"a line per run: {lines}")
    journal.write_text("\n".join(lines[:2]) + "\n" + lines[2][:40], encoding="utf-8")
    second = campaign(folder, "--seeds", "1-4", "--out", "out")
    CHECKS.that("2 of 4 runs are in" in second.stderr, f"two lines count: {second.stderr}")
    fresh = campaign(folder, "--seeds", "1-4")
    CHECKS.that(second.stdout == fresh.stdout, "the report is that of a campaign in one go")
    third = campaign(folder, "--seeds", "1-4", "--out", "out")
    CHECKS.that("4 of 4 runs are in" in third.stderr, f"no line is lost: {third.stderr}")
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
                            (("campaign", "long-run", "--duration", "0"), "--duration"),
                            (("campaign", "motors", "--set", "motor=kim-2016"), "draws its motors"),
                            ((*SHORT, "--set", "motor=nobody"), "nobody"),
                            ((*SHORT, "--set", "drive.law=pid", "--write-scenario", "x.toml"),
                             "nothing but motor=")):
        done = run(*arguments, cwd=folder)
        CHECKS.that(done.returncode == 2 and text in done.stderr
                    and len(done.stderr.splitlines()) == 1, f"{arguments}: {done.stderr}")
    CHECKS.that(not (folder / "x.toml").exists(), "nothing written")


for check in (jobs_change_nothing, a_written_scenario_is_the_same_run,
              a_random_motor_is_written_beside_its_scenario,
              a_motor_of_ones_own_is_taken_and_can_be_written_out,
              a_motor_that_the_drive_refuses_is_a_verdict,
              settings_lie_over_every_scenario, it_goes_on_where_it_was_cut_off,
              a_run_that_does_not_hold_is_named, bad_input_is_refused):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
