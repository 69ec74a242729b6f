"""Calls of the simulator on the workers of a dask.distributed cluster.

Workers need Python and dask, nothing of ours: program, scenarios and this package's call.py go with
the calls. What a worker had in hand when it died is run again by another.
"""
import asyncio
import concurrent.futures
import hashlib
import socket
import threading

from spread import call
from spread.answer import Refused, checked

CONNECT_s = 10
CALLS_PER_CORE = 2   # so that no worker waits for its next call
MOST_CALLS = 512     # at a time
PART = 4 << 20       # bytes in one task: more in one makes dask warn
TRIES = 3            # of a call whose workers die, each after dask's own


class Cluster:
    def __init__(self, address, jobs=None):
        """Refused if dask.distributed is not installed or nobody answers at `address`."""
        try:
            import cloudpickle
            import distributed
        except ImportError as error:
            raise Refused(f"--dask needs dask.distributed: {error}; tools/setup cluster installs it"
                          ) from error
        cloudpickle.register_pickle_by_value(call)
        self.distributed, self.address = distributed, address
        try:
            socket.create_connection(distributed.comm.get_address_host_port(address),
                                     CONNECT_s).close()
            self.client = distributed.Client(address, timeout=CONNECT_s, set_as_default=False)
        except (OSError, ValueError) as error:
            raise Refused(f"--dask {address}: no scheduler answers: {error}") from error
        cores = sum(self.client.ncores().values())
        self.jobs = jobs or min(MOST_CALLS, max(1, CALLS_PER_CORE * cores))
        self.bundles, self.lock = {}, threading.Lock()

    def _bundle(self, program):
        """(its name, its parts on the cluster); the scheduler can make them anew."""
        with self.lock:  # tools call from many threads
            if program not in self.bundles:
                bundle = call.bundle_of(program, call.CATALOGUE)
                name = hashlib.sha256(bundle).hexdigest()[:16]
                self.bundles[program] = name, [
                    self.client.submit(call.same, bundle[at:at + PART], key=f"{name}-{at}")
                    for at in range(0, len(bundle), PART)]
            return self.bundles[program]

    def call(self, program, arguments, files=None, returns=()):
        name, parts = self._bundle(program)
        words = [str(word) for word in arguments]
        for _ in range(TRIES):
            future = self.client.submit(call.run_bundled, parts, name, words, files or {}, returns,
                                        pure=False)
            try:
                return checked(future.result())
            except self.distributed.scheduler.KilledWorker:
                continue
            except (OSError, asyncio.CancelledError, concurrent.futures.CancelledError) as error:
                raise ConnectionError(
                    f"--dask {self.address}: the scheduler is gone; the same command goes on from "
                    f"what is finished: {error}") from error
        raise ConnectionError(f"--dask {self.address}: workers die of {' '.join(words)}")

    def close(self):
        self.client.close()
