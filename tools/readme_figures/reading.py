"""Reads figures out of summaries of runs, and spells them."""
import math

from comparison.results import percentile_95


def value_of(summary, metric, window):
    """Of a window that is named, or that the scenario states as [begin, end]."""
    if window in summary["metrics"]:
        return summary["metrics"][window][metric]
    for one in (*summary["expectations"], *summary["reports"]):
        if one["metric"] == metric and one["window"] == window:
            return one["value"]
    raise ValueError(f"{summary['scenario']}: no {metric} of the window {window}")


def p95(runs, metric, window="move"):
    return percentile_95([value_of(run, metric, window) for run in runs])


def spelled(value, digits):
    return f"{value:,.{digits}f}"


def up(value, digits):
    """Rounded away from zero: for `within`."""
    return spelled(math.ceil(value * 10**digits - 1e-9) / 10**digits, digits)


def mrad(runs, metric, window="move", digits=1, rounded=up):
    return rounded(1e3 * p95(runs, metric, window), digits)
