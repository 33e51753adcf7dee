# SPDX-License-Identifier: BSD-2-Clause
"""The kernels of a sweep. All meshes are checked first, then each kernel is computed once."""
import json
import re
import subprocess
from collections import deque
from collections.abc import Generator, Iterable, Iterator
from pathlib import Path

from ricochet import programs
from ricochet.programs import Answer, Word
from ricochet.progress import Progress
from ricochet.studies.study import Study
from ricochet.studies.workers import Reply, in_parallel

# Keys that the check of meshes, groups, loads and receivers ignores. Settings that differ only in these are
# checked once.
NUMBERS = re.compile(
    r"(bodies\.[^.]+\.(material(\.[^.]+)?\.(like|young|shear|density|poisson|stiffness|axes|about|yield)"
    r"|damping|velocity|translate|rotate_deg)|time|loads\.gravity|contact\.(gap|scheme|restitution))\b"
)


Files = dict[int, list[str]]  # kernel files by index of a setting


class Kernels:
    """The kernels of the settings of a study, in a folder. `show` is called with each line that states the time and memory
    of a part of their computation."""

    def __init__(
        self, study: Study, folder: Path, jobs: int, ranks: int, show: programs.Show | None = None
    ) -> None:
        self.study, self.folder, self.jobs, self.ranks, self.show = study, folder, jobs, ranks, show
        self.refused: dict[int, Answer] = {}  # answer of --batch, by index of the setting
        self.names: set[str] = set()  # kernel files of all settings
        self.checked: dict[str, Answer | None] = {}  # error or None, by meshes
        self.tried: set[str] = set()  # files that this round has tried to compute

    def ask(self, requests: Iterable[Answer]) -> Generator[Reply, None, None]:
        """Sends requests to processes of ricochet-contact. Yields (index, answer as a line of JSON,
        records)."""
        words = programs.with_set(programs.settings(self.study.fixed), self.folder)
        command = [programs.BIN / "ricochet-contact", self.study.scene, "--batch", *words]
        return in_parallel(self.jobs, programs.bound(command), requests)

    def compute(self, missing: Files) -> None:
        """Computes missing kernel files, given by index of the setting. Settings that fail are added to
        `refused`."""
        self.tried = set()
        self._check(missing)
        left = self._first_of_each(missing)
        bar = Progress(len(left))
        while left:
            name, index = min(left.items(), key=lambda item: item[1])
            bar.advance(name, 0)
            before = self._stamps()
            words = self._words(index, quiet=self.show is None)
            command = programs.kernel_command(self.study.scene, words, self.ranks)
            if answer := programs.refusal(programs.start(command), self.show):
                self._refuse(index, answer, missing)
            else:
                self.tried.add(name)
            new = sorted(name for name, stamp in self._stamps().items() if before.get(name) != stamp)
            self.tried.update(new)
            self._derive(new, missing)
            remaining = self._first_of_each(missing)
            bar.advance(name, len(left) - len(remaining))
            left = remaining

    def _words(self, index: int, quiet: bool = True) -> list[Word]:
        changes = self.study.fixed | self.study.settings[index]
        return [*["--quiet"] * quiet, *programs.with_set(programs.settings(changes), self.folder)]

    def _stamps(self) -> dict[str, int]:
        return {path.name: path.stat().st_mtime_ns for path in self.folder.glob("*.kernel.h5")}

    def _first_of_each(self, missing: Files) -> dict[str, int]:
        """For each missing file, the first setting that needs it."""
        found: dict[str, int] = {}
        for index, files in missing.items():
            if index not in self.refused:
                for file in files:
                    if file not in self.tried:
                        found.setdefault(file, index)
        return found

    def _derive(self, new: list[str], missing: Files) -> None:
        """Derives kernels from those that were just computed, without starting ricochet-kernel."""
        wanted = sorted(set(self._first_of_each(missing).values())) if new else []
        requests = (
            {"set": programs.settings(self.study.settings[k]), "kernels": True, "derive": new} for k in wanted
        )
        for _, line, _ in self.ask(requests):
            self.tried.update(
                kernel["file"] for kernel in json.loads(line).get("kernels", []) if kernel["there"]
            )

    def _refuse(self, index: int, answer: Answer, missing: Files) -> None:
        """Refuses a setting, and all others that would fail for the same reason: those that need the kernel
        that is to blame, or exactly the same kernels, and those whose meshes are refused."""
        blamed = self._blamed(missing[index], answer)
        meshes = self.meshes(index) if answer["status"] == 2 else None
        for other, files in missing.items():
            if blamed in files or files == missing[index] or meshes == self.meshes(other):
                self.refused[other] = answer

    def _blamed(self, files: list[str], answer: Answer) -> str | None:
        """The file of the body that the error names. The computation of a kernel also fails at the first one
        missing."""
        body = re.search(r"bodies\.([\w-]+)", answer["error"])
        named = [file for file in files if body and file.rpartition("-")[0] == body[1]]
        if named or answer["status"] == 2:
            return named[0] if named else None
        there = self._stamps()
        return next((file for file in files if file not in there), files[0])

    def meshes(self, index: int) -> str:
        """The part of a setting on which the check of meshes depends. With `reach`, this is the whole
        setting, because the placement of the bodies then determines the candidates."""
        setting = self.study.fixed | self.study.settings[index]
        reach = "reach" in self.study.text or any("reach" in key for key in setting)
        return json.dumps({key: value for key, value in setting.items() if reach or not NUMBERS.match(key)})

    def _check(self, missing: Files) -> None:
        """Checks the meshes of all settings with several processes of ricochet-kernel. If there is only one
        setting, its computation checks them."""
        while True:
            asked: dict[str, int] = {}
            for index in self._first_of_each(missing).values():
                asked.setdefault(self.meshes(index), index)
            asked = {meshes: index for meshes, index in asked.items() if meshes not in self.checked}
            if not asked or len(asked) == 1 and not self.checked:
                return
            bar = Progress(len(asked))
            for meshes, answer in self._answers(asked):
                self.checked[meshes] = answer
                bar.advance("checking meshes")
                if answer:
                    self._refuse(asked[meshes], answer, missing)

    def _answers(self, asked: dict[str, int]) -> Iterator[tuple[str, Answer | None]]:
        """Yields meshes and the error of their setting, or None. `asked`: index of a setting by its
        meshes."""
        running: deque[tuple[str, subprocess.Popen[str]]] = deque()
        waiting = iter(asked.items())
        try:
            while True:
                while len(running) < self.jobs and (item := next(waiting, None)):
                    words = [self.study.scene, "--check", *self._words(item[1])]
                    running.append((item[0], programs.start([programs.kernel_program(), *words])))
                if not running:
                    return
                meshes, process = running[0]
                yield meshes, programs.refusal(process)
                running.popleft()
        finally:
            for _, process in running:
                process.terminate()
            for _, process in running:
                process.wait()
