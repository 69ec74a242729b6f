"""hal/*/README.md and tests/target/README.md: memory and cycles of the images."""
import json
import re
import subprocess

from comparison.simulator import ROOT
from readme_figures.reading import spelled
from readme_figures.registry import Cost, entry, table
from readme_figures.sources import Missing

COMPILER = "12.2"  # arm-none-eabi-gcc of the figures: another makes other code
G474, G071 = "board-stm32g474", "board-stm32g071"
CLOCK_Hz = 170e6
CYCLES = ROOT / "tools/comparison/cycles.json"


def same_compiler(sources):
    version = sources.text("arm-none-eabi-gcc", "-dumpfullversion").strip()
    if not version.startswith(COMPILER + "."):
        raise Missing(f"the figures are of arm-none-eabi-gcc {COMPILER}, here is {version}")


def image(sources, preset):
    same_compiler(sources)
    return sources.built(f"{preset}/steadystep.elf", preset)


def run_on_board(sources, scenario):
    """Of the summary that the test board.run.<scenario> has left, if the image is not newer."""
    elf = image(sources, G474)
    file = sources.built(f"{G474}/tests/board/runs/{scenario}.json", G474)
    if file.stat().st_mtime < elf.stat().st_mtime:
        raise Missing(f"{file}: older than the image; run the tests of the preset {G474}")
    return json.loads(file.read_text(encoding="utf-8"))[0]["interrupt"]


def longest_paths(sources):
    elf = image(sources, G474)
    file = sources.built(f"{G474}/tests/board/longest-path.json", G474)
    if file.stat().st_mtime < elf.stat().st_mtime:
        raise Missing(f"{file}: older than the image; run the tests of the preset {G474}")
    return next(row for row in json.loads(file.read_text(encoding="utf-8")) if row["case"] == "any")


def us(cycles, digits=1):
    return spelled(cycles / CLOCK_Hz * 1e6, digits)


BOARD_RUNS = [("state feedback without encoder", "bendjedia-fig12"),
              ("default with encoder", "default-law-move"),
              ("with standstill pulses", "standstill-pulses")]


@entry("interrupt", f"ctest --preset {G474} -R 'board.(run|budget)'")
def interrupt(sources):
    rows = []
    for title, scenario in BOARD_RUNS:
        total = run_on_board(sources, scenario)["total_cycles"]
        ccm = total["worst_ccm"]["worst"]
        rows.append([f"{title} (`{scenario}`)",
                     f"{total['nominal']['mean']:,.0f}, {total['nominal']['worst']:,}",
                     f"{ccm:,}, {us(ccm)} µs", f"{total['worst_flash']['worst']:,}"])
    bound = longest_paths(sources)
    rows.append(["longest path of any law, statically (`tools/longest_path`)",
                 f"{bound['nominal']:,}", f"{bound['worst_ccm']:,}, {us(bound['worst_ccm'])} µs",
                 f"{bound['worst_flash']:,}"])
    first = run_on_board(sources, BOARD_RUNS[0][1])
    stages = {name: columns["nominal"]["mean"] for name, columns in first["stage_cycles"].items()}
    around = [stages["sampling"], stages["outputs"], stages["cycle counts"]]
    rest = first["total_cycles"]["nominal"]["mean"] - sum(around)
    heads = ["", "nominal: mean, worst", "worst case, from CCM",
             "worst case, from flash without cache"]
    return {"table": table(heads, rows), "longest": us(bound["worst_ccm"]),
            "latency": f"{first['start_latency_cycles']['least']}",
            "stages": table(["sampling", "outputs, leaving", "cycles counted",
                             "the drive and what puts it together"],
                            [[f"{value:.0f}" for value in (*around, rest)]])}


def sizes(path):
    """Bytes of flash, and of those the ones that run from CCM SRAM."""
    from arm_image import memory  # wants pyelftools
    from arm_image.image import Image
    found = Image(path)
    ccm = sum(size for _, start, size, _, _ in found.sections if memory.region(start) == "ccm")
    return sum(len(data) for _, data in memory.loaded(path)), ccm


def kibibytes(size_B):
    return spelled(size_B / 1024, 1)


@entry("image", "tests/board/image_limits.py build/board-stm32g474/steadystep.elf")
def g474_sizes(sources):
    flash_B, ccm_B = sizes(image(sources, G474))
    return {"flash": kibibytes(flash_B), "ccm": kibibytes(ccm_B),
            "share": spelled(100 * ccm_B / 32768, 0)}


def size_of_image(sources):
    return "{} {}".format(*sizes(image(sources, G474)))


FEWER_LAWS = "STEADYSTEP_LAWS=state-feedback;pid;feedback-linearisation"
BY_CONSOLE = ("STEADYSTEP_LINK=OFF", "STEADYSTEP_MACHINE_IO=OFF")


def variant(sources, name, *options):
    """Sizes of the image with these options."""
    same_compiler(sources)
    folder = sources.build / f"figures-{name}"
    sources.text("cmake", "--preset", G474, "-B", folder, f"-DSTEADYSTEP_HOST_BUILD={sources.build}/sil",
                 *(f"-D{option}" for option in options), accepted=(0,))
    sources.text("cmake", "--build", folder, "--target", "steadystep", accepted=(0,))
    flash_B, ccm_B = sizes(folder / "steadystep.elf")
    return {"flash": kibibytes(flash_B), "ccm": kibibytes(ccm_B)}


@entry("image-fewer-laws", f'cmake --preset {G474} -B build/figures-fewer-laws -D"{FEWER_LAWS}"',
       Cost.DEAR, probe=(size_of_image,))
def fewer_laws(sources):
    return variant(sources, "fewer-laws", FEWER_LAWS)


@entry("image-by-console", f"cmake --preset {G474} -B build/figures-by-console "
       + " ".join(f"-D{option}" for option in BY_CONSOLE), Cost.DEAR, probe=(size_of_image,))
def by_console(sources):
    return {"flash": variant(sources, "by-console", *BY_CONSOLE)["flash"]}


@entry("picture-interrupt", "tools/interrupt_budget RUN... --longest-path FILE --plot FILE.png",
       probe=(lambda sources: json.dumps([run_on_board(sources, name)["total_cycles"]
                                          for _, name in BOARD_RUNS]),), picture="interrupt.png")
def interrupt_picture(sources):
    runs = sources.built(f"{G474}/tests/board/runs", G474)
    drawn = sources.build / "interrupt.png"
    sources.tool("interrupt_budget", *(runs / f"{name}.json" for _, name in BOARD_RUNS),
                 "--longest-path", runs.parent / "longest-path.json", "--plot", drawn)
    sources.keep_picture(drawn, "interrupt.png")
    return {}


@entry("g071", "build/sil/tests/stm32g071_run build/board-stm32g071/steadystep.elf")
def g071(sources):
    elf = image(sources, G071)
    text = sources.text(sources.built("sil/tests/stm32g071_run", "sil"), elf)
    row = {name: re.search(rf"^ +{name} +mean +([\d.]+) .*worst +(\d+) .*flash +(\d+)", text, re.M)
           for name in ("whole", "sampling", "outputs", "other")}
    latency = re.search(r"latency from the peak: mean ([\d.]+), worst (\d+)", text)
    blocks = int(re.search(r"blocks of the drive: at most (\d+) cycles", text)[1])

    def line(title, *cycles, bold=False):
        cells = [" / ".join(f"{value:,.0f}" for value in cycles),
                 " / ".join(spelled(value / 64, 1) for value in cycles)]
        return [title, *(f"**{cell}**" if bold else cell for cell in cells)]

    mean, worst, flash = float(row["whole"][1]), int(row["whole"][2]), int(row["whole"][3])
    rows = [line("**control cycle** (blocks of the drive), worst, at most", blocks, bold=True),
            line("whole control interrupt, mean", mean),
            line("whole control interrupt, **worst**", worst, bold=True),
            line("of that: entry and reading", int(row["sampling"][2])),
            line("of that: writing and return", int(row["outputs"][2])),
            line("of that: around the drive", float(row["other"][1])),
            line("peak to the first instruction, mean / worst", float(latency[1]), int(latency[2])),
            line("from flash, 4 wait states per line (this chip has 2), no cache", flash)]
    return {"table": table(["", "cycles", "µs"], rows), "worst-us": spelled(worst / 64, 1),
            "end-us": spelled((worst + int(latency[2])) / 64, 0)}


@entry("g071-memory", "tools/stack_bound build/board-stm32g071/steadystep.elf")
def g071_memory(sources):
    from arm_image import memory
    elf = image(sources, G071)
    sections = section_sizes(elf)
    flash = 1024 * int(re.search(r"FLASH .* (\d+)K\n",
                                 (ROOT / "hal/stm32g071/memory.ld").read_text(encoding="utf-8"))[1])
    used = re.search(r"stack: (\d+) bytes used",
                     sources.text(sources.built("sil/tests/stm32g071_run", "sil"), elf))[1]
    bound = re.findall(r"(\d+) B in all", sources.tool("stack_bound", elf))[-1]
    loaded = sum(len(data) for _, data in memory.loaded(elf))
    fast = sections[".ram_code"] + sections[".unpacked.interrupt"]
    data = sum(sections[name] for name in (".data", ".bss", ".no_init"))
    return table(["memory", "bytes", "of"], [
        ["flash, with the code that runs from RAM, packed", f"{loaded:,}",
         f"{flash:,} ({128 * 1024 - flash:,} more are the store)"],
        ["RAM: code and tables of the interrupt", f"{fast:,}", ""],
        ["RAM: data", f"{data:,}", ""],
        ["RAM: stack, used in the run / static bound", f"{int(used):,} / {int(bound):,}",
         f"{sections['.stack']:,} (36,864 in all)"]])


def section_sizes(elf):
    listed = subprocess.run(["arm-none-eabi-size", "-A", elf], capture_output=True, text=True,
                            check=True).stdout
    return {name: int(size) for name, size in re.findall(r"^(\.[\w.]+)\s+(\d+)\s", listed, re.M)}


def counted(rows):
    """{(core, format, law): row}"""
    return {(row["core"], row["numeric"], row["law"]): row for row in rows}


# The default law and the heaviest, in the format that a board is flashed with, as tools/test counts them.
QUICK = tuple(f"{image} {law}" for image in ("m4f float", "m0plus fixed")
              for law in ("default-sensorless", "feedback-linearisation"))
# The other formats, which tools/test --full counts.
VARIANTS = ("m4f fixed default-sensorless", "m4f fixed feedback-linearisation",
            "one_motor default-sensorless")


def only(rows):
    return [word for text in rows for word in ("--only", text)]


def quick_rows(sources):
    same_compiler(sources)
    elf = sources.built("arm-m4f/tests/target/replay_default-sensorless_float.elf", "arm-m4f")
    file = sources.build / "cycles.json"  # of tools/cycles --write, in tools/test
    if not file.exists() or file.stat().st_mtime < elf.stat().st_mtime:
        sources.tool("cycles", *only(QUICK), "--write", file)
    return counted(json.loads(file.read_text(encoding="utf-8")))


def probe_of_cycles(sources):
    return json.dumps([row["worst_cycles"] for row in quick_rows(sources).values()])


def figures_of_counts(named):
    found = {}
    for name, row in named:
        found[name] = f"{row['worst_cycles']:,}"
        if not name.endswith("fixed") and name != "one-motor":
            found[f"{name}-us"] = f"{row['worst_us']:.1f}"
        if not name.startswith("encoder"):
            found[f"{name}-mean"] = f"{row['mean_cycles']:,}"
        found[f"{name}-bound"] = f"{row['must_cycles']:,}"
    return found


@entry("cycles", f"tools/cycles --only {' --only '.join(map(repr, QUICK))}")
def cycles(sources):
    rows = quick_rows(sources)
    float_row, small = (rows[tuple(QUICK[n].split())] for n in (0, 2))
    found = figures_of_counts((name, rows[tuple(row.split())]) for name, row in
                              zip(("float", "encoder-float", "m0plus", "encoder-m0plus"), QUICK))
    return found | {"float-mean-bound": f"{float_row['must_mean_cycles']:,}",
                    "ram": kibibytes(float_row["ram_B"]),
                    "start-up": spelled(float_row["start_up_ms"], 0),
                    "start-up-m0plus": spelled(small["start_up_ms"], 0)}


@entry("cycles-variants", f"tools/cycles --only {' --only '.join(map(repr, VARIANTS))}", Cost.DEAR,
       probe=(probe_of_cycles,))
def cycles_of_variants(sources):
    """Fixed point on the M4F, and the images for one motor."""
    same_compiler(sources)
    rows = counted(json.loads(sources.tool("cycles", *only(VARIANTS), "--json")))
    default, encoder = "default-sensorless", "feedback-linearisation"
    return figures_of_counts((("fixed", rows["m4f", "fixed", default]),
                              ("encoder-fixed", rows["m4f", "fixed", encoder]),
                              ("one-motor", rows["m4f", "one_motor", default]),
                              ("one-motor-m0plus", rows["m0plus", "one_motor", default])))


# Before the estimator's prediction became what the control answers to, by block: M4F float at worst and
# in motion, and the whole interrupt on the virtual board, its idle periods included.
BEFORE = {"sampling": (None, None, 394), "measurement": (40, 40, 40), "state machine": (128, 25, 22),
          "estimator": (327, 338, 349), "reference": (122, 125, 86), "position law": (109, 109, 75),
          "current control": (86, 86, 85), "modulator": (110, 110, 105), "protection": (39, 39, 38),
          "outputs": (None, None, 93), "cycle counts": (None, None, 112), "other": (72, 94, 137)}
OF_BLOCK = {"estimator": "estimator, prediction", "position law": "position law, hold",
            "modulator": "modulator, loss, bus", "protection": "protection, synchronism monitor",
            "outputs": "outputs, leaving", "cycle counts": "cycles counted", "other": "what puts them together"}
BLOCK_ROW = "m4f float default-sensorless"


@entry("cycle-blocks", f'tools/cycles --blocks --only "{BLOCK_ROW}"; ctest --preset {G474} -R board.run')
def cycle_blocks(sources):
    """Of the default without encoder, in float."""
    same_compiler(sources)
    row, = json.loads(sources.tool("cycles", "--blocks", "--json", "--only", BLOCK_ROW))
    on_board = run_on_board(sources, BOARD_RUNS[0][1])["stage_cycles"]
    now = (row["blocks"]["worst"], row["blocks"]["mean"],
           {name: columns["nominal"]["mean"] for name, columns in on_board.items()})

    def line(title, names, before):
        sums = [sum(of[name] for name in names) for of in now]
        return [title, *(f"{old:,} → {new:,.0f}" if old else f"{new:,.0f}" if new else "–"
                         for old, new in zip(before, sums))]

    lines = [line(OF_BLOCK.get(name, name), (name,), before) for name, before in BEFORE.items()]
    sums = [sum(filter(None, column)) for column in zip(*BEFORE.values())]
    lines.append(line("in all", tuple(BEFORE), sums))
    return {"table": table(["block", "worst", "mean", "whole interrupt on the board, mean"], lines)}


OBSERVED = "what all laws with an encoder share: the observer, the frames for three currents, " \
           "the whole voltage path"
BESIDES = {"csmc-equivalent": "the equivalent control",
           "csmc-servo": "three oscillators that need 32-bit coefficients",
           "feedback-linearisation": "600 cycles of detent compensation (six coefficients learned "
                                     "and played), the exact inverse of the winding, two "
                                     "disturbance observers"}


def why(law, first):
    return (OBSERVED if first else "the same") + (f", and {BESIDES[law]}" if law in BESIDES else "")


@entry("cycles-all", "tools/cycles --json > tools/comparison/cycles.json", Cost.DEAR,
       probe=(probe_of_cycles,))
def cycles_of_all(sources):
    """The comparison's page takes its cycles from the same file."""
    same_compiler(sources)
    rows = json.loads(sources.tool("cycles", "--json"))
    if sources.draws:
        CYCLES.write_text(json.dumps(rows, indent=2) + "\n", encoding="utf-8")
    rows = counted(rows)

    defaults = ("default-sensorless", "feedback-linearisation")
    preempted = ("references", "encoder-references")

    def span(core, numeric, key, digits):
        values = sorted(row[key] for (of, form, law), row in rows.items()
                        if (of, form) == (core, numeric) and law not in defaults + preempted)
        return f"{values[0]:,.{digits}f} to {values[-1]:,.{digits}f}"

    beyond = sorted(((row["worst_cycles"], law) for (core, numeric, law), row in rows.items()
                     if (core, numeric) == ("m0plus", "fixed") and row["worst_us"] > 45
                     and law not in preempted))
    lines = [[law, f"{count:,}", spelled(count / 64, 1),
              why(law, place == 0)]
             for place, (count, law) in enumerate(beyond)]
    return {"float": span("m4f", "float", "worst_cycles", 0),
            "fixed": span("m4f", "fixed", "worst_cycles", 0),
            "m0plus": span("m0plus", "fixed", "worst_us", 0),
            "m0plus-table": table(["law on the Cortex-M0+", "cycles", "us", "why"], lines)} | {
                f"{law}-{core if core == 'm0plus' else numeric}": f"{row['worst_cycles']:,}"
                for (core, numeric, law), row in rows.items()
                if law in preempted and numeric != "one_motor"}
