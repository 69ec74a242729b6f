"""sil/scenarios/README.md: the experiments beside the papers."""
import json

from comparison.results import percentile_95
from readme_figures.reading import mrad, p95, spelled, up, value_of
from readme_figures.registry import entry

OBSERVER = "csmc-fig3 csmc-fig3-e300u csmc-fig3-e100u csmc-fig3-e30u csmc-fig3-e10u"
PLAIN = spelled


@entry("fig10", "steadystep-sil run bendjedia-fig10 --seeds 1-32")
def fig10(sources):
    runs = sources.run("bendjedia-fig10")
    return {"rest": mrad(runs, "position_error_max_rad", "0.5...0.7"),
            "estimate": mrad(runs, "estimate_error_max_rad"),
            "rms": mrad(runs, "estimate_error_rms_rad", digits=2, rounded=PLAIN)}


@entry("fig11", "steadystep-sil run bendjedia-fig11 bendjedia-fig11-feed-forward --seeds 1-32")
def fig11(sources):
    with_it = sources.run("bendjedia-fig11-feed-forward")
    steady = [abs(value_of(run, "position_error_steady_rad", "move"))
              for run in sources.run("bendjedia-fig11")]
    return {"lag": spelled(percentile_95(steady), 2),
            "feed-forward": mrad(with_it, "position_error_max_rad")}


@entry("fig12", "steadystep-sil run bendjedia-fig12 --seeds 1-32")
def fig12(sources):
    runs = sources.run("bendjedia-fig12")
    return {"estimate": mrad(runs, "estimate_error_max_rad"),
            "t90": up(1e3 * p95(runs, "load_torque_t90_s"), 1),
            "release": mrad(runs, "position_error_max_rad", "0.5...0.7")}


def worst(rows, figure, key, within=1.0):
    """In mrad, of a figure's rows whose parameter is at most `within` off."""
    values = [row[key] for row in rows
              if row["figure"] == figure and abs(row["scale"] - 1) <= within + 1e-9]
    return 1e3 * max(values)


@entry("robustness", "steadystep-sil sweep bendjedia-robustness --seeds 1-32")
def robustness(sources):
    folder = sources.out_of("sweep", "bendjedia-robustness", "--seeds", "1-32")
    rows = json.loads((folder / "table.json").read_text(encoding="utf-8"))["rows"]
    largest, rms = "estimate_error_max_rad", "estimate_error_rms_rad"
    figures = {"fig13": worst(rows, "Fig 13", largest, 0.1), "fig14": worst(rows, "Fig 14", largest),
               "fig15": worst(rows, "Fig 15", largest), "fig19": worst(rows, "Fig 19", largest),
               "fig16-17": max(worst(rows, name, largest) for name in ("Fig 16", "Fig 17"))}
    figures["all"] = max(figures.values())
    return {**{name: up(value, 1) for name, value in figures.items()},
            "fig19-rms": spelled(worst(rows, "Fig 19", rms), 2)}


@entry("fig18", "steadystep-sil run bendjedia-fig18 bendjedia-fig18-minus-10 --seeds 1-32")
def fig18(sources):
    return {name: spelled(1e3 * p95(sources.run(scenario), "settling_time_s", "all"), 1)
            for name, scenario in (("plus", "bendjedia-fig18"), ("minus", "bendjedia-fig18-minus-10"))}


@entry("paper-filter", "steadystep-sil run bendjedia-paper-ekf --seeds 1-32")
def paper_filter(sources):
    return mrad(sources.run("bendjedia-paper-ekf"), "estimate_error_max_rad")


@entry("csmc-steps", "steadystep-sil run csmc-fig2")
def csmc_steps(sources):
    runs = sources.run("csmc-fig2", "1-1")
    times = [1e3 * p95(runs, "settling_time_s", window) for window in ("0...0.499", "0.45...1")]
    return {"settling": " / ".join(spelled(time, 1) for time in times),
            "overshoot": spelled(100 * p95(runs, "overshoot_rad", "0...0.499") / 0.03142, 2)}


@entry("csmc-observer", f"steadystep-sil run {OBSERVER} --trace npy --out FOLDER")
def csmc_observer(sources):
    from comparison.trace import read_trace  # wants numpy
    names = OBSERVER.split()
    folder = sources.out_of("run", *names, "--trace", "npy")
    reference, *others = (read_trace(folder / name)["theta_rad"] for name in names)
    return ", ".join(f"{1e3 * max(abs(one - reference)):.3g}" for one in others)


@entry("csmc-sampled", "steadystep-sil run csmc-fig4-smc csmc-fig4")
def csmc_sampled(sources):
    ideal, csmc = (sources.run(name, "1-1") for name in ("csmc-fig4-smc", "csmc-fig4"))
    window = "0.4...0.5"
    return {"ideal": mrad(ideal, "position_error_rms_rad", window, 2, PLAIN),
            "ideal-V": spelled(p95(ideal, "voltage_q_peak_to_peak_V", window), 0),
            "csmc": f"{p95(csmc, 'position_error_max_rad', window):.0e}".replace("e-0", "e-"),
            "csmc-V": spelled(p95(csmc, "voltage_q_peak_to_peak_V", window), 2)}


@entry("csmc-sine", "steadystep-sil run csmc-fig5-without-servo")
def csmc_sine(sources):
    runs = sources.run("csmc-fig5-without-servo", "1-1")
    return f"{1e4 * p95(runs, 'position_error_max_rad', '4...8'):.1f}e-4"


@entry("stmms", "steadystep-sil run stmms-continuous")
def stmms(sources):
    runs = sources.run("stmms-continuous", "1-1")
    return f"{1e4 * p95(runs, 'position_error_rms_rad', '1.2...2.8'):.2f}e-4"


def pictured(name, scenario):
    @entry(f"picture-{name}", f"tools/plot --readme {name}", probe=(f"run {scenario} --json",),
           picture=f"{name}.png")
    def draw(sources):
        sources.tool("plot", "--readme", name, "--program", sources.program)
        return {}
    return draw


for figure, shown in (("fig10", "bendjedia-fig10"), ("fig11", "bendjedia-fig11"),
                      ("fig11-feed-forward", "bendjedia-fig11-feed-forward"),
                      ("fig12", "bendjedia-fig12")):
    pictured(figure, shown)


@entry("picture-fig13-19", "tools/plot --readme fig13-19", picture="fig13-19.png",
       probe=("run bendjedia-fig13 bendjedia-fig14 bendjedia-fig15 bendjedia-fig16 bendjedia-fig19"
              " --json",))
def fig13_19(sources):
    sources.tool("plot", "--readme", "fig13-19", "--program", sources.program)
    return {}
