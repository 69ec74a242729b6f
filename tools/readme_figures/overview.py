"""README.md: the demonstration, the console, the limits at rest."""
import re

from comparison.simulator import ROOT, Refused
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


# What is typed, and when; enabling takes half a second.
DIALOGUE = ((0.05, "set resistance_ohm 0.40"), (0.10, "get hold_current_A"), (0.15, "enable"),
            (0.90, "set current_limit_A 2"), (0.95, "store"))
NEVER = "what no drive writes"


@entry("console", "steadystep-sil run SCENARIO with the same lines typed")
def console(sources):
    """A drive that does not write what is expected is shown with all that it has written."""
    runs = sources.run_text({
        "description": "a dialogue", "motor": "bendjedia-2012", "duration_s": 1.2,
        "event": [{"time_s": 0.01, "type": "disable"},
                  *({"time_s": time_s, "type": line} for time_s, line in DIALOGUE),
                  {"time_s": 1.1, "expect": NEVER}]}, "1-1")
    written = re.findall(r'"((?:ok|ready)[^"]*)"', runs[0]["failure"] or "")
    lines = written[written.index(next(line for line in written if line.startswith("ok set"))):]
    shown = []
    for _, typed in DIALOGUE:
        shown.append(f"> {typed}")
        if not lines or not lines[0].startswith(f"ok {typed.split()[0]}"):
            raise Refused(f"console: {typed}: answered by {lines[:1]}")
        shown.append(re.sub(r"(; at enable);.*", r"\1", lines.pop(0)))  # boards have no more words
        while lines and lines[0].startswith("ready"):
            shown.append(lines.pop(0))
    return "".join(f"    {line}\n" for line in shown)
