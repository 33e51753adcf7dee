# SPDX-License-Identifier: BSD-2-Clause
"""The kernels of a sweep: what their meshes refuse, found before the first one is computed, and computing them."""
import json
import re
import subprocess
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path

from ricochet import programs
from ricochet.errors import ProgramError
from ricochet.programs import Answer, Word
from ricochet.progress import Progress
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
        self.refused: dict[int, Answer] = {}  # by index: an answer as that of an impact
        self.names: set[str] = set()  # of the files of all settings
        self.checked: dict[str, Answer | None] = {}  # by meshes: None or an answer
        self.tried: set[str] = set()  # files of the present round

    def ask(self, requests: Iterable[Answer]) -> Generator[tuple[int, bytes], None, None]:
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

    def compute(self, missing: Files) -> None:
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
            remaining = self._first_of_each(missing)
            bar.advance(name, len(left) - len(remaining))
            left = remaining

    def _words(self, index: int) -> list[Word]:
        overrides = programs.with_set(programs.settings(self.study.fixed | self.study.settings[index]))
        return ["--quiet", "--out", self.folder, *overrides]

    def _stamps(self) -> dict[str, int]:
        return {path.name: path.stat().st_mtime_ns for path in self.folder.glob("*.kernel.h5")}

    def _first_of_each(self, missing: Files) -> dict[str, int]:
        """By file that is still to be computed: the first setting that needs it."""
        found: dict[str, int] = {}
        for index, files in missing.items():
            if index not in self.refused:
                for file in files:
                    if file not in self.tried:
                        found.setdefault(file, index)
        return found

    def _derive(self, new: list[str], missing: Files) -> None:
        """What follows from a kernel that was computed needs no start of ricochet-kernel."""
        wanted = sorted(set(self._first_of_each(missing).values())) if new else []
        requests = (
            {"set": programs.settings(self.study.settings[k]), "kernels": True, "derive": new} for k in wanted
        )
        for _, line in self.ask(requests):
            self.tried.update(
                kernel["file"] for kernel in json.loads(line).get("kernels", []) if kernel["there"]
            )

    def _refuse(self, index: int, failure: ProgramError, missing: Files) -> None:
        """A setting, and others for the same reason: what is refused is so by its meshes, and where a computation broke down
        it was that of the first body whose kernel is not there."""
        there = self._stamps()
        blamed = next((file for file in missing[index] if file not in there), missing[index][0])
        for other, files in missing.items():
            if blamed in files if failure.status == 1 else self._meshes(other) == self._meshes(index):
                self.refused[other] = {"status": failure.status, "error": str(failure)}

    def _meshes(self, index: int) -> str:
        """What of a setting its meshes have to do with; all of it where reaches choose points by the place of bodies."""
        setting = self.study.fixed | self.study.settings[index]
        reach = "reach" in self.study.text or any("reach" in key for key in setting)
        return json.dumps({key: value for key, value in setting.items() if reach or not NUMBERS.match(key)})

    def _check(self, missing: Files) -> None:
        """Lets ricochet-kernel check the meshes of all settings that need it, side by side. Those of the first kernel it
        checks anyway before it computes."""
        while True:
            asked: dict[str, int] = {}
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

    def _answers(self, asked: dict[str, int]) -> Iterator[tuple[str, Answer | None]]:
        """Pairs of meshes and what their setting is refused with, or None. `asked`: index by meshes."""
        running: deque[tuple[str, subprocess.Popen[str]]] = deque()
        waiting = iter(asked.items())
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
