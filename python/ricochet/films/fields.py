# SPDX-License-Identifier: BSD-2-Clause
"""The fields that colour the bodies of a film: at each vertex and snapshot, and their largest values over the run."""
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from numpy.typing import NDArray

from ricochet.arrays import Array
from ricochet.errors import InputError
from ricochet.films.basis import Values, blocks
from ricochet.films.bodies import FilmBody
from ricochet.pictures.loaded_result import LoadedResult
from ricochet.stress import von_mises


@dataclass
class Quantity:
    """What colours show."""

    name: str
    unit: str


QUANTITIES = {
    "motion": Quantity("displacement without that of the rigid motion", "m"),
    "speed": Quantity("mean speed between the neighbouring snapshots", "m/s"),
    "stress": Quantity("von Mises stress", "Pa"),
}


@dataclass
class ColourField:
    """A field on the V vertices of a body at the snapshots of the film."""

    values: Values
    largest: Array  # (V) over the run


def colour_field(
    what: str, result: LoadedResult, kernels: Path, name: str, body: FilmBody, time: Array
) -> ColourField:
    """The field `what`, a key of QUANTITIES, of the body `name`. Raises InputError if the run has no stress of surfaces,
    or not two snapshots for a speed.

    @param kernels  folder of the kernels
    @param time     of the snapshots of the film [s]
    """
    if what == "stress":
        if name not in result.stress:
            raise InputError(
                f"{result.path}: has no stress of the surface of {name}, which --colour stress needs: set output.stress = "
                "true, and compute kernels and impact again"
            )
        return ColourField(stress_values(result, kernels, name, body), result.stress[name].von_mises[body.of])
    if what == "speed" and len(time) < 2:
        raise InputError(
            f"{result.path}: has one snapshot, and --colour speed needs two: set a smaller output.snapshot_every and run "
            "again, or give another colour"
        )
    values = motion_values(body) if what == "motion" else speed_values(body, time)
    return ColourField(values, np.concatenate([values(some).max(axis=1) for some in blocks(len(body.of))]))


def motion_values(body: FilmBody) -> Values:
    """The length of the displacement by elastic modes and by the static response, not magnified [m]."""
    surface = body.surface
    elastic = np.flatnonzero(~surface.rigid)
    amplitudes = surface.coordinates[body.chosen][:, elastic].T.astype("f4")

    def values(some: NDArray[np.int64]) -> Array:
        return np.asarray(np.linalg.norm(surface.shape[body.of[some]][:, :, elastic] @ amplitudes, axis=1))

    return values


def speed_values(body: FilmBody, time: Array) -> Values:
    """The speed from the places at the snapshots before and after; at the ends, from the nearest two [m/s]."""
    surface, last = body.surface, len(time) - 1
    before, after = np.maximum(np.arange(last + 1) - 1, 0), np.minimum(np.arange(last + 1) + 1, last)
    between = np.maximum(time[after] - time[before], 1e-300)
    rotation, translation = (
        np.stack(parts) for parts in zip(*(surface.placement(int(k)) for k in body.chosen))
    )
    coordinates = surface.coordinates[body.chosen].T

    def values(some: NDArray[np.int64]) -> Array:
        node = body.of[some]
        local = surface.shape[node].astype(float) @ coordinates + surface.node[node][:, :, None]
        world = np.einsum("sij,vjs->vis", rotation, local) + translation.T
        return np.asarray(np.linalg.norm(world[:, :, after] - world[:, :, before], axis=1) / between)

    return values


def stress_values(result: LoadedResult, kernels: Path, name: str, body: FilmBody) -> Values:
    """The von Mises stress at the snapshots [Pa]."""
    fields, amplitudes = result.stress_fields(name, kernels)
    at = amplitudes[body.chosen].T.astype(fields.dtype)

    def values(some: NDArray[np.int64]) -> Array:
        return von_mises(np.moveaxis(fields[body.of[some]] @ at, 1, 2).astype(float))

    return values
