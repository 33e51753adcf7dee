# SPDX-License-Identifier: BSD-2-Clause
"""The verdicts of earlier runs, and the survivors that were looked at."""
import hashlib
import json
import os
import tomllib

from judge import SURVIVED, Verdict


def digest(text):
    return hashlib.sha256(text.encode()).hexdigest()


class Record:
    """Verdicts in a JSON file. A verdict is valid as long as the source is the same, and that of a survivor as
    long as the tests are the same too."""

    def __init__(self, file, tests):
        self.file, self.tests = file, tests
        known = json.loads(file.read_text()) if file.exists() else {}
        self.verdicts, self.usual_s = known.get("verdicts", {}), known.get("usual_s", {})

    def find(self, mutant):
        entry = self.verdicts.get(mutant.key)
        if not entry or entry["source"] != digest(mutant.site.text):
            return None
        if entry["kind"] == SURVIVED and entry["tests"] != self.tests:
            return None
        return Verdict(entry["kind"], entry["by"])

    def add(self, mutant, verdict):
        site = mutant.site
        entry = {"source": digest(site.text), "tests": self.tests, "file": site.file, "before": site.before}
        self.verdicts[mutant.key] = entry | {"after": site.after} | verdict._asdict()
        self.save()

    def save(self):
        partial = self.file.with_suffix(".partial")
        partial.write_text(json.dumps({"usual_s": self.usual_s, "verdicts": self.verdicts}, indent=1))
        os.replace(partial, self.file)


class Reasons:
    """Why mutants survive, from a TOML file with tables `[[survivor]]`: `file`, `before` and `after` (the lines,
    with single spaces), `equivalent` (no result depends on it) and `reason`."""

    def __init__(self, file):
        tables = tomllib.loads(file.read_text()).get("survivor", []) if file.exists() else []
        self.known = {(table["file"], table["before"], table["after"]): table for table in tables}

    def find(self, mutant):
        return self.known.get((mutant.site.file, mutant.site.before, mutant.site.after))
