"""Runs the comparison and holds its figures: law x plant x move."""
import concurrent.futures
import math
import shutil
from typing import NamedTuple

from comparison.experiment import parameters_for, scenarios_for
from comparison.simulator import Refused
from comparison.tuning import figures_of, is_lost, settings_by_motor


class Entry(NamedTuple):
    """A law of the comparison: its name in tables, and what it is run with."""
    name: str
    law: str
    parameters: object  # file of the parameter set; None: the drive's default bandwidths
    note: str           # what there is to say about them; ""
    settings: dict      # on top


class Cell(NamedTuple):
    """One law on one move and plant, over the seeds."""
    figures: dict    # metric -> 95th percentile over the seeds, SI; None: no value
    lost: str        # "lost" or "fault" if one run ended so; "" if none did
    refused: str     # why it did not run; ""
    reproduce: str


def entries_of(laws, motor, folder=None):
    entries = []
    for law in laws:
        file, note = parameters_for(law, motor, folder)
        tuned_for_this_motor = file is not None and not note
        settings = {} if tuned_for_this_motor else settings_by_motor(law, motor)
        entries.append(Entry(law, law, file, note, settings))
    return entries


def percentile_95(values):
    """As the simulator judges seeds: the worst up to 19 of them; no value is the worst of all."""
    ordered = sorted(math.inf if value is None else value for value in values)
    worst = ordered[(95 * len(ordered) + 99) // 100 - 1]
    return None if math.isinf(worst) else worst


def how_lost(runs, motor):
    if any(run["failure"] is not None or run["metrics"]["all"]["fault"] != "none" for run in runs):
        return "fault"
    return "lost" if any(is_lost(run, motor.full_step_rad) for run in runs) else ""


def cell_of(runs, motor):
    figures = [figures_of(run) for run in runs]
    return Cell({metric: percentile_95([one[metric] for one in figures]) for metric in figures[0]},
                how_lost(runs, motor), "", runs[0]["reproduce"])


class Comparison:
    def __init__(self, simulator, motor, entries, moves, plants, seeds, folder):
        self.simulator, self.motor, self.seeds = simulator, motor, seeds
        self.entries, self.moves, self.plants = entries, moves, plants
        self.scenarios = scenarios_for(moves, motor, folder / "scenarios")
        self.traces = folder / "traces"
        self.cells = {}  # (entry, plant, move) by name -> Cell

    def trace(self, entry, move):
        """Folder of the nominal run of seed 1 that the plots are drawn from."""
        return self.traces / entry.name / move.scenario

    def _run(self, entry, plant, with_trace):
        how = {"parameters": entry.parameters,
               "settings": {"drive.law": entry.law, **plant.settings, **entry.settings}}
        places = [self.scenarios[move.name] for move in self.moves]
        if with_trace:
            shutil.rmtree(self.traces / entry.name, ignore_errors=True)  # of a former run
            self.simulator.run_each(places, **how, out=self.traces / entry.name,
                                    trace="npy")
        return [Cell({}, "", str(runs), "") if isinstance(runs, Refused)
                else cell_of(runs, self.motor)
                for runs in self.simulator.run_each(places, **how, seeds=self.seeds)]

    def run(self, jobs, with_traces, say):
        """Fills `cells`; the same figures with any number of jobs."""
        tasks = [(entry, plant) for entry in self.entries for plant in self.plants]
        with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
            results = pool.map(lambda task: self._run(*task, with_traces
                                                      and task[1].name == "nominal"), tasks)
            for (entry, plant), cells in zip(tasks, results):
                say(f"{entry.name}, plant {plant.name}")
                for move, cell in zip(self.moves, cells):
                    self.cells[entry.name, plant.name, move.name] = cell

    def refusals(self):
        """(law, where, text), once for a law that is refused on every plant and move."""
        found = {}
        for (name, plant, move), cell in self.cells.items():
            if cell.refused:
                found.setdefault((name, cell.refused), []).append((plant, move))
        for (name, text), places in found.items():
            where = [what + ", ".join(dict.fromkeys(place[i] for place in places))
                     for i, (what, all_of_them) in enumerate((("plant ", self.plants),
                                                              ("move ", self.moves)))
                     if len({place[i] for place in places}) < len(all_of_them)]
            yield name, "; ".join(where), text

    def untuned(self):
        """A sentence on the laws whose parameters were not tuned for this motor; ""."""
        notes = {}
        for entry in self.entries:
            if entry.note:
                notes.setdefault(entry.note, []).append(entry.name)
        said = [f"{', '.join(names)}: {note}" for note, names in notes.items()]
        return (f"Not tuned for {self.motor.id}, so no statement about these laws on it: "
                f"{'; '.join(said)}." if said else "")

    def cell(self, entry, plant, move):
        return self.cells[entry.name, plant.name, move.name]
