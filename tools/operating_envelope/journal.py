"""Finished points, a line of JSON each, so that a map goes on where it was cut off."""
import hashlib
import json


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
        with open(self.file, "a", encoding="utf-8") as file:
            file.write(json.dumps({"key": key, "result": result}) + "\n")
