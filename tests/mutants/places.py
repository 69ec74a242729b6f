"""The places of a C source where a mutation may break it, and what it may become there.

Kinds: relation, arithmetic, constant, sign, statement (deleted), condition (negated). No place is
what stands in a comment, a string, a preprocessor line (so the tables of firmware/interface and the
constants that have a name there), a static assertion, or the size of a declared array or bit field.
The layout of clang-format distinguishes a product or difference, with a space on either side, from
a pointer or a sign.
"""
import re
from typing import NamedTuple

TOKEN = re.compile(r"""
    (?P<skipped>/\*.*?\*/|//[^\n]*|(?<=\n)[ \t]*\#(?:\\\n|[^\n])*|[ \t]+|\n)
  | (?P<text>"(?:\\.|[^"\\])*"|'(?:\\.|[^'\\])*')
  | (?P<number>(?:0[xX][0-9a-fA-F]+|(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?)[uUlLfF]*)
  | (?P<word>[A-Za-z_]\w*)
  | (?P<operator><<=|>>=|->|\+\+|--|<<|>>|<=|>=|==|!=|&&|\|\||[-+*/%&|^]=|.)
""", re.VERBOSE | re.DOTALL)
RELATIONS = {"<": ("<=", ">="), "<=": ("<", ">"), ">": (">=", "<="), ">=": (">", "<"),
             "==": ("!=",), "!=": ("==",)}
ARITHMETIC = {"+": "-", "-": "+", "*": "/", "/": "*", "+=": "-=", "-=": "+=", "*=": "/=",
              "/=": "*="}
DECLARING = {"struct", "union", "enum", "const", "static", "volatile", "extern", "typedef"}
NO_EXPRESSION = DECLARING | {"if", "for", "while", "do", "else", "switch", "case", "default",
                             "return", "goto", "_Static_assert"}


class Token(NamedTuple):
    kind: str
    text: str
    start: int

    @property
    def end(self):
        return self.start + len(self.text)


class Place(NamedTuple):
    file: str
    kind: str
    start: int
    end: int
    choices: tuple  # what may stand there instead


class Source:
    """A file's tokens, and for each whether it stands in a function and how deep in brackets."""

    def __init__(self, text):
        self.text = text
        self.tokens = []
        self.in_function = []
        self.depth = []   # of ( and [
        braces = []       # True: of a function
        depth = 0
        for match in TOKEN.finditer("\n" + text):
            if match.lastgroup == "skipped":
                continue
            token = Token(match.lastgroup, match.group(), match.start() - 1)
            if token.text in ")]":
                depth -= 1
            if token.text == "}" and braces:
                braces.pop()
            self.in_function.append(any(braces))
            self.depth.append(depth)
            if token.text in "([":
                depth += 1
            if token.text == "{":
                before = self.tokens[-1].text if self.tokens else ""
                braces.append(any(braces) or before == ")")
            self.tokens.append(token)

    def closing(self, opening):
        """The index of the bracket that closes the one at index `opening`."""
        return next(i for i in range(opening + 1, len(self.tokens))
                    if self.depth[i] == self.depth[opening] and self.tokens[i].text in ")]")

    def spaced(self, token):
        around = self.text[token.start - 1] + self.text[token.end:token.end + 1]
        return around.strip() == ""

    def statement_of(self, i):
        """The words from the beginning of the statement at index i on, up to it."""
        first = i
        while first and self.tokens[first - 1].text not in ";{}":
            first -= 1
        return [token.text for token in self.tokens[first:i]]


def number_choices(text):
    """n + 1, 0 and 2 n, without those that are n."""
    digits = re.match(r"0[xX][0-9a-fA-F]+|[0-9.]+(?:[eE][-+]?\d+)?", text).group()
    suffix = text[len(digits):]
    whole = re.fullmatch(r"0[xX][0-9a-fA-F]+|\d+", digits)
    n = int(digits, 0 if digits[:2] in ("0x", "0X") else 10) if whole else float(digits)
    return tuple(f"{other!r}{suffix}" for other in dict.fromkeys((n + 1, n * 0, n * 2))
                 if other != n)


def is_size(source, i):
    """The number at index i is the size of an array that is declared, or of a bit field."""
    before = source.tokens[i - 1].text
    if before == ":" and not source.in_function[i]:
        return True
    if before != "[":
        return False
    words = source.statement_of(i)
    words = words[max((k + 1 for k, word in enumerate(words) if word == ")"), default=0):]
    return (not source.in_function[i] and "=" not in words) or \
        bool(DECLARING & set(words[:1])) or \
        len(words) > 1 and all(re.fullmatch(r"\w+", word) for word in words[:2])


def statement_end(source, i):
    """The index of the ; that ends the statement at index i, if it may be deleted, else None."""
    tokens = source.tokens
    if not 0 < i < len(tokens) - 1:
        return None
    before, first, second = tokens[i - 1:i + 2]
    labelled = before.text == ":" and source.statement_of(i)[0] in ("case", "default")
    begins = before.text in ("{", "}", ";") or labelled
    if not source.in_function[i] or source.depth[i] or not begins:
        return None
    if first.text in ("break", "continue"):
        return i + 1
    if first.text == "atomic_signal_fence": # orders what an interrupt sees: tests have none
        return None
    expression = first.text in ("*", "(", "++", "--") or first.kind == "word" and \
        first.text not in NO_EXPRESSION and second.kind != "word" and \
        second.text not in ("*", ":", ",", "}")
    if not expression:
        return None
    literal = 0 # braces of compound literals
    for end in range(i, len(tokens)):
        text = tokens[end].text
        if text == "{":
            if tokens[end - 1].text not in ")=,{":
                return None
            literal += 1
        elif text == "}":
            literal -= 1
        elif text == ";" and source.depth[end] == 0 and not literal:
            return end
        if literal < 0:
            return None
    return None


def token_choices(source, i):
    """(kind, choices) of what the token at index i may become alone, or None."""
    token = source.tokens[i]
    if token.kind == "number":
        return None if is_size(source, i) else ("constant", number_choices(token.text))
    if token.kind != "operator":
        return None
    if token.text in RELATIONS and source.spaced(token):
        return "relation", RELATIONS[token.text]
    if token.text in ARITHMETIC and source.spaced(token):
        return "arithmetic", (ARITHMETIC[token.text],)
    if token.text == "-":
        return "sign", ("+",)
    if token.text == "!":
        return "condition", ("",)
    return None


def condition(source, i):
    """(start, end) of the condition that the keyword at index i asks for, or None."""
    tokens = source.tokens
    if tokens[i].text not in ("if", "while", "for") or tokens[i + 1].text != "(":
        return None
    first, last = i + 2, source.closing(i + 1)
    if tokens[i].text == "for":
        ends = [k for k in range(first, last)
                if tokens[k].text == ";" and source.depth[k] == source.depth[first]]
        first, last = ends[0] + 1, ends[1]
    return (tokens[first].start, tokens[last].start) if last > first else None


def places_of(file, text):
    """All the places of a file, in their order."""
    source = Source(text)
    places = []
    asserted = 0
    for i, token in enumerate(source.tokens):
        if token.text == "_Static_assert":
            asserted = source.closing(i + 1)
        if i <= asserted and asserted:
            continue
        alone = token_choices(source, i)
        if alone and alone[1]:
            places.append(Place(file, alone[0], token.start, token.end, alone[1]))
        asked = condition(source, i)
        if asked:
            places.append(Place(file, "condition", *asked, (f"!({text[asked[0]:asked[1]]})",)))
        end = statement_end(source, i)
        if end is not None:
            places.append(Place(file, "statement", token.start, source.tokens[end].end, (";",)))
    return places
