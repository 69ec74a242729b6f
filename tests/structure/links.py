#!/usr/bin/env python3
"""Checks what the Markdown files promise: links lead somewhere, and CI runs the README's commands.

usage: links.py ROOT             exit 1 and one line per violation
       links.py --self-test ROOT plants violations in a copy and expects each to be found
"""
import pathlib
import re
import shutil
import sys
import tempfile

import check

LINK = re.compile(r"\]\(([^)\s]+)\)")
HEADING = re.compile(r"^#+ (.*)$", re.MULTILINE)
ANCHOR = re.compile(r'<a id="([^"]+)"></a>')
WORKFLOW = ".github/workflows/ci.yml"
MOST_LINES = 150  # of the README: what does not fit stands beside what it describes


def markdown_files(root):
    tops = [root, root / ".github", *(root / top for top in ("firmware", "hal", "sil", "tests", "tools"))]
    for top in tops:
        yield from sorted(top.glob("*.md") if top == root else top.rglob("*.md"))


def without_code(text):
    """Links in blocks of code are none."""
    text = re.sub(r"^```.*?^```$", "", text, flags=re.MULTILINE | re.DOTALL)
    return re.sub(r"^    .*$", "", text, flags=re.MULTILINE)


def anchors(text):
    """Those that are set, and as the common renderers make them of headings."""
    yield from ANCHOR.findall(without_code(text))
    for heading in HEADING.findall(without_code(text)):
        heading = re.sub(r"\[([^\]]*)\]\([^)]*\)", r"\1", heading)
        yield re.sub(r"[^\w\- ]", "", heading.lower()).replace(" ", "-")


def wrong_links(root):
    for file in markdown_files(root):
        text = file.read_text(encoding="utf-8")
        for target in LINK.findall(without_code(text)):
            if "://" in target:
                continue
            path, _, anchor = target.partition("#")
            where = (file.parent / path) if path else file
            if not where.exists():
                yield f"{file.relative_to(root)}: ({target}): there is no such file"
            elif anchor and anchor not in anchors(where.read_text(encoding="utf-8")):
                yield f"{file.relative_to(root)}: ({target}): there is no such heading"


def commands_of_the_readme(text):
    section = text.split("## Two commands\n", 1)[-1].split("\n## ", 1)[0]
    return [line.split("#")[0].strip() for line in re.findall(r"^    (tools/.*)$", section, re.MULTILINE)]


def violations(root):
    yield from wrong_links(root)
    readme = (root / "README.md").read_text(encoding="utf-8")
    if len(readme.splitlines()) > MOST_LINES:
        yield f"README.md: more than {MOST_LINES} lines"
    run = re.findall(r"^ +(?:- )?run: (.*)$", (root / WORKFLOW).read_text(encoding="utf-8"), re.MULTILINE)
    commands = commands_of_the_readme(readme)
    if len(commands) != 2 or run != commands:
        yield f"{WORKFLOW} runs {run}, the README shows {commands}"


PLANTED = [
    ("README.md", "README.md", "README.mdx"),
    ("sil/README.md", "(scenarios/README.md)", "(scenario/README.md)"),
    ("README.md", "#the-console", "#the-consoles"),
    ("README.md", "    tools/test ", "    tools/tests "),
    ("README.md", "\n## Limits", "\n" * 100 + "## Limits"),
    (WORKFLOW, "run: tools/demo", "run: tools/setup"),
]


def self_test(root):
    missed = 0
    for name, before, after in PLANTED:
        with tempfile.TemporaryDirectory() as scratch:
            copy = pathlib.Path(scratch) / "copy"
            shutil.copytree(root, copy, ignore=shutil.ignore_patterns("build", "out", ".git"))
            text = (copy / name).read_text(encoding="utf-8")
            (copy / name).write_text(text.replace(before, after, 1), encoding="utf-8")
            found = list(violations(copy))
            if before not in text or len(found) != 1:
                print(f"planted in {name}: {after!r}\n  reported: {found}")
                missed += 1
    print(f"{len(PLANTED) - missed} of {len(PLANTED)} planted violations found")
    return missed == 0


if __name__ == "__main__":
    sys.exit(check.of_root(__doc__, violations, self_test, sys.argv[1:]))
