"""README.md, sil/README.md: boards and motors as they leave their factories, beside `bench`."""
import pathlib

from readme_figures.campaigns import campaign
from readme_figures.reading import mrad, spelled, up
from readme_figures.registry import Cost, entry, table
from readme_figures.sensorless import RESTS

AS_BUILT = {"plant.model": "as-built"}
ON_IT = ("--set", "plant=as-built")
ROOT = pathlib.Path(__file__).resolve().parents[2]


def accepted_motors():
    """The library without the motor that a sensorless drive refuses."""
    return sorted({file.stem for file in (ROOT / "sil/motors").glob("*.toml")} - {"seshagiri-khalil"})


@entry("as-built-draws", "steadystep-sil campaign as-built --seeds 1-1000", Cost.CAMPAIGN,
       probe=("campaign as-built --seeds 1-18 --json",
              "campaign as-built --seeds 1-18 --numeric fixed --json"))
def draws(sources):
    found = {}
    for name, numeric in (("", "float"), ("-fixed", "fixed")):
        run = campaign(sources, "as-built", "1-1000", numeric=numeric)
        angle = run["figures"]["estimate_error_max_deg_electrical"]
        found |= {f"held{name}": f"{run['verdicts'].get('held', 0):,}",
                  f"median{name}": spelled(angle["median"], 1),
                  f"most{name}": up(angle["percentile_95"], 0), f"worst{name}": up(angle["worst"], 0)}
    return found


@entry("as-built-corners", "steadystep-sil campaign as-built-corners --seeds 1-36", Cost.DEAR,
       probe=("campaign as-built-corners --seeds 1-4 --json",))
def corners(sources):
    run = campaign(sources, "as-built-corners", "1-36")
    return {"held": f"{run['verdicts'].get('held', 0)}",
            "worst": up(run["figures"]["estimate_error_max_deg_electrical"]["worst"], 0)}


@entry("as-built-loads", "steadystep-sil campaign as-built-loads --seeds 1-400", Cost.CAMPAIGN,
       probe=("campaign as-built-loads --seeds 1-12 --json",
              "campaign as-built-loads --seeds 1-12 --numeric fixed --json"))
def loads(sources):
    run = campaign(sources, "as-built-loads", "1-400")
    fixed = campaign(sources, "as-built-loads", "1-400", numeric="fixed")

    def most(figure):
        return max(of["figures"][figure]["worst"] for of in (run, fixed))

    return {"held": f"{run['verdicts'].get('held', 0)}",
            "held-fixed": f"{fixed['verdicts'].get('held', 0)}",
            "worst": up(most("borne_largest_deg"), 0),
            "delay": up(most("overload_delay_ms"), 1)}


@entry("as-built-loads-library", "steadystep-sil campaign as-built-loads --seeds 1001-1004 --set motor=MOTOR",
       Cost.CAMPAIGN, probe=("campaign as-built-loads --seeds 1001-1002 --json --set motor=17hs4417",))
def loads_library(sources):
    runs = [campaign(sources, "as-built-loads", "1001-1004", "--set", f"motor={motor}")
            for motor in accepted_motors()]
    held = sum(run["verdicts"].get("held", 0) for run in runs)
    return {"held": f"{held}", "runs": f"{4 * len(runs)}"}


@entry("stiff-belts", "steadystep-sil campaign as-built --seeds 1-24 --set motor=MOTOR "
       "--set plant.belt_frequency_Hz=HZ --set plant.belt_inertia_share=0.7 [--set drive.rotor_inertia_percent=30]",
       Cost.DEAR, probe=("campaign as-built --seeds 1-2 --json --set plant.belt_frequency_Hz=350 "
                         "--set plant.belt_inertia_share=0.7 --set drive.rotor_inertia_percent=30",))
def stiff_belts(sources):
    def held(motor, frequency_Hz, *given):
        run = campaign(sources, "as-built", "1-24", "--set", f"motor={motor}", "--set", "plant.belt_inertia_share=0.7",
                       "--set", f"plant.belt_frequency_Hz={frequency_Hz}", *given)
        return f"{run['verdicts'].get('held', 0)}"

    belts = ("170", "250", "350")
    rows = [[motor] + [f"{held(motor, belt)}, {held(motor, belt, '--set', 'drive.rotor_inertia_percent=30')}"
                       for belt in belts] for motor in ("bendjedia-2012", "23he22-2804s", "17hs4417", "sh2861-5141")]
    return {"table": table(["of 24 runs held: default, with the percentage", *(f"{belt} Hz" for belt in belts)], rows)}


@entry("belts-held", "steadystep-sil campaign as-built --seeds 1-8 --set motor=MOTOR [--set plant.belt_frequency_Hz=HZ "
       "--set plant.belt_inertia_share=SHARE] [--set drive.rotor_inertia_percent=30 | --set drive.law_bandwidth_rad_s=375]",
       Cost.DEAR, probe=("campaign as-built --seeds 1-2 --json --set plant.belt_frequency_Hz=200 "
                         "--set plant.belt_inertia_share=0.7 --set drive.rotor_inertia_percent=30",))
def belts_held(sources):
    """What tools/steadystep resonance proposes where the rotor's share is not known, and without a resonance."""
    def held(motor, *given):
        run = campaign(sources, "as-built", "1-8", "--set", f"motor={motor}", *given)
        return run["verdicts"].get("held", 0)

    def behind(motor, share, *given):
        return sum(held(motor, "--set", f"plant.belt_inertia_share={share}", "--set", f"plant.belt_frequency_Hz={belt}", *given)
                   for belt in ("60", "120", "200", "350"))

    percent, quicker = ("--set", "drive.rotor_inertia_percent=30"), ("--set", "drive.law_bandwidth_rad_s=375")
    shares = ("0.3", "0.5", "0.7")
    rows = [[motor, f"{held(motor)}, {held(motor, *quicker)}"]
            + [f"{behind(motor, share)}, {behind(motor, share, *percent)}" for share in shares]
            for motor in ("bendjedia-2012", "23he22-2804s", "17hs4417", "sh2861-5141")]
    return {"table": table(["held: default, as proposed", "rigid, of 8", *(f"{share} behind, of 32" for share in shares)], rows)}


@entry("as-built-long", "steadystep-sil campaign long-run --seeds 1-100 --set plant=as-built",
       Cost.CAMPAIGN, probe=("campaign long-run --seeds 1-4 --duration 10 --json --set plant=as-built",))
def long_run(sources):
    run = campaign(sources, "long-run", "1-100", *ON_IT)
    angle = run["figures"]["estimate_error_max_deg_electrical"]
    return {"held": f"{run['verdicts'].get('held', 0)}", "most": up(angle["percentile_95"], 0)}


@entry("as-built-library", "steadystep-sil campaign long-run --seeds 7001-7006 --duration 10 --set plant=as-built "
       "--set motor=MOTOR", Cost.DEAR,
       probe=("campaign long-run --seeds 7001-7001 --duration 5 --json --set plant=as-built --set motor=ms14ha1p4150",))
def library(sources):
    found = {}
    for name, numeric in (("", "float"), ("-fixed", "fixed")):
        runs = {motor: campaign(sources, "long-run", "7001-7006", "--duration", "10", *ON_IT, "--set", f"motor={motor}",
                                numeric=numeric)["verdicts"]
                for motor in accepted_motors()}
        held = {motor: verdicts.get("held", 0) for motor, verdicts in runs.items()}
        others = sorted((count, motor) for motor, count in held.items() if count < 6)
        found |= {"runs": f"{6 * len(held)}", f"held{name}": f"{sum(held.values())}",
                  f"others{name}": ", ".join(f"{motor} {count}" for count, motor in others) or "none"}
    return found


@entry("as-built", "steadystep-sil run bendjedia-fig12 hold-transition hold-transition-loaded "
       "--seeds 1-32 --set plant=as-built", Cost.DEAR,
       probe=("run bendjedia-fig12 hold-transition --json --set plant=as-built",))
def of_the_first_page(sources):
    def most(scenario, windows, metric="position_error_max_rad"):
        runs = sources.run(scenario, settings=AS_BUILT)
        return max((mrad(runs, metric, window) for window in windows), key=float)

    return {"estimate": most("bendjedia-fig12", ("move",), "estimate_error_max_rad"),
            "rest": most("hold-transition", RESTS[1:2]),
            "departure": most("hold-transition", RESTS[2:]),
            "transition": max((most(name, RESTS) for name in
                               ("hold-transition", "hold-transition-loaded")), key=float)}
