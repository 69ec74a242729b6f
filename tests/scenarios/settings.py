"""A file of settings takes a drive from one run to another, whole and exact."""
import json
import pathlib
import tomllib

from program import SMALL, Checks, run, scratch

CHECKS = Checks()

# From several laws, both feedbacks, laws with gains of their own, a parameter set.
DRIVES = ["bendjedia-fig12", "stmms-drive", "compare-move", "default-law-move"]


def summary(folder, *arguments):
    result = run("run", *arguments, "--json", cwd=folder)
    CHECKS.that(result.returncode != 2, f"{arguments}: {result.stderr}")
    return json.loads(result.stdout)[0]


def hashes(folder, *arguments):
    found = summary(folder, *arguments)
    return found["trace_hash"], found["drive_hash"]


def written(folder, *arguments):
    """The bytes of the file that a run writes."""
    summary(folder, *arguments, "--write-settings", "written.toml")
    return (folder / "written.toml").read_bytes()


def same_results_and_bytes(folder):
    for name in DRIVES:
        plain = hashes(folder, name)
        CHECKS.that(hashes(folder, name, "--write-settings", "a.toml") == plain,
                    f"{name}: --write-settings changes no result")
        CHECKS.that(hashes(folder, name, "--settings", "a.toml") == plain,
                    f"{name}: the same result by its own settings")
        CHECKS.that(written(folder, name, "--settings", "a.toml")
                    == (folder / "a.toml").read_bytes(), f"{name}: the same bytes again")


def whole(folder):
    """Whatever the other scenario sets, and whatever its motor: nothing of it is left."""
    first = written(folder, "bendjedia-fig12")
    (folder / "a.toml").write_bytes(first)
    (folder / "other.toml").write_text(
        SMALL.replace("hold_on_enable = false", "hold_on_enable = false\nhold_current_A = 1.0\n"
                      'feedback = "encoder"\novercurrent_trip_A = 5.0').replace(
                          'model = "bench"', "encoder_counts_per_turn = 4000"), encoding="utf-8")
    CHECKS.that(written(folder, "other.toml") != first, "another drive")
    CHECKS.that(written(folder, "other.toml", "--settings", "a.toml") == first,
                "no setting of the other scenario is left")
    CHECKS.that(b"hold_current_A = nan  # A\n" in first, "what is not given says so")
    values = tomllib.loads(first.decode())
    CHECKS.that(values["resistance_ohm"] == 0.37 and values["law"] == "state-feedback"
                and values["hold_at_rest"] is True and values["detent_torque_Nm"] == [0] * 6,
                f"another reader of TOML: {values}")


def precedence(folder):
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    (folder / "a.toml").write_text('law = "pid"\nhold_current_A = 1.0\nlaw_bandwidth_rad_s = 100\n',
                                   encoding="utf-8")

    def values(*arguments):
        return tomllib.loads(written(folder, "small.toml", *arguments).decode())

    over_all = values("--parameters", "bendjedia-2012/foc", "--settings", "a.toml")
    CHECKS.that(over_all["law"] == "pid" and over_all["hold_current_A"] == 1.0,
                f"--settings counts over --parameters: {over_all}")
    CHECKS.that(over_all["hold_on_enable"] is False, "what the file leaves out stays")
    set_over = values("--settings", "a.toml", "--set", "drive.hold_current_A=0.5", "--set",
                      "plant.bus_V=23")
    CHECKS.that(set_over["hold_current_A"] == 0.5, f"--set counts over --settings: {set_over}")
    law = values("--settings", "a.toml", "--set", "drive.law=foc")
    CHECKS.that(law["law"] == "foc" and law["law_bandwidth_rad_s"] != 100,
                f"a law that is set brings its defaults: {law}")


def plant_stays(folder):
    """The drive is set to another motor; the one that turns is the scenario's."""
    (folder / "small.toml").write_text(SMALL, encoding="utf-8")
    (folder / "a.toml").write_text("resistance_ohm = 0.5\n", encoding="utf-8")
    said = summary(folder, "small.toml", "--settings", "a.toml")
    error = said["metrics"]["all"]["resistance_estimate_error_ratio"]
    CHECKS.that(said["motor"] == "bendjedia-2012", f"motor: {said['motor']}")
    CHECKS.that(said["settings"] == "a.toml" and "--settings a.toml" in said["reproduce"],
                f"how to repeat it: {said['reproduce']}")
    CHECKS.that(error is not None and error > 0.01, f"the drive believes the file: {error}")
    CHECKS.that(said["trace_hash"] != summary(folder, "small.toml")["trace_hash"],
                "another result")


for part in (same_results_and_bytes, whole, precedence, plant_stays):
    with scratch() as name:
        part(pathlib.Path(name))
CHECKS.end()
