"""Builds unit tests of which one file of the firmware is replaced, and runs them."""
import os
import pathlib
import shlex
import subprocess
from typing import NamedTuple

FLAGS = ["-std=c11", "-O1", "-ffp-contract=off", "-fno-math-errno", "-w",
         "-DUNITY_INCLUDE_DOUBLE", "-DUNITY_SUPPORT_64"]
RUN_TIMEOUT_S = 60
# A cache of compilations leaves paths as they are, and looks at what the preprocessor makes: it
# would not see a header that has come before another one.
ENVIRONMENT = {**os.environ, "CCACHE_NODIRECT": "1", "CCACHE_BASEDIR": ""}


class Failure(Exception):
    """Why a mutant proves nothing."""


class TimedOut(Failure):
    """The test does not end."""


class Result(NamedTuple):
    output: str
    passed: bool


class Build:
    """Objects of the unbroken firmware and tests; a mutant recompiles what its test links and what
    depends on its file."""

    def __init__(self, root, unity, compiler, scratch):
        self.root = root
        self.unity = unity
        self.compiler = shlex.split(compiler)
        self.scratch = scratch
        self.dependencies = {}  # (numeric, source): files
        self.linked = {}        # (numeric, test): sources

    def compile(self, source, numeric, target, overlay=None):
        """Compiles `source`, files of the folder `overlay` before those of the project; returns the
        project's files it depends on."""
        path = self.root / source
        includes = [f"-I{self.root}"]
        if overlay:
            includes = [f"-I{overlay}", *includes]
            if (overlay / source).is_file():
                path = overlay / source
        target.parent.mkdir(parents=True, exist_ok=True)
        command = [*self.compiler, *FLAGS, f"-DSTEADYSTEP_NUM=NUM_{numeric.upper()}",
                   *includes, f"-I{self.unity}", "-MMD", "-MF", f"{target}.d",
                   "-c", str(path), "-o", str(target)]
        result = subprocess.run(command, check=False, capture_output=True, text=True,
                                env=ENVIRONMENT)
        if result.returncode:
            raise Failure(f"{path.name} does not compile:\n{result.stderr}")
        words = pathlib.Path(f"{target}.d").read_text(encoding="utf-8").split()
        prefix = f"{self.root}/"
        return {word[len(prefix):] for word in words if word.startswith(prefix)}

    def objects_of(self, numeric):
        return self.scratch / "unbroken" / numeric

    def prepare(self, pool, wanted):
        """Compiles everything once for each (numeric, test) wanted."""
        firmware = sorted(path.relative_to(self.root)
                          for path in (self.root / "firmware").rglob("*.c"))
        jobs = []
        for numeric in {numeric for numeric, _ in wanted}:
            sources = firmware + [source_of(test) for other, test in wanted if other == numeric]
            for source in sources:
                jobs.append((numeric, source,
                             pool.submit(self.compile, source, numeric,
                                         self.object_of(numeric, source))))
        self.compile(self.unity / "unity.c", "double", self.scratch / "unity.o")
        self.dependencies = {(numeric, source): job.result() for numeric, source, job in jobs}
        for numeric in {numeric for numeric, _ in wanted}:
            subprocess.run(["ar", "rcsT", self.archive_of(numeric),
                            *(self.object_of(numeric, source) for source in firmware)], check=True)
        for numeric, test in wanted:
            self.linked[numeric, test] = self.sources_of(numeric, test)

    def archive_of(self, numeric):
        return self.objects_of(numeric) / "firmware.a"

    def object_of(self, numeric, source):
        return (self.objects_of(numeric) / source).with_suffix(".o")

    def link(self, arguments, program):
        return subprocess.run([self.compiler[-1], *map(str, arguments),
                               str(self.scratch / "unity.o"), "-lm", "-o", str(program)],
                              check=True, capture_output=True, text=True).stdout

    def sources_of(self, numeric, test):
        """The test's own, and those of the firmware's that the linker takes for it."""
        source = source_of(test)
        taken = self.link([self.object_of(numeric, source), self.archive_of(numeric), "-Wl,-t"],
                          self.scratch / "taken")
        return [other for of, other in self.dependencies
                if of == numeric and (other == source or
                                      str(self.object_of(numeric, other).relative_to(
                                          self.objects_of(numeric))) in taken)]

    def affected(self, numeric, test, file):
        """The sources linked for the test that a change of `file` compiles anew."""
        return [source for source in self.linked[numeric, test]
                if file in self.dependencies[numeric, source]]

    def run(self, numeric, test, replaced, folder, cpu_s=None):
        """Links the test with the objects in `replaced` and runs it."""
        folder.mkdir(parents=True, exist_ok=True)
        program = folder / "program"
        self.link([replaced.get(source, self.object_of(numeric, source))
                   for source in self.linked[numeric, test]], program)
        limit = f"ulimit -t {cpu_s}; " if cpu_s else ""
        try:
            result = subprocess.run(["sh", "-c", f'{limit}exec "$0"', str(program)], check=False,
                                    capture_output=True, text=True, errors="replace",
                                    timeout=RUN_TIMEOUT_S)
        except subprocess.TimeoutExpired as expired:
            raise TimedOut(f"runs for more than {RUN_TIMEOUT_S} s") from expired
        finally:
            os.unlink(program)
        return Result(result.stdout, result.returncode == 0)


def source_of(test):
    return pathlib.Path(f"tests/unit/test_{test}.c")


def overlay_of(folder, file, text):
    """A folder with `file` alone, which reads `text`."""
    path = folder / file
    path.parent.mkdir(parents=True, exist_ok=True)
    path.write_text(text, encoding="utf-8")
    return folder
