"""Runs steadystep-sil and reads what comes of it."""
import argparse
import json
import pathlib
import re

from spread.answer import Refused
from spread.machine import Local

ROOT = pathlib.Path(__file__).resolve().parent.parent.parent
DEFAULT_PROGRAM = ROOT / "build/sil/steadystep-sil"
SCENARIOS = ROOT / "sil/scenarios"
REFUSED_CODE = 2  # any other that is not expected is a defect, not an answer


class Simulator:
    def __init__(self, program=DEFAULT_PROGRAM, numeric="float", machine=None):
        """`machine`: where it runs (spread.machine); None: here."""
        self.program = pathlib.Path(program).absolute()
        self.machine = machine or Local()
        self.numeric = numeric
        if not self.program.is_file():
            raise Refused(f"{self.program}: not found; build the preset sil first (tools/demo does)")

    def call(self, arguments, accepted=(0, 1), files=None, returns=()):
        """Answer of a call (spread.machine); Refused if its input is refused."""
        answer = self.machine.call(self.program, arguments, files, returns)
        if answer.code not in (*accepted, REFUSED_CODE):
            raise ChildProcessError(f"{self.program.name} ended with code {answer.code}: "
                                    f"{answer.err.strip()[-300:]}")
        if answer.code not in accepted:
            lines = answer.err.strip().splitlines()
            text = lines[-1] if lines else f"ended with code {answer.code}"
            raise Refused(text.removeprefix("steadystep-sil: ").replace(f"{ROOT}/", ""))
        return answer

    def _call(self, arguments, accepted=(0, 1), files=None):
        return self.call(arguments, accepted, files).out

    def version(self):
        return self._call(["--version"]).strip()

    def laws(self):
        """Names of all laws, each with the gains that it can be given."""
        # 2: some other scenario of the folder is not in order.
        lines = self._call(["list"], (0, 2)).split("\nlaws,", 1)[1].splitlines()[1:]
        words = [line.split() for line in lines if line.startswith("  ")]
        return {name: gains for name, *gains in words}

    def motors(self, names):
        """What `check-motor` says of motors by name or path: parameters, what follows, doubts."""
        return json.loads(self._call(["check-motor", "--json", *names]))

    def run(self, scenarios, parameters=None, settings=None, seeds=(1, 1), out=None, files=None,
            trace="csv"):
        """Summaries of all scenarios and seeds, as summary.json has them; Refused if refused.
        `files`: text by name; scenarios among them are named "./name.toml". `trace`: as --trace."""
        command = ["run", *scenarios, "--numeric", self.numeric, "--jobs", 1, "--json"]
        if parameters:
            command += ["--parameters", parameters]
        for key, value in (settings or {}).items():
            command += ["--set", f"{key}={toml_value(value)}"]
        command += (["--seed", seeds[0]] if seeds[0] == seeds[1] else
                    ["--seeds", f"{seeds[0]}-{seeds[1]}"])
        if out:
            command += ["--out", out, "--trace", trace]
        return json.loads(self._call(command, files=files))

    def run_each(self, scenarios, **how):
        """For each scenario its summaries, or the Refused that stands in their place."""
        try:
            runs = self.run(scenarios, **how)
            count = len(runs) // len(scenarios)
            return [runs[i * count:(i + 1) * count] for i in range(len(scenarios))]
        except Refused as refusal:
            if len(scenarios) == 1:
                return [refusal]
            return [self.run_each([one], **how)[0] for one in scenarios]


def seed_range(text):
    """A or A-B, for argparse."""
    found = re.fullmatch(r"(\d+)(?:-(\d+))?", text)
    if not found or int(found[2] or found[1]) < int(found[1]):
        raise argparse.ArgumentTypeError("expected A or A-B with A <= B")
    return int(found[1]), int(found[2] or found[1])


def toml_value(value):
    """A Python value as TOML spells it in one line."""
    if isinstance(value, bool):
        return "true" if value else "false"
    if isinstance(value, (int, float)):
        return repr(value)
    if isinstance(value, str):
        return json.dumps(value, ensure_ascii=False)
    if isinstance(value, dict):
        return "{ " + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + " }"
    return "[" + ", ".join(toml_value(item) for item in value) + "]"


def toml_document(document):
    """A document of values, tables and arrays of tables, one key a line."""
    plain = [f"{key} = {toml_value(value)}" for key, value in document.items()
             if not isinstance(value, dict) and not is_array_of_tables(value)]
    tables = []
    for key, value in document.items():
        parts = [("[{}]", value)] if isinstance(value, dict) else (
            [("[[{}]]", one) for one in value] if is_array_of_tables(value) else [])
        for heading, table in parts:
            tables.append("\n" + heading.format(key))
            tables += [f"{name} = {toml_value(item)}" for name, item in table.items()]
    return "\n".join(plain + tables) + "\n"


def is_array_of_tables(value):
    return isinstance(value, list) and value != [] and all(isinstance(one, dict) for one in value)
