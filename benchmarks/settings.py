# SPDX-License-Identifier: BSD-2-Clause
"""Cost and error of each setting that trades accuracy for speed: time and memory of the kernels, error of the
impacts.

    scripts/bench settings meshes/two-disks/two-disks.toml
    scripts/bench settings meshes/two-disks/two-disks.toml --json settings.json
    scripts/bench settings meshes/two-disks/two-disks.toml --approximate

The reference is the impact computed with the lowest 400 certified modes of each body, residuals up to 1e-8.
Times are those of ricochet-kernel as a whole, meshing and assembly included; memory is the peak of the rank
that needed most. The error of frequencies is the largest of those kept, against the reference's of the same
number.

With --approximate, modes from block iterations are compared with certified ones with residuals up to 1e-4
(whose frequencies are accurate to 1e-7) by processor time on one rank, which other work on the machine
affects less.
"""
import json
import re
import subprocess
import sys
import tempfile
import time
from pathlib import Path

import h5py
import numpy as np

from benchmarks import impacts, launch, tables, timing
from benchmarks.impacts import Impacts, compare
from ricochet import errors, programs

CONTACT = 'basis="contact",up_to_hz={band:g}'
SETTINGS = [
    ("400 certified modes", "{{count=400}}", []),
    ("residuals up to 1e-6", "{{count=400,relative_residual=1e-6}}", []),
    ("residuals up to 1e-4", "{{count=400,relative_residual=1e-4}}", []),
    ("residuals up to 1e-2", "{{count=400,relative_residual=1e-2}}", []),
    ("approximate, 1 block iteration", "{{count=400,approximate=1}}", []),
    ("approximate, 2 block iterations", "{{count=400,approximate=2}}", []),
    ("200 modes", "{{count=200}}", []),
    ("100 modes", "{{count=100}}", []),
    ("100 modes, no residual flexibility", "{{count=100,residual_flexibility=false}}", []),
    ("modes for a flexibility error of 3e-2", "{{up_to_hz={band:g},flexibility_error=3e-2}}", []),
    ("order 2 on the same elements", "{{count=400}}", ["order=2"]),
    ("order 4 on the same elements", "{{count=400}}", ["order=4"]),
    ("contact-adapted basis, error 1e-1", "{{" + CONTACT + ",flexibility_error=1e-1}}", []),
    ("contact-adapted basis, error 1e-2", "{{" + CONTACT + ",flexibility_error=1e-2}}", []),
    ("contact-adapted basis, error 1e-3", "{{" + CONTACT + ",flexibility_error=1e-3}}", []),
    ("the same, block low-rank 1e-8", "{{" + CONTACT + ",flexibility_error=1e-3,low_rank=1e-8}}", []),
    ("the same, block low-rank 1e-4", "{{" + CONTACT + ",flexibility_error=1e-3,low_rank=1e-4}}", []),
]


def kernel_run(options, words):
    """Wall time [s] and peak memory [MiB] of ricochet-kernel, which prints the latter in its table."""
    command = programs.mpirun(options.ranks) + [programs.BIN / "ricochet-kernel", options.scene, *words]
    started = time.monotonic()
    done = subprocess.run([str(word) for word in command], capture_output=True, text=True)
    seconds = time.monotonic() - started
    peak = re.search(r"^total .* (\d+) MiB", done.stderr + done.stdout, re.MULTILINE)
    if done.returncode != 0 or not peak:
        print(done.stderr, file=sys.stderr)
        raise errors.ProgramError(done.returncode or 1)
    return seconds, int(peak[1])


def frequencies(folder):
    """Of each body, by name."""
    found = {}
    for path in folder.glob("*.kernel.h5"):
        with h5py.File(path) as kernel:
            found[kernel.attrs["body"].decode()] = kernel["modes/angular_frequency"][:]
    return found


def elastic_errors(omega, reference):
    """Relative, of as many as both have."""
    n = min(len(omega), len(reference))
    elastic = reference[:n] > 0
    return np.abs(omega[:n][elastic] / reference[:n][elastic] - 1)


def frequency_error(found, reference):
    return max(elastic_errors(omega, reference[body]).max() for body, omega in found.items())


def measure(options, name, modes, of_bodies, reference):
    with tempfile.TemporaryDirectory(prefix="ricochet-settings-") as folder:
        settings = [f"bodies.{body}.{key}" for body in reference.bodies for key in of_bodies]
        computed = Impacts(options, Path(folder), settings)
        modes = modes.format(band=options.band)
        words = [word for word in computed.words(modes) if word != "--quiet"]
        seconds, peak = kernel_run(options, words)
        found = computed.compute(modes) | {"frequencies": frequencies(Path(folder))}
        if reference.found is None:
            reference.found = found
        exact = "contact" not in modes and "flexibility_error" not in modes
        return {
            "setting": name,
            "vectors": found["vectors"],
            "seconds": seconds,
            "peak_mib": peak,
            "frequency_error": frequency_error(found["frequencies"], reference.found["frequencies"])
            if exact
            else None,
            "errors": compare(found, reference.found),
        }


def approximate(options, iterations=(0, 1, 2)):
    """A table of certified modes (0) and of approximate ones by so many iterations, of all bodies."""
    tables.head(
        [
            "modes",
            "processor time (s)",
            "certified / this",
            "block iterations taken",
            "error of frequencies: largest",
            "median",
        ]
    )
    truth, first = None, None
    for count in iterations:
        modes = f"{{count={options.count}," + (
            f"approximate={count}}}" if count else "relative_residual=1e-4}"
        )
        with tempfile.TemporaryDirectory(prefix="ricochet-settings-") as folder:
            before = timing.children_seconds()
            programs.kernel(
                options.scene,
                ["--quiet", "--out", folder, *programs.with_set([f"modes={modes}", "output.view=false"])],
                1,
            )
            seconds = timing.children_seconds() - before
            found, taken = frequencies(Path(folder)), iterations_taken(Path(folder))
        if not count:
            truth, first = found, seconds
        errors = np.concatenate([elastic_errors(omega, truth[body]) for body, omega in found.items()])
        tables.row(
            [
                f"`approximate = {count}`" if count else "certified, residuals up to 1e-4",
                f"{seconds:.1f}",
                f"{first / seconds:.2f}",
                taken if count else "",
                *([tables.show(errors.max()), tables.show(np.median(errors))] if count else ["", ""]),
            ]
        )


def iterations_taken(folder):
    taken = []
    for path in sorted(folder.glob("*.kernel.h5")):
        with h5py.File(path) as kernel:
            taken.append(int(kernel["modes/certificate"].attrs.get("approximate", 0)))
    return ", ".join(str(count) for count in taken)


class Reference:
    """The first setting measured."""

    def __init__(self, bodies):
        self.bodies, self.found = bodies, None


def add_arguments(parser):
    impacts.add_arguments(parser)
    parser.add_argument(
        "--approximate", action="store_true", help="compare approximate modes with certified ones instead"
    )
    parser.add_argument(
        "--count", type=int, default=400, help="number of those modes of each body (default: 400)"
    )


def run(options):
    launch.build("ricochet-kernel", "ricochet-contact")
    if options.approximate:
        approximate(options)
        return
    reference = Reference(Impacts(options, None).bodies)
    head = [
        "setting",
        "modes or vectors",
        "time (s)",
        "time of the first / time",
        "memory (MiB)",
        "error of frequencies",
    ]
    head += [f"{what} at {speed:g} m/s" for speed in options.speeds for what in ("rebound", "impulse")]
    tables.head(head)
    rows = []
    for name, modes, of_bodies in SETTINGS:
        row = measure(options, name, modes, of_bodies, reference)
        rows.append(row)
        cells = [name, ", ".join(str(n) for n in row["vectors"].values()), f"{row['seconds']:.1f}"]
        cells += [
            f"{rows[0]['seconds'] / row['seconds']:.1f}",
            row["peak_mib"],
            tables.show(row["frequency_error"]),
        ]
        cells += [
            tables.show(row["errors"][speed][what])
            for speed in options.speeds
            for what in ("rebound", "impulse")
        ]
        tables.row(cells)
    if options.json:
        options.json.write_text(json.dumps(rows, indent=1) + "\n")
