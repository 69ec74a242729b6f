"""Finished points, a line of JSON each, so that a map goes on where it was cut off."""
import hashlib
import json
import os


def append(file, lines):
    """Behind what the file holds; a line that was cut off is ended first."""
    with open(file, "ab+") as stream:
        size = stream.seek(0, os.SEEK_END)
        stream.seek(max(0, size - 1))
        start = "\n" if stream.read(1) not in (b"", b"\n") else ""
        stream.write((start + "".join(f"{line}\n" for line in lines)).encode())


class Journal:
    def __init__(self, file, program, conditions, fresh=False):
        """`conditions`: all that a result depends on besides scenario and program."""
        self.file = file
        self.base = hashlib.sha256(program.read_bytes())
        self.base.update(json.dumps(conditions, sort_keys=True).encode())
        self.found = {}
        if fresh:
            file.unlink(missing_ok=True)
        if not file.is_file():
            return
        for line in file.read_text(encoding="utf-8").splitlines():
            try:
                entry = json.loads(line)
                self.found[entry["key"]] = entry["result"]
            except (json.JSONDecodeError, KeyError):
                continue  # the last line of a run that was cut off

    def key(self, scenario):
        digest = self.base.copy()
        digest.update(scenario.encode())
        return digest.hexdigest()[:32]

    def get(self, scenario):
        return self.found.get(self.key(scenario))

    def put(self, scenario, result):
        key = self.key(scenario)
        self.found[key] = result
        append(self.file, [json.dumps({"key": key, "result": result})])
