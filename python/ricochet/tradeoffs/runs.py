# SPDX-License-Identifier: BSD-2-Clause
"""The runs of a trade-off study: kernels and impacts of all settings with time, memory and results, each
computed once."""
import argparse
import hashlib
import json
import shutil
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from ricochet import programs
from ricochet.errors import InputError, failure
from ricochet.progress import Progress
from ricochet.studies.records import Row, Store
from ricochet.timing import Done, timed
from ricochet.tradeoffs.points import Point, errors
from ricochet.tradeoffs.settings import Impact, Kernel, Scene, settings


@dataclass
class Outcome:
    points: list[Point]
    floor: float  # error of the reference itself


class Runner:
    """Computes kernels and impacts of a scene in a folder."""

    def __init__(self, scene: Scene, folder: Path, ranks: int, repeats: int) -> None:
        self.scene, self.folder, self.ranks, self.repeats = scene, folder, ranks, repeats
        self.store = Store(folder / "runs.jsonl")

    def compare(self, options: argparse.Namespace) -> Outcome:
        """Runs the reference and all settings. Raises InputError if the scene has no usable reference."""
        scene = self.scene
        most = max(options.counts or [scene.count])
        basis = ("contact", 1e-3, True) if scene.band_hz else ("modes", most, True)
        finest = Kernel(
            *basis,
            order=scene.order and scene.order + 1,
            relative_residual=1e-8,
            spacing_m=scene.spacing and scene.spacing / 2,
            band_hz=scene.band_hz and 2 * scene.band_hz,
        )
        rate_hz = 2 * max(options.rates) * scene.rate_hz
        varied = settings(options, scene)
        bar = Progress(1 + sum(1 + len(impacts) for _, impacts in varied))
        bar.advance("kernels of the reference", 0)
        needed(self.kernel(finest))
        reference, coarser = (
            needed(self.impact(finest, Impact("compliant", rate))) for rate in (rate_hz, rate_hz / 2)
        )
        if not reference["ended"]:
            raise InputError(
                "the contact of the reference has not ended: give the scene a longer time.duration"
            )
        floor = max(errors(coarser, reference)[f"{measure}_error"] for measure in options.measure)
        bar.advance("reference")
        points = []
        for kernel, impacts in varied:
            known = len(self.store.rows)
            bar.advance(f"kernels of {kernel.name()}", 0)
            kernel_row = self.kernel(kernel)
            bar.advance(kernel.name(), already=len(self.store.rows) == known)
            for impact in impacts:
                known = len(self.store.rows)
                row = kernel_row if "refused" in kernel_row else self.impact(kernel, impact)
                points.append(Point(kernel, impact, kernel_row, row, reference, options.measure))
                bar.advance(kernel.name(), already=len(self.store.rows) == known)
        return Outcome(points, floor)

    def key(self, *settings: Any) -> str:
        text = json.dumps([self.scene.text, *settings], sort_keys=True)
        return hashlib.sha256(text.encode()).hexdigest()[:16]

    def kernel_key(self, kernel: Kernel) -> str:
        return self.key(kernel.changes(self.scene), self.ranks)

    def kernel(self, kernel: Kernel) -> Row:
        """Time [s] and peak memory [MiB] of the kernels of all bodies, computed in one run without any
        existing kernel."""
        key = self.kernel_key(kernel)
        folder = self.folder / key
        row = self.store.rows.get(key)
        if row and (folder.is_dir() or "refused" in row):
            return row
        shutil.rmtree(folder, ignore_errors=True)  # a resumed run would take less time
        changes = kernel.changes(self.scene)
        words = self._words(changes, folder)
        command = programs.kernel_command(self.scene.path, words, self.ranks)
        programs.find(command)
        done = timed(command)
        row = {"key": key, "kernel": changes, "kernel_s": done.seconds}
        if done.status != 0:
            return self.store.add(row | refusal(done))
        return self.store.add(row | {"kernel_mib": done.rank_mib()})

    def impact(self, kernel: Kernel, impact: Impact) -> Row:
        """Results of an impact whose kernels exist, and the time of all its steps [s], without reading and
        writing: the shortest of `repeats` runs. If steps are chosen for an accuracy, it is the time of the
        whole run, with its estimates."""
        changes = kernel.changes(self.scene) | impact.changes()
        key = self.key(changes, "quantities")  # rows of earlier versions have none
        if key in self.store.rows:
            return self.store.rows[key]
        folder = self.folder / self.kernel_key(kernel)
        words = ["--quiet", *self._words(changes | {"title": "impact"}, folder)]
        command = [programs.BIN / "ricochet-contact", self.scene.path, *words]
        summaries, seconds = [], []
        for _ in range(self.repeats):
            done = timed(command)
            if done.status != 0:
                return self.store.add({"key": key} | refusal(done))
            seconds.append(done.seconds)
            summaries.append(json.loads((folder / "impact.summary.json").read_text()))
        (folder / "impact.result.h5").unlink(missing_ok=True)
        best = max(summaries, key=lambda summary: summary["real_time_factor"])
        return self.store.add(
            {
                "key": key,
                "impact_s": (
                    min(seconds) if impact.rate_hz is None else best["duration_s"] / best["real_time_factor"]
                ),
                "vectors": sum(best["modes"].values()),
                "candidates": best["candidates"],
                "impact_mib": done.peak_mib,
                "quantities": best["quantities"],
                "ended": best["contact_end_s"] is not None,
            }
        )

    def _words(self, changes: dict[str, Any], folder: Path) -> list[programs.Word]:
        return programs.with_set([*self.scene.settings, *programs.settings(changes)], folder)


def needed(row: Row) -> Row:
    """The row of a run of the reference. Raises InputError if the run was refused."""
    if "refused" in row:
        raise InputError(f"the reference is refused: {row['refused']}")
    return row


def refusal(done: Done) -> Row:
    """The row of a setting that the programs refuse (status 2). Raises the error of any other failure, which
    ends the study."""
    own = [line for line in done.text.splitlines() if line.startswith("ricochet-")]
    last = own[-1] if own else "no reason given"
    if done.status != 2:
        raise failure(done.status, last)
    return {"refused": last}
