# SPDX-License-Identifier: BSD-2-Clause
"""Runs a study: first the kernels, each once, then several impacts at a time. Finished work is skipped."""
import contextlib
import hashlib
import json
import os
import time
import tomllib
from collections.abc import Callable
from pathlib import Path
from typing import Any

from ricochet import programs, scene_keys
from ricochet.errors import InputError, failure
from ricochet.programs import Show
from ricochet.progress import Progress
from ricochet.studies.groups import Groups
from ricochet.studies.histories import Source
from ricochet.studies.journal import Journal, Part
from ricochet.studies.kernels import Files, Kernels
from ricochet.studies.records import Row
from ricochet.studies.study import Study
from ricochet.studies.table import Table

SYNC_S = 2.0


class Sweep:
    """A study in a folder of kernels and results.

    @param part      run only this part of the impacts, beside other parts, with existing kernels
    @param collects  run nothing and only collect finished impacts
    @param retry     run impacts again that were refused or have failed
    @param show      called with lines about the time and memory of kernels
    """

    def __init__(
        self,
        study: Study,
        folder: Path,
        jobs: int | None,
        ranks: int,
        part: Part | None = None,
        collects: bool = False,
        retry: bool = False,
        show: Show | None = None,
    ) -> None:
        self.study, self.folder, self.part, self.collects = study, folder, part, collects
        self.stem = folder / study.slug
        self.results = Path(f"{self.stem}.sweep.h5")
        self.journal = Journal(self.stem, part, collects, study.keep, retry)
        self.kernels = Kernels(study, folder, jobs or os.cpu_count() or 1, ranks, show)
        # Keys identify impacts by program, scene, setting, kernels and other files that they read.
        self.keys = [""] * len(study.settings)
        self.refused: dict[int, Row] = {}  # answers by index of the setting
        self.wanted = {"keep": study.keep} if study.keep else {}  # in requests
        self.families: dict[str, list[int]] = {}  # by file of settings: impacts with accuracy
        self.groups = Groups(study, self.kernels, self.journal, self.keys, part is not None)

    def prepare(self) -> None:
        """Checks all settings and computes the kernels that this stage needs. Raises InputError and
        SolverError."""
        before = None
        while True:
            missing = self._check()
            if self.part or self.collects:  # an earlier stage may have failed to compute kernels
                rows = self.journal.rows
                self.kernels.refused = {k: rows[self.keys[k]] for k in missing if self.keys[k] in rows}
            self.refused |= self.kernels.refused
            if len(self.refused) == len(self.keys):
                raise failure(self.refused[0]["status"], self.refused[0]["error"])
            missing = {index: files for index, files in missing.items() if index not in self.refused}
            if not missing or self.collects:
                break
            name = min(missing.values())[0]
            if self.part:
                raise InputError(
                    f"{self.folder}: the kernels of {len(missing)} settings are missing, such as {name}: "
                    "run ricochet sweep --kernels"
                )
            if missing == before:
                raise InputError(
                    f"{self.folder}: ricochet-kernel does not leave {name} there: compute it by hand"
                )
            # A kernel with only some candidates may not suffice for all settings, so the next round checks
            # again.
            self.kernels.compute(missing)
            for index, answer in self.kernels.refused.items():
                self.journal.add(self.keys[index], json.dumps(answer).encode())
            before = missing
        if not self.collects:
            for family, members in self.families.items():
                if not all(k in self.refused or self.journal.finished(self.keys[k]) for k in members):
                    self.groups.settle(family, members)
            self.refused |= self.groups.refused
            if len(self.refused) == len(self.keys):
                raise failure(self.refused[0]["status"], self.refused[0]["error"])

    def _check(self) -> Files:
        """Requests the list of kernels of each setting. Fills `keys` and `refused`. Returns, by index, the
        kernels that an unfinished impact needs and that are missing or contain too few candidates."""
        study = self.study
        scene, version = [content_of(study.text), study.fixed], programs.version()
        self.refused, missing, bar = {}, {}, Progress(len(study.settings))
        self.families.clear()
        requests = (
            {"set": programs.settings(setting), "kernels": True, **self.wanted} for setting in study.settings
        )
        for index, line, _ in self.kernels.ask(requests):
            answer = json.loads(line)
            bar.advance("checking")
            if answer["status"] != 0:
                self.refused[index] = answer
                continue
            family = answer.get("settings")
            kernels = [] if family else answer["kernels"]
            files = [family] if family else [kernel["file"] for kernel in kernels]
            self.kernels.names.update(kernel["file"] for kernel in kernels)
            identity = [version, scene, study.settings[index], files, answer["reads"]]
            text = json.dumps(identity, sort_keys=True, default=str)
            self.keys[index] = hashlib.sha256(text.encode()).hexdigest()[:24]
            if family:  # all rows, so that a sweep that goes on finds the same groups
                self.families.setdefault(family, []).append(index)
                if self.journal.refused(self.keys[index]):
                    self.refused[index] = self.journal.rows[self.keys[index]]
            lacking = [kernel["file"] for kernel in kernels if not kernel["there"]]
            if lacking and self.journal.refused(self.keys[index]):
                self.refused[index] = self.journal.rows[self.keys[index]]
            elif lacking and not self.journal.finished(self.keys[index]):
                missing[index] = lacking
        return missing

    def own(self) -> list[int]:
        """The settings of this part, except refused ones."""
        k, n = self.part or (1, 1)
        return [index for index in range(k - 1, len(self.keys), n) if index not in self.refused]

    def left(self) -> list[int]:
        """The settings of `own` whose impacts are to be run."""
        journal, keys = self.journal, self.keys
        return [k for k in self.own() if not journal.finished(keys[k]) and not journal.refused(keys[k])]

    def run(self, check: Callable[[Row], None] = lambda _: None) -> int:
        """Runs the remaining impacts and returns their number. `check` is called with each row and may raise
        InputError."""
        left, rows = self.left(), self.journal.rows
        bar, synced = Progress(len(self.keys)), time.monotonic()
        bar.advance("impacts", len(self.keys) - len(left), already=True)
        for key in self.keys:
            if key in rows:
                check(rows[key])
        settings = self.study.settings
        served = self.groups.served
        requests = (
            {"set": programs.settings(settings[k]) + (served[k].chosen if k in served else []), **self.wanted}
            for k in left
        )
        with contextlib.closing(self.kernels.ask(requests)) as answers:
            for index, line, records in answers:
                key = self.keys[left[index]]
                if left[index] in served:
                    line = json.dumps(served[left[index]].complete(json.loads(line))).encode()
                self.journal.add(key, line, records)
                check(rows[key])
                bar.advance("impacts")
                if time.monotonic() - synced > SYNC_S:
                    self.journal.sync()
                    synced = time.monotonic()
        self.journal.sync()
        return len(left)

    def write(self) -> Table:
        """Writes the table of all settings as <slug>.sweep.csv, and with the records as <slug>.sweep.h5."""
        rows = [self.refused.get(k) or self.journal.rows.get(key) for k, key in enumerate(self.keys)]
        kept = self.journal.kept
        sources = [
            Source(k, *kept[key]) for k, key in enumerate(self.keys) if self.study.keep and key in kept
        ]
        table = Table(self.study, rows)
        table.write_csv(Path(f"{self.stem}.sweep.csv"))
        table.write_hdf5(self.results, sources, scene_keys.all_units())
        return table


def content_of(scene: str) -> dict[str, Any] | str:
    """The content of a scene without comments and layout. Text that is not TOML is returned as it is;
    ricochet-contact refuses it."""
    try:
        return tomllib.loads(scene)
    except (ValueError, RecursionError):
        return scene
