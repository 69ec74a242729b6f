"""A run is reproducible from scenario, seed and version alone."""
import json
import pathlib

from program import SMALL, Checks, run, scratch

CHECKS = Checks()


def batch(folder, out, *arguments):
    result = run("run", "one.toml", "two.toml", *arguments, "--out", out, cwd=folder)
    CHECKS.that(result.returncode == 0, f"{out}: exit code {result.returncode}: {result.stdout}")
    return result


def summaries(folder, out):
    """Everything but the CPU time, which is no result."""
    found = {}
    for path in sorted((folder / out).rglob("summary.json")):
        summary = json.loads(path.read_text(encoding="utf-8"))
        del summary["cpu_s"]
        found[path.parent.name] = summary
    return found


def traces(folder, out):
    return {path.parent.name: path.read_bytes()
            for path in sorted((folder / out).rglob("trace.csv"))}


def hashes(folder, out, run_name):
    summary = summaries(folder, out)[run_name]
    return summary["trace_hash"], summary["drive_hash"]


def without_times(text):
    return [line for line in text.splitlines() if "simulated in" not in line]


with scratch() as name:
    FOLDER = pathlib.Path(name)
    (FOLDER / "one.toml").write_text(SMALL, encoding="utf-8")
    (FOLDER / "two.toml").write_text(SMALL.replace("0.05\nduration", "0.06\nduration"),
                                     encoding="utf-8")

    alone = batch(FOLDER, "a", "--seeds", "1-6", "--jobs", "1")
    together = batch(FOLDER, "b", "--seeds", "1-6", "--jobs", "5")
    CHECKS.that(len(summaries(FOLDER, "a")) == 12, "twelve runs leave twelve summaries")
    CHECKS.that(summaries(FOLDER, "a") == summaries(FOLDER, "b"), "--jobs changes no summary")
    CHECKS.that(traces(FOLDER, "a") == traces(FOLDER, "b"), "--jobs changes no trace")
    CHECKS.that(without_times(alone.stdout) == without_times(together.stdout),
                "--jobs changes neither the text nor its order")

    seed_1, seed_2 = hashes(FOLDER, "a", "one-seed1"), hashes(FOLDER, "a", "one-seed2")
    CHECKS.that(seed_1[0] != seed_2[0], "another seed, another trace hash")
    CHECKS.that(seed_1[1] != seed_2[1], "another seed, another drive hash")
    batch(FOLDER, "c", "--seed", "1")
    CHECKS.that(hashes(FOLDER, "c", "one") == seed_1, "--seed 1 is the first of --seeds 1-6")
    batch(FOLDER, "d", "--seed", "1", "--numeric", "fixed")
    CHECKS.that(hashes(FOLDER, "d", "one") != seed_1, "fixed point is not float")
    batch(FOLDER, "e", "--seed", "1", "--set", "plant.resistance_scale=1.001")
    CHECKS.that(hashes(FOLDER, "e", "one") != seed_1, "another plant, another hash")
CHECKS.end()
