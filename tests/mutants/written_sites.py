# SPDX-License-Identifier: BSD-2-Clause
"""Hand-written sites: the deliberate errors of deliberate_errors.toml, of each kind in each contact law and scheme."""
import dataclasses
import hashlib
import tomllib
from pathlib import Path
from typing import NamedTuple

from mutant import Mutant, Site

FILE = Path(__file__).with_name("deliberate_errors.toml")
KINDS = ("force", "sign", "R", "mode", "Δ")


@dataclasses.dataclass(frozen=True)
class Error(Mutant):
    """A mutant of a law or scheme (`folder`) that makes a line of the manual fail in each of `cases`."""

    kind: str
    what: str
    cases: tuple

    @property
    def name(self):
        return f"{self.folder}, {self.kind}"

    def __str__(self):
        return f"{super().__str__()}\n    {self.what}; caught in {', '.join(self.cases)}"


class Written(NamedTuple):
    """The laws and schemes with what they are, the errors in them, and by (scheme, kind) why there is none."""

    schemes: dict
    errors: list
    none: dict


def read(root, table=None):
    """The hand-written sites in a checkout. Raises ValueError if a text does not occur exactly once in its file, or if a kind has
    neither an error nor a reason.

    @param table  in place of the table in FILE"""
    table = table or tomllib.loads(FILE.read_text())
    errors = []
    for entry in table["error"]:
        text, right, wrong = (root / entry["file"]).read_text(), entry["right"], entry["wrong"]
        name = f"{entry['scheme']}, {entry['kind']}"
        if (count := text.count(right)) != 1:
            raise ValueError(f"{name}: occurs {count} times in {entry['file']}: {right}")
        start = text.index(right)
        site = Site(entry["file"], text, start, start + len(right), wrong)
        key = hashlib.sha256("\0".join((site.file, right, wrong)).encode()).hexdigest()[:12]
        errors.append(Error(entry["scheme"], site, key, entry["kind"], entry["what"], tuple(entry["cases"])))
    none = {(scheme, kind): why for scheme, kinds in table["none"].items() for kind, why in kinds.items()}
    covered = {(error.folder, error.kind) for error in errors}
    for pair in ((scheme, kind) for scheme in table["schemes"] for kind in KINDS):
        if (pair in covered) == (pair in none):
            raise ValueError(
                f"{', '.join(pair)}: needs an error, or a reason why there is none, and not both"
            )
    return Written(table["schemes"], errors, none)
