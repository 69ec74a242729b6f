"""Runs what stands behind the figures, each command once."""
import hashlib
import json
import pathlib
import re
import subprocess
import tempfile

from comparison.simulator import ROOT, Refused, toml_document, toml_value

PICTURES = ROOT / "tools/pictures"
# Of an answer: what differs from one run, build or version to the next without any figure changing.
NOISE = re.compile(r'"(?:cpu_s|version|program|reproduce)":\s*(?:"[^"]*"|[-\d.e+]+),?|'
                   r"simulated in [^)]*\)")


class Missing(Exception):
    """What an entry is read from has not been built."""


class Sources:
    def __init__(self, program, build, draws=True):
        self.program, self.build, self.draws = pathlib.Path(program).absolute(), build, draws
        self.answers = {}

    def text(self, *command, accepted=(0, 1), cwd=ROOT):
        """What a command prints, each command called once; a path or text per word."""
        command = tuple(map(str, command))
        if (command, cwd) not in self.answers:
            done = subprocess.run(command, capture_output=True, text=True, check=False, cwd=cwd)
            if done.returncode not in accepted:
                raise Refused(f"{' '.join(command)}: exit {done.returncode}: "
                              f"{(done.stderr or done.stdout).strip()[-300:]}")
            self.answers[command, cwd] = done.stdout
        return self.answers[command, cwd]

    def simulator(self, *arguments, cwd=ROOT):
        if not self.program.is_file():
            raise Missing(f"{self.program}: not found; build the preset sil")
        return self.text(self.program, *arguments, cwd=cwd)

    def tool(self, name, *arguments, accepted=(0, 1)):
        return self.text(ROOT / "tools" / name, *arguments, accepted=accepted)

    def run(self, scenario, seeds="1-32", settings=None, numeric="float"):
        """Summaries of a scenario, one per seed."""
        command = ["run", scenario, "--seeds", seeds, "--numeric", numeric, "--json"]
        for key, value in (settings or {}).items():
            command += ["--set", f"{key}={value if key == 'motor' else toml_value(value)}"]
        return json.loads(self.simulator(*command))

    def run_text(self, document, seeds="1-32", settings=None, numeric="float"):
        """The same of a scenario that stands in no file."""
        with tempfile.TemporaryDirectory() as scratch:
            file = pathlib.Path(scratch, "scenario.toml")
            file.write_text(toml_document(document), encoding="utf-8")
            return self.run(str(file), seeds, settings, numeric)

    def out_of(self, *arguments):
        """Folder that --out received; lives as long as the sources."""
        key = ("out", *arguments)
        if key not in self.answers:
            self.answers[key] = tempfile.TemporaryDirectory()
            self.simulator(*arguments, "--out", self.answers[key].name)
        return pathlib.Path(self.answers[key].name)

    def built(self, path, preset):
        """A file of a build."""
        file = self.build / path
        if not file.exists():
            raise Missing(f"{file}: not found; build and test the preset {preset}")
        return file

    def keep_picture(self, file, name):
        """Takes a picture to those that the READMEs show, if it is to be drawn at all."""
        if self.draws:
            (PICTURES / name).write_bytes(pathlib.Path(file).read_bytes())

    def probe(self, commands):
        """Hash of what these commands of the simulator answer, but for times and versions; a
        function of the sources instead of a command gives its own text."""
        digest = hashlib.sha256()
        for command in commands:
            text = command(self) if callable(command) else self.simulator(*command.split())
            digest.update(NOISE.sub("", text).encode())
        return digest.hexdigest()[:16]
