"""The comparison as one self-contained HTML page: tables, pictures, conditions, how to read it."""
import base64
import html
import tomllib

from comparison import tuning
from comparison.experiment import PLANTS
from comparison.table import column, main_columns, mismatch_columns

STYLE = """
body { font: 15px/1.5 "Helvetica Neue", Helvetica, Arial, sans-serif; color: #1a1a1a;
       margin: 0 auto; padding: 1.5em 2em 4em; max-width: 1236px; background: #fff; }
h1 { font-size: 1.7em; margin: 0 0 .1em; } h2 { font-size: 1.2em; margin: 2.2em 0 .5em;
     border-bottom: 2px solid #1a1a1a; padding-bottom: .15em; }
p { max-width: 62em; } .quiet { color: #666; font-size: .9em; }
.wide { overflow-x: auto; } table { border-collapse: collapse; font-size: .8em;
       font-variant-numeric: tabular-nums; }
th, td { padding: .3em .32em; text-align: right; } td { white-space: nowrap; }
th:first-child, td:first-child { text-align: left; }
thead th { font-weight: 600; vertical-align: bottom; }
thead tr:first-child th { text-align: center; border-bottom: 1px solid #999; }
tbody tr { border-top: 1px solid #e2e2e2; } tbody tr:nth-child(even) { background: #fafafa; }
tr.home td { background: #eaf3fb; font-weight: 600; }
td.first, th.first { border-left: 1px solid #bbb; }
td.best { color: #006b4f; font-weight: 700; } td.lost { color: #b2182b; }
span.swatch { display: inline-block; width: .8em; height: .8em; margin-right: .5em; }
img { max-width: 100%; height: auto; } pre { background: #f6f6f6; padding: .8em 1em;
      overflow-x: auto; font-size: .82em; line-height: 1.4; }
dt { font-weight: 600; margin-top: .5em; } dd { margin: 0 0 0 1.2em; }
details { margin: .3em 0; } summary { cursor: pointer; }
.narrow { display: none; } .narrow table { width: 100%; margin-bottom: 1.2em; }
pre { white-space: pre-wrap; } code, pre, td.words { overflow-wrap: anywhere; }
td.words { white-space: normal; }
@media (max-width: 900px) { .wide { display: none; } .narrow { display: block; }
       body { padding: .8em 1em 3em; } h1 { font-size: 1.35em; } dd { margin-left: .6em; }
       .narrow td:first-child { white-space: normal; } table { font-size: .86em; } }
@media print { body { max-width: none; padding: 0; font-size: 11px; } h2 { break-after: avoid; }
               img { break-inside: avoid; } details { display: none; } }
"""

NARROW = "max-width: 900px"
NARROW_COLUMNS = 3  # that a telephone shows beside the law's name
LONGEST_CELL = 24   # beyond, a cell is words

# What tools/cycles calls a law where it counts it in another configuration.
CYCLES_OF = {"state-feedback": "default-sensorless"}

HOW_TO_READ = """
<p>Every law runs as the drive's own firmware on the same simulated board, with the same encoder,
observer structure, angle advance, voltage limit, loss compensation and calibrated series
resistance; its bandwidths were found by the same optimiser with the same budget and cost, with
detent learning and without, of which it has what costs less. What differs between two rows is the
law.</p>
<p>Errors are reference minus true angle. The rms counts from 0.03 s on (sine: 0.3 s), so that the
load's arrival at time zero does not weigh in. The step is a raw one: laws that live from a smooth
reference are at no advantage there. <b>Ripple</b> is the rms of the q current about its mean over
2 ms: what a loop makes of noise, as heat and sound. A lower error bought with more ripple is not a
better law; tuning allows {ripple:.2g} A. <b>Lost</b> means that the rotor did not end where it
should, <b>fault</b> that the drive opened the bridge. Figures are the worst of the seeds (95th percentile above 19).</p>
<p>What this cannot show: it is simulation, with one motor model that was not fitted to a motor on
a bench. Each law was tuned once, from one seed: do not read much into small differences. The
encoder's resolution of {lsb:.3g} mrad is of the size of the smallest errors.</p>
"""


def cell_html(tag, text, classes=()):
    attribute = f' class="{" ".join(classes)}"' if classes else ""
    return f"<{tag}{attribute}>{html.escape(text)}</{tag}>"


def in_both(whole, parts):
    """A table for a wide page, and the same in parts for a narrow one."""
    return f'<div class="wide">{whole}</div><div class="narrow">{"".join(parts)}</div>'


def grouped_table(names, columns, home_law, colours=None):
    groups = {}
    for one in columns:
        groups.setdefault(one.group, []).append(one)
    return in_both(table_of(names, columns, home_law, colours),
                   [part for group in groups.values()
                    for part in (table_of(names, group[first:first + NARROW_COLUMNS], home_law,
                                          colours)
                                 for first in range(0, len(group), NARROW_COLUMNS))])


def table_of(names, columns, home_law, colours):
    top, second = ["<th></th>"], ["<th>law</th>"]
    starts = [i == 0 or columns[i - 1].group != one.group for i, one in enumerate(columns)]
    for i, one in enumerate(columns):
        if starts[i]:
            span = 1
            while i + span < len(columns) and not starts[i + span]:
                span += 1
            top.append(f'<th class="first" colspan="{span}">{html.escape(one.group)}</th>')
        second.append(cell_html("th", one.heading, ["first"] if starts[i] else []))
    rows = []
    for row, name in enumerate(names):
        swatch = (f'<span class="swatch" style="background:{colours[name]}"></span>'
                  if colours else "")
        cells = [f"<td>{swatch}{html.escape(name)}</td>"]
        for i, one in enumerate(columns):
            text = one.texts[row]
            classes = (["first"] if starts[i] else []) + (["best"] if one.bold == row else []) + (
                ["lost"] if text in ("lost", "fault", "refused") else [])
            cells.append(cell_html("td", text, classes))
        home = ' class="home"' if name == home_law else ""
        rows.append(f"<tr{home}>{''.join(cells)}</tr>")
    return (f'<table><thead><tr>{"".join(top)}</tr><tr>{"".join(second)}</tr>'
            f"</thead><tbody>{''.join(rows)}</tbody></table>")


def plain_table(headings, rows):
    """The first column names the rows, in every part of it."""
    def part(begin, end):
        def line(tag, cells):
            shown = [cells[0], *cells[begin:end]]
            return "<tr>" + "".join(cell_html(tag, cell, ["words"] if len(cell) > LONGEST_CELL else [])
                                    .replace("_", "_<wbr>") for cell in shown) + "</tr>"

        return (f'<table><thead>{line("th", headings)}</thead>'
                f'<tbody>{"".join(line("td", row) for row in rows)}</tbody></table>')

    return in_both(part(1, len(headings)), [part(begin, begin + NARROW_COLUMNS)
                                            for begin in range(1, len(headings), NARROW_COLUMNS)])


def costs_section(comparison, plant):
    """Current and voltage, move by move."""
    columns = []
    for move in comparison.moves:
        cells = [comparison.cell(entry, plant, move) for entry in comparison.entries]
        columns += [column(move.name, heading, cells, metric, 1, digits,
                           comparison.motor.full_step_rad)._replace(bold=None)
                    for metric, heading, digits in (("current_ripple_rms_A", "ripple A", 3),
                                                    ("current_rms_A", "current A", 2),
                                                    ("voltage_rms_V", "voltage V", 2))]
    return grouped_table([entry.name for entry in comparison.entries], columns, None)


def cycles_section(comparison, cycles):
    if not cycles:
        return "<p>Not counted in this run: <code>tools/cycles --json</code>.</p>"
    by_law = {}
    for row in cycles:
        by_law.setdefault(row["law"], {})[row["core"], row["numeric"]] = row
    targets = sorted({(row["core"], row["numeric"]) for row in cycles})
    rows = []
    for entry in comparison.entries:
        known = by_law.get(entry.law, by_law.get(CYCLES_OF.get(entry.law), {}))
        row = [entry.name]
        for target in targets:
            one = known.get(target)
            row += ([f"{one['worst_cycles']:.0f}", f"{one['worst_us']:.1f}"] if one
                    else ["–", "–"])
        rows.append(row)
    headings = ["law"] + [f"{core} {numeric}: {what}" for core, numeric in targets
                          for what in ("cycles", "µs")]
    return plain_table(headings, rows)


def parameters_section(comparison):
    """A table of the numbers, and each set's own words on how they were found."""
    sets, words = {}, []
    for entry in comparison.entries:
        if entry.parameters is None:
            sets[entry.name] = {}
            continue
        text = entry.parameters.read_text(encoding="utf-8")
        drive = tomllib.loads(text)["drive"]
        gains = drive.pop("law_gains", {})
        sets[entry.name] = {**drive, **gains, **entry.settings}
        comment = "\n".join(line.removeprefix("#").removeprefix(" ")
                            for line in text.splitlines() if line.startswith("#"))
        words.append(f"<details><summary>{html.escape(entry.name)}: how it was tuned</summary>"
                     f"<pre>{html.escape(comment)}</pre></details>")
    keys = sorted({key for one in sets.values() for key in one if key != "law"})
    rows = [[entry.name] + [text_of_setting(sets[entry.name].get(key)) for key in keys]
            + [entry.note] for entry in comparison.entries]
    return plain_table(["law", *keys, ""], rows) + "".join(words)


def text_of_setting(value):
    if value is None:
        return "–"
    return f"{value:g}" if isinstance(value, (int, float)) and not isinstance(value, bool) else (
        str(value).lower() if isinstance(value, bool) else str(value))


def best_of(comparison, plant):
    """One sentence on who leads where."""
    parts = []
    for move in comparison.moves:
        figures = {}
        for entry in comparison.entries:
            cell = comparison.cell(entry, plant, move)
            value = cell.figures.get("position_error_rms_rad")
            if value is not None and not cell.lost:
                figures[entry.name] = 1e3 * value
        if figures:
            name = min(figures, key=figures.get)
            parts.append(f"{move.name} {html.escape(name)} ({figures[name]:.3g} mrad)")
    return "Smallest rms error: " + ", ".join(parts) + "." if parts else ""


def conditions(comparison, numeric):
    motor = comparison.motor
    first, last = comparison.seeds
    plants = "".join(f"<dt>{one.name}</dt><dd>{html.escape(one.title)}</dd>"
                     for one in PLANTS if one in comparison.plants)
    moves = "".join(f"<dt>{one.name}</dt><dd>{html.escape(one.title)}; scenario "
                    f"<code>{html.escape(str(comparison.scenarios[one.name]))}</code></dd>"
                    for one in comparison.moves)
    return (f"<p>Motor {html.escape(motor.id)}: rated {motor.rated_current_A:g} A, "
            f"{motor.rated_torque_Nm:.3g} N·m; the supply drives the rated current up to "
            f"{motor.rated_speed_rad_s:.0f} rad/s; the rated torque accelerates the rotor at "
            f"{motor.rated_acceleration_rad_s2:.0f} rad/s². Control period 100 µs, one period of "
            f"delay; firmware in {numeric}; seeds {first} to {last}.</p>"
            f"<h3>Moves</h3><dl>{moves}</dl><h3>Plants</h3><dl>{plants}</dl>")


def refusals(comparison):
    return "".join(f'<p class="quiet">{html.escape(name)} was refused'
                   f"{where and ' on ' + where}: {html.escape(text)}</p>"
                   for name, where, text in comparison.refusals())


def page(comparison, *, pictures, cycles, ablation, command, version, numeric, home_law, colours):
    names = [entry.name for entry in comparison.entries]
    nominal = comparison.plants[0]
    # The encoder of the scenarios: 16384 counts per turn.
    read = HOW_TO_READ.format(ripple=tuning.RIPPLE_LIMIT * comparison.motor.rated_current_A,
                              lsb=1e3 * 2 * 3.141592653589793 / 16384)
    parts = [
        f"<h1>Position laws compared: {html.escape(comparison.motor.id)}</h1>",
        f'<p class="quiet">{html.escape(version)}; made by <code>{html.escape(command)}</code></p>',
        f"<p>{best_of(comparison, nominal)} {html.escape(comparison.untuned())}</p>",
        f"<h2>Figures, plant {nominal.name}</h2>",
        grouped_table(names, main_columns(comparison, nominal), home_law, colours),
        refusals(comparison),
        '<p class="quiet">Best of each column in green; the drive\'s default law is shaded.</p>',
        "<h2>How to read this</h2>", read]
    if len(comparison.plants) > 1:
        parts += ["<h2>When the motor is not what the drive believes: position error rms, mrad</h2>",
                  grouped_table(names, mismatch_columns(comparison), home_law, colours)]
    if ablation:
        parts += ["<h2>What each part of the default law is worth</h2>", ablation]
    for move, *drawn in pictures:
        wide, narrow = ("data:image/png;base64," + base64.b64encode(one).decode("ascii")
                        for one in drawn)
        parts += [f"<h2>{html.escape(move.title[0].upper() + move.title[1:])}</h2>",
                  f'<picture><source media="({NARROW})" srcset="{narrow}">'
                  f'<img alt="position error of every law, {html.escape(move.title)}" '
                  f'src="{wide}"></picture>']
    parts += ["<h2>Current and voltage</h2>",
              "<p>rms of one phase; ripple of the q current.</p>",
              costs_section(comparison, nominal),
              "<h2>Time in the control interrupt</h2>",
              "<p>Worst case of the whole control interrupt, executed instructions times published "
              "timings; M4F at 170 MHz, M0+ at 64 MHz.</p>",
              cycles_section(comparison, cycles),
              "<h2>Parameter sets</h2>", parameters_section(comparison),
              "<h2>Conditions</h2>", conditions(comparison, numeric)]
    body = "\n".join(parts)
    return (f'<!DOCTYPE html>\n<html lang="en"><head><meta charset="utf-8">'
            '<meta name="viewport" content="width=device-width, initial-scale=1">'
            f"<title>Position laws compared: {html.escape(comparison.motor.id)}</title>"
            f"<style>{STYLE}</style></head><body>\n{body}\n</body></html>\n")
