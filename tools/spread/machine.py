"""Where calls of the simulator run: on this machine, or on the workers of a cluster.

A call is the simulator's arguments and the files that they name, so that it can run anywhere. It
runs in a folder of its own that holds the files, and nothing outside but the program and its own
scenarios, motors and parameter sets.
"""
import os
import tempfile

from spread.answer import Refused, checked
from spread.call import CATALOGUE, answer_of, write_files

SCENARIOS = ("--scenarios", CATALOGUE / "scenarios")


class Local:
    """This machine; as many calls at a time as there are cores, unless set."""

    def __init__(self, jobs=None):
        self.jobs = jobs or os.cpu_count() or 1

    def call(self, program, arguments, files=None, returns=()):
        """Answer of the program. Without `files` it runs in the present folder. `returns`: names of
        files that the answer is to hold."""
        if files is None:
            return checked(answer_of([program, *SCENARIOS, *arguments], None, returns))
        with tempfile.TemporaryDirectory() as folder:
            write_files(folder, files)
            return checked(answer_of([program, *SCENARIOS, *arguments], folder, returns))

    def close(self):
        pass


def add_options(parser):
    """--jobs and --dask, the same for every tool."""
    parser.add_argument("--jobs", type=int)
    parser.add_argument("--dask", metavar="ADDRESS")


def machine_of(options):
    """As the options say; Refused if it is not there."""
    if options.jobs is not None and options.jobs < 1:
        raise Refused("--jobs: at least 1")
    if not options.dask:
        return Local(options.jobs)
    from spread.cluster import Cluster
    return Cluster(options.dask, options.jobs)
