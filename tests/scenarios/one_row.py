"""A setting, a command, a signal and a fault are a row each: added to a scratch copy, they show up.

usage: one_row.py ROOT CC CXX
"""
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT, CC, CXX = pathlib.Path(sys.argv[1]), sys.argv[2], sys.argv[3]

# A row behind the line that begins so; the command's act is the only other edit.
ROWS = [
    ("settings_table.h", "#define DRIVE_SETTINGS(",
     'REAL(0x2ff0, proof_V, "V", FIXED(0.0), FIXED(9.0), FIXED(2.5), AT_ENABLE, "setting of the proof")'),
    ("commands_table.h", "#define DRIVE_COMMANDS_TABLE(",
     'COMMAND(200, PROOF, "prove", WITH(speed_rad_s), 0, ANY_STATE, AT_ONCE, "act of the proof")'),
    ("signals_table.h", "#define DRIVE_SIGNALS_TABLE(",
     'COUNT(0x2ff1, proof_count, planner.underruns, "", TRACED, "signal of the proof")'),
    ("faults_table.h", "#define DRIVE_FAULTS_TABLE(",
     'FAULT(PROOF, 0xfff0, "proven", "cause of the proof", NO_LIMIT, STANDS, "remedy of the proof")'),
]
ACT = ("    if (!command_rules_check(drive, command, asked_in, error)) {\n        return false;\n    }\n",
       "    if (command->kind == DRIVE_COMMAND_PROOF) {\n"
       "        drive->planner.underruns += (uint32_t)command->speed_rad_s;\n"
       "        return true;\n    }\n")

CONSOLE = r"""
#include <stdio.h>
#include "tests/unit/console_bench.h"
int main(void)
{
    static const char *const lines[] = {"get proof_V", "set proof_V 10", "help prove", "prove",
                                        "prove 7", "signals"};
    const struct drive_settings settings = bench_quick_settings();

    bench_power_up();
    bench_start(&settings);
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++) {
        printf("%s", bench_ask(lines[i]));
    }
    puts(drive_fault_name(DRIVE_FAULT_PROOF));
    return 0;
}
"""
PAGES = r"""
#include <cstdio>
#include "sil/scenario/pages.h"
#include "sil/scenario/record.h"
int main()
{
    for (const scenario::Page &page : scenario::pages()) {
        std::puts(page.text().c_str());
    }
    std::puts(scenario::column_name(scenario::Column(scenario::COLUMNS - 1)));
}
"""
EXPECTED = [
    "ok get proof_V=2.5 V; 0...9; default 2.5", "error: proof_V", "ok prove speed_rad_s=: act of the proof",
    "error: prove: missing speed_rad_s=", "ok prove\n", "ok signals proof_count=7 ", "proven\n",
    "| 0x2ff0 | `proof_V` | V | 0…9 | 2.5 |", "| 200 | `prove` | `speed_rad_s` | in any state |",
    "| 0x2ff1 | `proof_count` |",
    "| 0xfff0 | <a id=\"proven\"></a>`proven` | cause of the proof | remedy of the proof |",
    "[2FF0]\nParameterName=proof_V\n", "[2FF1]\nParameterName=proof_count\n", "\nproof_count\n",
]


def add_rows(scratch):
    for name, begin, row in ROWS:
        path = scratch / "firmware/interface" / name
        text = path.read_text(encoding="utf-8")
        place = text.index("\n", text.index(begin)) + 1
        path.write_text(text[:place] + f"    {row} \\\n" + text[place:], encoding="utf-8")
    path = scratch / "firmware/drive/commands.c"
    text = path.read_text(encoding="utf-8")
    if text.count(ACT[0]) != 1:
        sys.exit("drive/commands.c: where an act at once belongs is not found")
    path.write_text(text.replace(ACT[0], "".join(ACT)), encoding="utf-8")


def build(scratch):
    """The console on the bench, and what writes pages and traces: what both have written."""
    (scratch / "type.c").write_text(CONSOLE, encoding="utf-8")
    (scratch / "write.cpp").write_text(PAGES, encoding="utf-8")
    options = ["-w", "-O0", "-I.", "-DSTEADYSTEP_NUM=NUM_DOUBLE"]

    def run(*command):
        return subprocess.run(command, cwd=scratch, check=True, stdout=subprocess.PIPE).stdout

    objects = []
    for source in [*sorted(scratch.glob("firmware/**/*.c")), scratch / "type.c"]:
        objects.append(str(source.with_suffix(".o")))
        run(CC, "-std=gnu11", *options, "-c", str(source), "-o", objects[-1])
    run(CC, *objects, "-lm", "-o", "type")
    run(CXX, "-std=c++17", *options, "write.cpp",
        *(f"sil/scenario/{name}.cpp" for name in ("pages", "eds", "record", "text")),
        *objects[:-1], "-o", "write")
    return (run("./type") + run("./write")).decode()


with tempfile.TemporaryDirectory() as name:
    copy = pathlib.Path(name)
    for part in ("firmware", "hal", "sil/scenario", "tests/unit"):
        shutil.copytree(ROOT / part, copy / part)
    add_rows(copy)
    written = build(copy)
missing = [text for text in EXPECTED if text not in written]
for text in missing:
    print(f"not found: {text!r}")
if missing:
    print(written[:3000])
sys.exit(1 if missing else 0)
