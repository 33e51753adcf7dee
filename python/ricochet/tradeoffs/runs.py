# SPDX-License-Identifier: BSD-2-Clause
"""The runs of a trade-off study: kernels and impacts of its settings with time, memory and outcome, each computed once."""
import hashlib
import json
import os
import re
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.errors import InputError, ProgramError
from ricochet.programs import Word
from ricochet.progress import Progress
from ricochet.studies.records import Row, Store
from ricochet.tradeoffs.points import Point, errors
from ricochet.tradeoffs.settings import Axes, Impact, Kernel, Scene


@dataclass
class Outcome:
    points: list[Point]
    floor: float  # error of the reference itself


class Runner:
    """Computes kernels and impacts of a scene in a folder."""

    def __init__(self, scene: Scene, folder: Path, ranks: int, repeats: int) -> None:
        self.scene, self.folder, self.ranks, self.repeats = scene, folder, ranks, repeats
        self.store = Store(folder / "runs.jsonl")

    def compare(self, axes: Axes, measures: Sequence[str], bar: Progress) -> Outcome:
        """Runs the reference and all settings. Raises InputError if the scene has no usable reference."""
        scene = self.scene
        basis = ("contact", 1e-3, True) if scene.band_hz else ("modes", max(axes.counts), True)
        finest = Kernel(
            *basis,
            order=scene.order and scene.order + 1,
            tolerance=1e-8,
            spacing=scene.spacing and scene.spacing / 2,
            band_hz=scene.band_hz and 2 * scene.band_hz,
        )
        rate_hz = 2 * max(axes.rates) * scene.rate_hz
        bar.advance("kernels of the reference", 0)
        row = self.kernel(finest)
        if "refused" in row:
            raise InputError(f"the reference is refused: {row['refused']}")
        reference, coarser = (
            self.impact(finest, Impact("compliant", rate)) for rate in (rate_hz, rate_hz / 2)
        )
        for row in (reference, coarser):
            if "refused" in row:
                raise InputError(f"the reference is refused: {row['refused']}")
        if not reference["ended"]:
            raise InputError(
                "the contact of the reference has not ended: give the scene a longer time.duration"
            )
        floor = max(errors(coarser, reference)[f"{measure}_error"] for measure in measures)
        bar.advance("reference")
        points = []
        for kernel, impacts in axes.settings(scene):
            known = len(self.store.rows)
            bar.advance(f"kernels of {kernel.name()}", 0)
            kernel_row = self.kernel(kernel)
            bar.advance(kernel.name(), already=len(self.store.rows) == known)
            for impact in impacts:
                known = len(self.store.rows)
                row = kernel_row if "refused" in kernel_row else self.impact(kernel, impact)
                points.append(Point(kernel, impact, kernel_row, row, reference, measures))
                bar.advance(kernel.name(), already=len(self.store.rows) == known)
        return Outcome(points, floor)

    def key(self, *settings: Any) -> str:
        text = json.dumps([self.scene.text, *settings], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def kernel_key(self, kernel: Kernel) -> str:
        return self.key(kernel.changes(self.scene), self.ranks)

    def kernel(self, kernel: Kernel) -> Row:
        """Time [s] and peak memory [MiB] of the kernels of all bodies, computed from nothing in one run."""
        key = self.kernel_key(kernel)
        folder = self.folder / key
        row = self.store.rows.get(key)
        if row and (folder.is_dir() or "refused" in row):
            return row
        shutil.rmtree(folder, ignore_errors=True)  # the time of a resumed run would be too short
        changes = kernel.changes(self.scene)
        command = [
            *programs.mpirun(self.ranks),
            programs.BIN / "ricochet-kernel",
            self.scene.path,
            "--out",
            folder,
            *self._words(changes),
        ]
        done = timed(command)
        row = {"key": key, "kernel": changes, "kernel_s": done.seconds}
        if done.status != 0:
            return self.store.add(row | refusal(done))
        peak = re.search(r"^total .* (\d+) MiB", done.text, re.MULTILINE)  # of the rank that needs most
        return self.store.add(row | {"kernel_mib": int(peak[1]) if peak else None})

    def impact(self, kernel: Kernel, impact: Impact) -> Row:
        """Outcome of an impact whose kernels exist, and the time [s] of all its steps without reading and writing: the
        shortest of `repeats` runs."""
        changes = kernel.changes(self.scene) | impact.changes()
        key = self.key(changes)
        if key in self.store.rows:
            return self.store.rows[key]
        folder = self.folder / self.kernel_key(kernel)
        command: list[Word] = [
            programs.BIN / "ricochet-contact",
            self.scene.path,
            "--quiet",
            "--out",
            folder,
            *self._words(changes | {"title": "impact"}),
        ]
        summaries, peak_mib = [], 0.0
        for _ in range(self.repeats):
            done = timed(command)
            if done.status != 0:
                return self.store.add({"key": key} | refusal(done))
            summaries.append(json.loads((folder / "impact.summary.json").read_text()))
            peak_mib = done.peak_mib
        (folder / "impact.result.h5").unlink(missing_ok=True)
        best = max(summaries, key=lambda summary: summary["real_time_factor"])
        return self.store.add(
            {
                "key": key,
                "impact_s": self.scene.duration_s / best["real_time_factor"],
                "vectors": sum(best["modes"].values()),
                "candidates": best["candidates"],
                "impact_mib": peak_mib,
                "exit_velocity": best["exit_velocity"],
                "impulse_ns": best["impulse_ns"],
                "peak_force_n": best["peak_force_n"],
                "ended": best["contact_end_s"] is not None,
            }
        )

    def _words(self, changes: dict[str, Any]) -> list[str]:
        return programs.with_set([*self.scene.settings, *programs.settings(changes)])


@dataclass
class Done:
    """A program that has ended: wall time [s], its own peak memory [MiB], status and output."""

    seconds: float
    peak_mib: float
    status: int
    text: str


def timed(command: Sequence[Word]) -> Done:
    environment = os.environ | programs.ONE_THREAD
    with tempfile.TemporaryFile("w+") as output:
        started = time.monotonic()
        process = subprocess.Popen(list(map(str, command)), env=environment, stdout=output, stderr=output)
        _, status, usage = os.wait4(process.pid, 0)
        seconds = time.monotonic() - started
        process.returncode = os.waitstatus_to_exitcode(status)  # or Popen would wait for it once more
        output.seek(0)
        return Done(seconds, usage.ru_maxrss / 1024, process.returncode, output.read())


def refusal(done: Done) -> Row:
    """The row of a setting that the programs refuse (status 2). Any other failure ends the study: ProgramError."""
    last = ([line for line in done.text.splitlines() if line.startswith("ricochet-")] or ["no reason given"])[
        -1
    ]
    if done.status != 2:
        print(last, file=sys.stderr)
        raise ProgramError(done.status)
    return {"refused": last}
