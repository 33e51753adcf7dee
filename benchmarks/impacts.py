# SPDX-License-Identifier: BSD-2-Clause
"""Impacts of one scene computed with different kernels, and their errors relative to a reference."""
import math
import warnings
from pathlib import Path

import ricochet
from ricochet import programs, quantities


def add_arguments(parser):
    """Adds the scene and the parameters of its impacts, for subcommands that compare impacts."""
    parser.add_argument("scene", type=Path, metavar="SCENE.toml")
    parser.add_argument("--body", default="upper", help="body whose rebound is compared (default: upper)")
    parser.add_argument(
        "--speeds", type=float, nargs="+", default=[1.0, 6.0], help="its speeds [m/s] (default: 1 6)"
    )
    parser.add_argument(
        "--band", type=float, default=500.0, help="band in which contact acts [Hz] (default: 500)"
    )
    parser.add_argument("--ranks", type=int, default=2, help="ranks of ricochet-kernel (default: 2)")
    parser.add_argument("--json", type=Path, help="write the results into this file")


class Impacts:
    """Impacts of one scene at several speeds, with all files in one folder."""

    def __init__(self, options, folder, settings=()):
        self.scene = ricochet.Scene(options.scene).changed(programs.changes(settings))
        self.body, self.speeds, self.ranks, self.folder = options.body, options.speeds, options.ranks, folder
        self.bodies = self.scene.bodies
        if self.body not in self.bodies:
            raise ricochet.InputError(f'{options.scene}: there is no body "{self.body}": give --body')
        velocity = self.scene[f"bodies.{self.body}.velocity"]
        if not any(velocity):
            text = f"{options.scene}: {self.body} is at rest: name the body that moves by --body"
            raise ricochet.InputError(text)
        self.direction = [v / math.hypot(*velocity) for v in velocity]

    def with_modes(self, modes):
        """The scene with this table [modes], without pictures."""
        return self.scene.changed(
            programs.changes([f"modes={modes}"]) | {"output.view": False, "output.snapshot_every": 0}
        )

    def compute(self, modes):
        """Computes kernels and impacts. Returns the number of vectors of each body, the largest estimate of
        their flexibility errors and, by speed, the rebound velocity [m/s] (None if the bodies still touch),
        the impulse [N s] and all quantities of interest."""
        scene, impacts = self.with_modes(modes), {}
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            kernels = ricochet.kernels(scene, self.ranks, self.folder)
            for speed in self.speeds:
                velocity = [speed * d for d in self.direction]
                changed = scene.changed({f"bodies.{self.body}.velocity": velocity, "title": "impact"})
                summary = ricochet.impact(changed, self.folder).summary
                exit_velocity = summary["exit_velocity"].get(self.body)
                impacts[speed] = {
                    "rebound": exit_velocity and sum(v * d for v, d in zip(exit_velocity, self.direction)),
                    "impulse": summary["impulse_ns"],
                    "quantities": summary["quantities"],
                }
        vectors = {body: len(kernel.angular_frequency) for body, kernel in kernels.items()}
        error = max(kernel.certificate.flexibility_error for kernel in kernels.values())
        return {"vectors": vectors, "estimate": error, "impacts": impacts}


def compare(found, reference):
    """Relative errors of all quantities, by speed. That of the rebound is None if the bodies still touch."""
    errors = {
        speed: quantities.errors(impact, reference["impacts"][speed])
        for speed, impact in found["impacts"].items()
    }
    for speed, impact in found["impacts"].items():
        if impact["rebound"] is None:
            errors[speed]["rebound"] = None
    return errors


def error_columns(speeds):
    """Table columns for the errors of `compare`."""
    return [
        (
            f"error of {what} at {speed:g} m/s",
            lambda row, of=(speed, what): row["errors"][of[0]][of[1]],
            ".1e",
        )
        for speed in speeds
        for what in ("rebound", "impulse")
    ]


def vectors_of(row):
    return ", ".join(f"{body} {n}" for body, n in row["vectors"].items())
