# SPDX-License-Identifier: BSD-2-Clause
"""Deliberate errors: a wrong force, a wrong sign, a wrong R, a lost mode and a wrong step in each contact law and scheme, and the
lines of the manual that then fail.

    scripts/verify --errors                    # all
    scripts/verify --errors friction blocks    # of these laws and schemes
    scripts/verify --errors --list             # what would be changed
    scripts/verify --errors --manual           # all; also writes docs/validation/errors.md

Each error of deliberate_errors.py is built and run in a copy of the tree in build-errors/. It counts as caught in a case if the case
stops, or if a line fails that holds without the error and does not hold by construction. Each case that the list names must catch the
error; otherwise the status is 1. A run that was interrupted continues where it was.
"""
import hashlib
import importlib
import json
import os
import shutil
import subprocess
import sys
from pathlib import Path

import case
import deliberate_errors
import errors_page
import manual_cases
import mutate
from copy_tree import fingerprint, synchronise
from deliberate_errors import ERRORS, SCHEMES
from judge import Judge
from ricochet import errors, programs
from ricochet.progress import Progress

PAGE = programs.ROOT / "docs" / "validation" / "errors.md"
# What the programs are built from.
FOLDERS = ["CMakeLists.txt", "base/", "contact/", "include/", "kernels/", "python/bindings/", "src/"]
DEADLOCK_S = 600  # a case that runs longer hangs because of the error


def key_of(error):
    return hashlib.sha256("\0".join((error.file, error.right, error.wrong)).encode()).hexdigest()[:12]


class Bench:
    """Runs cases with the programs of a copy of the tree, which may contain an error."""

    def __init__(self, folder, jobs, options):
        self.folder, self.tree, self.build = folder, folder / "tree", folder / "build"
        folder.mkdir(parents=True, exist_ok=True)
        synchronise(programs.ROOT, self.tree)
        mutate.configure(self.tree, self.build, ["-DRICOCHET_APART=core;contact", *options])
        self.judge = Judge(self.tree, self.build, jobs, {})
        self.sources = fingerprint(programs.ROOT, FOLDERS)

    def compile(self, targets):
        built = self.judge.compile(targets)
        if not built.passed:
            raise errors.SolverError(f"the build fails:\n{built.output[-3000:]}")

    def mark(self, module, error):
        """Changes with the sources of the programs, the case and the error."""
        files = sorted(manual_cases.sources(Path(module.__file__), {Path(case.__file__)}))
        digest = hashlib.sha256((self.sources + (key_of(error) if error else "")).encode())
        for path in files + sorted((programs.ROOT / "meshes").glob("*/*.[tg]*")):
            digest.update(path.read_bytes())
        return digest.hexdigest()

    def cache(self, error):
        return self.folder / "cases" / (key_of(error) if error else "right")

    def missing(self, name, error):
        """Whether the case must still be run."""
        mark = self.mark(importlib.import_module(f"cases.{name}"), error)
        return not manual_cases.kept_in(self.cache(error) / name / "found.json", mark)

    def found(self, name, error):
        """Results of the case with the present build, or earlier ones. The case runs in a process of its own, because an
        error may end or stop it."""
        path = self.cache(error) / name / "found.json"
        mark = self.mark(importlib.import_module(f"cases.{name}"), error)
        if self.missing(name, error):
            if error and error.file.startswith("contact/"):
                self.lend_kernels(name, self.cache(error) / name, mark)
            variables = {"RICOCHET_BIN": str(self.build / "bin")}
            variables["PYTHONPATH"] = f"{self.build}/python:{os.environ['PYTHONPATH']}"
            command = [sys.executable, "-m", "errors_caught", name, mark, self.cache(error)]
            errors_of_case = subprocess.DEVNULL if error else None  # where it broke off
            try:
                subprocess.run(command, env=os.environ | variables, stderr=errors_of_case, timeout=DEADLOCK_S)
                why = "its process ended"
            except subprocess.TimeoutExpired:
                why = f"not finished after {DEADLOCK_S} s"
            if self.missing(name, error):
                path.parent.mkdir(parents=True, exist_ok=True)
                path.write_text(json.dumps(case.nothing(why) | {"fingerprint": mark}))
        return manual_cases.kept_in(path, mark)

    def lend_kernels(self, name, to, mark):
        """An error in the contact library does not change kernels, so the case continues with the right ones."""
        shutil.rmtree(to, ignore_errors=True)
        own = self.cache(None) / name
        for kernel in own.rglob("*.kernel.h5"):
            target = to / kernel.relative_to(own)
            target.parent.mkdir(parents=True, exist_ok=True)
            os.link(kernel, target)
        to.mkdir(parents=True, exist_ok=True)
        (to / "begun").write_text(mark)

    def right(self, names):
        """Results without an error."""
        if any(self.missing(name, None) for name in names):
            self.compile(["ricochet-kernel", "ricochet_python"])
        return {name: self.found(name, None) for name in names}

    def wrong(self, error):
        """Results with the error, by case."""
        if any(self.missing(name, error) for name in error.cases):
            source = self.tree / error.file
            text = source.read_text()
            source.write_text(text.replace(error.right, error.wrong))
            try:
                self.compile(programs_of(error))
            finally:
                source.write_text(text)
        return {name: self.found(name, error) for name in error.cases}


def programs_of(error):
    return ["ricochet_python"] + ["ricochet-kernel"] * (not error.file.startswith("contact/"))


def add_arguments(parser):
    parser.add_argument("schemes", nargs="*", metavar="SCHEME", help="these alone (default: all)")
    parser.add_argument("--list", action="store_true", help="list the errors and stop")
    parser.add_argument("--manual", action="store_true", help="write docs/validation/errors.md; needs all")
    parser.add_argument(
        "--jobs", type=int, default=os.cpu_count(), help="jobs of the build (default: all cores)"
    )
    parser.add_argument(
        "--build", type=Path, default=programs.ROOT / "build-errors", help="folder (default build-errors)"
    )
    parser.add_argument(
        "--cmake", action="append", default=[], metavar="OPTION", help="option of CMake: --cmake=-DX=Y"
    )


def run(options):
    """Returns the status, which is 1 if a case does not catch an error."""
    for name in options.schemes:
        if name not in SCHEMES:
            raise errors.InputError(f"{name}: no such law or scheme. They are {', '.join(SCHEMES)}.")
    if options.manual and options.schemes:
        raise errors.InputError("--manual: the page contains every law and scheme. Give no names.")
    chosen = [error for error in ERRORS if not options.schemes or error.scheme in options.schemes]
    if options.list:
        for error in chosen:
            print(f"{error.scheme:18} {error.kind:6} {error.what}: {error.file}, {', '.join(error.cases)}")
        return 0
    deliberate_errors.check(programs.ROOT)
    bench = Bench(options.build.resolve(), options.jobs, options.cmake)
    right = bench.right(sorted({name for error in chosen for name in error.cases}))
    progress, effects = Progress(len(chosen)), {}
    for error in sorted(chosen, key=lambda error: error.file):  # a file that changes again is compiled once
        already = not any(bench.missing(name, error) for name in error.cases)
        found = bench.wrong(error)
        effects[error] = [errors_page.effect(name, right[name], found[name]) for name in error.cases]
        print(*errors_page.describe(error, effects[error]), sep="\n", flush=True)
        progress.advance(f"{error.scheme}, {error.kind}", already=already)
    results = [(error, effects[error]) for error in chosen]
    if options.manual:
        errors_page.write(PAGE, results)
        print(PAGE)
    missed = [error for error, found in results if not all(one.caught for one in found)]
    for error in missed:
        print(f"verify: not caught: {error.scheme}, {error.kind}: {error.what}", file=sys.stderr)
    return 1 if missed else 0


if __name__ == "__main__":  # one case, for Bench.found
    wanted, fingerprint_of_case, folder = sys.argv[1:]
    manual_cases.found_by(
        wanted, importlib.import_module(f"cases.{wanted}"), fingerprint_of_case, Path(folder), False
    )
