# SPDX-License-Identifier: BSD-2-Clause
"""Judges deliberate errors by the lines of the validation manual.

An error is caught in a case if the case stops, or if a line fails that holds without the error and does not hold by construction. It is
killed if each of its cases catches it."""
import hashlib
import importlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import case
import errors_page
import manual_cases
from copy_tree import fingerprint
from judge import KILLED, SURVIVED, Judge, Verdict
from ricochet import programs

# What the programs are built from.
FOLDERS = ["CMakeLists.txt", "base/", "contact/", "include/", "kernels/", "python/bindings/", "src/"]
DEADLOCK_S = 600  # a case that runs longer hangs because of the error


class ManualJudge(Judge):
    """A judge who runs cases of the manual. The folder keeps their results, which are also the record of earlier verdicts."""

    def __init__(self, folder, jobs):
        super().__init__(folder / "tree", folder / "build", jobs, {})
        self.folder, self.sources = folder / "cases", fingerprint(programs.ROOT, FOLDERS)

    def place(self, name, error):
        return self.folder / (error.key if error else "right") / name

    def mark(self, name, error):
        """Changes with the sources of the programs, the case and the error."""
        module = importlib.import_module(f"cases.{name}")
        files = sorted(manual_cases.sources(Path(module.__file__), {Path(case.__file__)}))
        digest = hashlib.sha256((self.sources + (error.key if error else "")).encode())
        for path in files + sorted((programs.ROOT / "meshes").glob("*/*.[tg]*")):
            digest.update(path.read_bytes())
        return digest.hexdigest()

    def kept(self, name, error):
        """Earlier results of the case, or None."""
        return manual_cases.kept_in(self.place(name, error) / "found.json", self.mark(name, error))

    def effects(self, error):
        """What the error does to each of its cases, from kept results, or None if any is missing."""
        results = [(name, self.kept(name, None), self.kept(name, error)) for name in error.cases]
        complete = all(right and wrong for _, right, wrong in results)
        return [errors_page.effect(*result) for result in results] if complete else None

    def find(self, error):
        """The verdict from kept results, as that of a record, or None."""
        effects = self.effects(error)
        if effects is None:
            return None
        kind = KILLED if all(effect.caught for effect in effects) else SURVIVED
        return Verdict(kind, "\n".join(errors_page.describe(error, effects)))

    def add(self, error, verdict):
        """The cases have kept their results."""

    def write_page(self, path, written):
        results = [(error, self.effects(error)) for error in written.errors]
        if missing := sum(effects is None for _, effects in results):
            raise SystemExit(f"mutants: --manual: {missing} errors have no results yet")
        errors_page.write(path, written, results)
        print(path)

    def judge(self, error):
        if any(not self.kept(name, None) for name in error.cases):
            self.run_cases(error.cases, None, ["ricochet-kernel", "ricochet_python"])
        return super().judge(error)

    def _tested(self, error):
        in_contact = error.site.file.startswith("contact/")
        self.run_cases(error.cases, error, ["ricochet_python"] + ["ricochet-kernel"] * (not in_contact))
        return self.find(error), None

    def run_cases(self, names, error, programs_of_cases):
        """Builds the programs as they are and runs those of the cases without results. Each runs in a process of its own, because an
        error may end or stop it."""
        built = self.compile(programs_of_cases)
        if not built.passed:
            raise SystemExit(
                f"mutants: {error.name if error else 'no mutant'}: the build fails:\n{built.output[-3000:]}"
            )
        variables = {"RICOCHET_BIN": str(self.build / "bin")}
        variables["PYTHONPATH"] = f"{self.build}/python:{os.environ['PYTHONPATH']}"
        for name in names:
            if self.kept(name, error):
                continue
            place, mark = self.place(name, error), self.mark(name, error)
            if error and error.site.file.startswith("contact/"):
                self.lend_kernels(name, place, mark)
            command = [sys.executable, "-m", "manual_judge", name, mark, place.parent]
            errors_of_case = subprocess.DEVNULL if error else None  # where it broke off
            try:
                subprocess.run(command, env=os.environ | variables, stderr=errors_of_case, timeout=DEADLOCK_S)
                why = "its process ended"
            except subprocess.TimeoutExpired:
                why = f"not finished after {DEADLOCK_S} s"
            if not self.kept(name, error):
                place.mkdir(parents=True, exist_ok=True)
                (place / "found.json").write_text(json.dumps(case.nothing(why) | {"fingerprint": mark}))

    def lend_kernels(self, name, to, mark):
        """An error in the contact library does not change kernels, so the case continues with the right ones."""
        shutil.rmtree(to, ignore_errors=True)
        own = self.place(name, None)
        for kernel in own.rglob("*.kernel.h5"):
            target = to / kernel.relative_to(own)
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(kernel, target)
        to.mkdir(parents=True, exist_ok=True)
        (to / "begun").write_text(mark)


if __name__ == "__main__":  # one case, for run_cases
    wanted, fingerprint_of_case, results = sys.argv[1:]
    manual_cases.found_by(
        wanted, importlib.import_module(f"cases.{wanted}"), fingerprint_of_case, Path(results), False
    )
