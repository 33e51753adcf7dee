# SPDX-License-Identifier: BSD-2-Clause
"""The kernels of a sweep: what their meshes refuse, found before the first one is computed, and computing them."""
import json
import re
from collections import deque
from collections.abc import Iterable, Iterator
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.errors import ProgramError
from ricochet.progress import Progress
from ricochet.programs import Answer, Word
from ricochet.studies.study import Study
from ricochet.studies.workers import in_parallel

# Keys that no mesh, group, load or receiver is checked against: settings that differ in these alone are checked once.
NUMBERS = re.compile(
    r"(bodies\.[^.]+\.(material(\.[^.]+)?\.(young|density|poisson)|damping|velocity|translate|rotate_deg)"
    r"|time|loads\.gravity|contact\.(gap|scheme|restitution))\b"
)


Files = dict[int, list[str]]  # by index of a setting: kernel files


class Kernels:
    """Of a study's settings, in `folder`."""

    def __init__(self, study: Study, folder: Path, jobs: int, ranks: int) -> None:
        self.study, self.folder, self.jobs, self.ranks = study, folder, jobs, ranks
        self.refused = {}  # by index: an answer as that of an impact
        self.names = set()  # of the files of all settings
        self.checked = {}  # by meshes: None or an answer
        self.tried = set()  # files of the present round

    def ask(self, requests):
        """Yields (index, answer as a line of JSON)."""
        words = programs.with_set(programs.settings(self.study.fixed))
        command = [
            programs.BIN / "ricochet-contact",
            self.study.scene,
            "--batch",
            "--out",
            self.folder,
            *words,
        ]
        return in_parallel(self.jobs, programs.bound(command), requests)

    def compute(self, missing):
        """`missing`: by index the files that a setting lacks. Each is computed once, or its settings join `refused`."""
        self.tried = set()
        self._check(missing)
        left = self._first_of_each(missing)
        bar = Progress(len(left))
        while left:
            name, index = min(left.items(), key=lambda item: item[1])
            bar.advance(name, 0)
            before = self._stamps()
            try:
                programs.kernel(self.study.scene, self._words(index), self.ranks, quiet=True)
                self.tried.add(name)
            except ProgramError as failure:
                if not str(failure):
                    raise
                self._refuse(index, failure, missing)
            new = sorted(name for name, stamp in self._stamps().items() if before.get(name) != stamp)
            self.tried.update(new)
            self._derive(new, missing)
            before, left = len(left), self._first_of_each(missing)
            bar.advance(name, before - len(left))

    def _words(self, index):
        overrides = programs.with_set(programs.settings(self.study.fixed | self.study.settings[index]))
        return ["--quiet", "--out", self.folder, *overrides]

    def _stamps(self):
        return {path.name: path.stat().st_mtime_ns for path in self.folder.glob("*.kernel.h5")}

    def _first_of_each(self, missing):
        """By file that is still to be computed: the first setting that needs it."""
        found = {}
        for index, files in missing.items():
            if index not in self.refused:
                for file in files:
                    if file not in self.tried:
                        found.setdefault(file, index)
        return found

    def _derive(self, new, missing):
        """What follows from a kernel that was computed needs no start of ricochet-kernel."""
        wanted = sorted(set(self._first_of_each(missing).values())) if new else []
        requests = (
            {"set": programs.settings(self.study.settings[k]), "kernels": True, "derive": new} for k in wanted
        )
        for _, line in self.ask(requests):
            self.tried.update(
                kernel["file"] for kernel in json.loads(line).get("kernels", []) if kernel["there"]
            )

    def _refuse(self, index, failure, missing):
        """A setting, and others for the same reason: what is refused is so by its meshes, and where a computation broke down
        it was that of the first body whose kernel is not there."""
        there = self._stamps()
        blamed = next((file for file in missing[index] if file not in there), missing[index][0])
        for other, files in missing.items():
            if blamed in files if failure.status == 1 else self._meshes(other) == self._meshes(index):
                self.refused[other] = {"status": failure.status, "error": str(failure)}

    def _meshes(self, index):
        """What of a setting its meshes have to do with; all of it where reaches choose points by the place of bodies."""
        setting = self.study.fixed | self.study.settings[index]
        reach = "reach" in self.study.text or any("reach" in key for key in setting)
        return json.dumps({key: value for key, value in setting.items() if reach or not NUMBERS.match(key)})

    def _check(self, missing):
        """Lets ricochet-kernel check the meshes of all settings that need it, side by side. Those of the first kernel it
        checks anyway before it computes."""
        while True:
            asked = {}
            for index in self._first_of_each(missing).values():
                asked.setdefault(self._meshes(index), index)
            asked = {meshes: index for meshes, index in asked.items() if meshes not in self.checked}
            if not asked or len(asked) == 1 and not self.checked:
                return
            bar = Progress(len(asked))
            for meshes, answer in self._answers(asked):
                self.checked[meshes] = answer
                bar.advance("checking meshes")
            if any(self.checked[meshes] for meshes in asked):
                for index in missing:
                    if answer := self.checked.get(self._meshes(index)):
                        self.refused[index] = answer

    def _answers(self, asked):
        """Pairs of meshes and what their setting is refused with, or None. `asked`: index by meshes."""
        running, waiting = deque(), iter(asked.items())
        try:
            while True:
                while len(running) < self.jobs and (item := next(waiting, None)):
                    command = [
                        programs.BIN / "ricochet-kernel",
                        self.study.scene,
                        "--check",
                        *self._words(item[1]),
                    ]
                    running.append((item[0], programs.start(command)))
                if not running:
                    return
                yield running[0][0], programs.refusal(running[0][1])
                running.popleft()
        finally:
            for _, process in running:
                process.terminate()
            for _, process in running:
                process.wait()
