"""Traces: text and doubles say the same, nothing half-written stays, and tools/plot reads either."""
import ast
import csv
import pathlib
import struct
import subprocess

from program import ROOT, SMALL, Checks, run, scratch

CHECKS = Checks()
ENABLING = "record_enabling = true\n" + SMALL


def run_small(folder, text, *arguments):
    (folder / "small.toml").write_text(text, encoding="utf-8")
    return run("run", "small.toml", *arguments, "--out", "out", cwd=folder)


def written(folder):
    return sorted(path.name for path in (folder / "out/small").iterdir())


def text_trace(file):
    with open(file, encoding="utf-8", newline="") as lines:
        head, *rows = csv.reader(lines)
    return head, [[float(cell) for cell in row] for row in rows]


def binary_trace(file):
    """Without NumPy: what the format says of itself (NEP 1)."""
    whole = file.read_bytes()
    CHECKS.that(whole[:8] == b"\x93NUMPY\x01\x00", f"NumPy's format, version 1.0: {whole[:8]}")
    (length,) = struct.unpack("<H", whole[8:10])
    heading = ast.literal_eval(whole[10:10 + length].decode("ascii"))
    CHECKS.that((10 + length) % 64 == 0, "the rows begin at a multiple of 64 bytes")
    head = [name for name, kind in heading["descr"]]
    CHECKS.that({kind for _, kind in heading["descr"]} == {"<f8"}, "doubles, little endian")
    rows = list(struct.iter_unpack(f"<{len(head)}d", whole[10 + length:]))
    CHECKS.that(heading["shape"] == (len(rows),) and heading["fortran_order"] is False,
                f"{len(rows)} rows are announced: {heading['shape']}")
    return head, [list(row) for row in rows]


def both_say_the_same(folder):
    run_small(folder, ENABLING, "--trace", "both")
    names = written(folder)
    CHECKS.that(names == ["serial.txt", "summary.json", "trace.csv", "trace.npy"], f"{names}")
    text, binary = (read(folder / "out/small" / name)
                    for read, name in ((text_trace, "trace.csv"), (binary_trace, "trace.npy")))
    CHECKS.that(text[0] == binary[0], "the same columns")
    CHECKS.that(text[1] == binary[1] and len(text[1]) > 501, "the same bits")
    CHECKS.that(text[1][0][0] < 0 < text[1][-1][0], "from the enabling to the end")


def what_is_asked_for_is_written(folder):
    for kind, names in (("csv", ["trace.csv"]), ("npy", ["trace.npy"]), ("none", [])):
        with scratch() as name:
            run_small(pathlib.Path(name), SMALL, "--trace", kind)
            CHECKS.that(written(pathlib.Path(name)) == ["serial.txt", "summary.json", *names],
                        f"{kind}: {written(pathlib.Path(name))}")
    refused = run_small(folder, SMALL, "--trace", "pdf")
    CHECKS.that(refused.returncode == 2 and "--trace" in refused.stderr, refused.stderr)


def a_drive_that_does_not_get_ready_leaves_a_trace(folder):
    run_small(folder, ENABLING, "--set", "plant.current_offset_a_A=4.0", "--trace", "both")
    _, rows = binary_trace(folder / "out/small/trace.npy")
    CHECKS.that(rows == text_trace(folder / "out/small/trace.csv")[1] and rows[0][0] == 0,
                f"its enabling, from time 0: {len(rows)} rows")
    run_small(folder, SMALL, "--set", "plant.current_offset_a_A=4.0", "--trace", "npy")
    CHECKS.that(binary_trace(folder / "out/small/trace.npy")[1] == [], "or a heading alone")


def plot(*arguments):
    return subprocess.run([ROOT / "tools/plot", *arguments], capture_output=True, text=True,
                          check=False)


def both_are_drawn_alike(folder):
    run_small(folder, SMALL, "--trace", "both")
    pictures = []
    for name in ("trace.npy", "trace.csv"):
        done = plot(folder / "out/small")
        picture = folder / "out/small/plot.png"
        CHECKS.that(done.returncode == 0, f"{name}: {done.stderr}")
        pictures.append(picture.read_bytes())
        (folder / "out/small" / name).unlink()
    CHECKS.that(pictures[0] == pictures[1] and pictures[0][:4] == b"\x89PNG", "the same picture")


def a_trace_that_is_not_whole_is_named_in_one_line(folder):
    for name in ("trace.npy", "trace.csv", "summary.json"):
        run_small(folder, SMALL, "--trace", name.removeprefix("trace.") if "trace" in name else "csv")
        file = folder / "out/small" / name
        whole = file.read_bytes()
        file.write_bytes(whole[:len(whole) // 2 + 1])
        done = plot(folder / "out/small")
        CHECKS.that(done.returncode == 1 and len(done.stderr.splitlines()) == 1
                    and done.stderr.startswith(f"plot: {file}: not"), f"{name}: {done.stderr}")
        file.rename(f"{file}.part")
        done = plot(folder / "out/small")
        CHECKS.that(done.returncode == 1 and len(done.stderr.splitlines()) == 1,
                    f"{name}.part: {done.stderr}")
        pathlib.Path(f"{file}.part").unlink()


for check in (both_say_the_same, what_is_asked_for_is_written,
              a_drive_that_does_not_get_ready_leaves_a_trace):
    with scratch() as place:
        check(pathlib.Path(place))
if plot("--help").returncode == 0:  # else there is no matplotlib
    for check in (both_are_drawn_alike, a_trace_that_is_not_whole_is_named_in_one_line):
        with scratch() as place:
            check(pathlib.Path(place))
CHECKS.end()
