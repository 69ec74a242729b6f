"""Works through many items at a time, keeps what is finished, says how far it is."""
import concurrent.futures
import sys
import time

PROGRESS_EVERY_s = 5


class Progress:
    """"envelope: 37 of 96 points, 12 s left", a line every few seconds."""

    def __init__(self, tool, what, count):
        self.tool, self.what, self.count, self.done = tool, what, count, 0
        self.started = self.shown = time.monotonic()

    def add(self, count):
        self.done += count
        now = time.monotonic()
        if now - self.shown > PROGRESS_EVERY_s and self.done < self.count:
            self.shown = now
            left = (now - self.started) / self.done * (self.count - self.done)
            print(f"{self.tool}: {self.done} of {self.count} {self.what}, {left:.0f} s left",
                  file=sys.stderr, flush=True)


def each(items, work, jobs):
    """(item, work(item)) as they finish, `jobs` at a time; the first exception ends it all."""
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        running = {pool.submit(work, item): item for item in items}
        try:
            for future in concurrent.futures.as_completed(running):
                yield running[future], future.result()
        except BaseException:
            pool.shutdown(cancel_futures=True)
            raise
