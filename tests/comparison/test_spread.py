"""Runs are spread in one way, over cores or a cluster, and a worker that dies loses nothing.

usage: test_spread.py PROGRAM ROOT [TEST…]    exit code 77 if only tests that cannot run are named
"""
import contextlib
import json
import os
import pathlib
import signal
import socket
import subprocess
import sys
import tempfile
import time
import unittest

PROGRAM, ROOT = pathlib.Path(sys.argv[1]).absolute(), pathlib.Path(sys.argv[2])
sys.path.insert(0, str(ROOT / "tools"))

from spread import journal, machine, work  # noqa: E402

SKIPPED = 77
# The tools' own interpreter, which may have more than the one of the tests.
PYTHON = (ROOT / "tools/motors").read_text(encoding="utf-8").splitlines()[0].removeprefix("#!")
HAS_DASK = subprocess.run([PYTHON, "-c", "import distributed"], capture_output=True,
                          check=False).returncode == 0
WAIT = """
import sys, distributed
with distributed.Client(sys.argv[1], timeout=60, set_as_default=False) as client:
    client.wait_for_workers(2, timeout=60)
"""
PATIENCE_s = 60


def tool(name, *arguments, **how):
    return subprocess.run([PYTHON, ROOT / "tools" / name, "--program", PROGRAM, *arguments],
                          capture_output=True, text=True, check=False, **how)


class Parts(unittest.TestCase):
    def test_a_call_finds_its_files_and_leaves_those_asked_for(self):
        files = {"in.txt": "x", "deep/in.txt": "y"}
        script = "cat in.txt deep/in.txt > out.txt; echo said; echo bad >&2; exit 3"
        here = machine.Local(1)
        machine.SCENARIOS, kept = (), machine.SCENARIOS
        try:
            answer = here.call("/bin/sh", ["-c", script], files=files, returns=("out.txt", "none"))
        finally:
            machine.SCENARIOS = kept
        self.assertEqual(answer, (3, "said\n", "bad\n", {"out.txt": "xy"}))
        self.assertFalse(pathlib.Path("out.txt").exists())

    def test_each_gives_every_result_and_ends_with_the_first_error(self):
        self.assertEqual(dict(work.each(range(20), lambda n: n * n, 3)),
                         {n: n * n for n in range(20)})
        begun = []

        def fails(n):
            begun.append(n)
            time.sleep(1e-3)
            raise ValueError(n)

        with self.assertRaises(ValueError):
            list(work.each(range(1000), fails, 2))
        self.assertLess(len(begun), 1000)

    def test_a_journal_forgets_other_conditions_and_lines_that_were_cut_off(self):
        with tempfile.TemporaryDirectory() as scratch:
            file = pathlib.Path(scratch, "journal.jsonl")
            first = journal.Journal(file, PROGRAM, ["float"])
            first.put("one", 1)
            first.put("two", 2)
            file.write_text(file.read_text(encoding="utf-8")[:-5], encoding="utf-8")
            again = journal.Journal(file, PROGRAM, ["float"])
            self.assertEqual((again.get("one"), again.get("two")), (1, None))
            again.put("two", 3)
            self.assertEqual(journal.Journal(file, PROGRAM, ["float"]).get("two"), 3)
            self.assertIsNone(journal.Journal(file, PROGRAM, ["fixed"]).get("one"))


class Campaign(unittest.TestCase):
    def test_report_and_journal_are_those_of_the_program_and_it_goes_on(self):
        order = ("long-run", "--duration", "0.3", "--seeds", "1-45")
        alone = subprocess.run([PROGRAM, "campaign", *order], capture_output=True, text=True,
                               check=False)
        with tempfile.TemporaryDirectory() as scratch:
            done = tool("campaign", *order, "--out", scratch)
            self.assertEqual((done.returncode, done.stdout), (alone.returncode, alone.stdout),
                             done.stderr)
            file = pathlib.Path(scratch, "long-run-float.jsonl")
            lines = file.read_text(encoding="utf-8").splitlines()
            self.assertEqual(sorted(json.loads(line)["seed"] for line in lines),
                             list(range(1, 46)))
            file.write_text("\n".join(lines[:25]) + "\n" + lines[25][:30], encoding="utf-8")
            again = tool("campaign", *order, "--out", scratch)
            self.assertEqual(again.stdout, alone.stdout, again.stderr)
            seeds = []
            for line in file.read_text(encoding="utf-8").splitlines():
                with contextlib.suppress(json.JSONDecodeError):
                    seeds.append(json.loads(line)["seed"])
            self.assertEqual(sorted(seeds), list(range(1, 46)), "each seed ran once")

    def test_a_motor_goes_along_and_is_named_as_it_was_given(self):
        with tempfile.TemporaryDirectory() as scratch:
            setting = f"motor={ROOT}/sil/motors/kim-2016.toml"
            done = tool("campaign", "long-run", "--duration", "0.3", "--seeds", "1-3", "--set",
                        setting, "--out", scratch, "--json")
            found = json.loads(done.stdout)
        self.assertEqual(len(found["runs"]), 3)
        self.assertTrue(found["runs"][0]["reproduce"].endswith(f"--set {setting}"),
                        found["runs"][0]["reproduce"])

    def test_bad_input_is_one_line(self):
        with tempfile.TemporaryDirectory() as scratch:
            for arguments, text in ((("sleep", "--seeds", "1-2"), "unknown kind"),
                                    (("slip", "--seeds", "1-2", "--jobs", "0"), "--jobs"),
                                    (("slip", "--seeds", "1-2", "--set", "motor=x/y.toml"),
                                     "y.toml")):
                done = tool("campaign", *arguments, "--out", scratch)
                self.assertEqual((done.returncode, len(done.stderr.splitlines())), (2, 1),
                                 done.stderr)
                self.assertIn(text, done.stderr)


class WithoutDask(unittest.TestCase):
    def test_what_is_missing_is_named(self):
        with tempfile.TemporaryDirectory() as scratch:
            pathlib.Path(scratch, "distributed.py").write_text("raise ImportError('gone')\n",
                                                               encoding="utf-8")
            for name, more in (("motors", ()), ("envelope", ()), ("tune", ("--law", "pid")),
                               ("campaign", ("slip", "--seeds", "1-2"))):
                done = tool(name, *more, "--dask", "tcp://127.0.0.1:9",
                            env={**os.environ, "PYTHONPATH": scratch})
                self.assertNotEqual(done.returncode, 0)
                self.assertIn("tools/setup cluster", done.stderr)
                self.assertEqual(len(done.stderr.splitlines()), 1, done.stderr)


@unittest.skipUnless(HAS_DASK, "dask.distributed is not installed: tools/setup cluster")
class Cluster(unittest.TestCase):
    """A scheduler and two workers of one thread each. The scheduler gives a task up as soon as it
    has lost a worker with it: that it is tried again is ours."""

    def setUp(self):
        self.stack = contextlib.ExitStack()
        self.addCleanup(self.stack.close)
        self.scratch = pathlib.Path(self.stack.enter_context(tempfile.TemporaryDirectory()))
        with socket.socket() as free:
            free.bind(("127.0.0.1", 0))
            self.address = f"tcp://127.0.0.1:{free.getsockname()[1]}"
        self.start("distributed.cli.dask_scheduler", "--host", self.address, "--no-dashboard")
        self.workers = [self.start("distributed.cli.dask_worker", self.address, "--no-nanny",
                                   "--nthreads", "1", "--no-dashboard", "--local-directory",
                                   str(self.scratch)) for _ in range(2)]
        subprocess.run([PYTHON, "-c", WAIT, self.address], check=True, capture_output=True)

    def start(self, module, *arguments):
        log = open(self.scratch / f"{module}.log", "ab")
        self.stack.callback(log.close)
        process = subprocess.Popen(
            [PYTHON, "-m", module, *arguments], stdout=log, stderr=log, cwd=self.scratch,
            env={**os.environ, "DASK_DISTRIBUTED__SCHEDULER__ALLOWED_FAILURES": "0"})
        self.stack.callback(process.wait)
        self.stack.callback(process.kill)
        return process

    def test_the_matrix_is_the_same_although_a_worker_dies(self):
        order = ("--motor", "kim-2016", "--motor", "bendjedia-2012", "--moves", "turn", "tenths",
                 "creep", "--seeds", "1-2", "--json")
        local = tool("motors", *order, "--out", self.scratch / "local")
        there = subprocess.Popen(
            [PYTHON, ROOT / "tools/motors", "--program", PROGRAM, *order, "--out",
             self.scratch / "there", "--dask", self.address], stdout=subprocess.PIPE,
            stderr=subprocess.PIPE, text=True)
        finished = self.scratch / "there/results.jsonl"
        deadline = time.monotonic() + PATIENCE_s
        while not finished.is_file() or not finished.read_bytes():
            self.assertLess(time.monotonic(), deadline, "no run has ended")
            self.assertIsNone(there.poll(), "it ended too early")
            time.sleep(0.02)
        self.workers[0].send_signal(signal.SIGKILL)
        before = len(finished.read_text(encoding="utf-8").splitlines())
        out, err = there.communicate(timeout=PATIENCE_s)
        lines = len(finished.read_text(encoding="utf-8").splitlines())
        self.assertLess(before, lines, f"the worker died in the middle: {err}")
        same = [[{key: value for key, value in cell.items() if key != "reproduce"}
                 for cell in json.loads(text)] for text in (local.stdout, out)]
        self.assertEqual(same[0], same[1], err)
        self.assertEqual(there.returncode, local.returncode)

    def test_campaign_envelope_and_tuning_run_there(self):
        order = ("long-run", "--duration", "0.3", "--seeds", "1-45", "--out")
        local = tool("campaign", *order, self.scratch / "local")
        there = tool("campaign", *order, self.scratch / "there", "--dask", self.address)
        self.assertEqual(there.stdout, local.stdout, there.stderr)
        for name, order, table in (
                ("envelope", ("--quick", "--motor", ROOT / "sil/motors/kim-2016.toml"),
                 "table.json"),
                ("tune", ("--law", "pid", "--budget", "20", "--moves", "step", "--motor",
                          "kim-2016", "--state", self.scratch / "state", "--fresh"), "pid.toml")):
            texts = []
            for where in ((), ("--dask", self.address)):
                out = self.scratch / f"{name}{len(where)}"
                done = tool(name, *order, "--out", out, *where)
                self.assertEqual(done.returncode, 0, done.stderr)
                texts.append((out / table).read_text(encoding="utf-8"))
            self.assertEqual(texts[0], texts[1])

    def test_a_drive_that_refuses_is_a_refusal_there_too(self):
        text = (ROOT / "sil/motors/kim-2016.toml").read_text(encoding="utf-8")
        motor = self.scratch / "mine.toml"
        motor.write_text(text.replace("kim-2016", "mine").replace("3.6e-3", "3.6"),
                         encoding="utf-8")
        order = ("--motor", motor, "--plants", "ideal", "--moves", "rest", "--seeds", "1-1",
                 "--json", "--out", self.scratch / "out", "--dask", self.address)
        done = tool("motors", *order)
        self.assertEqual(done.returncode, 1, done.stderr)
        for cell in json.loads(done.stdout):
            self.assertEqual(cell["verdict"], "refused")
            self.assertRegex(cell["words"], r"^(\./)*mine\.toml:5: inductance_H: ")


if __name__ == "__main__":
    if sys.argv[3:] and not HAS_DASK and all(name.startswith("Cluster") for name in sys.argv[3:]):
        print("skipped: dask.distributed is not installed; tools/setup cluster installs it")
        sys.exit(SKIPPED)
    unittest.main(argv=[sys.argv[0], *sys.argv[3:]], verbosity=1)
