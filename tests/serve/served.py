"""Starts `steadystep-sil serve` for a test and speaks to it as its clients do."""
import os
import pathlib
import select
import signal
import socket
import subprocess
import sys
import tempfile
import time

SIL = pathlib.Path(sys.argv[1]).resolve()


class Line:
    """One end of a line of bytes, by text lines."""

    def __init__(self, place):
        self.rest = b""
        if ":" in place:
            host, port = place.split(":")
            self.socket = socket.create_connection((host, int(port)))
            self.file = self.socket.fileno()
        else:
            self.socket = None
            self.file = os.open(place, os.O_RDWR | os.O_NOCTTY)

    def close(self):
        if self.socket:
            self.socket.close()
        else:
            os.close(self.file)

    def send(self, text):
        os.write(self.file, text.encode())

    def read(self, timeout_s=5.0):
        """The next line; "" if none comes in time."""
        end = time.monotonic() + timeout_s
        while b"\n" not in self.rest:
            left = end - time.monotonic()
            if left <= 0 or not select.select([self.file], [], [], left)[0]:
                return ""
            self.rest += os.read(self.file, 4096)
        line, self.rest = self.rest.split(b"\n", 1)
        return line.decode()

    def until(self, begin, timeout_s=10.0):
        """The next line that begins so; "" if none comes in time."""
        end = time.monotonic() + timeout_s
        while time.monotonic() < end:
            line = self.read(max(0.0, end - time.monotonic()))
            if line.startswith(begin):
                return line
        return ""

    def ask(self, text):
        self.send(text + "\n")
        return self.read()


class Served:
    """A server in a folder of its own: links `drive` and `knobs`, and TCP for both."""

    def __init__(self, *arguments):
        self.scratch = tempfile.TemporaryDirectory()
        self.folder = pathlib.Path(self.scratch.name)
        self.link, self.knobs_link = self.folder / "drive", self.folder / "knobs"
        self.process = subprocess.Popen(
            [SIL, "serve", "--link", self.link, "--tcp", "0", "--knobs-link", self.knobs_link,
             "--knobs-tcp", "0", *map(str, arguments)],
            stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, cwd=self.folder)
        self.serial = self.process.stdout.readline().split()[1:]
        self.knobs = self.process.stdout.readline().split()[1:]

    def __enter__(self):
        return self

    def end(self, number=signal.SIGTERM):
        """The exit code and what was said."""
        self.process.send_signal(number)
        said, complaint = self.process.communicate(timeout=20)
        return self.process.returncode, said, complaint

    def __exit__(self, *_):
        if self.process.poll() is None:
            self.process.kill()
            self.process.communicate()
        self.scratch.cleanup()


class Checks:
    """Collects what is not as it should be."""

    def __init__(self):
        self.failed = self.passed = 0

    def that(self, condition, what):
        self.passed += bool(condition)
        if not condition:
            self.failed += 1
            print(f"FAILED: {what}")

    def end(self):
        print(f"{self.passed} checks passed, {self.failed} failed")
        sys.exit(1 if self.failed else 0)
