"""sil/README.md: campaigns, which take minutes to hours; run when they are named."""
import json

from readme_figures.reading import spelled, up
from readme_figures.registry import Cost, entry

WARN = ("--set", "drive.synchronism_policy=warn")


def campaign(sources, kind, seeds, *more, numeric="float"):
    return json.loads(sources.tool("campaign", kind, "--seeds", seeds, "--numeric", numeric, *more,
                                   "--json", "--program", sources.program,
                                   "--out", sources.build / f"figures-{kind}-{numeric}-{len(more)}"))


def verdicts(found, word):
    return sum(count for name, count in found["verdicts"].items() if word in name)


def miss_rate(reported):
    """Per cent: the bound of 95 % confidence of none that is missed."""
    return 100 * (1 - 0.05 ** (1 / reported))


@entry("slip", "steadystep-sil campaign slip --seeds 1-10000", Cost.CAMPAIGN,
       probe=("campaign slip --seeds 1-40 --json", "campaign slip --seeds 1-40 --numeric fixed --json"))
def slip(sources):
    found, fixed = (campaign(sources, "slip", "1-10000", numeric=numeric)
                    for numeric in ("float", "fixed"))
    figures, delays = found["figures"], sorted(
        run["delay_ms"] for run in found["runs"] if run["delay_ms"] is not None)
    slips = int(figures["slips"]["sum"])
    return {"held": f"{found['verdicts']['held']:,}", "held-fixed": f"{fixed['verdicts']['held']:,}",
            "missed": f"{verdicts(found, 'missed')}", "missed-fixed": f"{verdicts(fixed, 'missed')}",
            "false": f"{verdicts(found, 'false alarm')}",
            "false-fixed": f"{verdicts(fixed, 'false alarm')}",
            "slips": f"{slips}", "stalled": f"{figures['reports_stalled']['sum']:,.0f}",
            "other": f"{figures['other_faults']['sum']:.0f}",
            "doubted": f"{figures['slips_doubted_before']['sum']:.0f}",
            "bound": spelled(miss_rate(slips), 1), "median": spelled(delays[len(delays) // 2], 1),
            "most": up(delays[95 * len(delays) // 100], 0), "worst": up(delays[-1], 0)}


@entry("slip-warned", "steadystep-sil campaign slip --seeds 1-10000 "
       "--set drive.synchronism_policy=warn", Cost.CAMPAIGN,
       probe=("campaign slip --seeds 1-40 --json --set drive.synchronism_policy=warn",))
def slip_warned(sources):
    found = campaign(sources, "slip", "1-10000", *WARN)
    slips, missed = int(found["figures"]["slips"]["sum"]), verdicts(found, "missed")
    late = [run for run in found["runs"] if "missed" in run["verdict"]]
    return {"slips": f"{slips}", "reported": f"{slips - missed}",
            "doubted": f"{found['figures']['slips_doubted_before']['sum']:.0f}",
            "false": f"{verdicts(found, 'false alarm')}",
            "late": "; ".join(f"{run['delay_ms']:.0f} ms with `warn`, seed {run['seed']}"
                              if run["delay_ms"] is not None else f"never, seed {run['seed']}"
                              for run in late) or "none"}


@entry("long-run", "steadystep-sil campaign long-run --seeds 1-200", Cost.CAMPAIGN,
       probe=("campaign long-run --seeds 1-4 --duration 10 --json",))
def long_run(sources):
    found = campaign(sources, "long-run", "1-200")
    worst = found["figures"]["estimate_error_max_deg_electrical"]
    return {"held": f"{found['verdicts']['held']}", "median": spelled(worst["median"], 1),
            "most": spelled(worst["percentile_95"], 0),
            "others": ", ".join(f"{count} {name}" for name, count in
                                sorted(found["verdicts"].items()) if name != "held")}


@entry("load", "steadystep-sil campaign load --seeds 1-800", Cost.CAMPAIGN,
       probe=("campaign load --seeds 1-16 --json",
              "campaign load --seeds 1-16 --numeric fixed --json",
              "campaign load --seeds 1-16 --set plant.model=as-built --json"))
def load(sources):
    found = {}
    for name, numeric, options in (("held", "float", ()), ("held-fixed", "fixed", ()),
                                   ("held-as-built", "float", ("--set", "plant.model=as-built"))):
        run = campaign(sources, "load", "1-800", *options, numeric=numeric)
        found |= {name: f"{run['verdicts']['held']}",
                  name.replace("held", "others"): ", ".join(
                      f"{count} {what}" for what, count in sorted(run["verdicts"].items())
                      if what != "held") or "none"}
    return found
