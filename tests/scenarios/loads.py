"""Campaigns of loads: what is borne, what is reported, and that a run that failed is none of both."""
import collections
import json

from program import Checks, run

CHECKS = Checks()


def verdicts(kind, *arguments):
    runs = json.loads(run("campaign", kind, *arguments, "--json").stdout)["runs"]
    return collections.Counter(one["verdict"] for one in runs)


def all_is_borne_but_a_release_of_what_grew_unseen():
    for numeric in ("float", "fixed"):
        found = verdicts("load", "--seeds", "1-16", "--numeric", numeric)
        releases = found.pop("release: fault", 0)  # one in 100 of all, sil/README.md
        CHECKS.that(releases <= 1 and set(found) == {"held"}, f"{numeric}: {releases}, {found}")


def a_drive_that_does_not_get_ready_holds_nothing():
    for kind, more in ("load", ("--duration", "0.8")), ("as-built-loads", ()):
        found = verdicts(kind, "--seeds", "1-8", *more, "--set", "plant.current_offset_a_A=4.0")
        CHECKS.that(found == {"failed": 8}, f"{kind}: {found}")


all_is_borne_but_a_release_of_what_grew_unseen()
a_drive_that_does_not_get_ready_holds_nothing()
CHECKS.end()
