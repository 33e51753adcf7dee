# SPDX-License-Identifier: BSD-2-Clause
"""Impacts of one scene computed with different kernels, and their errors relative to a reference."""
import json
import math
import tomllib
from pathlib import Path

import h5py

from ricochet import programs, quantities
from ricochet.errors import InputError


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
        self.scene, self.body, self.speeds = options.scene, options.body, options.speeds
        self.settings = list(settings)
        self.ranks, self.folder = options.ranks, folder
        resolved = tomllib.loads(programs.resolved(self.scene, programs.with_set(self.settings)))
        self.bodies = sorted(resolved["bodies"])
        if self.body not in self.bodies:
            raise InputError(f'{self.scene}: there is no body "{self.body}": give --body')
        velocity = resolved["bodies"][self.body]["velocity"]
        if not any(velocity):
            raise InputError(f"{self.scene}: {self.body} is at rest: name the body that moves by --body")
        self.direction = [v / math.hypot(*velocity) for v in velocity]

    def words(self, modes, *more):
        own = [f"modes={modes}", "output.view=false", "output.snapshot_every=0"]
        return programs.with_set([*own, *self.settings, *more], self.folder)

    def compute(self, modes):
        """Computes kernels and impacts. Returns the number of vectors of each body, the largest estimate of
        their flexibility errors and, by speed, the rebound velocity [m/s] (None if the bodies still touch),
        the impulse [N s] and all quantities of interest."""
        programs.kernel(self.scene, ["--quiet", *self.words(modes)], self.ranks)
        impacts = {}
        for speed in self.speeds:
            velocity = ",".join(str(speed * d) for d in self.direction)
            words = self.words(modes, f"bodies.{self.body}.velocity=[{velocity}]", "title=impact")
            programs.contact(self.scene, ["--quiet", *words])
            summary = json.loads((self.folder / "impact.summary.json").read_text())
            exit_velocity = summary["exit_velocity"].get(self.body)
            rebound = exit_velocity and sum(v * d for v, d in zip(exit_velocity, self.direction))
            impacts[speed] = {
                "rebound": rebound,
                "impulse": summary["impulse_ns"],
                "quantities": summary["quantities"],
            }
        vectors, error = {}, 0.0
        with h5py.File(self.folder / "impact.result.h5") as result:
            kernels = {body: group.attrs["kernel"].decode() for body, group in result["bodies"].items()}
        for body, name in kernels.items():
            with h5py.File(self.folder / name) as kernel:
                vectors[body] = len(kernel["modes/angular_frequency"])
                error = max(error, float(kernel["modes/certificate"].attrs["flexibility_error"]))
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
