# SPDX-License-Identifier: BSD-2-Clause
"""Cost and error of each setting that trades accuracy for speed: time and memory of the kernels, error of the
impacts.

    scripts/bench settings meshes/two-disks/two-disks.toml
    scripts/bench settings meshes/two-disks/two-disks.toml --json settings.json

The reference is the impact computed with the lowest 400 certified modes of each body, with residuals up to
1e-8. Times are those of ricochet-kernel as a whole, including meshing and assembly. Memory is the peak of the
rank that used most. The error of the frequencies is the largest one; each mode is compared with the mode of
the same number in the reference.
"""
import json
import tempfile
from pathlib import Path

import h5py
import numpy as np

from benchmarks import impacts, launch, tables
from benchmarks.impacts import Impacts, compare, error_columns, vectors_of
from ricochet import programs

CONTACT = '{{basis="contact",up_to_hz={band:g},flexibility_error='
SETTINGS = [
    ("400 certified modes", "{{count=400}}", []),
    ("residuals up to 1e-6", "{{count=400,relative_residual=1e-6}}", []),
    ("residuals up to 1e-4", "{{count=400,relative_residual=1e-4}}", []),
    ("residuals up to 1e-2", "{{count=400,relative_residual=1e-2}}", []),
    ("200 modes", "{{count=200}}", []),
    ("100 modes", "{{count=100}}", []),
    ("100 modes, no residual flexibility", "{{count=100,residual_flexibility=false}}", []),
    ("modes for a flexibility error of 3e-2", "{{up_to_hz={band:g},flexibility_error=3e-2}}", []),
    ("order 2 on the same elements", "{{count=400}}", ["order=2"]),
    ("order 4 on the same elements", "{{count=400}}", ["order=4"]),
    ("contact-adapted basis, error 1e-1", CONTACT + "1e-1}}", []),
    ("contact-adapted basis, error 1e-2", CONTACT + "1e-2}}", []),
    ("contact-adapted basis, error 1e-3", CONTACT + "1e-3}}", []),
    ("the same, block low-rank 1e-8", CONTACT + "1e-3,low_rank=1e-8}}", []),
    ("the same, block low-rank 1e-4", CONTACT + "1e-3,low_rank=1e-4}}", []),
]


def frequencies(folder):
    """Angular frequencies by body."""
    found = {}
    for path in folder.glob("*.kernel.h5"):
        with h5py.File(path) as kernel:
            found[kernel.attrs["body"].decode()] = kernel["modes/angular_frequency"][:]
    return found


def frequency_error(found, reference):
    """Largest relative error of the elastic frequencies that are in both, over all bodies."""

    def largest(omega, true):
        n = min(len(omega), len(true))
        elastic = true[:n] > 0
        return np.abs(omega[:n][elastic] / true[:n][elastic] - 1).max()

    return max(largest(omega, reference[body]) for body, omega in found.items())


def measure(options, name, modes, of_bodies, reference):
    with tempfile.TemporaryDirectory(prefix="ricochet-settings-") as folder:
        settings = [f"bodies.{body}.{key}" for body in reference.bodies for key in of_bodies]
        computed = Impacts(options, Path(folder), settings)
        modes = modes.format(band=options.band)
        scene = computed.with_modes(modes).write(Path(folder) / "scene.toml")
        done = launch.measured(programs.kernel_command(scene, ["--out", folder], options.ranks))
        found = computed.compute(modes) | {"frequencies": frequencies(Path(folder))}
        if reference.found is None:
            reference.found = found
        error = None
        if "flexibility_error" not in modes:
            error = frequency_error(found["frequencies"], reference.found["frequencies"])
        return {
            "setting": name,
            "vectors": found["vectors"],
            "seconds": done.seconds,
            "peak_mib": done.rank_mib(),
            "frequency_error": error,
            "errors": compare(found, reference.found),
        }


class Reference:
    """The result of the first setting that was measured."""

    def __init__(self, bodies):
        self.bodies, self.found = bodies, None


def add_arguments(parser):
    impacts.add_arguments(parser)


def run(options):
    launch.build("ricochet-kernel", "ricochet_python")
    reference = Reference(Impacts(options, None).bodies)
    rows = []
    table = tables.Table(
        [
            ("setting", "setting", ""),
            ("modes or vectors", vectors_of, ""),
            ("time (s)", "seconds", ".1f"),
            ("time of the first / time", lambda row: rows[0]["seconds"] / row["seconds"], ".1f"),
            ("memory (MiB)", "peak_mib", ""),
            ("error of frequencies", "frequency_error", ".1e"),
            *error_columns(options.speeds),
        ]
    )
    for name, modes, of_bodies in SETTINGS:
        row = measure(options, name, modes, of_bodies, reference)
        rows.append(row)
        table.row(row)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
