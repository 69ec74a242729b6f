"""What the READMEs show of an own scenario and an own motor, taken from their text, runs and holds."""
import math
import pathlib
import re
import shlex

from program import ROOT, Checks, run, scratch

CHECKS = Checks()
READMES = ("README.md", "sil/README.md", "sil/motors/README.md")


def blocks():
    """(README, text) of what is set as code, up to a blank line."""
    for name in READMES:
        text = (ROOT / name).read_text(encoding="utf-8")
        for block in re.findall(r"(?:^    .*\n)+", text, re.MULTILINE):
            yield name, re.sub(r"^    ", "", block, flags=re.MULTILINE)


def block_of(name, wanted):
    found = [text for readme, text in blocks() if readme == name and wanted in text]
    CHECKS.that(len(found) == 1, f"{name}: one block with {wanted}: {len(found)}")
    return found[0]


def commands_of(name):
    for readme, text in blocks():
        if readme == name:
            yield from (line for line in text.splitlines() if line.startswith(("steadystep-sil ",
                                                                               "build/sil/")))


def write_samples(folder):
    (folder / "my-move.toml").write_text(block_of("README.md", "# my-move.toml"), encoding="utf-8")
    (folder / "my-motor.toml").write_text(block_of("sil/motors/README.md", "# my-motor.toml"),
                                          encoding="utf-8")


def both_readmes_show_the_same_scenario(_):
    one, other = (tuple(line.split("#")[0].strip()
                        for line in block_of(name, "# my-move.toml").splitlines())
                  for name in ("README.md", "sil/README.md"))
    CHECKS.that(one == other, f"{one}\n{other}")


def commands_of_the_samples_hold(folder):
    """As they stand, but for the place of the program."""
    write_samples(folder)
    lines = [line for name in READMES for line in commands_of(name)
             if "my-m" in line and "campaign" not in line]
    CHECKS.that(len(lines) >= 3, f"commands with the samples: {lines}")
    for line in lines:
        done = run(*shlex.split(line.split("#")[0])[1:], cwd=folder)
        CHECKS.that(done.returncode == 0 and done.stderr == "", f"{line}: {done.stdout}{done.stderr}")


def the_sample_motor_keeps_its_rotor_at_rest(folder):
    write_samples(folder)
    REST = """base = "./my-move.toml"
duration_s = 3.3
motor = "./my-motor.toml"
expect = [
  { metric = "fault", equals = "none" },
  { metric = "slip_full_steps", max = 0 },
  { metric = "position_error_max_rad", window = [3.0, 3.3], max = %s },
]
"""
    for model, full_steps in (("ideal", 1 / 16), ("bench", 1 / 16), ("real", 1 / 5)):  # detent
        (folder / "rest.toml").write_text(REST % (full_steps * math.pi / 100), encoding="utf-8")
        done = run("run", "./rest.toml", "--seeds", "1-8", "--set", f"plant.model={model}", "--set",
                   "plant.current_range_rated=2.2", cwd=folder)
        CHECKS.that(done.returncode == 0, f"{model}: {done.stdout}{done.stderr}")


for check in (both_readmes_show_the_same_scenario, commands_of_the_samples_hold,
              the_sample_motor_keeps_its_rotor_at_rest):
    with scratch() as name:
        check(pathlib.Path(name))
CHECKS.end()
