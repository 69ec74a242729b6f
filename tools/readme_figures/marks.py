"""Marks in the Markdown files, which no reader of the rendered page sees.

<!--= NAME -->1.2<!--=-->     a figure within a line
<!--: NAME -->                the block of code or the table that follows, to its last line
"""
import re
from typing import NamedTuple

INLINE = re.compile(r"(?<!`)<!--= ([\w.-]+) -->([^\n]*?)<!--=-->")
BLOCK = re.compile(r"(?<!`)<!--: ([\w.-]+) -->\n\n?((?:(?:    .*|\|.*)\n(?:\n(?=    ))?)+)")
ANY = re.compile(r"(?<!`)<!--[=:] ")  # one in backticks is shown, not meant
SKIPPED = ("build", "third_party", ".git")


class Mark(NamedTuple):
    file: object  # path
    line: int
    name: str
    text: str     # what stands there
    begin: int    # of the text, in the file
    end: int

    @property
    def is_block(self):
        return self.text.endswith("\n")


def files(root):
    return [file for file in sorted(root.rglob("*.md"))
            if not any(part in SKIPPED for part in file.relative_to(root).parts)]


def marks_of(file):
    text = file.read_text(encoding="utf-8")
    found = [Mark(file, text.count("\n", 0, match.start(2)) + 1, match[1], match[2],
                  match.start(2), match.end(2))
             for pattern in (INLINE, BLOCK) for match in pattern.finditer(text)]
    begun = len(ANY.findall(text))
    if begun != len(found):
        raise ValueError(f"{file}: {begun} marks begin, {len(found)} are whole: "
                         "`<!--= NAME -->text<!--=-->` in one line, or `<!--: NAME -->` "
                         "before a table or a block of code")
    return sorted(found, key=lambda mark: mark.begin)


def with_values(text, marks, values):
    """`text` with what stands at the marks replaced; a mark without a value keeps what it has."""
    for mark in sorted(marks, key=lambda one: one.begin, reverse=True):
        value = values.get(mark.name, mark.text)
        text = text[:mark.begin] + value + text[mark.end:]
    return text
