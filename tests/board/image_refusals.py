#!/usr/bin/env python3
"""What `steadystep-sil run --image` refuses before it runs anything: exit code 2 and one line.

usage: image_refusals.py SIMULATOR IMAGE.elf     exit 1 and one line for each that is taken, or is
                                                 refused in other words
"""

import json
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

SCENARIO = "bendjedia-fig12"


def first_run(content, name, value):
    content["code"][0][name] = value


def stages_of_first_run(content, instructions):
    content["code"][0]["stages"][0][1] = instructions


# change of the map, in the simulator's words
MAPS = [
    (lambda content: content.update(format=1), "is of another format than 4"),
    (lambda content: content.update(core="m0plus"), "is for a core m0plus"),
    (lambda content: content["identity"].update(fnv1a="0"), "is the map of another image"),
    (lambda content: first_run(content, "costs", "0"), "that it does not describe"),
    (lambda content: first_run(content, "costs", "0g" * 2000), "expected hexadecimal digits"),
    (lambda content: first_run(content, "costs", "ff" * 2000), "that it does not describe"),
    (lambda content: first_run(content, "costs", [0, 1]), "type_error"),
    (lambda content: first_run(content, "stages", []), "names no stage of some instructions"),
    (lambda content: stages_of_first_run(content, 10**18), "that it does not describe"),
    (lambda content: stages_of_first_run(content, -1), "that it does not describe"),
    (lambda content: content.pop("costs"), "key 'costs' not found"),
    (lambda content: content["flash"].update(line_bytes=-1), "expected 1...4096"),
]


# of a setting that images leave out, in the simulator's words
SETTINGS = [
    (["bendjedia-fig12", "--set", "drive.law=smc"], "law = smc: for simulation"),
    (["initial-position-published"], "initial_position = published-impulses: for simulation"),
]


def wrong(simulator, image, words, scenario=(SCENARIO,)):
    """1, with a line, unless the image is refused in these words."""
    done = subprocess.run(
        [simulator, "run", "--image", image, *scenario], capture_output=True, text=True
    )
    if done.returncode == 2 and words in done.stderr and done.stderr.count("\n") == 1:
        return 0
    print(f"expected exit code 2 and '{words}', got {done.returncode} and: {done.stderr}")
    return 1


def main(simulator, image):
    errors = 0
    with tempfile.TemporaryDirectory() as folder:
        copy = Path(folder) / "copy.elf"
        file = copy.with_suffix(".map.json")
        shutil.copy(image, copy)
        errors += wrong(simulator, copy, "cannot be read; tools/image_map writes it")
        for scenario, words in SETTINGS:
            errors += wrong(simulator, image, words, scenario)
        text = Path(image).with_suffix(".map.json").read_text(encoding="utf-8")
        for change, words in MAPS:
            content = json.loads(text)
            change(content)
            file.write_text(json.dumps(content), encoding="utf-8")
            errors += wrong(simulator, copy, words)
        file.write_text(text[: len(text) // 2], encoding="utf-8")
        errors += wrong(simulator, copy, "parse_error")
        copy.write_text("no program", encoding="utf-8")
        errors += wrong(simulator, copy, "is no ELF program")
    return int(errors > 0)


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
