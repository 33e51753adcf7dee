# SPDX-License-Identifier: BSD-2-Clause
"""Functions on scenes and results: kernels, impacts, studies, pictures and pages."""

from __future__ import annotations

import contextlib
import re
import warnings
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from ricochet import _core, files, pages, pictures, programs
from ricochet.errors import InputError
from ricochet.kernel import Kernel
from ricochet.progress import Progress
from ricochet.result import Result
from ricochet.scene import PathLike, Scene, plain, scene_of
from ricochet.studies.study import Study
from ricochet.studies.sweep import Sweep
from ricochet.sweep_result import SweepResult

#: matches a line that ricochet-kernel prints at the end of a phase
_PHASE = re.compile(r"(?P<body>[\w-]+): (?P<phase>.+?) {2,}[\d.]+ (s|min|h)")


def kernels(scene: Scene | PathLike, ranks: int = 2, out: PathLike | None = None) -> dict[str, Kernel]:
    """Returns the kernels of a scene, by body. Missing kernels are computed by ricochet-kernel under mpirun.

    ranks: MPI ranks of ricochet-kernel.
    out: folder of the kernels; default: `scene.out`.

    Raises InputError, one line, for a mesh, a material or a setting that ricochet-kernel refuses, and
    SolverError for a computation that fails.
    """
    scene = scene_of(scene)
    folder = _folder(scene, out)
    if scene._core.needs_other_orders or not all(there for _, _, there in scene._core.kernel_files(folder)):
        _compute(scene, folder, ranks)
    return {body: Kernel(path) for body, path, _ in scene._core.kernel_files(folder)}


def stored_kernels(scene: Scene) -> dict[str, Kernel]:
    """The kernels in `scene.out`, by body. Raises InputError if one is missing."""
    found = {}
    for body, path, there in scene._core.kernel_files(scene.out):
        if not there:
            raise InputError(
                f"{scene.file.name}: no kernel for body {body!r} in {scene.out}. Call kernels(scene) first."
            )
        found[body] = Kernel(path)
    return found


def impact(scene: Scene | PathLike, out: PathLike | None = None) -> Result:
    """Runs the impact of a scene in this process and returns its result.

    Kernels must exist: call `kernels` first. The files of the result are those that ricochet-contact writes.
    Other threads can run during the steps. Ctrl-C ends the run and leaves no files behind.

    out: folder of kernels and results; default: `scene.out`.

    Raises InputError, one line, for kernels that are missing and for bodies that overlap or do not meet, and
    SolverError if the motion becomes infinite or undefined. Issues a UserWarning if the model may not be
    valid.
    """
    scene = scene_of(scene)
    folder = _folder(scene, out)
    file, settings = scene._command(folder)
    _core.run_impact(file, settings, folder, _StepBar().show)
    result = Result(folder / f"{scene.slug}.result.h5")
    for warning in result.warnings:
        warnings.warn(warning, stacklevel=2)
    return result


def sweep(
    study: Scene | PathLike,
    grid: Mapping[str, Sequence[Any]] | None = None,
    *,
    keep: Sequence[str] = (),
    out: PathLike | None = None,
    jobs: int | None = None,
    ranks: int = 2,
    retry: bool = False,
) -> SweepResult:
    """Runs the impacts of a study and computes the kernels that they need. Skips impacts that are finished,
    were refused or have failed, unless something they depend on has changed.

    study: a study file (docs/studies.md), or a Scene whose keys `grid` varies.
    grid: lists of values by key; every combination is run.
    keep: records to keep of each impact, for `SweepResult.history`: "force", "receivers",
        "acceleration", "gauges", "bodies", "energy". A study file has a `keep` of its own.
    out: folder of kernels and results; default: `out` beside the study, or `scene.out`.
    jobs: number of impacts that run at the same time; default: one for each processor.
    ranks: MPI ranks of ricochet-kernel.
    retry: whether to run impacts again that were refused or have failed.

    Raises InputError for a study that is refused, and SolverError if all of its impacts fail. If only some
    impacts fail, their rows of the result contain the reason in `error`.
    """
    if isinstance(study, Scene):
        if not grid:
            raise InputError("grid: is missing: name keys of the scene, with lists of their values")
        folder = _folder(study, out)
        path = _study_file(study, grid, keep, folder)
    else:
        for name, given in (("grid", grid is not None), ("keep", bool(keep))):
            if given:
                raise InputError(
                    f"{name}: does not go with a study file, which has a {name} of its own. Leave it out."
                )
        path = Path(study)
        folder = path.parent / "out" if out is None else Path(out)
    run = Sweep(Study(path), folder, jobs, ranks, retry=retry)
    with contextlib.closing(run.journal):
        run.prepare()
        try:
            run.run()
        finally:
            table = run.write()
    return SweepResult(table, run.results)


class Picture:
    """A PNG file, displayed in notebooks."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def _repr_png_(self) -> bytes:
        return self.path.read_bytes()

    def __repr__(self) -> str:
        return f"<Picture {self.path}>"


def plot(what: Result | Kernel | PathLike, out: PathLike | None = None) -> list[Picture]:
    """Draws a result or a kernel. Pictures of a result show the contact, the energy and, if there are
    snapshots, the bodies. The picture of a kernel shows its first elastic modes, if it has any. For the
    modes, the scene needs `output.view = true`.

    what: a result, its path, or a kernel.
    out: folder of the pictures; default: the folder of the result or of the kernel.

    Raises InputError for a file that cannot be drawn.
    """
    folder = None if out is None else Path(out)
    if isinstance(what, Kernel):
        drawn = pictures.draw_modes(what.path, folder or what.path.parent)
        return [Picture(drawn)] if drawn else []
    return [Picture(path) for path in pictures.draw(_path_of(what), folder)]


def report(result: Result | PathLike, out: PathLike | None = None) -> Path:
    """Writes the page of a run, which opens in any browser, and returns its path.

    out: path of the page; default: `<slug>.report.html` beside the result.

    Raises InputError for a file that cannot be read.
    """
    return pages.write_page(_path_of(result), None if out is None else Path(out))


# ---- Parts ----


def _folder(scene: Scene, out: PathLike | None) -> Path:
    return scene.out if out is None else Path(out).absolute()


def _path_of(result: Result | PathLike) -> Path:
    return result.path if isinstance(result, Result) else Path(result)


def _compute(scene: Scene, folder: Path, ranks: int) -> None:
    """Runs ricochet-kernel, with a progress bar that counts bodies."""
    file, settings = scene._command(folder)
    bar, seen = Progress(len(scene.bodies)), ""

    def show(line: str) -> None:
        nonlocal seen
        if found := _PHASE.match(line):
            body = found["body"]
            bar.advance(f"{body}: {found['phase']}", int(body != seen and seen != ""))
            seen = body
        elif line.startswith("warning: "):
            warnings.warn(line.removeprefix("warning: ").strip(), stacklevel=5)

    command = programs.kernel_command(file, programs.with_set(settings, folder), ranks)
    programs.wait(programs.start(command), show)
    bar.advance("kernels", bar.total - bar.done)


def _study_file(scene: Scene, grid: Mapping[str, Sequence[Any]], keep: Sequence[str], folder: Path) -> Path:
    """Writes the scene, and a study that varies it, into `folder`."""
    written = scene.write(folder / f"{scene.slug}.toml")
    path = folder / f"{scene.slug}.study.toml"
    words = [keep] if isinstance(keep, str) else list(keep)
    table = {"scene": written.name, "title": scene.title, "keep": words, "grid": plain(grid)}
    files.write(path, "\n".join(programs.settings(table)).encode())
    return path


class _StepBar:
    """A progress bar for those phases of a run whose length is known."""

    def __init__(self) -> None:
        self._bar: Progress | None = None

    def show(self, phase: str, done: int, total: int) -> None:
        if total > 0:
            self._bar = self._bar or Progress(total)
            self._bar.advance(phase, done - self._bar.done)
