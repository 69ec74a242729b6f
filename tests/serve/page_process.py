"""`steadystep page --simulate` as a process of a test."""
import signal
import subprocess
import sys

from operated import environment

SIL = sys.argv[1]


class Page:
    """Its address, its token, and where another program finds its drive."""

    def __init__(self, *arguments):
        self.process = subprocess.Popen(
            [sys.executable, "-m", "steadystep", "page", "--simulate", "--simulator", SIL, *arguments],
            env=environment(), stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
        address = self.process.stdout.readline().split()[1:]
        if not address:
            sys.exit(self.process.communicate()[1])
        self.address = address[0]
        self.url, self.token = self.address.split("/#")
        self.shared = self.process.stdout.readline().split()[4]

    def end(self):
        self.process.send_signal(signal.SIGTERM)
        said = self.process.communicate(timeout=20)[1]
        return self.process.returncode, said
