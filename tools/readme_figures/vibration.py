"""firmware/README.md: the oscillating load that is borne. tools/README.md: the envelope."""
import json
import math

from readme_figures.registry import Cost, entry


@entry("vibration", "tools/vibration", Cost.DEAR, picture="vibration.png",
       probe=("run vibration-at-rest --json", "run vibration-at-rest --json --set plant.model=real"))
def vibration(sources):
    folder = sources.build / "vibration"
    sources.tool("vibration", "--program", sources.program, "--out", folder)
    sources.keep_picture(folder / "vibration.png", "vibration.png")
    rows = json.loads((folder / "table.json").read_text(encoding="utf-8"))
    found = {}
    for state in ("at rest", "in motion"):
        least = min((row for row in rows if row["state"] == state), key=lambda row: row["borne_share"])
        name = state.replace(" ", "-")
        found |= {name: f"{math.floor(100 * least['borne_share'] + 1e-9)}", f"{name}-Hz": f"{least['frequency_Hz']:.0f}",
                  f"{name}-plant": f"`{least['plant']}`"}
    return found


def keep_envelope(sources, plant, name):
    folder = sources.build / f"envelope-{plant}"
    sources.tool("envelope", "--plant", plant, "--program", sources.program, "--out", folder)
    sources.keep_picture(folder / "envelope.png", name)
    return {}


@entry("picture-envelope", "tools/envelope", Cost.CAMPAIGN, picture="envelope.png",
       probe=("run load-step hold-transition --json --set plant.model=as-built",
              "run load-step --json --set plant.model=as-built --set plant.km_scale=0.9"))
def envelope(sources):
    return keep_envelope(sources, "as-built", "envelope.png")


@entry("picture-envelope-bench", "tools/envelope --plant bench", Cost.CAMPAIGN, picture="envelope-bench.png",
       probe=("run load-step hold-transition --json --set plant.model=bench",
              "run load-step --json --set plant.model=bench --set plant.km_scale=0.9"))
def envelope_on_bench(sources):
    return keep_envelope(sources, "bench", "envelope-bench.png")
