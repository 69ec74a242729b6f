"""README.md: the demonstration, the limits at rest."""
import re

from comparison.simulator import ROOT
from readme_figures.reading import mrad, p95, up
from readme_figures.registry import entry

TIMES = re.compile(r"simulated in [^)]*\)")


@entry("demo", "build/sil/steadystep-sil run bendjedia-fig12 --numeric fixed")
def demo(sources):
    """As tools/demo prints it. How long it took says nothing of the drive: that stays as it is."""
    lines = sources.simulator("run", "bendjedia-fig12", "--numeric", "fixed").splitlines()
    last = next(place for place, line in enumerate(lines) if "slip_full_steps" in line)
    text = "".join(f"    {line}\n" for line in lines[:last + 1])
    stands = TIMES.search((ROOT / "README.md").read_text(encoding="utf-8"))
    return TIMES.sub(stands[0], text) if stands else text


@entry("load-at-rest", "steadystep-sil run standstill-load --seeds 1-32 --set drive.hold_current_A=3")
def load_at_rest(sources):
    runs = sources.run("standstill-load", settings={"drive.hold_current_A": 3.0})
    return mrad(runs, "position_error_max_rad", "0.15...0.6")


@entry("slow-load-at-rest", "steadystep-sil run SCENARIO --seeds 1-32: at rest, load_torque_Nm = 0.1, "
       "ramp_s = 0.2")
def slow_load_at_rest(sources):
    runs = sources.run_text({
        "description": "0.1 Nm at rest, slower than what the hold sees", "motor": "bendjedia-2012",
        "duration_s": 1.2, "plant": {"model": "bench"},
        "event": [{"time_s": 0.1, "load_torque_Nm": 0.1, "ramp_s": 0.2}]})
    return up(1e3 * p95(runs, "position_error_max_rad", "all"), 1)
